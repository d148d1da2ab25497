//! The fluid process: a weakly compressible liquid with delta-SPH and the walls around it.
//!
//! Midpoint steps (Kayaki's eqs. 30 and 31) over particles sorted into rows; each physical or numerical effect is a type
//! that adds its share to one pass over the neighbours.

pub mod artificial_viscosity;
pub mod columns;
pub mod density_diffusion;
pub mod density_gradient;
pub mod fluid;
#[cfg(test)]
mod fluid_tests;
pub mod interface;
pub mod measure;
pub mod midpoint;
pub mod momentum;
pub mod rates;
#[cfg(test)]
mod term_tests;
pub mod time_step;
pub mod viscosity;
pub mod wall;
pub mod wall_guard;

pub use fluid::Fluid;

use halfstep_shared::scene::{EffectName, Scene, Switch};

/// Physical over artificial kinematic viscosity below which the physical one is left out.
pub const SMALLEST_VISCOSITY_SHARE: f64 = 0.01;

/// Whether the physical viscosity of a scene is computed: as the user says; else if its kinematic viscosity is at least
/// [`SMALLEST_VISCOSITY_SHARE`] of the artificial one.
pub fn viscosity_acts(scene: &Scene) -> bool {
    match (scene.switch(EffectName::Viscosity), viscosity_share(scene)) {
        (Switch::Off, _) | (_, None) => false,
        (Switch::On, Some(_)) => true,
        (Switch::Auto, Some(share)) => share >= SMALLEST_VISCOSITY_SHARE,
    }
}

/// Physical over artificial kinematic viscosity A h c0 / 8 (Monaghan 2005, two dimensions); infinite without artificial
/// one, `None` without fluid or without physical one.
pub fn viscosity_share(scene: &Scene) -> Option<f64> {
    let fluid = scene.fluid.as_ref().filter(|f| f.viscosity > 0.0)?;
    let h = scene.smoothing_ratio * scene.resolution;
    let artificial = fluid.artificial_viscosity.linear * h * fluid.sound_speed / 8.0;
    Some(fluid.viscosity / fluid.density / artificial)
}
