//! The coupler of a trial: answers the solid with the load.

use super::{SOLID, Trial};
use halfstep_coupling::clock;
use halfstep_coupling::course::Progress;
use halfstep_coupling::error::RunError;
use halfstep_coupling::external::{Continuity, ExternalSolid, WallContact};
use halfstep_coupling::say;
use halfstep_link::{CouplerLink, CouplerPort, Expect, FLUID, LinkError, Processes, StateMessage};
use halfstep_output::run_json::Percentiles;
use halfstep_output::{FirstMessage, ProbeLog};
use halfstep_scene::Scene;
use halfstep_scene::geometry::holds;
use halfstep_wire::Name;
use halfstep_wire::failure::Diverged;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, StateRecord, order, status};
use std::sync::atomic::Ordering;
use std::time::Instant;

type Link = CouplerLink<Processes>;

/// Median, and what one in a hundred exceeds; zeros of nothing.
fn percentiles(mut durations: Vec<f32>) -> Percentiles {
    durations.sort_unstable_by(f32::total_cmp);
    let of = |share: f64| {
        let place = (durations.len() as f64 * share) as usize;
        durations.get(place).or(durations.last()).map_or(0.0, |us| f64::from(*us))
    };
    Percentiles { p50: of(0.5), p99: of(0.99) }
}

/// A coupler that answers with the load.
pub(super) struct Pusher<'a> {
    scene: &'a Scene,
    trial: &'a Trial,
    pub(super) solid: ExternalSolid,
    /// Its first message beside what the scene has.
    pub(super) first: Option<FirstMessage>,
    continuity: Continuity,
    /// Contact with walls, unless the solid evaluates it itself.
    walls: Option<WallContact>,
    log: ProbeLog,
    /// For who watches the trial.
    progress: &'a Progress,
    /// Step n and its time, s.
    pub(super) clock: (u64, f64),
    /// Share of the load of each particle.
    pub(super) pushed: Vec<f64>,
    /// Duration of each of the solid's half-steps, µs.
    half_steps: Vec<f32>,
    /// What the trial was warned of.
    pub(super) remarks: Vec<String>,
}

impl<'a> Pusher<'a> {
    /// Before the first step, `solid` being at this place among the scene's.
    pub(super) fn new(
        scene: &'a Scene,
        trial: &'a Trial,
        (place, solid): (usize, ExternalSolid),
        log: ProbeLog,
        progress: &'a Progress,
    ) -> Self {
        Self {
            scene,
            trial,
            solid,
            first: None,
            continuity: Continuity::new(scene, place, true),
            walls: WallContact::new(scene, place),
            log,
            progress,
            clock: (0, 0.0),
            pushed: Vec::new(),
            half_steps: Vec::new(),
            remarks: Vec::new(),
        }
    }

    /// How long the solid's half-steps took.
    pub(super) fn half_step_us(&mut self) -> Percentiles {
        percentiles(std::mem::take(&mut self.half_steps))
    }

    fn receive(
        &self,
        link: &mut Link,
        place: usize,
        expect: &Expect,
    ) -> Result<<Link as CouplerPort>::State, LinkError> {
        self.progress.await_message(place);
        let state = link.receive_state(place, expect)?;
        self.progress.note_message();
        Ok(state)
    }

    /// The step, s, that the trial, the solid and its contact with walls allow.
    fn allowed(&self, step: u64, dt_limit: f64) -> Result<f64, RunError> {
        let contact = self.walls.as_ref().map_or(f64::INFINITY, WallContact::limit);
        let own = self.trial.time_step.min(contact);
        let dt = own.min(dt_limit);
        if clock::reaches_end(dt, self.scene.end_time) {
            return Ok(dt);
        }
        let participant = if dt_limit < own { self.trial.solid } else { Name::COUPLER };
        Err(Diverged::of_time_step(participant, dt, step).into())
    }

    /// Pushes the solid to the scene's end, or until the trial is stopped.
    pub(super) fn run(&mut self, mut link: Link) -> Result<(), RunError> {
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
                let state = self.receive(&mut link, SOLID, &expect)?;
                self.half_steps.extend(sent.map(|sent| sent.elapsed().as_secs_f32() * 1e6));
                if state.header().status != status::OK {
                    return Err(RunError::RoleFailed { role: self.trial.solid, step, said: None });
                }
                drop(self.receive(&mut link, FLUID, &expect)?);
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
                    dt = self.allowed(step, state.header().dt_limit)?.min(left);
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
                // Before the forces are there: a solid that is woken may take this core.
                sent = Some(Instant::now());
                link.send_forces(SOLID, &header, if stops { &[] } else { &forces })?;
                drop(state);
                link.send_forces(FLUID, &header, &[])?;
                if stops {
                    for place in [FLUID, SOLID] {
                        drop(self.receive(&mut link, place, &Expect::last(step))?);
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
        self.first = self.solid.first_message(self.scene, records);
        for remark in self.first.iter().flat_map(|first| first.remarks(self.scene.dimension)) {
            say::warn(format_args!("warning: {remark}"));
            self.remarks.push(remark);
        }
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
