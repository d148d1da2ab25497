//! Prescribed motion, and wave makers.

use super::{Key, Kind, Table, words};
use crate::read_motion::{ANGLE, INSTANT};
use crate::read_waves::{self, MAX_COMPONENTS};
use crate::section::Range;

const START: Key = Key::number("start", INSTANT, "When it begins.").unit("s").default("0.0");
const PIVOT: Key = Key::new("pivot", Kind::Vector, "What turns, turns about this point.").unit("m");

pub(super) static MOTION: Table = Table {
    instead: Some(("wave", &WAVES)),
    ..Table::new(
        "motion",
        "A motion: steady, an oscillation, a series from a file, or a wave maker.",
        &[
            Key::new("velocity", Kind::Vector, "Velocity of a steady motion.").unit("m/s"),
            Key::number("angular_velocity", ANGLE, "Angular velocity of a steady motion, counter-clockwise.")
                .unit("rad/s"),
            Key::new("amplitude", Kind::Vector, "Amplitude of an oscillation.").unit("m"),
            Key::number("angle", ANGLE, "Amplitude of an oscillating rotation, counter-clockwise.")
                .unit("rad"),
            Key::number("period", Range::at_least(1e-9).up_to(1e12), "Period of an oscillation.").unit("s"),
            Key::number("phase", ANGLE, "Phase of an oscillation; needs a ramp.").unit("rad").default("0.0"),
            START,
            Key::number("end", INSTANT, "When a steady motion ends.").unit("s").default("never"),
            Key::number("ramp", INSTANT, "How long it takes to its full rate or amplitude.")
                .unit("s")
                .default("0.0"),
            PIVOT,
            Key::new(
                "file",
                Kind::Text,
                "A CSV file with a series, its path relative to the scene's folder.",
            ),
            Key::new("columns", Kind::Table(&COLUMNS), "Titles of the file's columns."),
            Key::number("scale", Range::at_least(-1e12).up_to(1e12), "Factor of the file's values.")
                .default("1.0"),
        ],
    )
};

static COLUMNS: Table = Table::new(
    "columns",
    "Titles of a file's columns.",
    &[
        Key::new("time", Kind::Text, "Time, s.").required(),
        Key::new("x", Kind::Text, "Displacement along x, m."),
        Key::new("y", Kind::Text, "Displacement along y, m."),
        Key::new("angle", Kind::Text, "Angle, rad."),
    ],
);

const SEAS: &[&str] = &["regular", "irregular"];
const IRREGULAR: &[&str] = &["irregular"];

static WAVES: Table = Table::new(
    "wave_maker",
    "A wall that makes waves.",
    &[
        Key::words("wave", || words(&read_waves::WAVES), "Which waves.").required(),
        Key::number(
            "height",
            Range::positive(),
            "From trough to crest; irregular: the significant height; solitary: above \
        the level at rest. At most where waves break.",
        )
        .unit("m")
        .required(),
        Key::number(
            "depth",
            Range::at_least(1e-6).up_to(1e6).why("it is the depth of the water at rest, m"),
            "Depth of the water at rest.",
        )
        .unit("m")
        .required(),
        Key::number("period", Range::at_least(1e-3).up_to(1e6), "Period; irregular: of the spectrum's peak.")
            .unit("s")
            .only(SEAS),
        Key::words(
            "maker",
            || words(&read_waves::MAKERS),
            "How the wall moves; solitary waves need a piston.",
        )
        .default("\"piston\""),
        Key::number("floor", Range::at_least(-1e9).up_to(1e9), "y of the floor.")
            .unit("m")
            .default("0.0")
            .only(SEAS),
        Key::words("toward", || words(&read_waves::DIRECTIONS), "Where the waves go.").default("\"right\""),
        START,
        Key::number(
            "ramp",
            Range::positive().up_to(1e12).why("the paddle begins at rest where the scene has it"),
            "How long the paddle takes to its full amplitude.",
        )
        .unit("s")
        .default("`period`")
        .only(SEAS),
        Key::number(
            "peakedness",
            Range::at_least(1.0)
                .up_to(10.0)
                .why("1 is a sea that is fully developed, 3.3 the North Sea's mean"),
            "How narrow the spectrum is.",
        )
        .default("3.3")
        .only(IRREGULAR),
        Key::new("components", Kind::Integer(8, MAX_COMPONENTS), "Number of waves that are added up.")
            .default("64")
            .only(IRREGULAR),
        Key::new("seed", Kind::Integer(0, u32::MAX), "Seed of their phases.").default("1").only(IRREGULAR),
        Key::new("pivot", Kind::Vector, "Hinge of a flap.").unit("m").only(SEAS),
    ],
)
.tag("wave");
