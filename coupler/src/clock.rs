//! The one time line of a run: steps, times, and when something is written.

use halfstep_shared::failure::{Diverged, Quantity, RoleName};
use halfstep_shared::scene::{Scene, TimeStep};

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
    /// Smallest limit seen.
    limit: f64,
    frames: Periodic,
    rows: Periodic,
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
            limit: f64::INFINITY,
            frames: Periodic { interval: scene.output.frame_interval, count: 0 },
            rows: Periodic { interval: scene.output.probe_interval, count: 0 },
        }
    }

    /// Looks at the state at n: what to do with it and how far to go next, given both sides' limit.
    ///
    /// # Errors
    /// The limit is no positive number, or would never reach the end.
    pub fn tick(&mut self, limit: f64, stop: bool) -> Result<Tick, Diverged> {
        let remaining = self.end - self.time;
        let last = stop || remaining <= self.end * 1e-12;
        let tick =
            |dt, next_time, frame, row| Tick { step: self.step, time: self.time, dt, next_time, frame, row };
        if last {
            return Ok(tick(None, self.time, true, true));
        }
        self.limit = self.limit.min(limit);
        let frame = self.frames.due(self.time).is_some();
        let row = self.rows.due(self.time).is_some();
        let mut dt = match self.fixed {
            Some(dt) => dt,
            None => self.last_dt.map_or(limit, |last| limit.min(GROWTH * last)),
        };
        if !(dt.is_finite() && dt > 1e-9 * self.end.min(1.0) * 1e-3) {
            return Err(Diverged {
                role: RoleName::Coupler,
                particle: 0,
                quantity: Quantity::TimeStep,
                value: dt,
                step: self.step,
                stage: 0,
                position: [0.0; 3],
            });
        }
        self.last_dt = Some(dt);
        let mut next_time = self.time + dt;
        if remaining <= dt * (1.0 + 1e-9) {
            (dt, next_time) = (remaining, self.end);
        } else if self.fixed.is_none() && remaining < 2.0 * dt {
            // Two even steps rather than one of the usual length and a sliver.
            dt = 0.5 * remaining;
            next_time = self.time + dt;
        }
        Ok(Tick { step: self.step, time: self.time, dt: Some(dt), next_time, frame, row })
    }

    /// The fixed time step and the smallest stability limit seen, where the step exceeds it.
    pub fn exceeded(&self) -> Option<(f64, f64)> {
        self.fixed.filter(|&dt| dt > self.limit * (1.0 + 1e-9)).map(|dt| (dt, self.limit))
    }

    /// The step was done.
    pub fn advance(&mut self, tick: &Tick) {
        self.time = tick.next_time;
        self.step += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clock(end: f64, fixed: Option<f64>) -> Clock {
        Clock {
            end,
            fixed,
            time: 0.0,
            step: 0,
            last_dt: None,
            limit: f64::INFINITY,
            frames: Periodic { interval: 0.25, count: 0 },
            rows: Periodic { interval: 0.1, count: 0 },
        }
    }

    fn run(mut clock: Clock, limit: impl Fn(u64) -> f64) -> (Vec<f64>, Vec<f64>, f64) {
        let (mut steps, mut frames) = (Vec::new(), Vec::new());
        loop {
            let tick = clock.tick(limit(clock.step), false).unwrap();
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
        let failure = clock(1.0, None).tick(f64::NAN, false).unwrap_err();
        assert_eq!(failure.quantity, Quantity::TimeStep);
        assert!(clock(1.0, None).tick(0.0, false).is_err());
    }
}
