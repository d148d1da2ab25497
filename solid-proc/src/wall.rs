//! Rigid walls toward the solid. Below the spacing dx (the mean of the two), at which two surfaces meet, particles
//! repel each other as those of different bodies do, and what approaches is damped as soon as surfaces overlap:
//!   F = [k (dx - r) - c w(r) min(v_sw . x_sw / r, 0)] x_sw / r,   k = (K + 4 G / 3) / 2 dx^(D-2),
//!   c = 2 zeta sqrt(k m_s), w = 1 below 0.75 dx, 0 from dx on, a straight line between.
//!
//! Kayaki's section 4.1 extrapolates the solid's pressure to its walls, after Adami. Here a wall has none: such a push
//! follows from no energy, begins 2h off the wall and pushes a body up that lies on it.

use crate::columns::{Vectors, vectors};
use halfstep_scene::geometry::WallPoint;
use halfstep_scene::{Motion, Placement, Scene};
use halfstep_sph::columns::{bounds, fit};
use halfstep_sph::fade::Fade;
use halfstep_sph::lane::{Arch, Isa, LANES, Lane, Lanes};
use halfstep_sph::neighbours::{ClusterList, PADDING, Rows};
use halfstep_sph::pair::{self, PairLaw, distance, dot, pair_sum};

/// zeta. A disc of rubber, 20 particles across, loses 0.3 % of its energy by it.
const DAMPING_RATIO: f64 = 0.2;
/// Distance up to which the whole damping acts, over the spacing; from the spacing on there is none.
const TOUCH: f64 = 0.75;

/// Wall particles that the solid may touch.
pub(crate) struct Walls<const D: usize> {
    id: Vec<u32>,
    position: Vectors<D>,
    velocity: Vectors<D>,
    /// Of the surface beside that, by number of the wall particle, m/s.
    belt: Vec<[f64; D]>,
    rows: Rows<D>,
    /// Of the rows, m.
    height: f64,
    moving: Option<Moving<D>>,
    /// The solid's wall neighbours.
    neighbours: ClusterList,
    forces: Vec<WallForce<D>>,
}

/// Walls that move by prescription: columns by number of the wall particle.
struct Moving<const D: usize> {
    /// By shape.
    motions: Vec<Option<Motion>>,
    /// Where each shape was when the lists were made.
    listed: Vec<Placement>,
    /// Distance of each shape's farthest particle from the pivot about which it turns, m.
    radius: Vec<f64>,
    /// When the lists were made, s.
    listed_at: f64,
    /// Now, s.
    time: f64,
    shape: Vec<u32>,
    /// Place in the scene, m.
    initial: Vec<[f64; D]>,
}

impl<const D: usize> Moving<D> {
    fn new(points: &[&WallPoint<D>], scene: &Scene) -> Option<Self> {
        let motion = |shape: u32| scene.shapes[shape as usize].motion.as_ref();
        points.iter().find(|p| motion(p.shape).is_some())?;
        let mut radius = vec![0.0_f64; scene.shapes.len()];
        for p in points {
            if let Some(pivot) = motion(p.shape).and_then(Motion::pivot) {
                let away = ((p.position[0] - pivot[0]).powi(2) + (p.position[1] - pivot[1]).powi(2)).sqrt();
                radius[p.shape as usize] = radius[p.shape as usize].max(away);
            }
        }
        Some(Self {
            motions: scene.shapes.iter().map(|shape| shape.motion.clone()).collect(),
            listed: vec![Placement::default(); scene.shapes.len()],
            radius,
            listed_at: 0.0,
            time: 0.0,
            shape: points.iter().map(|p| p.shape).collect(),
            initial: points.iter().map(|p| p.position).collect(),
        })
    }

    /// Where a shape's surface is now, and how fast.
    fn of(&self, shape: usize) -> Placement {
        self.motions[shape].as_ref().map_or_else(Placement::default, |motion| motion.at(self.time))
    }

    /// Largest displacement since the lists were made, m.
    fn displacement(&self) -> f64 {
        let of =
            |(shape, listed): (usize, &Placement)| self.of(shape).moved_since(listed, self.radius[shape]);
        self.listed.iter().enumerate().map(of).fold(0.0, f64::max)
    }
}

impl<const D: usize> Walls<D> {
    /// `None` where the solid may touch no wall.
    pub(crate) fn new(scene: &Scene, points: &[WallPoint<D>], height: f64, isa: Isa) -> Option<Self> {
        let points: Vec<_> = points.iter().filter(|p| p.contact).collect();
        if points.is_empty() {
            return None;
        }
        let n = points.len();
        let mut walls = Self {
            id: (0..n as u32).collect(),
            position: vectors(n),
            velocity: vectors(n),
            belt: points.iter().map(|p| p.velocity).collect(),
            rows: Rows::default(),
            height,
            moving: Moving::new(&points, scene),
            neighbours: ClusterList::new(isa),
            forces: Vec::new(),
        };
        for (i, p) in points.iter().enumerate() {
            for d in 0..D {
                walls.position[d][i] = p.position[d];
            }
        }
        walls.sort();
        Some(walls)
    }

    fn sort(&mut self) {
        let (low, high) = bounds(&self.position);
        self.rows.sort(&self.position, &self.id, self.height, low, high);
        for d in 0..D {
            self.rows.permute(&mut self.position[d]);
            fit(&mut self.velocity[d], self.rows.slots(), 0.0);
        }
        self.rows.permute_ids(&mut self.id);
    }

    /// Brings the walls that move to where they are at a time, s.
    pub(crate) fn set_time(&mut self, time: f64) {
        let Some(moving) = &mut self.moving else { return };
        moving.time = time;
        let placements: Vec<Placement> = (0..moving.motions.len()).map(|shape| moving.of(shape)).collect();
        let mut last = 0;
        for (slot, &id) in self.id.iter().enumerate() {
            // A padding slot repeats the particle before it.
            last = if id == PADDING { last } else { id as usize };
            let now = &placements[moving.shape[last] as usize];
            let place = moving.initial[last];
            let (x, v) = (now.position_of(place), now.velocity_of(place));
            for d in 0..D {
                self.position[d][slot] = x[d];
                self.velocity[d][slot] = v[d];
            }
        }
    }

    /// Largest displacement since the lists were made, m.
    pub(crate) fn displacement(&self) -> f64 {
        self.moving.as_ref().map_or(0.0, Moving::displacement)
    }

    /// When the lists of walls that move were made, s.
    pub(crate) fn listed_at(&mut self) -> Option<&mut f64> {
        self.moving.as_mut().map(|moving| &mut moving.listed_at)
    }

    /// Brings the walls that move to where they were when the lists were made.
    pub(crate) fn return_to_lists(&mut self) {
        if let Some(time) = self.listed_at().copied() {
            self.set_time(time);
        }
    }

    /// Lists who is near whom, to `reach`, m. The solid is sorted.
    pub(crate) fn relist(&mut self, solid: &Vectors<D>, reach: f64) {
        if let Some(moving) = &mut self.moving {
            moving.listed_at = moving.time;
            moving.listed = (0..moving.motions.len()).map(|shape| moving.of(shape)).collect();
            let n = moving.shape.len();
            self.id = (0..n as u32).collect();
            self.position.iter_mut().for_each(|column| column.resize(n, 0.0));
            self.velocity.iter_mut().for_each(|column| column.resize(n, 0.0));
            self.set_time(self.moving.as_ref().map_or(0.0, |moving| moving.time));
            self.sort();
            self.set_time(self.moving.as_ref().map_or(0.0, |moving| moving.time));
        }
        self.neighbours.build(solid, &self.position, &self.rows, reach);
        fit(&mut self.forces, self.neighbours.fours(), WallForce::default());
    }

    /// Pairs that the pass between walls and solid evaluates.
    pub(crate) fn pairs(&self) -> usize {
        self.neighbours.pairs()
    }

    /// Evaluates the push on every solid particle.
    pub(crate) fn act(&mut self, isa: Isa, solid: Touching<'_, D>) {
        let mut forces = std::mem::take(&mut self.forces);
        pair::pass(isa, &self.push(solid), &self.neighbours, &mut forces);
        self.forces = forces;
    }

    fn push<'a>(&'a self, solid: Touching<'a, D>) -> Push<'a, D> {
        Push {
            solid,
            position: &self.position,
            velocity: &self.velocity,
            touch: Fade::new(TOUCH * solid.spacing, solid.spacing),
            dashpot: solid.dashpot(),
        }
    }

    /// Wall particles that the solid particle at a slot touches, with the square of its distance, m².
    fn touching<'w>(
        &'w self,
        solid: Touching<'w, D>,
        slot: usize,
    ) -> impl Iterator<Item = (usize, f64)> + use<'w, D> {
        self.neighbours.of(slot).filter_map(move |j| {
            let apart = |d: usize| solid.position[d][slot] - self.position[d][j];
            let square = (0..D).map(|d| apart(d).powi(2)).sum::<f64>();
            (square < solid.spacing * solid.spacing).then_some((j, square))
        })
    }

    /// What walls add to the square of a particle's frequency, 1/s², and its damping, 1/s.
    pub(crate) fn stiffness(&self, solid: Touching<'_, D>, slot: usize) -> (f64, f64) {
        if self.acceleration(slot) == [0.0; D] {
            return (0.0, 0.0);
        }
        let count = self.touching(solid, slot).count() as f64;
        (count * solid.repulsion, count * solid.dashpot())
    }

    /// Power of walls that move on the solid's particles, in the state that was evaluated last, over a particle's mass,
    /// W/kg. `id` are the numbers of the solid's slots, `free` is the part of a particle that no clamp holds.
    pub(crate) fn power(
        &self,
        isa: Isa,
        solid: Touching<'_, D>,
        id: &[u32],
        free: impl Fn(u32) -> f64,
    ) -> f64 {
        if self.moving.is_none() {
            return 0.0;
        }
        let law = PushPower(self.push(solid));
        let mut sums = vec![Power::default(); self.neighbours.fours()];
        pair::pass(isa, &law, &self.neighbours, &mut sums);
        let real = (0..id.len()).filter(|&slot| id[slot] != PADDING);
        real.map(|slot| free(id[slot]) * sums[slot / LANES].0.0[slot % LANES]).sum()
    }

    /// Velocity of the surface that pushes the solid particle at a slot, m/s: that of its particles by their overlap.
    pub(crate) fn velocity_at(&self, solid: Touching<'_, D>, slot: usize) -> [f64; D] {
        let (mut sum, mut weights) = ([0.0; D], 0.0);
        for (j, square) in self.touching(solid, slot).filter(|(j, _)| self.id[*j] != PADDING) {
            let (overlap, belt) = (solid.spacing - square.sqrt(), self.belt[self.id[j] as usize]);
            sum = std::array::from_fn(|d| sum[d] + overlap * (self.velocity[d][j] + belt[d]));
            weights += overlap;
        }
        if weights > 0.0 { sum.map(|v| v / weights) } else { sum }
    }

    /// Acceleration of the solid particle at a slot, m/s².
    pub(crate) fn acceleration(&self, slot: usize) -> [f64; D] {
        self.forces[slot / LANES].0.map(|a| a.0[slot % LANES])
    }
}

/// The solid as walls see it: columns sorted by the rows that the lists were made with.
#[derive(Clone, Copy)]
pub(crate) struct Touching<'a, const D: usize> {
    /// m.
    pub(crate) position: &'a Vectors<D>,
    /// m/s.
    pub(crate) velocity: &'a Vectors<D>,
    /// Mean of the spacings of solid and walls, m.
    pub(crate) spacing: f64,
    /// k over a particle's mass, 1/s²: see [`repulsion`].
    pub(crate) repulsion: f64,
}

impl<const D: usize> Touching<'_, D> {
    /// c over a particle's mass, 1/s.
    fn dashpot(&self) -> f64 {
        2.0 * DAMPING_RATIO * self.repulsion.sqrt()
    }
}

/// k over a particle's mass, 1/s², for a material's pressure waves and spacing.
pub(crate) fn repulsion(pressure_wave_speed: f64, spacing: f64) -> f64 {
    0.5 * (pressure_wave_speed / spacing).powi(2)
}

/// Acceleration of several solid particles by the walls.
#[derive(Clone, Copy)]
struct WallForce<const D: usize, L = Lane>([L; D]);
pair_sum!(WallForce { D } { 0 });

/// The walls push the solid.
struct Push<'a, const D: usize> {
    solid: Touching<'a, D>,
    /// Of the wall particles, m.
    position: &'a Vectors<D>,
    /// Of the wall particles, m/s.
    velocity: &'a Vectors<D>,
    touch: Fade,
    /// c over a particle's mass, 1/s.
    dashpot: f64,
}

impl<const D: usize> PairLaw<D> for Push<'_, D> {
    /// Velocity, m/s.
    type Target<L: Lanes> = [L; D];
    type Sum<L: Lanes> = WallForce<D, L>;
    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.solid.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> [L; D] {
        std::array::from_fn(|d| L::load(&self.solid.velocity[d], slot))
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        velocity: &[L; D],
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut WallForce<D, L>,
    ) {
        let dv = std::array::from_fn(|d| velocity[d] - L::splat(self.velocity[d][j]));
        let r = distance(r2, self.solid.spacing);
        let overlap = (L::splat(self.solid.spacing) - r).max(L::ZERO);
        let approach = dot::<D, A, L>(dv, dx).min(L::ZERO) / r;
        let damping = L::splat(self.dashpot) * self.touch.at(r) * approach;
        let coefficient = (L::splat(self.solid.repulsion) * overlap - damping) / r;
        for d in 0..D {
            sum.0[d] = A::mul_add(coefficient, dx[d], sum.0[d]);
        }
    }
}

/// Power of several pushes by the walls' own velocities, over a particle's mass.
#[derive(Clone, Copy)]
struct Power<L = Lane>(L);
pair_sum!(Power {} { 0 });

/// The power of [`Push`] that comes from the walls' motion.
struct PushPower<'a, const D: usize>(Push<'a, D>);

impl<const D: usize> PairLaw<D> for PushPower<'_, D> {
    type Target<L: Lanes> = [L; D];
    type Sum<L: Lanes> = Power<L>;
    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.0.target_positions()
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> [L; D] {
        self.0.target(slot)
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.0.source_position(j)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, velocity: &[L; D], j: usize, dx: [L; D], r2: L, sum: &mut Power<L>) {
        let mut push = WallForce::default();
        self.0.add::<A, L>(velocity, j, dx, r2, &mut push);
        for d in 0..D {
            sum.0 = A::mul_add(push.0[d], L::splat(self.0.velocity[d][j]), sum.0);
        }
    }
}
