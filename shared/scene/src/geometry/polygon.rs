//! Regions of the plane that straight sides bound.

mod edges;
mod faces;
mod rows;
mod standing;
mod validity;

pub(crate) use edges::{Edge, Edges};
pub(super) use rows::rows;
pub(super) use standing::{Standing, standing};
pub(crate) use validity::Fault;

use super::points::{Point, Spacing};
use serde::{Deserialize, Serialize};

/// Most corners of a polygon with its holes: the thickness of each is measured between all pairs of its sides.
pub const MAX_CORNERS: usize = 2000;

/// A region between an outline and holes in it.
///
/// The outline runs counter-clockwise, holes clockwise: the region lies on the left of every side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polygon {
    /// Corners, m.
    pub outline: Vec<[f64; 2]>,
    /// Corners of each hole, m.
    pub holes: Vec<Vec<[f64; 2]>>,
}

/// Twice the area that a line of corners encloses, m²: positive where it runs counter-clockwise.
pub fn twice_area(corners: &[[f64; 2]]) -> f64 {
    let Some(o) = corners.first() else { return 0.0 };
    let next = corners.iter().cycle().skip(1);
    // From the first corner: far from the origin the products would lose their digits.
    corners.iter().zip(next).map(|(a, b)| (a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1])).sum()
}

impl Polygon {
    /// A region from an outline and holes that run either way.
    ///
    /// # Errors
    /// What is wrong with them.
    pub(crate) fn new(mut outline: Vec<[f64; 2]>, mut holes: Vec<Vec<[f64; 2]>>) -> Result<Self, Fault> {
        validity::check(&outline, &holes)?;
        if twice_area(&outline) < 0.0 {
            outline.reverse();
        }
        for hole in holes.iter_mut().filter(|hole| twice_area(hole) > 0.0) {
            hole.reverse();
        }
        Ok(Self { outline, holes })
    }

    /// Area, m².
    pub fn area(&self) -> f64 {
        let holes: f64 = self.holes.iter().map(|hole| twice_area(hole)).sum();
        0.5 * (twice_area(&self.outline) + holes)
    }

    /// Least distance of sides that face each other across the region, m, and the middle between them. Where none do,
    /// as in a triangle: twice the area over the longest side, in the middle of that side.
    pub fn thickness(&self) -> (f64, [f64; 2]) {
        self.facing().unwrap_or_else(|| {
            let edges = Edges::new(self);
            let edge = edges.longest();
            let middle = std::array::from_fn(|a| 0.5 * (edge.from[a] + edge.to[a]));
            (2.0 * self.area() / edge.length(), middle)
        })
    }

    /// Least distance of sides that face each other across the region, m, and the middle between them.
    pub(super) fn facing(&self) -> Option<(f64, [f64; 2])> {
        faces::least(&Edges::new(self))
    }

    /// Distance of a point, m: zero inside.
    pub(super) fn distance(&self, p: &[f64; 2]) -> f64 {
        Edges::new(self).distance(p)
    }

    /// The faces that are nearest to each other across the polygon at a point in it: the unit normal out of the one,
    /// the point's distances from the one and from the other, m.
    pub(super) fn across(edges: &Edges, p: &[f64; 2]) -> Option<([f64; 2], [f64; 2])> {
        faces::across(edges, p)
    }

    /// Particles of a lattice that lies along the polygon's longest side (`aligned`) or the axes, from the side's
    /// beginning or the lowest corner of the box around it.
    pub(super) fn fill<const D: usize>(&self, spacing: Spacing, aligned: bool) -> Vec<Point<D>> {
        let edges = Edges::new(self);
        let (origin, along) = match aligned {
            true => (edges.longest().from, edges.longest().direction()),
            false => (edges.low, [1.0, 0.0]),
        };
        let [cos, sin] = super::moved::turn(spacing.turn);
        let along = [cos * along[0] - sin * along[1], sin * along[0] + cos * along[1]];
        let across = [-along[1], along[0]];
        let place = |s: f64, t: f64| [0, 1].map(|a| origin[a] + along[a] * s + across[a] * t);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in &self.outline {
            let from = [corner[0] - origin[0], corner[1] - origin[1]];
            let at = [dot(&from, &along), dot(&from, &across)];
            for a in 0..2 {
                (low[a], high[a]) = (low[a].min(at[a]), high[a].max(at[a]));
            }
        }
        let range = |a: usize| {
            ((low[a] / spacing.dx).floor() as i64 - 1)..=((high[a] / spacing.dx).ceil() as i64 + 1)
        };
        let margin = -super::TOLERANCE * spacing.dx;
        let mut points = Vec::new();
        for j in range(1) {
            for i in range(0) {
                let at = place(spacing.place(i) * spacing.dx, spacing.place(j) * spacing.dx);
                if edges.contains(&at, margin) {
                    let position = in_space(at);
                    points.push(Point { position, normal: [0.0; D], depth: 0.0, corner: false });
                }
            }
        }
        points
    }
}

pub(super) fn dot(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// A point of the plane with D components.
pub(super) fn in_space<const D: usize>(at: [f64; 2]) -> [f64; D] {
    std::array::from_fn(|a| if a < 2 { at[a] } else { 0.0 })
}

#[cfg(test)]
mod tests;
