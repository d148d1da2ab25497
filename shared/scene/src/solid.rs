//! The solid's section of a scene: what all models have. What only one has is in its file in `solid`.

mod contact;
mod finite_element;
mod fracture;
mod hypoelastic;
mod models;
mod rigid;
mod total_lagrangian;

pub use contact::ContactKeys;
pub(crate) use contact::{FRICTION, RESTITUTION, TABLE as CONTACT};
pub use finite_element::{FiniteElementKeys, TimeIntegration};
pub use fracture::Fracture;
pub use hypoelastic::{ArtificialStress, HypoelasticKeys};
pub(crate) use models::MODEL_KEYS;
pub use models::{ModelKeys, SolidModelName};
pub use rigid::{Joint, JointKind, RigidBody, RigidKeys};
pub use total_lagrangian::{Material, Plane, TotalLagrangianKeys};

use super::ArtificialViscosity;
use serde::{Deserialize, Serialize};

/// A solid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solid {
    /// Name of the solid: `solid` for `[solid]`, else the section's.
    pub name: String,
    /// Name of the process that serves it.
    pub process: String,
    /// Worker threads for it.
    pub threads: usize,
    /// Which model computes it, with the keys that only this model has.
    #[serde(flatten)]
    pub model: ModelKeys,
    /// Reference density, kg/m³.
    pub density: f64,
    /// Young's modulus, Pa; 0 of a solid that does not strain.
    pub youngs_modulus: f64,
    /// Poisson's ratio; 0 of a solid that does not strain.
    pub poissons_ratio: f64,
    /// The solid's own smoothing length over spacing.
    pub smoothing_ratio: f64,
    /// Artificial viscosity inside the solid.
    pub artificial_viscosity: ArtificialViscosity,
    /// Friction on the faces that two dimensions do not see, as a force per volume against the velocity, N/m³.
    #[serde(default)]
    pub side_friction: f64,
    /// Solid sub-steps per fluid step.
    pub sub_steps: SubSteps,
}

impl Solid {
    /// What only a rigid solid has.
    pub fn rigid(&self) -> Option<&RigidKeys> {
        match &self.model {
            ModelKeys::Rigid(keys) => Some(keys),
            _ => None,
        }
    }

    /// What two dimensions mean: the hypoelastic model knows plane strain alone.
    pub fn plane(&self) -> Plane {
        match &self.model {
            ModelKeys::TotalLagrangian(keys) => keys.plane,
            ModelKeys::FiniteElement(keys) => keys.plane,
            _ => Plane::Strain,
        }
    }

    /// Modulus of a plate that bends, Pa: E / (1 - nu²) where nothing strains across the plane, else E.
    pub fn bending_modulus(&self) -> f64 {
        match self.plane() {
            Plane::Strain => self.youngs_modulus / (1.0 - self.poissons_ratio.powi(2)),
            Plane::Stress => self.youngs_modulus,
        }
    }

    /// Name of the one that a scene describes by `[solid]`, and of the process that serves all solids by default.
    pub const DEFAULT_NAME: &str = "solid";

    /// Bulk modulus K = E / (3 (1 - 2 nu)), Pa.
    pub fn bulk_modulus(&self) -> f64 {
        self.youngs_modulus / (3.0 * (1.0 - 2.0 * self.poissons_ratio))
    }
    /// Shear modulus G = E / (2 (1 + nu)), Pa.
    pub fn shear_modulus(&self) -> f64 {
        self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))
    }
    /// Shear modulus of a sudden strain, Pa: with what relaxes later.
    pub fn instantaneous_shear_modulus(&self) -> f64 {
        let stiffening = match &self.model {
            ModelKeys::TotalLagrangian(keys) => keys.stiffening(),
            ModelKeys::Hypoelastic(_) | ModelKeys::FiniteElement(_) | ModelKeys::Rigid(_) => 1.0,
        };
        self.shear_modulus() * stiffening
    }
    /// Speed of the bulk wave c_s = sqrt(K / rho), m/s (Gray 2001): the sound speed of the artificial viscosity.
    pub fn sound_speed(&self) -> f64 {
        (self.bulk_modulus() / self.density).sqrt()
    }
    /// Speed of the pressure wave c_P = sqrt((K + 4 G / 3) / rho), m/s: the one that limits the time step. G is that of
    /// a sudden strain.
    pub fn pressure_wave_speed(&self) -> f64 {
        ((self.bulk_modulus() + 4.0 / 3.0 * self.instantaneous_shear_modulus()) / self.density).sqrt()
    }
}

/// The number of solid sub-steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SubSteps {
    /// From the solid's own stability limit.
    Auto,
    /// Given: 1 or an even number.
    Fixed(u32),
}
