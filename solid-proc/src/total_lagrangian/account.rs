//! What effects give the solid over a step: the sum over its sub-steps of dt v . (a + a') / 2, where v is the velocity
//! of the drift, and a and a' are the accelerations of the kicks before and after it.

use super::material::Matrix;
use super::model::TotalLagrangian;
use super::pass::Viscosity;
use crate::columns::{Vectors, vectors};
use crate::ledger::Given;
use halfstep_scene::EnergyPart;
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::pair;
use halfstep_wire::state::{Fields, State, StateError};

/// Accelerations by what takes energy, at one evaluation.
#[derive(Clone, Debug)]
struct Sinks<const D: usize> {
    /// By the artificial viscosity, m/s².
    viscous: Vectors<D>,
    /// By walls, m/s².
    walls: Vectors<D>,
    /// Power of walls that move, W (2D: W/m).
    moving_walls: f64,
    /// By all that acts inside, on the particles that clamps move, m/s².
    driven: Vec<[f64; D]>,
}

/// What was given over the present step, and what that takes to know.
#[derive(Clone, Debug)]
pub(super) struct Account<const D: usize> {
    pub(super) given: Given,
    last: Sinks<D>,
}

impl<const D: usize> Account<D> {
    pub(super) fn new(slots: usize, driven: usize) -> Self {
        let none = Sinks {
            viscous: vectors(slots),
            walls: vectors(slots),
            moving_walls: 0.0,
            driven: vec![[0.0; D]; driven],
        };
        Self { given: Given::default(), last: none }
    }
}

impl<const D: usize> State for Account<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let (slots, driven) = (self.last.walls[0].len(), self.last.driven.len());
        fields.vectors("viscous", &mut self.last.viscous)?;
        fields.vectors("walls", &mut self.last.walls)?;
        fields.real("moving_walls", &mut self.last.moving_walls)?;
        fields.points("driven", &mut self.last.driven)?;
        let columns = self.last.viscous.iter().chain(&self.last.walls);
        columns.map(Vec::len).try_for_each(|n| fields.length("viscous", slots, n))?;
        fields.length("driven", driven, self.last.driven.len())
    }
}

impl<const D: usize> TotalLagrangian<D> {
    /// What the present sub-step gives is noted.
    pub(super) fn keeps_account(&self) -> bool {
        self.account.as_ref().is_some_and(|account| account.given.open)
    }

    /// What follows belongs to a step that is kept, or no longer does.
    pub(super) fn set_account_open(&mut self, open: bool) {
        if let Some(account) = &mut self.account {
            account.given.open = open;
        }
    }

    /// Kinetic energy of the particles that no clamp holds, J (2D: J/m), where account is kept.
    pub(super) fn accounted_kinetic_energy(&self) -> Option<f64> {
        if !self.keeps_account() {
            return None;
        }
        let free = |&slot: &usize| self.id[slot] != PADDING && self.fixed.clamped[slot] == 0.0;
        let square = |slot: usize| (0..D).map(|d| self.now.velocity[d][slot].powi(2)).sum::<f64>();
        Some(0.5 * self.mass * (0..self.id.len()).filter(free).map(square).sum::<f64>())
    }

    /// The velocities are those of the drift, and the present state has been evaluated.
    fn sinks(&mut self) -> Sinks<D> {
        let slots = self.id.len();
        let mut sinks = Account::new(slots, 0).last;
        if let Some(damping) = self.damping() {
            let law = Viscosity {
                damping,
                displacement: &self.now.displacement,
                scale: self.volume / self.material.density,
            };
            let mut sums = vec![super::pass::Acceleration::default(); slots / LANES];
            pair::fixed_pass(self.isa, &law, &self.pairs, &mut sums);
            for slot in (0..slots).filter(|&slot| self.id[slot] != PADDING) {
                for d in 0..D {
                    sinks.viscous[d][slot] = sums[slot / LANES].0[d].0[slot % LANES];
                }
            }
        }
        if let Some(contact) = &self.contact {
            contact.wall_accelerations(|id, a| {
                let slot = self.slot_of[id as usize] as usize;
                if self.fixed.clamped[slot] == 0.0 {
                    for d in 0..D {
                        sinks.walls[d][slot] = a[d];
                    }
                }
            });
            sinks.moving_walls = self.mass * contact.power_of_walls(self.isa, self.kernel, &self.material);
        }
        let inner = |slot: usize| std::array::from_fn(|d| self.sums[slot / LANES].0[d].0[slot % LANES]);
        sinks.driven = self.driven.iter().map(|(slot, _)| inner(*slot)).collect();
        sinks
    }

    /// Notes what was given over the sub-step of this length, s, that led to the present state; `before` is what
    /// clamps moved from.
    pub(super) fn note_sub_step(&mut self, dt: f64, before: &[Driven<D>]) {
        if !self.keeps_account() {
            return;
        }
        let sinks = self.sinks();
        let Some(account) = &mut self.account else { return };
        let velocity = &self.now.velocity;
        let work = |a: &Vectors<D>, b: &Vectors<D>| -> f64 {
            let of = |slot: usize| -> f64 {
                (0..D).map(|d| velocity[d][slot] * 0.5 * (a[d][slot] + b[d][slot])).sum()
            };
            let real = (0..self.id.len()).filter(|&slot| self.id[slot] != PADDING);
            dt * self.mass * real.map(of).sum::<f64>()
        };
        let viscous = work(&account.last.viscous, &sinks.viscous);
        let contact = work(&account.last.walls, &sinks.walls);
        let moving = 0.5 * dt * (account.last.moving_walls + sinks.moving_walls);
        account.given.give(EnergyPart::ArtificialViscosity, viscous);
        account.given.give(EnergyPart::WallContact, contact - moving);
        account.given.give(EnergyPart::MovingWalls, moving);
        let mut clamps = 0.0;
        for (((slot, _), before), (a, b)) in
            self.driven.iter().zip(before).zip(account.last.driven.iter().zip(&sinks.driven))
        {
            for d in 0..D {
                let way = self.now.displacement[d][*slot] - before.displacement[d];
                let kinetic = 0.5 * (velocity[d][*slot].powi(2) - before.velocity[d].powi(2));
                clamps += kinetic - (0.5 * (a[d] + b[d]) + self.gravity[d] + before.load[d]) * way;
            }
        }
        account.given.give(EnergyPart::Clamps, self.mass * clamps);
        account.last = sinks;
    }

    /// Begins to keep account, from the present state on.
    pub(super) fn open_account(&mut self) {
        self.account = Some(Account::new(self.id.len(), self.driven.len()));
        let sinks = self.sinks();
        if let Some(account) = &mut self.account {
            account.last = sinks;
        }
    }

    /// Where clamps move particles from; nothing where no account is open.
    pub(super) fn driven_from(&self) -> Vec<Driven<D>> {
        if !self.keeps_account() {
            return Vec::new();
        }
        let of = |columns: &Vectors<D>, slot: usize| std::array::from_fn(|d| columns[d][slot]);
        let from = |(&(slot, _), &load): (&(usize, _), &[f64; D])| Driven {
            displacement: of(&self.now.displacement, slot),
            velocity: of(&self.now.velocity, slot),
            load,
        };
        self.driven.iter().zip(&self.driven_load).map(from).collect()
    }
}

/// A particle that a clamp moves, before a sub-step.
pub(super) struct Driven<const D: usize> {
    displacement: [f64; D],
    velocity: [f64; D],
    /// By the fluid, m/s².
    load: [f64; D],
}

/// Energy that an arm of relative modulus `share` and relaxation time `time` loses while its elastic deviator goes
/// straight on by `change` in `dt`, and its stress from `before` to `after`, Pa, per reference volume; 2 G in Pa. That
/// is the work on it, change / 2G : (mean of h), less what it holds more.
pub(super) fn lost_by_arm<const D: usize>(
    (share, time): (f64, f64),
    dt: f64,
    double_modulus: f64,
    change: &Matrix<D>,
    [before, after]: [&Matrix<D>; 2],
) -> f64 {
    let mean = (change * share - (after - before)) * (time / dt);
    let held = |h: &Matrix<D>| contraction(h, h) / (2.0 * share);
    (contraction(change, &mean) - (held(after) - held(before))) / double_modulus
}

/// A : B of two deviators; in 2D with their zz components.
fn contraction<const D: usize>(a: &Matrix<D>, b: &Matrix<D>) -> f64 {
    let out_of_plane = if D == 2 { a.trace() * b.trace() } else { 0.0 };
    a.component_mul(b).sum() + out_of_plane
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix2;

    /// Held at a strain, an arm loses what it held.
    #[test]
    fn an_arm_that_relaxes_loses_its_energy() {
        let (before, after) = (Matrix2::new(1.0, 0.0, 0.0, -1.0), Matrix2::new(0.5, 0.0, 0.0, -0.5));
        // h : h / (4 g G) with g = 2, 2 G = 3: (2 - 0.5) / 12.
        let lost = lost_by_arm((2.0, 0.1), 0.07, 3.0, &Matrix2::zeros(), [&before, &after]);
        assert!((lost - 0.125).abs() < 1e-15, "{lost}");
    }

    /// From rest at a constant rate for as long as tau: h = g s' tau (1 - exp(-t / tau)), and what is lost is the
    /// integral of h : h / (2 g G tau).
    #[test]
    fn an_arm_that_is_strained_loses_by_hand() {
        let (g, tau, double_modulus) = (0.5, 0.1, 3.0);
        let end = g * (1.0 - (-1.0_f64).exp());
        let change = Matrix2::new(0.0, 1.0, 1.0, 0.0);
        let after = change * end;
        let lost = lost_by_arm((g, tau), tau, double_modulus, &change, [&Matrix2::zeros(), &after]);
        // h : h = 2 g² (1 - e^-x)², x = t / tau; its integral to 1 is 2 g² (1 - 2 (1 - e^-1) + (1 - e^-2) / 2).
        let e = (-1.0_f64).exp();
        let integral = 2.0 * g * g * (1.0 - 2.0 * (1.0 - e) + 0.5 * (1.0 - e * e));
        assert!((lost - integral / (g * double_modulus)).abs() < 1e-15, "{lost}");
    }
}
