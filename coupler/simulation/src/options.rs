//! How a scene is run.

use halfstep_coupling::supervise::StopFlags;
use halfstep_role::timeline::Window;
use halfstep_scene::Scene;
use halfstep_sph::lane::Isa;
use halfstep_wire::Name;
use std::path::PathBuf;

/// Where a solid that is not built in comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SolidSource {
    /// A command line for the shell.
    Command(String),
    /// Somebody starts it by hand.
    ByHand,
}

/// Starts the participants' processes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Launcher {
    /// A program that serves a process of participants when it is started with the arguments `role NAME`: `halfstep`,
    /// or any program that calls [`crate::role_main`] first.
    pub program: PathBuf,
}

/// A timeline of half-steps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trace {
    /// Trace event file.
    pub file: PathBuf,
    /// The steps whose half-steps are recorded.
    pub window: Window,
}

/// How to run.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Folder of the run.
    pub out: PathBuf,
    /// Worker threads of the fluid; `None`: the scene's.
    pub threads: Option<usize>,
    /// Starts the roles as processes; `None`: they are threads of this process.
    pub launcher: Option<Launcher>,
    /// Set, they end the run.
    pub stop: StopFlags,
    /// What this process has to say goes to the run's `log.txt`: it becomes the process's only log. Warnings about the
    /// scene go to standard error as well.
    pub log: bool,
    /// No progress.
    pub quiet: bool,
    /// An earlier run in the folder is removed.
    pub force: bool,
    /// The run is one of `halfstep study` or `compare`, which may replace it.
    pub by_study: bool,
    /// Solids that are not built in, by name.
    pub external: Vec<(Name, SolidSource)>,
    /// How long to wait for a solid started by hand, s.
    pub solid_wait: f64,
    /// How long a participant that is alive may be silent, s.
    pub patience: f64,
    /// How often a run that has diverged goes back to its last checkpoint, with half the time step each time.
    pub retries: u32,
    /// Instruction set of every role; one that the processor has.
    pub isa: Isa,
    /// Writes a timeline; `None`: nothing is recorded.
    pub trace: Option<Trace>,
}

impl RunOptions {
    /// A quiet run into a folder, its roles threads of this process, which is left alone otherwise.
    pub fn new(out: PathBuf) -> Self {
        Self {
            out,
            threads: None,
            launcher: None,
            stop: StopFlags::default(),
            log: false,
            quiet: true,
            force: false,
            by_study: false,
            external: Vec::new(),
            solid_wait: 60.0,
            patience: 600.0,
            retries: 0,
            isa: Isa::detect(),
            trace: None,
        }
    }

    /// Names of the solids that are not built in.
    pub fn external_names(&self) -> Vec<Name> {
        self.external.iter().map(|(name, _)| *name).collect()
    }

    /// Where a solid comes from; `None`: it is built in.
    pub fn source(&self, name: Name) -> Option<&SolidSource> {
        source(&self.external, name)
    }
}

/// Where a solid comes from that may be among those that are not built in.
pub(crate) fn source(external: &[(Name, SolidSource)], name: Name) -> Option<&SolidSource> {
    external.iter().find(|(known, _)| *known == name).map(|(_, source)| source)
}

/// The name of a solid of the scene.
///
/// # Errors
/// The scene has no solid of this name: a sentence that names those it has.
pub fn known_solid<'a>(scene: &'a Scene, name: &str) -> Result<&'a str, String> {
    let known = || scene.solids.iter().map(|solid| solid.name.as_str());
    known().find(|solid| *solid == name).ok_or_else(|| {
        format!("the scene has no solid `{name}`; it has {}", known().collect::<Vec<_>>().join(", "))
    })
}
