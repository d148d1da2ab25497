//! A process's place in the run: its node, its wake-up calls, and who else is there.

use super::awake::Awake;
use super::verdict::{OpenError, PortError, Verdict};
use super::{LinkConfig, LinkError, Transport, claim::process_lives};
use halfstep_wire::Name;
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
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Longest sleep: after this the abort flag is looked at and the peer asked for.
const TICK: Duration = Duration::from_millis(50);
/// Pause between two looks at who has come.
const HANDSHAKE_TICK: Duration = Duration::from_millis(1);

/// What is known about the other processes. Shared with the handlers of full queues.
#[derive(Debug)]
pub(super) struct Watch<S> {
    config: Config,
    nodes: Mutex<Vec<(Name, UniqueNodeId)>>,
    stuck: Mutex<Option<u128>>,
    abort: Option<Arc<AtomicBool>>,
    patience: Duration,
    transport: PhantomData<S>,
}

impl<S: Transport> Watch<S> {
    pub(super) fn aborted(&self) -> bool {
        self.abort.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Remembers the node of a process.
    pub(super) fn met(&self, process: Name, node: UniqueNodeId) {
        let mut nodes = self.nodes();
        if !nodes.iter().any(|(p, _)| *p == process) {
            nodes.push((process, node));
        }
    }

    fn nodes(&self) -> MutexGuard<'_, Vec<(Name, UniqueNodeId)>> {
        self.nodes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The process that owns a node.
    pub(super) fn process_of(&self, node: UniqueNodeId) -> Option<Name> {
        self.nodes().iter().find(|(_, n)| *n == node).map(|(process, _)| *process)
    }

    /// Whether a process that had come has ended. `listed`: a channel of it still names it as its writer.
    pub(super) fn is_gone(&self, process: Name, listed: bool) -> bool {
        match self.state_of(process) {
            None | Some(Ok(Some(NodeState::Alive(_)))) => false,
            Some(Ok(Some(NodeState::Dead(_)))) => true,
            // It has left, or somebody has removed the files that tell of it: the system knows.
            Some(_) => !(S::SHARED_MEMORY && listed && self.is_running(process)),
        }
    }

    fn is_running(&self, process: Name) -> bool {
        let pid = self.node_of(process).and_then(|node| u32::try_from(node.pid::<S>().ok()?.value()).ok());
        pid.is_some_and(process_lives)
    }

    /// Whether a process that had come has ended without leaving.
    fn was_killed(&self, process: Name) -> bool {
        matches!(self.state_of(process), Some(Ok(Some(NodeState::Dead(_)))))
    }

    fn state_of(&self, process: Name) -> Option<Result<Option<NodeState<S>>, NodeListFailure>> {
        self.node_of(process).map(|node| Node::<S>::state_of(&self.config, node))
    }

    fn node_of(&self, process: Name) -> Option<UniqueNodeId> {
        self.nodes().iter().find(|(p, _)| *p == process).map(|(_, node)| *node)
    }

    /// The first of the other processes that has ended.
    fn first_gone(&self) -> Option<Name> {
        let known: Vec<Name> = self.nodes().iter().map(|(process, _)| *process).collect();
        known.into_iter().find(|process| self.is_gone(*process, true))
    }

    /// What a publisher does when a reader's queue is full, which lock-step does not let happen unless that reader has
    /// died or does not read.
    pub(super) fn on_full_queue(&self, info: &BackpressureInfo) -> BackpressureAction {
        std::thread::sleep(HANDSHAKE_TICK);
        let give_up = self.aborted()
            || info.elapsed_time > self.patience
            || (info.retries % 50 == 49 && self.first_gone().is_some());
        if give_up {
            *self.stuck.lock().unwrap_or_else(PoisonError::into_inner) = Some(info.receiver_port_id);
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
        let port = self.stuck.lock().unwrap_or_else(PoisonError::into_inner).take();
        match port.and_then(owner).and_then(|node| self.process_of(node)) {
            Some(peer) => LinkError::Timeout { peer, seconds: self.patience.as_secs_f64() },
            None => LinkError::transport("sending", "a reader's queue is full"),
        }
    }
}

/// Whether a participant has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Presence {
    /// The process has not been seen.
    NotYet,
    /// The process is there, and connected to.
    Here,
    /// The process was there, and connected to, and has left.
    Left,
}

impl Presence {
    /// Of two in one process.
    pub(super) fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::NotYet, _) | (_, Self::NotYet) => Self::NotYet,
            (Self::Left, _) | (_, Self::Left) => Self::Left,
            (Self::Here, Self::Here) => Self::Here,
        }
    }
}

/// Node, listener and notifiers of a process.
#[derive(Debug)]
pub(super) struct Hub<S: Transport> {
    pub(super) process: Name,
    listener: Listener<S>,
    notifiers: Vec<(Name, Notifier<S>)>,
    /// Wake-up services: the own process's first, then its partners'.
    events: Vec<(Name, event::PortFactory<S>)>,
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
        process: Name,
        abort: Option<Arc<AtomicBool>>,
    ) -> Result<Self, LinkError> {
        // Every failure comes back as an error; the transport's own words only on request (IOX2_LOG_LEVEL).
        set_log_level_from_env_or(LogLevel::Fatal);
        let transport = config.transport()?;
        let name = NodeName::new(process.as_str()).map_err(|e| LinkError::transport("naming a node", e))?;
        let node = NodeBuilder::new()
            .name(&name)
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
        let partners = config.partners(process);
        let known = |owner: &Name| *owner == process || partners.contains(owner);
        for owner in config.processes().into_iter().chain([Name::COUPLER]).filter(known) {
            let service = format!("halfstep/{owner}/wake");
            let name = service_name(&service)?;
            let attributes = attributes()?;
            let callers = config.partners(owner).len();
            let factory = open_until(deadline, &watch, process, &service, || {
                node.service_builder(&name)
                    .event()
                    .max_listeners(1)
                    .max_notifiers(callers)
                    .max_nodes(callers + 1)
                    .open_or_create_with_attributes(&attributes)
            })?;
            events.push((owner, factory));
        }
        events.sort_by_key(|(owner, _)| *owner != process);
        let own = &events[0].1;
        let listener = own.listener_builder().create().map_err(|e| port_error(process, "listening", e))?;
        let handshake = config.handshake_seconds;
        Ok(Self {
            process,
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
    pub(super) fn open_service<T, E: OpenError>(
        &self,
        service: &str,
        open: impl FnMut() -> Result<T, E>,
    ) -> Result<T, LinkError> {
        open_until(self.deadline, &self.watch, self.process, service, open)
    }

    /// Waits until everybody is there and connected to everybody; `look` connects to what a partner publishes once that
    /// is there.
    ///
    /// A process makes its notifier for another when it has connected to all that the other publishes. So a process
    /// that finds the notifiers of all partners knows that no message of its own can be lost, even if it sends one and
    /// ends at once. A process that has come and gone was connected before it went.
    pub(super) fn gather(
        &mut self,
        mut look: impl FnMut(Name, &Watch<S>) -> Result<Presence, LinkError>,
    ) -> Result<(), LinkError> {
        let partners: Vec<Name> = self.events[1..].iter().map(|(owner, _)| *owner).collect();
        let mut looked = Instant::now();
        loop {
            let mut missing = Vec::new();
            for process in partners.iter().copied() {
                let presence = look(process, &self.watch)?;
                let notified = self.notifiers.iter().any(|(owner, _)| *owner == process);
                if presence != Presence::NotYet && !notified {
                    self.create_notifier(process)?;
                }
                if presence == Presence::NotYet
                    || (presence == Presence::Here && !self.is_notified_by(process))
                {
                    missing.push(process);
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
                if let Some(peer) = partners.iter().copied().find(|p| self.watch.was_killed(*p)) {
                    return Err(LinkError::PeerDied { peer });
                }
                looked = Instant::now();
            }
            if Instant::now() > self.deadline {
                let seconds = self.handshake;
                return Err(LinkError::HandshakeTimeout { role: self.process, missing, seconds });
            }
            std::thread::sleep(HANDSHAKE_TICK);
        }
    }

    fn create_notifier(&mut self, owner: Name) -> Result<(), LinkError> {
        let service = self.events.iter().find(|(name, _)| *name == owner);
        let Some((_, factory)) = service else {
            return Err(LinkError::Config { key: "process", reason: format!("`{owner}` is no partner") });
        };
        let notifier =
            factory.notifier_builder().create().map_err(|e| port_error(self.process, "notifying", e))?;
        self.notifiers.push((owner, notifier));
        Ok(())
    }

    fn is_notified_by(&self, process: Name) -> bool {
        let mut found = false;
        self.events[0].1.dynamic_config().list_notifiers(|details| {
            found |= self.watch.process_of(details.node_id) == Some(process);
            CallbackProgression::Continue
        });
        found
    }

    /// Wakes a process, or all partners.
    pub(super) fn notify(&mut self, only: Option<Name>) {
        for (process, notifier) in &self.notifiers {
            if only.is_none_or(|wanted| wanted == *process) && !matches!(notifier.notify(), Ok(1..)) {
                self.suspicious = true;
            }
        }
    }

    /// Waits until `receive` finds a message of `peer`, which runs in `process` and is `listed` as the writer of its
    /// channel as long as it has not left: asleep, but for a moment where messages of this channel come at once.
    pub(super) fn wait<T>(
        &mut self,
        peer: Name,
        process: Name,
        awake: &mut Awake,
        listed: impl Fn() -> bool,
        mut receive: impl FnMut() -> Result<Option<T>, LinkError>,
    ) -> Result<T, LinkError> {
        let start = Instant::now();
        let (mut looked, mut stayed) = (start, false);
        loop {
            if self.watch.aborted() {
                return Err(LinkError::Aborted);
            }
            if let Some(message) = receive()? {
                if stayed {
                    awake.learn(start.elapsed());
                }
                return Ok(message);
            }
            if !stayed && let Some(message) = awake.stay(&mut receive)? {
                return Ok(message);
            }
            stayed = true;
            if std::mem::take(&mut self.suspicious) || looked.elapsed() >= TICK {
                if self.watch.is_gone(process, listed()) {
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
pub(super) fn port_error(process: Name, action: &'static str, error: impl PortError) -> LinkError {
    if error.is_taken() {
        LinkError::RoleTaken { role: process }
    } else {
        LinkError::transport(action, error)
    }
}

/// Opening races with others who create, open or remove the same service: what is not final is tried again.
fn open_until<S: Transport, T, E: OpenError>(
    deadline: Instant,
    watch: &Watch<S>,
    process: Name,
    service: &str,
    mut open: impl FnMut() -> Result<T, E>,
) -> Result<T, LinkError> {
    loop {
        let error = match open() {
            Ok(factory) => return Ok(factory),
            Err(error) => error,
        };
        let reason = || format!("{error:?}");
        match error.verdict() {
            Verdict::Incompatible => {
                return Err(LinkError::Incompatible { service: service.into(), reason: reason() });
            }
            Verdict::Taken => return Err(LinkError::RoleTaken { role: process }),
            Verdict::Refused => {
                return Err(LinkError::Transport { action: "opening a channel", reason: reason() });
            }
            Verdict::Race if Instant::now() > deadline => {
                return Err(LinkError::Transport { action: "opening a channel", reason: reason() });
            }
            Verdict::Race => {}
        }
        if watch.aborted() {
            return Err(LinkError::Aborted);
        }
        std::thread::sleep(HANDSHAKE_TICK);
    }
}
