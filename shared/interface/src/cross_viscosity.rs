//! The cross-phase artificial viscosity f_i, Kayaki's eq. (32): what keeps fluid and solid particles from passing
//! through each other.
//!
//!   f_i = -sum_j m_j Pi_ij grad W,  Pi_ij = -C c_ij theta_ij / rho_ij where v_ij . x_ij < 0, else 0,
//!   theta_ij = h v_ij . x_ij / (r² + 0.01 h²),  rho_ij = (rho_i + rho_j) / 2,
//! over the neighbours j of the other phase; an acceleration, with m_i f_ij = -m_j f_ji. The sound speed c_ij is
//! (c_f + c_s) / 2 with phase-blind coupling; with the moving wall, where the solid shows the fluid the mass and
//! density of the fluid that it displaces, c_ij = c_f.

use crate::{Interface, InterfaceParticles};
use halfstep_scene::{Interface as Coefficients, Treatment};
use halfstep_sph::artificial_viscosity::damping;
use halfstep_sph::fade::Fade;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, LANES, Lane, Lanes};
use halfstep_sph::neighbours::ClusterList;
use halfstep_sph::pair::{self, PairLaw, distance, dot, pair_sum};
use halfstep_sph::with_kernel;

struct Law<'a, K, const D: usize> {
    kernel: K,
    targets: &'a InterfaceParticles<D>,
    sources: &'a InterfaceParticles<D>,
    /// C c_ij between particles far from each other, m/s.
    far: f64,
    /// What being near adds, m/s.
    added: f64,
    near: Fade,
}

#[derive(Clone, Copy)]
struct Target<L, const D: usize> {
    velocity: [L; D],
    density: L,
}

/// Sum of m_j Pi_ij grad W.
#[derive(Clone, Copy)]
struct Sum<const D: usize, L = Lane>([L; D]);
pair_sum!(Sum { D } { 0 });

impl<K: Kernel<D>, const D: usize> PairLaw<D> for Law<'_, K, D> {
    type Target<L: Lanes> = Target<L, D>;
    type Sum<L: Lanes> = Sum<D, L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        &self.targets.position
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> Target<L, D> {
        Target {
            velocity: std::array::from_fn(|d| L::load(&self.targets.velocity[d], slot)),
            density: L::load(&self.targets.density, slot),
        }
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        std::array::from_fn(|d| self.sources.position[d][j])
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, i: &Target<L, D>, j: usize, dx: [L; D], r2: L, sum: &mut Sum<D, L>) {
        let h = self.kernel.smoothing_length();
        let r = distance(r2, h);
        let f = self.kernel.gradient_over_r::<A, L>(r);
        let dv = std::array::from_fn(|d| i.velocity[d] - L::splat(self.sources.velocity[d][j]));
        let density_sum = i.density + L::splat(self.sources.density[j]);
        // A function of r alone: the same for both sides of a pair.
        let strength = A::mul_add(L::splat(self.added), self.near.at(r), L::splat(self.far));
        let pi = damping::<A, L>(h, strength, L::ZERO, dot::<D, A, L>(dv, dx), r2, density_sum);
        let coefficient = L::splat(-self.sources.mass[j]) * pi * f;
        for d in 0..D {
            sum.0[d] = A::mul_add(coefficient, dx[d], sum.0[d]);
        }
    }
}

/// Evaluates f_i for both phases.
pub struct CrossViscosity<const D: usize> {
    sums: Vec<Sum<D>>,
}

impl<const D: usize> Default for CrossViscosity<D> {
    fn default() -> Self {
        Self { sums: Vec::new() }
    }
}

impl<const D: usize> CrossViscosity<D> {
    /// f_i of the fluid's records: `visit(record, acceleration)`.
    pub fn on_fluid(&mut self, interface: &Interface<D>, visit: impl FnMut(usize, [f64; D])) {
        let (targets, sources) = (&interface.fluid, &interface.solid);
        self.evaluate(interface, targets, sources, &interface.fluid_list, visit);
    }

    /// f_i of the solid's records: `visit(record, acceleration)`, an acceleration of the solid's own mass.
    pub fn on_solid(&mut self, interface: &Interface<D>, mut visit: impl FnMut(usize, [f64; D])) {
        let (targets, sources) = (&interface.solid, &interface.fluid);
        let solid = &interface.solid;
        // The law sums over real fluid masses; a solid particle takes part with the mass that it shows.
        let mut slots = solid.slots();
        self.evaluate(interface, targets, sources, &interface.solid_list, |record, a| {
            let slot = slots.next().map_or(0, |(slot, _)| slot);
            let share = solid.mass[slot] / solid.own_mass[slot];
            visit(record, a.map(|a| a * share));
        });
    }

    fn evaluate(
        &mut self,
        interface: &Interface<D>,
        targets: &InterfaceParticles<D>,
        sources: &InterfaceParticles<D>,
        list: &ClusterList,
        mut visit: impl FnMut(usize, [f64; D]),
    ) {
        let p = &interface.parameters;
        if p.cross_viscosity == 0.0 {
            return;
        }
        let sound_speed = match p.treatment {
            Treatment::MovingWall => p.fluid.sound_speed,
            Treatment::PhaseBlind => 0.5 * (p.fluid.sound_speed + p.solid_sound_speed),
        };
        let far = p.cross_viscosity_far * sound_speed;
        let added = (p.cross_viscosity - p.cross_viscosity_far) * sound_speed;
        let gone = p.cross_viscosity_reach;
        let near = Fade::new((gone - Coefficients::FADE) * p.resolution, gone * p.resolution);
        self.sums.resize(list.fours(), Sum::default());
        with_kernel!(p.kernel, p.smoothing_length, D, |kernel| {
            let law = Law { kernel, targets, sources, far, added, near };
            pair::pass(p.isa, &law, list, &mut self.sums);
        });
        for (slot, record) in targets.slots() {
            visit(record, std::array::from_fn(|d| self.sums[slot / LANES].0[d].0[slot % LANES]));
        }
    }
}
