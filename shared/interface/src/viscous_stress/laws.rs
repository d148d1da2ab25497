//! The laws of the passes, and what they sum up.

use crate::faces::{FaceSum, Faces, between};
use crate::phase_blind::Vector;
use crate::{InterfaceParticles, SolidForce};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Lanes};
use halfstep_sph::pair::{PairLaw, distance, dot};

/// What the laws see.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a, F, const D: usize> {
    pub(super) fluid: &'a InterfaceParticles<D>,
    pub(super) solid: &'a InterfaceParticles<D>,
    pub(super) shown: &'a [[Vec<f64>; D]; 2],
    pub(super) faces: F,
    /// 2 D mu / <r²>, Pa s / m².
    pub(super) strength: f64,
}

impl<F: Faces<D>, const D: usize> Seen<'_, F, D> {
    /// v_s of the solid particle `j` toward fluid particles.
    #[inline(always)]
    fn shown_at<A: Arch, L: Lanes>(&self, j: usize, to_fluid: [L; D]) -> [L; D] {
        let share = self.faces.share_at::<A, L>(j, to_fluid);
        let [against, along] = self.shown;
        std::array::from_fn(|d| between::<A, L>([L::splat(against[d][j]), L::splat(along[d][j])], share))
    }
}

/// Acceleration of the fluid.
pub(super) struct OnFluid<'a, K, F, const D: usize>(pub(super) K, pub(super) Seen<'a, F, D>);

impl<K: Kernel<D>, F: Faces<D>, const D: usize> PairLaw<D> for OnFluid<'_, K, F, D> {
    /// Velocity; 2 D mu / (<r²> rho).
    type Target<L: Lanes> = ([L; D], L);
    type Sum<L: Lanes> = Vector<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.1.fluid.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
        let velocity = std::array::from_fn(|d| L::load(&self.1.fluid.velocity[d], slot));
        (velocity, L::splat(self.1.strength) / L::load(&self.1.fluid.density, slot))
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.1.solid.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        (velocity, factor): &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut Vector<D, L>,
    ) {
        let Self(kernel, seen) = self;
        let f = kernel.gradient_over_r::<A, L>(distance(r2, kernel.smoothing_length()));
        let coefficient = L::splat(seen.solid.mass[j] / seen.solid.density[j]) * *factor * f;
        let shown = seen.shown_at::<A, L>(j, dx);
        let approach = dot::<D, A, L>(std::array::from_fn(|d| velocity[d] - shown[d]), dx);
        for d in 0..D {
            sum.0[d] = A::mul_add(coefficient * approach, dx[d], sum.0[d]);
        }
    }
}

/// What is loaded of solid particles.
#[derive(Clone, Copy)]
pub(super) struct OfSolid<O, L, const D: usize> {
    shown: [[L; D]; 2],
    /// 2 D mu V / <r²>.
    factor: L,
    own: O,
}

/// Force on the solid.
pub(super) struct OnSolid<'a, K, F, const D: usize>(pub(super) K, pub(super) Seen<'a, F, D>);

impl<K: Kernel<D>, F: Faces<D>, const D: usize> PairLaw<D> for OnSolid<'_, K, F, D> {
    type Target<L: Lanes> = OfSolid<F::Own<L>, L, D>;
    type Sum<L: Lanes> = SolidForce<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.1.solid.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
        let seen = &self.1;
        OfSolid {
            shown: std::array::from_fn(|k| std::array::from_fn(|d| L::load(&seen.shown[k][d], slot))),
            factor: L::splat(seen.strength) * L::load(&seen.solid.mass, slot)
                / L::load(&seen.solid.density, slot),
            own: seen.faces.load(slot),
        }
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.1.fluid.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        i: &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut SolidForce<D, L>,
    ) {
        let Self(kernel, seen) = self;
        let f = kernel.gradient_over_r::<A, L>(distance(r2, kernel.smoothing_length()));
        let coefficient = L::splat(seen.fluid.mass[j] / seen.fluid.density[j]) * i.factor * f;
        let share = seen.faces.share_of::<A, L>(&i.own, dx.map(|x| -x));
        let shown = |d: usize| between::<A, L>(i.shown.map(|shown| shown[d]), share);
        let velocity = std::array::from_fn(|d| shown(d) - L::splat(seen.fluid.velocity[d][j]));
        let approach = dot::<D, A, L>(velocity, dx);
        for d in 0..D {
            sum.0[d] = A::mul_add(coefficient * approach, dx[d], sum.0[d]);
        }
    }
}

impl<const D: usize> FaceSum<D> {
    /// w~ of the k-th, m/s, with its own velocity and the rotation beside it; zero without fluid around.
    pub(super) fn relative(&self, k: usize, own: &[f64; D], spin: impl Fn(usize, usize) -> f64) -> [f64; D] {
        let weight = self.weight.0[k];
        if weight <= 0.0 {
            return [0.0; D];
        }
        let to_fluid = |d: usize| -self.from_fluid[d].0[k] / weight;
        let mut relative = std::array::from_fn(|d| self.velocity[d].0[k] / weight - own[d]);
        for a in 0..D {
            for b in a + 1..D {
                relative[a] -= spin(a, b) * to_fluid(b);
                relative[b] += spin(a, b) * to_fluid(a);
            }
        }
        relative
    }
}
