//! Messages that are wrong in one place each: the receiver says which.

use super::Run;
use super::end::End;
use super::play;
use super::raw::{RawCoupler, RawPhase, identified, identified_force};
use halfstep_link::{CouplerLink, CouplerPort, Expect, LinkError, Transport};
use halfstep_wire::Name;
use halfstep_wire::half_step::Stage::{First, Second};
use halfstep_wire::protocol::{ForceHeader, ForceRecord, StateHeader, StateRecord, order, status};
use std::thread::scope;

type StateFault = (&'static str, fn(&mut StateHeader, &mut Vec<StateRecord>));
type ForceFault = (&'static str, fn(&mut ForceHeader, &mut Vec<ForceRecord>));

/// Wrong states, by the field that the receiver must name.
const STATES: &[StateFault] = &[
    ("run_id", |header, _| header.run_id += 1),
    ("protocol", |header, _| header.protocol += 1),
    ("schema", |header, _| header.schema ^= 1),
    ("status", |header, _| header.status = 4),
    ("status", |header, _| header.status = status::FINISHED),
    ("step", |header, _| header.step += 1),
    ("step", |header, _| header.step = 0),
    ("stage", |header, _| header.stage = 0),
    ("time", |header, _| header.time = header.time.next_up()),
    ("time", |header, _| header.time = f64::NAN),
    ("dt", |header, _| header.dt = header.dt.next_down()),
    ("dt_limit", |header, _| header.dt_limit = f64::INFINITY),
    ("displacement", |header, _| header.displacement = f64::NAN),
    ("epoch", |header, _| header.epoch = 6),
    ("count", |header, _| header.count -= 1),
    ("count", |header, records| {
        records.pop();
        header.count -= 1;
    }),
    ("id", |_, records| records.swap(3, 4)),
    ("id", |_, records| records[5].id += 1),
    ("id", |header, records| {
        header.epoch += 1;
        records.swap(3, 4);
    }),
    ("id", |header, records| {
        header.epoch += 1;
        records[4].id = records[3].id;
    }),
    ("position", |_, records| records[7].position[2] = f64::NAN),
    ("velocity", |_, records| records[7].velocity[0] = f64::INFINITY),
    ("density", |_, records| records[7].density = f64::NEG_INFINITY),
    ("pressure", |_, records| records[7].pressure = f64::NAN),
    ("mass", |_, records| records[7].mass = f64::NAN),
    ("density", |_, records| records[7].density = 0.0),
    ("mass", |_, records| records[7].mass = -8.0),
    ("deviatoric_stress", |_, records| records[7].deviatoric_stress[5] = f64::NAN),
];

/// Wrong answers, by the field that the receiver must name.
const FORCES: &[ForceFault] = &[
    ("run_id", |header, _| header.run_id += 1),
    ("protocol", |header, _| header.protocol += 1),
    ("schema", |header, _| header.schema ^= 1),
    ("step", |header, _| header.step += 1),
    ("stage", |header, _| header.stage = 0),
    ("time", |header, _| header.time = header.time.next_down()),
    ("dt", |header, _| header.dt = header.dt.next_up()),
    ("next_time", |header, _| header.next_time = f64::NAN),
    ("order", |header, _| header.order = order::WRITE_FRAME),
    ("order", |header, _| header.order = order::GO | order::STOP),
    ("stage", |header, _| header.order = order::STOP),
    ("epoch", |header, _| header.epoch += 1),
    ("count", |header, _| header.count += 1),
    ("count", |header, records| {
        records.pop();
        header.count -= 1;
    }),
    ("id", |_, records| records.swap(0, 1)),
    ("cross_viscosity", |_, records| records[7].cross_viscosity[1] = f64::NAN),
    ("stress_force", |_, records| records[7].stress_force[0] = f64::INFINITY),
];

/// Step at which the wrong message is sent; epoch 7 of the fluid.
const STEP: u64 = 370;

fn is_about(error: &LinkError, sender: Name, wrong: &str) -> bool {
    match error {
        LinkError::Mismatch { peer, field, expected, found, step, stage } => {
            *peer == sender
                && *field == wrong
                && expected != found
                && (*step, *stage) == (STEP, Second.number())
        }
        LinkError::NotFinite { peer, field, value, step, stage, .. } => {
            *peer == sender
                && *field == wrong
                && !value.is_finite()
                && (*step, *stage) == (STEP, Second.number())
        }
        LinkError::NotPositive { peer, field, particle, value, step, stage } => {
            (*peer, *field, *particle) == (sender, wrong, play::state(sender, STEP, Second, 7).id)
                && *value <= 0.0
                && (*step, *stage) == (STEP, Second.number())
        }
        _ => false,
    }
}

/// Each wrong state is refused by the other phase and by the coupler, by the right name; a right one is not.
pub fn wrong_states<S: Transport>() {
    let nothing: StateFault = ("", |_, _| {});
    for (field, spoil) in STATES.iter().chain([&nothing]) {
        let run = Run::new(100, 100);
        let run = &*run;
        let (time, dt) = play::clock(STEP);
        let first = Expect::new(STEP, First).time(time).dt(0.0);
        let second = Expect::new(STEP, Second).time(time).dt(dt);
        let verdict = |receiver: &str, result: Result<(), LinkError>| match result {
            Ok(()) => assert!(field.is_empty(), "{receiver} accepted a wrong {field}"),
            Err(error) => {
                assert!(is_about(&error, Name::FLUID, field), "{receiver}: {error} instead of {field}")
            }
        };
        scope(|threads| {
            threads.spawn(move || {
                let fluid = RawPhase::<S>::enter(run, "fluid", 100);
                let records = |stage| -> Vec<_> {
                    (0..play::count(Name::FLUID, STEP))
                        .map(|slot| play::state(Name::FLUID, STEP, stage, slot))
                        .collect()
                };
                let mut records_0 = records(First);
                let header =
                    |stage, count| identified(run, play::state_header(Name::FLUID, STEP, stage), count);
                fluid.send(header(First, records_0.len()), &records_0);
                let mut header_1 = header(Second, records_0.len());
                records_0 = records(Second);
                spoil(&mut header_1, &mut records_0);
                fluid.send(header_1, &records_0);
                linger(|| fluid.peer.receive().unwrap().is_some());
            });
            threads.spawn(move || {
                let mut solid = End::<S>::open(run, Name::SOLID, None).unwrap();
                drop(solid.receive_peer(&first).unwrap());
                verdict("the solid", solid.receive_peer(&second).map(drop));
                solid.send_state(&play::state_header(Name::SOLID, STEP, First), &[]).unwrap();
            });
            let mut coupler = CouplerLink::<S>::open(run, None).unwrap();
            drop(coupler.receive_state(0, &first).unwrap());
            verdict("the coupler", coupler.receive_state(0, &second).map(drop));
            drop(coupler.receive_state(1, &Expect::new(STEP, First)).unwrap());
        });
    }
}

/// Each wrong answer is refused by the phase, by the right name; a right one is not.
pub fn wrong_forces<S: Transport>() {
    let nothing: ForceFault = ("", |_, _| {});
    for (field, spoil) in FORCES.iter().chain([&nothing]) {
        let run = Run::new(100, 100);
        let run = &*run;
        let (time, dt) = play::clock(STEP);
        scope(|threads| {
            threads.spawn(move || {
                let mut fluid = End::<S>::open(run, Name::FLUID, None).unwrap();
                let records: Vec<_> = (0..play::count(Name::FLUID, STEP))
                    .map(|slot| play::state(Name::FLUID, STEP, Second, slot))
                    .collect();
                fluid.send_state(&play::state_header(Name::FLUID, STEP, Second), &records).unwrap();
                match fluid.receive_forces(&Expect::new(STEP, Second).time(time).dt(dt)).map(drop) {
                    Ok(()) => assert!(field.is_empty(), "accepted a wrong {field}"),
                    Err(error) => {
                        assert!(is_about(&error, Name::COUPLER, field), "{error} instead of {field}")
                    }
                }
                fluid.send_state(&play::state_header(Name::FLUID, STEP, Second), &records).unwrap();
            });
            threads.spawn(move || {
                let mut solid = End::<S>::open(run, Name::SOLID, None).unwrap();
                drop(solid.receive_peer(&Expect::new(STEP, Second)).unwrap());
                drop(solid.receive_peer(&Expect::new(STEP, Second)).unwrap());
                solid.send_state(&play::state_header(Name::SOLID, STEP, Second), &[]).unwrap();
            });
            let coupler = RawCoupler::<S>::enter(run);
            let mut state = None;
            linger(|| {
                state = coupler.states[0].receive().unwrap();
                state.is_some()
            });
            let zero = StateRecord::default();
            let mut forces: Vec<_> =
                state.take().unwrap().payload().iter().map(|slot| play::force(&slot.0, &zero)).collect();
            let mut header =
                identified_force(run, play::force_header(Name::FLUID, STEP, Second), forces.len());
            spoil(&mut header, &mut forces);
            coupler.role.send(&coupler.forces[0], header, &forces);
            linger(|| coupler.states[0].receive().unwrap().is_some());
            linger(|| coupler.states[1].receive().unwrap().is_some());
        });
    }
}

fn linger(condition: impl FnMut() -> bool) {
    super::eventually(20.0, "a message", condition);
}
