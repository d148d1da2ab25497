//! What a run writes down as it goes: probe log, statistics, progress.

use crate::clock::{Tick, times_above_limit};
use crate::energy::{self, Account, EnergyBalance};
use crate::error::RunError;
use crate::roles::measured_by;
use crate::say;
use halfstep_output::probes::Logged;
use halfstep_output::{FirstMessage, OutputError, ProbeLog, RunReport, run_json};
use halfstep_scene::{Phase, Scene, Solid};
use halfstep_wire::failure::Diverged;
use halfstep_wire::protocol::{Audit, StateHeader};
use halfstep_wire::state::{Fields, Group, State, StateError};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Least pause between two renewals of the report: each waits for the disk.
const RENEWAL: Duration = Duration::from_secs(1);

/// Part of a run after which a line tells of it.
const TENTH: f64 = 0.1;

/// What a participant measured on the state at n.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// Its phase.
    pub phase: Phase,
    /// Values of its probes in the scene's order; empty where no row is due.
    pub probes: &'a [f64],
    /// Sums over its particles.
    pub audit: &'a Audit,
    /// Sub-steps of the last step.
    pub sub_steps: u32,
    /// Own particles.
    pub particles: u64,
}

impl<'a> Measured<'a> {
    /// What a state message carries, with the probe values that came beside it.
    pub fn of(phase: Phase, header: &'a StateHeader, probes: &'a [f64]) -> Self {
        let StateHeader { audit, sub_steps, particles, .. } = header;
        Self { phase, probes, audit, sub_steps: *sub_steps, particles: *particles }
    }
}

/// Probe log, statistics and progress of a run.
pub struct Recorder {
    log: Option<ProbeLog>,
    /// The log when it was last synchronised.
    logged: Logged,
    /// What a crash of the machine leaves of the run's report: its file, and when it was written last.
    report: Option<(PathBuf, RunReport)>,
    renewed: Instant,
    /// For each probe the place of its participant and its number of values.
    order: Vec<(usize, usize)>,
    values: Vec<f64>,
    bar: ProgressBar,
    /// Progress as lines: the part of the run at the last one, and when it was.
    lines: Option<(f64, Instant)>,
    started: Instant,
    /// Duration of the run before an interruption, s.
    earlier: f64,
    shown: Instant,
    end: f64,
    steps: u64,
    time: f64,
    dt: (f64, f64, f64),
    particle_steps: f64,
    /// Largest number of sub-steps in a step of each participant; 0 of the fluid.
    sub_steps: Vec<u32>,
    first_momentum: Option<[f64; 3]>,
    momentum_scale: f64,
    momentum_drift: f64,
    first_energy: Option<f64>,
    energy: f64,
    density_error: f64,
    gap: f64,
    removed: u64,
    first_fluid: Option<u64>,
    isolated: bool,
    dimension: usize,
    /// What external solids published first.
    external: Vec<FirstMessage>,
    /// What the run was warned of on its way.
    told: Vec<String>,
    balance: EnergyBalance,
}

impl Recorder {
    /// For a scene; `quiet` hides the progress. The rows of probe values go to `log`, where there is one.
    pub fn new(scene: &Scene, log: Option<ProbeLog>, quiet: bool) -> Self {
        let bar = ProgressBar::new(1000);
        let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}  ETA {eta}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        // Where nobody sees a bar, lines tell.
        let lines = !quiet && !std::io::stderr().is_terminal();
        if quiet || lines {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        let now = Instant::now();
        // Momentum is kept only where nothing outside acts.
        let isolated = scene.gravity == [0.0; 3]
            && scene.frame.is_none()
            && scene.shapes.iter().all(|s| {
                s.phase != Phase::Wall && s.clamp.is_empty() && s.motion.is_none() && s.load.is_none()
            })
            && scene.fluid.as_ref().is_none_or(|fluid| fluid.beach.is_none())
            && scene.solids.iter().all(|s| s.side_friction == 0.0)
            && scene.solids.iter().filter_map(Solid::rigid).all(|keys| keys.joints.is_empty());
        Self {
            log,
            order: measured_by(scene)
                .into_iter()
                .zip(&scene.probes)
                .map(|(place, probe)| (place, probe.kind.count(scene.dimension)))
                .collect(),
            values: Vec::new(),
            bar,
            lines: lines.then_some((0.0, now)),
            started: now,
            shown: now,
            end: scene.end_time,
            steps: 0,
            time: 0.0,
            dt: (f64::INFINITY, 0.0, 0.0),
            particle_steps: 0.0,
            sub_steps: Vec::new(),
            first_momentum: None,
            momentum_scale: 0.0,
            momentum_drift: 0.0,
            first_energy: None,
            energy: 0.0,
            density_error: 0.0,
            gap: f64::INFINITY,
            removed: 0,
            first_fluid: None,
            isolated,
            dimension: scene.dimension,
            external: Vec::new(),
            told: Vec::new(),
            balance: EnergyBalance::new(scene),
            earlier: 0.0,
            logged: Logged::default(),
            report: None,
            renewed: now,
        }
    }

    /// Renews the report in a file with frames, at most every second, with the steps done and the time reached.
    pub fn renew(&mut self, path: PathBuf, report: RunReport) {
        self.report = Some((path, report));
    }

    /// Writes down how far the run has come, and makes sure that the rows so far outlive a crash of the machine.
    fn renew_report(&mut self) -> Result<(), OutputError> {
        self.renewed = Instant::now();
        self.synchronise()?;
        let wall_seconds = self.wall_seconds();
        let Some((path, report)) = &mut self.report else { return Ok(()) };
        (report.steps, report.time, report.wall_seconds) = (self.steps, self.time, wall_seconds);
        report.write(path)
    }

    /// The columns of a scene's probe log.
    pub fn columns(scene: &Scene) -> Vec<String> {
        scene.probes.iter().flat_map(|p| p.columns(scene.dimension)).collect()
    }

    /// Brings the probe values of each participant into the order of [`Self::columns`]; NaN where one is missing.
    pub fn arrange(&self, by_participant: &[&[f64]], values: &mut Vec<f64>) {
        let mut rest: Vec<_> = by_participant.iter().map(|own| own.iter()).collect();
        values.clear();
        for &(place, n) in &self.order {
            let mut next = || rest.get_mut(place).and_then(Iterator::next).copied().unwrap_or(f64::NAN);
            values.extend((0..n).map(|_| next()));
        }
    }

    /// Goes on from a checkpoint, with the log of the interrupted run where it has one. Returns the recorder of a run
    /// that was never interrupted.
    ///
    /// # Errors
    /// The checkpoint is none of this scene, or the log lacks rows.
    pub fn resume(mut self, scene: &Scene, log: Option<&Path>, state: &Group) -> Result<Self, RunError> {
        self.load(state)?;
        self.log = log.map(|path| ProbeLog::resume(path, &Self::columns(scene), self.logged)).transpose()?;
        Ok(self)
    }

    /// Forgets the rows that an interrupted run wrote after what this one goes on from.
    pub(crate) fn forget_later_rows(&self) -> Result<(), OutputError> {
        self.log.as_ref().map_or(Ok(()), ProbeLog::forget_rest)
    }

    /// Seconds of computation, those before an interruption included.
    fn wall_seconds(&self) -> f64 {
        self.earlier + self.started.elapsed().as_secs_f64()
    }

    /// Makes sure that the rows so far outlive a crash of the machine.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn synchronise(&mut self) -> Result<(), OutputError> {
        if let Some(log) = &self.log {
            self.logged = log.synchronise()?;
        }
        Ok(())
    }

    /// Judges the energies of the state at n.
    pub fn judge(&mut self, step: u64, time: f64, accounts: &[Account<'_>]) -> Option<Diverged> {
        self.balance.note(time, accounts).map(|excess| energy::diverged(excess, step))
    }

    /// Warns in the log and on the terminal.
    pub(crate) fn warn(&self, warning: &str) {
        tracing::warn!("{warning}");
        self.bar.suspend(|| say::warn(format_args!("warning: {warning}")));
    }

    /// As [`Self::warn`], and in the report.
    pub(crate) fn note_warning(&mut self, warning: String) {
        self.warn(&warning);
        if let Some((path, report)) = self.report.as_mut() {
            report.warnings.push(warning.clone());
            // A run that is killed has said it, too.
            if let Err(error) = report.write(path) {
                tracing::warn!("{error}");
            }
        }
        self.told.push(warning);
    }

    /// Takes what external solids published first into the report, and warns of what the scene has otherwise; of a run
    /// that was `resumed` the report knows it.
    pub(crate) fn compare_first(&mut self, mut first: Vec<FirstMessage>, resumed: bool) {
        if let Some((_, report)) =
            self.report.as_ref().filter(|(_, report)| resumed && !report.external.is_empty())
        {
            self.external.clone_from(&report.external);
            return;
        }
        // The first velocities of a run that goes on are none with which the scene begins.
        first.iter_mut().filter(|_| resumed).for_each(|message| message.off_velocity = 0.0);
        let remarks = first.iter().filter(|_| !resumed).flat_map(|message| message.remarks(self.dimension));
        remarks.for_each(|remark| self.warn(&remark));
        if let Some((path, report)) = self.report.as_mut().filter(|_| !first.is_empty()) {
            report.external.clone_from(&first);
            // Whoever goes on from the first checkpoint has to know whose solid it is.
            if let Err(error) = report.write(path) {
                tracing::warn!("{error}");
            }
        }
        self.external = first;
    }

    /// Notes the state at n, as all participants measured it.
    ///
    /// # Errors
    /// A row of the probe log cannot be written.
    pub fn note(&mut self, tick: &Tick, measured: &[Measured<'_>]) -> Result<(), OutputError> {
        self.time = tick.time;
        if let (Some(limit), Some(dt)) = (tick.exceeded, tick.dt) {
            let warning = times_above_limit(dt, limit.participant.as_str(), limit.dt);
            self.warn(&warning);
        }
        if tick.row {
            let own: Vec<&[f64]> = measured.iter().map(|m| m.probes).collect();
            let mut values = std::mem::take(&mut self.values);
            self.arrange(&own, &mut values);
            self.values = values;
            if let Some(log) = &mut self.log {
                log.row(tick.time, &self.values)?;
            }
        }
        self.audit(measured);
        let particles: u64 = measured.iter().map(|m| m.particles).sum();
        if let Some(dt) = tick.dt {
            self.steps += 1;
            self.particle_steps += particles as f64;
            self.dt = (self.dt.0.min(dt), self.dt.1 + dt, self.dt.2.max(dt));
        }
        if tick.frame && self.renewed.elapsed() > RENEWAL {
            self.renew_report()?;
        }
        self.sub_steps.resize(measured.len(), 0);
        let own = self.sub_steps.iter_mut().zip(measured);
        own.filter(|(_, m)| m.phase == Phase::Solid).for_each(|(most, m)| *most = m.sub_steps.max(*most));
        if self.shown.elapsed() > Duration::from_millis(200) {
            self.shown = Instant::now();
            self.tell_line();
            let rate = self.particle_steps / self.wall_seconds();
            self.bar.set_position((1000.0 * self.time / self.end) as u64);
            self.bar.set_message(format!(
                "t = {:.4} s  dt = {:.2e} s  {:.2} M particle-steps/s",
                self.time,
                tick.dt.unwrap_or(0.0),
                rate * 1e-6
            ));
        }
        Ok(())
    }

    /// Says in a line how far the run has come: at each tenth of it, at most every second, or after half a minute.
    fn tell_line(&mut self) {
        let part = self.time / self.end;
        let Some((told, when)) = &mut self.lines else { return };
        let (further, later) = (part - *told, when.elapsed().as_secs_f64());
        if (further >= TENTH && later >= 1.0) || later >= 30.0 {
            let seconds = self.started.elapsed().as_secs_f64();
            let rest = if part > 0.0 { seconds * (1.0 - part) / part } else { f64::NAN };
            say::warn(format_args!(
                "{:3.0} %  t = {:.4} s  {seconds:.0} s gone, about {rest:.0} s to go",
                100.0 * part,
                self.time
            ));
            // The next tenth, not a tenth later.
            *told = (part / TENTH).floor() * TENTH;
            *when = Instant::now();
        }
    }

    fn audit(&mut self, measured: &[Measured<'_>]) {
        let (mut momentum, mut kinetic, mut stored, mut mass) = ([0.0; 3], 0.0, 0.0, 0.0);
        for m in measured {
            for d in 0..3 {
                momentum[d] += m.audit.momentum[d];
            }
            kinetic += m.audit.kinetic_energy;
            stored += m.audit.stored_energy;
            mass += m.audit.mass;
        }
        if let Some(f) = measured.iter().find(|m| m.phase == Phase::Fluid) {
            self.density_error = self.density_error.max(f.audit.density_error);
            self.gap = self.gap.min(f.audit.gap);
            let first = *self.first_fluid.get_or_insert(f.particles);
            self.removed = first.saturating_sub(f.particles);
        }
        self.energy = kinetic + stored;
        self.first_energy.get_or_insert(self.energy);
        let first = *self.first_momentum.get_or_insert(momentum);
        // Scale: all mass at the speed of the largest kinetic energy seen.
        self.momentum_scale = self.momentum_scale.max((2.0 * kinetic * mass).sqrt());
        // What leaves takes its momentum along.
        if self.isolated && self.removed == 0 && self.momentum_scale > 0.0 {
            let drift = (0..3).map(|d| (momentum[d] - first[d]).abs()).fold(0.0, f64::max);
            self.momentum_drift = self.momentum_drift.max(drift / self.momentum_scale);
        }
    }

    /// Puts the statistics into the report.
    pub fn finish(&self, report: &mut RunReport) {
        self.bar.finish_and_clear();
        report.steps = self.steps;
        report.time = self.time;
        report.wall_seconds = self.wall_seconds();
        if report.wall_seconds > 0.0 {
            report.particle_steps_per_second = Some(self.particle_steps / report.wall_seconds);
        }
        if self.steps > 0 {
            report.dt = run_json::TimeSteps {
                min: Some(self.dt.0),
                mean: Some(self.dt.1 / self.steps as f64),
                max: Some(self.dt.2),
            };
        }
        report.sub_steps = self.sub_steps.iter().copied().max().filter(|most| *most > 0);
        for (participant, most) in report.participants.iter_mut().zip(&self.sub_steps) {
            participant.sub_steps = Some(*most).filter(|most| *most > 0);
            participant.energy_growth = self.balance.growth_of(&participant.name);
        }
        report.audit.momentum_drift = self.isolated.then_some(self.momentum_drift);
        report.audit.energy_drift = self
            .first_energy
            .filter(|&e| self.isolated && self.first_fluid.is_none() && e > 0.0)
            .map(|e| self.energy / e - 1.0);
        // What begins outside of the domain is gone before the first state.
        let at_first = self.first_fluid.map_or(0, |first| report.particles.fluid.saturating_sub(first));
        report.particles.removed = at_first + self.removed;
        // A run that ended before the first states knows what an earlier part of it wrote.
        if !self.external.is_empty() {
            report.external.clone_from(&self.external);
        }
        report.warnings.extend(self.told.iter().cloned());
        report.audit.energy_growth = self.balance.growth();
        report.audit.density_error = self.first_fluid.map(|_| self.density_error);
        report.audit.min_gap = self.gap.is_finite().then_some(self.gap);
    }
}

impl State for Recorder {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let mut wall_seconds = self.wall_seconds();
        fields.real("wall_seconds", &mut wall_seconds)?;
        if fields.loading() {
            self.earlier = wall_seconds;
        }
        fields.count("log_bytes", &mut self.logged.bytes)?;
        fields.count("log_hash", &mut self.logged.hash)?;
        fields.count("steps", &mut self.steps)?;
        fields.real("time", &mut self.time)?;
        fields.real("least_dt", &mut self.dt.0)?;
        fields.real("sum_of_dt", &mut self.dt.1)?;
        fields.real("largest_dt", &mut self.dt.2)?;
        fields.real("particle_steps", &mut self.particle_steps)?;
        fields.numbers("sub_steps", &mut self.sub_steps)?;
        let mut momentum: Vec<[f64; 3]> = self.first_momentum.into_iter().collect();
        fields.points("first_momentum", &mut momentum)?;
        self.first_momentum = momentum.first().copied();
        fields.real("momentum_scale", &mut self.momentum_scale)?;
        fields.real("momentum_drift", &mut self.momentum_drift)?;
        fields.optional_real("first_energy", &mut self.first_energy)?;
        fields.real("energy", &mut self.energy)?;
        fields.real("density_error", &mut self.density_error)?;
        fields.real("gap", &mut self.gap)?;
        fields.count("removed", &mut self.removed)?;
        fields.optional_count("first_fluid", &mut self.first_fluid)?;
        fields.part("energy_balance", &mut self.balance)
    }
}
