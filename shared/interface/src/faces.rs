//! Faces of a solid toward the fluid: the two of a thin plate, or the one that any other solid has.

use super::InterfaceParticles;
use super::moving_wall::OneFace;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Lane, Lanes};
use halfstep_sph::pair::{PairLaw, distance, pair_sum};

/// On which face of the solid fluid stands: the share of the second one.
pub(super) trait Faces<const D: usize>: Copy + Send + Sync {
    /// What is loaded of solid particles.
    type Own<L: Lanes>: Copy;
    /// Loads the solid particles from `slot` on.
    fn load<L: Lanes>(&self, slot: usize) -> Self::Own<L>;
    /// Of fluid at `to_fluid` = x_f - x_s from solid particles.
    fn share_of<A: Arch, L: Lanes>(&self, own: &Self::Own<L>, to_fluid: [L; D]) -> L;
    /// Of fluid particles at `to_fluid` from the solid particle `j`.
    fn share_at<A: Arch, L: Lanes>(&self, j: usize, to_fluid: [L; D]) -> L;
}

impl<const D: usize> Faces<D> for OneFace<'_, D> {
    type Own<L: Lanes> = ();

    #[inline(always)]
    fn load<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn share_of<A: Arch, L: Lanes>(&self, (): &(), _: [L; D]) -> L {
        L::splat(1.0)
    }
    #[inline(always)]
    fn share_at<A: Arch, L: Lanes>(&self, _: usize, _: [L; D]) -> L {
        L::splat(1.0)
    }
}

/// Of what two faces show, the part that fluid with this share of the second one sees.
#[inline(always)]
pub(super) fn between<A: Arch, L: Lanes>([against, along]: [L; 2], share: L) -> L {
    A::mul_add(share, along - against, against)
}

/// sum W, sum W v_f and sum W (x_s - x_f) of several solid particles, over the fluid on one face.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceSum<const D: usize, L = Lane> {
    pub(super) weight: L,
    pub(super) velocity: [L; D],
    pub(super) from_fluid: [L; D],
}
pair_sum!(FaceSum { D } { weight, velocity, from_fluid });

/// The pass over the solid: the fluid at each face.
pub(super) struct AtFaces<'a, K, F, const D: usize> {
    pub(super) kernel: K,
    pub(super) fluid: &'a InterfaceParticles<D>,
    pub(super) solid: &'a InterfaceParticles<D>,
    pub(super) faces: F,
}

impl<K: Kernel<D>, F: Faces<D>, const D: usize> PairLaw<D> for AtFaces<'_, K, F, D> {
    type Target<L: Lanes> = F::Own<L>;
    type Sum<L: Lanes> = [FaceSum<D, L>; 2];

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.solid.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> F::Own<L> {
        self.faces.load(slot)
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.fluid.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, own: &F::Own<L>, j: usize, dx: [L; D], r2: L, sum: &mut Self::Sum<L>) {
        let w = self.kernel.value::<A, L>(distance(r2, self.kernel.smoothing_length()));
        let along = w * self.faces.share_of::<A, L>(own, dx.map(|x| -x));
        for (sum, w) in sum.iter_mut().zip([w - along, along]) {
            sum.weight += w;
            for d in 0..D {
                sum.velocity[d] = A::mul_add(w, L::splat(self.fluid.velocity[d][j]), sum.velocity[d]);
                sum.from_fluid[d] = A::mul_add(w, dx[d], sum.from_fluid[d]);
            }
        }
    }
}
