//! The end of a process with one participant and one peer, for tests that speak of the fluid and the solid.

use halfstep_link::{Expect, LinkConfig, LinkError, LinkTimes, Port, ProcessLink, Transport};
use halfstep_wire::Name;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, StateHeader, StateRecord};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A message as it was received.
#[derive(Clone, Debug)]
pub struct Received<R, H> {
    header: H,
    records: Vec<R>,
}

impl<R, H> Received<R, H> {
    /// What heads it.
    pub fn header(&self) -> &H {
        &self.header
    }

    /// Its records.
    pub fn records(&self) -> &[R] {
        &self.records
    }
}

/// A link with one member and one peer.
#[derive(Debug)]
pub struct End<S: Transport>(ProcessLink<S>);

impl<S: Transport> End<S> {
    /// Enters the run.
    ///
    /// # Errors
    /// As for [`ProcessLink::open`].
    pub fn open(
        config: &LinkConfig,
        process: Name,
        abort: Option<Arc<AtomicBool>>,
    ) -> Result<Self, LinkError> {
        ProcessLink::open(config, process, abort).map(Self)
    }

    /// As [`Port::send_state`].
    ///
    /// # Errors
    /// The same.
    pub fn send_state(&mut self, header: &StateHeader, records: &[StateRecord]) -> Result<(), LinkError> {
        self.0.send_state(0, header, records)
    }

    /// As [`ProcessLink::send_state_from`].
    ///
    /// # Errors
    /// The same.
    pub fn send_state_from(
        &mut self,
        header: &StateHeader,
        count: usize,
        record: impl FnMut(usize) -> StateRecord,
    ) -> Result<(), LinkError> {
        self.0.send_state_from(0, header, count, record)
    }

    /// As [`Port::receive_peer`].
    ///
    /// # Errors
    /// The same.
    pub fn receive_peer(&mut self, expect: &Expect) -> Result<Received<StateRecord, StateHeader>, LinkError> {
        let mut records = Vec::new();
        let header = self.0.receive_peer(0, 0, expect, &mut records)?;
        Ok(Received { header, records })
    }

    /// As [`Port::receive_forces`].
    ///
    /// # Errors
    /// The same.
    pub fn receive_forces(
        &mut self,
        expect: &Expect,
    ) -> Result<Received<ForceRecord, ForceHeader>, LinkError> {
        let mut records = Vec::new();
        let header = self.0.receive_forces(0, expect, &mut records)?;
        Ok(Received { header, records })
    }

    /// As [`Port::times`].
    pub fn times(&self) -> LinkTimes {
        self.0.times()
    }
}
