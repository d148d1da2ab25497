//! Contact: what happens beyond the reference neighbours, in the present configuration.
//!
//! Bodies are what reference neighbours of one name connect (`geometry::pieces`). Two particles of different
//! bodies repel each other as soon as they are closer than the spacing dx, which is where two surfaces meet:
//!   F_ij = k (dx - r) x_ij / r,   k = M/2 dx^(D-2),   M = K + 4 G / 3,
//! pairwise, without friction and without loss. A body does not see itself. Walls push as they push any solid
//! (see `crate::wall`). A solid that says `contact` leaves both to the coupler.

use crate::columns::{Vectors, vectors};
use crate::effects::{takes_part, touches_walls};
use crate::surface::surface_set;
use crate::wall::{Touching, Walls, repulsion};
use halfstep_scene::geometry::{self, Layout, SolidPoint};
use halfstep_scene::{EffectName, Scene, Solid};
use halfstep_sph::columns::{copy, fit, moved_farther};
use halfstep_sph::lane::{Arch, Isa, LANES, Lane, Lanes};
use halfstep_sph::neighbours::{ClusterList, Neighbours, PADDING, Rows};
use halfstep_sph::pair::{self, PairLaw, distance, pair_sum};
use halfstep_wire::order;
use halfstep_wire::state::StateError;

/// Distance, in smoothing lengths of the interface, that lists hold beyond reach.
const SKIN: f64 = 0.3;
/// Distance from the surface within which particles may touch a wall, in spacings: its two outer rows.
const OUTER: f64 = 1.1;

/// Particles that may touch something, sorted by where they are now.
pub(crate) struct Contact<const D: usize> {
    pub(super) id: Vec<u32>,
    position: Vectors<D>,
    velocity: Vectors<D>,
    body: Vec<f64>,
    /// Whether a clamp holds it, by particle number.
    clamped: Vec<bool>,
    /// Positions at the last sort.
    pub(super) listed: Vectors<D>,
    rows: Rows<D>,
    list: ClusterList,
    sums: Vec<Repulsion<D>>,
    several: bool,
    walls: Option<Walls<D>>,
    /// dx of the solid, m.
    spacing: f64,
    /// Mean of that and the walls', m.
    wall_spacing: f64,
    /// Distance that lists hold beyond reach, m.
    skin: f64,
    domain: ([f64; D], [f64; D]),
    stiffness: f64,
    mass: f64,
}

/// State of a particle, for [`Contact::act`].
pub(crate) struct Present<const D: usize> {
    pub position: [f64; D],
    pub velocity: [f64; D],
}

impl<const D: usize> Contact<D> {
    /// `None` where nothing can touch. `body` has a number for each particle's body.
    pub(crate) fn new(
        scene: &Scene,
        solid: usize,
        material: &Solid,
        layout: &Layout<D>,
        body: &[u32],
        isa: Isa,
    ) -> Option<Self> {
        let dx = scene.solid_spacing(solid);
        let skin = SKIN * scene.smoothing_ratio * scene.resolution;
        let wall_spacing = scene.interface_spacing(solid);
        let walls = touches_walls(scene, solid)
            .then(|| Walls::new(scene, &layout.wall, wall_spacing + skin, isa))
            .flatten();
        let breaks = takes_part(scene, solid, EffectName::Fracture);
        let several = !scene.leaves_bodies_to_coupler(solid) && body.iter().any(|&b| b != body[0]);
        let id = match (&walls, several) {
            (None, false) if !breaks => return None,
            // Cracks open surfaces everywhere.
            _ if breaks => (0..layout.solid.len() as u32).collect(),
            (Some(_), _) => surface_set(&layout.solid, body, OUTER * dx, dx),
            (None, _) => surface_set(&layout.solid, body, 0.1 * dx, dx),
        };
        let column = |of: &dyn Fn(&SolidPoint<D>) -> f64| -> Vec<f64> {
            id.iter().map(|&p| of(&layout.solid[p as usize])).collect()
        };
        let n = id.len();
        let domain = geometry::domain(scene);
        let modulus = material.density * material.pressure_wave_speed().powi(2);
        let mut contact = Self {
            position: std::array::from_fn(|d| column(&|p| p.position[d])),
            velocity: vectors(n),
            body: id.iter().map(|&p| f64::from(body[p as usize])).collect(),
            clamped: layout.solid.iter().map(|p| p.clamped).collect(),
            listed: vectors(0),
            rows: Rows::default(),
            list: ClusterList::new(isa),
            sums: Vec::new(),
            several,
            walls,
            spacing: dx,
            wall_spacing,
            skin,
            domain: (std::array::from_fn(|d| domain.min[d]), std::array::from_fn(|d| domain.max[d])),
            stiffness: 0.5 * modulus * dx.powi(D as i32 - 2),
            mass: material.density * dx.powi(D as i32),
            id,
        };
        contact.sort();
        Some(contact)
    }

    /// Reach of the lists of walls, m.
    fn wall_reach(&self) -> f64 {
        self.wall_spacing + self.skin
    }

    fn row_height(&self) -> f64 {
        if self.walls.is_some() { self.wall_reach() } else { self.spacing + self.skin }
    }

    /// Lists who is near whom, from the positions at the sort.
    fn list(&mut self) {
        let (reach, wall_reach) = (self.spacing + self.skin, self.wall_reach());
        if self.several {
            self.list.build(&self.listed, &self.listed, &self.rows, reach);
            fit(&mut self.sums, self.list.fours(), Repulsion::default());
        }
        if let Some(walls) = &mut self.walls {
            walls.relist(&self.listed, wall_reach);
        }
    }

    fn sort(&mut self) {
        let height = self.row_height();
        self.rows.sort(&self.position, &self.id, height, self.domain.0, self.domain.1);
        for d in 0..D {
            self.rows.permute(&mut self.position[d]);
            self.rows.permute(&mut self.velocity[d]);
        }
        self.rows.permute(&mut self.body);
        self.rows.permute_ids(&mut self.id);
        for d in 0..D {
            copy(&mut self.listed[d], &self.position[d]);
        }
        self.list();
    }

    /// The body of each particle that may touch something, by particle number.
    pub(super) fn bodies(&self) -> Vec<(u32, f64)> {
        let slots = self.id.iter().zip(&self.body).filter(|&(&id, _)| id != PADDING);
        let mut bodies: Vec<(u32, f64)> = slots.map(|(&id, &body)| (id, body)).collect();
        bodies.sort_unstable_by_key(|&(id, _)| id);
        bodies
    }

    /// Fits the columns to the order of `id` and `listed`, both as saved; `bodies` are those of the scene.
    pub(super) fn reorder(&mut self, bodies: &[(u32, f64)]) -> Result<(), StateError> {
        let n = self.id.len();
        self.body = vec![0.0; n];
        for (slot, id) in self.id.iter().enumerate().filter(|&(_, &id)| id != PADDING) {
            let place = bodies.binary_search_by_key(id, |&(id, _)| id);
            let place =
                place.map_err(|_| StateError::contradiction("a contact of a particle that has none"))?;
            self.body[slot] = bodies[place].1;
        }
        let wrong = "contacts of other particles than the scene's";
        let among = bodies.last().map_or(0, |&(id, _)| id as usize + 1);
        if order::count(&self.id, among, wrong)? != bodies.len() || !n.is_multiple_of(LANES) {
            return Err(StateError::contradiction(wrong));
        }
        self.position = self.listed.clone();
        self.velocity = vectors(n);
        Ok(())
    }

    /// Rows and lists as they were at the last sort.
    pub(super) fn list_at_sort(&mut self) -> Result<(), StateError> {
        let (height, domain) = (self.row_height(), self.domain);
        order::sort_again(&mut self.rows, &self.listed, &self.id, height, domain, "the rows of contacts")?;
        if let Some(walls) = &mut self.walls {
            walls.return_to_lists();
        }
        self.list();
        Ok(())
    }

    /// There is something to touch.
    pub(super) fn acts(&self) -> bool {
        self.several || self.walls.is_some()
    }

    /// The bodies are these from now on, by particle number, and they are several.
    pub(super) fn divide(&mut self, bodies: &[u32]) {
        for (body, &id) in self.body.iter_mut().zip(&self.id).filter(|(_, id)| **id != PADDING) {
            *body = f64::from(bodies[id as usize]);
        }
        self.several = true;
        self.list();
    }

    /// There are contacts between bodies.
    pub(super) fn between_bodies(&self) -> bool {
        self.several
    }

    /// The walls, for leaving them out for a while.
    pub(super) fn walls(&mut self) -> &mut Option<Walls<D>> {
        &mut self.walls
    }

    /// Brings walls that move to where they are at a time, s.
    pub(crate) fn set_time(&mut self, time: f64) {
        if let Some(walls) = &mut self.walls {
            walls.set_time(time);
        }
    }

    /// Takes over the present state.
    pub(crate) fn update(&mut self, present: impl Fn(u32) -> Present<D>) {
        for slot in 0..self.id.len() {
            if self.id[slot] != PADDING {
                let p = present(self.id[slot]);
                for d in 0..D {
                    self.position[d][slot] = p.position[d];
                    self.velocity[d][slot] = p.velocity[d];
                }
            }
        }
        let margin = 0.5 * self.skin;
        let walls_moved = self.walls.as_ref().is_some_and(|walls| walls.displacement() > margin);
        if walls_moved || moved_farther(&self.position, &self.listed, &self.id, margin) {
            self.sort();
        }
    }

    /// Evaluates all contacts of the state last taken over.
    pub(crate) fn act(&mut self, isa: Isa, solid: &Solid) {
        if self.several {
            let law = Repel { position: &self.position, body: &self.body, spacing: self.spacing };
            pair::pass(isa, &law, &self.list, &mut self.sums);
        }
        if let Some(mut walls) = self.walls.take() {
            walls.act(isa, self.touching_solid(solid));
            self.walls = Some(walls);
        }
    }

    /// The particles as walls see them.
    fn touching_solid(&self, solid: &Solid) -> Touching<'_, D> {
        Touching {
            position: &self.position,
            velocity: &self.velocity,
            spacing: self.wall_spacing,
            repulsion: repulsion(solid.pressure_wave_speed(), self.spacing),
        }
    }

    /// Calls `add` with each particle's number and its acceleration by contacts, m/s².
    pub(crate) fn accelerations(&self, mut add: impl FnMut(u32, [f64; D])) {
        for slot in (0..self.id.len()).filter(|&s| self.id[s] != PADDING) {
            let mut a = self.by_bodies(slot);
            if let Some(walls) = &self.walls {
                let push = walls.acceleration(slot);
                a = std::array::from_fn(|d| a[d] + push[d]);
            }
            add(self.id[slot], a);
        }
    }

    /// Calls `give` with each particle's number and the force of contacts on it, N (2D: N/m).
    pub(crate) fn forces(&self, mut give: impl FnMut(u32, [f64; D])) {
        self.accelerations(|id, a| give(id, a.map(|a| self.mass * a)));
    }

    /// Acceleration of the particle at a slot by other bodies, m/s².
    fn by_bodies(&self, slot: usize) -> [f64; D] {
        if !self.several {
            return [0.0; D];
        }
        self.sums[slot / LANES].force.map(|f| f.0[slot % LANES] * self.stiffness / self.mass)
    }

    /// Calls `add` with each particle's number and its acceleration by other bodies, m/s².
    pub(crate) fn body_accelerations(&self, mut add: impl FnMut(u32, [f64; D])) {
        for slot in (0..self.id.len()).filter(|&s| self.id[s] != PADDING) {
            add(self.id[slot], self.by_bodies(slot));
        }
    }

    /// Calls `add` with each particle's number and its acceleration by walls, m/s².
    pub(crate) fn wall_accelerations(&self, mut add: impl FnMut(u32, [f64; D])) {
        let Some(walls) = &self.walls else { return };
        for slot in (0..self.id.len()).filter(|&s| self.id[s] != PADDING) {
            add(self.id[slot], walls.acceleration(slot));
        }
    }

    /// Power of walls that move on the solid, over a particle's mass, W/kg; `free` is the part of a particle that no
    /// clamp holds.
    pub(crate) fn power_of_walls(&self, isa: Isa, solid: &Solid, free: impl Fn(u32) -> f64) -> f64 {
        let power = |walls: &Walls<D>| walls.power(isa, self.touching_solid(solid), &self.id, free);
        self.walls.as_ref().map_or(0.0, power)
    }

    /// What contacts add to the square of a particle's highest frequency, 1/s², and its damping by walls, 1/s: the
    /// largest of any particle in the state that was evaluated last.
    pub(crate) fn stiffness(&self, solid: &Solid) -> (f64, f64) {
        let (mut springs, mut damping) = (0.0_f64, 0.0_f64);
        let free = |slot: &usize| self.id[*slot] != PADDING && !self.held(*slot);
        for slot in (0..self.id.len()).filter(free) {
            let bodies = self.stiffness / self.mass * self.touched(slot) as f64;
            let walls = self.walls.as_ref();
            let (spring, viscous) =
                walls.map_or((0.0, 0.0), |walls| walls.stiffness(self.touching_solid(solid), slot));
            springs = springs.max(bodies + spring);
            damping = damping.max(viscous);
        }
        (springs, damping)
    }

    /// A clamp holds the particle at a slot.
    fn held(&self, slot: usize) -> bool {
        self.clamped.get(self.id[slot] as usize).copied().unwrap_or(false)
    }

    /// Number of particles of other bodies that push a particle; those that give way count twice.
    fn touched(&self, slot: usize) -> usize {
        self.pushing(slot).map(|(j, ..)| 2 - usize::from(self.held(j))).sum()
    }

    /// Particles of other bodies that push the one at a slot: slot, x_ij and its square.
    fn pushing(&self, slot: usize) -> impl Iterator<Item = (usize, [f64; D], f64)> {
        let pushed = self.several && self.sums[slot / LANES].square.0[slot % LANES] != 0.0;
        let near = if pushed { self.list.of(slot) } else { Neighbours::NONE };
        near.filter_map(move |j| {
            let apart: [f64; D] = std::array::from_fn(|d| self.position[d][slot] - self.position[d][j]);
            let square: f64 = apart.iter().map(|x| x.powi(2)).sum();
            let pushes = self.body[j] != self.body[slot] && square < self.spacing * self.spacing;
            pushes.then_some((j, apart, square))
        })
    }

    /// Calls `visit` with particles of two bodies that push each other, the lower number first, their x_ij / r, and the
    /// acceleration that either gets, m/s².
    pub(super) fn touching(&self, mut visit: impl FnMut([u32; 2], [f64; D], f64)) {
        for slot in (0..self.id.len()).filter(|&slot| self.id[slot] != PADDING) {
            for (j, apart, square) in self.pushing(slot) {
                if self.id[slot] < self.id[j] && self.id[j] != PADDING && square > 0.0 {
                    let r = square.sqrt();
                    let push = (self.spacing - r) * self.stiffness / self.mass;
                    visit([self.id[slot], self.id[j]], apart.map(|x| x / r), push);
                }
            }
        }
    }

    /// Calls `visit` with particles that walls push, the acceleration, m/s², and the velocity of the surface, m/s.
    pub(super) fn touching_walls(&self, solid: &Solid, mut visit: impl FnMut(u32, [f64; D], [f64; D])) {
        let Some(walls) = &self.walls else { return };
        for slot in (0..self.id.len()).filter(|&s| self.id[s] != PADDING) {
            let push = walls.acceleration(slot);
            if push != [0.0; D] {
                visit(self.id[slot], push, walls.velocity_at(self.touching_solid(solid), slot));
            }
        }
    }

    /// Energy in the contacts between bodies, J.
    pub(crate) fn energy(&self) -> f64 {
        let slots = (0..self.id.len()).filter(|&s| self.several && self.id[s] != PADDING);
        // Half of each pair's energy, k (dx - r)² / 2, belongs to either particle.
        slots.map(|s| 0.25 * self.stiffness * self.sums[s / LANES].square.0[s % LANES]).sum()
    }
}

/// Sums over particles of other bodies for several particles, to be multiplied by k.
#[derive(Clone, Copy)]
struct Repulsion<const D: usize, L = Lane> {
    force: [L; D],
    /// sum (dx - r)².
    square: L,
}

pair_sum!(Repulsion { D } { force, square });

struct Repel<'a, const D: usize> {
    position: &'a Vectors<D>,
    body: &'a [f64],
    spacing: f64,
}

impl<const D: usize> PairLaw<D> for Repel<'_, D> {
    type Target<L: Lanes> = L;
    type Sum<L: Lanes> = Repulsion<D, L>;
    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.position
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.position[d][j])
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> L {
        L::load(self.body, slot)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, body: &L, j: usize, dx: [L; D], r2: L, sum: &mut Repulsion<D, L>) {
        let r = distance(r2, self.spacing);
        // Body numbers are whole: 1 between different bodies, else 0.
        let other = *body - L::splat(self.body[j]);
        let other = other.max(-other).min(L::splat(1.0));
        let overlap = (L::splat(self.spacing) - r).max(L::ZERO) * other;
        sum.square = A::mul_add(overlap, overlap, sum.square);
        let force = overlap / r;
        for d in 0..D {
            sum.force[d] = A::mul_add(force, dx[d], sum.force[d]);
        }
    }
}
