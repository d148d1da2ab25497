//! Impacts with restitution. Those contacts that approach bounce together, and what they push against others bounces in
//! turn (generalised reflections, Smith, Kaufman, Vouga, Tamstorf and Grinspun 2012), until nothing approaches.
//!
//! Surfaces meet within a drift, at the part s = 1 - delta / (v dt) of it, for an approach v that left a depth delta.
//! The drift's velocity is that of its middle; at the impact it is v - (1/2 - s) a dt, for an acceleration a toward the
//! surface. Bodies are moved back to the surface after the second kick, -a dt / 2, and have there what they had at the
//! impact: so the bounce is e (v - (1/2 - s) a dt) + a dt / 2 before that kick.

use super::account::Met;
use super::body::Pose;
use super::contact::Touch;
use super::row::Factors;
use super::solve::{Held, solve};
use super::step::System;

/// Most rounds of impacts that follow from each other at one instant.
const IMPACTS: usize = 1000;
/// An approach of less than this part of the fastest body's speed, or of what gravity adds in a sub-step, is none.
const CREEP: [f64; 2] = [1e-6, 1e-3];
/// s of what is hit by others and not by the drift.
const MIDDLE: f64 = 0.5;

impl System {
    /// Impacts of the present state. `half`, s: after the drift of a sub-step, before a kick of that length.
    pub(super) fn collide(&mut self, touches: &[Touch], dt: f64, half: Option<f64>) -> Met {
        let mut met = Met::default();
        if self.restitution == 0.0 || touches.is_empty() {
            return met;
        }
        let speed = |pose: &Pose| pose.velocity.norm_squared().sqrt();
        let fastest = self.poses.iter().map(speed).fold(0.0, f64::max);
        let creep = (CREEP[0] * fastest).max(CREEP[1] * dt * self.gravity.norm_squared().sqrt());
        let rates: Vec<f64> = touches.iter().map(|touch| self.rate(touch)).collect();
        if rates.iter().all(|rate| *rate >= -creep) {
            return met;
        }
        let rows = self.joint_rows();
        let factors = Factors::of(&rows, &self.bodies, &self.poses);
        let held = Held { rows: &rows, factors: &factors, rates: &vec![0.0; rows.len()] };
        // What each bounce has more than e v; nothing once it had it.
        let mut more = vec![0.0; touches.len()];
        if let Some(half) = half {
            let is_hit: Vec<bool> = rates.iter().map(|rate| *rate < -creep).collect();
            let kicked = self.kicked(touches, &rates, &is_hit, &held, half);
            for (k, more) in more.iter_mut().enumerate() {
                let left = (-touches[k].normal.gap).max(0.0) / (-rates[k] * dt);
                let instant = if is_hit[k] { 1.0 - left.min(1.0) } else { MIDDLE };
                *more = (self.restitution * (1.0 - 2.0 * instant) - 1.0) * kicked[k];
            }
        }
        for _ in 0..IMPACTS {
            let mut hit = Vec::new();
            for (touch, more) in touches.iter().zip(&mut more) {
                let rate = self.rate(touch);
                if rate < -creep {
                    let bounce = (std::mem::take(more) - self.restitution * rate).max(0.0);
                    let target = if touch.is_contact() { bounce } else { touch.target };
                    hit.push(Touch { target, ..touch.clone() });
                }
            }
            if hit.is_empty() {
                break;
            }
            let impulses = solve(&self.bodies, &mut self.poses, &held, &mut hit, self.friction);
            self.note(&hit);
            met = met.and(self.book_meeting(&rows, &impulses, &hit));
        }
        met
    }

    /// Speed of a touch along its normal, m/s.
    fn rate(&self, touch: &Touch) -> f64 {
        touch.normal.rate(&self.bodies, &self.poses)
    }

    /// What a kick of `dt`, s, adds to the speeds of touches, m/s, while joints and the touches that are not hit hold.
    /// Dampers are left out: they turn with the velocity.
    fn kicked(
        &mut self,
        touches: &[Touch],
        rates: &[f64],
        is_hit: &[bool],
        held: &Held<'_>,
        dt: f64,
    ) -> Vec<f64> {
        let from = self.poses.clone();
        let springs = self.springs();
        self.fall(dt);
        springs.iter().for_each(|(row, force, _)| row.push(&self.bodies, &mut self.poses, force * dt));
        let others = touches.iter().zip(is_hit).filter(|(_, hit)| !**hit);
        let mut others: Vec<Touch> = others.map(|(touch, _)| touch.clone()).collect();
        solve(&self.bodies, &mut self.poses, held, &mut others, self.friction);
        let kicked = touches.iter().zip(rates).map(|(touch, before)| self.rate(touch) - before).collect();
        self.poses = from;
        kicked
    }
}
