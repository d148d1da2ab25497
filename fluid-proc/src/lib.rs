//! The fluid process: a weakly compressible liquid with delta-SPH and the walls around it.
//!
//! Steps of position Verlet or of the midpoint rule (Kayaki's eqs. 30 and 31) over particles sorted into rows; each
//! physical or numerical effect is a type that adds its share to one pass over the neighbours.
//!
//! ```
//! use halfstep_fluid::Fluid;
//! use halfstep_role::role::Role;
//! use halfstep_sph::lane::Isa;
//!
//! let text = "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
//!             phase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [1.0, 0.5] }\n";
//! let scene = halfstep_scene::parse(text, "water.toml".as_ref(), &[]).expect("a right scene");
//! let fluid = Fluid::<2>::new(&scene, Isa::detect()).expect("a scene with fluid");
//! assert_eq!(fluid.particles(), 50);
//! assert!((fluid.audit().mass - 500.0).abs() < 1e-9, "kg for a metre of depth");
//! ```

pub mod columns;
#[doc(hidden)]
pub mod compiled;
pub mod composition;
pub mod effects;
pub mod equations;
pub mod fluid;
#[cfg(test)]
mod fluid_tests;
pub mod integration;
pub mod interface;
pub mod ledger;
pub mod measure;
mod memory;
pub mod midpoint;
pub mod momentum;
#[cfg(test)]
mod motion_tests;
mod passes;
#[cfg(test)]
mod prediction_tests;
#[cfg(test)]
mod probe_tests;
mod probes;
pub mod rates;
#[cfg(test)]
mod rider_tests;
mod riders;
#[cfg(test)]
mod separation_tests;
pub mod shifting_sums;
#[cfg(test)]
mod shifting_tests;
mod state;
#[cfg(test)]
mod term_tests;
pub mod time_step;
pub mod verlet;
pub mod walls;

pub use fluid::Fluid;

use halfstep_role::role::Role;
use halfstep_scene::{Scene, dispatch};
use halfstep_sph::lane::Isa;

/// The fluid of a scene as a participant, with the passes compiled in this crate; `None` without a fluid.
pub fn role(scene: &Scene, isa: Isa) -> Option<Box<dyn Role>> {
    let boxed = dispatch!(scene.dimension, D => {
        Fluid::<D>::new(scene, isa).map(|fluid| Box::new(fluid) as Box<dyn Role>)
    });
    boxed.flatten()
}
