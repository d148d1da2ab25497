//! Damage grows at the end of an accepted sub-step, from the deformation gradients of its state.

use super::Fracture;
use super::principal::largest;
use crate::total_lagrangian::evaluate::at;
use crate::total_lagrangian::material::Matrix;
use crate::total_lagrangian::model::TotalLagrangian;
use halfstep_scene::EnergyPart;
use halfstep_sph::lane::LANES;

/// What damage leaves of the hourglass resistance: the sixteenth power of 1 - d. It would stiffen the band of a crack,
/// where neighbours move against each other; so it goes long before the stress does.
fn resistance(damage: f64) -> f64 {
    let left = 1.0 - damage;
    let (fourth, square) = (left * left * left * left, |x: f64| x * x);
    square(square(fourth))
}

/// What pulls at a particle.
struct Pulled {
    /// Principal tension of the undamaged law, Pa.
    tension: f64,
    /// The largest principal stretch.
    stretch: f64,
    /// J.
    volume_ratio: f64,
    /// At an edge of a last row, not in its middle.
    at_edge: bool,
}

/// Where a particle is on its softening curve.
struct Point {
    /// e0.
    onset: f64,
    /// Its largest principal stretch when damage began, at e0; beside a clamp with the opening on the free side added.
    begun: f64,
    /// e: the largest strain that it has had.
    strain: f64,
    /// d.
    damage: f64,
}

impl<const D: usize> Fracture<D> {
    fn point(&self, slot: usize) -> Point {
        let [onset, begun, strain, damage] =
            [&self.onset, &self.begun, &self.strain, &self.damage].map(|column| column[slot]);
        Point { onset, begun, strain, damage }
    }

    fn set(&mut self, slot: usize, point: &Point) {
        self.onset[slot] = point.onset;
        self.begun[slot] = point.begun;
        self.strain[slot] = point.strain;
        self.damage[slot] = point.damage;
    }

    /// Norm of P, Pa, squared, below which nothing happens to an intact particle: at a surface twice the tension.
    pub(in crate::total_lagrangian) fn screen(&self) -> f64 {
        if self.accepted { 0.2 * self.keys.strength * self.keys.strength } else { f64::INFINITY }
    }
}

impl<const D: usize> TotalLagrangian<D> {
    /// P of a slot, with its damage.
    #[inline(always)]
    pub(in crate::total_lagrangian) fn stress_at(&self, slot: usize, f: &Matrix<D>, j: f64) -> Matrix<D> {
        match self.damage_at(slot) {
            d if d > 0.0 => self.law.damaged(f, j, d).stress,
            _ => self.law.first_piola_kirchhoff(f, j),
        }
    }

    /// Damage grows in these particles, ascending, whose stresses are those of the state, and in last rows.
    pub(in crate::total_lagrangian) fn grow(&mut self, mut candidates: Vec<usize>) {
        let Some(fracture) = &self.fracture else { return };
        if fracture.accepted && !fracture.ligaments.is_empty() {
            candidates.extend(fracture.ligaments.iter().map(|ligament| ligament.slot));
            candidates.sort_unstable();
            candidates.dedup();
        }
        if candidates.is_empty() {
            return;
        }
        let crushed: Vec<usize> = candidates.iter().copied().filter(|&slot| self.is_crushed(slot)).collect();
        if let Some(fracture) = &mut self.fracture {
            fracture.crushed = crushed;
        }
        let Some(fracture) = &self.fracture else { return };
        let mut grown = Vec::new();
        for &slot in candidates.iter().filter(|&&slot| self.has_strain(slot)) {
            let Pulled { tension, stretch, volume_ratio, at_edge } = self.pulled(slot, fracture);
            let begins = if fracture.strain[slot] > 0.0 {
                None
            } else {
                let outward = &fracture.outward[slot];
                let ratio =
                    if at_edge || *outward == [0.0; D] { 1.0 } else { self.at_surface(slot, outward) };
                if ratio * tension <= fracture.keys.strength {
                    continue;
                }
                Some(fracture.keys.strength / (ratio * fracture.modulus))
            };
            // Of the particle's middle, also where an edge decides.
            let inside =
                self.opening_inside(slot, (1.0 - fracture.damage[slot]) * tension / fracture.modulus);
            let mut point = match begins {
                Some(onset) => Point { onset, begun: stretch + inside, strain: onset, damage: 0.0 },
                None => fracture.point(slot),
            };
            // A force over the area that it had.
            let nominal = tension * volume_ratio / stretch;
            // What a squeeze stretches across it is no opening: the law of the whole has no tension there.
            let share = if inside > 0.0 { (inside / (stretch - 1.0)).min(1.0) } else { 0.0 };
            let strain = (tension / fracture.modulus * (1.0 + share))
                .min(point.onset + stretch + inside - point.begun);
            point.strain = point.strain.max(strain);
            let damage = 1.0 - fracture.law(slot, point.onset).tension(point.strain) / nominal;
            if nominal > 0.0 && damage > point.damage {
                grown.push((slot, Point { damage, ..point }));
            }
        }
        for (slot, point) in grown {
            let before = self.stored_at(slot);
            let Some(fracture) = &mut self.fracture else { return };
            if fracture.strain[slot] == 0.0 {
                let place = fracture.damaged.partition_point(|&other| other < slot);
                fracture.damaged.insert(place, slot);
            }
            let (old, damage, last) = (fracture.damage[slot], point.damage, fracture.last[slot]);
            fracture.set(slot, &point);
            self.soften(slot);
            let after = before - self.stored_at(slot);
            // Over the sub-step, in which the strain went from the last one to the present one: for e² the velocity
            // Verlet scheme takes the geometric mean, exactly.
            let [last, present] =
                [last, self.gradient[slot]].map(|f| self.lost_by(&f, [old, damage]).max(0.0));
            let taken = after - present + (last * present).sqrt();
            self.book(taken);
            let (f, j) = (self.gradient[slot], self.volume_ratio[slot]);
            let correction = self.correction[slot];
            let h = at(&self.deformations[slot / LANES].gradient, slot % LANES) * correction;
            let bracket = self.stress_at(slot, &f, j) * correction - h * self.hourglass[slot];
            self.set_bracket(slot, &bracket);
        }
    }

    /// What pulls at a particle: of one in the last row beside a crack the more at an edge of it.
    fn pulled(&self, slot: usize, fracture: &Fracture<D>) -> Pulled {
        let own = self.pulled_by(&self.gradient[slot], self.volume_ratio[slot], false);
        let edges = fracture.ligaments_of(slot).iter().flat_map(|ligament| self.at_edges(ligament));
        let at = |f: Matrix<D>| {
            let j = self.law.volume_ratio(&f);
            (j > 0.0).then(|| self.pulled_by(&f, j, true))
        };
        edges.filter_map(at).fold(own, |most, edge| if edge.tension > most.tension { edge } else { most })
    }

    fn pulled_by(&self, f: &Matrix<D>, volume_ratio: f64, at_edge: bool) -> Pulled {
        let stretch = largest(&(f.transpose() * f)).sqrt();
        Pulled { tension: largest(&self.effective_of(f, volume_ratio)), stretch, volume_ratio, at_edge }
    }

    /// Strain energy that damage takes from a particle at F, J, by growing.
    fn lost_by(&self, f: &Matrix<D>, damage: [f64; 2]) -> f64 {
        let j = self.law.volume_ratio(f);
        let [before, after] = damage.map(|d| self.law.damaged(f, j, d).energy);
        self.volume * (before - after)
    }

    /// Keeps F, at the end of an accepted sub-step or of a checkpoint's.
    pub(in crate::total_lagrangian) fn keep_gradients(&mut self) {
        if let Some(fracture) = &mut self.fracture {
            fracture.last.clone_from(&self.gradient);
        }
    }

    /// The hourglass resistance that damage leaves.
    pub(super) fn soften(&mut self, slot: usize) {
        let left = if self.has_strain(slot) { resistance(self.damage_at(slot)) } else { 0.0 };
        self.hourglass[slot] = left * self.hourglass_modulus;
    }

    /// What fracture has taken so far, J (2D: J/m).
    pub(super) fn taken(&self) -> f64 {
        self.fracture.as_ref().map_or(0.0, |fracture| fracture.taken)
    }

    /// Notes energy that fracture took, J (2D: J/m).
    pub(super) fn book(&mut self, taken: f64) {
        if let Some(fracture) = &mut self.fracture {
            fracture.taken += taken;
        }
        if let Some(account) = self.account.as_mut().filter(|account| account.given.open) {
            account.given.give(EnergyPart::Fracture, -taken);
        }
    }
}
