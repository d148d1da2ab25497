//! The largest sub-step. A free body has no stiffness, and its accuracy asks for little: no point goes farther than a
//! quarter of the spacing in a sub-step, so that contacts are found in time, and a body falls from rest by less than
//! that. A spring is stable to 2 / omega; a quarter of that keeps its phase.

use super::step::System;

/// m/s²: where there is no gravity.
const FALL: f64 = 9.81;

/// A block that rubs on a floor which swings goes as far as with short steps to 7 %, or to 1 % where it does so gently.
const STEPS_PER_PERIOD: f64 = 200.0;

impl System {
    /// s, for this spacing, m.
    pub(super) fn sub_step_limit(&self, spacing: f64) -> f64 {
        let way = 0.25 * spacing;
        let fall = self.gravity.norm_squared().sqrt().max(FALL);
        let mut limit = (2.0 * way / fall).sqrt();
        for (body, pose) in self.bodies.iter().zip(&self.poses).take(self.real) {
            let rate = body.angular_velocity(pose).norm_squared().sqrt();
            let speed = pose.velocity.norm_squared().sqrt() + rate * body.radius;
            limit = limit.min(way / speed);
        }
        // What moves by prescription must not go farther either, nor take few steps for a swing.
        let fastest = self.bodies.iter().map(|body| body.fastest).fold(0.0, f64::max);
        let period = self.bodies.iter().map(|body| body.period).fold(f64::INFINITY, f64::min);
        limit = limit.min(way / fastest).min(period / STEPS_PER_PERIOD);
        let mut ways = Vec::new();
        let mut squares = 0.0;
        let mut damping = 0.0;
        for link in &self.links {
            ways.clear();
            link.ways(self.plane, &self.bodies, &self.poses, &mut ways);
            for row in &ways {
                let give = row.response(row, &self.bodies, &self.poses);
                squares += link.stiffness * give;
                damping += link.damping * give;
            }
        }
        limit.min(0.5 / squares.sqrt()).min(0.5 / damping)
    }
}
