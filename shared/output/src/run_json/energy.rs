//! The energy ledgers of all participants.

use super::ContactReport;
use halfstep_scene::{EnergyEntry, EnergyPart};
use serde::{Deserialize, Serialize};

/// The energy ledgers of all participants, J (2D: J/m).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct EnergyReport {
    /// Error of time integration: the largest at any step, sum over the participants.
    pub residual: f64,
    /// The same over the largest energy exchanged.
    pub relative_residual: f64,
    /// The largest change of a part of a ledger since the start.
    pub largest: Option<LargestEnergy>,
    /// What both sides of the interfaces were given together: energy that the exchange made, or lost if negative;
    /// `null` where a side is another program's.
    pub interface: Option<InterfaceEnergy>,
    /// The ledgers, in the order of the participants.
    pub participants: Vec<ParticipantEnergy>,
}

/// The largest energy exchanged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LargestEnergy {
    /// Whose.
    pub participant: String,
    /// Which part.
    pub part: EnergyPart,
    /// How much, J (2D: J/m).
    pub joules: f64,
}

/// Energy of the exchange between fluid and solids, J (2D: J/m).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InterfaceEnergy {
    /// By pressure; phase-blind by stress.
    pub pressure: f64,
    /// By f_i and by viscous stress.
    pub cross_viscosity: f64,
}

/// A participant's energy ledger.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParticipantEnergy {
    /// Name of the participant.
    pub name: String,
    /// What it holds, what it was given since the start, and the rest.
    pub parts: Vec<EnergyEntry>,
}

impl EnergyReport {
    /// From the ledgers of those participants that kept one; `complete`: all did. `None` where nobody did. The work of
    /// contacts, which solids book as pressure of the interface, is none of the exchange with the fluid.
    pub fn of(
        participants: Vec<ParticipantEnergy>,
        complete: bool,
        contacts: &[ContactReport],
    ) -> Option<Self> {
        let all = || participants.iter().flat_map(|own| own.parts.iter().map(move |entry| (own, entry)));
        let exchanged = all().filter(|(_, entry)| entry.part != EnergyPart::Integration);
        let largest = exchanged.max_by(|a, b| a.1.largest.total_cmp(&b.1.largest)).map(|(own, entry)| {
            LargestEnergy { participant: own.name.clone(), part: entry.part, joules: entry.largest }
        })?;
        let of = |part: EnergyPart| all().map(|(_, entry)| entry).filter(move |entry| entry.part == part);
        let residual = of(EnergyPart::Integration).map(|entry| entry.largest).sum();
        let given = |part| of(part).map(|entry| entry.joules).sum();
        let relative_residual = if largest.joules > 0.0 { residual / largest.joules } else { 0.0 };
        let interface = InterfaceEnergy {
            pressure: given(EnergyPart::InterfacePressure)
                - contacts.iter().map(|contact| contact.normal + contact.friction).sum::<f64>(),
            cross_viscosity: given(EnergyPart::CrossViscosity),
        };
        let interface = (complete && participants.len() > 1).then_some(interface);
        Some(Self { residual, relative_residual, largest: Some(largest), interface, participants })
    }

    /// A part of a participant's ledger, J (2D: J/m).
    pub fn joules(&self, participant: &str, part: EnergyPart) -> Option<f64> {
        let own = self.participants.iter().find(|own| own.name == participant)?;
        own.parts.iter().find(|entry| entry.part == part).map(|entry| entry.joules)
    }
}
