//! Watches a coupled run for silence: says who is waited for, and ends the wait where the run was told to stop.

use halfstep_coupling::course::Progress;
use halfstep_coupling::say;
use halfstep_coupling::supervise::StopFlags;
use halfstep_wire::Name;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Pause between two looks.
pub(crate) const TICK: Duration = Duration::from_millis(20);

/// Silence that is told.
pub(crate) const TOLD: Duration = Duration::from_secs(5);

/// Silence that a run which was told to stop waits for at least.
const GRACE: Duration = Duration::from_secs(2);

/// What is known of the pauses between messages.
pub(crate) struct Silence<'a> {
    progress: &'a Progress,
    names: &'a [Name],
    messages: u64,
    since: Instant,
    longest: Duration,
    told: bool,
}

impl<'a> Silence<'a> {
    /// Of the run of these participants, from now on.
    pub(crate) fn new(progress: &'a Progress, names: &'a [Name]) -> Self {
        let (since, longest) = (Instant::now(), Duration::ZERO);
        Self { progress, names, messages: progress.messages(), since, longest, told: false }
    }

    /// Watches until the run is over. Where it was told to stop, the wait for a silent participant is ended: at once at
    /// the second signal, else after the larger of two seconds and three times the longest pause so far. Returns who
    /// was silent then, and for how long.
    pub(crate) fn watch(
        &mut self,
        abort: &AtomicBool,
        done: &AtomicBool,
        stop: &StopFlags,
    ) -> Option<(Name, Duration)> {
        while !done.load(Ordering::Relaxed) {
            let silence = self.look();
            let patient = GRACE.max(3 * self.longest);
            let stopped = stop.stop.load(Ordering::Relaxed);
            if stop.at_once.load(Ordering::Relaxed) || (stopped && silence > patient) {
                abort.store(true, Ordering::Relaxed);
                return Some((self.awaited()?, silence));
            }
            if silence > TOLD.max(3 * self.longest) && !std::mem::replace(&mut self.told, true) {
                let name = self.awaited()?;
                say::warn(format_args!("waiting for the {name} since {:.0} s", silence.as_secs_f64()));
                tracing::warn!("waiting for the {name} since {:.0} s", silence.as_secs_f64());
            }
            std::thread::sleep(TICK);
        }
        None
    }

    /// How long no message has come.
    fn look(&mut self) -> Duration {
        let (messages, silence) = (self.progress.messages(), self.since.elapsed());
        if messages == self.messages {
            return silence;
        }
        if self.messages > 0 {
            self.longest = self.longest.max(silence);
        }
        (self.messages, self.since, self.told) = (messages, Instant::now(), false);
        Duration::ZERO
    }

    fn awaited(&self) -> Option<Name> {
        self.names.get(self.progress.awaited()).copied()
    }
}
