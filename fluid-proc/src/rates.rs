//! The one pass that gives acceleration and density rate: pressure, continuity and whatever effects the scene calls
//! for.

use crate::columns::{PairParticles, Source};
use crate::composition::Composition;
use crate::momentum::pressure_and_continuity;
use halfstep_sph::artificial_viscosity::damping;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Lane};
use halfstep_sph::pair::{PairLaw, distance, dot};

/// One particle with one of its neighbours, four times.
#[derive(Clone, Copy, Debug)]
pub struct FluidPair<const D: usize> {
    /// x_i - x_j, m.
    pub dx: [Lane; D],
    /// |x_ij|², m².
    pub r2: Lane,
    /// v_i - v_j, m/s.
    pub dv: [Lane; D],
    /// v_ij . x_ij, m²/s.
    pub approach: Lane,
    /// rho_i, kg/m³.
    pub density_i: Lane,
    /// rho_j, kg/m³.
    pub density_j: Lane,
    /// p_i / rho_i².
    pub pressure_term_i: Lane,
    /// p_j / rho_j².
    pub pressure_term_j: Lane,
}

impl<const D: usize> FluidPair<D> {
    /// Pi_ij of the artificial viscosity; `linear` is A c0, `quadratic` B.
    #[inline(always)]
    pub fn damping<A: Arch>(&self, h: f64, linear: Lane, quadratic: f64) -> Lane {
        let density_sum = self.density_i + self.density_j;
        damping::<A>(h, linear, Lane::splat(quadratic), self.approach, self.r2, density_sum)
    }
}

/// What a pair adds: `bracket` times m_j F x_ij and `vector` times m_j F to the acceleration, `density` times
/// m_j / rho_j F to the density's rate.
#[derive(Clone, Copy, Debug)]
pub struct PairRates<const D: usize> {
    /// Scalar bracket of the momentum equation.
    pub bracket: Lane,
    /// Density's rate.
    pub density: Lane,
    /// Vector part of the acceleration; left out where no effect has one.
    pub vector: [Lane; D],
}

/// An effect in the pair pass. An absent effect is `()`; several are nested pairs.
pub trait PairEffect<const D: usize>: Copy + Send + Sync {
    /// What the effect loads of four targets before their neighbours are visited.
    type Own: Copy;
    /// The effect adds to [`PairRates::vector`].
    const VECTOR: bool = false;
    /// Loads the targets at `slot..slot + 4`.
    fn own(&self, slot: usize) -> Self::Own;
    /// Adds the share of source `j`.
    fn add<A: Arch>(&self, own: &Self::Own, j: usize, pair: &FluidPair<D>, rates: &mut PairRates<D>);
    /// Enters a composition. A share that calls [`Composition::with`] has passes compiled for it: it doubles their
    /// number.
    fn enter<C: Composition<D>>(self, composition: C) {
        composition.complete();
    }
    /// What the name of a composition says of it.
    fn labels(_: &mut Vec<&'static str>) {}
}

impl<const D: usize> PairEffect<D> for () {
    type Own = ();
    #[inline(always)]
    fn own(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch>(&self, _: &(), _: usize, _: &FluidPair<D>, _: &mut PairRates<D>) {}
}

impl<const D: usize, E: PairEffect<D>, F: PairEffect<D>> PairEffect<D> for (E, F) {
    type Own = (E::Own, F::Own);
    const VECTOR: bool = E::VECTOR || F::VECTOR;
    #[inline(always)]
    fn own(&self, slot: usize) -> Self::Own {
        (self.0.own(slot), self.1.own(slot))
    }
    #[inline(always)]
    fn add<A: Arch>(&self, own: &Self::Own, j: usize, pair: &FluidPair<D>, rates: &mut PairRates<D>) {
        self.0.add::<A>(&own.0, j, pair, rates);
        self.1.add::<A>(&own.1, j, pair, rates);
    }
    fn labels(labels: &mut Vec<&'static str>) {
        E::labels(labels);
        F::labels(labels);
    }
}

/// An effect of which only the run knows whether it takes part.
impl<const D: usize, E: PairEffect<D>> PairEffect<D> for Option<E> {
    type Own = Option<E::Own>;
    const VECTOR: bool = E::VECTOR;
    #[inline(always)]
    fn own(&self, slot: usize) -> Self::Own {
        self.as_ref().map(|effect| effect.own(slot))
    }
    #[inline(always)]
    fn add<A: Arch>(&self, own: &Self::Own, j: usize, pair: &FluidPair<D>, rates: &mut PairRates<D>) {
        if let (Some(effect), Some(own)) = (self, own) {
            effect.add::<A>(own, j, pair, rates);
        }
    }
    fn labels(labels: &mut Vec<&'static str>) {
        *labels = vec!["complete law"];
    }
}

/// Sums of the pass for four particles.
#[derive(Clone, Copy, Debug)]
pub struct RateSum<const D: usize> {
    /// Acceleration, m/s².
    pub acceleration: [Lane; D],
    /// Rate of density, kg/(m³ s).
    pub density_rate: Lane,
}

impl<const D: usize> Default for RateSum<D> {
    fn default() -> Self {
        Self { acceleration: [Lane::ZERO; D], density_rate: Lane::ZERO }
    }
}

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
pub struct RateLaw<'a, K, E, const D: usize> {
    /// Kernel.
    pub kernel: K,
    /// Effects beside pressure and continuity.
    pub effects: E,
    /// Particles whose rates are wanted.
    pub targets: &'a PairParticles<D>,
    /// Neighbours of the targets.
    pub sources: &'a PairParticles<D>,
}

/// What a law loads of four targets.
#[derive(Clone, Copy)]
pub struct Target<O, const D: usize> {
    pub(crate) velocity: [Lane; D],
    density: Lane,
    pub(crate) pressure_term: Lane,
    pub(crate) own: O,
}

impl<O, const D: usize> Target<O, D> {
    #[inline(always)]
    pub(crate) fn load(targets: &PairParticles<D>, slot: usize, own: O) -> Self {
        Self {
            velocity: targets.velocities(slot),
            density: targets.densities(slot),
            pressure_term: targets.pressure_terms(slot),
            own,
        }
    }

    /// The targets with one neighbour.
    #[inline(always)]
    pub(crate) fn with<A: Arch>(&self, s: &Source<D>, dx: [Lane; D], r2: Lane) -> FluidPair<D> {
        let dv = std::array::from_fn(|d| self.velocity[d] - Lane::splat(s.velocity[d]));
        FluidPair {
            dx,
            r2,
            dv,
            approach: dot::<D, A>(dv, dx),
            density_i: self.density,
            density_j: Lane::splat(s.density),
            pressure_term_i: self.pressure_term,
            pressure_term_j: Lane::splat(s.pressure_term),
        }
    }
}

impl<K: Kernel<D>, E: PairEffect<D>, const D: usize> PairLaw<D> for RateLaw<'_, K, E, D> {
    type Target = Target<E::Own, D>;
    type Sum = RateSum<D>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.targets.position
    }
    #[inline(always)]
    fn target(&self, slot: usize) -> Self::Target {
        Target::load(self.targets, slot, self.effects.own(slot))
    }

    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.sources.sources[j].position
    }

    #[inline(always)]
    fn add<A: Arch>(&self, i: &Self::Target, j: usize, dx: [Lane; D], r2: Lane, sum: &mut RateSum<D>) {
        let s = &self.sources.sources[j];
        let f = self.kernel.gradient_over_r::<A>(distance(r2, self.kernel.smoothing_length()));
        let pair = i.with::<A>(s, dx, r2);
        let mut rates = pressure_and_continuity(&pair);
        self.effects.add::<A>(&i.own, j, &pair, &mut rates);
        let mf = Lane::splat(self.sources.mass) * f;
        let bracket = mf * rates.bracket;
        for d in 0..D {
            sum.acceleration[d] = A::mul_add(bracket, dx[d], sum.acceleration[d]);
            if E::VECTOR {
                sum.acceleration[d] = A::mul_add(mf, rates.vector[d], sum.acceleration[d]);
            }
        }
        sum.density_rate = A::mul_add(Lane::splat(s.volume) * f, rates.density, sum.density_rate);
    }
}
