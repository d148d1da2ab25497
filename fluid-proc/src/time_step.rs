//! The fluid's stability limits (Monaghan 1992; Morris 1997):
//!   cfl h / (c0 + v),  0.25 sqrt(h / |a|),  0.125 h² rho / mu,
//! v and a the largest speed and acceleration, and of what damps sound by one evaluation (measured)
//!   1.4 h / (A c0),  0.25 h / (delta c0). With phase-blind coupling also 0.8 h rho_ij / (C c_ij max(rho_f,
//! rho_s)): the cross-phase viscosity acts on the lighter side with the heavier's mass. With the moving wall and a
//! light solid the first is divided by sqrt(rho_f / rho_s), and the third, where viscous stress crosses the interface,
//! by rho_f / rho_s.

use crate::effects::FluidEffect;
use crate::effects::artificial_viscosity::ArtificialViscosity;
use crate::effects::density_diffusion::DensityDiffusion;
use halfstep_scene::{Scene, Treatment};

/// dt A c0 / h of still water's limit: 1.56 holds, and with 1.8 the floor's pressure is wrong.
const ARTIFICIAL_VISCOSITY: f64 = 1.4;
/// dt delta c0 / h of still water's limit: 0.28 holds, 0.30 diverges.
const DENSITY_DIFFUSION: f64 = 0.25;

/// The limits that do not change during a run, and the factors of those that do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepLimits {
    courant: f64,
    smoothing_length: f64,
    sound_speed: f64,
    fixed: f64,
}

impl StepLimits {
    /// From a scene with fluid.
    pub fn new<const D: usize>(scene: &Scene) -> Self {
        let h = scene.smoothing_ratio * scene.resolution;
        let mut limits =
            Self { courant: scene.numerics.cfl, smoothing_length: h, sound_speed: 0.0, fixed: f64::INFINITY };
        let Some(fluid) = &scene.fluid else { return limits };
        limits.sound_speed = fluid.sound_speed;
        if fluid.viscosity > 0.0 {
            limits.fixed = 0.125 * h * h * fluid.density / fluid.viscosity;
        }
        if halfstep_interface::interface_viscosity(scene).on {
            let ratio = |solid| fluid.density / scene.lightest_density(solid);
            limits.fixed /= (0..scene.solids.len()).map(ratio).fold(1.0, f64::max);
        }
        let crossing = h / fluid.sound_speed;
        if ArtificialViscosity::<D>::decide(scene).on {
            limits.fixed =
                limits.fixed.min(ARTIFICIAL_VISCOSITY * crossing / fluid.artificial_viscosity.linear);
        }
        if DensityDiffusion::<D>::decide(scene).on {
            limits.fixed =
                limits.fixed.min(DENSITY_DIFFUSION * crossing / fluid.density_diffusion_coefficient);
        }
        let mut lightest = 1.0_f64;
        for (index, solid) in scene.solids.iter().enumerate() {
            if scene.interface.treatment == Treatment::MovingWall {
                lightest = lightest.max((fluid.density / scene.lightest_density(index)).sqrt());
            } else {
                let c = scene.interface.cross_viscosity * 0.5 * (fluid.sound_speed + solid.sound_speed());
                let mean = 0.5 * (fluid.density + solid.density);
                if c > 0.0 {
                    limits.fixed = limits.fixed.min(0.8 * h * mean / (c * fluid.density.max(solid.density)));
                }
            }
        }
        limits.courant /= lightest;
        limits
    }

    /// Largest time step for these largest speed and acceleration, s.
    pub fn time_step(&self, speed: f64, acceleration: f64) -> f64 {
        let courant = self.courant * self.smoothing_length / (self.sound_speed + speed);
        let force = if acceleration > 0.0 {
            0.25 * (self.smoothing_length / acceleration).sqrt()
        } else {
            f64::INFINITY
        };
        courant.min(force).min(self.fixed)
    }
}
