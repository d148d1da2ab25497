//! Why a run failed.

use crate::supervise::SuperviseError;
use halfstep_link::LinkError;
use halfstep_output::OutputError;
use halfstep_role::lockstep::RoleError;
use halfstep_wire::Name;
use halfstep_wire::failure::Diverged;
use halfstep_wire::state::StateError;
use std::fmt::{Display, Formatter};
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
    #[error("the {role} failed at step {step}{}", after_colon(said.as_deref()))]
    RoleFailed {
        /// Which.
        role: Name,
        /// Step n.
        step: u64,
        /// Its last words in the log.
        said: Option<String>,
    },
    /// A role's process ended.
    #[error("{0}")]
    RoleEnded(Box<RoleEnd>),
    /// Nobody started a solid.
    #[error(
        "nobody started a solid within {seconds} s (--solid-wait): {}",
        missing.iter().map(Name::to_string).collect::<Vec<_>>().join(", ")
    )]
    NoSolid {
        /// Who did not come.
        missing: Vec<Name>,
        /// How long was waited, s.
        seconds: f64,
    },
    /// Somebody stopped the run before its roles had met.
    #[error("stopped before the start")]
    StoppedEarly,
    /// A resumed run has not gone on.
    #[error("{0}: the run has not gone on, and its folder is as before")]
    NotGoneOn(Box<RunError>),
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
    /// A particle of a solid has another mass than before.
    #[error(
        "particle {particle} of the {solid} has a mass of {now} at step {step} and of {first} before: masses stay as \
         they were first published"
    )]
    MassChanged {
        /// Which solid.
        solid: Name,
        /// Number of the particle.
        particle: u32,
        /// At first, kg (2D: kg/m).
        first: f64,
        /// Now, kg (2D: kg/m).
        now: f64,
        /// Step n.
        step: u64,
    },
    /// A solid has nothing that the fluid could meet.
    #[error("the {solid} publishes no interface particles: a solid has at least one")]
    NoParticles {
        /// Which solid.
        solid: Name,
    },
    /// A particle of a solid is somewhere else from one state to the next.
    #[error(
        "the {solid} moved its particle {particle} by {distance:.3e} m at step {step}, although its particles are no \
         faster than {speed:.3e} m/s and the step is {dt:.3e} s: what its process sends does not belong together"
    )]
    Jump {
        /// Which solid.
        solid: Name,
        /// Number of the particle.
        particle: u32,
        /// How far, m.
        distance: f64,
        /// Largest speed of its particles, m/s.
        speed: f64,
        /// Time step, s.
        dt: f64,
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
    /// A participant cannot be set back.
    #[error("--on-divergence retry needs checkpoints, and the {participant} writes none")]
    NoCheckpoints {
        /// Which.
        participant: Name,
    },
    /// A checkpoint is not one of this run.
    #[error("cannot resume: {0}")]
    Resume(String),
    /// The operating system refused.
    #[error("{0}")]
    System(String),
}

impl RunError {
    /// Somebody stopped the run: nothing is wrong with it.
    pub fn is_stop(&self) -> bool {
        match self {
            Self::StoppedEarly | Self::StoppedAtOnce { .. } => true,
            Self::NotGoneOn(why) => why.is_stop(),
            _ => false,
        }
    }
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

/// How the process of a role ended while the run was going on.
#[derive(Debug)]
pub struct RoleEnd {
    /// Which.
    pub role: Name,
    /// How.
    pub status: ExitStatus,
    /// Step n and its time, s; `None`: the run had not begun.
    pub at: Option<(u64, f64)>,
    /// Its last words in the log.
    pub said: Option<String>,
    /// It is no program of the user's: one that ends with words has found the fault, at itself or at another.
    pub is_own: bool,
    /// What the coupler saw.
    pub link: LinkError,
}

impl Display for RoleEnd {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { role, status, link, .. } = self;
        let when = match self.at {
            Some((step, time)) => format!("at step {step}, t = {time:.6e} s"),
            None => "before the run had begun".into(),
        };
        match &self.said {
            Some(said) if self.is_own => {
                write!(f, "{said} (the {role} process ended with it, {status}, {when})")
            }
            Some(said) => write!(f, "the {role} process ended ({status}) {when}: {said}"),
            None if *link == LinkError::Aborted => write!(f, "the {role} process ended ({status}) {when}"),
            None => write!(f, "the {role} process ended ({status}) {when}: {link}"),
        }
    }
}

fn after_colon(said: Option<&str>) -> String {
    said.map_or_else(|| "; log.txt says why".into(), |said| format!(": {said}"))
}
