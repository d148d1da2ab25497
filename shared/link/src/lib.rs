//! Lock-step channels between the roles of a run: the same code between processes and between threads.
//!
//! A process of participants (the fluid, one solid or several) holds a [`ProcessLink`]: it publishes their interface
//! states, reads the states of the other phase and receives the cross-phase forces. The coupler holds a
//! [`CouplerLink`]: it reads all states and answers each with forces, the time step and an order. [`Port`] is what the
//! half-step loop sees of it. Nothing is overwritten, dropped or retried on another
//! step: whatever does not fit is a [`LinkError`] that says who sent what and what was expected.
//!
//! Waiting sleeps; it wakes when a message arrives, when the peer is gone, when the caller's abort flag is set or when
//! a live peer stays silent longer than [`LinkConfig::patience_seconds`]. `docs/protocol.md` describes the wire for
//! processes that are not written against this module.
//!
//! ```
//! use halfstep_link::LinkConfig;
//!
//! // Room for 100 fluid and 20 solid particles in a message; every process of the run gets the same variables.
//! let config = LinkConfig::of_two(100, 20);
//! let variables = config.to_env();
//! assert!(variables.iter().any(|(key, value)| *key == "HALFSTEP_PARTICIPANTS" && value == "fluid:100,solid:20"));
//! ```

mod answer;
mod awake;
mod channel;
mod check;
mod claim;
mod config;
mod coupler;
mod descriptors;
mod error;
mod hub;
mod memory;
mod port;
mod process;
mod records;
mod slot;
mod verdict;

pub use answer::verify_forces;
pub use channel::{ForceSample, ProbeSample, StateSample};
pub use check::{Expect, Identities, StateCheck, verify_probes};
pub use claim::{Claim, cleanup, cleanup_stale};
pub use config::{FLUID, LinkConfig, Participant};
pub use coupler::CouplerLink;
pub use descriptors::{check_descriptors, raise_descriptor_limit};
pub use error::LinkError;
pub use memory::{check_all_room, free_space};
pub use port::{CouplerPort, Port, StateMessage};
pub use process::ProcessLink;
pub use slot::Slot;

use iceoryx2::prelude::{ipc, local};
use iceoryx2::service::Service;
use std::time::Duration;

/// How messages travel.
pub trait Transport: Service + 'static {
    /// Whether messages lie in `/dev/shm` (else on the heap of the only process).
    const SHARED_MEMORY: bool;
}

/// Roles are processes.
pub type Processes = ipc::Service;
/// Roles are threads of one process. A link is created in the thread that uses it.
pub type Threads = local::Service;

impl Transport for Processes {
    const SHARED_MEMORY: bool = true;
}

impl Transport for Threads {
    const SHARED_MEMORY: bool = false;
}

/// Where a link's time went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkTimes {
    /// Asleep, waiting for messages of others.
    pub wait: Duration,
    /// Copying, sending, notifying, checking.
    pub exchange: Duration,
}
