//! Artificial stress against the tensile instability (Gray, Monaghan and Swift 2001; Kayaki's eqs. 25 and 26):
//! the term (R_i + R_j) (W(r) / W(d0))^n is added in the momentum bracket. In the principal axes of sigma,
//! R = -epsilon sigma_aa / rho² where sigma_aa > 0 (tension), else 0; rotated back. d0 is the initial spacing.

use nalgebra::{SMatrix, SymmetricEigen};

/// R of one particle from its stress sigma.
pub(super) fn tensor<const D: usize>(epsilon: f64, sigma: [[f64; D]; D], density: f64) -> [[f64; D]; D] {
    let scale = -epsilon / (density * density);
    match D {
        2 => {
            // Closed form of the eigenproblem: mean +- radius.
            let (xx, yy, xy) = (sigma[0][0], sigma[1][1], sigma[0][1]);
            let mean = 0.5 * (xx + yy);
            let half = 0.5 * (xx - yy);
            let radius = (half * half + xy * xy).sqrt();
            let first = (mean + radius).max(0.0);
            let second = (mean - radius).max(0.0);
            let (cos2, sin2) = if radius > 0.0 { (half / radius, xy / radius) } else { (1.0, 0.0) };
            let (m, h) = (0.5 * (first + second), 0.5 * (first - second));
            let entries = [[m + h * cos2, h * sin2], [h * sin2, m - h * cos2]];
            std::array::from_fn(|a| std::array::from_fn(|b| scale * entries[a][b]))
        }
        _ => {
            let m = SMatrix::<f64, 3, 3>::from_fn(|a, b| sigma[a][b]);
            let eigen = SymmetricEigen::new(m);
            let tension = eigen.eigenvalues.map(|v| v.max(0.0));
            let r = eigen.eigenvectors
                * SMatrix::<f64, 3, 3>::from_diagonal(&tension)
                * eigen.eigenvectors.transpose();
            std::array::from_fn(|a| std::array::from_fn(|b| scale * r[(a, b)]))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tension_and_compression_by_hand() {
        // sigma = diag(8, -4), rho = 2, epsilon = 0.3: R = diag(-0.3 * 8 / 4, 0).
        let r = tensor(0.3, [[8.0, 0.0], [0.0, -4.0]], 2.0);
        assert!((r[0][0] + 0.6).abs() < 1e-15 && r[1][1].abs() < 1e-15 && r[0][1].abs() < 1e-15);
    }

    #[test]
    fn pure_shear_by_hand() {
        // sigma_xy = 1: tension 1 along the diagonal, so R = -epsilon / 2 in every entry (rho = 1).
        let r = tensor(0.3, [[0.0, 1.0], [1.0, 0.0]], 1.0);
        for entry in r.as_flattened() {
            assert!((entry + 0.15).abs() < 1e-15);
        }
    }

    #[test]
    fn three_dimensions_agree_with_two() {
        let plane = tensor(0.3, [[3.0, 1.0], [1.0, -2.0]], 1.5);
        let space = tensor(0.3, [[3.0, 1.0, 0.0], [1.0, -2.0, 0.0], [0.0, 0.0, -1.0]], 1.5);
        for a in 0..2 {
            for b in 0..2 {
                assert!((plane[a][b] - space[a][b]).abs() < 1e-14);
            }
        }
    }
}
