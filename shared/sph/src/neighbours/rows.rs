//! Moving particles sorted into rows: slots of one row are consecutive and ascend in x.
//!
//! A row is a strip along x (2D) or a square column along x (3D). Each row is padded to whole clusters, of the widest
//! kind whatever the processor, with copies of its last particle; a padding slot is never anybody's neighbour, so what
//! becomes of it does not matter.

use super::PADDING;
use crate::columns::fit;
use crate::lane::Precision;
use std::cmp::Ordering;

/// The order of one set of particles.
#[derive(Clone, Debug, Default)]
pub struct Rows<const D: usize> {
    origin: Vec<f64>,
    height: f64,
    counts: Vec<usize>,
    /// First slot of each row; one more entry at the end.
    start: Vec<u32>,
    /// Real particles of each row.
    filled: Vec<u32>,
    /// New slot -> old slot.
    permutation: Vec<u32>,
    cursor: Vec<u32>,
    scratch: Vec<f64>,
    /// Rows of the old slots during the sort, then the numbers' new order.
    id_scratch: Vec<u32>,
    /// Slots that every column has memory for.
    room: usize,
    precision: Precision,
}

impl<const D: usize> Rows<D> {
    /// For lists of laws that are computed in this precision.
    pub fn new(precision: Precision) -> Self {
        Self { precision, ..Self::default() }
    }

    /// Sorts the particles of `x` whose `id` is not [`PADDING`] into rows of at least `height` inside the box
    /// `[low, high]` (particles outside belong to the nearest row). Afterwards [`Rows::permute`] each column.
    pub fn sort(&mut self, x: &[Vec<f64>; D], id: &[u32], height: f64, low: [f64; D], high: [f64; D]) {
        let real = id.iter().filter(|&&i| i != PADDING).count();
        self.lay_out(x, id, real, height, low, high);
        let rows = self.start.len() - 1;

        let mut keys = std::mem::take(&mut self.id_scratch);
        keys.clear();
        reserve(&mut keys, id.len().max(self.room));
        for slot in 0..id.len() {
            let key = if id[slot] == PADDING {
                u32::MAX
            } else {
                self.row_of(std::array::from_fn(|d| x[d][slot])) as u32
            };
            if key != u32::MAX {
                self.filled[key as usize] += 1;
            }
            keys.push(key);
        }
        let (mut total, mut slots, cluster) = (0, 0, self.precision.padding());
        for row in 0..rows {
            self.cursor[row] = total;
            self.start[row] = slots;
            total += self.filled[row];
            slots += self.filled[row].next_multiple_of(cluster as u32);
        }
        self.start[rows] = slots;
        // Padding comes and goes with the shape of the whole: some ahead, so that a later sort does not allocate.
        let slots = slots as usize;
        if slots > self.room {
            self.room = slots + slots / 32 + 16 * cluster;
        }
        self.permutation.clear();
        reserve(&mut self.permutation, self.room);
        self.permutation.resize(slots, 0);
        for (slot, &key) in keys.iter().enumerate().filter(|&(_, &key)| key != u32::MAX) {
            let c = &mut self.cursor[key as usize];
            self.permutation[*c as usize] = slot as u32;
            *c += 1;
        }
        self.id_scratch = keys;
        // Canonical order within a row: x, then the particle's number.
        sort_rows(&self.filled, &mut self.permutation[..real], &|a, b| {
            x[0][a as usize].total_cmp(&x[0][b as usize]).then(id[a as usize].cmp(&id[b as usize]))
        });
        self.pad(real);
    }

    /// Moves the rows, which stand one after the other, to where they start, the last one first.
    fn pad(&mut self, real: usize) {
        let mut end = real;
        for row in (0..self.filled.len()).rev() {
            let n = self.filled[row] as usize;
            let (to, next) = (self.start[row] as usize, self.start[row + 1] as usize);
            if n > 0 {
                self.permutation.copy_within(end - n..end, to);
                let last = self.permutation[to + n - 1];
                self.permutation[to + n..next].fill(last);
            }
            end -= n;
        }
    }

    fn lay_out(
        &mut self,
        x: &[Vec<f64>; D],
        id: &[u32],
        real: usize,
        height: f64,
        low: [f64; D],
        high: [f64; D],
    ) {
        self.origin.clear();
        self.counts.clear();
        self.height = height;
        let mut extent = [0.0; D];
        for d in 1..D {
            let (mut a, mut b) = (f64::INFINITY, f64::NEG_INFINITY);
            for slot in 0..id.len() {
                if id[slot] != PADDING {
                    a = a.min(x[d][slot]);
                    b = b.max(x[d][slot]);
                }
            }
            let a = a.clamp(low[d], high[d]);
            let b = b.clamp(low[d], high[d]);
            self.origin.push(a);
            extent[d] = (b - a).max(0.0);
        }
        // Wider rows are as right as narrow ones: no more rows than the particles are worth.
        loop {
            self.counts.clear();
            let mut rows = 1.0;
            for d in 1..D {
                let n = (extent[d] / self.height).floor() + 1.0;
                rows *= n;
                self.counts.push(n as usize);
            }
            if rows <= (4 * real + 64) as f64 {
                break;
            }
            self.height *= 2.0;
        }
        let rows: usize = self.counts.iter().product();
        for (column, len) in [(&mut self.start, rows + 1), (&mut self.filled, rows), (&mut self.cursor, rows)]
        {
            column.clear();
            fit(column, len, 0);
        }
    }

    #[inline]
    fn coordinate(&self, d: usize, value: f64) -> usize {
        let k = ((value - self.origin[d - 1]) / self.height).floor();
        // NaN becomes row 0; bounds are checked elsewhere.
        (k.max(0.0) as usize).min(self.counts[d - 1] - 1)
    }

    fn row_of(&self, x: [f64; D]) -> usize {
        let mut row = 0;
        for d in (1..D).rev() {
            row = row * self.counts[d - 1] + self.coordinate(d, x[d]);
        }
        row
    }

    /// Allocated bytes.
    pub fn bytes(&self) -> usize {
        let of_rows = 8 * (self.origin.capacity() + self.counts.capacity() + self.scratch.capacity());
        let of_slots = [&self.start, &self.filled, &self.permutation, &self.cursor, &self.id_scratch];
        of_rows + 4 * of_slots.iter().map(|c| c.capacity()).sum::<usize>()
    }

    /// Slots after the sort, padding included: a whole number of clusters.
    pub fn slots(&self) -> usize {
        self.permutation.len()
    }

    /// Brings a column into the new order.
    pub fn permute(&mut self, column: &mut Vec<f64>) {
        self.scratch.clear();
        reserve(&mut self.scratch, self.room);
        self.scratch.extend(self.permutation.iter().map(|&old| column[old as usize]));
        std::mem::swap(column, &mut self.scratch);
    }

    /// Brings one number of each record into the new order; the records keep the length of the longer of both orders.
    pub fn permute_field<T: Clone>(
        &mut self,
        records: &mut Vec<T>,
        zero: T,
        field: impl Fn(&mut T) -> &mut f64,
    ) {
        if records.len() < self.slots() {
            fit(records, self.slots(), zero);
        }
        self.scratch.clear();
        reserve(&mut self.scratch, self.room);
        self.scratch.extend(self.permutation.iter().map(|&old| *field(&mut records[old as usize])));
        for (record, &value) in records.iter_mut().zip(&self.scratch) {
            *field(record) = value;
        }
    }

    /// Brings the particle numbers into the new order; padding slots get [`PADDING`].
    pub fn permute_ids(&mut self, id: &mut Vec<u32>) {
        self.id_scratch.clear();
        reserve(&mut self.id_scratch, self.room);
        self.id_scratch.extend(self.permutation.iter().map(|&old| id[old as usize]));
        for row in 0..self.filled.len() {
            let (a, b) = (self.start[row] as usize, self.start[row + 1] as usize);
            self.id_scratch[a + self.filled[row] as usize..b].fill(PADDING);
        }
        std::mem::swap(id, &mut self.id_scratch);
    }

    /// Calls `visit(first, end)` for each run of real slots that can lie within `reach` of the box `[low, high]`; `x0`
    /// is the sorted x column, unchanged since the sort.
    #[inline]
    pub fn candidates(
        &self,
        x0: &[f64],
        low: [f64; D],
        high: [f64; D],
        reach: f64,
        mut visit: impl FnMut(usize, usize),
    ) {
        if self.filled.is_empty() {
            return;
        }
        let mut from = [0; D];
        let mut to = [0; D];
        for d in 1..D {
            from[d] = self.coordinate(d, low[d] - reach);
            to[d] = self.coordinate(d, high[d] + reach);
        }
        let mut at = from;
        loop {
            let mut row = 0;
            for d in (1..D).rev() {
                row = row * self.counts[d - 1] + at[d];
            }
            let first = self.start[row] as usize;
            let part = &x0[first..first + self.filled[row] as usize];
            let a = part.partition_point(|&v| v < low[0] - reach);
            let b = a + part[a..].partition_point(|&v| v <= high[0] + reach);
            if a < b {
                visit(first + a, first + b);
            }
            let mut d = 1;
            while d < D {
                if at[d] < to[d] {
                    at[d] += 1;
                    break;
                }
                at[d] = from[d];
                d += 1;
            }
            if d >= D {
                return;
            }
        }
    }
}

/// Makes room for as many values as `room`, in one go.
fn reserve<T>(column: &mut Vec<T>, room: usize) {
    column.reserve_exact(room.saturating_sub(column.len()));
}

/// Sorts each row by itself, rows in parallel, without allocating.
fn sort_rows(filled: &[u32], slots: &mut [u32], order: &(impl Fn(u32, u32) -> Ordering + Sync)) {
    if filled.len() <= 1 || slots.len() <= 4096 {
        let mut rest = slots;
        for &n in filled {
            let (row, tail) = rest.split_at_mut(n as usize);
            row.sort_unstable_by(|&a, &b| order(a, b));
            rest = tail;
        }
        return;
    }
    let (left, right) = filled.split_at(filled.len() / 2);
    let (a, b) = slots.split_at_mut(left.iter().sum::<u32>() as usize);
    rayon::join(|| sort_rows(left, a, order), || sort_rows(right, b, order));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_ascend_in_x_and_are_padded() {
        // Two rows of height 1: y < 1 holds three particles, y >= 1 five.
        let x = [vec![3.0, 1.0, 2.0, 9.0, 8.0, 7.0, 6.0, 5.0], vec![0.0, 0.1, 0.2, 1.1, 1.2, 1.3, 1.4, 1.5]];
        let mut id: Vec<u32> = (10..18).collect();
        let mut rows = Rows::<2>::default();
        rows.sort(&x, &id, 1.0, [-1e3; 2], [1e3; 2]);
        assert_eq!(rows.slots(), 8 + 8);
        let mut x0 = x[0].clone();
        rows.permute(&mut x0);
        assert_eq!(x0[..8], [1.0, 2.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0]);
        assert_eq!(x0[8..], [5.0, 6.0, 7.0, 8.0, 9.0, 9.0, 9.0, 9.0]);
        rows.permute_ids(&mut id);
        assert_eq!(id[..4], [11, 12, 10, PADDING]);
        assert_eq!(
            id[4..],
            [PADDING, PADDING, PADDING, PADDING, 17, 16, 15, 14, 13, PADDING, PADDING, PADDING]
        );
    }

    #[test]
    fn particles_beyond_the_box_are_still_found() {
        let x = [vec![0.0, 0.5], vec![1e9, 1e9]];
        let id = vec![0, 1];
        let mut rows = Rows::<2>::default();
        rows.sort(&x, &id, 1.0, [-1.0; 2], [1.0; 2]);
        let mut found = Vec::new();
        rows.candidates(&x[0], [0.0, 1e9], [0.0, 1e9], 1.0, |a, b| found.push((a, b)));
        assert_eq!(found, [(0, 2)]);
    }
}
