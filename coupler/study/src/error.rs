//! Why a study cannot be made.

use halfstep_output::OutputError;
use halfstep_scene::SceneErrors;

/// Why a study cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A scene of the ladder is not valid.
    #[error(transparent)]
    Scene(#[from] SceneErrors),
    /// The command line asks for what the scene does not have.
    #[error("{0}")]
    Usage(String),
    /// A file could not be read or written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The operating system refused.
    #[error("{0}")]
    System(String),
}

impl StudyError {
    /// From what the system said about something.
    pub(crate) fn system(what: impl std::fmt::Display) -> impl FnOnce(std::io::Error) -> Self {
        move |error| Self::System(format!("{what}: {error}"))
    }
}
