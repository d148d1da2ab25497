//! Forces on the solids: contacts by pairs, and all of them by kind.

use serde::{Deserialize, Serialize};
use std::fmt;

/// What [`ContactReport::solids`] calls the walls of a scene: the name of no solid.
pub const WALLS: &str = "wall";

/// What contact did to a pair of solids or to the bodies of one, or walls to a solid, where the coupler evaluates it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ContactReport {
    /// Names of the two, of bodies of one solid twice its name; all walls together are [`WALLS`].
    pub solids: Vec<String>,
    /// Pressure over penetration, Pa/m.
    pub stiffness: f64,
    /// Energy that both got by normal forces, J (2D: J/m); negative: impacts took it.
    pub normal: f64,
    /// Energy that both got by friction, J (2D: J/m); negative: friction took it.
    pub friction: f64,
    /// Largest force on one of the two, N (2D: N/m).
    pub largest_force: f64,
    /// Largest penetration, m.
    pub largest_penetration: f64,
}

/// Kinds of forces that a solid gets from outside of its own program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ForceKind {
    /// Pressure, or stress, of the fluid.
    #[default]
    Stress,
    /// f_i, and the viscous stress across the interface.
    CrossViscosity,
    /// Contact with other solids.
    Contact,
    /// Contact with walls, where the coupler evaluates it.
    Walls,
}

impl ForceKind {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 4] = [Self::Stress, Self::CrossViscosity, Self::Contact, Self::Walls];
}

impl fmt::Display for ForceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stress => "stress",
            Self::CrossViscosity => "cross-viscosity",
            Self::Contact => "contact",
            Self::Walls => "walls",
        })
    }
}

/// What a kind of force did to a solid over the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ForceReport {
    /// Name of the solid.
    pub solid: String,
    /// Kind of the force.
    pub kind: ForceKind,
    /// Impulse, N s (2D: N s/m).
    pub impulse: [f64; 3],
    /// Work, J (2D: J/m).
    pub work: f64,
    /// Largest force in size, N (2D: N/m).
    pub largest: f64,
}
