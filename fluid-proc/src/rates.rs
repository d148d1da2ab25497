//! The one pass that gives acceleration and density rate: pressure, continuity and whatever effects the scene calls
//! for.

use crate::columns::{Beside, PairParticles, each};
use crate::composition::Composition;
use crate::equations::Equations;
use crate::momentum::pressure_and_continuity;
use halfstep_sph::artificial_viscosity::damping;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Lane, Lanes, components};
use halfstep_sph::pair::{PairLaw, distance, dot, pair_sum};

/// Several particles with one of their neighbours.
#[derive(Clone, Copy, Debug)]
pub struct FluidPair<const D: usize, L = Lane> {
    /// x_i - x_j, m.
    pub dx: [L; D],
    /// |x_ij|², m².
    pub r2: L,
    /// v_i - v_j, m/s.
    pub dv: [L; D],
    /// v_ij . x_ij, m²/s.
    pub approach: L,
    /// rho_i, kg/m³.
    pub density_i: L,
    /// rho_j, kg/m³.
    pub density_j: L,
    /// rho_i - rho_j, kg/m³.
    pub density_difference: L,
    /// p_i / rho_i².
    pub pressure_term_i: L,
    /// p_j / rho_j².
    pub pressure_term_j: L,
}

impl<L: Lanes, const D: usize> FluidPair<D, L> {
    /// Pi_ij of the artificial viscosity; `linear` is A c0, `quadratic` B.
    #[inline(always)]
    pub fn damping<A: Arch>(&self, h: f64, linear: L, quadratic: f64) -> L {
        let density_sum = self.density_i + self.density_j;
        damping::<A, L>(h, linear, L::splat(quadratic), self.approach, self.r2, density_sum)
    }

    /// v . x_ij of a velocity beside v_ij that one source has, m²/s.
    #[inline(always)]
    pub fn approach_by<A: Arch>(&self, velocity: &[f64; D]) -> L {
        dot::<D, A, L>(components(|d| L::splat(velocity[d])), self.dx)
    }
}

/// What a pair adds: `bracket` times m_j F x_ij and `vector` times m_j F to the acceleration, `density` times
/// m_j / rho_j F to the density's rate.
#[derive(Clone, Copy, Debug)]
pub struct PairRates<const D: usize, L = Lane> {
    /// Scalar bracket of the momentum equation.
    pub bracket: L,
    /// Density's rate.
    pub density: L,
    /// Vector part of the acceleration; left out where no effect has one.
    pub vector: [L; D],
}

impl<L: Lanes, const D: usize> PairRates<D, L> {
    /// Nothing yet.
    pub(crate) const ZERO: Self = Self { bracket: L::ZERO, density: L::ZERO, vector: [L::ZERO; D] };

    /// Adds what the pair's effects `E` accelerate; `mf` is m_j F.
    #[inline(always)]
    fn add_accelerations<A: Arch, E: PairEffect<D>>(&self, mf: L, dx: [L; D], accelerations: &mut [L; D]) {
        let bracket = mf * self.bracket;
        for d in 0..D {
            accelerations[d] = A::mul_add(bracket, dx[d], accelerations[d]);
            if E::VECTOR {
                accelerations[d] = A::mul_add(mf, self.vector[d], accelerations[d]);
            }
        }
    }
}

/// An effect in the pair pass. An absent effect is `()`; several are nested pairs.
pub trait PairEffect<const D: usize>: Copy + Send + Sync {
    /// What the effect loads of the targets before their neighbours are visited.
    type Own<L: Lanes>: Copy;
    /// The effect adds to [`PairRates::vector`].
    const VECTOR: bool = false;
    /// The effect adds to the acceleration.
    const MOMENTUM: bool = true;
    /// The effect adds to the density's rate.
    const CONTINUITY: bool = true;
    /// Loads the targets from `slot` on.
    fn own<L: Lanes>(&self, slot: usize) -> Self::Own<L>;
    /// Adds the share of source `j`.
    fn add<A: Arch, L: Lanes>(
        &self,
        own: &Self::Own<L>,
        j: usize,
        pair: &FluidPair<D, L>,
        rates: &mut PairRates<D, L>,
    );
    /// Enters a composition. A share that calls [`Composition::with`] has passes compiled for it: it doubles their
    /// number.
    fn enter<C: Composition<D>>(self, composition: C) {
        composition.complete();
    }
    /// What the name of a composition says of it.
    fn labels(_: &mut Vec<&'static str>) {}
}

impl<const D: usize> PairEffect<D> for () {
    type Own<L: Lanes> = ();
    const MOMENTUM: bool = false;
    const CONTINUITY: bool = false;
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, _: &FluidPair<D, L>, _: &mut PairRates<D, L>) {}
}

impl<const D: usize, E: PairEffect<D>, F: PairEffect<D>> PairEffect<D> for (E, F) {
    type Own<L: Lanes> = (E::Own<L>, F::Own<L>);
    const VECTOR: bool = E::VECTOR || F::VECTOR;
    const MOMENTUM: bool = E::MOMENTUM || F::MOMENTUM;
    const CONTINUITY: bool = E::CONTINUITY || F::CONTINUITY;
    #[inline(always)]
    fn own<L: Lanes>(&self, slot: usize) -> Self::Own<L> {
        (self.0.own(slot), self.1.own(slot))
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        own: &Self::Own<L>,
        j: usize,
        pair: &FluidPair<D, L>,
        rates: &mut PairRates<D, L>,
    ) {
        self.0.add::<A, L>(&own.0, j, pair, rates);
        self.1.add::<A, L>(&own.1, j, pair, rates);
    }
    fn labels(labels: &mut Vec<&'static str>) {
        E::labels(labels);
        F::labels(labels);
    }
}

/// An effect of which only the run knows whether it takes part.
impl<const D: usize, E: PairEffect<D>> PairEffect<D> for Option<E> {
    type Own<L: Lanes> = Option<E::Own<L>>;
    const VECTOR: bool = E::VECTOR;
    const MOMENTUM: bool = E::MOMENTUM;
    const CONTINUITY: bool = E::CONTINUITY;
    #[inline(always)]
    fn own<L: Lanes>(&self, slot: usize) -> Self::Own<L> {
        self.as_ref().map(|effect| effect.own(slot))
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        own: &Self::Own<L>,
        j: usize,
        pair: &FluidPair<D, L>,
        rates: &mut PairRates<D, L>,
    ) {
        if let (Some(effect), Some(own)) = (self, own) {
            effect.add::<A, L>(own, j, pair, rates);
        }
    }
    fn labels(labels: &mut Vec<&'static str>) {
        *labels = vec!["complete law"];
    }
}

/// Sums of the pass for several particles: four where they are stored.
#[derive(Clone, Copy, Debug)]
pub struct RateSum<const D: usize, L = Lane> {
    /// Acceleration, m/s².
    pub acceleration: [L; D],
    /// Rate of density, kg/(m³ s).
    pub density_rate: L,
}

pair_sum!(RateSum { D } { acceleration, density_rate });

impl<const D: usize> RateSum<D> {
    /// Adds to the k-th particle's rates.
    pub fn add(&mut self, k: usize, acceleration: [f64; D], density_rate: f64) {
        for d in 0..D {
            self.acceleration[d].0[k] += acceleration[d];
        }
        self.density_rate.0[k] += density_rate;
    }
}

/// The law of the pass: targets and sources may be the same set, or fluid and walls.
#[derive(Clone, Copy)]
pub struct RateLaw<'a, K, E, Q, const D: usize> {
    /// Kernel.
    pub kernel: K,
    /// What rates are wanted.
    pub equations: Q,
    /// Effects beside pressure and continuity.
    pub effects: E,
    /// Particles whose rates are wanted.
    pub targets: &'a PairParticles<D>,
    /// Neighbours of the targets.
    pub sources: &'a PairParticles<D>,
}

/// What a law loads of its targets.
#[derive(Clone, Copy)]
pub struct Target<O, L, const D: usize> {
    pub(crate) velocity: [L; D],
    density: L,
    excess: L,
    pub(crate) pressure_term: L,
    pub(crate) own: O,
}

impl<O, L: Lanes, const D: usize> Target<O, L, D> {
    #[inline(always)]
    pub(crate) fn load(targets: &PairParticles<D>, slot: usize, own: O) -> Self {
        Self {
            velocity: targets.velocities(slot),
            density: targets.densities(slot),
            excess: targets.excesses(slot),
            pressure_term: targets.pressure_terms(slot),
            own,
        }
    }

    /// The targets with other velocities, m/s, by slots.
    #[inline(always)]
    pub(crate) fn moving(self, velocity: &[[f64; D]], slot: usize) -> Self {
        Self { velocity: components(|d| each(velocity, slot, |v| v[d])), ..self }
    }

    /// The targets with one neighbour.
    #[inline(always)]
    pub(crate) fn with<A: Arch>(&self, s: &Beside<D, L>, dx: [L; D], r2: L) -> FluidPair<D, L> {
        let dv = components(|d| self.velocity[d] - s.velocity[d]);
        FluidPair {
            dx,
            r2,
            dv,
            approach: dot::<D, A, L>(dv, dx),
            density_i: self.density,
            density_j: s.density,
            density_difference: self.excess - s.excess,
            pressure_term_i: self.pressure_term,
            pressure_term_j: s.pressure_term,
        }
    }
}

impl<K: Kernel<D>, E: PairEffect<D>, Q: Equations, const D: usize> PairLaw<D> for RateLaw<'_, K, E, Q, D> {
    const SINGLE: bool = true;
    type Target<L: Lanes> = Target<E::Own<L>, L, D>;
    type Sum<L: Lanes> = RateSum<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.targets.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
        Target::load(self.targets, slot, self.effects.own(slot))
    }

    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.sources.sources[j].position
    }
    #[inline(always)]
    fn source_numbers<L: Lanes>(&self, j: usize) -> [L::Number; D] {
        self.sources.at::<L>(j)
    }

    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        i: &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut RateSum<D, L>,
    ) {
        let s = self.sources.beside::<L>(j);
        let f = self.kernel.gradient_over_r::<A, L>(distance(r2, self.kernel.smoothing_length()));
        let pair = i.with::<A>(&s, dx, r2);
        let mut rates = pressure_and_continuity(&pair);
        self.effects.add::<A, L>(&i.own, j, &pair, &mut rates);
        // What goes into the equation that is not wanted is not computed either.
        if Q::MOMENTUM {
            let mf = L::splat(self.sources.mass) * f;
            rates.add_accelerations::<A, E>(mf, dx, &mut sum.acceleration);
        }
        if Q::CONTINUITY {
            sum.density_rate = A::mul_add(s.volume * f, rates.density, sum.density_rate);
        }
    }
}

/// The accelerations that effects give at predicted velocities, without pressure.
pub struct PredictedLaw<'a, K, E, const D: usize> {
    /// Kernel.
    pub kernel: K,
    /// The effects.
    pub effects: E,
    /// Particles whose accelerations are wanted.
    pub targets: &'a PairParticles<D>,
    /// Their predicted velocities, m/s.
    pub velocities: &'a [[f64; D]],
    /// Neighbours of the targets.
    pub sources: &'a PairParticles<D>,
}

impl<K: Kernel<D>, E: PairEffect<D>, const D: usize> PairLaw<D> for PredictedLaw<'_, K, E, D> {
    const SINGLE: bool = true;
    type Target<L: Lanes> = Target<E::Own<L>, L, D>;
    type Sum<L: Lanes> = RateSum<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.targets.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
        Target::load(self.targets, slot, self.effects.own(slot)).moving(self.velocities, slot)
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.sources.sources[j].position
    }
    #[inline(always)]
    fn source_numbers<L: Lanes>(&self, j: usize) -> [L::Number; D] {
        self.sources.at::<L>(j)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        i: &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut RateSum<D, L>,
    ) {
        let s = self.sources.beside::<L>(j);
        let f = self.kernel.gradient_over_r::<A, L>(distance(r2, self.kernel.smoothing_length()));
        let pair = i.with::<A>(&s, dx, r2);
        let mut rates = PairRates::ZERO;
        self.effects.add::<A, L>(&i.own, j, &pair, &mut rates);
        rates.add_accelerations::<A, E>(L::splat(self.sources.mass) * f, dx, &mut sum.acceleration);
    }
}
