//! Motions that are sums of parts.

use super::waves::{Solitary, WaveMaker};
use super::{Placement, Spline, Turn};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};

/// A sum of translations, and of rotations about a pivot that goes along with the translations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Composed {
    /// Where the axis of rotation, along z, is in the scene, m; `None`: it does not turn.
    pub pivot: Option<[f64; 3]>,
    /// The parts.
    pub parts: Vec<Part>,
    /// What it makes as a wave maker.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub makes: Option<WaveMaker>,
}

/// One part: a course in time s(t), times a translation and an angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// s.
    pub course: Course,
    /// Translation for s = 1, m (for [`Course::Steady`], m/s).
    pub translation: [f64; 3],
    /// Angle for s = 1, rad (for [`Course::Steady`], rad/s), positive counter-clockwise.
    pub angle: f64,
}

/// A course in time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Course {
    /// At the rate 1 from `start` to `end`; over `ramp` after the start and before the end the rate goes with sin².
    Steady {
        /// When it begins, s.
        start: f64,
        /// When it ends, s.
        end: f64,
        /// How long the rate takes to reach 1, s.
        ramp: f64,
    },
    /// e sin(2 pi (t - start) / period + phase), e = sin²(pi (t - start) / (2 ramp)) until `ramp` is over, then 1.
    Sine {
        /// Period, s.
        period: f64,
        /// Phase at the start, rad.
        phase: f64,
        /// When it begins, s.
        start: f64,
        /// How long it takes to reach its amplitude, s; 0: at once.
        ramp: f64,
    },
    /// Through points.
    Points(Spline),
    /// A piston that makes a solitary wave; s is its way, m.
    Solitary(Solitary),
}

impl Course {
    /// s with its first two derivatives.
    fn at(&self, time: f64) -> [f64; 3] {
        match *self {
            Self::Points(ref spline) => spline.at(time),
            Self::Solitary(ref wave) => wave.at(time),
            Self::Steady { start, end, ramp } => {
                let (since, rest) = (time - start, end - time);
                if since <= 0.0 {
                    [0.0; 3]
                } else if rest <= 0.0 {
                    [end - start - ramp, 0.0, 0.0]
                } else if since < ramp {
                    rise(since, ramp)
                } else if rest < ramp {
                    let [way, rate, change] = rise(rest, ramp);
                    [end - start - ramp - way, rate, -change]
                } else {
                    [since - 0.5 * ramp, 1.0, 0.0]
                }
            }
            Self::Sine { period, phase, start, ramp } => {
                let t = time - start;
                if t < 0.0 {
                    return [0.0; 3];
                }
                swing(t, period, phase, ramp)
            }
        }
    }

    /// When it begins and ends, s; twice the start where it goes on.
    pub(crate) fn ends(&self) -> [f64; 2] {
        match self {
            Self::Steady { start, end, .. } => [*start, *end],
            Self::Sine { start, .. } => [*start; 2],
            Self::Points(spline) => spline.ends(),
            Self::Solitary(_) => [0.0; 2],
        }
    }

    /// Least and largest s until a time.
    fn extent(&self, end_time: f64) -> (f64, f64) {
        match self {
            Self::Steady { .. } | Self::Solitary(_) => (0.0, self.at(end_time)[0]),
            Self::Sine { .. } => (-1.0, 1.0),
            Self::Points(spline) => spline.extent(),
        }
    }

    /// See [`super::Motion::shortest_period`].
    pub(super) fn period(&self) -> f64 {
        match self {
            Self::Steady { .. } | Self::Solitary(_) => f64::INFINITY,
            Self::Sine { period, .. } => *period,
            Self::Points(spline) => 2.0 * spline.shortest(),
        }
    }

    /// An upper bound of the size of its rate.
    fn fastest(&self) -> f64 {
        match self {
            Self::Steady { .. } => 1.0,
            Self::Sine { period, ramp, .. } => fastest_swing(*period, *ramp),
            Self::Points(spline) => spline.fastest(),
            Self::Solitary(wave) => wave.fastest(),
        }
    }
}

/// e sin(2 pi t / period + phase), with its first two derivatives.
pub(super) fn swing(t: f64, period: f64, phase: f64, ramp: f64) -> [f64; 3] {
    let omega = 2.0 * PI / period;
    // One implementation on every machine: its bits matter.
    let (s, c) = libm::sincos(omega * t + phase);
    let (e, e1, e2) = envelope(t, ramp);
    [e * s, e1 * s + e * omega * c, e2 * s + 2.0 * e1 * omega * c - e * omega * omega * s]
}

/// An upper bound of the size of its rate.
pub(super) fn fastest_swing(period: f64, ramp: f64) -> f64 {
    2.0 * PI / period + if ramp > 0.0 { FRAC_PI_2 / ramp } else { 0.0 }
}

/// The envelope and its first two derivatives.
pub(super) fn envelope(t: f64, ramp: f64) -> (f64, f64, f64) {
    if t >= ramp {
        return (1.0, 0.0, 0.0);
    }
    // sin² = (1 - cos 2x) / 2.
    let rate = PI / ramp;
    let (s, c) = libm::sincos(rate * t);
    (0.5 * (1.0 - c), 0.5 * rate * s, 0.5 * rate * rate * c)
}

/// The integral of the envelope from 0 to t < ramp, the envelope and its rate.
fn rise(t: f64, ramp: f64) -> [f64; 3] {
    let rate = PI / ramp;
    let (s, c) = libm::sincos(rate * t);
    [0.5 * (t - s / rate), 0.5 * (1.0 - c), 0.5 * rate * s]
}

impl Composed {
    /// Where it is at a time, s.
    pub(super) fn at(&self, time: f64) -> Placement {
        let mut placement = Placement::default();
        let mut turned = [0.0; 3];
        for part in &self.parts {
            let s = part.course.at(time);
            for d in 0..3 {
                placement.displacement[d] += part.translation[d] * s[0];
                placement.velocity[d] += part.translation[d] * s[1];
                placement.acceleration[d] += part.translation[d] * s[2];
            }
            (0..3).for_each(|k| turned[k] += part.angle * s[k]);
        }
        placement.turn = self.pivot.map(|pivot| {
            let [angle, rate, acceleration] = turned;
            let (sin, cos) = libm::sincos(angle);
            Turn { pivot, sin, cos, rate, acceleration }
        });
        placement
    }

    /// Sum of the parts' displacements along x, m, and angles, rad, of those that have one or the other.
    pub(crate) fn ways(&self, time: f64) -> f64 {
        self.parts.iter().map(|part| (part.translation[0] + part.angle) * part.course.at(time)[0]).sum()
    }

    /// See [`super::Motion::reach`].
    pub(super) fn reach(&self, end_time: f64) -> [(f64, f64); 3] {
        let mut reach = [(0.0, 0.0); 3];
        for part in &self.parts {
            let (low, high) = part.course.extent(end_time);
            for (d, (back, forth)) in reach.iter_mut().enumerate() {
                let ends = [part.translation[d] * low, part.translation[d] * high];
                *back += ends[0].min(ends[1]);
                *forth += ends[0].max(ends[1]);
            }
        }
        reach.map(|(back, forth): (f64, f64)| (back.min(0.0), forth.max(0.0)))
    }

    /// See [`super::Motion::fastest`]; `radius` is the distance of the farthest point from the pivot, m.
    pub(super) fn fastest(&self, radius: f64) -> f64 {
        let length = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let of =
            |part: &Part| part.course.fastest() * (length(&part.translation) + part.angle.abs() * radius);
        self.parts.iter().map(of).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Motion;
    use super::*;
    use crate::Block;
    use std::sync::Arc;

    /// Turns at pi/4 rad/s for 4 s after a ramp of 1 s, about (1, 2).
    fn turning() -> Motion {
        let course = Course::Steady { start: 1.0, end: 6.0, ramp: 1.0 };
        let part = Part { course, translation: [0.0; 3], angle: PI / 4.0 };
        Motion::Composed(Arc::new(Composed { pivot: Some([1.0, 2.0, 0.0]), parts: vec![part], makes: None }))
    }

    #[test]
    fn a_half_turn_by_hand() {
        let motion = turning();
        let close = |a: [f64; 2], b: [f64; 2]| (0..2).all(|d| (a[d] - b[d]).abs() < 1e-14);
        let at = |time: f64| motion.at(time).position_of([1.5, 2.0]);
        assert!(close(at(0.5), [1.5, 2.0]) && close(at(7.0), [0.5, 2.0]), "{:?}", at(7.0));
        // Half way in time is half way round: a quarter.
        let middle = motion.at(3.5);
        assert!(close(middle.position_of([1.5, 2.0]), [1.0, 2.5]));
        // omega x r and -omega² r, r = (0, 1/2).
        let omega = PI / 4.0;
        assert!(close(middle.velocity_of([1.5, 2.0]), [-0.5 * omega, 0.0]));
        assert!(close(middle.acceleration_of([1.5, 2.0]), [0.0, -0.5 * omega * omega]));
        assert!(close(middle.direction_of([1.0, 0.0]), [0.0, 1.0]));
        // From the start to a half turn the point goes across: twice the radius.
        assert!((motion.at(7.0).moved_since(&motion.at(0.0), 0.5) - 1.0).abs() < 1e-14);
        let around = Block { min: [0.7, 2.0, 0.0], max: [1.3, 2.4, 0.0] };
        assert!((motion.fastest(&around) - omega * 0.5).abs() < 1e-14);
        let swept = motion.swept(&around, 10.0);
        assert!(close([swept.min[0], swept.max[1]], [0.5, 2.5]), "{swept:?}");
    }

    #[test]
    fn rates_are_derivatives_of_a_sum_of_everything() {
        let sine = |period: f64, phase: f64| Course::Sine { period, phase, start: 0.2, ramp: 0.9 };
        let points = Spline::new(vec![0.0, 0.7, 1.1, 2.0], vec![0.0, 0.3, -0.2, 0.1]);
        let parts = vec![
            Part { course: sine(0.7, 0.0), translation: [0.1, 0.0, 0.0], angle: 0.3 },
            Part { course: sine(0.45, 1.3), translation: [0.0, 0.05, 0.0], angle: -0.1 },
            Part { course: Course::Points(points), translation: [0.0, 1.0, 0.0], angle: 0.7 },
            Part {
                course: Course::Steady { start: 0.1, end: 2.1, ramp: 0.4 },
                translation: [-0.3, 0.0, 0.0],
                angle: 1.0,
            },
        ];
        let motion =
            Motion::Composed(Arc::new(Composed { pivot: Some([0.2, -0.1, 0.0]), parts, makes: None }));
        let place = [0.9, 0.4];
        let around = Block { min: [0.9, 0.4, 0.0], max: [0.9, 0.4, 0.0] };
        let swept = motion.swept(&around, 2.5);
        for k in 1..250 {
            let (t, e) = (0.0101 * f64::from(k), 1e-6);
            let (before, at, after) = (motion.at(t - e), motion.at(t), motion.at(t + e));
            for d in 0..2 {
                let v = (after.position_of(place)[d] - before.position_of(place)[d]) / (2.0 * e);
                let a = (after.velocity_of(place)[d] - before.velocity_of(place)[d]) / (2.0 * e);
                assert!((v - at.velocity_of(place)[d]).abs() < 1e-6, "{t}: {v} {at:?}");
                assert!(
                    (a - at.acceleration_of(place)[d]).abs() < 1e-4 * a.abs().max(1.0),
                    "{t}: {a} {at:?}"
                );
                let x = at.position_of(place)[d];
                assert!(swept.min[d] <= x && x <= swept.max[d], "{t}: {x} {swept:?}");
            }
            let speed = at.velocity_of(place).map(|v| v * v).iter().sum::<f64>().sqrt();
            assert!(speed <= motion.fastest(&around), "{t}: {speed}");
        }
    }

    #[test]
    fn a_ramped_motion_ends_where_it_should() {
        let course = Course::Steady { start: 0.0, end: 3.0, ramp: 1.0 };
        // Half of each ramp is lost: 3 - 1.
        assert_eq!(course.at(5.0), [2.0, 0.0, 0.0]);
        assert_eq!(course.at(1.5), [1.0, 1.0, 0.0]);
        for t in [1e-9, 1.0, 2.0, 3.0 - 1e-9] {
            let (a, b) = (course.at(t - 1e-10), course.at(t + 1e-10));
            assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-8), "{t}: {a:?} {b:?}");
        }
    }
}
