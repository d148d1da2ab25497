//! `halfstep fake-fluid`: pushes a solid of another program with a known load, so that it can be tried alone. The
//! solid's side of the exchange is that of a run; fluid and coupler are stand-ins.

mod push;

use crate::cause::{Cause, culprit};
use crate::particles::{self, PARTICLES_VARIABLE};
use crate::run::check_gravity;
use crate::session::{Raised, watch};
use crate::silence::{Ended, Silence};
use halfstep_coupling::course::Progress;
use halfstep_coupling::error::RunError;
use halfstep_coupling::external::ExternalSolid;
use halfstep_coupling::roles::probes_of;
use halfstep_coupling::supervise::{Children, StopFlags};
use halfstep_link::{
    self as link, Claim, CouplerLink, Expect, LinkConfig, LinkError, Participant, Port, ProcessLink,
    Processes,
};
use halfstep_output::probes::ProbeLog;
use halfstep_output::run_dir::TRIAL;
use halfstep_output::run_json::{Percentiles, RunStatus, TimeSteps};
use halfstep_output::{OutputError, RunDirectory, RunReport, Table, atomic, read_probes};
use halfstep_role::serve::{FOLDER_VARIABLE, SCENE_VARIABLE};
use halfstep_scene::{Block, Scene, dispatch, geometry};
use halfstep_wire::Name;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{LAST_STAGE, StateHeader, order, status};
use push::Pusher;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Place of the solid among the participants.
const SOLID: usize = 1;

/// A force on the solid's particles, shared in proportion to their masses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// The whole force, N (2D: N/m).
    pub force: [f64; 3],
    /// Only on particles that begin in this box; `None`: on all.
    pub within: Option<Block>,
    /// Time in which the force grows from zero, linearly, s.
    pub ramp: f64,
}

/// What is tried, and for how long.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Which solid of the scene it stands for.
    pub solid: Name,
    /// A line for the shell that starts it.
    pub command: String,
    /// What pushes it.
    pub load: Load,
    /// Longest time step, s; the solid may allow less.
    pub time_step: f64,
    /// Folder of the trial: an empty one, or one of an earlier trial.
    pub out: PathBuf,
    /// Replaces the files of a run in the folder, too.
    pub replace: bool,
    /// How long the solid may be silent, s.
    pub patience: f64,
    /// `halfstep study` or `compare` tries it, and may replace the trial.
    pub by_study: bool,
    /// Ends the trial.
    pub stop: StopFlags,
}

impl Trial {
    /// What is tried, for whoever finds the folder.
    fn json(&self) -> Result<String, RunError> {
        let told = serde_json::json!({
            "solid": self.solid.as_str(),
            "command": self.command,
            "force": self.load.force,
            "within": self.load.within,
            "ramp": self.load.ramp,
            "time_step": self.time_step,
        });
        serde_json::to_string_pretty(&told).map_err(|e| RunError::System(e.to_string()))
    }
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Tried {
    /// Steps.
    pub steps: u64,
    /// The end, s.
    pub time: f64,
    /// Number of the solid's particles, and how many of them the load was on.
    pub particles: [usize; 2],
    /// The solid's probes against time, as in probes.csv.
    pub probes: Table,
    /// From sending the solid its forces to having its next state.
    pub half_step_us: Percentiles,
}

/// Runs a trial to the scene's end. The folder has scene.json, the table of particles, probes.csv, log.txt and a short
/// run.json then.
///
/// # Errors
/// The solid did not come, ended early, or sent what a run would refuse; the folder cannot be written.
pub fn run(scene: &Scene, trial: &Trial) -> Result<Tried, RunError> {
    check_gravity(scene, trial.solid.as_str())?;
    let place =
        1 + scene.solids.iter().position(|solid| solid.name == trial.solid.as_str()).unwrap_or_default();
    let particles = dispatch!(scene.dimension, D => {
        particles::table(scene, &geometry::layout::<D>(scene), place - 1)
    });
    let particles = particles.unwrap_or_default();
    let system = |what: &str, e: std::io::Error| RunError::System(format!("{what}: {e}"));
    let directory = RunDirectory::create(&trial.out, trial.replace || trial.out.join(TRIAL).is_file());
    let directory = directory.map_err(|error| match error {
        OutputError::Occupied { dir, found } => OutputError::HoldsRun { dir, found },
        other => other,
    })?;
    let out = directory.path().canonicalize().map_err(|e| system("the trial's folder", e))?;
    atomic::replace_bytes(&out.join(TRIAL), trial.json()?.as_bytes())?;
    let file = |name: &str| out.join(name);
    let (told, table) = (file("scene.json"), file(&particles::file_name(trial.solid.as_str())));
    let text = scene.to_json().map_err(|e| RunError::System(e.to_string()))?;
    atomic::replace_bytes(&told, text.as_bytes())?;
    atomic::replace_bytes(&table, particles.as_bytes())?;

    let alone = |name: Name, capacity| Participant { name, process: name, capacity, probes: 0 };
    let capacity = particles.lines().count().max(4096) as u32;
    let mut config = LinkConfig::new(vec![alone(Name::FLUID, 1), alone(trial.solid, capacity)]);
    config.patience_seconds = trial.patience;
    let _claim = Claim::new(&config)?;
    let log = file("log.txt");
    std::fs::write(&log, "").map_err(|e| system("log.txt", e))?;
    let mut children = Children::new(&log);
    children.keep(directory.lock());
    let variables = [(SCENE_VARIABLE, told.as_path()), (FOLDER_VARIABLE, &out), (PARTICLES_VARIABLE, &table)];
    children.spawn_shell(&config.participants[SOLID], &trial.command, &config, &variables)?;

    // Without water the first solid is the first participant of a run.
    let of_run = place - usize::from(scene.fluid.is_none());
    let stand_in = ExternalSolid::new(scene, of_run, trial.solid, &out)?;
    let columns: Vec<String> = probes_of(scene, of_run).flat_map(|p| p.columns(scene.dimension)).collect();
    let path = file("probes.csv");
    let progress = Progress::default();
    let log_of_probes = ProbeLog::create(&path, &columns)?;
    let mut pusher = Pusher::new(scene, trial, (place - 1, stand_in), log_of_probes, &progress);
    let started = Instant::now();
    let (abort, connected, done) =
        (Arc::new(AtomicBool::new(false)), AtomicBool::new(false), AtomicBool::new(false));
    let (names, stop) = (config.names(), &trial.stop);
    let (ended, early, later) = std::thread::scope(|threads| {
        let watcher = threads.spawn(|| {
            let early = watch(&mut children, &abort, &connected, &done, &stop.stop);
            (early, Silence::new(&progress, &names).watch(&mut children, &abort, &done, stop))
        });
        let over = Raised(&done);
        let raised = Arc::clone(&abort);
        let config = &config;
        let fluid = threads.spawn(move || fluid(config, raised));
        let ended = CouplerLink::<Processes>::open(config, Some(Arc::clone(&abort)))
            .inspect(|_| connected.store(true, Ordering::Relaxed))
            .map_err(RunError::from)
            .and_then(|link| pusher.run(link));
        drop(over);
        if ended.is_err() {
            abort.store(true, Ordering::Relaxed);
        }
        // What the fluid misses, the coupler misses, too.
        let _ = fluid.join();
        let (early, later) = watcher.join().unwrap_or((None, None));
        (ended, early, later)
    });
    let (steps, time) = pusher.clock;
    let particles = [pusher.pushed.len(), pusher.pushed.iter().filter(|share| **share > 0.0).count()];
    let half_step_us = pusher.half_step_us();
    let ended = ended.and(pusher.solid.finish().map_err(RunError::from));
    let warnings = std::mem::take(&mut pusher.remarks);
    let external = pusher.first.take().into_iter().collect();
    drop(pusher);
    let mean = (steps > 0).then(|| time / steps as f64);
    let mut report = RunReport {
        scene: serde_json::to_value(scene).map_err(|e| RunError::System(e.to_string()))?,
        version: env!("CARGO_PKG_VERSION").into(),
        by_study: Some(trial.by_study),
        steps,
        time,
        wall_seconds: started.elapsed().as_secs_f64(),
        dt: TimeSteps { mean, ..TimeSteps::default() },
        round_trip_us: Some(half_step_us),
        warnings,
        external,
        ..RunReport::default()
    };
    let stopped = stop.stop.load(Ordering::Relaxed);
    let waiting = !connected.load(Ordering::Relaxed);
    let ended = ended.map_err(|error| {
        if let (RunError::Link(_), Some(Ended::Silent(role, silence))) = (&error, later) {
            children.stop(Duration::from_millis(300));
            return match waiting {
                true => RunError::StoppedEarly,
                false => RunError::StoppedAtOnce { role, seconds: silence.as_secs_f64() },
            };
        }
        let ended = culprit(&mut children, &error);
        // The handshake may have ended at the same moment.
        if stopped && (waiting || steps == 0) {
            return RunError::StoppedEarly;
        }
        let failed = match later {
            Some(Ended::Failed(role, status)) => Some((role, status)),
            _ => None,
        };
        Cause { log: &log, external: &[trial.solid], at: (!waiting).then_some((steps, time)) }
            .of(error, early.or(failed).or(ended))
    });
    report.status = Some(match &ended {
        Ok(()) if !stopped => RunStatus::Finished,
        Ok(()) => RunStatus::Stopped,
        Err(error) if error.is_stop() => RunStatus::Stopped,
        Err(RunError::Diverged { .. }) => RunStatus::Diverged,
        Err(_) => RunStatus::Failed,
    });
    let why = ended.as_ref().err().filter(|error| !matches!(error, RunError::StoppedEarly));
    report.error = why.map(ToString::to_string);
    match (ended, report.write(&file("run.json"))) {
        (Ok(()), Ok(())) => {
            children.wait(Duration::from_secs(5));
            Ok(Tried { steps, time, particles, probes: read_probes(&path)?, half_step_us })
        }
        (Err(error), Ok(())) => Err(error),
        (Ok(()), Err(unwritten)) => Err(unwritten.into()),
        // A full disk may be the reason for both: the first says what was tried.
        (Err(error), Err(unwritten)) => Err(RunError::System(format!("{error}; and {unwritten}"))),
    }
}

/// A fluid that says nothing of interest, on time.
fn fluid(config: &LinkConfig, abort: Arc<AtomicBool>) -> Result<(), LinkError> {
    let mut link = ProcessLink::<Processes>::open(config, Name::FLUID, Some(abort))?;
    let (mut states, mut forces) = (Vec::new(), Vec::new());
    let mut half_step = HalfStep::begin(0, 0.0);
    loop {
        let (expect, header) = (Expect::of(&half_step), half_step.state_header());
        let state = link.receive_peer(0, 0, &expect.dt(header.dt), &mut states)?;
        if state.status != status::OK {
            return Ok(());
        }
        let header = StateHeader { dt_limit: f64::MAX, ..header };
        link.send_state(0, &header, &[])?;
        let answer = link.receive_forces(0, &expect, &mut forces)?;
        if answer.order & order::STOP != 0 {
            let last = StateHeader { stage: LAST_STAGE, status: status::FINISHED, ..header };
            return link.send_state(0, &last, &[]);
        }
        half_step = half_step.with_step(answer.dt, answer.next_time).next();
    }
}

/// Removes what trials that were killed left behind.
pub fn clean_up() {
    link::cleanup_stale();
}
