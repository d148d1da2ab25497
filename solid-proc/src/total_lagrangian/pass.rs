//! The two passes over the reference neighbours. X_ij = X_i - X_j reference positions, u displacement, weights
//! w = -V0 W'(R_ij) / R_ij; beta_ij = 1, but between a free and a clamped particle the free one's gain (see `clamp`).
//!
//!   M_i = sum_j w X_ij (x) X_ij,   L_i = M_i^-1                                         (Bonet and Lok 1999)
//!   F_i = I + H_i,   H_i = sum_j w beta u_ij (x) X_ij L_i
//!   rho0 D v_i / Dt = -sum_j w beta [ (B_i + B_j) X_ij + (a_i + a_j) beta u_ij ],   B = P L - a H
//!
//! P L in B is the stress, the rest the hourglass force (see `hourglass`): the derivatives of sum_i V0 psi(F_i) and of
//! the hourglass energy. Momentum and angular momentum are therefore conserved.

use crate::columns::Vectors;
use halfstep_sph::artificial_viscosity::damping;
use halfstep_sph::lane::{Arch, Lane};
use halfstep_sph::pair::{FixedLaw, dot};

/// Full tensors, entry by entry.
pub(super) type Matrices<const D: usize> = [[Vec<f64>; D]; D];

/// What the reference configuration fixes beside pairs and their slopes.
pub(super) struct Fixed {
    /// 1 where clamped, else 0.
    pub clamped: Vec<f64>,
    /// gain - 1.
    pub excess_gain: Vec<f64>,
}

/// beta_ij - 1 for four targets.
#[inline(always)]
fn excess<A: Arch>(clamped: Lane, gain: Lane, clamped_j: f64, gain_j: f64) -> Lane {
    A::mul_add(Lane::splat(clamped_j), gain, clamped * Lane::splat(gain_j))
}

/// The moment matrices, once.
pub(super) struct Moment {
    /// V0.
    pub volume: f64,
}

/// M of four particles; a <= b filled.
#[derive(Clone, Copy)]
pub(super) struct MomentSum<const D: usize>(pub [[Lane; D]; D]);

impl<const D: usize> Default for MomentSum<D> {
    fn default() -> Self {
        Self([[Lane::ZERO; D]; D])
    }
}

impl<const D: usize> FixedLaw<D> for Moment {
    type Target = ();
    type Sum = MomentSum<D>;
    #[inline(always)]
    fn target(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch>(&self, _: &(), _: usize, dx: [Lane; D], slope: Lane, sum: &mut MomentSum<D>) {
        let weight = Lane::splat(-self.volume) * slope;
        for a in 0..D {
            let moment = weight * dx[a];
            for b in a..D {
                sum.0[a][b] = A::mul_add(moment, dx[b], sum.0[a][b]);
            }
        }
    }
}

/// First pass: displacement gradient before its correction.
pub(super) struct Deformation<'a, const D: usize> {
    pub fixed: &'a Fixed,
    pub displacement: &'a Vectors<D>,
    /// V0.
    pub volume: f64,
}

/// Sums of the first pass for four particles.
#[derive(Clone, Copy)]
pub(super) struct DeformationSum<const D: usize> {
    /// H M.
    pub gradient: [[Lane; D]; D],
    /// sum w |beta u_ij|².
    pub square: Lane,
}

impl<const D: usize> Default for DeformationSum<D> {
    fn default() -> Self {
        Self { gradient: [[Lane::ZERO; D]; D], square: Lane::ZERO }
    }
}

#[derive(Clone, Copy)]
pub(super) struct Displaced<const D: usize> {
    displacement: [Lane; D],
    clamped: Lane,
    gain: Lane,
}

impl<const D: usize> FixedLaw<D> for Deformation<'_, D> {
    type Target = Displaced<D>;
    type Sum = DeformationSum<D>;
    #[inline(always)]
    fn target(&self, slot: usize) -> Displaced<D> {
        Displaced {
            displacement: std::array::from_fn(|d| Lane::load(&self.displacement[d], slot)),
            clamped: Lane::load(&self.fixed.clamped, slot),
            gain: Lane::load(&self.fixed.excess_gain, slot),
        }
    }
    #[inline(always)]
    fn add<A: Arch>(
        &self,
        i: &Displaced<D>,
        j: usize,
        dx: [Lane; D],
        slope: Lane,
        sum: &mut DeformationSum<D>,
    ) {
        let weight = Lane::splat(-self.volume) * slope;
        let excess = excess::<A>(i.clamped, i.gain, self.fixed.clamped[j], self.fixed.excess_gain[j]);
        for a in 0..D {
            let u = i.displacement[a] - Lane::splat(self.displacement[a][j]);
            let u = A::mul_add(excess, u, u);
            sum.square = A::mul_add(weight * u, u, sum.square);
            let row = weight * u;
            for b in 0..D {
                sum.gradient[a][b] = A::mul_add(row, dx[b], sum.gradient[a][b]);
            }
        }
    }
}

/// Artificial viscosity in the second pass; `()` is none.
pub(super) trait Damping<const D: usize>: Copy + Send + Sync {
    /// What it loads of four targets.
    type Own: Copy;
    fn own(&self, slot: usize) -> Self::Own;
    /// -m Pi_ij rho0 / V0 for a pair at x_ij: coefficient of -w x_ij beside the brackets of the pass.
    fn coefficient<A: Arch>(&self, own: &Self::Own, j: usize, x: [Lane; D]) -> Lane;
    const ACTS: bool;
}

impl<const D: usize> Damping<D> for () {
    type Own = ();
    const ACTS: bool = false;
    #[inline(always)]
    fn own(&self, _: usize) {}
    #[inline(always)]
    fn coefficient<A: Arch>(&self, _: &(), _: usize, _: [Lane; D]) -> Lane {
        Lane::ZERO
    }
}

/// Monaghan's Pi_ij of present distances and velocities, with the reference kernel.
#[derive(Clone, Copy)]
pub(super) struct Viscous<'a, const D: usize> {
    pub velocity: &'a Vectors<D>,
    /// h, m.
    pub smoothing_length: f64,
    /// rho0, kg/m³.
    pub density: f64,
    /// A c_s, m/s.
    pub linear: f64,
    /// B.
    pub quadratic: f64,
}

impl<const D: usize> Damping<D> for Viscous<'_, D> {
    type Own = [Lane; D];
    const ACTS: bool = true;
    #[inline(always)]
    fn own(&self, slot: usize) -> [Lane; D] {
        std::array::from_fn(|d| Lane::load(&self.velocity[d], slot))
    }
    #[inline(always)]
    fn coefficient<A: Arch>(&self, own: &[Lane; D], j: usize, x: [Lane; D]) -> Lane {
        let v: [Lane; D] = std::array::from_fn(|d| own[d] - Lane::splat(self.velocity[d][j]));
        let (approach, r2) = (dot::<D, A>(v, x), dot::<D, A>(x, x));
        let sum = Lane::splat(2.0 * self.density);
        let pi = damping::<A>(
            self.smoothing_length,
            Lane::splat(self.linear),
            Lane::splat(self.quadratic),
            approach,
            r2,
            sum,
        );
        Lane::splat(-self.density * self.density) * pi
    }
}

/// Second pass: acceleration.
pub(super) struct Momentum<'a, V, const D: usize> {
    pub damping: V,
    pub fixed: &'a Fixed,
    pub displacement: &'a Vectors<D>,
    /// B, Pa.
    pub stress: &'a Matrices<D>,
    /// a, Pa.
    pub hourglass: &'a [f64],
    /// V0 / rho0.
    pub scale: f64,
}

#[derive(Clone, Copy)]
pub(super) struct Stressed<O, const D: usize> {
    displaced: Displaced<D>,
    stress: [[Lane; D]; D],
    hourglass: Lane,
    own: O,
}

/// The damping of the second pass alone.
pub(super) struct Viscosity<'a, V, const D: usize> {
    pub damping: V,
    pub displacement: &'a Vectors<D>,
    /// V0 / rho0.
    pub scale: f64,
}

impl<V: Damping<D>, const D: usize> FixedLaw<D> for Viscosity<'_, V, D> {
    type Target = ([Lane; D], V::Own);
    type Sum = Acceleration<D>;
    #[inline(always)]
    fn target(&self, slot: usize) -> Self::Target {
        (std::array::from_fn(|d| Lane::load(&self.displacement[d], slot)), self.damping.own(slot))
    }
    #[inline(always)]
    fn add<A: Arch>(
        &self,
        (displacement, own): &Self::Target,
        j: usize,
        dx: [Lane; D],
        slope: Lane,
        sum: &mut Acceleration<D>,
    ) {
        let x: [Lane; D] =
            std::array::from_fn(|a| dx[a] + displacement[a] - Lane::splat(self.displacement[a][j]));
        let viscous = Lane::splat(self.scale) * slope * self.damping.coefficient::<A>(own, j, x);
        for a in 0..D {
            sum.0[a] = A::mul_add(viscous, x[a], sum.0[a]);
        }
    }
}

/// Acceleration of four particles.
#[derive(Clone, Copy)]
pub(super) struct Acceleration<const D: usize>(pub [Lane; D]);

impl<const D: usize> Default for Acceleration<D> {
    fn default() -> Self {
        Self([Lane::ZERO; D])
    }
}

impl<V: Damping<D>, const D: usize> FixedLaw<D> for Momentum<'_, V, D> {
    type Target = Stressed<V::Own, D>;
    type Sum = Acceleration<D>;
    #[inline(always)]
    fn target(&self, slot: usize) -> Self::Target {
        let displaced = Displaced {
            displacement: std::array::from_fn(|d| Lane::load(&self.displacement[d], slot)),
            clamped: Lane::load(&self.fixed.clamped, slot),
            gain: Lane::load(&self.fixed.excess_gain, slot),
        };
        Stressed {
            displaced,
            stress: std::array::from_fn(|a| std::array::from_fn(|b| Lane::load(&self.stress[a][b], slot))),
            hourglass: Lane::load(self.hourglass, slot),
            own: self.damping.own(slot),
        }
    }
    #[inline(always)]
    fn add<A: Arch>(
        &self,
        i: &Self::Target,
        j: usize,
        dx: [Lane; D],
        slope: Lane,
        sum: &mut Acceleration<D>,
    ) {
        let f = Lane::splat(self.scale) * slope;
        let d = &i.displaced;
        let excess = excess::<A>(d.clamped, d.gain, self.fixed.clamped[j], self.fixed.excess_gain[j]);
        let beta = Lane::splat(1.0) + excess;
        let hourglass = (i.hourglass + Lane::splat(self.hourglass[j])) * beta;
        let u: [Lane; D] =
            std::array::from_fn(|a| i.displaced.displacement[a] - Lane::splat(self.displacement[a][j]));
        let f_beta = f * beta;
        for a in 0..D {
            let row: [Lane; D] = std::array::from_fn(|b| i.stress[a][b] + Lane::splat(self.stress[a][b][j]));
            let bracket = A::mul_add(hourglass, u[a], dot::<D, A>(row, dx));
            sum.0[a] = A::mul_add(f_beta, bracket, sum.0[a]);
        }
        if V::ACTS {
            let x: [Lane; D] = std::array::from_fn(|a| dx[a] + u[a]);
            let viscous = f * self.damping.coefficient::<A>(&i.own, j, x);
            for a in 0..D {
                sum.0[a] = A::mul_add(viscous, x[a], sum.0[a]);
            }
        }
    }
}
