//! Monaghan's artificial viscosity between fluid particles: -Pi_ij of [`halfstep_shared::artificial_viscosity`] in the
//! bracket of the momentum equation, Kayaki's eq. (22).

use crate::rates::{FluidPair, PairEffect, PairRates};
use halfstep_shared::artificial_viscosity::damping;
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
        rates.bracket = rates.bracket
            - damping::<A>(
                self.smoothing_length,
                linear,
                quadratic,
                pair.approach,
                pair.r2,
                pair.density_i + pair.density_j,
            );
    }
}
