//! The regular course of a run, and its ends.

use super::end::End;
use super::play;
use super::raw::{RawPhase, RawRole, identified};
use super::{Run, eventually};
use crate::process::cpu_seconds;
use halfstep_link::{
    Claim, CouplerLink, CouplerPort, Expect, LinkConfig, LinkError, Participant, Port, ProcessLink,
    StateMessage, Transport,
};
use halfstep_wire::Name;
use halfstep_wire::half_step::Stage::{First, Second};
use halfstep_wire::protocol::{Failure, ForceHeader, ForceRecord, StateHeader, StateRecord, order, status};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

const ROLES: [Name; 3] = [Name::FLUID, Name::SOLID, Name::COUPLER];
/// Well below a run's patience of 20 s, and enough for a machine with other work.
const SOON: Duration = Duration::from_secs(5);

/// Roles may start in any order.
pub fn any_start_order<S: Transport>() {
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        let run = Run::new(100, 100);
        let run = &*run;
        scope(|threads| {
            for (place, index) in order.into_iter().enumerate() {
                threads.spawn(move || {
                    sleep(Duration::from_millis(40 * place as u64));
                    play::role::<S>(run, ROLES[index], 3, None).unwrap();
                });
            }
        });
    }
}

/// Every value of a long run arrives, in lock-step, and the counters add up to the time that passed.
pub fn long_run<S: Transport>(half_steps: u64) {
    let run = Run::new(100, 100);
    let run = &*run;
    let start = Instant::now();
    let times: Vec<_> = scope(|threads| {
        let roles = ROLES
            .map(|role| threads.spawn(move || play::role::<S>(run, role, half_steps / 2, None).unwrap()));
        roles.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let wall = start.elapsed();
    for (role, times) in ROLES.iter().zip(times) {
        assert!(!times.exchange.is_zero() && !times.wait.is_zero(), "{role}: {times:?}");
        assert!(times.exchange + times.wait <= wall, "{role}: {times:?} in {wall:?}");
    }
}

/// Runs at the same time do not see each other.
pub fn several_runs<S: Transport>() {
    let runs = [(); 3].map(|()| Run::new(100, 100));
    scope(|threads| {
        for run in &runs {
            for role in ROLES {
                threads.spawn(move || play::role::<S>(run, role, 100, None).unwrap());
            }
        }
    });
}

/// A second process in a role is refused, and the run of the first goes on.
pub fn role_taken<S: Transport>() {
    let run = Run::new(100, 100);
    let run = &*run;
    scope(|threads| {
        let fluid = threads.spawn(move || play::phase::<S>(run, Name::FLUID, None));
        sleep(Duration::from_millis(100));
        let second = End::<S>::open(run, Name::FLUID, None).map(drop);
        assert_eq!(second, Err(LinkError::RoleTaken { role: Name::FLUID }));
        threads.spawn(move || play::phase::<S>(run, Name::SOLID, None).unwrap());
        play::coupler::<S>(run, 20, None).unwrap();
        fluid.join().unwrap().unwrap();
    });
}

/// Who does not come is named.
pub fn handshake_timeout<S: Transport>() {
    let run = Run::new(100, 100);
    let config = LinkConfig { handshake_seconds: 0.3, ..run.0.clone() };
    let error = End::<S>::open(&config, Name::SOLID, None).map(drop);
    assert_eq!(
        error,
        Err(LinkError::HandshakeTimeout {
            role: Name::SOLID,
            missing: vec![Name::FLUID, Name::COUPLER],
            seconds: 0.3
        })
    );
    let flag = Arc::new(AtomicBool::new(false));
    let error = scope(|threads| {
        threads.spawn(|| {
            let solid = End::<S>::open(&run, Name::SOLID, Some(Arc::clone(&flag))).map(drop);
            assert_eq!(solid, Err(LinkError::Aborted));
        });
        sleep(Duration::from_millis(50));
        let error = CouplerLink::<S>::open(&config, None).map(drop);
        flag.store(true, Ordering::Relaxed);
        error
    });
    assert_eq!(
        error,
        Err(LinkError::HandshakeTimeout { role: Name::COUPLER, missing: vec![Name::FLUID], seconds: 0.3 })
    );
}

/// Opens a link of each role in its own thread and hands it to a closure.
pub fn with_links<S: Transport>(
    config: &LinkConfig,
    abort: Option<Arc<AtomicBool>>,
    fluid: impl FnOnce(End<S>) + Send,
    solid: impl FnOnce(End<S>) + Send,
    coupler: impl FnOnce(CouplerLink<S>),
) {
    scope(|threads| {
        let flag = abort.clone();
        threads.spawn(move || fluid(End::open(config, Name::FLUID, flag).unwrap()));
        let flag = abort.clone();
        threads.spawn(move || solid(End::open(config, Name::SOLID, flag).unwrap()));
        coupler(CouplerLink::open(config, abort).unwrap());
    });
}

/// A peer that leaves without a word is reported to both others, soon.
pub fn peer_leaves<S: Transport>() {
    let run = Run::new(100, 100);
    let expect = Expect::new(0, First);
    let soon = |start: Instant| assert!(start.elapsed() < SOON, "{:?}", start.elapsed());
    with_links::<S>(
        &run,
        None,
        |mut fluid| {
            let start = Instant::now();
            let error = fluid.receive_peer(&expect).map(drop);
            assert_eq!(error, Err(LinkError::PeerDied { peer: Name::SOLID }));
            soon(start);
            // To say so to those who are left is still possible.
            let header = StateHeader { status: status::FAILED, ..StateHeader::default() };
            fluid.send_state(&header, &[]).unwrap();
        },
        drop,
        |mut coupler| {
            let start = Instant::now();
            let error = coupler.receive_state(1, &expect).map(drop);
            assert_eq!(error, Err(LinkError::PeerDied { peer: Name::SOLID }));
            soon(start);
            let last = coupler.receive_state(0, &expect).unwrap();
            assert_eq!(last.header().status, status::FAILED);
        },
    );
}

/// The last message of a peer is read, also one that says that the peer diverged, before the peer's end is reported.
pub fn last_message<S: Transport>() {
    let run = Run::new(100, 100);
    let read = |header: &StateHeader| {
        assert_eq!((header.status, header.failure.particle), (status::DIVERGED, 17));
        assert!(header.failure.value.is_nan());
    };
    with_links::<S>(
        &run,
        None,
        |mut fluid| {
            sleep(Duration::from_millis(150));
            read(fluid.receive_peer(&Expect::new(4, Second)).unwrap().header());
            let error = fluid.receive_peer(&Expect::new(4, Second)).map(drop);
            assert_eq!(error, Err(LinkError::PeerDied { peer: Name::SOLID }));
        },
        |mut solid| {
            let header = StateHeader {
                status: status::DIVERGED,
                failure: Failure { particle: 17, value: f64::NAN, ..Failure::default() },
                time: f64::NAN,
                ..StateHeader::default()
            };
            solid.send_state(&header, &[]).unwrap();
        },
        |mut coupler| {
            sleep(Duration::from_millis(150));
            read(coupler.receive_state(1, &Expect::new(4, Second)).unwrap().header());
        },
    );
}

/// A peer that is there and says nothing is waited for only so long; so is one that does not read.
pub fn silence<S: Transport>() {
    let run = Run::new(100, 100);
    let config = LinkConfig { patience_seconds: 0.4, ..run.0.clone() };
    let done = &AtomicBool::new(false);
    let linger = || eventually(20.0, "the others' end", || done.load(Ordering::Relaxed));
    with_links::<S>(
        &config,
        None,
        |mut fluid| {
            let error = fluid.receive_peer(&Expect::new(0, First)).map(drop);
            assert_eq!(error, Err(LinkError::Timeout { peer: Name::SOLID, seconds: 0.4 }));
            let results: Vec<_> = (0..3)
                .map(|step| fluid.send_state(&play::state_header(Name::FLUID, step, First), &[]))
                .collect();
            assert_eq!(results[..2], [Ok(()), Ok(())]);
            assert!(matches!(results[2], Err(LinkError::Timeout { seconds: 0.4, .. })), "{results:?}");
            done.store(true, Ordering::Relaxed);
        },
        |_solid| linger(),
        |_coupler| linger(),
    );
}

/// Who waits for long takes no processor time, even if all messages before came at once.
pub fn patience<S: Transport>() {
    const STEPS: u64 = 100;
    let run = Run::new(100, 100);
    let silent = Duration::from_secs(1);
    let asleep = |wait: &mut dyn FnMut()| {
        let before = cpu_seconds();
        wait();
        let taken = cpu_seconds() - before;
        assert!(taken < 0.02 * silent.as_secs_f64(), "{taken} s");
    };
    with_links::<S>(
        &run,
        None,
        |mut fluid| {
            for step in 0..=STEPS {
                if step == STEPS {
                    sleep(silent);
                }
                let records = [play::state(Name::FLUID, 0, First, 0)];
                let header = play::state_header(Name::FLUID, step, First);
                fluid.send_state(&StateHeader { epoch: 0, ..header }, &records).unwrap();
                let expect = Expect::new(step, First).dt(play::clock(step).1);
                let mut wait = || drop(fluid.receive_forces(&expect).unwrap());
                if step == STEPS { asleep(&mut wait) } else { wait() }
            }
        },
        |mut solid| {
            for step in 0..=STEPS {
                let mut wait = || drop(solid.receive_peer(&Expect::new(step, First)).unwrap());
                if step == STEPS { asleep(&mut wait) } else { wait() }
            }
        },
        |mut coupler| {
            for step in 0..=STEPS {
                let expect = Expect::new(step, First);
                let mut wait = || drop(coupler.receive_state(0, &expect).unwrap());
                if step == STEPS {
                    asleep(&mut wait)
                } else {
                    wait()
                }
                if step == STEPS {
                    sleep(silent);
                }
                let header = play::force_header(Name::FLUID, step, First);
                let record = play::state(Name::FLUID, 0, First, 0);
                let forces = [play::force(&record, &record)];
                coupler.send_forces(0, &ForceHeader { epoch: 0, ..header }, &forces).unwrap();
            }
        },
    );
}

/// The abort flag ends every wait: for a message and for the start.
pub fn abort<S: Transport>() {
    let run = Run::new(100, 100);
    let flag = Arc::new(AtomicBool::new(false));
    let is_aborted = |result: Result<(), LinkError>| {
        assert_eq!(result, Err(LinkError::Aborted));
    };
    let set = AtomicBool::new(false);
    let ended = |start: Instant| assert!(start.elapsed() < SOON, "{:?}", start.elapsed());
    with_links::<S>(
        &run,
        Some(Arc::clone(&flag)),
        |mut fluid| {
            let start = Instant::now();
            is_aborted(fluid.receive_peer(&Expect::new(0, First)).map(drop));
            ended(start);
            eventually(5.0, "the flag", || set.load(Ordering::Relaxed));
        },
        |mut solid| {
            is_aborted(solid.receive_forces(&Expect::new(0, First)).map(drop));
            eventually(5.0, "the flag", || set.load(Ordering::Relaxed));
        },
        |mut coupler| {
            scope(|threads| {
                threads.spawn(|| {
                    sleep(Duration::from_millis(150));
                    flag.store(true, Ordering::Relaxed);
                });
                is_aborted(coupler.receive_state(0, &Expect::new(0, First)).map(drop));
            });
            set.store(true, Ordering::Relaxed);
        },
    );
    is_aborted(End::<S>::open(&run, Name::FLUID, Some(flag)).map(drop));
}

/// More particles than there is room for: refused where they are sent, and where they come from a stranger.
pub fn capacity<S: Transport>() {
    let run = Run::new(10, 10);
    let records: Vec<StateRecord> = (0..11).map(|slot| play::state(Name::FLUID, 0, First, slot)).collect();
    let too_many =
        |peer| LinkError::Capacity { peer, needed: 11, capacity: 10, key: LinkError::CAPACITY_KEY };
    scope(|threads| {
        threads.spawn(|| {
            let fluid = RawPhase::<S>::enter(&run, "fluid", 11);
            fluid.send(identified(&run, play::state_header(Name::FLUID, 0, First), 11), &records);
            eventually(20.0, "the solid's end", || {
                fluid
                    .peer
                    .receive()
                    .unwrap()
                    .is_some_and(|last| last.user_header().0.status == status::FAILED)
            });
        });
        threads.spawn(|| {
            let mut solid = End::<S>::open(&run, Name::SOLID, None).unwrap();
            let header = play::state_header(Name::SOLID, 0, First);
            assert_eq!(solid.send_state(&header, &records), Err(too_many(Name::SOLID)));
            let error = solid.receive_peer(&Expect::new(0, First)).map(drop);
            assert_eq!(error, Err(too_many(Name::FLUID)));
            solid.send_state(&StateHeader { status: status::FAILED, ..header }, &[]).unwrap();
        });
        let mut coupler = CouplerLink::<S>::open(&run, None).unwrap();
        let error = coupler.receive_state(0, &Expect::new(0, First)).map(drop);
        assert_eq!(error, Err(too_many(Name::FLUID)));
        let last = coupler.receive_state(1, &Expect::new(0, First)).unwrap();
        assert_eq!(last.header().status, status::FAILED);
    });
}

/// A process whose records or schema differ is refused at the start.
pub fn incompatible_processes<S: Transport>() {
    let run = Run::new(10, 10);
    let _claim = Claim::new(&run).unwrap();
    let is_refused = |channel: &str, what: &str| {
        let error = End::<S>::open(&run, Name::SOLID, None).map(drop).unwrap_err();
        match &error {
            LinkError::Incompatible { service, reason } => {
                assert_eq!(service, channel);
                assert!(reason.contains(what), "{reason}");
            }
            other => panic!("{other}"),
        }
    };
    {
        let _other_schema = RawRole::<S>::enter_with_schema(&run, "fluid", 1);
        is_refused("halfstep/fluid/wake", "IncompatibleAttributes");
    }
    let other_records = RawRole::<S>::enter(&run, "fluid");
    let _service = other_records.channel::<f64, StateHeader>("fluid/state", 2);
    is_refused("halfstep/fluid/state", "IncompatibleTypes");
}

/// Two solids in one process, a third in its own: states, forces and probe values arrive at the right participant, step
/// by step.
pub fn several_solids<S: Transport>() {
    let [a, b, c]: [Name; 3] = ["a", "b", "c"].map(|name| name.parse().unwrap());
    let mut run = Run::new(100, 100);
    let solid = |name, process| Participant { name, process, capacity: 10, probes: 2 };
    run.0.participants.splice(1.., [solid(a, Name::SOLID), solid(b, Name::SOLID), solid(c, c)]);
    run.0.participants[0].probes = 1;
    let run = &*run;
    let names = run.names();
    let record = |place: usize, step: u64| StateRecord {
        id: place as u32,
        position: [place as f64, step as f64, 0.0],
        density: 1.0,
        mass: 1.0,
        ..StateRecord::default()
    };
    let serve = |process: Name| {
        let mut link = ProcessLink::<S>::open(run, process, None).unwrap();
        let places = run.members(process);
        assert_eq!(link.members(), places.iter().map(|&k| names[k]).collect::<Vec<_>>());
        let (mut states, mut forces) = (Vec::new(), Vec::new());
        for step in 0..50 {
            let expect = Expect::new(step, First);
            for (member, &place) in places.iter().enumerate() {
                let header = StateHeader { step, dt_limit: 1.0, ..StateHeader::default() };
                link.send_state(member, &header, &[record(place, step)]).unwrap();
            }
            for (member, &place) in places.iter().enumerate() {
                for (peer, other) in run.peers(place).into_iter().enumerate() {
                    assert_eq!(link.peers(member)[peer], names[other]);
                    link.receive_peer(member, peer, &expect, &mut states).unwrap();
                    assert_eq!(states, [record(other, step)]);
                }
                let answer = link.receive_forces(member, &expect, &mut forces).unwrap();
                assert_eq!(forces[0].stress_force, [10.0 * place as f64, step as f64, 0.0]);
                if answer.order & order::SEND_PROBES != 0 {
                    let values = [step as f64, place as f64];
                    let count = run.participants[place].probes as usize;
                    link.send_probes(member, step, 0.5, &values[..count]).unwrap();
                }
            }
        }
    };
    scope(|threads| {
        for process in run.processes() {
            let serve = &serve;
            threads.spawn(move || serve(process));
        }
        let mut coupler = CouplerLink::<S>::open(run, None).unwrap();
        for step in 0..50 {
            for place in 0..names.len() {
                let state = coupler.receive_state(place, &Expect::new(step, First)).unwrap();
                assert_eq!(state.records(), [record(place, step)], "{}", names[place]);
            }
            let row = step % 7 == 0;
            for place in 0..names.len() {
                let orders = order::GO | if row { order::SEND_PROBES } else { 0 };
                let header = ForceHeader { step, order: orders, dt: 1.0, ..ForceHeader::default() };
                let stress_force = [10.0 * place as f64, step as f64, 0.0];
                let force = ForceRecord { id: place as u32, stress_force, ..ForceRecord::default() };
                coupler.send_forces(place, &header, &[force]).unwrap();
            }
            for place in (0..names.len()).filter(|_| row) {
                let mut values = Vec::new();
                coupler.receive_probes(place, step, &mut values).unwrap();
                let expected = [step as f64, place as f64];
                assert_eq!(values, &expected[..run.participants[place].probes as usize]);
            }
        }
    });
}
