//! The sums of particle shifting: the concentration's gradient, sum V [1 + R (W / W(dx))^4] grad W, of which its drift
//! is made, and the moment matrix M = sum V (x_j - x_i) (x) grad W. They go along with the accelerations of the second
//! stage, whose pass over the fluid visits the same pairs at the same places; where that pass gives both equations they
//! have one of their own, since each composition of effects with them along takes long to compile.

use crate::columns::{PairParticles, fit};
use crate::equations::Momentum;
use crate::rates::{PairEffect, RateLaw, RateSum, Target};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Isa, LANES, Lane, Lanes};
use halfstep_sph::neighbours::ClusterList;
use halfstep_sph::pair::{self, Along, PairLaw, distance, pair_sum};
use halfstep_sph::tensor::determinant;
use nalgebra::SMatrix;

/// R, against pairing.
const PAIRING: f64 = 0.2;
/// Largest drift over the fastest velocity of a neighbour relative to the particle. From 0.5 on water at rest keeps
/// moving against its drift.
pub(crate) const STRAINED: f64 = 0.3;

/// What the sums give of each slot.
#[derive(Clone, Debug)]
pub struct ShiftingSums<const D: usize> {
    /// Particle spacing, m.
    spacing: f64,
    /// sigma h c0, m²/s.
    strength: f64,
    /// Largest drift, m/s.
    fastest: f64,
    /// delta u, m/s. At a surface the effect's own pass makes it zero afterwards.
    pub(crate) drift: Vec<[f64; D]>,
    /// det M.
    pub(crate) determinant: Vec<f64>,
}

impl<const D: usize> ShiftingSums<D> {
    /// Memory, bytes a particle.
    pub(crate) const BYTES: usize = size_of::<[f64; D]>() + size_of::<f64>();

    /// For particles of a spacing, m; a drift is `strength`, m²/s, times the concentration's gradient, at most
    /// `fastest`, m/s.
    pub(crate) fn new(spacing: f64, strength: f64, fastest: f64) -> Self {
        Self { spacing, strength, fastest, drift: Vec::new(), determinant: Vec::new() }
    }

    /// Without particles, in the place of what is taken out of it.
    pub(crate) fn none() -> Self {
        Self::new(0.0, 0.0, 0.0)
    }

    /// Fits it to the slots of the fluid.
    pub(crate) fn resize(&mut self, slots: usize) {
        fit(&mut self.drift, slots, [0.0; D]);
        fit(&mut self.determinant, slots, 0.0);
    }

    /// Bytes allocated.
    pub(crate) fn bytes(&self) -> usize {
        self.drift.capacity() * size_of::<[f64; D]>() + self.determinant.capacity() * size_of::<f64>()
    }

    /// Runs the pass of the accelerations over the fluid with these sums along, which go on over the walls.
    pub(crate) fn with_accelerations<K: Kernel<D>, E: PairEffect<D>>(
        &mut self,
        isa: Isa,
        rates: RateLaw<'_, K, E, Momentum, D>,
        list: &ClusterList,
        walls: Option<(&PairParticles<D>, &ClusterList)>,
        sums: &mut [RateSum<D>],
    ) {
        let (law, walls) = self.laws(rates.kernel, rates.targets, walls);
        let (found, columns) = self.found();
        pair::pass_together(isa, (rates, law), list, walls, sums, found, columns);
    }

    /// Runs a pass of these sums alone, over fluid and walls.
    pub(crate) fn alone<K: Kernel<D>>(
        &mut self,
        isa: Isa,
        kernel: K,
        fluid: &PairParticles<D>,
        list: &ClusterList,
        walls: Option<(&PairParticles<D>, &ClusterList)>,
    ) {
        let (law, walls) = self.laws(kernel, fluid, walls);
        let (found, columns) = self.found();
        pair::pass_onward(isa, law, list, walls, found, columns);
    }

    /// The laws over fluid and walls.
    fn laws<'a, K: Kernel<D>>(
        &self,
        kernel: K,
        fluid: &'a PairParticles<D>,
        walls: Option<(&'a PairParticles<D>, &'a ClusterList)>,
    ) -> (ShiftingLaw<'a, K, D>, Option<(ShiftingLaw<'a, K, D>, &'a ClusterList)>) {
        let at_spacing = 1.0 / kernel.at(self.spacing);
        let law = ShiftingLaw { kernel, at_spacing, targets: fluid, sources: fluid, flows: true };
        (law, walls.map(|(sources, list)| (ShiftingLaw { sources, flows: false, ..law }, list)))
    }

    /// What makes drift and determinant of sums, and the columns of both.
    fn found(
        &mut self,
    ) -> (impl Fn(usize, &ShiftingSum<D>) -> Shifts<D> + Copy + Sync + use<D>, Columns<'_, D>) {
        let (strength, fastest) = (self.strength, self.fastest);
        let columns = (self.drift.as_chunks_mut().0, self.determinant.as_chunks_mut().0);
        (move |_, sum| sum.shift(strength, fastest), columns)
    }
}

/// Drift and determinant of several particles.
type Shifts<const D: usize> = ([[f64; D]; LANES], [f64; LANES]);
/// The columns of both.
type Columns<'a, const D: usize> = (&'a mut [[[f64; D]; LANES]], &'a mut [[f64; LANES]]);

/// The sums of several particles.
#[derive(Clone, Copy, Debug)]
struct ShiftingSum<const D: usize, L = Lane> {
    /// sum V [1 + R (W / W(dx))^4] grad W, 1/m.
    crowd: [L; D],
    /// M; only its upper half.
    moment: [[L; D]; D],
    /// Least -|v_ij|² within the kernel's support, m²/s²: a particle is its own neighbour.
    against: L,
}

pair_sum!(ShiftingSum { D } { crowd, moment, against });

impl<const D: usize> ShiftingSum<D> {
    // Inlined, its scalar arithmetic would break up the vectors of the loop before it.
    #[inline(never)]
    fn shift(&self, strength: f64, fastest: f64) -> Shifts<D> {
        let drift = std::array::from_fn(|k| {
            let fastest = fastest.min(STRAINED * (-self.against.0[k]).max(0.0).sqrt());
            let drift = self.crowd.map(|c| -strength * c.0[k]);
            let speed = drift.iter().map(|d| d * d).sum::<f64>().sqrt();
            if speed > fastest { drift.map(|d| d * fastest / speed) } else { drift }
        });
        let determinant = std::array::from_fn(|k| {
            determinant::<D>(&SMatrix::from_fn(|a, b| self.moment[a.min(b)][a.max(b)].0[k]))
        });
        (drift, determinant)
    }
}

/// The law of the sums, over fluid or walls.
#[derive(Clone, Copy)]
struct ShiftingLaw<'a, K, const D: usize> {
    kernel: K,
    /// 1 / W(dx), m^D.
    at_spacing: f64,
    targets: &'a PairParticles<D>,
    sources: &'a PairParticles<D>,
    /// The sources flow: their velocities count.
    flows: bool,
}

impl<K: Kernel<D>, const D: usize> PairLaw<D> for ShiftingLaw<'_, K, D> {
    const SINGLE: bool = true;
    /// Velocity.
    type Target<L: Lanes> = [L; D];
    type Sum<L: Lanes> = ShiftingSum<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.targets.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> [L; D] {
        self.targets.velocities(slot)
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
        velocity: &[L; D],
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut ShiftingSum<D, L>,
    ) {
        let r = distance(r2, self.kernel.smoothing_length());
        let source = self.sources.beside::<L>(j);
        let vf = source.volume * self.kernel.gradient_over_r::<A, L>(r);
        let near = self.kernel.value::<A, L>(r) * L::splat(self.at_spacing);
        let near2 = near * near;
        let crowd = A::mul_add(vf * L::splat(PAIRING), near2 * near2, vf);
        for a in 0..D {
            sum.crowd[a] = A::mul_add(crowd, dx[a], sum.crowd[a]);
            let row = -(vf * dx[a]);
            for b in a..D {
                sum.moment[a][b] = A::mul_add(row, dx[b], sum.moment[a][b]);
            }
        }
        if self.flows {
            let mut against = beyond(&self.kernel, r2);
            for d in 0..D {
                let dv = velocity[d] - source.velocity[d];
                against = A::mul_add(-dv, dv, against);
            }
            sum.against = sum.against.min(against);
        }
    }
}

impl<'a, K: Kernel<D>, E: PairEffect<D>, const D: usize> Along<RateLaw<'a, K, E, Momentum, D>, D>
    for ShiftingLaw<'a, K, D>
{
    #[inline(always)]
    fn along(&self, rates: &RateLaw<'a, K, E, Momentum, D>) -> Self {
        let RateLaw { kernel, targets, sources, .. } = *rates;
        Self { kernel, targets, sources, flows: true, ..*self }
    }
    #[inline(always)]
    fn targets<L: Lanes>(rates: &Target<E::Own<L>, L, D>) -> [L; D] {
        rates.velocity
    }
}

/// Zero within the support; beyond, far more than any determinant or square of a speed.
#[inline(always)]
pub(crate) fn beyond<K: Kernel<D>, L: Lanes, const D: usize>(kernel: &K, r2: L) -> L {
    let reach = 2.0 * kernel.smoothing_length();
    (r2 - L::splat(reach * reach)).max(L::ZERO) * L::splat(L::FAR)
}

#[cfg(test)]
#[path = "shifting_sums_tests.rs"]
mod tests;
