//! Pressure extrapolated to a boundary particle (Adami, Hu and Adams 2012, eq. 27; Kayaki's eq. 28):
//!   p_w = sum_j [ p_j + rho_j g . (x_w - x_j) ] W_wj / sum_j W_wj.

use crate::kernel::Kernel;
use crate::lane::{Arch, Lane, Lanes, components};
use crate::pair::{PairLaw, distance, dot, pair_sum};

/// The law of the pass over boundary particles.
#[derive(Clone, Copy)]
pub struct Extrapolation<'a, K, const D: usize> {
    /// Kernel.
    pub kernel: K,
    /// Gravity, m/s².
    pub gravity: [f64; D],
    /// Positions of the boundary particles, m.
    pub targets: &'a [Vec<f64>; D],
    /// Positions of the particles around, m.
    pub sources: &'a [Vec<f64>; D],
    /// Densities of the sources, kg/m³.
    pub density: &'a [f64],
    /// Pressures of the sources, Pa.
    pub pressure: &'a [f64],
}

/// Sums for several boundary particles: four where they are stored.
#[derive(Clone, Copy, Debug)]
pub struct ExtrapolationSum<L = Lane> {
    weight: L,
    pressure: L,
}
pair_sum!(ExtrapolationSum {} { weight, pressure });

impl ExtrapolationSum {
    /// Pressure of the k-th, Pa; `None` where nothing is around.
    pub fn pressure(&self, k: usize) -> Option<f64> {
        (self.weight.0[k] > 0.0).then(|| self.pressure.0[k] / self.weight.0[k])
    }

    /// sum W of the k-th.
    pub fn weight(&self, k: usize) -> f64 {
        self.weight.0[k]
    }
}

impl<L: Lanes> ExtrapolationSum<L> {
    /// Adds a pressure with a weight.
    #[inline(always)]
    pub fn add<A: Arch>(&mut self, weight: L, pressure: L) {
        self.weight += weight;
        self.pressure = A::mul_add(pressure, weight, self.pressure);
    }

    /// Adds a particle of this density and pressure; returns its weight W.
    #[inline(always)]
    pub fn add_particle<K: Kernel<D>, const D: usize, A: Arch>(
        &mut self,
        kernel: &K,
        gravity: [f64; D],
        pair: ([L; D], L),
        density: L,
        pressure: L,
    ) -> L {
        let (w, p) = weighted::<K, D, A, L>(kernel, gravity, pair, density, pressure);
        self.add::<A>(w, p);
        w
    }
}

/// W of a particle, and its pressure brought to the target's height.
#[inline(always)]
fn weighted<K: Kernel<D>, const D: usize, A: Arch, L: Lanes>(
    kernel: &K,
    gravity: [f64; D],
    (dx, r2): ([L; D], L),
    density: L,
    pressure: L,
) -> (L, L) {
    let w = kernel.value::<A, L>(distance(r2, kernel.smoothing_length()));
    let head = dot::<D, A, L>(components(|d| L::splat(gravity[d])), dx);
    (w, A::mul_add(density, head, pressure))
}

impl<K: Kernel<D>, const D: usize> Extrapolation<'_, K, D> {
    /// W of source `j`, and its pressure brought to the target's height.
    #[inline(always)]
    pub fn source<A: Arch, L: Lanes>(&self, j: usize, dx: [L; D], r2: L) -> (L, L) {
        let (density, pressure) = (L::splat(self.density[j]), L::splat(self.pressure[j]));
        weighted::<K, D, A, L>(&self.kernel, self.gravity, (dx, r2), density, pressure)
    }
}

impl<K: Kernel<D>, const D: usize> PairLaw<D> for Extrapolation<'_, K, D> {
    type Target<L: Lanes> = ();
    type Sum<L: Lanes> = ExtrapolationSum<L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.targets
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        components(|d| self.sources[d][j])
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), j: usize, dx: [L; D], r2: L, sum: &mut ExtrapolationSum<L>) {
        let (w, p) = self.source::<A, L>(j, dx, r2);
        sum.add::<A>(w, p);
    }
}
