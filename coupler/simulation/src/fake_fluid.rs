//! `halfstep fake-fluid`: pushes a solid of another program with a known load, so that it can be tried alone. The
//! solid's side of the exchange is that of a run; fluid and coupler are stand-ins.

use crate::cause::{Cause, culprit};
use crate::particles::{self, PARTICLES_VARIABLE};
use crate::run::check_gravity;
use crate::session::watch;
use halfstep_coupling::error::RunError;
use halfstep_coupling::external::{Continuity, ExternalSolid, WallContact};
use halfstep_coupling::roles::probes_of;
use halfstep_coupling::say;
use halfstep_coupling::supervise::{Children, StopFlags};
use halfstep_link::{
    self as link, Claim, CouplerLink, CouplerPort, Expect, FLUID, LinkConfig, LinkError, Participant, Port,
    ProcessLink, Processes, StateMessage,
};
use halfstep_output::probes::ProbeLog;
use halfstep_output::run_dir::TRIAL;
use halfstep_output::run_json::{Percentiles, RunStatus, TimeSteps};
use halfstep_output::{OutputError, RunDirectory, RunReport, Table, atomic, read_probes};
use halfstep_role::serve::{FOLDER_VARIABLE, SCENE_VARIABLE};
use halfstep_scene::geometry::{self, holds};
use halfstep_scene::{Block, Scene, dispatch};
use halfstep_wire::Name;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{
    ForceHeader, ForceRecord, LAST_STAGE, StateHeader, StateRecord, order, status,
};
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
    let config = LinkConfig::new(vec![alone(Name::FLUID, 1), alone(trial.solid, capacity)]);
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
    let mut pusher = Pusher {
        scene,
        trial,
        solid: stand_in,
        continuity: Continuity::new(scene, place - 1, true),
        walls: WallContact::new(scene, place - 1),
        log: ProbeLog::create(&path, &columns)?,
        clock: (0, 0.0),
        pushed: Vec::new(),
        half_steps: Vec::new(),
        remarks: Vec::new(),
    };
    let started = Instant::now();
    let (abort, connected, done) =
        (Arc::new(AtomicBool::new(false)), AtomicBool::new(false), AtomicBool::new(false));
    let (ended, early) = std::thread::scope(|threads| {
        let watcher = threads.spawn(|| watch(&mut children, &abort, &connected, &done, &trial.stop.stop));
        let raised = Arc::clone(&abort);
        let config = &config;
        let fluid = threads.spawn(move || fluid(config, raised));
        let ended = CouplerLink::<Processes>::open(config, Some(Arc::clone(&abort)))
            .inspect(|_| connected.store(true, Ordering::Relaxed))
            .map_err(RunError::from)
            .and_then(|link| pusher.run(link));
        done.store(true, Ordering::Relaxed);
        if ended.is_err() {
            abort.store(true, Ordering::Relaxed);
        }
        // What the fluid misses, the coupler misses, too.
        let _ = fluid.join();
        (ended, watcher.join().unwrap_or(None))
    });
    let (steps, time) = pusher.clock;
    let particles = [pusher.pushed.len(), pusher.pushed.iter().filter(|share| **share > 0.0).count()];
    let half_step_us = percentiles(std::mem::take(&mut pusher.half_steps));
    pusher.solid.finish()?;
    let warnings = std::mem::take(&mut pusher.remarks);
    drop(pusher);
    let mean = (steps > 0).then(|| time / steps as f64);
    let mut report = RunReport {
        scene: serde_json::to_value(scene).map_err(|e| RunError::System(e.to_string()))?,
        version: env!("CARGO_PKG_VERSION").into(),
        steps,
        time,
        wall_seconds: started.elapsed().as_secs_f64(),
        dt: TimeSteps { mean, ..TimeSteps::default() },
        round_trip_us: Some(half_step_us),
        warnings,
        ..RunReport::default()
    };
    let ended = ended.map_err(|error| {
        let ended = culprit(&mut children, &error);
        let cause = early.or(ended);
        let at = connected.load(Ordering::Relaxed).then_some((steps, time));
        Cause { log: &log, external: &[trial.solid], at }.of(error, cause)
    });
    let stopped = trial.stop.stop.load(Ordering::Relaxed);
    report.status = Some(match &ended {
        Ok(()) if stopped => RunStatus::Stopped,
        Ok(()) => RunStatus::Finished,
        Err(_) => RunStatus::Failed,
    });
    report.error = ended.as_ref().err().map(ToString::to_string);
    report.write(&file("run.json"))?;
    match ended {
        Ok(()) => {
            children.wait(Duration::from_secs(5));
            Ok(Tried { steps, time, particles, probes: read_probes(&path)?, half_step_us })
        }
        Err(error) => Err(error),
    }
}

/// Median, and what one in a hundred exceeds; zeros of nothing.
fn percentiles(mut durations: Vec<f32>) -> Percentiles {
    durations.sort_unstable_by(f32::total_cmp);
    let of = |share: f64| {
        let place = (durations.len() as f64 * share) as usize;
        durations.get(place).or(durations.last()).map_or(0.0, |us| f64::from(*us))
    };
    Percentiles { p50: of(0.5), p99: of(0.99) }
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

/// A coupler that answers with the load.
struct Pusher<'a> {
    scene: &'a Scene,
    trial: &'a Trial,
    solid: ExternalSolid,
    continuity: Continuity,
    /// Contact with walls, unless the solid evaluates it itself.
    walls: Option<WallContact>,
    log: ProbeLog,
    /// Step n and its time, s.
    clock: (u64, f64),
    /// Share of the load of each particle.
    pushed: Vec<f64>,
    /// Duration of each of the solid's half-steps, µs.
    half_steps: Vec<f32>,
    /// What the trial was warned of.
    remarks: Vec<String>,
}

impl Pusher<'_> {
    fn run(&mut self, mut link: CouplerLink<Processes>) -> Result<(), RunError> {
        let mut sent: Option<Instant> = None;
        let mut last_dt = 0.0;
        loop {
            let (step, time) = self.clock;
            let stops = time >= self.scene.end_time || self.trial.stop.stop.load(Ordering::Relaxed);
            let (mut dt, mut next_time) = (0.0, time);
            for stage in 0..2 {
                let half_step = HalfStep::begin(step, time).with_step(dt, next_time).both()[stage];
                let expect = Expect::of(&half_step).dt(half_step.state_header().dt);
                // The solid first: one that fails says so, and then the stand-in for the fluid ends, too.
                let state = link.receive_state(SOLID, &expect)?;
                self.half_steps.extend(sent.map(|sent| sent.elapsed().as_secs_f32() * 1e6));
                if state.header().status != status::OK {
                    return Err(RunError::RoleFailed { role: self.trial.solid, step, said: None });
                }
                drop(link.receive_state(FLUID, &expect)?);
                let records = state.records();
                self.continuity.check(
                    records,
                    if stage == 0 { last_dt } else { dt },
                    (step, stage as u32),
                )?;
                if let Some(remark) = self.continuity.remark() {
                    say::warn(format_args!("warning: {remark}"));
                    self.remarks.push(remark);
                }
                if step == 0 && stage == 0 {
                    if state.header().holds_own_walls() {
                        self.walls = None;
                    }
                    self.begin(records)?;
                }
                if stage == 0 && !stops {
                    let left = self.scene.end_time - time;
                    let contact = self.walls.as_ref().map_or(f64::INFINITY, WallContact::limit);
                    dt = self.trial.time_step.min(state.header().dt_limit).min(contact).min(left);
                    next_time = if dt < left { time + dt } else { self.scene.end_time };
                }
                // The last state has no step: contacts then take that of their limit.
                let step_length = if stops { f64::INFINITY } else { dt };
                let contact = self.touch([half_step.before(), step_length], records, stage == 0);
                let forces = self.forces(half_step.before(), records, &contact);
                if stage == 0 {
                    self.log.row(time, self.solid.measure(records, &forces, &contact))?;
                }
                let order = if stops { order::STOP } else { order::GO };
                let header = ForceHeader { order, ..half_step.with_step(dt, next_time).force_header() };
                link.send_forces(SOLID, &header, if stops { &[] } else { &forces })?;
                sent = Some(Instant::now());
                drop(state);
                link.send_forces(FLUID, &header, &[])?;
                if stops {
                    for place in [FLUID, SOLID] {
                        drop(link.receive_state(place, &Expect::last(step))?);
                    }
                    return Ok(());
                }
            }
            self.clock = (step + 1, next_time);
            last_dt = dt;
        }
    }

    fn begin(&mut self, records: &[StateRecord]) -> Result<(), RunError> {
        self.solid.begin(records);
        if let Some(walls) = &mut self.walls {
            walls.begin(records);
        }
        let is_pushed = |r: &StateRecord| self.trial.load.within.is_none_or(|b| holds(&b, &r.position, 0.0));
        let shares = records.iter().map(|r| if is_pushed(r) { r.mass } else { 0.0 });
        self.pushed = shares.collect();
        let sum: f64 = self.pushed.iter().sum();
        if sum <= 0.0 {
            return Err(RunError::System(
                "none of the solid's particles begins in the box of --within".into(),
            ));
        }
        self.pushed.iter_mut().for_each(|share| *share /= sum);
        Ok(())
    }

    /// Force of walls on each record at a time, s, in a time step `dt`, s. `whole`: of a state at n.
    fn touch(&mut self, [time, dt]: [f64; 2], records: &[StateRecord], whole: bool) -> Vec<[f64; 2]> {
        let Some(walls) = &mut self.walls else { return vec![[0.0; 2]; records.len()] };
        walls.evaluate(records, [time, dt], whole);
        (0..records.len()).map(|k| walls.on(k)).collect()
    }

    /// Load at a time, s, and contact.
    fn forces(&self, time: f64, records: &[StateRecord], contact: &[[f64; 2]]) -> Vec<ForceRecord> {
        let load = self.trial.load;
        let grown = if load.ramp > 0.0 { (time / load.ramp).min(1.0) } else { 1.0 };
        let on = |((record, share), contact): ((&StateRecord, &f64), &[f64; 2])| {
            let [x, y, z] = load.force.map(|f| grown * share * f);
            let stress_force = [x + contact[0], y + contact[1], z];
            ForceRecord { id: record.id, flags: 0, cross_viscosity: [0.0; 3], stress_force }
        };
        records.iter().zip(&self.pushed).zip(contact).map(on).collect()
    }
}

/// Removes what trials that were killed left behind.
pub fn clean_up() {
    link::cleanup_stale();
}
