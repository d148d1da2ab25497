//! Where a shape is: polygons, outlines from files, and what turns, shifts and repeats any geometry.

use super::document::{Node, Value};
use super::drawing::{self, Region};
use super::geometry::{Fault, MAX_CORNERS, Moved, Polygon};
use super::read_probe::read_csv;
use super::section::Section;
use super::*;
use std::path::Path;

/// Most copies of a shape.
pub(crate) const MAX_COPIES: u32 = 100_000;

/// The polygon that a shape's `polygon` or `outline` with its `holes` says; `None` with errors.
pub(super) fn polygon(section: &Section<'_>, key: &'static str, folder: &Path) -> Option<Polygon> {
    let node = section.node(key)?;
    let region = match key {
        "outline" => from_file(section, folder),
        _ => corners(section, key, node).map(|outline| Region { outline, holes: Vec::new() }),
    };
    let holes_node = section.node("holes");
    let holes = match holes_node {
        None => Some(Vec::new()),
        Some(holes) => match &holes.value {
            Value::Array(items) => items.iter().map(|item| corners(section, "holes", item)).collect(),
            _ => {
                section.wrong("holes", holes, "must be an array of holes, each an array of corners [x, y]");
                None
            }
        },
    };
    let (region, mut holes) = (region?, holes?);
    let own = holes.len();
    holes.extend(region.holes);
    match Polygon::new(region.outline, holes) {
        Ok(polygon) => Some(polygon),
        Err(Fault { hole: None, reason }) => {
            section.wrong(key, node, reason);
            None
        }
        Err(Fault { hole: Some(index), reason }) if index >= own => {
            section.wrong(
                key,
                node,
                format!("has a part that {reason}: a path is one region with its holes"),
            );
            None
        }
        Err(Fault { hole: Some(index), reason }) => {
            let at = match holes_node.map(|node| &node.value) {
                Some(Value::Array(items)) => items.get(index),
                _ => None,
            };
            section.wrong(&format!("holes.{index}"), at.unwrap_or(node), reason);
            None
        }
    }
}

fn corners(section: &Section<'_>, key: &str, node: &Node) -> Option<Vec<[f64; 2]>> {
    let Value::Array(items) = &node.value else {
        section.wrong(key, node, "must be an array of corners [x, y]");
        return None;
    };
    if items.len() > MAX_CORNERS + 1 {
        let reason = format!("has {} corners; at most {MAX_CORNERS}", items.len());
        section.wrong(key, node, reason);
        return None;
    }
    let corner = |item: &Node| section.as_vector(key, item, 2).map(|v| [v[0], v[1]]);
    items.iter().map(corner).collect::<Option<Vec<_>>>().map(open)
}

/// A line of corners without the repetition of its first one.
fn open(mut corners: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    if corners.len() > 3 && corners.first() == corners.last() {
        corners.pop();
    }
    corners
}

fn from_file(section: &Section<'_>, folder: &Path) -> Option<Region> {
    let table = section.section("outline");
    let node = table.node("file");
    let file = table.string("file");
    if table.is_present() && node.is_none() {
        table.missing("file");
    }
    let scale = table.number("scale", Some(1.0));
    let (id_node, id) = (table.node("id"), table.string("id"));
    let (node, file) = (node?, folder.join(file?));
    let drawing = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg"));
    if let (Some(id_node), false) = (id_node, drawing) {
        table.wrong("id", id_node, "only a drawing, a file that ends in .svg, has paths with ids");
    }
    let found = if drawing {
        file::read(&file).and_then(|text| drawing::read(&text, id))
    } else {
        read_csv(&file, "x", "y").map(|outline| Region { outline, holes: Vec::new() }).map_err(|reason| {
            let table = file.extension().is_none_or(|extension| extension.eq_ignore_ascii_case("csv"));
            let other = "; what does not end in .svg is read as a table with the columns `x` and `y`";
            format!("{reason}{}", if table { "" } else { other })
        })
    };
    let found = found.and_then(|Region { outline, holes }| {
        let scaled =
            |line: Vec<[f64; 2]>| open(line.into_iter().map(|corner| corner.map(|x| x * scale)).collect());
        let region = Region { outline: scaled(outline), holes: holes.into_iter().map(scaled).collect() };
        let all = region.holes.iter().chain([&region.outline]).flatten().flatten();
        let far = all.copied().find(|x| x.abs() > 1e12);
        match far {
            Some(x) => Err(format!("{x:e} m is farther than 1e12 m from the origin")),
            None => Ok(region),
        }
    });
    let found = found.map_err(|reason| table.wrong("file", node, format!("{}: {reason}", file.display())));
    table.finish();
    found.ok()
}

/// A geometry as `rotate`, `translate` and `repeat` of its shape have it.
pub(super) fn moved(section: &Section<'_>, geometry: Geometry, dimension: usize) -> Geometry {
    let (rotate, repeat) = (section.section("rotate"), section.section("repeat"));
    let translate = section.node("translate").is_some();
    if !rotate.is_present() && !repeat.is_present() && !translate {
        return geometry;
    }
    let mut moved = Moved {
        angle: 0.0,
        about: middle(&geometry, dimension),
        translate: section.vector("translate", dimension, Some([0.0; 3])),
        count: 1,
        step: [0.0; 3],
        geometry: Box::new(geometry),
    };
    if rotate.is_present() {
        moved.angle = rotate.number("angle", None);
        moved.about = rotate.vector("about", dimension, Some(moved.about));
    }
    if repeat.is_present() {
        if repeat.node("count").is_none() {
            repeat.missing("count");
        }
        moved.count = repeat.integer("count", 1);
        moved.step = repeat.vector("step", dimension, None);
        if let (true, Some(node)) = (moved.count > 1 && moved.step == [0.0; 3], repeat.node("step")) {
            repeat.wrong("step", node, "puts all copies in one place");
        }
    }
    rotate.finish();
    repeat.finish();
    Geometry::Moved(moved)
}

/// The middle of the box around a geometry; of a tank, of its cavity.
fn middle(geometry: &Geometry, dimension: usize) -> [f64; 3] {
    let axis = |a: usize| {
        let unit = std::array::from_fn(|b| f64::from(u8::from(a == b)));
        let [low, high] = geometry::extent(geometry, dimension, 0.0, unit);
        0.5 * (low + high)
    };
    std::array::from_fn(|a| if a < dimension { axis(a) } else { 0.0 })
}
