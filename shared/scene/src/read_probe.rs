//! `[[probe]]` and `[[reference]]`.

use super::document::{Node, Value};
use super::read_shape::{name, needs_solid, which_solid};
use super::section::{Range, Section};
use super::*;
use std::path::Path;

#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Displacement,
    Position,
    Stress,
    SolidVelocity,
    Strain,
    CauchyStress,
    StrainEnergy,
    CrackEnergy,
    CrackArea,
    Bodies,
    Pressure,
    Velocity,
    Flux,
    WaterLevel,
    Front,
    KineticEnergy,
    Energy,
    Centroid,
    Force,
    Moment,
    Body(BodyQuantity),
}

const OTHERS: [(&str, Kind); 20] = [
    ("displacement", Kind::Displacement),
    ("position", Kind::Position),
    ("stress", Kind::Stress),
    ("solid-velocity", Kind::SolidVelocity),
    ("strain", Kind::Strain),
    ("cauchy-stress", Kind::CauchyStress),
    ("strain-energy", Kind::StrainEnergy),
    ("crack-energy", Kind::CrackEnergy),
    ("crack-area", Kind::CrackArea),
    ("bodies", Kind::Bodies),
    ("pressure", Kind::Pressure),
    ("velocity", Kind::Velocity),
    ("flux", Kind::Flux),
    ("water-level", Kind::WaterLevel),
    ("front", Kind::Front),
    ("kinetic-energy", Kind::KineticEnergy),
    ("energy", Kind::Energy),
    ("centroid", Kind::Centroid),
    ("force", Kind::Force),
    ("moment", Kind::Moment),
];

/// All kinds.
pub(crate) fn kinds() -> Vec<(&'static str, Kind)> {
    let bodies = BodyQuantity::ALL.map(|(name, quantity)| (name, Kind::Body(quantity)));
    OTHERS.into_iter().chain(bodies).collect()
}

pub(crate) const MOVING: [(&str, Phase); 2] = [("fluid", Phase::Fluid), ("solid", Phase::Solid)];

/// A probe; `None` where it is not clear what it measures, so that nobody asks it anything.
pub(super) fn probe(
    section: Section<'_>,
    dimension: usize,
    solids: &[&str],
    shapes: &[Shape],
) -> Option<Probe> {
    let name = name(&section);
    let vector = |key| section.vector(key, dimension, None);
    let at = || vector("at");
    // Without a kind its other keys mean nothing: they are not looked at.
    let kind = match section.choice("kind", None, &kinds())? {
        Kind::Displacement => ProbeKind::Displacement { at: at() },
        Kind::Position => ProbeKind::Position { at: at() },
        Kind::Stress => ProbeKind::Stress { at: at() },
        Kind::SolidVelocity => ProbeKind::SolidVelocity { at: at() },
        Kind::Strain => ProbeKind::Strain { of: spot(&section, dimension)? },
        Kind::CauchyStress => ProbeKind::CauchyStress { of: spot(&section, dimension)? },
        Kind::StrainEnergy => ProbeKind::StrainEnergy,
        Kind::CrackEnergy => ProbeKind::CrackEnergy,
        Kind::CrackArea => ProbeKind::CrackArea,
        Kind::Bodies => ProbeKind::Bodies,
        Kind::Pressure => pressure(&section, dimension, shapes)?,
        Kind::Velocity => ProbeKind::Velocity { at: at() },
        Kind::Flux => ProbeKind::Flux { from: vector("from"), to: vector("to") },
        Kind::WaterLevel => ProbeKind::WaterLevel { x: gauges(&section)? },
        Kind::Front => ProbeKind::Front,
        Kind::KineticEnergy => ProbeKind::KineticEnergy { phase: section.choice("phase", None, &MOVING)? },
        Kind::Energy => {
            let phase = section.choice("phase", None, &MOVING)?;
            let parts: Vec<_> = EnergyPart::of(phase).iter().map(|&part| (part.name(), part)).collect();
            let part = section.node("part").and_then(|_| section.choice("part", None, &parts));
            ProbeKind::Energy { phase, part }
        }
        Kind::Centroid => ProbeKind::Centroid { phase: section.choice("phase", None, &MOVING)? },
        Kind::Force => {
            let (shape, within) = loaded(&section, dimension, shapes)?;
            ProbeKind::Force { within, shape }
        }
        Kind::Moment => {
            let (shape, within) = loaded(&section, dimension, shapes)?;
            ProbeKind::Moment { about: vector("about"), within, shape }
        }
        Kind::Body(quantity) => {
            if section.node("body").is_none() {
                section.missing("body");
            }
            ProbeKind::Body { body: section.string("body")?.to_owned(), quantity }
        }
    };
    let mut probe = Probe { name, kind, solid: None };
    let point = probe.kind.point_of_solid();
    probe.solid = match probe.kind {
        _ if point.is_some() => point.and_then(|at| shapes[geometry::nearest_solid(shapes, &at)?].solid),
        ProbeKind::Force { shape: Some(shape), .. } | ProbeKind::Moment { shape: Some(shape), .. } => {
            shapes[shape].solid
        }
        _ if probe.phase() == Phase::Solid => {
            needs_solid(&section, solids, "a probe of a solid");
            which_solid(&section, solids)
        }
        _ => None,
    };
    let needless = match probe.kind {
        ProbeKind::Displacement { .. } => Some("the displacement is that of the solid nearest to `at`"),
        ProbeKind::Position { .. } => Some("the position is that of the solid nearest to `at`"),
        ProbeKind::Stress { .. } | ProbeKind::CauchyStress { of: Spot::At(_) } => {
            Some("the stress is that of the solid nearest to `at`")
        }
        ProbeKind::SolidVelocity { .. } => Some("the velocity is that of the solid nearest to `at`"),
        ProbeKind::Strain { of: Spot::At(_) } => Some("the strain is that of the solid nearest to `at`"),
        ProbeKind::Force { shape: Some(_), .. } | ProbeKind::Moment { shape: Some(_), .. } => {
            Some("`shape` says it")
        }
        _ => (probe.phase() == Phase::Fluid).then_some("the probe measures the fluid"),
    };
    if let (Some(why), Some(node)) = (needless, section.node("solid")) {
        section.wrong("solid", node, format!("is not asked for: {why}"));
    }
    section.finish();
    Some(probe)
}

/// A point `at` of a solid, or a `body`.
fn spot(section: &Section<'_>, dimension: usize) -> Option<Spot> {
    let Some(node) = section.node("body") else {
        return Some(Spot::At(section.vector("at", dimension, None)));
    };
    if section.node("at").is_some() {
        section.wrong("body", node, "is measured as a whole, and `at` says a point: a probe has one of them");
        return None;
    }
    Some(Spot::Body(section.string("body")?.to_owned()))
}

/// Pressure at a point `at`, or its mean between `from` and `to`; `shape` is what takes them along.
fn pressure(section: &Section<'_>, dimension: usize, shapes: &[Shape]) -> Option<ProbeKind> {
    let line = ["from", "to"].into_iter().any(|key| section.node(key).is_some());
    if let (true, Some(node)) = (line, section.node("at")) {
        section.wrong("at", node, "is a point, and `from` and `to` say a line: a probe has one of them");
        return None;
    }
    let vector = |key| section.vector(key, dimension, None);
    let (at, to) = if line { (vector("from"), Some(vector("to"))) } else { (vector("at"), None) };
    let flows = |shape: &Shape| {
        (shape.phase == Phase::Fluid).then_some("is of phase \"fluid\": walls and solids take a point along")
    };
    let shape = which_shape(section, shapes, flows)?;
    Some(ProbeKind::Pressure { at, to, shape })
}

/// The shape that a probe of forces names, and the box that it keeps to.
fn loaded(
    section: &Section<'_>,
    dimension: usize,
    shapes: &[Shape],
) -> Option<(Option<usize>, Option<Block>)> {
    let within = section.section("within");
    let within = within.is_present().then(|| within.whole_block(dimension));
    let rigid = |shape: &Shape| {
        (shape.phase == Phase::Fluid).then_some("is of phase \"fluid\": forces are those on walls and solids")
    };
    Some((which_shape(section, shapes, rigid)?, within))
}

/// Index of the shape that `shape` names. `None` where it names none, or one that `refuses` has a reason against.
fn which_shape(
    section: &Section<'_>,
    shapes: &[Shape],
    refuses: impl Fn(&Shape) -> Option<&'static str>,
) -> Option<Option<usize>> {
    let Some(node) = section.node("shape") else { return Some(None) };
    let names: Vec<(&str, usize)> = shapes.iter().enumerate().map(|(k, s)| (s.name.as_str(), k)).collect();
    let shape = section.as_choice("shape", node, &names)?;
    if let Some(reason) = refuses(&shapes[shape]) {
        section.wrong("shape", node, reason);
        return None;
    }
    Some(Some(shape))
}

/// Most gauges of one probe.
pub(crate) const MAX_GAUGES: usize = 1000;

/// x of one column of water, or of several.
fn gauges(section: &Section<'_>) -> Option<Vec<f64>> {
    let Some(node) = section.node("x") else {
        section.missing("x");
        return None;
    };
    let Value::Array(items) = &node.value else {
        return section.as_number("x", node, Range::ANY).map(|x| vec![x]);
    };
    if items.is_empty() || items.len() > MAX_GAUGES {
        section.wrong("x", node, format!("must have from 1 to {MAX_GAUGES} places"));
        return None;
    }
    items.iter().map(|item| section.as_number("x", item, Range::ANY)).collect()
}

pub(super) fn reference(section: Section<'_>, folder: &Path) -> Option<Reference> {
    let text = |key| {
        if section.node(key).is_none() {
            section.missing(key);
        }
        section.string(key).map(str::to_owned)
    };
    let (probe, label) = (text("probe"), text("label"));
    let points = match (section.node("points"), section.node("file")) {
        (Some(node), None) => given(&section, node).map(|points| (points, None)),
        (None, Some(node)) => {
            from_file(&section, node, folder).map(|(points, column)| (points, Some(column)))
        }
        (Some(_), Some(_)) => {
            section.whole("has both `points` and `file`: a curve has one source");
            None
        }
        (None, None) => {
            section.whole("has no points: it needs `points` or `file`");
            None
        }
    };
    for key in ["columns", "scale"] {
        if let (Some(node), None) = (section.node(key), section.node("file")) {
            section.wrong(key, node, "belongs to `file`, and the curve has none");
        }
    }
    section.finish();
    let (points, column) = points?;
    Some(Reference { probe: probe?, label: label?, points, column })
}

fn given(section: &Section<'_>, node: &Node) -> Option<Vec<[f64; 2]>> {
    let Value::Array(items) = &node.value else {
        section.wrong("points", node, "must be an array of points [time, value]");
        return None;
    };
    let mut points = Vec::new();
    for item in items {
        let Value::Array(pair) = &item.value else {
            section.wrong("points", item, "must be a point [time, value]");
            return None;
        };
        let [time, value] = &pair[..] else {
            section.wrong("points", item, "must be a point [time, value]");
            return None;
        };
        points.push([
            section.as_number("points", time, Range::ANY)?,
            section.as_number("points", value, Range::ANY)?,
        ]);
    }
    if points.is_empty() {
        section.wrong("points", node, "has no point");
        return None;
    }
    Some(points)
}

fn from_file(section: &Section<'_>, node: &Node, folder: &Path) -> Option<(Vec<[f64; 2]>, Column)> {
    let scale = section.number("scale", Some(1.0));
    let columns = columns(section);
    let path = section.string("file")?;
    let file = folder.join(path);
    let [time, value] = columns?;
    match read_csv(&file, time, value) {
        Ok(points) => {
            let points: Vec<_> = points.into_iter().map(|[t, v]| [t, v * scale]).collect();
            if let (false, Some(node)) = (points.iter().all(|p| p[1].is_finite()), section.node("scale")) {
                section.wrong("scale", node, "makes values of the file infinite");
            }
            let [path, title, time] = [path, value, time].map(str::to_owned);
            Some((points, Column { file: path, title, time, scale }))
        }
        Err(reason) => {
            section.wrong("file", node, format!("{}: {reason}", file.display()));
            None
        }
    }
}

fn columns<'n>(section: &Section<'n>) -> Option<[&'n str; 2]> {
    let Some(node) = section.node("columns") else {
        section.missing("columns");
        return None;
    };
    let title = |item: &'n Node| match &item.value {
        Value::String(title) => Some(title.as_str()),
        _ => None,
    };
    let titles: Option<Vec<&str>> = match &node.value {
        Value::Array(items) => items.iter().map(title).collect(),
        _ => None,
    };
    match titles.as_deref() {
        Some(&[time, value]) => Some([time, value]),
        _ => {
            section.wrong("columns", node, "must be the titles of two columns, [time, value]");
            None
        }
    }
}

/// Two columns of a file with comments (`#`) and a line of titles; rows without the value are left out.
pub(super) fn read_csv(path: &Path, time: &str, value: &str) -> Result<Vec<[f64; 2]>, String> {
    let rows = read_columns(path, &[time, value])?;
    Ok(rows.into_iter().map(|row| [row[0], row[1]]).collect())
}

/// Some columns of a file with comments (`#`) and a line of titles; rows without the second one are left out.
pub(super) fn read_columns(path: &Path, wanted: &[&str]) -> Result<Vec<Vec<f64>>, String> {
    let text = file::read(path)?;
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    let titles = reader.headers().map_err(|e| e.to_string())?.clone();
    let index = |title: &&str| {
        titles.iter().position(|t| t == *title).ok_or_else(|| {
            let all = super::error::listed(titles.iter(), "and");
            format!("has no column `{title}`; its columns are {all}")
        })
    };
    let columns = wanted.iter().map(index).collect::<Result<Vec<usize>, String>>()?;
    let mut points = Vec::new();
    for row in reader.records() {
        let row = row.map_err(|e| e.to_string())?;
        let number = |column: &usize| {
            let text = row.get(*column).unwrap_or_default();
            let line = row.position().map_or(0, |p| p.line());
            match text.parse::<f64>() {
                Ok(x) if x.is_finite() => Ok(x),
                _ => Err(format!("line {line}: `{text}` is no number")),
            }
        };
        if !row.get(columns[1]).unwrap_or_default().is_empty() {
            points.push(columns.iter().map(number).collect::<Result<Vec<f64>, String>>()?);
        }
    }
    if points.is_empty() { Err("has no row".into()) } else { Ok(points) }
}
