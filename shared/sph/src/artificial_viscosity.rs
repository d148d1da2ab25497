//! Monaghan's artificial viscosity (Monaghan 1992), Kayaki's eqs. (23) and (24), between any two particles:
//!   Pi_ij = (-A c theta + B theta²) / rho_ij where v_ij . x_ij < 0, else 0,
//!   theta = h v_ij . x_ij / (r² + 0.01 h²), rho_ij = (rho_i + rho_j) / 2.
//! Divisions are what a pair costs most, so the three are one:
//!   Pi_ij = 2 q (B q - A c s) / (s² (rho_i + rho_j)), q = h min(v_ij . x_ij, 0), s = r² + 0.01 h².

use crate::lane::{Arch, Lanes};

/// Pi_ij with each target, m⁵/(kg s²). `linear` is A c, m/s; `quadratic` is B; `approach` is v_ij . x_ij, m²/s.
#[inline(always)]
pub fn damping<A: Arch, L: Lanes>(h: f64, linear: L, quadratic: L, approach: L, r2: L, density_sum: L) -> L {
    let q = approach.min(L::ZERO) * L::splat(h);
    let s = r2 + L::splat(0.01 * h * h);
    let numerator = (q + q) * A::mul_add(quadratic, q, -(linear * s));
    numerator / (s * s * density_sum)
}
