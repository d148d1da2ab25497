//! Smoothing kernels W(r, h) with support 2h, normalised in D dimensions.
//!
//! The pair loop needs W and F(r) = W'(r) / r, so that grad_i W_ij = F(r_ij) x_ij with x_ij = x_i - x_j and F <= 0.

use crate::lane::{Arch, Lane, Lanes};
use std::f64::consts::PI;

/// The smoothing kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KernelName {
    /// Cubic spline (Monaghan and Lattanzio 1985), support 2h.
    CubicSpline,
    /// Wendland C2 (Wendland 1995), support 2h.
    WendlandC2,
}

/// Runs `$body` with `$kernel` bound to the kernel that the scene names.
#[macro_export]
macro_rules! with_kernel {
    ($name:expr, $h:expr, $dimension:ident, |$kernel:ident| $body:expr) => {
        match $name {
            $crate::kernel::KernelName::CubicSpline => {
                let $kernel =
                    <$crate::kernel::CubicSpline<$dimension> as $crate::kernel::Kernel<$dimension>>::new($h);
                $body
            }
            $crate::kernel::KernelName::WendlandC2 => {
                let $kernel =
                    <$crate::kernel::WendlandC2<$dimension> as $crate::kernel::Kernel<$dimension>>::new($h);
                $body
            }
        }
    };
}

/// A smoothing kernel. Branch-free: zero beyond its support by itself.
pub trait Kernel<const D: usize>: Copy + Send + Sync + 'static {
    /// For smoothing length h, m.
    fn new(smoothing_length: f64) -> Self;
    /// W(r), m^-D.
    fn value<A: Arch, L: Lanes>(&self, r: L) -> L;
    /// F(r) = W'(r) / r, m^-(D+2); r > 0.
    fn gradient_over_r<A: Arch, L: Lanes>(&self, r: L) -> L;
    /// Smoothing length h, m.
    fn smoothing_length(&self) -> f64;
    /// <r²>, the integral of r² W, m².
    fn second_moment(&self) -> f64;
    /// W(r) of one distance.
    fn at(&self, r: f64) -> f64 {
        self.value::<crate::lane::Unfused, Lane>(Lane::splat(r)).0[0]
    }
    /// F(r) of one distance above zero.
    fn slope_at(&self, r: f64) -> f64 {
        self.gradient_over_r::<crate::lane::Unfused, Lane>(Lane::splat(r)).0[0]
    }
}

/// Cubic spline (Monaghan and Lattanzio 1985), Kayaki's eqs. (10) and (11):
/// W = c { 1 - 3/2 s² + 3/4 s³ (s < 1), 1/4 (2 - s)³ (s < 2) } = c/4 [ (2 - s)₊³ - 4 (1 - s)₊³ ], s = r / h,
/// c = 10 / (7 pi h²) in two dimensions, 1 / (pi h³) in three.
#[derive(Clone, Copy, Debug)]
pub struct CubicSpline<const D: usize> {
    h: f64,
    inverse_h: f64,
    quarter_c: f64,
    slope: f64,
}

impl<const D: usize> Kernel<D> for CubicSpline<D> {
    fn new(h: f64) -> Self {
        let c = match D {
            2 => 10.0 / (7.0 * PI * h * h),
            3 => 1.0 / (PI * h * h * h),
            _ => panic!("kernels are normalised in two and three dimensions"),
        };
        Self { h, inverse_h: 1.0 / h, quarter_c: 0.25 * c, slope: -0.75 * c / h }
    }

    #[inline(always)]
    fn value<A: Arch, L: Lanes>(&self, r: L) -> L {
        let s = r * L::splat(self.inverse_h);
        let a = (L::splat(2.0) - s).max(L::ZERO);
        let b = (L::splat(1.0) - s).max(L::ZERO);
        let b3 = b * b * b;
        L::splat(self.quarter_c) * A::mul_add(L::splat(-4.0), b3, a * a * a)
    }

    #[inline(always)]
    fn gradient_over_r<A: Arch, L: Lanes>(&self, r: L) -> L {
        let s = r * L::splat(self.inverse_h);
        let a = (L::splat(2.0) - s).max(L::ZERO);
        let b = (L::splat(1.0) - s).max(L::ZERO);
        L::splat(self.slope) * A::mul_add(L::splat(-4.0) * b, b, a * a) / r
    }

    fn smoothing_length(&self) -> f64 {
        self.h
    }

    fn second_moment(&self) -> f64 {
        (if D == 2 { 31.0 / 49.0 } else { 0.9 }) * self.h * self.h
    }
}

/// Wendland C2 (Wendland 1995): W = c (1 - s/2)₊⁴ (2 s + 1), c = 7 / (4 pi h²) in two dimensions, 21 / (16 pi h³) in
/// three; F = -5 c / h² (1 - s/2)₊³ needs no division.
#[derive(Clone, Copy, Debug)]
pub struct WendlandC2<const D: usize> {
    h: f64,
    half_inverse_h: f64,
    c: f64,
    slope: f64,
}

impl<const D: usize> Kernel<D> for WendlandC2<D> {
    fn new(h: f64) -> Self {
        let c = match D {
            2 => 7.0 / (4.0 * PI * h * h),
            3 => 21.0 / (16.0 * PI * h * h * h),
            _ => panic!("kernels are normalised in two and three dimensions"),
        };
        Self { h, half_inverse_h: 0.5 / h, c, slope: -5.0 * c / (h * h) }
    }

    #[inline(always)]
    fn value<A: Arch, L: Lanes>(&self, r: L) -> L {
        let half_s = r * L::splat(self.half_inverse_h);
        let t = (L::splat(1.0) - half_s).max(L::ZERO);
        let t2 = t * t;
        L::splat(self.c) * t2 * t2 * A::mul_add(L::splat(4.0), half_s, L::splat(1.0))
    }

    #[inline(always)]
    fn gradient_over_r<A: Arch, L: Lanes>(&self, r: L) -> L {
        let t = (L::splat(1.0) - r * L::splat(self.half_inverse_h)).max(L::ZERO);
        L::splat(self.slope) * t * t * t
    }

    fn smoothing_length(&self) -> f64 {
        self.h
    }

    fn second_moment(&self) -> f64 {
        (if D == 2 { 5.0 / 9.0 } else { 0.8 }) * self.h * self.h
    }
}

/// A kernel chosen by the scene, for the few evaluations outside the pair loop.
pub fn value_at<const D: usize>(name: KernelName, h: f64, r: f64) -> f64 {
    with_kernel!(name, h, D, |kernel| kernel.at(r))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integral of r^power W over the plane or space by the midpoint rule along r.
    fn integral<const D: usize, K: Kernel<D>>(kernel: K, power: i32) -> f64 {
        let h = kernel.smoothing_length();
        let n = 20_000;
        let dr = 2.0 * h / n as f64;
        (0..n)
            .map(|k| {
                let r = (k as f64 + 0.5) * dr;
                let shell = if D == 2 { 2.0 * PI * r } else { 4.0 * PI * r * r };
                kernel.at(r) * r.powi(power) * shell * dr
            })
            .sum()
    }

    fn slope_matches_difference<const D: usize, K: Kernel<D>>(kernel: K) {
        let h = kernel.smoothing_length();
        for s in [0.3, 0.9, 1.1, 1.7] {
            let (r, e) = (s * h, 1e-6 * h);
            let difference = (kernel.at(r + e) - kernel.at(r - e)) / (2.0 * e);
            let exact = kernel.slope_at(r) * r;
            assert!((difference - exact).abs() < 1e-6 * exact.abs(), "s = {s}: {difference} {exact}");
        }
        assert_eq!(kernel.at(2.0 * h), 0.0);
        assert_eq!(kernel.slope_at(2.5 * h), 0.0);
    }

    fn integrates_to_one<const D: usize, K: Kernel<D>>(kernel: K) {
        assert!((integral(kernel, 0) - 1.0).abs() < 1e-7);
        assert!((integral(kernel, 2) / kernel.second_moment() - 1.0).abs() < 1e-7);
    }

    #[test]
    fn kernels_integrate_to_one_and_to_their_second_moment() {
        integrates_to_one(CubicSpline::<2>::new(0.3));
        integrates_to_one(CubicSpline::<3>::new(0.3));
        integrates_to_one(WendlandC2::<2>::new(0.3));
        integrates_to_one(WendlandC2::<3>::new(0.3));
    }

    #[test]
    fn the_gradient_factor_is_the_kernels_derivative() {
        slope_matches_difference(CubicSpline::<2>::new(0.3));
        slope_matches_difference(CubicSpline::<3>::new(0.3));
        slope_matches_difference(WendlandC2::<2>::new(0.3));
        slope_matches_difference(WendlandC2::<3>::new(0.3));
    }

    #[test]
    fn cubic_spline_by_hand() {
        // h = 1: W(0) = 10 / (7 pi); W(1) = 10 / (7 pi) / 4; W(1.5) = 10 / (7 pi) / 32.
        let c = 10.0 / (7.0 * PI);
        let k = CubicSpline::<2>::new(1.0);
        assert!((k.at(0.0) - c).abs() < 1e-15);
        assert!((k.at(1.0) - c / 4.0).abs() < 1e-15);
        assert!((k.at(1.5) - c / 32.0).abs() < 1e-15);
    }
}
