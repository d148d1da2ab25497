//! The command line of `halfstep study`.

use super::choose::Goal;
use super::error::StudyError;
use super::ladder::Vary;
use super::pictures;
use super::result::Against;
use super::sweep::{self, Sweep};
use super::target::Reached;
use super::{Options, Session};
use halfstep_coupling::say;
use halfstep_coupling::supervise::StopFlags;
use halfstep_output::run_json::RunStatus;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Exit status where a wanted error or budget was not reached.
const NOT_REACHED: u8 = 3;
const NONE_FINISHED: &str = "no run finished";

/// Measures what accuracy costs: runs a scene over a ladder of settings
///
/// Exit status: 0 done; 1 scene or usage error; 2 no run finished; 3 the wanted error or budget was not reached;
/// 130 interrupted (the same command goes on where it was).
#[derive(Clone, Debug, clap::Args)]
pub struct StudyArguments {
    /// Scene file (TOML) with at least one [[metric]]
    scene: PathBuf,
    /// Overrides a key of the scene in every run
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// A key and the values it takes; as often as wanted (default: four resolutions, sqrt(2) apart)
    #[arg(long, value_name = "KEY=A,B,C")]
    vary: Vec<Vary>,
    /// A physical key and the values it takes: a parameter study, all combinations of several
    #[arg(long, value_name = "KEY=A,B,C", conflicts_with_all = ["vary", "full", "against", "error", "budget", "metric"])]
    sweep: Vec<Vary>,
    /// Prints the results as JSON and nothing else
    #[arg(long, conflicts_with_all = ["error", "budget"])]
    json: bool,
    /// A solid of your own in every run: a command that speaks the protocol; with several solids NAME=COMMAND, repeated
    #[arg(long, value_name = "COMMAND")]
    solid: Vec<String>,
    /// All combinations of the values instead of one change at a time
    #[arg(long)]
    full: bool,
    /// Runs of each setting: wall times are their medians
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeat: u32,
    /// Simulated time, s (end_time of the scene)
    #[arg(long, value_name = "SECONDS")]
    until: Option<String>,
    /// Worker threads of the fluid process
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1024))]
    threads: Option<u64>,
    /// Runs at a time; with more than one, wall times are not comparable
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=1024))]
    jobs: u64,
    /// Folder of the study (default: out/study-SCENE); finished runs in it are used again
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Errors against the metric's reference, or against the finest runs (default: reference where there is one)
    #[arg(long, value_enum)]
    against: Option<Against>,
    /// Finds, runs and reports the cheapest settings with at most this error: 2% or 0.02
    #[arg(long, value_name = "ERROR", value_parser = error_of, conflicts_with = "budget")]
    error: Option<f64>,
    /// Finds, runs and reports the settings with the least error in this wall time: 60s, 5min, 2h
    #[arg(long, value_name = "TIME", value_parser = seconds_of)]
    budget: Option<f64>,
    /// The metric that --error and --budget are about (default: the scene's first)
    #[arg(long, value_name = "NAME")]
    metric: Option<String>,
    /// Shows no progress
    #[arg(long)]
    quiet: bool,
}

fn error_of(text: &str) -> Result<f64, String> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    positive(number).map(|x| x * unit)
}

fn seconds_of(text: &str) -> Result<f64, String> {
    let units = [("min", 60.0), ("h", 3600.0), ("s", 1.0)];
    let split = units.iter().find_map(|(unit, factor)| Some((text.strip_suffix(unit)?, *factor)));
    let (number, factor) = split.unwrap_or((text, 1.0));
    positive(number).map(|x| x * factor)
}

fn positive(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err("must be a number greater than 0".into()),
    }
}

/// Runs the study.
pub fn study(arguments: StudyArguments) -> ExitCode {
    ended(run(arguments))
}

/// The exit status of a command of several runs; an error is told.
pub(crate) fn ended(result: Result<ExitCode, StudyError>) -> ExitCode {
    match result {
        Ok(code) => code,
        Err(StudyError::Scene(errors)) => {
            say::warn(format_args!("{:?}", miette::Report::new(errors)));
            ExitCode::from(1)
        }
        Err(error) => {
            say::warn(format_args!("error: {error}"));
            ExitCode::from(1)
        }
    }
}

/// Tells what was found, as JSON or as text with the files that were `made`. Returns the exit status where that is not
/// enough, `failed` says why.
pub(crate) fn tell(
    json: Option<String>,
    text: impl FnOnce() -> String,
    (made, folder): (&str, &Path),
    failed: Option<&str>,
) -> Option<ExitCode> {
    match json {
        Some(json) => say::tell(format_args!("{json}")),
        None => {
            say::tell(format_args!("{}", text().trim_end()));
            say::tell(format_args!("\n{made} are in {}", folder.display()));
        }
    }
    let failed = failed?;
    say::warn(format_args!("error: {failed}"));
    Some(ExitCode::from(2))
}

fn run(arguments: StudyArguments) -> Result<ExitCode, StudyError> {
    let goal = match (arguments.error, arguments.budget) {
        (Some(error), _) => Some(Goal::Error(error)),
        (_, Some(seconds)) => Some(Goal::Budget(seconds)),
        _ => None,
    };
    let mut base = arguments.set;
    base.extend(arguments.threads.map(|n| format!("numerics.threads.fluid={n}")));
    base.extend(arguments.until.map(|t| format!("end_time={t}")));
    let keys: Vec<String> = arguments.sweep.iter().map(|vary| vary.key.clone()).collect();
    let sweeps = !keys.is_empty();
    for vary in arguments.vary.iter().filter(|vary| sweep::is_physical(&vary.key)) {
        say::warn(format_args!("warning: {}", sweep::warning(&vary.key)));
    }
    let json = arguments.json;
    let options = Options {
        scene: arguments.scene,
        base,
        vary: if sweeps { arguments.sweep } else { arguments.vary },
        solids: arguments.solid,
        full: arguments.full || sweeps,
        repeat: arguments.repeat,
        jobs: arguments.jobs as usize,
        out: arguments.out,
        against: arguments.against,
        quiet: arguments.quiet,
    };
    let stop = StopFlags::of_signals().map_err(StudyError::system("cannot watch for signals"))?;
    let mut session = Session::new(&options, &stop)?;
    let metric = metric(&session, arguments.metric.as_deref())?;
    if !session.ladder()? {
        return Ok(interrupted());
    }
    let mut reached = None;
    if let Some(goal) = goal {
        reached = Some(session.reach(goal, metric)?);
        if reached == Some(Reached::Stopped) {
            return Ok(interrupted());
        }
        say::tell(format_args!(""));
    }
    let study = session.study();
    if sweeps {
        return report(&Sweep::of(&study, keys), json, session.folder());
    }
    study.write(session.folder())?;
    pictures::draw(&study, session.folder())?;
    let as_json = || serde_json::to_string_pretty(&study).map_err(|e| StudyError::System(e.to_string()));
    let as_json = json.then(as_json).transpose()?;
    let failed = study.rows.iter().all(|row| row.error.is_some()).then_some(NONE_FINISHED);
    let made = ("study.csv, study.json and pictures", session.folder());
    if let Some(code) = tell(as_json, || study.text(), made, failed) {
        return Ok(code);
    }
    Ok(match reached {
        Some(Reached::Yes(changes)) => {
            let set: Vec<String> =
                in_force(&options.base, &changes).map(|change| format!("--set {change}")).collect();
            let set = if set.is_empty() { "the scene's own".into() } else { set.join(" ") };
            say::tell(format_args!("\nsettings that reach it: {set}"));
            ExitCode::SUCCESS
        }
        Some(Reached::No(reason)) => {
            say::warn(format_args!("not reached: {reason}"));
            ExitCode::from(NOT_REACHED)
        }
        _ => ExitCode::SUCCESS,
    })
}

/// Writes and says what a parameter study found.
fn report(sweep: &Sweep, json: bool, folder: &Path) -> Result<ExitCode, StudyError> {
    sweep.write(folder)?;
    let as_json = json.then(|| sweep.json()).transpose()?;
    let finished = sweep.rows.iter().any(|row| row.status == Some(RunStatus::Finished));
    let failed = (!finished).then_some(NONE_FINISHED);
    let made = ("sweep.csv, sweep.json and sweep.png", folder);
    Ok(tell(as_json, || sweep.text(), made, failed).unwrap_or(ExitCode::SUCCESS))
}

/// The overrides of which no later one says otherwise.
fn in_force<'o>(base: &'o [String], changes: &'o [String]) -> impl Iterator<Item = &'o String> {
    let key = |text: &'o str| text.split_once('=').map_or(text, |(key, _)| key);
    let later = move |k: usize| base.iter().chain(changes).skip(k + 1);
    let all = base.iter().chain(changes).enumerate();
    all.filter(move |(k, text)| !later(*k).any(|other| key(other) == key(text))).map(|(_, text)| text)
}

fn metric(session: &Session<'_>, name: Option<&str>) -> Result<usize, StudyError> {
    let Some(name) = name else { return Ok(0) };
    let names: Vec<&str> = session.metrics.iter().map(|m| m.name.as_str()).collect();
    let found = names.iter().position(|n| *n == name);
    found.ok_or_else(|| {
        StudyError::Usage(format!(
            "--metric {name}: the scene has no such metric; it has {}",
            names.join(", ")
        ))
    })
}

fn interrupted() -> ExitCode {
    say::warn(format_args!("interrupted; finished runs are kept, and the same command goes on from there"));
    ExitCode::from(130)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_value_of_a_key_is_printed() {
        let [base, changes] =
            [&["a=1", "b=2"][..], &["a=3"]].map(|o| o.iter().map(|s| s.to_string()).collect::<Vec<_>>());
        assert_eq!(in_force(&base, &changes).collect::<Vec<_>>(), ["b=2", "a=3"]);
    }

    #[test]
    fn errors_and_times_have_units() {
        assert_eq!(error_of("2%"), Ok(0.02));
        assert_eq!(error_of("0.5"), Ok(0.5));
        assert_eq!(seconds_of("1.5min"), Ok(90.0));
        assert_eq!((seconds_of("60s"), seconds_of("2h"), seconds_of("7")), (Ok(60.0), Ok(7200.0), Ok(7.0)));
        for wrong in ["", "-1", "0%", "many", "inf"] {
            assert!(error_of(wrong).is_err() && seconds_of(wrong).is_err(), "{wrong}");
        }
    }
}
