//! Monaghan's artificial viscosity between fluid particles: -Pi_ij of [`halfstep_sph::artificial_viscosity`] in the
//! bracket of the momentum equation, Kayaki's eq. (22).

use crate::effects::FluidEffect;
use crate::rates::{FluidPair, PairEffect, PairRates};
use halfstep_scene::{ArtificialViscosity as Coefficients, Decision, Derived, EffectName, Fluid, Scene};
use halfstep_sph::lane::Arch;

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

impl<const D: usize> FluidEffect<D> for ArtificialViscosity {
    type Pair<'a> = Self;
    fn decide(scene: &Scene) -> Decision {
        let derived = match &scene.fluid {
            None => Derived::Impossible("the scene has no fluid".into()),
            Some(Fluid { artificial_viscosity: a, .. }) if a.linear == 0.0 && a.quadratic == 0.0 => {
                Derived::Impossible("fluid.artificial_viscosity is zero".into())
            }
            Some(Fluid { artificial_viscosity: a, .. }) => {
                Derived::On(format!("fluid.artificial_viscosity: A = {}, B = {}", a.linear, a.quadratic))
            }
        };
        Decision::new(scene, EffectName::ArtificialViscosity, derived)
    }
    fn pair(fluid: &crate::Fluid<D>) -> Self {
        fluid.artificial_viscosity
    }
}

impl<const D: usize> PairEffect<D> for ArtificialViscosity {
    type Own = ();
    #[inline(always)]
    fn own(&self, _: usize) {}

    #[inline(always)]
    fn add<A: Arch>(&self, _: &(), _: usize, pair: &FluidPair<D>, rates: &mut PairRates<D>) {
        rates.bracket = rates.bracket - pair.damping::<A>(self.smoothing_length, self.linear, self.quadratic);
    }
}
