//! A reference that owes nothing to particles: the slowest period of a clamped plane-strain block by finite elements.
//!
//! 8-node serendipity quadrilaterals with 3 x 3 Gauss points, consistent mass (Bathe, Finite element procedures,
//! sections 5.3 and 5.5); the lowest mode by inverse iteration.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SMatrix};

/// Nodes of an element: corners, then middles of the sides.
const NODES: [(f64, f64); 8] =
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)];

type Element = SMatrix<f64, 16, 16>;

/// A block clamped over its whole left face, free elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// m.
    pub length: f64,
    /// m.
    pub height: f64,
    /// Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// kg/m³.
    pub density: f64,
}

impl Block {
    /// Longest period of free vibration with that many elements along and across, s.
    ///
    /// # Panics
    /// The stiffness is not positive definite: no block.
    pub fn period(&self, along: usize, across: usize) -> f64 {
        let (stiffness, mass) = self.assembled(along, across);
        let factor: Cholesky<f64, Dyn> = Cholesky::new(stiffness).expect("a clamped block is stiff");
        let mut mode = DVector::from_element(mass.nrows(), 1.0);
        let mut square = 0.0;
        for _ in 0..30 {
            let next = factor.solve(&(&mass * &mode));
            // Rayleigh's quotient of K^-1 M.
            let weighted = &mass * &next;
            square = mode.dot(&weighted) / mode.dot(&(&mass * &mode));
            mode = &next / next.norm();
        }
        std::f64::consts::TAU * square.sqrt()
    }

    /// Stiffness and mass of the free degrees of freedom.
    fn assembled(&self, along: usize, across: usize) -> (DMatrix<f64>, DMatrix<f64>) {
        let (stiffness, mass) = self.element(along, across);
        // Numbers of the free nodes of a grid of half elements, middles of elements left out.
        let mut number = vec![vec![None; 2 * across + 1]; 2 * along + 1];
        let mut count = 0;
        for (i, column) in number.iter_mut().enumerate().skip(1) {
            for (j, node) in column.iter_mut().enumerate() {
                if i % 2 == 0 || j % 2 == 0 {
                    *node = Some(count);
                    count += 1;
                }
            }
        }
        let mut all = [DMatrix::zeros(2 * count, 2 * count), DMatrix::zeros(2 * count, 2 * count)];
        for i in 0..along {
            for j in 0..across {
                let nodes = NODES.map(|(x, y)| {
                    let half = |middle: usize, offset: f64| (middle as f64 + offset) as usize;
                    number[half(2 * i + 1, x)][half(2 * j + 1, y)]
                });
                for (a, row) in nodes.iter().enumerate() {
                    for (b, column) in nodes.iter().enumerate() {
                        let (Some(row), Some(column)) = (row, column) else { continue };
                        for c in 0..2 {
                            for d in 0..2 {
                                let at = (2 * row + c, 2 * column + d);
                                all[0][at] += stiffness[(2 * a + c, 2 * b + d)];
                                all[1][at] += mass[(2 * a + c, 2 * b + d)];
                            }
                        }
                    }
                }
            }
        }
        let [stiffness, mass] = all;
        (stiffness, mass)
    }

    /// Stiffness and mass of an element.
    fn element(&self, along: usize, across: usize) -> (Element, Element) {
        let (e, nu) = (self.youngs_modulus, self.poissons_ratio);
        let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let mu = e / (2.0 * (1.0 + nu));
        let elasticity = SMatrix::<f64, 3, 3>::new(
            lambda + 2.0 * mu,
            lambda,
            0.0,
            lambda,
            lambda + 2.0 * mu,
            0.0,
            0.0,
            0.0,
            mu,
        );
        let (hx, hy) = (self.length / along as f64, self.height / across as f64);
        let points = [(-(0.6_f64.sqrt()), 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.6_f64.sqrt(), 5.0 / 9.0)];
        let (mut stiffness, mut mass) = (Element::zeros(), Element::zeros());
        for (x, weight_x) in points {
            for (y, weight_y) in points {
                let mut strain = SMatrix::<f64, 3, 16>::zeros();
                let mut value = SMatrix::<f64, 2, 16>::zeros();
                for (k, &node) in NODES.iter().enumerate() {
                    let (n, dx, dy) = shape(node, x, y);
                    let (dx, dy) = (2.0 * dx / hx, 2.0 * dy / hy);
                    strain[(0, 2 * k)] = dx;
                    strain[(1, 2 * k + 1)] = dy;
                    strain[(2, 2 * k)] = dy;
                    strain[(2, 2 * k + 1)] = dx;
                    value[(0, 2 * k)] = n;
                    value[(1, 2 * k + 1)] = n;
                }
                let area = weight_x * weight_y * hx * hy / 4.0;
                stiffness += strain.transpose() * elasticity * strain * area;
                mass += value.transpose() * value * (self.density * area);
            }
        }
        (stiffness, mass)
    }
}

/// Shape function of a node and its derivatives.
fn shape((a, b): (f64, f64), x: f64, y: f64) -> (f64, f64, f64) {
    if a != 0.0 && b != 0.0 {
        (
            0.25 * (1.0 + a * x) * (1.0 + b * y) * (a * x + b * y - 1.0),
            0.25 * a * (1.0 + b * y) * (2.0 * a * x + b * y),
            0.25 * b * (1.0 + a * x) * (a * x + 2.0 * b * y),
        )
    } else if a == 0.0 {
        (0.5 * (1.0 - x * x) * (1.0 + b * y), -x * (1.0 + b * y), 0.5 * b * (1.0 - x * x))
    } else {
        (0.5 * (1.0 + a * x) * (1.0 - y * y), 0.5 * a * (1.0 - y * y), -y * (1.0 + a * x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thin_block_has_the_period_of_a_beam() {
        // Bending, nu = 0: T = 2 pi / (1.8751² sqrt(E H² / (12 rho)) / L²); shear adds 1e-4.
        let thin =
            Block { length: 1.0, height: 0.01, youngs_modulus: 1e6, poissons_ratio: 0.0, density: 1000.0 };
        let theory = std::f64::consts::TAU / (1.875_104_f64.powi(2) * (1e6 * 1e-4 / 12e3_f64).sqrt());
        let found = thin.period(20, 1);
        assert!((found / theory - 1.0).abs() < 1e-3, "{found} {theory}");
    }

    #[test]
    fn shape_functions_sum_to_one_and_belong_to_their_nodes() {
        for (x, y) in [(0.3, -0.7), (1.0, 0.2), (-0.4, 0.9)] {
            let sum = NODES.iter().fold((0.0, 0.0, 0.0), |s, &n| {
                let (v, dx, dy) = shape(n, x, y);
                (s.0 + v, s.1 + dx, s.2 + dy)
            });
            assert!((sum.0 - 1.0).abs() < 1e-12 && sum.1.abs() < 1e-12 && sum.2.abs() < 1e-12);
        }
        for (k, &node) in NODES.iter().enumerate() {
            for (l, &(x, y)) in NODES.iter().enumerate() {
                assert_eq!(shape(node, x, y).0, f64::from(u8::from(k == l)));
            }
        }
    }
}
