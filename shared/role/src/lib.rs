//! A participant of a co-simulation, and the half-step loop that drives one.

pub mod farewell;
mod latency;
pub mod lockstep;
pub mod role;
