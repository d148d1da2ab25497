//! The coupler's end of the exchange.

use super::channel::{Channel, Incoming, Outgoing, ProbeSample, StateSample};
use super::check::{Expect, StateCheck, verify_probes};
use super::hub::{Hub, Presence};
use super::{
    Claim, CouplerPort, LinkConfig, LinkError, LinkTimes, Participant, StateMessage, Transport, memory,
};
use halfstep_wire::Name;
use halfstep_wire::protocol::{
    ForceHeader, ForceRecord, PROTOCOL, ProbeHeader, SCHEMA, StateHeader, StateRecord,
};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// What the coupler holds toward one participant.
#[derive(Debug)]
struct Partner<S: Transport> {
    participant: Participant,
    forces: Outgoing<S, ForceRecord, ForceHeader>,
    state: Incoming<S, StateRecord, StateHeader>,
    probes: Option<Incoming<S, f64, ProbeHeader>>,
    check: StateCheck,
}

impl<S: Transport> Partner<S> {
    fn open(hub: &Hub<S>, config: &LinkConfig, place: usize) -> Result<Self, LinkError> {
        let participant = config.participants[place];
        let Participant { name, process, .. } = participant;
        let state = Channel::state(hub, config, place)?.reader(hub, name, process)?;
        let probes = match participant.probes {
            0 => None,
            _ => Some(Channel::probes(hub, config, place)?.reader(hub, name, process)?),
        };
        let forces = Channel::forces(hub, config, place)?.writer(hub)?;
        Ok(Self { participant, forces, state, probes, check: StateCheck::new(config, place) })
    }
}

/// Reads the states of all participants and answers them. Participants are named by their place in the run.
///
/// Use it in the thread that opened it. Start child processes before: a process must not fork once it has a link.
#[derive(Debug)]
pub struct CouplerLink<S: Transport> {
    partners: Vec<Partner<S>>,
    run_id: u64,
    times: LinkTimes,
    hub: Hub<S>,
    // Last: goes when the transport's own files have gone.
    _claim: Claim,
}

impl<S: Transport> CouplerLink<S> {
    /// Creates the coupler's ports and waits until all participants are connected.
    ///
    /// Setting `abort` ends this and every later wait with [`LinkError::Aborted`] within 50 ms.
    pub fn open(config: &LinkConfig, abort: Option<Arc<AtomicBool>>) -> Result<Self, LinkError> {
        let claim = Claim::new(config)?;
        memory::check_room::<S>(config, Name::COUPLER)?;
        let mut hub = Hub::<S>::open(config, Name::COUPLER, abort)?;
        let partners = (0..config.participants.len()).map(|place| Partner::open(&hub, config, place));
        let mut partners = partners.collect::<Result<Vec<_>, LinkError>>()?;
        hub.gather(|other, watch| {
            let mut all = Presence::Here;
            for side in partners.iter_mut().filter(|side| side.participant.process == other) {
                all = all.and(side.state.meet_sender(watch)?);
                // The probes' channel is made before the state's: one that is not there never comes.
                if let Some(probes) = &mut side.probes {
                    probes.meet_sender(watch)?;
                }
            }
            Ok(all)
        })?;
        for side in &partners {
            side.forces.connect()?;
        }
        memory::reserve::<S>(config)?;
        Ok(Self { partners, run_id: config.run_id, times: LinkTimes::default(), hub, _claim: claim })
    }
}

impl<S: Transport> CouplerPort for CouplerLink<S> {
    type State = StateSample<S>;

    fn participants(&self) -> usize {
        self.partners.len()
    }

    fn name(&self, place: usize) -> Name {
        self.partners[place].participant.name
    }

    fn receive_state(&mut self, place: usize, expect: &Expect) -> Result<StateSample<S>, LinkError> {
        let start = Instant::now();
        let side = &mut self.partners[place];
        let sample = side.state.receive(&mut self.hub);
        let arrival = Instant::now();
        self.times.wait += arrival - start;
        let sample = StateSample(sample?);
        side.check.verify(sample.header(), sample.records(), expect)?;
        self.times.exchange += arrival.elapsed();
        Ok(sample)
    }

    fn receive_probes(&mut self, place: usize, step: u64, values: &mut Vec<f64>) -> Result<(), LinkError> {
        let start = Instant::now();
        let Partner { participant, probes, .. } = &mut self.partners[place];
        let Some(probes) = probes else { return Ok(()) };
        let sample = probes.receive(&mut self.hub);
        let arrival = Instant::now();
        self.times.wait += arrival - start;
        let sample = ProbeSample(sample?);
        verify_probes(self.run_id, participant, sample.header(), sample.values(), step)?;
        values.extend_from_slice(sample.values());
        self.times.exchange += arrival.elapsed();
        Ok(())
    }

    fn send_forces(
        &mut self,
        place: usize,
        header: &ForceHeader,
        records: &[ForceRecord],
    ) -> Result<(), LinkError> {
        let start = Instant::now();
        let header = ForceHeader {
            run_id: self.run_id,
            protocol: PROTOCOL,
            schema: SCHEMA,
            count: records.len() as u32,
            ..*header
        };
        let side = &mut self.partners[place];
        side.forces.send_all(&self.hub, &header, records)?;
        self.hub.notify(Some(side.participant.process));
        self.times.exchange += start.elapsed();
        Ok(())
    }

    fn times(&self) -> LinkTimes {
        self.times
    }
}
