//! Inner acceleration of a state: deformation gradient, stress, momentum, contacts.

use super::contact::{Contact, Present};
use super::fracture::Fracture;
use super::material::{Cauchy, Matrix};
use super::model::TotalLagrangian;
use super::pass::{Damping, Deformation, DeformationSum, Moment, MomentSum, Momentum, Viscous};
use super::relaxation::Arms;
use halfstep_role::role::{Costs, fastest};
use halfstep_scene::{ArtificialViscosity, EffectName, EnergyPart};
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::{pair, tensor};

pub(super) fn at<const D: usize>(entries: &[[halfstep_sph::lane::Lane; D]; D], k: usize) -> Matrix<D> {
    Matrix::from_fn(|a, b| entries[a][b].0[k])
}

impl<const D: usize> TotalLagrangian<D> {
    /// Inverse moment matrices: zero where singular, so that F = I and no stress.
    pub(super) fn correct(&mut self) {
        let mut moments = vec![MomentSum::default(); self.deformations.len()];
        pair::fixed_pass(self.isa, &Moment { volume: self.volume }, &self.pairs, &mut moments);
        self.pair_evaluations += self.evaluations();
        for slot in 0..self.id.len() {
            let sum = &moments[slot / LANES];
            let moment = Matrix::<D>::from_fn(|a, b| sum.0[a.min(b)][a.max(b)].0[slot % LANES]);
            // A clamped particle is rigid: it has neither strain nor error vectors. Nor has one that lacks neighbours.
            let correction = tensor::moment_inverse(&moment).filter(|_| !self.is_rigid(slot));
            self.hourglass[slot] = if correction.is_some() { self.hourglass_modulus } else { 0.0 };
            self.correction[slot] = correction.unwrap_or_else(Matrix::zeros);
        }
    }

    /// The slot has a particle of a rigid clamp.
    pub(super) fn is_rigid(&self, slot: usize) -> bool {
        self.rigid_clamps && self.fixed.clamped[slot] != 0.0
    }

    /// Pairs that a pass evaluates.
    fn evaluations(&self) -> u64 {
        self.pairs.list().pairs() as u64
    }

    /// The sums of the first pass.
    pub(super) fn first_pass(&mut self) {
        let law =
            Deformation { fixed: &self.fixed, displacement: &self.now.displacement, volume: self.volume };
        pair::fixed_pass(self.isa, &law, &self.pairs, &mut self.deformations);
        self.pair_evaluations += self.evaluations();
    }

    /// F of a slot from the sums of the first pass.
    pub(super) fn gradient_at(&self, slot: usize) -> Matrix<D> {
        let h = at(&self.deformations[slot / LANES].gradient, slot % LANES) * self.correction[slot];
        Matrix::identity() + h
    }

    fn momentum<V: Damping<D>>(&self, damping: V, sums: &mut [super::pass::Acceleration<D>]) {
        let law = Momentum {
            damping,
            fixed: &self.fixed,
            displacement: &self.now.displacement,
            stress: &self.bracket,
            hourglass: &self.hourglass,
            scale: self.volume / self.material.density,
        };
        pair::fixed_pass(self.isa, &law, &self.pairs, sums);
    }

    /// B of a slot, Pa.
    pub(super) fn set_bracket(&mut self, slot: usize, bracket: &Matrix<D>) {
        for a in 0..D {
            for b in 0..D {
                self.bracket[a][b][slot] = bracket[(a, b)];
            }
        }
    }

    /// Cauchy stress at a slot.
    pub(super) fn cauchy(&self, slot: usize) -> Cauchy<D> {
        let (f, j) = (&self.gradient[slot], self.volume_ratio[slot]);
        let cauchy = match self.damage_at(slot) {
            d if d > 0.0 => self.law.damaged_cauchy(f, j, d),
            _ => self.law.cauchy(f, j),
        };
        self.memory.added_to(cauchy, slot, f, j)
    }

    /// Acceleration of the present state, `elapsed` (s) after the one before, by everything but loads and gravity.
    pub(super) fn evaluate(&mut self, elapsed: f64) {
        self.first_pass();
        if self.arms.is_empty() {
            self.stresses(&mut ());
        } else {
            let mut memory = std::mem::take(&mut self.memory);
            let arms = std::mem::take(&mut self.arms);
            let shear_modulus = self.material.shear_modulus();
            let mut relaxation = Arms::over(elapsed, &arms, shear_modulus, &mut memory);
            let accounted = self.keeps_account();
            if accounted {
                relaxation = relaxation.with_account(elapsed, &arms);
            }
            self.stresses(&mut relaxation);
            let lost = self.volume * relaxation.lost();
            if let Some(account) = self.account.as_mut().filter(|_| accounted) {
                account.given.give(EnergyPart::Relaxation, -lost);
            }
            (self.memory, self.arms) = (memory, arms);
        }
        let mut sums = std::mem::take(&mut self.sums);
        match self.damping() {
            Some(viscous) => self.momentum(viscous, &mut sums),
            None => self.momentum((), &mut sums),
        }
        self.keep_out_of_clamps(&mut sums);
        for slot in 0..self.id.len() {
            let free = self.id[slot] != PADDING && self.fixed.clamped[slot] == 0.0;
            for d in 0..D {
                let a = sums[slot / LANES].0[d].0[slot % LANES];
                self.now.acceleration[d][slot] = if free { a } else { 0.0 };
            }
        }
        self.sums = sums;
        if let Some(contact) = self.contact.take() {
            self.contact = Some(self.touch(contact));
        }
        self.note_rubbing();
    }

    /// The artificial viscosity of the present velocities.
    pub(super) fn damping(&self) -> Option<Viscous<'_, D>> {
        let viscosity = self.material.artificial_viscosity;
        (viscosity.linear > 0.0 || viscosity.quadratic > 0.0).then(|| Viscous {
            velocity: &self.now.velocity,
            smoothing_length: self.smoothing_length,
            density: self.material.density,
            linear: viscosity.linear * self.material.sound_speed(),
            quadratic: viscosity.quadratic,
        })
    }

    /// Where a particle is now, and how fast.
    pub(super) fn present(&self, id: u32) -> Present<D> {
        let slot = self.slot_of[id as usize] as usize;
        Present {
            position: self.position_at(slot),
            velocity: std::array::from_fn(|d| self.now.velocity[d][slot]),
        }
    }

    fn touch(&mut self, mut contact: Contact<D>) -> Contact<D> {
        contact.update(|id| self.present(id));
        contact.act(self.isa, &self.material);
        contact.accelerations(|id, a| {
            let slot = self.slot_of[id as usize] as usize;
            if self.fixed.clamped[slot] == 0.0 {
                for d in 0..D {
                    self.now.acceleration[d][slot] += a[d];
                }
            }
        });
        contact
    }

    /// Parts of an evaluation's time, each effect's measured by leaving it out. The hourglass force and the clamps'
    /// gain are factors of the passes: there is nothing to leave out.
    pub(super) fn costs_of_effects(&mut self) -> Costs {
        let (before, state, memory) = (self.pair_evaluations, self.now.clone(), self.memory.clone());
        let evaluation = |model: &mut Self| fastest(|| model.evaluate(0.0));
        let mut costs = Costs::default();
        // Damage does not grow where it has grown: it is looked for only.
        self.fracture.iter_mut().for_each(|fracture| {
            fracture.leave_n();
            fracture.accept(true);
        });
        let whole = evaluation(self);
        let mut note = |effect: EffectName, without: f64| {
            costs.effects[effect as usize] = (1.0 - without / whole).max(0.0);
        };
        if let Some(mut contact) = self.contact.take() {
            let walls = contact.walls().take();
            // Where only walls can be touched, all that a contact does is theirs.
            let (kept, aside) =
                if contact.between_bodies() { (Some(contact), None) } else { (None, Some(contact)) };
            self.contact = kept;
            if walls.is_some() {
                note(EffectName::WallContact, evaluation(self));
            }
            self.contact = aside.or_else(|| self.contact.take());
            self.contact.iter_mut().zip(walls).for_each(|(contact, walls)| *contact.walls() = Some(walls));
        }
        let none = ArtificialViscosity { linear: 0.0, quadratic: 0.0 };
        let viscosity = std::mem::replace(&mut self.material.artificial_viscosity, none);
        if viscosity.linear > 0.0 || viscosity.quadratic > 0.0 {
            note(EffectName::ArtificialViscosity, evaluation(self));
        }
        self.material.artificial_viscosity = viscosity;
        let arms = std::mem::take(&mut self.arms);
        if !arms.is_empty() {
            note(EffectName::Relaxation, evaluation(self));
            self.arms = arms;
        }
        if let Some(friction) = self.fracture.as_mut().and_then(Fracture::take_friction) {
            note(EffectName::FragmentFriction, evaluation(self));
            self.fracture.iter_mut().for_each(|fracture| fracture.put_friction(friction));
        }
        if let Some(mut fracture) = self.fracture.take() {
            note(EffectName::Fracture, evaluation(self));
            fracture.return_to_n();
            fracture.accept(false);
            self.fracture = Some(fracture);
        }
        self.now.copy_from(&state);
        self.memory.copy_from(&memory);
        self.pair_evaluations = before;
        costs
    }

    /// sum V0 psi, the hourglass energy, and those of ways into clamps and of contacts between bodies, J.
    pub(super) fn energy(&self) -> f64 {
        let inner: f64 = self.slot_of.iter().map(|&slot| self.stored_at(slot as usize)).sum();
        inner + self.contact.as_ref().map_or(0.0, Contact::energy)
    }

    /// Energy stored by the particle at a slot, J (2D: J/m).
    pub(super) fn stored_at(&self, slot: usize) -> f64 {
        let f = &self.gradient[slot];
        let strained = match self.damage_at(slot) {
            d if d > 0.0 => self.volume * self.law.damaged(f, self.volume_ratio[slot], d).energy,
            _ => self.volume * self.law.energy(f, self.volume_ratio[slot]),
        };
        let relaxing = self.memory.energy(slot, &self.arms, self.material.shear_modulus());
        let unseen = 0.5 * self.hourglass[slot] * self.volume * self.error_square(slot);
        strained + self.volume * relaxing + unseen + self.energy_beside_clamp(slot)
    }

    /// sum_j w |e_ij|² = sum_j w |beta u_ij|² - H : H M, by the definition of H.
    pub(super) fn error_square(&self, slot: usize) -> f64 {
        let sum: &DeformationSum<D> = &self.deformations[slot / LANES];
        let h = self.gradient[slot] - Matrix::identity();
        sum.square.0[slot % LANES] - h.component_mul(&at(&sum.gradient, slot % LANES)).sum()
    }
}
