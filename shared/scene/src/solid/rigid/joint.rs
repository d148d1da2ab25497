//! Joints of rigid bodies.

use crate::keys::{Key, Kind as Value, Table, words};
use crate::section::{Range, Section};
use serde::{Deserialize, Serialize};

/// What holds a rigid body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Name of the joint.
    pub name: String,
    /// The body that it holds.
    pub body: String,
    /// What it ties the body to: another body of the solid, or a wall; empty: space.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub with: String,
    /// Which freedom it leaves.
    #[serde(flatten)]
    pub kind: JointKind,
    /// Against the way that the joint leaves free: of a hinge N m/rad (2D: N/rad), else N/m (2D: N/m²).
    pub stiffness: f64,
    /// Against its speed: of a hinge N m s/rad (2D: N s/rad), else N s/m (2D: N s/m²).
    pub damping: f64,
    /// Way at which the spring rests: of a hinge rad, of a rail m; of a spring its length, m.
    pub rest: f64,
    /// Least and largest way: of a hinge rad, of a rail m.
    pub limits: Option<[f64; 2]>,
}

/// The kinds of joints.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum JointKind {
    /// Nothing moves.
    Fixed,
    /// The body turns about a point; in three dimensions about an axis through it, or, where that is zero, any way.
    Hinge {
        /// The point at first, m.
        at: [f64; 3],
        /// The axis at first (2D: z).
        axis: [f64; 3],
    },
    /// A point of the body moves along a line.
    Rail {
        /// The point at first, m.
        at: [f64; 3],
        /// Direction of the line at first, of length 1.
        axis: [f64; 3],
        /// The body may turn about the point.
        turns: bool,
    },
    /// A spring and a damper between two points.
    Spring {
        /// The point of the body at first, m.
        at: [f64; 3],
        /// The point of what it is tied to, m.
        to: [f64; 3],
    },
}

impl Joint {
    /// It takes a freedom from the body, and does not only push it.
    pub fn holds(&self) -> bool {
        !matches!(self.kind, JointKind::Spring { .. })
    }
}

#[derive(Clone, Copy)]
enum Kind {
    Fixed,
    Hinge,
    Rail,
    Spring,
}

const KINDS: [(&str, Kind); 4] =
    [("fixed", Kind::Fixed), ("hinge", Kind::Hinge), ("rail", Kind::Rail), ("spring", Kind::Spring)];
/// Of springs and dampers.
const COEFFICIENT: Range = Range::at_least(0.0).up_to(1e15);
/// Ways, m or rad.
const WAY: Range = Range::at_least(-1e6).up_to(1e6);

const MOVES: &[&str] = &["hinge", "rail", "spring"];

pub(super) static TABLE: Table = Table::new(
    "joint",
    "What holds a rigid body.",
    &[
        Key::new("name", Value::Text, "Name of the joint.").required(),
        Key::words("kind", || words(&KINDS), "What it leaves free.").required(),
        Key::new("body", Value::Text, "The body that it holds.").required(),
        Key::new("with", Value::Text, "What it is tied to: another body of the solid, or a wall.")
            .default("space"),
        Key::new("at", Value::Vector, "Point of the body at the start.").unit("m").only(MOVES),
        Key::new("to", Value::Vector, "Point of what it is tied to.")
            .unit("m")
            .default("`at`")
            .only(&["spring"]),
        Key::new("axis", Value::Vector, "Direction of the line.").only(&["rail"]),
        Key::new("turns", Value::Boolean, "The body may turn about `at`.").default("false").only(&["rail"]),
        Key::number("stiffness", COEFFICIENT, "Stiffness of its spring.")
            .unit("of a hinge N m/rad (2D: N/rad), else N/m (2D: N/m2)")
            .default("0.0")
            .only(MOVES),
        Key::number("damping", COEFFICIENT, "Coefficient of its damper.")
            .unit("of a hinge N m s/rad (2D: N s/rad), else N s/m (2D: N s/m2)")
            .default("0.0")
            .only(MOVES),
        Key::number("rest", WAY, "Where the spring rests.")
            .unit("rad or m")
            .default("0; spring: its length at the start")
            .only(MOVES),
        Key::new("limits", Value::Array(&Value::Number(WAY), 2, 2), "Stops, from the start.")
            .unit("rad or m")
            .only(&["hinge", "rail"]),
    ],
)
.tag("kind");

/// A joint; `None` where its kind is not known, so that nobody asks it anything.
pub(super) fn read(table: Section<'_>, dimension: usize) -> Option<Joint> {
    let (name, body) = (required(&table, "name"), required(&table, "body"));
    let with = table.string("with").unwrap_or_default().to_owned();
    let at = || table.vector("at", dimension, None);
    let which = table.choice("kind", None, &KINDS)?;
    let mut length = 0.0;
    let kind = match which {
        Kind::Fixed => JointKind::Fixed,
        Kind::Hinge => JointKind::Hinge { at: at(), axis: hinge_axis(&table, dimension) },
        Kind::Rail => {
            let axis = unit(&table, table.vector("axis", dimension, None));
            JointKind::Rail { at: at(), axis, turns: table.boolean("turns", false) }
        }
        Kind::Spring => {
            let at = at();
            let to = table.vector("to", dimension, Some(at));
            length = (0..3).map(|d| (to[d] - at[d]).powi(2)).sum::<f64>().sqrt();
            JointKind::Spring { at, to }
        }
    };
    refuse(&table, which);
    let rest = match which {
        Kind::Spring => table.number_within("rest", Some(length), Range::at_least(0.0).up_to(1e6)),
        _ => table.number("rest", Some(0.0)),
    };
    let joint = Joint {
        name,
        body,
        with,
        kind,
        stiffness: table.number("stiffness", Some(0.0)),
        damping: table.number("damping", Some(0.0)),
        rest,
        limits: limits(&table),
    };
    if matches!(which, Kind::Spring) && joint.stiffness == 0.0 && joint.damping == 0.0 {
        table.whole("has neither `stiffness` nor `damping`: a spring without them does nothing");
    }
    table.finish();
    Some(joint)
}

/// A name that must be there.
pub(super) fn required(table: &Section<'_>, key: &'static str) -> String {
    if table.node(key).is_none() {
        table.missing(key);
    }
    table.string(key).unwrap_or_default().to_owned()
}

/// Keys that a kind of joint does not have.
fn refuse(table: &Section<'_>, kind: Kind) {
    let needless: &[(&'static str, &str)] = match kind {
        Kind::Fixed => &[
            ("at", "nothing moves at a fixed joint, wherever it is"),
            ("stiffness", "nothing moves at a fixed joint"),
            ("damping", "nothing moves at a fixed joint"),
            ("limits", "nothing moves at a fixed joint"),
            ("rest", "nothing moves at a fixed joint"),
        ],
        Kind::Spring => &[("limits", "a spring has no stops; a `rail` does")],
        Kind::Hinge | Kind::Rail => &[],
    };
    for (key, why) in needless {
        if let Some(node) = table.node(key) {
            table.wrong(key, node, *why);
        }
    }
    let own =
        [("axis", [Kind::Hinge, Kind::Rail].as_slice()), ("turns", &[Kind::Rail]), ("to", &[Kind::Spring])];
    for (key, owners) in own {
        let owned = owners.iter().any(|owner| *owner as u8 == kind as u8);
        if let (false, Some(node)) = (owned, table.node(key)) {
            let names = KINDS.iter().filter(|(_, k)| owners.iter().any(|o| *o as u8 == *k as u8));
            let names: Vec<String> = names.map(|(name, _)| format!("a {name}")).collect();
            table.wrong(key, node, format!("only {} has `{key}`", names.join(" or ")));
        }
    }
}

/// The axis of a hinge: z in the plane; in space as given, zero for a ball.
fn hinge_axis(table: &Section<'_>, dimension: usize) -> [f64; 3] {
    if dimension == 3 {
        return match table.node("axis") {
            Some(_) => unit(table, table.vector("axis", dimension, None)),
            None => [0.0; 3],
        };
    }
    if let Some(node) = table.node("axis") {
        table.wrong("axis", node, "is z for every hinge of a plane");
    }
    [0.0, 0.0, 1.0]
}

fn unit(table: &Section<'_>, axis: [f64; 3]) -> [f64; 3] {
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length == 0.0
        && let Some(node) = table.node("axis")
    {
        table.wrong("axis", node, "must have a length: it is a direction");
    }
    axis.map(|x| x / length)
}

fn limits(table: &Section<'_>) -> Option<[f64; 2]> {
    use crate::document::Value as Written;
    let node = table.node("limits")?;
    let form = "must be the least and the largest way, [least, largest]";
    let Written::Array(items) = &node.value else {
        table.wrong("limits", node, form);
        return None;
    };
    let [least, largest] = &items[..] else {
        table.wrong("limits", node, form);
        return None;
    };
    let limits = [table.as_number("limits", least, WAY)?, table.as_number("limits", largest, WAY)?];
    if limits[0] > 0.0 || limits[1] < 0.0 {
        table.wrong("limits", node, "must hold 0, where the joint is at first");
        return None;
    }
    if limits[0] == limits[1] {
        table.wrong("limits", node, "leaves no way: a `fixed` joint does that");
        return None;
    }
    Some(limits)
}
