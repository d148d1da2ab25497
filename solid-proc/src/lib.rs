//! The solid process: any [`SolidModel`] behind the half-step protocol.

pub mod hypoelastic;
pub mod model;
pub mod solid;

pub use model::{Load, SolidModel};
pub use solid::Solid;
