//! Sharp corners of walls that fluid falls into.

use super::near;
use super::reached::{Matter, reached};
use super::shapes::{length, place};
use halfstep_scene::geometry::{Layout, Moved, Polygon, Regions, Surface, cell};
use halfstep_scene::{Block, Geometry, Phase, Scene, Shape, expected_speed};

/// Angle below which a corner focuses what falls into it, degrees.
const SHARP: f64 = 30.0;
/// Fluid that begins within so many spacings of a corner does not fall into it.
const FILLED: f64 = 4.0;
/// A sound speed so many times that of "auto" is the author's own.
const OWN: f64 = 1.2;
/// Sides of two walls that end within so many spacings of each other meet.
const MEET: f64 = 0.5;

/// A corner that a wall leaves to the fluid, in a plane.
struct Corner {
    at: [f64; 2],
    /// Degrees between its sides.
    angle: f64,
    /// Unit vector between its sides.
    middle: [f64; 2],
}

/// Corners sharper than 30 degrees that are empty at the start and that fluid from above can come to.
pub(super) fn corners<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let Some(fluid) = scene.fluid.as_ref().filter(|_| !layout.fluid.is_empty() && D == 2) else { return };
    let walls: Vec<&Shape> = scene.shapes.iter().filter(|s| s.phase == Phase::Wall).collect();
    let of_wall = |wall: &&Shape| {
        let name = format!("the corner of `{}`", wall.name);
        of_geometry(&wall.geometry).into_iter().map(move |corner| (name.clone(), corner))
    };
    let mut sharp: Vec<(String, Corner)> = walls.iter().flat_map(of_wall).collect();
    sharp.extend(between(scene, &walls));
    if sharp.is_empty() || fluid.sound_speed > OWN * 10.0 * expected_speed(scene) {
        return;
    }
    let dx = scene.resolution;
    let level = reached(scene, layout, &Matter::of_walls(scene, layout), false);
    for (corner_of, Corner { at, angle, middle }) in sharp {
        // Where the sides are three spacings apart a cell between them is free.
        let way = 1.5 * dx / (0.5 * angle.to_radians()).sin();
        let inside: [f64; D] = std::array::from_fn(|a| at[a] + way * middle[a]);
        let corner: [f64; D] = std::array::from_fn(|a| at[a]);
        let filled = layout.fluid.iter().any(|p| near(&p.position, &corner, way + FILLED * dx));
        if !filled && level.contains(&cell(&inside, dx)) {
            all.push(format!(
                "fluid comes into {corner_of} at {}, whose sides meet at {angle:.0} degrees: there it is compressed \
                 the more the finer the spacing, and may diverge with the sound speed that \"auto\" gives \
                 (fluid.sound_speed = {} is twice that)",
                place(&at),
                length(2.0 * fluid.sound_speed)
            ));
        }
    }
}

/// Sides of a wall: of what is round none, of a tank those of its cavity that are closed.
fn sides(geometry: &Geometry) -> Vec<[[f64; 2]; 2]> {
    let mut all = Vec::new();
    match geometry.unmoved() {
        Geometry::Box(_) | Geometry::Polygon(_) => {
            Surface::new(geometry, None).outline(f64::INFINITY, &mut |_, ends| all.push(ends));
        }
        Geometry::Tank { cavity: Block { min, max }, open } => {
            let corners = [[min[0], min[1]], [max[0], min[1]], [max[0], max[1]], [min[0], max[1]]];
            let [bottom, right, top, left] = [0, 1, 2, 3].map(|k| [corners[k], corners[(k + 1) % 4]]);
            let named = [[left, right], [bottom, top]];
            for (axis, both) in named.into_iter().enumerate() {
                let closed = halfstep_scene::geometry::sides(axis).map(|side| !open.contains(&side));
                all.extend(both.into_iter().zip(closed).filter(|(_, closed)| *closed).map(|(side, _)| side));
            }
            if let Geometry::Moved(moved) = geometry {
                let first = all;
                let placed = |copy| first.iter().map(move |side| side.map(|end| moved.place(copy, end)));
                all = moved.copies().flat_map(placed).collect();
            }
        }
        _ => {}
    }
    all
}

/// Sharp corners that two walls leave between them.
fn between(scene: &Scene, walls: &[&Shape]) -> Vec<(String, Corner)> {
    let dx = scene.resolution;
    let all: Vec<Vec<[[f64; 2]; 2]>> = walls.iter().map(|wall| sides(&wall.geometry)).collect();
    let regions = Regions::of(scene, |shape| shape.phase == Phase::Wall);
    let mut corners = Vec::new();
    for (k, one) in all.iter().enumerate() {
        for (other, name) in all.iter().zip(walls).skip(k + 1) {
            let pairs = one.iter().flat_map(|a| other.iter().map(move |b| (a, b)));
            let found = pairs.filter_map(|(a, b)| meeting(a, b, &regions, dx));
            let named = format!("the corner between `{}` and `{}`", walls[k].name, name.name);
            corners.extend(found.take(1).map(|corner| (named.clone(), corner)));
        }
    }
    corners
}

/// The sharp corner at which two sides meet, or cross, with no wall in it.
fn meeting(a: &[[f64; 2]; 2], b: &[[f64; 2]; 2], regions: &Regions<'_>, dx: f64) -> Option<Corner> {
    let way = |[from, to]: &[[f64; 2]; 2]| [to[0] - from[0], to[1] - from[1]];
    let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
    let (u, v) = (way(a), way(b));
    let sine = cross(u, v);
    if sine == 0.0 {
        return None;
    }
    // Where the lines cross, as parts of the sides.
    let from = [b[0][0] - a[0][0], b[0][1] - a[0][1]];
    let (s, t) = (cross(from, v) / sine, cross(from, u) / sine);
    let sized = [(s, u), (t, v)].map(|(part, way)| (part, way, way[0].hypot(way[1])));
    let on = |(part, _, size): &(f64, [f64; 2], f64)| {
        let slack = MEET * dx / size;
        -slack <= *part && *part <= 1.0 + slack
    };
    if !sized.iter().all(on) {
        return None;
    }
    let at = [0, 1].map(|k| a[0][k] + s * u[k]);
    // The ways along each side that go on from there.
    let goes_on = |(part, way, size): (f64, [f64; 2], f64)| {
        let unit = way.map(|x| x / size);
        let ends = [((1.0 - part) * size, 1.0), (part * size, -1.0)];
        ends.into_iter().filter(|(long, _)| *long > 2.0 * dx).map(move |(_, sign)| unit.map(|x| sign * x))
    };
    let both = goes_on(sized[0]).flat_map(|one| goes_on(sized[1]).map(move |other| [one, other]));
    both.filter_map(|[one, other]| {
        let angle = (one[0] * other[0] + one[1] * other[1]).clamp(-1.0, 1.0).acos().to_degrees();
        let sum = [one[0] + other[0], one[1] + other[1]];
        let middle = sum.map(|x| x / sum[0].hypot(sum[1]));
        let free = |ways: f64| !regions.hold(&[0, 1].map(|k| at[k] + ways * dx * middle[k]), 0.0);
        (angle < SHARP && free(1.0) && free(2.0)).then_some(Corner { at, angle, middle })
    })
    .next()
}

fn of_geometry(geometry: &Geometry) -> Vec<Corner> {
    match geometry {
        Geometry::Polygon(polygon) => of_polygon(polygon),
        Geometry::Moved(moved) => moved.copies().flat_map(|copy| of_copy(moved, copy)).collect(),
        _ => Vec::new(),
    }
}

fn of_copy(moved: &Moved, copy: u32) -> Vec<Corner> {
    let placed = |corner: Corner| {
        let tip = [0, 1].map(|a| corner.at[a] + corner.middle[a]);
        let at: [f64; 2] = moved.place(copy, corner.at);
        let tip: [f64; 2] = moved.place(copy, tip);
        Corner { at, middle: [tip[0] - at[0], tip[1] - at[1]], ..corner }
    };
    of_geometry(&moved.geometry).into_iter().map(placed).collect()
}

/// Corners of the outline that go into the wall, and those of holes.
fn of_polygon(polygon: &Polygon) -> Vec<Corner> {
    let mut lines = vec![(&polygon.outline, -1.0)];
    lines.extend(polygon.holes.iter().map(|hole| (hole, 1.0)));
    let mut all = Vec::new();
    for (line, outward) in lines {
        // Positive where the fluid's side of a corner turns by less than half a turn.
        let sense = outward * halfstep_scene::geometry::twice_area(line).signum();
        let n = line.len();
        for k in 0..n {
            let (before, at, after) = (line[(k + n - 1) % n], line[k], line[(k + 1) % n]);
            let unit = |to: [f64; 2]| {
                let way = [to[0] - at[0], to[1] - at[1]];
                way.map(|x| x / way[0].hypot(way[1]))
            };
            let [a, b] = [before, after].map(unit);
            let convex = sense * (a[0] * b[1] - a[1] * b[0]) < 0.0;
            let angle = (a[0] * b[0] + a[1] * b[1]).clamp(-1.0, 1.0).acos().to_degrees();
            if convex && angle < SHARP {
                let sum = [a[0] + b[0], a[1] + b[1]];
                all.push(Corner { at, angle, middle: sum.map(|x| x / sum[0].hypot(sum[1])) });
            }
        }
    }
    all
}
