//! Why a run failed.

use crate::supervise::SuperviseError;
use halfstep_link::LinkError;
use halfstep_output::OutputError;
use halfstep_role::lockstep::RoleError;
use halfstep_wire::Name;
use halfstep_wire::failure::Diverged;
use halfstep_wire::state::StateError;
use std::process::ExitStatus;

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A quantity left its bounds.
    #[error("{diverged}{}{hint}", if hint.is_empty() { "" } else { "\nhint: " })]
    Diverged {
        /// Whose and which.
        diverged: Diverged,
        /// What to change in the scene; empty until the run knows.
        hint: String,
    },
    /// A role gave up.
    #[error("the {role} failed at step {step}; log.txt says why")]
    RoleFailed {
        /// Which.
        role: Name,
        /// Step n.
        step: u64,
    },
    /// A role's process ended.
    #[error("the {role} process ended ({status}) while the run was going on: {link}")]
    RoleEnded {
        /// Which.
        role: Name,
        /// How.
        status: ExitStatus,
        /// What the coupler saw.
        link: Box<LinkError>,
    },
    /// Nobody started a solid.
    #[error("no solid came within {seconds} s (--solid-wait)")]
    NoSolid {
        /// How long was waited, s.
        seconds: f64,
    },
    /// Somebody stopped the run before its roles had met.
    #[error("stopped before the start")]
    StoppedEarly,
    /// Somebody stopped the run while a role was silent.
    #[error("stopped without waiting for the {role}, which has been silent for {seconds:.1} s")]
    StoppedAtOnce {
        /// Which.
        role: Name,
        /// For how long, s.
        seconds: f64,
    },
    /// The solid changed the size of its interface set.
    #[error(
        "the {solid} published {now} interface particles at step {step} and {first} before; the number is fixed"
    )]
    SolidCount {
        /// Which solid.
        solid: Name,
        /// At first.
        first: u64,
        /// Now.
        now: u64,
        /// Step n.
        step: u64,
    },
    /// The exchange failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// A file could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A process could not be started.
    #[error(transparent)]
    Supervise(#[from] SuperviseError),
    /// A role in this process failed.
    #[error(transparent)]
    Role(RoleError),
    /// A checkpoint is not one of this run.
    #[error("cannot resume: {0}")]
    Resume(String),
    /// The operating system refused.
    #[error("{0}")]
    System(String),
}

impl From<Diverged> for RunError {
    fn from(diverged: Diverged) -> Self {
        Self::Diverged { diverged, hint: String::new() }
    }
}

impl From<StateError> for RunError {
    fn from(error: StateError) -> Self {
        Self::Resume(error.to_string())
    }
}

impl From<RoleError> for RunError {
    fn from(error: RoleError) -> Self {
        match error {
            RoleError::Diverged(diverged) => diverged.into(),
            other => Self::Role(other),
        }
    }
}
