//! A simulation that left its bounds: who, where, which quantity.

use crate::half_step::Stage;
use crate::protocol::{StateHeader, status};
pub use halfstep_sph::quantity::Quantity;

/// The process, by what it owns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RoleName {
    /// Owns the fluid and the walls around it.
    Fluid,
    /// Owns the solid.
    Solid,
    /// Owns the clock and the cross-phase force.
    Coupler,
}

impl RoleName {
    /// The other phase. The coupler has none and is its own.
    pub fn peer(self) -> Self {
        match self {
            Self::Fluid => Self::Solid,
            Self::Solid => Self::Fluid,
            Self::Coupler => Self::Coupler,
        }
    }
}

impl std::fmt::Display for RoleName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Fluid => "fluid",
            Self::Solid => "solid",
            Self::Coupler => "coupler",
        })
    }
}

/// A quantity is out of bounds: the run cannot go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diverged {
    /// Whose particle.
    pub role: RoleName,
    /// Its number; 0 where the quantity is no particle's.
    pub particle: u32,
    /// Which quantity.
    pub quantity: Quantity,
    /// Its value; of an energy what nothing explains.
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
        let Self { role, particle, quantity, value, step, stage, position: [x, y, z] } = self;
        write!(f, "the {role} diverged at step {step}, stage {stage}: ")?;
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

/// Added to the quantity's number on the wire where the particle is not the sender's but the other phase's.
const OF_PEER: u32 = 16;

impl Diverged {
    /// Makes `header` the message of `sender` that tells of this in the place of its next state.
    pub fn tell(&self, sender: RoleName, header: &mut StateHeader) {
        header.status = status::DIVERGED;
        header.failure_quantity = self.quantity as u32 + if self.role == sender { 0 } else { OF_PEER };
        header.failure_particle = self.particle;
        header.failure_value = self.value;
        header.failure_position = self.position;
    }

    /// What a message of `sender` tells. It takes the place of the state after the one that diverged.
    pub fn told(sender: RoleName, header: &StateHeader) -> Self {
        let number = header.failure_quantity;
        let (role, number) =
            if number > OF_PEER { (sender.peer(), number - OF_PEER) } else { (sender, number) };
        let (step, stage) = Stage::try_from(header.stage).unwrap_or(Stage::First).preceding(header.step);
        Self {
            role,
            particle: header.failure_particle,
            quantity: Quantity::from_wire(number).unwrap_or(Quantity::Position),
            value: header.failure_value,
            step,
            stage,
            position: header.failure_position,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_energy_is_the_phases_and_no_particles() {
        let diverged = Diverged {
            role: RoleName::Fluid,
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
    fn what_is_told_arrives_whoever_owns_the_particle() {
        for (role, sender) in [
            (RoleName::Solid, RoleName::Solid),
            (RoleName::Solid, RoleName::Fluid),
            (RoleName::Fluid, RoleName::Fluid),
        ] {
            let diverged = Diverged {
                role,
                particle: 7,
                quantity: Quantity::Speed,
                value: 250.0,
                step: 41,
                stage: Stage::Second,
                position: [1.0, 2.0, 0.0],
            };
            // The state of step 41, stage 1 was the last one: the message stands for step 42, stage 0.
            let mut header = StateHeader { step: 42, stage: 0, ..StateHeader::default() };
            diverged.tell(sender, &mut header);
            assert_eq!(header.status, status::DIVERGED);
            assert_eq!(Diverged::told(sender, &header), diverged);
        }
    }
}
