//! What can go wrong on a link, and whose doing it is.

use halfstep_wire::Name;

/// Why a link could not be opened, or a message not be sent or accepted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinkError {
    /// A message arrived that is not the expected one.
    #[error("message of the {peer} at step {step}, stage {stage}: {field} is {found}, expected {expected}")]
    Mismatch {
        /// Who sent it.
        peer: Name,
        /// The field that differs.
        field: &'static str,
        /// The right value.
        expected: String,
        /// The value received.
        found: String,
        /// The step that the receiver is at.
        step: u64,
        /// The stage that the receiver is at, as its number on the wire.
        stage: u32,
    },
    /// A message carries an infinity or a NaN without saying that its sender failed.
    #[error(
        "message of the {peer} at step {step}, stage {stage}: {field} is {value}{}",
        particle.map(|id| format!(" for particle {id}")).unwrap_or_default()
    )]
    NotFinite {
        /// Who sent it.
        peer: Name,
        /// The field.
        field: &'static str,
        /// The particle; `None`: a field of the header.
        particle: Option<u32>,
        /// The value.
        value: f64,
        /// The step that the receiver is at.
        step: u64,
        /// The stage that the receiver is at, as its number on the wire.
        stage: u32,
    },
    /// A particle has a density or a mass that nothing has.
    #[error(
        "message of the {peer} at step {step}, stage {stage}: {field} is {value:e} for particle {particle}, expected a \
         positive number"
    )]
    NotPositive {
        /// Who sent it.
        peer: Name,
        /// The field.
        field: &'static str,
        /// The particle.
        particle: u32,
        /// The value.
        value: f64,
        /// The step that the receiver is at.
        step: u64,
        /// The stage that the receiver is at, as its number on the wire.
        stage: u32,
    },
    /// A peer ended or was killed while a message of it was due.
    #[error("the {peer} is gone: it ended without a last message")]
    PeerDied {
        /// Who.
        peer: Name,
    },
    /// A peer lives but has been silent for too long.
    #[error("no message of the {peer} for {seconds} s although it lives")]
    Timeout {
        /// Who.
        peer: Name,
        /// How long was waited.
        seconds: f64,
    },
    /// Not all roles came.
    #[error(
        "the {role} waited {seconds} s for the start of: {}",
        missing.iter().map(Name::to_string).collect::<Vec<_>>().join(", ")
    )]
    HandshakeTimeout {
        /// Who waited.
        role: Name,
        /// Who did not come.
        missing: Vec<Name>,
        /// How long was waited.
        seconds: f64,
    },
    /// The other side speaks another version of the protocol or opened a channel with other options.
    #[error("channel {service} is incompatible: {reason}")]
    Incompatible {
        /// The channel or variable.
        service: String,
        /// What differs.
        reason: String,
    },
    /// Another process of this run already plays this role.
    #[error("another process of this run already is the {role}")]
    RoleTaken {
        /// The role.
        role: Name,
    },
    /// More interface particles than the run has room for.
    #[error("the {peer} has {needed} interface particles, room is for {capacity}: raise `{key}`")]
    Capacity {
        /// Whose particles.
        peer: Name,
        /// How many there are.
        needed: usize,
        /// How many fit.
        capacity: usize,
        /// The scene's key that sets the capacity.
        key: &'static str,
    },
    /// Messages would not fit into the shared memory of the machine.
    #[error("shared memory is full: {needed} bytes are needed, {available} are free in /dev/shm")]
    SharedMemoryFull {
        /// Bytes the run needs.
        needed: u64,
        /// Bytes that are free.
        available: u64,
    },
    /// A process may not open as many files as it needs.
    #[error(
        "too few files can be opened: a run of these participants needs about {needed} at once, {available} are left \
         (ulimit -n)"
    )]
    Descriptors {
        /// How many are needed.
        needed: usize,
        /// How many there are.
        available: usize,
    },
    /// Somebody has made room for messages that the run does not have.
    #[error(
        "the run's objects in /dev/shm have {bytes} bytes, {expected} were expected: a participant of another program \
         makes room for more than its capacity"
    )]
    Oversized {
        /// Length of all of them.
        bytes: u64,
        /// What the run needs.
        expected: u64,
    },
    /// The caller's abort flag was set.
    #[error("aborted")]
    Aborted,
    /// The configuration does not hold together.
    #[error("link configuration: {key}: {reason}")]
    Config {
        /// Field or environment variable.
        key: &'static str,
        /// Why it cannot be used.
        reason: String,
    },
    /// A file or folder of the run could not be made or opened.
    #[error("{path}: {reason}")]
    Io {
        /// The path.
        path: String,
        /// What the system said.
        reason: String,
    },
    /// The transport failed.
    #[error("{action}: {reason}")]
    Transport {
        /// What was attempted.
        action: &'static str,
        /// What iceoryx2 said.
        reason: String,
    },
}

impl LinkError {
    /// The scene's key that sets the number of interface particles a message has room for.
    pub const CAPACITY_KEY: &'static str = "numerics.interface_capacity";

    pub(super) fn transport(action: &'static str, reason: impl std::fmt::Debug) -> Self {
        Self::Transport { action, reason: format!("{reason:?}") }
    }

    pub(super) fn io(path: &std::path::Path, reason: &std::io::Error) -> Self {
        Self::Io { path: path.display().to_string(), reason: reason.to_string() }
    }
}
