//! Viscous stress of a Newtonian fluid by pairs, along the line between them:
//!   m_i a_i = sum_j V_i V_j (2 D mu / <r²>) F (v_ij . x_ij) x_ij,  <r²> = integral of r² W,
//! with grad W = F x_ij. Monaghan and Gingold (1983) have 2 (D + 2) mu / (r² + 0.01 h²) for the bracket: near
//! neighbours weigh more, a lattice's sum is farther from the integral, and a pair needs a division more.

use crate::kernel::{Kernel, KernelName};
use crate::with_kernel;

/// 2 D mu / <r²>, Pa s / m², of a viscosity mu, Pa s, with a kernel of smoothing length h, m.
pub fn strength<const D: usize>(viscosity: f64, kernel: KernelName, smoothing_length: f64) -> f64 {
    with_kernel!(kernel, smoothing_length, D, |kernel| 2.0 * D as f64 * viscosity / kernel.second_moment())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::WendlandC2;

    /// Weight of a pair at a distance, in spacings: ours, and Monaghan and Gingold's without their 0.01 h².
    fn weights(h: f64) -> [impl Fn(f64) -> f64; 2] {
        let kernel = WendlandC2::<2>::new(h);
        [true, false].map(|ours| {
            move |r: f64| {
                let pair = if ours { 4.0 / kernel.second_moment() } else { 8.0 / (r * r) };
                -kernel.slope_at(r) * pair
            }
        })
    }

    fn lattice(steps: [[f64; 2]; 2]) -> impl Iterator<Item = [f64; 2]> {
        let all = (-8..=8).flat_map(|i| (-8..=8).map(move |j| [f64::from(i), f64::from(j)]));
        all.filter(|n| *n != [0.0; 2]).map(move |[i, j]| [0, 1].map(|d| i * steps[0][d] + j * steps[1][d]))
    }

    /// Momentum that a shear du/dy = 1 carries over a cell of area 1, over mu: 1 where the sum is its integral.
    fn shear(lattice: impl Iterator<Item = [f64; 2]>, weight: impl Fn(f64) -> f64) -> f64 {
        0.5 * lattice.map(|[x, y]| weight(x.hypot(y)) * x * x * y * y).sum::<f64>()
    }

    /// The sums that the page compares: rows that slide, a square lattice along its axes and its diagonals, a hexagonal
    /// one.
    #[test]
    fn a_lattices_sum_is_near_to_its_integral() {
        let half = 0.5_f64.sqrt();
        let side = (2.0 / 3.0_f64.sqrt()).sqrt();
        let lattices = [
            [[1.0, 0.0], [0.0, 1.0]],
            [[half, half], [-half, half]],
            [[side, 0.0], [0.5 * side, 0.75_f64.sqrt() * side]],
        ];
        for (h, right) in [
            (1.5, [[0.998, 0.996, 1.044, 1.000], [0.919, 0.886, 1.109, 0.994]]),
            (2.0, [[1.000, 0.998, 1.011, 0.999], [0.972, 0.959, 1.039, 0.998]]),
        ] {
            for (weight, right) in weights(h).into_iter().zip(right) {
                // Rows in the mean over all places along each other.
                let rows = (0..100).map(|k| {
                    let moved = lattice(lattices[0]).filter(|[_, y]| *y != 0.0);
                    shear(moved.map(|[x, y]| [x + 0.01 * f64::from(k), y]), &weight)
                });
                let rows = rows.sum::<f64>() / 100.0;
                let [axes, diagonals, hexagons] = lattices.map(|steps| shear(lattice(steps), &weight));
                let found = [rows, axes, diagonals, hexagons];
                println!("{h}: {found:?}");
                assert!(
                    found.iter().zip(right).all(|(f, r)| (f - r).abs() < 6e-4),
                    "{h}: {found:?} {right:?}"
                );
            }
        }
    }

    /// Largest rate at which a wave on a square lattice decays, over nu / h²: explicit steps bear 2 of its product.
    #[test]
    fn the_fastest_mode_of_a_lattice() {
        for (h, right) in [(1.5, 10.8), (2.0, 10.7)] {
            let [ours, _] = weights(h);
            let mut fastest = 0.0_f64;
            for k in (0..=40).flat_map(|i| (0..=40).map(move |j| [i, j])) {
                let k = k.map(|k| f64::from(k) * std::f64::consts::PI / 40.0);
                let mut m = [0.0; 3];
                for [x, y] in lattice([[1.0, 0.0], [0.0, 1.0]]) {
                    let part = ours(x.hypot(y)) * (1.0 - (k[0] * x + k[1] * y).cos());
                    m = [m[0] + part * x * x, m[1] + part * x * y, m[2] + part * y * y];
                }
                fastest = fastest.max(0.5 * (m[0] + m[2]) + (0.5 * (m[0] - m[2])).hypot(m[1]));
            }
            println!("{h}: {}", fastest * h * h);
            assert!((fastest * h * h - right).abs() < 0.1, "{h}: {}", fastest * h * h);
        }
    }
}
