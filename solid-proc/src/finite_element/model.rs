//! The model behind [`SolidModel`]: nodes in time.
//!
//! Lumped mass and velocity Verlet (kick, drift, kick), as of the total-Lagrangian particles: the central difference of
//! explicit finite elements (Belytschko, Liu, Moran and Elkhodary 2014, section 6.2); or implicit steps.

mod build;

use super::element::Element;
use super::equations::Equations;
use super::mesh::Mesh;
use super::stress::Stressed;
use crate::account::Account;
use crate::columns::{ParticleColumns, Vectors};
use crate::model::{Load, OutOfBounds, Particles, SolidModel};
use crate::shown_velocity::ShownVelocity;
use crate::side_friction;
use crate::total_lagrangian::bounds::{VolumeBounds, keep_worse, refuse_worst};
use crate::total_lagrangian::contact::{Contact, Present};
use crate::total_lagrangian::material::{Law, Matrix};
use crate::total_lagrangian::step_limit::{squared_stretches, sub_step};
use crate::verlet::Kinematics;
use halfstep_role::timeline;
use halfstep_scene::bounds::Excess;
use halfstep_scene::geometry::SolidPoint;
use halfstep_scene::{EnergyPart, Motion, Solid};
use halfstep_sph::lane::Isa;
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::wide;

/// The finite-element solid.
pub struct FiniteElement<const D: usize> {
    pub(super) material: Solid,
    pub(super) law: Law,
    pub(super) element: Element<D>,
    pub(super) mesh: Mesh<D>,
    /// K of the patterns without a gradient.
    pub(super) hourglass: f64,
    /// Viscosity, Pa s.
    pub(super) viscosity: f64,
    /// Deceleration by side friction, m/s².
    side_friction: Option<f64>,
    pub(super) isa: Isa,
    pub(super) spacing: f64,
    pub(super) gravity: [f64; D],
    courant: f64,
    /// Of a particle, kg (2D: kg/m).
    pub(super) mass: f64,
    points: Vec<SolidPoint<D>>,
    shown: ParticleColumns<D>,
    interface_set: Vec<u32>,
    /// Nodes of clamped particles.
    pub(super) clamped: Vec<bool>,
    /// Of these, those that clamps move, and how.
    pub(super) driven: Vec<(usize, Motion)>,
    /// Of the nodes.
    pub(super) now: Kinematics<D>,
    at_n: Kinematics<D>,
    pub(super) shown_velocity: ShownVelocity<D>,
    /// Loads and gravity, m/s².
    pub(super) load: Vectors<D>,
    /// Inner acceleration of all nodes, also of those that clamps hold, m/s².
    pub(super) inner: Vectors<D>,
    /// F.
    pub(super) gradient: Vec<Matrix<D>>,
    /// J.
    pub(super) volume_ratio: Vec<f64>,
    pub(super) contact: Option<Contact<D>>,
    bounds: VolumeBounds,
    /// The particle whose volume left its bounds first, or of several the one farthest out.
    pub(super) failure: Option<(u32, Excess)>,
    pub(super) evaluations: u64,
    pub(super) account: Option<Account<D>>,
    /// Of implicit time integration.
    equations: Option<Equations<D>>,
    /// There is no fluid, whose time step it could take.
    alone: bool,
}

impl<const D: usize> FiniteElement<D> {
    /// Present position of a particle, m.
    fn position(&self, particle: usize) -> [f64; D] {
        let moved = self.mesh.mean(particle, &self.now.displacement);
        std::array::from_fn(|d| self.points[particle].position[d] + moved[d])
    }

    fn take_load(&mut self, load: &Load<D>) {
        for d in 0..D {
            self.load[d].fill(0.0);
        }
        for (p, force) in load.force.iter().enumerate() {
            for &node in self.mesh.of(p) {
                let node = node as usize;
                let part = 1.0 / (Mesh::<D>::CORNERS as f64 * self.mass * self.mesh.share(node));
                for d in 0..D {
                    self.load[d][node] += force[d] * part;
                }
            }
        }
        for d in 0..D {
            self.load[d].iter_mut().for_each(|load| *load += self.gravity[d]);
        }
    }

    fn kick(&mut self, dt: f64) {
        for d in 0..D {
            let rates = self.now.acceleration[d].iter().zip(&self.load[d]).zip(&self.clamped);
            for (v, ((inner, load), held)) in self.now.velocity[d].iter_mut().zip(rates) {
                if !held {
                    *v += dt * (inner + load);
                }
            }
        }
        self.rub(dt);
    }

    /// Slows by side friction.
    pub(super) fn rub(&mut self, dt: f64) {
        if let Some(friction) = self.side_friction {
            let before = self.accounted_kinetic_energy();
            let clamped = &self.clamped;
            side_friction::slow(&mut self.now.velocity, dt * friction, |node| !clamped[node]);
            if let (Some(before), Some(after)) = (before, self.accounted_kinetic_energy())
                && let Some(account) = &mut self.account
            {
                account.given.give(EnergyPart::SideFriction, after - before);
            }
        }
    }

    /// Brings what clamps move to where they are at a time, s.
    pub(super) fn drive(&mut self, time: f64) {
        let reference = &self.mesh.reference;
        self.now.drive(&self.driven, time, |node| reference[node]);
    }

    /// `count` steps over `dt` from `time` on, both s.
    fn go_on(&mut self, count: u32, dt: f64, time: f64) {
        match self.equations.take() {
            Some(mut equations) => {
                self.implicit_steps(&mut equations, count, dt, time);
                self.equations = Some(equations);
            }
            None => self.sub_step(count, dt, time),
        }
    }

    /// `count` Verlet steps over `dt` from `time` on, both s.
    fn sub_step(&mut self, count: u32, dt: f64, time: f64) {
        let each = dt / f64::from(count);
        for k in 1..=count {
            let _phase = timeline::phase("sub-step");
            if let Some(contact) = &mut self.contact {
                contact.set_time(time + f64::from(k) * each);
            }
            self.kick(0.5 * each);
            let driven = self.driven_from();
            self.now.drift(each);
            self.drive(time + f64::from(k) * each);
            self.evaluate();
            self.note_sub_step(each, &driven);
            self.kick(0.5 * each);
        }
    }

    /// The stable Verlet step, s; springs, 1/s², and walls, 1/s, are those of contacts.
    fn explicit_step(&self, springs: f64, walls: f64) -> f64 {
        let stiffness = |(f, &j): (&Matrix<D>, &f64)| self.law.stiffness(f, j, squared_stretches(f));
        let stiffest = self.gradient.iter().zip(&self.volume_ratio).map(stiffness).fold(0.0, f64::max);
        let square = 4.0 * D as f64 / (self.material.density * self.spacing.powi(2));
        let omega = (square * stiffest + springs).sqrt();
        let damping = 0.5 * (square * 2.0 * self.viscosity + walls);
        sub_step(omega, damping)
    }

    /// Inner acceleration of the present state: stresses, patterns, contacts.
    pub(super) fn evaluate(&mut self) {
        self.inner.iter_mut().for_each(|column| column.fill(0.0));
        let mut worst: Option<(u32, Excess)> = None;
        for p in 0..self.points.len() {
            let Stressed { gradient, volume_ratio, stress, on_patterns } =
                self.stressed(p, &self.now.displacement, &self.now.velocity);
            keep_worse(&mut worst, p as u32, self.bounds.excess(volume_ratio, 0.0));
            (self.gradient[p], self.volume_ratio[p]) = (gradient, volume_ratio);
            for (corner, &node) in self.mesh.of(p).iter().enumerate() {
                let node = node as usize;
                let force = self.element.force(corner, &stress, &on_patterns);
                let part = 1.0 / (self.mass * self.mesh.share(node));
                (0..D).for_each(|d| self.inner[d][node] += force[d] * part);
            }
        }
        self.evaluations += self.points.len() as u64;
        self.failure = self.failure.or(worst);
        if let Some(mut contact) = self.contact.take() {
            self.touch(&mut contact);
            contact.accelerations(|id, a| add_to_nodes(&self.mesh, &mut self.inner, id, a));
            self.contact = Some(contact);
        }
        for d in 0..D {
            let of = self.inner[d].iter().zip(&self.clamped).map(|(a, held)| if *held { 0.0 } else { *a });
            self.now.acceleration[d].clear();
            self.now.acceleration[d].extend(of);
        }
    }

    /// Contacts of the present state.
    pub(super) fn touch(&self, contact: &mut Contact<D>) {
        contact.update(|id| {
            let p = id as usize;
            Present { position: self.position(p), velocity: self.mesh.mean(p, &self.now.velocity) }
        });
        contact.act(self.isa, &self.material);
    }

    fn show_particles(&mut self) {
        for p in 0..self.points.len() {
            self.shown.position[p] = self.position(p);
            self.shown.velocity[p] = self.mesh.mean(p, &self.now.velocity);
            self.shown.density[p] = self.material.density / self.volume_ratio[p];
        }
    }

    fn record(&self, particle: u32) -> StateRecord {
        let p = particle as usize;
        let j = self.volume_ratio[p];
        let cauchy = self.law.cauchy(&self.gradient[p], j);
        let mut r = StateRecord {
            id: particle,
            flags: u32::from(self.points[p].clamped),
            position: wide(self.shown.position[p]),
            velocity: wide(self.shown_velocity.of(particle)),
            density: self.material.density / j,
            pressure: cauchy.pressure,
            mass: self.mass,
            ..StateRecord::default()
        };
        cauchy.put_deviator(&mut r);
        r
    }

    /// What was restored, evaluated again.
    pub(super) fn show_restored(&mut self) {
        // Damping took the velocities in the middle of the last sub-step.
        let (acceleration, evaluations) = (self.now.acceleration.clone(), self.evaluations);
        self.evaluate();
        (self.now.acceleration, self.evaluations) = (acceleration, evaluations);
        self.show_particles();
    }

    fn check(&self) -> Result<(), OutOfBounds> {
        let excess = |(p, v): (usize, &[f64; D])| {
            let speed = v.iter().map(|v| v * v).sum::<f64>().sqrt();
            Some((p as u32, self.bounds.excess(1.0, speed)?))
        };
        let all = self.shown.view().velocity.iter().enumerate().filter_map(excess).chain(self.failure);
        refuse_worst(all, |p| self.shown.position[p])
    }
}

/// Adds an acceleration of a particle, m/s², to its nodes, as a force in equal parts.
pub(super) fn add_to_nodes<const D: usize>(
    mesh: &Mesh<D>,
    accelerations: &mut Vectors<D>,
    particle: u32,
    a: [f64; D],
) {
    for &node in mesh.of(particle as usize) {
        let node = node as usize;
        let part = 1.0 / (Mesh::<D>::CORNERS as f64 * mesh.share(node));
        (0..D).for_each(|d| accelerations[d][node] += a[d] * part);
    }
}

impl<const D: usize> SolidModel<D> for FiniteElement<D> {
    fn particles(&self) -> Particles<'_, D> {
        self.shown.view()
    }

    fn interface_set(&self) -> &[u32] {
        &self.interface_set
    }

    fn set_gravity(&mut self, gravity: [f64; D]) {
        self.gravity = gravity;
    }

    fn records(&self, particles: &[u32], out: &mut Vec<StateRecord>) {
        out.extend(particles.iter().map(|&p| self.record(p)));
    }

    /// omega² = 4 D M / (rho0 dx²) bounds that of every element, M the largest eigenvalue of the present acoustic
    /// tensor: D M is no less than the stiffness against any gradient, and a node has a 2^D-th of an element's mass.
    fn sub_step_limit(&self) -> f64 {
        let (springs, walls) =
            self.contact.as_ref().map_or((0.0, 0.0), |contact| contact.stiffness(&self.material));
        let part = self.courant.min(LARGEST_PART);
        if self.equations.is_some() {
            let touched = springs + walls > 0.0;
            let of_contacts = if touched { part * sub_step(springs.sqrt(), 0.5 * walls) } else { ANY_STEP };
            let of_waves = if self.alone { ALONE * part * self.explicit_step(0.0, 0.0) } else { ANY_STEP };
            return of_contacts.min(of_waves);
        }
        part * self.explicit_step(springs, walls)
    }

    fn advance(&mut self, half_step: &HalfStep, sub_steps: u32, load: &Load<D>) -> Result<(), OutOfBounds> {
        self.take_load(load);
        let span = half_step.span();
        match half_step.stage {
            Stage::First => {
                self.at_n.copy_from(&self.now);
                let (mesh, from) = (&self.mesh, &self.at_n.displacement);
                self.shown_velocity.leave(|p| mesh.mean(p, from));
                self.go_on((sub_steps / 2).max(1), span, half_step.time);
            }
            Stage::Second => {
                self.now.copy_from(&self.at_n);
                self.account.iter_mut().for_each(|account| account.given.open = true);
                self.go_on(sub_steps, span, half_step.time);
                self.contact.iter_mut().for_each(Contact::leave);
                self.account.iter_mut().for_each(|account| account.given.open = false);
            }
        }
        let (mesh, now) = (&self.mesh, &self.now);
        let place = |p: usize| mesh.mean(p, &now.displacement);
        // Nodes go an implicit step by the mean of their velocities, which may be far from each.
        let parts = if self.equations.is_some() { sub_steps.max(2) } else { sub_steps };
        self.shown_velocity.arrive(half_step, parts, place, |p| mesh.mean(p, &now.velocity));
        self.show_particles();
        self.check()
    }

    fn deformation(&self, particle: u32) -> Option<[[f64; D]; D]> {
        let gradient = &self.gradient[particle as usize];
        Some(std::array::from_fn(|a| std::array::from_fn(|b| gradient[(a, b)])))
    }

    fn keep_account(&mut self) {
        self.account = Some(Account::new(self.sinks()));
    }

    fn account(&mut self, give: &mut dyn FnMut(EnergyPart, f64)) {
        if let Some(account) = &mut self.account {
            account.given.hand_over(give);
        }
    }

    fn strain_energy(&self) -> f64 {
        let of =
            |p: usize| self.stored_by(p, &self.gradient[p], self.volume_ratio[p], &self.now.displacement);
        let inner: f64 = (0..self.points.len()).map(of).sum();
        inner + self.contact.as_ref().map_or(0.0, Contact::energy)
    }

    fn energy_of(&self, particles: &[u32]) -> f64 {
        let of = |p: usize| {
            let stored = self.stored_by(p, &self.gradient[p], self.volume_ratio[p], &self.now.displacement);
            self.kinetic_energy_in(p) + stored
        };
        particles.iter().map(|&p| of(p as usize)).sum()
    }

    fn kinetic_energy(&self) -> f64 {
        self.nodal_kinetic_energy()
    }

    fn contact_forces(&self, give: &mut dyn FnMut(u32, [f64; D])) {
        self.contact.iter().for_each(|contact| contact.forces(&mut *give));
    }

    fn state(&mut self) -> Option<&mut dyn halfstep_wire::state::State> {
        Some(self)
    }

    fn pair_evaluations(&self) -> u64 {
        self.evaluations
    }
}

/// What an implicit solid without contacts asks of a step, s: messages carry no infinite one.
const ANY_STEP: f64 = 1e9;

/// Implicit steps of a solid without fluid over explicit ones.
const ALONE: f64 = 10.0;

/// Part of the stable sub-step that a state may take.
const LARGEST_PART: f64 = 0.9;
