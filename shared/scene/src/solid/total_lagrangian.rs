//! What a scene says to the total-Lagrangian model alone.

use super::fracture as fracture_keys;
use super::models::Rules;
use super::{ContactKeys, Fracture, ModelKeys, Solid};
use crate::ArtificialViscosity;
use crate::document::{Node, Value};
use crate::keys::{Key, Kind, words};
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
    /// Maxwell arms [g, tau]: shear modulus over G, and relaxation time, s.
    #[serde(default)]
    pub prony: Vec<[f64; 2]>,
    /// What happens across the plane of two dimensions.
    #[serde(default)]
    pub plane: Plane,
    /// Seed of an irregular arrangement of its particles; `None`: they lie on their lattice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub irregular: Option<u32>,
    /// Strength and fracture energy; `None`: it does not break.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fracture: Option<Fracture>,
    /// Friction and restitution at walls; `None`: the model holds it against them, without either.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactKeys>,
}

/// What two dimensions mean to a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Plane {
    /// It cannot strain across the plane.
    #[default]
    Strain,
    /// Nothing holds it across the plane.
    Stress,
}

/// Most Maxwell arms.
const MAX_ARMS: usize = 16;

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
        ("material", "only the total-lagrangian and the finite-element model have a choice of materials"),
        ("hourglass", "only the total-lagrangian model resists hourglass modes"),
        ("prony", "only the total-lagrangian model has a strain that Maxwell arms could follow; others know its rate"),
        ("arrangement", "only the total-lagrangian model knows particles off a lattice"),
        ("arrangement_seed", "only the total-lagrangian model knows particles off a lattice"),
        ("fracture", "only the total-lagrangian model breaks"),
        ("plane", "only the total-lagrangian and the finite-element model know the strain across the plane"),
    ],
    // One row of particles has no deformation gradient across.
    rows: 2,
    not_phase_blind: Some("the fluid's share in a velocity gradient means nothing to a deformation gradient"),
    largest_cfl: Some((0.9, "it is stable to 0.94")),
    rigid: false,
};

const MATERIALS: [(&str, Material); 2] =
    [("st-venant-kirchhoff", Material::StVenantKirchhoff), ("neo-hookean", Material::NeoHookean)];
const PLANES: [(&str, Plane); 2] = [("strain", Plane::Strain), ("stress", Plane::Stress)];
/// Whether an arrangement is irregular.
const ARRANGEMENTS: [(&str, bool); 2] = [("lattice", false), ("irregular", true)];
/// Seed of an irregular arrangement where none is said.
const SEED: u32 = 1;
const SHARE: Range =
    Range::positive().up_to(100.0).why("g is the arm's shear modulus over the long-time one");
const TIME: Range = Range::at_least(1e-9).up_to(1e9).why("tau is the arm's relaxation time, s");

const OWN: &[&str] = &["total-lagrangian"];
const BOTH: &[&str] = &["total-lagrangian", "finite-element"];

pub(super) const KEYS: &[Key] = &[
    Key::words("material", || words(&MATERIALS), "The law.").default("\"neo-hookean\"").only(BOTH),
    Key::new(
        "hourglass",
        Kind::NumberOrAuto(
            Range::at_least(0.0)
                .up_to(10.0)
                .why("beyond, it is stiffer than the material and limits the time step"),
        ),
        "Coefficient of the hourglass resistance; \"auto\": particles bend as their cells do.",
    )
    .default("\"auto\"")
    .only(OWN),
    Key::new(
        "prony",
        Kind::Array(&Kind::Row(&[Kind::Number(SHARE), Kind::Number(TIME)]), 0, MAX_ARMS),
        "Maxwell arms [g, tau]: shear modulus over G, and relaxation time, s.",
    )
    .only(OWN),
    Key::words("plane", || words(&PLANES), "What two dimensions mean.").default("\"strain\"").only(BOTH),
    Key::words("arrangement", || words(&ARRANGEMENTS), "How its particles lie inside of it at the start.")
        .default("\"lattice\"")
        .only(OWN),
    Key::new("arrangement_seed", Kind::Integer(0, u32::MAX), "Which of the irregular arrangements.")
        .default("1")
        .only(OWN),
    Key::new("fracture", Kind::Table(&fracture_keys::TABLE), "Strength and energy with which it breaks.")
        .only(OWN),
];

impl Solid {
    /// Seed of the irregular arrangement of its particles; `None`: they lie on a lattice.
    pub fn irregular(&self) -> Option<u32> {
        match &self.model {
            ModelKeys::TotalLagrangian(keys) => keys.irregular,
            _ => None,
        }
    }
}

impl TotalLagrangianKeys {
    /// Largest `numerics.solid_cfl` of an irregular arrangement, in which particles are up to a quarter closer.
    pub(crate) const LARGEST_IRREGULAR_CFL: f64 = 0.7;

    pub(super) fn read(section: &Section<'_>, _: &Defaults) -> Self {
        let (prony, plane, material) = (prony(section), plane(section), material(section));
        Self {
            material,
            hourglass: section.number_or_auto("hourglass", None),
            prony,
            plane,
            irregular: irregular(section),
            fracture: fracture(section, plane, material),
            contact: ContactKeys::read(section),
        }
    }

    /// Shear modulus of a sudden strain over the long-time one: 1 + sum g.
    pub(crate) fn stiffening(&self) -> f64 {
        1.0 + self.prony.iter().map(|[g, _]| g).sum::<f64>()
    }
}

/// The law of the material.
pub(super) fn material(section: &Section<'_>) -> Material {
    section.choice("material", Some(Material::NeoHookean), &MATERIALS).unwrap_or(Material::NeoHookean)
}

fn irregular(section: &Section<'_>) -> Option<u32> {
    let irregular = section.choice("arrangement", Some(false), &ARRANGEMENTS).unwrap_or(false);
    let seed = section.optional_integer("arrangement_seed");
    if let (None, Some(node)) = (section.node("arrangement"), section.node("arrangement_seed")) {
        section.wrong(
            "arrangement_seed",
            node,
            "is that of `arrangement` = \"irregular\", which is not said",
        );
    }
    irregular.then(|| seed.unwrap_or(SEED))
}

fn fracture(section: &Section<'_>, plane: Plane, material: Material) -> Option<Fracture> {
    let (fracture, node) = (Fracture::read(section)?, section.node("fracture")?);
    if section.node("prony").is_some() {
        section.wrong(
            "fracture",
            node,
            "cannot stand with `prony`: what damage does to Maxwell arms is not known",
        );
    }
    if section.node("contact").is_some() {
        let why = "the coupler holds a solid with `contact` against walls, and knows its surface at the start alone";
        let instead = "`friction` of `fracture` knows both";
        let message = format!("cannot stand with `contact`: {why}, not what cracks open; {instead}");
        section.wrong("fracture", node, message);
    }
    if (plane, material) == (Plane::Stress, Material::NeoHookean) {
        let why = "the strain across the plane would depend on the damage";
        section.wrong(
            "fracture",
            node,
            format!("with `plane` = \"stress\" needs `material` = \"st-venant-kirchhoff\": {why}"),
        );
    }
    Some(fracture)
}

/// What two dimensions mean.
pub(super) fn plane(section: &Section<'_>) -> Plane {
    let plane = section.choice("plane", Some(Plane::Strain), &PLANES).unwrap_or(Plane::Strain);
    if let (Plane::Stress, Some(node), Some(_)) = (plane, section.node("plane"), section.node("prony")) {
        let why = "what a plate does across its plane would depend on all that its arms remember";
        section.wrong("plane", node, format!("cannot be \"stress\" with `prony`: {why}"));
    }
    plane
}

fn prony(section: &Section<'_>) -> Vec<[f64; 2]> {
    let Some(node) = section.node("prony") else { return Vec::new() };
    let form = "must be an array of Maxwell arms, each [g, tau]: its shear modulus over G, and its time, s";
    let Value::Array(items) = &node.value else {
        section.wrong("prony", node, form);
        return Vec::new();
    };
    if items.len() > MAX_ARMS {
        section.wrong("prony", node, format!("has {} arms; at most {MAX_ARMS}", items.len()));
    }
    let arm = |item: &Node| match &item.value {
        Value::Array(pair) if pair.len() == 2 => {
            let share = section.as_number("prony", &pair[0], SHARE)?;
            Some([share, section.as_number("prony", &pair[1], TIME)?])
        }
        _ => {
            section.wrong("prony", item, form);
            None
        }
    };
    items.iter().filter_map(arm).collect()
}
