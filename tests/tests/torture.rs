//! A short torture: `make torture` is the long one.

use halfstep_tests::torture::{python, torture};
use std::time::Duration;

#[test]
fn runs_that_are_interrupted_at_any_instant_lose_nothing() {
    let seed = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_nanos() as u64;
    let tally = torture(8, seed, Duration::from_secs(15), python().as_deref(), |line| println!("{line}"));
    assert!(tally.faults.is_empty(), "seed {seed}:\n{}", tally.faults.join("\n"));
    assert!(tally.disturbed > 0, "{tally:?}");
}
