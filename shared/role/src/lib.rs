//! A participant of a co-simulation, and the half-step loop that drives those of a process.
//!
//! A participant implements [`role::Role`]; [`lockstep::drive`] takes it through the half-steps over any
//! [`halfstep_link::Port`], and [`serve::serve_process`] is the `main` of a process of participants.
//!
//! ```
//! use halfstep_role::serve::on_threads;
//!
//! // Sums over neighbours share the pool that they are called in.
//! assert_eq!(on_threads(2, || 6 * 7).expect("two threads"), 42);
//! ```

pub mod awake;
pub mod balance;
mod error;
mod latency;
pub mod ledger;
pub mod lockstep;
mod member;
mod published;
pub mod report;
pub mod role;
pub mod serve;
pub mod timeline;
mod track;

pub use member::Member;
pub use published::Published;
