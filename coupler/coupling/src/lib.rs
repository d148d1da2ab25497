//! The coupler: the clock, the lock-step of all participants, the energy balance, and the processes that they run in.

pub mod checkpoints;
pub mod clock;
pub mod couple;
pub mod energy;
pub mod error;
pub mod foreign;
pub mod local;
pub mod recorder;
pub mod reports;
pub mod roles;
pub mod say;
pub mod supervise;
