//! Artificial viscosity between fluid and walls, and the wall guard.
//!
//! Between fluid and wall the same Pi_ij acts as between fluid particles (Kayaki's eq. 23), with the velocity that the
//! wall shows. The guard raises its A to 1 along free-slip walls: what the cross-phase f_i is between fluid and solid.
//! Without it single particles of a thin film sink into the wall by up to 1.7 dx before their pressure stops them
//! (elastic gate, 2.5 mm); with it 0.25 dx. There the wall shows the particle's own tangential velocity, so nothing
//! drags along it. No-slip walls and corners reverse the whole velocity and keep the scene's A: a guard would be
//! friction.

use super::artificial_viscosity::ArtificialViscosity;
use super::{FluidEffect, Listed};
use crate::columns::fit;
use crate::composition::{Composition, NoShare};
use crate::rates::{FluidPair, PairEffect, PairRates};
use crate::walls::Walls;
use halfstep_scene::{Decision, Derived, EffectName, Phase, Scene};
use halfstep_sph::lane::Arch;

/// A of the guard.
pub const GUARD: f64 = 1.0;

/// The effect.
#[derive(Clone, Debug)]
pub struct WallGuard<const D: usize> {
    smoothing_length: f64,
    /// A c0 where walls show the fluid's own tangential velocity, m/s.
    free_slip: f64,
    /// A c0 in corners and along no-slip walls, m/s.
    plain: f64,
    quadratic: f64,
    /// A c0 of each wall slot, m/s.
    linear: Vec<f64>,
}

impl<const D: usize> Listed<D> for WallGuard<D> {
    fn of(scene: &Scene) -> Option<Self> {
        let fluid = scene.fluid.as_ref()?;
        let acts = f64::from(u8::from(ArtificialViscosity::<D>::decide(scene).on));
        let plain = acts * fluid.artificial_viscosity.linear;
        Some(Self {
            smoothing_length: scene.smoothing_ratio * scene.resolution,
            free_slip: plain.max(GUARD) * fluid.sound_speed,
            plain: plain * fluid.sound_speed,
            quadratic: acts * fluid.artificial_viscosity.quadratic,
            linear: Vec::new(),
        })
    }
}

impl<const D: usize> FluidEffect<D> for WallGuard<D> {
    const NAME: &'static str = EffectName::WallGuard.name();
    type Pair<'a> = NoShare;
    type AtWall<'a> = GuardedViscosity<'a>;
    fn decide(scene: &Scene) -> Decision {
        let derived = match &scene.fluid {
            None => Derived::Impossible("the scene has no fluid".into()),
            Some(_) if !scene.shapes.iter().any(|s| s.phase == Phase::Wall && s.free_slip) => {
                Derived::Impossible("no free-slip walls".into())
            }
            Some(fluid) if fluid.artificial_viscosity.linear >= GUARD => {
                Derived::Impossible(format!("A is {GUARD} or more everywhere"))
            }
            Some(_) => Derived::On("keeps single particles out of walls".into()),
        };
        Decision::new(scene, EffectName::WallGuard, derived)
    }
    fn resize(&mut self, _: usize, walls: Option<&Walls<D>>) {
        let Some(walls) = walls else { return };
        fit(&mut self.linear, walls.slots(), 0.0);
        for (slot, linear) in self.linear.iter_mut().enumerate() {
            *linear = if walls.reverses_all(slot) { self.plain } else { self.free_slip };
        }
    }
    fn at_wall(&self) -> Option<GuardedViscosity<'_>> {
        let Self { smoothing_length, quadratic, linear, .. } = self;
        Some(GuardedViscosity { smoothing_length: *smoothing_length, linear, quadratic: *quadratic })
    }
    fn bytes(&self) -> usize {
        self.linear.capacity() * size_of::<f64>()
    }
}

/// The share of a pair of a fluid and a wall particle.
#[derive(Clone, Copy, Debug)]
pub struct GuardedViscosity<'a> {
    smoothing_length: f64,
    /// A c0 of each wall slot, m/s.
    linear: &'a [f64],
    quadratic: f64,
}

impl<const D: usize> PairEffect<D> for GuardedViscosity<'_> {
    type Own = ();
    #[inline(always)]
    fn own(&self, _: usize) {}

    #[inline(always)]
    fn add<A: Arch>(&self, _: &(), j: usize, pair: &FluidPair<D>, rates: &mut PairRates<D>) {
        rates.bracket =
            rates.bracket - pair.damping::<A>(self.smoothing_length, self.linear[j], self.quadratic);
    }
    fn enter<C: Composition<D>>(self, composition: C) {
        composition.with(self);
    }
    fn labels(labels: &mut Vec<&'static str>) {
        labels.push("guarded artificial viscosity");
    }
}
