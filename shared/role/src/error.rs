//! Why a process of participants ended.

use halfstep_link::LinkError;
use halfstep_wire::Name;
use halfstep_wire::failure::Diverged;
use halfstep_wire::frame::SinkError;

/// Why a process of participants ended before it was told to.
#[derive(Debug, thiserror::Error)]
pub enum RoleError {
    /// The exchange failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// A particle left its bounds, or moves so fast that the interface set may lack one.
    #[error(transparent)]
    Diverged(#[from] Diverged),
    /// A frame or a report cannot be written.
    #[error("{0}")]
    Output(SinkError),
    /// A participant of another process said that it ends.
    #[error("the {peer} ended the run at step {step}, stage {stage}")]
    PeerEnded {
        /// Who.
        peer: Name,
        /// Step n.
        step: u64,
        /// Stage of its message, as the number on the wire.
        stage: u32,
    },
    /// The process was not started as one of participants.
    #[error("{0}")]
    Start(String),
}
