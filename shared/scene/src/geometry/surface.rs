//! Surfaces of geometries: how far a point is from one, and points that lie on one.

use super::points::sides;
use super::polygon::Edges;
use crate::{Block, Geometry, TankSide};
use std::f64::consts::TAU;

/// The surface of a geometry.
#[derive(Clone, Debug)]
pub struct Surface {
    part: Part,
    /// Where copies of it are.
    moved: Option<super::Moved>,
    copies: std::ops::Range<u32>,
}

#[derive(Clone, Debug)]
enum Part {
    Block(Block),
    /// Between two radii; of a disc the inner one is negative.
    Ring {
        center: [f64; 3],
        inner: f64,
        outer: f64,
    },
    Tank {
        cavity: Block,
        open: Vec<TankSide>,
    },
    Polygon(Box<Edges>),
}

impl Surface {
    /// Of a geometry; where that is repeated, of that copy or of all.
    pub fn new(geometry: &Geometry, copy: Option<u32>) -> Self {
        let (unmoved, moved) = match geometry {
            Geometry::Moved(moved) => (&*moved.geometry, Some(moved.clone())),
            other => (other, None),
        };
        let part = match unmoved {
            Geometry::Box(block) => Part::Block(*block),
            Geometry::Disc { center, radius } => Part::Ring { center: *center, inner: -1.0, outer: *radius },
            Geometry::Ring { center, inner, outer } => {
                Part::Ring { center: *center, inner: *inner, outer: *outer }
            }
            Geometry::Tank { cavity, open } => Part::Tank { cavity: *cavity, open: open.clone() },
            Geometry::Polygon(polygon) => Part::Polygon(Box::new(Edges::new(polygon))),
            // A geometry is moved once.
            Geometry::Moved(inner) => return Self::new(&inner.geometry, copy),
        };
        let all = moved.as_ref().map_or(0..1, super::Moved::copies);
        let copies = match copy {
            Some(copy) if moved.is_some() => copy..copy + 1,
            _ => all,
        };
        Self { part, moved, copies }
    }

    /// Calls `visit` with the distance of a point from the surface, m, negative inside, and the unit normal out of the
    /// geometry there; once for each copy, and for each closed side of a tank.
    pub fn nearest<const D: usize>(&self, at: [f64; D], visit: &mut impl FnMut(f64, [f64; D])) {
        let Some(moved) = &self.moved else { return self.part.nearest(at, visit) };
        for copy in self.copies.clone() {
            self.part.nearest(moved.back(copy, at), &mut |distance, normal| {
                visit(distance, moved.turned(normal));
            });
        }
    }

    /// How far a ball of [`Self::balls`] is of the shape below its surface, m: a ring is hollow.
    pub fn depth(&self) -> f64 {
        match self.part {
            Part::Ring { inner, outer, .. } if inner > 0.0 => outer - inner,
            _ => f64::INFINITY,
        }
    }

    /// Calls `visit` with balls (centre, radius, m) that touch the surface from within, at most `spacing` (m) apart: of
    /// discs and rings the whole disc, of others points on the surface.
    pub fn balls<const D: usize>(
        &self,
        spacing: f64,
        visit: &mut impl FnMut([f64; D], f64, Option<[[f64; D]; 2]>),
    ) {
        for copy in self.copies.clone() {
            self.part.balls(spacing, &mut |center, radius, normals| match &self.moved {
                None => visit(center, radius, normals),
                Some(moved) => visit(
                    moved.place(copy, center),
                    radius,
                    normals.map(|both| both.map(|n| moved.turned(n))),
                ),
            });
        }
    }

    /// Calls `visit` with the number of a copy and the ends of a part of its outline in the plane, at most `spacing`
    /// (m) long: the geometry lies on its left. The ends of parts that meet agree bit by bit. A tank has none.
    pub fn outline(&self, spacing: f64, visit: &mut impl FnMut(u32, [[f64; 2]; 2])) {
        for copy in self.copies.clone() {
            self.part.outline(spacing, &mut |ends| match &self.moved {
                None => visit(copy, ends),
                Some(moved) => visit(copy, ends.map(|end| moved.place(copy, end))),
            });
        }
    }
}

/// A unit vector along an axis, one way or the other.
fn along<const D: usize>(axis: usize, way: f64) -> [f64; D] {
    std::array::from_fn(|a| if a == axis { way } else { 0.0 })
}

fn length<const D: usize>(v: &[f64; D]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

impl Part {
    fn nearest<const D: usize>(&self, at: [f64; D], visit: &mut impl FnMut(f64, [f64; D])) {
        match self {
            Self::Block(block) => {
                let (distance, normal) = from_block(block, &at);
                visit(distance, normal);
            }
            Self::Ring { center, inner, outer } => {
                let from: [f64; D] = std::array::from_fn(|a| at[a] - center[a]);
                let radius = length(&from);
                let outward = if radius > 0.0 { from.map(|x| x / radius) } else { along(0, 1.0) };
                if *inner > 0.0 && radius - inner < outer - radius {
                    visit(inner - radius, outward.map(|x| -x));
                } else {
                    visit(radius - outer, outward);
                }
            }
            Self::Tank { cavity, open } => {
                let beyond = |a: usize| {
                    let [low, high] = sides(a);
                    (open.contains(&low) && at[a] < cavity.min[a])
                        || (open.contains(&high) && at[a] > cavity.max[a])
                };
                for axis in (0..D).filter(|axis| !(0..D).any(|a| a != *axis && beyond(a))) {
                    let [low, high] = sides(axis);
                    if !open.contains(&low) {
                        visit(at[axis] - cavity.min[axis], along(axis, 1.0));
                    }
                    if !open.contains(&high) {
                        visit(cavity.max[axis] - at[axis], along(axis, -1.0));
                    }
                }
            }
            Self::Polygon(edges) => {
                let p = [at[0], at[1]];
                let Some((edge, distance)) = edges.nearest(&p, f64::INFINITY) else { return };
                let (edge, inside) = (&edges.all[edge], edges.contains(&p, 0.0));
                let way = if inside { -1.0 } else { 1.0 };
                let foot = edge.foot(&p);
                let at_end = foot == edge.from || foot == edge.to;
                // Of what lies on an edge the direction to the foot is rounding.
                let normal = if distance > 0.0 && at_end {
                    [0, 1].map(|a| way * (p[a] - foot[a]) / distance)
                } else {
                    edge.normal()
                };
                visit(way * distance, std::array::from_fn(|a| if a < 2 { normal[a] } else { 0.0 }));
            }
        }
    }

    fn outline(&self, spacing: f64, visit: &mut impl FnMut([[f64; 2]; 2])) {
        match self {
            Self::Block(Block { min, max }) => {
                let corners = [[min[0], min[1]], [max[0], min[1]], [max[0], max[1]], [min[0], max[1]]];
                (0..4).for_each(|k| parts(corners[k], corners[(k + 1) % 4], spacing, visit));
            }
            Self::Ring { center, inner, outer } => {
                around(center, *outer, 1.0, spacing, visit);
                if *inner > 0.0 {
                    around(center, *inner, -1.0, spacing, visit);
                }
            }
            Self::Tank { .. } => {}
            Self::Polygon(edges) => {
                edges.all.iter().for_each(|edge| parts(edge.from, edge.to, spacing, visit))
            }
        }
    }

    fn balls<const D: usize>(
        &self,
        spacing: f64,
        visit: &mut impl FnMut([f64; D], f64, Option<[[f64; D]; 2]>),
    ) {
        match self {
            Self::Block(block) => {
                let extent: [f64; D] = std::array::from_fn(|a| block.max[a] - block.min[a]);
                let cells = extent.map(|x| (x / spacing).ceil().max(1.0) as usize);
                let count: usize = cells.iter().map(|n| n + 1).product();
                for code in 0..count {
                    let mut rest = code;
                    let index: [usize; D] = std::array::from_fn(|a| {
                        let k = rest % (cells[a] + 1);
                        rest /= cells[a] + 1;
                        k
                    });
                    if (0..D).any(|a| index[a] == 0 || index[a] == cells[a]) {
                        let place = |a: usize| block.min[a] + extent[a] * index[a] as f64 / cells[a] as f64;
                        let side = |a: usize| match index[a] {
                            0 => -1.0,
                            k if k == cells[a] => 1.0,
                            _ => 0.0,
                        };
                        visit(std::array::from_fn(place), 0.0, (D == 2).then(|| beside([0, 1].map(side))));
                    }
                }
            }
            Self::Ring { center, outer, .. } => visit(std::array::from_fn(|a| center[a]), *outer, None),
            Self::Tank { .. } => {}
            Self::Polygon(edges) => {
                for edge in &edges.all {
                    let parts = (edge.length() / spacing).ceil().max(1.0) as usize;
                    for k in 0..parts {
                        let share = k as f64 / parts as f64;
                        let place = |a: usize| edge.from[a] + share * (edge.to[a] - edge.from[a]);
                        let before = if k == 0 { &edges.all[edge.before] } else { edge };
                        let normals = [before, edge].map(|side| in_plane(side.normal()));
                        visit(in_plane([0, 1].map(place)), 0.0, (D == 2).then_some(normals));
                    }
                }
            }
        }
    }
}

/// A vector of the plane.
fn in_plane<const D: usize>(v: [f64; 2]) -> [f64; D] {
    std::array::from_fn(|a| if a < 2 { v[a] } else { 0.0 })
}

/// Normals of the sides of a box in the plane before and after a point of its outline, counter-clockwise. `side`: by
/// axis, -1 on the lower side, 1 on the upper one, 0 between them.
fn beside<const D: usize>([x, y]: [f64; 2]) -> [[f64; D]; 2] {
    let (of_x, of_y) = (in_plane([x, 0.0]), in_plane([0.0, y]));
    if x == 0.0 {
        [of_y; 2]
    } else if y == 0.0 {
        [of_x; 2]
    } else if x * y > 0.0 {
        [of_x, of_y]
    } else {
        [of_y, of_x]
    }
}

/// Calls `visit` with the parts of a straight line, at most `spacing` (m) long.
fn parts(from: [f64; 2], to: [f64; 2], spacing: f64, visit: &mut impl FnMut([[f64; 2]; 2])) {
    let length = libm::hypot(to[0] - from[0], to[1] - from[1]);
    let count = (length / spacing).ceil().max(1.0) as usize;
    let place = |k: usize| {
        let share = k as f64 / count as f64;
        if k == count { to } else { [0, 1].map(|a| from[a] + share * (to[a] - from[a])) }
    };
    (0..count).for_each(|k| visit([place(k), place(k + 1)]));
}

/// Calls `visit` with the parts of a circle, counter-clockwise or clockwise.
fn around(center: &[f64; 3], radius: f64, way: f64, spacing: f64, visit: &mut impl FnMut([[f64; 2]; 2])) {
    let count = (TAU * radius / spacing).ceil().max(8.0) as usize;
    let place = |k: usize| {
        let angle = way * TAU * (k % count) as f64 / count as f64;
        [center[0] + radius * libm::cos(angle), center[1] + radius * libm::sin(angle)]
    };
    (0..count).for_each(|k| visit([place(k), place(k + 1)]));
}

/// Distance of a point from a block, m, negative inside, and the normal of the surface there.
fn from_block<const D: usize>(block: &Block, at: &[f64; D]) -> (f64, [f64; D]) {
    let from: [f64; D] = std::array::from_fn(|a| at[a] - 0.5 * (block.min[a] + block.max[a]));
    let beyond: [f64; D] = std::array::from_fn(|a| from[a].abs() - 0.5 * (block.max[a] - block.min[a]));
    let way = |a: usize| if from[a] < 0.0 { -1.0 } else { 1.0 };
    let outside: [f64; D] = std::array::from_fn(|a| way(a) * beyond[a].max(0.0));
    let distance = length(&outside);
    if distance > 0.0 {
        return (distance, outside.map(|x| x / distance));
    }
    let axis = (1..D).fold(0, |best, a| if beyond[a] > beyond[best] { a } else { best });
    (beyond[axis], along(axis, way(axis)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Moved, Polygon};

    fn nearest(geometry: &Geometry, at: [f64; 2]) -> Vec<(f64, [f64; 2])> {
        let mut all = Vec::new();
        Surface::new(geometry, None).nearest(at, &mut |distance, normal| all.push((distance, normal)));
        all
    }

    fn close(found: (f64, [f64; 2]), right: (f64, [f64; 2])) {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        let same = near(found.0, right.0) && near(found.1[0], right.1[0]) && near(found.1[1], right.1[1]);
        assert!(same, "{found:?} {right:?}");
    }

    #[test]
    fn distances_by_hand() {
        let block = Geometry::Box(Block { min: [0.0; 3], max: [4.0, 2.0, 0.0] });
        close(nearest(&block, [1.0, 2.5])[0], (0.5, [0.0, 1.0]));
        close(nearest(&block, [7.0, 6.0])[0], (5.0, [0.6, 0.8]));
        close(nearest(&block, [0.25, 1.0])[0], (-0.25, [-1.0, 0.0]));
        let ring = Geometry::Ring { center: [0.0; 3], inner: 1.0, outer: 2.0 };
        close(nearest(&ring, [0.5, 0.0])[0], (0.5, [-1.0, 0.0]));
        close(nearest(&ring, [0.0, 3.0])[0], (1.0, [0.0, 1.0]));
        let cavity = Block { min: [0.0; 3], max: [4.0, 2.0, 0.0] };
        let tank = Geometry::Tank { cavity, open: vec![TankSide::Top] };
        let sides = nearest(&tank, [1.0, 0.5]);
        assert_eq!(sides.len(), 3);
        close(sides[0], (1.0, [1.0, 0.0]));
        close(sides[1], (3.0, [-1.0, 0.0]));
        close(sides[2], (0.5, [0.0, 1.0]));
        // Above the open top no side is beside it.
        assert_eq!(nearest(&tank, [-1.0, 3.0]).len(), 1);
        let corners = vec![[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]];
        let triangle = Geometry::Polygon(Polygon::new(corners, Vec::new()).expect("a triangle"));
        close(nearest(&triangle, [2.0 + 0.6, 1.5 + 0.8])[0], (1.0, [0.6, 0.8]));
        close(nearest(&triangle, [1.0, 0.1])[0], (-0.1, [0.0, -1.0]));
        let step = [10.0, 0.0, 0.0];
        let moved = Moved {
            geometry: Box::new(block),
            angle: 90.0,
            about: [0.0; 3],
            translate: [0.0; 3],
            count: 2,
            step,
        };
        // Turned, it lies in -2 < x < 0, 0 < y < 4; the copy ten further.
        let both = nearest(&Geometry::Moved(moved), [1.0, 1.0]);
        close(both[0], (1.0, [1.0, 0.0]));
        close(both[1], (7.0, [-1.0, 0.0]));
    }

    /// Twice the area on the left of an outline's parts, and their length.
    fn measured(geometry: &Geometry) -> [f64; 2] {
        let mut sums = [0.0; 2];
        Surface::new(geometry, None).outline(0.01, &mut |_, [from, to]| {
            sums[0] += from[0] * to[1] - from[1] * to[0];
            let length = libm::hypot(to[0] - from[0], to[1] - from[1]);
            assert!(length < 0.01 + 1e-12);
            sums[1] += length;
        });
        sums
    }

    #[test]
    fn outlines_have_their_geometry_on_the_left() {
        let block = Geometry::Box(Block { min: [0.1, 0.2, 0.0], max: [0.3, 0.3, 0.0] });
        let near = |found: [f64; 2], right: [f64; 2], by: f64| {
            assert!((0..2).all(|k| (found[k] / right[k] - 1.0).abs() < by), "{found:?} {right:?}");
        };
        near(measured(&block), [2.0 * 0.02, 0.6], 1e-12);
        let ring = Geometry::Ring { center: [1.0, 1.0, 0.0], inner: 0.1, outer: 0.2 };
        near(measured(&ring), [TAU * 0.03, TAU * 0.3], 1e-3);
        let corners = vec![[0.0, 0.0], [0.0, 0.3], [0.4, 0.0]];
        let triangle = Geometry::Polygon(Polygon::new(corners, Vec::new()).expect("a triangle"));
        near(measured(&triangle), [0.12, 1.2], 1e-12);
        let turned = Moved {
            geometry: Box::new(block),
            angle: 30.0,
            about: [0.0; 3],
            translate: [1.0, 0.0, 0.0],
            count: 2,
            step: [0.0, 1.0, 0.0],
        };
        near(measured(&Geometry::Moved(turned)), [2.0 * 2.0 * 0.02, 2.0 * 0.6], 1e-12);
    }

    #[test]
    fn balls_touch_from_within() {
        let block = Geometry::Box(Block { min: [0.0; 3], max: [0.2, 0.1, 0.0] });
        let mut count = 0;
        Surface::new(&block, None).balls(0.05, &mut |center: [f64; 2], radius, normals| {
            count += 1;
            // Lower corners: of the left side and the floor, of the floor and the right side.
            let right = match center {
                [0.0, 0.0] => [[-1.0, 0.0], [0.0, -1.0]],
                [x, 0.0] if x > 0.19 => [[0.0, -1.0], [1.0, 0.0]],
                [_, 0.0] => [[0.0, -1.0]; 2],
                [0.0, y] if y < 0.09 => [[-1.0, 0.0]; 2],
                _ => normals.unwrap(),
            };
            assert_eq!(normals, Some(right), "{center:?}");
            let (distance, _) = nearest(&block, center)[0];
            assert!((distance + radius).abs() < 1e-15);
        });
        assert_eq!(count, 2 * (4 + 2));
    }
}
