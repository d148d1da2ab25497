//! Physical viscosity, Kayaki's eqs. (4) and (22): the viscous stress
//!   tau_ab = mu (dv_a/dx_b + dv_b/dx_a - 2/3 delta_ab div v)
//! of each particle from a first pass, then (tau_i / rho_i² + tau_j / rho_j²) . grad W in the momentum equation. A wall
//! particle takes part in the gradient with the velocity it shows and repeats the stress of its fluid neighbour. What
//! solids add to the gradient comes from the interface ([`super::interface_viscosity`]).

use super::{FluidEffect, Listed, Neighbourhood, evaluations};
use crate::columns::{PairParticles, each, fit};
use crate::composition::Composition;
use crate::rates::{FluidPair, PairEffect, PairRates};
use crate::walls::Walls;
use halfstep_scene::{Decision, EffectName, Scene};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, LANES, Lane, Lanes, components};
use halfstep_sph::pair::{self, PairLaw, distance, pair_sum};
use halfstep_wire::half_step::Stage;

/// tau_ab / rho² of each slot.
#[derive(Clone, Debug, Default)]
pub struct StressTerm<const D: usize>(pub Vec<[[f64; D]; D]>);

/// dv_a / dx_b of several particles.
#[derive(Clone, Copy, Debug)]
pub struct VelocityGradient<const D: usize, L = Lane>(pub [[L; D]; D]);
pair_sum!(VelocityGradient { D } { 0 });

/// The law of the first pass.
pub struct GradientLaw<'a, K, const D: usize> {
    /// Kernel.
    pub kernel: K,
    /// Fluid.
    pub targets: &'a PairParticles<D>,
    /// Fluid or walls.
    pub sources: &'a PairParticles<D>,
}

impl<K: Kernel<D>, const D: usize> PairLaw<D> for GradientLaw<'_, K, D> {
    const SINGLE: bool = true;
    /// Velocity.
    type Target<L: Lanes> = [L; D];
    type Sum<L: Lanes> = VelocityGradient<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.targets.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
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
        i: &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut VelocityGradient<D, L>,
    ) {
        let f = self.kernel.gradient_over_r::<A, L>(distance(r2, self.kernel.smoothing_length()));
        let source = self.sources.beside::<L>(j);
        let vf = source.volume * f;
        for a in 0..D {
            let row = vf * (source.velocity[a] - i[a]);
            for b in 0..D {
                sum.0[a][b] = A::mul_add(row, dx[b], sum.0[a][b]);
            }
        }
    }
}

impl<const D: usize> VelocityGradient<D> {
    /// tau / rho² of the four particles.
    // Inlined, its scalar arithmetic would break up the vectors of the loop before it.
    #[inline(never)]
    pub fn stress(&self, viscosity: f64, density: Lane) -> [[[f64; D]; D]; LANES] {
        std::array::from_fn(|k| stress(viscosity, density.0[k], |a, b| self.0[a][b].0[k]))
    }
}

/// tau / rho² of a velocity gradient.
#[inline(always)]
fn stress<const D: usize>(
    viscosity: f64,
    density: f64,
    gradient: impl Fn(usize, usize) -> f64,
) -> [[f64; D]; D] {
    let divergence: f64 = (0..D).map(|a| gradient(a, a)).sum();
    let scale = viscosity / (density * density);
    let component = |a: usize, b: usize| {
        let isotropic = if a == b { 2.0 / 3.0 * divergence } else { 0.0 };
        scale * (gradient(a, b) + gradient(b, a) - isotropic)
    };
    components(|a| components(|b| component(a.min(b), a.max(b))))
}

impl<const D: usize> StressTerm<D> {
    #[inline(always)]
    fn load<L: Lanes>(&self, slot: usize) -> [[L; D]; D] {
        components(|a| components(|b| each(&self.0, slot, |stress| stress[a][b])))
    }
}

#[inline(always)]
fn add_stress<const D: usize, A: Arch, L: Lanes>(
    sum: impl Fn(usize, usize) -> L,
    dx: &[L; D],
    rates: &mut PairRates<D, L>,
) {
    for a in 0..D {
        for b in 0..D {
            rates.vector[a] = A::mul_add(sum(a, b), dx[b], rates.vector[a]);
        }
    }
}

/// The effect.
#[derive(Clone, Debug)]
pub struct Viscosity<const D: usize> {
    /// mu, Pa s.
    viscosity: f64,
    stress: StressTerm<D>,
}

impl<const D: usize> Listed<D> for Viscosity<D> {
    fn of(scene: &Scene) -> Option<Self> {
        let viscosity = scene.fluid.as_ref()?.viscosity;
        Some(Self { viscosity, stress: StressTerm::default() })
    }
}

impl<const D: usize> FluidEffect<D> for Viscosity<D> {
    const NAME: &'static str = EffectName::Viscosity.name();
    type Pair<'a> = ViscousStress<'a, D>;
    type AtWall<'a> = ViscosityAtWall<'a, D>;
    fn decide(scene: &Scene) -> Decision {
        halfstep_scene::viscosity(scene)
    }
    fn bytes_per_particle(_: &Scene) -> usize {
        size_of::<[[f64; D]; D]>()
    }
    fn resize(&mut self, slots: usize, _: Option<&Walls<D>>) {
        fit(&mut self.stress.0, slots, [[0.0; D]; D]);
    }
    fn prepare<K: Kernel<D>>(&mut self, stage: Stage, around: &Neighbourhood<'_, K, D>) -> u64 {
        if !around.needed(stage).momentum() {
            return 0;
        }
        let (kernel, fluid, viscosity) = (around.kernel, around.fluid, self.viscosity);
        let law = GradientLaw { kernel, targets: fluid, sources: fluid };
        let finish = |slot, sum: &VelocityGradient<D>| sum.stress(viscosity, fluid.densities(slot));
        let (out, _) = self.stress.0.as_chunks_mut();
        let pairs = if let Some((walls, list)) = around.walls {
            let at_walls = GradientLaw { kernel, targets: fluid, sources: &walls.shown };
            pair::pass_both_into(around.isa, (&law, around.list), (&at_walls, list), finish, out);
            evaluations(around.list) + evaluations(list)
        } else {
            pair::pass_into(around.isa, &law, around.list, finish, out);
            evaluations(around.list)
        };
        // Stress is linear in the gradient.
        for (slot, gradient) in around.beside_solids {
            let density = fluid.sources[*slot as usize].density;
            let more = stress::<D>(viscosity, density, |a, b| gradient[a][b]);
            let sum = self.stress.0[*slot as usize].as_flattened_mut();
            sum.iter_mut().zip(more.as_flattened()).for_each(|(sum, more)| *sum += more);
        }
        pairs
    }
    fn pair(&self) -> Option<ViscousStress<'_, D>> {
        Some(ViscousStress(&self.stress))
    }
    fn at_wall(&self) -> Option<ViscosityAtWall<'_, D>> {
        Some(ViscosityAtWall(&self.stress))
    }
    fn bytes(&self) -> usize {
        self.stress.0.capacity() * size_of::<[[f64; D]; D]>()
    }
}

/// The effect between fluid particles.
#[derive(Clone, Copy, Debug)]
pub struct ViscousStress<'a, const D: usize>(pub &'a StressTerm<D>);

impl<const D: usize> PairEffect<D> for ViscousStress<'_, D> {
    type Own<L: Lanes> = [[L; D]; D];
    const CONTINUITY: bool = false;
    const VECTOR: bool = true;
    #[inline(always)]
    fn own<L: Lanes>(&self, slot: usize) -> Self::Own<L> {
        self.0.load(slot)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        own: &Self::Own<L>,
        j: usize,
        pair: &FluidPair<D, L>,
        rates: &mut PairRates<D, L>,
    ) {
        let other = &self.0.0[j];
        add_stress::<D, A, L>(|a, b| own[a][b] + L::splat(other[a.min(b)][a.max(b)]), &pair.dx, rates);
    }
    fn enter<C: Composition<D>>(self, composition: C) {
        composition.with(self);
    }
    fn labels(labels: &mut Vec<&'static str>) {
        labels.push("viscosity");
    }
}

/// The effect between fluid and wall.
#[derive(Clone, Copy, Debug)]
pub struct ViscosityAtWall<'a, const D: usize>(pub &'a StressTerm<D>);

impl<const D: usize> PairEffect<D> for ViscosityAtWall<'_, D> {
    type Own<L: Lanes> = [[L; D]; D];
    const CONTINUITY: bool = false;
    const VECTOR: bool = true;
    #[inline(always)]
    fn own<L: Lanes>(&self, slot: usize) -> Self::Own<L> {
        self.0.load(slot)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        own: &Self::Own<L>,
        _: usize,
        pair: &FluidPair<D, L>,
        rates: &mut PairRates<D, L>,
    ) {
        add_stress::<D, A, L>(|a, b| own[a][b] + own[a][b], &pair.dx, rates);
    }
    fn enter<C: Composition<D>>(self, composition: C) {
        composition.with(self);
    }
    fn labels(labels: &mut Vec<&'static str>) {
        labels.push("viscosity");
    }
}
