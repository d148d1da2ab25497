//! The velocity that a solid shows the fluid.
//!
//! At n that is the particle's own, and so it is at n + 1/2 of a step with one sub-step. With several, what is shown at
//! n + 1/2 moves the fluid from n to n + 1 and must agree with the way that the particle goes meanwhile: it is to be
//! the mean over the step, which is not known yet. Stage 0 has gone from n to n + 1/2 only; its mean m0 belongs to n +
//! 1/4, the mean M over the step before to n - 1/2, and the mean over [n, n + 1] to n + 1/2:
//!   v = m0 + (m0 - M) dt_n / (dt_n + 2 dt_(n-1)),
//! at the start, where v0 is known at n = 0: v = 2 m0 - v0. m0 alone lags by dt/4: an error of first order, that feeds
//! energy into a light plate between two waters.

use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::state::{Fields, State, StateError};

/// One entry of each column for each particle, by particle number.
pub(crate) struct ShownVelocity<const D: usize> {
    /// What is shown, m/s.
    shown: Vec<[f64; D]>,
    /// M, the mean over the last step, m/s; before the first one the velocity.
    mean: Vec<[f64; D]>,
    /// Length of the last step, s; 0 before the first one.
    last_dt: f64,
    /// Where particles are at n, m, from wherever the model counts.
    start: Vec<[f64; D]>,
}

impl<const D: usize> ShownVelocity<D> {
    /// Of particles with these velocities, m/s.
    pub(crate) fn new(velocity: impl Iterator<Item = [f64; D]>) -> Self {
        let shown: Vec<_> = velocity.collect();
        Self { mean: shown.clone(), last_dt: 0.0, start: vec![[0.0; D]; shown.len()], shown }
    }

    /// Velocity to show of a particle, m/s.
    pub(crate) fn of(&self, particle: u32) -> [f64; D] {
        self.shown[particle as usize]
    }

    /// Notes where particles are at n, before the first stage.
    pub(crate) fn leave(&mut self, place: impl Fn(usize) -> [f64; D]) {
        self.start.iter_mut().enumerate().for_each(|(p, start)| *start = place(p));
    }

    /// After a stage of so many sub-steps that led to these places, m, and velocities, m/s.
    pub(crate) fn arrive(
        &mut self,
        half_step: &HalfStep,
        sub_steps: u32,
        place: impl Fn(usize) -> [f64; D],
        velocity: impl Fn(usize) -> [f64; D],
    ) {
        let span = half_step.span();
        let ahead = half_step.dt / (half_step.dt + 2.0 * self.last_dt);
        for (p, shown) in self.shown.iter_mut().enumerate() {
            let now = place(p);
            let mean: [f64; D] = std::array::from_fn(|d| (now[d] - self.start[p][d]) / span);
            let last = &mut self.mean[p];
            *shown = if sub_steps == 1 || half_step.stage == Stage::Second {
                velocity(p)
            } else {
                std::array::from_fn(|d| mean[d] + (mean[d] - last[d]) * ahead)
            };
            if half_step.stage == Stage::Second {
                *last = mean;
            }
        }
        if half_step.stage == Stage::Second {
            self.last_dt = half_step.dt;
        }
    }
}

impl<const D: usize> State for ShownVelocity<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let particles = self.start.len();
        fields.points("shown", &mut self.shown)?;
        fields.points("mean", &mut self.mean)?;
        fields.real("last_dt", &mut self.last_dt)?;
        fields.length("shown_x", particles, self.shown.len())?;
        fields.length("mean_x", particles, self.mean.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: f64 = 3.0;

    /// Uniform acceleration A from 0.5 m/s at t = 0.
    fn place(t: f64) -> f64 {
        0.5 * t + 0.5 * A * t * t
    }

    #[test]
    fn under_uniform_acceleration_it_is_that_of_the_instant() {
        let mut shown = ShownVelocity::new([[0.5]].into_iter());
        let mut time = 0.0;
        for (step, dt) in [0.1, 0.1, 0.25, 0.05].into_iter().enumerate() {
            shown.leave(|_| [place(time)]);
            for half_step in HalfStep::begin(step as u64, time).lasting(dt).both() {
                let end = time + half_step.span();
                // Half-way the particle's own velocity is not asked for.
                let own = if half_step.stage == Stage::First { f64::NAN } else { 0.5 + A * end };
                shown.arrive(&half_step, 2, |_| [place(end)], |_| [own]);
                assert!(
                    (shown.of(0)[0] - (0.5 + A * end)).abs() < 1e-13,
                    "{half_step:?}: {}",
                    shown.of(0)[0]
                );
            }
            time += dt;
        }
    }

    #[test]
    fn with_one_sub_step_it_is_the_particles_own() {
        let mut shown = ShownVelocity::new([[0.5]].into_iter());
        for half_step in HalfStep::begin(0, 0.0).lasting(0.1).both() {
            shown.arrive(&half_step, 1, |_| [1.0], |_| [7.0]);
            assert_eq!(shown.of(0), [7.0]);
        }
    }
}
