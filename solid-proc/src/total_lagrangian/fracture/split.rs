//! The law of a damaged particle: psi = (1 - d) psi+ + psi-, the tensile and the compressive part of the law's energy.
//!
//! In principal stretches s_a, c_a = s_a², E_a = (c_a - 1) / 2, with (x)+ = max(x, 0) and (x)- = min(x, 0) (Miehe,
//! Hofacker and Welschinger 2010, for small strains):
//!   St. Venant-Kirchhoff:  psi± = lambda/2 (tr E)±² + mu sum (E_a)±²
//!   neo-Hooke:             psi± = lambda/2 (ln J)±² + mu/2 sum (c_a - 1 - ln c_a) of the s_a above (below) 1
//! Both parts add up to the law, and a crack that closes carries the whole pressure.

use super::principal::principal;
use crate::total_lagrangian::material::{Cauchy, Law, Matrix};
use halfstep_scene::{Material, Plane};

/// What a damaged particle has.
pub(in crate::total_lagrangian) struct Damaged<const D: usize> {
    /// P, Pa.
    pub(in crate::total_lagrangian) stress: Matrix<D>,
    /// psi, J/m³.
    pub(in crate::total_lagrangian) energy: f64,
    /// Cauchy stress across the plane, Pa.
    across: f64,
}

impl Law {
    /// Of a damage d > 0; `j` is [`Law::volume_ratio`].
    pub(in crate::total_lagrangian) fn damaged<const D: usize>(
        &self,
        f: &Matrix<D>,
        j: f64,
        d: f64,
    ) -> Damaged<D> {
        let (squares, directions) = principal(&(f.transpose() * f));
        let (_, mu) = self.constants();
        let lambda = self.lambda_in_plane();
        let left = |x: f64| if x > 0.0 { 1.0 - d } else { 1.0 };
        let strain = |square: f64| 0.5 * (square - 1.0);
        let (mut energy, common) = match self.material() {
            Material::StVenantKirchhoff => {
                let trace: f64 = squares.iter().map(|&square| strain(square)).sum();
                (0.5 * lambda * left(trace) * trace * trace, lambda * left(trace) * trace)
            }
            Material::NeoHookean => {
                let log = libm::log(j);
                (0.5 * lambda * left(log) * log * log, lambda * left(log) * log)
            }
        };
        let mut second = Matrix::zeros();
        for (a, &square) in squares.iter().enumerate() {
            let (e, direction) = (strain(square), directions.column(a));
            let stress = match self.material() {
                Material::StVenantKirchhoff => {
                    energy += mu * left(e) * e * e;
                    common + 2.0 * mu * left(e) * e
                }
                Material::NeoHookean => {
                    energy += 0.5 * mu * left(e) * (2.0 * e - libm::log(square));
                    (common + mu * left(e) * 2.0 * e) / square
                }
            };
            second += direction * direction.transpose() * stress;
        }
        let held = D == 2 && self.plane() == Plane::Strain;
        Damaged { stress: f * second, energy, across: if held { common / j } else { 0.0 } }
    }

    /// Cauchy stress of a damage d > 0.
    pub(in crate::total_lagrangian) fn damaged_cauchy<const D: usize>(
        &self,
        f: &Matrix<D>,
        j: f64,
        d: f64,
    ) -> Cauchy<D> {
        let damaged = self.damaged(f, j, d);
        let sigma = damaged.stress * f.transpose() / j;
        let pressure = -(sigma.trace() + damaged.across) / 3.0;
        Cauchy { pressure, deviator: sigma + Matrix::identity() * pressure }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Matrix3, Rotation2};

    const BOTH: [Material; 2] = [Material::StVenantKirchhoff, Material::NeoHookean];

    #[test]
    fn both_parts_add_up_to_the_law() {
        for material in BOTH {
            let law = Law::of_constants(material, 2.0, 1.0);
            for f in [
                Matrix3::new(1.1, 0.2, -0.1, 0.05, 0.9, 0.3, -0.2, 0.1, 1.2),
                Matrix3::new(0.8, 0.2, -0.1, 0.05, 0.9, 0.1, -0.2, 0.1, 0.9),
            ] {
                let j = f.determinant();
                let damaged = law.damaged(&f, j, 0.0);
                assert!((damaged.energy - law.energy(&f, j)).abs() < 1e-14, "{material:?}");
                assert!((damaged.stress - law.first_piola_kirchhoff(&f, j)).norm() < 1e-13, "{material:?}");
            }
            let f = Matrix2::new(1.1, 0.2, 0.0, 0.8);
            let (whole, split) = (law.cauchy(&f, 0.88), law.damaged_cauchy(&f, f.determinant(), 0.0));
            assert!((whole.pressure - split.pressure).abs() < 1e-14, "{material:?}");
        }
    }

    #[test]
    fn a_closed_crack_carries_pressure_and_an_open_one_nothing() {
        for material in BOTH {
            let law = Law::of_constants(material, 2.0, 1.0);
            let turn = *Rotation2::new(0.7).matrix();
            let closed = turn * Matrix2::new(0.9, 0.0, 0.0, 0.95);
            let j = closed.determinant();
            let stress = law.damaged(&closed, j, 1.0).stress;
            assert!((stress - law.first_piola_kirchhoff(&closed, j)).norm() < 1e-14, "{material:?}");
            let open = turn * Matrix2::new(1.1, 0.0, 0.0, 1.05);
            assert_eq!(law.damaged(&open, open.determinant(), 1.0).energy, 0.0);
        }
    }

    #[test]
    fn stress_is_the_slope_of_the_energy() {
        for material in BOTH {
            let law = Law::of_constants(material, 2.0, 1.0);
            let f = Matrix2::new(1.2, 0.15, -0.05, 0.9);
            let stress = law.damaged(&f, f.determinant(), 0.6).stress;
            for a in 0..2 {
                for b in 0..2 {
                    let at = |step: f64| {
                        let mut g = f;
                        g[(a, b)] += step;
                        law.damaged(&g, g.determinant(), 0.6).energy
                    };
                    let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
                    assert!((slope - stress[(a, b)]).abs() < 1e-9, "{material:?} {a}{b}");
                }
            }
        }
    }
}
