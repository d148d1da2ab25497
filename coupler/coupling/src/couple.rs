//! The coupler's half-steps: checks the states, evaluates the cross-phase forces, decides dt and orders.

use crate::checkpoints::Checkpoints;
use crate::clock::{Clock, Limit, Tick};
use crate::energy::Account;
use crate::error::RunError;
use crate::foreign::ForeignSolid;
use crate::recorder::{Measured, Recorder};
use halfstep_interface::cross_viscosity::CrossViscosity;
use halfstep_interface::{Interface, Parameters};
use halfstep_link::{CouplerPort, Expect, FLUID, StateMessage};
use halfstep_output::run_json::RoleSeconds;
use halfstep_scene::Scene;
use halfstep_sph::Phase;
use halfstep_sph::lane::Isa;
use halfstep_wire::Name;
use halfstep_wire::failure::Diverged;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, StateHeader, StateRecord, ability, order, status};
use halfstep_wire::state::{Fields, Group, State, StateError};
use halfstep_wire::wide;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use xxhash_rust::xxh3::Xxh3;

/// Half-steps between two checks that action equals reaction.
const AUDIT_INTERVAL: u64 = 50;

/// How a run ended.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// It was told to stop before its end.
    pub stopped: bool,
    /// Last messages of the participants.
    pub last: Vec<StateHeader>,
    /// Where the coupler's time went.
    pub seconds: RoleSeconds,
    /// Largest relative mismatch of the forces on both sides.
    pub action_reaction: f64,
    /// Consistency checks passed.
    pub checks: u64,
    /// Pairs listed in the coupler's sums.
    pub pair_evaluations: u64,
}

/// The one time line of a run, what is written down of it, and who may end it.
pub struct Course {
    /// Steps and times.
    pub clock: Clock,
    /// Probe log, statistics, progress.
    pub recorder: Recorder,
    /// `None`: nothing is saved.
    pub checkpoints: Option<Checkpoints>,
    /// Set, it ends the run at the next state n.
    pub stop: Arc<AtomicBool>,
    /// For who watches the run.
    pub progress: Arc<Progress>,
}

/// How far a run is, seen from another thread.
#[derive(Debug, Default)]
pub struct Progress {
    messages: AtomicU64,
    awaited: AtomicUsize,
}

impl Progress {
    /// Messages received so far.
    pub fn messages(&self) -> u64 {
        self.messages.load(Ordering::Relaxed)
    }

    /// Place of the participant whose message was awaited last.
    pub fn awaited(&self) -> usize {
        self.awaited.load(Ordering::Relaxed)
    }
}

/// What the coupler holds of a solid.
struct SolidSide<const D: usize> {
    /// `None` where there is no fluid.
    interface: Option<Interface<D>>,
    forces: Vec<ForceRecord>,
    /// Positions at n, m.
    at_n: Vec<[f64; 3]>,
    /// Number of its interface particles, once known.
    count: Option<u64>,
    /// Hash of the state that a checkpoint was made of, as the solid published it.
    saved: u64,
    foreign: Option<ForeignSolid>,
}

/// The coupler of a run, whatever carries its messages. A step is [`Self::first`], [`Self::note`], [`Self::second`].
pub struct Coupler<P: CouplerPort, const D: usize> {
    /// The exchange.
    pub port: P,
    phases: Vec<Phase>,
    solids: Vec<SolidSide<D>>,
    cross: CrossViscosity<D>,
    fluid_forces: Vec<ForceRecord>,
    /// Probe values of each participant at the present row.
    probes: Vec<Vec<f64>>,
    /// What each participant said in its first message that it does; empty before.
    abilities: Vec<u32>,
    /// States of the present half-step.
    states: Vec<P::State>,
    half_step: HalfStep,
    /// What happens with the state at n.
    tick: Option<Tick>,
    /// Energy from nowhere, and whose: the run ends with this state.
    grown: Option<Diverged>,
    stopped: bool,
    /// The next states must be those of the checkpoint.
    resumed: bool,
    half_steps: u64,
    action_reaction: f64,
    checks: u64,
    pair_evaluations: u64,
    compute: Duration,
    frame: u64,
}

impl<P: CouplerPort, const D: usize> Coupler<P, D> {
    /// For a scene, on a port whose participants are connected, computing with an instruction set that the processor
    /// has. `foreign` has an entry for each solid: what stands in for what a foreign solid does not do itself.
    pub fn new(port: P, scene: &Scene, foreign: Vec<Option<ForeignSolid>>, isa: Isa) -> Self {
        let side = |(solid, foreign)| SolidSide {
            interface: Parameters::new(scene, solid, isa).map(Interface::new),
            forces: Vec::new(),
            at_n: Vec::new(),
            count: None,
            saved: 0,
            foreign,
        };
        let participants = port.participants();
        let phases = scene.participants().into_iter().map(|participant| participant.phase).collect();
        Self {
            port,
            phases,
            solids: foreign.into_iter().enumerate().map(side).collect(),
            cross: CrossViscosity::default(),
            fluid_forces: Vec::new(),
            probes: vec![Vec::new(); participants],
            abilities: Vec::new(),
            states: Vec::with_capacity(participants),
            half_step: HalfStep::begin(0, 0.0),
            tick: None,
            grown: None,
            stopped: false,
            resumed: false,
            half_steps: 0,
            action_reaction: 0.0,
            checks: 0,
            pair_evaluations: 0,
            compute: Duration::ZERO,
            frame: 0,
        }
    }

    /// Runs to the clock's end or until it is told to stop.
    ///
    /// # Errors
    /// A participant failed, died or disagrees; the log cannot be written.
    pub fn run(&mut self, course: &mut Course) -> Result<Outcome, RunError> {
        while self.first(course)? {
            self.note(course)?;
            self.second(course)?;
        }
        self.note(course)?;
        self.end(course)
    }

    /// Goes on from a checkpoint's part of the coupler, with the course's clock; the recorder is resumed by itself.
    ///
    /// # Errors
    /// The checkpoint is not one of this scene.
    pub fn resume(&mut self, clock: &mut Clock, checkpoint: &Group) -> Result<(), StateError> {
        let group = |name: &str| {
            checkpoint.groups.get(name).ok_or_else(|| StateError::Missing { field: name.to_owned() })
        };
        clock.load(group("clock")?)?;
        self.load(group("coupler")?)?;
        self.half_step = HalfStep::begin(clock.step(), clock.time());
        self.resumed = true;
        Ok(())
    }

    /// The first half of a step: takes the states at n and answers them. Returns whether the run goes on.
    ///
    /// # Errors
    /// As for [`Self::run`].
    pub fn first(&mut self, course: &mut Course) -> Result<bool, RunError> {
        self.receive(&course.progress, &Expect::of(&self.half_step))?;
        if self.abilities.is_empty() {
            self.abilities = self.states.iter().map(|state| state.header().abilities).collect();
            self.begin_foreign();
        }
        self.check_resumed()?;
        self.stopped = course.stop.load(Ordering::Relaxed);
        let limit = |(k, state): (usize, &P::State)| Limit {
            participant: self.port.name(k),
            dt: state.header().dt_limit,
        };
        let limits: Vec<Limit> = self.states.iter().enumerate().map(limit).collect();
        // Before anything of this step is noted: a run that goes on from here notes it.
        let saved = self.save_if_due(course, &limits)?;
        let work = self.work_on_solids();
        let accounts: Vec<Account<'_>> = self.accounts(&work);
        let HalfStep { step, time, .. } = self.half_step;
        self.grown = course.recorder.judge(step, time, &accounts);
        // Energy from nowhere ends the run in order, with its last state on disk.
        let tick = course.clock.tick(&limits, self.stopped || self.grown.is_some())?;
        let checkpoint = match (saved, &mut course.checkpoints, &self.grown) {
            (Some(saved), Some(checkpoints), None) => Some(checkpoints.begin(&saved, &course.clock)?),
            _ => None,
        };
        self.half_step = tick.half_step();
        self.tick = Some(tick);
        self.answer(&tick, checkpoint)?;
        Ok(tick.dt.is_some())
    }

    /// Takes what the participants measured on the state at n where a row is due, and notes it. The frames of foreign
    /// solids are written.
    ///
    /// # Errors
    /// As for [`Self::run`].
    pub fn note(&mut self, course: &mut Course) -> Result<(), RunError> {
        let Some(tick) = self.tick else { return Ok(()) };
        self.measure(&tick)?;
        let of = self.phases.iter().zip(&self.states).zip(&self.probes);
        let measured: Vec<Measured<'_>> =
            of.map(|((phase, state), probes)| Measured::of(*phase, state.header(), probes)).collect();
        course.recorder.note(&tick, &measured)?;
        self.states.clear();
        Ok(())
    }

    /// The second half of a step: takes the states at n + 1/2 and answers them.
    ///
    /// # Errors
    /// As for [`Self::run`].
    pub fn second(&mut self, course: &mut Course) -> Result<(), RunError> {
        let Some(tick) = self.tick else { return Ok(()) };
        self.half_step = self.half_step.next();
        self.receive(&course.progress, &Expect::of(&self.half_step))?;
        self.complete_checkpoint(course)?;
        self.answer(&tick, None)?;
        self.states.clear();
        course.clock.advance(&tick);
        self.half_step = self.half_step.next();
        Ok(())
    }

    /// Takes the last messages of a run that was told to stop.
    ///
    /// # Errors
    /// As for [`Self::run`].
    pub fn end(&mut self, course: &mut Course) -> Result<Outcome, RunError> {
        self.receive(&course.progress, &Expect::last(self.half_step.step))?;
        for side in &mut self.solids {
            side.foreign.take().map_or(Ok(()), ForeignSolid::finish)?;
        }
        self.complete_checkpoint(course)?;
        self.checks += self.states.len() as u64;
        if let Some(diverged) = self.grown.take() {
            return Err(diverged.into());
        }
        let last = self.states.iter().map(|state| *state.header()).collect();
        self.states.clear();
        Ok(self.outcome(last))
    }

    fn complete_checkpoint(&self, course: &mut Course) -> Result<(), RunError> {
        let Some(checkpoints) = &mut course.checkpoints else { return Ok(()) };
        Ok(checkpoints.complete(self.states.iter().map(|state| state.header().checkpoint_safe))?)
    }

    /// The state of clock, recorder and coupler where a checkpoint is due and all participants can write theirs.
    fn save_if_due(&mut self, course: &mut Course, limits: &[Limit]) -> Result<Option<Group>, RunError> {
        let able = self.abilities.iter().all(|abilities| abilities & ability::CHECKPOINTS != 0);
        let Course { clock, recorder, checkpoints, .. } = course;
        let Some(checkpoints) = checkpoints.as_mut().filter(|_| able) else { return Ok(None) };
        checkpoints.complete(self.states.iter().map(|state| state.header().checkpoint_safe))?;
        if !checkpoints.is_due(clock, limits, self.stopped) {
            return Ok(None);
        }
        recorder.synchronise()?;
        let first_solid = self.first_solid();
        for (side, state) in self.solids.iter_mut().zip(&self.states[first_solid..]) {
            side.saved = positions_hash(state.records());
        }
        let mut group = Group::default();
        group.groups.insert("clock".into(), clock.save());
        group.groups.insert("recorder".into(), recorder.save());
        group.groups.insert("coupler".into(), self.save());
        Ok(Some(group))
    }

    /// A solid that goes on from a checkpoint must show the state that it showed when the checkpoint was written.
    fn check_resumed(&mut self) -> Result<(), RunError> {
        if !std::mem::take(&mut self.resumed) {
            return Ok(());
        }
        let first_solid = self.first_solid();
        let changed =
            |(side, state): (&SolidSide<D>, &P::State)| positions_hash(state.records()) != side.saved;
        match self.solids.iter().zip(&self.states[first_solid..]).position(changed) {
            None => Ok(()),
            Some(solid) => {
                let name = self.port.name(first_solid + solid);
                let reason = format!("the {name} shows another state than that of the checkpoint");
                Err(RunError::Resume(reason))
            }
        }
    }

    fn begin_foreign(&mut self) {
        let first = self.first_solid();
        if self.half_step.step > 0 {
            // Their first records are in the checkpoint.
            return;
        }
        for (side, state) in self.solids.iter_mut().zip(&self.states[first..]) {
            if let Some(foreign) = &mut side.foreign {
                foreign.begin(state.records());
            }
        }
    }

    /// Place of the first solid among the participants.
    fn first_solid(&self) -> usize {
        self.phases.iter().filter(|phase| **phase == Phase::Fluid).count()
    }

    fn has_fluid(&self) -> bool {
        self.phases.first() == Some(&Phase::Fluid)
    }

    fn accounts<'a>(&'a self, work: &[f64]) -> Vec<Account<'a>> {
        let first_solid = self.first_solid();
        let account = |(place, state): (usize, &'a P::State)| {
            let side = place.checked_sub(first_solid).map(|solid| &self.solids[solid]);
            let foreign = side.is_some_and(|side| side.foreign.is_some());
            Account {
                name: self.port.name(place),
                phase: self.phases[place],
                audit: (!foreign).then_some(&state.header().audit),
                work: work[place],
            }
        };
        self.states.iter().enumerate().map(account).collect()
    }

    /// All states of a half-step. The solids' first: where all are there the order does not matter, and the fluid waits
    /// for the solids' first messages before it sends its own.
    fn receive(&mut self, progress: &Progress, expect: &Expect) -> Result<(), RunError> {
        let (first_solid, participants) = (self.first_solid(), self.phases.len());
        self.states.clear();
        for place in (first_solid..participants).chain(0..first_solid) {
            progress.awaited.store(place, Ordering::Relaxed);
            let state = self.port.receive_state(place, expect)?;
            progress.messages.fetch_add(1, Ordering::Relaxed);
            self.reject_failure(place, state.header())?;
            self.states.push(state);
        }
        self.states.rotate_right(first_solid);
        if !expect.is_last() {
            for (place, side) in self.solids.iter_mut().enumerate() {
                let now = self.states[place + first_solid].records().len() as u64;
                let first = *side.count.get_or_insert(now);
                if first != now {
                    let solid = self.port.name(place + first_solid);
                    return Err(RunError::SolidCount { solid, first, now, step: expect.step });
                }
            }
        }
        Ok(())
    }

    fn reject_failure(&self, place: usize, header: &StateHeader) -> Result<(), RunError> {
        let role = self.port.name(place);
        match header.status {
            status::OK | status::FINISHED => Ok(()),
            status::DIVERGED => {
                let names: Vec<Name> = (0..self.port.participants()).map(|k| self.port.name(k)).collect();
                Err(Diverged::told(role, &names, header).into())
            }
            _ => Err(RunError::RoleFailed { role, step: header.step }),
        }
    }

    /// Work of the fluid on each participant from the state at n before to this one, J: the force of n + 1/2 moved a
    /// solid all the way.
    fn work_on_solids(&mut self) -> Vec<f64> {
        let first_solid = self.first_solid();
        let mut work = vec![0.0; self.states.len()];
        for (place, side) in self.solids.iter_mut().enumerate() {
            let records = self.states[place + first_solid].records();
            let ways = records.iter().zip(&side.at_n).zip(&side.forces);
            let done = ways.map(|((record, from), force)| {
                let force = force.force(record.mass);
                (0..3).map(|d| force[d] * (record.position[d] - from[d])).sum::<f64>()
            });
            work[place + first_solid] = done.sum();
            side.at_n.clear();
            side.at_n.extend(records.iter().map(|r| r.position));
        }
        work
    }

    /// Fetches the probe values of the state at n where a row is due, and writes the frames of foreign solids.
    fn measure(&mut self, tick: &Tick) -> Result<(), RunError> {
        let first_solid = self.first_solid();
        for (place, state) in self.states.iter().enumerate() {
            let values = &mut self.probes[place];
            values.clear();
            if let Some(SolidSide { foreign: Some(foreign), forces, .. }) =
                place.checked_sub(first_solid).map(|solid| &mut self.solids[solid])
            {
                if tick.frame {
                    foreign.write(self.frame - 1, tick.time, state.records())?;
                }
                if self.abilities[place] & ability::PROBES == 0 {
                    if tick.row {
                        values.extend_from_slice(foreign.measure(state.records(), forces));
                    }
                    continue;
                }
            }
            if tick.row {
                self.port.receive_probes(place, tick.step, values)?;
            }
        }
        Ok(())
    }

    fn answer(&mut self, tick: &Tick, checkpoint: Option<u64>) -> Result<(), RunError> {
        let start = Instant::now();
        self.checks += self.states.len() as u64;
        let mut header = self.half_step.force_header();
        header.order = tick.orders(self.half_step.stage);
        if let Some(number) = checkpoint {
            header.order |= order::WRITE_CHECKPOINT;
            header.checkpoint = number;
        }
        if header.order & order::WRITE_FRAME != 0 {
            header.frame = self.frame;
            self.frame += 1;
        }
        self.evaluate();
        self.compute += start.elapsed();
        let first_solid = self.first_solid();
        for (place, side) in self.solids.iter().enumerate() {
            let epoch = self.states[place + first_solid].header().epoch;
            self.port.send_forces(place + first_solid, &ForceHeader { epoch, ..header }, &side.forces)?;
        }
        if self.has_fluid() {
            let epoch = self.states[FLUID].header().epoch;
            self.port.send_forces(FLUID, &ForceHeader { epoch, ..header }, &self.fluid_forces)?;
        }
        let start = Instant::now();
        if self.half_steps.is_multiple_of(AUDIT_INTERVAL) {
            self.audit();
        }
        self.half_steps += 1;
        self.compute += start.elapsed();
        Ok(())
    }

    fn evaluate(&mut self) {
        if self.solids.is_empty() || !self.has_fluid() {
            return;
        }
        let blank = |id| ForceRecord { id, ..ForceRecord::default() };
        let fluid = &self.states[FLUID];
        self.fluid_forces.clear();
        self.fluid_forces.extend(fluid.records().iter().map(|r| blank(r.id)));
        for (place, side) in self.solids.iter_mut().enumerate() {
            let solid = &self.states[place + 1];
            side.forces.clear();
            side.forces.extend(solid.records().iter().map(|r| blank(r.id)));
            let Some(interface) = &mut side.interface else { continue };
            interface.update(fluid.records(), solid.records(), fluid.header().epoch);
            self.pair_evaluations += interface.pairs() as u64;
            let forces = &mut side.forces;
            interface.act_on_solid(|record, force| forces[record].stress_force = wide(force));
            self.cross.on_solid(interface, |record, a| forces[record].cross_viscosity = wide(a));
            let forces = &mut self.fluid_forces;
            self.cross.on_fluid(interface, |record, a| {
                let sum = &mut forces[record].cross_viscosity;
                // The first solid's share is taken as it is: a sum would lose the sign of a zero.
                *sum = if place == 0 { wide(a) } else { std::array::from_fn(|d| sum[d] + wide(a)[d]) };
            });
        }
    }

    /// Sum of all interface forces over the sum of their magnitudes.
    fn audit(&mut self) {
        let (mut sum, mut scale) = ([0.0; 3], 0.0);
        let mut add = |force: [f64; 3]| {
            for d in 0..3 {
                sum[d] += force[d];
                scale += force[d].abs();
            }
        };
        let Some(records) = self.states.first().map(StateMessage::records) else { return };
        for interface in self.solids.iter_mut().filter_map(|side| side.interface.as_mut()) {
            interface.act_on_fluid(|record, a, _| add(wide(a).map(|a| a * records[record].mass)));
        }
        for (force, record) in self.fluid_forces.iter().zip(records) {
            add(force.cross_viscosity.map(|a| a * record.mass));
        }
        for side in &self.solids {
            let Some(interface) = &side.interface else { continue };
            for (slot, record) in interface.solid.slots() {
                add(side.forces[record].force(interface.solid.own_mass[slot]));
            }
        }
        if scale > 0.0 {
            let mismatch = sum.iter().fold(0.0_f64, |m, s| m.max(s.abs())) / scale;
            self.action_reaction = self.action_reaction.max(mismatch);
            self.checks += 1;
        }
    }

    fn outcome(&self, last: Vec<StateHeader>) -> Outcome {
        let times = self.port.times();
        Outcome {
            stopped: self.stopped,
            last,
            seconds: RoleSeconds {
                compute: self.compute.as_secs_f64(),
                wait: times.wait.as_secs_f64(),
                exchange: times.exchange.as_secs_f64(),
                output: 0.0,
            },
            action_reaction: self.action_reaction,
            checks: self.checks,
            pair_evaluations: self.pair_evaluations,
        }
    }
}

impl<P: CouplerPort, const D: usize> State for Coupler<P, D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.count("frame", &mut self.frame)?;
        fields.count("half_steps", &mut self.half_steps)?;
        fields.count("checks", &mut self.checks)?;
        fields.count("pair_evaluations", &mut self.pair_evaluations)?;
        fields.real("action_reaction", &mut self.action_reaction)?;
        for (solid, side) in self.solids.iter_mut().enumerate() {
            fields.group(&format!("solid_{solid}"), |fields| side.fields(fields))?;
        }
        Ok(())
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.solids.iter_mut().try_for_each(State::restored)
    }
}

impl<const D: usize> State for SolidSide<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.optional_count("count", &mut self.count)?;
        fields.count("published", &mut self.saved)?;
        fields.points("position", &mut self.at_n)?;
        let mut force: [Vec<[f64; 3]>; 2] = [
            self.forces.iter().map(|f| f.cross_viscosity).collect(),
            self.forces.iter().map(|f| f.stress_force).collect(),
        ];
        fields.points("cross_viscosity", &mut force[0])?;
        fields.points("stress_force", &mut force[1])?;
        if fields.loading() {
            let [cross_viscosity, stress_force] = force;
            fields.length("stress_force", cross_viscosity.len(), stress_force.len())?;
            let of = |(cross_viscosity, stress_force)| ForceRecord {
                cross_viscosity,
                stress_force,
                ..ForceRecord::default()
            };
            self.forces = cross_viscosity.into_iter().zip(stress_force).map(of).collect();
        }
        if let Some(interface) = &mut self.interface {
            fields.part("interface", interface)?;
        }
        if let Some(foreign) = &mut self.foreign {
            fields.part("foreign", foreign)?;
        }
        Ok(())
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.interface.as_mut().map_or(Ok(()), State::restored)?;
        self.foreign.as_mut().map_or(Ok(()), State::restored)
    }
}

/// Hash of particles and their positions.
fn positions_hash(records: &[StateRecord]) -> u64 {
    let mut hash = Xxh3::new();
    for record in records {
        hash.update(&record.id.to_le_bytes());
        record.position.iter().for_each(|x| hash.update(&x.to_le_bytes()));
    }
    hash.digest()
}

/// Hash over all participants, in their order.
pub fn combined_hash<'a>(last: impl IntoIterator<Item = &'a StateHeader>) -> u64 {
    let hashes = last.into_iter().enumerate();
    hashes.fold(0, |hash, (place, header)| hash ^ header.state_hash.rotate_left(place as u32))
}
