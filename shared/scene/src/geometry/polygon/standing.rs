//! Polygons of walls that stand on other walls: a side that lies on another wall's surface is set into that wall, by
//! the kernel's support.
//!
//! Rows end on the bisector of two sides, so a wedge whose lower side lies on a floor would have few particles near its
//! tip, in rows of two directions, with gaps between them and the floor's lattice. No fluid comes to the lower side:
//! below the floor's surface the rows of the upper side go on.

use super::{Edges, Polygon, dot};
use crate::geometry::TOLERANCE;
use crate::geometry::points::Spacing;
use crate::geometry::region::{Region, voids_before};
use crate::{Geometry, Phase, Scene, Shape};

/// Where along a side other walls are looked for.
const ALONG: [f64; 5] = [0.02, 0.25, 0.5, 0.75, 0.98];

/// The polygon of a wall that stands on other walls, which move as it does, set into them; `None` where it does not.
pub(in crate::geometry) fn set_into_walls(scene: &Scene, index: usize) -> Option<Geometry> {
    let shape = &scene.shapes[index];
    let Geometry::Polygon(polygon) = &shape.geometry else { return None };
    let along = |other: &Shape| other.phase == Phase::Wall && other.motion == shape.motion;
    let others = scene.shapes.iter().enumerate().filter(|(k, other)| *k != index && along(other));
    let others: Vec<Region<'_>> = others
        .map(|(k, other)| Region::new(&other.geometry, Spacing::of(scene, other), &voids_before(scene, k)))
        .collect();
    if shape.phase != Phase::Wall || others.is_empty() {
        return None;
    }
    let spacing = Spacing::of(scene, shape);
    let held = |p: &[f64; 2]| others.iter().any(|region| region.contains(p, TOLERANCE * spacing.dx));
    set_into(polygon, spacing.thickness(), spacing.dx, held).map(Geometry::Polygon)
}

/// The polygon with all sides that lie on other walls moved out by `depth`, m, a multiple of `dx`; `None` where there
/// are none, or where more than these sides would move out of the walls. `held` says whether another wall holds a
/// place.
pub(super) fn set_into(
    polygon: &Polygon,
    depth: f64,
    dx: f64,
    held: impl Fn(&[f64; 2]) -> bool,
) -> Option<Polygon> {
    let edges = Edges::new(polygon);
    let sides = &edges.all[..polygon.outline.len()];
    let offsets: Vec<f64> = sides
        .iter()
        .map(|edge| {
            let normal = edge.normal();
            let beside = |share: f64, out: f64| {
                [0, 1].map(|a| edge.from[a] + share * (edge.to[a] - edge.from[a]) + out * normal[a])
            };
            let lies =
                |&share: &f64| held(&beside(share, 0.25 * dx)) && held(&beside(share, depth - 0.25 * dx));
            if ALONG.iter().all(lies) { depth } else { 0.0 }
        })
        .collect();
    if offsets.iter().all(|&offset| offset == 0.0) {
        return None;
    }
    let corner = |k: usize| -> Option<[f64; 2]> {
        let (before, after) = (sides[k].before, k);
        let [a, b] = [before, after].map(|side| sides[side].normal());
        let [p, q] =
            [before, after].map(|side| dot(&sides[side].from, &sides[side].normal()) + offsets[side]);
        let cross = a[0] * b[1] - a[1] * b[0];
        if offsets[before] == 0.0 && offsets[after] == 0.0 {
            return Some(sides[k].from);
        }
        (cross.abs() > 1e-6).then(|| [(p * b[1] - q * a[1]) / cross, (q * a[0] - p * b[0]) / cross])
    };
    let outline: Vec<[f64; 2]> = (0..sides.len()).map(corner).collect::<Option<_>>()?;
    let inside = |(edge, to): (&super::Edge, &[f64; 2])| {
        let from = edge.from;
        let steps = (libm::hypot(to[0] - from[0], to[1] - from[1]) / dx).ceil();
        let place = |k: usize| [0, 1].map(|a| from[a] + (k as f64 + 1.0) / steps * (to[a] - from[a]));
        from == *to || (0..steps as usize).all(|k| held(&place(k)))
    };
    if !sides.iter().zip(&outline).all(inside) {
        return None;
    }
    Polygon::new(outline, polygon.holes.clone()).ok()
}
