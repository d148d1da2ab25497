//! Several particles at once: the vectors that the pair loop computes with.
//!
//! Plain arrays and plain loops: inside a function compiled for AVX2 (four numbers) or AVX-512 (eight) each operation
//! is one instruction. Everything here must inline into that function; a call would fall back to the baseline
//! instruction set.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Particles whose sums are stored together: the fewest that are computed at once.
pub const LANES: usize = 4;

/// Most particles that are computed at once; rows of particles are padded to a multiple of it.
pub const WIDEST: usize = 8;

/// One number for each of several particles: four unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct Lane<const N: usize = LANES>(pub [f64; N]);

/// One number for each of eight particles.
pub type Eight = Lane<WIDEST>;

/// What the pair loop computes with: one number for each target, a whole number of fours.
pub trait Lanes:
    Copy
    + Debug
    + Default
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + 'static
{
    /// Number of targets.
    const TARGETS: usize;
    /// All zero.
    const ZERO: Self;

    /// The same number for all targets.
    fn splat(value: f64) -> Self;
    /// Each target's own number.
    fn each(value: impl Fn(usize) -> f64) -> Self;
    /// Consecutive entries of a column.
    fn load(column: &[f64], slot: usize) -> Self;
    /// From fours.
    fn of_fours(four: impl Fn(usize) -> Lane) -> Self;
    /// The k-th four.
    fn four(self, k: usize) -> Lane;
    /// Square roots.
    fn sqrt(self) -> Self;
    /// The larger of two; the second where they do not compare.
    fn max(self, other: Self) -> Self;
    /// The smaller of two; the second where they do not compare.
    fn min(self, other: Self) -> Self;
    /// `self * b + c`, rounded once.
    fn fused(self, b: Self, c: Self) -> Self;
    /// `self * b + c`, rounded twice.
    fn unfused(self, b: Self, c: Self) -> Self;
}

/// How `a * b + c` is rounded.
pub trait Arch: Copy + Send + Sync + 'static {
    /// `a * b + c`.
    fn mul_add<L: Lanes>(a: L, b: L, c: L) -> L;
}

/// Fused: one rounding, one instruction where the processor has FMA. The same bits on AVX2 and AVX-512.
#[derive(Clone, Copy)]
pub struct Fused;

/// Two roundings, for processors without FMA (where a fused result would be a library call).
#[derive(Clone, Copy)]
pub struct Unfused;

impl Arch for Fused {
    #[inline(always)]
    fn mul_add<L: Lanes>(a: L, b: L, c: L) -> L {
        a.fused(b, c)
    }
}

impl Arch for Unfused {
    #[inline(always)]
    fn mul_add<L: Lanes>(a: L, b: L, c: L) -> L {
        a.unfused(b, c)
    }
}

impl<const N: usize> Default for Lane<N> {
    fn default() -> Self {
        Self::ZERO
    }
}

/// Each number by itself: a plain loop, which inlines whatever surrounds it, unlike `std::array::from_fn`.
macro_rules! each {
    ($k:ident => $number:expr) => {{
        let mut lane = Self::ZERO;
        for $k in 0..N {
            lane.0[$k] = $number;
        }
        lane
    }};
}

impl<const N: usize> Lanes for Lane<N> {
    const TARGETS: usize = N;
    const ZERO: Self = Self([0.0; N]);

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; N])
    }
    #[inline(always)]
    fn each(value: impl Fn(usize) -> f64) -> Self {
        each!(k => value(k))
    }
    #[inline(always)]
    fn load(column: &[f64], slot: usize) -> Self {
        let part: &[f64; N] = column[slot..slot + N].try_into().expect("a slice of that length");
        Self(*part)
    }
    #[inline(always)]
    fn of_fours(four: impl Fn(usize) -> Lane) -> Self {
        let mut lane = Self::ZERO;
        for (k, part) in lane.0.chunks_exact_mut(LANES).enumerate() {
            part.copy_from_slice(&four(k).0);
        }
        lane
    }
    #[inline(always)]
    fn four(self, k: usize) -> Lane {
        let part: &[f64; LANES] = self.0[LANES * k..][..LANES].try_into().expect("a slice of four");
        Lane(*part)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        each!(k => self.0[k].sqrt())
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        each!(k => if self.0[k] > other.0[k] { self.0[k] } else { other.0[k] })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        each!(k => if self.0[k] < other.0[k] { self.0[k] } else { other.0[k] })
    }
    #[inline(always)]
    fn fused(self, b: Self, c: Self) -> Self {
        each!(k => self.0[k].mul_add(b.0[k], c.0[k]))
    }
    #[inline(always)]
    fn unfused(self, b: Self, c: Self) -> Self {
        each!(k => self.0[k] * b.0[k] + c.0[k])
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $op:tt) => {
        impl<const N: usize> $trait for Lane<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                each!(k => self.0[k] $op other.0[k])
            }
        }
    };
}
operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl<const N: usize> AddAssign for Lane<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const N: usize> Neg for Lane<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        each!(k => -self.0[k])
    }
}

/// The instruction set that the pair loop was dispatched to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Isa {
    /// x86-64-v1 or any other processor.
    Baseline,
    /// AVX2 and FMA.
    Avx2,
    /// AVX-512 with VL and DQ: eight numbers at once.
    Avx512vl,
}

impl Isa {
    /// The best that this processor has.
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
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

    /// Targets that the wide passes compute at once.
    pub fn targets(self) -> usize {
        match self {
            Self::Baseline | Self::Avx2 => LANES,
            Self::Avx512vl => WIDEST,
        }
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
        let a: Lane = Lane::splat(1.0 + e);
        let c = Lane::splat(-1.0 - 2.0 * e);
        assert_eq!(Fused::mul_add(a, a, c).0[0], e * e);
        assert_eq!(Unfused::mul_add(a, a, c).0[0], 0.0);
    }

    #[test]
    fn eight_are_two_fours() {
        let eight = Eight::each(|k| k as f64);
        assert_eq!(eight.four(1), Lane([4.0, 5.0, 6.0, 7.0]));
        assert_eq!(Eight::of_fours(|k| eight.four(k)), eight);
    }
}
