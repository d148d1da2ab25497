//! Cuts of pairs, and the bodies that are left.

use super::Fracture;
use super::principal::smallest;
use crate::total_lagrangian::material::Matrix;
use crate::total_lagrangian::model::TotalLagrangian;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::tensor;

/// Part of the smaller of both particles' strains by which a pair has to be stretched to be cut. Across a crack along a
/// row it is stretched by 2 (straight) or 1 (diagonal) of them, along it by nothing.
const STRETCHED: f64 = 0.5;
/// Opening between a broken particle and one that is not, over that with which its band is broken, from which on they
/// are cut: the other would go on pulling with its hourglass resistance. A crack that breaks both is cut before.
pub(super) const LET_GO: f64 = 1.5;
/// Stretch of a pair along a closed crack under pressure, over [`STRETCHED`]'s, from which on it is cut after all: what
/// is crushed spreads without end.
const SPREAD: f64 = 3.0;
/// Largest cosine between the direction of a pressure and a pair that lies across it.
const ACROSS: f64 = 0.5;
/// Smallest determinant of the moment matrix with which a particle that was cut off from neighbours keeps a
/// deformation gradient, over that of a corner of the lattice.
const SMALLEST: f64 = 0.5;
/// Largest volume of a damaged particle over its reference volume, and of the latter over the former: half of what ends
/// a run. A crack that opens is cut at less than twice its volume; beside a rigid clamp, whose band is half as wide, at
/// less than three times.
const VOLUME_CHANGE: f64 = 5.0;
/// Longest pair over dx whose cells share a face.
pub(super) const STRAIGHT: f64 = 1.05;

impl<const D: usize> TotalLagrangian<D> {
    /// A particle is damaged, and its volume has changed more than any law means.
    pub(super) fn is_crushed(&self, slot: usize) -> bool {
        let Some(fracture) = self.fracture.as_ref().filter(|_| self.has_strain(slot)) else { return false };
        let sensible = (1.0 / VOLUME_CHANGE..=VOLUME_CHANGE).contains(&self.volume_ratio[slot]);
        fracture.strain[slot] > 0.0 && !sensible
    }

    /// Pairs that are to be cut in the present state, by their slots, ascending.
    pub(super) fn torn(&self, fracture: &Fracture<D>) -> Vec<[usize; 2]> {
        let mut torn = Vec::new();
        let broken = |slot: usize| fracture.is_broken(slot);
        // A rigid clamp has no damage: the particle beside it decides.
        let rigid = |slot: usize| self.is_rigid(slot);
        let broken_slots: Vec<usize> =
            fracture.damaged.iter().copied().filter(|&slot| broken(slot)).collect();
        for &i in &broken_slots {
            for (j, _) in self.pairs.neighbours(i).filter(|&(j, _)| !(broken(j) && j < i)) {
                let both = broken(j) || rigid(j);
                let strain = if rigid(j) {
                    STRETCHED * fracture.strain[i]
                } else if both {
                    STRETCHED * fracture.strain[i].min(fracture.strain[j])
                } else {
                    // Of an opening a pair of length R shows dx / R.
                    LET_GO * fracture.broken_opening(i) * self.spacing / self.apart(i, j).norm_squared()
                };
                // A row that bends is torn at an edge.
                let mut edges = fracture.ligaments_of(i).iter().filter(|ligament| both && ligament.next == j);
                let stretched = self.is_stretched([i, j], strain)
                    || edges.any(|ligament| self.is_edge_stretched(ligament, strain));
                if stretched && !(broken(j) && self.is_spread(fracture, [i, j], strain)) {
                    torn.push([i.min(j), i.max(j)]);
                }
            }
        }
        self.leave_clamps(fracture, &broken_slots, &mut torn);
        // A particle without a deformation gradient has no stress and no damage that grows: how far a pair of it is
        // stretched tells alone whether it holds.
        for i in (0..self.id.len()).filter(|&slot| fracture.loose > 0 && self.is_loose(slot)) {
            let strain = STRETCHED * fracture.broken_strain(i);
            let stretched = self.pairs.neighbours(i).filter(|&(j, _)| self.is_stretched([i, j], strain));
            torn.extend(stretched.map(|(j, _)| [i.min(j), i.max(j)]));
        }
        for &i in &fracture.crushed {
            torn.extend(self.pairs.neighbours(i).map(|(j, _)| [i.min(j), i.max(j)]));
        }
        torn.sort_unstable();
        torn.dedup();
        torn
    }

    /// The slot has a free particle without a deformation gradient.
    fn is_loose(&self, slot: usize) -> bool {
        self.is_free(slot) && !self.has_strain(slot)
    }

    /// A pair is longer than its reference by more than this strain.
    fn is_stretched(&self, [i, j]: [usize; 2], strain: f64) -> bool {
        let (x, y) = (self.position_at(i), self.position_at(j));
        let present: f64 = (0..D).map(|d| (x[d] - y[d]).powi(2)).sum();
        present > self.apart(i, j).norm_squared() * (1.0 + strain).powi(2)
    }

    /// A pair of broken particles lies along a closed crack under a pressure of more than f_t, which spreads its faces:
    /// they have no strength left, but no crack runs across them before [`SPREAD`] times this strain.
    fn is_spread(&self, fracture: &Fracture<D>, pair: [usize; 2], strain: f64) -> bool {
        let along = self.apart(pair[0], pair[1]).normalize();
        let shortest = 1.0 - fracture.keys.strength / fracture.modulus;
        let pressed = |&slot: &usize| {
            let f = self.gradient[slot];
            let (square, direction) = smallest(&(f.transpose() * f));
            self.has_strain(slot) && square < shortest.powi(2) && direction.dot(&along).abs() < ACROSS
        };
        pair.iter().any(pressed) && !self.is_stretched(pair, SPREAD * strain)
    }

    /// Cuts what is torn in the present state, which has been evaluated, and evaluates what is left.
    pub(in crate::total_lagrangian) fn tear(&mut self) {
        let Some(fracture) = self.fracture.as_ref().filter(|fracture| fracture.accepted) else { return };
        let torn = self.torn(fracture);
        self.forget_crushed();
        if torn.is_empty() {
            return;
        }
        self.sever(torn);
        // What the state without these pairs crushes is found once more in the next sub-step.
        self.forget_crushed();
    }

    fn forget_crushed(&mut self) {
        if let Some(fracture) = &mut self.fracture {
            fracture.crushed.clear();
        }
    }

    /// Cuts these pairs in the present state, which has been evaluated, and evaluates what is left.
    pub(super) fn sever(&mut self, pairs: Vec<[usize; 2]>) {
        let before = self.energy();
        let mut pairs = pairs;
        while !pairs.is_empty() {
            let touched = self.cut(pairs);
            pairs = self.overstrained(&touched);
        }
        self.note_ligaments();
        self.divide();
        let booked = self.taken();
        self.evaluate(0.0);
        // Damage that grew meanwhile is booked.
        let taken = before - self.energy() - (self.taken() - booked);
        self.book(taken);
    }

    /// All pairs of those particles, ascending, that what is left of their neighbours would strain beyond what they
    /// held and could hold at their strength: in a heap of debris it tells nothing of a particle's strain.
    fn overstrained(&mut self, touched: &[usize]) -> Vec<[usize; 2]> {
        let Some(fracture) = &self.fracture else { return Vec::new() };
        let most = self.volume * fracture.keys.strength.powi(2) / (2.0 * fracture.modulus);
        let held: Vec<f64> = touched.iter().map(|&slot| self.stored_at(slot)).collect();
        self.first_pass();
        let mut pairs = Vec::new();
        for (&slot, held) in touched.iter().zip(held) {
            self.gradient[slot] = self.gradient_at(slot);
            self.volume_ratio[slot] = self.law.volume_ratio(&self.gradient[slot]);
            let now = self.stored_at(slot);
            if now.is_nan() || now > held + most {
                pairs.extend(self.pairs.neighbours(slot).map(|(j, _)| [slot.min(j), slot.max(j)]));
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// Cuts pairs, and those that carry nothing any more; the slots that lost one, ascending.
    fn cut(&mut self, mut pairs: Vec<[usize; 2]>) -> Vec<usize> {
        let mut all = Vec::new();
        while !pairs.is_empty() {
            let mut touched = Vec::new();
            for [i, j] in pairs.drain(..) {
                self.pairs.cut(i, j);
                touched.extend([i, j]);
                self.fracture.iter_mut().for_each(|fracture| fracture.cuts.push([i, j]));
            }
            touched.sort_unstable();
            touched.dedup();
            all.extend(&touched);
            let lost: Vec<usize> = touched.into_iter().filter(|&slot| !self.correct_again(slot)).collect();
            for i in lost {
                // Neither of the two has a stress.
                let without = self.pairs.neighbours(i).map(|(j, _)| j).filter(|&j| !self.has_strain(j));
                pairs.extend(without.map(|j| [i.min(j), i.max(j)]));
            }
            pairs.sort_unstable();
            pairs.dedup();
        }
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Area of the faces of cells between which pairs are cut, m² (2D: m).
    pub(super) fn cut_area(&self) -> f64 {
        let Some(fracture) = &self.fracture else { return 0.0 };
        let counts = |&&[i, j]: &&[usize; 2]| {
            fracture.irregular.is_some() || self.apart(i, j).norm() < STRAIGHT * self.spacing
        };
        fracture.face * fracture.cuts.iter().filter(counts).count() as f64
    }

    /// Area for which each pair that a cut crosses stands in an arrangement without directions, m² (2D: m): a plane
    /// somewhere in a volume V crosses sum |cos| R / V pairs for each m² of it, |cos| being 2 / pi in the mean, in
    /// space 1 / 2 (Buffon; Cauchy).
    pub(super) fn face_of_a_pair(&self) -> f64 {
        let cosine = if D == 2 { 2.0 / std::f64::consts::PI } else { 0.5 };
        let real = || (0..self.id.len()).filter(|&slot| self.id[slot] != PADDING);
        // Each pair comes twice.
        let lengths = |slot: usize| self.pairs.neighbours(slot).map(move |(j, _)| self.apart(slot, j).norm());
        let sum = 0.5 * real().flat_map(lengths).sum::<f64>();
        self.volume * real().count() as f64 / (cosine * sum)
    }

    /// M of a slot.
    pub(super) fn moment(&self, slot: usize) -> Matrix<D> {
        let weighted = |(j, slope): (usize, f64)| {
            let x = self.apart(slot, j);
            x * x.transpose() * (-self.volume * slope)
        };
        self.pairs.neighbours(slot).map(weighted).fold(Matrix::zeros(), |sum, of_pair| sum + of_pair)
    }

    /// The moment matrix of a particle that was cut off from neighbours: whether it is free and has lost its
    /// deformation gradient is told by `false`.
    pub(super) fn correct_again(&mut self, slot: usize) -> bool {
        if self.is_rigid(slot) {
            return true;
        }
        let moment = self.moment(slot);
        let corner = self.fracture.as_ref().map_or(1.0, Fracture::corner);
        let enough = tensor::determinant(&moment) >= SMALLEST * corner;
        let correction = tensor::moment_inverse(&moment).filter(|_| enough);
        self.correction[slot] = correction.unwrap_or_else(Matrix::zeros);
        self.soften(slot);
        correction.is_some()
    }

    /// Finds the bodies that pairs still connect, and lets them and the sides of cuts touch.
    pub(super) fn divide(&mut self) {
        let Some(mut fracture) = self.fracture.take() else { return };
        let mut parent: Vec<u32> = (0..self.slot_of.len() as u32).collect();
        for i in (0..self.id.len()).filter(|&slot| self.id[slot] != PADDING) {
            for (j, _) in self.pairs.neighbours(i) {
                let (a, b) = (root(&mut parent, self.id[i]), root(&mut parent, self.id[j]));
                parent[a.max(b) as usize] = a.min(b);
            }
        }
        // Numbers in the order of the bodies' first particles.
        let mut count = 0;
        for p in 0..parent.len() {
            let first = root(&mut parent, p as u32) as usize;
            fracture.body[p] = if first == p { count } else { fracture.body[first] };
            count += u32::from(first == p);
        }
        fracture.bodies = count;
        fracture.loose = (0..self.id.len()).filter(|&slot| self.is_loose(slot)).count() as u32;
        fracture.thin = self.thin(&fracture);
        let mut contact = self.contact.take().or_else(|| fracture.dormant.take());
        if let Some(contact) = &mut contact {
            let cuts = fracture.cuts.iter().map(|pair| pair.map(|slot| self.id[slot]));
            let within = cuts.filter(|pair| fracture.within_body(*pair));
            contact.divide(self.isa, &fracture.body, within, |id| self.present(id));
        }
        self.contact = contact;
        self.fracture = Some(fracture);
    }
}

impl<const D: usize> Fracture<D> {
    /// Both particles are of one body.
    fn within_body(&self, [a, b]: [u32; 2]) -> bool {
        self.body[a as usize] == self.body[b as usize]
    }

    /// det M of a corner. In the plane it is 0.71 to 1 times a quarter of that inside, whatever the kernel, which lets
    /// every corner keep its gradient; in space 0.40 to 0.97 times an eighth.
    fn corner(&self) -> f64 {
        let part = 0.5_f64.powi(D as i32) * self.inside;
        if D == 2 { part } else { part.min(self.corner) }
    }
}

fn root(parent: &mut [u32], mut p: u32) -> u32 {
    while parent[p as usize] != p {
        parent[p as usize] = parent[parent[p as usize] as usize];
        p = parent[p as usize];
    }
    p
}
