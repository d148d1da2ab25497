//! The course of a run: its time line, what is written down of it, and how it is watched and ended.

use crate::checkpoints::Checkpoints;
use crate::clock::Clock;
use crate::recorder::Recorder;
use halfstep_output::{OutputError, SetAside};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

/// The one time line of a run, what is written down of it, and who may end it.
pub struct Course {
    /// Steps and times.
    pub clock: Clock,
    /// Probe log, statistics, progress.
    pub recorder: Recorder,
    /// `None`: nothing is saved.
    pub checkpoints: Option<Checkpoints>,
    /// The run shall not begin with a participant that writes no checkpoints.
    pub must_save: bool,
    /// Set, it ends the run at the next state n.
    pub stop: Arc<AtomicBool>,
    /// What an interrupted run wrote after the checkpoint that this one goes on from, until it goes on.
    pub set_aside: Option<SetAside>,
    /// For who watches the run.
    pub progress: Arc<Progress>,
}

impl Course {
    /// The participants have shown the state that the run goes on from.
    pub(crate) fn go_on(&mut self) -> Result<(), OutputError> {
        self.recorder.forget_later_rows()?;
        self.set_aside.take().map_or(Ok(()), SetAside::forget)
    }
}

/// How far a run is, seen from another thread.
#[derive(Debug, Default)]
pub struct Progress {
    messages: AtomicU64,
    awaited: AtomicUsize,
    waits: AtomicBool,
}

impl Progress {
    /// Messages received so far.
    pub fn messages(&self) -> u64 {
        self.messages.load(Ordering::Relaxed)
    }

    /// Place of the participant whose message was awaited last.
    pub fn awaited(&self) -> usize {
        self.awaited.load(Ordering::Relaxed)
    }

    /// Whether that message has not come yet.
    pub fn waits(&self) -> bool {
        self.waits.load(Ordering::Relaxed)
    }

    /// A participant's message is awaited.
    pub fn await_message(&self, place: usize) {
        self.awaited.store(place, Ordering::Relaxed);
        self.waits.store(true, Ordering::Relaxed);
    }

    /// The awaited message has come.
    pub fn note_message(&self) {
        self.waits.store(false, Ordering::Relaxed);
        self.messages.fetch_add(1, Ordering::Relaxed);
    }
}
