//! What an interface keeps over an interruption: the order of both records and where the lists were made, since sums
//! run in that order, and the plates' first positions, since their normals belong to the undeformed plate.

use super::screen::Screen;
use super::{Interface, InterfaceParticles};
use halfstep_sph::columns::bounds;
use halfstep_sph::neighbours::PADDING;
use halfstep_wire::order;
use halfstep_wire::state::{Fields, State, StateError};

impl<const D: usize> Interface<D> {
    /// Lists who is near whom, from the sides as they are sorted.
    pub(super) fn relist(&mut self) {
        let height = self.height();
        self.fluid_list.build(&self.fluid.position, &self.solid.position, self.solid.rows(), height);
        self.solid_list.build(&self.solid.position, &self.fluid.position, self.fluid.rows(), height);
        if let Some(stress) = &mut self.viscous_stress {
            stress.list(&self.solid, height);
        }
    }
}

impl<const D: usize> State for Interface<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.optional_count("epoch", &mut self.epoch)?;
        fields.part("fluid", &mut self.fluid)?;
        fields.part("solid", &mut self.solid)?;
        let mut first = self.screen.as_ref().map(Screen::first_positions).unwrap_or_default();
        fields.points("first_position", &mut first)?;
        if fields.loading() {
            self.screen = (!first.is_empty()).then(|| Screen::new(&self.parameters, &first));
        }
        Ok(())
    }

    fn restored(&mut self) -> Result<(), StateError> {
        if self.epoch.is_none() {
            return Ok(());
        }
        let height = self.height();
        self.fluid.restore(height)?;
        self.solid.restore(height)?;
        if self.screen.as_ref().is_some_and(|screen| screen.records() != self.solid.records()) {
            return Err(StateError::contradiction(
                "a plate's first positions are not those of the solid's records",
            ));
        }
        self.relist();
        Ok(())
    }
}

impl<const D: usize> State for InterfaceParticles<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.numbers("record", &mut self.record)?;
        fields.vectors("reference", &mut self.reference)?;
        self.reference.iter().try_for_each(|x| fields.length("reference", self.record.len(), x.len()))
    }
}

impl<const D: usize> InterfaceParticles<D> {
    /// The rows as they were when the lists were made, from the order and the positions of that time.
    fn restore(&mut self, height: f64) -> Result<(), StateError> {
        let particles = self.record.iter().filter(|&&r| r != PADDING).count();
        let wrong = "an interface's records are not numbered one by one";
        self.records = order::count(&self.record, particles, wrong)?;
        self.position.clone_from(&self.reference);
        let (x, around) = (&self.position, bounds(&self.position));
        order::sort_again(&mut self.rows, x, &self.record, height, around, "an interface's rows")?;
        self.fit_columns();
        Ok(())
    }
}
