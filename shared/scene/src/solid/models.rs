//! The solid models that come with the program, and what each asks of a scene.

use super::{finite_element, hypoelastic, rigid, total_lagrangian};
use crate::keys::Key;
use crate::preset::Defaults;
use crate::section::{Range, Section};
use serde::{Deserialize, Serialize};

/// The solid models, one line each: documentation, type, name in the scene, module, type of its keys. Hands the list to
/// another macro; the solid's crate builds models and decides on effects from it.
#[macro_export]
macro_rules! solid_models {
    ($then:ident) => {
        $then! {
            /// Hooke's law in rate form with the Jaumann rate (Gray, Monaghan and Swift 2001).
            Hypoelastic "hypoelastic" hypoelastic HypoelasticKeys,
            /// Hyperelastic, with neighbours of the reference configuration (Bonet and Lok 1999).
            TotalLagrangian "total-lagrangian" total_lagrangian TotalLagrangianKeys,
            /// Squares with one point of integration on the particles' cells (Belytschko and Bachrach 1986).
            FiniteElement "finite-element" finite_element FiniteElementKeys,
            /// Bodies that do not strain, held by joints, in contact with walls and each other.
            Rigid "rigid" rigid RigidKeys,
        }
    };
}

/// What a model asks of a scene, besides reading its own keys.
pub(crate) struct Rules {
    /// The solid's own h / dx.
    pub(crate) smoothing: Range,
    /// The defaults of keys that all models have, from those of the preset.
    pub(crate) defaults: fn(Defaults) -> Defaults,
    /// Keys that only this model has, and why.
    pub(crate) keys: &'static [(&'static str, &'static str)],
    /// Fewest rows of particles across a shape.
    pub(crate) rows: u8,
    /// Why it cannot be phase-blind, where it cannot.
    pub(crate) not_phase_blind: Option<&'static str>,
    /// Largest `numerics.solid_cfl`, and why, where it is below what that key allows.
    pub(crate) largest_cfl: Option<(f64, &'static str)>,
    /// It does not strain: it has no elastic constants.
    pub(crate) rigid: bool,
}

macro_rules! registry {
    ($($(#[$doc:meta])* $model:ident $name:literal $module:ident $keys:ident,)*) => {
        /// The solid models that come with the program.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum SolidModelName {
            $($(#[$doc])* $model,)*
        }

        /// A model's name, with the keys that only this model has.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "model", rename_all = "kebab-case")]
        pub enum ModelKeys {
            $($(#[$doc])* $model($module::$keys),)*
        }

        /// Keys that only some models have.
        pub(crate) const MODEL_KEYS: &[&[Key]] = &[$($module::KEYS,)*];

        impl SolidModelName {
            /// All of them, by their name in scenes.
            pub const ALL: &[(&str, Self)] = &[$(($name, Self::$model),)*];

            /// Name of the model in scenes.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$model => $name,)*
                }
            }

            pub(crate) fn rules(self) -> &'static Rules {
                match self {
                    $(Self::$model => &$module::RULES,)*
                }
            }

            /// Reads the keys that only this model has.
            pub(crate) fn read(self, section: &Section<'_>, defaults: &Defaults) -> ModelKeys {
                match self {
                    $(Self::$model => ModelKeys::$model($module::$keys::read(section, defaults)),)*
                }
            }
        }

        impl ModelKeys {
            /// Which model.
            pub fn name(&self) -> SolidModelName {
                match self {
                    $(Self::$model(_) => SolidModelName::$model,)*
                }
            }
        }
    };
}

solid_models!(registry);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_files() {
        for (name, model) in SolidModelName::ALL {
            assert_eq!(serde_json::to_value(model).unwrap(), *name);
            assert_eq!(model.name(), *name);
        }
    }
}
