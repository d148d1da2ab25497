//! One run from a scene to a folder, or on from where it was interrupted.

use crate::checkpoint::Checkpoint;
use crate::options::{RunOptions, known_solid};
use crate::remarks::Placed;
use crate::session::Session;
use crate::{course, effects, forecast, remarks, timeline};
use halfstep_coupling::course::Course;
use halfstep_coupling::error::RunError;
use halfstep_coupling::local::LocalRun;
use halfstep_coupling::roles;
use halfstep_coupling::say;
use halfstep_output::run_json::{Particles, Resumption, RunStatus};
use halfstep_output::{OutputError, RunDirectory, RunReport, draw_contact, draw_plot};
use halfstep_role::serve;
use halfstep_scene::geometry::{self, Layout};
use halfstep_scene::{Scene, dispatch};
use halfstep_sph::lane::Isa;
use halfstep_wire::Name;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A report, and the error where the run failed.
pub type Ended = (RunReport, Option<RunError>);

/// Runs a scene. The report is written whatever happens; an error stands in it, too.
///
/// # Errors
/// Nothing could be started or written. A run that failed is a report with its error.
pub fn run(scene: &Scene, options: &RunOptions) -> Result<Ended, RunError> {
    check_external(scene, options)?;
    // Before an earlier run is removed.
    check_resources(scene, options)?;
    if let Some(trace) = &options.trace {
        timeline::check(trace, &scene.path, &options.out, options.force)?;
    }
    let directory = RunDirectory::create(&options.out, options.force)?;
    if let Some(trace) = &options.trace {
        // An earlier one, which may be replaced, would pass for this run's where nothing is recorded.
        let _ = std::fs::remove_file(&trace.file);
    }
    let ended = execute(scene, options, &directory, None)?;
    let ended = retry(scene, options, &directory, ended, 1.0)?;
    if let Some(trace) = &options.trace {
        timeline::finish(scene, directory.path(), trace, ended.0.steps);
    }
    Ok(ended)
}

/// Lets a run that has diverged go on from its last checkpoint with half the time step, as often as the options say.
fn retry(
    scene: &Scene,
    options: &RunOptions,
    directory: &RunDirectory,
    mut ended: Ended,
    mut factor: f64,
) -> Result<Ended, RunError> {
    for attempt in 1..=options.retries {
        let (mut report, Some(RunError::Diverged { diverged, hint })) = ended else { return Ok(ended) };
        let mut checkpoint = match Checkpoint::newest(directory.path(), scene, options.isa) {
            Ok(checkpoint) => checkpoint,
            Err(error) => {
                say::warn(format_args!("warning: the diverged run has nothing to go back to: {error}"));
                return Ok((report, Some(RunError::Diverged { diverged, hint })));
            }
        };
        factor *= 0.5;
        checkpoint.shorten(factor);
        let told = format!(
            "{diverged}; attempt {attempt} of {}: on from step {}, t = {:.6e} s, with {factor} of the time step",
            options.retries, checkpoint.manifest.step, checkpoint.manifest.time
        );
        tracing::warn!("{told}");
        say::warn(format_args!("warning: {told}"));
        let before = report.clone();
        report.error = Some(diverged.to_string());
        ended = match execute(scene, options, directory, Some((checkpoint, report))) {
            // The folder has the run that diverged.
            Err(RunError::NotGoneOn(why)) => {
                say::warn(format_args!("warning: the diverged run does not go on: {why}"));
                return Ok((before, Some(RunError::Diverged { diverged, hint })));
            }
            other => other?,
        };
    }
    Ok(ended)
}

/// Goes on with the interrupted run in the folder of the options: from its last whole checkpoint, to the same bits as
/// if it had never been interrupted. `until` (s) gives it another end.
///
/// # Errors
/// There is no checkpoint to go on from, or nothing could be started or written.
pub fn resume(options: &RunOptions, until: Option<f64>) -> Result<(Scene, Ended), RunError> {
    let dir = &options
        .out
        .canonicalize()
        .map_err(|error| RunError::Resume(format!("{}: {error}", options.out.display())))?;
    // Nobody else changes what is read from here on.
    let directory = RunDirectory::reopen(dir)?;
    let mut scene = read_scene(dir)?;
    check_external(&scene, options)?;
    let earlier = RunReport::read(&dir.join("run.json")).unwrap_or_default();
    let checkpoint = Checkpoint::newest(dir, &scene, options.isa)?;
    check_sources(&scene, &checkpoint, options)?;
    match until {
        None if earlier.status == Some(RunStatus::Finished) => {
            let reason = format!(
                "the run has reached its end, {} s; --until SECONDS gives it a later one",
                scene.end_time
            );
            return Err(RunError::Resume(reason));
        }
        Some(until) if earlier.status == Some(RunStatus::Finished) && until < earlier.time => {
            let reason = format!(
                "the run has reached {} s, and --until {until} s would discard its end: start a run of its own for it",
                earlier.time
            );
            return Err(RunError::Resume(reason));
        }
        Some(until) if until <= checkpoint.manifest.time => {
            let reason =
                format!("--until {until} s is not after the checkpoint at {} s", checkpoint.manifest.time);
            return Err(RunError::Resume(reason));
        }
        Some(until) => scene.end_time = until,
        None => {}
    }
    let factor = checkpoint.factor();
    let earlier = RunReport { error: None, ..earlier };
    let ended = execute(&scene, options, &directory, Some((checkpoint, earlier)))?;
    let ended = retry(&scene, options, &directory, ended, factor)?;
    Ok((scene, ended))
}

/// The scene of the run in a folder, as resolved.
///
/// # Errors
/// There is none that can be read.
pub fn read_scene(dir: &Path) -> Result<Scene, RunError> {
    read_scene_file(&dir.join("scene.json"))
}

/// The same from a file.
///
/// # Errors
/// As for [`read_scene`].
pub fn read_scene_file(path: &Path) -> Result<Scene, RunError> {
    let wrong = |reason: String| RunError::System(format!("{}: {reason}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
    Scene::from_json(&text).map_err(|error| wrong(error.to_string()))
}

/// Draws the pictures of the run in a folder from what is on disk: their files, none where there is nothing to draw.
pub fn draw(scene: &Scene, dir: &Path) -> [Result<Option<PathBuf>, OutputError>; 2] {
    [draw_plot(scene, dir).map(Some), draw_contact(scene, dir)]
}

fn check_resources(scene: &Scene, options: &RunOptions) -> Result<(), RunError> {
    let external = options.external_names();
    let (out, as_processes) = (&options.out, options.launcher.is_some());
    let checked = dispatch!(scene.dimension, D => {
        let layout = geometry::layout::<D>(scene);
        forecast::check(scene, &layout, &external, out, as_processes)
    });
    checked.unwrap_or_else(|| Err(unknown_dimension(scene)))
}

/// Another program is told one gravity.
///
/// # Errors
/// The scene's frame changes it.
pub(crate) fn check_gravity(scene: &Scene, solid: &str) -> Result<(), RunError> {
    if scene.frame.is_none() {
        return Ok(());
    }
    let reason = "is computed by another program, which is told one `gravity`, and `frame` changes it";
    Err(RunError::System(format!("the {solid} {reason}")))
}

fn check_external(scene: &Scene, options: &RunOptions) -> Result<(), RunError> {
    if !options.external.is_empty() && (scene.fluid.is_none() || scene.solids.is_empty()) {
        return Err(RunError::System("--solid needs a scene with [fluid] and [solid]".into()));
    }
    if let Some(name) = options.external_names().first() {
        check_gravity(scene, name.as_str())?;
    }
    for name in options.external_names() {
        known_solid(scene, name.as_str()).map_err(RunError::System)?;
    }
    Ok(())
}

/// A run's solids are computed on by whom they were computed by.
fn check_sources(scene: &Scene, checkpoint: &Checkpoint, options: &RunOptions) -> Result<(), RunError> {
    let names = options.external_names();
    for (solid, name) in scene.solids.iter().map(|solid| solid.name.as_str()).enumerate() {
        let is_told = names.iter().any(|told| told.as_str() == name);
        let why = match (checkpoint.is_external(solid), is_told) {
            (false, true) => "was computed by halfstep itself: go on without --solid for it",
            (true, false) => {
                "was computed by another program: --solid or --await-solid say by which it is from here on"
            }
            _ => continue,
        };
        return Err(RunError::Resume(format!("`{name}` of this run {why}")));
    }
    Ok(())
}

/// What the report of a run says at its start, and the shapes as they are computed.
pub(crate) fn begin_report<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    isa: Isa,
) -> Result<(RunReport, Vec<Placed>), RunError> {
    let counts = layout.counts();
    let placed = remarks::placed(scene, layout);
    let unwritable = |e: serde_json::Error| RunError::System(e.to_string());
    let mut report = RunReport {
        scene: serde_json::to_value(scene).map_err(unwritable)?,
        version: env!("CARGO_PKG_VERSION").into(),
        warnings: remarks::on(scene, layout, &placed),
        shapes: placed.iter().map(serde_json::to_value).collect::<Result<_, _>>().map_err(unwritable)?,
        particles: Particles { fluid: counts.fluid, solid: counts.solid, wall: counts.wall, removed: 0 },
        ..RunReport::default()
    };
    report.effects = effects::reports(scene, &counts);
    report.audit.isa = Some(isa.bits_name().into());
    Ok((report, placed))
}

fn execute(
    scene: &Scene,
    options: &RunOptions,
    directory: &RunDirectory,
    resumed: Option<(Checkpoint, RunReport)>,
) -> Result<Ended, RunError> {
    let ended = dispatch!(scene.dimension, D => execute_in::<D>(scene, options, directory, resumed));
    ended.unwrap_or_else(|| Err(unknown_dimension(scene)))
}

fn unknown_dimension(scene: &Scene) -> RunError {
    RunError::System(format!("scenes of {} dimensions cannot be run", scene.dimension))
}

fn execute_in<const D: usize>(
    scene: &Scene,
    options: &RunOptions,
    directory: &RunDirectory,
    resumed: Option<(Checkpoint, RunReport)>,
) -> Result<Ended, RunError> {
    let layout = geometry::layout::<D>(scene);
    let (mut report, placed) = begin_report(scene, &layout, options.isa)?;
    let cores = std::thread::available_parallelism().map_or(usize::MAX, usize::from);
    report.warnings.extend(crowded(scene, options, cores));
    report.by_study = Some(options.by_study);
    let checkpoint = resumed.map(|(checkpoint, earlier)| {
        report.external = earlier.external;
        report.resumed = earlier.resumed;
        report.resumed.push(Resumption { because: earlier.error, ..checkpoint.resumption() });
        checkpoint
    });
    let (stop, from) = (Arc::clone(&options.stop.stop), checkpoint.as_ref());
    let mut course = course::begin(scene, Some(directory), from, stop, options.isa, options.quiet)?;
    course.must_save = options.retries > 0;
    if let Some(checkpoints) = &mut course.checkpoints {
        checkpoints.at_start = course.must_save;
    }
    if options.log {
        start_log(directory)?;
        for shape in &placed {
            tracing::info!("{}: {shape}", shape.name);
        }
        for warning in &report.warnings {
            tracing::warn!("{warning}");
            // Who goes on has heard it.
            if checkpoint.is_none() {
                say::warn(format_args!("warning: {warning}"));
            }
        }
    }
    report.write(&directory.file("run.json"))?;
    course.recorder.renew(directory.file("run.json"), report.clone());
    let result = if scene.fluid.is_some() && !scene.solids.is_empty() {
        Session::<D>::new(scene, options, directory, from, &layout)
            .and_then(|session| session.run(&mut course, &mut report))
    } else {
        drop(layout);
        let local = local::<D>(scene, options, directory, from, course, &mut report);
        match local {
            Ok((ended, stopped)) => {
                course = ended;
                stopped
            }
            Err(why) if checkpoint.is_some() => return Err(not_gone_on(why)),
            Err(why) => return Err(why),
        }
    };
    if course.set_aside.take().is_some() {
        return Err(not_gone_on(result.err().unwrap_or(RunError::StoppedEarly)));
    }
    Ok(course::end(&mut course, result, scene, &options.external, Some(directory), report))
}

/// Why a resumed run is what it was.
fn not_gone_on(why: RunError) -> RunError {
    tracing::error!("{why}: the run has not gone on");
    RunError::NotGoneOn(Box::new(why))
}

/// What this process has to say goes to the run's log, beside what its children say.
fn start_log(directory: &RunDirectory) -> Result<(), RunError> {
    let path = directory.file("log.txt");
    let log = std::fs::OpenOptions::new()
        .create(true)
        .append(true)
        .open(&path)
        .map_err(|e| RunError::System(format!("cannot open {}: {e}", path.display())))?;
    let subscriber =
        tracing_subscriber::fmt().with_ansi(false).with_writer(std::sync::Mutex::new(log)).finish();
    // A process that runs several scenes keeps its first log.
    if tracing::subscriber::set_global_default(subscriber).is_err() {
        tracing::debug!("the log is open already");
    }
    Ok(())
}

/// Worker threads of a run in one process.
pub(crate) fn threads(scene: &Scene, wanted: Option<usize>) -> usize {
    let of_solids = scene.solids.iter().map(|solid| solid.threads).max();
    let own = if scene.fluid.is_some() { scene.numerics.threads.fluid } else { of_solids.unwrap_or(1) };
    wanted.unwrap_or(own)
}

/// Participants of this program with many more worker threads than the machine has cores.
fn crowded(scene: &Scene, options: &RunOptions, cores: usize) -> Vec<String> {
    let external = options.external_names();
    // Without fluid one pool serves all.
    let (first, solids) = match scene.fluid {
        Some(_) => ("fluid", &scene.solids[..]),
        None => ("solid", &[][..]),
    };
    let own = |name: &str| !external.iter().any(|other| other.as_str() == name);
    let solids = solids.iter().filter(|solid| own(&solid.name)).map(|solid| (&*solid.name, solid.threads));
    let pools = std::iter::once((first, threads(scene, options.threads))).chain(solids);
    let many = pools.filter(|(_, threads)| *threads > cores.saturating_mul(2));
    many.map(|(name, threads)| {
        format!("{threads} worker threads of the {name} take turns on this machine's processors ({cores})")
    })
    .collect()
}

/// A course that has ended, with whether it was stopped.
type LocalEnd = (Course, Result<bool, RunError>);

/// A scene with one phase: in this process, nothing exchanged.
fn local<const D: usize>(
    scene: &Scene,
    options: &RunOptions,
    directory: &RunDirectory,
    checkpoint: Option<&Checkpoint>,
    course: Course,
    report: &mut RunReport,
) -> Result<LocalEnd, RunError> {
    let places: Vec<usize> = (0..scene.participants().len()).collect();
    serve::on_threads(threads(scene, options.threads), || {
        let from = checkpoint.map(|checkpoint| checkpoint.folder.as_path());
        let members = roles::members(scene, &places, options.isa, Some(directory.path()), from)?;
        let coupler = checkpoint.map(|checkpoint| &checkpoint.coupler);
        let traced = options.trace.as_ref();
        let _recording = traced.map(|to| timeline::record(to.window, directory.path(), Name::COUPLER, false));
        let mut run = LocalRun::<D>::new(members, scene, course, options.isa, coupler)?;
        let result = run.run().map(|ended| course::report_local(scene, &options.external, ended, report));
        Ok((run.into_course(), result))
    })?
}

#[cfg(test)]
mod tests {
    use super::crowded;
    use crate::options::{RunOptions, SolidSource};
    use halfstep_wire::Name;
    use std::path::Path;

    #[test]
    fn many_more_threads_than_cores_are_told() {
        let solid = "[solid]\ndensity = 2000.0\nyoungs_modulus = 1e7\npoissons_ratio = 0.2\nthreads = 4\n\
                     [[shape]]\nname = \"wall\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.1, 0.2] }\n";
        let fluid = "[fluid]\ndensity = 1000.0\n[numerics]\nthreads = { fluid = 5 }\n[[shape]]\nname = \"water\"\n\
                     phase = \"fluid\"\nbox = { min = [0.1, 0.0], max = [0.3, 0.1] }\n";
        let top = "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, -10.0]\n";
        let parsed = |text: String| halfstep_scene::parse(&text, Path::new("x.toml"), &[]);
        let [wet, dry] = [format!("{top}{fluid}{solid}"), format!("{top}{solid}")]
            .map(|text| parsed(text).unwrap_or_else(|e| panic!("{e:?}")));
        let line = |threads: usize, name: &str, cores: usize| {
            format!(
                "{threads} worker threads of the {name} take turns on this machine's processors ({cores})"
            )
        };
        let with = |threads| RunOptions { threads, ..RunOptions::new("out".into()) };
        assert_eq!(crowded(&wet, &with(None), 3), [""; 0]);
        assert_eq!(crowded(&wet, &with(None), 2), [line(5, "fluid", 2)]);
        assert_eq!(crowded(&wet, &with(Some(1024)), 1), [line(1024, "fluid", 1), line(4, "solid", 1)]);
        let foreign = RunOptions { external: vec![(Name::SOLID, SolidSource::ByHand)], ..with(Some(1024)) };
        assert_eq!(crowded(&wet, &foreign, 1), [line(1024, "fluid", 1)]);
        assert_eq!(crowded(&dry, &with(Some(1024)), 2), [line(1024, "solid", 2)]);
        assert_eq!(crowded(&dry, &with(None), 2), [""; 0]);
    }
}
