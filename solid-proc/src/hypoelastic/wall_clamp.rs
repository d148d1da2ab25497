//! A clamp that acts as a wall does (Kayaki section 4.1): its rows have velocity zero, the pressure extrapolated from
//! the free particles around (eq. 28), the density of that pressure (eq. 5) and no deviatoric stress. Unlike walls it
//! may pull.
//!
//! Kayaki's text leaves open whether the plate's clamp is made of the solid's particles or of the wall's: this is the
//! second reading. Off unless `effects.wall-clamp` is on.

use super::model::Hypoelastic;
use crate::columns::{Vectors, vectors};
use halfstep_sph::extrapolation::{Extrapolation, ExtrapolationSum};
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::pair::{self, Narrow};
use halfstep_sph::with_kernel;

/// Out of every kernel's reach, m.
const FAR: f64 = 1e30;

/// Columns for the extrapolation.
pub(super) struct WallClamp<const D: usize> {
    /// Positions, those of clamped particles out of reach.
    free: Vectors<D>,
    sums: Vec<ExtrapolationSum>,
}

impl<const D: usize> Default for WallClamp<D> {
    fn default() -> Self {
        Self { free: vectors(0), sums: Vec::new() }
    }
}

impl<const D: usize> Hypoelastic<D> {
    fn is_clamped(&self, slot: usize) -> bool {
        self.id[slot] != PADDING && self.points[self.id[slot] as usize].clamped
    }

    /// Gives the clamped rows the state of a wall.
    pub(super) fn show_clamps_as_walls(&mut self) {
        let Some(mut clamp) = self.wall_clamp.take() else { return };
        let slots = self.id.len();
        for d in 0..D {
            clamp.free[d].clone_from(&self.now.position[d]);
        }
        for slot in (0..slots).filter(|&s| self.is_clamped(s)) {
            clamp.free[0][slot] = FAR;
        }
        clamp.sums.resize(self.neighbours.fours(), ExtrapolationSum::default());
        with_kernel!(self.kernel, self.smoothing_length, D, |kernel| {
            let law = Narrow(Extrapolation {
                kernel,
                gravity: self.gravity,
                targets: &self.now.position,
                sources: &clamp.free,
                density: &self.now.density,
                pressure: &self.pressure,
            });
            pair::pass(self.isa, &law, &self.neighbours, &mut clamp.sums);
        });
        self.pair_evaluations += self.neighbours.pairs() as u64;
        let (k, rho0) = (self.material.bulk_modulus(), self.material.density);
        for slot in 0..slots {
            if !self.is_clamped(slot) {
                continue;
            }
            let p = clamp.sums[slot / LANES].pressure(slot % LANES).unwrap_or(0.0);
            self.now.density[slot] = rho0 * (1.0 + p / k);
            for a in 0..D {
                for b in a..D {
                    self.now.stress[a][b][slot] = 0.0;
                }
            }
            self.show(slot, p);
        }
        self.wall_clamp = Some(clamp);
    }
}
