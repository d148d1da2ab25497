//! All participants in one thread: the same half-step loop and the same coupler, with nothing between them but memory.

use crate::couple::{Coupler, Outcome};
use crate::course::Course;
use crate::error::RunError;
use halfstep_link::{CouplerPort, Expect, FLUID, LinkError, Port, StateMessage};
use halfstep_role::Member;
use halfstep_role::lockstep::{Lockstep, RoleError};
use halfstep_role::report::Report;
use halfstep_scene::Scene;
use halfstep_sph::Phase;
use halfstep_sph::lane::Isa;
use halfstep_wire::Name;
use halfstep_wire::half_step::Stage;
use halfstep_wire::protocol::{ForceHeader, ForceRecord, StateHeader, StateRecord, status};
use halfstep_wire::state::Group;
use std::sync::Arc;

/// A state as a participant published it.
#[derive(Clone, Debug, Default)]
struct Message {
    header: StateHeader,
    records: Vec<StateRecord>,
}

/// A message in the mailbox, shared while the coupler reads it.
#[derive(Clone, Default)]
struct Posted(Arc<Message>);

impl StateMessage for Posted {
    fn header(&self) -> &StateHeader {
        &self.0.header
    }

    fn records(&self) -> &[StateRecord] {
        &self.0.records
    }
}

/// What participants and coupler leave for each other.
struct Mailbox {
    names: Vec<Name>,
    states: Vec<Posted>,
    answers: Vec<(ForceHeader, Vec<ForceRecord>)>,
    probes: Vec<Vec<f64>>,
}

impl CouplerPort for Mailbox {
    type State = Posted;

    fn participants(&self) -> usize {
        self.names.len()
    }

    fn name(&self, place: usize) -> Name {
        self.names[place]
    }

    fn receive_state(&mut self, place: usize, _expect: &Expect) -> Result<Posted, LinkError> {
        Ok(self.states[place].clone())
    }

    fn receive_probes(&mut self, place: usize, _step: u64, values: &mut Vec<f64>) -> Result<(), LinkError> {
        values.append(&mut self.probes[place]);
        Ok(())
    }

    fn send_forces(
        &mut self,
        place: usize,
        header: &ForceHeader,
        records: &[ForceRecord],
    ) -> Result<(), LinkError> {
        let (last, forces) = &mut self.answers[place];
        *last = *header;
        forces.clear();
        forces.extend_from_slice(records);
        Ok(())
    }
}

/// The coupler's part of a run in one thread: it takes its half-step when the first participant asks for the answer.
struct Desk<'a, const D: usize> {
    coupler: &'a mut Coupler<Mailbox, D>,
    course: &'a mut Course,
    /// Places of each participant's peers, and their names.
    peers: &'a [(Vec<usize>, Vec<Name>)],
    /// Why the coupler's part failed.
    error: Option<RunError>,
}

impl<const D: usize> Port for Desk<'_, D> {
    fn send_state(
        &mut self,
        member: usize,
        header: &StateHeader,
        records: &[StateRecord],
    ) -> Result<(), LinkError> {
        let message = Arc::make_mut(&mut self.coupler.port.states[member].0);
        message.header = *header;
        message.records.clear();
        message.records.extend_from_slice(records);
        Ok(())
    }

    fn receive_peer(
        &mut self,
        member: usize,
        peer: usize,
        _expect: &Expect,
        records: &mut Vec<StateRecord>,
    ) -> Result<StateHeader, LinkError> {
        let message = &self.coupler.port.states[self.peers[member].0[peer]].0;
        records.clear();
        records.extend_from_slice(&message.records);
        Ok(message.header)
    }

    fn receive_forces(
        &mut self,
        member: usize,
        _expect: &Expect,
        records: &mut Vec<ForceRecord>,
    ) -> Result<ForceHeader, LinkError> {
        if member == 0 {
            let first = self.coupler.port.states[0].header().stage == Stage::First.number();
            let answered = match first {
                true => self.coupler.first(self.course).map(drop),
                false => self.coupler.note(self.course).and_then(|()| self.coupler.second(self.course)),
            };
            answered.map_err(|error| {
                self.error = Some(error);
                LinkError::Aborted
            })?;
        }
        let (header, forces) = &self.coupler.port.answers[member];
        records.clear();
        records.extend_from_slice(forces);
        Ok(*header)
    }

    fn send_probes(
        &mut self,
        member: usize,
        _step: u64,
        _time: f64,
        values: &[f64],
    ) -> Result<(), LinkError> {
        let own = &mut self.coupler.port.probes[member];
        own.clear();
        own.extend_from_slice(values);
        Ok(())
    }

    fn peers(&self, member: usize) -> &[Name] {
        &self.peers[member].1
    }

    fn participants(&self) -> &[Name] {
        &self.coupler.port.names
    }
}

/// A run of all participants in the calling thread.
pub struct LocalRun<const D: usize> {
    participants: Lockstep,
    coupler: Coupler<Mailbox, D>,
    course: Course,
    peers: Vec<(Vec<usize>, Vec<Name>)>,
}

impl<const D: usize> LocalRun<D> {
    /// Of a scene's participants, in its order.
    ///
    /// # Errors
    /// The participants go on from different steps, or the scene has none.
    pub fn new(
        members: Vec<Member>,
        scene: &Scene,
        mut course: Course,
        isa: Isa,
        resumed: Option<&Group>,
    ) -> Result<Self, RunError> {
        let names: Vec<Name> = members.iter().map(|member| member.role.name()).collect();
        let phases: Vec<Phase> = members.iter().map(|member| member.role.phase()).collect();
        if members.is_empty() {
            return Err(RunError::System("the scene has neither fluid nor solid".into()));
        }
        let has_fluid = phases.first() == Some(&Phase::Fluid);
        let peers = |(place, phase): (usize, &Phase)| {
            let places: Vec<usize> = match phase {
                Phase::Fluid => (1..names.len()).collect(),
                _ if has_fluid => vec![FLUID],
                _ => Vec::new(),
            };
            let names = places.iter().map(|&k| names[k]).collect();
            debug_assert!(!places.contains(&place));
            (places, names)
        };
        let peers: Vec<(Vec<usize>, Vec<Name>)> = phases.iter().enumerate().map(peers).collect();
        let count = names.len();
        let mailbox = Mailbox {
            names,
            states: vec![Posted::default(); count],
            answers: vec![(ForceHeader::default(), Vec::new()); count],
            probes: vec![Vec::new(); count],
        };
        let external = scene.solids.iter().map(|_| None).collect();
        let mut coupler = Coupler::new(mailbox, scene, external, isa);
        if let Some(checkpoint) = resumed {
            coupler.resume(&mut course.clock, checkpoint)?;
        }
        let sizes: Vec<usize> = peers.iter().map(|(places, _)| places.len()).collect();
        Ok(Self { participants: Lockstep::new(members, &sizes)?, coupler, course, peers })
    }

    fn with<T>(
        &mut self,
        act: impl FnOnce(&mut Lockstep, &mut Desk<'_, D>) -> Result<T, RoleError>,
    ) -> Result<T, RunError> {
        let mut desk =
            Desk { coupler: &mut self.coupler, course: &mut self.course, peers: &self.peers, error: None };
        let result = act(&mut self.participants, &mut desk);
        match desk.error {
            Some(error) => Err(error),
            None => Ok(result?),
        }
    }

    /// Both halves of a step; returns whether the run goes on. After the last one, [`Self::end`].
    ///
    /// # Errors
    /// A participant diverged, or something cannot be written.
    pub fn step(&mut self) -> Result<bool, RunError> {
        self.with(|participants, desk| Ok(participants.half_step(desk)? && participants.half_step(desk)?))
    }

    /// Writes what is to be written at the end. Returns how the run went and what the participants say about
    /// themselves.
    ///
    /// # Errors
    /// As for [`Self::step`].
    pub fn end(&mut self) -> Result<(Outcome, Vec<Report>), RunError> {
        self.coupler.note(&mut self.course)?;
        let mut reports = Vec::new();
        self.with(|participants, desk| {
            participants.end(desk, &mut |report| {
                reports.push(report.clone());
                Ok(())
            })
        })?;
        debug_assert!(self.coupler.port.states.iter().all(|state| state.header().status == status::FINISHED));
        Ok((self.coupler.end(&mut self.course)?, reports))
    }

    /// All steps to the clock's end or until the run is told to stop, and the end.
    ///
    /// # Errors
    /// As for [`Self::step`].
    pub fn run(&mut self) -> Result<(Outcome, Vec<Report>), RunError> {
        while self.step()? {}
        self.end()
    }

    /// The time line and what is written down, to be ended where a step has failed.
    pub fn course_mut(&mut self) -> &mut Course {
        &mut self.course
    }

    /// The time line and what is written down.
    pub fn course(&self) -> &Course {
        &self.course
    }

    /// The time line and what is written down, at the end of the run.
    pub fn into_course(self) -> Course {
        self.course
    }

    /// The participants.
    pub fn participants(&self) -> &Lockstep {
        &self.participants
    }
}
