//! Fragments thinner than 4h - dx of the fluid where the solid was thicker. The fluid's kernel reaches through them,
//! and only what was so thin from the start is screened: they show each face a mean of both pressures.

use super::Fracture;
use crate::surface;
use crate::total_lagrangian::model::TotalLagrangian;
use halfstep_scene::Scene;
use halfstep_sph::neighbours::PADDING;
use std::collections::BTreeSet;

/// Rows of a solid of its own spacing `dx`, m, that are as thick as 4h - dx of the scene, of an even number one more;
/// without fluid of a scene with h = 1.5 dx.
pub(super) fn rows_of_a_thick_body(scene: &Scene, dx: f64) -> usize {
    const ROUNDING: f64 = 1e-9;
    if scene.fluid.is_none() {
        return 5;
    }
    let rows =
        ((4.0 * scene.smoothing_ratio - 1.0) * scene.resolution / dx * (1.0 - ROUNDING)).ceil() as usize;
    // Layer by layer from both faces an odd number is left.
    rows | 1
}

impl<const D: usize> TotalLagrangian<D> {
    /// Notes which particles begin in thick bodies.
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

    /// Whether each particle's body has as many rows as a thick one somewhere: a particle all of whose neighbours lack
    /// none for five rows, those of whose neighbours lack none for seven, and so on.
    fn thick(&self, fracture: &Fracture<D>) -> Vec<bool> {
        let lacks_none = |slot: usize| self.pairs.neighbours(slot).count() == fracture.whole[slot];
        let real = |slot: &usize| self.id[*slot] != PADDING;
        let slots = || 0..self.id.len();
        let mut inside: Vec<bool> = slots().map(lacks_none).collect();
        for _ in 1..fracture.thick_rows / 2 {
            let deeper = |slot: usize| inside[slot] && self.pairs.neighbours(slot).all(|(j, _)| inside[j]);
            inside = slots().map(deeper).collect();
        }
        let body = |slot: usize| fracture.body[self.id[slot] as usize];
        let bodies: BTreeSet<u32> = slots().filter(real).filter(|&slot| inside[slot]).map(body).collect();
        fracture.body.iter().map(|body| bodies.contains(body)).collect()
    }
}
