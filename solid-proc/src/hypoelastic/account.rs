//! What effects give the hypoelastic solid over a step: the sum over its sub-steps of dt v . a, both at the sub-step's
//! middle, with the rates that the sub-step took.
//!
//! Its strain energy is that of the stresses which it has, not of a deformation. So the stress has a part of its own:
//! what it gives the velocities and the energy that it then holds more do not cancel.

use super::model::Hypoelastic;
use super::rates::{ArtificialStress, Plain};
use crate::columns::Vectors;
use crate::ledger::Given;
use crate::model::SolidModel;
use halfstep_scene::{ArtificialViscosity, EnergyPart};
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::with_kernel;

/// What was given over the present step.
#[derive(Clone, Debug, Default)]
pub(super) struct Account {
    pub(super) given: Given,
    /// Strain energy at n, J (2D: J/m).
    strain: f64,
}

impl<const D: usize> Hypoelastic<D> {
    fn is_open(&self) -> bool {
        self.account.as_ref().is_some_and(|account| account.given.open)
    }

    /// Begins a step.
    pub(super) fn open_account(&mut self) {
        let strain = self.account.is_some().then(|| self.strain_energy());
        if let (Some(account), Some(strain)) = (&mut self.account, strain) {
            account.strain = strain;
        }
    }

    /// What follows belongs to a step that is kept, or no longer does.
    pub(super) fn keep_rates(&mut self, kept: bool) {
        if let Some(account) = &mut self.account {
            account.given.open = kept;
        }
    }

    /// Ends a step.
    pub(super) fn close_account(&mut self) {
        let strain = self.account.is_some().then(|| self.strain_energy());
        if let (Some(account), Some(strain)) = (&mut self.account, strain) {
            account.given.give(EnergyPart::Stress, strain - account.strain);
        }
    }

    /// sum m v . a of the last pass, W (2D: W/m).
    fn power_of_sums(&self) -> f64 {
        self.power(|slot| self.sums[slot / LANES].acceleration.map(|a| a.0[slot % LANES]))
    }

    fn power(&self, acceleration: impl Fn(usize) -> [f64; D]) -> f64 {
        let of = |slot: usize| {
            let a = acceleration(slot);
            (0..D).map(|d| self.now.velocity[d][slot] * a[d]).sum::<f64>()
        };
        let real = (0..self.id.len()).filter(|&slot| self.id[slot] != PADDING);
        self.mass * real.map(of).sum::<f64>()
    }

    /// Notes the rates of the present state, which are taken over this length, s.
    pub(super) fn note_rates(&mut self, dt: f64) {
        if !self.is_open() {
            return;
        }
        let inner = self.power_of_sums();
        let (sums, evaluations) = (self.sums.clone(), self.pair_evaluations);
        let mut bare = self.sources.clone();
        bare.iter_mut().for_each(|source| source.stress_term = [[0.0; D]; D]);
        let sources = std::mem::replace(&mut self.sources, bare);
        with_kernel!(self.kernel, self.smoothing_length, D, |kernel| self.pass(kernel, (), Plain));
        let viscous = self.power_of_sums();
        let mut artificial = 0.0;
        if self.artificial_stress.is_some() {
            let none = ArtificialViscosity { linear: 0.0, quadratic: 0.0 };
            let viscosity = std::mem::replace(&mut self.material.artificial_viscosity, none);
            let tensors = std::mem::take(&mut self.artificial);
            with_kernel!(self.kernel, self.smoothing_length, D, |kernel| {
                if let Some(correction) =
                    ArtificialStress::of(self.artificial_stress, &tensors, kernel, self.spacing)
                {
                    self.pass(kernel, correction, Plain);
                }
            });
            artificial = self.power_of_sums();
            (self.artificial, self.material.artificial_viscosity) = (tensors, viscosity);
        }
        (self.sums, self.pair_evaluations, self.sources) = (sums, evaluations, sources);
        let (contact, moving) = self.powers_of_walls();
        let Some(Account { given, .. }) = &mut self.account else { return };
        given.give(EnergyPart::ArtificialViscosity, dt * viscous);
        given.give(EnergyPart::ArtificialStress, dt * artificial);
        given.give(EnergyPart::Stress, dt * (inner - viscous - artificial));
        given.give(EnergyPart::WallContact, dt * (contact - moving));
        given.give(EnergyPart::MovingWalls, dt * moving);
    }

    /// Power of all walls, and that of their motion, W (2D: W/m).
    fn powers_of_walls(&self) -> (f64, f64) {
        let Some(walls) = &self.walls else { return (0.0, 0.0) };
        let contact = self.power(|slot| {
            let clamped = self.points[self.id[slot] as usize].clamped;
            if clamped { [0.0; D] } else { walls.acceleration(slot) }
        });
        let free = |id: u32| if self.points[id as usize].clamped { 0.0 } else { 1.0 };
        (contact, self.mass * walls.power(&self.id, free))
    }

    /// Notes what side friction took of these velocities, m/s, before it acted.
    pub(super) fn note_friction(&mut self, before: &Vectors<D>) {
        if !self.is_open() {
            return;
        }
        let square = |v: &Vectors<D>, slot: usize| (0..D).map(|d| v[d][slot].powi(2)).sum::<f64>();
        let real = (0..self.id.len()).filter(|&slot| self.id[slot] != PADDING);
        let change: f64 = real.map(|slot| square(&self.now.velocity, slot) - square(before, slot)).sum();
        let joules = 0.5 * self.mass * change;
        if let Some(account) = &mut self.account {
            account.given.give(EnergyPart::SideFriction, joules);
        }
    }
}
