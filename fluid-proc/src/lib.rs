//! The fluid process: a weakly compressible liquid with delta-SPH and the walls around it.
//!
//! Midpoint steps (Kayaki's eqs. 30 and 31) over particles sorted into rows; each physical or numerical effect is a type
//! that adds its share to one pass over the neighbours.

pub mod artificial_viscosity;
pub mod columns;
pub mod density_diffusion;
pub mod density_gradient;
pub mod fluid;
pub mod interface;
pub mod measure;
pub mod momentum;
pub mod rates;
#[cfg(test)]
mod fluid_tests;
#[cfg(test)]
mod term_tests;
pub mod time_step;
pub mod viscosity;
pub mod wall;

pub use fluid::Fluid;

use halfstep_shared::scene::Scene;

/// Whether the physical viscosity of a scene shows beside the artificial one: its kinematic viscosity is at least 1 %
/// of A h c0 / 8 (Monaghan 2005, two dimensions), or there is no artificial one.
pub fn viscosity_matters(scene: &Scene) -> bool {
    viscosity_share(scene).is_some_and(|share| share >= 0.01)
}

/// Physical over artificial kinematic viscosity; `None` without fluid or without physical viscosity.
pub fn viscosity_share(scene: &Scene) -> Option<f64> {
    let fluid = scene.fluid.as_ref().filter(|f| f.viscosity > 0.0)?;
    let h = scene.smoothing_ratio * scene.resolution;
    let artificial = fluid.artificial_viscosity.linear * h * fluid.sound_speed / 8.0;
    Some(fluid.viscosity / fluid.density / artificial)
}
