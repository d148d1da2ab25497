//! A plate that breaks: a particle's normal is that of its own piece.
//!
//! The records know of no cuts, so both sides of the interface find pieces by positions: a bond between nearest
//! neighbours is gone where it is stretched beyond what a crack can open to before the pair across it is cut, and of
//! the particles around one those count that bonds among themselves connect with it.

use nalgebra::SVector;

/// Nearest neighbours, over the distance of the nearest one; the next ones of a lattice are at 1.41.
const NEAREST: f64 = 1.2;

/// The bonds of a plate's particles.
#[derive(Clone, Debug)]
pub(super) struct Pieces<const D: usize> {
    /// Positions at the first half-step, m.
    first: Vec<SVector<f64, D>>,
    /// Records that a record is bonded to.
    bonds: Vec<Vec<u32>>,
    /// Stretch beyond which a bond is gone.
    torn: f64,
    /// Farthest of a record's neighbours, m.
    reach: f64,
    /// Round in which a record was reached.
    reached: Vec<u64>,
    round: u64,
    open: Vec<usize>,
}

impl<const D: usize> Pieces<D> {
    /// From positions at the first half-step, and each record's neighbours in its plate.
    pub(super) fn new<'a>(
        first: Vec<SVector<f64, D>>,
        torn: f64,
        reach: f64,
        neighbours: impl Fn(usize) -> &'a [u32],
    ) -> Self {
        let apart = |i: usize, j: u32| (first[j as usize] - first[i]).norm();
        let nearest: Vec<f64> = (0..first.len())
            .map(|i| neighbours(i).iter().map(|&j| apart(i, j)).fold(f64::INFINITY, f64::min))
            .collect();
        let bonds = (0..first.len()).map(|i| {
            let is_bond = |&j: &u32| apart(i, j) <= NEAREST * nearest[i].max(nearest[j as usize]);
            neighbours(i).iter().copied().filter(is_bond).collect()
        });
        let (bonds, reached) = (bonds.collect(), vec![0; first.len()]);
        let mut pieces = Self { first, bonds, torn, reach, reached, round: 0, open: Vec::new() };
        // Where the arrangement is no lattice, what nearest ones do not connect has bonds of its own.
        let first = pieces.first.clone();
        for i in 0..first.len() {
            pieces.gather(i, |j| first[j]);
            let alone = |&j: &u32| pieces.reached[j as usize] != pieces.round;
            let more: Vec<u32> = neighbours(i).iter().copied().filter(alone).collect();
            pieces.bonds[i].extend(more);
        }
        pieces
    }

    /// Finds those of a record's neighbours that are in one piece with it, at the positions `at`.
    pub(super) fn gather(&mut self, own: usize, at: impl Fn(usize) -> SVector<f64, D>) {
        self.round += 1;
        self.reached[own] = self.round;
        self.open.push(own);
        while let Some(i) = self.open.pop() {
            for &j in &self.bonds[i] {
                let j = j as usize;
                let first = |i: usize| self.first[j] - self.first[i];
                let is_near = || first(own).norm() <= self.reach;
                let is_whole = || (at(j) - at(i)).norm() <= self.torn * first(i).norm();
                if self.reached[j] != self.round && is_near() && is_whole() {
                    self.reached[j] = self.round;
                    self.open.push(j);
                }
            }
        }
    }

    /// Whether the last search found a record.
    pub(super) fn holds(&self, record: usize) -> bool {
        self.reached[record] == self.round
    }
}
