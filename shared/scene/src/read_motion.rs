//! `motion` of a wall or of a solid's clamps.

use super::document::Value;
use super::motion::{Column, Composed, Course, Part, Spline};
use super::read_probe::read_columns;
use super::section::{Range, Section};
use super::*;
use std::path::Path;
use std::sync::Arc;

pub(crate) const INSTANT: Range = Range::at_least(0.0).up_to(1e12);
/// Angles, rad, and angular velocities, rad/s.
pub(crate) const ANGLE: Range = Range::at_least(-1e6).up_to(1e6);
/// Longest series of a file.
const MAX_ROWS: usize = 1_000_000;

/// What of the rest of the scene motions need.
#[derive(Clone, Copy)]
pub(super) struct Around<'a> {
    pub(super) dimension: usize,
    pub(super) folder: &'a Path,
    /// m/s².
    pub(super) gravity: [f64; 3],
    /// s.
    pub(super) end_time: f64,
}

/// A motion, or a list of them that add up.
pub(super) fn motion(section: &Section<'_>, around: &Around<'_>) -> Option<Motion> {
    let dimension = around.dimension;
    let node = section.node("motion")?;
    let tables = match node.table() {
        Some(_) => vec![section.section("motion")],
        None => section.tables("motion"),
    };
    if tables.is_empty() {
        if matches!(&node.value, Value::Array(items) if items.is_empty()) {
            section.wrong("motion", node, "has no part");
        }
        return None;
    }
    let alone = tables.len() == 1;
    let mut composed = Composed { pivot: None, parts: Vec::new(), makes: None };
    for table in tables {
        if alone && let Some(simple) = simple(&table, dimension) {
            table.finish();
            return Some(simple);
        }
        let parts = if makes_waves(&table) {
            let (parts, makes) = read_waves::waves(&table, around).unwrap_or_default();
            if composed.makes.is_some() && makes.is_some() {
                table.whole("makes waves beside another part that does: a paddle makes one sort of waves");
            }
            composed.makes = makes.or(composed.makes);
            parts
        } else {
            parts(&table, dimension, around.folder)
        };
        let turns = parts.iter().any(|part| part.angle != 0.0) || table.node("pivot").is_some();
        if turns {
            let pivot = table.vector("pivot", dimension, None);
            match composed.pivot {
                Some(other) if other != pivot && pivot.iter().all(|x| x.is_finite()) => {
                    let reason =
                        "must be that of the parts before it: what moves has one pivot, which goes along";
                    table.node("pivot").iter().for_each(|node| table.wrong("pivot", node, reason));
                }
                _ => composed.pivot = Some(pivot),
            }
        }
        composed.parts.extend(parts);
        table.finish();
    }
    Some(Motion::Composed(Arc::new(composed)))
}

fn makes_waves(table: &Section<'_>) -> bool {
    table.has("wave")
}

/// A translation at constant velocity, or one that swings.
fn simple(table: &Section<'_>, dimension: usize) -> Option<Motion> {
    let has = |key| table.node(key).is_some();
    if makes_waves(table) {
        return None;
    }
    if ["angular_velocity", "angle", "file", "pivot", "phase"].into_iter().any(has) {
        return None;
    }
    match (has("velocity"), has("amplitude")) {
        (true, false) if !has("ramp") => {
            let (start, end) = span(table, 0.0);
            Some(Motion::Steady { velocity: table.vector("velocity", dimension, None), start, end })
        }
        (false, true) => Some(Motion::Oscillating {
            amplitude: table.vector("amplitude", dimension, None),
            period: table.number("period", None),
            start: table.number("start", Some(0.0)),
            ramp: table.number("ramp", Some(0.0)),
        }),
        _ => None,
    }
}

/// Start and end, with room for two ramps between them.
fn span(table: &Section<'_>, ramp: f64) -> (f64, f64) {
    let start = table.number("start", Some(0.0));
    let end = table.number("end", Some(1e12));
    if end <= start {
        table.whole(format!("must have an `end` after its `start`, {start} s"));
    } else if end - start < 2.0 * ramp {
        table.whole(format!(
            "must last as long as two ramps, {} s: one at its start, one at its end",
            2.0 * ramp
        ));
    }
    (start, end)
}

fn parts(table: &Section<'_>, dimension: usize, folder: &Path) -> Vec<Part> {
    let has = |key| table.node(key).is_some();
    let kinds = [has("velocity") || has("angular_velocity"), has("amplitude") || has("angle"), has("file")];
    let zero = Some([0.0; 3]);
    match kinds {
        [true, false, false] => {
            let ramp = table.number("ramp", Some(0.0));
            let (start, end) = span(table, ramp);
            vec![Part {
                course: Course::Steady { start, end, ramp },
                translation: table.vector("velocity", dimension, zero),
                angle: table.number("angular_velocity", Some(0.0)),
            }]
        }
        [false, true, false] => {
            let phase = table.number("phase", Some(0.0));
            let ramp = table.number("ramp", Some(0.0));
            if let (true, Some(node)) = (phase != 0.0 && ramp == 0.0, table.node("phase")) {
                table.wrong(
                    "phase",
                    node,
                    "needs a `ramp`: without one it would not begin where the scene has it",
                );
            }
            vec![Part {
                course: Course::Sine {
                    period: table.number("period", None),
                    phase,
                    start: table.number("start", Some(0.0)),
                    ramp,
                },
                translation: table.vector("amplitude", dimension, zero),
                angle: table.number("angle", Some(0.0)),
            }]
        }
        [false, false, true] => from_file(table, dimension, folder).unwrap_or_default(),
        _ => {
            table.whole(
                "needs one of `velocity` or `angular_velocity` (a steady motion), `amplitude` or `angle` with `period` \
                 (an oscillation), `file` (a series) and `wave` (a wave maker)",
            );
            // What the others would have meant is not asked.
            ["start", "end", "ramp", "period", "phase", "columns", "scale"]
                .into_iter()
                .for_each(|key| _ = table.node(key));
            Vec::new()
        }
    }
}

/// A series in a file: `columns = { time, x, y, angle }` are the titles of its columns.
fn from_file(table: &Section<'_>, dimension: usize, folder: &Path) -> Option<Vec<Part>> {
    let scale = table.number("scale", Some(1.0));
    let columns = table.section("columns");
    if !columns.is_present() {
        if table.node("columns").is_none() {
            table.missing("columns");
        }
        return None;
    }
    let axes = &["x", "y", "z"][..dimension];
    if columns.node("time").is_none() {
        columns.missing("time");
    }
    let time = columns.string("time");
    let mut found = Vec::new();
    for (axis, key) in axes.iter().copied().chain(["angle"]).enumerate() {
        found.extend(columns.string(key).map(|title| (title, (key != "angle").then_some(axis))));
    }
    if found.is_empty() {
        columns.whole("names no column that moves anything: `x`, `y` (m) or `angle` (rad)");
    }
    columns.finish();
    let (node, path) = (table.node("file")?, table.string("file")?);
    let file = folder.join(path);
    let titles: Vec<&str> = [time?].into_iter().chain(found.iter().map(|(title, _)| *title)).collect();
    let wrong = |reason: String| table.wrong("file", node, format!("{}: {reason}", file.display()));
    let read = read_columns(&file, &titles).and_then(|rows| match rows.len() {
        n if n > MAX_ROWS => Err(format!("has more than {MAX_ROWS} rows")),
        n if n < 2 => Err("has a single row".into()),
        _ => Ok(rows),
    });
    let rows = read.map_err(wrong).ok()?;
    let times: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    if let Some(k) = (1..times.len()).find(|&k| times[k] <= times[k - 1]) {
        wrong(format!("goes back in time: {} s follows {} s", times[k], times[k - 1]));
        return None;
    }
    let part = |(column, &(title, axis)): (usize, &(&str, Option<usize>))| {
        let values: Vec<f64> = rows.iter().map(|row| scale * row[column + 1]).collect();
        let [title, time] = [title, titles[0]].map(str::to_owned);
        let of = Column { file: path.to_owned(), title, time, scale };
        let spline = Spline::new(times.clone(), values).from_column(of);
        let mut part = Part { course: Course::Points(spline), translation: [0.0; 3], angle: 0.0 };
        match axis {
            Some(axis) => part.translation[axis] = 1.0,
            None => part.angle = 1.0,
        }
        part
    };
    let parts: Vec<Part> = found.iter().enumerate().map(part).collect();
    let finite = |part: &Part| matches!(&part.course, Course::Points(s) if s.fastest().is_finite() && s.fastest() < 1e12);
    if !parts.iter().all(finite) {
        wrong("moves faster than 1e12 m/s or rad/s".into());
        return None;
    }
    Some(parts)
}
