//! Checkpoints of a run from the coupler's side: when one is written and whole, and a run that goes on from one.

use super::Coupler;
use crate::clock::{Clock, Limit};
use crate::course::Course;
use crate::error::RunError;
use halfstep_link::{CouplerPort, StateMessage};
use halfstep_role::timeline::{self, Kind};
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::ability;
use halfstep_wire::state::{Fields, Group, State, StateError};

impl<P: CouplerPort, const D: usize> Coupler<P, D> {
    /// Goes on from a checkpoint's part of the coupler, with the course's clock; the recorder is resumed by itself.
    ///
    /// # Errors
    /// The checkpoint is not one of this scene.
    pub fn resume(&mut self, clock: &mut Clock, checkpoint: &Group) -> Result<(), StateError> {
        let group = |name: &str| {
            checkpoint.groups.get(name).ok_or_else(|| StateError::Missing { field: name.to_owned() })
        };
        clock.load(group("clock")?)?;
        self.load(group("coupler")?)?;
        self.half_step = HalfStep::begin(clock.step(), clock.time());
        self.resumed = true;
        Ok(())
    }

    pub(super) fn complete_checkpoint(&self, course: &mut Course) -> Result<(), RunError> {
        let Some(checkpoints) = &mut course.checkpoints else { return Ok(()) };
        let _phase = timeline::phase_of(Kind::Output, "checkpoint");
        let safe = |(place, state): (usize, &P::State)| {
            let header = state.header();
            let frames = if self.solids.is_external(place) {
                self.solids.frames_safe(place)
            } else {
                header.frames_safe
            };
            (header.checkpoint_safe, frames)
        };
        Ok(checkpoints.complete(self.states.iter().enumerate().map(safe))?)
    }

    /// The state of clock, recorder and coupler where a checkpoint is due and all participants can write theirs.
    pub(super) fn save_if_due(
        &mut self,
        course: &mut Course,
        limits: &[Limit],
    ) -> Result<Option<Group>, RunError> {
        let able = self.abilities.iter().all(|abilities| abilities & ability::CHECKPOINTS != 0);
        let Course { clock, recorder, checkpoints, .. } = course;
        let Some(checkpoints) = checkpoints.as_mut().filter(|_| able) else { return Ok(None) };
        if !checkpoints.is_due(clock, limits, self.stopped) {
            return Ok(None);
        }
        let _phase = timeline::phase_of(Kind::Output, "checkpoint");
        recorder.synchronise()?;
        self.solids.note_saved(&self.states);
        let mut group = Group::default();
        group.groups.insert("clock".into(), clock.save());
        group.groups.insert("recorder".into(), recorder.save());
        group.groups.insert("coupler".into(), self.save());
        Ok(Some(group))
    }

    /// A solid that goes on from a checkpoint must show the state that it showed when the checkpoint was written, and
    /// say what it said then of who evaluates its walls; `changed` does not.
    pub(super) fn check_resumed(&self, changed: Option<usize>) -> Result<(), RunError> {
        if let Some(place) = changed {
            let name = self.port.name(place);
            let why = "says other than before the checkpoint who evaluates its contact with walls";
            return Err(RunError::Resume(format!("the {name} {why}")));
        }
        match self.solids.changed_since_saved(&self.states) {
            None => Ok(()),
            Some(place) => {
                let name = self.port.name(place);
                Err(RunError::Resume(format!("the {name} shows another state than that of the checkpoint")))
            }
        }
    }
}

impl<P: CouplerPort, const D: usize> State for Coupler<P, D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.count("frame", &mut self.frame)?;
        fields.count("half_steps", &mut self.half_steps)?;
        fields.count("checks", &mut self.checks)?;
        fields.count("pair_evaluations", &mut self.pair_evaluations)?;
        fields.real("action_reaction", &mut self.action_reaction)?;
        // Each solid has a group beside these fields.
        self.solids.fields(fields)
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.solids.restored()
    }
}
