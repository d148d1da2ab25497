//! How a scene is run.

use halfstep_sph::lane::Isa;
use std::path::PathBuf;

/// Where the solid process comes from.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum SolidSource {
    /// The scene's model.
    #[default]
    BuiltIn,
    /// A command line for the shell.
    Command(String),
    /// Somebody starts it by hand.
    ByHand,
}

/// How to run.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Folder of the run.
    pub out: PathBuf,
    /// Worker threads of the fluid; `None`: the scene's.
    pub threads: Option<usize>,
    /// Roles as threads of this process.
    pub in_process: bool,
    /// No progress.
    pub quiet: bool,
    /// An earlier run in the folder is removed.
    pub force: bool,
    /// The solid.
    pub solid: SolidSource,
    /// How long to wait for a solid started by hand, s.
    pub solid_wait: f64,
    /// Instruction set of every role; one that the processor has.
    pub isa: Isa,
}
