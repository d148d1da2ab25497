//! `contact` of a solid: how it touches walls and, a rigid one, its own bodies.

use super::{ModelKeys, Solid};
use crate::keys::{Key, Table};
use crate::section::{Range, Section};
use serde::{Deserialize, Serialize};

/// The law of contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactKeys {
    /// Coulomb's coefficient of friction, sticking and sliding.
    pub friction: f64,
    /// Normal speed after an impact over that before it.
    pub restitution: f64,
}

pub(crate) const FRICTION: Range = Range::at_least(0.0).up_to(100.0).why("it is Coulomb's coefficient");
pub(crate) const RESTITUTION: Range =
    Range::at_least(0.0).up_to(1.0).why("it is the speed after an impact over the one before");

pub(crate) static TABLE: Table = Table::new(
    "solid_contact",
    "How a solid touches walls; a rigid one: its own bodies, too.",
    &[
        Key::number("friction", FRICTION, "Coulomb's coefficient, sticking and sliding.").default("0.0"),
        Key::number("restitution", RESTITUTION, "Normal speed after an impact over that before it.")
            .default("0.0"),
    ],
);

impl ContactKeys {
    /// `None` where the section says nothing of contact.
    pub(super) fn read(section: &Section<'_>) -> Option<Self> {
        let contact = section.section("contact");
        let keys = Self {
            friction: contact.number("friction", Some(0.0)),
            restitution: contact.number("restitution", Some(0.0)),
        };
        let said = contact.is_present();
        contact.finish();
        said.then_some(keys)
    }
}

impl Solid {
    /// What the scene says of its contact.
    pub fn contact(&self) -> Option<ContactKeys> {
        match &self.model {
            ModelKeys::Rigid(keys) => Some(keys.contact),
            ModelKeys::Hypoelastic(keys) => keys.contact,
            ModelKeys::TotalLagrangian(keys) => keys.contact,
            ModelKeys::FiniteElement(keys) => keys.contact,
        }
    }
}
