//! Resistance to deformations that F does not see (hourglass modes), and the bending stiffness of a single particle.
//!
//! The error vector of Ganzenmueller 2015, e_ij = x_ij - F_i X_ij (F_i the deformation gradient), gets the energy
//!   1/2 sum_j kappa_ij |e_ij|²,   kappa_ij = a V0 w_ij,   w_ij = -V0 W'(R_ij) / R_ij,   a = alpha G.
//! With these weights the derivative through F_i is zero, since F_i is the fit that leaves no first moment of e. So the
//! force is -sum_j kappa_ij (e_ij - e_ji): pairwise antisymmetric, from an energy, and zero in a linear field.
//!
//! **alpha from the bending stiffness.** n rows of particles that carry one strain each have 1 - 1/n² of a plate's
//! bending stiffness: the strain's variation within a particle's own cell, dx²/12 of second moment, is missing. In
//! bending to curvature c, u = c (-x y, x²/2 + nu' y²/2) with nu' = nu / (1 - nu), the cell lacks the energy density
//!   1/2 c² dx²/12 2 G / (1 - nu),
//! and the error vectors of an inner particle hold
//!   1/2 c² alpha G sum_j w [X² Y² + (X² + nu' Y²)² / 4].
//! The default alpha makes them equal: particles then resist bending as the material in their cells does.

use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Lane, Lanes, Unfused};

/// alpha that gives a lattice of spacing `dx` the whole bending stiffness.
pub(super) fn from_bending<K: Kernel<D>, const D: usize>(kernel: K, dx: f64, poissons_ratio: f64) -> f64 {
    let nu = poissons_ratio / (1.0 - poissons_ratio);
    let reach = (2.0 * kernel.smoothing_length() / dx).ceil() as i64;
    let depth = if D == 3 { reach } else { 0 };
    let mut sum = 0.0;
    for k in -depth..=depth {
        for j in -reach..=reach {
            for i in -reach..=reach {
                if (i, j, k) == (0, 0, 0) {
                    continue;
                }
                let [x, y, z] = [i, j, k].map(|n| n as f64 * dx);
                let r = Lane::splat((x * x + y * y + z * z).sqrt());
                let weight = -dx.powi(D as i32) * kernel.gradient_over_r::<Unfused, Lane>(r).0[0];
                sum += weight * (x * x * y * y + 0.25 * (x * x + nu * y * y).powi(2));
            }
        }
    }
    dx * dx / (6.0 * (1.0 - poissons_ratio) * sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfstep_sph::kernel::CubicSpline;

    #[test]
    fn four_neighbours_by_hand() {
        // Reach below the diagonal (h = 0.6): four neighbours of weight w, of which only the axial terms
        // count: sum = w dx⁴ (1 + nu'²) / 2. With nu = 0: alpha = 1 / (3 w dx²).
        let kernel = CubicSpline::<2>::new(0.6);
        let w = -kernel.gradient_over_r::<Unfused, Lane>(Lane::splat(1.0)).0[0];
        assert!((from_bending(kernel, 1.0, 0.0) - 1.0 / (3.0 * w)).abs() < 1e-14);
        // nu = 1/3: nu' = 1/2, alpha = 2 / (6 (2/3) w 5/4).
        assert!((from_bending(kernel, 1.0, 1.0 / 3.0) - 2.0 / (5.0 * w)).abs() < 1e-13);
    }

    #[test]
    fn it_does_not_depend_on_the_unit_of_length() {
        let one = from_bending(CubicSpline::<2>::new(0.75), 1.0, 0.4);
        let milli = from_bending(CubicSpline::<2>::new(0.75e-3), 1e-3, 0.4);
        assert!((one - milli).abs() < 1e-12 * one, "{one} {milli}");
    }
}
