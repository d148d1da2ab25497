//! Solids, and how they touch. The keys of one model stand in its file.

use super::top::VISCOSITY_KEY;
use super::{Key, Kind, Table, words};
use crate::SolidModelName;
use crate::read::{DENSITY, MAX_THREADS};
use crate::section::Range;
use crate::solid::{self, FRICTION, MODEL_KEYS, RESTITUTION};

/// A name of a solid or a process.
const IDENTIFIER: Kind = Kind::Form("^[a-z][a-z0-9-]{0,23}$");
const STRAINS: &[&str] = &["total-lagrangian", "finite-element", "hypoelastic"];

pub(super) static SOLID: Table = Table {
    further: MODEL_KEYS,
    ..Table::new(
        "solid",
        "A solid. Present exactly if a shape has phase \"solid\".",
        &[
            Key::new("name", IDENTIFIER, "Name of one of several solids; the one of [solid] has none."),
            Key::new("process", IDENTIFIER, "Name of the process that serves it; \"own\": the solid's name.")
                .default("\"solid\""),
            Key::new("threads", Kind::Integer(1, MAX_THREADS), "Worker threads for it.")
                .default("`numerics.threads.solid`"),
            Key::words("model", || words(SolidModelName::ALL), "Which model computes it.")
                .default("\"total-lagrangian\"; \"hypoelastic\" with the phase-blind interface"),
            Key::number("density", DENSITY, "Reference density.").unit("kg/m3").required(),
            Key::number(
                "youngs_modulus",
                Range::positive().up_to(1e15),
                "Young's modulus E; not of rigid bodies.",
            )
            .unit("Pa")
            .only(STRAINS),
            Key::number(
                "poissons_ratio",
                Range::at_least(0.0)
                    .below(0.5)
                    .why("at 0.5 a solid is incompressible, its bulk modulus infinite"),
                "Poisson's ratio; not of rigid bodies.",
            )
            .only(STRAINS),
            Key::number(
                "smoothing_ratio",
                Range::at_least(0.75).up_to(2.5),
                "The solid's own smoothing length over dx.",
            )
            .default("total Lagrangian and finite element 0.75; hypoelastic 1.33")
            .only(STRAINS),
            VISCOSITY_KEY.only(STRAINS),
            Key::number(
                "side_friction",
                Range::at_least(0.0).up_to(1e12).why("it is a force per volume, N/m3, against the velocity"),
                "Friction on the faces that two dimensions do not see.",
            )
            .unit("N/m3")
            .default("0.0")
            .only(STRAINS),
            Key::new(
                "contact",
                Kind::Table(&solid::CONTACT),
                "How it touches walls; of what strains only in the plane, without cracks.",
            ),
            Key::new("sub_steps", Kind::IntegerOrAuto(1, 100_000), "Sub-steps a step: 1 or even.")
                .default("\"auto\""),
        ],
    )
    .tag("model")
};

pub(super) static CONTACT: Table = Table::new(
    "contact",
    "How a pair of solids touches.",
    &[
        Key::new("solids", Kind::Array(&Kind::Text, 2, 2), "The names of the two.").required(),
        Key::number("friction", FRICTION, "Coulomb's coefficient, sticking and sliding.").default("0.0"),
        Key::number("restitution", RESTITUTION, "Normal speed after an impact over that before it.")
            .default("0.0"),
        Key::new(
            "stiffness",
            Kind::NumberOrAuto(
                Range::positive()
                    .up_to(1e18)
                    .why("it is the pressure over how far one goes into the other, Pa/m"),
            ),
            "Pressure over penetration.",
        )
        .unit("Pa/m")
        .default("\"auto\""),
        Key::new("touch", Kind::Boolean, "false: the two do not feel each other.").default("true"),
    ],
);
