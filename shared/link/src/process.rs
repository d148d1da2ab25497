//! The end of the exchange that a process of participants holds.

use super::answer::take_forces;
use super::channel::{Channel, Incoming, Outgoing};
use super::check::{Expect, Identities, StateCheck};
use super::hub::{Hub, Presence};
use super::{Claim, LinkConfig, LinkError, LinkTimes, Port, StateMessage, Transport, memory};
use halfstep_wire::Name;
use halfstep_wire::protocol::{
    ForceHeader, ForceRecord, PROTOCOL, ProbeHeader, SCHEMA, StateHeader, StateRecord, status,
};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Publishes the states of a process's participants, reads their peers' and receives the coupler's forces.
///
/// Use it in the thread that opened it.
#[derive(Debug)]
pub struct ProcessLink<S: Transport> {
    members: Vec<Member<S>>,
    participants: Vec<Name>,
    run_id: u64,
    times: LinkTimes,
    hub: Hub<S>,
    // Last: goes when the transport's own files have gone.
    _claim: Claim,
}

#[derive(Debug)]
struct Member<S: Transport> {
    name: Name,
    state: Outgoing<S, StateRecord, StateHeader>,
    probes: Option<Outgoing<S, f64, ProbeHeader>>,
    peers: Vec<(Incoming<S, StateRecord, StateHeader>, StateCheck)>,
    peer_names: Vec<Name>,
    forces: Incoming<S, ForceRecord, ForceHeader>,
    sent: Identities,
}

impl<S: Transport> Member<S> {
    fn open(hub: &Hub<S>, config: &LinkConfig, place: usize) -> Result<Self, LinkError> {
        let participant = &config.participants[place];
        let peer = |other: usize| {
            let sender = &config.participants[other];
            let state = Channel::state(hub, config, other)?.reader(hub, sender.name, sender.process)?;
            Ok((state, StateCheck::new(config, other)))
        };
        // Publishers last: whoever sees one knows that the subscribers are there.
        let peers = config.peers(place).into_iter().map(peer).collect::<Result<Vec<_>, LinkError>>()?;
        let forces = Channel::forces(hub, config, place)?.reader(hub, Name::COUPLER, Name::COUPLER)?;
        let probes = match participant.probes {
            0 => None,
            _ => Some(Channel::probes(hub, config, place)?.writer(hub)?),
        };
        Ok(Self {
            name: participant.name,
            peer_names: peers.iter().map(|(state, _)| state.sender).collect(),
            peers,
            forces,
            probes,
            sent: Identities::new(participant.capacity),
            state: Channel::state(hub, config, place)?.writer(hub)?,
        })
    }
}

impl<S: Transport> ProcessLink<S> {
    /// Creates the ports of all participants of `process` and waits until all others are connected.
    ///
    /// Setting `abort` ends this and every later wait with [`LinkError::Aborted`] within 50 ms.
    ///
    /// # Errors
    /// The process has no participants, somebody does not come in time or means something else.
    pub fn open(
        config: &LinkConfig,
        process: Name,
        abort: Option<Arc<AtomicBool>>,
    ) -> Result<Self, LinkError> {
        let places = config.members(process);
        if places.is_empty() {
            return Err(LinkError::Config {
                key: "process",
                reason: format!("no participant runs in `{process}`"),
            });
        }
        let claim = Claim::new(config)?;
        memory::check_room::<S>(config, process)?;
        let mut hub = Hub::<S>::open(config, process, abort)?;
        let members = places.into_iter().map(|place| Member::open(&hub, config, place));
        let mut members = members.collect::<Result<Vec<_>, LinkError>>()?;
        hub.gather(|other, watch| {
            let mut all = Presence::Here;
            for member in &mut members {
                if other == Name::COUPLER {
                    all = all.and(member.forces.meet_sender(watch)?);
                }
                for (state, _) in member.peers.iter_mut().filter(|(state, _)| state.process == other) {
                    all = all.and(state.meet_sender(watch)?);
                }
            }
            Ok(all)
        })?;
        for member in &members {
            member.state.connect()?;
            member.probes.iter().try_for_each(Outgoing::connect)?;
        }
        memory::reserve::<S>(config)?;
        Ok(Self {
            members,
            participants: config.names(),
            run_id: config.run_id,
            times: LinkTimes::default(),
            hub,
            _claim: claim,
        })
    }

    /// Names of the process's participants, in order.
    pub fn members(&self) -> Vec<Name> {
        self.members.iter().map(|member| member.name).collect()
    }

    /// Publishes a state, each record written once, straight to where its readers find it.
    ///
    /// # Errors
    /// As for [`Port::send_state`].
    pub fn send_state_from(
        &mut self,
        member: usize,
        header: &StateHeader,
        count: usize,
        mut record: impl FnMut(usize) -> StateRecord,
    ) -> Result<(), LinkError> {
        self.publish(member, header, count, |state, hub, header, fresh| match fresh {
            None => state.send(hub, header, count, record),
            Some(sent) => state.send(hub, header, count, |slot| {
                let record = record(slot);
                sent.push(record.id);
                record
            }),
        })
    }

    /// Publishes a state of so many particles; what sends it notes their numbers where they are new.
    fn publish(
        &mut self,
        member: usize,
        header: &StateHeader,
        count: usize,
        send: impl FnOnce(
            &mut Outgoing<S, StateRecord, StateHeader>,
            &Hub<S>,
            &StateHeader,
            Option<&mut Identities>,
        ) -> Result<(), LinkError>,
    ) -> Result<(), LinkError> {
        let start = Instant::now();
        let Member { state, sent, .. } = &mut self.members[member];
        state.check_capacity(count)?;
        let header = StateHeader {
            run_id: self.run_id,
            protocol: PROTOCOL,
            schema: SCHEMA,
            count: count as u32,
            ..*header
        };
        let known = header.status != status::OK || sent.is_current(header.epoch, count);
        if !known {
            sent.begin(header.epoch);
        }
        send(state, &self.hub, &header, (!known).then_some(sent))?;
        self.hub.notify(None);
        self.times.exchange += start.elapsed();
        Ok(())
    }
}

impl<S: Transport> Port for ProcessLink<S> {
    fn send_state(
        &mut self,
        member: usize,
        header: &StateHeader,
        records: &[StateRecord],
    ) -> Result<(), LinkError> {
        self.publish(member, header, records.len(), |state, hub, header, fresh| {
            if let Some(sent) = fresh {
                records.iter().for_each(|record| sent.push(record.id));
            }
            state.send_all(hub, header, records)
        })
    }

    fn receive_peer(
        &mut self,
        member: usize,
        peer: usize,
        expect: &Expect,
        records: &mut Vec<StateRecord>,
    ) -> Result<StateHeader, LinkError> {
        let start = Instant::now();
        let (state, check) = &mut self.members[member].peers[peer];
        let sample = state.receive(&mut self.hub);
        let arrival = Instant::now();
        self.times.wait += arrival - start;
        let sample = super::StateSample(sample?);
        check.take(sample.header(), sample.records(), expect, records)?;
        self.times.exchange += arrival.elapsed();
        Ok(*sample.header())
    }

    fn receive_forces(
        &mut self,
        member: usize,
        expect: &Expect,
        records: &mut Vec<ForceRecord>,
    ) -> Result<ForceHeader, LinkError> {
        let start = Instant::now();
        let Member { forces, sent, .. } = &mut self.members[member];
        let sample = forces.receive(&mut self.hub);
        let arrival = Instant::now();
        self.times.wait += arrival - start;
        let sample = super::ForceSample(sample?);
        take_forces(self.run_id, sent, sample.header(), sample.records(), expect, records)?;
        self.times.exchange += arrival.elapsed();
        Ok(*sample.header())
    }

    fn send_probes(&mut self, member: usize, step: u64, time: f64, values: &[f64]) -> Result<(), LinkError> {
        let start = Instant::now();
        let Some(probes) = &mut self.members[member].probes else { return Ok(()) };
        let header = ProbeHeader {
            run_id: self.run_id,
            protocol: PROTOCOL,
            schema: SCHEMA,
            count: values.len() as u32,
            step,
            time,
        };
        probes.send(&self.hub, &header, values.len(), |slot| values[slot])?;
        self.hub.notify(Some(Name::COUPLER));
        self.times.exchange += start.elapsed();
        Ok(())
    }

    fn peers(&self, member: usize) -> &[Name] {
        &self.members[member].peer_names
    }

    fn participants(&self) -> &[Name] {
        &self.participants
    }

    fn times(&self) -> LinkTimes {
        self.times
    }
}
