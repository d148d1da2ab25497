//! The parts of an energy ledger: what a participant holds, what it is given, and where energy is lost.

use super::{EffectName, Phase, ProbeKind, Scene};
use serde::{Deserialize, Serialize};

macro_rules! parts {
    ($($(#[$doc:meta])* $part:ident $name:literal,)*) => {
        /// A part of a participant's energy ledger.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum EnergyPart {
            $($(#[$doc])* $part,)*
        }

        impl EnergyPart {
            /// All parts, of fluid and solids.
            pub const ALL: &'static [Self] = &[$(Self::$part,)*];
            const NAMES: &'static [&'static str] = &[$($name,)*];
        }
    };
}

parts! {
    /// Held: kinetic energy.
    Kinetic "kinetic",
    /// Held by the fluid: work that compressed it, from the equation of state.
    Compression "compression",
    /// Held by a solid: strain energy, that of Maxwell arms, of the hourglass force and of contacts between bodies.
    Strain "strain",
    /// Held: potential energy of gravity, above that of the first state.
    Potential "potential",
    /// Given by the artificial viscosity.
    ArtificialViscosity "artificial-viscosity",
    /// Given by the wall guard.
    WallGuard "wall-guard",
    /// Given by the viscosity.
    Viscosity "viscosity",
    /// Given by the density diffusion.
    DensityDiffusion "density-diffusion",
    /// Given by the shifting of particles, against gravity.
    ParticleShifting "particle-shifting",
    /// Given where water that leaves walls is not thinned out.
    WallSeparation "wall-separation",
    /// Given by the beach.
    Beach "beach",
    /// Given by an effect that is not on the program's list.
    FurtherEffect "further-effect",
    /// Given by the pressure of walls, beside the work of their motion: an error of the walls' extrapolation.
    WallPressure "wall-pressure",
    /// Given by walls that move: the force on the participant along the walls' motion.
    MovingWalls "moving-walls",
    /// Given across the interface by pressure; phase-blind by stress.
    InterfacePressure "interface-pressure",
    /// Given across the interface by f_i and by viscous stress.
    CrossViscosity "cross-viscosity",
    /// Given by pressure and continuity between fluid particles, whose sums do not cancel where densities differ.
    Continuity "continuity",
    /// Taken along by particles that left the domain.
    Outflow "outflow",
    /// Given by the Maxwell arms.
    Relaxation "relaxation",
    /// Given by side friction.
    SideFriction "side-friction",
    /// Given by fracture: what damage and cuts of pairs take.
    Fracture "fracture",
    /// Given by friction between fragments, crack faces and walls.
    FragmentFriction "fragment-friction",
    /// Given by tractions that the scene prescribes.
    Loads "loads",
    /// Given by contact with walls, beside the work of their motion.
    WallContact "wall-contact",
    /// Given by the artificial stress.
    ArtificialStress "artificial-stress",
    /// Given by clamps that move.
    Clamps "clamps",
    /// Given by the stress of a solid whose strain energy does not follow from a deformation.
    Stress "stress",
    /// Given by nobody: the error of time integration.
    Integration "integration",
}

/// A part of a ledger at the end of a run, J (2D: J/m).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnergyEntry {
    /// Which.
    pub part: EnergyPart,
    /// Held at the end, or given since the start.
    pub joules: f64,
    /// Largest change since the start.
    pub largest: f64,
}

/// Number of parts that are held; they come first.
pub(crate) const HELD: usize = 3;

const FLUID: [EnergyPart; 18] = {
    use EnergyPart::*;
    [
        Kinetic,
        Compression,
        Potential,
        ArtificialViscosity,
        WallGuard,
        Viscosity,
        DensityDiffusion,
        ParticleShifting,
        WallSeparation,
        Beach,
        FurtherEffect,
        WallPressure,
        MovingWalls,
        InterfacePressure,
        CrossViscosity,
        Continuity,
        Outflow,
        Integration,
    ]
};

const SOLID: [EnergyPart; 17] = {
    use EnergyPart::*;
    [
        Kinetic,
        Strain,
        Potential,
        ArtificialViscosity,
        ArtificialStress,
        Relaxation,
        SideFriction,
        Fracture,
        FragmentFriction,
        Loads,
        WallContact,
        MovingWalls,
        Clamps,
        Stress,
        InterfacePressure,
        CrossViscosity,
        Integration,
    ]
};

impl EnergyPart {
    /// Name of the part in scenes and reports.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// The parts of a phase's ledger: what it holds, what it is given, and the rest.
    pub fn of(phase: Phase) -> &'static [Self] {
        match phase {
            Phase::Solid => &SOLID,
            _ => &FLUID,
        }
    }

    /// Names of the parts of a phase's ledger, or of one of them.
    pub(crate) fn names(phase: Phase, part: Option<Self>) -> Vec<String> {
        let own = Self::of(phase).iter().filter(|own| part.is_none_or(|part| part == **own));
        own.map(|own| own.name().to_owned()).collect()
    }

    /// What an effect of the fluid of this name gives.
    pub fn of_effect(name: &str) -> Self {
        // It belongs to the work of the walls' pressure, which takes continuity's part with it.
        if name == EffectName::NoSlipContinuity.name() {
            return Self::WallPressure;
        }
        FLUID.into_iter().find(|part| part.name() == name).unwrap_or(Self::FurtherEffect)
    }

    /// The participant holds this energy; else it is given it.
    pub const fn is_held(self) -> bool {
        matches!(self, Self::Kinetic | Self::Compression | Self::Strain | Self::Potential)
    }
}

impl Scene {
    /// A probe asks for energies: all participants then keep their ledgers.
    pub fn keeps_energy_ledgers(&self) -> bool {
        self.probes.iter().any(|probe| matches!(probe.kind, ProbeKind::Energy { .. }))
    }
}

const _: () = assert!(FLUID[HELD - 1].is_held() && !FLUID[HELD].is_held());
const _: () = assert!(SOLID[HELD - 1].is_held() && !SOLID[HELD].is_held());

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_scenes_and_files() {
        for part in EnergyPart::ALL {
            assert_eq!(serde_json::to_string(part).unwrap(), format!("\"{}\"", part.name()));
        }
        assert_eq!(EnergyPart::names(Phase::Solid, Some(EnergyPart::Strain)), ["strain"]);
        assert_eq!(EnergyPart::names(Phase::Fluid, None)[..3], ["kinetic", "compression", "potential"]);
    }
}
