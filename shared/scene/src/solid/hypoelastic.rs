//! What a scene says to the hypoelastic model alone.

use super::ContactKeys;
use super::models::Rules;
use crate::keys::{Key, Kind, Table};
use crate::preset::Defaults;
use crate::read::{COEFFICIENT, SMOOTHING};
use crate::section::{Range, Section};
use serde::{Deserialize, Serialize};

/// Keys of the hypoelastic model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HypoelasticKeys {
    /// Gray's artificial stress.
    pub artificial_stress: ArtificialStress,
    /// Friction and restitution at walls; `None`: the model holds it against them, without either.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactKeys>,
}

/// Parameters of the artificial stress (Gray 2001).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArtificialStress {
    /// Coefficient epsilon; 0 leaves it out.
    pub strength: f64,
    /// Exponent n of the kernel ratio.
    pub exponent: f64,
}

pub(super) const RULES: Rules = Rules {
    smoothing: SMOOTHING,
    defaults: |defaults| defaults,
    keys: &[("artificial_stress", "only the hypoelastic model has a tensile instability that needs it")],
    rows: 1,
    not_phase_blind: None,
    largest_cfl: None,
    rigid: false,
};

pub(super) const KEYS: &[Key] =
    &[Key::new("artificial_stress", Kind::Table(&STRESS), "Gray's artificial stress.")
        .only(&["hypoelastic"])];

static STRESS: Table = Table::new(
    "artificial_stress",
    "Gray's artificial stress.",
    &[
        Key::number("strength", COEFFICIENT, "Coefficient epsilon; 0 leaves it out.").default("0.3"),
        Key::number(
            "exponent",
            Range::at_least(1.0).up_to(16.0).why("it is a whole power of a ratio of kernels"),
            "Exponent n of the kernel ratio, a whole number.",
        )
        .default("4.0"),
    ],
);

impl HypoelasticKeys {
    pub(super) fn read(section: &Section<'_>, defaults: &Defaults) -> Self {
        let stress = section.section("artificial_stress");
        let default = defaults.artificial_stress;
        let artificial_stress = ArtificialStress {
            strength: stress.number("strength", Some(default.strength)),
            exponent: exponent(&stress, default.exponent),
        };
        stress.finish();
        Self { artificial_stress, contact: ContactKeys::read(section) }
    }
}

fn exponent(stress: &Section<'_>, default: f64) -> f64 {
    let exponent = stress.number("exponent", Some(default));
    if exponent.fract() != 0.0
        && let Some(node) = stress.node("exponent")
    {
        stress.wrong("exponent", node, "must be a whole number: it is a power of a ratio of kernels");
    }
    exponent
}
