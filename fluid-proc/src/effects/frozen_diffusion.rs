//! The renormalised density gradient of delta-SPH is computed at stage 0 only and used at both stages; the diffusion
//! itself is evaluated at both in any case. (Antuono, Colagrossi and Marrone 2012 freeze the whole diffusive term over
//! a step.) [`super::density_diffusion::DensityDiffusion`] has the gradient and asks whether this effect takes part.

use super::density_diffusion::DensityDiffusion;
use super::{FluidEffect, Listed};
use crate::composition::NoShare;
use halfstep_scene::{Decision, DensityDiffusion as Variant, Derived, EffectName, FluidIntegration, Scene};

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct FrozenDiffusion<const D: usize>;

impl<const D: usize> Listed<D> for FrozenDiffusion<D> {
    fn of(_: &Scene) -> Option<Self> {
        Some(Self)
    }
}

impl<const D: usize> FluidEffect<D> for FrozenDiffusion<D> {
    const NAME: &'static str = EffectName::FrozenDiffusion.name();
    type Pair<'a> = NoShare;
    type AtWall<'a> = NoShare;
    fn decide(scene: &Scene) -> Decision {
        let derived = match &scene.fluid {
            Some(fluid) if fluid.time_integration == FluidIntegration::Verlet => {
                Derived::Impossible("position Verlet needs the rate of the density once a step".into())
            }
            Some(fluid)
                if fluid.density_diffusion == Variant::DeltaSph
                    && DensityDiffusion::<D>::decide(scene).on =>
            {
                Derived::On("the density gradient of delta-SPH changes little in half a step".into())
            }
            _ => Derived::Impossible("only delta-SPH diffusion needs the density gradient".into()),
        };
        Decision::new(scene, EffectName::FrozenDiffusion, derived)
    }
}
