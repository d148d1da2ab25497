//! Impulses: of joints as one linear system, of contacts one after the other, until neither changes any more (projected
//! Gauss and Seidel; Jean 1999). Of a heavy body on light ones a round takes away a part as small as the ratio of their
//! masses; so after some rounds those contacts that push and stick are one linear system, too, from which the rounds go
//! on (subspace minimisation; Silcowitz, Niebe and Erleben 2010).

use super::Vec3;
use super::body::{Body, Pose};
use super::contact::Touch;
use super::row::{Factors, Row};

/// Most rounds.
const ROUNDS: usize = 1000;
/// A round that changes no impulse by more than this part of the largest is the last one.
const CHANGE: f64 = 1e-10;
/// Rounds before a system of contacts.
const PLAIN_ROUNDS: usize = 100;
/// Most rows of such a system, and how often it is solved anew without those that would pull.
const MOST_ROWS: usize = 200;
const SOLUTIONS: usize = 8;
/// Friction within this part of its bound slides.
const AT_BOUND: f64 = 1e-9;

/// Rows that are kept at given rates.
pub(super) struct Held<'a> {
    pub(super) rows: &'a [Row],
    pub(super) factors: &'a Factors,
    /// m/s.
    pub(super) rates: &'a [f64],
}

/// Velocities and angular velocities of all bodies.
#[derive(Clone)]
struct Motions {
    straight: Vec<Vec3>,
    turning: Vec<Vec3>,
}

/// A row with what a unit impulse along it does to its ends.
#[derive(Clone)]
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

/// Impulses so far, and the motions with them.
#[derive(Clone)]
struct Search {
    motions: Motions,
    joints: Vec<Ready>,
    normals: Vec<Ready>,
    across: Vec<Vec<Ready>>,
    touches: Vec<Touch>,
}

/// What a round did: the largest change of an impulse, and the largest impulse of a contact.
struct Round {
    largest: f64,
    most: f64,
}

impl Round {
    /// The last one; NaN is never better.
    fn ends(&self) -> bool {
        self.largest.is_nan() || self.largest <= CHANGE * self.most
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
    let ready = |row: &Row| Ready::new(row, bodies, poses);
    let mut search = Search {
        motions: Motions {
            straight: poses.iter().map(|pose| pose.velocity).collect(),
            turning: bodies.iter().zip(&*poses).map(|(body, pose)| body.angular_velocity(pose)).collect(),
        },
        joints: held.rows.iter().map(ready).collect(),
        normals: touches.iter().map(|touch| ready(&touch.normal)).collect(),
        across: touches.iter().map(|touch| touch.tangents.iter().map(ready).collect()).collect(),
        touches: touches.to_vec(),
    };
    for round in 1..=ROUNDS {
        let done = search.round(held, friction);
        if done.ends() {
            break;
        }
        if round.is_multiple_of(PLAIN_ROUNDS) {
            let mut other = search.clone();
            if other.solve_system(held, bodies, poses, friction) {
                let better = other.round(held, friction);
                if better.largest < done.largest {
                    search = other;
                    if better.ends() {
                        break;
                    }
                }
            }
        }
    }
    touches.clone_from_slice(&search.touches);
    let Search { joints, normals, across, .. } = &search;
    for ready in joints.iter().chain(normals).chain(across.iter().flatten()) {
        ready.row.push(bodies, poses, ready.impulse);
    }
    joints.iter().map(|joint| joint.impulse).collect()
}

impl Search {
    /// Joints, then one contact after the other.
    fn round(&mut self, held: &Held<'_>, friction: f64) -> Round {
        let Self { motions, joints, normals, across, touches } = self;
        let mut change: Vec<f64> =
            held.rates.iter().zip(&*joints).map(|(rate, joint)| rate - joint.rate(motions)).collect();
        held.factors.solve(&mut change);
        joints.iter_mut().zip(&change).for_each(|(joint, &impulse)| joint.push(motions, impulse));
        let (mut largest, mut most) = (0.0_f64, 0.0_f64);
        for ((touch, normal), across) in touches.iter_mut().zip(normals).zip(across) {
            let give = normal.give();
            if give <= 0.0 {
                // A stop between two that are driven.
                continue;
            }
            let step = (touch.target - normal.rate(motions)) / give;
            let impulse = (touch.impulse + step).max(0.0);
            normal.push(motions, impulse - touch.impulse);
            largest = largest.max((impulse - touch.impulse).abs());
            touch.impulse = impulse;
            most = most.max(impulse);
            largest = largest.max(rub(motions, touch, across, friction * impulse));
        }
        Round { largest, most }
    }

    /// Brings the joints, and what pushes and sticks, to their rates together, again and again without what would pull
    /// or hold more than friction does. `false`: there are too many.
    fn solve_system(&mut self, held: &Held<'_>, bodies: &[Body], poses: &[Pose], friction: f64) -> bool {
        for _ in 0..SOLUTIONS {
            if !self.solve_once(held, bodies, poses, friction) {
                return false;
            }
            if !self.bound(friction) {
                break;
            }
        }
        true
    }

    fn solve_once(&mut self, held: &Held<'_>, bodies: &[Body], poses: &[Pose], friction: f64) -> bool {
        let Self { motions, joints, normals, across, touches } = self;
        let mut rows: Vec<Row> = held.rows.to_vec();
        let mut change: Vec<f64> =
            held.rates.iter().zip(&*joints).map(|(rate, joint)| rate - joint.rate(motions)).collect();
        // Contact, and which of its rows: 0 is the normal.
        let mut of: Vec<(usize, usize)> = Vec::new();
        for (k, touch) in touches.iter().enumerate().filter(|(_, touch)| touch.impulse > 0.0) {
            of.push((k, 0));
            rows.push(touch.normal);
            change.push(touch.target - normals[k].rate(motions));
            if size(&touch.friction) < (1.0 - AT_BOUND) * friction * touch.impulse {
                for (d, row) in touch.tangents.iter().enumerate() {
                    of.push((k, d + 1));
                    rows.push(*row);
                    change.push(touch.slide[d] - across[k][d].rate(motions));
                }
            }
        }
        if rows.len() > MOST_ROWS {
            return false;
        }
        Factors::of(&rows, bodies, poses).solve(&mut change);
        let (of_joints, of_contacts) = change.split_at(joints.len());
        joints.iter_mut().zip(of_joints).for_each(|(joint, &impulse)| joint.push(motions, impulse));
        for (&(k, row), &impulse) in of.iter().zip(of_contacts) {
            match row.checked_sub(1) {
                None => {
                    normals[k].push(motions, impulse);
                    touches[k].impulse += impulse;
                }
                Some(d) => {
                    across[k][d].push(motions, impulse);
                    touches[k].friction[d] += impulse;
                }
            }
        }
        true
    }

    /// Takes away what contacts cannot do; returns whether there was any.
    fn bound(&mut self, friction: f64) -> bool {
        let Self { motions, normals, across, touches, .. } = self;
        let mut any = false;
        for ((touch, normal), across) in touches.iter_mut().zip(normals).zip(across) {
            if touch.impulse < 0.0 {
                any = true;
                normal.push(motions, -touch.impulse);
                touch.impulse = 0.0;
            }
            let (size, bound) = (size(&touch.friction), friction * touch.impulse);
            if size > bound {
                any = true;
                for (row, now) in across.iter_mut().zip(&mut touch.friction) {
                    let wanted = *now * (bound / size);
                    row.push(motions, wanted - *now);
                    *now = wanted;
                }
            }
        }
        any
    }
}

fn size(impulses: &[f64]) -> f64 {
    impulses.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Coulomb's friction at a contact: what stops it, at most `bound`. Returns the largest change of an impulse.
fn rub(motions: &mut Motions, touch: &mut Touch, across: &mut [Ready], bound: f64) -> f64 {
    let give = across.iter().map(Ready::give).fold(0.0, f64::max);
    let mut wanted = [0.0; 2];
    for (k, (row, now)) in across.iter().zip(&touch.friction).enumerate() {
        wanted[k] = now - (row.rate(motions) - touch.slide[k]) / give;
    }
    let size = size(&wanted);
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
