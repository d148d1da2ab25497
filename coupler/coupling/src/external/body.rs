//! What the records of another program's solid say of one of its bodies, taken as a rigid one.

use halfstep_scene::{BodyQuantity, angle_near};
use halfstep_wire::protocol::{ForceRecord, StateRecord};
use nalgebra::{Matrix3, Vector3};

/// A body's particles: those of these numbers.
pub(super) struct Particles<'a> {
    pub(super) chosen: &'a [usize],
    pub(super) records: &'a [StateRecord],
    pub(super) forces: &'a [ForceRecord],
    /// Those of contact among them, N (2D: N/m); none where it is empty.
    pub(super) contact: &'a [[f64; 2]],
    /// Positions in the reference configuration, m.
    pub(super) first: &'a [[f64; 3]],
    /// Its last angle, rad.
    pub(super) turned: f64,
}

/// Of a particle, J.
pub(super) fn kinetic_energy(record: &StateRecord) -> f64 {
    0.5 * record.mass * record.velocity.iter().map(|v| v * v).sum::<f64>()
}

impl Particles<'_> {
    fn mean(&self, of: impl Fn(usize) -> [f64; 3]) -> Vector3<f64> {
        let mass: f64 = self.chosen.iter().map(|&i| self.records[i].mass).sum();
        self.sum(|i| self.records[i].mass * Vector3::from(of(i))) / mass
    }

    fn sum(&self, of: impl Fn(usize) -> Vector3<f64>) -> Vector3<f64> {
        self.chosen.iter().map(|&i| of(i)).sum()
    }

    /// Of other solids and of walls.
    fn contact(&self, i: usize) -> Vector3<f64> {
        self.contact.get(i).map_or(Vector3::zeros(), |[x, y]| Vector3::new(*x, *y, 0.0))
    }

    /// Of the fluid.
    fn force(&self, i: usize) -> Vector3<f64> {
        Vector3::from(self.forces[i].force(self.records[i].mass)) - self.contact(i)
    }

    fn moment(&self, of: impl Fn(usize) -> Vector3<f64>) -> Vector3<f64> {
        let centre = self.centre();
        self.sum(|i| (self.position(i) - centre).cross(&of(i)))
    }

    fn centre(&self) -> Vector3<f64> {
        self.mean(|i| self.records[i].position)
    }

    fn position(&self, i: usize) -> Vector3<f64> {
        self.records[i].position.into()
    }

    /// The rotation in the plane since the start by least squares (Kabsch 1976), rad.
    fn angle(&self) -> f64 {
        let (was, is) = (self.mean(|i| self.first[i]), self.centre());
        let (mut sine, mut cosine) = (0.0, 0.0);
        for &i in self.chosen {
            let (mass, x) = (self.records[i].mass, self.position(i) - is);
            let reference = Vector3::from(self.first[i]) - was;
            sine += mass * reference.cross(&x).z;
            cosine += mass * reference.dot(&x);
        }
        angle_near(sine, cosine, self.turned)
    }

    /// Angular velocity with the angular momentum that the particles have, rad/s.
    fn rate(&self, dimension: usize) -> Vector3<f64> {
        let (velocity, centre) = (self.mean(|i| self.records[i].velocity), self.centre());
        let (mut inertia, mut momentum) = (Matrix3::zeros(), Vector3::zeros());
        for &i in self.chosen {
            let (mass, r) = (self.records[i].mass, self.position(i) - centre);
            inertia += mass * (r.norm_squared() * Matrix3::identity() - r * r.transpose());
            momentum += mass * r.cross(&(Vector3::from(self.records[i].velocity) - velocity));
        }
        if dimension == 2 {
            return Vector3::z() * (momentum.z / inertia[(2, 2)]);
        }
        inertia.try_inverse().map_or(Vector3::repeat(f64::NAN), |inverse| inverse * momentum)
    }

    /// A quantity's vector; those about z in the plane are its z. None: the records do not tell it.
    ///
    /// `strains` for a body that the scene has as elastic: what it stores is not known.
    pub(super) fn quantity(&self, of: BodyQuantity, dimension: usize, strains: bool) -> Option<Vector3<f64>> {
        match of {
            BodyQuantity::Position => Some(self.centre()),
            BodyQuantity::Velocity => Some(self.mean(|i| self.records[i].velocity)),
            BodyQuantity::Angle if dimension == 2 => Some(Vector3::z() * self.angle()),
            BodyQuantity::AngularVelocity => Some(self.rate(dimension)),
            BodyQuantity::Force => Some(self.sum(|i| self.force(i))),
            BodyQuantity::Moment => Some(self.moment(|i| self.force(i))),
            BodyQuantity::Energy if !strains => {
                let energy: f64 = self.chosen.iter().map(|&i| kinetic_energy(&self.records[i])).sum();
                Some(Vector3::z() * energy)
            }
            // Contact by its own program stays within that.
            BodyQuantity::ContactForce => Some(self.sum(|i| self.contact(i))),
            BodyQuantity::ContactMoment => Some(self.moment(|i| self.contact(i))),
            BodyQuantity::Angle | BodyQuantity::Energy => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(position: [f64; 3], velocity: [f64; 3], mass: f64) -> StateRecord {
        StateRecord { position, velocity, mass, ..StateRecord::default() }
    }

    /// Two masses of 1 and 3 on a rod of 4, about z by 30 degrees and moved by (5, 6), turning at 2 rad/s.
    #[test]
    fn a_rod_that_has_turned_and_gone() {
        let first = [[0.0; 3], [4.0, 0.0, 0.0]];
        let (sin, cos) = 30f64.to_radians().sin_cos();
        // Centre at (3, 0) before, at (8, 6) now; arms of -3 and 1.
        let at = |arm: f64| [8.0 + arm * cos, 6.0 + arm * sin, 0.0];
        let speed = |arm: f64| [0.5 - 2.0 * arm * sin, 2.0 * arm * cos, 0.0];
        let records = [record(at(-3.0), speed(-3.0), 1.0), record(at(1.0), speed(1.0), 3.0)];
        let pull = ForceRecord { stress_force: [0.0, 7.0, 0.0], ..ForceRecord::default() };
        let hit = ForceRecord { stress_force: [2.0, 0.0, 0.0], ..ForceRecord::default() };
        let forces = [pull, hit];
        let rod = Particles {
            chosen: &[0, 1],
            records: &records,
            forces: &forces,
            contact: &[[0.0, 0.0], [2.0, 0.0]],
            first: &first,
            turned: 0.0,
        };
        let close = |of: BodyQuantity, expected: [f64; 3]| {
            for dimension in [2, 3] {
                // In space a rod's moment of inertia about itself is zero.
                if dimension == 3 && matches!(of, BodyQuantity::Angle | BodyQuantity::AngularVelocity) {
                    continue;
                }
                let value = rod.quantity(of, dimension, false).unwrap();
                assert!((value - Vector3::from(expected)).norm() < 1e-6, "{of:?} in {dimension}D: {value}");
            }
        };
        close(BodyQuantity::Position, [8.0, 6.0, 0.0]);
        close(BodyQuantity::Velocity, [0.5, 0.0, 0.0]);
        close(BodyQuantity::Angle, [0.0, 0.0, 30f64.to_radians()]);
        close(BodyQuantity::AngularVelocity, [0.0, 0.0, 2.0]);
        close(BodyQuantity::Force, [0.0, 7.0, 0.0]);
        close(BodyQuantity::Moment, [0.0, 0.0, -3.0 * cos * 7.0]);
        close(BodyQuantity::ContactForce, [2.0, 0.0, 0.0]);
        close(BodyQuantity::ContactMoment, [0.0, 0.0, -sin * 2.0]);
        // 4 (1/4) / 2 of the centre, (1 * 9 + 3 * 1) 4 / 2 of the rotation.
        close(BodyQuantity::Energy, [0.0, 0.0, 0.5 + 24.0]);
        assert!(rod.quantity(BodyQuantity::Energy, 2, true).is_none());
    }
}
