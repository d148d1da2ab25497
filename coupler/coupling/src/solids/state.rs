//! What the coupler keeps of the solids over an interruption, and whether they show the states that a checkpoint has.

use super::{CoupledSolid, Solids};
use halfstep_link::StateMessage;
use halfstep_wire::protocol::{ForceRecord, StateRecord};
use halfstep_wire::state::{Fields, State, StateError};
use xxhash_rust::xxh3::Xxh3;

impl<const D: usize> Solids<D> {
    /// Notes the states that a checkpoint is made of.
    pub(crate) fn note_saved(&mut self, states: &[impl StateMessage]) {
        for (side, state) in self.solids.iter_mut().zip(&states[self.first..]) {
            side.saved = state_hash(state.records());
        }
    }

    /// Place of a solid whose state is not the one that the checkpoint was made of.
    pub(crate) fn changed_since_saved<S: StateMessage>(&self, states: &[S]) -> Option<usize> {
        let changed = |(side, state): (&CoupledSolid<D>, &S)| state_hash(state.records()) != side.saved;
        let solid = self.solids.iter().zip(&states[self.first..]).position(changed)?;
        Some(self.first + solid)
    }
}

impl<const D: usize> State for Solids<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let mut solids = self.solids.iter_mut().enumerate();
        solids.try_for_each(|(solid, side)| fields.part(&format!("solid_{solid}"), side))?;
        fields.part("impulse", &mut self.impulse)?;
        self.contact.as_mut().map_or(Ok(()), |contact| fields.part("contact", contact))
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.contact.as_mut().map_or(Ok(()), State::restored)?;
        self.solids.iter_mut().try_for_each(State::restored)
    }
}

impl<const D: usize> State for CoupledSolid<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.part("by_kind", &mut self.by_kind)?;
        fields.optional_count("count", &mut self.continuity.count)?;
        fields.count("state_published", &mut self.saved)?;
        fields.points("position", &mut self.at_n)?;
        let mut cross_viscosity = self.forces.iter().map(|f| f.cross_viscosity).collect();
        let mut stress_force = self.forces.iter().map(|f| f.stress_force).collect();
        fields.points("cross_viscosity", &mut cross_viscosity)?;
        fields.points("stress_force", &mut stress_force)?;
        if fields.loading() {
            fields.length("stress_force", cross_viscosity.len(), stress_force.len())?;
            let of = |(cross_viscosity, stress_force)| ForceRecord {
                cross_viscosity,
                stress_force,
                ..ForceRecord::default()
            };
            self.forces = cross_viscosity.into_iter().zip(stress_force).map(of).collect();
        }
        if let Some(interface) = &mut self.interface {
            fields.part("interface", interface)?;
        }
        if let Some(external) = &mut self.external {
            fields.part("external", external)?;
            if external.own_walls {
                self.walls = None;
            }
        }
        self.walls.as_mut().map_or(Ok(()), |walls| fields.part("walls", walls))?;
        self.touched.as_mut().map_or(Ok(()), |touched| fields.part("touched", touched))
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.interface.as_mut().map_or(Ok(()), State::restored)?;
        self.external.as_mut().map_or(Ok(()), State::restored)?;
        self.walls.as_mut().map_or(Ok(()), State::restored)
    }
}

/// Hash of particles, their positions, velocities and masses.
fn state_hash(records: &[StateRecord]) -> u64 {
    let mut hash = Xxh3::new();
    for record in records {
        hash.update(&record.id.to_le_bytes());
        let numbers = record.position.iter().chain(&record.velocity).chain([&record.mass]);
        numbers.for_each(|x| hash.update(&x.to_le_bytes()));
    }
    hash.digest()
}
