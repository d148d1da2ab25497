//! Rigid walls toward the solid. As bodies do (see `crate::kernel_sum`), their particles push one of the solid by its
//! depth, and what approaches is damped as soon as surfaces overlap:
//!   F_i = -[k delta_i + c w(delta_i) max(d delta_i / dt, 0)] grad_i delta_i,   k = (K + 4 G / 3) / 2 dx^(D-2),
//!   c = 2 zeta sqrt(k m_s), w = 0 at the surface, 1 from a quarter of the distance d on, a straight line between.
//! What begins in a wall is pushed from where it is, and once it has left, from the wall's surface on.
//!
//! Kayaki's section 4.1 extrapolates the solid's pressure to its walls, after Adami. Here a wall has none: such a push
//! follows from no energy, begins 2h off the wall and pushes a body up that lies on it.

use crate::columns::{Vectors, vectors};
use crate::kernel_sum::KernelSum;
use halfstep_scene::geometry::WallPoint;
use halfstep_scene::{Motion, Placement, Scene};
use halfstep_sph::columns::{bounds, fit};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Isa, LANES, Lane, Lanes};
use halfstep_sph::neighbours::{ClusterList, PADDING, Rows};
use halfstep_sph::pair::{self, PairLaw, distance, dot, pair_sum};
use halfstep_wire::state::{Fields, StateError};

/// zeta. A disc of rubber, 20 particles across, loses 0.3 % of its energy by it.
const DAMPING_RATIO: f64 = 0.2;
/// Depth from which on the whole damping acts, over d.
const TOUCH: f64 = 0.25;

/// Part of S at a surface below which a particle has left it.
const LEFT: f64 = 0.5;

/// Wall particles that the solid may touch.
pub(crate) struct Walls<const D: usize> {
    id: Vec<u32>,
    position: Vectors<D>,
    velocity: Vectors<D>,
    /// Of the surface beside that, by number of the wall particle, m/s.
    belt: Vec<[f64; D]>,
    rows: Rows<D>,
    law: KernelSum<D>,
    /// Distance that lists hold beyond its radius, m.
    skin: f64,
    moving: Option<Moving<D>>,
    /// The solid's wall neighbours.
    neighbours: ClusterList,
    sums: Vec<WallSum<D>>,
    /// Force over mass and grad S, by the solid's slots.
    push: Vec<f64>,
    /// S from which on a particle of the solid is pushed, by its number.
    rest: Vec<f64>,
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
    /// `None` where the scene's solid of that index may touch none of the walls. Lists hold `skin`, m, more than
    /// needed.
    pub(crate) fn new(
        scene: &Scene,
        solid: usize,
        points: &[WallPoint<D>],
        skin: f64,
        isa: Isa,
    ) -> Option<Self> {
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
            law: KernelSum::new(scene.solid_spacing(solid), scene.resolution),
            skin,
            moving: Moving::new(&points, scene),
            neighbours: ClusterList::new(isa),
            sums: Vec::new(),
            push: Vec::new(),
            rest: Vec::new(),
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
        self.rows.sort(&self.position, &self.id, self.reach(), low, high);
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

    /// Brings the walls that move to where they were when the lists were made.
    pub(crate) fn return_to_lists(&mut self) {
        if let Some(time) = self.moving.as_ref().map(|moving| moving.listed_at) {
            self.set_time(time);
        }
    }

    /// Distance that lists hold, m.
    pub(crate) fn reach(&self) -> f64 {
        self.law.radius + self.skin
    }

    /// Lists who is near whom. The solid is sorted.
    pub(crate) fn relist(&mut self, solid: &Vectors<D>) {
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
        self.neighbours.build(solid, &self.position, &self.rows, self.reach());
        fit(&mut self.sums, self.neighbours.fours(), WallSum::default());
        fit(&mut self.push, solid[0].len(), 0.0);
    }

    /// Pairs that the pass between walls and solid evaluates.
    pub(crate) fn pairs(&self) -> usize {
        self.neighbours.pairs()
    }

    /// The solid begins where it is: nothing pushes.
    pub(crate) fn begin(&mut self, isa: Isa, solid: Touching<'_, D>) {
        let real = || (0..solid.id.len()).filter(|&slot| solid.id[slot] != PADDING);
        self.rest = vec![self.law.level; real().map(|slot| solid.id[slot] as usize + 1).max().unwrap_or(0)];
        self.sum_up(isa, solid);
        for slot in real() {
            let (sum, rest) = (self.sum(slot), &mut self.rest[solid.id[slot] as usize]);
            *rest = rest.max(sum);
        }
    }

    fn sum_up(&mut self, isa: Isa, solid: Touching<'_, D>) {
        let mut sums = std::mem::take(&mut self.sums);
        let law = Presence { law: &self.law, solid, position: &self.position, velocity: &self.velocity };
        pair::pass(isa, &law, &self.neighbours, &mut sums);
        self.sums = sums;
    }

    /// Evaluates the push on every solid particle.
    pub(crate) fn act(&mut self, isa: Isa, solid: Touching<'_, D>) {
        self.sum_up(isa, solid);
        for slot in 0..solid.id.len() {
            let depth = match solid.id[slot] {
                PADDING => 0.0,
                id => self.law.depth(self.sum(slot), self.rest[id as usize]),
            };
            self.push[slot] = if depth > 0.0 {
                let gradient = self.gradient(slot);
                let own: f64 = (0..D).map(|d| solid.velocity[d][slot] * gradient[d]).sum();
                let approach = ((own + self.carried(slot)) / self.law.slope).max(0.0);
                let touch = (depth / (TOUCH * self.law.distance)).min(1.0);
                (solid.repulsion * depth + solid.dashpot() * touch * approach) / self.law.slope
            } else {
                0.0
            };
        }
    }

    /// What has left a wall in the state that was evaluated last touches its surface from now on. What slides along
    /// one wall out of a corner of two has not.
    pub(crate) fn leave(&mut self, id: &[u32]) {
        for (slot, &id) in id.iter().enumerate().filter(|&(_, &id)| id != PADDING) {
            if self.rest[id as usize] > self.law.level && self.sum(slot) < LEFT * self.law.level {
                self.rest[id as usize] = self.law.level;
            }
        }
    }

    /// S of the solid particle at a slot.
    fn sum(&self, slot: usize) -> f64 {
        self.sums[slot / LANES].sum.0[slot % LANES]
    }

    fn gradient(&self, slot: usize) -> [f64; D] {
        self.sums[slot / LANES].gradient.map(|g| g.0[slot % LANES])
    }

    fn carried(&self, slot: usize) -> f64 {
        self.sums[slot / LANES].carried.0[slot % LANES]
    }

    /// Wall particles that the solid particle at a slot sees, with their distance, m.
    fn seen<'w>(
        &'w self,
        solid: Touching<'w, D>,
        slot: usize,
    ) -> impl Iterator<Item = (usize, f64)> + use<'w, D> {
        self.neighbours.of(slot).filter_map(move |j| {
            let apart = |d: usize| solid.position[d][slot] - self.position[d][j];
            let r = (0..D).map(|d| apart(d).powi(2)).sum::<f64>().sqrt();
            (r < self.law.radius).then_some((j, r))
        })
    }

    /// What walls add to the square of a particle's frequency, 1/s², and its damping, 1/s.
    pub(crate) fn stiffness(&self, solid: Touching<'_, D>, slot: usize) -> (f64, f64) {
        if self.push[slot] == 0.0 {
            return (0.0, 0.0);
        }
        let slope = self.gradient(slot).iter().map(|g| g * g).sum::<f64>() / self.law.slope.powi(2);
        let curvature: f64 = self.seen(solid, slot).map(|(_, r)| self.law.curvature(r)).sum();
        (solid.repulsion * slope + self.push[slot] * self.law.slope * curvature, solid.dashpot() * slope)
    }

    /// Power of walls that move on the solid's particles, in the state that was evaluated last, over a particle's mass,
    /// W/kg. `id` are the numbers of the solid's slots, `free` is the part of a particle that no clamp holds.
    pub(crate) fn power(&self, id: &[u32], free: impl Fn(u32) -> f64) -> f64 {
        if self.moving.is_none() {
            return 0.0;
        }
        let pushed = (0..id.len()).filter(|&slot| self.push[slot] > 0.0);
        pushed.map(|slot| free(id[slot]) * self.push[slot] * self.carried(slot)).sum()
    }

    /// Velocity of the surface that pushes the solid particle at a slot, m/s: that of its particles, by their kernels.
    pub(crate) fn velocity_at(&self, solid: Touching<'_, D>, slot: usize) -> [f64; D] {
        let (mut sum, mut weights) = ([0.0; D], 0.0);
        for (j, r) in self.seen(solid, slot) {
            let (weight, belt) = (self.law.kernel.at(r), self.belt[self.id[j] as usize]);
            sum = std::array::from_fn(|d| sum[d] + weight * (self.velocity[d][j] + belt[d]));
            weights += weight;
        }
        if weights > 0.0 { sum.map(|v| v / weights) } else { sum }
    }

    /// Visits what walls keep over an interruption.
    pub(crate) fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        if let Some(moving) = &mut self.moving {
            fields.real("walls_listed_at", &mut moving.listed_at)?;
        }
        let particles = self.rest.len();
        fields.reals("walls_rest", &mut self.rest)?;
        fields.length("walls_rest", particles, self.rest.len())
    }

    /// Acceleration of the solid particle at a slot, m/s².
    pub(crate) fn acceleration(&self, slot: usize) -> [f64; D] {
        match self.push[slot] {
            0.0 => [0.0; D],
            push => self.gradient(slot).map(|g| -push * g),
        }
    }
}

/// The solid as walls see it: columns sorted by the rows that the lists were made with.
#[derive(Clone, Copy)]
pub(crate) struct Touching<'a, const D: usize> {
    /// Particle number of a slot, or padding.
    pub(crate) id: &'a [u32],
    /// m.
    pub(crate) position: &'a Vectors<D>,
    /// m/s.
    pub(crate) velocity: &'a Vectors<D>,
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

/// Sums over walls for several solid particles.
#[derive(Clone, Copy)]
struct WallSum<const D: usize, L = Lane> {
    /// S.
    sum: L,
    /// grad S.
    gradient: [L; D],
    /// Rate of S by the motion of walls.
    carried: L,
}
pair_sum!(WallSum { D } { sum, gradient, carried });

/// Solid particles see walls.
struct Presence<'a, const D: usize> {
    law: &'a KernelSum<D>,
    solid: Touching<'a, D>,
    /// Of the wall particles, m.
    position: &'a Vectors<D>,
    /// Of the wall particles, m/s.
    velocity: &'a Vectors<D>,
}

impl<const D: usize> PairLaw<D> for Presence<'_, D> {
    type Target<L: Lanes> = ();
    type Sum<L: Lanes> = WallSum<D, L>;
    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.solid.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, (): &(), j: usize, dx: [L; D], r2: L, sum: &mut WallSum<D, L>) {
        let r = distance(r2, self.law.radius);
        sum.sum += self.law.kernel.value::<A, L>(r);
        let slope = self.law.kernel.gradient_over_r::<A, L>(r);
        for d in 0..D {
            sum.gradient[d] = A::mul_add(slope, dx[d], sum.gradient[d]);
        }
        let velocity = std::array::from_fn(|d| L::splat(self.velocity[d][j]));
        sum.carried = A::mul_add(-slope, dot::<D, A, L>(velocity, dx), sum.carried);
    }
}
