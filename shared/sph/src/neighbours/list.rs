//! Neighbour lists for clusters of consecutive slots, as many as the passes compute at once.

use super::Rows;
use crate::lane::{Isa, LANES, Precision, WIDEST, WIDEST_SINGLE};
use rayon::prelude::*;
use std::ops::Range;

/// Fours of targets whose neighbours lie together.
pub const CHUNK_FOURS: usize = 128;

/// Targets whose neighbours lie together.
const CHUNK: usize = CHUNK_FOURS * LANES;

/// For each cluster of targets the sources within reach of any of them, in slot order.
#[derive(Clone, Debug)]
pub struct ClusterList {
    chunks: Vec<Chunk>,
    /// Targets of a cluster.
    width: usize,
    precision: Precision,
    targets: usize,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Chunk {
    start: Vec<u32>,
    index: Vec<u32>,
}

impl Chunk {
    fn clear(&mut self) {
        self.start.clear();
        self.index.clear();
    }

    /// Makes room for the next lists to be somewhat longer without allocating. Lists that outgrew their memory, which
    /// was `before`, were given up to twice as much: where they allocate in any case, they are made to measure.
    fn keep_room(&mut self, before: usize) {
        let used = self.index.len();
        if self.index.capacity() != before || before < used + used / 32 {
            // Short lists, those of walls, change the most.
            let room = if used < 16 * CHUNK_FOURS { 2 * used + 256 } else { used / 4 };
            self.index.shrink_to(used + room);
            self.index.reserve_exact(room);
        }
    }

    /// Neighbours of the chunk's cluster number `k`.
    #[inline(always)]
    pub(crate) fn of(&self, k: usize) -> &[u32] {
        self.range(k).0
    }

    /// Neighbours of a cluster, and how many the clusters before it have.
    #[inline(always)]
    pub(crate) fn range(&self, k: usize) -> (&[u32], usize) {
        let (first, end) = (self.start[k] as usize, self.start[k + 1] as usize);
        (&self.index[first..end], first)
    }
}

impl ClusterList {
    /// An empty list for wide laws with an instruction set.
    pub fn new(isa: Isa) -> Self {
        Self::with_precision(isa, Precision::Double)
    }

    /// The same for laws that are computed in this precision.
    pub fn with_precision(isa: Isa, precision: Precision) -> Self {
        Self { width: isa.min(Isa::detect()).targets(precision), precision, ..Self::narrow() }
    }

    /// An empty list for laws that compute four targets at once.
    pub fn narrow() -> Self {
        Self { chunks: Vec::new(), width: LANES, precision: Precision::Double, targets: 0 }
    }

    /// Lists all sources within `reach` of the targets. Both sets are sorted; `rows` is the order of the sources.
    pub fn build<const D: usize>(
        &mut self,
        targets: &[Vec<f64>; D],
        sources: &[Vec<f64>; D],
        rows: &Rows<D>,
        reach: f64,
    ) {
        self.targets = targets[0].len();
        let used = self.targets.div_ceil(CHUNK);
        let width = self.width;
        // Chunks that are not needed now keep their memory for when they are.
        // One more stands ready: spreading particles need more padding.
        self.chunks.resize_with((used + 1).max(self.chunks.len()), Chunk::default);
        self.chunks[used].clear();
        self.chunks[used].start.reserve_exact(CHUNK / width + 1);
        self.chunks[used..].iter_mut().for_each(Chunk::clear);
        self.chunks[..used].par_iter_mut().enumerate().for_each(|(c, chunk)| {
            let first = c * CHUNK;
            let last = (first + CHUNK).min(targets[0].len());
            let before = chunk.index.capacity();
            chunk.clear();
            chunk.start.reserve_exact(CHUNK / width + 1);
            chunk.start.push(0);
            for slot in (first..last).step_by(width) {
                let index = &mut chunk.index;
                match width {
                    LANES => push_neighbours::<D, LANES>(slot, targets, sources, rows, reach, index),
                    WIDEST => push_neighbours::<D, WIDEST>(slot, targets, sources, rows, reach, index),
                    _ => push_neighbours::<D, WIDEST_SINGLE>(slot, targets, sources, rows, reach, index),
                }
                chunk.start.push(chunk.index.len() as u32);
            }
            chunk.keep_room(before);
        });
    }

    /// A list of clusters of any width for a test.
    #[cfg(test)]
    pub(crate) fn of_width(width: usize) -> Self {
        Self { width, ..Self::narrow() }
    }

    /// Number of targets of a cluster.
    pub fn width(&self) -> usize {
        self.width
    }

    /// What passes over it are computed in.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Number of fours of targets.
    pub fn fours(&self) -> usize {
        self.targets / LANES
    }

    /// Pairs that a pass evaluates: each source with all targets of the cluster.
    pub fn pairs(&self) -> usize {
        self.width * self.chunks.iter().map(|c| c.index.len()).sum::<usize>()
    }

    pub(crate) fn chunks(&self) -> &[Chunk] {
        &self.chunks[..self.targets.div_ceil(CHUNK)]
    }

    /// Numbers of the clusters of a chunk.
    pub(crate) fn clusters_of(&self, chunk: usize) -> Range<usize> {
        chunk * CHUNK / self.width..((chunk + 1) * CHUNK).min(self.targets) / self.width
    }

    /// The chunk of a target, its cluster's neighbours, and how many the clusters before it in the chunk have.
    pub(crate) fn place(&self, slot: usize) -> (usize, &[u32], usize) {
        let chunk = slot / CHUNK;
        let (neighbours, first) = self.chunks[chunk].range(slot % CHUNK / self.width);
        (chunk, neighbours, first)
    }

    /// Neighbours of a target's cluster.
    pub fn of(&self, slot: usize) -> &[u32] {
        self.place(slot).1
    }

    /// Allocated bytes.
    pub fn bytes(&self) -> usize {
        self.chunks.iter().map(|c| 4 * (c.start.capacity() + c.index.capacity())).sum()
    }
}

fn push_neighbours<const D: usize, const N: usize>(
    slot: usize,
    targets: &[Vec<f64>; D],
    sources: &[Vec<f64>; D],
    rows: &Rows<D>,
    reach: f64,
    index: &mut Vec<u32>,
) {
    let i: [[f64; N]; D] = std::array::from_fn(|d| std::array::from_fn(|k| targets[d][slot + k]));
    let low = std::array::from_fn(|d| i[d].iter().copied().fold(f64::INFINITY, f64::min));
    let high = std::array::from_fn(|d| i[d].iter().copied().fold(f64::NEG_INFINITY, f64::max));
    let reach2 = reach * reach;
    rows.candidates(&sources[0], low, high, reach, |first, end| {
        for j in first..end {
            let mut r2 = [0.0; N];
            for d in 0..D {
                let xj = sources[d][j];
                for k in 0..N {
                    let dx = i[d][k] - xj;
                    r2[k] += dx * dx;
                }
            }
            if r2.iter().any(|&r2| r2 < reach2) {
                index.push(j as u32);
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::neighbours::PADDING;
    use proptest::prelude::*;

    /// The list holds every pair within reach, none twice, and no padding.
    fn every_pair_within_reach_is_listed<const D: usize>(points: &[[f64; 3]]) {
        let mut x: [Vec<f64>; D] = std::array::from_fn(|d| points.iter().map(|p| p[d]).collect());
        let mut id: Vec<u32> = (0..points.len() as u32).collect();
        let mut rows = Rows::<D>::new(Precision::Mixed);
        rows.sort(&x, &id, 1.0, [0.0; D], [4.0; D]);
        for column in &mut x {
            rows.permute(column);
        }
        rows.permute_ids(&mut id);
        for width in [LANES, WIDEST, WIDEST_SINGLE] {
            let mut list = ClusterList::of_width(width);
            list.build(&x, &x, &rows, 1.0);
            holds_every_pair(&list, &x, &id);
        }
    }

    fn holds_every_pair<const D: usize>(list: &ClusterList, x: &[Vec<f64>; D], id: &[u32]) {
        for i in 0..id.len() {
            let listed = list.of(i);
            assert!(listed.windows(2).all(|w| w[0] < w[1]));
            for j in 0..id.len() {
                let r2: f64 = x.iter().map(|x| (x[i] - x[j]).powi(2)).sum();
                let is_listed = listed.contains(&(j as u32));
                if id[j] == PADDING {
                    assert!(!is_listed);
                } else if id[i] != PADDING && r2 < 1.0 {
                    assert!(is_listed, "{i} {j} {r2}");
                }
            }
        }
    }

    proptest! {
        #[test]
        fn every_pair_is_listed_in_the_plane(
            points in prop::collection::vec(prop::array::uniform3(0.0..4.0f64), 1..120)
        ) {
            every_pair_within_reach_is_listed::<2>(&points);
        }

        #[test]
        fn every_pair_is_listed_in_space(
            points in prop::collection::vec(prop::array::uniform3(0.0..4.0f64), 1..200)
        ) {
            every_pair_within_reach_is_listed::<3>(&points);
        }
    }
}
