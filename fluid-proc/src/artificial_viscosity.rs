//! Monaghan's artificial viscosity, Kayaki's eqs. (23) and (24):
//!   Pi_ij = (-A c theta + B theta²) / rho_ij where v_ij . x_ij < 0, else 0,
//!   theta = h v_ij . x_ij / (r² + 0.01 h²), rho_ij = (rho_i + rho_j) / 2;
//! -Pi_ij stands in the bracket of the momentum equation.

use crate::rates::{FluidPair, PairEffect, PairRates};
use halfstep_shared::lane::{Arch, Lane};
use halfstep_shared::scene::ArtificialViscosity as Coefficients;

/// A between fluid and wall: what the cross-phase f_i is between fluid and solid. Without it single particles of a thin
/// film sink into the wall by up to 1.7 dx before their pressure stops them (elastic gate, 2.5 mm); with it 0.25 dx. A
/// free-slip wall shows the particle's own tangential velocity, so nothing drags along it.
const WALL_GUARD: f64 = 1.0;

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct ArtificialViscosity {
    smoothing_length: f64,
    /// A c0.
    linear: f64,
    quadratic: f64,
}

impl ArtificialViscosity {
    /// With the fluid's sound speed c0 for c.
    pub fn new(coefficients: Coefficients, sound_speed: f64, smoothing_length: f64) -> Self {
        Self {
            smoothing_length,
            linear: coefficients.linear * sound_speed,
            quadratic: coefficients.quadratic,
        }
    }

    /// Between fluid and wall: A at least [`WALL_GUARD`].
    pub fn at_walls(coefficients: Coefficients, sound_speed: f64, smoothing_length: f64) -> Self {
        let linear = coefficients.linear.max(WALL_GUARD);
        Self::new(Coefficients { linear, ..coefficients }, sound_speed, smoothing_length)
    }
}

impl<const D: usize> PairEffect<D> for ArtificialViscosity {
    type Own = ();
    #[inline(always)]
    fn own(&self, _: usize) {}

    #[inline(always)]
    fn add<A: Arch>(&self, _: &(), _: usize, pair: &FluidPair<D>, rates: &mut PairRates<D>) {
        let h = self.smoothing_length;
        let closing = pair.approach.min(Lane::ZERO) * Lane::splat(h);
        let softened = pair.r2 + Lane::splat(0.01 * h * h);
        let theta = closing / softened;
        let numerator = theta * A::mul_add(Lane::splat(self.quadratic), theta, Lane::splat(-self.linear));
        let pi = numerator * Lane::splat(2.0) / (pair.density_i + pair.density_j);
        rates.bracket = rates.bracket - pi;
    }
}
