//! The place of a state in the lock-step: step, stage, and the instants that belong to them.

use crate::protocol::{ForceHeader, StateHeader};

/// Which half of a step from n to n + 1; on the wire and in files a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// 0: from n to n + 1/2, with the rates of n.
    First,
    /// 1: from n to n + 1, with the rates of n + 1/2.
    Second,
}

/// A number that stands for no [`Stage`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a step has the stages 0 and 1, not {0}")]
pub struct UnknownStage(pub u32);

impl Stage {
    /// The number that stands for it: 0 or 1.
    pub const fn number(self) -> u32 {
        match self {
            Self::First => 0,
            Self::Second => 1,
        }
    }

    /// Step and stage of the state after the one of this stage of `step`.
    pub const fn following(self, step: u64) -> (u64, Self) {
        match self {
            Self::First => (step, Self::Second),
            Self::Second => (step + 1, Self::First),
        }
    }

    /// Step and stage of the state before the one of this stage of `step`; step 0 counts as its own predecessor.
    pub const fn preceding(self, step: u64) -> (u64, Self) {
        match self {
            Self::First => (step.saturating_sub(1), Self::Second),
            Self::Second => (step, Self::First),
        }
    }
}

impl From<Stage> for u32 {
    fn from(stage: Stage) -> Self {
        stage.number()
    }
}

impl TryFrom<u32> for Stage {
    type Error = UnknownStage;

    fn try_from(number: u32) -> Result<Self, UnknownStage> {
        match number {
            0 => Ok(Self::First),
            1 => Ok(Self::Second),
            _ => Err(UnknownStage(number)),
        }
    }
}

impl std::fmt::Display for Stage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.number().fmt(f)
    }
}

/// One of the two stages of a step from n to n + 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfStep {
    /// Step n.
    pub step: u64,
    /// Which half.
    pub stage: Stage,
    /// Time of step n, s.
    pub time: f64,
    /// Whole time step from n to n + 1, s; zero as long as the coupler has not told it.
    pub dt: f64,
    /// Time of step n + 1, s, as the coupler tells it: the sum of `time` and `dt` may miss the end of the run by a
    /// rounding.
    pub next_time: f64,
}

impl HalfStep {
    /// The first stage of step n at `time`, s. How far it goes is not known yet.
    pub const fn begin(step: u64, time: f64) -> Self {
        Self { step, stage: Stage::First, time, dt: 0.0, next_time: time }
    }

    /// The same half-step with the time step `dt`, s, to `next_time`, s, both as the coupler told them.
    pub const fn with_step(self, dt: f64, next_time: f64) -> Self {
        Self { dt, next_time, ..self }
    }

    /// The same half-step with the time step `dt`, s, where no coupler tells the time of n + 1.
    pub fn lasting(self, dt: f64) -> Self {
        self.with_step(dt, self.time + dt)
    }

    /// First and second stage of the step.
    pub const fn both(self) -> [Self; 2] {
        [Self { stage: Stage::First, ..self }, Self { stage: Stage::Second, ..self }]
    }

    /// The half-step after it: the second stage of the same step, or the first of the next one.
    pub const fn next(self) -> Self {
        match self.stage.following(self.step) {
            (_, Stage::Second) => Self { stage: Stage::Second, ..self },
            (step, Stage::First) => Self::begin(step, self.next_time),
        }
    }

    /// Length over which the stage advances the state at n, s: half of the time step or all of it.
    pub fn span(&self) -> f64 {
        match self.stage {
            Stage::First => 0.5 * self.dt,
            Stage::Second => self.dt,
        }
    }

    /// Instant of the state whose rates the stage takes, s: n or n + 1/2.
    pub fn before(&self) -> f64 {
        match self.stage {
            Stage::First => self.time,
            Stage::Second => self.middle(),
        }
    }

    /// Instant of the state that the stage leads to, s: n + 1/2 or n + 1.
    pub fn after(&self) -> f64 {
        match self.stage {
            Stage::First => self.middle(),
            Stage::Second => self.next_time,
        }
    }

    fn middle(&self) -> f64 {
        self.time + 0.5 * self.dt
    }

    /// Header of a state that is published in this half-step: its place and times. The first stage shows no time step.
    pub fn state_header(&self) -> StateHeader {
        let dt = match self.stage {
            Stage::First => 0.0,
            Stage::Second => self.dt,
        };
        StateHeader {
            step: self.step,
            stage: self.stage.number(),
            time: self.time,
            dt,
            ..StateHeader::default()
        }
    }

    /// Header of the coupler's answer in this half-step: its place and times.
    pub fn force_header(&self) -> ForceHeader {
        ForceHeader {
            step: self.step,
            stage: self.stage.number(),
            time: self.time,
            dt: self.dt,
            next_time: self.next_time,
            ..ForceHeader::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_and_instants_by_hand() {
        let [first, second] = HalfStep::begin(7, 2.0).lasting(0.5).both();
        assert_eq!((first.step, first.stage, first.time, first.dt), (7, Stage::First, 2.0, 0.5));
        assert_eq!((first.span(), first.before(), first.after()), (0.25, 2.0, 2.25));
        assert_eq!((second.step, second.stage, second.time, second.dt), (7, Stage::Second, 2.0, 0.5));
        assert_eq!((second.span(), second.before(), second.after()), (0.5, 2.25, 2.5));
    }

    #[test]
    fn before_the_coupler_has_told_the_time_step_a_half_step_goes_nowhere() {
        let half_step = HalfStep::begin(7, 2.0);
        assert_eq!((half_step.span(), half_step.before(), half_step.after()), (0.0, 2.0, 2.0));
    }

    #[test]
    fn a_step_begins_where_the_one_before_it_ended() {
        let first = HalfStep::begin(7, 2.0).with_step(0.5, 2.5);
        let second = first.next();
        assert_eq!([first, second], first.both());
        assert_eq!(second.next(), HalfStep::begin(8, 2.5));
    }

    /// 0.1 + (0.41 - 0.1) is two roundings below 0.41.
    #[test]
    fn the_last_step_ends_at_the_end_to_the_bit() {
        let (time, end) = (0.1, 0.41);
        let dt = end - time;
        assert_ne!(time + dt, end);
        let [first, last] = HalfStep::begin(3, time).with_step(dt, end).both();
        assert_eq!(first.after(), 0.1 + 0.5 * dt);
        assert_eq!(last.before(), first.after());
        assert_eq!(last.after(), end);
        assert_eq!(last.next().time, end);
    }

    #[test]
    fn stages_are_numbers_on_the_wire() {
        for (stage, number) in [(Stage::First, 0), (Stage::Second, 1)] {
            assert_eq!((stage.number(), Stage::try_from(number)), (number, Ok(stage)));
            assert_eq!(stage.to_string(), number.to_string());
        }
        // The number of a last message.
        assert_eq!(Stage::try_from(2), Err(UnknownStage(2)));
    }

    #[test]
    fn places_follow_one_another() {
        assert_eq!(Stage::First.following(41), (41, Stage::Second));
        assert_eq!(Stage::Second.following(41), (42, Stage::First));
        assert_eq!(Stage::First.preceding(42), (41, Stage::Second));
        assert_eq!(Stage::Second.preceding(41), (41, Stage::First));
        assert_eq!(Stage::First.preceding(0), (0, Stage::Second));
    }

    #[test]
    fn headers_carry_place_and_times() {
        let [first, second] = HalfStep::begin(7, 2.0).with_step(0.5, 2.5).both();
        let place = |h: StateHeader| (h.step, h.stage, h.time, h.dt);
        assert_eq!(place(first.state_header()), (7, 0, 2.0, 0.0));
        assert_eq!(place(second.state_header()), (7, 1, 2.0, 0.5));
        let place = |h: ForceHeader| (h.step, h.stage, h.time, h.dt, h.next_time);
        assert_eq!(place(first.force_header()), (7, 0, 2.0, 0.5, 2.5));
        assert_eq!(place(second.force_header()), (7, 1, 2.0, 0.5, 2.5));
    }
}
