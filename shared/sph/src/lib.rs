//! Smoothed particle hydrodynamics without any scene: kernels, neighbours, the one pair pass and the terms that every
//! phase needs.

pub mod artificial_viscosity;
pub mod columns;
pub mod extrapolation;
pub mod fade;
pub mod kernel;
pub mod lane;
pub mod neighbours;
pub mod pair;
mod phase;
pub mod quantity;
pub mod state_equation;
pub mod tensor;

pub use phase::Phase;
