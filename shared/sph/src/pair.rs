//! The one neighbour pass: every sum over neighbours in the program is a [`PairLaw`] run by [`pass`].
//!
//! Each target gathers over its own neighbours in list order, so the bits of a sum do not depend on the number of
//! threads. Several targets are computed at once; a source is broadcast to them; the kernel itself is the cut-off. What
//! the targets beside it have as neighbours adds zeros to a target's sum, so neither do the bits depend on how many are
//! computed at once.

use crate::columns::Vectors;
use crate::kernel::Kernel;
use crate::lane::{Arch, Eight, Fused, Isa, LANES, Lane, Lanes, Unfused};
use crate::neighbours::{CHUNK_FOURS, ClusterList};
use rayon::prelude::*;

/// A sum over neighbours.
pub trait PairLaw<const D: usize>: Sync {
    /// As many targets are computed at once as the processor can; else four: a law with more numbers for a target than
    /// registers gains nothing by more of them. Its list is made by [`ClusterList::new`], else by
    /// [`ClusterList::narrow`].
    const WIDE: bool = true;
    /// What is loaded of the targets before their neighbours are visited.
    type Target<L: Lanes>: Copy;
    /// What is summed up for the targets.
    type Sum<L: Lanes>: PairSum<L, Four = Self::Sum<Lane>> + Default;

    /// Positions of the targets.
    fn target_positions(&self) -> &[Vec<f64>; D];
    /// Position of source `j`.
    fn source_position(&self, j: usize) -> [f64; D];
    /// Loads what else is needed of the targets from `slot` on.
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L>;
    /// Adds the contribution of source `j`: `dx` = x_i - x_j, `r2` = |dx|².
    fn add<A: Arch, L: Lanes>(
        &self,
        target: &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut Self::Sum<L>,
    );
}

/// A law that computes four targets at once, over a list that others like it use.
pub struct Narrow<W>(pub W);

impl<const D: usize, W: PairLaw<D>> PairLaw<D> for Narrow<W> {
    const WIDE: bool = false;
    type Target<L: Lanes> = W::Target<L>;
    type Sum<L: Lanes> = W::Sum<L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.0.target_positions()
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.0.source_position(j)
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> W::Target<L> {
        self.0.target(slot)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, i: &W::Target<L>, j: usize, dx: [L; D], r2: L, sum: &mut W::Sum<L>) {
        self.0.add::<A, L>(i, j, dx, r2, sum);
    }
}

/// Sums of several targets, which are stored by fours; see [`pair_sum`].
pub trait PairSum<L>: Copy + Send {
    /// The sums of four targets.
    type Four: Copy + Send;
    /// The k-th four.
    fn four(&self, k: usize) -> Self::Four;
    /// From fours.
    fn of_fours(four: impl Fn(usize) -> Self::Four) -> Self;
}

impl<L: Lanes> PairSum<L> for L {
    type Four = Lane;
    #[inline(always)]
    fn four(&self, k: usize) -> Lane {
        Lanes::four(*self, k)
    }
    #[inline(always)]
    fn of_fours(four: impl Fn(usize) -> Lane) -> Self {
        <L as Lanes>::of_fours(four)
    }
}

impl<L, S: PairSum<L>, const N: usize> PairSum<L> for [S; N] {
    type Four = [S::Four; N];
    #[inline(always)]
    fn four(&self, k: usize) -> Self::Four {
        std::array::from_fn(|n| self[n].four(k))
    }
    #[inline(always)]
    fn of_fours(four: impl Fn(usize) -> Self::Four) -> Self {
        std::array::from_fn(|n| S::of_fours(|k| four(k)[n]))
    }
}

/// Makes a structure a [`PairSum`](crate::pair::PairSum): `pair_sum!(Name { constants } { fields });` for a
/// `Name<constants, L>` whose fields are sums themselves, `L` or arrays of it.
#[macro_export]
macro_rules! pair_sum {
    ($name:ident { $($constant:ident),* } { $($field:tt),+ }) => {
        impl<L: $crate::lane::Lanes, $(const $constant: usize),*> $crate::pair::PairSum<L>
            for $name<$($constant,)* L>
        {
            type Four = $name<$($constant,)* $crate::lane::Lane>;
            #[inline(always)]
            fn four(&self, k: usize) -> Self::Four {
                $name { $($field: $crate::pair::PairSum::<L>::four(&self.$field, k)),+ }
            }
            #[inline(always)]
            fn of_fours(four: impl Fn(usize) -> Self::Four) -> Self {
                $name { $($field: $crate::pair::PairSum::<L>::of_fours(|k| four(k).$field)),+ }
            }
        }
    };
}
pub use pair_sum;

/// What becomes of the sum over the neighbours of four targets.
trait Sink<F>: Copy + Sync {
    /// Where it goes.
    type Out: Send;
    /// What the sum begins with.
    fn begin(self, out: &Self::Out) -> F;
    /// Takes the sum of the targets that begin at `slot`.
    fn end(self, slot: usize, sum: F, out: &mut Self::Out);
}

/// The sum takes the place of what was there.
#[derive(Clone, Copy)]
struct Replace<G>(G);

impl<F: Default, T: Send, G: Fn(usize, &F) -> T + Copy + Sync> Sink<F> for Replace<G> {
    type Out = T;
    #[inline(always)]
    fn begin(self, _: &T) -> F {
        F::default()
    }
    #[inline(always)]
    fn end(self, slot: usize, sum: F, out: &mut T) {
        *out = (self.0)(slot, &sum);
    }
}

/// The sum goes on from what was there.
#[derive(Clone, Copy)]
struct Add;

impl<F: Copy + Send> Sink<F> for Add {
    type Out = F;
    #[inline(always)]
    fn begin(self, out: &F) -> F {
        *out
    }
    #[inline(always)]
    fn end(self, _: usize, sum: F, out: &mut F) {
        *out = sum;
    }
}

/// A law with the list of its pairs, or several, each of which adds to the same sum in its turn.
trait Work<const D: usize>: Copy + Sync {
    /// See [`PairLaw::WIDE`].
    const WIDE: bool;
    /// What is summed up.
    type Sum<L: Lanes>: PairSum<L, Four = Self::Sum<Lane>> + Default;
    /// The list.
    fn list(&self) -> &ClusterList;
    /// Adds up the neighbours of the cluster number `k` of a chunk, whose targets begin at `slot`.
    fn gather<A: Arch, L: Lanes>(self, chunk: usize, k: usize, slot: usize, sum: &mut Self::Sum<L>);
}

impl<const D: usize, W: PairLaw<D>> Work<D> for (&W, &ClusterList) {
    const WIDE: bool = W::WIDE;
    type Sum<L: Lanes> = W::Sum<L>;
    fn list(&self) -> &ClusterList {
        self.1
    }
    #[inline(always)]
    fn gather<A: Arch, L: Lanes>(self, chunk: usize, k: usize, slot: usize, sum: &mut W::Sum<L>) {
        let (law, list) = self;
        let neighbours = list.chunks()[chunk].of(k);
        if neighbours.is_empty() {
            return;
        }
        let positions = law.target_positions();
        // By way of memory: of a vector put together from scalars the compiler keeps some apart through the whole loop,
        // and one that ends in fours it computes by fours.
        let target = std::hint::black_box(law.target::<L>(slot));
        let xi: [L; D] = std::hint::black_box(std::array::from_fn(|d| L::load(&positions[d], slot)));
        let mut total = *sum;
        for &j in neighbours {
            let j = j as usize;
            let xj = law.source_position(j);
            let mut dx = [L::ZERO; D];
            let mut r2 = L::ZERO;
            for d in 0..D {
                dx[d] = xi[d] - L::splat(xj[d]);
                r2 = A::mul_add(dx[d], dx[d], r2);
            }
            law.add::<A, L>(&target, j, dx, r2, &mut total);
        }
        *sum = std::hint::black_box(total);
    }
}

/// A sum over neighbours that stay where they are to each other: what depends on their distance alone is computed once.
pub trait FixedLaw<const D: usize>: Sync {
    /// What is loaded of the targets before their neighbours are visited.
    type Target<L: Lanes>: Copy;
    /// What is summed up for the targets.
    type Sum<L: Lanes>: PairSum<L, Four = Self::Sum<Lane>> + Default;

    /// Loads the targets from `slot` on.
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L>;
    /// Adds the contribution of source `j`: `dx` = x_i - x_j, `slope` = F(r).
    fn add<A: Arch, L: Lanes>(
        &self,
        target: &Self::Target<L>,
        j: usize,
        dx: [L; D],
        slope: L,
        sum: &mut Self::Sum<L>,
    );
}

/// Positions that do not change, with their neighbours and the kernel's slopes F between them.
pub struct FixedPairs<const D: usize> {
    position: Vectors<D>,
    list: ClusterList,
    /// By chunk, in the list's order: as many fours for each source as a cluster has.
    slopes: Vec<Vec<Lane>>,
}

/// Where the slope of a pair is kept.
struct Place {
    chunk: usize,
    four: usize,
    lane: usize,
}

impl<const D: usize> FixedPairs<D> {
    /// Of a narrow list among these positions.
    pub fn new<K: Kernel<D>>(isa: Isa, kernel: K, position: Vectors<D>, list: ClusterList) -> Self {
        let mut pairs = Self { position, list, slopes: Vec::new() };
        let fused = isa.min(Isa::detect()) != Isa::Baseline;
        let fours = pairs.list.width() / LANES;
        for (c, chunk) in pairs.list.chunks().iter().enumerate() {
            let clusters = pairs.list.clusters_of(c);
            let slopes = clusters.enumerate().flat_map(|(k, cluster)| {
                let pairs = &pairs;
                let all = chunk.of(k).iter().flat_map(move |&j| (0..fours).map(move |four| (four, j)));
                all.map(move |(four, j)| {
                    let slot = cluster * pairs.list.width() + four * LANES;
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
        let width = list.width();
        for (c, (chunk, slopes)) in list.chunks().iter().zip(slopes).enumerate() {
            let clusters = list.clusters_of(c).enumerate();
            let pairs = clusters.flat_map(|(k, cluster)| chunk.of(k).iter().map(move |&j| (cluster, j)));
            for ((cluster, j), fours) in pairs.zip(slopes.chunks_mut(width / LANES)) {
                for lane in 0..width {
                    if apart(cluster * width + lane, j as usize) {
                        fours[lane / LANES].0[lane % LANES] = 0.0;
                    }
                }
            }
        }
    }

    /// Where the slope of a pair is kept, by its slots.
    fn place(&self, i: usize, j: usize) -> Option<Place> {
        let (chunk, neighbours, first) = self.list.place(i);
        let entry = first + neighbours.iter().position(|&k| k as usize == j)?;
        let (four, lane) = self.four_of(entry, i);
        Some(Place { chunk, four, lane })
    }

    /// The four, and the number in it, that keeps the slope of an entry of the list for a slot.
    fn four_of(&self, entry: usize, slot: usize) -> (usize, usize) {
        let width = self.list.width();
        (entry * (width / LANES) + slot % width / LANES, slot % LANES)
    }

    /// Cuts a pair, by its slots: it has no slope from now on, whichever of the two asks.
    pub fn cut(&mut self, i: usize, j: usize) {
        for (i, j) in [(i, j), (j, i)] {
            if let Some(Place { chunk, four, lane }) = self.place(i, j) {
                self.slopes[chunk][four].0[lane] = 0.0;
            }
        }
    }

    /// Slots of the neighbours that a slot is not cut off from, in the list's order, with the slopes F.
    pub fn neighbours(&self, slot: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (chunk, neighbours, first) = self.list.place(slot);
        let slopes = &self.slopes[chunk];
        let pairs = neighbours.iter().enumerate().map(move |(n, &j)| {
            let (four, lane) = self.four_of(first + n, slot);
            (j as usize, slopes[four].0[lane])
        });
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
    fn apart<L: Lanes>(&self, xi: &[L; D], j: usize) -> [L; D] {
        std::array::from_fn(|d| xi[d] - L::splat(self.position[d][j]))
    }

    #[inline(always)]
    fn at<L: Lanes>(&self, slot: usize) -> [L; D] {
        std::array::from_fn(|d| L::load(&self.position[d], slot))
    }

    fn slope<K: Kernel<D>, A: Arch>(&self, kernel: K, slot: usize, j: u32) -> Lane {
        let dx = self.apart::<Lane>(&self.at(slot), j as usize);
        let r2 = dx.iter().fold(Lane::ZERO, |r2, &dx| A::mul_add(dx, dx, r2));
        kernel.gradient_over_r::<A, Lane>(distance(r2, kernel.smoothing_length()))
    }
}

struct OverFixed<'a, W, const D: usize>(&'a W, &'a FixedPairs<D>);

impl<W, const D: usize> Clone for OverFixed<'_, W, D> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<W, const D: usize> Copy for OverFixed<'_, W, D> {}

impl<const D: usize, W: FixedLaw<D>> Work<D> for OverFixed<'_, W, D> {
    // Eight of one row have nearly as long a list as twice four, and eight slopes to load for each entry.
    const WIDE: bool = false;
    type Sum<L: Lanes> = W::Sum<L>;
    fn list(&self) -> &ClusterList {
        &self.1.list
    }
    #[inline(always)]
    fn gather<A: Arch, L: Lanes>(self, chunk: usize, k: usize, slot: usize, sum: &mut W::Sum<L>) {
        let Self(law, pairs) = self;
        let (neighbours, first) = pairs.list.chunks()[chunk].range(k);
        let target = std::hint::black_box(law.target::<L>(slot));
        let xi = std::hint::black_box(pairs.at::<L>(slot));
        let fours = L::TARGETS / LANES;
        let mut total = *sum;
        for (&j, slopes) in neighbours.iter().zip(pairs.slopes[chunk][first * fours..].chunks_exact(fours)) {
            let dx = pairs.apart(&xi, j as usize);
            law.add::<A, L>(&target, j as usize, dx, L::of_fours(|k| slopes[k]), &mut total);
        }
        *sum = std::hint::black_box(total);
    }
}

/// Runs a law over all of fixed pairs; `sums` has one entry for each four targets.
pub fn fixed_pass<const D: usize, W: FixedLaw<D>>(
    isa: Isa,
    law: &W,
    pairs: &FixedPairs<D>,
    sums: &mut [W::Sum<Lane>],
) {
    run_chunks(isa, OverFixed(law, pairs), Replace(|_, sum: &W::Sum<Lane>| *sum), sums);
}

/// One law over two sets of neighbours; the second goes on from the sum of the first.
struct Both<'a, W>([(&'a W, &'a ClusterList); 2]);

impl<W> Clone for Both<'_, W> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<W> Copy for Both<'_, W> {}

impl<const D: usize, W: PairLaw<D>> Work<D> for Both<'_, W> {
    const WIDE: bool = W::WIDE;
    type Sum<L: Lanes> = W::Sum<L>;
    fn list(&self) -> &ClusterList {
        let [(_, first), (_, second)] = self.0;
        assert_eq!((first.fours(), first.width()), (second.fours(), second.width()), "of the same targets");
        first
    }
    #[inline(always)]
    fn gather<A: Arch, L: Lanes>(self, chunk: usize, k: usize, slot: usize, sum: &mut W::Sum<L>) {
        let [first, second] = self.0;
        first.gather::<A, L>(chunk, k, slot, sum);
        second.gather::<A, L>(chunk, k, slot, sum);
    }
}

/// Runs a law over all targets of a list; `sums` has one entry for each four of them.
pub fn pass<const D: usize, W: PairLaw<D>>(isa: Isa, law: &W, list: &ClusterList, sums: &mut [W::Sum<Lane>]) {
    run_chunks(isa, (law, list), Replace(|_, sum: &W::Sum<Lane>| *sum), sums);
}

/// The pass, adding to what `sums` holds.
pub fn pass_adding<const D: usize, W: PairLaw<D>>(
    isa: Isa,
    law: &W,
    list: &ClusterList,
    sums: &mut [W::Sum<Lane>],
) {
    run_chunks(isa, (law, list), Add, sums);
}

/// The pass; the sum of each four goes through `finish`, with the first of its slots, before it is stored.
pub fn pass_into<const D: usize, W: PairLaw<D>, T: Send>(
    isa: Isa,
    law: &W,
    list: &ClusterList,
    finish: impl Fn(usize, &W::Sum<Lane>) -> T + Copy + Sync,
    out: &mut [T],
) {
    run_chunks(isa, (law, list), Replace(finish), out);
}

/// The same over two sets of neighbours, the second after the first.
pub fn pass_both_into<const D: usize, W: PairLaw<D>, T: Send>(
    isa: Isa,
    first: (&W, &ClusterList),
    second: (&W, &ClusterList),
    finish: impl Fn(usize, &W::Sum<Lane>) -> T + Copy + Sync,
    out: &mut [T],
) {
    run_chunks(isa, Both([first, second]), Replace(finish), out);
}

fn run_chunks<const D: usize, W: Work<D>, S: Sink<W::Sum<Lane>>>(
    isa: Isa,
    work: W,
    sink: S,
    out: &mut [S::Out],
) {
    let list = work.list();
    assert_eq!(out.len(), list.fours(), "one sum for each four targets");
    // Never more than the processor has: that is what makes the calls below safe.
    let isa = isa.min(Isa::detect());
    let width = if W::WIDE { isa.targets() } else { LANES };
    assert_eq!(list.width(), width, "the list's clusters are as wide as the passes");
    if out.len() <= CHUNK_FOURS {
        if !out.is_empty() {
            run_chunk(isa, work, 0, sink, out);
        }
        return;
    }
    out.par_chunks_mut(CHUNK_FOURS).enumerate().for_each(|(c, out)| run_chunk(isa, work, c, sink, out));
}

fn run_chunk<const D: usize, W: Work<D>, S: Sink<W::Sum<Lane>>>(
    isa: Isa,
    work: W,
    chunk: usize,
    sink: S,
    out: &mut [S::Out],
) {
    match isa {
        // SAFETY: `run_chunks` asked the processor.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512vl if W::WIDE => unsafe { run_avx512::<D, W, S, Eight>(work, chunk, sink, out) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512vl => unsafe { run_avx512::<D, W, S, Lane>(work, chunk, sink, out) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => unsafe { run_avx2(work, chunk, sink, out) },
        _ => run::<D, W, S, Unfused, Lane>(work, chunk, sink, out),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,fma")]
unsafe fn run_avx512<const D: usize, W: Work<D>, S: Sink<W::Sum<Lane>>, L: Lanes>(
    work: W,
    chunk: usize,
    sink: S,
    out: &mut [S::Out],
) {
    run::<D, W, S, Fused, L>(work, chunk, sink, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn run_avx2<const D: usize, W: Work<D>, S: Sink<W::Sum<Lane>>>(
    work: W,
    chunk: usize,
    sink: S,
    out: &mut [S::Out],
) {
    run::<D, W, S, Fused, Lane>(work, chunk, sink, out);
}

#[inline(always)]
fn run<const D: usize, W: Work<D>, S: Sink<W::Sum<Lane>>, A: Arch, L: Lanes>(
    work: W,
    chunk: usize,
    sink: S,
    out: &mut [S::Out],
) {
    for (k, out) in out.chunks_exact_mut(L::TARGETS / LANES).enumerate() {
        let slot = chunk * CHUNK_FOURS * LANES + k * L::TARGETS;
        let mut sum = W::Sum::<L>::of_fours(|four| sink.begin(&out[four]));
        work.gather::<A, L>(chunk, k, slot, &mut sum);
        for (four, out) in out.iter_mut().enumerate() {
            sink.end(slot + four * LANES, sum.four(four), out);
        }
    }
}

/// A distance from its square that is never zero: a pair at one place (a particle with itself, or two coincident ones)
/// has finite kernel slopes and, as x_ij = 0, no force.
#[inline(always)]
pub fn distance<L: Lanes>(r2: L, smoothing_length: f64) -> L {
    (r2 + L::splat(1e-12 * smoothing_length * smoothing_length)).sqrt()
}

/// Scalar products of two vectors for each target.
#[inline(always)]
pub fn dot<const D: usize, A: Arch, L: Lanes>(a: [L; D], b: [L; D]) -> L {
    let mut sum = a[0] * b[0];
    for d in 1..D {
        sum = A::mul_add(a[d], b[d], sum);
    }
    sum
}
