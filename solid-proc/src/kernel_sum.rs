//! Depth of a particle in a surface that other particles make, by a sum over a kernel.
//!
//! With the Wendland kernel w of radius R, a particle i sees others as
//!   S_i = sum_j w(r_ij),   delta_i = max(S_i - S_0, 0) / sigma.
//! S_0 and -sigma are this sum and its slope at the distance dx from a flat lattice, where two surfaces meet. The
//! radius is the one with which S differs least along the lattice, so what slides does not climb from row to row: with
//! pairs that push from dx on it does, by 0.134 dx. An energy k delta_i² / 2 pushes each pair along its line, so
//! momentum and moment are kept.

use halfstep_sph::kernel::{Kernel, WendlandC2};

/// Places along a spacing over which S_0 and sigma are means.
const PLACES: u32 = 8;

/// The sum over the particles of a spacing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KernelSum<const D: usize> {
    pub(crate) kernel: WendlandC2<D>,
    /// R, m.
    pub(crate) radius: f64,
    /// S_0, m^-D.
    pub(crate) level: f64,
    /// sigma, m^-(D+1).
    pub(crate) slope: f64,
}

impl<const D: usize> KernelSum<D> {
    /// R over dx. S differs along a square lattice at the depths 0, 0.1 and 0.3 dx by 0.0003, 0.0006
    /// and 0.0023 sigma dx, along a cubic one by 0.0015, 0.0021 and 0.0012.
    const RADIUS: f64 = if D == 2 { 1.8 } else { 1.9 };

    /// Of particles dx, m, apart.
    pub(crate) fn new(dx: f64) -> Self {
        let radius = Self::RADIUS * dx;
        let kernel = WendlandC2::new(0.5 * radius);
        let (mut level, mut slope) = (0.0, 0.0);
        let across = (radius / dx).ceil() as i32 + 1;
        let (width, sides) = ((2 * across + 1) as u32, D as u32 - 1);
        let rows = ((radius - dx) / dx).ceil() as u32;
        for place in 0..PLACES.pow(sides) {
            for k in 0..width.pow(sides) {
                let lateral: f64 = (0..sides)
                    .map(|side| {
                        let cell = f64::from((k / width.pow(side) % width) as i32 - across);
                        let offset = f64::from(place / PLACES.pow(side) % PLACES) / f64::from(PLACES);
                        (dx * (cell + offset)).powi(2)
                    })
                    .sum();
                for row in 0..rows {
                    let height = dx + f64::from(row) * dx;
                    let r = (lateral + height * height).sqrt();
                    level += kernel.at(r);
                    slope -= kernel.slope_at(r) * height;
                }
            }
        }
        let places = f64::from(PLACES.pow(sides));
        Self { kernel, radius, level: level / places, slope: slope / places }
    }

    /// delta, m, of a particle with the sum S that pushes from `rest` on.
    pub(crate) fn depth(&self, sum: f64, rest: f64) -> f64 {
        (sum - rest).max(0.0) / self.slope
    }

    /// Largest curvature of w at a distance, over sigma: the larger of |w''| and |w' / r|, 1/m.
    pub(crate) fn curvature(&self, r: f64) -> f64 {
        let q = r / self.radius;
        let along = if q < 1.0 { (1.0 - 4.0 * q).abs() / (1.0 - q) } else { 0.0 };
        self.kernel.slope_at(r).abs() * along.max(1.0) / self.slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl KernelSum<2> {
        /// delta, the slope of delta and the sum of curvatures at a height over rows of a lattice with a particle right
        /// below.
        pub(crate) fn over_rows(&self, dx: f64, height: f64) -> [f64; 3] {
            let (mut sum, mut slope, mut curvature) = (0.0, 0.0, 0.0);
            for (row, k) in (0..4).flat_map(|row| (-4..=4).map(move |k| (row, k))) {
                let (x, y) = (f64::from(k) * dx, height + f64::from(row) * dx);
                let r = x.hypot(y);
                if r < self.radius {
                    sum += self.kernel.at(r);
                    slope -= self.kernel.slope_at(r) * y / self.slope;
                    curvature += self.curvature(r);
                }
            }
            [self.depth(sum, self.level), slope, curvature]
        }
    }

    /// w(1) = 0.1257, w(sqrt 2) = 0.00874 over w(0) with R = 1.8: 0.1432 above a particle, in the mean 0.1434.
    #[test]
    fn level_and_slope_are_those_of_a_lattice() {
        let sum = KernelSum::<2>::new(1.0);
        assert!((sum.level / sum.kernel.at(0.0) - 0.1434).abs() < 5e-5, "{sum:?}");
        assert!((sum.slope / sum.kernel.at(0.0) - 0.6668).abs() < 5e-5, "{sum:?}");
        let fine = KernelSum::<2>::new(0.01);
        assert!((fine.slope / fine.level / (sum.slope / sum.level) - 100.0).abs() < 1e-9);
    }

    /// S along a row: a part of the depth of 0.134 dx from which pairs would lift it.
    #[test]
    fn along_a_row_the_depth_does_not_change() {
        let sum = KernelSum::<2>::new(1.0);
        let at = |x: f64| -> f64 {
            let rows = (0..4).flat_map(|row| (-4..=4).map(move |k| (row, k)));
            rows.map(|(row, k)| sum.kernel.at((x - f64::from(k)).hypot(1.0 + f64::from(row)))).sum()
        };
        let depths = (0..16).map(|k| (at(f64::from(k) / 16.0) - sum.level) / sum.slope);
        let most = depths.map(f64::abs).fold(0.0, f64::max);
        assert!(most < 0.001, "{most}");
    }

    /// w'' and w' / r by differences.
    #[test]
    fn no_curvature_is_larger() {
        let sum = KernelSum::<2>::new(1.0);
        for k in 1..40 {
            let (r, e) = (0.05 * f64::from(k), 1e-4);
            let [behind, here, ahead] = [r - e, r, r + e].map(|r| sum.kernel.at(r));
            let found =
                ((ahead - 2.0 * here + behind) / (e * e)).abs().max((ahead - behind).abs() / (2.0 * e * r));
            assert!((sum.curvature(r) * sum.slope - found).abs() < 1e-4, "{r}: {found}");
        }
    }
}
