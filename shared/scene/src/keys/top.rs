//! The top of a scene, and the sections that stand once.

use super::material::{CONTACT, SOLID};
use super::measure::{METRIC, PROBE, REFERENCE};
use super::motion::MOTION;
use super::shape::{BOX, SHAPE};
use super::{Key, Kind, Table, words};
use crate::read::{self, COEFFICIENT, DENSITY, MAX_THREADS, REACH, SMOOTHING};
use crate::section::Range;

pub(crate) static SCENE: Table = Table::new(
    "scene",
    "A scene of halfstep. All quantities are in SI units.",
    &[
        Key::words(
            "preset",
            || words(&read::PRESETS),
            "Starting values, which keys of the scene override one by one.",
        ),
        Key::new("dimension", Kind::Integer(2, 2), "Number of space dimensions.").default("2"),
        Key::number("resolution", Range::positive(), "Distance dx of particles.").unit("m").required(),
        Key::number("smoothing_ratio", SMOOTHING, "Smoothing length of fluid and interface over dx.")
            .default("2.0; with a solid 1.5; or the preset's"),
        Key::number("end_time", Range::at_least(1e-12).up_to(1e12), "Simulated time.").unit("s").required(),
        Key::new(
            "time_step",
            Kind::NumberOrAuto(Range::positive()),
            "From the stability limits at every step, or fixed.",
        )
        .unit("s")
        .default("\"auto\", or the preset's"),
        Key::new("gravity", Kind::Vector, "Acceleration of gravity.").unit("m/s2").default("[0.0, -9.81]"),
        Key::new("frame", Kind::Table(&FRAME), "A frame of reference that moves."),
        Key::new(
            "parameters",
            Kind::Parameters,
            "Numbers and formulas by names of the scene's own, for formulas.",
        ),
        Key::new("fluid", Kind::Table(&FLUID), "The liquid."),
        Key::new("solid", Kind::TableOrTables(&SOLID), "The solid, or several, each with a name."),
        Key::new("contact", Kind::Tables(&CONTACT), "How two solids touch."),
        Key::new("interface", Kind::Table(&INTERFACE), "How fluid and solid act on each other."),
        Key::new("output", Kind::Table(&OUTPUT), "When files are written."),
        Key::new("effects", Kind::Switches, "Overrides which effects take part."),
        Key::new("numerics", Kind::Table(&NUMERICS), "Parameters that are no physics."),
        Key::new("shape", Kind::Tables(&SHAPE), "Where particles are at first."),
        Key::new("probe", Kind::Tables(&PROBE), "What is measured."),
        Key::new("reference", Kind::Tables(&REFERENCE), "Curves of the literature."),
        Key::new("metric", Kind::Tables(&METRIC), "Numbers that a study compares."),
    ],
);

static FRAME: Table = Table::new(
    "frame",
    "The scene is seen from something that moves, such as a tank that is shaken.",
    &[Key::new(
        "motion",
        Kind::TableOrTables(&MOTION),
        "How the frame moves in space: gravity is less its acceleration, and turned back by its angle.",
    )
    .required()],
);

static FLUID: Table = Table::new(
    "fluid",
    "The liquid. Present exactly if a shape has phase \"fluid\".",
    &[
        Key::number("density", DENSITY, "Reference density.").unit("kg/m3").required(),
        Key::number("viscosity", Range::at_least(0.0).up_to(1e9), "Dynamic viscosity.")
            .unit("Pa s")
            .default("0.0"),
        Key::new(
            "sound_speed",
            Kind::NumberOrAuto(Range::positive().up_to(1e9)),
            "Artificial speed of sound; \"auto\": \
        ten times the fastest speed that gravity and the start let expect.",
        )
        .unit("m/s")
        .default("\"auto\""),
        VISCOSITY_KEY,
        Key::words("density_diffusion", || words(&read::DIFFUSIONS), "Variant of the density diffusion.")
            .default("\"hydrostatic\", or the preset's"),
        Key::number(
            "density_diffusion_coefficient",
            Range::at_least(0.0).up_to(1.0).why("the usual value is 0.1"),
            "Coefficient of the density diffusion.",
        )
        .default("0.1"),
        Key::number(
            "background_pressure",
            Range::at_least(0.0).up_to(1e15),
            "Added to the equation of state.",
        )
        .unit("Pa")
        .default("0.0"),
        Key::words("time_integration", || words(&read::INTEGRATIONS), "How it goes from n to n + 1.")
            .default(
                "\"verlet\"; with a solid that strains, several solids, the phase-blind interface or `preset` \"kayaki\" \"midpoint\"",
            ),
        Key::new("beach", Kind::Table(&BEACH), "Where waves are absorbed."),
    ],
);

/// Of fluid and solids.
pub(super) const VISCOSITY_KEY: Key =
    Key::new("artificial_viscosity", Kind::Table(&VISCOSITY), "Monaghan's artificial viscosity.");

static VISCOSITY: Table = Table::new(
    "artificial_viscosity",
    "Coefficients of Monaghan's artificial viscosity.",
    &[
        Key::number("linear", COEFFICIENT, "A: in proportion to the sound speed.").default(
            "fluid 0.05, with `smoothing_ratio` 1.75 or more, or a free body, 0.02, less by what its own viscosity \
             is worth; \
             solid by its model; or the preset's",
        ),
        Key::number("quadratic", COEFFICIENT, "B: in proportion to the square of the approach speed.")
            .default("0; hypoelastic and preset \"kayaki\" 1"),
    ],
);

const PLACE: Range = Range::at_least(-1e9).up_to(1e9);

static BEACH: Table = Table::new(
    "beach",
    "Where velocities decay so that waves are absorbed.",
    &[
        Key::number("from", PLACE, "x where it begins.").unit("m").required(),
        Key::number("to", PLACE, "x where it is strongest, as beyond.").unit("m").required(),
        Key::number("rate", Range::positive().up_to(1e6), "How fast velocities decay there.")
            .unit("1/s")
            .default("10.0"),
    ],
);

static INTERFACE: Table = Table::new(
    "interface",
    "How fluid and solid act on each other.",
    &[
        Key::words("treatment", || words(&read::TREATMENTS), "What the phases do to each other.")
            .default("\"moving-wall\", or the preset's"),
        Key::number(
            "cross_viscosity",
            COEFFICIENT,
            "Strength C of the cross-phase viscosity between near particles.",
        )
        .default("1.0; with `smoothing_ratio` 1.75 or more 4.0"),
        Key::number(
            "cross_viscosity_far",
            COEFFICIENT,
            "C from `cross_viscosity_reach` on, at most `cross_viscosity`.",
        )
        .default("0; phase-blind: `cross_viscosity`"),
        Key::number(
            "cross_viscosity_reach",
            REACH,
            "Distance from which on C is the far one, over `resolution`; a straight line over the last 0.25.",
        )
        .default("1.25; with `smoothing_ratio` 1.75 or more, or a free body, 1.0"),
    ],
);

static OUTPUT: Table = Table::new(
    "output",
    "When files are written.",
    &[
        Key::number("frame_interval", Range::positive(), "Time between frames.")
            .unit("s")
            .default("`end_time` / 50"),
        Key::number("probe_interval", Range::positive(), "Time between rows of probes.csv.")
            .unit("s")
            .default("`end_time` / 2000"),
        Key::number(
            "checkpoint_interval",
            Range::at_least(0.0),
            "Simulated time between checkpoints; 0: one after every \
        ten minutes of computation.",
        )
        .unit("s")
        .default("0.0"),
    ],
);

static NUMERICS: Table = Table::new(
    "numerics",
    "Parameters that are no physics.",
    &[
        Key::words("kernel", || words(&read::KERNELS), "Smoothing kernel of both phases.")
            .default("\"wendland-c2\", or the preset's"),
        Key::words(
            "precision",
            || words(&read::PRECISIONS),
            "What the pairs of fluid and wall particles are computed in.",
        )
        .default("\"double\""),
        Key::number(
            "cfl",
            Range::positive()
                .up_to(1.0)
                .why("a sound wave must not cross more than a smoothing length a step"),
            "Courant number of the fluid.",
        )
        .default(
            "0.6; with a solid that strains, several solids or `fluid.time_integration` \"midpoint\" 0.4",
        ),
        Key::number(
            "solid_cfl",
            Range::positive().up_to(1.1).why("dt c_P / dx beyond 1.1 is unstable"),
            "Courant number of a solid sub-step.",
        )
        .default("0.6"),
        Key::new(
            "max_sub_steps",
            Kind::Integer(1, 100_000),
            "Most sub-steps before the solid lowers the time step.",
        )
        .default("200"),
        Key::new(
            "interface_capacity",
            Kind::Integer(1, 100_000_000),
            "Fluid particles that fit into an interface message.",
        )
        .default("from the scene"),
        Key::new("threads", Kind::Table(&THREADS), "Worker threads of the processes."),
        Key::words("lattice", || words(&read::LATTICES), "Where the first particle of a shape lies.")
            .default("\"centred\", or the preset's"),
        Key::new("domain", Kind::Table(&BOX), "Fluid particles that leave this box are taken out.")
            .default("the box around all shapes, widened by its own size"),
    ],
);

static THREADS: Table = Table::new(
    "threads",
    "Worker threads of the processes.",
    &[
        Key::new("fluid", Kind::Integer(1, MAX_THREADS), "Of the fluid process.").default("2"),
        Key::new("solid", Kind::Integer(1, MAX_THREADS), "Of a solid that says no `threads` of its own.")
            .default("1"),
    ],
);
