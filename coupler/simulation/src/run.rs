//! One run from a scene to a folder.

use crate::advice::advice;
use crate::effects;
use crate::options::{RunOptions, SolidSource};
use crate::session::Session;
use halfstep_coupling::clock::Clock;
use halfstep_coupling::error::RunError;
use halfstep_coupling::recorder::Recorder;
use halfstep_coupling::roles;
use halfstep_coupling::solo::run_solo;
use halfstep_coupling::supervise::stop_flag;
use halfstep_output::run_json::{Particles, RunStatus};
use halfstep_output::{self as output, FrameWriter, RunDirectory, RunReport};
use halfstep_role::lockstep;
use halfstep_scene::Scene;
use halfstep_scene::geometry;
use halfstep_wire::failure::RoleName;
use std::sync::atomic::AtomicBool;

/// Runs a scene. The report is written whatever happens; an error stands in it, too.
///
/// # Errors
/// Nothing could be started or written. A run that failed is a report with its error.
pub fn run(scene: &Scene, options: &RunOptions) -> Result<(RunReport, Option<RunError>), RunError> {
    if options.solid != SolidSource::BuiltIn && (scene.fluid.is_none() || scene.solids.is_empty()) {
        return Err(RunError::System("--solid needs a scene with [fluid] and [solid]".into()));
    }
    let directory = RunDirectory::create(&options.out, options.force)?;
    let stop = stop_flag().map_err(|e| RunError::System(format!("cannot watch for signals: {e}")))?;
    let counts = geometry::layout::<2>(scene).counts();
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
    let foreign = options.solid != SolidSource::BuiltIn;
    let result = if scene.fluid.is_some() && (!scene.solids.is_empty() || foreign) {
        let capacity = capacities(scene, counts.fluid, counts.solid, foreign);
        let session = Session { scene, options, directory: &directory, stop: &stop, capacity };
        session.run(&mut clock, &mut recorder, &mut report)
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
                *hint = advice(diverged, scene, &clock, foreign);
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

/// Interface capacities of fluid and solid for these numbers of particles.
pub fn capacities(scene: &Scene, fluid: u64, solid: u64, foreign: bool) -> (u32, u32) {
    let solid = if foreign { solid.max(4096) } else { solid };
    // A ribbon of about four layers on each side of the solid's surface, and room for compression.
    let ribbon = (24 * solid).max(4096).min(fluid);
    let fluid = scene.numerics.interface_capacity.map_or(ribbon, u64::from);
    (fluid.max(1) as u32, solid.max(1) as u32)
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
    let name = if scene.fluid.is_some() { RoleName::Fluid } else { RoleName::Solid };
    let stem = roles::stem(name);
    let own = scene.numerics.threads;
    let threads = options.threads.unwrap_or(if name == RoleName::Fluid { own.fluid } else { own.solid });
    let mut writer = FrameWriter::start(directory.path(), stem)?;
    let result = lockstep::on_threads(threads, || -> Result<_, RunError> {
        let mut role = roles::build(name, scene, options.isa)
            .ok_or_else(|| RunError::System("the scene has neither fluid nor solid".into()))?;
        run_solo(role.as_mut(), clock, &mut writer, recorder, stop)
    })?;
    writer.finish()?;
    let outcome = result?;
    report.audit.state_hash = Some(format!("{:016x}", outcome.state_hash));
    effects::share_solo(report, &outcome);
    let seconds = Some(outcome.seconds);
    let evaluations = Some(outcome.pair_evaluations);
    if name == RoleName::Fluid {
        report.roles.fluid = seconds;
        report.work.pair_evaluations.fluid = evaluations;
    } else {
        report.roles.solid = seconds;
        report.work.pair_evaluations.solid = evaluations;
    }
    Ok(outcome.stopped)
}
