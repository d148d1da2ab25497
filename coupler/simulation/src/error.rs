//! What can go wrong in a program that uses the library.

use halfstep_coupling::error::RunError;
use halfstep_output::OutputError;
use halfstep_role::lockstep::RoleError;
use halfstep_scene::SceneErrors;

/// Why a simulation could not be made or did not finish.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene is wrong; all of its errors, each with its place.
    #[error("{0}{problems}", problems = problems(.0))]
    Scene(#[from] SceneErrors),
    /// The run failed or diverged.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The simulation was put together in a way that cannot run.
    #[error("{0}")]
    Setup(String),
}

/// All errors of a scene, a line each.
fn problems(errors: &SceneErrors) -> String {
    errors.problems.iter().map(|problem| format!("\n{problem}")).collect()
}

impl From<OutputError> for Error {
    fn from(error: OutputError) -> Self {
        Self::Run(error.into())
    }
}

impl From<RoleError> for Error {
    fn from(error: RoleError) -> Self {
        Self::Run(error.into())
    }
}
