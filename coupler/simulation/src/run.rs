//! One run from a scene to a folder.

use crate::advice::advice;
use crate::effects;
use crate::options::{RunOptions, known_solid};
use crate::participants::report_participants;
use crate::session::Session;
use halfstep_coupling::clock::Clock;
use halfstep_coupling::couple::combined_hash;
use halfstep_coupling::error::RunError;
use halfstep_coupling::recorder::Recorder;
use halfstep_coupling::roles;
use halfstep_coupling::solo::run_solo;
use halfstep_coupling::supervise::stop_flag;
use halfstep_output::run_json::{Particles, RunStatus};
use halfstep_output::{self as output, RunDirectory, RunReport};
use halfstep_role::report::Report;
use halfstep_role::serve;
use halfstep_scene::Scene;
use halfstep_scene::geometry;
use std::sync::atomic::AtomicBool;

/// Runs a scene. The report is written whatever happens; an error stands in it, too.
///
/// # Errors
/// Nothing could be started or written. A run that failed is a report with its error.
pub fn run(scene: &Scene, options: &RunOptions) -> Result<(RunReport, Option<RunError>), RunError> {
    if !options.foreign.is_empty() && (scene.fluid.is_none() || scene.solids.is_empty()) {
        return Err(RunError::System("--solid needs a scene with [fluid] and [solid]".into()));
    }
    for name in options.foreign_names() {
        known_solid(scene, name.as_str()).map_err(RunError::System)?;
    }
    let directory = RunDirectory::create(&options.out, options.force)?;
    let stop = stop_flag().map_err(|e| RunError::System(format!("cannot watch for signals: {e}")))?;
    let layout = geometry::layout::<2>(scene);
    let counts = layout.counts();
    let mut report = RunReport {
        scene: serde_json::to_value(scene).map_err(|e| RunError::System(e.to_string()))?,
        version: env!("CARGO_PKG_VERSION").into(),
        particles: Particles { fluid: counts.fluid, solid: counts.solid, wall: counts.wall, removed: 0 },
        ..RunReport::default()
    };
    report.effects = effects::ledger(scene, &counts);
    start_log(&directory)?;
    report.audit.isa = Some(options.isa.bits_name().into());
    report.write(&directory.file("run.json"))?;
    let mut recorder = Recorder::new(scene, &directory.file("probes.csv"), options.quiet)?;
    let mut clock = Clock::new(scene);
    let result = if scene.fluid.is_some() && !scene.solids.is_empty() {
        Session::new(scene, options, &directory, &stop, &layout)
            .and_then(|session| session.run(&mut clock, &mut recorder, &mut report))
    } else {
        solo(scene, options, &directory, &stop, &mut clock, &mut recorder, &mut report)
    };
    recorder.finish(&mut report);
    let error = match result {
        Ok(stopped) => {
            report.status = Some(if stopped { RunStatus::Stopped } else { RunStatus::Finished });
            None
        }
        Err(mut error) => {
            report.status = Some(RunStatus::Failed);
            if let RunError::Diverged { diverged, hint } = &mut error {
                *hint = advice(diverged, scene, &clock, &options.foreign_names());
                report.status = Some(RunStatus::Diverged);
            }
            tracing::error!("{error}");
            report.error = Some(error.to_string());
            Some(error)
        }
    };
    report.write(&directory.file("run.json"))?;
    for picture in
        [output::draw_plot(scene, directory.path()).map(Some), output::draw_contact(scene, directory.path())]
    {
        if let Err(e) = picture {
            tracing::warn!("a picture could not be drawn: {e}");
        }
    }
    Ok((report, error))
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

fn solo(
    scene: &Scene,
    options: &RunOptions,
    directory: &RunDirectory,
    stop: &AtomicBool,
    clock: &mut Clock,
    recorder: &mut Recorder,
    report: &mut RunReport,
) -> Result<bool, RunError> {
    let places: Vec<usize> = (0..scene.participants().len()).collect();
    if places.is_empty() {
        return Err(RunError::System("the scene has neither fluid nor solid".into()));
    }
    let of_solids = scene.solids.iter().map(|solid| solid.threads).max();
    let own = if scene.fluid.is_some() { scene.numerics.threads.fluid } else { of_solids.unwrap_or(1) };
    let threads = options.threads.unwrap_or(own);
    let outcome = serve::on_threads(threads, || -> Result<_, RunError> {
        let members = roles::members(scene, &places, options.isa, Some(directory.path()))?;
        run_solo(members, clock, recorder, stop)
    })??;
    report.audit.state_hash = Some(format!("{:016x}", combined_hash(&outcome.last)));
    let reports: Vec<Option<Report>> = outcome.reports.into_iter().map(Some).collect();
    report_participants(scene, options, &outcome.last, &reports, None, report);
    Ok(outcome.stopped)
}
