//! Impulses: of joints as one linear system, of contacts one after the other, until neither changes any more (projected
//! Gauss and Seidel; Jean 1999).

use super::Vec3;
use super::body::{Body, Pose};
use super::contact::Touch;
use super::row::{Factors, Row};

/// Most rounds.
const ROUNDS: usize = 1000;
/// A round that changes no impulse by more than this part of the largest is the last one.
const CHANGE: f64 = 1e-10;

/// Rows that are kept at given rates.
pub(super) struct Held<'a> {
    pub(super) rows: &'a [Row],
    pub(super) factors: &'a Factors,
    /// m/s.
    pub(super) rates: &'a [f64],
}

/// Velocities and angular velocities of all bodies.
struct Motions {
    straight: Vec<Vec3>,
    turning: Vec<Vec3>,
}

/// A row with what a unit impulse along it does to its ends.
struct Ready {
    row: Row,
    impulse: f64,
    straight: [Vec3; 2],
    turning: [Vec3; 2],
}

impl Ready {
    fn new(row: &Row, bodies: &[Body], poses: &[Pose]) -> Self {
        let gives = row.ends.map(|k| bodies[k].gives_way());
        let straight =
            [0, 1].map(|e| if gives[e] { row.linear / bodies[row.ends[e]].mass } else { Vec3::zeros() });
        let turning = [0, 1].map(|e| {
            let k = row.ends[e];
            if gives[e] { bodies[k].turn_rate(&poses[k].rotation(), &row.angular[e]) } else { Vec3::zeros() }
        });
        Self { row: *row, impulse: 0.0, straight, turning }
    }

    /// J v.
    fn rate(&self, motions: &Motions) -> f64 {
        let [a, b] = self.row.ends;
        let straight = self.row.linear.dot(&(motions.straight[b] - motions.straight[a]));
        let [on_a, on_b] = &self.row.angular;
        straight + on_b.dot(&motions.turning[b]) - on_a.dot(&motions.turning[a])
    }

    /// Rate that a unit impulse makes.
    fn give(&self) -> f64 {
        let of =
            |e: usize| self.row.linear.dot(&self.straight[e]) + self.row.angular[e].dot(&self.turning[e]);
        of(0) + of(1)
    }

    fn push(&mut self, motions: &mut Motions, impulse: f64) {
        let [a, b] = self.row.ends;
        motions.straight[a] -= self.straight[0] * impulse;
        motions.straight[b] += self.straight[1] * impulse;
        motions.turning[a] -= self.turning[0] * impulse;
        motions.turning[b] += self.turning[1] * impulse;
        self.impulse += impulse;
    }
}

/// Brings joints to their rates, and contacts to at least their targets, with friction. Returns the joints' impulses;
/// those of the contacts stand in them.
pub(super) fn solve(
    bodies: &[Body],
    poses: &mut [Pose],
    held: &Held<'_>,
    touches: &mut [Touch],
    friction: f64,
) -> Vec<f64> {
    let mut motions = Motions {
        straight: poses.iter().map(|pose| pose.velocity).collect(),
        turning: bodies.iter().zip(&*poses).map(|(body, pose)| body.angular_velocity(pose)).collect(),
    };
    let ready = |row: &Row| Ready::new(row, bodies, poses);
    let mut joints: Vec<Ready> = held.rows.iter().map(ready).collect();
    let mut normals: Vec<Ready> = touches.iter().map(|touch| ready(&touch.normal)).collect();
    let mut across: Vec<Vec<Ready>> =
        touches.iter().map(|touch| touch.tangents.iter().map(ready).collect()).collect();
    let mut change = vec![0.0; joints.len()];
    for _ in 0..ROUNDS {
        for ((change, joint), rate) in change.iter_mut().zip(&joints).zip(held.rates) {
            *change = rate - joint.rate(&motions);
        }
        held.factors.solve(&mut change);
        joints.iter_mut().zip(&change).for_each(|(joint, &impulse)| joint.push(&mut motions, impulse));
        let (mut largest, mut most) = (0.0_f64, 0.0_f64);
        for ((touch, normal), across) in touches.iter_mut().zip(&mut normals).zip(&mut across) {
            if normal.give() <= 0.0 {
                // A stop between two that are driven.
                continue;
            }
            let step = (touch.target - normal.rate(&motions)) / normal.give();
            let impulse = (touch.impulse + step).max(0.0);
            normal.push(&mut motions, impulse - touch.impulse);
            largest = largest.max((impulse - touch.impulse).abs());
            touch.impulse = impulse;
            most = most.max(impulse);
            largest = largest.max(rub(&mut motions, touch, across, friction * impulse));
        }
        if largest.is_nan() || largest <= CHANGE * most {
            break;
        }
    }
    for ready in joints.iter().chain(&normals).chain(across.iter().flatten()) {
        ready.row.push(bodies, poses, ready.impulse);
    }
    joints.iter().map(|joint| joint.impulse).collect()
}

/// Coulomb's friction at a contact: what stops it, at most `bound`. Returns the largest change of an impulse.
fn rub(motions: &mut Motions, touch: &mut Touch, across: &mut [Ready], bound: f64) -> f64 {
    let give = across.iter().map(Ready::give).fold(0.0, f64::max);
    let mut wanted = [0.0; 2];
    for (k, (row, now)) in across.iter().zip(&touch.friction).enumerate() {
        wanted[k] = now - (row.rate(motions) - touch.slide[k]) / give;
    }
    let size = wanted.iter().map(|x| x * x).sum::<f64>().sqrt();
    let scale = if size > bound { bound / size } else { 1.0 };
    let mut largest = 0.0_f64;
    for ((wanted, row), now) in wanted.iter().zip(across).zip(&mut touch.friction) {
        let wanted = scale * wanted;
        row.push(motions, wanted - *now);
        largest = largest.max((wanted - *now).abs());
        *now = wanted;
    }
    largest
}
