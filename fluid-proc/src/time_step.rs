//! The fluid's stability limits (Monaghan 1992; Morris 1997):
//!   cfl h / (c0 + v),  0.25 sqrt(h / |a|),  0.125 h² rho / mu,
//! v and a the largest speed and acceleration, and of what damps sound by one evaluation (measured)
//!   1.4 h / (A c0),  0.25 h / (delta c0). The third and the fourth damp the same waves: their inverses add up. With
//! phase-blind coupling also 0.8 h rho_ij / (C c_ij max(rho_f, rho_s)): the cross-phase viscosity acts on the lighter
//! side with the heavier's mass. With the moving wall and a light solid the first is divided by sqrt(rho_f / rho_s),
//! and the third, where viscous stress crosses the interface, by rho_f / rho_s + 0.4: it moves both sides. There the
//! inverses of the first and the third add up, too: near both limits a plate in oil gains energy.

use crate::effects::FluidEffect;
use crate::effects::artificial_viscosity::ArtificialViscosity;
use crate::effects::density_diffusion::DensityDiffusion;
use halfstep_scene::{Scene, Treatment};

/// dt A c0 / h of still water's limit: 1.56 holds, and with 1.8 the floor's pressure is wrong.
const ARTIFICIAL_VISCOSITY: f64 = 1.4;
/// What is added to rho_f / rho_s: a solid of few rows gives way to the water that drags it, and shows that twice. With
/// it no arrangement of rows that was tried decays at more than 1.9 over a step, without it two rows of the water's
/// density at 2.3, where explicit steps bear 2.
const BESIDE_THIN_SOLIDS: f64 = 0.4;
/// dt delta c0 / h of still water's limit: 0.28 holds, 0.30 diverges.
const DENSITY_DIFFUSION: f64 = 0.25;

/// The limits that do not change during a run, and the factors of those that do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepLimits {
    courant: f64,
    smoothing_length: f64,
    sound_speed: f64,
    fixed: f64,
    /// 1 / s of viscous stress at solids, which adds to the inverse of the Courant limit.
    dragging: f64,
}

impl StepLimits {
    /// From a scene with fluid.
    pub fn new<const D: usize>(scene: &Scene) -> Self {
        let h = scene.smoothing_ratio * scene.resolution;
        let mut limits = Self {
            courant: scene.numerics.cfl,
            smoothing_length: h,
            sound_speed: 0.0,
            fixed: f64::INFINITY,
            dragging: 0.0,
        };
        let Some(fluid) = &scene.fluid else { return limits };
        limits.sound_speed = fluid.sound_speed;
        let mut fastest = 0.0;
        if fluid.viscosity > 0.0 {
            fastest = 8.0 * fluid.viscosity / (fluid.density * h * h);
        }
        if halfstep_interface::interface_viscosity(scene).on {
            let ratio = |solid| fluid.density / scene.lightest_density(solid) + BESIDE_THIN_SOLIDS;
            fastest *= (0..scene.solids.len()).map(ratio).fold(1.0, f64::max);
            limits.dragging = fastest;
        }
        let crossing = h / fluid.sound_speed;
        if ArtificialViscosity::<D>::decide(scene).on {
            fastest += fluid.artificial_viscosity.linear / (ARTIFICIAL_VISCOSITY * crossing);
        }
        limits.fixed = 1.0 / fastest;
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
        // Scenes without viscous stress at solids keep the Courant limit to the last digit.
        let courant = if self.dragging > 0.0 { 1.0 / (1.0 / courant + self.dragging) } else { courant };
        courant.min(force).min(self.fixed)
    }
}
