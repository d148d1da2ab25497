//! Diffusion of density: + delta h c0 sum_j m_j / rho_j psi_ij . grad W on the density's rate, fluid pairs only.
//!
//! With grad W = F x_ij, psi_ij . grad W is F times
//! - simple (Molteni and Colagrossi 2009): 2 (rho_i - rho_j);
//! - hydrostatic (Fourtakas et al. 2019, linearised): 2 (rho_i - rho_j - rho0 g . x_ij / c0²);
//! - delta-SPH (Antuono et al. 2010; Marrone et al. 2011, Kayaki's eqs. 18 to 21):
//!   2 (rho_i - rho_j) - ({grad rho}_i + {grad rho}_j) . x_ij, with the renormalised gradient of
//!   [`crate::density_gradient`]. (Printed with a difference of the gradients in Kayaki's eq. (19); only the sum cancels a
//!   linear field.)

use crate::columns::four;
use crate::effects::FluidEffect;
use crate::fluid::Fluid;
use crate::rates::{FluidPair, PairEffect, PairRates};
use halfstep_scene::{Decision, DensityDiffusion as Variant, Derived, EffectName, Scene};
use halfstep_sph::lane::{Arch, Lane};
use halfstep_sph::pair::dot;

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

/// The effect in the list.
#[derive(Clone, Copy, Debug)]
pub struct DensityDiffusion;

impl<const D: usize> FluidEffect<D> for DensityDiffusion {
    type Pair<'a> = Diffusion<'a, D>;
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
    fn bytes(scene: &Scene) -> usize {
        let renormalised = scene.fluid.as_ref().is_some_and(|f| f.density_diffusion == Variant::DeltaSph);
        if renormalised { size_of::<[f64; D]>() } else { 0 }
    }
    fn pair(fluid: &Fluid<D>) -> Diffusion<'_, D> {
        let strength = fluid.strength;
        match fluid.diffusion {
            Variant::DeltaSph => {
                Diffusion::DeltaSph(DeltaSph { strength, gradient: fluid.gradient.as_flattened() })
            }
            Variant::Hydrostatic => {
                let scale = fluid.state.density / fluid.state.sound_speed.powi(2);
                Diffusion::Hydrostatic(Hydrostatic { strength, gradient: fluid.gravity.map(|g| scale * g) })
            }
            Variant::Simple | Variant::None => Diffusion::Simple(Simple(strength)),
        }
    }
}

impl<const D: usize> PairEffect<D> for Diffusion<'_, D> {
    type Own = [Lane; D];
    #[inline(always)]
    fn own(&self, slot: usize) -> [Lane; D] {
        match self {
            Self::DeltaSph(d) => d.own(slot),
            Self::Simple(_) | Self::Hydrostatic(_) => [Lane::ZERO; D],
        }
    }
    #[inline(always)]
    fn add<A: Arch>(&self, own: &[Lane; D], j: usize, pair: &FluidPair<D>, rates: &mut PairRates<D>) {
        match self {
            Self::Simple(d) => d.add::<A>(&(), j, pair, rates),
            Self::Hydrostatic(d) => d.add::<A>(&(), j, pair, rates),
            Self::DeltaSph(d) => d.add::<A>(own, j, pair, rates),
        }
    }
}

#[inline(always)]
fn diffuse<const D: usize, A: Arch>(strength: Strength, psi: Lane, rates: &mut PairRates<D>) {
    rates.density = A::mul_add(Lane::splat(strength.0), psi, rates.density);
}

#[inline(always)]
fn twice_difference<const D: usize>(pair: &FluidPair<D>) -> Lane {
    Lane::splat(2.0) * (pair.density_i - pair.density_j)
}

impl<const D: usize> PairEffect<D> for Simple {
    type Own = ();
    #[inline(always)]
    fn own(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch>(&self, _: &(), _: usize, pair: &FluidPair<D>, rates: &mut PairRates<D>) {
        diffuse::<D, A>(self.0, twice_difference(pair), rates);
    }
}

impl<const D: usize> PairEffect<D> for Hydrostatic<D> {
    type Own = ();
    #[inline(always)]
    fn own(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch>(&self, _: &(), _: usize, pair: &FluidPair<D>, rates: &mut PairRates<D>) {
        let rest = dot::<D, A>(self.gradient.map(|g| Lane::splat(2.0 * g)), pair.dx);
        diffuse::<D, A>(self.strength, twice_difference(pair) - rest, rates);
    }
}

impl<const D: usize> PairEffect<D> for DeltaSph<'_, D> {
    type Own = [Lane; D];
    #[inline(always)]
    fn own(&self, slot: usize) -> [Lane; D] {
        std::array::from_fn(|d| four(self.gradient, slot, |g| g[d]))
    }
    #[inline(always)]
    fn add<A: Arch>(&self, own: &[Lane; D], j: usize, pair: &FluidPair<D>, rates: &mut PairRates<D>) {
        let gradient = &self.gradient[j];
        let sum: [Lane; D] = std::array::from_fn(|d| own[d] + Lane::splat(gradient[d]));
        diffuse::<D, A>(self.strength, twice_difference(pair) - dot::<D, A>(sum, pair.dx), rates);
    }
}
