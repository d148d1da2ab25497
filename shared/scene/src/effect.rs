//! The closed list of effects that a scene may switch. Each has a file of its own with its equation and source; the
//! program derives from the scene whether it takes part, and says why.

use super::Scene;
use serde::{Deserialize, Serialize};

/// The effects of the fluid, one line each: documentation, type, name in the scene, module in the fluid's crate
/// (`fluid-proc/src/effects`). Hands the list to another macro; the fluid takes its effects and passes from it.
#[macro_export]
macro_rules! fluid_effects {
    ($then:ident) => {
        $then! {
            /// Artificial viscosity between fluid particles.
            ArtificialViscosity "artificial-viscosity" artificial_viscosity,
            /// Diffusion of density, in the variant that `fluid.density_diffusion` names.
            DensityDiffusion "density-diffusion" density_diffusion,
            /// Physical viscosity of the fluid.
            Viscosity "viscosity" viscosity,
            /// The renormalised density gradient of delta-SPH is computed once a step.
            FrozenDiffusion "frozen-diffusion" frozen_diffusion,
            /// Strong artificial viscosity between fluid and free-slip walls that are close.
            WallGuard "wall-guard" wall_guard,
            /// Pressure shown by walls, and by the solid as moving wall, is never negative.
            NonNegativeWallPressure "non-negative-wall-pressure" non_negative_wall_pressure,
            /// Thin plates show the fluid on each face a pressure of its own.
            ThinPlateScreen "thin-plate-screen" thin_plate_screen,
            /// Velocities decay where waves are to be absorbed.
            Beach "beach" beach,
            /// Particles are moved from where they are close to where they are few.
            ParticleShifting "particle-shifting" particle_shifting,
            /// Water that leaves a wall or a solid is not thinned out by the velocity that it shows.
            WallSeparation "wall-separation" wall_separation,
            /// Continuity takes no part of the tangential velocity that walls without slip show.
            NoSlipContinuity "no-slip-continuity" no_slip_continuity,
            /// Viscous stress between fluid and solid.
            InterfaceViscosity "interface-viscosity" interface_viscosity,
        }
    };
}

macro_rules! effect_names {
    ($($(#[$doc:meta])* $effect:ident $name:literal $module:ident,)*) => {
        names! {
            $($(#[$doc])* $effect $name,)*
            /// Artificial stress in the solid.
            ArtificialStress "artificial-stress",
            /// Renormalised velocity gradient in the solid.
            RenormalisedGradient "renormalised-gradient",
            /// Clamps hold the total-Lagrangian solid at their boxes' faces.
            ClampFace "clamp-face",
            /// Clamps act on the hypoelastic solid as walls do.
            WallClamp "wall-clamp",
            /// Walls hold values toward the hypoelastic solid and take part in its sums.
            WallParticles "wall-particles",
            /// Rigid walls toward the solid.
            WallContact "wall-contact",
            /// A solid that rests is not computed until fluid comes near.
            SleepingSolid "sleeping-solid",
            /// Stress that relaxes in the total-Lagrangian solid.
            Relaxation "relaxation",
            /// Friction on the faces of a solid that two dimensions do not see.
            SideFriction "side-friction",
            /// Cracks in the total-Lagrangian solid.
            Fracture "fracture",
            /// Friction between fragments, crack faces and walls.
            FragmentFriction "fragment-friction",
        }
    };
}

macro_rules! names {
    ($($(#[$doc:meta])* $effect:ident $name:literal,)*) => {
        /// Effects that the program derives from the scene and the user may force.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum EffectName {
            $($(#[$doc])* $effect,)*
        }

        impl EffectName {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$effect,)*];

            /// Name of the effect in scenes and reports.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$effect => $name,)*
                }
            }
        }
    };
}

fluid_effects!(effect_names);

/// A forced effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Switch {
    /// The program decides.
    Auto,
    /// Always.
    On,
    /// Never.
    Off,
}

/// Whether an effect takes part, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    /// The effect's name.
    pub name: &'static str,
    /// The effect takes part.
    pub on: bool,
    /// The scene's key or the fact that decided.
    pub why: String,
}

/// What a scene says about an effect before the user's switch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Derived {
    /// There is nothing that it could act on: the switch does not matter.
    Impossible(String),
    /// On.
    On(String),
    /// Off.
    Off(String),
}

impl Decision {
    /// The user's switch decides where the effect is possible; else what follows from the scene.
    pub fn new(scene: &Scene, effect: EffectName, derived: Derived) -> Self {
        Self::of(effect.name(), scene.switch(effect), derived)
    }

    /// The same of an effect that the program knows and this crate does not ([`crate::load_with`]).
    pub fn own(scene: &Scene, name: &'static str, derived: Derived) -> Self {
        Self::of(name, scene.own_effects.get(name).copied().unwrap_or(Switch::Auto), derived)
    }

    fn of(name: &'static str, switch: Switch, derived: Derived) -> Self {
        let key = |word: &str| format!("effects.{name} is \"{word}\"");
        let (on, why) = match (derived, switch) {
            (Derived::Impossible(why), _) => (false, why),
            (_, Switch::On) => (true, key("on")),
            (_, Switch::Off) => (false, key("off")),
            (Derived::On(why), Switch::Auto) => (true, why),
            (Derived::Off(why), Switch::Auto) => (false, why),
        };
        Self { name, on, why }
    }
}

impl Scene {
    /// What the user wants of an effect.
    pub fn switch(&self, effect: EffectName) -> Switch {
        self.effects.get(&effect).copied().unwrap_or(Switch::Auto)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn names_are_those_of_the_files() {
        for effect in EffectName::ALL {
            assert_eq!(serde_json::to_value(effect).unwrap(), effect.name());
        }
    }

    #[test]
    fn the_switch_beats_the_derivation_but_not_the_impossible() {
        let text = "resolution = 0.01\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"w\"\n\
                    phase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.1, 0.1] }\n[effects]\nviscosity = \"off\"\n";
        let scene = crate::parse(text, Path::new("x.toml"), &[]).unwrap();
        let decide = |effect, derived| {
            let d = Decision::new(&scene, effect, derived);
            (d.on, d.why)
        };
        let off = (false, "effects.viscosity is \"off\"".to_owned());
        assert_eq!(decide(EffectName::Viscosity, Derived::On("it matters".into())), off);
        assert_eq!(decide(EffectName::WallGuard, Derived::On("walls".into())), (true, "walls".into()));
        let none = Derived::Impossible("no mu".into());
        assert_eq!(decide(EffectName::Viscosity, none), (false, "no mu".into()));
    }
}
