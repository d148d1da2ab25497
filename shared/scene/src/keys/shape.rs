//! Shapes: where particles are at first.

use super::motion::MOTION;
use super::{Key, Kind, NAME, Table, words};
use crate::geometry::MAX_CORNERS;
use crate::read::DENSITY;
use crate::read_geometry::MAX_COPIES;
use crate::read_shape::{self, MAX_ACROSS};
use crate::section::Range;

const SOLID: &[&str] = &["solid"];
const FLUID: &[&str] = &["fluid"];
const WALL: &[&str] = &["wall"];
const NO_VOID: &[&str] = &["fluid", "solid", "wall"];
// Degrees: more would lose digits, and fewer say the same.
const TURN: Range = Range::at_least(-360.0).up_to(360.0);
const CORNER: Kind = Kind::Array(&Kind::Number(Range::ANY), 2, 2);
const CORNERS: Kind = Kind::Array(&CORNER, 3, MAX_CORNERS + 1);

pub(super) static SHAPE: Table = Table {
    one_of: &read_shape::GEOMETRIES,
    ..Table::new(
        "shape",
        "A body of particles, or a place without any.",
        &[
            Key::new("name", NAME, "Letters, digits, `-` and `_`, not digits alone.").required(),
            Key::words(
                "phase",
                || words(&read_shape::SHAPE_PHASES),
                "What it is of; \"void\": a place kept empty.",
            )
            .required(),
            Key::new("solid", Kind::Text, "Name of the solid that it is of, where there are several.")
                .only(SOLID),
            Key::number("spacing", Range::positive(), "Distance of its particles.")
                .unit("m")
                .default("`resolution`")
                .only(SOLID),
            Key::new("across", Kind::Integer(1, MAX_ACROSS), "So many particles across its thinnest side.")
                .only(SOLID),
            Key::number(
                "lattice_angle",
                TURN,
                "Turns its particles' lattice inside of it, counter-clockwise.",
            )
            .unit("degrees")
            .default("0.0")
            .only(SOLID),
            Key::new("box", Kind::Table(&BOX), "An axis-parallel box."),
            Key::new("disc", Kind::Table(&DISC), "A disc."),
            Key::new("ring", Kind::Table(&RING), "A ring."),
            Key::new("tank", Kind::Table(&TANK), "The walls around an axis-parallel cavity.").only(WALL),
            Key::new("polygon", CORNERS, "The region that straight sides between these corners bound.")
                .unit("m"),
            Key::new("outline", Kind::Table(&OUTLINE), "A polygon from a file."),
            Key::new(
                "holes",
                Kind::Array(&CORNERS, 0, MAX_CORNERS),
                "Regions taken out of a polygon or an outline.",
            )
            .unit("m"),
            Key::new("rotate", Kind::Table(&ROTATE), "Turns it."),
            Key::new("translate", Kind::Vector, "Shifts it.").unit("m"),
            Key::new("repeat", Kind::Table(&REPEAT), "Puts copies of it."),
            Key::new("body", NAME, "The body that it is part of.").default("the shape's name").only(SOLID),
            Key::number("density", DENSITY, "Density of this shape alone, of a rigid solid.")
                .unit("kg/m3")
                .default("the solid's")
                .only(SOLID),
            Key::new(
                "velocity",
                Kind::Vector,
                "Initial velocity; of a wall the constant one of its surface.",
            )
            .unit("m/s")
            .default("[0.0, 0.0]")
            .only(NO_VOID),
            Key::words("pressure", || words(&read_shape::PRESSURES), "Pressure at the start.")
                .default("\"zero\"")
                .only(FLUID),
            Key::new("clamp", Kind::TableOrTables(&CLAMP), "Boxes in which particles are held.").only(SOLID),
            Key::new("load", Kind::Table(&LOAD), "A traction that the scene prescribes.").only(SOLID),
            Key::new(
                "crack",
                Kind::Array(&Kind::Vector, 2, 2),
                "Ends of a line across which it is cut at the start.",
            )
            .unit("m")
            .only(SOLID),
            Key::new(
                "cantilever_mode",
                Kind::Table(&CANTILEVER),
                "Initial velocity of a cantilever's first mode.",
            )
            .only(SOLID),
            Key::new("velocity_field", Kind::Table(&FIELD), "Initial velocity with a known solution.")
                .only(FLUID),
            Key::new("motion", Kind::TableOrTables(&MOTION), "Prescribed motion, or several that add up.")
                .only(&["wall", "solid"]),
            Key::new("contact", Kind::Boolean, "The solid may touch this wall.")
                .default("true where nothing holds a body, else false")
                .only(WALL),
            Key::words("slip", || words(&read_shape::SLIPS), "Slip of the fluid along it.")
                .default("\"free\"")
                .only(WALL),
        ],
    )
    .tag("phase")
};

const MIN: Key = Key::new("min", Kind::Vector, "Lowest corner.").unit("m").required();
const MAX: Key = Key::new("max", Kind::Vector, "Highest corner.").unit("m").required();

pub(super) static BOX: Table = Table::new("box", "An axis-parallel box.", &[MIN, MAX]);

static TANK: Table = Table::new(
    "tank",
    "The walls around an axis-parallel cavity, 2h thick.",
    &[
        MIN,
        MAX,
        Key::new(
            "open",
            Kind::Array(&Kind::Words(|| words(&read_shape::SIDES[..4])), 0, 64),
            "Sides left out.",
        )
        .default("[]"),
    ],
);

static CLAMP: Table = Table::new(
    "clamp",
    "A box in which a solid's particles are held.",
    &[MIN, MAX, Key::new("with", Kind::Text, "Name of a wall whose motion takes it along.")],
);

const CENTER: Key = Key::new("center", Kind::Vector, "Centre.").unit("m").required();

static DISC: Table = Table::new(
    "disc",
    "A disc.",
    &[CENTER, Key::number("radius", Range::positive(), "Radius.").unit("m").required()],
);

static RING: Table = Table::new(
    "ring",
    "A ring.",
    &[
        CENTER,
        Key::number("inner", Range::positive(), "Inner radius.").unit("m").required(),
        Key::number("outer", Range::positive(), "Outer radius, greater than the inner one.")
            .unit("m")
            .required(),
    ],
);

static OUTLINE: Table = Table::new(
    "outline",
    "Corners from a CSV file with the columns x and y, or a closed path of a drawing (.svg).",
    &[
        Key::new("file", Kind::Text, "The file, its path relative to the scene's folder.").required(),
        Key::number("scale", Range::positive().up_to(1e9), "What makes the file's coordinates metres.")
            .default("1.0"),
        Key::new("id", Kind::Text, "Which path of a drawing.").default("its only one"),
    ],
);

static ROTATE: Table = Table::new(
    "rotate",
    "Turns a shape.",
    &[
        Key::number("angle", TURN, "Angle, counter-clockwise.").unit("degrees").required(),
        Key::new("about", Kind::Vector, "Centre of the rotation.")
            .unit("m")
            .default("the middle of the box around it"),
    ],
);

static REPEAT: Table = Table::new(
    "repeat",
    "Copies of a shape.",
    &[
        Key::new("count", Kind::Integer(1, MAX_COPIES), "How many.").required(),
        Key::new("step", Kind::Vector, "From one to the next.").unit("m").required(),
    ],
);

static LOAD: Table = Table::new(
    "load",
    "A traction on one face of each particle's cell.",
    &[
        Key::new("within", Kind::Table(&BOX), "On the particles that are in this box at the start.")
            .required(),
        Key::new("traction", Kind::Vector, "Force per area.").unit("Pa").required(),
        Key::number(
            "ramp",
            Range::at_least(0.0).up_to(1e9).why("it is a time, s"),
            "How long it takes to grow evenly.",
        )
        .unit("s")
        .default("0.0"),
    ],
);

static CANTILEVER: Table = Table::new(
    "cantilever_mode",
    "Initial velocity of a cantilever's first bending mode.",
    &[
        Key::number(
            "fraction",
            Range::at_least(-0.5).up_to(0.5).why("the tip's speed is this part of the bulk sound speed"),
            "The tip's speed over the bulk sound speed.",
        )
        .required(),
        Key::number("root", Range::ANY, "x of the clamped end.").unit("m").required(),
        Key::number("length", Range::positive(), "Free length.").unit("m").required(),
    ],
);

const SPEED: Range = Range::at_least(-1e6).up_to(1e6);
const LENGTH: Range = Range::at_least(1e-9).up_to(1e9);

static FIELD: Table = Table::new(
    "velocity_field",
    "An initial velocity field with a known solution.",
    &[
        Key::words("kind", || words(&read_shape::FIELDS), "Which field.").required(),
        Key::new("origin", Kind::Vector, "A cell's corner; of a wave the floor below a crest.")
            .unit("m")
            .required(),
        Key::number("half_wave", LENGTH, "A cell's side; half the wave length.").unit("m").required(),
        Key::number("speed", SPEED, "Largest speed.").unit("m/s").only(&["taylor-green"]),
        Key::number("depth", LENGTH, "Depth of the water.").unit("m").only(&["standing-wave"]),
        Key::number(
            "amplitude",
            Range::at_least(0.0).up_to(1e9),
            "Height of a crest above the level at rest, at most a \
        fifth of `half_wave` and half of `depth`.",
        )
        .unit("m")
        .only(&["standing-wave"]),
    ],
)
.tag("kind");
