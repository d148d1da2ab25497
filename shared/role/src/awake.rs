//! Threads that stay awake between the passes of a half-step.
//!
//! A pool's thread that finds no work falls asleep within microseconds, and waking it takes tens of them on a virtual
//! machine, whose idle processor halts: as long as half of a short pass. While a participant computes, the other
//! threads of its pool ask for work in turn, for `PATIENCE` at most, and offer their processor to whoever else wants
//! it in between.

use rayon::Yield;
use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// How long a thread without work stays awake: what one thread does alone between two passes takes less.
const PATIENCE: Duration = Duration::from_micros(200);

thread_local! {
    static AWAKE: Cell<bool> = const { Cell::new(false) };
}

/// The other threads of a pool.
#[derive(Clone, Debug, Default)]
pub struct Awake {
    /// Those that are awake.
    count: Arc<AtomicUsize>,
}

impl Awake {
    /// What follows has work for all threads of the pool that this one is of.
    pub fn wake(&self) {
        let others = rayon::current_num_threads() - 1;
        let Some(own) = rayon::current_thread_index() else { return };
        if self.count.load(Ordering::Relaxed) >= others {
            return;
        }
        let count = self.count.clone();
        rayon::spawn_broadcast(move |thread| {
            if thread.index() != own && !AWAKE.replace(true) {
                count.fetch_add(1, Ordering::Relaxed);
                stay();
                count.fetch_sub(1, Ordering::Relaxed);
                AWAKE.set(false);
            }
        });
    }
}

/// Works until there has been nothing to do for a while.
fn stay() {
    let mut idle = Instant::now();
    while idle.elapsed() < PATIENCE {
        if rayon::yield_now() == Some(Yield::Executed) {
            idle = Instant::now();
        } else {
            std::thread::yield_now();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::serve::on_threads;

    /// They wake once however often they are asked to, take work, and fall asleep by themselves.
    #[test]
    fn the_other_threads_wake_once_and_fall_asleep() {
        let awake = Awake::default();
        let seen = on_threads(3, || {
            let begin = Instant::now();
            let mut most = 0;
            while most < 2 && begin.elapsed() < Duration::from_secs(10) {
                awake.wake();
                rayon::join(std::thread::yield_now, || ());
                most = most.max(awake.count.load(Ordering::Relaxed));
            }
            while awake.count.load(Ordering::Relaxed) > 0 && begin.elapsed() < Duration::from_secs(20) {
                std::thread::sleep(PATIENCE);
            }
            (most, awake.count.load(Ordering::Relaxed))
        });
        assert_eq!(seen.expect("three threads"), (2, 0));
        // Alone there is nobody to wake.
        on_threads(1, || awake.wake()).expect("a thread");
        assert_eq!(awake.count.load(Ordering::Relaxed), 0);
    }
}
