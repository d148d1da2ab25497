//! The motion that bodies begin with at their joints: a rate that the scene gives is about the hinge that holds the
//! body, and what is hinged or fixed to a body that turns goes along with it.

use super::Vec3;
use super::joint::LinkKind::{Fixed, Hinge};
use super::step::System;

/// Speed, m/s and rad/s, below which the ends of a joint move together.
const TOGETHER: f64 = 1e-9;

impl System {
    /// Joints whose ends do not begin with the same velocity, each with how fast they move, m/s, and turn, rad/s,
    /// against each other along what the joint holds. The first step takes that away.
    pub(super) fn jerked_joints(&self) -> Vec<(String, [f64; 2])> {
        let mut all = Vec::new();
        for link in &self.links {
            let mut rows = Vec::new();
            link.rows(self.plane, &self.bodies, &self.poses, &mut rows);
            let mut squares = [0.0, 0.0];
            for row in &rows {
                squares[usize::from(row.linear == Vec3::zeros())] +=
                    row.rate(&self.bodies, &self.poses).powi(2);
            }
            let rates = squares.map(f64::sqrt);
            if rates.iter().any(|rate| *rate > TOGETHER) {
                all.push((link.name.clone(), rates));
            }
        }
        all
    }

    /// Velocities of the bodies that begin with none, from hinges that keep their place on. The first joint of a body
    /// counts: what contradicts another one the first step takes away.
    pub(super) fn turn_about_hinges(&mut self) {
        let still = |k: usize| self.poses[k].velocity == Vec3::zeros();
        // A wall that moves takes its bodies along by impulses of their joints.
        let rests = |k: usize| still(k) && self.poses[k].spin == Vec3::zeros();
        let given = |k: usize| !still(k) || !self.bodies[k].gives_way();
        let mut known: Vec<bool> =
            (0..self.bodies.len()).map(|k| if k < self.real { given(k) } else { rests(k) }).collect();
        let mut more = true;
        while std::mem::take(&mut more) {
            for link in &self.links {
                let (Hinge { at, .. } | Fixed { at }) = &link.kind else { continue };
                let [a, b] = link.ends;
                let (from, to) = match (known[a], known[b]) {
                    (true, false) => (a, b),
                    (false, true) => (b, a),
                    _ => continue,
                };
                let rate = |k: usize| self.bodies[k].angular_velocity(&self.poses[k]);
                let place = self.bodies[from].place(&self.poses[from], at);
                let arm = |k: usize| place - self.poses[k].center;
                let own = match &link.kind {
                    Fixed { .. } => rate(from),
                    // About other axes it turns as what it is hinged to.
                    Hinge { axis, .. } if *axis != Vec3::zeros() => {
                        rate(from) + axis * axis.dot(&(rate(to) - rate(from)))
                    }
                    _ => rate(to),
                };
                let hinge = self.poses[from].velocity + rate(from).cross(&arm(from));
                let (velocity, turns) = (hinge - own.cross(&arm(to)), own != rate(to));
                // Of what is at rest not even the sign of a zero changes.
                if velocity != Vec3::zeros() {
                    self.poses[to].velocity = velocity;
                }
                if turns {
                    self.poses[to].spin = self.bodies[to].spin(&self.poses[to].rotation(), &own);
                }
                known[to] = true;
                more = true;
            }
        }
    }
}
