//! Prescribed motion of a wall: a gate that opens, a wave paddle, a tank that rolls.

mod course;
mod placement;
mod spline;
mod waves;

pub use course::{Composed, Course, Part};
pub use placement::{Placement, Turn, angle_near};
pub use spline::{Column, Spline};
pub(crate) use waves::{Paddle, Sea, breaking_height, wave_number};
pub use waves::{Solitary, WaveMaker};

use crate::Block;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How a wall moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Motion {
    /// At constant velocity from `start` to `end`.
    Steady {
        /// Velocity, m/s.
        velocity: [f64; 3],
        /// When it begins, s.
        start: f64,
        /// When it ends, s.
        end: f64,
    },
    /// x = e(t) amplitude sin(2 pi (t - start) / period), e = sin²(pi (t - start) / (2 ramp)) until `ramp` is over,
    /// then 1.
    Oscillating {
        /// Amplitude, m.
        amplitude: [f64; 3],
        /// Period, s.
        period: f64,
        /// When it begins, s.
        start: f64,
        /// How long it takes to reach its amplitude, s; 0: at once.
        ramp: f64,
    },
    /// A sum of translations and rotations about one pivot.
    Composed(#[serde(with = "shared")] Arc<Composed>),
}

/// What many particles share, written as if it were theirs alone.
mod shared {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::sync::Arc;

    pub(super) fn serialize<T: Serialize, S: Serializer>(value: &Arc<T>, to: S) -> Result<S::Ok, S::Error> {
        (**value).serialize(to)
    }

    pub(super) fn deserialize<'a, T: Deserialize<'a>, D: Deserializer<'a>>(
        from: D,
    ) -> Result<Arc<T>, D::Error> {
        T::deserialize(from).map(Arc::new)
    }
}

impl Motion {
    /// Where the wall is at a time, s.
    pub fn at(&self, time: f64) -> Placement {
        match *self {
            Self::Composed(ref composed) => composed.at(time),
            Self::Steady { velocity, start, end } => {
                let moved = (time.min(end) - start).max(0.0);
                let moves = time >= start && time < end;
                Placement {
                    displacement: velocity.map(|v| v * moved),
                    velocity: if moves { velocity } else { [0.0; 3] },
                    ..Placement::default()
                }
            }
            Self::Oscillating { amplitude, period, start, ramp } => {
                let t = time - start;
                if t < 0.0 {
                    return Placement::default();
                }
                let [x, v, a] = course::swing(t, period, 0.0, ramp);
                Placement {
                    displacement: amplitude.map(|k| k * x),
                    velocity: amplitude.map(|k| k * v),
                    acceleration: amplitude.map(|k| k * a),
                    turn: None,
                }
            }
        }
    }

    /// What a composed motion adds up; nothing of the others.
    pub fn parts(&self) -> &[Part] {
        match self {
            Self::Composed(composed) => &composed.parts,
            Self::Steady { .. } | Self::Oscillating { .. } => &[],
        }
    }

    /// Least and largest displacement until `end_time` along each axis, m, of what does not turn: bounds.
    pub fn reach(&self, end_time: f64) -> [(f64, f64); 3] {
        match self {
            Self::Steady { .. } => self.at(end_time).displacement.map(|x| (x.min(0.0), x.max(0.0))),
            Self::Oscillating { amplitude, .. } => amplitude.map(|x| (-x.abs(), x.abs())),
            Self::Composed(composed) => composed.reach(end_time),
        }
    }

    /// A box that holds all that begins in a box, wherever the motion takes it until `end_time`.
    pub fn swept(&self, around: &Block, end_time: f64) -> Block {
        let mut block = *around;
        if let Some(pivot) = self.pivot() {
            let radius = farthest(&pivot, around);
            for axis in 0..2 {
                (block.min[axis], block.max[axis]) = (pivot[axis] - radius, pivot[axis] + radius);
            }
        }
        for (axis, (back, forth)) in self.reach(end_time).into_iter().enumerate() {
            block.min[axis] += back;
            block.max[axis] += forth;
        }
        block
    }

    /// An upper bound of the speed of what begins in a box, m/s.
    pub fn fastest(&self, around: &Block) -> f64 {
        let length = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        match self {
            Self::Steady { velocity, .. } => length(velocity),
            Self::Oscillating { amplitude, period, ramp, .. } => {
                length(amplitude) * course::fastest_swing(*period, *ramp)
            }
            Self::Composed(composed) => {
                composed.fastest(farthest(&composed.pivot.unwrap_or_default(), around))
            }
        }
    }

    /// Shortest period of its swings, s; of points twice the shortest time between two. Infinite where it does not
    /// swing.
    pub fn shortest_period(&self) -> f64 {
        match self {
            Self::Steady { .. } => f64::INFINITY,
            Self::Oscillating { period, .. } => *period,
            Self::Composed(composed) => {
                let periods = composed.parts.iter().map(|part| part.course.period());
                periods.fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// Whether it, or a part of it, goes on at a rate.
    pub fn is_steady(&self) -> bool {
        match self {
            Self::Steady { .. } => true,
            Self::Oscillating { .. } => false,
            Self::Composed(composed) => {
                composed.parts.iter().any(|part| matches!(part.course, Course::Steady { .. }))
            }
        }
    }

    /// Sum of the largest angles of its swings about a middle position, rad; what turns one way does not count.
    pub fn swings_by(&self) -> f64 {
        let Self::Composed(composed) = self else { return 0.0 };
        let swing = |part: &Part| match &part.course {
            Course::Sine { .. } => part.angle.abs(),
            Course::Points(spline) => (part.angle * spline.swings_by()).abs(),
            Course::Steady { .. } | Course::Solitary(_) => 0.0,
        };
        composed.parts.iter().map(swing).sum()
    }

    /// What it makes as a wave maker.
    pub fn makes(&self) -> Option<&WaveMaker> {
        match self {
            Self::Composed(composed) => composed.makes.as_ref(),
            _ => None,
        }
    }

    /// The point about which it turns, m; `None` where it does not.
    pub fn pivot(&self) -> Option<[f64; 3]> {
        match self {
            Self::Composed(composed) => composed.pivot,
            _ => None,
        }
    }
}

/// Distance of a box's farthest corner from an axis along z, m.
pub(crate) fn farthest(pivot: &[f64; 3], around: &Block) -> f64 {
    let along =
        |axis: usize| (around.min[axis] - pivot[axis]).abs().max((around.max[axis] - pivot[axis]).abs());
    (along(0) * along(0) + along(1) * along(1)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::course::envelope;
    use super::*;
    use std::f64::consts::PI;

    const ANYWHERE: Block = Block { min: [0.0; 3], max: [1.0; 3] };

    #[test]
    fn a_gate_opens_by_hand() {
        let gate = Motion::Steady { velocity: [0.0, 2.0, 0.0], start: 0.1, end: 0.4 };
        assert_eq!(gate.at(0.05), Placement::default());
        assert!((gate.at(0.2).displacement[1] - 0.2).abs() < 1e-15);
        assert_eq!(gate.at(0.2).velocity, [0.0, 2.0, 0.0]);
        assert!((gate.at(9.0).displacement[1] - 0.6).abs() < 1e-15);
        assert_eq!(gate.at(9.0).velocity, [0.0; 3]);
        assert_eq!(gate.fastest(&ANYWHERE), 2.0);
        assert_eq!(gate.reach(0.05), [(0.0, 0.0); 3]);
        assert!((gate.reach(0.2)[1].1 - 0.2).abs() < 1e-15 && gate.reach(0.2)[1].0 == 0.0);
    }

    #[test]
    fn a_paddle_swings_by_hand() {
        // A quarter of its period after the ramp is over: at its amplitude, at rest, accelerated by omega² A.
        let paddle = Motion::Oscillating { amplitude: [0.1, 0.0, 0.0], period: 2.0, start: 1.0, ramp: 2.0 };
        let p = paddle.at(5.5);
        assert!((p.displacement[0] - 0.1).abs() < 1e-15 && p.velocity[0].abs() < 1e-15);
        assert!((p.acceleration[0] + 0.1 * PI * PI).abs() < 1e-14);
        // Half the ramp: e = 1/2.
        let half = paddle.at(1.0 + 0.5);
        assert!((envelope(1.0, 2.0).0 - 0.5).abs() < 1e-15);
        assert!((half.displacement[0] - 0.1 * envelope(0.5, 2.0).0).abs() < 1e-15);
    }

    #[test]
    fn velocity_and_acceleration_are_derivatives() {
        let paddle = Motion::Oscillating { amplitude: [0.1, 0.2, 0.0], period: 0.7, start: 0.3, ramp: 1.1 };
        for t in [0.31, 0.9, 1.3, 1.41, 2.0] {
            let e = 1e-5;
            let (before, at, after) = (paddle.at(t - e), paddle.at(t), paddle.at(t + e));
            for d in 0..3 {
                let v = (after.displacement[d] - before.displacement[d]) / (2.0 * e);
                let a = (after.velocity[d] - before.velocity[d]) / (2.0 * e);
                // The envelope's second derivative jumps where the ramp ends, at 1.4 s.
                assert!((v - at.velocity[d]).abs() < 1e-6, "{t}: {v} {}", at.velocity[d]);
                assert!((a - at.acceleration[d]).abs() < 1e-3, "{t}: {a} {}", at.acceleration[d]);
                assert!(at.velocity[d].abs() <= paddle.fastest(&ANYWHERE));
            }
        }
    }
}
