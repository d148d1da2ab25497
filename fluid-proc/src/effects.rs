//! The fluid's effects: what each of them is to the fluid, and the list of those that the program knows.
//!
//! [`halfstep_scene::fluid_effects`] is the list; each line names the file in this folder that holds all of the effect:
//! when it takes part, its memory, its own pass, its share of a pair. A program that uses this crate may add one more
//! effect, the parameter `X` of [`crate::Fluid`].

use crate::columns::PairParticles;
use crate::compiled::Passes;
use crate::composition::Shares;
use crate::equations::Needed;
use crate::ledger::Measuring;
use crate::rates::PairEffect;
use crate::shifting_sums::ShiftingSums;
use crate::walls::Walls;
use halfstep_role::role::fastest;
use halfstep_role::timeline;
use halfstep_scene::{Decision, EnergyPart, FluidIntegration, Scene};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::Isa;
use halfstep_sph::neighbours::ClusterList;
use halfstep_wire::half_step::Stage;

/// An effect on the fluid.
pub trait FluidEffect<const D: usize>: Send + Sync + Sized + 'static {
    /// Name of the effect in scenes and reports.
    const NAME: &'static str;
    /// What the effect adds to a pair of fluid particles; [`NoShare`](crate::composition::NoShare) where it acts in
    /// another way.
    type Pair<'a>: PairEffect<D>;
    /// What the effect adds to a pair of a fluid and a wall particle.
    type AtWall<'a>: PairEffect<D>;

    /// Whether it takes part in a scene with fluid, and why.
    fn decide(scene: &Scene) -> Decision;
    /// Memory of its own where it takes part, bytes a particle.
    fn bytes_per_particle(_: &Scene) -> usize {
        0
    }
    /// Fits its columns to the slots of the fluid and of the walls, after each sort. What the columns held belongs to
    /// the order before.
    fn resize(&mut self, _slots: usize, _walls: Option<&Walls<D>>) {}
    /// The effect's own pass, before the pass that gives the rates at a stage. Returns the number of pairs that it
    /// evaluated.
    fn prepare<K: Kernel<D>>(&mut self, _: Stage, _: &Neighbourhood<'_, K, D>) -> u64 {
        0
    }
    /// The effect's share of a pair of fluid particles.
    fn pair(&self) -> Option<Self::Pair<'_>> {
        None
    }
    /// The effect's share of a pair of a fluid and a wall particle.
    fn at_wall(&self) -> Option<Self::AtWall<'_>> {
        None
    }
    /// Position Verlet: the effect's share of a pair of a fluid and a wall particle that is evaluated after all others,
    /// with the velocity to which those lead.
    fn at_wall_predicted(&self) -> Option<Self::AtWall<'_>> {
        None
    }
    /// The effect acts on single particles ([`Self::on_particle`]).
    const ON_PARTICLES: bool = false;
    /// Acceleration that the effect gives a particle at a position, m, with a velocity, m/s; m/s².
    fn on_particle(&self, _position: &[f64; D], _velocity: &[f64; D]) -> [f64; D] {
        [0.0; D]
    }
    /// Particle shifting's sums, which are found along with the fluid's accelerations of the second stage, or after
    /// them. No effect of another crate can make them.
    #[doc(hidden)]
    fn shifting_sums(&mut self) -> Option<&mut ShiftingSums<D>> {
        None
    }
    /// The effect's own pass at the second stage, after the pass that gives the rates. Returns the number of pairs that
    /// it evaluated.
    fn conclude<K: Kernel<D>>(&mut self, _: &Neighbourhood<'_, K, D>) -> u64 {
        0
    }
    /// Velocity of each slot beside its own, at which the effect moves particles from n to n + 1, m/s; after
    /// [`FluidEffect::conclude`]. Particle shifting's comes before that of a further effect.
    fn drift(&self) -> Option<&[[f64; D]]> {
        None
    }
    /// Bytes allocated for its columns.
    fn bytes(&self) -> usize {
        0
    }
    /// The passes of a fluid with this effect as the further one.
    #[doc(hidden)]
    fn passes() -> Passes<D, Self> {
        Passes::compiled()
    }
}

/// An effect of the program's own list.
pub trait Listed<const D: usize>: FluidEffect<D> {
    /// With what it needs of a scene with fluid.
    fn of(scene: &Scene) -> Option<Self>;
}

/// What an effect's own pass sees.
#[derive(Clone, Copy, Debug)]
pub struct Neighbourhood<'a, K, const D: usize> {
    /// Kernel.
    pub kernel: K,
    /// Instruction set of the passes.
    pub isa: Isa,
    /// How the fluid goes from n to n + 1.
    pub integration: FluidIntegration,
    /// Ledgers or probes ask for shares of both equations at either stage.
    pub measured: bool,
    /// Gravity, m/s².
    pub gravity: [f64; D],
    /// The fluid.
    pub fluid: &'a PairParticles<D>,
    /// The fluid around the fluid.
    pub list: &'a ClusterList,
    /// The walls, with what they show, and the walls around the fluid.
    pub walls: Option<(&'a Walls<D>, &'a ClusterList)>,
}

impl<K, const D: usize> Neighbourhood<'_, K, D> {
    /// The equations whose shares are asked for after the effects' own passes of a stage.
    pub const fn needed(&self, stage: Stage) -> Needed {
        if self.measured { Needed::Both } else { Needed::at(stage, self.integration) }
    }
}

/// Pairs that a pass over a list evaluates.
pub fn evaluations(list: &ClusterList) -> u64 {
    list.pairs() as u64
}

/// Effects of a list that take part, `(Option<A>, (Option<B>, ()))`; `None`: absent.
pub trait Effects<const D: usize>: Send + Sync {
    /// Shares of a pair of fluid particles.
    type Pairs<'a>: Shares<D>
    where
        Self: 'a;
    /// Shares of a pair of a fluid and a wall particle.
    type AtWalls<'a>: Shares<D>
    where
        Self: 'a;

    /// See [`FluidEffect::resize`].
    fn resize(&mut self, slots: usize, walls: Option<&Walls<D>>);
    /// See [`FluidEffect::prepare`].
    fn prepare<K: Kernel<D>>(&mut self, stage: Stage, around: &Neighbourhood<'_, K, D>) -> u64;
    /// The shares of a pair of fluid particles, but for the effect of this name.
    fn pairs_without(&self, name: &str) -> Self::Pairs<'_>;
    /// The shares of a pair of fluid particles.
    fn pairs(&self) -> Self::Pairs<'_> {
        self.pairs_without("")
    }
    /// The shares of a pair of a fluid and a wall particle.
    fn at_walls(&self) -> Self::AtWalls<'_>;
    /// The shares of a pair of a fluid and a wall particle at predicted velocities.
    fn at_walls_predicted(&self) -> Self::AtWalls<'_>;
    /// See [`FluidEffect::shifting_sums`]; of the first effect that has them, with the effect's name.
    fn shifting_sums(&mut self) -> Option<(&'static str, &mut ShiftingSums<D>)>;
    /// See [`FluidEffect::conclude`].
    fn conclude<K: Kernel<D>>(&mut self, around: &Neighbourhood<'_, K, D>) -> u64;
    /// See [`FluidEffect::drift`]; of the last effect that has one.
    fn drift(&self) -> Option<&[[f64; D]]>;
    /// Adds name and seconds of the own passes, in the mean of both stages, of each effect with a share of a pair of
    /// fluid particles or a drift.
    fn measure<K: Kernel<D>>(&mut self, around: &Neighbourhood<'_, K, D>, own: &mut Vec<(&'static str, f64)>);
    /// Measures the power of each share of a pair of fluid particles.
    fn measure_pairs<K: Kernel<D>>(&self, measuring: &mut Measuring<'_, K, D>);
    /// Measures the power of each share of a pair of a fluid and a wall particle.
    fn measure_walls<K: Kernel<D>>(&self, measuring: &mut Measuring<'_, K, D>);
    /// Gives each effect that acts on single particles, by its name, to a function.
    fn on_particles(&self, act: &mut dyn FnMut(&'static str, OnParticle<'_, D>));
    /// Bytes allocated.
    fn bytes(&self) -> usize;
}

/// See [`FluidEffect::on_particle`].
pub type OnParticle<'a, const D: usize> = &'a dyn Fn(&[f64; D], &[f64; D]) -> [f64; D];

impl<const D: usize> Effects<D> for () {
    type Pairs<'a> = ();
    type AtWalls<'a> = ();
    fn resize(&mut self, _: usize, _: Option<&Walls<D>>) {}
    fn prepare<K: Kernel<D>>(&mut self, _: Stage, _: &Neighbourhood<'_, K, D>) -> u64 {
        0
    }
    fn pairs_without(&self, _: &str) {}
    fn at_walls(&self) {}
    fn at_walls_predicted(&self) {}
    fn on_particles(&self, _: &mut dyn FnMut(&'static str, OnParticle<'_, D>)) {}
    fn shifting_sums(&mut self) -> Option<(&'static str, &mut ShiftingSums<D>)> {
        None
    }
    fn conclude<K: Kernel<D>>(&mut self, _: &Neighbourhood<'_, K, D>) -> u64 {
        0
    }
    fn drift(&self) -> Option<&[[f64; D]]> {
        None
    }
    fn measure<K: Kernel<D>>(&mut self, _: &Neighbourhood<'_, K, D>, _: &mut Vec<(&'static str, f64)>) {}
    fn measure_pairs<K: Kernel<D>>(&self, _: &mut Measuring<'_, K, D>) {}
    fn measure_walls<K: Kernel<D>>(&self, _: &mut Measuring<'_, K, D>) {}
    fn bytes(&self) -> usize {
        0
    }
}

impl<const D: usize, E: FluidEffect<D>, R: Effects<D>> Effects<D> for (Option<E>, R) {
    type Pairs<'a>
        = (Option<E::Pair<'a>>, R::Pairs<'a>)
    where
        Self: 'a;
    type AtWalls<'a>
        = (Option<E::AtWall<'a>>, R::AtWalls<'a>)
    where
        Self: 'a;

    fn resize(&mut self, slots: usize, walls: Option<&Walls<D>>) {
        if let Some(effect) = &mut self.0 {
            effect.resize(slots, walls);
        }
        self.1.resize(slots, walls);
    }
    fn prepare<K: Kernel<D>>(&mut self, stage: Stage, around: &Neighbourhood<'_, K, D>) -> u64 {
        let own = self.0.as_mut().map_or(0, |effect| {
            let _phase = timeline::phase(E::NAME);
            effect.prepare(stage, around)
        });
        own + self.1.prepare(stage, around)
    }
    fn pairs_without(&self, name: &str) -> Self::Pairs<'_> {
        let effect = self.0.as_ref().filter(|_| E::NAME != name);
        (effect.and_then(E::pair), self.1.pairs_without(name))
    }
    fn at_walls(&self) -> Self::AtWalls<'_> {
        (self.0.as_ref().and_then(E::at_wall), self.1.at_walls())
    }
    fn at_walls_predicted(&self) -> Self::AtWalls<'_> {
        (self.0.as_ref().and_then(E::at_wall_predicted), self.1.at_walls_predicted())
    }
    fn shifting_sums(&mut self) -> Option<(&'static str, &mut ShiftingSums<D>)> {
        let own = self.0.as_mut().and_then(|effect| Some((E::NAME, effect.shifting_sums()?)));
        own.or_else(|| self.1.shifting_sums())
    }
    fn conclude<K: Kernel<D>>(&mut self, around: &Neighbourhood<'_, K, D>) -> u64 {
        let own = self.0.as_mut().map_or(0, |effect| {
            let _phase = timeline::phase(E::NAME);
            effect.conclude(around)
        });
        own + self.1.conclude(around)
    }
    fn drift(&self) -> Option<&[[f64; D]]> {
        self.1.drift().or_else(|| self.0.as_ref().and_then(E::drift))
    }
    fn measure<K: Kernel<D>>(
        &mut self,
        around: &Neighbourhood<'_, K, D>,
        own: &mut Vec<(&'static str, f64)>,
    ) {
        if let Some(effect) =
            self.0.as_mut().filter(|effect| effect.pair().is_some() || effect.drift().is_some())
        {
            let [first, second] =
                [Stage::First, Stage::Second].map(|stage| fastest(|| _ = effect.prepare(stage, around)));
            own.push((E::NAME, 0.5 * (first + second + fastest(|| _ = effect.conclude(around)))));
        }
        self.1.measure(around, own);
    }
    fn measure_pairs<K: Kernel<D>>(&self, measuring: &mut Measuring<'_, K, D>) {
        if let Some(share) = self.0.as_ref().and_then(E::pair) {
            measuring.add(EnergyPart::of_effect(E::NAME), share);
        }
        self.1.measure_pairs(measuring);
    }
    fn measure_walls<K: Kernel<D>>(&self, measuring: &mut Measuring<'_, K, D>) {
        if let Some(share) = self.0.as_ref().and_then(E::at_wall) {
            measuring.add(EnergyPart::of_effect(E::NAME), share);
        }
        if let Some(share) = self.0.as_ref().and_then(E::at_wall_predicted) {
            measuring.add_predicted(EnergyPart::of_effect(E::NAME), share);
        }
        self.1.measure_walls(measuring);
    }
    fn on_particles(&self, act: &mut dyn FnMut(&'static str, OnParticle<'_, D>)) {
        if let Some(effect) = self.0.as_ref().filter(|_| E::ON_PARTICLES) {
            act(E::NAME, &|position, velocity| effect.on_particle(position, velocity));
        }
        self.1.on_particles(act);
    }
    fn bytes(&self) -> usize {
        self.0.as_ref().map_or(0, E::bytes) + self.1.bytes()
    }
}

macro_rules! list {
    ($($(#[$doc:meta])* $effect:ident $name:literal $module:ident,)*) => {
        $(pub mod $module;)*

        /// The effects of the list.
        pub type Standard<const D: usize> = chain!(D, $($module::$effect)*);

        /// The effects that take part in a scene; `further` comes before those of the list.
        pub(crate) fn of_scene<const D: usize, X>(scene: &Scene, further: Option<X>) -> List<D, X> {
            (further, chain!(of D, scene, $($module::$effect)*))
        }

        /// What a scene with fluid decides about each effect of the list, with the memory that the effect has of its
        /// own, bytes a particle.
        pub fn decide<const D: usize>(scene: &Scene) -> Vec<(Decision, usize)> {
            vec![$(decide_one::<$module::$effect<D>, D>(scene),)*]
        }
    };
}

macro_rules! chain {
    ($D:ident,) => { () };
    ($D:ident, $module:ident::$effect:ident $($rest:tt)*) => {
        (Option<$module::$effect<$D>>, chain!($D, $($rest)*))
    };
    (of $D:ident, $scene:ident,) => { () };
    (of $D:ident, $scene:ident, $module:ident::$effect:ident $($rest:tt)*) => {
        (taking_part::<$module::$effect<$D>, $D>($scene), chain!(of $D, $scene, $($rest)*))
    };
}

/// A further effect, `X`, and those of the list.
pub type List<const D: usize, X> = (Option<X>, Standard<D>);

fn decide_one<E: FluidEffect<D>, const D: usize>(scene: &Scene) -> (Decision, usize) {
    let decision = E::decide(scene);
    let bytes = if decision.on { E::bytes_per_particle(scene) } else { 0 };
    (decision, bytes)
}

fn taking_part<E: Listed<D>, const D: usize>(scene: &Scene) -> Option<E> {
    E::decide(scene).on.then(|| E::of(scene)).flatten()
}

halfstep_scene::fluid_effects!(list);
