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
