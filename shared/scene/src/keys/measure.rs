//! Probes, curves beside them, and numbers of them.

use super::shape::BOX;
use super::{Key, Kind, NAME, Table, words};
use crate::section::Range;
use crate::{EnergyPart, read_metric, read_probe};

const PHASED: &[&str] = &["kinetic-energy", "energy", "centroid"];
const LOADED: &[&str] = &["force", "moment"];
const BODIES: &[&str] = &[
    "body-position",
    "body-velocity",
    "body-angle",
    "body-angular-velocity",
    "body-force",
    "body-moment",
    "body-contact-force",
    "body-contact-moment",
    "body-energy",
    "strain",
    "cauchy-stress",
];

pub(super) static PROBE: Table = Table::new(
    "probe",
    "Something that is measured.",
    &[
        Key::new("name", NAME, "Letters, digits, `-` and `_`, not digits alone.").required(),
        Key::words("kind", || words(&read_probe::kinds()), "What it measures.").required(),
        Key::new("at", Kind::Vector, "Where.").unit("m").only(&[
            "displacement",
            "position",
            "stress",
            "solid-velocity",
            "strain",
            "cauchy-stress",
            "pressure",
            "velocity",
        ]),
        Key::new("from", Kind::Vector, "Where a line begins.").unit("m").only(&["pressure", "flux"]),
        Key::new("to", Kind::Vector, "Where a line ends.").unit("m").only(&["pressure", "flux"]),
        Key::new(
            "x",
            Kind::Either(&[
                Kind::Number(Range::ANY),
                Kind::Array(&Kind::Number(Range::ANY), 1, read_probe::MAX_GAUGES),
            ]),
            "x of one gauge or several.",
        )
        .unit("m")
        .only(&["water-level"]),
        Key::words("phase", || words(&read_probe::MOVING), "Of fluid or solid.").only(PHASED),
        Key::words(
            "part",
            || EnergyPart::ALL.iter().map(|part| part.name()).collect(),
            "Only this part of the energies.",
        )
        .default("all")
        .only(&["energy"]),
        Key::new("shape", Kind::Text, "Name of a shape: the one that bears a load or takes a point along.")
            .only(&["pressure", "force", "moment"]),
        Key::new("within", Kind::Table(&BOX), "Only on particles that are in this box at the start.")
            .only(LOADED),
        Key::new("about", Kind::Vector, "The point that a moment is about.").unit("m").only(&["moment"]),
        Key::new(
            "body",
            Kind::Text,
            "Name of a body: for strain, stress and energy of any, else of a rigid one.",
        )
        .only(BODIES),
        Key::new("solid", Kind::Text, "Name of the solid that it is about, where there are several."),
    ],
)
.tag("kind");

pub(super) static REFERENCE: Table = Table {
    one_of: &["points", "file"],
    ..Table::new(
        "reference",
        "A curve drawn beside a probe.",
        &[
            Key::new("probe", Kind::Text, "Component of a probe: \"tip.x\".").required(),
            Key::new("label", Kind::Text, "Entry in the legend.").required(),
            Key::new(
                "points",
                Kind::Array(&Kind::Array(&Kind::Number(Range::ANY), 2, 2), 1, usize::MAX),
                "The curve, [time, value].",
            )
            .unit("s and the probe's"),
            Key::new("file", Kind::Text, "A CSV file, its path relative to the scene's folder."),
            Key::new(
                "columns",
                Kind::Array(&Kind::Text, 2, 2),
                "Titles of the file's columns, [time, value].",
            ),
            Key::number("scale", Range::ANY, "Factor of the file's values.").default("1.0"),
        ],
    )
};

const TIME: Range = Range::at_least(0.0);
const CURVES: &[&str] =
    &["peak", "peak-time", "trough", "trough-time", "range", "first-above", "rms", "period", "mean", "decay"];

pub(super) static METRIC: Table = Table::new(
    "metric",
    "A number that a study compares.",
    &[
        Key::new("name", NAME, "Letters, digits, `-` and `_`, not digits alone.").required(),
        Key::new("probe", Kind::Text, "Component of a probe: \"tip.x\".").required(),
        Key::words("kind", || words(&read_metric::KINDS), "Which number.").required(),
        Key::number("from", TIME, "Begin of the part of the curve that counts.")
            .unit("s")
            .default("0.0")
            .only(CURVES),
        Key::number("to", TIME, "End of it.").unit("s").default("the end of the run").only(CURVES),
        Key::number("at", TIME, "When.").unit("s").only(&["value"]),
        Key::number("level", Range::ANY, "A value of the probe, in its unit.").default("0.0").only(&[
            "first-above",
            "period",
            "decay",
        ]),
        Key::new(
            "reference",
            Kind::Either(&[Kind::Number(Range::ANY), Kind::Text]),
            "What it should be: a number, or the label of a [[reference]] of the same probe.",
        ),
        Key::new("source", Kind::Text, "Where a number as `reference` comes from."),
        Key::number("scale", Range::positive(), "What errors are relative to.")
            .default("the size of the reference"),
    ],
)
.tag("kind");
