//! Columns of vectors and tensors, and the columns by particle number that a model shows.

use crate::model::Particles;
use halfstep_scene::geometry::SolidPoint;

pub(crate) use halfstep_sph::columns::{Vectors, vectors};

/// Symmetric tensors; a <= b filled.
pub(crate) type Tensors<const D: usize> = [[Vec<f64>; D]; D];

/// Columns of `n` zeros for a symmetric tensor.
pub(crate) fn tensors<const D: usize>(n: usize) -> Tensors<D> {
    std::array::from_fn(|a| std::array::from_fn(|b| if a <= b { vec![0.0; n] } else { Vec::new() }))
}

/// The vector of a slot.
pub(crate) fn vector<const D: usize>(columns: &Vectors<D>, slot: u32) -> [f64; D] {
    std::array::from_fn(|d| columns[d][slot as usize])
}

/// What [`Particles`] views.
pub(crate) struct ParticleColumns<const D: usize> {
    reference: Vec<[f64; D]>,
    pub(crate) position: Vec<[f64; D]>,
    pub(crate) velocity: Vec<[f64; D]>,
    pub(crate) density: Vec<f64>,
    mass: Vec<f64>,
}

impl<const D: usize> ParticleColumns<D> {
    /// Particles of this mass each, kg (2D: kg/m), where the scene begins with them.
    pub(crate) fn new(points: &[SolidPoint<D>], mass: f64) -> Self {
        let reference: Vec<[f64; D]> = points.iter().map(|p| p.position).collect();
        let n = reference.len();
        Self {
            position: reference.clone(),
            reference,
            velocity: vec![[0.0; D]; n],
            density: vec![0.0; n],
            mass: vec![mass; n],
        }
    }

    pub(crate) fn view(&self) -> Particles<'_, D> {
        Particles {
            reference: &self.reference,
            position: &self.position,
            velocity: &self.velocity,
            density: &self.density,
            mass: &self.mass,
        }
    }
}
