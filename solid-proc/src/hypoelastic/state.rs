//! What the hypoelastic solid keeps over an interruption at a state n: the particles in the order of their slots, where
//! they were at the last sort, and the velocity that the fluid is shown.

use super::columns::{Source, State as Columns};
use super::model::Hypoelastic;
use halfstep_sph::columns::fit;
use halfstep_sph::lane::LANES;
use halfstep_wire::order;
use halfstep_wire::state::{Fields, State, StateError};

impl<const D: usize> State for Hypoelastic<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.numbers("id", &mut self.id)?;
        fields.part("particles", &mut self.now)?;
        fields.part("shown_velocity", &mut self.shown_velocity)?;
        fields.vectors("position_at_sort", &mut self.reference)?;
        fields.count("pair_evaluations", &mut self.pair_evaluations)?;
        if let Some(walls) = &mut self.walls {
            walls.fields(fields)?;
            fields.real("wall_springs", &mut self.wall_springs)?;
        }
        let slots = self.id.len();
        fields.length("particles/density", slots, self.now.density.len())?;
        let columns = [&self.now.position, &self.now.velocity, &self.reference];
        columns.into_iter().flatten().try_for_each(|column| fields.length("id", column.len(), slots))?;
        for a in 0..D {
            for b in a..D {
                fields.length("particles/stress", slots, self.now.stress[a][b].len())?;
            }
        }
        Ok(())
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.number_slots()?;
        if !self.id.len().is_multiple_of(LANES) {
            return Err(StateError::contradiction("the solid's slots are not in fours"));
        }
        self.sort_rows_at_reference()?;
        // Both are overwritten when a step begins; until then only their lengths count.
        self.at_n = self.now.clone();
        self.step_start = self.now.clone();
        let slots = self.id.len();
        fit(&mut self.pressure, slots, 0.0);
        fit(&mut self.sources, slots, Source::ZERO);
        if self.artificial_stress.is_some() {
            fit(&mut self.artificial, slots, [[0.0; D]; D]);
        }
        self.rates.resize(slots);
        if let Some(walls) = &mut self.walls {
            walls.return_to_lists();
        }
        self.list();
        self.apply_state_equation();
        self.show_particles();
        Ok(())
    }
}

impl<const D: usize> Hypoelastic<D> {
    /// The slot of each particle, from the numbers of the slots.
    fn number_slots(&mut self) -> Result<(), StateError> {
        let all = self.slot_of.len();
        if order::count(&self.id, all, "the solid's particles are not those of the scene")? != all {
            return Err(StateError::contradiction("a particle of the solid is missing"));
        }
        self.slot_particles();
        Ok(())
    }
}

impl<const D: usize> State for Columns<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.vectors("position", &mut self.position)?;
        fields.vectors("velocity", &mut self.velocity)?;
        fields.reals("density", &mut self.density)?;
        for a in 0..D {
            for b in a..D {
                fields.reals(
                    &format!("stress_{}{}", ["x", "y", "z"][a], ["x", "y", "z"][b]),
                    &mut self.stress[a][b],
                )?;
            }
        }
        Ok(())
    }
}
