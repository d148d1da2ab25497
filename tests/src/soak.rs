//! Runs for a long time: short ones after one another in several places at once, and a single one of very many steps.
//! What they hold must not grow, and each kind of run must have the same bits every time.

use crate::process::{descriptors, is_alive, leftovers, resident, shared_memory, with_variable};
use crate::run::{RunBuilder, scene};
use halfstep_output::run_json::RunStatus;
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Environment variable by which the processes of the long run are found.
const MARK: &str = "HALFSTEP_SOAK";
/// Samples of what the long run holds.
const SAMPLES: u64 = 400;
/// What the memory of a process may grow by between the second and the last quarter of the long run: the granularity
/// of the allocator, bytes.
const GROWTH: u64 = 1 << 20;
/// Time step of the long run, s: far below what is stable.
const STEP: f64 = 1e-5;

/// Keys with their values.
type Keys = &'static [(&'static str, &'static str)];

/// Short runs of different kinds: the scene, what is set, and the end, s.
const SHORT: [(&str, Keys, f64); 3] = [
    ("elastic-gate", &[("resolution", "0.0025")], 0.01),
    ("two-plates", &[("resolution", "0.004"), ("solid.stiff.process", "own")], 0.02),
    ("hydrostatic-tank", &[("resolution", "0.02")], 0.1),
];

/// What the processes of a run hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Held {
    /// Resident memory, bytes.
    memory: u64,
    descriptors: u64,
    /// Shared memory, bytes, and the number of its objects.
    shared: (u64, u64),
}

impl Held {
    fn now(launcher: u32, mark: &str) -> Self {
        let processes = with_variable(MARK, mark);
        let sum = |of: fn(u32) -> u64| processes.iter().map(|&pid| of(pid)).sum();
        Self { memory: sum(resident), descriptors: sum(descriptors), shared: shared_memory(launcher) }
    }
}

/// Runs short runs in `at_once` places until `time` is over, and one of so many steps beside them; tells how it goes
/// on. Returns what should not be.
pub fn soak(time: Duration, at_once: usize, steps: u64, told: impl Fn(&str) + Sync) -> Vec<String> {
    let faults = Mutex::new(Vec::new());
    let hashes = Mutex::new(BTreeMap::new());
    let started = Instant::now();
    std::thread::scope(|scope| {
        for place in 0..at_once {
            let (faults, hashes, told) = (&faults, &hashes, &told);
            scope.spawn(move || {
                let mut runs = 0;
                while started.elapsed() < time {
                    faults
                        .lock()
                        .expect("no panic")
                        .extend(short_run((place + runs) % SHORT.len(), hashes).err());
                    runs += 1;
                }
                told(&format!("place {place}: {runs} runs"));
            });
        }
        if steps > 0 {
            let found = long_run(steps, &told);
            faults.lock().expect("no panic").extend(found);
        }
    });
    faults.into_inner().expect("no panic")
}

fn configured(name: &str, set: Keys) -> RunBuilder {
    set.iter().fold(scene(name), |run, (key, value)| run.set(key, value))
}

fn short_run(kind: usize, hashes: &Mutex<BTreeMap<usize, String>>) -> Result<(), String> {
    let (name, set, until) = SHORT[kind];
    let running = configured(name, set).until(until).start();
    let launcher = running.pid();
    let outcome = running.wait();
    if outcome.code() != Some(0) {
        return Err(format!("{name}: ended with {:?}: {}", outcome.code(), outcome.stderr));
    }
    let left = leftovers(launcher);
    if !left.is_empty() {
        return Err(format!("{name}: left behind {left:?}"));
    }
    let hash = outcome.report().audit.state_hash.ok_or_else(|| format!("{name}: no hash"))?;
    let mut hashes = hashes.lock().expect("no panic");
    let known = hashes.entry(kind).or_insert_with(|| hash.clone());
    if *known == hash { Ok(()) } else { Err(format!("{name}: {hash} instead of {known}")) }
}

/// A run of so many steps: water pushes a block away and comes to rest.
fn long_run(steps: u64, told: &impl Fn(&str)) -> Vec<String> {
    let until = steps as f64 * STEP;
    let mark = std::process::id().to_string();
    let mut running = configured("spring-block", &[("resolution", "0.02")])
        .set("time_step", STEP)
        .set("end_time", until)
        .set("output.probe_interval", until / 2000.0)
        .set("output.frame_interval", until / 200.0)
        .variable(MARK, mark.as_str())
        .start();
    let launcher = running.pid();
    let mut samples: Vec<(u64, Held)> = Vec::new();
    while running.is_alive() {
        std::thread::sleep(Duration::from_millis(250));
        let report = halfstep_output::RunReport::read(&running.dir().join("run.json"));
        let done = report.map_or(0, |report| report.steps);
        let due = steps * samples.len() as u64 / SAMPLES;
        if done >= due && done > 0 && is_alive(launcher) {
            let held = Held::now(launcher, &mark);
            if samples.len().is_multiple_of(20) {
                told(&format!("step {done}: {held:?}"));
            }
            samples.push((done, held));
        }
    }
    let outcome = running.wait();
    let report = outcome.report();
    if report.status != Some(RunStatus::Finished) || report.steps < steps {
        return vec![format!(
            "the long run: {:?} after {} steps: {}",
            report.status, report.steps, outcome.stderr
        )];
    }
    told(&format!("long run: {} steps, {} s", report.steps, report.wall_seconds));
    growth(&samples, steps)
}

/// What grew from the second quarter of the steps to the last. (The last samples may be of a run that is ending.)
fn growth(samples: &[(u64, Held)], steps: u64) -> Vec<String> {
    // Descriptors: the fewest, since a file that is being written has one for an instant; a leak raises these, too.
    let held = |from: u64, to: u64| {
        let part = samples.iter().filter(|(done, _)| (from * steps / 100..to * steps / 100).contains(done));
        part.map(|(_, held)| *held).reduce(|a, b| Held {
            memory: a.memory.max(b.memory),
            descriptors: a.descriptors.min(b.descriptors),
            shared: a.shared.max(b.shared),
        })
    };
    let (Some(early), Some(late)) = (held(25, 50), held(75, 98)) else {
        return vec![format!("{} samples are too few", samples.len())];
    };
    let mut faults = Vec::new();
    if late.memory > early.memory + GROWTH {
        faults.push(format!("memory grew from {} to {} bytes", early.memory, late.memory));
    }
    if late.descriptors > early.descriptors {
        faults.push(format!("descriptors grew from {} to {}", early.descriptors, late.descriptors));
    }
    if late.shared > early.shared {
        faults.push(format!("shared memory grew from {:?} to {:?}", early.shared, late.shared));
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_grows_is_found() {
        let held = |k: u64| Held { memory: 1 << 30, descriptors: 50, shared: (1 << 20, 20 + k) };
        let flat: Vec<_> = (0..100).map(|k| (k, held(0))).collect();
        assert_eq!(growth(&flat, 100), Vec::<String>::new());
        let growing: Vec<_> = (0..100).map(|k| (k, held(k / 10))).collect();
        assert_eq!(growth(&growing, 100).len(), 1);
        let leak: Vec<_> = (0..100).map(|k| (k, Held { descriptors: 50 + k / 30, ..held(0) })).collect();
        assert_eq!(growth(&leak, 100), ["descriptors grew from 50 to 52"]);
        let file: Vec<_> =
            (0..100).map(|k| (k, Held { descriptors: 50 + u64::from(k == 80), ..held(0) })).collect();
        assert_eq!(growth(&file, 100), Vec::<String>::new());
        assert_eq!(growth(&flat[..3], 100), ["3 samples are too few"]);
    }
}
