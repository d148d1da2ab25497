//! The last row of particles beside a crack: a ligament of one row.
//!
//! One deformation gradient a row does not see the row bend: its mean over the row's thickness is what a hinge leaves
//! unstrained, while the edges of the row, half a spacing to either side, are pulled apart and squeezed. Across the row
//! (half a spacing, the vector a) the gradient goes on as the row turns along itself (t): where displacements are
//! smooth, dF/da t = dF/dt a. So the edges have
//!   F± = F ± (dF/dt a) (x) t,
//! with dF/dt from the next particles of the row, those on the other side of the crack included. The larger of both
//! edges' tensions drives the damage of such a particle, and the edges tell whether its pair across the crack is torn.
//! Stress and energy are those of F alone, so force stays the derivative of the energy.
//!
//! On lattices only: elsewhere there are no rows.

use super::Fracture;
use super::cuts::STRAIGHT;
use crate::total_lagrangian::material::Matrix;
use crate::total_lagrangian::model::TotalLagrangian;
use nalgebra::SVector;

/// Largest distance of two places in the lattice that are one, over dx.
const ALIKE: f64 = 0.05;

/// A particle in the last row beside a crack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ligament<const D: usize> {
    pub(super) slot: usize,
    /// The slot across the crack.
    pub(super) next: usize,
    /// The next one of the row on the particle's own side, with which it is connected.
    behind: Option<usize>,
    /// a: from the particle to one edge of the row, m.
    pub(super) edge: SVector<f64, D>,
}

impl<const D: usize> Fracture<D> {
    /// Last rows in which a slot is.
    pub(super) fn ligaments_of(&self, slot: usize) -> &[Ligament<D>] {
        let first = self.ligaments.partition_point(|ligament| ligament.slot < slot);
        let count = self.ligaments[first..].partition_point(|ligament| ligament.slot == slot);
        &self.ligaments[first..first + count]
    }
}

impl<const D: usize> TotalLagrangian<D> {
    /// Finds what cuts have left of rows.
    pub(super) fn note_ligaments(&mut self) {
        let ligaments = self.find_ligaments();
        if let Some(fracture) = &mut self.fracture {
            fracture.ligaments = ligaments;
        }
    }

    /// The particles of last rows beside cuts, ascending by their slots.
    fn find_ligaments(&self) -> Vec<Ligament<D>> {
        let Some(fracture) = self.fracture.as_ref().filter(|fracture| fracture.irregular.is_none()) else {
            return Vec::new();
        };
        let mut found = Vec::new();
        for [i, j] in fracture.cuts.iter().copied() {
            let along = self.apart(j, i);
            if along.norm() >= STRAIGHT * self.spacing {
                continue;
            }
            for beside in self.pairs.list().of(i) {
                let across = self.apart(beside, i);
                let is_row = across.norm() > ALIKE * self.spacing
                    && across.norm() < STRAIGHT * self.spacing
                    && across.dot(&along).abs() < ALIKE * self.spacing * self.spacing;
                let Some(other) = self.placed(j, across).filter(|_| is_row) else { continue };
                if !self.are_connected(beside, other) || self.row_holds([beside, other], across) {
                    continue;
                }
                for (slot, next, along) in [(beside, other, along), (other, beside, -along)] {
                    if self.is_free(slot) {
                        let behind = self.placed(slot, -along).filter(|&k| self.are_connected(slot, k));
                        found.push(Ligament { slot, next, behind, edge: across * 0.5 });
                    }
                }
            }
        }
        found.sort_by_key(|ligament| (ligament.slot, ligament.next));
        found
    }

    /// A pair of the next row, farther along `across`, is connected.
    fn row_holds(&self, [i, j]: [usize; 2], across: SVector<f64, D>) -> bool {
        let pair = self.placed(i, across).zip(self.placed(j, across));
        pair.is_some_and(|(i, j)| self.are_connected(i, j))
    }

    /// The neighbour of a slot, cut off or not, that was so far away at the start.
    fn placed(&self, slot: usize, way: SVector<f64, D>) -> Option<usize> {
        let near = |&j: &usize| (self.apart(j, slot) - way).norm() < ALIKE * self.spacing;
        self.pairs.list().of(slot).find(near)
    }

    fn are_connected(&self, i: usize, j: usize) -> bool {
        self.pairs.neighbours(i).any(|(k, _)| k == j)
    }

    /// F at both edges of a particle's row.
    pub(super) fn at_edges(&self, ligament: &Ligament<D>) -> [Matrix<D>; 2] {
        let Ligament { slot, next, behind, edge } = *ligament;
        let (mut turn, mut length) = (SVector::<f64, D>::zeros(), 0.0);
        let along = self.apart(next, slot);
        for (j, sign) in [(Some(next), 1.0), (behind, -1.0)] {
            if let Some(j) = j.filter(|&j| self.has_strain(j) || self.is_rigid(j)) {
                turn += (self.gradient[j] - self.gradient[slot]) * edge * (sign * self.gain([slot, j]));
                length += along.norm();
            }
        }
        let own = self.gradient[slot];
        let change =
            if length > 0.0 { turn * along.transpose() / (length * along.norm()) } else { Matrix::zeros() };
        [own + change, own - change]
    }

    /// beta_ij, by which a clamp's face is nearer than its particle.
    fn gain(&self, [i, j]: [usize; 2]) -> f64 {
        let (clamped, gain) = (&self.fixed.clamped, &self.fixed.excess_gain);
        1.0 + clamped[j] * gain[i] + clamped[i] * gain[j]
    }

    /// An edge of the row is torn apart between a particle and the one across the crack, by more than this strain.
    pub(super) fn is_edge_stretched(&self, ligament: &Ligament<D>, strain: f64) -> bool {
        let Ligament { slot, next, edge, .. } = *ligament;
        let way = SVector::from(self.position_at(slot)) - SVector::from(self.position_at(next));
        let turn = (self.gradient[slot] - self.gradient[next]) * edge;
        let most = self.apart(slot, next).norm() * (1.0 + strain);
        [way + turn, way - turn].iter().any(|way| way.norm() > most)
    }
}
