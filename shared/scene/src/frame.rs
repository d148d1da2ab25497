//! Gravity in a frame of reference that moves.
//!
//! A scene may be seen from a tank that is shaken or rolls. With the frame's displacement u, its angle theta about z
//! and gravity g in space, what is at rest in the frame feels
//!   g(t) = R(-theta) (g - u'').
//! What turning adds beside that, -theta' x (theta' x r) - theta'' x r - 2 theta' x v, is left out: a frame that turns
//! tilts slowly.

use super::{Motion, Scene};
use serde::{Deserialize, Serialize};

/// A frame of reference that moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// How it moves in space.
    pub motion: Motion,
}

/// Gravity as a scene's frame feels it.
#[derive(Clone, Debug, PartialEq)]
pub struct Gravity {
    /// In space, m/s².
    in_space: [f64; 3],
    motion: Option<Motion>,
}

impl Scene {
    /// Of gravity as the scene has it at rest, m/s².
    pub fn gravity_magnitude(&self) -> f64 {
        self.gravity.iter().map(|g| g * g).sum::<f64>().sqrt()
    }
}

impl Gravity {
    /// Of a scene.
    pub fn of(scene: &Scene) -> Self {
        Self { in_space: scene.gravity, motion: scene.frame.as_ref().map(|frame| frame.motion.clone()) }
    }

    /// At a time, s; m/s².
    pub fn at<const D: usize>(&self, time: f64) -> [f64; D] {
        let mut felt = self.in_space;
        if let Some(motion) = &self.motion {
            let frame = motion.at(time);
            for (g, a) in felt.iter_mut().zip(frame.acceleration) {
                *g -= a;
            }
            if let Some(turn) = frame.turn {
                let [x, y, z] = felt;
                felt = [turn.cos * x + turn.sin * y, turn.cos * y - turn.sin * x, z];
            }
        }
        std::array::from_fn(|d| felt[d])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Course;
    use crate::motion::{Composed, Part};
    use std::f64::consts::PI;
    use std::sync::Arc;

    fn gravity(motion: Motion) -> Gravity {
        Gravity { in_space: [0.0, -10.0, 0.0], motion: Some(motion) }
    }

    fn close<const D: usize>(found: [f64; D], expected: [f64; D]) {
        assert!((0..D).all(|d| (found[d] - expected[d]).abs() < 1e-12), "{found:?} {expected:?}");
    }

    #[test]
    fn without_a_frame_it_stays() {
        let gravity = Gravity { in_space: [1.0, -10.0, 0.0], motion: None };
        assert_eq!(gravity.at::<2>(3.0), [1.0, -10.0]);
    }

    /// x = 0.1 sin(2 pi t / 2): x'' = -0.1 pi² at a quarter of the period, and what is in the frame is pushed forth.
    #[test]
    fn a_shaken_frame_by_hand() {
        let amplitude = [0.1, 0.0, 0.0];
        let gravity = gravity(Motion::Oscillating { amplitude, period: 2.0, start: 0.0, ramp: 0.0 });
        close(gravity.at::<2>(0.5), [0.1 * PI * PI, -10.0]);
        close(gravity.at::<3>(1.5), [-0.1 * PI * PI, -10.0, 0.0]);
    }

    /// A frame that has turned by a sixth of a turn counter-clockwise sees gravity turned as far clockwise.
    #[test]
    fn a_tilted_frame_by_hand() {
        let course = Course::Steady { start: 0.0, end: 2.0, ramp: 0.0 };
        let part = Part { course, translation: [0.0; 3], angle: PI / 6.0 };
        let composed = Composed { pivot: Some([5.0, 7.0, 0.0]), parts: vec![part], makes: None };
        let gravity = gravity(Motion::Composed(Arc::new(composed)));
        // (0, -10) turned by -60 degrees.
        close(gravity.at::<2>(2.0), [-10.0 * (PI / 3.0).sin(), -10.0 * (PI / 3.0).cos()]);
    }
}
