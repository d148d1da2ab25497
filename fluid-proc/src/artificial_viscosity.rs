//! Monaghan's artificial viscosity, Kayaki's eqs. (23) and (24):
//!   Pi_ij = (-A c theta + B theta²) / rho_ij where v_ij . x_ij < 0, else 0,
//!   theta = h v_ij . x_ij / (r² + 0.01 h²), rho_ij = (rho_i + rho_j) / 2;
//! -Pi_ij stands in the bracket of the momentum equation.

use crate::rates::{FluidPair, PairEffect, PairRates};
use halfstep_shared::lane::{Arch, Lane};
use halfstep_shared::scene::ArtificialViscosity as Coefficients;

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
}

impl<const D: usize> PairEffect<D> for ArtificialViscosity {
    type Own = ();
    #[inline(always)]
    fn own(&self, _: usize) {}

    #[inline(always)]
    fn add<A: Arch>(&self, _: &(), _: usize, pair: &FluidPair<D>, rates: &mut PairRates<D>) {
        let linear = Lane::splat(self.linear);
        let quadratic = Lane::splat(self.quadratic);
        rates.bracket = rates.bracket - damping::<D, A>(self.smoothing_length, linear, quadratic, pair);
    }
}

/// Pi_ij with `linear` = A c and `quadratic` = B.
#[inline(always)]
pub(crate) fn damping<const D: usize, A: Arch>(
    h: f64,
    linear: Lane,
    quadratic: Lane,
    pair: &FluidPair<D>,
) -> Lane {
    let closing = pair.approach.min(Lane::ZERO) * Lane::splat(h);
    let softened = pair.r2 + Lane::splat(0.01 * h * h);
    let theta = closing / softened;
    let numerator = theta * A::mul_add(quadratic, theta, -linear);
    numerator * Lane::splat(2.0) / (pair.density_i + pair.density_j)
}
