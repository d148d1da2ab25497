//! A participant of a co-simulation, and the half-step loop that drives those of a process.

mod latency;
pub mod lockstep;
mod published;
pub mod report;
pub mod role;
pub mod serve;

pub use published::Published;
