//! What reads bytes that somebody else wrote, each as a function of those bytes that panics where something is wrong.
//!
//! `make fuzz` lets a coverage-guided fuzzer (libFuzzer, Serebryany 2016) look for such bytes; what it found worth
//! keeping is in `corpus`, and a test gives all of it to these functions again.

mod checkpoint;
mod message;
mod scene;

pub use checkpoint::checkpoint;
pub use message::message;
pub use scene::{curve, drawing, outline, scene};
