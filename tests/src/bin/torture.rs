//! Interrupts real runs at random instants in random ways: `torture [RUNS] [SECONDS] [SEED]`. Ends with status 1 where
//! one hung, lost what it had announced, left something behind, or went on to other bits.

use halfstep_tests::torture::{python, torture};
use std::process::ExitCode;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

fn main() -> ExitCode {
    let arguments: Vec<Option<u64>> = std::env::args().skip(1).map(|word| word.parse().ok()).collect();
    if arguments.len() > 3 || arguments.contains(&None) {
        eprintln!("usage: torture [RUNS] [SECONDS] [SEED]");
        return ExitCode::from(2);
    }
    let number = |place: usize| arguments.get(place).copied().flatten();
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |since| since.as_nanos() as u64);
    let (runs, seed) = (number(0).unwrap_or(1000) as usize, number(2).unwrap_or(now));
    let time = Duration::from_secs(number(1).unwrap_or(1_000_000));
    let python = python();
    if python.is_none() {
        eprintln!("no Python environment (tests/python/setup.sh): no external solids");
    }
    println!("seed {seed}");
    let tally = torture(runs, seed, time, python.as_deref(), |line| println!("{line}"));
    println!(
        "{} runs, {} of them disturbed before their end, {} resumed; {} faults",
        tally.runs,
        tally.disturbed,
        tally.resumed,
        tally.faults.len()
    );
    for fault in &tally.faults {
        println!("{fault}");
    }
    ExitCode::from(u8::from(!tally.faults.is_empty()))
}
