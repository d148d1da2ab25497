//! Corners of walls, which others' faces touch: of a ridge between two of a body's points none of the body's own points
//! knows.

use super::regions::{Places, copies};
use super::{SHORTEST, direction, distinct, normal, that_move_alike, turn_at};
use crate::Scene;
use crate::geometry::points::Spacing;

/// Sine of the angle from which on an outline has a corner.
const STRAIGHT: f64 = 1e-6;

/// A corner of a wall in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallCorner {
    /// Index of the wall in [`Scene::shapes`].
    pub shape: usize,
    /// m.
    pub place: [f64; 2],
    /// Normals out of the wall of the edges before and after it; a face lies on the corner from between these alone.
    pub normals: [[f64; 2]; 2],
    /// Length of both edges, m.
    pub length: f64,
}

/// Where walls that solids may touch stand out: convex corners of polygons, boxes and tanks that are corners of the
/// union of all walls that move alike, too, once for each such wall. Where two walls are flush there is none. Circles
/// have none. In space there are none.
pub fn wall_corners(scene: &Scene) -> Vec<WallCorner> {
    if scene.dimension != 2 {
        return Vec::new();
    }
    let near = SHORTEST * scene.resolution;
    let mut all = Vec::new();
    for members in that_move_alike(scene) {
        let outlines = Places::union(scene, &members).regions();
        let contours = outlines.iter().flatten().map(|contour| distinct(contour, near));
        let convex: Vec<WallCorner> = contours.filter(|corners| corners.len() > 2).flat_map(convex).collect();
        // A union's own corners are rounded.
        for &shape in members.iter().filter(|&&shape| !scene.shapes[shape].geometry.is_round()) {
            let wall = &scene.shapes[shape];
            let own = copies(&wall.geometry, Spacing::of(scene, wall));
            let first = all.len();
            for place in own.into_iter().flatten().flatten().flatten() {
                let meets = |other: [f64; 2]| libm::hypot(other[0] - place[0], other[1] - place[1]) < near;
                let corner = convex.iter().find(|corner| meets(corner.place));
                let known = all[first..].iter().any(|corner: &WallCorner| meets(corner.place));
                if let Some(corner) = corner.filter(|_| !known) {
                    all.push(WallCorner { shape, place, ..*corner });
                }
            }
        }
    }
    all
}

/// The corners at which a contour turns to its left.
fn convex(corners: Vec<[f64; 2]>) -> Vec<WallCorner> {
    let n = corners.len();
    let edge = |k: usize| {
        let ends = [corners[k % n], corners[(k + 1) % n]];
        (normal(ends), direction(ends).1)
    };
    let stands_out = |k: &usize| turn_at(&corners, *k).0 > STRAIGHT;
    let corner = |k: usize| {
        let [(before, one), (after, other)] = [edge(k + n - 1), edge(k)];
        WallCorner { shape: 0, place: corners[k], normals: [before, after], length: one + other }
    };
    (0..n).filter(stands_out).map(corner).collect()
}
