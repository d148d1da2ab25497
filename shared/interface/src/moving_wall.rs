//! The solid as the fluid's moving wall (after Adami, Hu and Adams 2012, eqs. 23, 27 and 28).
//!
//! A solid particle s shows the fluid the pressure extrapolated from the fluid around it,
//!   p_s = sum_f [ p_f + rho_f g . (x_s - x_f) ] W_sf / sum_f W_sf,
//! the density of the fluid's equation of state at that pressure, the mass of the fluid that it displaces,
//! m_s = rho_f0 V_s0, and its own velocity. With grad W = F x_ij,
//!   D rho_f / Dt += rho_f sum_s m_s / rho_s v_fs . grad W,
//!   m_f a_f += -sum_s m_f m_s (p_f/rho_f² + p_s/rho_s²) grad W,
//! and the solid receives the opposite of each pair force. Its density and strain do not see the fluid.

use super::{FluidSum, Interface, InterfaceParticles, Parameters, SolidForce};
use halfstep_sph::extrapolation::{Extrapolation, ExtrapolationSum};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, LANES, Lanes};
use halfstep_sph::pair::{self, PairLaw, distance, dot};
use halfstep_sph::with_kernel;

pub(super) fn show_pressure<const D: usize>(interface: &mut Interface<D>) {
    let mut sums = std::mem::take(&mut interface.wall_sums);
    sums.resize(interface.solid_list.fours(), ExtrapolationSum::default());
    let p = &interface.parameters;
    with_kernel!(p.kernel, p.smoothing_length, D, |kernel| {
        let law = extrapolation(interface, kernel);
        pair::pass(p.isa, &law, &interface.solid_list, &mut sums);
    });
    let displaced = p.fluid.density / p.solid_density;
    let side = &mut interface.solid;
    for slot in 0..side.density.len() {
        let pressure = extrapolated(p, &sums[slot / LANES], slot % LANES);
        side.pressure[slot] = pressure;
        side.density[slot] = p.fluid.density_at(pressure);
        side.mass[slot] = side.own_mass[slot] * displaced;
    }
    interface.wall_sums = sums;
}

/// The fluid's pressure, extrapolated to the solid.
pub(super) fn extrapolation<K: Kernel<D>, const D: usize>(
    interface: &Interface<D>,
    kernel: K,
) -> Extrapolation<'_, K, D> {
    Extrapolation {
        kernel,
        gravity: interface.parameters.gravity,
        targets: &interface.solid.position,
        sources: &interface.fluid.position,
        density: &interface.fluid.density,
        pressure: &interface.fluid.pressure,
    }
}

/// The pressure that the k-th of four solid particles shows; 0 without fluid around, and not below 0 unless the scene
/// lets it.
pub(super) fn extrapolated<const D: usize>(p: &Parameters<D>, sum: &ExtrapolationSum, k: usize) -> f64 {
    let pressure = sum.pressure(k).unwrap_or(0.0);
    if p.non_negative_pressure { pressure.max(0.0) } else { pressure }
}

/// Pressure of a solid particle toward the fluid, which for a particle of a thin plate depends on where the fluid is.
pub(super) trait WallPressure<const D: usize>: Copy + Send + Sync {
    /// What is loaded of solid particles.
    type Own<L: Lanes>: Copy;
    /// Loads the solid particles from `slot` on.
    fn own<L: Lanes>(&self, slot: usize) -> Self::Own<L>;
    /// p / rho² of solid particles, toward fluid at `to_fluid` = x_f - x_s.
    fn of<A: Arch, L: Lanes>(&self, own: &Self::Own<L>, to_fluid: [L; D]) -> L;
    /// p / rho² and m / rho of the solid particle `j`, toward fluid particles.
    fn to<A: Arch, L: Lanes>(&self, j: usize, to_fluid: [L; D]) -> (L, L);
    /// p / rho² toward both sides.
    fn pressure_terms(&self, slot: usize) -> [f64; 2];
    /// v_f - v_s as continuity of fluid with this p / rho² sees it, from what it is.
    #[inline(always)]
    fn receding<A: Arch, L: Lanes>(&self, _: usize, _: [L; D], dv: [L; D], _: L) -> [L; D] {
        dv
    }
}

/// One pressure whatever the fluid's place is: the columns of the solid. All fluid stands on the second side.
#[derive(Clone, Copy)]
pub(super) struct OneFace<'a, const D: usize>(pub(super) &'a InterfaceParticles<D>);

impl<const D: usize> WallPressure<D> for OneFace<'_, D> {
    type Own<L: Lanes> = L;

    #[inline(always)]
    fn own<L: Lanes>(&self, slot: usize) -> L {
        let density = L::load(&self.0.density, slot);
        L::load(&self.0.pressure, slot) / (density * density)
    }
    #[inline(always)]
    fn of<A: Arch, L: Lanes>(&self, own: &L, _: [L; D]) -> L {
        *own
    }
    #[inline(always)]
    fn to<A: Arch, L: Lanes>(&self, j: usize, _: [L; D]) -> (L, L) {
        let (side, rho) = (self.0, self.0.density[j]);
        (L::splat(side.pressure[j] / (rho * rho)), L::splat(side.mass[j] / rho))
    }
    fn pressure_terms(&self, slot: usize) -> [f64; 2] {
        [0.0, self.0.pressure[slot] / self.0.density[slot].powi(2)]
    }
}

/// Several fluid particles.
#[derive(Clone, Copy)]
struct OfFluid<L, const D: usize> {
    velocity: [L; D],
    density: L,
    /// p / rho².
    pressure_term: L,
}

struct OnFluid<'a, K, S, const D: usize> {
    kernel: K,
    targets: &'a InterfaceParticles<D>,
    sources: &'a InterfaceParticles<D>,
    wall: S,
}

impl<K: Kernel<D>, S: WallPressure<D>, const D: usize> PairLaw<D> for OnFluid<'_, K, S, D> {
    type Target<L: Lanes> = OfFluid<L, D>;
    type Sum<L: Lanes> = FluidSum<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.targets.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> OfFluid<L, D> {
        let side = self.targets;
        let density = L::load(&side.density, slot);
        OfFluid {
            velocity: std::array::from_fn(|d| L::load(&side.velocity[d], slot)),
            density,
            pressure_term: L::load(&side.pressure, slot) / (density * density),
        }
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.sources.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        i: &OfFluid<L, D>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut FluidSum<D, L>,
    ) {
        let f = self.kernel.gradient_over_r::<A, L>(distance(r2, self.kernel.smoothing_length()));
        let (term, volume) = self.wall.to::<A, L>(j, dx);
        let s = self.sources;
        let coefficient = L::splat(s.mass[j]) * (i.pressure_term + term) * f;
        let dv = std::array::from_fn(|d| i.velocity[d] - L::splat(s.velocity[d][j]));
        let dv = self.wall.receding::<A, L>(j, dx, dv, i.pressure_term);
        for d in 0..D {
            sum.acceleration[d] = A::mul_add(-coefficient, dx[d], sum.acceleration[d]);
        }
        sum.density_rate = A::mul_add(i.density * volume * f, dot::<D, A, L>(dv, dx), sum.density_rate);
    }
}

struct OnSolid<'a, K, S, const D: usize> {
    kernel: K,
    targets: &'a InterfaceParticles<D>,
    sources: &'a InterfaceParticles<D>,
    wall: S,
}

impl<K: Kernel<D>, S: WallPressure<D>, const D: usize> PairLaw<D> for OnSolid<'_, K, S, D> {
    /// Mass, and what it shows.
    type Target<L: Lanes> = (L, S::Own<L>);
    type Sum<L: Lanes> = SolidForce<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.targets.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L> {
        (L::load(&self.targets.mass, slot), self.wall.own(slot))
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.sources.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(
        &self,
        i: &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut SolidForce<D, L>,
    ) {
        let f = self.kernel.gradient_over_r::<A, L>(distance(r2, self.kernel.smoothing_length()));
        let (mass, own) = i;
        let (s, rho) = (self.sources, self.sources.density[j]);
        let term = L::splat(s.pressure[j] / (rho * rho));
        let own_term = self.wall.of::<A, L>(own, dx.map(|x| -x));
        let coefficient = *mass * (L::splat(s.mass[j]) * (own_term + term) * f);
        for d in 0..D {
            sum.0[d] = A::mul_add(-coefficient, dx[d], sum.0[d]);
        }
    }
}

pub(super) fn push_fluid<const D: usize>(
    interface: &Interface<D>,
    wall: impl WallPressure<D>,
    sums: &mut [FluidSum<D>],
) {
    let p = &interface.parameters;
    with_kernel!(p.kernel, p.smoothing_length, D, |kernel| {
        let law = OnFluid { kernel, targets: &interface.fluid, sources: &interface.solid, wall };
        pair::pass(p.isa, &law, &interface.fluid_list, sums);
    });
}

pub(super) fn push_solid<const D: usize>(
    interface: &Interface<D>,
    wall: impl WallPressure<D>,
    sums: &mut [SolidForce<D>],
) {
    let p = &interface.parameters;
    with_kernel!(p.kernel, p.smoothing_length, D, |kernel| {
        let law = OnSolid { kernel, targets: &interface.solid, sources: &interface.fluid, wall };
        pair::pass(p.isa, &law, &interface.solid_list, sums);
    });
}
