//! The one time line of a run: steps, times, and when something is written.

use halfstep_scene::{Scene, TimeStep};
use halfstep_wire::Name;
use halfstep_wire::failure::Diverged;
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::order;
use halfstep_wire::state::{Column, Fields, Group, State, StateError};

/// Growth of the time step from one step to the next.
const GROWTH: f64 = 1.1;

/// Steps and times.
#[derive(Clone, Debug)]
pub struct Clock {
    end: f64,
    fixed: Option<f64>,
    time: f64,
    step: u64,
    last_dt: Option<f64>,
    /// Of each participant, as last told.
    limits: Vec<Limit>,
    /// Participants above whose limit the fixed step was found.
    warned: Vec<Name>,
    frames: Periodic,
    rows: Periodic,
    /// A step was shortened to meet the end: times are no longer those of a run with a later end.
    clipped: bool,
    /// Part of the limits that is taken.
    factor: f64,
}

/// Largest time step that a participant is stable with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The participant.
    pub participant: Name,
    /// Time step, s.
    pub dt: f64,
}

/// Says that a fixed time step, s, is above a limit, s, of somebody.
pub fn above_limit(dt: f64, whose: &str, limit: f64) -> String {
    format!("time_step = {dt:.4e} s is above the {whose}'s stability limit of {limit:.4e} s")
}

/// The same with what keeps to it.
pub fn times_above_limit(dt: f64, whose: &str, limit: f64) -> String {
    format!("{}, {:.2} times (time_step = \"auto\" keeps to it)", above_limit(dt, whose, limit), dt / limit)
}

/// Whether steps of this length, s, reach an end, s, in less than a lifetime.
pub fn reaches_end(dt: f64, end: f64) -> bool {
    dt.is_finite() && dt > 1e-9 * end.min(1.0) * 1e-3
}

#[derive(Clone, Debug)]
struct Periodic {
    interval: f64,
    count: u64,
}

impl Periodic {
    fn due(&mut self, time: f64) -> Option<u64> {
        if time < self.count as f64 * self.interval * (1.0 - 1e-9) {
            return None;
        }
        let number = self.count;
        // An interval shorter than a step does not make up for instants that passed.
        self.count = self.count.max((time / self.interval * (1.0 + 1e-9)).floor() as u64) + 1;
        Some(number)
    }
}

/// What happens with the state at n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Step n.
    pub step: u64,
    /// Its time, s.
    pub time: f64,
    /// Step to n + 1, s; `None`: the end is reached.
    pub dt: Option<f64>,
    /// Time of n + 1, s.
    pub next_time: f64,
    /// It is written as a frame.
    pub frame: bool,
    /// It is a row of the probe log.
    pub row: bool,
    /// The step is the scene's and, for the first time, above this limit.
    pub exceeded: Option<Limit>,
}

impl Tick {
    /// The first half of the step to n + 1; its time step is zero where the end is reached.
    pub fn half_step(&self) -> HalfStep {
        HalfStep::begin(self.step, self.time).with_step(self.dt.unwrap_or(0.0), self.next_time)
    }

    /// The orders of the answer at a stage, but for checkpoints: see [`order`]. Only the state at n is written or
    /// measured.
    pub fn orders(&self, stage: Stage) -> u32 {
        let mut orders = if self.dt.is_some() { order::GO } else { order::STOP };
        if stage == Stage::First {
            orders |= if self.frame { order::WRITE_FRAME } else { 0 };
            orders |= if self.row { order::SEND_PROBES } else { 0 };
        }
        orders
    }
}

/// Name of the part in a saved clock.
const FACTOR: &str = "factor";

/// Lets a saved clock take this part of the limits, or of the scene's own time step.
pub fn shorten(clock: &mut Group, factor: f64) {
    clock.columns.insert(FACTOR.into(), Column::Reals(vec![factor]));
}

impl Clock {
    /// A clock at time zero.
    pub fn new(scene: &Scene) -> Self {
        Self {
            end: scene.end_time,
            fixed: match scene.time_step {
                TimeStep::Auto => None,
                TimeStep::Fixed(dt) => Some(dt),
            },
            time: 0.0,
            step: 0,
            last_dt: None,
            limits: Vec::new(),
            warned: Vec::new(),
            frames: Periodic { interval: scene.output.frame_interval, count: 0 },
            rows: Periodic { interval: scene.output.probe_interval, count: 0 },
            clipped: false,
            factor: 1.0,
        }
    }

    /// Part of the limits, or of the scene's own time step, that is taken: less than 1 after a run that diverged.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Time of the state at n, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Number of the state at n.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Looks at the state at n: what to do with it and how far to go next, given the limits of the participants.
    ///
    /// # Errors
    /// The limit is no positive number, or would never reach the end.
    pub fn tick(&mut self, limits: &[Limit], stop: bool) -> Result<Tick, Diverged> {
        let remaining = self.end - self.time;
        let last = stop || remaining <= self.end * 1e-12;
        let (step, time) = (self.step, self.time);
        if last {
            return Ok(Tick {
                step,
                time,
                dt: None,
                next_time: time,
                frame: true,
                row: true,
                exceeded: None,
            });
        }
        self.limits.clear();
        self.limits.extend_from_slice(limits);
        let frame = self.frames.due(self.time).is_some();
        let row = self.rows.due(self.time).is_some();
        let mut dt = self.whole_step(limits);
        if !reaches_end(dt, self.end) {
            // Whose limit it is; NaN is nobody's wish, and comes first.
            let wanted = |limit: &Limit| if limit.dt.is_nan() { 0.0 } else { limit.dt };
            let shortest = limits.iter().min_by(|a, b| wanted(a).total_cmp(&wanted(b)));
            let whose = shortest.filter(|limit| self.fixed.is_none() && !reaches_end(limit.dt, self.end));
            let participant = whose.map_or(Name::COUPLER, |limit| limit.participant);
            return Err(Diverged::of_time_step(participant, dt, self.step));
        }
        self.last_dt = Some(dt);
        self.clipped |= self.clips(dt);
        let mut next_time = self.time + dt;
        if remaining <= dt * (1.0 + 1e-9) {
            (dt, next_time) = (remaining, self.end);
        } else if self.fixed.is_none() && remaining < 2.0 * dt {
            // Two even steps rather than one of the usual length and a sliver.
            dt = 0.5 * remaining;
            next_time = self.time + dt;
        }
        let exceeded = self.exceeded().find(|limit| !self.warned.contains(&limit.participant));
        self.warned.extend(exceeded.map(|limit| limit.participant));
        Ok(Tick { step, time, dt: Some(dt), next_time, frame, row, exceeded })
    }

    /// The step that the limits and the step before it allow, s.
    fn whole_step(&self, limits: &[Limit]) -> f64 {
        // NaN wins over every number in this minimum.
        let limit =
            limits.iter().map(|l| l.dt).fold(f64::INFINITY, |a, b| if b.is_nan() || b < a { b } else { a });
        match self.fixed {
            Some(dt) => dt * self.factor,
            None => {
                let limit = limit * self.factor;
                self.last_dt.map_or(limit, |last| limit.min(GROWTH * last))
            }
        }
    }

    /// A step of this length would be shortened to meet the end.
    fn clips(&self, dt: f64) -> bool {
        let remaining = self.end - self.time;
        remaining <= dt * (1.0 + 1e-9) || (self.fixed.is_none() && remaining < 2.0 * dt)
    }

    /// The next step is the first that the end shortens: a run with a later end goes on from here.
    pub fn is_about_to_clip(&self, limits: &[Limit]) -> bool {
        !self.clipped && self.clips(self.whole_step(limits))
    }

    /// No step was shortened to meet the end so far.
    pub fn is_unclipped(&self) -> bool {
        !self.clipped
    }

    /// Limits that the scene's own time step exceeds, in the order of the participants.
    pub fn exceeded(&self) -> impl Iterator<Item = Limit> + '_ {
        let above = |l: &Limit| self.fixed.is_some_and(|dt| dt * self.factor > l.dt * (1.0 + 1e-9));
        self.limits.iter().copied().filter(above)
    }

    /// The step was done.
    pub fn advance(&mut self, tick: &Tick) {
        self.time = tick.next_time;
        self.step += 1;
    }
}

impl State for Clock {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.real("time", &mut self.time)?;
        fields.count("step", &mut self.step)?;
        fields.optional_real("last_dt", &mut self.last_dt)?;
        fields.count("frames", &mut self.frames.count)?;
        fields.count("rows", &mut self.rows.count)?;
        fields.flag("clipped", &mut self.clipped)?;
        fields.real(FACTOR, &mut self.factor)?;
        let names = self.warned.iter().map(Name::to_string).collect::<Vec<_>>();
        let mut warned = names.join(" ");
        fields.text("warned", &mut warned)?;
        let known = warned.split_whitespace().map(str::parse).collect::<Result<_, _>>();
        self.warned = known.map_err(|_| StateError::contradiction("`warned` holds what is no name"))?;
        Ok(())
    }

    fn restored(&mut self) -> Result<(), StateError> {
        let sound = self.time.is_finite() && self.time >= 0.0 && self.last_dt.is_none_or(|dt| dt > 0.0);
        let sound = sound && self.factor > 0.0 && self.factor <= 1.0;
        if sound { Ok(()) } else { Err(StateError::contradiction("the clock shows no time")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfstep_wire::failure::Quantity;

    fn clock(end: f64, fixed: Option<f64>) -> Clock {
        Clock {
            end,
            fixed,
            time: 0.0,
            step: 0,
            last_dt: None,
            limits: Vec::new(),
            warned: Vec::new(),
            frames: Periodic { interval: 0.25, count: 0 },
            rows: Periodic { interval: 0.1, count: 0 },
            clipped: false,
            factor: 1.0,
        }
    }

    fn of_fluid(dt: f64) -> Limit {
        Limit { participant: Name::FLUID, dt }
    }

    fn run(mut clock: Clock, limit: impl Fn(u64) -> f64) -> (Vec<f64>, Vec<f64>, f64) {
        let (mut steps, mut frames) = (Vec::new(), Vec::new());
        loop {
            let tick = clock.tick(&[of_fluid(limit(clock.step))], false).unwrap();
            if tick.frame {
                frames.push(tick.time);
            }
            let Some(dt) = tick.dt else { return (steps, frames, tick.time) };
            steps.push(dt);
            clock.advance(&tick);
        }
    }

    #[test]
    fn the_last_step_is_clipped_to_the_end() {
        let (steps, frames, end) = run(clock(1.0, Some(0.3)), |_| f64::NAN);
        assert_eq!(steps.len(), 4);
        assert!((steps[3] - 0.1).abs() < 1e-12);
        assert_eq!(end, 1.0);
        assert_eq!(frames.len(), 5, "{frames:?}");
    }

    #[test]
    fn a_saved_clock_goes_on_as_if_never_interrupted() {
        let limit = |n: u64| if n == 3 { 0.01 } else { 0.04 };
        let (whole, ..) = run(clock(1.0, None), limit);
        for stop in [0, 2, 5, whole.len() - 3] {
            let mut first = clock(1.0, None);
            for _ in 0..stop {
                let tick = first.tick(&[of_fluid(limit(first.step))], false).unwrap();
                first.advance(&tick);
            }
            let mut second = clock(1.0, None);
            second.load(&first.save()).unwrap();
            let (rest, ..) = run(second, limit);
            assert_eq!(rest, whole[stop..]);
        }
    }

    #[test]
    fn a_saved_clock_may_go_on_with_a_part_of_the_step() {
        for (fixed, limit, first) in [(Some(0.1), f64::NAN, 0.1), (None, 0.08, 0.08)] {
            let mut saved = clock(1.0, fixed).save();
            let mut shortened = clock(1.0, fixed);
            shorten(&mut saved, 0.5);
            shortened.load(&saved).unwrap();
            let tick = shortened.tick(&[of_fluid(limit)], false).unwrap();
            assert_eq!((tick.dt, shortened.factor()), (Some(0.5 * first), 0.5));
            shorten(&mut saved, 0.0);
            assert!(clock(1.0, fixed).load(&saved).is_err());
        }
    }

    #[test]
    fn the_first_shortened_step_is_told_beforehand() {
        let mut clock = clock(1.0, None);
        let mut told = Vec::new();
        while clock.time() < 1.0 {
            let limits = [of_fluid(0.3)];
            told.push((clock.is_about_to_clip(&limits), clock.is_unclipped()));
            let tick = clock.tick(&limits, false).unwrap();
            clock.advance(&tick);
        }
        // 0, 0.3, 0.6 with less than two steps to go: two of 0.2.
        assert_eq!(told, [(false, true), (false, true), (true, true), (false, false)]);
    }

    #[test]
    fn the_step_grows_by_a_tenth_at_most_and_shrinks_at_once() {
        let (steps, _, end) = run(clock(1.0, None), |n| {
            if n == 3 {
                0.01
            } else if n == 0 {
                0.02
            } else {
                1.0
            }
        });
        assert!((steps[1] / steps[0] - 1.1).abs() < 1e-12);
        assert_eq!(steps[3], 0.01);
        assert!((steps[4] - 0.011).abs() < 1e-15);
        assert!((steps.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert_eq!(end, 1.0);
    }

    #[test]
    fn a_limit_that_is_no_number_is_an_error() {
        let failure = clock(1.0, None).tick(&[of_fluid(f64::NAN)], false).unwrap_err();
        assert_eq!(failure.quantity, Quantity::TimeStep);
        assert_ne!(failure.participant, Name::COUPLER, "whose limit it is");
        assert!(clock(1.0, None).tick(&[of_fluid(0.0)], false).is_err());
        let both = [of_fluid(0.1), Limit { participant: Name::SOLID, dt: f64::NAN }];
        assert!(clock(1.0, None).tick(&both, false).is_err());
    }

    #[test]
    fn a_fixed_step_above_a_limit_is_told_once_for_each_participant() {
        let mut clock = clock(1.0, Some(0.1));
        let mut told = Vec::new();
        for (fluid, solid) in [(0.2, 0.05), (0.2, 0.04), (0.09, 0.05), (0.08, 0.05)] {
            let solid = Limit { participant: Name::SOLID, dt: solid };
            let tick = clock.tick(&[of_fluid(fluid), solid], false).unwrap();
            assert_eq!(tick.dt, Some(0.1), "it is taken all the same");
            told.push(tick.exceeded);
            clock.advance(&tick);
        }
        let solid = Limit { participant: Name::SOLID, dt: 0.05 };
        assert_eq!(told, [Some(solid), None, Some(of_fluid(0.09)), None]);
        assert_eq!(clock.exceeded().count(), 2);
    }

    #[test]
    fn only_the_state_at_n_is_written_and_measured() {
        let mut clock = clock(1.0, Some(0.3));
        let tick = clock.tick(&[of_fluid(1.0)], false).unwrap();
        let both = order::WRITE_FRAME | order::SEND_PROBES;
        assert_eq!(tick.orders(Stage::First), order::GO | both, "the first state is a frame and a row");
        assert_eq!(tick.orders(Stage::Second), order::GO);
        let last = clock.tick(&[of_fluid(1.0)], true).unwrap();
        assert_eq!(last.orders(Stage::First), order::STOP | both);
    }
}
