//! `[[probe]]` and `[[reference]]`.

use super::document::{Node, Value};
use super::read_shape::{name, needs_solid, which_solid};
use super::section::{Range, Section};
use super::*;
use std::path::Path;

#[derive(Clone, Copy)]
enum Kind {
    Displacement,
    Pressure,
    WaterLevel,
    Front,
    KineticEnergy,
    Centroid,
    Force,
}

const KINDS: [(&str, Kind); 7] = [
    ("displacement", Kind::Displacement),
    ("pressure", Kind::Pressure),
    ("water-level", Kind::WaterLevel),
    ("front", Kind::Front),
    ("kinetic-energy", Kind::KineticEnergy),
    ("centroid", Kind::Centroid),
    ("force", Kind::Force),
];

const MOVING: [(&str, Phase); 2] = [("fluid", Phase::Fluid), ("solid", Phase::Solid)];

/// A probe; `None` where it is not clear what it measures, so that nobody asks it anything.
pub(super) fn probe(
    section: Section<'_>,
    dimension: usize,
    solids: &[&str],
    shapes: &[Shape],
) -> Option<Probe> {
    let name = name(&section);
    let at = || section.vector("at", dimension, None);
    // Without a kind its other keys mean nothing: they are not looked at.
    let kind = match section.choice("kind", None, &KINDS)? {
        Kind::Displacement => ProbeKind::Displacement { at: at() },
        Kind::Pressure => ProbeKind::Pressure { at: at() },
        Kind::WaterLevel => ProbeKind::WaterLevel { x: section.number("x", None, Range::ANY) },
        Kind::Front => ProbeKind::Front,
        Kind::KineticEnergy => ProbeKind::KineticEnergy { phase: section.choice("phase", None, &MOVING)? },
        Kind::Centroid => ProbeKind::Centroid { phase: section.choice("phase", None, &MOVING)? },
        Kind::Force => {
            let within = section.section("within");
            ProbeKind::Force { within: within.is_present().then(|| within.whole_block(dimension)) }
        }
    };
    let solid = match kind {
        ProbeKind::Displacement { at } => nearest_solid(shapes, &at),
        _ if kind.phase() == Phase::Solid => {
            needs_solid(&section, solids, "a probe of a solid");
            which_solid(&section, solids)
        }
        _ => None,
    };
    let needless = match kind {
        ProbeKind::Displacement { .. } => Some("the displacement is that of the solid nearest to `at`"),
        _ => (kind.phase() == Phase::Fluid).then_some("the probe measures the fluid"),
    };
    if let (Some(why), Some(node)) = (needless, section.node("solid")) {
        section.wrong("solid", node, format!("is not asked for: {why}"));
    }
    section.finish();
    Some(Probe { name, kind, solid })
}

/// The solid whose shape is nearest to a point: of several equally near the one that comes first.
fn nearest_solid(shapes: &[Shape], at: &[f64; 3]) -> Option<usize> {
    let of_solid = shapes.iter().filter_map(|s| Some((s.solid?, geometry::distance(&s.geometry, at))));
    of_solid.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(solid, _)| solid)
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
        (Some(node), None) => given(&section, node),
        (None, Some(node)) => from_file(&section, node, folder),
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
    Some(Reference { probe: probe?, label: label?, points: points? })
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

fn from_file(section: &Section<'_>, node: &Node, folder: &Path) -> Option<Vec<[f64; 2]>> {
    let scale = section.number("scale", Some(1.0), Range::ANY);
    let columns = columns(section);
    let file = folder.join(section.string("file")?);
    let [time, value] = columns?;
    match read_csv(&file, time, value) {
        Ok(points) => {
            let points: Vec<_> = points.into_iter().map(|[t, v]| [t, v * scale]).collect();
            if let (false, Some(node)) = (points.iter().all(|p| p[1].is_finite()), section.node("scale")) {
                section.wrong("scale", node, "makes values of the file infinite");
            }
            Some(points)
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
    let text = file::read(path)?;
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(text.as_bytes());
    let titles = reader.headers().map_err(|e| e.to_string())?.clone();
    let index = |title: &str| {
        titles.iter().position(|t| t == title).ok_or_else(|| {
            let all = super::error::listed(titles.iter(), "and");
            format!("has no column `{title}`; its columns are {all}")
        })
    };
    let (time, value) = (index(time)?, index(value)?);
    let mut points = Vec::new();
    for row in reader.records() {
        let row = row.map_err(|e| e.to_string())?;
        let number = |column: usize| {
            let text = row.get(column).unwrap_or_default();
            let line = row.position().map_or(0, |p| p.line());
            match text.parse::<f64>() {
                Ok(x) if x.is_finite() => Ok(x),
                _ => Err(format!("line {line}: `{text}` is no number")),
            }
        };
        if !row.get(value).unwrap_or_default().is_empty() {
            points.push([number(time)?, number(value)?]);
        }
    }
    if points.is_empty() { Err("has no row".into()) } else { Ok(points) }
}
