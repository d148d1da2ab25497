//! Kayaki's interface (section 5): the sums of continuity, eq. (17), and stress, eq. (22), do not ask for a
//! neighbour's phase.
//!
//!   D rho_i / Dt += rho_i sum_j m_j / rho_j v_ij . grad W
//!   dv_a / dx_b (i) += -sum_j m_j / rho_j v_ij,a F x_ij,b                 (toward the solid)
//!   m_i a_i += sum_j m_i m_j (sigma_i / rho_i² + sigma_j / rho_j²) grad W
//! over the neighbours j of the other phase. The fluid shows -p I only. The artificial viscosity between the phases is
//! left out here: f_i replaces it.

use super::{FluidSum, Interface, InterfaceParticles};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Lane, Lanes};
use halfstep_sph::pair::{self, PairLaw, distance, dot, pair_sum};
use halfstep_sph::with_kernel;

/// A vector for each of several particles.
#[derive(Clone, Copy, Debug)]
pub struct Vector<const D: usize, L = Lane>(pub [L; D]);
pair_sum!(Vector { D } { 0 });

/// What the fluid adds to the rates of several solid particles.
#[derive(Clone, Copy, Debug)]
pub struct SolidRates<const D: usize, L = Lane> {
    /// Rate of density, kg/(m³ s).
    pub density_rate: L,
    /// dv_a / dx_b, 1/s.
    pub gradient: [[L; D]; D],
}

pair_sum!(SolidRates { D } { density_rate, gradient });

/// Nothing to prepare: each particle shows its own density and stress.
pub(super) fn show_stress<const D: usize>(_: &mut Interface<D>) {}

#[derive(Clone, Copy)]
struct Target<L, const D: usize> {
    velocity: [L; D],
    density: L,
    mass: L,
    stress_term: [[L; D]; D],
}

struct Blind<'a, K, const D: usize> {
    kernel: K,
    targets: &'a InterfaceParticles<D>,
    sources: &'a InterfaceParticles<D>,
}

impl<K: Kernel<D>, const D: usize> Blind<'_, K, D> {
    #[inline(always)]
    fn load<L: Lanes>(&self, slot: usize) -> Target<L, D> {
        let t = self.targets;
        Target {
            velocity: std::array::from_fn(|d| L::load(&t.velocity[d], slot)),
            density: L::load(&t.density, slot),
            mass: L::load(&t.mass, slot),
            stress_term: std::array::from_fn(|a| {
                std::array::from_fn(|b| L::load(&t.stress_term[a.min(b)][a.max(b)], slot))
            }),
        }
    }

    #[inline(always)]
    fn slope<A: Arch, L: Lanes>(&self, r2: L) -> L {
        self.kernel.gradient_over_r::<A, L>(distance(r2, self.kernel.smoothing_length()))
    }

    /// Acceleration of i by j.
    #[inline(always)]
    fn acceleration<A: Arch, L: Lanes>(&self, i: &Target<L, D>, j: usize, dx: [L; D], f: L) -> [L; D] {
        let mf = L::splat(self.sources.mass[j]) * f;
        std::array::from_fn(|a| {
            let mut sum = L::ZERO;
            for b in 0..D {
                let sj = L::splat(self.sources.stress_term[a.min(b)][a.max(b)][j]);
                sum = A::mul_add(i.stress_term[a][b] + sj, dx[b], sum);
            }
            mf * sum
        })
    }

    #[inline(always)]
    fn velocity_difference<L: Lanes>(&self, i: &Target<L, D>, j: usize) -> [L; D] {
        std::array::from_fn(|d| i.velocity[d] - L::splat(self.sources.velocity[d][j]))
    }

    #[inline(always)]
    fn volume<L: Lanes>(&self, j: usize) -> L {
        L::splat(self.sources.mass[j] / self.sources.density[j])
    }
}

macro_rules! pair_law {
    ($law:ident, $sum:ident, |$s:ident, $arch:ident, $i:ident, $j:ident, $dx:ident, $r2:ident, $out:ident| $body:block) => {
        struct $law<'a, K, const D: usize>(Blind<'a, K, D>);
        impl<K: Kernel<D>, const D: usize> PairLaw<D> for $law<'_, K, D> {
            type Target<L: Lanes> = Target<L, D>;
            type Sum<L: Lanes> = $sum<D, L>;
            #[inline(always)]
            fn target_positions(&self) -> &[Vec<f64>; D] {
                &self.0.targets.position
            }
            #[inline(always)]
            fn target<L: Lanes>(&self, slot: usize) -> Target<L, D> {
                self.0.load(slot)
            }
            #[inline(always)]
            fn source_position(&self, j: usize) -> [f64; D] {
                std::array::from_fn(|d| self.0.sources.position[d][j])
            }
            #[inline(always)]
            fn add<$arch: Arch, L: Lanes>(
                &self,
                $i: &Target<L, D>,
                $j: usize,
                $dx: [L; D],
                $r2: L,
                $out: &mut $sum<D, L>,
            ) {
                let $s = &self.0;
                $body
            }
        }
    };
}

pair_law!(OnFluid, FluidSum, |s, A, i, j, dx, r2, sum| {
    let f = s.slope::<A, _>(r2);
    let a = s.acceleration::<A, _>(i, j, dx, f);
    for d in 0..D {
        sum.acceleration[d] += a[d];
    }
    let vx = dot::<D, A, _>(s.velocity_difference(i, j), dx);
    sum.density_rate = A::mul_add(i.density * s.volume(j) * f, vx, sum.density_rate);
});

pair_law!(OnSolid, Vector, |s, A, i, j, dx, r2, sum| {
    let f = s.slope::<A, _>(r2);
    let a = s.acceleration::<A, _>(i, j, dx, f);
    for d in 0..D {
        sum.0[d] = A::mul_add(i.mass, a[d], sum.0[d]);
    }
});

pair_law!(RatesOfSolid, SolidRates, |s, A, i, j, dx, r2, sum| {
    let f = s.slope::<A, _>(r2);
    let vf = f * s.volume(j);
    let dv = s.velocity_difference(i, j);
    sum.density_rate = A::mul_add(i.density * vf, dot::<D, A, _>(dv, dx), sum.density_rate);
    for a in 0..D {
        for b in 0..D {
            sum.gradient[a][b] = A::mul_add(-(vf * dv[a]), dx[b], sum.gradient[a][b]);
        }
    }
});

pub(super) fn act_on_fluid<const D: usize>(interface: &Interface<D>, sums: &mut [FluidSum<D>]) {
    let p = &interface.parameters;
    with_kernel!(p.kernel, p.smoothing_length, D, |kernel| {
        let law = OnFluid(Blind { kernel, targets: &interface.fluid, sources: &interface.solid });
        pair::pass(p.isa, &law, &interface.fluid_list, sums);
    });
}

pub(super) fn act_on_solid<const D: usize>(interface: &Interface<D>, sums: &mut [Vector<D>]) {
    let p = &interface.parameters;
    with_kernel!(p.kernel, p.smoothing_length, D, |kernel| {
        let law = OnSolid(Blind { kernel, targets: &interface.solid, sources: &interface.fluid });
        pair::pass(p.isa, &law, &interface.solid_list, sums);
    });
}

pub(super) fn rates_of_solid<const D: usize>(interface: &Interface<D>, sums: &mut [SolidRates<D>]) {
    let p = &interface.parameters;
    with_kernel!(p.kernel, p.smoothing_length, D, |kernel| {
        let law = RatesOfSolid(Blind { kernel, targets: &interface.solid, sources: &interface.fluid });
        pair::pass(p.isa, &law, &interface.solid_list, sums);
    });
}
