//! Artificial viscosity between fluid and walls, and the wall guard.
//!
//! Between fluid and wall the same Pi_ij acts as between fluid particles (Kayaki's eq. 23), with the velocity that the
//! wall shows. The guard raises its A to 1 along free-slip walls: what the cross-phase f_i is between fluid and solid.
//! Without it single particles of a thin film sink into the wall by up to 1.7 dx before their pressure stops them (elastic
//! gate, 2.5 mm); with it 0.25 dx. There the wall shows the particle's own tangential velocity, so nothing drags along
//! it. No-slip walls and corners reverse the whole velocity and keep the scene's A: a guard would be friction.

use crate::rates::{FluidPair, PairEffect, PairRates};
use halfstep_scene::{Decision, Derived, EffectName, Phase, Scene};
use halfstep_sph::lane::Arch;

/// A of the guard.
pub const GUARD: f64 = 1.0;

/// Whether the guard acts.
pub fn decide(scene: &Scene) -> Decision {
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

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct WallViscosity<'a> {
    /// Smoothing length h, m.
    pub smoothing_length: f64,
    /// A c0 of each wall slot, m/s.
    pub linear: &'a [f64],
    /// B.
    pub quadratic: f64,
}

impl<const D: usize> PairEffect<D> for WallViscosity<'_> {
    type Own = ();
    #[inline(always)]
    fn own(&self, _: usize) {}

    #[inline(always)]
    fn add<A: Arch>(&self, _: &(), j: usize, pair: &FluidPair<D>, rates: &mut PairRates<D>) {
        rates.bracket =
            rates.bracket - pair.damping::<A>(self.smoothing_length, self.linear[j], self.quadratic);
    }
}
