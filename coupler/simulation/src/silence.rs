//! Watches a coupled run for silence: says who is waited for, and ends the wait where the run was told to stop or where
//! a process has failed.

use halfstep_coupling::course::Progress;
use halfstep_coupling::say;
use halfstep_coupling::supervise::{Children, StopFlags};
use halfstep_wire::Name;
use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Pause between two looks.
pub(crate) const TICK: Duration = Duration::from_millis(20);

/// Silence that is told.
pub(crate) const TOLD: Duration = Duration::from_secs(5);

/// Silence that a run which was told to stop waits for at least.
const GRACE: Duration = Duration::from_secs(2);

/// Wait for a message after which a process that a signal has ended is taken for the reason: the one that is waited for
/// may itself wait for that process, and hear of its end from nobody.
const BEREAVED: Duration = Duration::from_millis(500);

/// Why a wait was ended.
#[derive(Clone, Copy)]
pub(crate) enum Ended {
    /// The run was told to stop, and this participant was silent for so long.
    Silent(Name, Duration),
    /// This process had failed.
    Failed(Name, ExitStatus),
}

/// What is known of the pauses between messages.
pub(crate) struct Silence<'a> {
    progress: &'a Progress,
    names: &'a [Name],
    messages: u64,
    since: Instant,
    /// Begin of the present wait for a message.
    waiting: Instant,
    longest: Duration,
    told: bool,
}

impl<'a> Silence<'a> {
    /// Of the run of these participants, from now on.
    pub(crate) fn new(progress: &'a Progress, names: &'a [Name]) -> Self {
        let (now, longest) = (Instant::now(), Duration::ZERO);
        Self {
            progress,
            names,
            messages: progress.messages(),
            since: now,
            waiting: now,
            longest,
            told: false,
        }
    }

    /// Watches until the run is over. Where it was told to stop, the wait for a silent participant is ended: at once at
    /// the second signal, else after the larger of two seconds and three times the longest pause so far. Where a child
    /// has failed, the wait ends, too.
    pub(crate) fn watch(
        &mut self,
        children: &mut Children,
        abort: &AtomicBool,
        done: &AtomicBool,
        stop: &StopFlags,
    ) -> Option<Ended> {
        while !done.load(Ordering::Relaxed) {
            children.keep_log_short();
            let silence = self.look();
            let patient = GRACE.max(3 * self.longest);
            let stopped = stop.stop.load(Ordering::Relaxed);
            if stop.at_once.load(Ordering::Relaxed) || (stopped && silence > patient) {
                abort.store(true, Ordering::Relaxed);
                return Some(Ended::Silent(self.awaited()?, silence));
            }
            if let Some((process, status)) = self.bereaved(children) {
                abort.store(true, Ordering::Relaxed);
                return Some(Ended::Failed(process, status));
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

    /// The child whose end keeps the awaited message from coming. One that has failed in order has sent a last message,
    /// which is read as soon as a slow participant has sent its own.
    fn bereaved(&self, children: &mut Children) -> Option<(Name, ExitStatus)> {
        let waiting = self.waiting.elapsed();
        let patience = |status: ExitStatus| match status.signal() {
            Some(_) => BEREAVED,
            None => TOLD.max(3 * self.longest),
        };
        let failed = |(_, status): &(Name, ExitStatus)| !status.success() && waiting > patience(*status);
        if waiting > BEREAVED { children.first_exit().filter(failed) } else { None }
    }

    /// How long no message has come.
    fn look(&mut self) -> Duration {
        let (messages, silence) = (self.progress.messages(), self.since.elapsed());
        if messages != self.messages || !self.progress.waits() {
            self.waiting = Instant::now();
        }
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
