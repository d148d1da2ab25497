//! One element: a square (a cube) with one point of integration in its middle and a resistance to what that does not
//! see.
//!
//! At the middle the gradient of a nodal field u is H = sum_a u_a b_a, b_a = s_a / (2^(D-1) dx), s_a a corner's sides.
//! The patterns that have no gradient there, gamma . u with gamma the product of two or more sides over 2^D, would cost
//! nothing; each costs K |gamma . u|² / 2 with
//!   K = 4/3 E' dx^(D-2),
//! with which an element that is bent (u_x = -kappa x y) has the energy E' kappa² dx^(D+2) / 24 of its beam, E' = E /
//! (1 - nu²) in plane strain: no shear locking with one element across (Belytschko and Bachrach 1986 choose their
//! stabilisation by the same bending). With one point there is no volumetric locking either. Both energies depend on
//! differences of positions only and do not change with rotation; forces are their exact derivatives.

use super::mesh::{Mesh, side};
use crate::total_lagrangian::material::Matrix;
use halfstep_sph::columns::Vectors;

/// Patterns without a gradient in the middle: of four corners one, of eight four.
pub(super) const MOST_PATTERNS: usize = 4;

/// An element's geometry: all elements are alike.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element<const D: usize> {
    spacing: f64,
}

impl<const D: usize> Element<D> {
    /// Of this side, m.
    pub(super) fn new(spacing: f64) -> Self {
        Self { spacing }
    }

    /// dx^D.
    pub(super) fn volume(&self) -> f64 {
        self.spacing.powi(D as i32)
    }

    /// K for a modulus E', N/m (2D: N/m²).
    pub(super) fn hourglass(&self, modulus: f64) -> f64 {
        4.0 / 3.0 * modulus * self.spacing.powi(D as i32 - 2)
    }

    /// The slope of a corner's shape function in the middle, 1/m.
    pub(super) fn slope(&self, corner: usize, axis: usize) -> f64 {
        side(corner, axis) / ((Mesh::<D>::CORNERS / 2) as f64 * self.spacing)
    }

    /// du_a/dX_b in the middle.
    pub(super) fn gradient(&self, nodes: &[u32], u: &Vectors<D>) -> Matrix<D> {
        Matrix::from_fn(|a, b| {
            let of = |(corner, &node): (usize, &u32)| u[a][node as usize] * self.slope(corner, b);
            nodes.iter().enumerate().map(of).sum()
        })
    }

    /// gamma . u of each pattern; unused ones are zero.
    pub(super) fn patterns(&self, nodes: &[u32], u: &Vectors<D>) -> [[f64; D]; MOST_PATTERNS] {
        let mut found = [[0.0; D]; MOST_PATTERNS];
        for (pattern, axes) in found.iter_mut().zip(patterns::<D>()) {
            *pattern = std::array::from_fn(|d| {
                let of = |(corner, &node): (usize, &u32)| u[d][node as usize] * gamma::<D>(corner, axes);
                nodes.iter().enumerate().map(of).sum()
            });
        }
        found
    }

    /// Sum over the patterns of what two corners have of each.
    pub(super) fn pattern_product(&self, a: usize, b: usize) -> f64 {
        patterns::<D>().map(|axes| gamma::<D>(a, axes) * gamma::<D>(b, axes)).sum()
    }

    /// Force on a corner by the stress P in the middle, Pa, and by forces that work on the patterns, N (2D: N/m).
    pub(super) fn force(
        &self,
        corner: usize,
        stress: &Matrix<D>,
        on_patterns: &[[f64; D]; MOST_PATTERNS],
    ) -> [f64; D] {
        std::array::from_fn(|d| {
            let inner: f64 = (0..D).map(|b| stress[(d, b)] * self.slope(corner, b)).sum();
            let patterns = on_patterns.iter().zip(patterns::<D>());
            let hourglass: f64 = patterns.map(|(force, axes)| force[d] * gamma::<D>(corner, axes)).sum();
            -self.volume() * inner - hourglass
        })
    }
}

/// Sets of two or more axes, as bits.
fn patterns<const D: usize>() -> impl Iterator<Item = usize> {
    (0..1_usize << D).filter(|axes| axes.count_ones() > 1)
}

fn gamma<const D: usize>(corner: usize, axes: usize) -> f64 {
    let product: f64 = (0..D).filter(|d| axes >> d & 1 == 1).map(|d| side(corner, d)).product();
    product / Mesh::<D>::CORNERS as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Matrix3};

    const NODES: [u32; 4] = [0, 1, 2, 3];

    fn field(of: impl Fn(f64, f64) -> [f64; 2], dx: f64) -> Vectors<2> {
        let at = |corner: usize| of(0.5 * dx * side(corner, 0), 0.5 * dx * side(corner, 1));
        std::array::from_fn(|d| (0..4).map(|corner| at(corner)[d]).collect())
    }

    #[test]
    fn linear_fields_have_their_gradient_and_no_pattern() {
        let element = Element::<2>::new(0.1);
        let u = field(|x, y| [1.0 + 2.0 * x - 3.0 * y, 4.0 * x + 5.0 * y], 0.1);
        assert!((element.gradient(&NODES, &u) - Matrix2::new(2.0, -3.0, 4.0, 5.0)).norm() < 1e-13);
        assert!(element.patterns(&NODES, &u)[0].iter().all(|q| q.abs() < 1e-15));
        let cube = Element::<3>::new(0.5);
        let nodes: Vec<u32> = (0..8).collect();
        let u: Vectors<3> = std::array::from_fn(|d| (0..8).map(|c| 0.25 * side(c, d)).collect());
        assert!((cube.gradient(&nodes, &u) - Matrix3::identity()).norm() < 1e-14);
        assert_eq!(cube.patterns(&nodes, &u), [[0.0; 3]; 4]);
    }

    /// u_x = -kappa x y: gamma . u = -kappa dx² / 4, and K q² / 2 = E' kappa² dx⁴ / 24.
    #[test]
    fn a_bent_element_has_the_energy_of_its_beam() {
        let (dx, kappa, modulus) = (0.1, 3.0, 2e6);
        let element = Element::<2>::new(dx);
        let u = field(|x, y| [-kappa * x * y, 0.5 * kappa * x * x], dx);
        assert!(element.gradient(&NODES, &u).norm() < 1e-15);
        let [q, ..] = element.patterns(&NODES, &u);
        assert!((q[0] + 0.25 * kappa * dx * dx).abs() < 1e-16 && q[1].abs() < 1e-16);
        let energy = 0.5 * element.hourglass(modulus) * q[0] * q[0];
        assert!((energy / (modulus * kappa * kappa * dx.powi(4) / 24.0) - 1.0).abs() < 1e-14);
    }

    /// Forces are the derivative of the work: sum_a f_a . u_a = -V P : H - sum F . q.
    #[test]
    fn forces_work_on_what_they_belong_to() {
        let element = Element::<3>::new(0.2);
        let nodes: Vec<u32> = (0..8).collect();
        let u: Vectors<3> =
            std::array::from_fn(|d| (0..8).map(|c| f64::from(c * 7 % 5) - d as f64).collect());
        let stress = Matrix3::new(1.0, 2.0, 3.0, -4.0, 5.0, 6.0, 7.0, 8.0, -9.0);
        let on_patterns = [[1.0, 2.0, 3.0], [0.5, 0.0, -1.0], [2.0, 2.0, 2.0], [-3.0, 1.0, 0.0]];
        let forces: Vec<[f64; 3]> = (0..8).map(|c| element.force(c, &stress, &on_patterns)).collect();
        let work: f64 = (0..8).map(|c| (0..3).map(|d| forces[c][d] * u[d][c]).sum::<f64>()).sum();
        let inner = element.volume() * stress.component_mul(&element.gradient(&nodes, &u)).sum();
        let found = element.patterns(&nodes, &u);
        let hourglass: f64 =
            (0..4).map(|k| (0..3).map(|d| on_patterns[k][d] * found[k][d]).sum::<f64>()).sum();
        assert!((work + inner + hourglass).abs() < 1e-12 * inner.abs(), "{work} {inner} {hourglass}");
        let sum: f64 = forces.iter().flatten().sum();
        assert!(sum.abs() < 1e-12, "no force on the whole");
    }
}
