//! What the effects of the total-Lagrangian solid give it over a step (see [`crate::account`]).

use super::material::Matrix;
use super::model::TotalLagrangian;
use super::pass::Viscosity;
use crate::account::{self, Driven, Sinks, SubStep};
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::pair;
use std::collections::BTreeMap;

impl<const D: usize> TotalLagrangian<D> {
    /// What the present sub-step gives is noted.
    pub(super) fn keeps_account(&self) -> bool {
        account::is_open(self.account.as_ref())
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
    pub(super) fn sinks(&self) -> Sinks<D> {
        let slots = self.id.len();
        let mut sinks = Sinks::none(slots);
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
            let free = |id: u32| f64::from(u8::from(self.is_free(self.slot_of[id as usize] as usize)));
            sinks.moving_walls = self.mass * contact.power_of_walls(free);
        }
        sinks.driven = self.inner_of_driven();
        sinks
    }

    /// What acts from inside on the slots that clamps move, m/s²: stresses, other bodies, the other sides of cuts.
    fn inner_of_driven(&self) -> Vec<[f64; D]> {
        let inner = |slot: usize| std::array::from_fn(|d| self.sums[slot / LANES].0[d].0[slot % LANES]);
        let mut driven: Vec<[f64; D]> = self.driven.iter().map(|(slot, _)| inner(*slot)).collect();
        let place: BTreeMap<usize, usize> = self.driven.iter().map(|(slot, _)| *slot).zip(0..).collect();
        let mut add = |slot: usize, a: [f64; D]| {
            if let Some(&k) = place.get(&slot) {
                driven[k] = std::array::from_fn(|d| driven[k][d] + a[d]);
            }
        };
        if place.is_empty() {
            return driven;
        }
        if let Some(contact) = &self.contact {
            contact.body_accelerations(|id, a| add(self.slot_of[id as usize] as usize, a));
        }
        driven
    }

    /// Notes what was given over the sub-step of this length, s, that led to the present state; `before` is what
    /// clamps moved from.
    pub(super) fn note_sub_step(&mut self, dt: f64, before: &[Driven<D>]) {
        if !self.keeps_account() {
            return;
        }
        let sinks = self.sinks();
        let (now, gravity) = (&self.now, self.gravity);
        let step = SubStep { dt, mass: self.mass, now, driven: before, gravity };
        let share = |slot: usize| if self.id[slot] == PADDING { 0.0 } else { 1.0 };
        if let Some(account) = &mut self.account {
            account.note(&step, sinks, share);
        }
    }

    /// Where clamps move particles from; nothing where no account is open.
    pub(super) fn driven_from(&self) -> Vec<Driven<D>> {
        if !self.keeps_account() {
            return Vec::new();
        }
        let from = |((slot, _), load): (&(usize, _), &[f64; D])| Driven::of(&self.now, *slot, *load);
        self.driven.iter().zip(&self.driven_load).map(from).collect()
    }
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
