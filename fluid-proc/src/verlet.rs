//! Position Verlet (Zhang, Rezavand and Hu 2021, without their inner steps):
//!   rho_{n+1/2} = rho_{n-1/2} + (dt_{n-1} + dt_n) / 2 D rho / Dt (x_n, v_n),    x_{n+1/2} = x_n + dt / 2 v_n,
//!   v_{n+1} = v_n + dt D v / Dt (x_{n+1/2}, rho_{n+1/2}, v_n),                  x_{n+1} = x_{n+1/2} + dt / 2 v_{n+1}.
//!
//! A sound wave moves velocity by pressure and density by velocity, one after the other: nothing amplifies it up to
//! omega dt = 2, and each stage evaluates one of both equations. What damps is evaluated with v_n and so by Euler's
//! rule; the wall guard, after all else, with the velocity to which that leads.

use crate::columns::Source;
use crate::integration::{Moment, Rule};

/// From n to n + 1/2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Half of the step, s.
    pub span: f64,
    /// From the instant of the density, n - 1/2, to n + 1/2, s.
    pub density_span: f64,
}

impl Rule for Drift {
    const DENSITY: bool = true;

    fn advance<const D: usize>(
        &self,
        at_n: &Moment<D>,
        _: &Source<D>,
        _: [f64; D],
        density_rate: f64,
    ) -> Moment<D> {
        Moment {
            position: std::array::from_fn(|d| at_n.position[d] + self.span * at_n.velocity[d]),
            velocity: at_n.velocity,
            density: at_n.density + self.density_span * density_rate,
        }
    }
}

/// From n + 1/2 to n + 1. The position begins at n, since particle shifting moves that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kick {
    /// The step, s.
    pub dt: f64,
}

impl Rule for Kick {
    const DENSITY: bool = false;

    fn advance<const D: usize>(
        &self,
        at_n: &Moment<D>,
        now: &Source<D>,
        acceleration: [f64; D],
        _: f64,
    ) -> Moment<D> {
        let velocity: [f64; D] = std::array::from_fn(|d| at_n.velocity[d] + self.dt * acceleration[d]);
        let half = 0.5 * self.dt;
        Moment {
            position: std::array::from_fn(|d| at_n.position[d] + half * (at_n.velocity[d] + velocity[d])),
            velocity,
            density: now.density,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::midpoint::Midpoint;
    use halfstep_wire::half_step::HalfStep;

    const DT: f64 = 0.4;

    fn source(at: &Moment<2>) -> Source<2> {
        Source { position: at.position, velocity: at.velocity, density: at.density, ..Source::ZERO }
    }

    #[test]
    fn a_step_by_hand() {
        // The density is of 0.1 s before n: 1000 + (0.1 + 0.2) 10; 1 + 0.2 * 2.
        let n = Moment { position: [1.0, 0.0], velocity: [2.0, 0.0], density: 1000.0 };
        let drift = Drift { span: 0.5 * DT, density_span: 0.1 + 0.5 * DT };
        let half = drift.advance(&n, &source(&n), [f64::NAN; 2], 10.0);
        assert_eq!((half.position[0], half.velocity[0], half.density), (1.4, 2.0, 1003.0));
        // 2 - 0.4 * 4; 1 + 0.2 (2 + 0.4).
        let end = Kick { dt: DT }.advance(&n, &source(&half), [-4.0, 1.0], f64::NAN);
        for (found, expected) in [(end.position, [1.48, 0.08]), (end.velocity, [0.4, 0.4])] {
            assert!((0..2).all(|d| (found[d] - expected[d]).abs() < 1e-15), "{found:?} {expected:?}");
        }
        assert_eq!(end.density, 1003.0);
    }

    /// A sound wave: the density's rate is omega v, the acceleration -omega (rho - 1000).
    fn largest_amplitude(
        omega: f64,
        steps: u64,
        step: impl Fn(&Moment<1>, &dyn Fn(f64) -> f64) -> Moment<1>,
    ) -> f64 {
        let mut now = Moment { position: [0.0], velocity: [1.0], density: 1000.0 };
        let mut largest = 0.0_f64;
        for _ in 0..steps {
            now = step(&now, &|density| -omega * (density - 1000.0));
            largest = largest.max(now.velocity[0].hypot(now.density - 1000.0));
        }
        largest
    }

    /// Of omega dt = z = 1.5 the midpoint rule makes sqrt(1 + z^4 / 4) = 1.505 times as much in each step. Position
    /// Verlet keeps v² + r² + z v r of v at n and r at n - 1/2, and that is 1 - z² / 4 from v = 1 and r = 0 at the
    /// start: an ellipse that reaches sqrt(1 + z / 2) = 1.323.
    #[test]
    fn a_sound_wave_keeps_its_amplitude_and_by_the_midpoint_rule_grows() {
        let omega = 1.5 / DT;
        let first = std::cell::Cell::new(true);
        let verlet = largest_amplitude(omega, 100_000, |n, force| {
            let lag = if first.replace(false) { 0.0 } else { 0.5 * DT };
            let at = |m: &Moment<1>| Source { velocity: m.velocity, density: m.density, ..Source::<1>::ZERO };
            let drift = Drift { span: 0.5 * DT, density_span: lag + 0.5 * DT };
            let half = drift.advance(n, &at(n), [0.0], omega * n.velocity[0]);
            Kick { dt: DT }.advance(n, &at(&half), [force(half.density)], 0.0)
        });
        let farthest = 1.75_f64.sqrt();
        assert!((farthest - 1e-6..farthest + 1e-9).contains(&verlet), "{verlet}");

        let midpoint = largest_amplitude(omega, 1, |n, force| {
            let at = |m: &Moment<1>| Source { velocity: m.velocity, density: m.density, ..Source::<1>::ZERO };
            let [first, second] = HalfStep::begin(0, 0.0).lasting(DT).both().map(|half| Midpoint::new(&half));
            let half = first.advance(n, &at(n), [force(n.density)], omega * n.velocity[0]);
            second.advance(n, &at(&half), [force(half.density)], omega * half.velocity[0])
        });
        assert!((midpoint - (1.0 + 1.5_f64.powi(4) / 4.0).sqrt()).abs() < 1e-12, "{midpoint}");
    }
}
