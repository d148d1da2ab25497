//! The model behind [`SolidModel`]: reference configuration and time integration.
//!
//! Velocity Verlet (kick, drift, kick), which keeps the energy of an undamped solid: the midpoint scheme would amplify
//! it by 1 + (omega dt)⁴/8 a step. One evaluation a sub-step, since the acceleration at its start is known.

mod build;

use super::bounds::VolumeBounds;
use super::contact::Contact;
use super::fracture::{Drift, Fracture};
use super::loads::Loads;
use super::material::{Law, Matrix};
use super::pass::{Acceleration, DeformationSum, Fixed, Matrices};
use super::relaxation::{Arm, Memory};
use crate::account::Account;
use crate::columns::{ParticleColumns, Vectors, vector};
use crate::model::{FractureSummary, Load, OutOfBounds, Particles, SolidModel};
use crate::shown_velocity::ShownVelocity;
use crate::side_friction;
use crate::verlet::Kinematics;
use halfstep_role::role::Costs;
use halfstep_role::timeline;
use halfstep_scene::bounds::Excess;
use halfstep_scene::geometry::SolidPoint;
use halfstep_scene::{EnergyPart, Motion, Solid};
use halfstep_sph::lane::Isa;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::pair::FixedPairs;
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::wide;

/// The total-Lagrangian solid.
pub struct TotalLagrangian<const D: usize> {
    pub(super) material: Solid,
    pub(super) law: Law,
    /// Maxwell arms; none where stress does not relax.
    pub(super) arms: Vec<Arm>,
    /// Slots that clamps move, and how.
    pub(super) driven: Vec<(usize, Motion)>,
    /// Loads on these slots, m/s², where account is kept.
    pub(super) driven_load: Vec<[f64; D]>,
    /// Deceleration by side friction, m/s².
    side_friction: Option<f64>,
    pub(super) isa: Isa,
    pub(super) smoothing_length: f64,
    /// dx of its own, m.
    pub(super) spacing: f64,
    pub(super) gravity: [f64; D],
    courant: f64,
    /// V0 of a particle.
    pub(super) volume: f64,
    pub(super) mass: f64,
    /// alpha G, Pa.
    pub(super) hourglass_modulus: f64,
    /// Beyond the face of a clamp there is no strain.
    pub(super) rigid_clamps: bool,
    pub(super) points: Vec<SolidPoint<D>>,
    shown: ParticleColumns<D>,
    interface_set: Vec<u32>,
    /// Particle number of a slot, or padding.
    pub(super) id: Vec<u32>,
    /// Slot of a particle.
    pub(super) slot_of: Vec<u32>,
    pub(super) fixed: Fixed,
    /// X, neighbours and kernel of the reference configuration.
    pub(super) pairs: FixedPairs<D>,
    /// Largest sum_j V0 |W'| / R, 1/m².
    pub(super) slope_sum: f64,
    /// L; zero where a particle has no deformation gradient.
    pub(super) correction: Vec<Matrix<D>>,
    /// a, Pa.
    pub(super) hourglass: Vec<f64>,
    pub(super) now: Kinematics<D>,
    /// What Maxwell arms remember.
    pub(super) memory: Memory<D>,
    /// State at n.
    at_n: Kinematics<D>,
    memory_at_n: Memory<D>,
    pub(super) shown_velocity: ShownVelocity<D>,
    /// Loads and gravity, m/s².
    load: Vectors<D>,
    /// F.
    pub(super) gradient: Vec<Matrix<D>>,
    /// J.
    pub(super) volume_ratio: Vec<f64>,
    /// B, Pa.
    pub(super) bracket: Matrices<D>,
    pub(super) deformations: Vec<DeformationSum<D>>,
    pub(super) sums: Vec<Acceleration<D>>,
    pub(super) contact: Option<Contact<D>>,
    /// Where it breaks.
    pub(super) fracture: Option<Fracture<D>>,
    /// Tractions that the scene prescribes.
    loads: Loads<D>,
    pub(super) bounds: VolumeBounds,
    /// The particle whose volume left its bounds first, or of several the one farthest out.
    pub(super) failure: Option<(u32, Excess)>,
    pub(super) pair_evaluations: u64,
    /// Where account is kept of what effects give.
    pub(super) account: Option<Account<D>>,
}

impl<const D: usize> TotalLagrangian<D> {
    /// Present position of the particle at a slot.
    pub(super) fn position_at(&self, slot: usize) -> [f64; D] {
        std::array::from_fn(|d| self.pairs.position()[d][slot] + self.now.displacement[d][slot])
    }

    /// `time` is the middle of the stage, s.
    fn take_load(&mut self, load: &Load<D>, time: f64) {
        for slot in 0..self.id.len() {
            let free = self.id[slot] != PADDING && self.fixed.clamped[slot] == 0.0;
            for d in 0..D {
                let force = || load.force[self.id[slot] as usize][d] / self.mass;
                self.load[d][slot] = if free { self.gravity[d] + force() } else { 0.0 };
            }
        }
        self.loads.add(time, &mut self.load);
        if self.account.is_some() {
            let of = |(slot, _): &(usize, _)| load.force[self.id[*slot] as usize].map(|f| f / self.mass);
            self.driven_load = self.driven.iter().map(of).collect();
        }
    }

    fn kick(&mut self, dt: f64) {
        for d in 0..D {
            let rates = self.now.acceleration[d].iter().zip(&self.load[d]);
            for (v, (inner, load)) in self.now.velocity[d].iter_mut().zip(rates) {
                *v += dt * (inner + load);
            }
        }
        if let Some(friction) = self.side_friction {
            let before = self.accounted_kinetic_energy();
            let clamped = &self.fixed.clamped;
            side_friction::slow(&mut self.now.velocity, dt * friction, |slot| clamped[slot] == 0.0);
            if let (Some(before), Some(after)) = (before, self.accounted_kinetic_energy())
                && let Some(account) = &mut self.account
            {
                account.given.give(EnergyPart::SideFriction, after - before);
            }
        }
    }

    /// Notes the work of tractions over the step; `time` is its middle, s.
    fn account_for_loads(&mut self, time: f64) {
        if self.keeps_account() {
            let work = self.mass * self.loads.work(time, &self.at_n.displacement, &self.now.displacement);
            if let Some(account) = &mut self.account {
                account.given.give(EnergyPart::Loads, work);
            }
        }
    }

    /// Brings what clamps move to where they are at a time, s.
    fn drive(&mut self, time: f64) {
        let position = self.pairs.position();
        self.now.drive(&self.driven, time, |slot| vector(position, slot as u32));
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
            self.rub(0.5 * each, Drift::Follows);
            let driven = self.driven_from();
            self.now.drift(each);
            self.drive(time + f64::from(k) * each);
            self.evaluate(each);
            self.tear();
            if self.fracture.as_ref().is_some_and(Fracture::is_accepted) {
                self.keep_gradients();
            }
            self.note_sub_step(each, &driven);
            self.rub(0.5 * each, Drift::IsDone);
            self.kick(0.5 * each);
        }
    }

    /// Copies the present state to the columns by particle number.
    pub(super) fn show_particles(&mut self) {
        for p in 0..self.slot_of.len() {
            let slot = self.slot_of[p] as usize;
            self.shown.position[p] = self.position_at(slot);
            self.shown.velocity[p] = std::array::from_fn(|d| self.now.velocity[d][slot]);
            self.shown.density[p] = self.material.density / self.volume_ratio[slot];
        }
    }

    pub(super) fn record(&self, particle: u32) -> StateRecord {
        let slot = self.slot_of[particle as usize] as usize;
        let j = self.volume_ratio[slot];
        let cauchy = self.cauchy(slot);
        let mut r = StateRecord {
            id: particle,
            flags: u32::from(self.points[particle as usize].clamped),
            position: wide(self.position_at(slot)),
            velocity: wide(self.shown_velocity.of(particle)),
            density: self.material.density / j,
            pressure: cauchy.pressure,
            mass: self.mass,
            ..StateRecord::default()
        };
        cauchy.put_deviator(&mut r);
        r
    }
}

impl<const D: usize> SolidModel<D> for TotalLagrangian<D> {
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

    fn sub_step_limit(&self) -> f64 {
        let hourglass = self.hourglass_modulus / self.material.density;
        let speed = (self.material.pressure_wave_speed().powi(2) + hourglass).sqrt();
        (self.courant * self.spacing / speed).min(self.stable_sub_step())
    }

    fn advance(&mut self, half_step: &HalfStep, sub_steps: u32, load: &Load<D>) -> Result<(), OutOfBounds> {
        let span = half_step.span();
        self.take_load(load, half_step.time + 0.5 * span);
        match half_step.stage {
            Stage::First => {
                self.at_n.copy_from(&self.now);
                self.memory_at_n.copy_from(&self.memory);
                self.fracture.iter_mut().for_each(Fracture::leave_n);
                let (slot_of, from) = (&self.slot_of, &self.at_n.displacement);
                self.shown_velocity.leave(|p| vector(from, slot_of[p]));
                self.sub_step((sub_steps / 2).max(1), span, half_step.time);
            }
            Stage::Second => {
                self.now.copy_from(&self.at_n);
                self.memory.copy_from(&self.memory_at_n);
                self.account.iter_mut().for_each(|account| account.given.open = true);
                self.fracture.iter_mut().for_each(|fracture| {
                    fracture.return_to_n();
                    fracture.accept(true);
                });
                self.sub_step(sub_steps, span, half_step.time);
                self.contact.iter_mut().for_each(Contact::leave);
                self.fracture.iter_mut().for_each(|fracture| fracture.accept(false));
                self.account_for_loads(half_step.time + 0.5 * span);
                self.account.iter_mut().for_each(|account| account.given.open = false);
            }
        }
        let (slot_of, now) = (&self.slot_of, &self.now);
        let place = |p: usize| vector(&now.displacement, slot_of[p]);
        self.shown_velocity.arrive(half_step, sub_steps, place, |p| vector(&now.velocity, slot_of[p]));
        self.show_particles();
        self.check()
    }

    fn fracture(&self) -> FractureSummary {
        self.summary()
    }

    fn damage(&self, particle: u32) -> f64 {
        self.damage_at(self.slot_of[particle as usize] as usize)
    }

    fn breaks(&self) -> bool {
        self.fracture.is_some()
    }

    fn parted(&self) -> Option<&[u32]> {
        self.fracture.as_ref().map(Fracture::bodies)
    }

    fn deformation(&self, particle: u32) -> Option<[[f64; D]; D]> {
        let gradient = &self.gradient[self.slot_of[particle as usize] as usize];
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
        self.energy()
    }

    fn energy_of(&self, particles: &[u32]) -> f64 {
        let stored = particles.iter().map(|&p| self.stored_at(self.slot_of[p as usize] as usize));
        self.particles().kinetic_energy_of(particles) + stored.sum::<f64>()
    }

    fn contact_forces(&self, give: &mut dyn FnMut(u32, [f64; D])) {
        self.contact.iter().for_each(|contact| contact.forces(&mut *give));
        self.friction_forces(give);
    }

    fn state(&mut self) -> Option<&mut dyn halfstep_wire::state::State> {
        Some(self)
    }

    fn costs(&mut self) -> Costs {
        self.costs_of_effects()
    }

    fn pair_evaluations(&self) -> u64 {
        self.pair_evaluations
    }
}
