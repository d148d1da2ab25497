//! A shape as if there were nothing but it.

use super::points::{self, Spacing};
use super::polygon::Edges;
use super::region::{Region, voids_before};
use super::{Geometry, Polygon, TOLERANCE};
use crate::{Phase, Scene};

/// Places of the particles that the shape of an index would have with nothing but the voids before it.
pub fn places_alone<const D: usize>(scene: &Scene, index: usize) -> Vec<[f64; D]> {
    let shape = &scene.shapes[index];
    let spacing = Spacing::of(scene, shape);
    let region = Region::new(&shape.geometry, spacing, &voids_before(scene, index));
    let points = points::of_shape::<D>(&shape.geometry, spacing).into_iter().map(|p| p.position);
    points.filter(|p| !region.is_void(p)).collect()
}

/// Area (volume) of the cells that the shape of that index would have if there were nothing but it, no void either, m²
/// (m³): of a wall's polygon with what lies deeper than its rows.
pub fn measure_alone<const D: usize>(scene: &Scene, index: usize) -> f64 {
    let shape = &scene.shapes[index];
    let spacing = Spacing::of(scene, shape);
    let cells = points::of_shape::<D>(&shape.geometry, spacing).len() as f64 * spacing.dx.powi(D as i32);
    let copies = f64::from(shape.geometry.copies());
    match shape.geometry.unmoved() {
        // Its outermost row lies on the surface: half of each of its cells is outside.
        Geometry::Polygon(polygon) if shape.phase == Phase::Wall && spacing.nodal => copies * polygon.area(),
        Geometry::Polygon(polygon) if shape.phase == Phase::Wall => cells + copies * core(polygon, spacing),
        _ => cells,
    }
}

/// Area of a polygon that lies deeper than the rows of a wall, m²: that of the cells of a lattice.
fn core(polygon: &Polygon, spacing: Spacing) -> f64 {
    let (edges, dx) = (Edges::new(polygon), spacing.dx);
    let depth = spacing.thickness() - TOLERANCE * dx;
    let count = |a: usize| ((edges.high[a] - edges.low[a]) / dx).ceil() as usize;
    let place = |k: [usize; 2]| [0, 1].map(|a| edges.low[a] + (k[a] as f64 + 0.5) * dx);
    let row = |j: usize| (0..count(0)).filter(|&i| edges.contains(&place([i, j]), -depth)).count();
    (0..count(1)).map(row).sum::<usize>() as f64 * dx * dx
}
