//! How long a half step's exchange takes: from the fluid's publishing its state to its having the coupler's answer,
//! with nothing computed in between. `cargo run --release -p halfstep-coupling --example round_trip`

use halfstep_coupling::supervise::Children;
use halfstep_link::{
    Claim, CouplerLink, CouplerPort, Expect, LinkConfig, Port, ProcessLink, Processes, StateMessage, Threads,
    Transport,
};
use halfstep_wire::Name;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, StateHeader, StateRecord, order};
use std::error::Error;
use std::process::Command;
use std::time::{Duration, Instant};

const STEPS: u64 = 10_000;
const WARM_UP: usize = 1_000;
const DT: f64 = 1e-5;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [role] = arguments.as_slice() {
        let config = LinkConfig::from_env()?;
        return match role.as_str() {
            "solid" => phase::<Processes>(&config, Name::SOLID).map(drop),
            "coupler" => coupler::<Processes>(&config),
            other => Err(format!("no role: {other}").into()),
        };
    }
    println!("{:<10} {:>8} {:>10} {:>10}", "roles", "records", "p50 [us]", "p99 [us]");
    for records in [100, 1_000, 10_000] {
        report("processes", records, with_processes(records)?);
    }
    for records in [100, 1_000, 10_000] {
        report("threads", records, with_threads(records)?);
    }
    Ok(())
}

fn report(roles: &str, records: u32, mut times: Vec<Duration>) {
    times.drain(..WARM_UP);
    times.sort_unstable();
    let quantile = |part: f64| times[(part * (times.len() - 1) as f64) as usize].as_secs_f64() * 1e6;
    println!("{roles:<10} {records:>8} {:>10.1} {:>10.1}", quantile(0.5), quantile(0.99));
}

fn with_processes(records: u32) -> Outcome<Vec<Duration>> {
    let config = LinkConfig::of_two(records, records);
    let _claim = Claim::new(&config)?;
    let log = std::env::temp_dir().join(format!("{}round_trip.txt", config.prefix));
    let mut children = Children::new(&log);
    for role in [Name::SOLID, Name::COUPLER] {
        let mut command = Command::new(std::env::current_exe()?);
        command.arg(role.to_string()).envs(config.to_env());
        children.spawn(role, command)?;
    }
    let times = phase::<Processes>(&config, Name::FLUID)?;
    children.wait(Duration::from_secs(5));
    std::fs::remove_file(log)?;
    Ok(times)
}

fn with_threads(records: u32) -> Outcome<Vec<Duration>> {
    let config = LinkConfig::of_two(records, records);
    let _claim = Claim::new(&config)?;
    std::thread::scope(|threads| {
        threads.spawn(|| phase::<Threads>(&config, Name::SOLID).map(drop).expect("the solid's part"));
        threads.spawn(|| coupler::<Threads>(&config).expect("the coupler's part"));
        phase::<Threads>(&config, Name::FLUID)
    })
}

fn phase<S: Transport>(config: &LinkConfig, role: Name) -> Outcome<Vec<Duration>> {
    let mut link = ProcessLink::<S>::open(config, role, None)?;
    let count = config.participants[0].capacity as usize;
    let (mut states, mut forces) = (Vec::new(), Vec::new());
    let mut times = Vec::with_capacity(2 * STEPS as usize);
    for half_step in half_steps() {
        let header = StateHeader { dt_limit: 1.0, ..half_step.state_header() };
        let start = Instant::now();
        link.send_state_from(0, &header, count, |slot| StateRecord {
            id: slot as u32,
            position: [slot as f64, half_step.time, 0.0],
            density: 1000.0,
            mass: 1.0,
            ..StateRecord::default()
        })?;
        let expect = Expect::of(&half_step);
        link.receive_peer(0, 0, &expect.dt(header.dt), &mut states)?;
        link.receive_forces(0, &expect.dt(DT), &mut forces)?;
        times.push(start.elapsed());
    }
    Ok(times)
}

fn coupler<S: Transport>(config: &LinkConfig) -> Outcome<()> {
    let mut link = CouplerLink::<S>::open(config, None)?;
    let zero = ForceRecord::default();
    let mut forces: Vec<ForceRecord> =
        (0..config.participants[0].capacity).map(|id| ForceRecord { id, ..zero }).collect();
    for half_step in half_steps() {
        let expect = Expect::of(&half_step).dt(half_step.state_header().dt);
        let fluid = link.receive_state(0, &expect)?;
        let solid = link.receive_state(1, &expect)?;
        for (force, (a, b)) in forces.iter_mut().zip(fluid.records().iter().zip(solid.records())) {
            force.cross_viscosity = [a.position[0] - b.position[0], a.position[1] - b.position[1], 0.0];
        }
        let header = ForceHeader { order: order::GO, ..half_step.force_header() };
        link.send_forces(0, &header, &forces)?;
        link.send_forces(1, &header, &forces)?;
    }
    Ok(())
}

fn half_steps() -> impl Iterator<Item = HalfStep> {
    (0..STEPS).flat_map(|step| HalfStep::begin(step, step as f64 * DT).lasting(DT).both())
}
