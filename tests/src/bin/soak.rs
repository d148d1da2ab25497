//! Runs scenes again and again, several at once, and watches what they hold: `soak [SECONDS] [AT_ONCE] [STEPS]`. One
//! run of STEPS steps goes beside them. Ends with status 1 where memory, descriptors or shared memory grow.

use halfstep_tests::soak::soak;
use std::process::ExitCode;
use std::time::Duration;

fn main() -> ExitCode {
    let arguments: Vec<Option<u64>> = std::env::args().skip(1).map(|word| word.parse().ok()).collect();
    if arguments.len() > 3 || arguments.contains(&None) {
        eprintln!("usage: soak [SECONDS] [AT_ONCE] [STEPS]");
        return ExitCode::from(2);
    }
    let number = |place: usize, usual: u64| arguments.get(place).copied().flatten().unwrap_or(usual);
    let (seconds, at_once, steps) = (number(0, 3600), number(1, 8), number(2, 1_000_000));
    let faults = soak(Duration::from_secs(seconds), at_once as usize, steps, |line| println!("{line}"));
    println!("{} faults", faults.len());
    for fault in &faults {
        println!("{fault}");
    }
    ExitCode::from(u8::from(!faults.is_empty()))
}
