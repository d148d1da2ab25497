//! Bare transport of words between two processes that sleep while they wait: no checks, and no copies but those asked
//! for.

use halfstep_link::{LinkConfig, Processes};
use halfstep_tests::conformance::link::eventually;
use halfstep_tests::conformance::link::raw::{node, persistently};
use iceoryx2::port::listener::Listener;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::*;
use iceoryx2::sample::Sample;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// As long as the link stays awake, and sleeps.
const STAY: Duration = Duration::from_micros(200);
const TICK: Duration = Duration::from_millis(50);
const PATIENCE: Duration = Duration::from_secs(60);
/// Messages of a channel that can exist at once, as many as the link has.
const SAMPLES: usize = 6;

/// One of the two ends.
#[derive(Debug)]
pub(crate) struct End {
    publisher: Publisher<Processes, [u64], ()>,
    subscriber: Subscriber<Processes, [u64], ()>,
    listener: Listener<Processes>,
    notifier: Notifier<Processes>,
    abort: Option<Arc<AtomicBool>>,
    _node: Node<Processes>,
}

impl End {
    /// Opens the end `own` and waits for the `other`. Messages have up to so many words.
    pub(crate) fn open(
        config: &LinkConfig,
        [own, other]: [&str; 2],
        words: usize,
        abort: Option<Arc<AtomicBool>>,
    ) -> Self {
        let node = node::<Processes>(config);
        let name = |end: &str, kind: &str| ServiceName::new(&format!("raw/{end}/{kind}")).unwrap();
        let events = [own, other].map(|end| {
            persistently(|| {
                node.service_builder(&name(end, "wake"))
                    .event()
                    .max_listeners(1)
                    .max_notifiers(1)
                    .open_or_create()
            })
        });
        let channels = [own, other].map(|end| {
            persistently(|| {
                node.service_builder(&name(end, "words"))
                    .publish_subscribe::<[u64]>()
                    .enable_safe_overflow(false)
                    .history_size(0)
                    .subscriber_max_buffer_size(2)
                    .subscriber_max_borrowed_samples(2)
                    .max_publishers(1)
                    .max_subscribers(1)
                    .open_or_create()
            })
        });
        let listener = events[0].listener_builder().create().unwrap();
        let subscriber = channels[1].subscriber_builder().create().unwrap();
        let publisher = channels[0]
            .publisher_builder()
            .allocation_strategy(AllocationStrategy::Static)
            .initial_max_slice_len(words)
            .max_loaned_samples(1)
            .override_sample_preallocation(|_| SAMPLES)
            .create()
            .unwrap();
        eventually(20.0, "the other end", || {
            events[1].dynamic_config().number_of_listeners() == 1
                && channels[0].dynamic_config().number_of_subscribers() == 1
                && channels[1].dynamic_config().number_of_publishers() == 1
        });
        publisher.update_connections().unwrap();
        subscriber.update_connections().unwrap();
        let notifier = events[1].notifier_builder().create().unwrap();
        Self { publisher, subscriber, listener, notifier, abort, _node: node }
    }

    /// Writes a message once, straight to where the other end finds it, and wakes that.
    pub(crate) fn send(&self, words: &[u64]) {
        let sample = self.publisher.loan_slice_uninit(words.len()).unwrap();
        sample.write_from_slice(words).send().unwrap();
        self.notifier.notify().unwrap();
    }

    /// Waits until a message is there, asleep, or `awake` for a moment as the link where messages come at once; `None`
    /// where the run ends, or the other end says nothing.
    pub(crate) fn receive(&self, awake: bool) -> Option<Sample<Processes, [u64], ()>> {
        let start = Instant::now();
        while awake && start.elapsed() < STAY {
            if let Some(sample) = self.subscriber.receive().unwrap() {
                return Some(sample);
            }
            std::thread::yield_now();
        }
        loop {
            let aborted = self.abort.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed));
            if aborted || start.elapsed() > PATIENCE {
                return None;
            }
            if let Some(sample) = self.subscriber.receive().unwrap() {
                return Some(sample);
            }
            let _ = self.listener.timed_wait(|_| {}, TICK);
        }
    }
}
