//! Faces of a crack inside a body: a body does not see itself, so what a cut leaves opposite each other repels as
//! bodies do, from the distance on that it had before.

use super::Fracture;
use crate::total_lagrangian::model::TotalLagrangian;

/// Two particles whose cells shared a face, by their slots.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) pair: [usize; 2],
    /// Their distance in the reference configuration, m.
    pub(super) distance: f64,
}

impl<const D: usize> Fracture<D> {
    /// Both sides are of one body: else bodies repel each other.
    fn within_body(&self, [a, b]: [u32; 2]) -> bool {
        self.body[a as usize] == self.body[b as usize]
    }
}

impl<const D: usize> TotalLagrangian<D> {
    /// Calls `visit` with the faces that touch: slots, x_ij / r, overlap in m.
    fn touching_faces(&self, mut visit: impl FnMut([usize; 2], [f64; D], f64)) {
        let Some(fracture) = &self.fracture else { return };
        for Face { pair, distance } in &fracture.faces {
            let [i, j] = *pair;
            if !fracture.within_body([self.id[i], self.id[j]]) {
                continue;
            }
            let (x, y) = (self.position_at(i), self.position_at(j));
            let apart: [f64; D] = std::array::from_fn(|d| x[d] - y[d]);
            let r = apart.iter().map(|x| x * x).sum::<f64>().sqrt();
            if r > 0.0 && r < *distance {
                visit(*pair, apart.map(|x| x / r), distance - r);
            }
        }
    }

    /// Stiffness of a contact, N/m (2D: N/m²), as between bodies.
    fn face_stiffness(&self) -> f64 {
        let modulus = self.material.density * self.material.pressure_wave_speed().powi(2);
        0.5 * modulus * self.spacing.powi(D as i32 - 2)
    }

    /// Adds the accelerations of faces that touch.
    pub(in crate::total_lagrangian) fn push_faces(&mut self) {
        let mut pushes = Vec::new();
        let stiffness = self.face_stiffness() / self.mass;
        self.touching_faces(|pair, along, overlap| pushes.push((pair, along.map(|n| n * overlap * stiffness))));
        for ([i, j], push) in pushes {
            for (slot, sign) in [(i, 1.0), (j, -1.0)] {
                if self.is_free(slot) {
                    for d in 0..D {
                        self.now.acceleration[d][slot] += sign * push[d];
                    }
                }
            }
        }
    }

    /// Energy in faces that touch, J (2D: J/m).
    pub(in crate::total_lagrangian) fn face_energy(&self) -> f64 {
        let mut sum = 0.0;
        self.touching_faces(|_, _, overlap| sum += overlap * overlap);
        0.5 * self.face_stiffness() * sum
    }

    /// What faces that touch add to the square of a particle's highest frequency, 1/s²: the largest of any particle.
    pub(in crate::total_lagrangian) fn face_springs(&self) -> f64 {
        let mut touched: Vec<usize> = Vec::new();
        self.touching_faces(|pair, _, _| touched.extend(pair));
        touched.sort_unstable();
        let most = touched.chunk_by(|a, b| a == b).map(<[usize]>::len).max().unwrap_or(0);
        2.0 * self.face_stiffness() / self.mass * most as f64
    }
}
