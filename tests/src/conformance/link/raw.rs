//! A role written against the wire as documented, without the link's code: it can send anything.

use halfstep_link::{LinkConfig, Slot, Transport};
use halfstep_wire::protocol::{ForceHeader, ForceRecord, PROTOCOL, Plain, SCHEMA, StateHeader, StateRecord};
use iceoryx2::port::listener::Listener;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::{event, publish_subscribe};
use std::fmt::Debug;
use std::time::{Duration, Instant};

/// The writing end of a channel.
pub type Writer<S, R, H> = Publisher<S, [Slot<R>], Slot<H>>;
/// The reading end of a channel.
pub type Reader<S, R, H> = Subscriber<S, [Slot<R>], Slot<H>>;

/// Node, listener and notifiers of a role.
#[derive(Debug)]
pub struct RawRole<S: Transport> {
    node: Node<S>,
    own: event::PortFactory<S>,
    others: Vec<event::PortFactory<S>>,
    notifiers: Vec<Notifier<S>>,
    _listener: Listener<S>,
    attributes: AttributeVerifier,
}

impl<S: Transport> RawRole<S> {
    /// Enters the run as `role`.
    pub fn enter(config: &LinkConfig, role: &str) -> Self {
        Self::enter_with_schema(config, role, SCHEMA)
    }

    /// Enters the run as `role` with this schema in the channels' attributes.
    pub fn enter_with_schema(config: &LinkConfig, role: &str, schema: u64) -> Self {
        let node = node::<S>(config);
        let mut attributes = AttributeVerifier::new();
        for (key, value) in [("halfstep.schema", schema), ("halfstep.protocol", PROTOCOL.into())] {
            attributes = attributes
                .require(&key.try_into().unwrap(), &value.to_string().as_str().try_into().unwrap())
                .unwrap();
        }
        let wake = ["fluid", "solid", "coupler"].map(|owner| {
            persistently(|| {
                node.service_builder(&format!("halfstep/{owner}/wake").as_str().try_into().unwrap())
                    .event()
                    .max_listeners(1)
                    .max_notifiers(2)
                    .max_nodes(3)
                    .open_or_create_with_attributes(&attributes)
            })
        });
        let (own, others) = wake.into_iter().zip(["fluid", "solid", "coupler"]).fold(
            (None, Vec::new()),
            |(own, mut others), (service, owner)| {
                if owner == role {
                    return (Some(service), others);
                }
                others.push(service);
                (own, others)
            },
        );
        let own = own.unwrap();
        let listener = own.listener_builder().create().unwrap();
        Self { node, own, others, notifiers: Vec::new(), _listener: listener, attributes }
    }

    /// Says that everything is connected, and waits until the others are.
    fn ready(&mut self) {
        self.notifiers = self.others.iter().map(|s| s.notifier_builder().create().unwrap()).collect();
        super::eventually(20.0, "everybody's connections", || {
            self.own.dynamic_config().number_of_notifiers() == 2
        });
    }

    /// Opens a channel, e.g. `fluid/state`, with this number of readers.
    pub fn channel<R: Plain, H: Plain>(
        &self,
        channel: &str,
        readers: usize,
    ) -> publish_subscribe::PortFactory<S, [Slot<R>], Slot<H>> {
        persistently(|| {
            self.node
                .service_builder(&format!("halfstep/{channel}").as_str().try_into().unwrap())
                .publish_subscribe::<[Slot<R>]>()
                .user_header::<Slot<H>>()
                .enable_safe_overflow(false)
                .history_size(0)
                .subscriber_max_buffer_size(2)
                .subscriber_max_borrowed_samples(2)
                .max_publishers(1)
                .max_subscribers(readers)
                .max_nodes(readers + 1)
                .open_or_create_with_attributes(&self.attributes)
        })
    }

    /// Listeners, notifiers and nodes that a wake service of another role has room for, as strings.
    pub fn wake_options(&self, owner: &str) -> [String; 3] {
        let name = format!("halfstep/{owner}/wake");
        let service = self.others.iter().find(|s| s.name().as_str() == name).unwrap();
        let options = service.static_config();
        [options.max_listeners(), options.max_notifiers(), options.max_nodes()].map(|n| n.to_string())
    }

    /// Writes a message and wakes everybody.
    pub fn send<R: Plain, H: Plain>(&self, writer: &Writer<S, R, H>, header: H, records: &[R]) {
        let mut sample = writer.loan_slice_uninit(records.len()).unwrap();
        *sample.user_header_mut() = Slot(header);
        sample.write_from_fn(|k| Slot(records[k])).send().unwrap();
        self.wake();
    }

    /// Wakes everybody.
    pub fn wake(&self) {
        for notifier in &self.notifiers {
            notifier.notify().unwrap();
        }
    }
}

/// A phase with its ports.
#[derive(Debug)]
pub struct RawPhase<S: Transport> {
    /// Writes its states.
    pub state: Writer<S, StateRecord, StateHeader>,
    /// Reads its forces.
    pub forces: Reader<S, ForceRecord, ForceHeader>,
    /// Reads the other's states.
    pub peer: Reader<S, StateRecord, StateHeader>,
    /// The rest of it.
    pub role: RawRole<S>,
}

impl<S: Transport> RawPhase<S> {
    /// Enters with room for this many records, and waits for the others.
    pub fn enter(config: &LinkConfig, role: &str, capacity: usize) -> Self {
        let mut raw = RawRole::<S>::enter(config, role);
        let other = if role == "fluid" { "solid" } else { "fluid" };
        let peer_service = raw.channel(&format!("{other}/state"), 2);
        let peer = peer_service.subscriber_builder().create().unwrap();
        let force_service = raw.channel(&format!("{role}/force"), 1);
        let forces = force_service.subscriber_builder().create().unwrap();
        let service = raw.channel::<StateRecord, StateHeader>(&format!("{role}/state"), 2);
        let state = service.publisher_builder().initial_max_slice_len(capacity).create().unwrap();
        super::eventually(20.0, "everybody's start", || {
            service.dynamic_config().number_of_subscribers() == 2
                && peer_service.dynamic_config().number_of_publishers() == 1
                && force_service.dynamic_config().number_of_publishers() == 1
        });
        state.update_connections().unwrap();
        peer.update_connections().unwrap();
        forces.update_connections().unwrap();
        raw.ready();
        Self { state, forces, peer, role: raw }
    }

    /// Sends a state as it is.
    pub fn send(&self, header: StateHeader, records: &[StateRecord]) {
        self.role.send(&self.state, header, records);
    }
}

/// The coupler with its ports.
#[derive(Debug)]
pub struct RawCoupler<S: Transport> {
    /// Writes forces: fluid, solid.
    pub forces: [Writer<S, ForceRecord, ForceHeader>; 2],
    /// Reads states: fluid, solid.
    pub states: [Reader<S, StateRecord, StateHeader>; 2],
    /// The rest of it.
    pub role: RawRole<S>,
}

impl<S: Transport> RawCoupler<S> {
    /// Enters and waits for both phases.
    pub fn enter(config: &LinkConfig) -> Self {
        let mut raw = RawRole::<S>::enter(config, "coupler");
        let state_services = ["fluid", "solid"].map(|role| raw.channel(&format!("{role}/state"), 2));
        let states = state_services.each_ref().map(|s| s.subscriber_builder().create().unwrap());
        let services = ["fluid", "solid"]
            .map(|role| raw.channel::<ForceRecord, ForceHeader>(&format!("{role}/force"), 1));
        let forces =
            services.each_ref().map(|s| s.publisher_builder().initial_max_slice_len(1000).create().unwrap());
        super::eventually(20.0, "everybody's start", || {
            services.iter().all(|s| s.dynamic_config().number_of_subscribers() == 1)
                && state_services.iter().all(|s| s.dynamic_config().number_of_publishers() == 1)
        });
        states.iter().for_each(|port| port.update_connections().unwrap());
        forces.iter().for_each(|port| port.update_connections().unwrap());
        raw.ready();
        Self { forces, states, role: raw }
    }
}

/// Fills in what identifies a run.
pub fn identified(config: &LinkConfig, header: StateHeader, count: usize) -> StateHeader {
    StateHeader { run_id: config.run_id, protocol: PROTOCOL, schema: SCHEMA, count: count as u32, ..header }
}

/// Fills in what identifies a run.
pub fn identified_force(config: &LinkConfig, header: ForceHeader, count: usize) -> ForceHeader {
    ForceHeader { run_id: config.run_id, protocol: PROTOCOL, schema: SCHEMA, count: count as u32, ..header }
}

/// A node whose objects are those of the run.
pub fn node<S: Transport>(config: &LinkConfig) -> Node<S> {
    let mut transport = Config::default();
    transport.global.prefix = FileName::new(config.prefix.as_bytes()).unwrap();
    transport.global.set_root_path(&Path::new(config.root.to_str().unwrap().as_bytes()).unwrap());
    NodeBuilder::new()
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .config(&transport)
        .create::<S>()
        .unwrap()
}

/// Opening races with others who open the same service.
pub fn persistently<T, E: Debug>(mut open: impl FnMut() -> Result<T, E>) -> T {
    let deadline = Instant::now() + Duration::from_secs(20);
    loop {
        match open() {
            Ok(service) => return service,
            Err(error) => assert!(Instant::now() < deadline, "{error:?}"),
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}
