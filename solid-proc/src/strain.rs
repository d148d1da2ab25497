//! Strain of a solid for probes: from the model's own deformation gradient, or from where neighbours have gone.

use crate::model::{Particles, SolidModel};
use crate::total_lagrangian::material::{Matrix, green};
use halfstep_scene::geometry::Cells;
use halfstep_sph::tensor::{determinant, inverse};

/// Neighbours are closer than this in the reference configuration, in spacings: the diagonal of a cell.
const NEIGHBOUR: f64 = 1.5;
/// Part of dx^2D below which neighbours lie in one line.
const FLAT: f64 = 1e-3;

/// Particles of which the mean strain is measured.
pub(crate) struct Strain<const D: usize> {
    /// Each with its neighbours; without any where the model has a gradient of its own.
    particles: Vec<(u32, Vec<u32>)>,
    /// dx, m.
    spacing: f64,
}

impl<const D: usize> Strain<D> {
    /// Of these particles of a model with this spacing, m; `same` says whether two are of one body.
    pub(crate) fn new(
        model: &dyn SolidModel<D>,
        particles: &[u32],
        spacing: f64,
        same: impl Fn(u32, u32) -> bool,
    ) -> Self {
        let places = model.particles().reference;
        let mut all = Cells::new(NEIGHBOUR * spacing);
        (0..places.len() as u32).for_each(|p| all.add(&places[p as usize], p));
        let near = |p: u32| {
            if model.deformation(p).is_some() {
                return Vec::new();
            }
            let close = |&q: &u32| {
                let r2: f64 = difference(&places[q as usize], &places[p as usize]).norm_squared();
                q != p && r2 < (NEIGHBOUR * spacing).powi(2) && same(p, q)
            };
            let mut near: Vec<u32> = all.around(&places[p as usize]).copied().filter(close).collect();
            near.sort_unstable();
            near
        };
        Self { particles: particles.iter().map(|&p| (p, near(p))).collect(), spacing }
    }

    /// Mean of Green's strain; not finite where neighbours do not tell it.
    pub(crate) fn mean(&self, model: &dyn SolidModel<D>) -> Matrix<D> {
        let state = model.particles();
        let of = |(p, near): &(u32, Vec<u32>)| match model.deformation(*p) {
            Some(f) => green(&Matrix::<D>::from_fn(|a, b| f[a][b])),
            None => self.of_neighbours(&state, *p, near),
        };
        let sum = self.particles.iter().map(of).fold(Matrix::zeros(), |sum, strain| sum + strain);
        sum / self.particles.len() as f64
    }

    /// F = (sum r (x) R) (sum R (x) R)^-1, the least squares of r = F R.
    fn of_neighbours(&self, state: &Particles<'_, D>, p: u32, near: &[u32]) -> Matrix<D> {
        let (mut now, mut first) = (Matrix::<D>::zeros(), Matrix::<D>::zeros());
        for &q in near {
            let [p, q] = [p, q].map(|k| k as usize);
            let r = difference(&state.position[q], &state.position[p]);
            let reference = difference(&state.reference[q], &state.reference[p]);
            now += r * reference.transpose();
            first += reference * reference.transpose();
        }
        let determinant = determinant(&first);
        let flat = determinant < FLAT * self.spacing.powi(2 * D as i32);
        match inverse(&first, determinant).filter(|_| !flat) {
            Some(inverse) => green(&(now * inverse)),
            None => Matrix::repeat(f64::NAN),
        }
    }
}

fn difference<const D: usize>(a: &[f64; D], b: &[f64; D]) -> nalgebra::SVector<f64, D> {
    nalgebra::SVector::from_fn(|d, _| a[d] - b[d])
}
