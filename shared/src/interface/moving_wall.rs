//! The solid as the fluid's moving wall (after Adami, Hu and Adams 2012, eqs. 23, 27 and 28).
//!
//! A solid particle s shows the fluid the pressure extrapolated from the fluid around it,
//!   p_s = sum_f [ p_f + rho_f g . (x_s - x_f) ] W_sf / sum_f W_sf,
//! the density of the fluid's equation of state at that pressure, the mass of the fluid that it displaces,
//! m_s = rho_f0 V_s0, and its own velocity. With grad W = F x_ij,
//!   D rho_f / Dt += rho_f sum_s m_s / rho_s v_fs . grad W,   m_f a_f += -sum_s m_f m_s (p_f/rho_f² + p_s/rho_s²) grad W,
//! and the solid receives the opposite of each pair force. Its density and strain do not see the fluid.

use super::{FluidSum, Interface, Side, SolidForce};
use crate::extrapolation::{Extrapolation, ExtrapolationSum};
use crate::kernel::Kernel;
use crate::lane::{Arch, LANES, Lane};
use crate::neighbours::ClusterList;
use crate::pair::{self, PairLaw, distance, dot};
use crate::with_kernel;

pub(super) fn show_pressure<const D: usize>(interface: &mut Interface<D>) {
    let mut sums = std::mem::take(&mut interface.wall_sums);
    sums.resize(interface.solid_list.clusters(), ExtrapolationSum::default());
    let p = &interface.parameters;
    with_kernel!(p.kernel, p.smoothing_length, D, |kernel| {
        let law = Extrapolation {
            kernel,
            gravity: p.gravity,
            targets: &interface.solid.position,
            sources: &interface.fluid.position,
            density: &interface.fluid.density,
            pressure: &interface.fluid.pressure,
        };
        pair::pass(p.isa, &law, &interface.solid_list, &mut sums);
    });
    let displaced = p.fluid.density / p.solid_density;
    let side = &mut interface.solid;
    for slot in 0..side.density.len() {
        let mut pressure = sums[slot / LANES].pressure(slot % LANES).unwrap_or(0.0);
        if p.non_negative_pressure {
            pressure = pressure.max(0.0);
        }
        side.pressure[slot] = pressure;
        side.density[slot] = p.fluid.density_at(pressure);
        side.mass[slot] = side.own_mass[slot] * displaced;
    }
    interface.wall_sums = sums;
}

#[derive(Clone, Copy)]
struct Target<const D: usize> {
    velocity: [Lane; D],
    density: Lane,
    /// p / rho².
    pressure_term: Lane,
    mass: Lane,
}

fn load<const D: usize>(side: &Side<D>, slot: usize) -> Target<D> {
    let density = Lane::load(&side.density, slot);
    Target {
        velocity: std::array::from_fn(|d| Lane::load(&side.velocity[d], slot)),
        density,
        pressure_term: Lane::load(&side.pressure, slot) / (density * density),
        mass: Lane::load(&side.mass, slot),
    }
}

/// m_j (p_i/rho_i² + p_j/rho_j²) F.
struct Pressure<'a, K, const D: usize> {
    kernel: K,
    targets: &'a Side<D>,
    sources: &'a Side<D>,
}

impl<K: Kernel<D>, const D: usize> Pressure<'_, K, D> {
    #[inline(always)]
    fn coefficient(&self, i: &Target<D>, j: usize, f: Lane) -> Lane {
        let rho = self.sources.density[j];
        let term = self.sources.pressure[j] / (rho * rho);
        Lane::splat(self.sources.mass[j]) * (i.pressure_term + Lane::splat(term)) * f
    }
}

struct OnFluid<'a, K, const D: usize>(Pressure<'a, K, D>);

impl<K: Kernel<D>, const D: usize> PairLaw<D> for OnFluid<'_, K, D> {
    type Target = Target<D>;
    type Sum = FluidSum<D>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.0.targets.position
    }
    #[inline(always)]
    fn target(&self, slot: usize) -> Target<D> {
        load(self.0.targets, slot)
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.0.sources.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch>(&self, i: &Target<D>, j: usize, dx: [Lane; D], r2: Lane, sum: &mut FluidSum<D>) {
        let kernel = &self.0.kernel;
        let f = kernel.gradient_over_r::<A>(distance(r2, kernel.smoothing_length()));
        let coefficient = self.0.coefficient(i, j, f);
        let s = self.0.sources;
        let dv = std::array::from_fn(|d| i.velocity[d] - Lane::splat(s.velocity[d][j]));
        let volume = Lane::splat(s.mass[j] / s.density[j]);
        for d in 0..D {
            sum.acceleration[d] = A::mul_add(-coefficient, dx[d], sum.acceleration[d]);
        }
        sum.density_rate = A::mul_add(i.density * volume * f, dot::<D, A>(dv, dx), sum.density_rate);
    }
}

struct OnSolid<'a, K, const D: usize>(Pressure<'a, K, D>);

impl<K: Kernel<D>, const D: usize> PairLaw<D> for OnSolid<'_, K, D> {
    type Target = Target<D>;
    type Sum = SolidForce<D>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.0.targets.position
    }
    #[inline(always)]
    fn target(&self, slot: usize) -> Target<D> {
        load(self.0.targets, slot)
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.0.sources.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch>(&self, i: &Target<D>, j: usize, dx: [Lane; D], r2: Lane, sum: &mut SolidForce<D>) {
        let kernel = &self.0.kernel;
        let f = kernel.gradient_over_r::<A>(distance(r2, kernel.smoothing_length()));
        let coefficient = i.mass * self.0.coefficient(i, j, f);
        for d in 0..D {
            sum.0[d] = A::mul_add(-coefficient, dx[d], sum.0[d]);
        }
    }
}

fn run<const D: usize, L: PairLaw<D>>(
    interface: &Interface<D>,
    law: L,
    list: &ClusterList,
    sums: &mut [L::Sum],
) {
    pair::pass(interface.parameters.isa, &law, list, sums);
}

pub(super) fn act_on_fluid<const D: usize>(interface: &Interface<D>, sums: &mut [FluidSum<D>]) {
    let p = &interface.parameters;
    with_kernel!(p.kernel, p.smoothing_length, D, |kernel| {
        let law = OnFluid(Pressure { kernel, targets: &interface.fluid, sources: &interface.solid });
        run(interface, law, &interface.fluid_list, sums);
    });
}

pub(super) fn act_on_solid<const D: usize>(interface: &Interface<D>, sums: &mut [SolidForce<D>]) {
    let p = &interface.parameters;
    with_kernel!(p.kernel, p.smoothing_length, D, |kernel| {
        let law = OnSolid(Pressure { kernel, targets: &interface.solid, sources: &interface.fluid });
        run(interface, law, &interface.solid_list, sums);
    });
}
