//! What a half-step's exchange between processes takes beside raw transport of the same bytes:
//! `cargo bench --bench exchange`. `target/bench.json` has the same numbers.
//!
//! Fluid, solid and coupler are processes that exchange through the link and compute nothing; two more send bare bytes
//! to each other, asleep while they wait or awake for a moment as the link's ends. The kinds of exchange take turns, so
//! that other programs on the machine meet all of them; all figures are medians.

mod support;

use halfstep_coupling::supervise::{Children, abort_flag};
use halfstep_link::{
    Claim, CouplerLink, CouplerPort, Expect, FLUID, Identities, LinkConfig, Port, ProcessLink, Processes,
    StateCheck, StateMessage, check_all_room, verify_forces,
};
use halfstep_wire::Name;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{
    ForceHeader, ForceRecord, PROTOCOL, SCHEMA, StateHeader, StateRecord, order, status,
};
use serde_json::{Map, Value};
use std::error::Error;
use std::hint::black_box;
use std::process::Command;
use std::time::{Duration, Instant};
use support::median;
use support::raw::End;

type Outcome<T> = Result<T, Box<dyn Error>>;

const SIZES: [u32; 3] = [100, 1_000, 10_000];
/// Of each kind one after the other. The first one finds the caches full of another kind and is not counted.
const BLOCK: usize = 21;
const WARM_UP: usize = 10;
const ROUNDS: usize = 100;
const DT: f64 = 1e-5;

/// What is measured, as `target/bench.json` and the table name it.
const KINDS: [(&str, &str); 9] = [
    ("raw_us", "raw"),
    ("halfstep_us", "halfstep"),
    ("both_us", "both N"),
    ("wake_ups_us", "wake-ups"),
    ("raw_read_us", "raw, read"),
    ("raw_awake_us", "awake"),
    ("raw_read_awake_us", "read"),
    ("copy_us", "copy"),
    ("checks_us", "checks"),
];

/// First words of raw messages: what the answer shall be.
const EMPTY: u64 = 0;
const WRITTEN: u64 = 1;
const READ: u64 = 2;
const END: u64 = 3;
/// With this bit the other end stays awake for the next one. (The first of each kind is not counted.)
const AWAKE: u64 = 4;

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [role, processors @ ..] = arguments.as_slice() else { return tables() };
    let role = match role.as_str() {
        "solid" => solid,
        "coupler" => coupler,
        "raw" => answers,
        _ => return tables(),
    };
    bind(&processors.iter().map(|number| number.parse()).collect::<Result<Vec<_>, _>>()?)?;
    role()
}

fn tables() -> Outcome<()> {
    let processors = processors()?;
    println!("from publishing a state of N records to having their forces, between processes, medians, us");
    println!("\nprocesses where the system places them");
    let mut figures = Map::from_iter([("free".into(), table([&processors, &processors])?)]);
    if let [first, others @ ..] = processors.as_slice()
        && !others.is_empty()
    {
        println!("\nthe fluid on a processor of its own, as one that computes is");
        figures.insert("apart".into(), table([&[*first], others])?);
    }
    support::store(Map::from_iter([("exchange".into(), figures.into())]));
    Ok(())
}

/// The processors that this process may run on.
fn processors() -> Outcome<Vec<usize>> {
    // SAFETY: a set of processors is plain bits; the call writes to nothing else.
    let (set, outcome) = unsafe {
        let mut set: libc::cpu_set_t = std::mem::zeroed();
        let outcome = libc::sched_getaffinity(0, size_of_val(&set), &raw mut set);
        (set, outcome)
    };
    if outcome != 0 {
        return Err(std::io::Error::last_os_error().into());
    }
    // SAFETY: all numbers are within the set.
    Ok((0..libc::CPU_SETSIZE as usize).filter(|&k| unsafe { libc::CPU_ISSET(k, &set) }).collect())
}

fn bind(processors: &[usize]) -> Outcome<()> {
    // SAFETY: as above; the numbers are those of `processors`.
    let outcome = unsafe {
        let mut set: libc::cpu_set_t = std::mem::zeroed();
        processors.iter().for_each(|&k| libc::CPU_SET(k, &mut set));
        libc::sched_setaffinity(0, size_of_val(&set), &raw const set)
    };
    if outcome == 0 { Ok(()) } else { Err(std::io::Error::last_os_error().into()) }
}

/// Prints a row for each size: the fluid on these processors, all others on those.
fn table(places: [&[usize]; 2]) -> Outcome<Value> {
    print!("{:>6} {:>8}", "N", "bytes");
    KINDS.iter().for_each(|(_, heading)| print!(" {heading:>9}"));
    println!(" {:>9} {:>9}", "over raw", "bytes/us");
    let mut figures = Map::new();
    for records in SIZES {
        let bytes: usize = bytes(records).iter().sum();
        let times = measure(records, places)?.map(|seconds| 1e6 * seconds);
        let (ratio, rate) = (times[1] / times[0], bytes as f64 / times[1]);
        print!("{records:>6} {bytes:>8}");
        times.iter().for_each(|us| print!(" {us:>9.1}"));
        println!(" {ratio:>9.2} {rate:>9.0}");
        let mut row: Map<String, Value> =
            KINDS.iter().map(|kind| kind.0.into()).zip(times.map(Value::from)).collect();
        row.extend([
            ("bytes".into(), bytes.into()),
            ("halfstep_over_raw".into(), ratio.into()),
            ("halfstep_bytes_per_us".into(), rate.into()),
        ]);
        figures.insert(records.to_string(), row.into());
    }
    Ok(figures.into())
}

/// Bytes of a state of so many records and of its answer.
fn bytes(records: u32) -> [usize; 2] {
    let n = records as usize;
    let state = size_of::<StateHeader>() + n * size_of::<StateRecord>();
    [state, size_of::<ForceHeader>() + n * size_of::<ForceRecord>()]
}

fn words(records: u32) -> [usize; 2] {
    bytes(records).map(|bytes| bytes / size_of::<u64>())
}

/// Medians of all kinds, s.
fn measure(records: u32, [of_fluid, of_others]: [&[usize]; 2]) -> Outcome<[f64; KINDS.len()]> {
    // The raw ends have the names of a run, too: whatever removes the objects of runs removes theirs.
    let configs = [records, 1, records].map(|of_solid| LinkConfig::of_two(records, of_solid));
    let [of_raw, of_one, of_both] = &configs;
    let _claims = configs.iter().map(Claim::new).collect::<Result<Vec<_>, _>>()?;
    let log = of_raw.root.join("log.txt");
    let mut children = Children::new(&log);
    let mut start = |name: &str, role: Name, config: &LinkConfig| -> Outcome<()> {
        check_all_room(config)?;
        let mut command = Command::new(std::env::current_exe()?);
        command.arg(name).args(of_others.iter().map(usize::to_string)).envs(config.to_env());
        Ok(children.spawn(role, command)?)
    };
    // A process must not fork once it has a link: all children first.
    start("raw", Name::COUPLER, of_raw)?;
    for config in [of_one, of_both] {
        start("solid", Name::SOLID, config)?;
        start("coupler", Name::COUPLER, config)?;
    }
    bind(of_fluid)?;
    let medians = in_turns(records, &configs).inspect_err(|_| {
        eprintln!("{}", std::fs::read_to_string(&log).unwrap_or_default());
    })?;
    if !children.wait(Duration::from_secs(5)) {
        return Err("a process did not end".into());
    }
    Ok(medians)
}

fn in_turns(records: u32, [of_raw, of_one, of_both]: &[LinkConfig; 3]) -> Outcome<[f64; KINDS.len()]> {
    let raw = End::open(of_raw, ["ask", "answer"], words(records)[0], None);
    let mut message: Vec<u64> = (0..words(records)[0] as u64).collect();
    let mut answer = vec![0; words(records)[1]];
    let mut ask = |request: u64, words: usize| {
        message[0] = request;
        let start = Instant::now();
        raw.send(&message[..words]);
        let sample = raw.receive(request & AWAKE != 0).expect("an answer");
        if request & !AWAKE == READ {
            answer.copy_from_slice(sample.payload());
            black_box(&mut answer);
        }
        start.elapsed()
    };
    let mut one = Participant::enter(of_one, FLUID)?;
    let mut both = Participant::enter(of_both, FLUID)?;
    let mut parts = Parts::new(of_one);
    let mut seconds = KINDS.map(|_| Vec::with_capacity(ROUNDS * BLOCK));
    let whole = words(records)[0];
    for round in 0..WARM_UP + ROUNDS {
        for ((kind, _), seconds) in KINDS.iter().zip(&mut seconds) {
            for k in 0..BLOCK {
                let time = match *kind {
                    "raw_us" => ask(WRITTEN, whole),
                    "halfstep_us" => one.exchange()?.ok_or("the solid has ended")?,
                    "both_us" => both.exchange()?.ok_or("the solid has ended")?,
                    "wake_ups_us" => ask(EMPTY, 1),
                    "raw_read_us" => ask(READ, whole),
                    "raw_awake_us" => ask(WRITTEN | AWAKE, whole),
                    "raw_read_awake_us" => ask(READ | AWAKE, whole),
                    "copy_us" => parts.copy(),
                    _ => parts.check()?,
                };
                if round >= WARM_UP && k > 0 {
                    seconds.push(time.as_secs_f64());
                }
            }
        }
    }
    raw.send(&[END]);
    one.end()?;
    both.end()?;
    Ok(seconds.map(median))
}

fn half_steps() -> impl Iterator<Item = HalfStep> {
    (0..).flat_map(|step| HalfStep::begin(step, step as f64 * DT).lasting(DT).both())
}

fn states(count: u32) -> Vec<StateRecord> {
    let state = |id| StateRecord {
        id,
        position: [f64::from(id), 1.0, 0.0],
        velocity: [0.1, 0.2, 0.0],
        density: 1000.0,
        pressure: 1e3,
        mass: 1.0,
        ..StateRecord::default()
    };
    (0..count).map(state).collect()
}

fn forces(count: u32) -> Vec<ForceRecord> {
    let force =
        |id| ForceRecord { id, flags: 0, cross_viscosity: [0.1, 0.2, 0.0], stress_force: [1.0, 2.0, 0.0] };
    (0..count).map(force).collect()
}

fn state_header(half_step: &HalfStep) -> StateHeader {
    StateHeader { dt_limit: 1.0, ..half_step.state_header() }
}

/// A participant that computes nothing.
struct Participant {
    link: ProcessLink<Processes>,
    half_steps: Box<dyn Iterator<Item = HalfStep>>,
    own: Vec<StateRecord>,
    peer: Vec<StateRecord>,
    forces: Vec<ForceRecord>,
}

impl Participant {
    fn enter(config: &LinkConfig, place: usize) -> Outcome<Self> {
        let participant = config.participants[place];
        Ok(Self {
            link: ProcessLink::open(config, participant.process, Some(abort_flag()?))?,
            half_steps: Box::new(half_steps()),
            own: states(participant.capacity),
            peer: Vec::new(),
            forces: Vec::new(),
        })
    }

    fn next(&mut self) -> HalfStep {
        self.half_steps.next().expect("half-steps do not end")
    }

    /// One half-step's messages; `None` where the peer has ended.
    fn exchange(&mut self) -> Outcome<Option<Duration>> {
        let half_step = self.next();
        let (header, expect) = (state_header(&half_step), Expect::of(&half_step));
        let start = Instant::now();
        self.link.send_state(0, &header, &self.own)?;
        let peer = self.link.receive_peer(0, 0, &expect.dt(header.dt), &mut self.peer)?;
        if peer.status != status::OK {
            return Ok(None);
        }
        self.link.receive_forces(0, &expect.dt(DT), &mut self.forces)?;
        Ok(Some(start.elapsed()))
    }

    /// Tells the others to end.
    fn end(mut self) -> Outcome<()> {
        let header = StateHeader { status: status::FAILED, ..state_header(&self.next()) };
        Ok(self.link.send_state(0, &header, &[])?)
    }
}

fn solid() -> Outcome<()> {
    let mut solid = Participant::enter(&LinkConfig::from_env()?, 1)?;
    while solid.exchange()?.is_some() {}
    Ok(())
}

fn coupler() -> Outcome<()> {
    let config = LinkConfig::from_env()?;
    let mut link = CouplerLink::<Processes>::open(&config, Some(abort_flag()?))?;
    let forces: Vec<_> = config.participants.iter().map(|participant| forces(participant.capacity)).collect();
    for half_step in half_steps() {
        let expect = Expect::of(&half_step).dt(half_step.state_header().dt);
        // In the order of a real run, which holds the states while it answers.
        let solid = link.receive_state(1, &expect)?;
        let fluid = link.receive_state(0, &expect)?;
        if fluid.header().status != status::OK {
            break;
        }
        let header = ForceHeader { order: order::GO, ..half_step.force_header() };
        for (place, forces) in forces.iter().enumerate() {
            link.send_forces(place, &header, forces)?;
        }
        drop((solid, fluid));
    }
    Ok(())
}

/// The other end of the raw transport.
fn answers() -> Outcome<()> {
    let config = LinkConfig::from_env()?;
    let _claim = Claim::new(&config)?;
    let [there, back] = words(config.participants[0].capacity);
    let end = End::open(&config, ["answer", "ask"], back, Some(abort_flag()?));
    let answer = vec![1; back];
    let mut read = vec![0; there];
    let mut awake = false;
    while let Some(message) = end.receive(awake) {
        let request = message.payload()[0];
        awake = request & AWAKE != 0;
        match request & !AWAKE {
            EMPTY => end.send(&[EMPTY]),
            WRITTEN => end.send(&answer),
            READ => {
                read.copy_from_slice(message.payload());
                black_box(&mut read);
                end.send(&answer);
            }
            _ => break,
        }
    }
    Ok(())
}

/// What an exchange is made of, in one thread.
struct Parts {
    states: Vec<StateRecord>,
    forces: Vec<ForceRecord>,
    copies: (Vec<StateRecord>, Vec<ForceRecord>),
    run_id: u64,
    state_check: StateCheck,
    sent: Identities,
}

impl Parts {
    fn new(config: &LinkConfig) -> Self {
        let capacity = config.participants[0].capacity;
        let mut sent = Identities::new(capacity);
        sent.begin(0);
        (0..capacity).for_each(|id| sent.push(id));
        let (states, forces) = (states(capacity), forces(capacity));
        let copies = (states.clone(), forces.clone());
        Self { states, forces, copies, run_id: config.run_id, state_check: StateCheck::new(config, 0), sent }
    }

    /// Copies a state and its answer once.
    fn copy(&mut self) -> Duration {
        let start = Instant::now();
        self.copies.0.copy_from_slice(black_box(&self.states));
        self.copies.1.copy_from_slice(black_box(&self.forces));
        black_box(&mut self.copies);
        start.elapsed()
    }

    /// Checks a state and its answer once.
    fn check(&mut self) -> Outcome<Duration> {
        let half_step = HalfStep::begin(0, 0.0).lasting(DT);
        let (run_id, count) = (self.run_id, self.states.len() as u32);
        let (protocol, schema) = (PROTOCOL, SCHEMA);
        let header = StateHeader { run_id, protocol, schema, count, ..state_header(&half_step) };
        let answer =
            ForceHeader { run_id, protocol, schema, count, order: order::GO, ..half_step.force_header() };
        let expect = Expect::of(&half_step);
        let start = Instant::now();
        self.state_check.verify(&header, black_box(&self.states), &expect)?;
        verify_forces(run_id, &self.sent, &answer, black_box(&self.forces), &expect)?;
        Ok(start.elapsed())
    }
}
