//! Rates of a state: equation of state, the pass, walls, stress rate.

use super::artificial_stress;
use super::columns::Source;
use super::gradient::renormalise;
use super::model::Hypoelastic;
use super::rates::{ArtificialStress, Moment, Plain, Renormalised, SolidLaw, TensileCorrection};
use super::stress_rate::jaumann;
use crate::model::Load;
use crate::wall::{Touching, repulsion};
use halfstep_role::role::{Costs, fastest};
use halfstep_scene::EffectName;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::{pair, with_kernel};
use std::marker::PhantomData;

impl<const D: usize> Hypoelastic<D> {
    pub(super) fn stress_at(&self, slot: usize) -> [[f64; D]; D] {
        std::array::from_fn(|a| std::array::from_fn(|b| self.now.stress[a.min(b)][a.max(b)][slot]))
    }

    /// p = K (rho/rho0 - 1) (Kayaki's eq. 5) and what follows from pressure and stress.
    pub(super) fn apply_state_equation(&mut self) {
        let (k, rho0) = (self.material.bulk_modulus(), self.material.density);
        for slot in 0..self.id.len() {
            let rho = self.now.density[slot];
            self.show(slot, k * (rho / rho0 - 1.0));
        }
    }

    /// What neighbours read of a particle at a pressure, from its other columns.
    pub(super) fn show(&mut self, slot: usize, p: f64) {
        let rho = self.now.density[slot];
        self.pressure[slot] = p;
        let s = self.stress_at(slot);
        let sigma: [[f64; D]; D] =
            std::array::from_fn(|a| std::array::from_fn(|b| if a == b { s[a][b] - p } else { s[a][b] }));
        let inverse = 1.0 / (rho * rho);
        self.sources[slot] = Source {
            position: std::array::from_fn(|d| self.now.position[d][slot]),
            velocity: std::array::from_fn(|d| self.now.velocity[d][slot]),
            density: rho,
            volume: self.mass / rho,
            stress_term: sigma.map(|row| row.map(|s| s * inverse)),
        };
        if let Some(halfstep_scene::ArtificialStress { strength, .. }) = self.artificial_stress {
            self.artificial[slot] = artificial_stress::tensor(strength, sigma, rho);
        }
    }

    pub(super) fn pass<K: Kernel<D>, T: TensileCorrection<D>, M: Moment>(
        &mut self,
        kernel: K,
        correction: T,
        _: M,
    ) {
        // The correction borrows from self; the sums do not.
        let mut sums = std::mem::take(&mut self.sums);
        let law = SolidLaw {
            kernel,
            correction,
            gradient: PhantomData::<M>,
            state: &self.now,
            sources: &self.sources,
            mass: self.mass,
            linear: self.material.artificial_viscosity.linear * self.material.sound_speed(),
            quadratic: self.material.artificial_viscosity.quadratic,
        };
        pair::pass(self.isa, &law, &self.neighbours, &mut sums);
        self.sums = sums;
        self.pair_evaluations += self.neighbours.pairs() as u64;
    }

    fn sums<K: Kernel<D>>(&mut self, kernel: K) {
        let artificial = std::mem::take(&mut self.artificial);
        let correction = ArtificialStress::of(self.artificial_stress, &artificial, kernel, self.spacing);
        match (correction, self.renormalised) {
            (None, false) => self.pass(kernel, (), Plain),
            (None, true) => self.pass(kernel, (), Renormalised),
            (Some(c), false) => self.pass(kernel, c, Plain),
            (Some(c), true) => self.pass(kernel, c, Renormalised),
        }
        self.artificial = artificial;
    }

    fn touch_walls(&mut self) {
        if let Some(mut walls) = self.walls.take() {
            walls.act(self.touching());
            self.pair_evaluations += walls.pairs() as u64;
            self.walls = Some(walls);
        }
    }

    /// The largest that walls add to the square of a particle's frequency in the state that was evaluated last, 1/s².
    pub(super) fn springs_of_walls(&self) -> f64 {
        let Some(walls) = &self.walls else { return 0.0 };
        let free = |slot: &usize| {
            let id = self.id[*slot];
            id != PADDING && !self.points[id as usize].clamped
        };
        let of = |slot: usize| walls.stiffness(self.touching(), slot).0;
        (0..self.id.len()).filter(free).map(of).fold(0.0, f64::max)
    }

    /// The particles as walls see them.
    pub(super) fn touching(&self) -> Touching<'_, D> {
        Touching {
            id: &self.id,
            position: &self.now.position,
            velocity: &self.now.velocity,
            repulsion: repulsion(self.material.pressure_wave_speed(), self.spacing),
        }
    }

    /// Parts of an evaluation's time, each effect's measured by leaving it out.
    pub(super) fn costs_of_effects(&mut self) -> Costs {
        let load = Load::none(self.own);
        let before = self.pair_evaluations;
        let evaluation = |model: &mut Self| {
            fastest(|| {
                model.apply_state_equation();
                model.compute_rates(&load);
            })
        };
        let mut costs = Costs::default();
        let whole = evaluation(self);
        let mut note = |effect: EffectName, without: f64| {
            costs.effects[effect as usize] = (1.0 - without / whole).max(0.0);
        };
        if let Some(stress) = self.artificial_stress.take() {
            note(EffectName::ArtificialStress, evaluation(self));
            self.artificial_stress = Some(stress);
        }
        if std::mem::take(&mut self.renormalised) {
            note(EffectName::RenormalisedGradient, evaluation(self));
            self.renormalised = true;
        }
        if let Some(states) = self.wall_states.take() {
            let effect = if states.clamps { EffectName::WallClamp } else { EffectName::WallParticles };
            note(effect, evaluation(self));
            self.wall_states = Some(states);
        }
        if let Some(walls) = self.walls.take() {
            note(EffectName::WallContact, evaluation(self));
            self.walls = Some(walls);
        }
        self.apply_state_equation();
        self.pair_evaluations = before;
        costs
    }

    /// Rates of the present state under a load.
    pub(super) fn compute_rates(&mut self, load: &Load<D>) {
        if self.moved_too_far() {
            self.sort();
            self.apply_state_equation();
        }
        self.show_walls();
        with_kernel!(self.kernel, self.smoothing_length, D, |kernel| self.sums(kernel));
        self.touch_walls();
        let g = self.material.shear_modulus();
        for slot in 0..self.id.len() {
            let (sum, k) = (&self.sums[slot / LANES], slot % LANES);
            let id = self.id[slot];
            let mut l: [[f64; D]; D] =
                std::array::from_fn(|a| std::array::from_fn(|b| sum.gradient[a][b].0[k]));
            if self.renormalised {
                l = renormalise(l, std::array::from_fn(|a| std::array::from_fn(|b| sum.moment[a][b].0[k])));
            }
            let mut density_rate = -self.now.density[slot] * (0..D).map(|d| l[d][d]).sum::<f64>();
            let mut acceleration: [f64; D] =
                std::array::from_fn(|d| sum.acceleration[d].0[k] + self.gravity[d]);
            if let Some(walls) = &self.walls {
                let push = walls.acceleration(slot);
                for d in 0..D {
                    acceleration[d] += push[d];
                }
            }
            if id != PADDING {
                let p = id as usize;
                if let Some(force) = load.force.get(p) {
                    for d in 0..D {
                        acceleration[d] += force[d] / self.mass;
                    }
                }
                if let Some(outer) = self.outer.get(p) {
                    density_rate += outer.density;
                    for a in 0..D {
                        for b in 0..D {
                            l[a][b] += outer.gradient[a][b];
                        }
                    }
                }
                if self.points[p].clamped {
                    acceleration = [0.0; D];
                }
            }
            let stress_rate = jaumann(g, l, self.stress_at(slot));
            for a in 0..D {
                self.rates.acceleration[a][slot] = acceleration[a];
                for b in a..D {
                    self.rates.stress[a][b][slot] = stress_rate[a][b];
                }
            }
            self.rates.density[slot] = density_rate;
        }
    }
}

#[cfg(test)]
impl<const D: usize> Hypoelastic<D> {
    /// Gives every particle a velocity by its position.
    pub(super) fn set_velocity(&mut self, v: impl Fn([f64; D]) -> [f64; D]) {
        for slot in 0..self.id.len() {
            let at = v(std::array::from_fn(|d| self.now.position[d][slot]));
            for d in 0..D {
                self.now.velocity[d][slot] = at[d];
            }
        }
        self.apply_state_equation();
        self.show_particles();
    }

    /// Rate of the deviatoric stress of every particle.
    pub(super) fn stress_rates(&mut self, load: &Load<D>) -> Vec<[[f64; D]; D]> {
        self.compute_rates(load);
        let rate = |s: usize| {
            std::array::from_fn(|a| std::array::from_fn(|b: usize| self.rates.stress[a.min(b)][a.max(b)][s]))
        };
        self.slot_of.iter().map(|&s| rate(s as usize)).collect()
    }
}
