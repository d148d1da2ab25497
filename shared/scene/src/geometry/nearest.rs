//! Which particles and which shape a probe looks at.

use super::distance;
use crate::Shape;

/// Indices of the positions nearest to a point: all that are equally near.
pub fn nearest<const D: usize>(
    positions: impl Iterator<Item = [f64; D]> + Clone,
    at: [f64; D],
) -> Vec<usize> {
    let distances = positions.map(|x: [f64; D]| (0..D).map(|d| (x[d] - at[d]).powi(2)).sum::<f64>().sqrt());
    let least = distances.clone().fold(f64::INFINITY, f64::min);
    distances.enumerate().filter(|(_, r)| *r <= least * (1.0 + 1e-6) + 1e-12).map(|(i, _)| i).collect()
}

/// The shape of solid that is nearest to a point: of several equally near the one that comes first.
pub fn nearest_solid(shapes: &[Shape], at: &[f64; 3]) -> Option<usize> {
    let solids = shapes.iter().enumerate().filter(|(_, shape)| shape.solid.is_some());
    let distances = solids.map(|(index, shape)| (index, distance(&shape.geometry, at)));
    distances.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn every_point_at_the_least_distance_is_found() {
        let row = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]];
        assert_eq!(nearest(row.into_iter(), [1.5, 2.0]), [1, 2]);
        assert_eq!(nearest(row.into_iter(), [9.0, 0.0]), [3]);
        assert!(nearest([[0.0; 3]; 0].into_iter(), [0.0; 3]).is_empty());
    }
}
