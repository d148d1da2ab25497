//! The `halfstep` command.

mod arguments;
mod fake_fluid;
mod helpers;

use arguments::{
    Arguments, CheckArguments, Command, HowArguments, ResumeArguments, RunArguments, SceneArguments,
};
use clap::{CommandFactory, Parser};
use halfstep::Launcher;
use halfstep::options::{RunOptions, SolidSource, Trace, known_solid};
use halfstep::{isa, run};
use halfstep_coupling::say;
use halfstep_coupling::supervise::StopFlags;
use halfstep_output::RunReport;
use halfstep_output::checkpoint::{FOLDERS, MANIFEST};
use halfstep_output::run_json::RunStatus;
use halfstep_scene::{self as scene, Scene};
use halfstep_sph::lane::Isa;
use halfstep_study::command::study;
use halfstep_study::compare_command::compare;
use halfstep_wire::Name;
use serde::Serialize;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            let _ = error.print();
            if let Some(scene) = swallowed_scene(&error, &mut std::env::args()) {
                say::warn(format_args!(
                    "\nhint: --solid is followed by the command that starts the solid, and took the scene `{scene}` for \
                     it: halfstep run {scene} --solid 'COMMAND'"
                ));
            }
            // Help and version are no errors.
            return ExitCode::from(u8::from(error.use_stderr()));
        }
    };
    let isa = match isa::of_environment() {
        Ok(isa) => isa,
        Err(error) => {
            say::warn(format_args!("error: {error}"));
            return ExitCode::from(1);
        }
    };
    match arguments.command {
        Command::Run(arguments) => run_scene(arguments, isa),
        Command::Check(arguments) => check_scene(&arguments, isa),
        Command::Explain { scene, json } => explain_scene(&scene, json, isa),
        Command::Resume(arguments) => resume(&arguments, isa),
        Command::Plot { dir } => plot(&dir),
        Command::Study(arguments) => study(arguments),
        Command::Compare(arguments) => compare(arguments),
        Command::FakeFluid(arguments) => fake_fluid::try_solid(arguments),
        Command::New { scene, kind } => helpers::new(&scene, kind),
        Command::Schema => helpers::schema(),
        Command::Completions { shell } => helpers::completions(Arguments::command(), shell),
        Command::Man => helpers::manual(Arguments::command()),
        Command::Role { name } => ExitCode::from(halfstep::serve_role(&name, isa)),
    }
}

/// The scene that `--solid` took for its command, where that is why a scene is missing.
fn swallowed_scene(error: &clap::Error, arguments: &mut dyn Iterator<Item = String>) -> Option<String> {
    let is_missing = error.kind() == clap::error::ErrorKind::MissingRequiredArgument;
    let after = arguments.skip_while(|argument| argument != "--solid").nth(1);
    after.filter(|word| is_missing && word.ends_with(".toml"))
}

fn load(arguments: &SceneArguments) -> Result<scene::Scene, ExitCode> {
    if arguments.scene.extension().is_some_and(|extension| extension == "json") {
        let changed = !arguments.set.is_empty() || arguments.until.is_some();
        return rerun(&arguments.scene, changed).map_err(|error| usage(&error));
    }
    let mut overrides = arguments.set.clone();
    overrides.extend(arguments.until.iter().map(|t| format!("end_time={t}")));
    let mut scene = scene::load(&arguments.scene, &overrides).map_err(|errors| {
        say::warn(format_args!("{:?}", miette::Report::new(errors)));
        ExitCode::from(1)
    })?;
    if arguments.until.is_some() {
        let own = scene::load(&arguments.scene, &arguments.set).ok().map(|own| own.end_time);
        scene.whole = own.filter(|own| *own > scene.end_time);
    }
    Ok(scene)
}

/// The scene of an earlier run, from the `scene.json` in its folder: exactly as it was computed. Its numbers were
/// checked when a TOML scene was read and are not again, so that it has to be what the run says beside it.
fn rerun(path: &Path, changed: bool) -> Result<Scene, String> {
    if changed {
        return Err(format!(
            "{}: the scene of a run is run as it was: --set and --until change its TOML file's",
            path.display()
        ));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let wrong = |reason: String| format!("{}: {reason}", path.display());
    let scene = run::read_scene_file(path).map_err(|error| error.to_string())?;
    let report = RunReport::read(&folder.join("run.json"))
        .map_err(|error| wrong(format!("is run with its run's run.json beside it: {error}")))?;
    let told = serde_json::to_value(&scene).ok();
    if told.as_ref() != Some(&report.scene) {
        return Err(wrong("is not the scene that run.json beside it tells of: it was changed".into()));
    }
    Ok(scene)
}

fn check_scene(arguments: &CheckArguments, isa: Isa) -> ExitCode {
    let scene = match load(&arguments.scene) {
        Ok(scene) => scene,
        Err(code) => return code,
    };
    let Some(check) = halfstep::check::check(&scene, isa) else {
        return usage(&"three dimensions are not available yet");
    };
    let code = show(&check, arguments.json);
    let Some(picture) = &arguments.picture else { return code };
    match halfstep_output::draw_start(&scene, picture) {
        Ok(()) => code,
        Err(error) => failed(&error),
    }
}

fn explain_scene(arguments: &SceneArguments, json: bool, isa: Isa) -> ExitCode {
    let scene = match load(arguments) {
        Ok(scene) => scene,
        Err(code) => return code,
    };
    match halfstep::explain::explain(&scene, isa) {
        Ok(explanation) => show(&explanation, json),
        Err(error) => failed(&error),
    }
}

/// Prints a result as text or as JSON.
fn show<T: Display + Serialize>(result: &T, json: bool) -> ExitCode {
    let text = if json { serde_json::to_string_pretty(result) } else { Ok(result.to_string()) };
    match text {
        Ok(text) => {
            say::tell(format_args!("{}", text.trim_end()));
            ExitCode::SUCCESS
        }
        Err(error) => failed(&error),
    }
}

/// Something was started and failed.
fn failed(error: &dyn Display) -> ExitCode {
    say::warn(format_args!("error: {error}"));
    ExitCode::from(2)
}

fn run_scene(arguments: RunArguments, isa: Isa) -> ExitCode {
    let scene = match load(&arguments.scene) {
        Ok(scene) => scene,
        Err(code) => return code,
    };
    let out = arguments.out.unwrap_or_else(|| PathBuf::from("out").join(&scene.name));
    let external = match external_solids(&scene, &arguments.how.solid, &arguments.how.await_solid) {
        Ok(external) => external,
        Err(error) => return usage(&error),
    };
    let options = match options(out, arguments.force, &arguments.how, external, isa) {
        Ok(options) => options,
        Err(error) => return usage(&error),
    };
    let trace = arguments.trace.map(|file| Trace { file, window: arguments.trace_steps });
    let options = RunOptions { trace, by_study: arguments.by_study, ..options };
    match run::run(&scene, &options) {
        Err(error) => usage(&error),
        Ok(ended) => tell(&scene, &options.out, ended),
    }
}

fn resume(arguments: &ResumeArguments, isa: Isa) -> ExitCode {
    let external = run::read_scene(&arguments.dir).map_err(|error| error.to_string());
    let external =
        external.and_then(|scene| external_solids(&scene, &arguments.how.solid, &arguments.how.await_solid));
    let options =
        external.and_then(|external| options(arguments.dir.clone(), false, &arguments.how, external, isa));
    let options = match options {
        Ok(options) => options,
        Err(error) => return usage(&error),
    };
    match run::resume(&options, arguments.until) {
        Err(error) => {
            let status = usage(&error);
            if error.is_stop() { ExitCode::from(130) } else { status }
        }
        Ok((scene, ended)) => tell(&scene, &options.out, ended),
    }
}

fn plot(dir: &Path) -> ExitCode {
    let scene = match run::read_scene(dir) {
        Ok(scene) => scene,
        Err(error) => return usage(&error),
    };
    let mut drawn = false;
    for picture in run::draw(&scene, dir) {
        match picture {
            Ok(Some(path)) => {
                drawn = true;
                say::tell(format_args!("{}", path.display()));
            }
            // There is no frame yet.
            Ok(None) => {}
            Err(error) => say::warn(format_args!("error: {error}")),
        }
    }
    ExitCode::from(u8::from(!drawn))
}

/// Nothing was started.
fn usage(error: &dyn Display) -> ExitCode {
    say::warn(format_args!("error: {error}"));
    ExitCode::from(1)
}

fn options(
    out: PathBuf,
    force: bool,
    how: &HowArguments,
    external: Vec<(Name, SolidSource)>,
    isa: Isa,
) -> Result<RunOptions, String> {
    if how.on_divergence > 0 && external.iter().any(|(_, source)| *source == SolidSource::ByHand) {
        return Err(
            "--on-divergence retry starts all participants anew: it cannot with a solid started by hand"
                .into(),
        );
    }
    let own = || std::env::current_exe().map_err(|e| format!("cannot find the own program: {e}"));
    let launcher = if how.in_process { None } else { Some(Launcher { program: own()? }) };
    Ok(RunOptions {
        threads: how.threads.map(|n| n as usize),
        launcher,
        stop: StopFlags::of_signals().map_err(|e| format!("cannot watch for signals: {e}"))?,
        log: true,
        quiet: how.quiet,
        force,
        external,
        solid_wait: how.solid_wait,
        patience: how.patience,
        retries: how.on_divergence,
        isa,
        ..RunOptions::new(out)
    })
}

/// Says how a run ended and where to look.
fn tell(scene: &Scene, out: &Path, (report, error): run::Ended) -> ExitCode {
    if let Some(error) = error {
        let log = out.join("log.txt");
        let is_empty = std::fs::metadata(&log).map_or(true, |log| log.len() == 0);
        let more = if is_empty { String::new() } else { format!("\nthe log has more: {}", log.display()) };
        say::warn(format_args!("error: {error}{more}"));
    }
    // What could be drawn: a run may have lost what its picture is made of.
    let picture = Some(out.join("plot.png")).filter(|picture| picture.exists());
    let how = match report.status {
        Some(RunStatus::Finished) => "finished",
        Some(RunStatus::Stopped) => "stopped",
        Some(RunStatus::Diverged) => "diverged",
        _ => "failed",
    };
    say::tell(format_args!(
        "{}: {how}, {} steps to t = {} s in {:.1} s; see {}",
        scene.name,
        report.steps,
        report.time,
        report.wall_seconds,
        picture.as_deref().unwrap_or(out).display()
    ));
    let finished = report.status == Some(RunStatus::Finished);
    if !finished && FOLDERS.iter().any(|folder| out.join(folder).join(MANIFEST).exists()) {
        say::tell(format_args!("halfstep resume '{}' goes on from the last checkpoint", out.display()));
    }
    if !report.warnings_at_end.is_empty() {
        say::warn(format_args!("warning: {}", report.warnings_at_end.join("; ")));
    }
    match report.status {
        Some(RunStatus::Finished) => ExitCode::SUCCESS,
        Some(RunStatus::Stopped) => ExitCode::from(130),
        _ => ExitCode::from(2),
    }
}

/// The solids that are not built in. Where there is one solid its name may be left out.
fn external_solids(
    scene: &Scene,
    commands: &[String],
    awaited: &[String],
) -> Result<Vec<(Name, SolidSource)>, String> {
    let known: Vec<&str> = scene.solids.iter().map(|solid| solid.name.as_str()).collect();
    let only = || match known.as_slice() {
        [name] => Ok(*name),
        [] => Err("--solid needs a scene with [fluid] and [solid]".to_owned()),
        _ => Err(format!(
            "there are several solids: say which with NAME=COMMAND, NAME one of {}",
            known.join(", ")
        )),
    };
    let mut external: Vec<(Name, SolidSource)> = Vec::new();
    let mut add = |name: &str, source| {
        let name: Name = name.parse().map_err(|error| format!("{error}"))?;
        if external.iter().any(|(other, _)| *other == name) {
            return Err(format!("the solid `{name}` is named twice"));
        }
        external.push((name, source));
        Ok(())
    };
    for text in commands {
        // Of several solids one must be named; else what stands before the sign may belong to the command.
        let names = |name: &str| known.contains(&name) || (known.len() > 1 && name.parse::<Name>().is_ok());
        let (name, line) = match text.split_once('=') {
            Some((name, line)) if names(name) => (known_solid(scene, name)?, line),
            _ => (only()?, text.as_str()),
        };
        add(name, SolidSource::Command(line.to_owned()))?;
    }
    for text in awaited {
        let name = if text.is_empty() { only()? } else { known_solid(scene, text)? };
        add(name, SolidSource::ByHand)?;
    }
    Ok(external)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_runs_scene_is_taken_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("templates/water.toml");
        let scene = scene::load(&own, &[]).unwrap();
        let path = folder.path().join("scene.json");
        std::fs::write(&path, scene.to_json().unwrap()).unwrap();
        // Without its report nobody knows whether it is what was run.
        assert!(rerun(&path, false).unwrap_err().contains("run.json"));
        let report = RunReport { scene: serde_json::to_value(&scene).unwrap(), ..RunReport::default() };
        report.write(&folder.path().join("run.json")).unwrap();
        assert_eq!(rerun(&path, false).unwrap(), scene);
        assert!(rerun(&path, true).unwrap_err().contains("--set and --until change its TOML file's"));
        let other = Scene { resolution: 0.5 * scene.resolution, ..scene };
        std::fs::write(&path, other.to_json().unwrap()).unwrap();
        assert!(rerun(&path, false).unwrap_err().ends_with("it was changed"));
    }

    #[test]
    fn a_scene_that_was_taken_for_a_command_is_named() {
        let typed = |line: &str| line.split(' ').map(String::from).collect::<Vec<_>>();
        let hint = |line: &str| {
            let error = Arguments::try_parse_from(typed(line)).err()?;
            swallowed_scene(&error, &mut typed(line).into_iter())
        };
        assert_eq!(hint("halfstep run --solid wall.toml").as_deref(), Some("wall.toml"));
        assert_eq!(hint("halfstep run --quiet"), None);
        assert_eq!(hint("halfstep run wall.toml --solid other.toml"), None);
    }

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }
}
