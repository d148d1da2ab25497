//! Monaghan's artificial viscosity between fluid particles: -Pi_ij of [`halfstep_sph::artificial_viscosity`] in the
//! bracket of the momentum equation, Kayaki's eq. (22).

use super::wall_guard::WallGuard;
use super::{FluidEffect, Listed};
use crate::composition::Composition;
use crate::rates::{FluidPair, PairEffect, PairRates};
use halfstep_scene::{ArtificialViscosity as Coefficients, Decision, EffectName, Scene};
use halfstep_sph::lane::{Arch, Lanes};

/// The effect, and its share of a pair.
#[derive(Clone, Copy, Debug)]
pub struct ArtificialViscosity<const D: usize> {
    smoothing_length: f64,
    /// A c0.
    linear: f64,
    quadratic: f64,
    /// It acts between fluid and walls, too.
    at_walls: bool,
}

impl<const D: usize> ArtificialViscosity<D> {
    /// Between fluid particles, with the fluid's sound speed c0 for c.
    pub fn new(coefficients: Coefficients, sound_speed: f64, smoothing_length: f64) -> Self {
        Self {
            smoothing_length,
            linear: coefficients.linear * sound_speed,
            quadratic: coefficients.quadratic,
            at_walls: false,
        }
    }
}

impl<const D: usize> Listed<D> for ArtificialViscosity<D> {
    fn of(scene: &Scene) -> Option<Self> {
        let fluid = scene.fluid.as_ref()?;
        let h = scene.smoothing_ratio * scene.resolution;
        // The wall guard is the viscosity at all walls with a larger A along some.
        let at_walls = !WallGuard::<D>::decide(scene).on;
        Some(Self { at_walls, ..Self::new(fluid.artificial_viscosity, fluid.sound_speed, h) })
    }
}

impl<const D: usize> FluidEffect<D> for ArtificialViscosity<D> {
    const NAME: &'static str = EffectName::ArtificialViscosity.name();
    type Pair<'a> = Self;
    type AtWall<'a> = Self;
    fn decide(scene: &Scene) -> Decision {
        halfstep_scene::artificial_viscosity(scene)
    }
    fn pair(&self) -> Option<Self> {
        Some(*self)
    }
    fn at_wall(&self) -> Option<Self> {
        self.at_walls.then_some(*self)
    }
}

impl<const D: usize> PairEffect<D> for ArtificialViscosity<D> {
    type Own<L: Lanes> = ();
    const CONTINUITY: bool = false;
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}

    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, pair: &FluidPair<D, L>, rates: &mut PairRates<D, L>) {
        let linear = L::splat(self.linear);
        rates.bracket = rates.bracket - pair.damping::<A>(self.smoothing_length, linear, self.quadratic);
    }
    fn enter<C: Composition<D>>(self, composition: C) {
        composition.with(self);
    }
    fn labels(labels: &mut Vec<&'static str>) {
        labels.push("artificial viscosity");
    }
}
