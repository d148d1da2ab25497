//! The two sides of a cut.
//!
//! They repel as bodies do, k (d - r), but from the distance d on that they have when they are cut, at most dx:
//! nothing pushes at that moment. While they are farther apart d grows with their distance, up to dx. A body does not
//! see itself, so inside of one the whole force is here; between two bodies it is what is to be added to that of
//! their contact, k (dx - r). The same holds for particles that never were neighbours, of a body that was crushed, and
//! are of two from a cut on.

use super::Fracture;
use crate::total_lagrangian::model::TotalLagrangian;
use halfstep_scene::geometry::Cells;
use halfstep_sph::neighbours::PADDING;
use std::collections::BTreeSet;

/// A pair that is cut, by its slots.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub(super) pair: [usize; 2],
    /// d, m.
    pub(super) distance: f64,
}

impl<const D: usize> TotalLagrangian<D> {
    /// Particles that were of one body and now are of two, and closer than bodies come without pushing each other,
    /// begin to push from where they are.
    pub(super) fn face_what_is_near(&mut self, one: &[u32]) {
        let Some(fracture) = self.fracture.as_ref().filter(|fracture| fracture.body != one) else { return };
        let known: BTreeSet<[usize; 2]> = fracture.faces.iter().map(|face| face.pair).collect();
        let mut cells: Cells<usize, D> = Cells::new(self.spacing);
        let mut found = Vec::new();
        for slot in (0..self.id.len()).filter(|&slot| self.id[slot] != PADDING) {
            let (at, p) = (self.position_at(slot), self.id[slot] as usize);
            for &other in cells.around(&at) {
                let (pair, q) = ([other, slot], self.id[other] as usize);
                let parted = one[p] == one[q] && fracture.body[p] != fracture.body[q];
                let distance = self.distance(pair);
                if parted && distance < self.spacing && !known.contains(&pair) {
                    found.push(Face { pair, distance });
                }
            }
            cells.add(&at, slot);
        }
        if let Some(fracture) = &mut self.fracture {
            fracture.faces.extend(found);
        }
    }

    /// Present distance of a pair, m.
    pub(super) fn distance(&self, [i, j]: [usize; 2]) -> f64 {
        let (x, y) = (self.position_at(i), self.position_at(j));
        (0..D).map(|d| (x[d] - y[d]).powi(2)).sum::<f64>().sqrt()
    }

    /// Calls `visit` with the faces that touch: slots, x_ij / r, and the overlaps beside that of bodies in contact,
    /// and of these, m.
    pub(super) fn touching_faces(&self, mut visit: impl FnMut([usize; 2], [f64; D], [f64; 2])) {
        let Some(fracture) = &self.fracture else { return };
        for Face { pair, distance } in &fracture.faces {
            let r = self.distance(*pair);
            if r <= 0.0 || r >= self.spacing {
                continue;
            }
            let [i, j] = *pair;
            let (x, y) = (self.position_at(i), self.position_at(j));
            let bodies = fracture.within_body([self.id[i], self.id[j]]);
            let seen = if bodies { 0.0 } else { self.spacing - r };
            visit(*pair, std::array::from_fn(|d| (x[d] - y[d]) / r), [(distance - r).max(0.0), seen]);
        }
    }

    /// Stiffness of a contact, N/m (2D: N/m²), as between bodies.
    pub(super) fn face_stiffness(&self) -> f64 {
        let modulus = self.material.density * self.material.pressure_wave_speed().powi(2);
        0.5 * modulus * self.spacing.powi(D as i32 - 2)
    }

    /// Accelerations of the first of two slots by faces that touch, m/s².
    pub(in crate::total_lagrangian) fn face_pushes(&self) -> Vec<([usize; 2], [f64; D])> {
        let mut pushes = Vec::new();
        let stiffness = self.face_stiffness() / self.mass;
        self.touching_faces(|pair, along, [own, seen]| {
            pushes.push((pair, along.map(|n| n * (own - seen) * stiffness)));
        });
        pushes
    }

    /// Adds the accelerations of faces that touch.
    pub(in crate::total_lagrangian) fn push_faces(&mut self) {
        for ([i, j], push) in self.face_pushes() {
            for (slot, sign) in [(i, 1.0), (j, -1.0)] {
                if self.is_free(slot) {
                    for d in 0..D {
                        self.now.acceleration[d][slot] += sign * push[d];
                    }
                }
            }
        }
    }

    /// Energy in faces that touch, beside that of bodies in contact, J (2D: J/m).
    pub(in crate::total_lagrangian) fn face_energy(&self) -> f64 {
        let mut sum = 0.0;
        self.touching_faces(|_, _, [own, seen]| sum += own * own - seen * seen);
        0.5 * self.face_stiffness() * sum
    }

    /// What faces that touch inside of bodies add to the square of a particle's highest frequency, 1/s²: the largest
    /// of any particle.
    pub(in crate::total_lagrangian) fn face_springs(&self) -> f64 {
        let mut touched: Vec<usize> = Vec::new();
        self.touching_faces(|pair, _, [own, seen]| {
            if own > 0.0 && seen == 0.0 {
                touched.extend(pair);
            }
        });
        touched.sort_unstable();
        let most = touched.chunk_by(|a, b| a == b).map(<[usize]>::len).max().unwrap_or(0);
        2.0 * self.face_stiffness() / self.mass * most as f64
    }

    /// Faces that are apart recover their distance, at the end of an accepted sub-step.
    pub(in crate::total_lagrangian) fn open_faces(&mut self) {
        let Some(mut fracture) = self.fracture.take() else { return };
        for face in &mut fracture.faces {
            if face.distance < self.spacing {
                face.distance = face.distance.max(self.distance(face.pair).min(self.spacing));
            }
        }
        self.fracture = Some(fracture);
    }
}

impl<const D: usize> Fracture<D> {
    /// Both sides are of one body.
    fn within_body(&self, [a, b]: [u32; 2]) -> bool {
        self.body[a as usize] == self.body[b as usize]
    }
}
