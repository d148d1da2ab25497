//! Places along a line.

use crate::Scene;

/// The middles of parts of a line that are at most half a spacing long.
pub fn along<const D: usize>(scene: &Scene, from: &[f64; 3], to: &[f64; 3]) -> Vec<[f64; D]> {
    let length = (0..D).map(|d| (to[d] - from[d]).powi(2)).sum::<f64>().sqrt();
    let parts = (2.0 * length / scene.resolution).ceil().max(1.0);
    let at = |part: usize| (part as f64 + 0.5) / parts;
    (0..parts as usize).map(|part| std::array::from_fn(|d| from[d] + at(part) * (to[d] - from[d]))).collect()
}
