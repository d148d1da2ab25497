//! `[[shape]]`.

use super::document::Value;
use super::error::listed;
use super::read_geometry;
use super::read_motion::{self, Around};
use super::section::{Range, Section};
use super::*;
use std::path::Path;

pub(crate) const SIDES: [(&str, TankSide); 6] = [
    ("left", TankSide::Left),
    ("right", TankSide::Right),
    ("bottom", TankSide::Bottom),
    ("top", TankSide::Top),
    ("back", TankSide::Back),
    ("front", TankSide::Front),
];

pub(crate) const GEOMETRIES: [&str; 6] = ["box", "disc", "ring", "tank", "polygon", "outline"];

/// Most particles across a shape.
pub(crate) const MAX_ACROSS: u32 = 100_000;

/// Phases of shapes; a void has none.
pub(crate) const SHAPE_PHASES: [(&str, Option<Phase>); 4] = [
    ("fluid", Some(Phase::Fluid)),
    ("solid", Some(Phase::Solid)),
    ("wall", Some(Phase::Wall)),
    ("void", None),
];

pub(crate) const SLIPS: [(&str, bool); 2] = [("free", true), ("none", false)];
/// Whether it is hydrostatic.
pub(crate) const PRESSURES: [(&str, bool); 2] = [("hydrostatic", true), ("zero", false)];

#[derive(Clone, Copy)]
pub(crate) enum Field {
    TaylorGreen,
    StandingWave,
}

pub(crate) const FIELDS: [(&str, Field); 2] =
    [("taylor-green", Field::TaylorGreen), ("standing-wave", Field::StandingWave)];

/// Whether a shape is a void.
pub(super) fn is_void(section: &Section<'_>) -> bool {
    matches!(section.node("phase").map(|node| &node.value), Some(Value::String(phase)) if phase == "void")
}

/// A void after so many shapes.
pub(super) fn void(section: Section<'_>, dimension: usize, before: usize, folder: &Path) -> Void {
    let geometry = geometry(&section, dimension, None, folder);
    if let (Some(node), Geometry::Tank { .. }) = (section.node("tank"), geometry.unmoved()) {
        section.wrong("tank", node, "only a wall can be a tank: it is the walls around a cavity");
    }
    let void = Void { name: name(&section), geometry, before };
    section.finish();
    void
}

pub(super) fn shape(section: Section<'_>, around: &Around<'_>, solids: &[&str], lattice: Lattice) -> Shape {
    let Around { dimension, folder, .. } = *around;
    let phase = section.choice("phase", None, &SHAPE_PHASES).flatten();
    let geometry = geometry(&section, dimension, phase, folder);
    let (clamp, clamp_with) = clamp(&section, dimension);
    let shape = Shape {
        name: name(&section),
        phase: phase.unwrap_or(Phase::Wall),
        solid: which_solid(&section, solids).filter(|_| phase == Some(Phase::Solid)),
        spacing: spacing(&section, &geometry, dimension, lattice).filter(|_| phase == Some(Phase::Solid)),
        lattice_angle: lattice_angle(&section),
        geometry,
        density: section.optional_number("density"),
        velocity: section.vector("velocity", dimension, Some([0.0; 3])),
        cantilever_mode: cantilever_mode(&section),
        velocity_field: velocity_field(&section, dimension),
        clamp,
        clamp_with,
        load: load(&section, dimension),
        crack: crack(&section, dimension),
        body: body(&section),
        motion: read_motion::motion(&section, around),
        contact: section.boolean("contact", false),
        free_slip: section.choice("slip", Some(true), &SLIPS).unwrap_or(true),
        hydrostatic: section.choice("pressure", Some(false), &PRESSURES).unwrap_or(false),
    };
    for (key, owner, article) in [
        ("cantilever_mode", Phase::Solid, "a solid"),
        ("clamp", Phase::Solid, "a solid"),
        ("load", Phase::Solid, "a solid"),
        ("crack", Phase::Solid, "a solid"),
        ("body", Phase::Solid, "a solid"),
        ("density", Phase::Solid, "a solid"),
        ("solid", Phase::Solid, "a solid"),
        ("spacing", Phase::Solid, "a solid"),
        ("across", Phase::Solid, "a solid"),
        ("lattice_angle", Phase::Solid, "a solid"),
        ("velocity_field", Phase::Fluid, "a fluid"),
        ("contact", Phase::Wall, "a wall"),
        ("slip", Phase::Wall, "a wall"),
        ("pressure", Phase::Fluid, "a fluid"),
    ] {
        if let (Some(node), Some(phase)) = (section.node(key), phase)
            && phase != owner
        {
            section.wrong(key, node, format!("only {article} has `{key}`"));
        }
    }
    if let (Some(node), Some(Phase::Fluid)) = (section.node("motion"), phase) {
        section.wrong("motion", node, "only a wall, or a solid with a clamp, has `motion`");
    }
    if phase == Some(Phase::Solid) {
        needs_solid(&section, solids, "a solid shape");
    }
    section.finish();
    shape
}

/// The body that a shape says it is part of; empty where it says none.
fn body(section: &Section<'_>) -> String {
    match section.node("body") {
        Some(_) => named(section, "body"),
        None => String::new(),
    }
}

/// A solid's own spacing: `spacing`, m, or `across`, the number of particles across its thinnest side.
fn spacing(section: &Section<'_>, geometry: &Geometry, dimension: usize, lattice: Lattice) -> Option<f64> {
    let across = section.node("across");
    if section.node("spacing").is_some() {
        if across.is_some() {
            section.whole("has both `spacing` and `across`: each says how far apart its particles are");
        }
        return section.optional_number("spacing");
    }
    across?;
    let across = section.optional_integer("across")?;
    Some(spacing::with_across(geometry, dimension, lattice, across)).filter(|spacing| spacing.is_finite())
}

/// The angle of a solid's lattice inside its shape, degrees.
fn lattice_angle(section: &Section<'_>) -> f64 {
    let Some(node) = section.node("lattice_angle") else { return 0.0 };
    let angle = section.number("lattice_angle", Some(0.0));
    if angle != 0.0 && section.node("across").is_some() {
        let why = "turned rows are not so many across everywhere: say the `spacing`";
        section.wrong("lattice_angle", node, format!("stands beside `across`: {why}"));
    }
    angle
}

/// Index of the solid that a shape or a probe names; where it names none, of the only one.
pub(super) fn which_solid(section: &Section<'_>, solids: &[&str]) -> Option<usize> {
    // Names that are missing or taken twice are errors of their own.
    let told = |(k, name): (usize, &&str)| !name.is_empty() && !solids[..k].contains(name);
    let named = !solids.is_empty() && solids.iter().enumerate().all(told);
    match section.node("solid") {
        None => (solids.len() == 1).then_some(0),
        Some(node) if named => {
            let names: Vec<(&str, usize)> = solids.iter().enumerate().map(|(k, name)| (*name, k)).collect();
            section.as_choice("solid", node, &names)
        }
        Some(_) => None,
    }
}

/// Notes that a solid has to be named where there are several.
pub(super) fn needs_solid(section: &Section<'_>, solids: &[&str], who: &str) {
    if solids.len() > 1 && section.node("solid").is_none() {
        let names = listed(solids.iter().copied(), "or");
        section.whole(format!("says no `solid`: where there are several, {who} names its own, {names}"));
    }
}

/// The name of a shape or a probe: a part of dotted keys and of column titles.
pub(super) fn name(section: &Section<'_>) -> String {
    named(section, "name")
}

fn named(section: &Section<'_>, key: &'static str) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let Some(node) = section.node(key) else {
        section.missing(key);
        return String::new();
    };
    let Some(name) = section.string(key) else { return String::new() };
    if name.is_empty() || !name.chars().all(allowed) || name.chars().all(|c| c.is_ascii_digit()) {
        section.wrong(key, node, "must be letters, digits, `-` and `_`, and not digits alone");
    }
    name.to_owned()
}

fn geometry(section: &Section<'_>, dimension: usize, phase: Option<Phase>, folder: &Path) -> Geometry {
    let geometry = unmoved_geometry(section, dimension, phase, folder);
    read_geometry::moved(section, geometry, dimension)
}

fn unmoved_geometry(
    section: &Section<'_>,
    dimension: usize,
    phase: Option<Phase>,
    folder: &Path,
) -> Geometry {
    let given: Vec<&'static str> = GEOMETRIES.into_iter().filter(|g| section.node(g).is_some()).collect();
    let kind = match given[..] {
        [one] => one,
        [] => {
            section.whole(
                "has no place: it needs one of `box`, `disc`, `ring`, `tank`, `polygon` and `outline`",
            );
            "box"
        }
        [first, second, ..] => {
            let reason = format!("has both `{first}` and `{second}`: a shape has one place");
            section.whole(reason);
            first
        }
    };
    let nowhere = || Geometry::Box(Block { min: [f64::NAN; 3], max: [f64::NAN; 3] });
    if kind == "polygon" || kind == "outline" {
        return read_geometry::polygon(section, kind, folder).map_or_else(nowhere, Geometry::Polygon);
    }
    if let Some(node) = section.node("holes") {
        section.wrong("holes", node, "only a `polygon` or an `outline` has holes");
    }
    let place = section.section(kind);
    let geometry = match kind {
        _ if !place.is_present() => nowhere(),
        "box" => Geometry::Box(place.block(dimension)),
        "disc" => Geometry::Disc {
            center: place.vector("center", dimension, None),
            radius: place.number("radius", None),
        },
        "ring" => {
            let inner = place.number("inner", None);
            let outer = place.number("outer", None);
            if outer <= inner {
                place.whole(format!("must have an `outer` radius greater than the `inner`, {inner}"));
            }
            Geometry::Ring { center: place.vector("center", dimension, None), inner, outer }
        }
        _ => {
            if let (Some(node), Some(Phase::Fluid | Phase::Solid)) = (section.node("tank"), phase) {
                section.wrong("tank", node, "only a wall can be a tank: it is the walls around a cavity");
            }
            Geometry::Tank { cavity: place.block(dimension), open: open(&place, dimension) }
        }
    };
    place.finish();
    geometry
}

fn open(tank: &Section<'_>, dimension: usize) -> Vec<TankSide> {
    let Some(node) = tank.node("open") else { return Vec::new() };
    let Value::Array(items) = &node.value else {
        tank.wrong("open", node, "must be an array of sides, such as [\"top\"]");
        return Vec::new();
    };
    let sides = &SIDES[..2 * dimension];
    let open: Vec<TankSide> = items.iter().filter_map(|item| tank.as_choice("open", item, sides)).collect();
    if sides.iter().all(|(_, side)| open.contains(side)) {
        tank.wrong("open", node, "leaves no side closed: there is no wall left");
    }
    open
}

fn cantilever_mode(section: &Section<'_>) -> Option<CantileverMode> {
    let mode = section.section("cantilever_mode");
    if !mode.is_present() {
        return None;
    }
    let read = CantileverMode {
        fraction: mode.number("fraction", None),
        root: mode.number("root", None),
        length: mode.number("length", None),
    };
    mode.finish();
    Some(read)
}

fn velocity_field(section: &Section<'_>, dimension: usize) -> Option<VelocityField> {
    let table = section.section("velocity_field");
    if !table.is_present() {
        return None;
    }
    // Without a kind its other keys mean nothing: they are not looked at.
    let kind = table.choice("kind", None, &FIELDS)?;
    let origin = table.vector("origin", dimension, None);
    let half_wave = table.number("half_wave", None);
    let field = match kind {
        Field::TaylorGreen => {
            VelocityField::TaylorGreen { speed: table.number("speed", None), origin, half_wave }
        }
        Field::StandingWave => {
            let depth = table.number("depth", None);
            // Steeper waves break, and no wave is higher than its water.
            let most = (0.2 * half_wave).min(0.5 * depth);
            let why = "linear theory has no steeper waves: a fifth of half a wave, half the depth";
            let range = Range::at_least(0.0).up_to(if most > 0.0 { most } else { f64::MAX }).why(why);
            let amplitude = table.number_within("amplitude", None, range);
            VelocityField::StandingWave { amplitude, origin, half_wave, depth }
        }
    };
    table.finish();
    Some(field)
}

/// A traction that the scene prescribes.
fn load(section: &Section<'_>, dimension: usize) -> Option<Traction> {
    let table = section.section("load");
    if !table.is_present() {
        return None;
    }
    let within = table.section("within");
    // Of what is no table this is said already.
    if table.node("within").is_none() {
        table.missing("within");
    }
    let read = Traction {
        within: within.whole_block(dimension),
        traction: table.vector("traction", dimension, None),
        ramp: table.number("ramp", Some(0.0)),
    };
    table.finish();
    Some(read)
}

/// The ends of a crack.
fn crack(section: &Section<'_>, dimension: usize) -> Option<[[f64; 3]; 2]> {
    let node = section.node("crack")?;
    let ends = match &node.value {
        Value::Array(ends) if ends.len() == 2 => ends,
        _ => {
            section.wrong("crack", node, "must be the two ends of a line, [[x, y], [x, y]]");
            return None;
        }
    };
    let [from, to] = [&ends[0], &ends[1]].map(|end| section.as_vector("crack", end, dimension));
    let crack = [from?, to?];
    if crack[0][..2] == crack[1][..2] {
        section.wrong("crack", node, "has no length in the plane of x and y");
    }
    Some(crack)
}

/// The clamps' boxes, and with which wall each moves.
fn clamp(section: &Section<'_>, dimension: usize) -> (Vec<Block>, Vec<Option<String>>) {
    let Some(node) = section.node("clamp") else { return Default::default() };
    let tables = match node.table() {
        Some(_) => vec![section.section("clamp")],
        None => section.tables("clamp"),
    };
    let (clamps, with): (Vec<_>, Vec<_>) = tables
        .into_iter()
        .map(|table| {
            let with = table.string("with").map(str::to_owned);
            (table.whole_block(dimension), with)
        })
        .unzip();
    let moves = with.iter().any(Option::is_some);
    (clamps, if moves { with } else { Vec::new() })
}

impl Section<'_> {
    /// A table that is a box and nothing else.
    pub(super) fn whole_block(self, dimension: usize) -> Block {
        let block = self.block(dimension);
        self.finish();
        block
    }
}
