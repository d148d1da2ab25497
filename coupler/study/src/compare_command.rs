//! The command line of `halfstep compare`.

use super::adapted::{Adapted, adapted};
use super::candidate::Candidate;
use super::command::{ended, tell};
use super::compare::{Comparison, Ran, default_probe};
use super::error::StudyError;
use super::program::Program;
use super::runs::{self, Job};
use super::{claim, report_of};
use halfstep_coupling::say;
use halfstep_coupling::supervise::StopFlags;
use halfstep_output::read_probes;
use halfstep_output::run_json::RunStatus;
use halfstep_scene::Scene;
use std::path::PathBuf;
use std::process::ExitCode;

/// Runs a scene with different solids and compares them: a table and a picture
///
/// Exit status: 0 done; 1 scene or usage error; 2 a run did not finish; 130 interrupted.
#[derive(Clone, Debug, clap::Args)]
pub struct CompareArguments {
    /// Scene file (TOML) with a solid
    scene: PathBuf,
    /// A solid: the name of a built-in model, or a command that speaks the protocol, [NAME=]COMMAND; two or more
    #[arg(long, value_name = "MODEL|COMMAND", required = true)]
    solid: Vec<String>,
    /// Which of the scene's solids is exchanged, where there are several
    #[arg(long, value_name = "NAME")]
    of: Option<String>,
    /// Overrides a key of the scene in every run
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Simulated time, s (end_time of the scene)
    #[arg(long, value_name = "SECONDS")]
    until: Option<String>,
    /// The column of probes.csv that is compared, as tip.x (default: the first metric's)
    #[arg(long, value_name = "PROBE.COMPONENT")]
    probe: Option<String>,
    /// Folder (default: out/compare-SCENE)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Prints the results as JSON and nothing else
    #[arg(long)]
    json: bool,
    /// Shows no progress
    #[arg(long)]
    quiet: bool,
}

/// Runs the comparison.
pub fn compare(arguments: CompareArguments) -> ExitCode {
    ended(run(arguments))
}

fn run(arguments: CompareArguments) -> Result<ExitCode, StudyError> {
    let candidates: Vec<Candidate> = arguments.solid.iter().map(|text| Candidate::parse(text)).collect();
    let names: Vec<&str> = candidates.iter().map(Candidate::name).collect();
    if let Some(k) = (0..names.len()).find(|&k| names[..k].contains(&names[k])) {
        let name = names[k];
        return Err(StudyError::Usage(format!("two solids are called `{name}`: call one NAME=COMMAND")));
    }
    if let Some(unknown) = candidates.iter().find_map(Candidate::unknown) {
        return Err(StudyError::Usage(unknown));
    }
    let mut base = arguments.set;
    base.extend(arguments.until.map(|t| format!("end_time={t}")));
    let scene = halfstep_scene::load(&arguments.scene, &base)?;
    let exchanged = exchanged(&scene, arguments.of.as_deref()).map_err(StudyError::Usage)?;
    // Without water a program has nobody to exchange its state with but a stand-in, which knows no other solid.
    let program = candidates.iter().find(|candidate| matches!(candidate, Candidate::Program { .. }));
    if let (None, Some(program), true) = (&scene.fluid, program, scene.solids.len() > 1) {
        return Err(StudyError::Usage(format!(
            "{} has several solids and no [fluid]: {} cannot join it",
            scene.name,
            program.name()
        )));
    }
    let probe = arguments.probe.or_else(|| default_probe(&scene));
    let probe = probe.ok_or_else(|| StudyError::Usage(format!("{} has no [[probe]]", scene.name)))?;
    let folder =
        arguments.out.unwrap_or_else(|| PathBuf::from("out").join(format!("compare-{}", scene.name)));
    std::fs::create_dir_all(&folder).map_err(StudyError::system(folder.display()))?;
    let _claim = claim(&folder)?;
    let (index, key) = exchanged;
    let mut jobs = Vec::new();
    let mut told = Vec::new();
    for candidate in &candidates {
        let mut made = Adapted { overrides: base.clone(), ..Adapted::default() };
        let mut more = Vec::new();
        let mut stable_step = None;
        match candidate {
            // A model that cannot compute the scene is refused before anything runs.
            Candidate::Model(name) => {
                made = adapted(&scene, &arguments.scene, &base, (index, &key, name))?;
                if made.lacks_probe(&probe) {
                    return Err(StudyError::Usage(format!(
                        "--probe {probe}: {name} does not know it; name one that all have"
                    )));
                }
                let own = halfstep_scene::load(&arguments.scene, &made.overrides)?;
                stable_step = stable(&own, index)?;
            }
            Candidate::Program { command, .. } => {
                let of = key.strip_prefix("solid.").map_or(String::new(), |name| format!("{name}="));
                more = vec!["--solid".into(), format!("{of}{command}")];
            }
        }
        let note = made.text();
        if !note.is_empty() {
            say::warn(format_args!("{}: {note}", candidate.name()));
        }
        let overrides = made.overrides;
        told.push((note, stable_step));
        jobs.push(Job {
            label: candidate.name().into(),
            dir: folder.join("runs").join(candidate.name()),
            scene: arguments.scene.clone(),
            overrides,
            more,
            alone: scene.fluid.is_none() && matches!(candidate, Candidate::Program { .. }),
            end_time: scene.end_time,
            cost: 1.0,
        });
    }
    let stop = StopFlags::of_signals().map_err(StudyError::system("cannot watch for signals"))?;
    if !runs::execute(&jobs, 1, arguments.quiet, &Program::own()?, &stop)? {
        say::warn(format_args!("interrupted"));
        return Ok(ExitCode::from(130));
    }
    let mut ended = Vec::new();
    for ((candidate, job), (note, stable_step)) in candidates.into_iter().zip(&jobs).zip(told) {
        let table = read_probes(&job.dir.join("probes.csv")).ok();
        let report = report_of(job);
        ended.push(Ran { solid: candidate, folder: job.dir.clone(), report, table, note, stable_step });
    }
    let comparison = Comparison::new(&scene, &probe, index, ended)?;
    comparison.write(&scene, &folder)?;
    let json = arguments.json.then(|| comparison.json()).transpose()?;
    let unfinished = comparison.solids.iter().find(|solid| solid.status != Some(RunStatus::Finished));
    let failed = unfinished.map(|solid| format!("{} did not run to the end", solid.name));
    let made = ("compare.json, compare.png and the runs", folder.as_path());
    Ok(tell(json, || comparison.text(), made, failed.as_deref()).unwrap_or(ExitCode::SUCCESS))
}

/// Largest stable sub-step of the solid of that index in its first state, s.
fn stable(scene: &Scene, index: usize) -> Result<Option<f64>, StudyError> {
    let isa = halfstep::isa::of_environment().map_err(|e| StudyError::System(e.to_string()))?;
    Ok(halfstep::check::check(scene, isa).and_then(|check| check.stable_step(index)))
}

/// Index of the solid that is exchanged, and its key: `solid.NAME`, or `solid` where it is the only one.
fn exchanged(scene: &Scene, name: Option<&str>) -> Result<(usize, String), String> {
    let known: Vec<&str> = scene.solids.iter().map(|solid| solid.name.as_str()).collect();
    match (known.as_slice(), name) {
        ([], _) => Err(format!("{} has no solid", scene.name)),
        ([_], None) => Ok((0, "solid".into())),
        (_, None) => {
            Err(format!("there are several solids: say which with --of NAME, one of {}", known.join(", ")))
        }
        (_, Some(name)) if !known.contains(&name) => {
            Err(format!("--of {name}: the scene's solids are {}", known.join(", ")))
        }
        ([_], Some(_)) => Ok((0, "solid".into())),
        (_, Some(name)) => {
            let index = known.iter().position(|other| *other == name).unwrap_or_default();
            Ok((index, format!("solid.{name}")))
        }
    }
}
