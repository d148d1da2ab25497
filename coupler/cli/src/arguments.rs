//! The arguments of the `halfstep` command.

use crate::fake_fluid::FakeFluidArguments;
use crate::helpers::{self, Kind};
use clap::{Parser, Subcommand};
use halfstep_role::timeline::Window;
use halfstep_study::command::StudyArguments;
use halfstep_study::compare_command::CompareArguments;
use std::path::PathBuf;

/// Fluid-structure co-simulation by smoothed particle hydrodynamics: a fluid process, a solid process and a coupler in
/// lock-step over shared memory.
#[derive(Parser)]
#[command(name = "halfstep", version, long_version = helpers::VERSION.as_str())]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Simulates a scene
    Run(RunArguments),
    /// Validates a scene; prints counts, time steps, memory and expected time
    Check(CheckArguments),
    /// Shows which effects take part in a scene, why, and what each costs
    Explain {
        #[command(flatten)]
        scene: SceneArguments,
        /// Prints JSON
        #[arg(long)]
        json: bool,
    },
    /// Goes on with an interrupted run from its last checkpoint, to the same bits
    Resume(ResumeArguments),
    /// Draws plot.png and contact.png of a run from what is on disk, also of one that goes on or was killed
    Plot {
        /// Folder of the run
        dir: PathBuf,
    },
    Study(StudyArguments),
    Compare(CompareArguments),
    FakeFluid(FakeFluidArguments),
    /// Writes a commented scene that runs as it is
    New {
        /// File of the scene, or its name
        scene: PathBuf,
        /// What the scene is about
        #[arg(long, value_enum, default_value = "coupled")]
        kind: Kind,
    },
    /// Prints the JSON schema of scenes, from which editors know their keys
    Schema,
    /// Prints completions for a shell: bash, zsh, fish, elvish or powershell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Prints the manual page
    Man,
    /// A role's process; started by `run`
    #[command(hide = true)]
    Role {
        /// Name of the process
        name: String,
    },
}

#[derive(clap::Args)]
pub(crate) struct SceneArguments {
    /// Scene file (TOML)
    pub(crate) scene: PathBuf,
    /// Overrides a key of the scene: dotted, `shape.NAME.KEY` for a shape
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Simulated time, s (end_time of the scene)
    #[arg(long, value_name = "SECONDS")]
    pub(crate) until: Option<String>,
}

#[derive(clap::Args)]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Prints JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Draws the scene at its start, with bodies, clamps and probes, as PNG
    #[arg(long, value_name = "FILE")]
    pub(crate) picture: Option<PathBuf>,
}

#[derive(clap::Args)]
pub(crate) struct RunArguments {
    #[command(flatten)]
    pub(crate) scene: SceneArguments,
    /// Folder of the run (default: out/SCENE)
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Removes an earlier run in the folder
    #[arg(long)]
    pub(crate) force: bool,
    /// `study` or `compare` made the run, and may replace it
    #[arg(long, hide = true)]
    pub(crate) by_study: bool,
    /// Writes a timeline of half-steps, who does what and waits for whom: a trace event file (JSON), which Perfetto
    /// and chrome://tracing open, and trace.png in the run's folder
    #[arg(long, value_name = "FILE")]
    pub(crate) trace: Option<PathBuf>,
    /// Steps in the timeline: FROM and those after it, but not TO; 1000 at most. What a killed process did in a window
    /// that had not passed is lost; a run that ends otherwise within it has its part
    #[arg(long, value_name = "FROM..TO", default_value = "100..120", requires = "trace")]
    pub(crate) trace_steps: Window,
    #[command(flatten)]
    pub(crate) how: HowArguments,
}

#[derive(clap::Args)]
pub(crate) struct ResumeArguments {
    /// Folder of the run
    pub(crate) dir: PathBuf,
    /// Another end of the run, s: prolongs one that has finished
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) until: Option<f64>,
    #[command(flatten)]
    pub(crate) how: HowArguments,
}

/// How the participants are run.
#[derive(clap::Args)]
pub(crate) struct HowArguments {
    /// Worker threads of the fluid process; of a scene without fluid, of its solids
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1024))]
    pub(crate) threads: Option<u64>,
    /// Runs the roles as threads of one process
    #[arg(long, conflicts_with_all = ["solid", "await_solid"])]
    pub(crate) in_process: bool,
    /// Shows no progress
    #[arg(long)]
    pub(crate) quiet: bool,
    /// A solid of your own: a command that speaks the protocol; with several solids NAME=COMMAND, repeated
    #[arg(long, value_name = "[NAME=]COMMAND")]
    pub(crate) solid: Vec<String>,
    /// Awaits a solid that you start by hand
    #[arg(long, value_name = "NAME", num_args = 0..=1, require_equals = true, default_missing_value = "")]
    pub(crate) await_solid: Vec<String>,
    /// How long a participant that is alive may be silent, s
    #[arg(long, value_name = "SECONDS", default_value_t = 600.0, value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) patience: f64,
    /// What to do when a run has diverged: `stop`, or `retry`, which goes back to the last checkpoint with half the
    /// time step, at most 3 times or as often as `retry=N` says
    #[arg(long, value_name = "stop|retry[=N]", default_value = "stop", value_parser = retries, hide_default_value = true)]
    pub(crate) on_divergence: u32,
    /// How long to wait for a solid started by hand, s
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) solid_wait: f64,
}

/// A time to wait.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= 1e6 => Ok(value),
        Ok(_) => Err("must be greater than 0 and at most 1e6 s".into()),
        Err(error) => Err(error.to_string()),
    }
}

/// How often a run that has diverged is retried.
fn retries(text: &str) -> Result<u32, String> {
    let number = match text {
        "stop" => return Ok(0),
        "retry" => return Ok(3),
        _ => text.strip_prefix("retry=").and_then(|number| number.parse().ok()),
    };
    number
        .filter(|n| (1..=20).contains(n))
        .ok_or_else(|| "must be stop, retry, or retry=N with N from 1 to 20".into())
}
