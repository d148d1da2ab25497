//! Lock-step channels between the roles of a run: the same code between processes and between threads.
//!
//! The fluid and the solid each hold a [`PhaseLink`]: they publish their interface state, read the other's published
//! state where it lies, and receive the cross-phase forces. The coupler holds a [`CouplerLink`]: it reads both states
//! and answers each with forces, the time step and an order. Nothing is overwritten, dropped or retried on another
//! step: whatever does not fit is a [`LinkError`] that says who sent what and what was expected.
//!
//! Waiting sleeps; it wakes when a message arrives, when the peer is gone, when the caller's abort flag is set or when
//! a live peer stays silent longer than [`LinkConfig::patience_seconds`]. `docs/protocol.md` describes the wire for
//! processes that are not written against this module.

mod channel;
mod check;
mod claim;
mod config;
mod coupler;
mod error;
mod hub;
mod memory;
mod phase;
mod slot;

pub use channel::{ForceSample, StateSample};
pub use check::Expect;
pub use claim::{Claim, cleanup, cleanup_stale};
pub use config::LinkConfig;
pub use coupler::CouplerLink;
pub use error::LinkError;
pub use phase::PhaseLink;
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
