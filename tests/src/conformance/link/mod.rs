//! What every transport of the link must do: [`suite`] has the cases, [`play`] a run with known values, [`raw`] a
//! peer that is written against the wire alone and can therefore lie.

pub mod end;
pub mod faults;
pub mod play;
pub mod raw;
pub mod suite;

use halfstep_link::LinkConfig;
use std::ops::Deref;
use std::path::Path;
use std::time::{Duration, Instant};

/// A run of its own that must have left nothing behind when it is dropped.
#[derive(Debug)]
pub struct Run(pub LinkConfig);

impl Run {
    /// A run with room for this many particles of each phase. Waits end after 20 s.
    pub fn new(fluid_capacity: u32, solid_capacity: u32) -> Self {
        Self(LinkConfig {
            handshake_seconds: 20.0,
            patience_seconds: 20.0,
            ..LinkConfig::of_two(fluid_capacity, solid_capacity)
        })
    }

    /// Files of the run in shared memory and its root folder.
    pub fn leftovers(&self) -> Vec<String> {
        let shm = std::fs::read_dir("/dev/shm").expect("shared memory");
        let mut found: Vec<String> = shm
            .flatten()
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .filter(|name| name.starts_with(&self.prefix))
            .collect();
        if Path::new(&self.root).exists() {
            found.push(self.root.display().to_string());
        }
        found
    }
}

impl Deref for Run {
    type Target = LinkConfig;

    fn deref(&self) -> &LinkConfig {
        &self.0
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert_eq!(self.leftovers(), Vec::<String>::new(), "left behind");
        }
    }
}

/// Waits until `condition` holds; panics after `seconds`.
pub fn eventually(seconds: f64, what: &str, mut condition: impl FnMut() -> bool) {
    let deadline = Instant::now() + Duration::from_secs_f64(seconds);
    while !condition() {
        assert!(Instant::now() < deadline, "{what}: not within {seconds} s");
        std::thread::sleep(Duration::from_millis(2));
    }
}
