//! Things at places, sorted into cells.

use rustc_hash::{FxHashMap, FxHashSet};

/// Cells by their indices.
pub type CellSet<const D: usize> = FxHashSet<[i64; D]>;

/// Things at places, in cells of one side.
#[derive(Clone, Debug)]
pub struct Cells<T, const D: usize = 2> {
    cells: FxHashMap<[i64; D], Vec<T>>,
    side: f64,
}

impl<T, const D: usize> Cells<T, D> {
    /// None yet, in cells of this side, m.
    pub fn new(side: f64) -> Self {
        Self { cells: FxHashMap::default(), side }
    }

    /// Adds a thing at a place, m.
    pub fn add(&mut self, at: &[f64; D], thing: T) {
        self.cells.entry(cell(at, self.side)).or_default().push(thing);
    }

    /// All things in the cell of a place and in those around: what is no farther than a side from the place is there.
    pub fn around(&self, at: &[f64; D]) -> impl Iterator<Item = &T> {
        let home = cell(at, self.side);
        (0..3_usize.pow(D as u32)).flat_map(move |code| {
            let near: [i64; D] =
                std::array::from_fn(|a| home[a] + (code / 3_usize.pow(a as u32) % 3) as i64 - 1);
            self.cells.get(&near).into_iter().flatten()
        })
    }
}

/// The cell of this side, m, that holds a place, m.
pub fn cell<const D: usize>(at: &[f64; D], side: f64) -> [i64; D] {
    at.map(|x| (x / side).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_within_a_side_is_around() {
        let mut cells = Cells::new(0.5);
        for (name, at) in [("here", [0.1, 0.1]), ("left", [-0.3, 0.1]), ("far", [1.1, 0.1])] {
            cells.add(&at, name);
        }
        let mut found: Vec<&str> = cells.around(&[0.2, 0.4]).copied().collect();
        found.sort_unstable();
        assert_eq!(found, ["here", "left"]);
        assert_eq!(cell(&[-0.1, 0.5], 0.5), [-1, 1]);
    }
}
