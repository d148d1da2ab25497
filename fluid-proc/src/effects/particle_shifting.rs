//! Particle shifting (Sun, Colagrossi, Marrone and Zhang 2017): particles move, beside their velocity, from where they
//! are many to where they are few, by
//!   delta u_i = -sigma h c0 sum_j V_j [1 + R (W_ij / W(dx))^4] grad W,
//!   at most c0 / 20 and 0.3 max_j |v_ij|,
//! over fluid and walls. In order the sum is zero; the flow's strain brings particles into disorder, over which kernel
//! sums are wrong. Without strain there is nothing to mend: beside walls and surfaces the sum need not be zero at rest,
//! and water that is shifted there flows against it for ever.
//!
//! At a free surface the sum points out of the water, and a solid is no neighbour here: beside both, particles are not
//! shifted. The determinant of M_i = sum_j V_j (x_j - x_i) (x) grad W tells where: 1 inside, 1/4 at a flat surface in
//! the plane, 0 for a lone particle. Sun et al. shift along a surface, too; beside a solid that let water into it.

use super::{FluidEffect, Listed, Neighbourhood, evaluations};
use crate::columns::{PairParticles, fit};
use crate::composition::NoShare;
use crate::walls::Walls;
use halfstep_scene::{Decision, Derived, EffectName, Scene};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, LANES, Lane, Lanes};
use halfstep_sph::pair::{self, PairLaw, distance, pair_sum};
use halfstep_sph::tensor::determinant;
use halfstep_wire::half_step::Stage;
use nalgebra::SMatrix;

/// sigma: the formula of Sun et al. 2017 gives 0.2 for a fastest flow of c0 / 10; with 0.6 a vortex keeps more energy.
pub(crate) const STRENGTH: f64 = 0.6;
/// R, against pairing.
const PAIRING: f64 = 0.2;
/// Largest drift over c0: half of the fastest flow that c0 is made for.
const FASTEST: f64 = 0.05;
/// Largest drift over the fastest velocity of a neighbour relative to the particle. From 0.5 on water at rest keeps
/// moving against its drift.
pub(crate) const STRAINED: f64 = 0.3;
/// Geometric mean of M's eigenvalues below which a particle is at a surface.
const SURFACE: f64 = 0.75;
/// More than any determinant of M.
const FAR: f64 = 1e3;
/// A number times it stays larger than the same number in single precision.
const ROUNDED: f64 = 1.000_001;

/// The effect.
#[derive(Clone, Debug)]
pub struct ParticleShifting<const D: usize> {
    spacing: f64,
    /// sigma h c0, m²/s.
    strength: f64,
    /// Largest drift, m/s.
    fastest: f64,
    order: Vec<Order<D>>,
    drift: Vec<[f64; D]>,
}

impl<const D: usize> Listed<D> for ParticleShifting<D> {
    fn of(scene: &Scene) -> Option<Self> {
        let sound_speed = scene.fluid.as_ref()?.sound_speed;
        Some(Self {
            spacing: scene.resolution,
            strength: STRENGTH * scene.smoothing_ratio * scene.resolution * sound_speed,
            fastest: FASTEST * sound_speed,
            order: Vec::new(),
            drift: Vec::new(),
        })
    }
}

impl<const D: usize> FluidEffect<D> for ParticleShifting<D> {
    const NAME: &'static str = EffectName::ParticleShifting.name();
    type Pair<'a> = NoShare;
    type AtWall<'a> = NoShare;
    fn decide(scene: &Scene) -> Decision {
        let derived = match &scene.fluid {
            None => Derived::Impossible("the scene has no fluid".into()),
            Some(_) if scene.has_wide_support() => Derived::On("a wide kernel's sums ask for order".into()),
            Some(_) if scene.has_free_bodies() => {
                Derived::On("a body that nothing holds rides on waves, which order keeps".into())
            }
            Some(_) if halfstep_scene::viscosity(scene).on => {
                Derived::On("viscosity is on, and would damp what disorder stirs up".into())
            }
            Some(_) => {
                Derived::Off("for kernels wider than h / dx = 1.75, free bodies and viscous fluids".into())
            }
        };
        Decision::new(scene, EffectName::ParticleShifting, derived)
    }
    fn bytes_per_particle(_: &Scene) -> usize {
        size_of::<Order<D>>() + size_of::<[f64; D]>()
    }
    fn resize(&mut self, slots: usize, _: Option<&Walls<D>>) {
        fit(&mut self.order, slots, Order { drift: [0.0; D], determinant: 0.0 });
        fit(&mut self.drift, slots, [0.0; D]);
    }
    fn prepare<K: Kernel<D>>(&mut self, stage: Stage, around: &Neighbourhood<'_, K, D>) -> u64 {
        if stage == Stage::First {
            return 0;
        }
        let Neighbourhood { kernel, isa, fluid, list, walls, .. } = *around;
        let at_spacing = 1.0 / kernel.at(self.spacing);
        let law = OrderLaw { kernel, at_spacing, targets: fluid, sources: fluid, flows: true };
        let (order, _) = self.order.as_chunks_mut();
        let (strength, fastest) = (self.strength, self.fastest);
        let found = |_, sum: &OrderSum<D>| sum.order(strength, fastest);
        let mut pairs = 2 * evaluations(list);
        if let Some((walls, wall_list)) = walls {
            let at_walls = OrderLaw { sources: &walls.shown, flows: false, ..law };
            pair::pass_both_into(isa, (&law, list), (&at_walls, wall_list), found, order);
            pairs += evaluations(wall_list);
        } else {
            pair::pass_into(isa, &law, list, found, order);
        }
        let order = self.order.as_slice();
        let at_surface = SURFACE.powi(D as i32);
        let drift = |slot: usize, around: &Around| -> [[f64; D]; LANES] {
            std::array::from_fn(|k| match around.determinant.0[k] < at_surface {
                true => [0.0; D],
                false => order[slot + k].drift,
            })
        };
        let law = AroundLaw { kernel, order, inside: at_surface * ROUNDED, fluid };
        pair::pass_into(isa, &law, list, drift, self.drift.as_chunks_mut().0);
        pairs
    }
    fn drift(&self) -> Option<&[[f64; D]]> {
        Some(&self.drift)
    }
    fn bytes(&self) -> usize {
        self.order.capacity() * size_of::<Order<D>>() + self.drift.capacity() * size_of::<[f64; D]>()
    }
}

/// What the first pass finds of a particle.
#[derive(Clone, Copy, Debug)]
struct Order<const D: usize> {
    /// delta u where no surface is near, m/s.
    drift: [f64; D],
    /// det M.
    determinant: f64,
}

/// The same of several, as sums.
#[derive(Clone, Copy, Debug)]
struct OrderSum<const D: usize, L = Lane> {
    /// sum V [1 + R (W / W(dx))^4] grad W, 1/m.
    crowd: [L; D],
    /// M; only its upper half.
    moment: [[L; D]; D],
    /// Least -|v_ij|² within the kernel's support, m²/s²: a particle is its own neighbour.
    against: L,
}

pair_sum!(OrderSum { D } { crowd, moment, against });

impl<const D: usize> OrderSum<D> {
    // Inlined, its scalar arithmetic would break up the vectors of the loop before it.
    #[inline(never)]
    fn order(&self, strength: f64, fastest: f64) -> [Order<D>; LANES] {
        std::array::from_fn(|k| {
            let moment = SMatrix::from_fn(|a, b| self.moment[a.min(b)][a.max(b)].0[k]);
            let fastest = fastest.min(STRAINED * (-self.against.0[k]).max(0.0).sqrt());
            let drift = self.crowd.map(|c| -strength * c.0[k]);
            let speed = drift.iter().map(|d| d * d).sum::<f64>().sqrt();
            let drift = if speed > fastest { drift.map(|d| d * fastest / speed) } else { drift };
            Order { drift, determinant: determinant::<D>(&moment) }
        })
    }
}

/// The law of the first pass, over fluid or walls.
struct OrderLaw<'a, K, const D: usize> {
    kernel: K,
    /// 1 / W(dx), m^D.
    at_spacing: f64,
    targets: &'a PairParticles<D>,
    sources: &'a PairParticles<D>,
    /// The sources flow: their velocities count.
    flows: bool,
}

impl<K: Kernel<D>, const D: usize> PairLaw<D> for OrderLaw<'_, K, D> {
    const SINGLE: bool = true;
    /// Velocity.
    type Target<L: Lanes> = [L; D];
    type Sum<L: Lanes> = OrderSum<D, L>;

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
        sum: &mut OrderSum<D, L>,
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

/// Zero within the support; beyond, far more than any determinant or square of a speed.
#[inline(always)]
fn beyond<K: Kernel<D>, L: Lanes, const D: usize>(kernel: &K, r2: L) -> L {
    let reach = 2.0 * kernel.smoothing_length();
    (r2 - L::splat(reach * reach)).max(L::ZERO) * L::splat(L::FAR)
}

/// What is around several particles, within the kernel's support.
#[derive(Clone, Copy, Debug)]
struct Around<L = Lane> {
    /// Least det M, of those that are not inside.
    determinant: L,
}
pair_sum!(Around {} { determinant } from L::splat(FAR));

/// The law of the second pass, over the fluid. Most of it is inside, and its distances are not computed.
struct AroundLaw<'a, K, const D: usize> {
    kernel: K,
    order: &'a [Order<D>],
    /// Determinants from which a particle is inside.
    inside: f64,
    fluid: &'a PairParticles<D>,
}

impl<K: Kernel<D>, const D: usize> PairLaw<D> for AroundLaw<'_, K, D> {
    const SINGLE: bool = true;
    type Target<L: Lanes> = ();
    type Sum<L: Lanes> = Around<L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.fluid.position
    }
    #[inline(always)]
    fn skips(&self, j: usize) -> bool {
        self.order[j].determinant >= self.inside
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.fluid.sources[j].position
    }
    #[inline(always)]
    fn source_numbers<L: Lanes>(&self, j: usize) -> [L::Number; D] {
        self.fluid.at::<L>(j)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), j: usize, _: [L; D], r2: L, sum: &mut Around<L>) {
        let determinant = L::splat(self.order[j].determinant) + beyond(&self.kernel, r2);
        sum.determinant = sum.determinant.min(determinant);
    }
}
