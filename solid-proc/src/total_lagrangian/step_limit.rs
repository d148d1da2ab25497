//! The largest stable sub-step of the present state.
//!
//! Plane waves of a strained solid have, in its reference configuration, the acoustic tensor Q_ac = N_b N_d d P_ab / d
//! F_cd with the direction N (Holzapfel 2000, section 6.6): its largest eigenvalue M takes the place of rho0 c_P².
//! Squeezed to half its height a solid is several times stiffer than at rest. Contact springs add to the square of the
//! highest frequency, and artificial viscosity, which takes velocities of half a sub-step before, makes the step
//! shorter (Belytschko, Liu, Moran and Elkhodary 2014, section 6.6.6):
//!   omega² = (2 / (0.94 dx))² (M + alpha G) / rho0 + 2 sum k / m,
//!   dt = 2 / omega (sqrt(1 + zeta²) - zeta),   zeta = eta / omega,
//! k over what touches a particle (a wall, which does not give way: half of it), 2 eta = A c_s h sum_j V0 |W'| / R the
//! damping of opposite neighbours, and what walls add to it. 0.94 is measured on the solid at rest. The quadratic part
//! B of the viscosity is left out.

use super::material::{Law, Matrix, green};
use super::model::TotalLagrangian;
use super::stress::TASK;
use halfstep_scene::Material;
use halfstep_sph::lane::{Arch, LANES, Lane, Lanes};
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::pair::{self, FixedLaw, dot, pair_sum};
use rayon::prelude::*;

/// Largest stable sub-step at rest over dx over the speed of the fastest wave: measured with h = 0.75 dx for nu from 0
/// to 0.49 and alpha from 0 to 10.
const STABLE: f64 = 0.94;
/// Part of the stable sub-step that a state may take: the largest `solid_cfl` of a scene over what is stable.
const PART: f64 = 0.9 / STABLE;

/// sum_j V0 |W'| / R of several particles, 1/m².
#[derive(Clone, Copy)]
struct Slopes<L = Lane>(L);
pair_sum!(Slopes {} { 0 });

struct SlopeSum {
    /// V0.
    volume: f64,
    /// 0.01 h², m²: what keeps the viscosity of a particle with itself at zero.
    least: f64,
}

impl<const D: usize> FixedLaw<D> for SlopeSum {
    type Target<L: Lanes> = ();
    type Sum<L: Lanes> = Slopes<L>;
    #[inline(always)]
    fn target<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, dx: [L; D], slope: L, sum: &mut Slopes<L>) {
        let r2 = dot::<D, A, L>(dx, dx);
        sum.0 += L::splat(-self.volume) * slope * (r2 / (r2 + L::splat(self.least)));
    }
}

impl<const D: usize> TotalLagrangian<D> {
    /// Largest sum_j V0 |W'| / R of any particle, 1/m².
    pub(super) fn largest_slope_sum(&self) -> f64 {
        let law = SlopeSum { volume: self.volume, least: 0.01 * self.smoothing_length.powi(2) };
        let mut sums = vec![Slopes::default(); self.id.len() / LANES];
        pair::fixed_pass(self.isa, &law, &self.pairs, &mut sums);
        let real = (0..self.id.len()).filter(|&slot| self.id[slot] != PADDING);
        real.map(|slot| sums[slot / LANES].0.0[slot % LANES]).fold(0.0, f64::max)
    }

    /// The largest sub-step of the state that was evaluated last, s.
    pub(super) fn stable_sub_step(&self) -> f64 {
        let density = self.material.density;
        let shares: f64 = self.arms.iter().map(|arm| arm.share).sum();
        let stiffness = |&slot: &u32| {
            let slot = slot as usize;
            let f = &self.gradient[slot];
            let squares = squared_stretches(f);
            let arms = match self.memory.stress(slot) {
                Some(h) => h.norm() + 4.0 / 3.0 * shares * self.material.shear_modulus() * squares[1],
                None => 0.0,
            };
            self.law.stiffness(f, self.volume_ratio[slot], squares) + arms
        };
        // The largest of all whatever the order.
        let slots = self.slot_of.par_iter().with_min_len(TASK);
        let stiffest = slots.map(stiffness).reduce(|| 0.0, f64::max);
        let (springs, walls) =
            self.contact.as_ref().map_or((0.0, 0.0), |contact| contact.stiffness(&self.material));
        let waves = (stiffest + self.hourglass_modulus) / density;
        let omega = ((2.0 / (STABLE * self.spacing)).powi(2) * waves + springs).sqrt();
        let viscosity = self.material.artificial_viscosity.linear * self.material.sound_speed();
        // Twice their velocity is how fast opposite neighbours approach, which half of them do.
        let damping = 0.5 * (viscosity * self.smoothing_length * self.slope_sum + walls);
        PART * sub_step(omega, damping)
    }
}

/// Largest stable step of an oscillation of angular frequency omega, 1/s, that loses its velocity at twice this rate,
/// 1/s, if the damping takes the velocity of half a step before.
pub(crate) fn sub_step(omega: f64, damping: f64) -> f64 {
    let zeta = damping / omega;
    2.0 / omega * ((1.0 + zeta * zeta).sqrt() - zeta)
}

/// Squares of the smallest and the largest principal stretch.
pub(crate) fn squared_stretches<const D: usize>(f: &Matrix<D>) -> [f64; 2] {
    let c = f.transpose() * f;
    if D == 2 {
        let half = 0.5 * (c[(0, 0)] + c[(1, 1)]);
        let apart = (0.25 * (c[(0, 0)] - c[(1, 1)]).powi(2) + c[(0, 1)] * c[(1, 0)]).sqrt();
        let largest = half + apart;
        return [(c[(0, 0)] * c[(1, 1)] - c[(0, 1)] * c[(1, 0)]) / largest, largest];
    }
    let c = nalgebra::Matrix3::from_fn(|a, b| c[(a, b)]);
    let values = c.symmetric_eigenvalues();
    [values.min(), values.max()]
}

impl Law {
    /// Largest eigenvalue of the acoustic tensor in any direction, Pa; `squares` are those of the smallest and the
    /// largest principal stretch. In plane stress that of plane strain, which is larger.
    pub(crate) fn stiffness<const D: usize>(&self, f: &Matrix<D>, j: f64, [least, most]: [f64; 2]) -> f64 {
        let (lambda, mu) = self.constants();
        match self.material() {
            // Q = mu I + (mu + lambda (1 - ln J)) m m, m = F^-T N, which is longest across the most squeezed direction.
            Material::NeoHookean => mu + (mu + lambda * (1.0 - libm::log(j))).max(0.0) / least,
            // Q = (N . S N) I + (lambda + mu) n n + mu F F^T, n = F N, all largest along the most stretched direction.
            Material::StVenantKirchhoff => {
                let stress = lambda * green(f).trace() + mu * (most - 1.0);
                stress + (lambda + 2.0 * mu) * most
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix2;

    #[test]
    fn principal_stretches_by_hand() {
        // A turned diag(3, 1/2).
        let (s, c) = 0.7_f64.sin_cos();
        let (turn, back) = (Matrix2::new(c, -s, s, c), Matrix2::new(1.0, 0.3, 0.0, 1.0));
        let [least, most] = squared_stretches(&(turn * Matrix2::new(3.0, 0.0, 0.0, 0.5)));
        assert!((least - 0.25).abs() < 1e-15 && (most - 9.0).abs() < 1e-14);
        let [least, most] = squared_stretches(&back);
        assert!((least * most - 1.0).abs() < 1e-15, "simple shear keeps the area");
    }

    /// The largest eigenvalue over all directions, from differences of the stress.
    #[test]
    fn the_stiffness_is_that_of_the_stiffest_wave() {
        for material in [Material::NeoHookean, Material::StVenantKirchhoff] {
            let law = Law::of_constants(material, 2.0, 1.0);
            for f in [
                Matrix2::new(0.5, 0.1, 0.0, 1.2),
                Matrix2::new(1.0, 0.0, 0.0, 1.0),
                Matrix2::new(1.4, 0.3, -0.2, 0.8),
            ] {
                let stress = |f: Matrix2<f64>| law.first_piola_kirchhoff(&f, f.determinant());
                let of = |angle: f64| {
                    let n = nalgebra::Vector2::new(angle.cos(), angle.sin());
                    let step = 1e-6;
                    let column = |a: usize| {
                        let mut by = Matrix2::zeros();
                        by.set_row(a, &(n.transpose() * step));
                        (stress(f + by) - stress(f - by)) * n / (2.0 * step)
                    };
                    let q = Matrix2::from_columns(&[column(0), column(1)]);
                    (0.5 * (q + q.transpose())).symmetric_eigenvalues().max()
                };
                let stiffest = (0..3600).map(|k| of(f64::from(k) * 1e-3)).fold(0.0, f64::max);
                let found = law.stiffness(&f, f.determinant(), squared_stretches(&f));
                assert!((found / stiffest - 1.0).abs() < 1e-5, "{material:?} {f}: {found} {stiffest}");
            }
        }
    }

    #[test]
    fn damping_shortens_the_step() {
        assert_eq!(sub_step(4.0, 0.0), 0.5);
        // zeta = 3/4: sqrt(1 + 9/16) - 3/4 = 1/2.
        assert!((sub_step(4.0, 3.0) - 0.25).abs() < 1e-15);
    }
}
