//! The coupler's end of the exchange.

use super::channel::{Channel, Incoming, Outgoing, StateSample};
use super::check::{Expect, StateCheck};
use super::hub::Hub;
use super::{Claim, LinkConfig, LinkError, LinkTimes, Transport, memory};
use halfstep_wire::failure::RoleName;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, PROTOCOL, SCHEMA, StateHeader, StateRecord};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// What the coupler holds toward one phase.
#[derive(Debug)]
struct Side<S: Transport> {
    forces: Outgoing<S, ForceRecord, ForceHeader>,
    state: Incoming<S, StateRecord, StateHeader>,
    check: StateCheck,
}

/// Reads both phases' states and answers them.
///
/// Use it in the thread that opened it. Start child processes before: a process must not fork once it has a link.
#[derive(Debug)]
pub struct CouplerLink<S: Transport> {
    fluid: Side<S>,
    solid: Side<S>,
    run_id: u64,
    times: LinkTimes,
    hub: Hub<S>,
    // Last: goes when the transport's own files have gone.
    _claim: Claim,
}

impl<S: Transport> CouplerLink<S> {
    /// Creates the coupler's ports and waits until both phases are connected.
    ///
    /// Setting `abort` ends this and every later wait with [`LinkError::Aborted`] within 50 ms.
    pub fn open(config: &LinkConfig, abort: Option<Arc<AtomicBool>>) -> Result<Self, LinkError> {
        let claim = Claim::new(config)?;
        memory::check_room::<S>(config, RoleName::Coupler)?;
        let mut hub = Hub::<S>::open(config, RoleName::Coupler, abort)?;
        let [fluid_state, solid_state] = [RoleName::Fluid, RoleName::Solid]
            .map(|phase| Channel::state(&hub, config, phase)?.reader(&hub, phase));
        let (fluid_state, solid_state) = (fluid_state?, solid_state?);
        let [fluid_forces, solid_forces] = [RoleName::Fluid, RoleName::Solid]
            .map(|phase| Channel::forces(&hub, config, phase)?.writer(&hub));
        let side = |state: Incoming<S, _, _>, forces| Side {
            check: StateCheck::new(config, state.sender),
            state,
            forces,
        };
        let (fluid, solid) = (side(fluid_state, fluid_forces?), side(solid_state, solid_forces?));
        hub.gather(|other, watch| match other {
            RoleName::Solid => solid.state.meet_sender(watch),
            _ => fluid.state.meet_sender(watch),
        })?;
        fluid.forces.connect()?;
        solid.forces.connect()?;
        memory::reserve::<S>(config)?;
        Ok(Self { fluid, solid, run_id: config.run_id, times: LinkTimes::default(), hub, _claim: claim })
    }

    /// The state of a phase (fluid or solid) of this step and stage; sleeps until it is there.
    ///
    /// A message with another status than ok is returned as it is: look at the status first.
    pub fn receive_state(&mut self, role: RoleName, expect: &Expect) -> Result<StateSample<S>, LinkError> {
        let start = Instant::now();
        let side = side(&mut self.fluid, &mut self.solid, role)?;
        let sample = side.state.receive(&mut self.hub);
        let arrival = Instant::now();
        self.times.wait += arrival - start;
        let sample = StateSample(sample?);
        side.check.verify(sample.header(), sample.records(), expect)?;
        self.times.exchange += arrival.elapsed();
        Ok(sample)
    }

    /// Answers a phase's state. Run id, protocol, schema and count of the header are filled in here.
    pub fn send_forces(
        &mut self,
        role: RoleName,
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
        let side = side(&mut self.fluid, &mut self.solid, role)?;
        side.forces.send(&self.hub, &header, records.len(), |slot| records[slot])?;
        self.hub.notify(Some(role));
        self.times.exchange += start.elapsed();
        Ok(())
    }

    /// Where the time went since the link was opened.
    pub fn times(&self) -> LinkTimes {
        self.times
    }
}

fn side<'a, S: Transport>(
    fluid: &'a mut Side<S>,
    solid: &'a mut Side<S>,
    role: RoleName,
) -> Result<&'a mut Side<S>, LinkError> {
    match role {
        RoleName::Fluid => Ok(fluid),
        RoleName::Solid => Ok(solid),
        RoleName::Coupler => Err(LinkError::Config { key: "role", reason: "the coupler is no phase".into() }),
    }
}
