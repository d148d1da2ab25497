//! What joints, contacts and prescribed motion give the bodies over a step.
//!
//! Contacts and stops: what the kinetic energy changes by, less the work of all other forces along the velocity of the
//! drift and of walls that move. Dampers: their force along that velocity. What moves by prescription gives what its
//! own energy takes beside the loads on it, and the work of its pushes through joints and springs.

use super::Vec3;
use super::body::Pose;
use super::contact::Touch;
use super::row::Row;
use super::step::{Kick, System};
use crate::ledger::Given;
use halfstep_scene::EnergyPart;

/// The account.
pub(super) type Books = Given;

/// What a meeting of bodies gave.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Met {
    /// Something pushed.
    touched: bool,
    /// Work of what is driven, J.
    driven: f64,
}

impl Met {
    /// Two meetings.
    pub(super) fn and(self, other: Self) -> Self {
        Self { touched: self.touched || other.touched, driven: self.driven + other.driven }
    }
}

impl System {
    /// What happens now is noted.
    pub(super) fn books_open(&self) -> bool {
        self.accounted && self.books.open
    }

    /// Work of what is driven by an impulse along a row, J.
    fn driven_work(&self, row: &Row, impulse: f64, poses: &[Pose]) -> f64 {
        let driven = (0..2).filter(|&end| !self.bodies[row.ends[end]].gives_way());
        driven.map(|end| -impulse * row.of_end(end, &self.bodies, poses)).sum()
    }

    /// Books the work of what is driven by an impulse of a joint, and returns it, J; zero where nothing is noted.
    pub(super) fn book_joint(&mut self, row: &Row, impulse: f64, poses: &[Pose]) -> f64 {
        if !self.books_open() {
            return 0.0;
        }
        let work = self.driven_work(row, impulse, poses);
        self.books.give(EnergyPart::Clamps, work);
        work
    }

    /// What joints and contacts did by themselves moving.
    pub(super) fn book_meeting(&mut self, rows: &[Row], impulses: &[f64], touches: &[Touch]) -> Met {
        if !self.books_open() {
            return Met::default();
        }
        let of_row = |row: &Row, impulse: f64| self.driven_work(row, impulse, &self.poses);
        let joints: f64 = rows.iter().zip(impulses).map(|(row, &impulse)| of_row(row, impulse)).sum();
        let mut walls = 0.0;
        for touch in touches {
            walls += of_row(&touch.normal, touch.impulse);
            walls += touch.tangents.iter().zip(&touch.friction).map(|(row, &x)| of_row(row, x)).sum::<f64>();
            walls += touch.slide.iter().zip(&touch.friction).map(|(rate, x)| rate * x).sum::<f64>();
        }
        self.books.give(EnergyPart::Clamps, joints);
        self.books.give(EnergyPart::MovingWalls, walls);
        Met { touched: touches.iter().any(|touch| touch.impulse > 0.0), driven: joints + walls }
    }

    /// Contacts gave what the kinetic energy changed by, less the work of a kick, and of what moved.
    pub(super) fn book_contacts(&mut self, met: &Met, change: f64) {
        if self.books_open() && met.touched {
            self.books.give(EnergyPart::WallContact, change - met.driven);
        }
    }

    /// Work of a kick along the velocities of the drift, J.
    pub(super) fn work(&self, kick: &Kick, drifting: &[Pose]) -> f64 {
        let of_body = |(k, force, moment): &(usize, Vec3, Vec3)| {
            let rate = self.bodies[*k].angular_velocity(&drifting[*k]);
            force.dot(&drifting[*k].velocity) + moment.dot(&rate)
        };
        let of_spring = |(row, force, _): &(Row, f64, f64)| {
            let given = (0..2).filter(|&end| self.bodies[row.ends[end]].gives_way());
            given.map(|end| force * row.of_end(end, &self.bodies, drifting)).sum::<f64>()
        };
        let bodies: f64 = kick.pushes.iter().map(of_body).sum();
        kick.dt * (bodies + kick.springs.iter().map(of_spring).sum::<f64>())
    }

    /// What dampers, and springs on what is driven, give on the drift.
    pub(super) fn book_kick(&mut self, kick: &Kick) {
        if !self.books_open() {
            return;
        }
        let of = |(row, force, damper): &(Row, f64, f64)| {
            let rate = row.rate(&self.bodies, &self.poses);
            kick.dt * damper * rate + self.driven_work(row, force * kick.dt, &self.poses)
        };
        let given: f64 = kick.springs.iter().map(of).sum();
        self.books.give(EnergyPart::Clamps, given);
    }

    /// Work of the loads on the way from one pose of a body to another, J.
    fn load_work(&self, body: usize, from: &Pose, to: &Pose) -> f64 {
        let wrench = &self.wrenches[body];
        let turned = to.rotation() - from.rotation();
        wrench.force.dot(&(to.center - from.center)) + (turned * wrench.arms).trace()
    }

    /// Potential energy of gravity, J.
    fn potential(&self, body: usize, pose: &Pose) -> f64 {
        -self.bodies[body].mass * self.gravity.dot(&pose.center)
    }

    /// Energy of places: gravity's and the springs', J.
    pub(super) fn held_by_place(&self) -> f64 {
        let gravity: f64 = (0..self.real).map(|k| self.potential(k, &self.poses[k])).sum();
        gravity + self.spring_energy()
    }

    /// After overlapping bodies were pushed apart from where they were.
    pub(super) fn book_parting(&mut self, before: f64, from: &[Pose]) {
        let loads: f64 = (0..self.real).map(|k| self.load_work(k, &from[k], &self.poses[k])).sum();
        let given = self.held_by_place() - before - loads;
        self.books.give(EnergyPart::WallContact, given);
    }

    /// The bodies that are driven, before a sub-step.
    pub(super) fn driven_before(&self) -> Vec<(usize, Pose)> {
        if !self.books_open() {
            return Vec::new();
        }
        let driven = (0..self.real).filter(|&k| !self.bodies[k].gives_way());
        driven.map(|k| (k, self.poses[k])).collect()
    }

    /// What their prescription gave them.
    pub(super) fn book_driven(&mut self, before: &[(usize, Pose)]) {
        for (k, from) in before {
            let to = self.poses[*k];
            let body = &self.bodies[*k];
            let own = body.kinetic_energy(&to) - body.kinetic_energy(from);
            let height = self.potential(*k, &to) - self.potential(*k, from);
            self.books.give(EnergyPart::Clamps, own + height - self.load_work(*k, from, &to));
        }
    }

    /// Force and moment of contacts on a body, mean over `dt`, s.
    pub(super) fn contact_load(&self, body: usize, dt: f64) -> [Vec3; 2] {
        self.contact[body].map(|sum| sum / dt)
    }
}
