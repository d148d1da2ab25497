//! What a scene says to the total-Lagrangian model alone.

use super::models::Rules;
use crate::ArtificialViscosity;
use crate::preset::Defaults;
use crate::section::{Range, Section};
use serde::{Deserialize, Serialize};

/// Keys of the total-Lagrangian model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TotalLagrangianKeys {
    /// Law of the material.
    pub material: Material,
    /// Coefficient alpha of the hourglass resistance; `None`: the one that gives particles the bending stiffness of
    /// their cells.
    pub hourglass: Option<f64>,
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

pub(super) const RULES: Rules = Rules {
    smoothing: Range::at_least(0.75).up_to(2.5).why(
        "below, a particle loses its diagonal neighbours; above, they are too many to resolve anything at this spacing",
    ),
    // Fixed neighbours and corrected gradients: eight neighbours are enough. The viscosity is for a plate in water,
    // whose short waves grow with those of the water's pressure where nothing damps them.
    defaults: |defaults| Defaults {
        solid_smoothing_ratio: 0.75,
        solid_viscosity: ArtificialViscosity { linear: 0.1, quadratic: 0.0 },
        ..defaults
    },
    keys: &[
        ("material", "only the total-lagrangian model has a choice of materials"),
        ("hourglass", "only the total-lagrangian model resists hourglass modes"),
    ],
    // One row of particles has no deformation gradient across.
    rows: 2,
    not_phase_blind: Some("the fluid's share in a velocity gradient means nothing to a deformation gradient"),
    largest_cfl: Some((0.9, "it is stable to 0.94")),
};

impl TotalLagrangianKeys {
    pub(super) fn read(section: &Section<'_>, _: &Defaults) -> Self {
        const MATERIALS: [(&str, Material); 2] =
            [("st-venant-kirchhoff", Material::StVenantKirchhoff), ("neo-hookean", Material::NeoHookean)];
        let stiffest = "beyond, it is stiffer than the material and limits the time step";
        let material = section.choice("material", Some(Material::NeoHookean), &MATERIALS);
        Self {
            material: material.unwrap_or(Material::NeoHookean),
            hourglass: section.number_or_auto(
                "hourglass",
                None,
                Range::at_least(0.0).up_to(10.0).why(stiffest),
            ),
        }
    }
}
