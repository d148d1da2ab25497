//! The lattice of one shape, and the normals of walls.

use super::{Cells, Moved, TOLERANCE, moved, polygon, region};
use crate::{Block, Geometry, TankSide};

/// How a shape is filled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spacing {
    /// Particle spacing, m.
    pub(super) dx: f64,
    /// Particles at the cells' corners instead of their centres.
    pub(super) nodal: bool,
    /// A wall includes the nodes on its surface.
    pub(super) wall: bool,
    /// A polygon's lattice lies along its longest side, not along the axes.
    pub(super) aligned: bool,
    /// Kernel support over dx.
    pub(super) support: f64,
    /// Angle of the lattice against the one that the shape would have, degrees.
    pub(super) turn: f64,
}

impl Spacing {
    /// Layers of a tank's wall, the surface's own (nodal) not counted.
    pub(super) fn layers(&self) -> i64 {
        (self.support - TOLERANCE).ceil() as i64
    }

    /// Thickness of a tank's wall, m.
    pub(super) fn thickness(&self) -> f64 {
        self.layers() as f64 * self.dx
    }

    /// Cells along an extent.
    pub(super) fn cells(&self, extent: f64) -> i64 {
        (extent / self.dx).round() as i64
    }

    /// Place of lattice point k, in spacings.
    pub(super) fn place(&self, k: i64) -> f64 {
        if self.nodal { k as f64 } else { k as f64 + 0.5 }
    }

    /// First and last lattice index of `cells` cells.
    fn range(&self, cells: i64) -> [i64; 2] {
        match (self.nodal, self.wall) {
            (false, _) => [0, cells - 1],
            (true, false) => [1, cells - 1],
            (true, true) => [0, cells],
        }
    }

    /// Number of lattice points along an extent, without overflow.
    pub(super) fn expected(&self, extent: f64, cells_more: f64) -> f64 {
        let cells = (extent / self.dx).round() + cells_more;
        match (self.nodal, self.wall) {
            (false, _) => cells,
            (true, false) => cells - 1.0,
            (true, true) => cells + 1.0,
        }
        .max(0.0)
    }
}

/// A particle of a shape; the normal means something in a wall only.
pub(super) struct Point<const D: usize> {
    pub(super) position: [f64; D],
    pub(super) normal: [f64; D],
    /// Below the surface that it stands for, m; infinite behind an edge.
    pub(super) depth: f64,
    pub(super) corner: bool,
}

/// The sides at the low and high end of an axis.
pub fn sides(axis: usize) -> [TankSide; 2] {
    [[TankSide::Left, TankSide::Right], [TankSide::Bottom, TankSide::Top], [TankSide::Back, TankSide::Front]]
        [axis]
}

/// All points of a shape, x innermost.
pub(super) fn of_shape<const D: usize>(geometry: &Geometry, spacing: Spacing) -> Vec<Point<D>> {
    match geometry {
        Geometry::Box(block) if spacing.turn != 0.0 => turned(geometry, block, spacing),
        Geometry::Disc { center, radius: reach } | Geometry::Ring { center, outer: reach, .. }
            if spacing.turn != 0.0 =>
        {
            let [min, max] = [-reach, *reach].map(|way| center.map(|x| x + way));
            turned(geometry, &Block { min, max }, spacing)
        }
        Geometry::Box(block) => in_box(block, spacing),
        Geometry::Disc { center, radius } => in_ring(center, -1.0, *radius, spacing),
        Geometry::Ring { center, inner, outer } => in_ring(center, *inner, *outer, spacing),
        Geometry::Tank { cavity, open } => around(cavity, open, spacing),
        Geometry::Polygon(polygon) if spacing.wall => polygon::rows(polygon, spacing),
        Geometry::Polygon(polygon) => polygon.fill(spacing, spacing.aligned),
        Geometry::Moved(moved) => copies(moved, spacing).into_iter().map(|(point, _)| point).collect(),
    }
}

/// All points of a shape, each with the number of its copy.
pub(super) fn with_copies<const D: usize>(geometry: &Geometry, spacing: Spacing) -> Vec<(Point<D>, u32)> {
    match geometry {
        Geometry::Moved(moved) => copies(moved, spacing),
        _ => of_shape(geometry, spacing).into_iter().map(|point| (point, 0)).collect(),
    }
}

/// The points of all copies; of those closer than dx / 2 to one of an earlier copy, none.
fn copies<const D: usize>(moved: &Moved, spacing: Spacing) -> Vec<(Point<D>, u32)> {
    let first = of_shape::<D>(&moved.geometry, spacing);
    let mut points = Vec::with_capacity(first.len().saturating_mul(moved.count as usize));
    let mut cells = Cells::new(spacing.dx);
    for copy in moved.copies() {
        let placed = first.iter().map(|point| Point {
            position: moved.place(copy, point.position),
            normal: moved.turned(point.normal),
            depth: point.depth,
            corner: point.corner,
        });
        let limit = (0.5 - TOLERANCE) * spacing.dx;
        let free = |point: &Point<D>| {
            let r2 = |q: &[f64; D]| (0..D).map(|a| (q[a] - point.position[a]).powi(2)).sum::<f64>();
            !cells.around(&point.position).any(|q| r2(q) < limit * limit)
        };
        let kept: Vec<Point<D>> = placed.filter(free).collect();
        for point in &kept {
            cells.add(&point.position, point.position);
        }
        points.extend(kept.into_iter().map(|point| (point, copy)));
    }
    points
}

/// Expected number of points of a shape.
pub(super) fn expected(geometry: &Geometry, spacing: Spacing, dimension: usize) -> f64 {
    let measure = |radius: f64| {
        let r = radius / spacing.dx;
        std::f64::consts::PI * if dimension == 2 { r * r } else { 4.0 / 3.0 * r * r * r }
    };
    match geometry {
        Geometry::Box(block) => {
            (0..dimension).map(|a| spacing.expected(block.max[a] - block.min[a], 0.0)).product()
        }
        Geometry::Disc { radius, .. } => measure(*radius).round(),
        Geometry::Ring { inner, outer, .. } => (measure(*outer) - measure(*inner)).round(),
        // Of a wall's inside only the rows that the kernel reaches: an upper bound.
        Geometry::Polygon(polygon) => (polygon.area() / spacing.dx.powi(2)).round(),
        Geometry::Moved(moved) => f64::from(moved.count) * expected(&moved.geometry, spacing, dimension),
        Geometry::Tank { cavity, open } => {
            // The walls are what a box around them has more than the cavity.
            let hollow = Spacing { wall: false, ..spacing };
            let (mut all, mut inside) = (1.0, 1.0);
            for axis in 0..dimension {
                let extent = cavity.max[axis] - cavity.min[axis];
                let opened = sides(axis).iter().filter(|side| open.contains(side)).count() as f64;
                all *= spacing.expected(extent, (2.0 - opened) * spacing.layers() as f64);
                inside *= hollow.expected(extent, 0.0) + if spacing.nodal { opened } else { 0.0 };
            }
            // Beyond the floats' range the difference means nothing.
            if all.is_finite() { all - inside } else { all }
        }
    }
}

fn in_box<const D: usize>(block: &Block, spacing: Spacing) -> Vec<Point<D>> {
    let cells: [i64; D] = std::array::from_fn(|a| spacing.cells(block.max[a] - block.min[a]));
    let mut points = Vec::new();
    each_index(cells.map(|n| spacing.range(n)), |k| {
        let place: [f64; D] = k.map(|k| spacing.place(k));
        let (normal, depth) = nearest_face(&place, &cells);
        let position = std::array::from_fn(|a| block.min[a] + place[a] * spacing.dx);
        points.push(Point { position, normal, depth: depth * spacing.dx, corner: false });
    });
    points
}

/// The points of a lattice in a geometry of a solid that is turned about the middle of the box around it.
fn turned<const D: usize>(geometry: &Geometry, around: &Block, spacing: Spacing) -> Vec<Point<D>> {
    let middle: [f64; D] = std::array::from_fn(|a| 0.5 * (around.min[a] + around.max[a]));
    let reach = (0..D).map(|a| (around.max[a] - around.min[a]).powi(2)).sum::<f64>().sqrt();
    let cells = (0.5 * reach / spacing.dx).ceil() as i64 + 1;
    let [cos, sin] = moved::turn(spacing.turn);
    let mut points = Vec::new();
    each_index([[-cells, cells]; D], |k| {
        let mut from: [f64; D] = k.map(|k| spacing.place(k) * spacing.dx);
        (from[0], from[1]) = (cos * from[0] - sin * from[1], sin * from[0] + cos * from[1]);
        let position = std::array::from_fn(|a| middle[a] + from[a]);
        // What lies on the surface is outside, as in a polygon.
        if region::contains(geometry, spacing, &position, -TOLERANCE * spacing.dx) {
            points.push(Point { position, normal: [0.0; D], depth: 0.0, corner: false });
        }
    });
    points
}

/// The outward normal of the face nearest to a place inside a box, with how near that is in spacings. Where faces of
/// two axes are equally near, the diagonal, infinitely deep: water flows round such an edge, which is no corner that
/// reverses all components of a velocity. Of an axis whose two faces are equally near the other one decides.
fn nearest_face<const D: usize>(place: &[f64; D], cells: &[i64; D]) -> ([f64; D], f64) {
    // Places are multiples of 1/2: distances compare exactly.
    let depth: [f64; D] = std::array::from_fn(|a| place[a].min(cells[a] as f64 - place[a]));
    let least = depth.iter().copied().fold(f64::INFINITY, f64::min);
    let nearest = |a: usize| depth[a] == least;
    let between = |a: usize| place[a] == cells[a] as f64 - place[a];
    let one_way = (0..D).any(|a| nearest(a) && !between(a));
    let direction = std::array::from_fn(|a| match nearest(a) && !(one_way && between(a)) {
        true if place[a] <= cells[a] as f64 - place[a] => -1.0,
        true => 1.0,
        false => 0.0,
    });
    let (normal, edge) = normalised(direction);
    (normal, if edge { f64::INFINITY } else { least })
}

/// A unit vector, and whether more than one component was set.
fn normalised<const D: usize>(direction: [f64; D]) -> ([f64; D], bool) {
    let set = direction.iter().filter(|c| **c != 0.0).count();
    let length = (set.max(1) as f64).sqrt();
    (direction.map(|c| c / length), set > 1)
}

fn in_ring<const D: usize>(center: &[f64; 3], inner: f64, outer: f64, spacing: Spacing) -> Vec<Point<D>> {
    let reach = spacing.cells(outer) + 1;
    let margin = TOLERANCE * if spacing.wall { spacing.dx } else { -spacing.dx };
    let mut points = Vec::new();
    each_index([[-reach, reach]; D], |k| {
        let from_center: [f64; D] = k.map(|k| spacing.place(k) * spacing.dx);
        let radius = from_center.iter().map(|c| c * c).sum::<f64>().sqrt();
        if !(inner - margin..=outer + margin).contains(&radius) {
            return;
        }
        let outward = if radius - inner < outer - radius && inner >= 0.0 { -1.0 } else { 1.0 };
        let (normal, corner) = match radius > TOLERANCE * spacing.dx {
            true => (from_center.map(|c| outward * c / radius), false),
            false => normalised([1.0; D]),
        };
        let depth = if outward < 0.0 { radius - inner } else { outer - radius };
        let position = std::array::from_fn(|a| center[a] + from_center[a]);
        points.push(Point { position, normal, depth, corner });
    });
    points
}

fn around<const D: usize>(cavity: &Block, open: &[TankSide], spacing: Spacing) -> Vec<Point<D>> {
    let cells: [i64; D] = std::array::from_fn(|a| spacing.cells(cavity.max[a] - cavity.min[a]));
    let layers = spacing.layers();
    let mut points = Vec::new();
    let closed: [[bool; 2]; D] = std::array::from_fn(|a| sides(a).map(|side| !open.contains(&side)));
    let ranges: [[i64; 2]; D] = std::array::from_fn(|a| {
        let [first, last] = spacing.range(cells[a]);
        [first - if closed[a][0] { layers } else { 0 }, last + if closed[a][1] { layers } else { 0 }]
    });
    each_index(ranges, |k| {
        // The inward normal; zero in the cavity. A closed side's surface belongs to the wall, an open one's does not.
        let direction: [f64; D] = std::array::from_fn(|a| {
            let place = spacing.place(k[a]);
            match () {
                () if closed[a][0] && place <= 0.0 => 1.0,
                () if closed[a][1] && place >= cells[a] as f64 => -1.0,
                () => 0.0,
            }
        });
        if direction == [0.0; D] {
            return;
        }
        let (normal, corner) = normalised(direction);
        let depth = (0..D).fold(0.0_f64, |depth, a| {
            let place = spacing.place(k[a]);
            depth.max(-place).max(place - cells[a] as f64)
        });
        let position = std::array::from_fn(|a| cavity.min[a] + spacing.place(k[a]) * spacing.dx);
        points.push(Point { position, normal, depth: depth * spacing.dx, corner });
    });
    points
}

/// Calls `visit` with every index in the inclusive ranges, the first axis innermost.
fn each_index<const D: usize>(ranges: [[i64; 2]; D], mut visit: impl FnMut([i64; D])) {
    if ranges.iter().any(|[first, last]| first > last) {
        return;
    }
    let mut index = ranges.map(|[first, _]| first);
    loop {
        visit(index);
        let mut axis = 0;
        while index[axis] == ranges[axis][1] {
            index[axis] = ranges[axis][0];
            axis += 1;
            if axis == D {
                return;
            }
        }
        index[axis] += 1;
    }
}
