//! Diffusion of density: + delta h c0 sum_j m_j / rho_j psi_ij . grad W on the density's rate, fluid pairs only.
//!
//! With grad W = F x_ij, psi_ij . grad W is F times
//! - simple (Molteni and Colagrossi 2009): 2 (rho_i - rho_j);
//! - hydrostatic (Fourtakas et al. 2019, linearised): 2 (rho_i - rho_j - rho0 g . x_ij / c0²);
//! - delta-SPH (Antuono et al. 2010; Marrone et al. 2011, Kayaki's eqs. 18 to 21):
//!   2 (rho_i - rho_j) - ({grad rho}_i + {grad rho}_j) . x_ij, with the renormalised gradient of
//!   [`gradient`]. (Printed with a difference of the gradients in Kayaki's eq. (19); only the sum cancels a
//!   linear field.)

pub mod gradient;

use super::frozen_diffusion::FrozenDiffusion;
use super::{FluidEffect, Listed, Neighbourhood, evaluations};
use crate::columns::{each, fit};
use crate::composition::{Composition, NoShare};
use crate::rates::{FluidPair, PairEffect, PairRates};
use crate::walls::Walls;
use gradient::{GradientLaw, GradientSum};
use halfstep_scene::{Decision, DensityDiffusion as Variant, Derived, EffectName, Scene};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, LANES, Lanes, components};
use halfstep_sph::pair::{self, dot};
use halfstep_wire::half_step::Stage;

/// delta h c0, m²/s.
#[derive(Clone, Copy, Debug)]
pub struct Strength(pub f64);

/// Molteni and Colagrossi.
#[derive(Clone, Copy, Debug)]
pub struct Simple(pub Strength);

/// Fourtakas.
#[derive(Clone, Copy, Debug)]
pub struct Hydrostatic<const D: usize> {
    /// delta h c0.
    pub strength: Strength,
    /// rho0 g / c0²: the density gradient at rest, kg/m⁴.
    pub gradient: [f64; D],
}

/// Antuono, Marrone.
#[derive(Clone, Copy, Debug)]
pub struct DeltaSph<'a, const D: usize> {
    /// delta h c0.
    pub strength: Strength,
    /// Renormalised density gradient of each slot, kg/m⁴.
    pub gradient: &'a [[f64; D]],
}

/// One of the variants.
#[derive(Clone, Copy, Debug)]
pub enum Diffusion<'a, const D: usize> {
    /// Molteni and Colagrossi.
    Simple(Simple),
    /// Fourtakas.
    Hydrostatic(Hydrostatic<D>),
    /// Antuono, Marrone.
    DeltaSph(DeltaSph<'a, D>),
}

/// The effect.
#[derive(Clone, Debug)]
pub struct DensityDiffusion<const D: usize> {
    variant: Variant,
    strength: Strength,
    /// rho0 / c0², kg s²/m⁵.
    compliance: f64,
    /// That times g: the density gradient at rest, kg/m⁴.
    at_rest: [f64; D],
    /// Renormalised density gradient of each cluster's particles, kg/m⁴; only delta-SPH has it.
    gradient: Vec<[[f64; D]; LANES]>,
    /// The gradient is computed at the first stage of a step only.
    frozen: bool,
    /// The gradient was computed since the last sort.
    known: bool,
}

impl<const D: usize> Listed<D> for DensityDiffusion<D> {
    fn of(scene: &Scene) -> Option<Self> {
        let fluid = scene.fluid.as_ref()?;
        let h = scene.smoothing_ratio * scene.resolution;
        let compliance = fluid.density / fluid.sound_speed.powi(2);
        Some(Self {
            variant: fluid.density_diffusion,
            strength: Strength(fluid.density_diffusion_coefficient * h * fluid.sound_speed),
            compliance,
            at_rest: std::array::from_fn(|d| compliance * scene.gravity[d]),
            gradient: Vec::new(),
            frozen: FrozenDiffusion::<D>::decide(scene).on,
            known: false,
        })
    }
}

impl<const D: usize> FluidEffect<D> for DensityDiffusion<D> {
    const NAME: &'static str = EffectName::DensityDiffusion.name();
    type Pair<'a> = Diffusion<'a, D>;
    type AtWall<'a> = NoShare;
    fn decide(scene: &Scene) -> Decision {
        let derived =
            match scene.fluid.as_ref().map(|f| (f.density_diffusion, f.density_diffusion_coefficient)) {
                None => Derived::Impossible("the scene has no fluid".into()),
                Some((Variant::None, _)) => Derived::Impossible("fluid.density_diffusion is \"none\"".into()),
                Some((_, 0.0)) => Derived::Impossible("fluid.density_diffusion_coefficient is zero".into()),
                Some((variant, delta)) => {
                    let name = match variant {
                        Variant::None => "none",
                        Variant::Simple => "simple",
                        Variant::Hydrostatic => "hydrostatic",
                        Variant::DeltaSph => "delta-sph",
                    };
                    Derived::On(format!("fluid.density_diffusion is \"{name}\", delta = {delta}"))
                }
            };
        Decision::new(scene, EffectName::DensityDiffusion, derived)
    }
    fn bytes_per_particle(scene: &Scene) -> usize {
        let renormalised = scene.fluid.as_ref().is_some_and(|f| f.density_diffusion == Variant::DeltaSph);
        if renormalised { size_of::<[f64; D]>() } else { 0 }
    }
    fn resize(&mut self, slots: usize, _: Option<&Walls<D>>) {
        if self.variant == Variant::DeltaSph {
            fit(&mut self.gradient, slots / LANES, [[0.0; D]; LANES]);
            self.known = false;
        }
    }
    fn prepare<K: Kernel<D>>(&mut self, stage: Stage, around: &Neighbourhood<'_, K, D>) -> u64 {
        self.at_rest = around.gravity.map(|g| self.compliance * g);
        let stays = self.frozen && self.known && stage == Stage::Second;
        if self.variant != Variant::DeltaSph || stays || !around.needed(stage).continuity() {
            return 0;
        }
        self.known = true;
        let law = GradientLaw { kernel: around.kernel, fluid: around.fluid };
        let solve = |_, sum: &GradientSum<D>| sum.solve();
        pair::pass_into(around.isa, &law, around.list, solve, &mut self.gradient);
        evaluations(around.list)
    }
    fn pair(&self) -> Option<Diffusion<'_, D>> {
        let strength = self.strength;
        match self.variant {
            Variant::None => None,
            Variant::Simple => Some(Diffusion::Simple(Simple(strength))),
            Variant::Hydrostatic => {
                Some(Diffusion::Hydrostatic(Hydrostatic { strength, gradient: self.at_rest }))
            }
            Variant::DeltaSph => {
                Some(Diffusion::DeltaSph(DeltaSph { strength, gradient: self.gradient.as_flattened() }))
            }
        }
    }
    fn bytes(&self) -> usize {
        self.gradient.capacity() * size_of::<[[f64; D]; LANES]>()
    }
}

impl<const D: usize> PairEffect<D> for Diffusion<'_, D> {
    type Own<L: Lanes> = [L; D];
    const MOMENTUM: bool = false;
    #[inline(always)]
    fn own<L: Lanes>(&self, slot: usize) -> [L; D] {
        match self {
            Self::DeltaSph(d) => d.own(slot),
            Self::Simple(_) | Self::Hydrostatic(_) => [L::ZERO; D],
        }
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        own: &[L; D],
        j: usize,
        pair: &FluidPair<D, L>,
        rates: &mut PairRates<D, L>,
    ) {
        match self {
            Self::Simple(d) => d.add::<A, L>(&(), j, pair, rates),
            Self::Hydrostatic(d) => d.add::<A, L>(&(), j, pair, rates),
            Self::DeltaSph(d) => d.add::<A, L>(own, j, pair, rates),
        }
    }
    fn enter<C: Composition<D>>(self, composition: C) {
        match self {
            Self::Simple(share) => composition.with(share),
            Self::Hydrostatic(share) => composition.with(share),
            Self::DeltaSph(share) => composition.with(share),
        }
    }
}

#[inline(always)]
fn diffuse<const D: usize, A: Arch, L: Lanes>(strength: Strength, psi: L, rates: &mut PairRates<D, L>) {
    rates.density = A::mul_add(L::splat(strength.0), psi, rates.density);
}

#[inline(always)]
fn twice_difference<const D: usize, L: Lanes>(pair: &FluidPair<D, L>) -> L {
    L::splat(2.0) * pair.density_difference
}

impl<const D: usize> PairEffect<D> for Simple {
    type Own<L: Lanes> = ();
    const MOMENTUM: bool = false;
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, pair: &FluidPair<D, L>, rates: &mut PairRates<D, L>) {
        diffuse::<D, A, L>(self.0, twice_difference(pair), rates);
    }
    fn labels(labels: &mut Vec<&'static str>) {
        labels.push("simple diffusion");
    }
}

impl<const D: usize> PairEffect<D> for Hydrostatic<D> {
    type Own<L: Lanes> = ();
    const MOMENTUM: bool = false;
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, pair: &FluidPair<D, L>, rates: &mut PairRates<D, L>) {
        let rest = dot::<D, A, L>(components(|d| L::splat(2.0 * self.gradient[d])), pair.dx);
        diffuse::<D, A, L>(self.strength, twice_difference(pair) - rest, rates);
    }
    fn labels(labels: &mut Vec<&'static str>) {
        labels.push("hydrostatic diffusion");
    }
}

impl<const D: usize> PairEffect<D> for DeltaSph<'_, D> {
    type Own<L: Lanes> = [L; D];
    const MOMENTUM: bool = false;
    #[inline(always)]
    fn own<L: Lanes>(&self, slot: usize) -> [L; D] {
        components(|d| each(self.gradient, slot, |g| g[d]))
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        own: &[L; D],
        j: usize,
        pair: &FluidPair<D, L>,
        rates: &mut PairRates<D, L>,
    ) {
        let gradient = &self.gradient[j];
        let sum: [L; D] = components(|d| own[d] + L::splat(gradient[d]));
        diffuse::<D, A, L>(self.strength, twice_difference(pair) - dot::<D, A, L>(sum, pair.dx), rates);
    }
    fn labels(labels: &mut Vec<&'static str>) {
        labels.push("delta-SPH diffusion");
    }
}
