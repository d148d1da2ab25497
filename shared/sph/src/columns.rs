//! Columns of vectors: one `Vec` a component.

use crate::lane::WIDEST;
use crate::neighbours::PADDING;

/// `D` columns.
pub type Vectors<const D: usize> = [Vec<f64>; D];

/// `D` columns of `n` zeros.
pub fn vectors<const D: usize>(n: usize) -> Vectors<D> {
    std::array::from_fn(|_| vec![0.0; n])
}

/// Makes a column that long, with room for the little more that other padding may need: not twice as much.
pub fn fit<T: Clone>(column: &mut Vec<T>, len: usize, value: T) {
    make_room(column, len);
    column.resize(len, value);
}

/// Makes a column the same as another, with the same room as [`fit`] leaves.
pub fn copy<T: Clone>(column: &mut Vec<T>, from: &[T]) {
    column.clear();
    make_room(column, from.len());
    column.extend_from_slice(from);
}

fn make_room<T>(column: &mut Vec<T>, len: usize) {
    if column.capacity() < len {
        column.reserve_exact(len + len / 32 + 16 * WIDEST - column.len());
    }
}

/// Whether a particle, padding aside, is farther than `limit` from where it was.
pub fn moved_farther<const D: usize>(now: &Vectors<D>, was: &Vectors<D>, id: &[u32], limit: f64) -> bool {
    (0..id.len()).filter(|&s| id[s] != PADDING).any(|s| {
        let r2: f64 = (0..D).map(|d| (now[d][s] - was[d][s]).powi(2)).sum();
        r2 > limit * limit
    })
}

/// Lowest and highest corner of the box around points; zero where there are none.
pub fn bounds<const D: usize>(x: &Vectors<D>) -> ([f64; D], [f64; D]) {
    if x[0].is_empty() {
        return ([0.0; D], [0.0; D]);
    }
    (
        std::array::from_fn(|d| x[d].iter().copied().fold(f64::INFINITY, f64::min)),
        std::array::from_fn(|d| x[d].iter().copied().fold(f64::NEG_INFINITY, f64::max)),
    )
}
