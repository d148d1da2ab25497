//! Fragments of at most four rows where the solid had more. A fluid's kernel reaches through them, and only what was so
//! thin from the start is screened: they show each face a mean of both pressures.

use super::Fracture;
use crate::surface;
use crate::total_lagrangian::model::TotalLagrangian;
use halfstep_sph::neighbours::PADDING;
use std::collections::BTreeSet;

impl<const D: usize> TotalLagrangian<D> {
    /// Notes which particles begin in bodies of five rows and more.
    pub(super) fn note_thickness(&self, fracture: &mut Fracture<D>) {
        let neighbours = |slot: usize| self.pairs.neighbours(slot).count();
        let most = (0..self.id.len()).map(neighbours).max().unwrap_or(0);
        fracture.whole = match fracture.irregular {
            None => vec![most; self.id.len()],
            Some(_) => {
                let outer = surface::outer(&self.points, &fracture.body, self.spacing);
                let is_outer = |slot: usize| outer.get(self.id[slot] as usize).is_none_or(|outer| *outer);
                let whole = |slot| if is_outer(slot) { usize::MAX } else { neighbours(slot) };
                (0..self.id.len()).map(whole).collect()
            }
        };
        fracture.was_thick = self.thick(fracture);
    }

    /// Particles of bodies that have become thin, without those that are loose.
    pub(super) fn thin(&self, fracture: &Fracture<D>) -> u32 {
        let thick = self.thick(fracture);
        let thin =
            |p: &usize| fracture.was_thick[*p] && !thick[*p] && self.has_strain(self.slot_of[*p] as usize);
        (0..thick.len()).filter(thin).count() as u32
    }

    /// Whether each particle's body has five rows or more somewhere: a particle all of whose neighbours lack none.
    fn thick(&self, fracture: &Fracture<D>) -> Vec<bool> {
        let lacks_none = |slot: usize| self.pairs.neighbours(slot).count() == fracture.whole[slot];
        let inside: Vec<bool> = (0..self.id.len()).map(lacks_none).collect();
        let deep = |&slot: &usize| {
            self.id[slot] != PADDING && inside[slot] && self.pairs.neighbours(slot).all(|(j, _)| inside[j])
        };
        let body = |slot: usize| fracture.body[self.id[slot] as usize];
        let bodies: BTreeSet<u32> = (0..self.id.len()).filter(deep).map(body).collect();
        fracture.body.iter().map(|body| bodies.contains(body)).collect()
    }
}
