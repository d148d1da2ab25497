//! Surfaces of the walls that a solid may touch.
//!
//! In the plane they bound the union of all walls that move alike, less the voids in them and the solids that begin in
//! them: a seam between two flush walls is none, and what is let into a wall has a socket there. The outline is cut
//! into sides at its concave corners, and each side is touched by itself, at its point that is nearest. In space each
//! shape is taken by itself, without voids.

mod corners;
mod normals;
mod regions;

pub use corners::{WallCorner, wall_corners};
pub(super) use normals::{find_edges, where_walls_meet};

use super::{Surface, bounding_box};
use crate::{Block, Motion, Scene, Shape};
use regions::{Places, Regions};

/// Edges shorter than this are none, in spacings.
const SHORTEST: f64 = 1e-6;
/// Sine of the angle from which on a concave corner parts two sides: 15 degrees.
const CORNER: f64 = 0.259;

/// The surface of walls that move alike.
#[derive(Clone, Debug)]
pub struct WallSurface {
    /// How they move.
    pub motion: Option<Motion>,
    /// Velocity of a surface that stays where it is, m/s.
    pub belt: [f64; 3],
    /// Its farthest point's distance from the pivot that it turns about is no larger, m.
    pub radius: f64,
    parts: Vec<Part>,
}

#[derive(Clone, Debug)]
enum Part {
    Side(Side),
    Shape(Surface),
}

/// A part of an outline from one concave corner to the next, or all of it.
#[derive(Clone, Debug, PartialEq)]
struct Side {
    /// m; the wall lies on the left. Of a closed one the first is the last, too.
    corners: Vec<[f64; 2]>,
    end: End,
    /// The box around it, m.
    low: [f64; 2],
    high: [f64; 2],
}

/// Where a side begins and ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    /// In concave corners.
    Corners,
    /// Where it begins.
    Closed,
    /// It begins in a corner and goes straight on as the next one, which ends there: from where, and to where.
    GoesOn([[f64; 2]; 2]),
    /// It goes on from the one before.
    ComesOn([[f64; 2]; 2]),
}

/// Indices of the walls that solids may touch, those together that move alike.
fn that_move_alike(scene: &Scene) -> Vec<Vec<usize>> {
    grouped(scene, scene.walls_to_touch(), Shape::moves_like)
}

/// Indices of shapes, those together that are alike, in the order of the first of each.
fn grouped<'s>(
    scene: &Scene,
    shapes: impl Iterator<Item = (usize, &'s Shape)>,
    alike: impl Fn(&Shape, &Shape) -> bool,
) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = Vec::new();
    for (index, shape) in shapes {
        match all.iter_mut().find(|members| alike(shape, &scene.shapes[members[0]])) {
            Some(members) => members.push(index),
            None => all.push(vec![index]),
        }
    }
    all
}

impl WallSurface {
    /// Of all walls that solids may touch.
    pub fn all(scene: &Scene) -> Vec<Self> {
        let build = |members: Vec<usize>| {
            let wall = &scene.shapes[members[0]];
            let pivot = wall.motion.as_ref().and_then(Motion::pivot).unwrap_or_default();
            let farthest = |k: &usize| {
                let Block { min, max } = bounding_box(&scene.shapes[*k], scene);
                let [x, y] = [0, 1].map(|a| (pivot[a] - min[a]).abs().max((pivot[a] - max[a]).abs()));
                libm::hypot(x, y)
            };
            let shortest = SHORTEST * scene.resolution;
            let parts = match scene.dimension {
                2 => {
                    let regions = Places::union(scene, &members).without_solids().regions();
                    sides_of(&regions, shortest).into_iter().map(Part::Side).collect()
                }
                _ => members
                    .iter()
                    .map(|&k| Part::Shape(Surface::new(&scene.shapes[k].geometry, None)))
                    .collect(),
            };
            Self {
                motion: wall.motion.clone(),
                belt: wall.velocity,
                radius: members.iter().map(farthest).fold(0.0, f64::max),
                parts,
            }
        };
        that_move_alike(scene).into_iter().map(build).collect()
    }

    /// Number of parts that are touched each by itself.
    pub fn parts(&self) -> usize {
        self.parts.len()
    }

    /// Adds the edges of a part that a point which goes no farther than `way`, m, may be nearest to, where that is
    /// within `reach`, m, of the part; whether it is. A part that is no side has no edges.
    pub fn near<const D: usize>(
        &self,
        part: usize,
        at: [f64; D],
        [reach, way]: [f64; 2],
        edges: &mut Vec<u32>,
    ) -> bool {
        match &self.parts[part] {
            Part::Side(side) => side.near([at[0], at[1]], [reach, way], edges),
            Part::Shape(surface) => {
                let mut near = false;
                surface.nearest(at, &mut |distance, _| near |= distance.abs() < reach);
                near
            }
        }
    }

    /// Calls `visit` with the number of a face, the distance of a point from it, m, negative inside of the wall, and
    /// the unit normal out of the wall: for the point's nearest one of `edges`, or for each face of a shape.
    pub fn nearest<const D: usize>(
        &self,
        part: usize,
        edges: &[u32],
        at: [f64; D],
        visit: &mut impl FnMut(u32, f64, [f64; D]),
    ) {
        match &self.parts[part] {
            Part::Side(side) => {
                if let Some((distance, normal)) = side.nearest([at[0], at[1]], edges) {
                    visit(0, distance, std::array::from_fn(|d| if d < 2 { normal[d] } else { 0.0 }));
                }
            }
            Part::Shape(surface) => {
                let mut face = 0;
                surface.nearest(at, &mut |distance, normal| {
                    visit(face, distance, normal);
                    face += 1;
                });
            }
        }
    }
}

impl Side {
    fn new(corners: Vec<[f64; 2]>, end: End) -> Self {
        let bound = |first: f64, of: fn(f64, f64) -> f64| {
            [0, 1].map(|a| corners.iter().map(|corner| corner[a]).fold(first, of))
        };
        let (low, high) = (bound(f64::INFINITY, f64::min), bound(f64::NEG_INFINITY, f64::max));
        Self { corners, end, low, high }
    }

    fn edges(&self) -> usize {
        self.corners.len() - 1
    }

    fn edge(&self, k: usize) -> [[f64; 2]; 2] {
        [self.corners[k], self.corners[k + 1]]
    }

    /// The edge before or after one where they meet in a corner.
    fn beside(&self, k: usize, after: bool) -> Option<usize> {
        let closed = self.end == End::Closed;
        match after {
            false if k > 0 => Some(k - 1),
            true if k + 1 < self.edges() => Some(k + 1),
            false => closed.then(|| self.edges() - 1),
            true => closed.then_some(0),
        }
    }

    fn near(&self, at: [f64; 2], [reach, way]: [f64; 2], edges: &mut Vec<u32>) -> bool {
        if (0..2).any(|a| at[a] < self.low[a] - reach || at[a] > self.high[a] + reach) {
            return false;
        }
        let distances = || (0..self.edges()).map(|k| distance_to(self.edge(k), at).0);
        let least = distances().fold(f64::INFINITY, f64::min);
        if least < reach {
            edges.extend(distances().zip(0..).filter(|&(d, _)| d <= least + 2.0 * way).map(|(_, k)| k));
        }
        least < reach
    }

    /// Distance, m, negative inside of the wall, and the normal there.
    fn nearest(&self, at: [f64; 2], edges: &[u32]) -> Option<(f64, [f64; 2])> {
        let of = |&k: &u32| (k as usize, distance_to(self.edge(k as usize), at));
        let (k, (distance, share)) = edges.iter().map(of).min_by(|(_, a), (_, b)| a.0.total_cmp(&b.0))?;
        // Straight on there is the other one, which is nearer.
        match self.end {
            End::GoesOn(line) if k + 1 == self.edges() && ahead(line, at) => return None,
            End::ComesOn(line) if k == 0 && !ahead(line, at) => return None,
            _ => {}
        }
        let other = match share {
            0.0 => self.beside(k, false),
            1.0 => self.beside(k, true),
            _ => None,
        };
        let own = normal(self.edge(k));
        let out = other.map_or(own, |other| {
            let beside = normal(self.edge(other));
            let sum = [own[0] + beside[0], own[1] + beside[1]];
            let length = libm::hypot(sum[0], sum[1]);
            if length > 0.0 { sum.map(|x| x / length) } else { own }
        });
        let [from, to] = self.edge(k);
        let away = [0, 1].map(|a| at[a] - (from[a] + share * (to[a] - from[a])));
        let way = if away[0] * out[0] + away[1] * out[1] < 0.0 { -1.0 } else { 1.0 };
        // On the surface, and along an edge, the normal is the edge's.
        let out = if distance == 0.0 {
            out
        } else if other.is_none() && share > 0.0 && share < 1.0 {
            own
        } else {
            away.map(|a| way * a / distance)
        };
        Some((way * distance, out))
    }
}

/// Unit vector along a straight line, and its length, m.
fn direction([from, to]: [[f64; 2]; 2]) -> ([f64; 2], f64) {
    let way = [to[0] - from[0], to[1] - from[1]];
    let length = libm::hypot(way[0], way[1]);
    (way.map(|x| x / length), length)
}

/// Unit normal out of the wall on a line's left.
fn normal(ends: [[f64; 2]; 2]) -> [f64; 2] {
    let ([x, y], _) = direction(ends);
    [y, -x]
}

/// Distance of a point from a straight line, m, and where its foot is along the line, 0 to 1.
fn distance_to([from, to]: [[f64; 2]; 2], at: [f64; 2]) -> (f64, f64) {
    let (way, off) = ([to[0] - from[0], to[1] - from[1]], [at[0] - from[0], at[1] - from[1]]);
    let share = ((off[0] * way[0] + off[1] * way[1]) / (way[0] * way[0] + way[1] * way[1])).clamp(0.0, 1.0);
    if share > 0.0 && share < 1.0 {
        // The difference to the foot would lose digits along the line.
        return (across([from, to], at).abs(), share);
    }
    let end = if share == 0.0 { from } else { to };
    (libm::hypot(at[0] - end[0], at[1] - end[1]), share)
}

/// Whether a point is beyond where a line begins.
fn ahead([from, to]: [[f64; 2]; 2], at: [f64; 2]) -> bool {
    (at[0] - from[0]) * (to[0] - from[0]) + (at[1] - from[1]) * (to[1] - from[1]) >= 0.0
}

/// How far a point is on the left of a line, m.
fn across([from, to]: [[f64; 2]; 2], at: [f64; 2]) -> f64 {
    let (way, off) = ([to[0] - from[0], to[1] - from[1]], [at[0] - from[0], at[1] - from[1]]);
    (way[0] * off[1] - way[1] * off[0]) / libm::hypot(way[0], way[1])
}

/// A contour without edges that are shorter, m.
fn distinct(contour: &[[f64; 2]], shortest: f64) -> Vec<[f64; 2]> {
    let mut corners: Vec<[f64; 2]> = Vec::new();
    let apart = |a: &[f64; 2], b: &[f64; 2]| libm::hypot(a[0] - b[0], a[1] - b[1]) > shortest;
    for corner in contour {
        if corners.last().is_none_or(|last| apart(last, corner)) {
            corners.push(*corner);
        }
    }
    while corners.len() > 1 && !apart(&corners[0], &corners[corners.len() - 1]) {
        corners.pop();
    }
    corners
}

/// Sine and cosine of the angle by which a contour turns to its left in a corner.
fn turn_at(corners: &[[f64; 2]], k: usize) -> (f64, f64) {
    let n = corners.len();
    let [before, here, after] = [k + n - 1, k, k + 1].map(|k| corners[k % n]);
    let [(before, _), (after, _)] = [[before, here], [here, after]].map(direction);
    (before[0] * after[1] - before[1] * after[0], before[0] * after[0] + before[1] * after[1])
}

/// The outlines of regions, cut at their concave corners.
fn sides_of(regions: &Regions, shortest: f64) -> Vec<Side> {
    let mut all = Vec::new();
    for contour in regions.iter().flatten() {
        let corners = distinct(contour, shortest);
        let n = corners.len();
        if n < 3 {
            continue;
        }
        let parts = |k: usize| {
            let (cross, dot) = turn_at(&corners, k);
            -cross > CORNER || (cross < 0.0 && dot < 0.0)
        };
        let cuts: Vec<usize> = (0..n).filter(|&k| parts(k)).collect();
        let line = |from: usize, to: usize| (from..=to).map(|k| corners[k % n]).collect::<Vec<_>>();
        match cuts[..] {
            [] => all.push(Side::new(line(0, n), End::Closed)),
            // Both its ends meet in the corner, which has two sides.
            [corner] => {
                let length = |k: usize| direction([corners[k % n], corners[(k + 1) % n]]).1;
                let longest = (corner..corner + n).max_by(|a, b| length(*a).total_cmp(&length(*b)));
                let longest = longest.unwrap_or(corner);
                let middle = [0, 1].map(|a| 0.5 * (corners[longest % n][a] + corners[(longest + 1) % n][a]));
                let (mut first, mut rest) = (line(corner, longest), vec![middle]);
                first.push(middle);
                rest.extend(line(longest + 1, corner + n));
                let line = [middle, corners[(longest + 1) % n]];
                all.push(Side::new(first, End::GoesOn(line)));
                all.push(Side::new(rest, End::ComesOn(line)));
            }
            _ => {
                for (i, &from) in cuts.iter().enumerate() {
                    let next = cuts[(i + 1) % cuts.len()];
                    let to = if next > from { next } else { next + n };
                    all.push(Side::new(line(from, to), End::Corners));
                }
            }
        }
    }
    all
}

#[cfg(test)]
#[path = "wall_surface_tests.rs"]
mod tests;
