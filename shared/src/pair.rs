//! The one neighbour pass: every sum over neighbours in the program is a [`PairLaw`] run by [`pass`].
//!
//! Each target gathers over its own neighbours in list order, so the bits of a sum do not depend on the number of
//! threads. Four targets are computed at once; a source is broadcast to them; the kernel itself is the cut-off.

use crate::lane::{Arch, Fused, Isa, LANES, Lane, Unfused};
use crate::neighbours::{CHUNK_CLUSTERS, Chunk, ClusterList};
use rayon::prelude::*;

/// A sum over neighbours.
pub trait PairLaw<const D: usize>: Sync {
    /// What is loaded of four targets before their neighbours are visited.
    type Target: Copy;
    /// What is summed up for four targets.
    type Sum: Copy + Default + Send;

    /// Positions of the targets.
    fn target_positions(&self) -> &[Vec<f64>; D];
    /// Positions of the sources.
    fn source_positions(&self) -> &[Vec<f64>; D];
    /// Loads what else is needed of the targets at `slot..slot + 4`.
    fn target(&self, slot: usize) -> Self::Target;
    /// Adds the contribution of source `j`: `dx` = x_i - x_j, `r2` = |dx|².
    fn add<A: Arch>(&self, target: &Self::Target, j: usize, dx: [Lane; D], r2: Lane, sum: &mut Self::Sum);
}

/// Runs a law over all targets of a list; `sums` has one entry for each cluster.
pub fn pass<const D: usize, L: PairLaw<D>>(isa: Isa, law: &L, list: &ClusterList, sums: &mut [L::Sum]) {
    assert_eq!(sums.len(), list.clusters(), "one sum for each cluster");
    if let ([chunk], true) = (list.chunks(), sums.len() <= CHUNK_CLUSTERS) {
        return run_chunk(isa, law, 0, chunk, sums);
    }
    sums.par_chunks_mut(CHUNK_CLUSTERS).zip(list.chunks()).enumerate().for_each(|(c, (sums, chunk))| {
        run_chunk(isa, law, c * CHUNK_CLUSTERS * LANES, chunk, sums);
    });
}

fn run_chunk<const D: usize, L: PairLaw<D>>(
    isa: Isa,
    law: &L,
    first_slot: usize,
    chunk: &Chunk,
    sums: &mut [L::Sum],
) {
    match isa {
        // SAFETY: `Isa::detect` is the only source of these values in a run and asked the processor.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512vl => unsafe { run_avx512vl(law, first_slot, chunk, sums) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => unsafe { run_avx2(law, first_slot, chunk, sums) },
        _ => run::<D, L, Unfused>(law, first_slot, chunk, sums),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
unsafe fn run_avx512vl<const D: usize, L: PairLaw<D>>(
    law: &L,
    slot: usize,
    chunk: &Chunk,
    sums: &mut [L::Sum],
) {
    run::<D, L, Fused>(law, slot, chunk, sums);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn run_avx2<const D: usize, L: PairLaw<D>>(law: &L, slot: usize, chunk: &Chunk, sums: &mut [L::Sum]) {
    run::<D, L, Fused>(law, slot, chunk, sums);
}

#[inline(always)]
fn run<const D: usize, L: PairLaw<D>, A: Arch>(
    law: &L,
    first_slot: usize,
    chunk: &Chunk,
    sums: &mut [L::Sum],
) {
    let (positions, sources) = (law.target_positions(), law.source_positions());
    for (k, out) in sums.iter_mut().enumerate() {
        let neighbours = chunk.of(k);
        if neighbours.is_empty() {
            *out = L::Sum::default();
            continue;
        }
        let slot = first_slot + k * LANES;
        let target = law.target(slot);
        let xi: [Lane; D] = std::array::from_fn(|d| Lane::load(&positions[d], slot));
        let mut sum = L::Sum::default();
        for &j in neighbours {
            let j = j as usize;
            let mut dx = [Lane::ZERO; D];
            let mut r2 = Lane::ZERO;
            for d in 0..D {
                dx[d] = xi[d] - Lane::splat(sources[d][j]);
                r2 = A::mul_add(dx[d], dx[d], r2);
            }
            law.add::<A>(&target, j, dx, r2, &mut sum);
        }
        *out = sum;
    }
}

/// A distance from its square that is never zero: a pair at one place (a particle with itself, or two coincident ones)
/// has finite kernel slopes and, as x_ij = 0, no force.
#[inline(always)]
pub fn distance(r2: Lane, smoothing_length: f64) -> Lane {
    (r2 + Lane::splat(1e-12 * smoothing_length * smoothing_length)).sqrt()
}

/// Scalar product of two vectors of lanes.
#[inline(always)]
pub fn dot<const D: usize, A: Arch>(a: [Lane; D], b: [Lane; D]) -> Lane {
    let mut sum = a[0] * b[0];
    for d in 1..D {
        sum = A::mul_add(a[d], b[d], sum);
    }
    sum
}
