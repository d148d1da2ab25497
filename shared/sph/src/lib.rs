//! Smoothed particle hydrodynamics without any scene: kernels, neighbours, the one pair pass and the terms that every
//! phase needs.
//!
//! ```
//! use halfstep_sph::kernel::{Kernel, WendlandC2};
//!
//! // In two dimensions W(0) = 7 / (4 pi h²), and nothing is beyond 2h.
//! let kernel = WendlandC2::<2>::new(0.1);
//! assert!((kernel.at(0.0) - 7.0 / (4.0 * std::f64::consts::PI * 0.01)).abs() < 1e-12);
//! assert_eq!(kernel.at(0.2), 0.0);
//! ```

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
pub mod viscosity;

pub use phase::Phase;
