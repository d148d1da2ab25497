//! The solid process: any [`SolidModel`] behind the half-step protocol.
//!
//! ```
//! use halfstep_solid::total_lagrangian::TotalLagrangian;
//! use halfstep_solid::{Load, SolidModel};
//! use halfstep_sph::lane::Isa;
//! use halfstep_wire::half_step::HalfStep;
//!
//! let text = "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, -9.81]\n[solid]\ndensity = 1000.0\n\
//!             youngs_modulus = 1e6\npoissons_ratio = 0.3\n[[shape]]\nname = \"block\"\nphase = \"solid\"\n\
//!             box = { min = [0.0, 0.0], max = [0.2, 0.1] }\n";
//! let scene = halfstep_scene::parse(text, "block.toml".as_ref(), &[]).expect("a right scene");
//! let mut block = TotalLagrangian::<2>::new(&scene, 0, Isa::detect()).expect("a solid");
//! let (dt, none) = (1e-5, Load::none(block.particles().len()));
//! for stage in HalfStep::begin(0, 0.0).lasting(dt).both() {
//!     block.advance(&stage, 1, &none).expect("within bounds");
//! }
//! // It falls freely.
//! assert!((block.particles().velocity[0][1] / (-9.81 * dt) - 1.0).abs() < 1e-9);
//! ```

mod account;
mod columns;
pub mod effects;
pub mod finite_element;
pub mod hypoelastic;
mod kernel_sum;
mod ledger;
pub mod model;
mod models;
mod probes;
pub mod rigid;
mod shown_velocity;
mod side_friction;
mod sleep;
pub mod solid;
mod strain;
mod sub_steps;
mod surface;
pub mod total_lagrangian;
mod verlet;
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
