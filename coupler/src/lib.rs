//! The front door: runs scenes, couples fluid and solid in lock-step, writes what a run leaves.

mod advice;
pub mod check;
pub mod clock;
pub mod couple;
pub mod cross_viscosity;
pub mod effects;
pub mod energy;
pub mod error;
pub mod explain;
pub mod foreign;
pub mod recorder;
pub mod roles;
pub mod run;
mod session;
pub mod solo;
pub mod study;
pub mod supervise;
