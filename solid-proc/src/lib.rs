//! The solid process: any [`SolidModel`] behind the half-step protocol.

mod columns;
pub mod effects;
pub mod hypoelastic;
pub mod model;
mod models;
mod sleep;
pub mod solid;
mod sub_steps;
mod surface;
pub mod total_lagrangian;
mod wall;

pub use model::{Load, OuterRates, Particles, SolidModel};
pub use solid::Solid;
pub use sub_steps::SubStepping;
