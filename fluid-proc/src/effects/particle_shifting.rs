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
use crate::columns::PairParticles;
use crate::composition::NoShare;
use crate::shifting_sums::{ShiftingSums, beyond};
use crate::walls::Walls;
use halfstep_scene::{Decision, Derived, EffectName, Scene};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, LANES, Lane, Lanes};
use halfstep_sph::pair::{self, PairLaw, pair_sum};

/// sigma: the formula of Sun et al. 2017 gives 0.2 for a fastest flow of c0 / 10; with 0.6 a vortex keeps more energy.
pub(crate) const STRENGTH: f64 = 0.6;
/// Largest drift over c0: half of the fastest flow that c0 is made for.
const FASTEST: f64 = 0.05;
/// Geometric mean of M's eigenvalues below which a particle is at a surface.
const SURFACE: f64 = 0.75;
/// More than any determinant of M.
const FAR: f64 = 1e3;
/// A number times it stays larger than the same number in single precision.
const ROUNDED: f64 = 1.000_001;

/// The effect.
#[derive(Clone, Debug)]
pub struct ParticleShifting<const D: usize> {
    sums: ShiftingSums<D>,
}

impl<const D: usize> Listed<D> for ParticleShifting<D> {
    fn of(scene: &Scene) -> Option<Self> {
        let sound_speed = scene.fluid.as_ref()?.sound_speed;
        let strength = STRENGTH * scene.smoothing_ratio * scene.resolution * sound_speed;
        let fastest = FASTEST * sound_speed;
        Some(Self { sums: ShiftingSums::new(scene.resolution, strength, fastest) })
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
        ShiftingSums::<D>::BYTES
    }
    fn resize(&mut self, slots: usize, _: Option<&Walls<D>>) {
        self.sums.resize(slots);
    }
    fn shifting_sums(&mut self) -> Option<&mut ShiftingSums<D>> {
        Some(&mut self.sums)
    }
    fn conclude<K: Kernel<D>>(&mut self, around: &Neighbourhood<'_, K, D>) -> u64 {
        let Neighbourhood { kernel, isa, fluid, list, .. } = *around;
        let ShiftingSums { drift, determinant, .. } = &mut self.sums;
        let at_surface = SURFACE.powi(D as i32);
        let stay = |around: &Around, drift: &mut [[f64; D]; LANES]| {
            for (drift, around) in drift.iter_mut().zip(around.determinant.0) {
                if around < at_surface {
                    *drift = [0.0; D];
                }
            }
        };
        let law = AroundLaw { kernel, determinant, inside: at_surface * ROUNDED, fluid };
        pair::pass_changing(isa, &law, list, stay, drift.as_chunks_mut().0);
        evaluations(list)
    }
    fn drift(&self) -> Option<&[[f64; D]]> {
        Some(&self.sums.drift)
    }
    fn bytes(&self) -> usize {
        self.sums.bytes()
    }
}

/// What is around several particles, within the kernel's support.
#[derive(Clone, Copy, Debug)]
struct Around<L = Lane> {
    /// Least det M, of those that are not inside.
    determinant: L,
}
pair_sum!(Around {} { determinant } from L::splat(FAR));

/// The law of the effect's own pass, over the fluid. Most of it is inside, and its distances are not computed.
struct AroundLaw<'a, K, const D: usize> {
    kernel: K,
    determinant: &'a [f64],
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
        self.determinant[j] >= self.inside
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
        let determinant = L::splat(self.determinant[j]) + beyond(&self.kernel, r2);
        sum.determinant = sum.determinant.min(determinant);
    }
}
