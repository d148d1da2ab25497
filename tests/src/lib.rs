//! Suites that every implementation of a seam must pass, and what tests need that run whole scenes.

pub mod baseline;
pub mod beam;
pub mod cluster;
pub mod conformance;
pub mod curve;
pub mod finite_elements;
pub mod fluid_alone;
pub mod linear_waves;
pub mod patch;
pub mod process;
pub mod python;
pub mod run;
pub mod soak;
pub mod sources;
pub mod stability;
pub mod torture;
pub mod written;

pub use curve::Curve;
pub use run::{Finished, Outcome, RunBuilder, Running, repository, scene, scene_at};
pub use written::Written;
