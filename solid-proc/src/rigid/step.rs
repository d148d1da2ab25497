//! A sub-step of all bodies.

use super::Vec3;
use super::account::{Books, Met};
use super::body::{Body, Pose};
use super::contact::{Remembered, Touch};
use super::joint::Link;
use super::row::{Factors, Row};
use super::solve::{Held, solve};
use nalgebra::Matrix3;

/// Newton steps that bring joints together; each of them wins as many digits as the sub-step is short.
const JOINT_STEPS: usize = 30;
/// Part of a body's size, 1 m or rad, to which joints hold.
const JOINT_GAP: f64 = 1e-14;

/// What acts on a body from outside during a stage, fixed in space while the body turns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wrench {
    /// Force, N (2D: N/m).
    pub(super) force: Vec3,
    /// Sum of r f^T, r from the centre of mass in the reference configuration, N m.
    pub(super) arms: Matrix3<f64>,
}

impl Wrench {
    /// Moment about the centre of mass of a body that has turned, N m.
    pub(super) fn moment(&self, rotation: &Matrix3<f64>) -> Vec3 {
        let s = rotation * self.arms;
        Vec3::new(s[(1, 2)] - s[(2, 1)], s[(2, 0)] - s[(0, 2)], s[(0, 1)] - s[(1, 0)])
    }
}

/// Which kick of a sub-step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Half {
    First,
    Second,
}

/// What a kick did.
pub(super) struct Kick {
    /// s.
    pub(super) dt: f64,
    /// Body, force and moment.
    pub(super) pushes: Vec<(usize, Vec3, Vec3)>,
    /// Rows of the springs, each with the whole force along it and the damper's part.
    pub(super) springs: Vec<(Row, f64, f64)>,
    /// Work of what is driven through the joints that hold against dampers, J.
    driven: f64,
}

/// Bodies, what holds them, and where they are.
pub(super) struct System {
    pub(super) plane: bool,
    /// Bodies, then what they are tied to or touch.
    pub(super) bodies: Vec<Body>,
    /// Number of bodies.
    pub(super) real: usize,
    pub(super) links: Vec<Link>,
    /// m/s².
    pub(super) gravity: Vec3,
    pub(super) friction: f64,
    pub(super) restitution: f64,
    /// Surfaces closer than this touch, m.
    pub(super) tolerance: f64,
    pub(super) poses: Vec<Pose>,
    /// By body.
    pub(super) wrenches: Vec<Wrench>,
    /// Impulse of contacts on each body over the present stage, and its moment about the centre of mass.
    pub(super) contact: Vec<[Vec3; 2]>,
    /// Impulses of the last contacts, from which the next ones are sought.
    pub(super) memory: Vec<Remembered>,
    pub(super) books: Books,
    /// Energy is accounted.
    pub(super) accounted: bool,
}

impl System {
    /// Rows of all joints.
    pub(super) fn joint_rows(&self) -> Vec<Row> {
        let mut rows = Vec::new();
        self.links.iter().for_each(|link| link.rows(self.plane, &self.bodies, &self.poses, &mut rows));
        rows
    }

    /// Joints whose ends are apart by more than this, m, each with how far.
    pub(super) fn open_joints(&self, most: f64) -> Vec<(String, f64)> {
        let apart = |link: &Link| (link.name.clone(), link.apart(self.plane, &self.bodies, &self.poses));
        self.links.iter().map(apart).filter(|(_, apart)| *apart > most).collect()
    }

    /// Brings everything that is driven to where it is at a time, s.
    pub(super) fn drive(&mut self, time: f64) {
        for (body, pose) in self.bodies.iter().zip(&mut self.poses) {
            body.drive(pose, time);
        }
    }

    /// A kick by loads, gravity and springs over `dt`, s. Dampers take the velocities before the first kick of a
    /// sub-step and after the second: both together are of second order.
    fn kick(&mut self, dt: f64, half: Half) -> Kick {
        let of = |(row, elastic, damping): (Row, f64, f64)| {
            let damper = match half {
                Half::First => -damping * row.rate(&self.bodies, &self.poses),
                Half::Second => 0.0,
            };
            (row, damper + elastic, damper, damping)
        };
        let mut springs: Vec<(Row, f64, f64, f64)> = self.springs().into_iter().map(of).collect();
        let pushes = self.fall(dt);
        for (row, force, ..) in &springs {
            row.push(&self.bodies, &mut self.poses, force * dt);
        }
        let late = |(.., damping): &&mut (Row, f64, f64, f64)| half == Half::Second && *damping > 0.0;
        let mut late: Vec<_> = springs.iter_mut().filter(late).collect();
        // What joints hold gives way to a damper as they let it, with the velocity that they leave it.
        let held = if late.is_empty() { Vec::new() } else { self.joint_rows() };
        let factors = Factors::of(&held, &self.bodies, &self.poses);
        let mut driven = 0.0;
        for (row, force, damper, damping) in &mut late {
            driven += self.hold(&held, &factors);
            let mut joints: Vec<f64> =
                held.iter().map(|joint| joint.response(row, &self.bodies, &self.poses)).collect();
            let pushed = joints.clone();
            factors.solve(&mut joints);
            let by_joints: f64 = pushed.iter().zip(&joints).map(|(a, b)| a * b).sum();
            let give = row.response(row, &self.bodies, &self.poses) - by_joints;
            *damper = -*damping * row.rate(&self.bodies, &self.poses) / (1.0 + dt * *damping * give);
            row.push(&self.bodies, &mut self.poses, *damper * dt);
            *force += *damper;
        }
        if !late.is_empty() {
            driven += self.hold(&held, &factors);
        }
        let springs = springs.into_iter().map(|(row, force, damper, _)| (row, force, damper)).collect();
        Kick { dt, pushes, springs, driven }
    }

    /// Springs and dampers: rows, with the force of the spring along each, N, and its damping, kg/s (N m and kg m²/s of
    /// those that turn).
    pub(super) fn springs(&self) -> Vec<(Row, f64, f64)> {
        let mut all = Vec::new();
        let mut ways = Vec::new();
        for link in self.links.iter().filter(|link| link.stiffness > 0.0 || link.damping > 0.0) {
            ways.clear();
            link.ways(self.plane, &self.bodies, &self.poses, &mut ways);
            all.extend(ways.iter().map(|row| (*row, -link.stiffness * (row.gap - link.rest), link.damping)));
        }
        all
    }

    /// Velocities by loads and gravity over `dt`, s. Returns bodies, forces and moments.
    pub(super) fn fall(&mut self, dt: f64) -> Vec<(usize, Vec3, Vec3)> {
        let mut pushes = Vec::new();
        for k in (0..self.real).filter(|&k| self.bodies[k].gives_way()) {
            let (wrench, pose) = (self.wrenches[k], &mut self.poses[k]);
            pose.velocity += (wrench.force / self.bodies[k].mass + self.gravity) * dt;
            let moment = wrench.moment(&pose.rotation());
            let moment = if self.plane { Vec3::new(0.0, 0.0, moment[2]) } else { moment };
            pose.spin += moment * dt;
            pushes.push((k, wrench.force + self.gravity * self.bodies[k].mass, moment));
        }
        pushes
    }

    /// Impulses of joints that leave no velocity along their rows. Returns the work of what is driven through them, J.
    fn hold(&mut self, rows: &[Row], factors: &Factors) -> f64 {
        let mut impulses: Vec<f64> = rows.iter().map(|row| -row.rate(&self.bodies, &self.poses)).collect();
        factors.solve(&mut impulses);
        let from = self.poses.clone();
        let mut driven = 0.0;
        for (row, &impulse) in rows.iter().zip(&impulses) {
            row.push(&self.bodies, &mut self.poses, impulse);
            driven += self.book_joint(row, impulse, &from);
        }
        driven
    }

    /// Adds the impulses of contacts to what the bodies feel in this stage.
    pub(super) fn note(&mut self, touches: &[Touch]) {
        for touch in touches.iter().filter(|touch| touch.is_contact()) {
            let all = std::iter::once((&touch.normal, touch.impulse));
            for (row, impulse) in all.chain(touch.tangents.iter().zip(touch.friction.iter().copied())) {
                for (end, way) in [(0, -impulse), (1, impulse)] {
                    if let Some([force, moment]) = self.contact.get_mut(row.ends[end]) {
                        *force += row.linear * way;
                        *moment += row.angular[end] * way;
                    }
                }
            }
        }
    }

    /// Velocities after joints and contacts of the present state. Returns what these gave by themselves moving.
    fn meet(&mut self, mut touches: Vec<Touch>) -> Met {
        let rows = self.joint_rows();
        if rows.is_empty() && touches.is_empty() {
            self.memory.clear();
            return Met::default();
        }
        let factors = Factors::of(&rows, &self.bodies, &self.poses);
        let held = Held { rows: &rows, factors: &factors, rates: &vec![0.0; rows.len()] };
        self.recall(&mut touches);
        let impulses = solve(&self.bodies, &mut self.poses, &held, &mut touches, self.friction);
        self.note(&touches);
        self.memory = touches.iter().map(Remembered::of).collect();
        self.book_meeting(&rows, &impulses, &touches)
    }

    /// Goes on for `dt` to `time`, s, so that joints stay together: their impulses act along the rows of the start.
    /// Returns the work of what is driven through them, J.
    fn drift(&mut self, dt: f64, time: f64) -> f64 {
        let rows = self.joint_rows();
        let start = self.poses.clone();
        let factors = Factors::of(&rows, &self.bodies, &start);
        let mut velocities = start.clone();
        let (mut last, mut driven) = (f64::INFINITY, 0.0);
        for _ in 0..JOINT_STEPS {
            self.poses.clone_from(&velocities);
            for (body, pose) in self.bodies.iter().zip(&mut self.poses).filter(|(body, _)| body.gives_way()) {
                body.drift(pose, dt);
            }
            self.drive(time);
            let mut gaps: Vec<f64> = self.joint_rows().iter().map(|row| -row.gap / dt).collect();
            let largest = gaps.iter().map(|gap| (gap * dt).abs()).fold(0.0, f64::max);
            // Rounding ends it, and so does NaN.
            if !(largest > JOINT_GAP && largest < last) {
                break;
            }
            last = largest;
            factors.solve(&mut gaps);
            for (row, &impulse) in rows.iter().zip(&gaps) {
                row.push(&self.bodies, &mut velocities, impulse);
                driven += self.book_joint(row, impulse, &start);
            }
        }
        driven
    }

    /// Pushes what overlaps apart, without velocities.
    fn part<const D: usize>(&mut self, touches: &[Touch]) {
        if !touches.iter().any(|touch| touch.normal.gap < -1e-3 * self.tolerance) {
            return;
        }
        let held_before = self.books_open().then(|| self.held_by_place());
        let from = self.poses.clone();
        for _ in 0..3 {
            let mut touches = self.touches::<D>();
            let rows = self.joint_rows();
            let factors = Factors::of(&rows, &self.bodies, &self.poses);
            let mut moves = self.poses.clone();
            for pose in &mut moves {
                (pose.velocity, pose.spin) = (Vec3::zeros(), Vec3::zeros());
            }
            let rates: Vec<f64> = rows.iter().map(|row| -row.gap).collect();
            for touch in &mut touches {
                touch.target = -touch.normal.gap;
                touch.tangents.clear();
                touch.friction.clear();
            }
            let held = Held { rows: &rows, factors: &factors, rates: &rates };
            solve(&self.bodies, &mut moves, &held, &mut touches, 0.0);
            for ((body, pose), way) in self.bodies.iter().zip(&mut self.poses).zip(&mut moves) {
                if body.gives_way() {
                    body.drift(way, 1.0);
                    *pose = Pose { velocity: pose.velocity, spin: pose.spin, ..*way };
                }
            }
            if !touches.iter().any(|touch| touch.impulse > 0.0) {
                break;
            }
        }
        if let Some(before) = held_before {
            self.book_parting(before, &from);
        }
    }

    /// One sub-step from `time`, s, over `dt`, s.
    pub(super) fn sub_step<const D: usize>(&mut self, dt: f64, time: f64) {
        let half = 0.5 * dt;
        let before = self.driven_before();
        let energy = self.kinetic_energy();
        // Impacts whose bodies the last sub-step pushed apart and against others.
        let resting = self.touches::<D>();
        let met = self.collide(&resting, dt, None);
        let kick = self.kick(half, Half::First);
        let met = met.and(self.meet(resting));
        let driven = self.drift(dt, time + dt);
        let drifting = self.kinetic_energy();
        self.book_kick(&kick);
        self.book_contacts(&met, drifting - energy - driven - self.work(&kick, &self.poses));
        let touches = self.touches::<D>();
        let halfway = self.poses.clone();
        let met = self.collide(&touches, dt, Some(half));
        let kick = self.kick(half, Half::Second);
        let met = met.and(self.meet(touches.clone()));
        let end = std::mem::replace(&mut self.poses, halfway);
        self.book_kick(&kick);
        let work = self.work(&kick, &self.poses);
        self.poses = end;
        self.book_contacts(&met, self.kinetic_energy() - drifting - kick.driven - work);
        self.part::<D>(&touches);
        self.book_driven(&before);
    }

    /// Kinetic energy of what is not driven, J (2D: J/m).
    pub(super) fn kinetic_energy(&self) -> f64 {
        let of = |(body, pose): (&Body, &Pose)| body.kinetic_energy(pose);
        let all = self.bodies.iter().zip(&self.poses).take(self.real);
        all.filter(|(body, _)| body.gives_way()).map(of).sum()
    }

    /// Energy of all springs, J (2D: J/m).
    pub(super) fn spring_energy(&self) -> f64 {
        let mut ways = Vec::new();
        let mut sum = 0.0;
        for link in self.links.iter().filter(|link| link.stiffness > 0.0) {
            ways.clear();
            link.ways(self.plane, &self.bodies, &self.poses, &mut ways);
            sum += ways.iter().map(|row| 0.5 * link.stiffness * (row.gap - link.rest).powi(2)).sum::<f64>();
        }
        sum
    }
}
