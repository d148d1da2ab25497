//! The seam between the half-step loop and whatever carries its messages.

use super::{Expect, LinkError, LinkTimes};
use halfstep_wire::Name;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, StateHeader, StateRecord};

/// What the participants of one process exchange with the others. A participant is named by its place in the process, a
/// peer by its place among those whose states the participant reads. Left as they are, the methods with a body are
/// those of participants without peers that nothing carries messages for.
pub trait Port {
    /// Publishes a participant's state. Run id, protocol, schema and count of the header are filled in here.
    ///
    /// # Errors
    /// The message does not fit, or nobody takes it.
    fn send_state(
        &mut self,
        member: usize,
        header: &StateHeader,
        records: &[StateRecord],
    ) -> Result<(), LinkError>;

    /// Copies a peer's state of this step and stage to `records`; sleeps until it is there. A message with another
    /// status than ok is returned as it is: look at the status first.
    ///
    /// # Errors
    /// The peer is gone, is silent for too long, or sent something else.
    fn receive_peer(
        &mut self,
        member: usize,
        peer: usize,
        expect: &Expect,
        records: &mut Vec<StateRecord>,
    ) -> Result<StateHeader, LinkError> {
        let _ = (member, peer, expect, records);
        Err(LinkError::Config { key: "peer", reason: "there is no other phase".into() })
    }

    /// Copies the answer to the state of this step and stage to `records`; sleeps until it is there. With the order to
    /// stop there may be no records.
    ///
    /// # Errors
    /// As for [`Self::receive_peer`].
    fn receive_forces(
        &mut self,
        member: usize,
        expect: &Expect,
        records: &mut Vec<ForceRecord>,
    ) -> Result<ForceHeader, LinkError>;

    /// Sends the values of a participant's probes on the state of step n at `time`, s.
    ///
    /// # Errors
    /// As for [`Self::send_state`].
    fn send_probes(&mut self, member: usize, step: u64, time: f64, values: &[f64]) -> Result<(), LinkError> {
        let _ = (member, step, time, values);
        Ok(())
    }

    /// Names of a participant's peers, in their order.
    fn peers(&self, member: usize) -> &[Name] {
        let _ = member;
        &[]
    }

    /// Names of all participants of the run, in its order.
    fn participants(&self) -> &[Name];

    /// Where the time went so far.
    fn times(&self) -> LinkTimes {
        LinkTimes::default()
    }
}

/// A state message where the coupler reads it.
pub trait StateMessage {
    /// What heads the message.
    fn header(&self) -> &StateHeader;
    /// The interface particles, by ascending number.
    fn records(&self) -> &[StateRecord];
}

/// What the coupler exchanges with the participants. A participant is named by its place in the run.
pub trait CouplerPort {
    /// A participant's state.
    type State: StateMessage;

    /// Number of participants.
    fn participants(&self) -> usize;

    /// Name of a participant.
    fn name(&self, place: usize) -> Name;

    /// The state of a participant of this step and stage; sleeps until it is there. A message with another status than
    /// ok is returned as it is: look at the status first.
    ///
    /// # Errors
    /// The participant is gone, is silent for too long, or sent something else.
    fn receive_state(&mut self, place: usize, expect: &Expect) -> Result<Self::State, LinkError>;

    /// Appends the probe values of a participant on the state of this step to `values`; sleeps until they are there.
    /// Nothing where it has no probes.
    ///
    /// # Errors
    /// As for [`Self::receive_state`].
    fn receive_probes(&mut self, place: usize, step: u64, values: &mut Vec<f64>) -> Result<(), LinkError>;

    /// Answers a participant's state. Run id, protocol, schema and count of the header are filled in here.
    ///
    /// # Errors
    /// The message does not fit, or nobody takes it.
    fn send_forces(
        &mut self,
        place: usize,
        header: &ForceHeader,
        records: &[ForceRecord],
    ) -> Result<(), LinkError>;

    /// Where the time went so far.
    fn times(&self) -> LinkTimes {
        LinkTimes::default()
    }
}
