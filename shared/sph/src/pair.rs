//! The one neighbour pass: every sum over neighbours in the program is a [`PairLaw`] run by [`pass`].
//!
//! Each target gathers over its own neighbours in list order, so the bits of a sum do not depend on the number of
//! threads. Four targets are computed at once; a source is broadcast to them; the kernel itself is the cut-off.

use crate::columns::Vectors;
use crate::kernel::Kernel;
use crate::lane::{Arch, Fused, Isa, LANES, Lane, Unfused};
use crate::neighbours::{CHUNK_CLUSTERS, ClusterList};
use rayon::prelude::*;

/// A sum over neighbours.
pub trait PairLaw<const D: usize>: Sync {
    /// What is loaded of four targets before their neighbours are visited.
    type Target: Copy;
    /// What is summed up for four targets.
    type Sum: Copy + Default + Send;

    /// Positions of the targets.
    fn target_positions(&self) -> &[Vec<f64>; D];
    /// Position of source `j`.
    fn source_position(&self, j: usize) -> [f64; D];
    /// Loads what else is needed of the targets at `slot..slot + 4`.
    fn target(&self, slot: usize) -> Self::Target;
    /// Adds the contribution of source `j`: `dx` = x_i - x_j, `r2` = |dx|².
    fn add<A: Arch>(&self, target: &Self::Target, j: usize, dx: [Lane; D], r2: Lane, sum: &mut Self::Sum);
}

/// What becomes of the sum over a cluster's neighbours.
trait Sink<S>: Copy + Sync {
    /// Where it goes.
    type Out: Send;
    /// What the sum begins with.
    fn begin(self, out: &Self::Out) -> S;
    /// Takes the sum of the targets that begin at `slot`.
    fn end(self, slot: usize, sum: S, out: &mut Self::Out);
}

/// The sum takes the place of what was there.
#[derive(Clone, Copy)]
struct Replace<F>(F);

impl<S: Default, T: Send, F: Fn(usize, &S) -> T + Copy + Sync> Sink<S> for Replace<F> {
    type Out = T;
    #[inline(always)]
    fn begin(self, _: &T) -> S {
        S::default()
    }
    #[inline(always)]
    fn end(self, slot: usize, sum: S, out: &mut T) {
        *out = (self.0)(slot, &sum);
    }
}

/// The sum goes on from what was there.
#[derive(Clone, Copy)]
struct Add;

impl<S: Copy + Send> Sink<S> for Add {
    type Out = S;
    #[inline(always)]
    fn begin(self, out: &S) -> S {
        *out
    }
    #[inline(always)]
    fn end(self, _: usize, sum: S, out: &mut S) {
        *out = sum;
    }
}

/// A law with the list of its pairs, or several, each of which adds to the same sum in its turn.
trait Work<const D: usize>: Copy + Sync {
    /// What is summed up.
    type Sum: Copy + Default + Send;
    /// Number of clusters of targets.
    fn clusters(self) -> usize;
    /// Adds up the neighbours of the cluster number `k` of a chunk, whose targets begin at `slot`.
    fn gather<A: Arch>(self, chunk: usize, k: usize, slot: usize, sum: &mut Self::Sum);
}

impl<const D: usize, L: PairLaw<D>> Work<D> for (&L, &ClusterList) {
    type Sum = L::Sum;
    fn clusters(self) -> usize {
        self.1.clusters()
    }
    #[inline(always)]
    fn gather<A: Arch>(self, chunk: usize, k: usize, slot: usize, sum: &mut L::Sum) {
        let (law, list) = self;
        let neighbours = list.chunks()[chunk].of(k);
        if neighbours.is_empty() {
            return;
        }
        let positions = law.target_positions();
        // By way of memory: of a vector put together from scalars the compiler keeps some apart through the whole loop.
        let target = std::hint::black_box(law.target(slot));
        let xi: [Lane; D] = std::array::from_fn(|d| Lane::load(&positions[d], slot));
        let mut total = *sum;
        for &j in neighbours {
            let j = j as usize;
            let xj = law.source_position(j);
            let mut dx = [Lane::ZERO; D];
            let mut r2 = Lane::ZERO;
            for d in 0..D {
                dx[d] = xi[d] - Lane::splat(xj[d]);
                r2 = A::mul_add(dx[d], dx[d], r2);
            }
            law.add::<A>(&target, j, dx, r2, &mut total);
        }
        *sum = total;
    }
}

/// A sum over neighbours that stay where they are to each other: what depends on their distance alone is computed once.
pub trait FixedLaw<const D: usize>: Sync {
    /// What is loaded of four targets before their neighbours are visited.
    type Target: Copy;
    /// What is summed up for four targets.
    type Sum: Copy + Default + Send;

    /// Loads the targets at `slot..slot + 4`.
    fn target(&self, slot: usize) -> Self::Target;
    /// Adds the contribution of source `j`: `dx` = x_i - x_j, `slope` = F(r).
    fn add<A: Arch>(&self, target: &Self::Target, j: usize, dx: [Lane; D], slope: Lane, sum: &mut Self::Sum);
}

/// Positions that do not change, with their neighbours and the kernel's slopes F between them.
pub struct FixedPairs<const D: usize> {
    position: Vectors<D>,
    list: ClusterList,
    /// By chunk, in the list's order.
    slopes: Vec<Vec<Lane>>,
}

impl<const D: usize> FixedPairs<D> {
    /// Of a list among these positions.
    pub fn new<K: Kernel<D>>(isa: Isa, kernel: K, position: Vectors<D>, list: ClusterList) -> Self {
        let mut pairs = Self { position, list, slopes: Vec::new() };
        let fused = isa.min(Isa::detect()) != Isa::Baseline;
        for (c, chunk) in pairs.list.chunks().iter().enumerate() {
            let clusters = (c * CHUNK_CLUSTERS..pairs.list.clusters()).take(CHUNK_CLUSTERS);
            let slopes = clusters.enumerate().flat_map(|(k, cluster)| {
                let pairs = &pairs;
                chunk.of(k).iter().map(move |&j| {
                    let slot = cluster * LANES;
                    if fused {
                        pairs.slope::<K, Fused>(kernel, slot, j)
                    } else {
                        pairs.slope::<K, Unfused>(kernel, slot, j)
                    }
                })
            });
            let slopes = slopes.collect();
            pairs.slopes.push(slopes);
        }
        pairs
    }

    /// Takes the pairs apart, by their slots, for which `apart` holds: their slopes become zero.
    pub fn part(&mut self, apart: impl Fn(usize, usize) -> bool) {
        let Self { list, slopes, .. } = self;
        for (c, (chunk, slopes)) in list.chunks().iter().zip(slopes).enumerate() {
            let clusters = (c * CHUNK_CLUSTERS..list.clusters()).take(CHUNK_CLUSTERS).enumerate();
            let pairs = clusters.flat_map(|(k, cluster)| chunk.of(k).iter().map(move |&j| (cluster, j)));
            for ((cluster, j), slope) in pairs.zip(slopes) {
                for lane in 0..LANES {
                    if apart(cluster * LANES + lane, j as usize) {
                        slope.0[lane] = 0.0;
                    }
                }
            }
        }
    }

    /// Where the slope of a pair is kept, by its slots.
    fn place(&self, i: usize, j: usize) -> Option<(usize, usize)> {
        let cluster = i / LANES;
        let c = cluster / CHUNK_CLUSTERS;
        let (neighbours, first) = self.list.chunks()[c].range(cluster % CHUNK_CLUSTERS);
        Some((c, first + neighbours.iter().position(|&k| k as usize == j)?))
    }

    /// Cuts a pair, by its slots: it has no slope from now on, whichever of the two asks.
    pub fn cut(&mut self, i: usize, j: usize) {
        for (i, j) in [(i, j), (j, i)] {
            if let Some((c, entry)) = self.place(i, j) {
                self.slopes[c][entry].0[i % LANES] = 0.0;
            }
        }
    }

    /// Slots of the neighbours that a slot is not cut off from, in the list's order, with the slopes F.
    pub fn neighbours(&self, slot: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let cluster = slot / LANES;
        let c = cluster / CHUNK_CLUSTERS;
        let (neighbours, first) = self.list.chunks()[c].range(cluster % CHUNK_CLUSTERS);
        let slopes = &self.slopes[c][first..];
        let slopes = slopes.iter().map(move |slope| slope.0[slot % LANES]);
        let pairs = neighbours.iter().map(|&j| j as usize).zip(slopes);
        pairs.filter(move |&(j, slope)| j != slot && slope != 0.0)
    }

    /// The positions.
    pub fn position(&self) -> &Vectors<D> {
        &self.position
    }

    /// The list.
    pub fn list(&self) -> &ClusterList {
        &self.list
    }

    #[inline(always)]
    fn apart(&self, xi: &[Lane; D], j: usize) -> [Lane; D] {
        std::array::from_fn(|d| xi[d] - Lane::splat(self.position[d][j]))
    }

    #[inline(always)]
    fn at(&self, slot: usize) -> [Lane; D] {
        std::array::from_fn(|d| Lane::load(&self.position[d], slot))
    }

    fn slope<K: Kernel<D>, A: Arch>(&self, kernel: K, slot: usize, j: u32) -> Lane {
        let dx = self.apart(&self.at(slot), j as usize);
        let r2 = dx.iter().fold(Lane::ZERO, |r2, &dx| A::mul_add(dx, dx, r2));
        kernel.gradient_over_r::<A>(distance(r2, kernel.smoothing_length()))
    }
}

struct OverFixed<'a, L, const D: usize>(&'a L, &'a FixedPairs<D>);

impl<L, const D: usize> Clone for OverFixed<'_, L, D> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<L, const D: usize> Copy for OverFixed<'_, L, D> {}

impl<const D: usize, L: FixedLaw<D>> Work<D> for OverFixed<'_, L, D> {
    type Sum = L::Sum;
    fn clusters(self) -> usize {
        self.1.list.clusters()
    }
    #[inline(always)]
    fn gather<A: Arch>(self, chunk: usize, k: usize, slot: usize, sum: &mut L::Sum) {
        let Self(law, pairs) = self;
        let (neighbours, first) = pairs.list.chunks()[chunk].range(k);
        let (target, xi) = (law.target(slot), pairs.at(slot));
        let mut total = *sum;
        for (&j, &slope) in neighbours.iter().zip(&pairs.slopes[chunk][first..]) {
            let dx = pairs.apart(&xi, j as usize);
            law.add::<A>(&target, j as usize, dx, slope, &mut total);
        }
        *sum = total;
    }
}

/// Runs a law over all of fixed pairs; `sums` has one entry for each cluster.
pub fn fixed_pass<const D: usize, L: FixedLaw<D>>(
    isa: Isa,
    law: &L,
    pairs: &FixedPairs<D>,
    sums: &mut [L::Sum],
) {
    run_chunks(isa, OverFixed(law, pairs), Replace(|_, sum: &L::Sum| *sum), sums);
}

/// The second goes on from the sum of the first.
#[derive(Clone, Copy)]
struct Then<V, W>(V, W);

impl<const D: usize, V: Work<D>, W: Work<D, Sum = V::Sum>> Work<D> for Then<V, W> {
    type Sum = V::Sum;
    fn clusters(self) -> usize {
        assert_eq!(self.0.clusters(), self.1.clusters(), "both lists are of the same targets");
        self.0.clusters()
    }
    #[inline(always)]
    fn gather<A: Arch>(self, chunk: usize, k: usize, slot: usize, sum: &mut V::Sum) {
        self.0.gather::<A>(chunk, k, slot, sum);
        self.1.gather::<A>(chunk, k, slot, sum);
    }
}

/// Runs a law over all targets of a list; `sums` has one entry for each cluster.
pub fn pass<const D: usize, L: PairLaw<D>>(isa: Isa, law: &L, list: &ClusterList, sums: &mut [L::Sum]) {
    run_chunks(isa, (law, list), Replace(|_, sum: &L::Sum| *sum), sums);
}

/// The pass, adding to what `sums` holds.
pub fn pass_adding<const D: usize, L: PairLaw<D>>(
    isa: Isa,
    law: &L,
    list: &ClusterList,
    sums: &mut [L::Sum],
) {
    run_chunks(isa, (law, list), Add, sums);
}

/// The pass; each cluster's sum goes through `finish`, with the first of its slots, before it is stored.
pub fn pass_into<const D: usize, L: PairLaw<D>, T: Send>(
    isa: Isa,
    law: &L,
    list: &ClusterList,
    finish: impl Fn(usize, &L::Sum) -> T + Copy + Sync,
    out: &mut [T],
) {
    run_chunks(isa, (law, list), Replace(finish), out);
}

/// The same over two sets of neighbours, the second after the first.
pub fn pass_both_into<const D: usize, L: PairLaw<D>, M: PairLaw<D, Sum = L::Sum>, T: Send>(
    isa: Isa,
    first: (&L, &ClusterList),
    second: (&M, &ClusterList),
    finish: impl Fn(usize, &L::Sum) -> T + Copy + Sync,
    out: &mut [T],
) {
    run_chunks(isa, Then(first, second), Replace(finish), out);
}

fn run_chunks<const D: usize, W: Work<D>, S: Sink<W::Sum>>(isa: Isa, work: W, sink: S, out: &mut [S::Out]) {
    assert_eq!(out.len(), work.clusters(), "one sum for each cluster");
    // Never more than the processor has: that is what makes the calls below safe.
    let isa = isa.min(Isa::detect());
    if out.len() <= CHUNK_CLUSTERS {
        if !out.is_empty() {
            run_chunk(isa, work, 0, sink, out);
        }
        return;
    }
    out.par_chunks_mut(CHUNK_CLUSTERS).enumerate().for_each(|(c, out)| run_chunk(isa, work, c, sink, out));
}

fn run_chunk<const D: usize, W: Work<D>, S: Sink<W::Sum>>(
    isa: Isa,
    work: W,
    chunk: usize,
    sink: S,
    out: &mut [S::Out],
) {
    match isa {
        // SAFETY: `run_chunks` asked the processor.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512vl => unsafe { run_avx512vl(work, chunk, sink, out) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => unsafe { run_avx2(work, chunk, sink, out) },
        _ => run::<D, W, S, Unfused>(work, chunk, sink, out),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
unsafe fn run_avx512vl<const D: usize, W: Work<D>, S: Sink<W::Sum>>(
    work: W,
    chunk: usize,
    sink: S,
    out: &mut [S::Out],
) {
    run::<D, W, S, Fused>(work, chunk, sink, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn run_avx2<const D: usize, W: Work<D>, S: Sink<W::Sum>>(
    work: W,
    chunk: usize,
    sink: S,
    out: &mut [S::Out],
) {
    run::<D, W, S, Fused>(work, chunk, sink, out);
}

#[inline(always)]
fn run<const D: usize, W: Work<D>, S: Sink<W::Sum>, A: Arch>(
    work: W,
    chunk: usize,
    sink: S,
    out: &mut [S::Out],
) {
    for (k, out) in out.iter_mut().enumerate() {
        let slot = (chunk * CHUNK_CLUSTERS + k) * LANES;
        let mut sum = sink.begin(out);
        work.gather::<A>(chunk, k, slot, &mut sum);
        sink.end(slot, sum, out);
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
