//! The midpoint step, Kayaki's eqs. (30) and (31): to n + 1/2 with the rates at n, then from n to n + 1 with the rates
//! at n + 1/2.

use crate::columns::Source;
use crate::integration::{Moment, Rule};
use halfstep_wire::half_step::HalfStep;

/// Either stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Midpoint {
    /// Time from n, s.
    span: f64,
}

impl Midpoint {
    /// For one half-step.
    pub fn new(half_step: &HalfStep) -> Self {
        Self { span: half_step.span() }
    }
}

impl Rule for Midpoint {
    const DENSITY: bool = true;

    fn advance<const D: usize>(
        &self,
        at_n: &Moment<D>,
        now: &Source<D>,
        acceleration: [f64; D],
        density_rate: f64,
    ) -> Moment<D> {
        Moment {
            position: std::array::from_fn(|d| at_n.position[d] + self.span * now.velocity[d]),
            velocity: std::array::from_fn(|d| at_n.velocity[d] + self.span * acceleration[d]),
            density: at_n.density + self.span * density_rate,
        }
    }
}
