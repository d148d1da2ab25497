//! The passes over neighbours of a half-step, and what each effect takes of their time.

use crate::density_gradient::{GradientLaw, GradientSum};
use crate::effects::{Effects, LIST, Pass};
use crate::fluid::Fluid;
use crate::rates::{PairEffect, RateLaw, RateSum};
use crate::viscosity::{self, VelocityGradient, ViscosityAtWall};
use crate::wall::WallLaw;
use crate::wall_guard::WallViscosity;
use halfstep_role::role::{Costs, fastest};
use halfstep_scene::EffectName;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::ClusterList;
use halfstep_sph::pair;

impl<const D: usize> Fluid<D> {
    /// All sums of a half-step over fluid and walls.
    pub(crate) fn sums<K: Kernel<D>>(&mut self, kernel: K) {
        self.extrapolate(kernel);
        if self.needs_gradient() && !(self.frozen && self.gradient_known) {
            self.density_gradient(kernel);
        }
        if self.takes_part(EffectName::Viscosity) {
            self.viscous_stress(kernel);
        }
        let mut sums = std::mem::take(&mut self.sums);
        self.composition = Some(self.rates(kernel, Effects::of(self), &mut sums));
        self.wall_rates(kernel, &mut sums);
        self.sums = sums;
        self.pair_evaluations += evaluations(&self.fluid_list) + evaluations(&self.wall_list);
    }

    /// Pressure and velocity that the walls show.
    fn extrapolate<K: Kernel<D>>(&mut self, kernel: K) {
        let Some(walls) = &mut self.walls else { return };
        let mut sources = std::mem::take(&mut walls.shown.sources);
        let law = WallLaw::new(kernel, self.gravity, walls, &self.columns);
        let (fours, _) = sources.as_chunks_mut();
        let show = |slot, sum: &_| walls.shows(slot, sum, &self.state);
        pair::pass_into(self.isa, &law, &self.list_of_walls, show, fours);
        walls.shown.sources = sources;
        self.pair_evaluations += evaluations(&self.list_of_walls);
    }

    fn density_gradient<K: Kernel<D>>(&mut self, kernel: K) {
        self.gradient_known = true;
        let law = GradientLaw { kernel, fluid: &self.columns.now };
        let solve = |_, sum: &GradientSum<D>| sum.solve();
        pair::pass_into(self.isa, &law, &self.fluid_list, solve, &mut self.gradient);
        self.pair_evaluations += evaluations(&self.fluid_list);
    }

    fn viscous_stress<K: Kernel<D>>(&mut self, kernel: K) {
        let fluid = &self.columns.now;
        let law = viscosity::GradientLaw { kernel, targets: fluid, sources: fluid };
        let viscosity = self.viscosity;
        let finish = |slot, sum: &VelocityGradient<D>| sum.stress(viscosity, fluid.densities(slot));
        let (out, _) = self.stress.0.as_chunks_mut();
        if let Some(walls) = &self.walls {
            let at_walls = viscosity::GradientLaw { kernel, targets: fluid, sources: &walls.shown };
            let (first, second) = ((&law, &self.fluid_list), (&at_walls, &self.wall_list));
            pair::pass_both_into(self.isa, first, second, finish, out);
        } else {
            pair::pass_into(self.isa, &law, &self.fluid_list, finish, out);
        }
        self.pair_evaluations += evaluations(&self.fluid_list) + evaluations(&self.wall_list);
    }

    /// The rate pass over the fluid; returns the name of the composition that ran.
    fn rates<K: Kernel<D>>(
        &self,
        kernel: K,
        effects: Effects<'_, D>,
        sums: &mut [RateSum<D>],
    ) -> &'static str {
        effects.composition(OverFluid { kernel, fluid: self, sums })
    }

    /// Adds the rates by the walls.
    fn wall_rates<K: Kernel<D>>(&self, kernel: K, sums: &mut [RateSum<D>]) {
        let Some(walls) = &self.walls else { return };
        let damping = WallViscosity {
            smoothing_length: self.smoothing_length,
            linear: &walls.damping,
            quadratic: self.quadratic,
        };
        let (targets, sources) = (&self.columns.now, &walls.shown);
        if self.takes_part(EffectName::Viscosity) {
            let effects = (damping, (ViscosityAtWall(&self.stress), ()));
            let law = RateLaw { kernel, effects, targets, sources };
            pair::pass_adding(self.isa, &law, &self.wall_list, sums);
        } else {
            let law = RateLaw { kernel, effects: (damping, ()), targets, sources };
            pair::pass_adding(self.isa, &law, &self.wall_list, sums);
        }
    }

    /// Parts of the sums' time, each effect's measured by leaving it out.
    pub(crate) fn costs<K: Kernel<D>>(&mut self, kernel: K) -> Costs {
        let mut costs = Costs::default();
        let mut sums = std::mem::take(&mut self.sums);
        let walls = fastest(|| self.extrapolate(kernel)) + fastest(|| self.wall_rates(kernel, &mut sums));
        let rates = fastest(|| {
            self.rates(kernel, Effects::of(self), &mut sums);
        });
        let half = |frozen: bool| if frozen { 0.5 } else { 1.0 };
        let gradient = if self.needs_gradient() {
            half(self.frozen) * fastest(|| self.density_gradient(kernel))
        } else {
            0.0
        };
        let stress = if self.takes_part(EffectName::Viscosity) {
            fastest(|| self.viscous_stress(kernel))
        } else {
            0.0
        };
        let total = walls + rates + gradient + stress;
        costs.walls = walls / total;
        for &effect in LIST.iter().filter(|&&effect| self.takes_part(effect)) {
            let without = fastest(|| {
                self.rates(kernel, Effects::of(self).without(effect), &mut sums);
            });
            let own = match effect {
                EffectName::DensityDiffusion => gradient,
                EffectName::Viscosity => stress,
                _ => 0.0,
            };
            costs.effects[effect as usize] = ((rates - without).max(0.0) + own) / total;
        }
        self.sums = sums;
        costs
    }
}

/// Pairs that a pass over a list evaluates.
fn evaluations(list: &ClusterList) -> u64 {
    (list.entries() * LANES) as u64
}

struct OverFluid<'a, K, const D: usize> {
    kernel: K,
    fluid: &'a Fluid<D>,
    sums: &'a mut [RateSum<D>],
}

impl<K: Kernel<D>, const D: usize> Pass<D> for OverFluid<'_, K, D> {
    fn run<E: PairEffect<D>>(self, effects: E) {
        let shown = &self.fluid.columns.now;
        let law = RateLaw { kernel: self.kernel, effects, targets: shown, sources: shown };
        pair::pass(self.fluid.isa, &law, &self.fluid.fluid_list, self.sums);
    }
}
