//! How far geometries reach.

use super::points::sides;
use crate::{Block, Geometry};

/// Points, and a radius around each of them, between which a geometry lies. A tank's walls are so thick, m.
fn hull(geometry: &Geometry, dimension: usize, thickness: f64) -> (Vec<[f64; 3]>, f64) {
    let corners = |block: &Block| {
        let corner = |code: usize| {
            std::array::from_fn(|a| match a {
                _ if a >= dimension => 0.0,
                _ if code >> a & 1 == 1 => block.max[a],
                _ => block.min[a],
            })
        };
        (0..1 << dimension).map(corner).collect()
    };
    match geometry {
        Geometry::Box(block) => (corners(block), 0.0),
        Geometry::Disc { center, radius: r } | Geometry::Ring { center, outer: r, .. } => (vec![*center], *r),
        Geometry::Tank { cavity, open } => {
            let mut block = *cavity;
            for axis in 0..dimension {
                let [low, high] = sides(axis).map(|side| if open.contains(&side) { 0.0 } else { thickness });
                block.min[axis] -= low;
                block.max[axis] += high;
            }
            (corners(&block), 0.0)
        }
        Geometry::Polygon(polygon) => (polygon.outline.iter().map(|p| [p[0], p[1], 0.0]).collect(), 0.0),
        Geometry::Moved(moved) => {
            let (points, radius) = hull(&moved.geometry, dimension, thickness);
            // All other copies lie between the first and the last one.
            let ends = [0, moved.count - 1];
            let places = ends.iter().flat_map(|&copy| points.iter().map(move |p| moved.place(copy, *p)));
            (places.collect(), radius)
        }
    }
}

/// The least and the largest scalar product of a vector and a point of a geometry.
pub(crate) fn extent(geometry: &Geometry, dimension: usize, thickness: f64, v: [f64; 3]) -> [f64; 2] {
    let (points, radius) = hull(geometry, dimension, thickness);
    let size = v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let ends = points.iter().map(|p| (0..dimension).map(|a| v[a] * p[a]).sum::<f64>());
    let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [l.min(x), h.max(x)]);
    [low - size * radius, high + size * radius]
}

/// The box around a geometry.
pub(super) fn bounding_box(geometry: &Geometry, dimension: usize, thickness: f64) -> Block {
    let mut block = Block { min: [0.0; 3], max: [0.0; 3] };
    for axis in 0..dimension {
        let unit = std::array::from_fn(|a| f64::from(u8::from(a == axis)));
        [block.min[axis], block.max[axis]] = extent(geometry, dimension, thickness, unit);
    }
    block
}
