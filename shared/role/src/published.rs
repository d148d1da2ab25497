//! What a participant said of its state when it published it: the part of a checkpoint that belongs to the exchange.

use halfstep_wire::protocol::{Audit, StateHeader};
use halfstep_wire::state::{Fields, State, StateError};

/// The state message that a checkpoint was made of, but for its records.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Published {
    /// Step n.
    pub step: u64,
    /// Its time, s.
    pub time: f64,
    dt_limit: f64,
    displacement: f64,
    sub_steps: u32,
    audit: Audit,
}

impl Published {
    /// What a message says of its state.
    pub fn of(header: &StateHeader) -> Self {
        let StateHeader { step, time, dt_limit, displacement, sub_steps, audit, .. } = *header;
        Self { step, time, dt_limit, displacement, sub_steps, audit }
    }

    /// The message as it was.
    pub fn header(&self, now: StateHeader) -> StateHeader {
        let Self { step, time, dt_limit, displacement, sub_steps, audit } = *self;
        StateHeader { step, time, dt_limit, displacement, sub_steps, audit, ..now }
    }
}

impl State for Published {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.count("step", &mut self.step)?;
        fields.real("time", &mut self.time)?;
        fields.real("dt_limit", &mut self.dt_limit)?;
        fields.real("displacement", &mut self.displacement)?;
        fields.small_count("sub_steps", &mut self.sub_steps)?;
        fields.group("audit", |fields| {
            fields.vector("momentum", &mut self.audit.momentum)?;
            fields.real("kinetic_energy", &mut self.audit.kinetic_energy)?;
            fields.real("mass", &mut self.audit.mass)?;
            fields.real("density_error", &mut self.audit.density_error)?;
            fields.real("gap", &mut self.audit.gap)?;
            fields.real("stored_energy", &mut self.audit.stored_energy)
        })
    }
}
