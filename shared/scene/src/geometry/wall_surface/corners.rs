//! Corners of walls, which others' faces touch: of a ridge between two of a body's points none of the body's own points
//! knows.

use super::regions::{regions, union};
use super::{SHORTEST, distinct, that_move_alike, turn_at};
use crate::geometry::points::Spacing;
use crate::{Geometry, Scene};

/// Sine of the angle from which on an outline has a corner.
const STRAIGHT: f64 = 1e-6;

/// A corner of a wall in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallCorner {
    /// Index of the wall in [`Scene::shapes`].
    pub shape: usize,
    /// m.
    pub place: [f64; 2],
}

/// Where walls that solids may touch stand out: convex corners of polygons, boxes and tanks that are corners of the
/// union of all walls that move alike, too. Where two walls are flush there is none. Circles have none. In space there
/// are none.
pub fn wall_corners(scene: &Scene) -> Vec<WallCorner> {
    if scene.dimension != 2 {
        return Vec::new();
    }
    let near = SHORTEST * scene.resolution;
    let mut all: Vec<WallCorner> = Vec::new();
    for members in that_move_alike(scene) {
        let outlines = union(scene, &members);
        let contours = outlines.iter().flatten().map(|contour| distinct(contour, near));
        let convex: Vec<[f64; 2]> = contours
            .filter(|corners| corners.len() > 2)
            .flat_map(|corners| {
                let stands_out = |k: &usize| turn_at(&corners, *k).0 > STRAIGHT;
                (0..corners.len()).filter(stands_out).map(|k| corners[k]).collect::<Vec<_>>()
            })
            .collect();
        // A union's own corners are rounded.
        for &shape in &members {
            let wall = &scene.shapes[shape];
            if is_round(&wall.geometry) {
                continue;
            }
            let own = regions(&wall.geometry, Spacing::of(scene, wall));
            for place in own.into_iter().flatten().flatten() {
                let meets = |other: &[f64; 2]| libm::hypot(other[0] - place[0], other[1] - place[1]) < near;
                if convex.iter().any(meets) && !all.iter().any(|corner| meets(&corner.place)) {
                    all.push(WallCorner { shape, place });
                }
            }
        }
    }
    all
}

/// It is bounded by circles.
fn is_round(geometry: &Geometry) -> bool {
    match geometry {
        Geometry::Disc { .. } | Geometry::Ring { .. } => true,
        Geometry::Moved(moved) => is_round(&moved.geometry),
        Geometry::Box(_) | Geometry::Tank { .. } | Geometry::Polygon(_) => false,
    }
}
