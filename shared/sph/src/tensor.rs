//! Small matrices in two and three dimensions, where nalgebra's generic routines ask for bounds on the dimension.

use nalgebra::SMatrix;

/// Determinant of a 2 x 2 or 3 x 3 matrix.
pub fn determinant<const D: usize>(m: &SMatrix<f64, D, D>) -> f64 {
    match D {
        2 => m[(0, 0)] * m[(1, 1)] - m[(0, 1)] * m[(1, 0)],
        3 => (0..3).map(|b| m[(0, b)] * cofactor(m, 0, b)).sum(),
        _ => f64::NAN,
    }
}

/// Inverse of a 2 x 2 or 3 x 3 matrix whose determinant is known; `None` where that is zero or not finite.
pub fn inverse<const D: usize>(m: &SMatrix<f64, D, D>, determinant: f64) -> Option<SMatrix<f64, D, D>> {
    if determinant == 0.0 || !determinant.is_finite() {
        return None;
    }
    let scale = 1.0 / determinant;
    Some(match D {
        2 => SMatrix::from_fn(|a, b| {
            scale
                * match (a, b) {
                    (0, 0) => m[(1, 1)],
                    (1, 1) => m[(0, 0)],
                    _ => -m[(a, b)],
                }
        }),
        _ => SMatrix::from_fn(|a, b| scale * cofactor(m, b, a)),
    })
}

/// Determinant of a moment matrix below which it has no inverse worth using: lone particles, jets, films. About half of
/// what the corner of a lattice has with the widest usual support: 0.099 in the plane and 0.0086 in space with the
/// Wendland kernel and h = 2 dx (0.124 and 0.017 with h = 1.5 dx).
pub const fn smallest_determinant(dimension: usize) -> f64 {
    if dimension == 2 { 0.05 } else { 0.005 }
}

/// Inverse of a moment matrix M = sum_j V_j (x_j - x_i) (x) grad W; `None` below [`smallest_determinant`].
pub fn moment_inverse<const D: usize>(moment: &SMatrix<f64, D, D>) -> Option<SMatrix<f64, D, D>> {
    let determinant = determinant(moment);
    (determinant >= smallest_determinant(D)).then(|| inverse(moment, determinant)).flatten()
}

fn cofactor<const D: usize>(m: &SMatrix<f64, D, D>, a: usize, b: usize) -> f64 {
    let (r, s) = ((a + 1) % 3, (a + 2) % 3);
    let (t, u) = ((b + 1) % 3, (b + 2) % 3);
    m[(r, t)] * m[(s, u)] - m[(r, u)] * m[(s, t)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Matrix3};

    #[test]
    fn a_tensor_times_its_inverse_is_the_identity() {
        let a = Matrix2::new(4.0, 1.0, 2.0, 3.0);
        assert_eq!(determinant(&a), 10.0);
        assert!((inverse(&a, 10.0).unwrap() * a - Matrix2::identity()).norm() < 1e-15);
        let b = Matrix3::new(2.0, 0.0, 1.0, 1.0, 3.0, 2.0, 1.0, 1.0, 4.0);
        assert_eq!(determinant(&b), 18.0);
        assert!((inverse(&b, 18.0).unwrap() * b - Matrix3::identity()).norm() < 1e-15);
        assert!(inverse(&Matrix2::zeros(), 0.0).is_none());
        assert!(moment_inverse(&Matrix2::new(0.2, 0.0, 0.0, 0.2)).is_none(), "det M = 0.04");
        assert_eq!(moment_inverse(&Matrix2::new(0.5, 0.0, 0.0, 0.5)), Some(Matrix2::identity() * 2.0));
    }
}
