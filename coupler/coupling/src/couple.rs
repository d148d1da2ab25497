//! The coupler's half-step loop: checks both states, evaluates the cross-phase forces, decides dt and orders.

use crate::clock::{Clock, Limit, Tick};
use crate::error::RunError;
use crate::foreign::ForeignSolid;
use crate::recorder::{Measured, Recorder};
use halfstep_interface::cross_viscosity::CrossViscosity;
use halfstep_interface::{Interface, Parameters};
use halfstep_link::{CouplerLink, Expect, StateSample, Transport};
use halfstep_output::run_json::RoleSeconds;
use halfstep_scene::Scene;
use halfstep_sph::lane::Isa;
use halfstep_wire::failure::{Diverged, RoleName};
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::{ForceHeader, ForceRecord, StateHeader, StateRecord, order, status};
use halfstep_wire::wide;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Half-steps between two checks that action equals reaction.
const AUDIT_INTERVAL: u64 = 50;

/// How a coupled run ended.
#[derive(Clone, Copy, Debug)]
pub struct CoupledOutcome {
    /// It was told to stop before its end.
    pub stopped: bool,
    /// Last message of the fluid.
    pub fluid: StateHeader,
    /// Last message of the solid.
    pub solid: StateHeader,
    /// Where the coupler's time went.
    pub seconds: RoleSeconds,
    /// Largest relative mismatch of the forces on both sides.
    pub action_reaction: f64,
    /// Consistency checks passed.
    pub checks: u64,
    /// Pairs listed in the coupler's sums.
    pub pair_evaluations: u64,
}

/// State of the coupler.
pub struct Coupler<S: Transport, const D: usize> {
    link: CouplerLink<S>,
    interface: Interface<D>,
    cross: CrossViscosity<D>,
    fluid_forces: Vec<ForceRecord>,
    solid_forces: Vec<ForceRecord>,
    half_steps: u64,
    action_reaction: f64,
    checks: u64,
    pair_evaluations: u64,
    compute: Duration,
    frame: u64,
    solid_count: Option<usize>,
    foreign: Option<ForeignSolid>,
    /// The solid's positions at n, m.
    solid_at_n: Vec<[f64; 3]>,
}

impl<S: Transport, const D: usize> Coupler<S, D> {
    /// For a scene with both phases, on a link whose partners are connected.
    ///
    /// `isa` is the level of its sums; `foreign` stands in for what a solid of somebody else's does not do itself.
    pub fn new(link: CouplerLink<S>, scene: &Scene, isa: Isa, foreign: Option<ForeignSolid>) -> Option<Self> {
        Some(Self {
            link,
            interface: Interface::new(Parameters::new(scene, isa)?),
            cross: CrossViscosity::default(),
            fluid_forces: Vec::new(),
            solid_forces: Vec::new(),
            half_steps: 0,
            action_reaction: 0.0,
            checks: 0,
            pair_evaluations: 0,
            compute: Duration::ZERO,
            frame: 0,
            solid_count: None,
            foreign,
            solid_at_n: Vec::new(),
        })
    }

    /// Runs to the clock's end or until `stop`.
    ///
    /// # Errors
    /// A partner failed, died or disagrees; the log cannot be written.
    pub fn run(
        &mut self,
        clock: &mut Clock,
        recorder: &mut Recorder,
        stop: &AtomicBool,
    ) -> Result<CoupledOutcome, RunError> {
        let mut half_step = HalfStep::begin(0, 0.0);
        loop {
            let (step, time) = (half_step.step, half_step.time);
            let (fluid, solid) = self.receive(&Expect::of(&half_step))?;
            let stopped = stop.load(Ordering::Relaxed);
            let limit = |role, header: &StateHeader| Limit { role, dt: header.dt_limit };
            let limits = [limit(RoleName::Fluid, fluid.header()), limit(RoleName::Solid, solid.header())];
            let work = self.work_on_solid(solid.records());
            let of_solid = self.foreign.is_none().then_some(&solid.header().audit);
            let grown = recorder.judge(step, time, Some(&fluid.header().audit), of_solid, work);
            // Energy from nowhere ends the run in order, with its last state on disk.
            let tick = clock.tick(&limits, stopped || grown.is_some())?;
            let first = tick.half_step();
            self.answer(&tick, &first, &fluid, &solid)?;
            let mut of_solid = Measured::of(solid.header());
            if let Some(foreign) = &mut self.foreign {
                if tick.frame {
                    foreign.write(self.frame - 1, tick.time, solid.records())?;
                }
                let values = foreign.measure(solid.records(), &self.solid_forces);
                if of_solid.probes.is_empty() {
                    of_solid.probes = values;
                }
            }
            recorder.note(&tick, Some(Measured::of(fluid.header())), Some(of_solid))?;
            drop((fluid, solid));
            if tick.dt.is_none() {
                let (fluid, solid) = self.receive(&Expect::last(step).time(time))?;
                if let Some(foreign) = self.foreign.take() {
                    foreign.finish()?;
                }
                if let Some(diverged) = grown {
                    return Err(diverged.into());
                }
                return Ok(self.outcome(stopped, *fluid.header(), *solid.header()));
            }
            let second = first.next();
            let (fluid, solid) = self.receive(&Expect::of(&second))?;
            self.answer(&tick, &second, &fluid, &solid)?;
            clock.advance(&tick);
            half_step = second.next();
        }
    }

    /// Both states of a half-step. The solid's first: where both are there the order does not matter, and the fluid
    /// waits for the solid's first message before it sends its own.
    fn receive(&mut self, expect: &Expect) -> Result<(StateSample<S>, StateSample<S>), RunError> {
        let solid = self.link.receive_state(RoleName::Solid, expect)?;
        reject_failure(RoleName::Solid, solid.header())?;
        let fluid = self.link.receive_state(RoleName::Fluid, expect)?;
        reject_failure(RoleName::Fluid, fluid.header())?;
        if !expect.is_last() {
            let count = *self.solid_count.get_or_insert(solid.records().len());
            if count != solid.records().len() {
                return Err(RunError::SolidCount {
                    first: count,
                    now: solid.records().len(),
                    step: expect.step,
                });
            }
        }
        self.checks += 2;
        Ok((fluid, solid))
    }

    /// Work of the fluid on the solid from the state at n before to this one, J: the force of n + 1/2 moved the solid
    /// all the way.
    fn work_on_solid(&mut self, records: &[StateRecord]) -> f64 {
        let ways = records.iter().zip(&self.solid_at_n).zip(&self.solid_forces);
        let work = ways.map(|((record, from), force)| {
            let force = force.force(record.mass);
            (0..3).map(|d| force[d] * (record.position[d] - from[d])).sum::<f64>()
        });
        let work = work.sum();
        self.solid_at_n.clear();
        self.solid_at_n.extend(records.iter().map(|r| r.position));
        work
    }

    fn answer(
        &mut self,
        tick: &Tick,
        half_step: &HalfStep,
        fluid: &StateSample<S>,
        solid: &StateSample<S>,
    ) -> Result<(), RunError> {
        let start = Instant::now();
        let mut orders = if tick.dt.is_some() { order::GO } else { order::STOP };
        let mut header = ForceHeader { epoch: fluid.header().epoch, ..half_step.force_header() };
        if half_step.stage == Stage::First && tick.frame {
            orders |= order::WRITE_FRAME;
            header.frame = self.frame;
            self.frame += 1;
        }
        header.order = orders;
        self.evaluate(fluid, solid);
        self.compute += start.elapsed();
        self.link.send_forces(
            RoleName::Solid,
            &ForceHeader { epoch: solid.header().epoch, ..header },
            &self.solid_forces,
        )?;
        self.link.send_forces(RoleName::Fluid, &header, &self.fluid_forces)?;
        let start = Instant::now();
        if self.half_steps.is_multiple_of(AUDIT_INTERVAL) {
            self.audit(fluid);
        }
        self.half_steps += 1;
        self.compute += start.elapsed();
        Ok(())
    }

    fn evaluate(&mut self, fluid: &StateSample<S>, solid: &StateSample<S>) {
        let blank = |id| ForceRecord { id, ..ForceRecord::default() };
        self.fluid_forces.clear();
        self.fluid_forces.extend(fluid.records().iter().map(|r| blank(r.id)));
        self.solid_forces.clear();
        self.solid_forces.extend(solid.records().iter().map(|r| blank(r.id)));
        self.interface.update(fluid.records(), solid.records(), fluid.header().epoch);
        self.pair_evaluations += self.interface.pairs() as u64;
        let forces = &mut self.solid_forces;
        self.interface.act_on_solid(|record, force| forces[record].stress_force = wide(force));
        self.cross.on_solid(&self.interface, |record, a| forces[record].cross_viscosity = wide(a));
        let forces = &mut self.fluid_forces;
        self.cross.on_fluid(&self.interface, |record, a| forces[record].cross_viscosity = wide(a));
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
        self.interface.act_on_fluid(|record, a, _| add(wide(a).map(|a| a * records[record].mass)));
        for (force, record) in self.fluid_forces.iter().zip(records) {
            add(force.cross_viscosity.map(|a| a * record.mass));
        }
        for (slot, record) in self.interface.solid.slots() {
            add(self.solid_forces[record].force(self.interface.solid.own_mass[slot]));
        }
        if scale > 0.0 {
            let mismatch = sum.iter().fold(0.0_f64, |m, s| m.max(s.abs())) / scale;
            self.action_reaction = self.action_reaction.max(mismatch);
            self.checks += 1;
        }
    }

    fn outcome(&self, stopped: bool, fluid: StateHeader, solid: StateHeader) -> CoupledOutcome {
        let times = self.link.times();
        CoupledOutcome {
            stopped,
            fluid,
            solid,
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

fn reject_failure(role: RoleName, header: &StateHeader) -> Result<(), RunError> {
    match header.status {
        status::OK | status::FINISHED => Ok(()),
        status::DIVERGED => Err(Diverged::told(role, header).into()),
        _ => Err(RunError::RoleFailed { role, step: header.step }),
    }
}
