//! Monaghan's artificial viscosity between two particles of the solid, or of solid and wall.

use halfstep_shared::lane::{Arch, Lane};

/// Pi_ij, Kayaki's eqs. (23) and (24).
#[inline(always)]
pub(crate) fn artificial_viscosity<A: Arch>(
    h: f64,
    linear: f64,
    quadratic: f64,
    approach: Lane,
    r2: Lane,
    density_sum: Lane,
) -> Lane {
    let theta = approach.min(Lane::ZERO) * Lane::splat(h) / (r2 + Lane::splat(0.01 * h * h));
    theta * A::mul_add(Lane::splat(quadratic), theta, Lane::splat(-linear)) * Lane::splat(2.0) / density_sum
}
