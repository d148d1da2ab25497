//! Laminar viscosity, Morris, Fox and Zhu 1997, eq. (22), with one mu for all particles: the acceleration gets
//!   sum_j m_j 2 mu / (rho_i rho_j) (x_ij . grad W) / r² v_ij = sum_j m_j 2 mu / (rho_i rho_j) F v_ij,
//! since grad W = F x_ij. It keeps linear momentum and needs no pass of its own. At a wall it acts with the velocity
//! that the wall shows.

use halfstep_fluid::effects::FluidEffect;
use halfstep_fluid::rates::{FluidPair, PairEffect, PairRates};
use halfstep_scene::{Decision, Derived, Scene};
use halfstep_sph::lane::{Arch, Lanes};

/// The effect's key in `[effects]`, and its name in reports.
pub(crate) const NAME: &str = "laminar-viscosity";

/// The effect, and its share of a pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaminarViscosity {
    /// mu, Pa s.
    pub(crate) viscosity: f64,
}

impl<const D: usize> FluidEffect<D> for LaminarViscosity {
    const NAME: &'static str = NAME;
    type Pair<'a> = Self;
    type AtWall<'a> = Self;

    fn decide(scene: &Scene) -> Decision {
        Decision::own(scene, NAME, Derived::On("the program has it".into()))
    }
    fn pair(&self) -> Option<Self> {
        Some(*self)
    }
    fn at_wall(&self) -> Option<Self> {
        Some(*self)
    }
}

impl<const D: usize> PairEffect<D> for LaminarViscosity {
    type Own<L: Lanes> = ();
    const VECTOR: bool = true;
    const CONTINUITY: bool = false;

    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}

    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, pair: &FluidPair<D, L>, rates: &mut PairRates<D, L>) {
        let factor = L::splat(2.0 * self.viscosity) / (pair.density_i * pair.density_j);
        for d in 0..D {
            rates.vector[d] = A::mul_add(factor, pair.dv[d], rates.vector[d]);
        }
    }
}
