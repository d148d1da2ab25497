//! A simulation that left its bounds: who, where, which quantity.

use serde::{Deserialize, Serialize};

/// The process, by what it owns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RoleName {
    /// Owns the fluid and the walls around it.
    Fluid,
    /// Owns the solid.
    Solid,
    /// Owns the clock and the cross-phase force.
    Coupler,
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

/// A bounded quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
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
}

impl Quantity {
    /// The quantity with this number on the wire.
    pub fn from_wire(number: u32) -> Option<Self> {
        [Self::Density, Self::Speed, Self::Position, Self::Stress, Self::TimeStep]
            .into_iter()
            .find(|q| *q as u32 == number)
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
        })
    }
}

/// A particle's quantity is out of bounds: the run cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[error(
    "the {role} diverged at step {step}, stage {stage}: {quantity} of particle {particle} is {value:e} at \
     ({}, {}, {})", position[0], position[1], position[2]
)]
pub struct Diverged {
    /// Whose particle.
    pub role: RoleName,
    /// Its number.
    pub particle: u32,
    /// Which quantity.
    pub quantity: Quantity,
    /// Its value.
    pub value: f64,
    /// Step n.
    pub step: u64,
    /// 0 or 1.
    pub stage: u32,
    /// Where, m.
    pub position: [f64; 3],
}
