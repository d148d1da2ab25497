//! Quantities that a simulation keeps within bounds.

/// A bounded quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Quantity {
    /// Density, kg/m³.
    Density = 1,
    /// Speed, m/s.
    Speed = 2,
    /// Position, m.
    Position = 3,
    /// Stress, Pa.
    Stress = 4,
    /// Time step, s.
    TimeStep = 5,
    /// Energy of a whole phase, J.
    Energy = 6,
}

impl Quantity {
    /// The quantity with this number on the wire.
    pub fn from_wire(number: u32) -> Option<Self> {
        [Self::Density, Self::Speed, Self::Position, Self::Stress, Self::TimeStep, Self::Energy]
            .into_iter()
            .find(|q| *q as u32 == number)
    }

    /// Unit of the quantity.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Density => "kg/m³",
            Self::Speed => "m/s",
            Self::Position => "m",
            Self::Stress => "Pa",
            Self::TimeStep => "s",
            Self::Energy => "J",
        }
    }
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Density => "density",
            Self::Speed => "speed",
            Self::Position => "position",
            Self::Stress => "stress",
            Self::TimeStep => "time step",
            Self::Energy => "energy",
        })
    }
}
