//! The ends of a channel: one publisher, its readers, whole messages.

use super::awake::Awake;
use super::config::FLUID;
use super::hub::{Hub, Presence, Watch, attributes, port_error, service_name};
use super::memory::SAMPLES;
use super::{LinkConfig, LinkError, Participant, StateMessage, Transport};
use crate::slot::Slot;
use halfstep_wire::Name;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, Plain, ProbeHeader, StateHeader, StateRecord};
use iceoryx2::identifiers::UniqueNodeId;
use iceoryx2::port::SendError;
use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::*;
use iceoryx2::sample::Sample;
use iceoryx2::sample_mut::SampleMut;
use iceoryx2::sample_mut_uninit::SampleMutUninit;
use iceoryx2::service::port_factory::publish_subscribe;
use std::fmt::Debug;
use std::mem::MaybeUninit;
use std::sync::Arc;

/// A message where it was written.
type Message<S, R, H> = Sample<S, [Slot<R>], Slot<H>>;
/// A message before its records are written, and after.
type Room<S, R, H> = SampleMutUninit<S, [MaybeUninit<Slot<R>>], Slot<H>>;
type Written<S, R, H> = SampleMut<S, [Slot<R>], Slot<H>>;

/// A channel before its ports are made.
#[derive(Debug)]
pub(super) struct Channel<S: Transport, R: Plain, H: Plain> {
    factory: publish_subscribe::PortFactory<S, [Slot<R>], Slot<H>>,
    owner: Name,
    capacity: usize,
}

pub(super) type StateChannel<S> = Channel<S, StateRecord, StateHeader>;
pub(super) type ForceChannel<S> = Channel<S, ForceRecord, ForceHeader>;
pub(super) type ProbeChannel<S> = Channel<S, f64, ProbeHeader>;

impl<S: Transport> StateChannel<S> {
    /// The states of a participant: the fluid's read by all solids, a solid's by the fluid, and both by the coupler.
    pub(super) fn state(hub: &Hub<S>, config: &LinkConfig, place: usize) -> Result<Self, LinkError> {
        let Participant { name, capacity, .. } = config.participants[place];
        let readers = if place == FLUID { config.participants.len() } else { 2 };
        Self::open(hub, name, "state", capacity, readers)
    }
}

impl<S: Transport> ForceChannel<S> {
    /// The coupler's answers to a participant.
    pub(super) fn forces(hub: &Hub<S>, config: &LinkConfig, place: usize) -> Result<Self, LinkError> {
        let Participant { name, capacity, .. } = config.participants[place];
        Self::open(hub, name, "force", capacity, 1)
    }
}

impl<S: Transport> ProbeChannel<S> {
    /// The probe values of a participant, read by the coupler.
    pub(super) fn probes(hub: &Hub<S>, config: &LinkConfig, place: usize) -> Result<Self, LinkError> {
        let Participant { name, probes, .. } = config.participants[place];
        Self::open(hub, name, "probes", probes, 1)
    }
}

impl<S: Transport, R: Plain, H: Plain> Channel<S, R, H> {
    fn open(hub: &Hub<S>, owner: Name, kind: &str, capacity: u32, readers: usize) -> Result<Self, LinkError> {
        let service = format!("halfstep/{owner}/{kind}");
        let (name, attributes) = (service_name(&service)?, attributes()?);
        let factory = hub.open_service(&service, || {
            hub.node
                .service_builder(&name)
                .publish_subscribe::<[Slot<R>]>()
                .user_header::<Slot<H>>()
                .enable_safe_overflow(false)
                .history_size(0)
                .subscriber_max_buffer_size(2)
                .subscriber_max_borrowed_samples(2)
                .max_publishers(1)
                .max_subscribers(readers)
                .max_nodes(readers + 1)
                .open_or_create_with_attributes(&attributes)
        })?;
        Ok(Self { factory, owner, capacity: capacity as usize })
    }

    /// `process` is the one that the sender runs in.
    pub(super) fn reader(
        self,
        hub: &Hub<S>,
        sender: Name,
        process: Name,
    ) -> Result<Incoming<S, R, H>, LinkError> {
        let subscriber = self
            .factory
            .subscriber_builder()
            .create()
            .map_err(|e| port_error(hub.process, "subscribing", e))?;
        Ok(Incoming { subscriber, channel: self, sender, process, met: false, awake: Awake::default() })
    }

    pub(super) fn writer(self, hub: &Hub<S>) -> Result<Outgoing<S, R, H>, LinkError> {
        let watch = Arc::clone(&hub.watch);
        let publisher = self
            .factory
            .publisher_builder()
            .allocation_strategy(AllocationStrategy::Static)
            .initial_max_slice_len(self.capacity.max(1))
            .max_loaned_samples(1)
            .override_sample_preallocation(|_| SAMPLES)
            .backpressure_strategy(BackpressureStrategy::RetryUntilDelivered)
            .set_backpressure_handler(move |info| watch.on_full_queue(info))
            .create()
            .map_err(|e| port_error(hub.process, "publishing", e))?;
        Ok(Outgoing { publisher, channel: self })
    }

    /// The node that writes to this channel.
    fn writer_node(&self) -> Option<UniqueNodeId> {
        let mut node = None;
        self.factory.dynamic_config().list_publishers(|details| {
            node = Some(details.node_id);
            CallbackProgression::Stop
        });
        node
    }
}

/// The reading end of a channel.
#[derive(Debug)]
pub(super) struct Incoming<S: Transport, R: Plain, H: Plain> {
    subscriber: Subscriber<S, [Slot<R>], Slot<H>>,
    channel: Channel<S, R, H>,
    pub(super) sender: Name,
    pub(super) process: Name,
    /// The sender has come.
    met: bool,
    awake: Awake,
}

impl<S: Transport, R: Plain, H: Plain> Incoming<S, R, H> {
    /// Looks whether the sender has come; if so, connects and remembers its node. From then on whatever it sends is
    /// kept, even if it ends at once.
    pub(super) fn meet_sender(&mut self, watch: &Watch<S>) -> Result<Presence, LinkError> {
        match self.channel.writer_node() {
            Some(_) if self.met => Ok(Presence::Here),
            Some(node) => {
                self.subscriber.update_connections().map_err(|e| LinkError::transport("connecting", e))?;
                watch.met(self.process, node);
                self.met = true;
                Ok(Presence::Here)
            }
            None if self.met => Ok(Presence::Left),
            None => Ok(Presence::NotYet),
        }
    }

    pub(super) fn receive(&mut self, hub: &mut Hub<S>) -> Result<Received<S, R, H>, LinkError> {
        let (subscriber, channel) = (&self.subscriber, &self.channel);
        hub.wait(
            self.sender,
            self.process,
            &mut self.awake,
            || channel.writer_node().is_some(),
            || {
                let message = subscriber.receive().map_err(|e| LinkError::transport("receiving", e))?;
                Ok(message.map(Received::new))
            },
        )
    }
}

/// The writing end of a channel.
#[derive(Debug)]
pub(super) struct Outgoing<S: Transport, R: Plain, H: Plain> {
    publisher: Publisher<S, [Slot<R>], Slot<H>>,
    channel: Channel<S, R, H>,
}

impl<S: Transport, R: Plain, H: Plain> Outgoing<S, R, H> {
    pub(super) fn connect(&self) -> Result<(), LinkError> {
        self.publisher.update_connections().map_err(|e| LinkError::transport("connecting", e))
    }

    /// Fails if a message of `count` records does not fit.
    pub(super) fn check_capacity(&self, count: usize) -> Result<(), LinkError> {
        let Channel { capacity, owner, .. } = self.channel;
        if count > capacity {
            let key = LinkError::CAPACITY_KEY;
            return Err(LinkError::Capacity { peer: owner, needed: count, capacity, key });
        }
        Ok(())
    }

    /// Writes a message where its readers will find it, and hands it over. Does not wake them.
    pub(super) fn send(
        &mut self,
        hub: &Hub<S>,
        header: &H,
        count: usize,
        mut record: impl FnMut(usize) -> R,
    ) -> Result<(), LinkError> {
        let sample = self.loan(header, count)?;
        self.hand_over(hub, sample.write_from_fn(|slot| Slot(record(slot))))
    }

    /// The same with records that lie side by side.
    pub(super) fn send_all(&mut self, hub: &Hub<S>, header: &H, records: &[R]) -> Result<(), LinkError> {
        let sample = self.loan(header, records.len())?;
        self.hand_over(hub, sample.write_from_slice(Slot::of(records)))
    }

    /// Room for a message, with its header.
    fn loan(&mut self, header: &H, count: usize) -> Result<Room<S, R, H>, LinkError> {
        self.check_capacity(count)?;
        let mut sample = self
            .publisher
            .loan_slice_uninit(count)
            .map_err(|e| LinkError::transport("room for a message", e))?;
        *sample.user_header_mut() = Slot(*header);
        Ok(sample)
    }

    fn hand_over(&self, hub: &Hub<S>, sample: Written<S, R, H>) -> Result<(), LinkError> {
        match sample.send() {
            Ok(_) => Ok(()),
            Err(SendError::UnableToDeliver) => Err(hub.watch.undelivered(|port| self.owner_of(port))),
            Err(error) => Err(LinkError::transport("sending", error)),
        }
    }

    fn owner_of(&self, port: u128) -> Option<UniqueNodeId> {
        let mut node = None;
        self.channel.factory.dynamic_config().list_subscribers(|details| {
            if details.subscriber_id.value() == port {
                node = Some(details.node_id);
            }
            CallbackProgression::Continue
        });
        node
    }
}

/// A message whose header and number of records are those that were there when it came. Both lie where its sender can
/// still write: what was checked must be what is used.
#[derive(Debug)]
pub(super) struct Received<S: Transport, R: Plain, H: Plain> {
    header: H,
    records: *const R,
    count: usize,
    /// Keeps the records where they are.
    _message: Message<S, R, H>,
}

impl<S: Transport, R: Plain, H: Plain> Received<S, R, H> {
    fn new(message: Message<S, R, H>) -> Self {
        let records = Slot::values(message.payload());
        let (header, records, count) = (message.user_header().0, records.as_ptr(), records.len());
        Self { header, records, count, _message: message }
    }

    fn records(&self) -> &[R] {
        // SAFETY: so many records were there when the message came, and its memory is this reader's as long as it is
        // held.
        unsafe { std::slice::from_raw_parts(self.records, self.count) }
    }
}

/// A received state, read where its sender wrote it. At most two of a channel can be held.
#[derive(Debug)]
pub struct StateSample<S: Transport>(pub(super) Received<S, StateRecord, StateHeader>);

impl<S: Transport> StateMessage for StateSample<S> {
    fn header(&self) -> &StateHeader {
        &self.0.header
    }

    fn records(&self) -> &[StateRecord] {
        self.0.records()
    }
}

/// Received probe values. At most two of a channel can be held.
#[derive(Debug)]
pub struct ProbeSample<S: Transport>(pub(super) Received<S, f64, ProbeHeader>);

impl<S: Transport> ProbeSample<S> {
    /// Header of the message.
    pub fn header(&self) -> &ProbeHeader {
        &self.0.header
    }

    /// The values.
    pub fn values(&self) -> &[f64] {
        self.0.records()
    }
}

/// Received forces, read where the coupler wrote them. At most two of a channel can be held.
#[derive(Debug)]
pub struct ForceSample<S: Transport>(pub(super) Received<S, ForceRecord, ForceHeader>);

impl<S: Transport> ForceSample<S> {
    /// Header of the message.
    pub fn header(&self) -> &ForceHeader {
        &self.0.header
    }

    /// The forces, in the order of the state they answer.
    pub fn records(&self) -> &[ForceRecord] {
        self.0.records()
    }
}
