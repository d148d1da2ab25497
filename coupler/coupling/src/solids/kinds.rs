//! Forces on a solid by kind: it gets their sum, and what each of them did is booked here.

use halfstep_output::run_json::ForceKind;
use halfstep_wire::state::{Fields, State, StateError};

/// What a kind of force did to a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Done {
    /// Impulse, N s (2D: N s/m).
    pub impulse: [f64; 3],
    /// Work, J (2D: J/m).
    pub work: f64,
    /// Largest force in size, N (2D: N/m).
    pub largest: f64,
}

/// All kinds.
#[derive(Clone, Debug, Default)]
pub(crate) struct ByKind {
    /// Present forces, N.
    now: [[f64; 3]; ForceKind::ALL.len()],
    done: [Done; ForceKind::ALL.len()],
}

impl ByKind {
    /// Forgets the present forces.
    pub(crate) fn clear(&mut self) {
        self.now = Default::default();
    }

    /// Adds to the present force of a kind, N.
    pub(crate) fn add(&mut self, kind: ForceKind, force: [f64; 3]) {
        self.now[kind as usize].iter_mut().zip(force).for_each(|(sum, force)| *sum += force);
    }

    /// Books the present forces as those of a whole step of this length, s.
    pub(crate) fn book(&mut self, dt: f64) {
        for (done, force) in self.done.iter_mut().zip(self.now) {
            done.impulse.iter_mut().zip(force).for_each(|(sum, force)| *sum += dt * force);
            let size = force.iter().map(|f| f * f).sum::<f64>().sqrt();
            done.largest = done.largest.max(size);
        }
    }

    /// Books work of a kind, J.
    pub(crate) fn work(&mut self, kind: ForceKind, joules: f64) {
        self.done[kind as usize].work += joules;
    }

    /// What each kind did.
    pub(crate) fn done(&self) -> impl Iterator<Item = (ForceKind, Done)> {
        ForceKind::ALL.into_iter().zip(self.done)
    }
}

impl State for ByKind {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        for (kind, done) in ForceKind::ALL.into_iter().zip(&mut self.done) {
            fields.vector(&format!("{kind}_impulse"), &mut done.impulse)?;
            fields.real(&format!("{kind}_work"), &mut done.work)?;
            fields.real(&format!("{kind}_largest"), &mut done.largest)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 N and 4 N for 0.5 s, then 1 N the other way for 0.25 s.
    #[test]
    fn impulses_are_of_whole_steps() {
        let mut forces = ByKind::default();
        forces.add(ForceKind::Contact, [3.0, 0.0, 0.0]);
        forces.add(ForceKind::Contact, [0.0, 4.0, 0.0]);
        forces.book(0.5);
        forces.clear();
        forces.add(ForceKind::Contact, [-1.0, 0.0, 0.0]);
        forces.book(0.25);
        forces.work(ForceKind::Contact, 2.0);
        forces.work(ForceKind::Contact, -0.5);
        let done: Vec<_> = forces.done().filter(|(_, done)| *done != Done::default()).collect();
        let contact = Done { impulse: [1.25, 2.0, 0.0], work: 1.5, largest: 5.0 };
        assert_eq!(done, [(ForceKind::Contact, contact)]);
    }
}
