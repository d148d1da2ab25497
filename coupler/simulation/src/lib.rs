//! The front door: runs scenes, couples fluid and solid in lock-step, writes what a run leaves.

mod advice;
pub mod check;
mod effects;
pub mod explain;
pub mod isa;
pub mod options;
mod participants;
pub mod run;
mod session;
mod step_cost;
