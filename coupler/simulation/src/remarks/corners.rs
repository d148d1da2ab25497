//! Sharp corners of walls that fluid falls into.

use super::near;
use super::reached::{Matter, reached};
use super::shapes::{length, place};
use halfstep_scene::geometry::{Layout, Moved, Polygon, cell};
use halfstep_scene::{Geometry, Phase, Scene, expected_speed};

/// Angle below which a corner focuses what falls into it, degrees.
const SHARP: f64 = 30.0;
/// Fluid that begins within so many spacings of a corner does not fall into it.
const FILLED: f64 = 4.0;
/// A sound speed so many times that of "auto" is the author's own.
const OWN: f64 = 1.2;

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
    let walls: Vec<_> = scene.shapes.iter().filter(|s| s.phase == Phase::Wall).collect();
    let sharp: Vec<(&str, Corner)> = walls
        .iter()
        .flat_map(|wall| of_geometry(&wall.geometry).into_iter().map(|corner| (wall.name.as_str(), corner)))
        .collect();
    if sharp.is_empty() || fluid.sound_speed > OWN * 10.0 * expected_speed(scene) {
        return;
    }
    let dx = scene.resolution;
    let level = reached(scene, layout, &Matter::of_walls(scene, layout), false);
    for (wall, Corner { at, angle, middle }) in sharp {
        // Where the sides are three spacings apart a cell between them is free.
        let way = 1.5 * dx / (0.5 * angle.to_radians()).sin();
        let inside: [f64; D] = std::array::from_fn(|a| at[a] + way * middle[a]);
        let corner: [f64; D] = std::array::from_fn(|a| at[a]);
        let filled = layout.fluid.iter().any(|p| near(&p.position, &corner, way + FILLED * dx));
        if !filled && level.contains(&cell(&inside, dx)) {
            all.push(format!(
                "fluid comes into the corner of `{wall}` at {}, whose sides meet at {angle:.0} degrees: there it is \
                 compressed the more the finer the spacing, and may diverge with the sound speed that \"auto\" gives \
                 (fluid.sound_speed = {} is twice that)",
                place(&at),
                length(2.0 * fluid.sound_speed)
            ));
        }
    }
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
