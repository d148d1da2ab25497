//! What the finite-element solid keeps over an interruption at a state n: nodes and the order of contacts. The mesh
//! comes from the scene, stresses and energies from the displacements.

use super::model::FiniteElement;
use halfstep_wire::state::{Fields, State, StateError};

impl<const D: usize> State for FiniteElement<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let nodes = self.mesh.nodes();
        fields.part("nodes", &mut self.now)?;
        fields.part("shown_velocity", &mut self.shown_velocity)?;
        fields.count("evaluations", &mut self.evaluations)?;
        self.now.check_length(fields, "nodes", nodes)?;
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
        self.show_restored();
        Ok(())
    }
}
