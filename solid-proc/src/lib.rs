//! The solid process: any [`SolidModel`] behind the half-step protocol.

mod columns;
pub mod effects;
pub mod hypoelastic;
pub mod model;
mod models;
mod shown_velocity;
mod sleep;
pub mod solid;
mod sub_steps;
mod surface;
pub mod total_lagrangian;
mod wall;

pub use model::{Load, OuterRates, Particles, SolidModel};
pub use solid::Solid;
pub use sub_steps::SubStepping;

use halfstep_role::role::Role;
use halfstep_scene::{Scene, dispatch};
use halfstep_sph::lane::Isa;

/// A solid of a scene, by its place in [`Scene::solids`], as a participant; `None` where there is none.
pub fn role(scene: &Scene, solid: usize, isa: Isa) -> Option<Box<dyn Role>> {
    let boxed = dispatch!(scene.dimension, D => {
        Solid::<D>::new(scene, solid, isa).map(|solid| Box::new(solid) as Box<dyn Role>)
    });
    boxed.flatten()
}
