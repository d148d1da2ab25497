//! Renormalised density gradient, Kayaki's eqs. (20) and (21):
//!   {grad rho}_i = sum_j V_j (rho_j - rho_i) L_i grad W,  L_i = M_i^-1,  M_i = sum_j V_j (x_j - x_i) (x) grad W.
//!
//! M is the unit matrix inside a regular packing and nearly singular for lone particles, jets and films: there
//! (`tensor::smallest_determinant`) the gradient is zero and the diffusion falls back to the simple one.

use crate::columns::PairParticles;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, LANES, Lane, Lanes};
use halfstep_sph::pair::{PairLaw, distance, pair_sum};
use halfstep_sph::tensor::moment_inverse;
use nalgebra::{SMatrix, SVector};

/// Raw gradient and moment matrix of several particles.
#[derive(Clone, Copy, Debug)]
pub struct GradientSum<const D: usize, L = Lane> {
    raw: [L; D],
    moment: [[L; D]; D],
}

pair_sum!(GradientSum { D } { raw, moment });

/// The law of the pass.
pub struct GradientLaw<'a, K, const D: usize> {
    /// Kernel.
    pub kernel: K,
    /// The fluid.
    pub fluid: &'a PairParticles<D>,
}

impl<K: Kernel<D>, const D: usize> PairLaw<D> for GradientLaw<'_, K, D> {
    const SINGLE: bool = true;
    /// Density over the reference.
    type Target<L: Lanes> = L;
    type Sum<L: Lanes> = GradientSum<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.fluid.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
        self.fluid.excesses(slot)
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.fluid.sources[j].position
    }
    #[inline(always)]
    fn source_numbers<L: Lanes>(&self, j: usize) -> [L::Number; D] {
        self.fluid.at::<L>(j)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        i: &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut GradientSum<D, L>,
    ) {
        let f = self.kernel.gradient_over_r::<A, L>(distance(r2, self.kernel.smoothing_length()));
        let source = self.fluid.beside::<L>(j);
        let vf = source.volume * f;
        let difference = vf * (source.excess - *i);
        for a in 0..D {
            sum.raw[a] = A::mul_add(difference, dx[a], sum.raw[a]);
            let row = -(vf * dx[a]);
            for b in a..D {
                sum.moment[a][b] = A::mul_add(row, dx[b], sum.moment[a][b]);
            }
        }
    }
}

impl<const D: usize> GradientSum<D> {
    /// The renormalised gradients of the four particles, kg/m⁴.
    // Inlined, its scalar arithmetic would break up the vectors of the loop before it.
    #[inline(never)]
    pub fn solve(&self) -> [[f64; D]; LANES] {
        std::array::from_fn(|k| {
            renormalised(
                self.raw.map(|raw| raw.0[k]),
                std::array::from_fn(|a| std::array::from_fn(|b| self.moment[a.min(b)][a.max(b)].0[k])),
            )
        })
    }
}

fn renormalised<const D: usize>(raw: [f64; D], moment: [[f64; D]; D]) -> [f64; D] {
    let m = SMatrix::<f64, D, D>::from_fn(|a, b| moment[a][b]);
    moment_inverse(&m).map_or([0.0; D], |l| (l * SVector::from(raw)).into())
}
