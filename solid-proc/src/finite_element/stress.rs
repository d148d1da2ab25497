//! What an element's stresses are, and what they store.

use super::element::MOST_PATTERNS;
use super::model::FiniteElement;
use crate::columns::Vectors;
use crate::total_lagrangian::material::{Matrix, green};

/// What acts in an element.
pub(super) struct Stressed<const D: usize> {
    /// F.
    pub(super) gradient: Matrix<D>,
    /// J.
    pub(super) volume_ratio: f64,
    /// P, Pa.
    pub(super) stress: Matrix<D>,
    /// Forces on the patterns, N (2D: N/m).
    pub(super) on_patterns: [[f64; D]; MOST_PATTERNS],
}

impl<const D: usize> FiniteElement<D> {
    /// F of an element whose nodes have these displacements, m.
    pub(super) fn gradient_at(&self, p: usize, displacement: &Vectors<D>) -> Matrix<D> {
        Matrix::identity() + self.element.gradient(self.mesh.of(p), displacement)
    }

    /// F and J of such an element.
    pub(super) fn strained(&self, p: usize, displacement: &Vectors<D>) -> (Matrix<D>, f64) {
        let gradient = self.gradient_at(p, displacement);
        (gradient, self.law.volume_ratio(&gradient))
    }

    /// An element whose nodes have these displacements, m, and velocities, m/s.
    pub(super) fn stressed(&self, p: usize, displacement: &Vectors<D>, velocity: &Vectors<D>) -> Stressed<D> {
        let nodes = self.mesh.of(p);
        let (gradient, volume_ratio) = self.strained(p, displacement);
        let mut stress = self.law.first_piola_kirchhoff(&gradient, volume_ratio);
        let patterns = self.element.patterns(nodes, displacement);
        let mut on_patterns = patterns.map(|q| q.map(|q| self.hourglass * q));
        if self.viscosity > 0.0 {
            let (viscous, slowing) = self.viscous(p, &gradient, velocity);
            stress += viscous;
            for (force, more) in on_patterns.iter_mut().zip(slowing) {
                (0..D).for_each(|d| force[d] += more[d]);
            }
        }
        Stressed { gradient, volume_ratio, stress, on_patterns }
    }

    /// P of an implicit step between two gradients, Pa: F in the middle times the stress that belongs to the strain a
    /// part of the way, so that turning does not strain (J. C. Simo and N. Tarnow 1992).
    pub(super) fn stress_over(&self, before: &Matrix<D>, after: &Matrix<D>, part: f64, dt: f64) -> Matrix<D> {
        let (start, middle) = (green(before), (before + after) * 0.5);
        let strained = green(after) - start;
        let viscous = strained * (2.0 * self.viscosity / dt);
        middle * (self.law.second_piola_kirchhoff(&(start + strained * part)) + viscous)
    }

    /// Resistance of the patterns to their rate, N s/m (2D: N s/m²).
    pub(super) fn slowing(&self) -> f64 {
        self.element.hourglass(2.0 * self.viscosity)
    }

    /// Viscous stress of an element, Pa, and forces on its patterns, N (2D: N/m): 2 eta dE/dt for the stress that
    /// belongs to Green's strain E.
    pub(super) fn viscous(
        &self,
        p: usize,
        f: &Matrix<D>,
        velocity: &Vectors<D>,
    ) -> (Matrix<D>, [[f64; D]; MOST_PATTERNS]) {
        let nodes = self.mesh.of(p);
        let rate = self.element.gradient(nodes, velocity);
        let of_strain = f.transpose() * rate;
        let slowing = self.slowing();
        let patterns = self.element.patterns(nodes, velocity);
        (f * (of_strain + of_strain.transpose()) * self.viscosity, patterns.map(|q| q.map(|q| slowing * q)))
    }

    /// Energy that all elements store at these displacements, m, J (2D: J/m).
    pub(super) fn stored(&self, displacement: &Vectors<D>) -> f64 {
        let of = |p: usize| {
            let (f, j) = self.strained(p, displacement);
            self.stored_by(p, &f, j, displacement)
        };
        (0..self.mesh.elements()).map(of).sum()
    }

    /// The same of one element, whose gradient and volume are known.
    pub(super) fn stored_by(&self, p: usize, f: &Matrix<D>, j: f64, displacement: &Vectors<D>) -> f64 {
        let strained = self.element.volume() * self.law.energy(f, j);
        let patterns = self.element.patterns(self.mesh.of(p), displacement);
        strained + 0.5 * self.hourglass * patterns.iter().flatten().map(|q| q * q).sum::<f64>()
    }
}
