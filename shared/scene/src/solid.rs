//! The solid's section of a scene.

use super::ArtificialViscosity;
use serde::{Deserialize, Serialize};

/// An elastic solid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solid {
    /// Its name: `solid` for `[solid]`, else the section's.
    pub name: String,
    /// Name of the process that serves it.
    pub process: String,
    /// Worker threads for it.
    pub threads: usize,
    /// Which model computes it.
    pub model: SolidModelName,
    /// Reference density, kg/m³.
    pub density: f64,
    /// Young's modulus, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// The solid's own smoothing length over spacing.
    pub smoothing_ratio: f64,
    /// Artificial viscosity inside the solid.
    pub artificial_viscosity: ArtificialViscosity,
    /// Gray's artificial stress; the hypoelastic model only.
    pub artificial_stress: ArtificialStress,
    /// Law of the total-Lagrangian model.
    pub material: Material,
    /// Coefficient alpha of the total-Lagrangian model's hourglass resistance; `None`: the one that gives particles the
    /// bending stiffness of their cells.
    pub hourglass: Option<f64>,
    /// Solid sub-steps per fluid step.
    pub sub_steps: SubSteps,
}

impl Solid {
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
    /// Speed of the bulk wave c_s = sqrt(K / rho), m/s (Gray 2001): the sound speed of the artificial viscosity.
    pub fn sound_speed(&self) -> f64 {
        (self.bulk_modulus() / self.density).sqrt()
    }
    /// Speed of the pressure wave c_P = sqrt((K + 4 G / 3) / rho), m/s: the one that limits the time step.
    pub fn pressure_wave_speed(&self) -> f64 {
        ((self.bulk_modulus() + 4.0 / 3.0 * self.shear_modulus()) / self.density).sqrt()
    }
}

/// The solid models that come with the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SolidModelName {
    /// Hooke's law in rate form with the Jaumann rate (Gray, Monaghan and Swift 2001).
    Hypoelastic,
    /// Hyperelastic, with neighbours of the reference configuration (Bonet and Lok 1999).
    TotalLagrangian,
}

/// The hyperelastic laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Material {
    /// Linear between Green's strain and its stress.
    StVenantKirchhoff,
    /// Compressible, stiffens under compression.
    NeoHookean,
}

/// Parameters of the artificial stress (Gray 2001).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArtificialStress {
    /// Coefficient epsilon; 0 leaves it out.
    pub strength: f64,
    /// Exponent n of the kernel ratio.
    pub exponent: f64,
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
