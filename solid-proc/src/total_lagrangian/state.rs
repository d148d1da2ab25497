//! What the total-Lagrangian solid keeps over an interruption at a state n: displacements, velocities and the inner
//! acceleration, which the next sub-step begins with, what Maxwell arms remember, and the order of contacts. The
//! reference configuration and its pairs come from the scene, stresses and energies from the displacements.

use super::contact::Contact;
use super::fracture::Fracture;
use super::model::TotalLagrangian;
use halfstep_wire::state::{Fields, State, StateError};

impl<const D: usize> State for TotalLagrangian<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let slots = self.id.len();
        let mut id = self.id.clone();
        fields.numbers("id", &mut id)?;
        if id != self.id {
            return Err(StateError::contradiction("the solid's reference configuration is another one"));
        }
        fields.part("particles", &mut self.now)?;
        if !self.arms.is_empty() {
            fields.part("relaxation", &mut self.memory)?;
        }
        self.fracture_fields(fields)?;
        fields.part("shown_velocity", &mut self.shown_velocity)?;
        fields.count("pair_evaluations", &mut self.pair_evaluations)?;
        self.now.check_length(fields, "particles", slots)?;
        if let Some(account) = &mut self.account {
            fields.part("account", account)?;
        }
        match &mut self.contact {
            Some(contact) => fields.part("contact", contact),
            None => Ok(()),
        }
    }

    fn restored(&mut self) -> Result<(), StateError> {
        if let Some(contact) = &mut self.contact {
            contact.restored()?;
        }
        let (acceleration, evaluations) = (self.now.acceleration.clone(), self.pair_evaluations);
        self.evaluate(0.0);
        // Damping took the velocities in the middle of the last sub-step.
        self.now.acceleration = acceleration;
        self.fracture.iter_mut().for_each(Fracture::return_to_n);
        self.pair_evaluations = evaluations;
        self.keep_gradients();
        self.show_particles();
        Ok(())
    }
}

impl<const D: usize> State for Contact<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let body = self.bodies();
        fields.numbers("id", &mut self.id)?;
        fields.vectors("position_at_sort", &mut self.listed)?;
        self.listed.iter().try_for_each(|x| fields.length("position_at_sort", self.id.len(), x.len()))?;
        self.rest_fields(fields)?;
        if fields.loading() {
            self.reorder(&body)?;
        }
        Ok(())
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.list_at_sort()
    }
}
