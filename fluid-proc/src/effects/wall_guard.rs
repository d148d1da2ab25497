//! Artificial viscosity between fluid and walls, and the wall guard.
//!
//! Between fluid and wall the same Pi_ij acts as between fluid particles (Kayaki's eq. 23), with the velocity that the
//! wall shows. The guard raises its A to 1 between a free-slip wall and what is close to it: fully below dx, fading
//! to the scene's A at 1.5 dx; with a wide kernel to 8 below 0.75 dx, fading until dx. What the cross-phase f_i is
//! between fluid and solid, it is here: without it single particles of a thin film sink into the wall by up to 1.7 dx
//! before their pressure stops them.
//!
//! Its reach is its price. A wall shows the mean tangential velocity of the water within 2h, so a stream that stretches
//! or thins along the wall approaches some of the wall's particles, and a guard over all of 2h brakes it: like a
//! boundary layer. No-slip walls and corners reverse the whole velocity and keep the scene's A: a guard would be
//! friction.

use super::artificial_viscosity::ArtificialViscosity;
use super::{FluidEffect, Listed};
use crate::columns::fit;
use crate::composition::{Composition, NoShare};
use crate::rates::{FluidPair, PairEffect, PairRates};
use crate::walls::Walls;
use halfstep_scene::{Decision, Derived, EffectName, Phase, Scene};
use halfstep_sph::fade::Fade;
use halfstep_sph::lane::{Arch, Lanes};

/// A of the guard, up to where it is whole, and from where on there is none, over the spacing. With the narrow kernel a
/// reach of 1.25 lets water into corners by 0.7 dx.
const NARROW: [f64; 3] = [1.0, 1.0, 1.5];
/// The same with a wide kernel, which is flat at its middle.
const WIDE: [f64; 3] = [8.0, 0.75, 1.0];

fn guard(scene: &Scene) -> [f64; 3] {
    if scene.has_wide_support() { WIDE } else { NARROW }
}

/// The effect.
#[derive(Clone, Debug)]
pub struct WallGuard<const D: usize> {
    smoothing_length: f64,
    fade: Fade,
    /// A c0 far from walls, in corners and along no-slip walls, m/s.
    plain: f64,
    /// What a close free-slip wall adds to it, m/s.
    guard: f64,
    quadratic: f64,
    /// What each wall slot adds, m/s.
    added: Vec<f64>,
}

impl<const D: usize> Listed<D> for WallGuard<D> {
    fn of(scene: &Scene) -> Option<Self> {
        let fluid = scene.fluid.as_ref()?;
        let acts = f64::from(u8::from(ArtificialViscosity::<D>::decide(scene).on));
        let plain = acts * fluid.artificial_viscosity.linear;
        let (dx, c0) = (scene.resolution, fluid.sound_speed);
        let [strength, full, gone] = guard(scene);
        Some(Self {
            smoothing_length: scene.smoothing_ratio * dx,
            fade: Fade::new(full * dx, gone * dx),
            plain: plain * c0,
            guard: (strength - plain).max(0.0) * c0,
            quadratic: acts * fluid.artificial_viscosity.quadratic,
            added: Vec::new(),
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
            Some(fluid) if fluid.artificial_viscosity.linear >= guard(scene)[0] => {
                Derived::Impossible(format!("A is {} or more everywhere", guard(scene)[0]))
            }
            Some(_) => Derived::On("keeps single particles out of walls".into()),
        };
        Decision::new(scene, EffectName::WallGuard, derived)
    }
    fn resize(&mut self, _: usize, walls: Option<&Walls<D>>) {
        let Some(walls) = walls else { return };
        fit(&mut self.added, walls.slots(), 0.0);
        for (slot, added) in self.added.iter_mut().enumerate() {
            *added = if walls.reverses_all(slot) { 0.0 } else { self.guard };
        }
    }
    fn at_wall(&self) -> Option<GuardedViscosity<'_>> {
        let Self { smoothing_length, fade, plain, quadratic, added, .. } = self;
        Some(GuardedViscosity {
            smoothing_length: *smoothing_length,
            fade: *fade,
            plain: *plain,
            added,
            quadratic: *quadratic,
        })
    }
    fn bytes(&self) -> usize {
        self.added.capacity() * size_of::<f64>()
    }
}

/// The share of a pair of a fluid and a wall particle.
#[derive(Clone, Copy, Debug)]
pub struct GuardedViscosity<'a> {
    smoothing_length: f64,
    fade: Fade,
    /// A c0 far from walls, m/s.
    plain: f64,
    /// What each wall slot adds where it is close, m/s.
    added: &'a [f64],
    quadratic: f64,
}

impl<const D: usize> PairEffect<D> for GuardedViscosity<'_> {
    type Own<L: Lanes> = ();
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}

    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), j: usize, pair: &FluidPair<D, L>, rates: &mut PairRates<D, L>) {
        let near = self.fade.at(pair.r2.sqrt());
        let linear = A::mul_add(L::splat(self.added[j]), near, L::splat(self.plain));
        rates.bracket = rates.bracket - pair.damping::<A>(self.smoothing_length, linear, self.quadratic);
    }
    fn enter<C: Composition<D>>(self, composition: C) {
        composition.with(self);
    }
    fn labels(labels: &mut Vec<&'static str>) {
        labels.push("guarded artificial viscosity");
    }
}
