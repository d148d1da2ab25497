//! What fracture keeps over an interruption: damage, where it began, and cuts, by slot; all else follows.

use super::Fracture;
use crate::total_lagrangian::model::TotalLagrangian;
use halfstep_wire::state::{Fields, State, StateError};

/// The fields as a file has them.
struct Saved<'a, const D: usize> {
    fracture: &'a mut Fracture<D>,
    /// Slots of the cuts, two after two.
    cuts: &'a mut Vec<u32>,
}

impl<const D: usize> State for Saved<'_, D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let slots = self.fracture.strain.len();
        fields.reals("strain", &mut self.fracture.strain)?;
        fields.reals("onset", &mut self.fracture.onset)?;
        fields.reals("begun", &mut self.fracture.begun)?;
        fields.reals("damage", &mut self.fracture.damage)?;
        let Fracture { strain, onset, begun, damage, .. } = &*self.fracture;
        for (name, column) in [("strain", strain), ("onset", onset), ("begun", begun), ("damage", damage)] {
            fields.length(name, slots, column.len())?;
        }
        fields.real("taken", &mut self.fracture.taken)?;
        fields.numbers("cuts", self.cuts)?;
        fields.length("cuts", self.cuts.len() / 2 * 2, self.cuts.len())?;
        if self.fracture.friction > 0.0 { self.fracture.rubbing_fields(fields) } else { Ok(()) }
    }
}

impl<const D: usize> TotalLagrangian<D> {
    /// Visits what is damaged and cut; loading, it damages and cuts, before contacts are loaded.
    pub(in crate::total_lagrangian) fn fracture_fields(
        &mut self,
        fields: &mut Fields<'_>,
    ) -> Result<(), StateError> {
        let Some(fracture) = &mut self.fracture else { return Ok(()) };
        let mut cuts: Vec<u32> = fracture.cuts.iter().flatten().map(|&slot| slot as u32).collect();
        let mut saved = Saved { fracture, cuts: &mut cuts };
        fields.part("fracture", &mut saved)?;
        if !fields.loading() {
            return Ok(());
        }
        let slots = self.id.len();
        if cuts.iter().any(|&slot| slot as usize >= slots) {
            return Err(StateError::contradiction("cuts between other particles than the scene's"));
        }
        let damaged: Vec<usize> = (0..slots).filter(|&slot| fracture.strain[slot] > 0.0).collect();
        fracture.damaged = damaged.clone();
        fracture.cuts = cuts.chunks_exact(2).map(|pair| [pair[0] as usize, pair[1] as usize]).collect();
        let mut touched: Vec<usize> = fracture.cuts.iter().flatten().copied().collect();
        for &[i, j] in &fracture.cuts {
            self.pairs.cut(i, j);
        }
        touched.sort_unstable();
        touched.dedup();
        for slot in touched {
            self.correct_again(slot);
        }
        damaged.into_iter().for_each(|slot| self.soften(slot));
        if !cuts.is_empty() {
            self.note_ligaments();
            self.divide();
        }
        Ok(())
    }
}
