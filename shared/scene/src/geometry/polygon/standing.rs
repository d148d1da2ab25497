//! Polygons of walls that stand on other walls or lean on them: a side that lies on another wall's surface and ends in
//! an acute corner is set into that wall, by the kernel's support, and has no rows of its own.
//!
//! Rows end on the bisector of two sides, so a wedge whose lower side lies on a floor would have few particles near its
//! tip, in rows of two directions, with gaps between them and the floor's lattice; and so would the upper end of a
//! beach at a tank's side wall. No fluid comes to a side that lies on a wall: the rows of the other side go on behind
//! the wall's surface.

use super::{Edge, Edges, Polygon, dot};
use crate::geometry::points::Spacing;
use crate::geometry::region::{Region, voids_before};
use crate::geometry::{Moved, TOLERANCE};
use crate::{Geometry, Phase, Scene, Shape};

/// Where along a side other walls are looked for.
const ALONG: [f64; 5] = [0.02, 0.25, 0.5, 0.75, 0.98];
/// Cosine of the angle of a corner below which a side is set in: 85 degrees.
const ACUTE: f64 = 0.087;
/// The same of a wedge, in which rows have no room: 45 degrees.
const WEDGE: f64 = std::f64::consts::FRAC_1_SQRT_2 + 1e-9;
/// How many times as deep the sides lie in a polygon whose rows are taken: so deep that no bisector is near.
const DEEPER: f64 = 4.0;

/// A polygon of wall that stands on others.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::geometry) struct Standing {
    /// The places that it holds.
    pub(in crate::geometry) region: Geometry,
    /// The wall whose rows of particles it has in these places.
    pub(in crate::geometry) rows: Geometry,
}

/// The polygon of a wall that stands on other walls, which move as it does; `None` where it does not.
pub(in crate::geometry) fn standing(scene: &Scene, index: usize) -> Option<Standing> {
    let shape = &scene.shapes[index];
    let (polygon, moved) = match &shape.geometry {
        Geometry::Polygon(polygon) => (polygon, None),
        Geometry::Moved(moved) => match &*moved.geometry {
            Geometry::Polygon(polygon) => (polygon, Some(moved)),
            _ => return None,
        },
        _ => return None,
    };
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
    // Copies are alike: what one of them does not lie on is no ground for any.
    let held_by_all = |p: &[f64; 2]| match moved {
        Some(moved) => moved.copies().all(|copy| held(&moved.place(copy, *p))),
        None => held(p),
    };
    let set = set_into(polygon, spacing.thickness(), spacing.dx, held_by_all)?.map(Geometry::Polygon);
    let [region, rows] = set.map(|geometry| match moved {
        Some(moved) => Geometry::Moved(Moved { geometry: Box::new(geometry), ..moved.clone() }),
        None => geometry,
    });
    Some(Standing { region, rows })
}

/// The polygon with all sides that lie on other walls and end acutely moved out by `depth`, m, a multiple of `dx`,
/// and with the same sides [`DEEPER`]; `None` where there are none, or where more than these sides would move out of
/// the walls. `held` says whether another wall holds a place.
pub(super) fn set_into(
    polygon: &Polygon,
    depth: f64,
    dx: f64,
    held: impl Fn(&[f64; 2]) -> bool,
) -> Option<[Polygon; 2]> {
    let edges = Edges::new(polygon);
    let sides = &edges.all[..polygon.outline.len()];
    let lies = |edge: &Edge| {
        let normal = edge.normal();
        let beside = |share: f64, out: f64| {
            [0, 1].map(|a| edge.from[a] + share * (edge.to[a] - edge.from[a]) + out * normal[a])
        };
        ALONG.iter().all(|&share| held(&beside(share, 0.25 * dx)) && held(&beside(share, depth - 0.25 * dx)))
    };
    let lying = |sharper: f64| -> Vec<bool> {
        sides.iter().map(|edge| ends_acutely(sides, edge, sharper) && lies(edge)).collect()
    };
    let inside = |(edge, to): (&Edge, &[f64; 2])| {
        let from = edge.from;
        let steps = (libm::hypot(to[0] - from[0], to[1] - from[1]) / dx).ceil();
        let place = |k: usize| [0, 1].map(|a| from[a] + (k as f64 + 1.0) / steps * (to[a] - from[a]));
        from == *to || (0..steps as usize).all(|k| held(&place(k)))
    };
    let set = |lying: Vec<bool>| {
        let region = lying.contains(&true).then(|| moved_out(sides, &lying, depth)).flatten()?;
        let rows = moved_out(sides, &lying, DEEPER * depth)?;
        sides.iter().zip(&region).all(inside).then_some([region, rows])
    };
    // A beach that ends at the upper edge of a wall would come out of it.
    let [region, rows] = set(lying(ACUTE)).or_else(|| set(lying(WEDGE)))?;
    let of = |outline| Polygon::new(outline, polygon.holes.clone()).ok();
    Some([of(region)?, of(rows)?])
}

/// Whether a side ends in a corner whose angle has a larger cosine. In blunter ones both sides' rows have room.
fn ends_acutely(sides: &[Edge], edge: &Edge, cosine: f64) -> bool {
    let acute = |before: &Edge, after: &Edge| {
        let (a, b) = (before.direction(), after.direction());
        a[0] * b[1] - a[1] * b[0] > 0.0 && -dot(&a, &b) > cosine
    };
    acute(&sides[edge.before], edge) || acute(edge, &sides[edge.after])
}

/// The corners where the sides meet once those that lie on walls have moved out; `None` where parallel ones do not.
fn moved_out(sides: &[Edge], lying: &[bool], depth: f64) -> Option<Vec<[f64; 2]>> {
    let corner = |k: usize| -> Option<[f64; 2]> {
        let meeting = [sides[k].before, k];
        if meeting.iter().all(|&side| !lying[side]) {
            return Some(sides[k].from);
        }
        let [a, b] = meeting.map(|side| sides[side].normal());
        let out = |side: usize| if lying[side] { depth } else { 0.0 };
        let [p, q] = meeting.map(|side| dot(&sides[side].from, &sides[side].normal()) + out(side));
        let cross = a[0] * b[1] - a[1] * b[0];
        (cross.abs() > 1e-6).then(|| [(p * b[1] - q * a[1]) / cross, (q * a[0] - p * b[0]) / cross])
    };
    (0..sides.len()).map(corner).collect()
}
