//! A simulation that left its bounds: who, where, which quantity.

use crate::Name;
use crate::half_step::Stage;
use crate::protocol::{Failure, StateHeader, status};
pub use halfstep_sph::quantity::Quantity;

/// A quantity is out of bounds: the run cannot go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diverged {
    /// Whose particle.
    pub participant: Name,
    /// Number of the particle; 0 where the quantity is that of a whole phase.
    pub particle: u32,
    /// Which quantity.
    pub quantity: Quantity,
    /// Value of the quantity; of an energy the part that nothing explains.
    pub value: f64,
    /// Step n.
    pub step: u64,
    /// Stage of the step.
    pub stage: Stage,
    /// Where, m.
    pub position: [f64; 3],
}

impl std::fmt::Display for Diverged {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { participant, particle, quantity, value, step, stage, position: [x, y, z] } = self;
        write!(f, "the {participant} diverged at step {step}, stage {stage}: ")?;
        match quantity {
            Quantity::Energy => write!(
                f,
                "its energy is {value:.4e} J above what its start, gravity and the other phase explain"
            ),
            Quantity::TimeStep => write!(f, "{quantity} is {value:.4e} s"),
            _ => write!(
                f,
                "{quantity} of particle {particle} is {value:.4e} {} at ({x:.6}, {y:.6}, {z:.6}) m",
                quantity.unit()
            ),
        }
    }
}

impl std::error::Error for Diverged {}

impl Diverged {
    /// A time step, s, with which the run would never end, from step n on.
    pub fn of_time_step(participant: Name, dt: f64, step: u64) -> Self {
        Self {
            participant,
            particle: 0,
            quantity: Quantity::TimeStep,
            value: dt,
            step,
            stage: Stage::First,
            position: [0.0; 3],
        }
    }

    /// Makes `header` the message that tells of this in the place of its sender's next state. `participants` are those
    /// of the run, in its order.
    pub fn write_to(&self, participants: &[Name], header: &mut StateHeader) {
        let place = participants.iter().position(|name| *name == self.participant);
        header.status = status::DIVERGED;
        header.failure = Failure {
            participant: place.unwrap_or_default() as u32,
            quantity: self.quantity as u32,
            particle: self.particle,
            reserved: 0,
            value: self.value,
            position: self.position,
        };
    }

    /// The divergence that a message of `sender` reports. The message takes the place of the state after the one that
    /// diverged.
    pub fn of_message(sender: Name, participants: &[Name], header: &StateHeader) -> Self {
        let failure = &header.failure;
        let (step, stage) = Stage::try_from(header.stage).unwrap_or(Stage::First).preceding(header.step);
        Self {
            participant: participants.get(failure.participant as usize).copied().unwrap_or(sender),
            particle: failure.particle,
            quantity: Quantity::from_wire(failure.quantity).unwrap_or(Quantity::Position),
            value: failure.value,
            step,
            stage,
            position: failure.position,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_by_energy_names_the_phase_and_no_particle() {
        let diverged = Diverged {
            participant: Name::FLUID,
            particle: 0,
            quantity: Quantity::Energy,
            value: 12.5,
            step: 7,
            stage: Stage::First,
            position: [0.0; 3],
        };
        let text = diverged.to_string();
        assert!(
            text.starts_with("the fluid diverged at step 7, stage 0: its energy is 1.2500e1 J above"),
            "{text}"
        );
        assert!(!text.contains("particle"), "{text}");
    }

    #[test]
    fn a_failure_passes_through_the_header_whoever_owns_the_particle() {
        let plate: Name = "plate".parse().unwrap();
        let participants = [Name::FLUID, plate, Name::SOLID];
        for (participant, sender) in [(plate, plate), (plate, Name::FLUID), (Name::FLUID, Name::FLUID)] {
            let diverged = Diverged {
                participant,
                particle: 7,
                quantity: Quantity::Speed,
                value: 250.0,
                step: 41,
                stage: Stage::Second,
                position: [1.0, 2.0, 0.0],
            };
            // The state of step 41, stage 1 was the last one: the message stands for step 42, stage 0.
            let mut header = StateHeader { step: 42, stage: 0, ..StateHeader::default() };
            diverged.write_to(&participants, &mut header);
            assert_eq!(header.status, status::DIVERGED);
            assert_eq!(Diverged::of_message(sender, &participants, &header), diverged);
        }
        // A number that stands for no participant is the sender's.
        let mut header = StateHeader { step: 42, ..StateHeader::default() };
        header.failure.participant = 9;
        assert_eq!(Diverged::of_message(plate, &participants, &header).participant, plate);
    }
}
