//! Principal values and directions of symmetric matrices, by Jacobi's rotations: additions, products, quotients and
//! square roots only, so the same bits on every machine.

use crate::total_lagrangian::material::Matrix;
use nalgebra::SVector;

/// Most sweeps; three dimensions take four or five.
const SWEEPS: usize = 16;

/// Principal values, and directions as columns.
pub(super) fn principal<const D: usize>(symmetric: &Matrix<D>) -> ([f64; D], Matrix<D>) {
    let (mut a, mut directions) = (*symmetric, Matrix::<D>::identity());
    for _ in 0..SWEEPS {
        let mut turned = false;
        for p in 0..D {
            for q in p + 1..D {
                let off = a[(p, q)];
                if off.abs() <= f64::EPSILON * 0.5 * (a[(p, p)].abs() + a[(q, q)].abs()) {
                    continue;
                }
                turned = true;
                let half = (a[(q, q)] - a[(p, p)]) / (2.0 * off);
                let root = (half * half + 1.0).sqrt();
                let t = if half < 0.0 { -1.0 / (root - half) } else { 1.0 / (root + half) };
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for k in 0..D {
                    let (x, y) = (a[(k, p)], a[(k, q)]);
                    (a[(k, p)], a[(k, q)]) = (c * x - s * y, s * x + c * y);
                }
                for k in 0..D {
                    let (x, y) = (a[(p, k)], a[(q, k)]);
                    (a[(p, k)], a[(q, k)]) = (c * x - s * y, s * x + c * y);
                    let (x, y) = (directions[(k, p)], directions[(k, q)]);
                    (directions[(k, p)], directions[(k, q)]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
        if !turned {
            break;
        }
    }
    (std::array::from_fn(|k| a[(k, k)]), directions)
}

/// The largest principal value.
pub(super) fn largest<const D: usize>(symmetric: &Matrix<D>) -> f64 {
    principal(symmetric).0.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

/// The smallest principal value and its direction.
pub(super) fn smallest<const D: usize>(symmetric: &Matrix<D>) -> (f64, SVector<f64, D>) {
    let (values, directions) = principal(symmetric);
    let least = (1..D).fold(0, |least, k| if values[k] < values[least] { k } else { least });
    (values[least], directions.column(least).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Matrix3};

    #[test]
    fn values_and_directions_make_the_matrix() {
        let m = Matrix3::new(4.0, 1.0, -2.0, 1.0, 3.0, 0.5, -2.0, 0.5, -1.0);
        let (values, directions) = principal(&m);
        let diagonal = Matrix3::from_diagonal(&values.into());
        assert!((directions * diagonal * directions.transpose() - m).norm() < 1e-14);
        assert!((directions * directions.transpose() - Matrix3::identity()).norm() < 1e-14);
    }

    #[test]
    fn pure_shear_by_hand() {
        let shear = Matrix2::new(1.0, 2.0, 2.0, 1.0);
        assert!((largest(&shear) - 3.0).abs() < 1e-15);
        let (value, direction) = smallest(&shear);
        assert!((value + 1.0).abs() < 1e-15 && (direction[0] + direction[1]).abs() < 1e-15, "{direction}");
        assert_eq!(principal(&Matrix2::new(5.0, 0.0, 0.0, -7.0)).0, [5.0, -7.0]);
    }
}
