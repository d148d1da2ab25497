//! The pass over neighbours that stay where they are to each other: those of a reference configuration.

use super::{PairSum, Replace, Work, distance, run_tasks};
use crate::columns::Vectors;
use crate::kernel::Kernel;
use crate::lane::{Arch, Fused, Isa, LANES, Lane, Lanes, Unfused, components};
use crate::neighbours::ClusterList;

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
    /// The list's entries by chunk, side by side with the slopes: their pass is the shortest of all.
    entries: Vec<Vec<u32>>,
    /// By chunk, in the list's order.
    slopes: Vec<Vec<Lane>>,
}

impl<const D: usize> FixedPairs<D> {
    /// Of a list of fours ([`ClusterList::narrow`]) among these positions.
    pub fn new<K: Kernel<D>>(isa: Isa, kernel: K, position: Vectors<D>, list: ClusterList) -> Self {
        let mut pairs = Self { position, list, entries: Vec::new(), slopes: Vec::new() };
        let fused = isa.min(Isa::detect()) != Isa::Baseline;
        for (c, chunk) in pairs.list.chunks().iter().enumerate() {
            let slopes = pairs.list.clusters_of(c).enumerate().flat_map(|(k, cluster)| {
                let pairs = &pairs;
                chunk.of(k).map(move |j| {
                    let slot = cluster * LANES;
                    if fused {
                        pairs.slope::<K, Fused>(kernel, slot, j)
                    } else {
                        pairs.slope::<K, Unfused>(kernel, slot, j)
                    }
                })
            });
            let slopes = slopes.collect();
            let clusters = 0..pairs.list.clusters_of(c).len();
            let entries = clusters.flat_map(|k| chunk.of(k)).map(|j| j as u32).collect();
            pairs.slopes.push(slopes);
            pairs.entries.push(entries);
        }
        pairs
    }

    /// Takes the pairs apart, by their slots, for which `apart` holds: their slopes become zero.
    pub fn part(&mut self, apart: impl Fn(usize, usize) -> bool) {
        let Self { list, slopes, .. } = self;
        for (c, (chunk, slopes)) in list.chunks().iter().zip(slopes).enumerate() {
            let clusters = list.clusters_of(c).enumerate();
            let pairs = clusters.flat_map(|(k, cluster)| chunk.of(k).map(move |j| (cluster, j)));
            for ((cluster, j), slope) in pairs.zip(slopes) {
                for lane in 0..LANES {
                    if apart(cluster * LANES + lane, j) {
                        slope.0[lane] = 0.0;
                    }
                }
            }
        }
    }

    /// Where the slope of a pair is kept, by its slots: chunk and entry.
    fn place(&self, i: usize, j: usize) -> Option<(usize, usize)> {
        let (chunk, mut neighbours, first) = self.list.place(i);
        Some((chunk, first + neighbours.position(|k| k == j)?))
    }

    /// Cuts a pair, by its slots: it has no slope from now on, whichever of the two asks. `false`: it had none.
    pub fn cut(&mut self, i: usize, j: usize) -> bool {
        let mut had = false;
        for (i, j) in [(i, j), (j, i)] {
            if let Some((chunk, entry)) = self.place(i, j) {
                let slope = std::mem::take(&mut self.slopes[chunk][entry].0[i % LANES]);
                had |= slope != 0.0;
            }
        }
        had
    }

    /// Slots of the neighbours that a slot is not cut off from, in the list's order, with the slopes F.
    pub fn neighbours(&self, slot: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (chunk, neighbours, first) = self.list.place(slot);
        let slopes = self.slopes[chunk][first..].iter().map(move |slope| slope.0[slot % LANES]);
        neighbours.zip(slopes).filter(move |&(j, slope)| j != slot && slope != 0.0)
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
        components(|d| xi[d] - L::splat(self.position[d][j]))
    }

    #[inline(always)]
    fn at<L: Lanes>(&self, slot: usize) -> [L; D] {
        components(|d| L::load(&self.position[d], slot))
    }

    fn slope<K: Kernel<D>, A: Arch>(&self, kernel: K, slot: usize, j: usize) -> Lane {
        let dx = self.apart::<Lane>(&self.at(slot), j);
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
    const SINGLE: bool = false;
    type Sum<L: Lanes> = W::Sum<L>;
    fn list(&self) -> &ClusterList {
        &self.1.list
    }
    #[inline(always)]
    fn gather<A: Arch, L: Lanes>(self, chunk: usize, k: usize, slot: usize, sum: &mut W::Sum<L>) {
        let Self(law, pairs) = self;
        let (neighbours, first) = pairs.list.chunks()[chunk].range(k);
        let entries = &pairs.entries[chunk][first..first + neighbours.len()];
        // Not by way of memory, as with wider clusters: four targets stay in registers.
        let target = law.target::<L>(slot);
        let xi = pairs.at::<L>(slot);
        let mut total = *sum;
        for (&j, slope) in entries.iter().zip(&pairs.slopes[chunk][first..]) {
            let j = j as usize;
            let dx = pairs.apart(&xi, j);
            law.add::<A, L>(&target, j, dx, L::of_fours(|_| *slope), &mut total);
        }
        *sum = total;
    }
}

/// Runs a law over all of fixed pairs; `sums` has one entry for each four targets.
pub fn fixed_pass<const D: usize, W: FixedLaw<D>>(
    isa: Isa,
    law: &W,
    pairs: &FixedPairs<D>,
    sums: &mut [W::Sum<Lane>],
) {
    run_tasks(isa, OverFixed(law, pairs), Replace(|_, sum: &W::Sum<Lane>| *sum), sums);
}
