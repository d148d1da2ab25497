//! The coupler: the clock, the lock-step of all participants, the energy balance, and the processes that they run in.

pub mod clock;
pub mod couple;
pub mod energy;
pub mod error;
pub mod foreign;
pub mod recorder;
pub mod reports;
pub mod roles;
pub mod solo;
pub mod supervise;
