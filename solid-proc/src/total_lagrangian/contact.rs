//! Contact: what happens beyond the reference neighbours, in the present configuration.
//!
//! Bodies are what reference neighbours of one name connect (`geometry::pieces`). Bodies, and the two sides of a cut,
//! push each other by springs without friction and loss ([`bodies`]); walls push as they push any solid (see
//! `crate::wall`). A solid that says `contact` leaves both to the coupler.

mod bodies;
#[cfg(test)]
mod tests;

use crate::columns::{Vectors, vectors};
use crate::effects::{takes_part, touches_walls};
use crate::surface::surface_set;
use crate::wall::{Touching, Walls, repulsion};
use bodies::{Bodies, Slots};
use halfstep_scene::geometry::{self, Layout, SolidPoint};
use halfstep_scene::{EffectName, Scene, Solid};
use halfstep_sph::columns::{copy, moved_farther};
use halfstep_sph::lane::{Isa, LANES};
use halfstep_sph::neighbours::{ClusterList, PADDING, Rows};
use halfstep_wire::order;
use halfstep_wire::state::{Fields, StateError};

/// Distance, in smoothing lengths of the interface, that lists hold beyond reach.
const SKIN: f64 = 0.3;
/// Distance from the surface within which particles may touch something, in spacings: its two outer rows.
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
    bodies: Bodies<D>,
    several: bool,
    walls: Option<Walls<D>>,
    /// dx of the solid, m.
    spacing: f64,
    /// Distance that lists hold beyond reach, m.
    skin: f64,
    domain: ([f64; D], [f64; D]),
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
        let walls = touches_walls(scene, solid).then(|| Walls::new(scene, solid, skin)).flatten();
        let breaks = takes_part(scene, solid, EffectName::Fracture);
        let several = !scene.leaves_bodies_to_coupler(solid) && body.iter().any(|&b| b != body[0]);
        let id = match (&walls, several) {
            (None, false) if !breaks => return None,
            // Cracks open surfaces everywhere.
            _ if breaks => (0..layout.solid.len() as u32).collect(),
            _ => surface_set(&layout.solid, body, OUTER * dx, dx),
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
            bodies: Bodies::new(layout.solid.len(), dx, 0.25 * modulus * dx.powi(D as i32 - 2)),
            several,
            walls,
            spacing: dx,
            skin,
            domain: (std::array::from_fn(|d| domain.min[d]), std::array::from_fn(|d| domain.max[d])),
            mass: material.density * dx.powi(D as i32),
            id,
        };
        contact.sort();
        contact.begin(isa, material);
        Some(contact)
    }

    /// Nothing pushes at the start.
    fn begin(&mut self, isa: Isa, material: &Solid) {
        let before = self.bodies.sums();
        self.look(isa);
        self.bodies.rest_since(&before);
        if let Some(mut walls) = self.walls.take() {
            walls.begin(self.touching_solid(material));
            self.walls = Some(walls);
        }
    }

    /// The particles as bodies see them.
    fn slots(&self) -> Slots<'_, D> {
        Slots {
            id: &self.id,
            position: &self.position,
            body: &self.body,
            list: self.several.then_some(&self.list),
        }
    }

    /// Looks who is near whom now.
    fn look(&mut self, isa: Isa) {
        let Self { id, position, body, list, several, bodies, .. } = self;
        bodies.look(isa, Slots { id, position, body, list: several.then_some(&*list) });
    }

    fn row_height(&self) -> f64 {
        self.bodies.radius() + self.skin
    }

    /// Lists who is near whom, from the positions at the sort.
    fn list(&mut self) {
        if self.several {
            self.list.build(&self.listed, &self.listed, &self.rows, self.bodies.radius() + self.skin);
        }
        let Self { id, position, body, list, several, bodies, .. } = self;
        bodies.fit(Slots { id, position, body, list: several.then_some(&*list) });
        if let Some(walls) = &mut self.walls {
            walls.relist(&self.id, &self.listed);
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

    /// The bodies are these from now on, by particle number, and pairs of one body are cut, in the present state: that
    /// pushes nothing.
    pub(super) fn divide(
        &mut self,
        isa: Isa,
        bodies: &[u32],
        cuts: impl Iterator<Item = [u32; 2]>,
        present: impl Fn(u32) -> Present<D>,
    ) {
        let before = self.bodies.sums();
        for (body, &id) in self.body.iter_mut().zip(&self.id).filter(|(_, id)| **id != PADDING) {
            *body = f64::from(bodies[id as usize]);
        }
        self.several = bodies.iter().any(|&body| body != bodies[0]);
        self.bodies.cut(cuts);
        self.list();
        self.update(present);
        self.look(isa);
        self.bodies.rest_since(&before);
    }

    /// What has left a surface in the state that was evaluated last, and is not taken back, touches it from now on
    /// where surfaces meet.
    pub(crate) fn leave(&mut self) {
        self.bodies.leave();
        if let Some(walls) = &mut self.walls {
            walls.leave();
        }
    }

    /// There are contacts between bodies, or within one.
    pub(super) fn between_bodies(&self) -> bool {
        self.several || self.bodies.has_cuts()
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
        if self.between_bodies() {
            self.look(isa);
            let Self { id, position, body, list, several, bodies, .. } = self;
            bodies.push(isa, Slots { id, position, body, list: several.then_some(&*list) });
        }
        if let Some(mut walls) = self.walls.take() {
            walls.act(self.touching_solid(solid));
            self.walls = Some(walls);
        }
    }

    /// The particles as walls see them.
    fn touching_solid(&self, solid: &Solid) -> Touching<'_, D> {
        Touching {
            id: &self.id,
            position: &self.position,
            velocity: &self.velocity,
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
        self.bodies.force_at(slot).map(|force| force / self.mass)
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
    pub(crate) fn power_of_walls(&self, free: impl Fn(u32) -> f64) -> f64 {
        self.walls.as_ref().map_or(0.0, |walls| walls.power(&self.id, free))
    }

    /// What contacts add to the square of a particle's highest frequency, 1/s², and its damping by walls, 1/s: the
    /// largest of any particle in the state that was evaluated last.
    pub(crate) fn stiffness(&self, solid: &Solid) -> (f64, f64) {
        let bodies = match self.between_bodies() {
            true => self.bodies.largest_stiffness(self.slots(), |slot| self.held(slot)) / self.mass,
            false => 0.0,
        };
        let (mut springs, mut damping) = (0.0_f64, 0.0_f64);
        if let Some(walls) = &self.walls {
            for slot in (0..self.id.len()).filter(|&slot| self.id[slot] != PADDING && !self.held(slot)) {
                let (spring, viscous) = walls.stiffness(self.touching_solid(solid), slot);
                (springs, damping) = (springs.max(spring), damping.max(viscous));
            }
        }
        (bodies + springs, damping)
    }

    /// A clamp holds the particle at a slot.
    fn held(&self, slot: usize) -> bool {
        self.clamped.get(self.id[slot] as usize).copied().unwrap_or(false)
    }

    /// Calls `visit` with particles that push each other, the normal of the surface between them toward the first one,
    /// and the acceleration along that, m/s².
    pub(super) fn touching(&self, mut visit: impl FnMut([u32; 2], [f64; D], f64)) {
        if self.between_bodies() {
            self.bodies.touching(self.slots(), |pair, normal, force| {
                visit(pair.map(|slot| self.id[slot]), normal, force / self.mass);
            });
        }
    }

    /// Calls `visit` with particles that walls push, the normal out of the wall, the acceleration along that, m/s²,
    /// and the velocity of the surface, m/s.
    pub(super) fn touching_walls(&self, mut visit: impl FnMut(u32, [f64; D], f64, [f64; D])) {
        if let Some(walls) = &self.walls {
            walls.touching(|slot, normal, push, velocity| visit(self.id[slot], normal, push, velocity));
        }
    }

    /// Energy in the contacts between bodies, J (2D: J/m).
    pub(crate) fn energy(&self) -> f64 {
        self.bodies.energy()
    }

    /// Visits what bodies and walls keep over an interruption, but for the order.
    pub(super) fn rest_fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let rest = self.bodies.rest();
        let particles = rest.len();
        fields.reals("rest", rest)?;
        fields.length("rest", particles, rest.len())?;
        self.walls.as_mut().map_or(Ok(()), |walls| walls.fields(fields))
    }
}
