//! What a scene says to the finite-element model alone.

use super::ContactKeys;
use super::models::Rules;
use super::total_lagrangian::{self, Material, Plane, material, plane};
use crate::keys::{Key, words};
use crate::preset::Defaults;
use crate::section::{Range, Section};
use serde::{Deserialize, Serialize};

/// Keys of the finite-element model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FiniteElementKeys {
    /// Law of the material.
    pub material: Material,
    /// What happens across the plane of two dimensions.
    #[serde(default)]
    pub plane: Plane,
    /// How nodes go on in time.
    #[serde(default)]
    pub time_integration: TimeIntegration,
    /// Friction and restitution at walls; `None`: the model holds it against them, without either.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactKeys>,
}

/// How the nodes of finite elements go on in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimeIntegration {
    /// Velocity Verlet: cheap steps, which the fastest wave limits.
    #[default]
    Explicit,
    /// The midpoint rule: a system of equations for each step, of any length.
    Implicit,
}

pub(super) const RULES: Rules = Rules {
    smoothing: Range::at_least(0.75)
        .up_to(0.75)
        .why("finite elements have no kernel; it is the length of the viscosity"),
    defaults: total_lagrangian::RULES.defaults,
    keys: &[
        ("material", "only the total-lagrangian and the finite-element model have a choice of materials"),
        ("plane", "only the total-lagrangian and the finite-element model know the strain across the plane"),
        ("time_integration", "only the finite-element model has a choice of time integration"),
    ],
    rows: 1,
    not_phase_blind: Some("the fluid's share in a velocity gradient means nothing to a deformation gradient"),
    largest_cfl: Some((0.9, "it is stable to 1")),
    rigid: false,
};

const TIME_INTEGRATIONS: [(&str, TimeIntegration); 2] =
    [("explicit", TimeIntegration::Explicit), ("implicit", TimeIntegration::Implicit)];

/// Those of the total-Lagrangian model that it has, too, are listed there.
pub(super) const KEYS: &[Key] =
    &[Key::words("time_integration", || words(&TIME_INTEGRATIONS), "How nodes go on in time.")
        .default("\"explicit\"")
        .only(&["finite-element"])];

impl FiniteElementKeys {
    pub(super) fn read(section: &Section<'_>, _: &Defaults) -> Self {
        let viscosity = section.section("artificial_viscosity");
        if let Some(node) = viscosity.node("quadratic")
            && viscosity.number("quadratic", Some(0.0)) > 0.0
        {
            viscosity.wrong("quadratic", node, "must be 0: the viscosity of finite elements is linear");
        }
        let default = TimeIntegration::default();
        let time_integration =
            section.choice("time_integration", Some(default), &TIME_INTEGRATIONS).unwrap_or(default);
        Self {
            material: material(section),
            plane: plane(section),
            time_integration,
            contact: ContactKeys::read(section),
        }
    }
}
