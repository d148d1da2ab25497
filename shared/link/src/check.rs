//! What every received message must satisfy before anybody uses it.

use super::config::FLUID;
use super::records::{are_possible, copy_checked};
use super::{LinkConfig, LinkError, Participant};
use halfstep_wire::Name;
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::{LAST_STAGE, PROTOCOL, ProbeHeader, SCHEMA, StateHeader, StateRecord, status};
use std::fmt::Display;

/// The message that is due.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expect {
    /// Step n.
    pub step: u64,
    /// Stage of the step as its number on the wire.
    stage: u32,
    /// Time of step n, s, bit for bit; `None` where the receiver does not know it.
    pub time: Option<f64>,
    /// Time step, s, bit for bit; `None` where the receiver does not know it.
    pub dt: Option<f64>,
}

impl Expect {
    /// The message of this step and stage, at any time.
    pub fn new(step: u64, stage: Stage) -> Self {
        Self { step, stage: stage.number(), time: None, dt: None }
    }

    /// The message of this half-step at its time; from the second stage on with its time step.
    pub fn of(half_step: &HalfStep) -> Self {
        let expect = Self::new(half_step.step, half_step.stage).time(half_step.time);
        match half_step.stage {
            Stage::First => expect,
            Stage::Second => expect.dt(half_step.dt),
        }
    }

    /// The last message of a run that ends with the state of step n, at any time.
    pub fn last(step: u64) -> Self {
        Self { step, stage: LAST_STAGE, time: None, dt: None }
    }

    /// Whether it is the last message.
    pub fn is_last(&self) -> bool {
        self.stage == LAST_STAGE
    }

    /// With this time of step n, s.
    pub fn time(self, time: f64) -> Self {
        Self { time: Some(time), ..self }
    }

    /// With this time step, s.
    pub fn dt(self, dt: f64) -> Self {
        Self { dt: Some(dt), ..self }
    }
}

/// Who sent a message to whom waits for what.
pub(super) struct Check<'a> {
    pub(super) peer: Name,
    pub(super) expect: &'a Expect,
}

impl Check<'_> {
    pub(super) fn mismatch(
        &self,
        field: &'static str,
        expected: impl Display,
        found: impl Display,
    ) -> LinkError {
        LinkError::Mismatch {
            peer: self.peer,
            field,
            expected: expected.to_string(),
            found: found.to_string(),
            step: self.expect.step,
            stage: self.expect.stage,
        }
    }

    pub(super) fn equal<T: PartialEq + Display>(
        &self,
        field: &'static str,
        expected: T,
        found: T,
    ) -> Result<(), LinkError> {
        if expected == found { Ok(()) } else { Err(self.mismatch(field, expected, found)) }
    }

    /// Bit for bit, and a number at all.
    fn same_bits(&self, field: &'static str, expected: Option<f64>, found: f64) -> Result<(), LinkError> {
        match expected {
            Some(value) if value.to_bits() != found.to_bits() => {
                Err(self.mismatch(field, format!("{value:?}"), format!("{found:?}")))
            }
            _ => self.finite(field, found),
        }
    }

    pub(super) fn finite(&self, field: &'static str, value: f64) -> Result<(), LinkError> {
        if value.is_finite() { Ok(()) } else { Err(self.not_finite(field, None, value)) }
    }

    pub(super) fn not_finite(&self, field: &'static str, particle: Option<u32>, value: f64) -> LinkError {
        let Expect { step, stage, .. } = *self.expect;
        LinkError::NotFinite { peer: self.peer, field, particle, value, step, stage }
    }

    /// What is wrong with a record of which something is.
    fn impossible(&self, record: &StateRecord) -> LinkError {
        let Expect { step, stage, .. } = *self.expect;
        let (peer, particle) = (self.peer, record.id);
        match state_values(record).find(|(_, value)| !value.is_finite()) {
            Some((field, value)) => self.not_finite(field, Some(particle), value),
            None => {
                let density = record.density <= 0.0;
                let (field, value) =
                    if density { ("density", record.density) } else { ("mass", record.mass) };
                LinkError::NotPositive { peer, field, particle, value, step, stage }
            }
        }
    }

    pub(super) fn identity(&self, own: u64, run: u64, protocol: u32, schema: u64) -> Result<(), LinkError> {
        self.equal("run_id", own, run)?;
        self.equal("protocol", PROTOCOL, protocol)?;
        self.equal("schema", SCHEMA, schema)
    }

    pub(super) fn position(&self, step: u64, stage: u32, time: f64, dt: f64) -> Result<(), LinkError> {
        self.equal("step", self.expect.step, step)?;
        self.equal("stage", self.expect.stage, stage)?;
        self.same_bits("time", self.expect.time, time)?;
        self.same_bits("dt", self.expect.dt, dt)
    }
}

/// Particle numbers of the messages of one epoch.
#[derive(Debug)]
pub struct Identities {
    pub(super) ids: Vec<u32>,
    pub(super) epoch: Option<u64>,
}

impl Identities {
    /// Of messages with at most so many.
    pub fn new(capacity: u32) -> Self {
        Self { ids: Vec::with_capacity(capacity as usize), epoch: None }
    }

    /// Follows own messages, which others check.
    pub fn begin(&mut self, epoch: u64) {
        self.epoch = Some(epoch);
        self.ids.clear();
    }

    /// The next particle of the epoch.
    pub fn push(&mut self, id: u32) {
        self.ids.push(id);
    }

    /// The particles of a message, where they are known.
    fn of(&self, epoch: u64, count: usize) -> &[u32] {
        if self.is_current(epoch, count) { &self.ids } else { &[] }
    }

    pub(super) fn is_current(&self, epoch: u64, count: usize) -> bool {
        self.epoch == Some(epoch) && self.ids.len() == count
    }
}

/// Checks the states of a phase.
#[derive(Debug)]
pub struct StateCheck {
    run_id: u64,
    peer: Name,
    is_fluid: bool,
    capacity: usize,
    known: Identities,
}

impl StateCheck {
    /// Of the participant at this place.
    pub fn new(config: &LinkConfig, place: usize) -> Self {
        let Participant { name, capacity, .. } = config.participants[place];
        let known = Identities::new(capacity);
        let run_id = config.run_id;
        Self { run_id, peer: name, is_fluid: place == FLUID, capacity: capacity as usize, known }
    }

    /// Whether this is the message that is due. A message that says that its sender failed is, at any time: it must
    /// only be of this run.
    ///
    /// # Errors
    /// What is wrong with it: the peer, the field, what was expected and found.
    pub fn verify(
        &mut self,
        header: &StateHeader,
        records: &[StateRecord],
        expect: &Expect,
    ) -> Result<(), LinkError> {
        let known = self.known.of(header.epoch, records.len());
        if !self.head_calls_for_records(header, records.len(), expect)? || are_possible(known, records) {
            return Ok(());
        }
        self.look_closer(header, records, expect)
    }

    /// Copies the records of a message to `records`, and checks message and copies as [`Self::verify`] does: whoever
    /// has sent them cannot change these any more.
    ///
    /// # Errors
    /// As for [`Self::verify`].
    pub(super) fn take(
        &mut self,
        header: &StateHeader,
        from: &[StateRecord],
        expect: &Expect,
        records: &mut Vec<StateRecord>,
    ) -> Result<(), LinkError> {
        records.clear();
        let checked = self.head_calls_for_records(header, from.len(), expect)?;
        let known = self.known.of(header.epoch, from.len());
        if copy_checked(known, from, records) || !checked {
            return Ok(());
        }
        self.look_closer(header, records, expect).inspect_err(|_| records.clear())
    }

    /// Whether the records of a message have to be checked; an error where its header is wrong.
    fn head_calls_for_records(
        &self,
        header: &StateHeader,
        count: usize,
        expect: &Expect,
    ) -> Result<bool, LinkError> {
        let check = Check { peer: self.peer, expect };
        check.identity(self.run_id, header.run_id, header.protocol, header.schema)?;
        check.equal("count", count, header.count as usize)?;
        if count > self.capacity {
            let (needed, capacity) = (count, self.capacity);
            return Err(LinkError::Capacity {
                peer: self.peer,
                needed,
                capacity,
                key: LinkError::CAPACITY_KEY,
            });
        }
        match header.status {
            status::OK => {}
            status::DIVERGED | status::FAILED => return Ok(false),
            status::FINISHED if expect.is_last() => {
                check.equal("count", 0, count)?;
                check.equal("step", expect.step, header.step)?;
                check.equal("stage", LAST_STAGE, header.stage)?;
                return Ok(false);
            }
            status::FINISHED => {
                return Err(check.mismatch("status", "0 (ok): the run has not been stopped", header.status));
            }
            unknown => return Err(check.mismatch("status", "0 to 3", unknown)),
        }
        check.position(header.step, header.stage, header.time, header.dt)?;
        check.finite("dt_limit", header.dt_limit)?;
        check.finite("displacement", header.displacement)?;
        if header.stage == Stage::First.number() && header.dt_limit <= 0.0 {
            return Err(check.mismatch("dt_limit", "a positive number", header.dt_limit));
        }
        Ok(true)
    }

    /// Begins a new epoch, or finds out what is wrong.
    fn look_closer(
        &mut self,
        header: &StateHeader,
        records: &[StateRecord],
        expect: &Expect,
    ) -> Result<(), LinkError> {
        let check = Check { peer: self.peer, expect };
        self.identities(&check, header, records)?;
        match records.iter().find(|record| !state_is_possible(record)) {
            None => Ok(()),
            Some(record) => Err(check.impossible(record)),
        }
    }

    fn identities(
        &mut self,
        check: &Check<'_>,
        header: &StateHeader,
        records: &[StateRecord],
    ) -> Result<(), LinkError> {
        if !self.is_fluid {
            check.equal("epoch", 0, header.epoch)?;
        }
        let known = &mut self.known;
        match known.epoch {
            Some(epoch) if header.epoch < epoch => {
                return Err(check.mismatch("epoch", format!("at least {epoch}"), header.epoch));
            }
            Some(epoch) if header.epoch == epoch => {
                check.equal("count", known.ids.len(), records.len())?;
                return match known.ids.iter().zip(records).find(|(id, record)| **id != record.id) {
                    Some((id, record)) => Err(check.mismatch("id", id, record.id)),
                    None => Ok(()),
                };
            }
            _ => {}
        }
        if let Some(pair) = records.windows(2).find(|pair| pair[0].id >= pair[1].id) {
            return Err(check.mismatch("id", format!("more than {}", pair[0].id), pair[1].id));
        }
        known.begin(header.epoch);
        known.ids.extend(records.iter().map(|record| record.id));
        Ok(())
    }
}

/// Checks the probe values of a participant on the state of a step.
///
/// # Errors
/// What is wrong with them: the peer, the field, what was expected and found.
pub fn verify_probes(
    run_id: u64,
    participant: &Participant,
    header: &ProbeHeader,
    values: &[f64],
    step: u64,
) -> Result<(), LinkError> {
    let expect = Expect::new(step, Stage::First);
    let check = Check { peer: participant.name, expect: &expect };
    check.identity(run_id, header.run_id, header.protocol, header.schema)?;
    check.equal("count", participant.probes as usize, header.count as usize)?;
    check.equal("count", participant.probes as usize, values.len())?;
    check.equal("step", step, header.step)
}

fn state_is_possible(r: &StateRecord) -> bool {
    state_values(r).all(|(_, value)| value.is_finite()) && r.density > 0.0 && r.mass > 0.0
}

fn state_values(r: &StateRecord) -> impl Iterator<Item = (&'static str, f64)> {
    let named = |name: &'static str, values: &[f64]| {
        values.iter().map(|v| (name, *v)).collect::<Vec<_>>().into_iter()
    };
    named("position", &r.position)
        .chain(named("velocity", &r.velocity))
        .chain(named("density", &[r.density]))
        .chain(named("pressure", &[r.pressure]))
        .chain(named("mass", &[r.mass]))
        .chain(named("deviatoric_stress", &r.deviatoric_stress))
}
