//! Four particles at once: the vector that the pair loop computes with.
//!
//! Plain arrays and plain loops: inside a function compiled for AVX2 or AVX-512VL each operation is one instruction.
//! Everything here must inline into that function; a call would fall back to the baseline instruction set.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Particles per lane.
pub const LANES: usize = 4;

/// One number for each of four particles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub struct Lane(pub [f64; LANES]);

/// How `a * b + c` is rounded.
pub trait Arch: Copy + Send + Sync + 'static {
    /// `a * b + c`.
    fn mul_add(a: Lane, b: Lane, c: Lane) -> Lane;
}

/// Fused: one rounding, one instruction where the processor has FMA. The same bits on AVX2 and AVX-512VL.
#[derive(Clone, Copy)]
pub struct Fused;

/// Two roundings, for processors without FMA (where a fused result would be a library call).
#[derive(Clone, Copy)]
pub struct Unfused;

impl Arch for Fused {
    #[inline(always)]
    fn mul_add(a: Lane, b: Lane, c: Lane) -> Lane {
        Lane(std::array::from_fn(|k| a.0[k].mul_add(b.0[k], c.0[k])))
    }
}

impl Arch for Unfused {
    #[inline(always)]
    fn mul_add(a: Lane, b: Lane, c: Lane) -> Lane {
        Lane(std::array::from_fn(|k| a.0[k] * b.0[k] + c.0[k]))
    }
}

impl Lane {
    /// All zero.
    pub const ZERO: Self = Self([0.0; LANES]);

    /// The same number four times.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self([value; LANES])
    }

    /// Four consecutive entries of a column.
    #[inline(always)]
    pub fn load(column: &[f64], slot: usize) -> Self {
        let part: &[f64; LANES] = column[slot..slot + LANES].try_into().expect("a slice of four");
        Self(*part)
    }

    /// Square roots.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].sqrt()))
    }

    /// The larger of two; the second where they do not compare.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| if self.0[k] > other.0[k] { self.0[k] } else { other.0[k] }))
    }

    /// The smaller of two; the second where they do not compare.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| if self.0[k] < other.0[k] { self.0[k] } else { other.0[k] }))
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Lane {
            type Output = Lane;
            #[inline(always)]
            fn $method(self, other: Lane) -> Lane {
                Lane(std::array::from_fn(|k| self.0[k] $op other.0[k]))
            }
        }
    };
}
operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl AddAssign for Lane {
    #[inline(always)]
    fn add_assign(&mut self, other: Lane) {
        *self = *self + other;
    }
}

impl Neg for Lane {
    type Output = Lane;
    #[inline(always)]
    fn neg(self) -> Lane {
        Lane(std::array::from_fn(|k| -self.0[k]))
    }
}

/// The instruction set that the pair loop was dispatched to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Isa {
    /// x86-64-v1 or any other processor.
    Baseline,
    /// AVX2 and FMA.
    Avx2,
    /// AVX-512VL (256-bit vectors, 32 registers).
    Avx512vl,
}

impl Isa {
    /// The best that this processor has.
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("fma")
            {
                return Self::Avx512vl;
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                return Self::Avx2;
            }
        }
        Self::Baseline
    }

    /// Name of the level in `run.json`. The two levels with FMA give the same bits, so they share one name there.
    pub fn bits_name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 | Self::Avx512vl => "fma",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_acts_on_each_particle() {
        let a = Lane([1.0, 2.0, 3.0, 4.0]);
        let b = Lane::splat(2.0);
        assert_eq!((a + b).0, [3.0, 4.0, 5.0, 6.0]);
        assert_eq!((a - b).0, [-1.0, 0.0, 1.0, 2.0]);
        assert_eq!((a * b).0, [2.0, 4.0, 6.0, 8.0]);
        assert_eq!((a / b).0, [0.5, 1.0, 1.5, 2.0]);
        assert_eq!(a.max(b).0, [2.0, 2.0, 3.0, 4.0]);
        assert_eq!(a.min(b).0, [1.0, 2.0, 2.0, 2.0]);
        assert_eq!((a * a).sqrt(), a);
        assert_eq!((-a).0[3], -4.0);
    }

    #[test]
    fn fused_rounds_once() {
        let e = f64::EPSILON;
        let a = Lane::splat(1.0 + e);
        let c = Lane::splat(-1.0 - 2.0 * e);
        assert_eq!(Fused::mul_add(a, a, c).0[0], e * e);
        assert_eq!(Unfused::mul_add(a, a, c).0[0], 0.0);
    }
}
