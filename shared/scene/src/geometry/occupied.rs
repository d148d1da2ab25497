//! Which places earlier shapes have taken.

use super::TOLERANCE;
use super::cells::Cells;
use super::points::Spacing;
use super::region::Region;
use crate::Phase;

/// A particle's position and its spacing, m.
type Placed<const D: usize> = ([f64; D], f64);

/// The shapes placed so far, and their particles, each with its spacing, in cells of side dx.
pub(super) struct Occupied<'s, const D: usize> {
    /// No smaller than any spacing, m.
    dx: f64,
    taken: Vec<(Region<'s>, Spacing, Phase)>,
    cells: Cells<Placed<D>, D>,
}

impl<'s, const D: usize> Occupied<'s, D> {
    pub(super) fn new(dx: f64) -> Self {
        Self { dx, taken: Vec::new(), cells: Cells::new(dx) }
    }

    /// Takes a shape's places.
    pub(super) fn add(
        &mut self,
        region: Region<'s>,
        spacing: Spacing,
        phase: Phase,
        positions: impl Iterator<Item = [f64; D]>,
    ) {
        for position in positions {
            self.cells.add(&position, (position, spacing.dx));
        }
        self.taken.push((region, spacing, phase));
    }

    /// Whether no shape holds this place and no particle is closer than half the mean of its spacing and `own`, m.
    pub(super) fn is_free(&self, position: &[f64; D], own: f64) -> bool {
        if self.taken.is_empty() {
            return true;
        }
        let inside = self.taken.iter().any(|(region, spacing, phase)| {
            // A wall's surface is its own, as it carries the wall's nodes.
            let margin = if *phase == Phase::Wall && spacing.nodal { TOLERANCE } else { -TOLERANCE };
            region.contains(position, margin * self.dx)
        });
        !inside && !self.has_neighbour(position, own)
    }

    fn has_neighbour(&self, position: &[f64; D], own: f64) -> bool {
        self.cells.around(position).any(|(p, spacing)| {
            let limit = (0.5 - TOLERANCE) * 0.5 * (own + spacing);
            (0..D).map(|a| (p[a] - position[a]).powi(2)).sum::<f64>() < limit * limit
        })
    }
}
