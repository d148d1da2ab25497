//! The coupler's half-step loop: checks both states, evaluates the cross-phase forces, decides dt and orders.

use crate::clock::{Clock, Limit, Tick};
use crate::energy::Account;
use crate::error::RunError;
use crate::foreign::ForeignSolid;
use crate::recorder::{Measured, Recorder};
use halfstep_interface::cross_viscosity::CrossViscosity;
use halfstep_interface::{Interface, Parameters};
use halfstep_link::{CouplerLink, Expect, FLUID, StateSample, Transport};
use halfstep_output::run_json::RoleSeconds;
use halfstep_scene::Scene;
use halfstep_sph::Phase;
use halfstep_sph::lane::Isa;
use halfstep_wire::Name;
use halfstep_wire::failure::Diverged;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, StateHeader, ability, order, status};
use halfstep_wire::wide;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Half-steps between two checks that action equals reaction.
const AUDIT_INTERVAL: u64 = 50;

/// How a coupled run ended.
#[derive(Clone, Debug)]
pub struct CoupledOutcome {
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

/// What the coupler holds of a solid.
struct SolidSide<const D: usize> {
    interface: Interface<D>,
    forces: Vec<ForceRecord>,
    /// Positions at n, m.
    at_n: Vec<[f64; 3]>,
    /// Number of its interface particles, once known.
    count: Option<usize>,
    foreign: Option<ForeignSolid>,
}

/// State of the coupler.
pub struct Coupler<S: Transport, const D: usize> {
    link: CouplerLink<S>,
    solids: Vec<SolidSide<D>>,
    cross: CrossViscosity<D>,
    fluid_forces: Vec<ForceRecord>,
    /// Probe values of each participant at the present row.
    probes: Vec<Vec<f64>>,
    /// What each participant said in its first message that it does.
    abilities: Vec<u32>,
    half_steps: u64,
    action_reaction: f64,
    checks: u64,
    pair_evaluations: u64,
    compute: Duration,
    frame: u64,
}

impl<S: Transport, const D: usize> Coupler<S, D> {
    /// For a scene with both phases, on a link whose participants are connected, computing with an instruction set that
    /// the processor has. `foreign` has an entry for each solid: what stands in for what a foreign solid does not do
    /// itself. `None` where the scene lacks a phase.
    pub fn new(
        link: CouplerLink<S>,
        scene: &Scene,
        foreign: Vec<Option<ForeignSolid>>,
        isa: Isa,
    ) -> Option<Self> {
        let side = |(solid, foreign)| {
            Some(SolidSide {
                interface: Interface::new(Parameters::new(scene, solid, isa)?),
                forces: Vec::new(),
                at_n: Vec::new(),
                count: None,
                foreign,
            })
        };
        let solids = foreign.into_iter().enumerate().map(side).collect::<Option<Vec<_>>>()?;
        let participants = link.participants();
        (participants == solids.len() + 1).then(|| Self {
            link,
            solids,
            cross: CrossViscosity::default(),
            fluid_forces: Vec::new(),
            probes: vec![Vec::new(); participants],
            abilities: vec![0; participants],
            half_steps: 0,
            action_reaction: 0.0,
            checks: 0,
            pair_evaluations: 0,
            compute: Duration::ZERO,
            frame: 0,
        })
    }

    /// Runs to the clock's end or until `stop`.
    ///
    /// # Errors
    /// A participant failed, died or disagrees; the log cannot be written.
    pub fn run(
        &mut self,
        clock: &mut Clock,
        recorder: &mut Recorder,
        stop: &AtomicBool,
    ) -> Result<CoupledOutcome, RunError> {
        let mut half_step = HalfStep::begin(0, 0.0);
        loop {
            let states = self.receive(&Expect::of(&half_step))?;
            if half_step.step == 0 {
                self.abilities = states.iter().map(|state| state.header().abilities).collect();
            }
            let stopped = stop.load(Ordering::Relaxed);
            let limits: Vec<Limit> = (0..states.len())
                .map(|k| Limit { participant: self.link.name(k), dt: states[k].header().dt_limit })
                .collect();
            let work = self.work_on_solids(&states);
            let accounts: Vec<Account<'_>> =
                (0..states.len()).map(|k| self.account(k, states[k].header(), work[k])).collect();
            let grown = recorder.judge(half_step.step, half_step.time, &accounts);
            // Energy from nowhere ends the run in order, with its last state on disk.
            let tick = clock.tick(&limits, stopped || grown.is_some())?;
            let first = tick.half_step();
            self.answer(&tick, &first, &states)?;
            self.measure(&tick, &states)?;
            let measured: Vec<Measured<'_>> = (0..states.len())
                .map(|k| Measured::of(phase_of(k), states[k].header(), &self.probes[k]))
                .collect();
            recorder.note(&tick, &measured)?;
            drop(states);
            if tick.dt.is_none() {
                let last = self.receive(&Expect::last(first.step))?;
                for side in &mut self.solids {
                    side.foreign.take().map_or(Ok(()), ForeignSolid::finish)?;
                }
                if let Some(diverged) = grown {
                    return Err(diverged.into());
                }
                let last = last.iter().map(|state| *state.header()).collect();
                return Ok(self.outcome(stopped, last));
            }
            let second = first.next();
            let states = self.receive(&Expect::of(&second))?;
            self.answer(&tick, &second, &states)?;
            clock.advance(&tick);
            half_step = second.next();
        }
    }

    fn account<'a>(&self, place: usize, header: &'a StateHeader, work: f64) -> Account<'a> {
        let foreign = place != FLUID && self.solids[place - 1].foreign.is_some();
        Account {
            name: self.link.name(place),
            phase: phase_of(place),
            audit: (!foreign).then_some(&header.audit),
            work,
        }
    }

    /// All states of a half-step. The solids' first: where all are there the order does not matter, and the fluid waits
    /// for the solids' first messages before it sends its own.
    fn receive(&mut self, expect: &Expect) -> Result<Vec<StateSample<S>>, RunError> {
        let mut states = Vec::with_capacity(self.solids.len() + 1);
        for place in (1..=self.solids.len()).chain([FLUID]) {
            let state = self.link.receive_state(place, expect)?;
            self.reject_failure(place, state.header())?;
            states.push(state);
        }
        states.rotate_right(1);
        if !expect.is_last() {
            for (place, side) in self.solids.iter_mut().enumerate() {
                let now = states[place + 1].records().len();
                let first = *side.count.get_or_insert(now);
                if first != now {
                    let solid = self.link.name(place + 1);
                    return Err(RunError::SolidCount { solid, first, now, step: expect.step });
                }
            }
        }
        self.checks += states.len() as u64;
        Ok(states)
    }

    fn reject_failure(&self, place: usize, header: &StateHeader) -> Result<(), RunError> {
        let role = self.link.name(place);
        match header.status {
            status::OK | status::FINISHED => Ok(()),
            status::DIVERGED => {
                let names: Vec<Name> = (0..self.link.participants()).map(|k| self.link.name(k)).collect();
                Err(Diverged::told(role, &names, header).into())
            }
            _ => Err(RunError::RoleFailed { role, step: header.step }),
        }
    }

    /// Work of the fluid on each participant from the state at n before to this one, J: the force of n + 1/2 moved a
    /// solid all the way.
    fn work_on_solids(&mut self, states: &[StateSample<S>]) -> Vec<f64> {
        let mut work = vec![0.0; states.len()];
        for (place, side) in self.solids.iter_mut().enumerate() {
            let records = states[place + 1].records();
            let ways = records.iter().zip(&side.at_n).zip(&side.forces);
            let done = ways.map(|((record, from), force)| {
                let force = force.force(record.mass);
                (0..3).map(|d| force[d] * (record.position[d] - from[d])).sum::<f64>()
            });
            work[place + 1] = done.sum();
            side.at_n.clear();
            side.at_n.extend(records.iter().map(|r| r.position));
        }
        work
    }

    /// Fetches the probe values of the state at n where a row is due, and writes the frames of foreign solids.
    fn measure(&mut self, tick: &Tick, states: &[StateSample<S>]) -> Result<(), RunError> {
        for (place, state) in states.iter().enumerate() {
            let values = &mut self.probes[place];
            values.clear();
            if let Some(SolidSide { foreign: Some(foreign), forces, .. }) =
                place.checked_sub(1).map(|solid| &mut self.solids[solid])
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
            if tick.row
                && let Some(sample) = self.link.receive_probes(place, tick.step)?
            {
                values.extend_from_slice(sample.values());
            }
        }
        Ok(())
    }

    fn answer(
        &mut self,
        tick: &Tick,
        half_step: &HalfStep,
        states: &[StateSample<S>],
    ) -> Result<(), RunError> {
        let start = Instant::now();
        let mut header = half_step.force_header();
        header.order = tick.orders(half_step.stage);
        if header.order & order::WRITE_FRAME != 0 {
            header.frame = self.frame;
            self.frame += 1;
        }
        self.evaluate(states);
        self.compute += start.elapsed();
        for (place, side) in self.solids.iter().enumerate() {
            let epoch = states[place + 1].header().epoch;
            self.link.send_forces(place + 1, &ForceHeader { epoch, ..header }, &side.forces)?;
        }
        let epoch = states[FLUID].header().epoch;
        self.link.send_forces(FLUID, &ForceHeader { epoch, ..header }, &self.fluid_forces)?;
        let start = Instant::now();
        if self.half_steps.is_multiple_of(AUDIT_INTERVAL) {
            self.audit(&states[FLUID]);
        }
        self.half_steps += 1;
        self.compute += start.elapsed();
        Ok(())
    }

    fn evaluate(&mut self, states: &[StateSample<S>]) {
        let blank = |id| ForceRecord { id, ..ForceRecord::default() };
        let fluid = &states[FLUID];
        self.fluid_forces.clear();
        self.fluid_forces.extend(fluid.records().iter().map(|r| blank(r.id)));
        for (place, side) in self.solids.iter_mut().enumerate() {
            let solid = &states[place + 1];
            side.forces.clear();
            side.forces.extend(solid.records().iter().map(|r| blank(r.id)));
            side.interface.update(fluid.records(), solid.records(), fluid.header().epoch);
            self.pair_evaluations += side.interface.pairs() as u64;
            let forces = &mut side.forces;
            side.interface.act_on_solid(|record, force| forces[record].stress_force = wide(force));
            self.cross.on_solid(&side.interface, |record, a| forces[record].cross_viscosity = wide(a));
            let forces = &mut self.fluid_forces;
            self.cross.on_fluid(&side.interface, |record, a| {
                let sum = &mut forces[record].cross_viscosity;
                // The first solid's share is taken as it is: a sum would lose the sign of a zero.
                *sum = if place == 0 { wide(a) } else { std::array::from_fn(|d| sum[d] + wide(a)[d]) };
            });
        }
    }

    /// Sum of all interface forces over the sum of their magnitudes.
    fn audit(&mut self, fluid: &StateSample<S>) {
        let (mut sum, mut scale) = ([0.0; 3], 0.0);
        let mut add = |force: [f64; 3]| {
            for d in 0..3 {
                sum[d] += force[d];
                scale += force[d].abs();
            }
        };
        let records = fluid.records();
        for side in &mut self.solids {
            side.interface.act_on_fluid(|record, a, _| add(wide(a).map(|a| a * records[record].mass)));
        }
        for (force, record) in self.fluid_forces.iter().zip(records) {
            add(force.cross_viscosity.map(|a| a * record.mass));
        }
        for side in &self.solids {
            for (slot, record) in side.interface.solid.slots() {
                add(side.forces[record].force(side.interface.solid.own_mass[slot]));
            }
        }
        if scale > 0.0 {
            let mismatch = sum.iter().fold(0.0_f64, |m, s| m.max(s.abs())) / scale;
            self.action_reaction = self.action_reaction.max(mismatch);
            self.checks += 1;
        }
    }

    fn outcome(&self, stopped: bool, last: Vec<StateHeader>) -> CoupledOutcome {
        let times = self.link.times();
        CoupledOutcome {
            stopped,
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

fn phase_of(place: usize) -> Phase {
    if place == FLUID { Phase::Fluid } else { Phase::Solid }
}

/// Hash over all participants, in their order.
pub fn combined_hash<'a>(last: impl IntoIterator<Item = &'a StateHeader>) -> u64 {
    let hashes = last.into_iter().enumerate();
    hashes.fold(0, |hash, (place, header)| hash ^ header.state_hash.rotate_left(place as u32))
}
