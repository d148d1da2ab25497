//! When checkpoints are written, and what makes one whole.

use crate::clock::{Clock, Limit};
use halfstep_output::OutputError;
use halfstep_output::checkpoint::{self, COUPLER, Manifest, file, file_name};
use halfstep_scene::Scene;
use halfstep_wire::Name;
use halfstep_wire::state::Group;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use xxhash_rust::xxh3::xxh3_64;

/// Duration of computation between checkpoints where the scene gives no interval: what an interruption may cost.
pub const EVERY: Duration = Duration::from_secs(600);

/// Duration of a run from which on it leaves a checkpoint that it can be prolonged from.
pub const WORTH_PROLONGING: Duration = Duration::from_secs(10);

/// Checkpoints of a run that has a folder.
#[derive(Debug)]
pub struct Checkpoints {
    folder: PathBuf,
    /// Simulated time between checkpoints, s; `None`: by the duration of the computation.
    interval: Option<f64>,
    /// Also of the state that the run begins with.
    pub at_start: bool,
    /// Number of the next instant of the interval.
    next: u64,
    started: Instant,
    last: Instant,
    /// Number of the last checkpoint that was ordered.
    number: u64,
    /// What the manifest of a checkpoint that is not whole yet will say.
    pending: Option<Manifest>,
    /// Number of frames that were ordered before it.
    frames: u64,
    manifest: Manifest,
    participants: Vec<Name>,
}

/// Hash of a scene but for its end time: what a checkpoint must agree with.
pub fn scene_hash(scene: &Scene) -> Result<String, serde_json::Error> {
    let scene = Scene { end_time: 0.0, ..scene.clone() };
    Ok(format!("{:016x}", xxh3_64(serde_json::to_string(&scene)?.as_bytes())))
}

impl Checkpoints {
    /// For the run of these participants in a folder. `number` and `time` (s) are those of the checkpoint that the run
    /// goes on from; 0 at its start. `isa` names the instruction set level.
    ///
    /// # Errors
    /// The scene cannot be written down.
    pub fn new(
        scene: &Scene,
        folder: &Path,
        participants: Vec<Name>,
        isa: &str,
        (number, time): (u64, f64),
    ) -> Result<Self, serde_json::Error> {
        let now = Instant::now();
        let interval = Some(scene.output.checkpoint_interval).filter(|interval| *interval > 0.0);
        Ok(Self {
            folder: folder.to_owned(),
            interval,
            at_start: false,
            next: interval.map_or(1, |interval| instants(time, interval) + 1),
            started: now,
            last: now,
            number,
            pending: None,
            frames: 0,
            manifest: Manifest {
                version: env!("CARGO_PKG_VERSION").into(),
                isa: isa.into(),
                scene: scene_hash(scene)?,
                ..Manifest::default()
            },
            participants,
        })
    }

    /// Whether the state at n is to be saved, given the limits of the participants. One checkpoint is written after the
    /// other: while one is not whole, none is due, and a run that stops then goes on from that one.
    pub fn is_due(&mut self, clock: &Clock, limits: &[Limit], stopped: bool) -> bool {
        if !clock.is_unclipped() || self.pending.is_some() {
            return false;
        }
        let by_interval = self.interval.is_some_and(|interval| instants(clock.time(), interval) >= self.next);
        let by_duration = self.interval.is_none() && self.last.elapsed() >= EVERY;
        let worth = self.interval.is_some() || self.started.elapsed() >= WORTH_PROLONGING;
        let first = self.at_start && self.number == 0;
        stopped || first || by_interval || by_duration || worth && clock.is_about_to_clip(limits)
    }

    /// Begins a checkpoint of the state at n, before which so many frames were ordered, with the coupler's part;
    /// returns its number.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(&mut self, coupler: &Group, clock: &Clock, frames: u64) -> Result<u64, OutputError> {
        self.frames = frames;
        if let Some(interval) = self.interval {
            self.next = self.next.max(instants(clock.time(), interval) + 1);
        }
        self.last = Instant::now();
        self.number += 1;
        let folder = checkpoint::folder(&self.folder, self.number);
        Manifest::remove(&folder)?;
        let io = |error| OutputError::Io { action: "create", path: folder.clone(), error };
        std::fs::create_dir_all(&folder).map_err(io)?;
        file::write(&folder.join(COUPLER), coupler)?;
        let (step, time) = (clock.step(), clock.time());
        self.pending = Some(Manifest { number: self.number, step, time, ..self.manifest.clone() });
        Ok(self.number)
    }

    /// Completes the pending checkpoint where all participants have theirs on disk, and the frames before it. `safe`
    /// are the numbers of their last ones and of the frames that are safe.
    ///
    /// # Errors
    /// The manifest cannot be written.
    pub fn complete(&mut self, mut safe: impl Iterator<Item = (u32, u32)>) -> Result<(), OutputError> {
        let frames = self.frames;
        let is_safe = |number: u64, (own, own_frames): (u32, u32)| {
            u64::from(own) >= number && u64::from(own_frames) >= frames
        };
        let Some(manifest) = self.pending.take_if(|own| safe.all(|safe| is_safe(own.number, safe))) else {
            return Ok(());
        };
        let mut files: Vec<String> = self.participants.iter().map(|name| file_name(name.as_str())).collect();
        files.push(COUPLER.into());
        let folder = checkpoint::folder(&self.folder, manifest.number);
        manifest.write(&folder, &files)
    }
}

/// Whole intervals since the start.
fn instants(time: f64, interval: f64) -> u64 {
    (time / interval * (1.0 + 1e-9)).floor() as u64
}
