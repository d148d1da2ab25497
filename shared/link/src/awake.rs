//! Waits that stay awake for a moment.
//!
//! Waking a thread takes tens of microseconds on a virtual machine, whose idle processor halts: longer than a short
//! message. A waiter whose messages come sooner than that asks for the next one, for [`WINDOW`] at most, and offers its
//! processor in between. Whoever computes on the same processor takes such an offer for a tick of the system, of
//! milliseconds, where a sleeper would have been woken in between. So waiters stay awake only where it has paid.

use std::time::{Duration, Instant};

/// Longest stay.
const WINDOW: Duration = Duration::from_micros(200);
/// After a wait longer than the window so many in a row must have been shorter, asleep, before one stays awake.
const CALM: u32 = 8;
/// After a stay in vain so many; each further one doubles it, each that paid takes one off: where one of a hundred is
/// in vain, its milliseconds are what the others save.
const REST: u32 = 64;
const LONGEST_REST: u32 = 1 << 16;

/// Whether the next wait for messages of a channel stays awake. By the waits of this channel alone: those for the
/// coupler's answers are shorter than those for a peer that computes.
#[derive(Debug)]
pub(super) struct Awake {
    /// Short waits still to come before one stays awake.
    asleep: u32,
    rest: u32,
}

impl Default for Awake {
    fn default() -> Self {
        Self { asleep: CALM, rest: REST }
    }
}

impl Awake {
    /// Asks for a message for a while, if that pays. Without one the waiter shall sleep.
    pub(super) fn stay<T, E>(&mut self, ask: impl FnMut() -> Result<Option<T>, E>) -> Result<Option<T>, E> {
        let start = Instant::now();
        let offer = || {
            std::thread::yield_now();
            start.elapsed()
        };
        self.stay_between(offer, ask)
    }

    /// The same; `offer` lends the processor to others and returns the time since the start.
    fn stay_between<T, E>(
        &mut self,
        mut offer: impl FnMut() -> Duration,
        mut ask: impl FnMut() -> Result<Option<T>, E>,
    ) -> Result<Option<T>, E> {
        if self.asleep > 0 {
            return Ok(None);
        }
        loop {
            let late = offer() > WINDOW;
            let message = ask()?;
            if late {
                self.asleep = self.rest;
                self.rest = (2 * self.rest).min(LONGEST_REST);
                return Ok(message);
            }
            if message.is_some() {
                self.rest = (self.rest - 1).max(REST);
                return Ok(message);
            }
        }
    }

    /// Learns how long a wait was that slept.
    pub(super) fn learn(&mut self, wait: Duration) {
        self.asleep = if wait > WINDOW { self.asleep.max(CALM) } else { self.asleep.saturating_sub(1) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    const LONG: Duration = Duration::from_micros(201);

    /// One that has slept through its first waits.
    fn awake() -> Awake {
        let mut awake = Awake::default();
        (0..CALM).for_each(|_| awake.learn(WINDOW));
        awake
    }

    /// What comes with the `last` question, and how often was asked. Each offer ends so long after the start.
    fn ask(awake: &mut Awake, offer: Duration, last: u32) -> (Option<u32>, u32) {
        let mut asked = 0;
        let message = awake.stay_between(
            || offer,
            || {
                asked += 1;
                Ok::<_, Infallible>((asked == last).then_some(asked))
            },
        );
        (message.unwrap(), asked)
    }

    fn cpu_time() -> Duration {
        let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
        // SAFETY: the pointer is to a live timespec.
        unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
        Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
    }

    #[test]
    fn messages_that_come_at_once_are_got_awake() {
        let mut awake = awake();
        for _ in 0..100 {
            assert_eq!(ask(&mut awake, WINDOW, 2), (Some(2), 2));
        }
        let failed = awake.stay(|| Err::<Option<()>, _>("failed"));
        assert_eq!(failed, Err("failed"));
    }

    /// A run whose other process computes for longer never stays awake.
    #[test]
    fn long_waits_sleep_at_once() {
        let mut awake = Awake::default();
        for k in 0..1000 {
            assert_eq!(ask(&mut awake, WINDOW, 1), (None, 0), "wait {k}");
            awake.learn(if k % CALM == CALM - 1 { LONG } else { WINDOW });
        }
        (0..CALM).for_each(|_| awake.learn(WINDOW));
        assert_eq!(ask(&mut awake, WINDOW, 1), (Some(1), 1));
    }

    /// Whoever takes the processor has it from the first offer on, and the waiter does not try again for long.
    #[test]
    fn a_taken_processor_ends_it() {
        let mut awake = awake();
        for round in 0..3 {
            assert_eq!(ask(&mut awake, LONG, 2), (None, 1));
            for k in 0..REST << round {
                assert_eq!(ask(&mut awake, LONG, 1), (None, 0), "round {round}, wait {k}");
                awake.learn(WINDOW);
            }
        }
        // What has come meanwhile is not lost; it did not pay either.
        assert_eq!(ask(&mut awake, LONG, 1), (Some(1), 1));
        assert_eq!(awake.asleep, 8 * REST);
    }

    #[test]
    fn stays_that_pay_shorten_the_rest() {
        let mut awake = Awake { asleep: 0, rest: REST + 2 };
        for rest in [REST + 1, REST, REST] {
            assert_eq!(ask(&mut awake, WINDOW, 1), (Some(1), 1));
            assert_eq!(awake.rest, rest);
        }
        for _ in 0..20 {
            awake.asleep = 0;
            ask(&mut awake, LONG, 2);
        }
        assert_eq!((awake.asleep, awake.rest), (LONGEST_REST, LONGEST_REST));
    }

    /// However many waits are in vain, and whatever else runs.
    #[test]
    fn waits_in_vain_take_no_processor_time() {
        let (mut awake, before) = (awake(), cpu_time());
        for _ in 0..10_000 {
            assert_eq!(awake.stay(|| Ok::<Option<()>, Infallible>(None)), Ok(None));
            awake.learn(WINDOW);
        }
        let taken = cpu_time() - before;
        // Eight stays: 64 waits after the first, 8192 after the last.
        assert!(taken < 16 * WINDOW, "{taken:?}");
    }
}
