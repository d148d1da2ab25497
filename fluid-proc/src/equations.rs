//! Which of the fluid's two equations a stage needs the rates of: passes leave out the other one.

use halfstep_scene::FluidIntegration;
use halfstep_wire::half_step::Stage;

/// The equations whose rates a pass gives, known when it is compiled.
pub trait Equations: Copy + Send + Sync {
    /// Which they are.
    const NEEDED: Needed;
    /// Accelerations.
    const MOMENTUM: bool = Self::NEEDED.momentum();
    /// Rates of the density.
    const CONTINUITY: bool = Self::NEEDED.continuity();
}

/// Momentum and continuity.
#[derive(Clone, Copy, Debug)]
pub struct Both;
/// The momentum equation alone.
#[derive(Clone, Copy, Debug)]
pub struct Momentum;
/// The continuity equation alone.
#[derive(Clone, Copy, Debug)]
pub struct Continuity;

impl Equations for Both {
    const NEEDED: Needed = Needed::Both;
}
impl Equations for Momentum {
    const NEEDED: Needed = Needed::Momentum;
}
impl Equations for Continuity {
    const NEEDED: Needed = Needed::Continuity;
}

/// The same, known in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needed {
    /// Momentum and continuity.
    Both,
    /// The momentum equation alone.
    Momentum,
    /// The continuity equation alone.
    Continuity,
}

impl Needed {
    /// What a stage needs.
    pub const fn at(stage: Stage, integration: FluidIntegration) -> Self {
        match (integration, stage) {
            (FluidIntegration::Midpoint, _) => Self::Both,
            (FluidIntegration::Verlet, Stage::First) => Self::Continuity,
            (FluidIntegration::Verlet, Stage::Second) => Self::Momentum,
        }
    }

    /// What the stages of a step need, each once.
    pub const fn in_a_step(integration: FluidIntegration) -> &'static [Self] {
        match integration {
            FluidIntegration::Midpoint => &[Self::Both],
            FluidIntegration::Verlet => &[Self::Continuity, Self::Momentum],
        }
    }

    /// Accelerations are needed.
    pub const fn momentum(self) -> bool {
        !matches!(self, Self::Continuity)
    }

    /// Rates of the density are needed.
    pub const fn continuity(self) -> bool {
        !matches!(self, Self::Momentum)
    }
}
