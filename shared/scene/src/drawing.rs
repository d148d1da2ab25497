//! Outlines from drawings: one closed path of an SVG file.

use super::error::listed;
use super::geometry::{MAX_CORNERS, twice_area};
use kurbo::{BezPath, PathEl, Point};
use usvg::tiny_skia_path::PathSegment;
use usvg::{Group, ImageHrefResolver, Node, Options, Tree};

/// Length of a CSS pixel, m: the unit that a drawing's lengths are read in.
const PIXEL: f64 = 0.0254 / 96.0;

/// Largest distance of a chord from its curve, over the longer side of the box around the path.
const CHORD: f64 = 1e-4;

/// Corners that are nearer to each other than this part of that side are one: the file's numbers have seven digits.
const SAME: f64 = 1e-6;

/// Most ids of paths in a message.
const LISTED: usize = 12;

/// The region inside of a closed path: its outline, and the holes in it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Region {
    /// Corners of the largest part, m.
    pub outline: Vec<[f64; 2]>,
    /// Corners of the other parts, m.
    pub holes: Vec<Vec<[f64; 2]>>,
}

/// The path of a drawing that has this id, or its only one. x points to the right, y upward from the lower edge, and
/// lengths are those on paper.
pub(super) fn read(text: &str, id: Option<&str>) -> Result<Region, String> {
    // Images are no outlines: nothing else is read from disk.
    let none =
        ImageHrefResolver { resolve_data: Box::new(|_, _, _| None), resolve_string: Box::new(|_, _| None) };
    let options = Options { image_href_resolver: none, ..Options::default() };
    let tree = Tree::from_str(text, &options).map_err(|error| format!("is no drawing: {error}"))?;
    let mut paths = Vec::new();
    collect(tree.root(), &mut paths);
    let path = chosen(&paths, id)?;
    region(&in_metres(path, f64::from(tree.size().height())))
}

fn collect<'a>(group: &'a Group, paths: &mut Vec<&'a usvg::Path>) {
    for node in group.children() {
        match node {
            Node::Group(inner) => collect(inner, paths),
            Node::Path(path) => paths.push(path),
            Node::Image(_) | Node::Text(_) => {}
        }
    }
}

fn chosen<'a>(paths: &[&'a usvg::Path], id: Option<&str>) -> Result<&'a usvg::Path, String> {
    let ids = || {
        let named: Vec<&str> = paths.iter().map(|path| path.id()).filter(|id| !id.is_empty()).collect();
        match named.len() {
            0 => "none of its paths has an id".to_owned(),
            n if n > LISTED => format!(
                "it has {n} paths with ids, the first are {}",
                listed(named.into_iter().take(LISTED), "and")
            ),
            _ => format!("its ids are {}", listed(named, "and")),
        }
    };
    match (id, paths) {
        (_, []) => Err("shows no path: what has neither a fill nor a stroke is none".into()),
        (Some(id), _) => {
            let mut found = paths.iter().filter(|path| path.id() == id);
            match (found.next(), found.next()) {
                (Some(path), None) => Ok(path),
                (None, _) => Err(format!("shows no path with the id `{id}`; {}", ids())),
                _ => Err(format!("shows several paths with the id `{id}`")),
            }
        }
        (None, [path]) => Ok(path),
        (None, _) => Err(format!("shows {} paths: say which by `id`; {}", paths.len(), ids())),
    }
}

fn in_metres(path: &usvg::Path, height: f64) -> BezPath {
    let t = path.abs_transform();
    let [sx, kx, tx, ky, sy, ty] = [t.sx, t.kx, t.tx, t.ky, t.sy, t.ty].map(f64::from);
    let place = |p: usvg::tiny_skia_path::Point| {
        let (x, y) = (f64::from(p.x), f64::from(p.y));
        Point::new((sx * x + kx * y + tx) * PIXEL, (height - (ky * x + sy * y + ty)) * PIXEL)
    };
    let element = |segment| match segment {
        PathSegment::MoveTo(p) => PathEl::MoveTo(place(p)),
        PathSegment::LineTo(p) => PathEl::LineTo(place(p)),
        PathSegment::QuadTo(a, p) => PathEl::QuadTo(place(a), place(p)),
        PathSegment::CubicTo(a, b, p) => PathEl::CurveTo(place(a), place(b), place(p)),
        PathSegment::Close => PathEl::ClosePath,
    };
    path.data().segments().map(element).collect()
}

fn region(path: &BezPath) -> Result<Region, String> {
    let around = path.control_box();
    let side = around.width().max(around.height());
    if !(side > 0.0 && side.is_finite()) {
        return Err("has a path without a size".into());
    }
    let (mut parts, mut part, mut open, mut many) = (Vec::new(), Vec::<[f64; 2]>::new(), false, false);
    let near = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()) < SAME * side;
    let mut end = |part: &mut Vec<[f64; 2]>, closed: bool| {
        let returns = part.len() > 1 && near(&part[0], &part[part.len() - 1]);
        open |= !closed && !returns && part.len() > 1;
        if returns {
            part.pop();
        }
        if part.len() > 1 {
            parts.push(std::mem::take(part));
        }
        part.clear();
    };
    kurbo::flatten(path, CHORD * side, |element| match element {
        PathEl::ClosePath => end(&mut part, true),
        PathEl::MoveTo(p) => {
            end(&mut part, false);
            part.push([p.x, p.y]);
        }
        PathEl::LineTo(p) => {
            many |= part.len() > MAX_CORNERS;
            if !many && part.last().is_none_or(|last| !near(last, &[p.x, p.y])) {
                part.push([p.x, p.y]);
            }
        }
        PathEl::QuadTo(..) | PathEl::CurveTo(..) => {}
    });
    end(&mut part, false);
    if open {
        return Err("has a path that is not closed".into());
    }
    if many {
        return Err(format!("has a path of more than {MAX_CORNERS} corners"));
    }
    let size = |k: usize| twice_area(&parts[k]).abs();
    let largest = (0..parts.len()).max_by(|&a, &b| size(a).total_cmp(&size(b)));
    let outline = parts.remove(largest.ok_or("has a path without a size")?);
    Ok(Region { outline, holes: parts })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    /// A drawing of 100 by 50 mm in millimetres.
    fn drawing(inside: &str) -> String {
        format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="50mm" viewBox="0 0 100 50">{inside}</svg>"#
        )
    }

    fn area(corners: &[[f64; 2]]) -> f64 {
        0.5 * twice_area(corners).abs()
    }

    fn close(found: &[[f64; 2]], expected: &[[f64; 2]]) {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (a, b) in found.iter().zip(expected) {
            assert_abs_diff_eq!(a[..], b[..], epsilon = 1e-7);
        }
    }

    #[test]
    fn a_path_has_its_size_on_paper_and_y_points_up() {
        let one = drawing(r#"<path d="M 10 50 h 20 v -10 z"/>"#);
        let region = read(&one, None).unwrap();
        close(&region.outline, &[[0.01, 0.0], [0.03, 0.0], [0.03, 0.01]]);
        assert!(region.holes.is_empty());
    }

    #[test]
    fn a_group_moves_and_turns_its_paths() {
        let turned = r#"<g transform="translate(50 25)"><rect id="a" width="10" height="4" transform="rotate(-90)"/></g>"#;
        // The rectangle reaches from (0, 0) to (10, 4) downward; a quarter turn to the left puts it to (0, 0), (4, 10).
        let mut outline = read(&drawing(turned), Some("a")).unwrap().outline;
        outline.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        close(&outline, &[[0.05, 0.025], [0.05, 0.035], [0.054, 0.025], [0.054, 0.035]]);
    }

    #[test]
    fn a_circle_keeps_its_area_and_a_second_part_is_a_hole() {
        let region = read(&drawing(r#"<circle cx="50" cy="25" r="20"/>"#), None).unwrap();
        // Chords lie up to CHORD times 40 mm, 4e-6 of 0.02 m, inside of the circle: 4e-4 of the area. The library's
        // parabolas lie outside of it by a tenth of that.
        let circle = std::f64::consts::PI * 4e-4;
        assert_abs_diff_eq!(area(&region.outline), circle, epsilon = 4e-4 * circle);

        let ring =
            drawing(r#"<path d="M 20 20 h 5 v 5 h -5 z M 10 10 h 30 v 30 h -30 z" fill-rule="evenodd"/>"#);
        let region = read(&ring, None).unwrap();
        assert_abs_diff_eq!(area(&region.outline), 9e-4, epsilon = 1e-9);
        assert_eq!(region.holes.len(), 1);
        assert_abs_diff_eq!(area(&region.holes[0]), 25e-6, epsilon = 1e-9);
    }

    #[test]
    fn what_is_no_single_closed_path_is_said() {
        let two = drawing(r#"<rect id="a" width="1" height="1"/><rect id="b" x="2" width="1" height="1"/>"#);
        let says = |text: &str, id| read(text, id).unwrap_err();
        assert_eq!(says(&two, None), "shows 2 paths: say which by `id`; its ids are `a` and `b`");
        assert_eq!(says(&two, Some("c")), "shows no path with the id `c`; its ids are `a` and `b`");
        let open = drawing(r#"<path d="M 0 0 h 10 v 10" stroke="black"/>"#);
        assert_eq!(says(&open, None), "has a path that is not closed");
        assert!(says(&drawing(""), None).starts_with("shows no path"));
        assert!(says("x,y\n1,2\n", None).starts_with("is no drawing: "));
        let deep = format!("{}{}", "<g>".repeat(100_000), "</g>".repeat(100_000));
        assert!(!says(&drawing(&deep), None).is_empty());
    }
}
