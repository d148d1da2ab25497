//! Which surface a wall particle stands for where walls meet.
//!
//! Each wall's lattice knows its own surface alone. Of a box on a floor the lower face is none: no water comes to it,
//! and the corner of box and floor closes in, as a tank's. So near another wall that moves and slips alike a particle
//! stands for the nearest part of the surface of their union. Outer faces of a tank's closed sides are none, unless
//! another tank's cavity lies before them.

use super::regions::Places;
use super::{SHORTEST, direction, distance_to, distinct, grouped, normal, turn_at};
use crate::geometry::points::{Spacing, sides};
use crate::geometry::polygon::dot;
use crate::geometry::{Cells, Moved, TOLERANCE, WallPoint};
use crate::{Block, Geometry, Phase, Scene, Shape, TankSide};
use std::collections::BTreeSet;
use std::f64::consts::FRAC_1_SQRT_2;

/// Cosine of the turn from which on a corner that closes in reverses all components of a velocity: 45 degrees.
const SHARP: f64 = FRAC_1_SQRT_2;
/// How far before an edge's particle, along the diagonal, a wall is looked for, in spacings.
const BEFORE: f64 = 1.4;
/// How near to that place, in spacings.
const NEAR: f64 = 0.7;
/// Where along an edge is asked whether it is hidden.
const ALONG: [f64; 3] = [0.1, 0.5, 0.9];

/// Sets what the wall particles stand for that are near another wall which moves and slips alike, in the plane.
/// `shared`: places of walls that others took, with their shapes.
pub(in crate::geometry) fn where_walls_meet<const D: usize>(
    scene: &Scene,
    walls: &mut [WallPoint<D>],
    shared: &[([f64; D], u32)],
) {
    if D != 2 || walls.is_empty() {
        return;
    }
    for members in that_are_alike(scene) {
        let reach = |shape: &Shape| Spacing::of(scene, shape).thickness();
        let farthest = members.iter().map(|&k| reach(&scene.shapes[k])).fold(0.0, f64::max);
        let meeting = that_meet(&members, walls, shared, farthest);
        if meeting.is_empty() {
            continue;
        }
        let edges = Edges::new(visible(scene, &members), farthest);
        for index in meeting {
            let point = &mut walls[index];
            let at = [point.position[0], point.position[1]];
            if let Some(found) = edges.nearest(at, TOLERANCE * scene.resolution) {
                point.normal = std::array::from_fn(|d| if d < 2 { found.normal[d] } else { 0.0 });
                (point.depth, point.corner) = (found.depth, found.corner);
            }
        }
    }
}

/// Marks the wall particles within the kernel's support of an edge: of one that stands for a diagonal, and before which
/// there is no wall.
pub(in crate::geometry) fn find_edges<const D: usize>(scene: &Scene, walls: &mut [WallPoint<D>]) {
    let diagonal = |point: &&WallPoint<D>| point.depth.is_infinite() && !point.corner;
    let Some(first) = walls.iter().find(diagonal) else { return };
    let reach = Spacing::of(scene, &scene.shapes[first.shape as usize]).thickness();
    let dx = scene.resolution;
    let mut all = Cells::new(dx);
    walls.iter().for_each(|point| all.add(&point.position, point.position));
    let stands_out = |point: &&WallPoint<D>| {
        let before = std::array::from_fn(|d| point.position[d] + BEFORE * dx * point.normal[d]);
        !all.around(&before).any(|place| is_near(place, &before, NEAR * dx))
    };
    let mut edges = Cells::new(reach);
    walls
        .iter()
        .filter(diagonal)
        .filter(stands_out)
        .for_each(|point| edges.add(&point.position, point.position));
    for point in walls {
        point.at_edge = edges.around(&point.position).any(|edge| is_near(edge, &point.position, reach));
    }
}

/// Whether two places are closer than a distance, m.
fn is_near<const D: usize>(a: &[f64; D], b: &[f64; D], distance: f64) -> bool {
    (0..D).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>() < distance * distance
}

/// Indices of walls that move and slip alike, several together.
fn that_are_alike(scene: &Scene) -> Vec<Vec<usize>> {
    let walls = scene.shapes.iter().enumerate().filter(|(_, shape)| shape.phase == Phase::Wall);
    let alike = |one: &Shape, other: &Shape| one.moves_like(other) && one.free_slip == other.free_slip;
    let mut all = grouped(scene, walls, alike);
    all.retain(|members| members.len() > 1);
    all
}

/// Indices of the particles of these walls that are within `reach`, m, of a place of another of them.
fn that_meet<const D: usize>(
    members: &[usize],
    walls: &[WallPoint<D>],
    shared: &[([f64; D], u32)],
    reach: f64,
) -> Vec<usize> {
    let members: BTreeSet<u32> = members.iter().map(|&k| k as u32).collect();
    let mut cells: Cells<([f64; D], u32), D> = Cells::new(reach);
    let own = || walls.iter().enumerate().filter(|(_, point)| members.contains(&point.shape));
    let taken = shared.iter().filter(|(_, shape)| members.contains(shape)).copied();
    for (place, shape) in own().map(|(_, point)| (point.position, point.shape)).chain(taken) {
        cells.add(&place, (place, shape));
    }
    let meets = |point: &WallPoint<D>| {
        let near = |at: &[f64; D]| is_near(at, &point.position, reach);
        cells.around(&point.position).any(|(at, shape)| *shape != point.shape && near(at))
    };
    own().filter(|(_, point)| meets(point)).map(|(index, _)| index).collect()
}

/// What is nearest to a place inside.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Nearest {
    normal: [f64; 2],
    /// m; infinite behind an edge.
    depth: f64,
    corner: bool,
}

/// An edge of the union's outline, with what it and its neighbours make in their corners.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Edge {
    ends: [[f64; 2]; 2],
    /// Normal of the edge after it, where that is visible and the corner between them closes in.
    into: Option<[f64; 2]>,
    /// The same of the edge before it.
    from: Option<[f64; 2]>,
}

/// The edges of the union's outline but those of tanks' outer faces.
fn visible(scene: &Scene, members: &[usize]) -> Vec<Edge> {
    let regions = Places::union_of_many(scene, members).regions();
    let tolerance = SHORTEST * scene.resolution;
    let tanks: Vec<Tank<'_>> = members.iter().filter_map(|&k| Tank::of(scene, &scene.shapes[k])).collect();
    let before = 1e-3 * scene.resolution;
    let hidden = |ends: [[f64; 2]; 2]| {
        let [from, to] = ends;
        let out = normal(ends);
        ALONG.iter().all(|share| {
            let place = [0, 1].map(|a| from[a] + share * (to[a] - from[a]));
            let outside = [0, 1].map(|a| place[a] + before * out[a]);
            tanks.iter().any(|tank| tank.is_outer(place, tolerance))
                && !tanks.iter().any(|tank| tank.holds(outside))
        })
    };
    let mut edges = Vec::new();
    for contour in regions.iter().flatten() {
        let corners = distinct(contour, tolerance);
        let n = corners.len();
        if n < 3 {
            continue;
        }
        let ends = |k: usize| [corners[k % n], corners[(k + 1) % n]];
        let closes_in = |k: usize| turn_at(&corners, k % n).0 < 0.0;
        let seen: Vec<bool> = (0..n).map(|k| !hidden(ends(k))).collect();
        let beside = |k: usize| seen[k % n].then(|| normal(ends(k)));
        edges.extend((0..n).filter(|&k| seen[k]).map(|k| Edge {
            ends: ends(k),
            into: beside(k + 1).filter(|_| closes_in(k + 1)),
            from: beside(k + n - 1).filter(|_| closes_in(k)),
        }));
    }
    edges
}

/// A tank among the walls.
struct Tank<'s> {
    cavity: &'s Block,
    open: &'s [TankSide],
    moved: Option<&'s Moved>,
    thickness: f64,
}

impl<'s> Tank<'s> {
    fn of(scene: &Scene, shape: &'s Shape) -> Option<Self> {
        let (geometry, moved) = match &shape.geometry {
            Geometry::Moved(moved) => (&*moved.geometry, Some(moved)),
            other => (other, None),
        };
        let Geometry::Tank { cavity, open } = geometry else { return None };
        Some(Self { cavity, open, moved, thickness: Spacing::of(scene, shape).thickness() })
    }

    /// A place as each copy has it before it is moved.
    fn back(&self, place: [f64; 2]) -> Vec<[f64; 2]> {
        match self.moved {
            Some(moved) => moved.copies().map(|copy| moved.back(copy, place)).collect(),
            None => vec![place],
        }
    }

    /// Whether its cavity holds a place.
    fn holds(&self, place: [f64; 2]) -> bool {
        let Block { min, max } = self.cavity;
        self.back(place).iter().any(|p| (0..2).all(|a| p[a] > min[a] && p[a] < max[a]))
    }

    /// Whether a place lies on the outer face of a closed side.
    fn is_outer(&self, place: [f64; 2], tolerance: f64) -> bool {
        let Block { min, max } = self.cavity;
        let reach = self.thickness + tolerance;
        self.back(place).iter().any(|p| {
            let within = (0..2).all(|a| p[a] > min[a] - reach && p[a] < max[a] + reach);
            within
                && (0..2).any(|a| {
                    let [low, high] = sides(a).map(|side| !self.open.contains(&side));
                    let on = |x: f64| (p[a] - x).abs() <= tolerance;
                    (low && on(min[a] - self.thickness)) || (high && on(max[a] + self.thickness))
                })
        })
    }
}

/// Edges by the cells that they pass.
struct Edges {
    all: Vec<Edge>,
    /// Indices of edges, at places along them.
    places: Cells<u32>,
}

impl Edges {
    /// For places that are no farther than twice `size`, m, from their nearest edge.
    fn new(all: Vec<Edge>, size: f64) -> Self {
        let mut places = Cells::new(2.0 * size);
        for (index, edge) in (0..).zip(&all) {
            let [from, to] = edge.ends;
            let (_, length) = direction(edge.ends);
            let parts = (2.0 * length / size).ceil().max(1.0) as usize;
            for k in 0..=parts {
                let share = k as f64 / parts as f64;
                places.add(&[0, 1].map(|a| from[a] + share * (to[a] - from[a])), index);
            }
        }
        Self { all, places }
    }

    /// What the nearest edge makes of a place; of several that are equally near what lies between them.
    fn nearest(&self, at: [f64; 2], tolerance: f64) -> Option<Nearest> {
        let near: BTreeSet<u32> = self.places.around(&at).copied().collect();
        let near = || near.iter().map(|&k| &self.all[k as usize]);
        let least = near().map(|edge| distance_to(edge.ends, at).0).fold(f64::INFINITY, f64::min);
        let mut sum = [0.0; 2];
        let (mut first, mut alone, mut corner) = (None, true, false);
        for edge in near() {
            let (distance, share) = distance_to(edge.ends, at);
            if distance > least + tolerance {
                continue;
            }
            let own = normal(edge.ends);
            let beside = match share {
                0.0 => edge.from,
                1.0 => edge.into,
                _ => None,
            };
            corner |= beside.is_some_and(|other| dot(&own, &other) < SHARP);
            let out = beside.map_or(own, |other| unit([own[0] + other[0], own[1] + other[1]]).unwrap_or(own));
            let first = *first.get_or_insert(out);
            alone &= dot(&out, &first) > SHARP;
            (0..2).for_each(|a| sum[a] += out[a]);
        }
        let first = first?;
        let between = unit(sum).unwrap_or(first);
        Some(Nearest {
            // One edge's normal is its own to the last digit.
            normal: if alone && dot(&first, &between) > 1.0 - 1e-12 { first } else { between },
            depth: if alone { least } else { f64::INFINITY },
            corner,
        })
    }
}

/// A vector over its length; `None` where it has none.
fn unit(v: [f64; 2]) -> Option<[f64; 2]> {
    let (way, length) = direction([[0.0; 2], v]);
    (length > 1e-6).then_some(way)
}

#[cfg(test)]
#[path = "normals_tests.rs"]
mod tests;
