//! Renormalised density gradient, Kayaki's eqs. (20) and (21):
//!   {grad rho}_i = sum_j V_j (rho_j - rho_i) L_i grad W,  L_i = M_i^-1,  M_i = sum_j V_j (x_j - x_i) (x) grad W.
//!
//! M is the unit matrix inside a regular packing and nearly singular for lone particles, jets and films: there
//! (det M < 0.05) the gradient is zero and the diffusion falls back to the simple one.

use crate::columns::Shown;
use halfstep_shared::kernel::Kernel;
use halfstep_shared::lane::{Arch, LANES, Lane};
use halfstep_shared::pair::{PairLaw, distance};
use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;

/// Determinant of M below which the gradient is left out.
pub const SMALLEST_DETERMINANT: f64 = 0.05;

/// Raw gradient and moment matrix of four particles.
#[derive(Clone, Copy, Debug)]
pub struct GradientSum<const D: usize> {
    raw: [Lane; D],
    moment: [[Lane; D]; D],
}

impl<const D: usize> Default for GradientSum<D> {
    fn default() -> Self {
        Self { raw: [Lane::ZERO; D], moment: [[Lane::ZERO; D]; D] }
    }
}

/// The law of the pass.
pub struct GradientLaw<'a, K, const D: usize> {
    /// Kernel.
    pub kernel: K,
    /// The fluid.
    pub fluid: &'a Shown<D>,
}

impl<K: Kernel<D>, const D: usize> PairLaw<D> for GradientLaw<'_, K, D> {
    /// Density.
    type Target = Lane;
    type Sum = GradientSum<D>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.fluid.position
    }
    #[inline(always)]
    fn target(&self, slot: usize) -> Self::Target {
        Lane::load(&self.fluid.density, slot)
    }
    #[inline(always)]
    fn source_positions(&self) -> &[Vec<f64>; D] {
        &self.fluid.position
    }
    #[inline(always)]
    fn add<A: Arch>(&self, i: &Self::Target, j: usize, dx: [Lane; D], r2: Lane, sum: &mut GradientSum<D>) {
        let f = self.kernel.gradient_over_r::<A>(distance(r2, self.kernel.smoothing_length()));
        let vf = Lane::splat(self.fluid.volume[j]) * f;
        let difference = vf * (Lane::splat(self.fluid.density[j]) - *i);
        for a in 0..D {
            sum.raw[a] = A::mul_add(difference, dx[a], sum.raw[a]);
            let row = -(vf * dx[a]);
            for b in a..D {
                sum.moment[a][b] = A::mul_add(row, dx[b], sum.moment[a][b]);
            }
        }
    }
}

/// Solves for the gradients of all slots.
pub fn solve<const D: usize>(sums: &[GradientSum<D>], gradient: &mut [Vec<f64>; D]) {
    for (d, column) in gradient.iter_mut().enumerate() {
        column.par_chunks_mut(LANES).zip(sums).with_min_len(128).for_each(|(values, sum)| {
            for (k, value) in values.iter_mut().enumerate() {
                let g: [f64; D] = renormalised(
                    std::array::from_fn(|a| sum.raw[a].0[k]),
                    std::array::from_fn(|a| std::array::from_fn(|b| sum.moment[a.min(b)][a.max(b)].0[k])),
                );
                *value = g[d];
            }
        });
    }
}

fn renormalised<const D: usize>(raw: [f64; D], moment: [[f64; D]; D]) -> [f64; D] {
    let m = SMatrix::<f64, D, D>::from_fn(|a, b| moment[a][b]);
    let determinant = halfstep_shared::tensor::determinant(&m);
    if determinant.is_nan() || determinant < SMALLEST_DETERMINANT {
        return [0.0; D];
    }
    match halfstep_shared::tensor::inverse(&m, determinant) {
        Some(l) => (l * SVector::from(raw)).into(),
        None => [0.0; D],
    }
}
