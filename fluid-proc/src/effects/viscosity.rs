//! Physical viscosity between fluid particles, and between fluid and walls: the pair force of
//! [`halfstep_sph::viscosity`] against the velocities that walls show. Between fluid and solids it is part of the
//! interface ([`super::interface_viscosity`]).

use super::{FluidEffect, Listed};
use crate::composition::Composition;
use crate::rates::{FluidPair, PairEffect, PairRates};
use halfstep_scene::{Decision, EffectName, Scene};
use halfstep_sph::kernel::KernelName;
use halfstep_sph::lane::{Arch, Lanes};
use halfstep_sph::viscosity::strength;

/// The effect, and its share of a pair.
#[derive(Clone, Copy, Debug)]
pub struct Viscosity<const D: usize> {
    /// 2 D mu / <r²>, Pa s / m².
    strength: f64,
}

impl<const D: usize> Viscosity<D> {
    /// Of a viscosity mu, Pa s, with a kernel of smoothing length h, m.
    pub fn new(viscosity: f64, kernel: KernelName, smoothing_length: f64) -> Self {
        Self { strength: strength::<D>(viscosity, kernel, smoothing_length) }
    }
}

impl<const D: usize> Listed<D> for Viscosity<D> {
    fn of(scene: &Scene) -> Option<Self> {
        let h = scene.smoothing_ratio * scene.resolution;
        Some(Self::new(scene.fluid.as_ref()?.viscosity, scene.numerics.kernel, h))
    }
}

impl<const D: usize> FluidEffect<D> for Viscosity<D> {
    const NAME: &'static str = EffectName::Viscosity.name();
    type Pair<'a> = Self;
    type AtWall<'a> = Self;
    fn decide(scene: &Scene) -> Decision {
        halfstep_scene::viscosity(scene)
    }
    fn pair(&self) -> Option<Self> {
        Some(*self)
    }
    fn at_wall(&self) -> Option<Self> {
        Some(*self)
    }
}

impl<const D: usize> PairEffect<D> for Viscosity<D> {
    type Own<L: Lanes> = ();
    const CONTINUITY: bool = false;
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, pair: &FluidPair<D, L>, rates: &mut PairRates<D, L>) {
        let strength = L::splat(self.strength);
        rates.bracket += strength * pair.approach / (pair.density_i * pair.density_j);
    }
    fn enter<C: Composition<D>>(self, composition: C) {
        composition.with(self);
    }
    fn labels(labels: &mut Vec<&'static str>) {
        labels.push("viscosity");
    }
}
