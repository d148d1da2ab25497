//! Pressure in the momentum equation, Kayaki's eq. (22): with grad W = F x_ij
//!   D v_i / Dt = -sum_j m_j (p_i / rho_i² + p_j / rho_j²) grad W + ...
//! and continuity, eq. (17):
//!   D rho_i / Dt = rho_i sum_j m_j / rho_j v_ij . grad W + ...
//! Both stand at the head of every pass; the other effects add to the same bracket.

use crate::rates::{FluidPair, PairRates};
use halfstep_sph::lane::Lanes;

/// The bracket of the momentum equation and the density's rate before any other effect.
#[inline(always)]
pub fn pressure_and_continuity<L: Lanes, const D: usize>(pair: &FluidPair<D, L>) -> PairRates<D, L> {
    PairRates {
        bracket: -(pair.pressure_term_i + pair.pressure_term_j),
        density: pair.density_i * pair.approach,
        vector: [L::ZERO; D],
    }
}
