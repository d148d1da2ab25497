//! The fluid's or the solid's end of the exchange.

use super::channel::{Channel, ForceSample, Incoming, Outgoing, StateSample};
use super::check::{Expect, Identities, StateCheck, verify_forces};
use super::hub::Hub;
use super::{Claim, LinkConfig, LinkError, LinkTimes, Transport, memory};
use halfstep_wire::failure::RoleName;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, PROTOCOL, SCHEMA, StateHeader, StateRecord, status};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Publishes a phase's states, reads the other phase's and receives the coupler's forces.
///
/// Use it in the thread that opened it.
#[derive(Debug)]
pub struct PhaseLink<S: Transport> {
    state: Outgoing<S, StateRecord, StateHeader>,
    peer: Incoming<S, StateRecord, StateHeader>,
    forces: Incoming<S, ForceRecord, ForceHeader>,
    peer_check: StateCheck,
    sent: Identities,
    run_id: u64,
    times: LinkTimes,
    hub: Hub<S>,
    // Last: goes when the transport's own files have gone.
    _claim: Claim,
}

impl<S: Transport> PhaseLink<S> {
    /// Creates the ports of `role` (fluid or solid) and waits until the other phase and the coupler are connected.
    ///
    /// Setting `abort` ends this and every later wait with [`LinkError::Aborted`] within 50 ms.
    pub fn open(
        config: &LinkConfig,
        role: RoleName,
        abort: Option<Arc<AtomicBool>>,
    ) -> Result<Self, LinkError> {
        if role == RoleName::Coupler {
            return Err(LinkError::Config { key: "role", reason: "the coupler is no phase".into() });
        }
        let claim = Claim::new(config)?;
        memory::check_room::<S>(config, role)?;
        let mut hub = Hub::<S>::open(config, role, abort)?;
        // Publisher last: whoever sees it knows that the subscribers are there.
        let peer = Channel::state(&hub, config, role.peer())?.reader(&hub, role.peer())?;
        let forces = Channel::forces(&hub, config, role)?.reader(&hub, RoleName::Coupler)?;
        let state = Channel::state(&hub, config, role)?.writer(&hub)?;
        hub.gather(|other, watch| match other {
            RoleName::Coupler => forces.meet_sender(watch),
            _ => peer.meet_sender(watch),
        })?;
        state.connect()?;
        memory::reserve::<S>(config)?;
        Ok(Self {
            state,
            peer,
            forces,
            peer_check: StateCheck::new(config, role.peer()),
            sent: Identities::new(config.capacity(role)),
            run_id: config.run_id,
            times: LinkTimes::default(),
            hub,
            _claim: claim,
        })
    }

    /// The own role.
    pub fn role(&self) -> RoleName {
        self.hub.role
    }

    /// Publishes the own state. Run id, protocol, schema and count of the header are filled in here.
    pub fn send_state(&mut self, header: &StateHeader, records: &[StateRecord]) -> Result<(), LinkError> {
        self.send_state_from(header, records.len(), |slot| records[slot])
    }

    /// Publishes the own state, each record written once, straight to where its readers find it.
    pub fn send_state_from(
        &mut self,
        header: &StateHeader,
        count: usize,
        mut record: impl FnMut(usize) -> StateRecord,
    ) -> Result<(), LinkError> {
        let start = Instant::now();
        self.state.check_capacity(count)?;
        let header = StateHeader {
            run_id: self.run_id,
            protocol: PROTOCOL,
            schema: SCHEMA,
            count: count as u32,
            ..*header
        };
        let sent = &mut self.sent;
        let result = if header.status != status::OK || sent.is_current(header.epoch, count) {
            self.state.send(&self.hub, &header, count, record)
        } else {
            sent.begin(header.epoch);
            self.state.send(&self.hub, &header, count, |slot| {
                let record = record(slot);
                sent.push(record.id);
                record
            })
        };
        result?;
        self.hub.notify(None);
        self.times.exchange += start.elapsed();
        Ok(())
    }

    /// The other phase's state of this step and stage; sleeps until it is there.
    ///
    /// A message with another status than ok is returned as it is: look at the status first.
    pub fn receive_peer(&mut self, expect: &Expect) -> Result<StateSample<S>, LinkError> {
        let start = Instant::now();
        let sample = self.peer.receive(&mut self.hub);
        let arrival = Instant::now();
        self.times.wait += arrival - start;
        let sample = StateSample(sample?);
        self.peer_check.verify(sample.header(), sample.records(), expect)?;
        self.times.exchange += arrival.elapsed();
        Ok(sample)
    }

    /// The coupler's answer to the state of this step and stage; sleeps until it is there.
    ///
    /// With the order to stop it may carry no records.
    pub fn receive_forces(&mut self, expect: &Expect) -> Result<ForceSample<S>, LinkError> {
        let start = Instant::now();
        let sample = self.forces.receive(&mut self.hub);
        let arrival = Instant::now();
        self.times.wait += arrival - start;
        let sample = ForceSample(sample?);
        verify_forces(self.run_id, &self.sent, sample.header(), sample.records(), expect)?;
        self.times.exchange += arrival.elapsed();
        Ok(sample)
    }

    /// Where the time went since the link was opened.
    pub fn times(&self) -> LinkTimes {
        self.times
    }
}
