//! Columns of the solid particles.

use crate::columns::{Tensors, Vectors, tensors, vectors};
use halfstep_scene::geometry::SolidPoint;
use halfstep_sph::columns::fit;
use halfstep_sph::neighbours::Rows;

/// What time integration advances.
#[derive(Clone, Debug)]
pub(super) struct State<const D: usize> {
    /// Position, m.
    pub position: Vectors<D>,
    /// Velocity, m/s.
    pub velocity: Vectors<D>,
    /// Density, kg/m³.
    pub density: Vec<f64>,
    /// Deviatoric stress, Pa. In 2D s_zz = -(s_xx + s_yy).
    pub stress: Tensors<D>,
}

impl<const D: usize> State<D> {
    pub(super) fn new(points: &[SolidPoint<D>], density: f64) -> Self {
        let n = points.len();
        let mut state = Self {
            position: vectors(n),
            velocity: vectors(n),
            density: vec![density; n],
            stress: tensors(n),
        };
        for (i, p) in points.iter().enumerate() {
            for d in 0..D {
                state.position[d][i] = p.position[d];
                state.velocity[d][i] = if p.clamped { 0.0 } else { p.velocity[d] };
            }
        }
        state
    }

    pub(super) fn permute(&mut self, rows: &mut Rows<D>) {
        for d in 0..D {
            rows.permute(&mut self.position[d]);
            rows.permute(&mut self.velocity[d]);
            for b in d..D {
                rows.permute(&mut self.stress[d][b]);
            }
        }
        rows.permute(&mut self.density);
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        for d in 0..D {
            self.position[d].clone_from(&other.position[d]);
            self.velocity[d].clone_from(&other.velocity[d]);
            for b in d..D {
                self.stress[d][b].clone_from(&other.stress[d][b]);
            }
        }
        self.density.clone_from(&other.density);
    }
}

/// What the pair pass reads of one neighbour, side by side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Velocity, m/s.
    pub velocity: [f64; D],
    /// Density rho, kg/m³.
    pub density: f64,
    /// m / rho, m³ (2D: m²).
    pub volume: f64,
    /// sigma / rho².
    pub stress_term: [[f64; D]; D],
}

impl<const D: usize> Source<D> {
    pub(super) const ZERO: Self = Self {
        position: [0.0; D],
        velocity: [0.0; D],
        density: 0.0,
        volume: 0.0,
        stress_term: [[0.0; D]; D],
    };
}

/// Rates of a [`State`].
#[derive(Clone, Debug)]
pub(super) struct Rates<const D: usize> {
    /// m/s².
    pub acceleration: Vectors<D>,
    /// kg/(m³ s).
    pub density: Vec<f64>,
    /// Pa/s.
    pub stress: Tensors<D>,
}

impl<const D: usize> Rates<D> {
    pub(super) fn new() -> Self {
        Self { acceleration: vectors(0), density: Vec::new(), stress: tensors(0) }
    }

    pub(super) fn resize(&mut self, n: usize) {
        for d in 0..D {
            fit(&mut self.acceleration[d], n, 0.0);
            for b in d..D {
                fit(&mut self.stress[d][b], n, 0.0);
            }
        }
        fit(&mut self.density, n, 0.0);
    }
}
