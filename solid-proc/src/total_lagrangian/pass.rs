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
use halfstep_sph::lane::{Arch, Lane, Lanes};
use halfstep_sph::pair::{FixedLaw, dot, pair_sum};

/// Full tensors, entry by entry.
pub(super) type Matrices<const D: usize> = [[Vec<f64>; D]; D];

/// What the reference configuration fixes beside pairs and their slopes.
pub(super) struct Fixed {
    /// 1 where clamped, else 0.
    pub clamped: Vec<f64>,
    /// gain - 1.
    pub excess_gain: Vec<f64>,
}

/// beta_ij - 1 for the targets.
#[inline(always)]
fn excess<A: Arch, L: Lanes>(clamped: L, gain: L, clamped_j: f64, gain_j: f64) -> L {
    A::mul_add(L::splat(clamped_j), gain, clamped * L::splat(gain_j))
}

/// The moment matrices, once.
pub(super) struct Moment {
    /// V0.
    pub volume: f64,
}

/// M of several particles; a <= b filled.
#[derive(Clone, Copy)]
pub(super) struct MomentSum<const D: usize, L = Lane>(pub [[L; D]; D]);
pair_sum!(MomentSum { D } { 0 });

impl<const D: usize> FixedLaw<D> for Moment {
    type Target<L: Lanes> = ();
    type Sum<L: Lanes> = MomentSum<D, L>;
    #[inline(always)]
    fn target<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, dx: [L; D], slope: L, sum: &mut MomentSum<D, L>) {
        let weight = L::splat(-self.volume) * slope;
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

/// Sums of the first pass for several particles.
#[derive(Clone, Copy)]
pub(super) struct DeformationSum<const D: usize, L = Lane> {
    /// H M.
    pub gradient: [[L; D]; D],
    /// sum w |beta u_ij|².
    pub square: L,
}

pair_sum!(DeformationSum { D } { gradient, square });

#[derive(Clone, Copy)]
pub(super) struct Displaced<L, const D: usize> {
    displacement: [L; D],
    clamped: L,
    gain: L,
}

impl<const D: usize> FixedLaw<D> for Deformation<'_, D> {
    type Target<L: Lanes> = Displaced<L, D>;
    type Sum<L: Lanes> = DeformationSum<D, L>;
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Displaced<L, D> {
        Displaced {
            displacement: std::array::from_fn(|d| L::load(&self.displacement[d], slot)),
            clamped: L::load(&self.fixed.clamped, slot),
            gain: L::load(&self.fixed.excess_gain, slot),
        }
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        i: &Displaced<L, D>,
        j: usize,
        dx: [L; D],
        slope: L,
        sum: &mut DeformationSum<D, L>,
    ) {
        let weight = L::splat(-self.volume) * slope;
        let excess = excess::<A, L>(i.clamped, i.gain, self.fixed.clamped[j], self.fixed.excess_gain[j]);
        for a in 0..D {
            let u = i.displacement[a] - L::splat(self.displacement[a][j]);
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
    /// What it loads of the targets.
    type Own<L: Lanes>: Copy;
    fn own<L: Lanes>(&self, slot: usize) -> Self::Own<L>;
    /// -m Pi_ij rho0 / V0 for a pair at x_ij: coefficient of -w x_ij beside the brackets of the pass.
    fn coefficient<A: Arch, L: Lanes>(&self, own: &Self::Own<L>, j: usize, x: [L; D]) -> L;
    const ACTS: bool;
}

impl<const D: usize> Damping<D> for () {
    type Own<L: Lanes> = ();
    const ACTS: bool = false;
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn coefficient<A: Arch, L: Lanes>(&self, _: &(), _: usize, _: [L; D]) -> L {
        L::ZERO
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
    type Own<L: Lanes> = [L; D];
    const ACTS: bool = true;
    #[inline(always)]
    fn own<L: Lanes>(&self, slot: usize) -> [L; D] {
        std::array::from_fn(|d| L::load(&self.velocity[d], slot))
    }
    #[inline(always)]
    fn coefficient<A: Arch, L: Lanes>(&self, own: &[L; D], j: usize, x: [L; D]) -> L {
        let v: [L; D] = std::array::from_fn(|d| own[d] - L::splat(self.velocity[d][j]));
        let (approach, r2) = (dot::<D, A, L>(v, x), dot::<D, A, L>(x, x));
        let sum = L::splat(2.0 * self.density);
        let pi = damping::<A, L>(
            self.smoothing_length,
            L::splat(self.linear),
            L::splat(self.quadratic),
            approach,
            r2,
            sum,
        );
        L::splat(-self.density * self.density) * pi
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
pub(super) struct Stressed<O, L, const D: usize> {
    displaced: Displaced<L, D>,
    stress: [[L; D]; D],
    hourglass: L,
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
    type Target<L: Lanes> = ([L; D], V::Own<L>);
    type Sum<L: Lanes> = Acceleration<D, L>;
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
        (std::array::from_fn(|d| L::load(&self.displacement[d], slot)), self.damping.own(slot))
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        (displacement, own): &Self::Target<L>,
        j: usize,
        dx: [L; D],
        slope: L,
        sum: &mut Acceleration<D, L>,
    ) {
        let x: [L; D] = std::array::from_fn(|a| dx[a] + displacement[a] - L::splat(self.displacement[a][j]));
        let viscous = L::splat(self.scale) * slope * self.damping.coefficient::<A, L>(own, j, x);
        for a in 0..D {
            sum.0[a] = A::mul_add(viscous, x[a], sum.0[a]);
        }
    }
}

/// Acceleration of several particles.
#[derive(Clone, Copy)]
pub(super) struct Acceleration<const D: usize, L = Lane>(pub [L; D]);
pair_sum!(Acceleration { D } { 0 });

impl<V: Damping<D>, const D: usize> FixedLaw<D> for Momentum<'_, V, D> {
    type Target<L: Lanes> = Stressed<V::Own<L>, L, D>;
    type Sum<L: Lanes> = Acceleration<D, L>;
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
        let displaced = Displaced {
            displacement: std::array::from_fn(|d| L::load(&self.displacement[d], slot)),
            clamped: L::load(&self.fixed.clamped, slot),
            gain: L::load(&self.fixed.excess_gain, slot),
        };
        Stressed {
            displaced,
            stress: std::array::from_fn(|a| std::array::from_fn(|b| L::load(&self.stress[a][b], slot))),
            hourglass: L::load(self.hourglass, slot),
            own: self.damping.own(slot),
        }
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        i: &Self::Target<L>,
        j: usize,
        dx: [L; D],
        slope: L,
        sum: &mut Acceleration<D, L>,
    ) {
        let f = L::splat(self.scale) * slope;
        let d = &i.displaced;
        let excess = excess::<A, L>(d.clamped, d.gain, self.fixed.clamped[j], self.fixed.excess_gain[j]);
        let beta = L::splat(1.0) + excess;
        let hourglass = (i.hourglass + L::splat(self.hourglass[j])) * beta;
        let u: [L; D] =
            std::array::from_fn(|a| i.displaced.displacement[a] - L::splat(self.displacement[a][j]));
        let f_beta = f * beta;
        for a in 0..D {
            let row: [L; D] = std::array::from_fn(|b| i.stress[a][b] + L::splat(self.stress[a][b][j]));
            let bracket = A::mul_add(hourglass, u[a], dot::<D, A, L>(row, dx));
            sum.0[a] = A::mul_add(f_beta, bracket, sum.0[a]);
        }
        if V::ACTS {
            let x: [L; D] = std::array::from_fn(|a| dx[a] + u[a]);
            let viscous = f * self.damping.coefficient::<A, L>(&i.own, j, x);
            for a in 0..D {
                sum.0[a] = A::mul_add(viscous, x[a], sum.0[a]);
            }
        }
    }
}
