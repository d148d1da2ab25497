//! Hyperelastic laws: energy psi per reference volume and first Piola-Kirchhoff stress P = d psi / d F.
//!
//! F deformation gradient, J = det F, lambda and mu Lame's constants. In 2D: plane strain, F_zz = 1, or plane stress,
//! where F_zz is such that no stress acts across the plane.
//!
//!   St. Venant-Kirchhoff:  E = (F^T F - I) / 2,  S = lambda tr(E) I + 2 mu E,  P = F S,
//!                          psi = lambda/2 tr(E)² + mu E : E                              (Holzapfel 2000, eq. 6.151)
//!                          plane stress: lambda* = 2 lambda mu / (lambda + 2 mu) for lambda in the plane
//!   neo-Hooke:             P = mu (F - F^-T) + lambda ln J F^-T,
//!                          psi = mu/2 (tr(F^T F) - 3 - 2 ln J) + lambda/2 (ln J)²   (Bonet and Wood 2008, eq. 6.27)
//!                          plane stress: mu (F_zz² - 1) + lambda ln J = 0

use halfstep_scene::{Material, Plane, Solid};
use halfstep_sph::tensor;
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::wire_component;
use nalgebra::SMatrix;

/// A matrix of the scene's dimension.
pub(crate) type Matrix<const D: usize> = SMatrix<f64, D, D>;

/// A law with its constants.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Law {
    material: Material,
    /// In three dimensions: strain.
    plane: Plane,
    /// Pa.
    lambda: f64,
    /// Pa.
    mu: f64,
}

/// Pressure and deviator of the Cauchy stress, Pa.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cauchy<const D: usize> {
    pub pressure: f64,
    pub deviator: Matrix<D>,
}

impl<const D: usize> Cauchy<D> {
    /// Puts the deviator into a record; in two dimensions with what stands across.
    pub(crate) fn put_deviator(&self, record: &mut StateRecord) {
        for a in 0..D {
            for b in a..D {
                record.deviatoric_stress[wire_component(a, b)] = self.deviator[(a, b)];
            }
        }
        if D == 2 {
            record.deviatoric_stress[2] = -self.deviator.trace();
        }
    }
}

impl Law {
    pub(crate) fn new(solid: &Solid, material: Material, plane: Plane) -> Self {
        let mu = solid.shear_modulus();
        Self { material, plane, lambda: solid.bulk_modulus() - 2.0 / 3.0 * mu, mu }
    }

    /// lambda and mu, Pa.
    pub(super) fn constants(&self) -> (f64, f64) {
        (self.lambda, self.mu)
    }

    /// Which law.
    pub(super) fn material(&self) -> Material {
        self.material
    }

    /// What happens across the plane.
    pub(super) fn plane(&self) -> Plane {
        self.plane
    }

    /// Of plane strain with lambda and mu, Pa.
    #[cfg(test)]
    pub(super) fn of_constants(material: Material, lambda: f64, mu: f64) -> Self {
        Self { material, plane: Plane::Strain, lambda, mu }
    }

    /// J, with what happens across the plane.
    #[inline(always)]
    pub(crate) fn volume_ratio<const D: usize>(&self, f: &Matrix<D>) -> f64 {
        let in_plane = tensor::determinant(f);
        match self.plane {
            Plane::Strain => in_plane,
            // Stretched farther than to nothing across its plane, it has no volume.
            Plane::Stress => in_plane * self.across(f, in_plane).max(0.0).sqrt(),
        }
    }

    /// F_zz² of plane stress; on its own, so that J of plane strain stays short enough to inline.
    #[inline(never)]
    fn across<const D: usize>(&self, f: &Matrix<D>, in_plane: f64) -> f64 {
        match self.material {
            Material::StVenantKirchhoff => {
                1.0 - 2.0 * self.lambda / (self.lambda + 2.0 * self.mu) * green(f).trace()
            }
            Material::NeoHookean => self.neo_hookean_across(in_plane),
        }
    }

    fn neo_hookean_across(&self, in_plane: f64) -> f64 {
        // Newton for x = ln F_zz²: mu (exp x - 1) + lambda (ln det F + x / 2) = 0, which is convex and grows.
        let log = libm::log(in_plane);
        let mut x = -2.0 * self.lambda / (self.lambda + 2.0 * self.mu) * log;
        for _ in 0..MOST_ITERATIONS {
            let value = self.mu * libm::expm1(x) + self.lambda * (log + 0.5 * x);
            let step = value / (self.mu * libm::exp(x) + 0.5 * self.lambda);
            x -= step;
            if step.abs() <= 1e-15 * (1.0 + x.abs()) {
                break;
            }
        }
        libm::exp(x)
    }

    /// lambda in the plane.
    pub(super) fn lambda_in_plane(&self) -> f64 {
        match self.plane {
            Plane::Strain => self.lambda,
            Plane::Stress => 2.0 * self.lambda * self.mu / (self.lambda + 2.0 * self.mu),
        }
    }

    /// First Piola-Kirchhoff stress, Pa; `j` is [`Self::volume_ratio`].
    #[inline(always)]
    pub(crate) fn first_piola_kirchhoff<const D: usize>(&self, f: &Matrix<D>, j: f64) -> Matrix<D> {
        self.nominal(f, j, self.log_of_volume(j))
    }

    /// ln J where the law needs it.
    fn log_of_volume(&self, j: f64) -> f64 {
        match self.material {
            Material::StVenantKirchhoff => 0.0,
            Material::NeoHookean => libm::log(j),
        }
    }

    /// P for F, J and [`Self::log_of_volume`], Pa.
    #[inline(always)]
    fn nominal<const D: usize>(&self, f: &Matrix<D>, j: f64, log: f64) -> Matrix<D> {
        match self.material {
            Material::StVenantKirchhoff => f * self.second_piola_kirchhoff(&green(f)),
            Material::NeoHookean => {
                let in_plane = match self.plane {
                    Plane::Strain => j,
                    Plane::Stress => tensor::determinant(f),
                };
                let Some(inverse) = tensor::inverse(f, in_plane) else { return Matrix::repeat(f64::NAN) };
                f * self.mu + inverse.transpose() * (self.lambda * log - self.mu)
            }
        }
    }

    /// Second Piola-Kirchhoff stress for Green's strain E, Pa.
    pub(crate) fn second_piola_kirchhoff<const D: usize>(&self, e: &Matrix<D>) -> Matrix<D> {
        match self.material {
            Material::StVenantKirchhoff => {
                Matrix::identity() * (self.lambda_in_plane() * e.trace()) + e * (2.0 * self.mu)
            }
            Material::NeoHookean => {
                let c = e * 2.0 + Matrix::identity();
                let square = tensor::determinant(&c);
                let Some(inverse) = tensor::inverse(&c, square) else { return Matrix::repeat(f64::NAN) };
                let in_plane = square.sqrt();
                let j = match self.plane {
                    Plane::Strain => in_plane,
                    Plane::Stress => in_plane * self.neo_hookean_across(in_plane).sqrt(),
                };
                Matrix::identity() * self.mu + inverse * (self.lambda * libm::log(j) - self.mu)
            }
        }
    }

    /// Energy per reference volume, J/m³.
    pub(crate) fn energy<const D: usize>(&self, f: &Matrix<D>, j: f64) -> f64 {
        match self.material {
            Material::StVenantKirchhoff => {
                let e = green(f);
                0.5 * self.lambda_in_plane() * e.trace().powi(2) + self.mu * e.component_mul(&e).sum()
            }
            Material::NeoHookean => {
                let log = libm::log(j);
                let across = match self.plane {
                    Plane::Strain => 0.0,
                    Plane::Stress => (j / tensor::determinant(f)).powi(2) - 1.0,
                };
                // tr(F^T F) - D - 2 ln J by way of E, which is small where F is near a rotation.
                0.5 * self.mu * (2.0 * green(f).trace() + across - 2.0 * log) + 0.5 * self.lambda * log * log
            }
        }
    }

    /// Cauchy stress P F^T / J as pressure and deviator; in 2D sigma_zz is that of plane strain, or none.
    pub(crate) fn cauchy<const D: usize>(&self, f: &Matrix<D>, j: f64) -> Cauchy<D> {
        let log = self.log_of_volume(j);
        let sigma = self.nominal(f, j, log) * f.transpose() / j;
        let out_of_plane = match (D, self.plane, self.material) {
            (2, Plane::Strain, Material::StVenantKirchhoff) => self.lambda * green(f).trace() / j,
            (2, Plane::Strain, Material::NeoHookean) => self.lambda * log / j,
            _ => 0.0,
        };
        let pressure = -(sigma.trace() + out_of_plane) / 3.0;
        Cauchy { pressure, deviator: sigma + Matrix::identity() * pressure }
    }
}

/// Most Newton steps; where strains are a few per cent, four are taken.
const MOST_ITERATIONS: u32 = 50;

/// Green's strain E.
pub(crate) fn green<const D: usize>(f: &Matrix<D>) -> Matrix<D> {
    (f.transpose() * f - Matrix::identity()) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Matrix3, Rotation2};

    /// lambda = 2, mu = 1.
    fn law(material: Material) -> Law {
        Law { material, plane: Plane::Strain, lambda: 2.0, mu: 1.0 }
    }
    const BOTH: [Material; 2] = [Material::StVenantKirchhoff, Material::NeoHookean];

    #[test]
    fn st_venant_kirchhoff_stretch_by_hand() {
        // F = diag(2, 1): E = diag(3/2, 0), S = 2 (3/2) I + 2 E = diag(6, 3), P = F S = diag(12, 3), J = 2;
        // sigma = P F^T / J = diag(12, 3/2), sigma_zz = lambda tr E / J = 3/2; p = -5.
        let (f, law) = (Matrix2::new(2.0, 0.0, 0.0, 1.0), law(Material::StVenantKirchhoff));
        assert_eq!(law.first_piola_kirchhoff(&f, 2.0), Matrix2::new(12.0, 0.0, 0.0, 3.0));
        assert_eq!(law.energy(&f, 2.0), 0.5 * 2.0 * 2.25 + 2.25);
        let cauchy = law.cauchy(&f, 2.0);
        assert!((cauchy.pressure + 5.0).abs() < 1e-15);
        assert!((cauchy.deviator - Matrix2::new(7.0, 0.0, 0.0, -3.5)).norm() < 1e-14);
    }

    #[test]
    fn neo_hookean_stretch_by_hand() {
        // F = diag(2, 1): P_xx = 2 - 1/2 + 2 ln 2 / 2, P_yy = 2 ln 2; sigma_zz = 2 ln 2 / 2;
        // psi = (4 + 1 + 1 - 3 - 2 ln 2) / 2 + (ln 2)².
        let (f, law, log) = (Matrix2::new(2.0, 0.0, 0.0, 1.0), law(Material::NeoHookean), 2.0_f64.ln());
        let p = law.first_piola_kirchhoff(&f, 2.0);
        assert!((p - Matrix2::new(1.5 + log, 0.0, 0.0, 2.0 * log)).norm() < 1e-15);
        assert!((law.energy(&f, 2.0) - (1.5 - log + log * log)).abs() < 1e-15);
        // sigma = diag(1.5 + ln 2, ln 2), zz = ln 2: p = -(1.5 + 3 ln 2) / 3.
        let cauchy = law.cauchy(&f, 2.0);
        assert!((cauchy.pressure + 0.5 + log).abs() < 1e-15);
        assert!((cauchy.deviator - Matrix2::new(1.0, 0.0, 0.0, -0.5)).norm() < 1e-15);
    }

    /// P = F S.
    #[test]
    fn both_stresses_are_one() {
        let f = Matrix2::new(1.1, 0.2, -0.1, 0.85);
        for (material, plane) in BOTH.into_iter().flat_map(|m| [(m, Plane::Strain), (m, Plane::Stress)]) {
            let law = Law { plane, ..law(material) };
            let first = law.first_piola_kirchhoff(&f, law.volume_ratio(&f));
            let second = law.second_piola_kirchhoff(&green(&f));
            assert!((first - f * second).norm() < 1e-14, "{material:?} {plane:?}: {first} {second}");
        }
    }

    #[test]
    fn plane_stress_is_three_dimensions_without_stress_across() {
        let f = Matrix2::new(1.1, 0.2, -0.1, 0.85);
        for material in BOTH {
            let law = Law { plane: Plane::Stress, ..law(material) };
            let j = law.volume_ratio(&f);
            let across = j / f.determinant();
            let full = Matrix3::new(1.1, 0.2, 0.0, -0.1, 0.85, 0.0, 0.0, 0.0, across);
            let space = Law { plane: Plane::Strain, ..law };
            let p = space.first_piola_kirchhoff(&full, full.determinant());
            assert!(p[(2, 2)].abs() < 1e-14, "{material:?}: {p}");
            let in_plane = law.first_piola_kirchhoff(&f, j);
            assert!((in_plane - p.fixed_view::<2, 2>(0, 0)).norm() < 1e-14, "{material:?}: {in_plane} {p}");
            assert!((law.energy(&f, j) - space.energy(&full, full.determinant())).abs() < 1e-14);
            let pressure = space.cauchy(&full, full.determinant()).pressure;
            assert!((law.cauchy(&f, j).pressure - pressure).abs() < 1e-14);
        }
    }

    /// F_zz² = 1 - 2 lambda / (lambda + 2 mu) tr E, with lambda = 2, mu = 1 negative beyond tr E = 1: no volume is
    /// left, which is out of bounds, and no NaN.
    #[test]
    fn a_sheet_that_is_stretched_to_nothing_has_no_volume() {
        let law = Law { plane: Plane::Stress, ..law(Material::StVenantKirchhoff) };
        let stretched = |trace: f64| law.volume_ratio(&(Matrix2::identity() * (1.0 + trace).sqrt()));
        assert!((stretched(0.75) - 1.75 * 0.5).abs() < 1e-14);
        assert_eq!(stretched(1.25), 0.0);
        assert!(law.volume_ratio(&Matrix2::from_element(f64::NAN)).is_nan());
    }

    #[test]
    fn a_strip_that_is_pulled_in_plane_stress_has_youngs_modulus() {
        // lambda = 2, mu = 1: E = mu (3 lambda + 2 mu) / (lambda + mu) = 8/3, nu = 1/3.
        let strain = 1e-7;
        let f = Matrix2::new(1.0 + strain, 0.0, 0.0, 1.0 - strain / 3.0);
        for material in BOTH {
            let law = Law { plane: Plane::Stress, ..law(material) };
            let p = law.first_piola_kirchhoff(&f, law.volume_ratio(&f));
            assert!((p[(0, 0)] / strain - 8.0 / 3.0).abs() < 1e-6 && p[(1, 1)].abs() < 1e-6 * strain, "{p}");
        }
    }

    #[test]
    fn simple_shear_by_hand() {
        // F = [[1, 1], [0, 1]]: E = [[0, 1/2], [1/2, 1/2]], S = [[1, 1], [1, 2]], P = [[2, 3], [1, 2]].
        let f = Matrix2::new(1.0, 1.0, 0.0, 1.0);
        let p = law(Material::StVenantKirchhoff).first_piola_kirchhoff(&f, 1.0);
        assert_eq!(p, Matrix2::new(2.0, 3.0, 1.0, 2.0));
        // J = 1, F^-T = [[1, 0], [-1, 1]]: P = F - F^-T = [[0, 1], [1, 0]].
        let p = law(Material::NeoHookean).first_piola_kirchhoff(&f, 1.0);
        assert_eq!(p, Matrix2::new(0.0, 1.0, 1.0, 0.0));
    }

    #[test]
    fn stress_is_the_slope_of_the_energy() {
        for material in BOTH {
            let law = law(material);
            let f = Matrix3::new(1.1, 0.2, -0.1, 0.05, 0.9, 0.3, -0.2, 0.1, 1.2);
            let p = law.first_piola_kirchhoff(&f, f.determinant());
            for a in 0..3 {
                for b in 0..3 {
                    let at = |step: f64| {
                        let mut g = f;
                        g[(a, b)] += step;
                        law.energy(&g, g.determinant())
                    };
                    let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
                    assert!((slope - p[(a, b)]).abs() < 1e-8, "{material:?} {a}{b}: {slope} {p}");
                }
            }
        }
    }

    #[test]
    fn a_rotation_makes_no_stress() {
        let f = *Rotation2::new(2.1).matrix();
        for material in BOTH {
            let law = law(material);
            assert!(law.first_piola_kirchhoff(&f, f.determinant()).norm() < 1e-14);
            assert!(law.energy(&f, f.determinant()).abs() < 1e-15);
        }
    }

    #[test]
    fn small_strains_follow_hooke() {
        // sigma = lambda tr(e) I + 2 mu e to first order.
        let e = Matrix2::new(3e-7, 1e-7, 1e-7, -2e-7);
        let f = Matrix2::identity() + e;
        let hooke = Matrix2::identity() * (2.0 * e.trace()) + e * 2.0;
        for material in BOTH {
            let cauchy = law(material).cauchy(&f, f.determinant());
            let sigma = cauchy.deviator - Matrix2::identity() * cauchy.pressure;
            assert!((sigma - hooke).norm() < 1e-12, "{material:?}");
        }
    }
}
