//! Velocity Verlet of what a model advances: particles, or nodes of a mesh.

use crate::columns::{Vectors, vectors};
use halfstep_scene::Motion;
use halfstep_wire::state::{Fields, State, StateError};

/// What time integration advances, and the inner acceleration that belongs to it: a column for each component, by slot.
#[derive(Clone, Debug)]
pub(crate) struct Kinematics<const D: usize> {
    /// u, m.
    pub(crate) displacement: Vectors<D>,
    /// m/s.
    pub(crate) velocity: Vectors<D>,
    /// By all but loads and gravity, m/s².
    pub(crate) acceleration: Vectors<D>,
}

impl<const D: usize> Kinematics<D> {
    /// In place, with these velocities, m/s.
    pub(crate) fn new(velocity: Vectors<D>) -> Self {
        let slots = velocity[0].len();
        Self { displacement: vectors(slots), velocity, acceleration: vectors(slots) }
    }

    /// Takes over another state in the room that is there.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        for d in 0..D {
            self.displacement[d].clone_from(&other.displacement[d]);
            self.velocity[d].clone_from(&other.velocity[d]);
            self.acceleration[d].clone_from(&other.acceleration[d]);
        }
    }

    /// The drift over `dt`, s.
    pub(crate) fn drift(&mut self, dt: f64) {
        for d in 0..D {
            for (u, v) in self.displacement[d].iter_mut().zip(&self.velocity[d]) {
                *u += dt * v;
            }
        }
    }

    /// Brings what clamps move to where it is at a time, s; `reference` is the place of a slot, m.
    pub(crate) fn drive(
        &mut self,
        driven: &[(usize, Motion)],
        time: f64,
        reference: impl Fn(usize) -> [f64; D],
    ) {
        for (slot, motion) in driven {
            let (placement, place) = (motion.at(time), reference(*slot));
            let (moved, velocity) = (placement.displacement_of(place), placement.velocity_of(place));
            for d in 0..D {
                self.displacement[d][*slot] = moved[d];
                self.velocity[d][*slot] = velocity[d];
            }
        }
    }

    /// Fails where columns that were read have not so many slots.
    pub(crate) fn check_length(
        &self,
        fields: &Fields<'_>,
        name: &str,
        slots: usize,
    ) -> Result<(), StateError> {
        let columns = [&self.displacement, &self.velocity, &self.acceleration];
        columns.into_iter().flatten().try_for_each(|column| fields.length(name, slots, column.len()))
    }
}

impl<const D: usize> State for Kinematics<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.vectors("displacement", &mut self.displacement)?;
        fields.vectors("velocity", &mut self.velocity)?;
        fields.vectors("acceleration", &mut self.acceleration)
    }
}
