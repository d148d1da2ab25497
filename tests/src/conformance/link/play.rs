//! A run whose every value is known beforehand, so that each role can check all it receives.

use super::end::End;
use halfstep_link::{
    CouplerLink, CouplerPort, Expect, LinkConfig, LinkError, LinkTimes, StateMessage, Transport,
};
use halfstep_wire::Name;
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::{
    ForceHeader, ForceRecord, LAST_STAGE, StateHeader, StateRecord, order, status,
};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Steps between two renewals of the fluid's set.
const EPOCH: u64 = 50;

/// Number of particles that a phase publishes at a step.
pub fn count(role: Name, step: u64) -> usize {
    match role {
        Name::FLUID => 20 + (epoch(role, step) as usize * 7) % 30,
        _ => 12,
    }
}

/// Epoch of a phase's set at a step.
pub fn epoch(role: Name, step: u64) -> u64 {
    if role == Name::FLUID { step / EPOCH } else { 0 }
}

/// A number that belongs to this place alone.
fn value(role: Name, step: u64, stage: Stage, slot: usize, component: usize) -> f64 {
    let key = ((step * 2 + u64::from(stage.number())) * 100 + slot as u64) * 16 + component as u64;
    (key as f64 + if role == Name::FLUID { 0.25 } else { 0.5 }) / 3.0
}

/// The record in a slot.
pub fn state(role: Name, step: u64, stage: Stage, slot: usize) -> StateRecord {
    let v = |component| value(role, step, stage, slot, component);
    StateRecord {
        id: (slot * 3) as u32 + epoch(role, step) as u32,
        flags: (slot % 2) as u32,
        position: [v(0), v(1), v(2)],
        velocity: [v(3), v(4), v(5)],
        density: v(6),
        pressure: v(7),
        mass: v(8),
        deviatoric_stress: [v(9), v(10), v(11), v(12), v(13), v(14)],
    }
}

/// What the coupler answers to a record.
pub fn force(of: &StateRecord, other: &StateRecord) -> ForceRecord {
    ForceRecord { id: of.id, flags: 0, cross_viscosity: of.velocity, stress_force: other.position }
}

/// Time and time step of a step. The sum is not exact, so that a role that adds up its own time is found out.
pub fn clock(step: u64) -> (f64, f64) {
    let mut time = 0.0;
    for n in 0..step {
        time += step_size(n);
    }
    (time, step_size(step))
}

fn step_size(step: u64) -> f64 {
    1e-5 * (1.0 + (step % 7) as f64 / 9.0)
}

fn half_step(step: u64, stage: Stage) -> HalfStep {
    let (time, dt) = clock(step);
    HalfStep { stage, ..HalfStep::begin(step, time).lasting(dt) }
}

/// The header of a state.
pub fn state_header(role: Name, step: u64, stage: Stage) -> StateHeader {
    header_of(role, &half_step(step, stage))
}

fn header_of(role: Name, half_step: &HalfStep) -> StateHeader {
    StateHeader { epoch: epoch(role, half_step.step), dt_limit: 1.0, ..half_step.state_header() }
}

/// The header of the answer to a state.
pub fn force_header(role: Name, step: u64, stage: Stage) -> ForceHeader {
    ForceHeader { order: order::GO, epoch: epoch(role, step), ..half_step(step, stage).force_header() }
}

/// Plays a phase until it is told to stop. Panics where a value is wrong.
pub fn phase<S: Transport>(
    config: &LinkConfig,
    role: Name,
    abort: Option<Arc<AtomicBool>>,
) -> Result<LinkTimes, LinkError> {
    let mut link = End::<S>::open(config, role, abort)?;
    let mut half_step = HalfStep::begin(0, 0.0);
    loop {
        let HalfStep { step, stage, .. } = half_step;
        let records: Vec<StateRecord> =
            (0..count(role, step)).map(|slot| state(role, step, stage, slot)).collect();
        let header = header_of(role, &half_step);
        if step % 2 == 0 {
            link.send_state(&header, &records)?;
        } else {
            link.send_state_from(&header, records.len(), |slot| records[slot])?;
        }
        let expect = Expect::of(&half_step);
        let peer = link.receive_peer(&expect.dt(header.dt))?;
        check_states(
            if role == Name::FLUID { Name::SOLID } else { Name::FLUID },
            step,
            stage,
            peer.records(),
        );
        let forces = link.receive_forces(&expect)?;
        let answer = forces.header();
        if answer.order & order::STOP != 0 {
            let last = StateHeader { stage: LAST_STAGE, status: status::FINISHED, ..header };
            link.send_state(&last, &[])?;
            return Ok(link.times());
        }
        for (slot, record) in forces.records().iter().enumerate() {
            let other = &peer.records()[slot % peer.records().len()];
            assert_eq!(*record, force(&records[slot], other), "{role} {step} {stage} {slot}");
        }
        assert_eq!(forces.records().len(), records.len());
        half_step = half_step.with_step(answer.dt, answer.next_time).next();
    }
}

/// Plays the coupler for this many steps. Panics where a value is wrong.
pub fn coupler<S: Transport>(
    config: &LinkConfig,
    steps: u64,
    abort: Option<Arc<AtomicBool>>,
) -> Result<LinkTimes, LinkError> {
    let mut link = CouplerLink::<S>::open(config, abort)?;
    let roles = [Name::FLUID, Name::SOLID];
    let mut time = 0.0;
    for step in 0..=steps {
        let dt = step_size(step);
        for half_step in HalfStep::begin(step, time).lasting(dt).both() {
            let stage = half_step.stage;
            let expect = Expect::of(&half_step).dt(half_step.state_header().dt);
            let fluid = link.receive_state(0, &expect)?;
            let solid = link.receive_state(1, &expect)?;
            check_states(Name::FLUID, step, stage, fluid.records());
            check_states(Name::SOLID, step, stage, solid.records());
            for (place, role) in roles.into_iter().enumerate() {
                let (own, other) = match role {
                    Name::FLUID => (fluid.records(), solid.records()),
                    _ => (solid.records(), fluid.records()),
                };
                let mut header = force_header(role, step, stage);
                if step == steps {
                    header.order = order::STOP;
                    link.send_forces(place, &header, &[])?;
                    continue;
                }
                let forces: Vec<ForceRecord> = own
                    .iter()
                    .enumerate()
                    .map(|(slot, record)| force(record, &other[slot % other.len()]))
                    .collect();
                link.send_forces(place, &header, &forces)?;
            }
            if step == steps {
                for place in 0..roles.len() {
                    let last = link.receive_state(place, &Expect::last(step))?;
                    assert_eq!((last.header().status, last.records().len()), (status::FINISHED, 0));
                }
                return Ok(link.times());
            }
        }
        time += dt;
    }
    unreachable!("the last step returns")
}

fn check_states(role: Name, step: u64, stage: Stage, records: &[StateRecord]) {
    assert_eq!(records.len(), count(role, step), "{role} {step} {stage}");
    for (slot, record) in records.iter().enumerate() {
        assert_eq!(*record, state(role, step, stage, slot), "{role} {step} {stage} {slot}");
    }
}

/// Plays any role.
pub fn role<S: Transport>(
    config: &LinkConfig,
    role: Name,
    steps: u64,
    abort: Option<Arc<AtomicBool>>,
) -> Result<LinkTimes, LinkError> {
    match role {
        Name::COUPLER => coupler::<S>(config, steps, abort),
        phase_name => phase::<S>(config, phase_name, abort),
    }
}
