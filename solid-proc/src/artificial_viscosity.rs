//! Monaghan's artificial viscosity between two particles of the solid, or of solid and wall.

use halfstep_shared::artificial_viscosity::damping;
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
    damping::<A>(h, Lane::splat(linear), Lane::splat(quadratic), approach, r2, density_sum)
}
