//! The principal tension at a particle, and at the surface above it.
//!
//! The outermost of n rows across a plate lies half a spacing under the surface and sees 1 - 1/n of its tension in
//! bending. A linear field through it and its neighbours, fitted with the weights of the deformation gradient, carries
//! the stress to the surface: exact where stress varies linearly.

use super::principal::largest;
use crate::total_lagrangian::material::Matrix;
use crate::total_lagrangian::model::TotalLagrangian;
use halfstep_sph::tensor;
use nalgebra::SVector;

/// Most that the tension at the surface is over the particle's: that of two rows.
const LARGEST: f64 = 2.0;
/// Share of a flat surface's missing neighbours from which on a particle lies under a surface.
const LEAST: f64 = 0.5;

impl<const D: usize> TotalLagrangian<D> {
    /// X_i - X_j.
    pub(super) fn apart(&self, i: usize, j: usize) -> SVector<f64, D> {
        let x = self.pairs.position();
        SVector::from_fn(|d, _| x[d][i] - x[d][j])
    }

    /// From a particle under the intact surface to the surface, m; zero inside, where det M is `inside`.
    pub(super) fn outward(&self, slot: usize, inside: f64) -> [f64; D] {
        if !self.is_free(slot) {
            return [0.0; D];
        }
        let mut sum = SVector::<f64, D>::zeros();
        for (j, slope) in self.pairs.neighbours(slot) {
            sum -= self.apart(slot, j) * (self.volume * slope);
        }
        // A row that is missing leaves M / (2 dx), M^D = det M.
        let size = sum.norm();
        let missing = if D == 2 { inside.sqrt() } else { libm::cbrt(inside) } / (2.0 * self.spacing);
        let outward = size > LEAST * missing;
        std::array::from_fn(|d| if outward { 0.5 * self.spacing * sum[d] / size } else { 0.0 })
    }

    /// Stress of the undamaged law, Pa.
    fn effective(&self, slot: usize) -> Matrix<D> {
        self.effective_of(&self.gradient[slot], self.volume_ratio[slot])
    }

    /// The same of F and J.
    pub(super) fn effective_of(&self, f: &Matrix<D>, j: f64) -> Matrix<D> {
        let cauchy = self.law.cauchy(f, j);
        cauchy.deviator - Matrix::identity() * cauchy.pressure
    }

    /// Principal tension of the undamaged law, Pa.
    #[cfg(test)]
    pub(super) fn tension(&self, slot: usize) -> f64 {
        largest(&self.effective(slot))
    }

    /// The tension at the surface over that at the particle, 1 to 2; `outward` leads to the surface, m.
    pub(super) fn at_surface(&self, slot: usize, outward: &[f64; D]) -> f64 {
        let own = self.effective(slot);
        let (mut moment, mut change) = (Matrix::<D>::zeros(), Vec::new());
        for (j, slope) in self.pairs.neighbours(slot) {
            if self.has_strain(j) {
                let (x, weight) = (self.apart(j, slot), -self.volume * slope);
                moment += x * x.transpose() * weight;
                change.push((x * weight, self.effective(j) - own));
            }
        }
        let Some(inverse) = tensor::moment_inverse(&moment) else { return 1.0 };
        let way = inverse * SVector::from(*outward);
        let carried = change.iter().fold(own, |sum, (x, change)| sum + change * x.dot(&way));
        let (inner, outer) = (largest(&own), largest(&carried));
        if inner > 0.0 { (outer / inner).clamp(1.0, LARGEST) } else { 1.0 }
    }

    /// The particle has a deformation gradient.
    pub(super) fn has_strain(&self, slot: usize) -> bool {
        self.correction[slot] != Matrix::<D>::zeros()
    }
}
