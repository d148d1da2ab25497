//! Renormalised velocity gradient: multiplied by the inverse moment matrix, so that a rigid rotation makes no strain
//! anywhere (Bonet and Lok 1999). The plain sum makes some at surfaces, where M is not the unit matrix.

use nalgebra::SMatrix;

/// `gradient` M^-1; unchanged where M is singular (lone particles).
pub(super) fn renormalise<const D: usize>(gradient: [[f64; D]; D], moment: [[f64; D]; D]) -> [[f64; D]; D] {
    let m = SMatrix::<f64, D, D>::from_fn(|a, b| moment[a.min(b)][a.max(b)]);
    let Some(inverse) = halfstep_sph::tensor::moment_inverse(&m) else { return gradient };
    let corrected = SMatrix::<f64, D, D>::from_fn(|a, b| gradient[a][b]) * inverse;
    std::array::from_fn(|a| std::array::from_fn(|b| corrected[(a, b)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moment_of_one_half_doubles() {
        let g = renormalise([[1.0, 2.0], [3.0, 4.0]], [[0.5, 0.0], [0.0, 0.5]]);
        assert_eq!(g, [[2.0, 4.0], [6.0, 8.0]]);
    }

    #[test]
    fn a_lone_particle_keeps_its_zero() {
        assert_eq!(renormalise([[0.0; 2]; 2], [[0.0; 2]; 2]), [[0.0; 2]; 2]);
    }
}
