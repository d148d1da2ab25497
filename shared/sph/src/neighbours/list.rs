//! Neighbour lists for clusters of consecutive slots, as many as the passes compute at once.

use super::Rows;
use crate::lane::{Isa, LANES, Precision, WIDEST, WIDEST_SINGLE};
use rayon::prelude::*;
use std::marker::PhantomData;
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

/// Neighbours of a few clusters. Where their slots are close to each other, two bytes are enough for each: lists are
/// the largest part of a particle's memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chunk {
    /// First entry of each cluster; one more at the end.
    start: Vec<u32>,
    /// What the two-byte entries count from.
    base: u32,
    /// Entries of two bytes, and one that is none.
    short: Vec<u16>,
    /// Entries of four bytes, where two do not do.
    long: Vec<u32>,
}

/// Neighbours of a cluster: slots of sources, ascending.
#[derive(Clone, Debug)]
pub struct Neighbours<'a> {
    /// The next entry; while one is left, four bytes from here on are the chunk's.
    next: *const u8,
    left: usize,
    /// Bytes of an entry.
    stride: usize,
    mask: u32,
    base: u32,
    chunk: PhantomData<&'a Chunk>,
}

impl Neighbours<'_> {
    /// Nobody.
    pub const NONE: Self =
        Self { next: std::ptr::null(), left: 0, stride: 0, mask: 0, base: 0, chunk: PhantomData };
}

impl Iterator for Neighbours<'_> {
    type Item = usize;

    // One way for entries of both lengths: two would be two copies of every pass.
    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.left == 0 {
            return None;
        }
        // SAFETY: there is an entry left, and behind the last one of two bytes another one.
        let entry = unsafe { self.next.cast::<u32>().read_unaligned() };
        self.next = self.next.wrapping_add(self.stride);
        self.left -= 1;
        Some((self.base + (entry & self.mask)) as usize)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl ExactSizeIterator for Neighbours<'_> {}

impl Chunk {
    fn clear(&mut self) {
        self.start.clear();
        self.short.clear();
        self.long.clear();
    }

    /// Number of entries.
    fn len(&self) -> usize {
        self.start.last().map_or(0, |&end| end as usize)
    }

    fn bytes(&self) -> usize {
        4 * (self.start.capacity() + self.long.capacity()) + 2 * self.short.capacity()
    }

    /// Neighbours of the chunk's cluster number `k`.
    #[inline(always)]
    pub(crate) fn of(&self, k: usize) -> Neighbours<'_> {
        self.range(k).0
    }

    /// Neighbours of a cluster, and how many the clusters before it have.
    #[inline(always)]
    pub(crate) fn range(&self, k: usize) -> (Neighbours<'_>, usize) {
        let (first, end) = (self.start[k] as usize, self.start[k + 1] as usize);
        let (next, stride, mask, base) = match self.short.is_empty() {
            true => (self.long[first..end].as_ptr().cast::<u8>(), 4, u32::MAX, 0),
            // With the entry that is none.
            false => (self.short[first..=end].as_ptr().cast::<u8>(), 2, u32::from(u16::MAX), self.base),
        };
        (Neighbours { next, left: end - first, stride, mask, base, chunk: PhantomData }, first)
    }
}

/// Makes room for the next lists to be somewhat longer without allocating. Lists that outgrew their memory, which was
/// `before`, were given up to twice as much: where they allocate in any case, they are made to measure.
fn keep_room<T>(index: &mut Vec<T>, before: usize) {
    let used = index.len();
    if index.capacity() != before || before < used + used / 32 {
        // Short lists, those of walls, change the most.
        let room = if used < 16 * CHUNK_FOURS { 2 * used + 256 } else { used / 4 };
        index.shrink_to(used + room);
        index.reserve_exact(room);
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
        let search = Search { targets, sources, rows, reach };
        // Chunks that are not needed now keep their memory for when they are.
        // One more stands ready: spreading particles need more padding.
        self.chunks.resize_with((used + 1).max(self.chunks.len()), Chunk::default);
        self.chunks[used].clear();
        self.chunks[used].start.reserve_exact(CHUNK / width + 1);
        self.chunks[used..].iter_mut().for_each(Chunk::clear);
        self.chunks[..used].par_iter_mut().enumerate().for_each(|(c, chunk)| {
            let first = c * CHUNK;
            let last = (first + CHUNK).min(targets[0].len());
            chunk.clear();
            chunk.start.reserve_exact(CHUNK / width + 1);
            let near = search.span(first..last);
            let Chunk { start, short, long, base } = chunk;
            if near.len() <= usize::from(u16::MAX) + 1 {
                let before = short.capacity();
                *base = near.start as u32;
                search.list(first..last, width, start, short, |j| (j - near.start) as u16);
                short.push(0);
                keep_room(short, before);
                *long = Vec::new();
            } else {
                let before = long.capacity();
                search.list(first..last, width, start, long, |j| j as u32);
                keep_room(long, before);
                *short = Vec::new();
            }
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
        self.width * self.chunks.iter().map(Chunk::len).sum::<usize>()
    }

    pub(crate) fn chunks(&self) -> &[Chunk] {
        &self.chunks[..self.targets.div_ceil(CHUNK)]
    }

    /// Numbers of the clusters of a chunk.
    pub(crate) fn clusters_of(&self, chunk: usize) -> Range<usize> {
        chunk * CHUNK / self.width..((chunk + 1) * CHUNK).min(self.targets) / self.width
    }

    /// The chunk of a target, its cluster's neighbours, and how many the clusters before it in the chunk have.
    pub(crate) fn place(&self, slot: usize) -> (usize, Neighbours<'_>, usize) {
        let chunk = slot / CHUNK;
        let (neighbours, first) = self.chunks[chunk].range(slot % CHUNK / self.width);
        (chunk, neighbours, first)
    }

    /// Neighbours of a target's cluster.
    pub fn of(&self, slot: usize) -> Neighbours<'_> {
        self.place(slot).1
    }

    /// Allocated bytes.
    pub fn bytes(&self) -> usize {
        self.chunks.iter().map(Chunk::bytes).sum()
    }
}

/// Who looks for neighbours among whom.
struct Search<'a, const D: usize> {
    targets: &'a [Vec<f64>; D],
    sources: &'a [Vec<f64>; D],
    /// Order of the sources.
    rows: &'a Rows<D>,
    reach: f64,
}

impl<const D: usize> Search<'_, D> {
    /// The slots between which all are that these targets may have as neighbours.
    fn span(&self, slots: Range<usize>) -> Range<usize> {
        let of = |d: usize| self.targets[d][slots.clone()].iter().copied();
        let low = std::array::from_fn(|d| of(d).fold(f64::INFINITY, f64::min));
        let high = std::array::from_fn(|d| of(d).fold(f64::NEG_INFINITY, f64::max));
        let (mut first, mut end) = (usize::MAX, 0);
        let widen = |a: usize, b: usize| (first, end) = (first.min(a), end.max(b));
        self.rows.candidates(&self.sources[0], low, high, self.reach, widen);
        first.min(end)..end
    }

    /// Lists the neighbours of these targets, cluster by cluster.
    fn list<T>(
        &self,
        slots: Range<usize>,
        width: usize,
        start: &mut Vec<u32>,
        index: &mut Vec<T>,
        entry: impl Fn(usize) -> T,
    ) {
        start.push(0);
        for slot in slots.step_by(width) {
            let push = |j| index.push(entry(j));
            match width {
                LANES => self.visit::<LANES>(slot, push),
                WIDEST => self.visit::<WIDEST>(slot, push),
                _ => self.visit::<WIDEST_SINGLE>(slot, push),
            }
            start.push(index.len() as u32);
        }
    }

    /// Visits the neighbours of the cluster that begins at `slot`.
    fn visit<const N: usize>(&self, slot: usize, mut visit: impl FnMut(usize)) {
        let Self { targets, sources, rows, reach } = *self;
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
                    visit(j);
                }
            }
        });
    }
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
            let listed: Vec<usize> = list.of(i).collect();
            assert!(listed.windows(2).all(|w| w[0] < w[1]));
            for j in 0..id.len() {
                let r2: f64 = x.iter().map(|x| (x[i] - x[j]).powi(2)).sum();
                let is_listed = listed.contains(&j);
                if id[j] == PADDING {
                    assert!(!is_listed);
                } else if id[i] != PADDING && r2 < 1.0 {
                    assert!(is_listed, "{i} {j} {r2}");
                }
            }
        }
    }

    /// Three rows of which each is so long that two bytes do not reach from the first one to the last.
    #[test]
    fn neighbours_far_apart_in_the_order_are_listed() {
        let long = 35_000;
        let mut x = [0, 1].map(|d| (0..3 * long).map(|k| [k % long, k / long][d] as f64).collect::<Vec<_>>());
        let mut id: Vec<u32> = (0..3 * long as u32).collect();
        let mut rows = Rows::<2>::new(Precision::Double);
        rows.sort(&x, &id, 1.0, [0.0; 2], [1e5; 2]);
        x.iter_mut().for_each(|column| rows.permute(column));
        rows.permute_ids(&mut id);
        let mut list = ClusterList::narrow();
        list.build(&x, &x, &rows, 1.1);
        let of_row = id.len() / 3;
        let (first, middle) = (list.of(0), list.of(of_row + 8));
        assert!(list.chunks[0].long.is_empty() && list.chunks[of_row / CHUNK + 1].short.is_empty());
        assert_eq!(first.collect::<Vec<_>>(), [0, 1, 2, 3, 4, of_row, of_row + 1, of_row + 2, of_row + 3]);
        let around = |row: usize, from: usize, to: usize| row * of_row + from..row * of_row + to;
        let expected: Vec<usize> = around(0, 8, 12).chain(around(1, 7, 13)).chain(around(2, 8, 12)).collect();
        assert_eq!(middle.collect::<Vec<_>>(), expected);
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
