//! What a scene says to the rigid model alone: bodies and joints.

mod joint;

pub use joint::{Joint, JointKind};

use super::ContactKeys;
use super::models::Rules;
use crate::keys::{Key, Kind, Table};
use crate::preset::Defaults;
use crate::read::SMOOTHING;
use crate::section::{Range, Section};
use serde::{Deserialize, Serialize};

/// Keys of the rigid model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RigidKeys {
    /// What happens where a body touches a wall or another body.
    #[serde(default)]
    pub contact: ContactKeys,
    /// Bodies of which the scene says more than their shapes do.
    #[serde(default)]
    pub bodies: Vec<RigidBody>,
    /// What holds bodies.
    #[serde(default)]
    pub joints: Vec<Joint>,
}

/// A rigid body whose mass or motion does not follow from its shapes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RigidBody {
    /// Name of the body: a shape's `body`, or the shape's own name.
    pub name: String,
    /// Mass, kg (2D: kg/m); `None`: that of the shapes.
    pub mass: Option<f64>,
    /// Centre of mass at first, m; `None`: that of the shapes.
    pub center: Option<[f64; 3]>,
    /// Moments of inertia about the centre of mass and axes along x, y and z, kg m² (2D: kg m, only the one about z);
    /// `None`: those of the shapes, in proportion to the mass.
    pub inertia: Option<[f64; 3]>,
    /// Angular velocity at first, rad/s (2D: only the one about z).
    pub angular_velocity: [f64; 3],
}

pub(super) const RULES: Rules = Rules {
    smoothing: SMOOTHING,
    defaults: |defaults| defaults,
    keys: &[
        ("bodies", "only the rigid model has a mass for a whole body"),
        ("joints", "only rigid bodies have joints; a `clamp` at a shape holds others"),
    ],
    rows: 1,
    not_phase_blind: Some("a rigid body has no strain in which the fluid could have a share"),
    largest_cfl: None,
    rigid: true,
};

/// Ends beyond any body, within which no formula overflows.
const MASS: Range = Range::positive().up_to(1e15);
/// rad/s.
const SPIN: Range = Range::at_least(-1e6).up_to(1e6);

const RIGID: &[&str] = &["rigid"];

pub(super) const KEYS: &[Key] = &[
    Key::new("bodies", Kind::Tables(&BODY), "What does not follow from the shapes of a body.").only(RIGID),
    Key::new("joints", Kind::Tables(&joint::TABLE), "What holds bodies.").only(RIGID),
];

static BODY: Table = Table::new(
    "rigid_body",
    "A rigid body whose mass or motion does not follow from its shapes.",
    &[
        Key::new("name", Kind::Text, "The `body` of its shapes, or the name of its only shape.").required(),
        Key::number("mass", MASS, "Mass.").unit("kg (2D: kg/m)").default("from the shapes"),
        Key::new("center", Kind::Vector, "Centre of mass at the start.").unit("m").default("from the shapes"),
        Key::number("inertia", MASS, "Moment of inertia about the centre of mass.")
            .unit("kg m2 (2D: kg m)")
            .default("from the shapes"),
        Key::number("angular_velocity", SPIN, "Angular velocity at the start.").unit("rad/s").default("0.0"),
    ],
);

impl RigidKeys {
    pub(super) fn read(section: &Section<'_>, defaults: &Defaults) -> Self {
        let dimension = defaults.dimension;
        Self {
            contact: ContactKeys::read(section).unwrap_or_default(),
            bodies: section.tables("bodies").into_iter().map(|table| body(table, dimension)).collect(),
            joints: section.tables("joints").into_iter().filter_map(|t| joint::read(t, dimension)).collect(),
        }
    }
}

fn body(table: Section<'_>, dimension: usize) -> RigidBody {
    // About z alone in the plane.
    let turning = |key: &'static str, range: Range| -> Option<[f64; 3]> {
        let node = table.node(key)?;
        if dimension == 2 {
            return Some([0.0, 0.0, table.as_number(key, node, range)?]);
        }
        let vector = table.as_vector(key, node, dimension)?;
        vector.iter().all(|&x| table.number_in(key, node, x, range)).then_some(vector)
    };
    let body = RigidBody {
        name: joint::required(&table, "name"),
        mass: table.optional_number("mass"),
        center: table.node("center").and_then(|node| table.as_vector("center", node, dimension)),
        inertia: turning("inertia", MASS),
        angular_velocity: turning("angular_velocity", SPIN).unwrap_or_default(),
    };
    table.finish();
    body
}
