//! The passes over neighbours of a half-step, and what each effect takes of their time.

use crate::columns::{PairParticles, fit};
use crate::compiled::StandardPasses;
use crate::composition::{Pass, Runs, Shares, WithList, adds};
use crate::effects::{Effects, FluidEffect, List, Neighbourhood, OnParticle, evaluations};
use crate::equations::{Both, Continuity, Equations, Momentum, Needed};
use crate::fluid::Fluid;
use crate::rates::{PairEffect, PredictedLaw, RateLaw, RateSum};
use crate::shifting_sums::ShiftingSums;
use crate::walls::WallLaw;
use halfstep_role::role::{Costs, fastest};
use halfstep_role::timeline;
use halfstep_scene::EffectName;
use halfstep_sph::kernel::{Kernel, KernelName};
use halfstep_sph::lane::{Isa, LANES};
use halfstep_sph::neighbours::ClusterList;
use halfstep_sph::{pair, with_kernel};
use halfstep_wire::half_step::Stage;
use rayon::prelude::*;

impl<const D: usize, X: FluidEffect<D>> Fluid<D, X> {
    /// All sums of a half-step over fluid and walls.
    pub(crate) fn sums<K: Kernel<D>>(&mut self, kernel: K) {
        self.columns.now.round_for(self.fluid_list.precision());
        self.extrapolate(kernel);
        let stage = self.stage;
        let needed = Needed::at(stage, self.integration);
        self.pair_evaluations += self.among(kernel, |effects, around| effects.prepare(stage, around));
        let mut sums = std::mem::take(&mut self.sums);
        let mut shifting = self.taken_shifting_sums(stage);
        self.all_rates(needed, shifting.as_mut(), &mut sums);
        self.sums = sums;
        let around = evaluations(&self.fluid_list) + evaluations(&self.wall_list);
        self.pair_evaluations += around;
        if let Some(shifting) = shifting {
            self.put_back(shifting);
            self.pair_evaluations += around;
        }
        if stage == Stage::Second {
            self.pair_evaluations += self.among(kernel, List::conclude);
        }
    }

    /// Particle shifting's sums, which the second stage finds, if the effect takes part.
    fn taken_shifting_sums(&mut self, stage: Stage) -> Option<ShiftingSums<D>> {
        let (_, sums) = self.effects.shifting_sums().filter(|_| stage == Stage::Second)?;
        Some(std::mem::replace(sums, ShiftingSums::none()))
    }

    fn put_back(&mut self, shifting: ShiftingSums<D>) {
        if let Some((_, place)) = self.effects.shifting_sums() {
            *place = shifting;
        }
    }

    /// The rates by fluid, walls and effects on single particles.
    pub(crate) fn all_rates(
        &self,
        needed: Needed,
        shifting: Option<&mut ShiftingSums<D>>,
        sums: &mut [RateSum<D>],
    ) {
        {
            let _phase = timeline::phase("pair pass");
            self.rates(needed, self.effects.pairs(), shifting, sums);
        }
        self.wall_rates(needed, sums);
        if needed.momentum() {
            self.effects.on_particles(&mut |name, of| {
                let _phase = timeline::phase(name);
                self.add_on_particles(of, sums);
            });
        }
    }

    /// The effects, with what their own passes see.
    fn among<K, T>(
        &mut self,
        kernel: K,
        act: impl FnOnce(&mut List<D, X>, &Neighbourhood<'_, K, D>) -> T,
    ) -> T {
        let walls = self.walls.as_ref().map(|walls| (walls, &self.wall_list));
        let (fluid, list) = (&self.columns.now, &self.fluid_list);
        let (isa, integration, gravity) = (self.isa, self.integration, self.gravity);
        let measured = self.ledger.is_some() || self.measures_loads();
        let around = Neighbourhood { kernel, isa, integration, measured, gravity, fluid, list, walls };
        act(&mut self.effects, &around)
    }

    /// Pressure and velocity that the walls show.
    fn extrapolate<K: Kernel<D>>(&mut self, kernel: K) {
        let Some(walls) = &mut self.walls else { return };
        let _phase = timeline::phase("walls: extrapolation");
        let mut sources = std::mem::take(&mut walls.shown.sources);
        let law = WallLaw::new(kernel, self.gravity, walls, &self.columns.now);
        let (fours, _) = sources.as_chunks_mut();
        let show = |slot, sum: &_| walls.shows(slot, sum, &self.state);
        pair::pass_into(self.isa, &law, &self.list_of_walls, show, fours);
        walls.shown.sources = sources;
        walls.shown.round_for(self.list_of_walls.precision());
        self.pair_evaluations += evaluations(&self.list_of_walls);
    }

    /// What the passes of the rates see.
    fn fluid_and_walls(&self) -> FluidAndWalls<'_, D> {
        FluidAndWalls {
            kernel: self.kernel,
            smoothing_length: self.smoothing_length,
            isa: self.isa,
            fluid: &self.columns.now,
            list: &self.fluid_list,
            walls: self.walls.as_ref().map(|walls| (&walls.shown, &self.wall_list)),
        }
    }

    /// The rates by the fluid, and particle shifting's sums where they are asked for.
    fn rates(
        &self,
        needed: Needed,
        (further, standard): <List<D, X> as Effects<D>>::Pairs<'_>,
        shifting: Option<&mut ShiftingSums<D>>,
        sums: &mut [RateSum<D>],
    ) {
        let particles = self.fluid_and_walls();
        match further.filter(|_| adds::<X::Pair<'_>, D>(needed)) {
            None => (StandardPasses::get().rates)(particles, needed, standard, shifting, sums),
            Some(share) => rates(particles, needed, WithList(share, standard), shifting, sums),
        }
    }

    /// Adds the rates by the walls.
    fn wall_rates(&self, needed: Needed, sums: &mut [RateSum<D>]) {
        if self.walls.is_none() {
            return;
        }
        let _phase = timeline::phase("walls: rates");
        let (particles, (further, standard)) = (self.fluid_and_walls(), self.effects.at_walls());
        match further.filter(|_| adds::<X::AtWall<'_>, D>(needed)) {
            None => (StandardPasses::get().wall_rates)(particles, needed, standard, sums),
            Some(share) => wall_rates(particles, needed, WithList(share, standard), sums),
        }
    }

    /// Position Verlet: adds the rates by walls at predicted velocities, once all sums are there but those that answer
    /// the interface.
    pub(crate) fn predicted_rates<K: Kernel<D>>(&mut self, kernel: K) {
        if !self.effects.at_walls_predicted().any() {
            return;
        }
        let _phase = timeline::phase("walls: predicted rates");
        let mut predicted = std::mem::take(&mut self.predicted);
        self.predict(self.dt, &self.sums, &mut predicted);
        let mut sums = std::mem::take(&mut self.sums);
        self.predicted_wall_rates(kernel, &predicted, &mut sums);
        self.pair_evaluations += evaluations(&self.wall_list);
        (self.sums, self.predicted) = (sums, predicted);
    }

    /// The velocities at n + 1, m/s, by accelerations, over a step of this length, s.
    pub(crate) fn predict(&self, dt: f64, sums: &[RateSum<D>], velocities: &mut Vec<[f64; D]>) {
        fit(velocities, self.columns.slots(), [0.0; D]);
        velocities.par_iter_mut().with_min_len(TASK).enumerate().for_each(|(slot, velocity)| {
            let (sum, now) = (&sums[slot / LANES], &self.columns.now.sources[slot]);
            *velocity = std::array::from_fn(|d| {
                now.velocity[d] + dt * (self.gravity[d] + sum.acceleration[d].0[slot % LANES])
            });
        });
    }

    /// Adds the rates by walls at predicted velocities, m/s.
    fn predicted_wall_rates<K: Kernel<D>>(
        &self,
        kernel: K,
        velocities: &[[f64; D]],
        sums: &mut [RateSum<D>],
    ) {
        let Some(law) = self.predicted_law(kernel, velocities) else { return };
        pair::pass_adding(self.isa, &law, &self.wall_list, sums);
    }

    /// What walls do by shares at predicted velocities.
    pub(crate) fn predicted_law<'a, K: Kernel<D>>(
        &'a self,
        kernel: K,
        velocities: &'a [[f64; D]],
    ) -> Option<PredictedLaw<'a, K, AtWalls<'a, D, X>, D>> {
        let effects = self.effects.at_walls_predicted();
        let (targets, sources) = (&self.columns.now, &self.walls.as_ref()?.shown);
        Some(PredictedLaw { kernel, effects, targets, velocities, sources })
    }

    /// Adds what an effect does to single particles.
    fn add_on_particles(&self, of: OnParticle<'_, D>, sums: &mut [RateSum<D>]) {
        for (slot, particle) in self.columns.now.sources.iter().enumerate() {
            sums[slot / LANES].add(slot % LANES, of(&particle.position, &particle.velocity), 0.0);
        }
    }

    /// Seconds of the rates at predicted velocities in the mean over both stages, where they are the fluid's own.
    fn cost_of_prediction<K: Kernel<D>>(&mut self, kernel: K, sums: &mut [RateSum<D>]) -> f64 {
        if !self.predicts_alone() || !self.effects.at_walls_predicted().any() {
            return 0.0;
        }
        let mut velocities = std::mem::take(&mut self.predicted);
        let seconds = fastest(|| {
            self.predict(0.0, sums, &mut velocities);
            self.predicted_wall_rates(kernel, &velocities, sums);
        });
        self.predicted = velocities;
        0.5 * seconds
    }

    /// Name of particle shifting, and seconds that its sums take beside the rates, in the mean over both stages.
    fn cost_of_shifting(&mut self, sums: &mut [RateSum<D>]) -> Option<(&'static str, f64)> {
        let needed = Needed::at(Stage::Second, self.integration);
        let (name, _) = self.effects.shifting_sums()?;
        let mut shifting = self.taken_shifting_sums(Stage::Second)?;
        let [with, without] = [true, false].map(|along| {
            fastest(|| {
                let shifting = along.then_some(&mut shifting);
                self.rates(needed, self.effects.pairs(), shifting, sums);
            })
        });
        self.put_back(shifting);
        Some((name, 0.5 * (with - without).max(0.0)))
    }

    /// Parts of the sums' time, each effect's measured by leaving it out.
    pub(crate) fn measured_costs<K: Kernel<D>>(&mut self, kernel: K) -> Costs {
        let mut costs = Costs::default();
        let mut sums = std::mem::take(&mut self.sums);
        // In the mean over a step; of stages that are alike once.
        let stages = Needed::in_a_step(self.integration);
        let number = stages.len() as f64;
        let mean = |seconds: &mut dyn FnMut(Needed) -> f64| {
            stages.iter().map(|&needed| seconds(needed)).sum::<f64>() / number
        };
        let at_walls = mean(&mut |needed| fastest(|| self.wall_rates(needed, &mut sums)));
        let walls =
            fastest(|| self.extrapolate(kernel)) + at_walls + self.cost_of_prediction(kernel, &mut sums);
        let rates = mean(&mut |needed| fastest(|| self.rates(needed, self.effects.pairs(), None, &mut sums)));
        let shifting = self.cost_of_shifting(&mut sums);
        let mut own_passes = Vec::new();
        self.among(kernel, |effects, around| effects.measure(around, &mut own_passes));
        for (name, own) in &mut own_passes {
            *own += shifting.filter(|(of, _)| of == name).map_or(0.0, |(_, seconds)| seconds);
        }
        self.effects.on_particles(&mut |name, of| {
            let part = stages.iter().filter(|needed| needed.momentum()).count() as f64 / number;
            own_passes.push((name, part * fastest(|| self.add_on_particles(of, &mut sums))));
        });
        let placing = self.walls.as_mut().map_or(0.0, |walls| fastest(|| walls.place_again()));
        let total = walls + rates + own_passes.iter().map(|(_, own)| own).sum::<f64>();
        costs.walls = walls / total;
        // It comes before the sums, once for each.
        costs.moving_walls = placing / total;
        for (name, own) in own_passes {
            // What a further effect takes is counted as the fluid's own.
            let Some(place) = EffectName::ALL.iter().position(|effect| effect.name() == name) else {
                continue;
            };
            let without = mean(&mut |needed| {
                fastest(|| self.rates(needed, self.effects.pairs_without(name), None, &mut sums))
            });
            costs.effects[place] = ((rates - without).max(0.0) + own) / total;
        }
        self.sums = sums;
        costs
    }
}

/// Particles that one task predicts the velocities of, at least.
const TASK: usize = 1024;

/// The fluid's shares of a pair of a fluid and a wall particle.
type AtWalls<'a, const D: usize, X> = <List<D, X> as Effects<D>>::AtWalls<'a>;

/// What the passes of the rates see.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FluidAndWalls<'a, const D: usize> {
    kernel: KernelName,
    smoothing_length: f64,
    isa: Isa,
    fluid: &'a PairParticles<D>,
    list: &'a ClusterList,
    walls: Option<(&'a PairParticles<D>, &'a ClusterList)>,
}

/// The rates by the fluid, and particle shifting's sums where they are asked for.
pub(crate) fn rates<const D: usize>(
    particles: FluidAndWalls<'_, D>,
    needed: Needed,
    shares: impl Runs<D>,
    shifting: Option<&mut ShiftingSums<D>>,
    sums: &mut [RateSum<D>],
) {
    with_kernel!(particles.kernel, particles.smoothing_length, D, |kernel| match (needed, shifting) {
        (Needed::Momentum, Some(shifting)) => shares.run(WithShifting { kernel, particles, shifting, sums }),
        (_, shifting) => {
            match needed {
                Needed::Both => shares.run(OverFluid { kernel, equations: Both, particles, sums }),
                Needed::Momentum => shares.run(OverFluid { kernel, equations: Momentum, particles, sums }),
                Needed::Continuity => {
                    shares.run(OverFluid { kernel, equations: Continuity, particles, sums })
                }
            }
            if let Some(shifting) = shifting {
                let FluidAndWalls { isa, fluid, list, walls, .. } = particles;
                shifting.alone(isa, kernel, fluid, list, walls);
            }
        }
    });
}

/// Adds the rates by the walls.
pub(crate) fn wall_rates<const D: usize>(
    particles: FluidAndWalls<'_, D>,
    needed: Needed,
    shares: impl Runs<D>,
    sums: &mut [RateSum<D>],
) {
    with_kernel!(particles.kernel, particles.smoothing_length, D, |kernel| match needed {
        Needed::Both => shares.run(OverWalls { kernel, equations: Both, particles, sums }),
        Needed::Momentum => shares.run(OverWalls { kernel, equations: Momentum, particles, sums }),
        Needed::Continuity => shares.run(OverWalls { kernel, equations: Continuity, particles, sums }),
    });
}

struct OverFluid<'a, K, Q, const D: usize> {
    kernel: K,
    equations: Q,
    particles: FluidAndWalls<'a, D>,
    sums: &'a mut [RateSum<D>],
}

impl<K: Kernel<D>, Q: Equations, const D: usize> Pass<D> for OverFluid<'_, K, Q, D> {
    type Equations = Q;
    fn run<E: PairEffect<D>>(self, effects: E) {
        let Self { kernel, equations, particles: FluidAndWalls { isa, fluid, list, .. }, sums } = self;
        let law = RateLaw { kernel, equations, effects, targets: fluid, sources: fluid };
        pair::pass(isa, &law, list, sums);
    }
}

/// Accelerations with particle shifting's sums along.
struct WithShifting<'a, K, const D: usize> {
    kernel: K,
    particles: FluidAndWalls<'a, D>,
    shifting: &'a mut ShiftingSums<D>,
    sums: &'a mut [RateSum<D>],
}

impl<K: Kernel<D>, const D: usize> Pass<D> for WithShifting<'_, K, D> {
    type Equations = Momentum;
    fn run<E: PairEffect<D>>(self, effects: E) {
        let Self { kernel, particles: FluidAndWalls { isa, fluid, list, walls, .. }, shifting, sums } = self;
        let law = RateLaw { kernel, equations: Momentum, effects, targets: fluid, sources: fluid };
        shifting.with_accelerations(isa, law, list, walls, sums);
    }
}

struct OverWalls<'a, K, Q, const D: usize> {
    kernel: K,
    equations: Q,
    particles: FluidAndWalls<'a, D>,
    sums: &'a mut [RateSum<D>],
}

impl<K: Kernel<D>, Q: Equations, const D: usize> Pass<D> for OverWalls<'_, K, Q, D> {
    type Equations = Q;
    fn run<E: PairEffect<D>>(self, effects: E) {
        let Self { kernel, equations, particles: FluidAndWalls { isa, fluid, walls, .. }, sums } = self;
        let Some((sources, list)) = walls else { return };
        let law = RateLaw { kernel, equations, effects, targets: fluid, sources };
        pair::pass_adding(isa, &law, list, sums);
    }
}
