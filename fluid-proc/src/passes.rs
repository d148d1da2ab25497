//! The passes over neighbours of a half-step, and what each effect takes of their time.

use crate::composition::{Pass, Shares};
use crate::effects::{Effects, FluidEffect, List, Neighbourhood, OnParticle, evaluations};
use crate::fluid::Fluid;
use crate::rates::{PairEffect, RateLaw, RateSum};
use crate::walls::{WallLaw, Walls};
use halfstep_role::role::{Costs, fastest};
use halfstep_role::timeline;
use halfstep_scene::EffectName;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::LANES;
use halfstep_sph::pair;

impl<const D: usize, X: FluidEffect<D>> Fluid<D, X> {
    /// All sums of a half-step over fluid and walls.
    pub(crate) fn sums<K: Kernel<D>>(&mut self, kernel: K) {
        self.columns.now.round_for(self.fluid_list.precision());
        self.extrapolate(kernel);
        let stage = self.stage;
        self.pair_evaluations += self.among(kernel, |effects, around| effects.prepare(stage, around));
        let mut sums = std::mem::take(&mut self.sums);
        {
            let _phase = timeline::phase("pair pass");
            self.rates(kernel, self.effects.pairs(), &mut sums);
        }
        self.wall_rates(kernel, &mut sums);
        self.effects.on_particles(&mut |name, of| {
            let _phase = timeline::phase(name);
            self.add_on_particles(of, &mut sums);
        });
        self.sums = sums;
        self.pair_evaluations += evaluations(&self.fluid_list) + evaluations(&self.wall_list);
    }

    /// The effects, with what their own passes see.
    fn among<K, T>(
        &mut self,
        kernel: K,
        act: impl FnOnce(&mut List<D, X>, &Neighbourhood<'_, K, D>) -> T,
    ) -> T {
        let walls = self.walls.as_ref().map(|walls| (walls, &self.wall_list));
        let (fluid, list) = (&self.columns.now, &self.fluid_list);
        let (isa, gravity) = (self.isa, self.gravity);
        let beside_solids = self.coupling.as_ref().map_or(&[][..], |coupling| &coupling.gradients);
        act(&mut self.effects, &Neighbourhood { kernel, isa, gravity, fluid, list, beside_solids, walls })
    }

    /// Pressure and velocity that the walls show.
    fn extrapolate<K: Kernel<D>>(&mut self, kernel: K) {
        let Some(walls) = &mut self.walls else { return };
        let _phase = timeline::phase("walls: extrapolation");
        let mut sources = std::mem::take(&mut walls.shown.sources);
        let law = WallLaw::new(kernel, self.gravity, walls, &self.columns);
        let (fours, _) = sources.as_chunks_mut();
        let show = |slot, sum: &_| walls.shows(slot, sum, &self.state);
        pair::pass_into(self.isa, &law, &self.list_of_walls, show, fours);
        walls.shown.sources = sources;
        walls.shown.round_for(self.list_of_walls.precision());
        self.pair_evaluations += evaluations(&self.list_of_walls);
    }

    /// The rate pass over the fluid.
    fn rates<K: Kernel<D>>(&self, kernel: K, shares: impl Shares<D>, sums: &mut [RateSum<D>]) {
        shares.run(OverFluid { kernel, fluid: self, sums });
    }

    /// Adds the rates by the walls.
    fn wall_rates<K: Kernel<D>>(&self, kernel: K, sums: &mut [RateSum<D>]) {
        let Some(walls) = &self.walls else { return };
        let _phase = timeline::phase("walls: rates");
        self.effects.at_walls().run(OverWalls { kernel, fluid: self, walls, sums });
    }

    /// Adds what an effect does to single particles.
    fn add_on_particles(&self, of: OnParticle<'_, D>, sums: &mut [RateSum<D>]) {
        for (slot, particle) in self.columns.now.sources.iter().enumerate() {
            sums[slot / LANES].add(slot % LANES, of(&particle.position, &particle.velocity), 0.0);
        }
    }

    /// Parts of the sums' time, each effect's measured by leaving it out.
    pub(crate) fn costs<K: Kernel<D>>(&mut self, kernel: K) -> Costs {
        let mut costs = Costs::default();
        let mut sums = std::mem::take(&mut self.sums);
        let walls = fastest(|| self.extrapolate(kernel)) + fastest(|| self.wall_rates(kernel, &mut sums));
        let rates = fastest(|| self.rates(kernel, self.effects.pairs(), &mut sums));
        let mut own_passes = Vec::new();
        self.among(kernel, |effects, around| effects.measure(around, &mut own_passes));
        self.effects.on_particles(&mut |name, of| {
            own_passes.push((name, fastest(|| self.add_on_particles(of, &mut sums))));
        });
        let placing = self.walls.as_mut().map_or(0.0, |walls| fastest(|| walls.place_again()));
        let total = walls + rates + own_passes.iter().map(|(_, own)| own).sum::<f64>();
        costs.walls = walls / total;
        // It comes before the sums, once for each.
        costs.moving_walls = placing / total;
        for (name, own) in own_passes {
            let without = fastest(|| self.rates(kernel, self.effects.pairs_without(name), &mut sums));
            // What a further effect takes is counted as the fluid's own.
            if let Some(place) = EffectName::ALL.iter().position(|effect| effect.name() == name) {
                costs.effects[place] = ((rates - without).max(0.0) + own) / total;
            }
        }
        self.sums = sums;
        costs
    }
}

struct OverFluid<'a, K, X: FluidEffect<D>, const D: usize> {
    kernel: K,
    fluid: &'a Fluid<D, X>,
    sums: &'a mut [RateSum<D>],
}

impl<K: Kernel<D>, X: FluidEffect<D>, const D: usize> Pass<D> for OverFluid<'_, K, X, D> {
    fn run<E: PairEffect<D>>(self, effects: E) {
        let shown = &self.fluid.columns.now;
        let law = RateLaw { kernel: self.kernel, effects, targets: shown, sources: shown };
        pair::pass(self.fluid.isa, &law, &self.fluid.fluid_list, self.sums);
    }
}

struct OverWalls<'a, K, X: FluidEffect<D>, const D: usize> {
    kernel: K,
    fluid: &'a Fluid<D, X>,
    walls: &'a Walls<D>,
    sums: &'a mut [RateSum<D>],
}

impl<K: Kernel<D>, X: FluidEffect<D>, const D: usize> Pass<D> for OverWalls<'_, K, X, D> {
    fn run<E: PairEffect<D>>(self, effects: E) {
        let (targets, sources) = (&self.fluid.columns.now, &self.walls.shown);
        let law = RateLaw { kernel: self.kernel, effects, targets, sources };
        pair::pass_adding(self.fluid.isa, &law, &self.fluid.wall_list, self.sums);
    }
}
