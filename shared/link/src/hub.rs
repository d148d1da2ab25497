//! A role's place in the run: its node, its wake-up calls, and who else is there.

use super::{LinkConfig, LinkError, Transport};
use halfstep_wire::failure::RoleName;
use halfstep_wire::protocol::{PROTOCOL, SCHEMA};
use iceoryx2::identifiers::UniqueNodeId;
use iceoryx2::node::NodeListFailure;
use iceoryx2::port::listener::Listener;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::{BackpressureAction, BackpressureInfo};
use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::event;
use std::fmt::Debug;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Longest sleep: after this the abort flag is looked at and the peer asked for.
const TICK: Duration = Duration::from_millis(50);
/// Pause between two looks at who has come.
const HANDSHAKE_TICK: Duration = Duration::from_millis(1);
const ROLES: [RoleName; 3] = [RoleName::Fluid, RoleName::Solid, RoleName::Coupler];

/// What is known about the other roles. Shared with the handlers of full queues.
#[derive(Debug)]
pub(super) struct Watch<S> {
    config: Config,
    nodes: Mutex<Vec<(RoleName, UniqueNodeId)>>,
    stuck: Mutex<Option<u128>>,
    abort: Option<Arc<AtomicBool>>,
    patience: Duration,
    transport: PhantomData<S>,
}

impl<S: Transport> Watch<S> {
    pub(super) fn aborted(&self) -> bool {
        self.abort.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Remembers the node of a role.
    pub(super) fn met(&self, role: RoleName, node: UniqueNodeId) {
        self.nodes.lock().expect("no panic inside").push((role, node));
    }

    /// Whether the role has come.
    pub(super) fn has_met(&self, role: RoleName) -> bool {
        self.nodes.lock().expect("no panic inside").iter().any(|(r, _)| *r == role)
    }

    /// The role that owns a node.
    pub(super) fn role_of(&self, node: UniqueNodeId) -> Option<RoleName> {
        self.nodes.lock().expect("no panic inside").iter().find(|(_, n)| *n == node).map(|(r, _)| *r)
    }

    /// Whether a role that had come has ended.
    pub(super) fn is_gone(&self, role: RoleName) -> bool {
        matches!(self.state_of(role), Some(Ok(None | Some(NodeState::Dead(_)))))
    }

    /// Whether a role that had come has ended without leaving.
    fn was_killed(&self, role: RoleName) -> bool {
        matches!(self.state_of(role), Some(Ok(Some(NodeState::Dead(_)))))
    }

    fn state_of(&self, role: RoleName) -> Option<Result<Option<NodeState<S>>, NodeListFailure>> {
        let node =
            self.nodes.lock().expect("no panic inside").iter().find(|(r, _)| *r == role).map(|(_, n)| *n);
        node.map(|node| Node::<S>::state_of(&self.config, node))
    }

    /// The first of the other roles that has ended.
    fn first_gone(&self) -> Option<RoleName> {
        ROLES.into_iter().find(|role| self.is_gone(*role))
    }

    /// What a publisher does when a reader's queue is full, which lock-step does not let happen unless that reader has
    /// died or does not read.
    pub(super) fn on_full_queue(&self, info: &BackpressureInfo) -> BackpressureAction {
        std::thread::sleep(HANDSHAKE_TICK);
        let give_up = self.aborted()
            || info.elapsed_time > self.patience
            || (info.retries % 50 == 49 && self.first_gone().is_some());
        if give_up {
            *self.stuck.lock().expect("no panic inside") = Some(info.receiver_port_id);
            BackpressureAction::DiscardDataAndFail
        } else {
            BackpressureAction::Retry
        }
    }

    /// Why a message was not delivered; `owner` finds the node of a port.
    pub(super) fn undelivered(&self, owner: impl Fn(u128) -> Option<UniqueNodeId>) -> LinkError {
        if self.aborted() {
            return LinkError::Aborted;
        }
        if let Some(peer) = self.first_gone() {
            return LinkError::PeerDied { peer };
        }
        let port = self.stuck.lock().expect("no panic inside").take();
        match port.and_then(owner).and_then(|node| self.role_of(node)) {
            Some(peer) => LinkError::Timeout { peer, seconds: self.patience.as_secs_f64() },
            None => LinkError::transport("sending", "a reader's queue is full"),
        }
    }
}

/// Whether a role has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Presence {
    /// It has not been seen.
    NotYet,
    /// It is there, and connected to.
    Here,
    /// It was there, and connected to, and has left.
    Left,
}

/// Node, listener and notifiers of a role.
#[derive(Debug)]
pub(super) struct Hub<S: Transport> {
    pub(super) role: RoleName,
    listener: Listener<S>,
    notifiers: Vec<(RoleName, Notifier<S>)>,
    events: Vec<(RoleName, event::PortFactory<S>)>,
    pub(super) watch: Arc<Watch<S>>,
    pub(super) node: Node<S>,
    /// A wake-up call reached nobody: look after the peers before the next sleep.
    suspicious: bool,
    deadline: Instant,
    handshake: f64,
}

impl<S: Transport> Hub<S> {
    /// Enters the run: creates the node and the listener. Notifiers follow in [`Self::gather`].
    pub(super) fn open(
        config: &LinkConfig,
        role: RoleName,
        abort: Option<Arc<AtomicBool>>,
    ) -> Result<Self, LinkError> {
        // Every failure comes back as an error; the transport's own words only on request (IOX2_LOG_LEVEL).
        set_log_level_from_env_or(LogLevel::Fatal);
        let transport = config.transport()?;
        let name = role.to_string();
        let node = NodeBuilder::new()
            .name(&NodeName::new(&name).map_err(|e| LinkError::transport("naming a node", e))?)
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .config(&transport)
            .create::<S>()
            .map_err(|e| LinkError::transport("entering the run", e))?;
        let watch = Arc::new(Watch {
            config: transport,
            nodes: Mutex::default(),
            stuck: Mutex::default(),
            abort,
            patience: Duration::from_secs_f64(config.patience_seconds),
            transport: PhantomData,
        });
        let deadline = Instant::now() + Duration::from_secs_f64(config.handshake_seconds);
        let mut events = Vec::new();
        for owner in ROLES {
            let service = format!("halfstep/{owner}/wake");
            let name = service_name(&service)?;
            let attributes = attributes()?;
            let factory = open_until(deadline, &watch, role, &service, || {
                node.service_builder(&name)
                    .event()
                    .max_listeners(1)
                    .max_notifiers(2)
                    .max_nodes(3)
                    .open_or_create_with_attributes(&attributes)
            })?;
            events.push((owner, factory));
        }
        let own = &events.iter().find(|(owner, _)| *owner == role).expect("all roles are there").1;
        let listener = own.listener_builder().create().map_err(|e| port_error(role, "listening", e))?;
        let handshake = config.handshake_seconds;
        Ok(Self {
            role,
            listener,
            notifiers: Vec::new(),
            events,
            watch,
            node,
            suspicious: false,
            deadline,
            handshake,
        })
    }

    /// Opens a channel, whoever comes first, or says why not.
    pub(super) fn open_service<T, E: Debug>(
        &self,
        service: &str,
        open: impl FnMut() -> Result<T, E>,
    ) -> Result<T, LinkError> {
        open_until(self.deadline, &self.watch, self.role, service, open)
    }

    /// Waits until everybody is there and connected to everybody; `look` connects to a role once it has come.
    ///
    /// A role makes its notifier for another when it has connected to all that the other publishes. So a role that
    /// finds the notifiers of both others knows that no message of its own can be lost, even if it sends one and ends
    /// at once. A role that has come and gone was connected before it went.
    pub(super) fn gather(
        &mut self,
        mut look: impl FnMut(RoleName, &Watch<S>) -> Result<Presence, LinkError>,
    ) -> Result<(), LinkError> {
        let others: Vec<RoleName> = ROLES.into_iter().filter(|role| *role != self.role).collect();
        let mut looked = Instant::now();
        loop {
            let mut missing = Vec::new();
            for role in others.iter().copied() {
                let presence = look(role, &self.watch)?;
                if presence != Presence::NotYet && !self.notifiers.iter().any(|(owner, _)| *owner == role) {
                    self.create_notifier(role)?;
                }
                if presence == Presence::NotYet || (presence == Presence::Here && !self.is_notified_by(role))
                {
                    missing.push(role);
                }
            }
            if missing.is_empty() {
                return Ok(());
            }
            if self.watch.aborted() {
                return Err(LinkError::Aborted);
            }
            if looked.elapsed() > TICK {
                // One that left on its own has left a message that says why.
                if let Some(peer) = others.iter().copied().find(|role| self.watch.was_killed(*role)) {
                    return Err(LinkError::PeerDied { peer });
                }
                looked = Instant::now();
            }
            if Instant::now() > self.deadline {
                let seconds = self.handshake;
                return Err(LinkError::HandshakeTimeout { role: self.role, missing, seconds });
            }
            std::thread::sleep(HANDSHAKE_TICK);
        }
    }

    fn wake_service(&self, owner: RoleName) -> &event::PortFactory<S> {
        &self.events.iter().find(|(role, _)| *role == owner).expect("all roles are there").1
    }

    fn create_notifier(&mut self, owner: RoleName) -> Result<(), LinkError> {
        let builder = self.wake_service(owner).notifier_builder();
        let notifier = builder.create().map_err(|e| port_error(self.role, "notifying", e))?;
        self.notifiers.push((owner, notifier));
        Ok(())
    }

    fn is_notified_by(&self, role: RoleName) -> bool {
        let mut found = false;
        self.wake_service(self.role).dynamic_config().list_notifiers(|details| {
            found |= self.watch.role_of(details.node_id) == Some(role);
            CallbackProgression::Continue
        });
        found
    }

    /// Wakes a role, or all others.
    pub(super) fn notify(&mut self, only: Option<RoleName>) {
        for (role, notifier) in &self.notifiers {
            if only.is_none_or(|wanted| wanted == *role) && !matches!(notifier.notify(), Ok(1..)) {
                self.suspicious = true;
            }
        }
    }

    /// Sleeps until `receive` finds a message of `peer`.
    pub(super) fn wait<T>(
        &mut self,
        peer: RoleName,
        mut receive: impl FnMut() -> Result<Option<T>, LinkError>,
    ) -> Result<T, LinkError> {
        let start = Instant::now();
        let mut looked = start;
        loop {
            if self.watch.aborted() {
                return Err(LinkError::Aborted);
            }
            if let Some(message) = receive()? {
                return Ok(message);
            }
            if std::mem::take(&mut self.suspicious) || looked.elapsed() >= TICK {
                if self.watch.is_gone(peer) {
                    // What it sent before it ended is still readable.
                    return receive()?.ok_or(LinkError::PeerDied { peer });
                }
                looked = Instant::now();
            }
            if start.elapsed() > self.watch.patience {
                return Err(LinkError::Timeout { peer, seconds: self.watch.patience.as_secs_f64() });
            }
            // A signal ends the sleep early; so does a call that another message has already answered.
            let _ = self.listener.timed_wait(|_| {}, TICK);
        }
    }
}

/// The attributes by which both ends of a channel know that they mean the same bytes.
pub(super) fn attributes() -> Result<AttributeVerifier, LinkError> {
    let failed = |e| LinkError::transport("attributes of a channel", e);
    let pair = |key: &str, value: String| {
        Ok::<_, SemanticStringError>((key.try_into()?, value.as_str().try_into()?))
    };
    let mut verifier = AttributeVerifier::new();
    for (key, value) in [("halfstep.schema", SCHEMA.to_string()), ("halfstep.protocol", PROTOCOL.to_string())]
    {
        let (key, value) =
            pair(key, value).map_err(|e| LinkError::transport("attributes of a channel", e))?;
        verifier = verifier.require(&key, &value).map_err(failed)?;
    }
    Ok(verifier)
}

pub(super) fn service_name(name: &str) -> Result<ServiceName, LinkError> {
    name.try_into().map_err(|e| LinkError::transport("naming a channel", e))
}

/// A port could not be made: usually somebody else has it.
pub(super) fn port_error(role: RoleName, action: &'static str, error: impl Debug) -> LinkError {
    if format!("{error:?}").starts_with("ExceedsMax") {
        LinkError::RoleTaken { role }
    } else {
        LinkError::transport(action, error)
    }
}

/// Opening races with others who create, open or remove the same service: what is not final is tried again.
fn open_until<S: Transport, T, E: Debug>(
    deadline: Instant,
    watch: &Watch<S>,
    role: RoleName,
    service: &str,
    mut open: impl FnMut() -> Result<T, E>,
) -> Result<T, LinkError> {
    loop {
        let error = match open() {
            Ok(factory) => return Ok(factory),
            Err(error) => format!("{error:?}"),
        };
        // The transport has one error enumeration for each kind of service; the names of the variants are common.
        if ["Incompatible", "DoesNotSupport", "VersionMismatch"].iter().any(|word| error.contains(word)) {
            return Err(LinkError::Incompatible { service: service.into(), reason: error });
        }
        if error.contains("ExceedsMaxNumberOfNodes") {
            return Err(LinkError::RoleTaken { role });
        }
        if error.contains("InsufficientPermissions") || Instant::now() > deadline {
            return Err(LinkError::Transport { action: "opening a channel", reason: error });
        }
        if watch.aborted() {
            return Err(LinkError::Aborted);
        }
        std::thread::sleep(HANDSHAKE_TICK);
    }
}
