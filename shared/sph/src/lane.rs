//! Several particles at once: the vectors that the pair loop computes with.
//!
//! Plain arrays and plain loops: inside a function compiled for AVX2 (four numbers, in single precision eight) or
//! AVX-512 (twice as many) each operation is one instruction. Everything here must inline into that function; a call
//! would fall back to the baseline instruction set.

mod isa;

pub use isa::{Isa, Precision};
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Particles whose sums are stored together: the fewest that are computed at once.
pub const LANES: usize = 4;

/// Most particles that are computed at once in double precision; rows of particles are padded to a multiple of it.
pub const WIDEST: usize = 8;

/// The same in single precision.
pub const WIDEST_SINGLE: usize = 16;

/// One number for each of several particles: four unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct Lane<const N: usize = LANES>(pub [f64; N]);

/// One number for each of eight particles.
pub type Eight = Lane<WIDEST>;

/// One number in single precision for each of several particles.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct Single<const N: usize>(pub [f32; N]);

/// A number whose difference from another counts: a component of a position. In single precision it is one number and
/// what that leaves out.
pub trait Number: Copy + Debug {
    /// From a number in double precision.
    fn of(value: f64) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }
}

/// A number, and the rest of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Halves {
    /// The number in single precision.
    pub high: f32,
    /// What it leaves out.
    pub low: f32,
}

impl Number for Halves {
    #[inline(always)]
    fn of(value: f64) -> Self {
        let high = value as f32;
        Self { high, low: (value - f64::from(high)) as f32 }
    }
}

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
    /// In single precision.
    const SINGLE: bool;
    /// Larger than whatever is compared with it, and finite times any of that.
    const FAR: f64;

    /// A number of a source whose difference from the targets' counts.
    type Number: Number;
    /// The targets' own.
    type Numbers: Copy;

    /// The same number for all targets.
    fn splat(value: f64) -> Self;
    /// Each target's own number.
    fn each(value: impl Fn(usize) -> f64) -> Self;
    /// Consecutive entries of a column.
    fn load(column: &[f64], slot: usize) -> Self;
    /// The same number in single precision for all targets.
    fn splat_single(value: f32) -> Self;
    /// A source's number that is kept in halves.
    fn of_halves(halves: Halves) -> Self::Number;
    /// Numbers of the targets.
    fn numbers(value: impl Fn(usize) -> f64) -> Self::Numbers;
    /// Differences of the targets' numbers from a source's.
    fn difference(numbers: Self::Numbers, from: Self::Number) -> Self;
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

/// Each number by itself: a plain loop, which inlines whatever surrounds it, unlike `std::array::from_fn`.
macro_rules! each {
    ($k:ident => $number:expr) => {{
        let mut lane = Self([0.0; N]);
        for $k in 0..N {
            lane.0[$k] = $number;
        }
        lane
    }};
}

macro_rules! operator {
    ($lanes:ident, $trait:ident, $method:ident, $op:tt) => {
        impl<const N: usize> $trait for $lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                each!(k => self.0[k] $op other.0[k])
            }
        }
    };
}

/// What lanes do alike in both precisions.
macro_rules! arithmetic {
    ($lanes:ident) => {
        impl<const N: usize> Default for $lanes<N> {
            fn default() -> Self {
                Self([0.0; N])
            }
        }

        operator!($lanes, Add, add, +);
        operator!($lanes, Sub, sub, -);
        operator!($lanes, Mul, mul, *);
        operator!($lanes, Div, div, /);

        impl<const N: usize> AddAssign for $lanes<N> {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl<const N: usize> Neg for $lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                each!(k => -self.0[k])
            }
        }
    };
}

/// Each component by itself: a plain loop, too, for what is computed of every pair. `from_fn` and `map` of arrays are
/// calls there where vectors are long, and a call keeps every vector in memory.
#[inline(always)]
pub fn components<T: Copy, const D: usize>(of: impl Fn(usize) -> T) -> [T; D] {
    let mut components = [of(0); D];
    for (d, component) in components.iter_mut().enumerate().skip(1) {
        *component = of(d);
    }
    components
}

/// The part of [`Lanes`] that is alike in both precisions.
macro_rules! elementwise {
    ($number:ty) => {
        const TARGETS: usize = N;
        const ZERO: Self = Self([0.0; N]);

        #[inline(always)]
        fn splat(value: f64) -> Self {
            Self([value as $number; N])
        }
        #[inline(always)]
        fn each(value: impl Fn(usize) -> f64) -> Self {
            each!(k => value(k) as $number)
        }
        #[inline(always)]
        fn splat_single(value: f32) -> Self {
            Self([<$number>::from(value); N])
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
    };
}

arithmetic!(Lane);
arithmetic!(Single);

impl<const N: usize> Lanes for Lane<N> {
    elementwise!(f64);
    const SINGLE: bool = false;
    const FAR: f64 = 1.340_780_792_994_259_6e154;
    type Number = f64;
    type Numbers = Self;

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
    fn of_halves(halves: Halves) -> f64 {
        f64::from(halves.high) + f64::from(halves.low)
    }
    #[inline(always)]
    fn numbers(value: impl Fn(usize) -> f64) -> Self {
        Self::each(value)
    }
    #[inline(always)]
    fn difference(numbers: Self, from: f64) -> Self {
        numbers - Self::splat(from)
    }
}

impl<const N: usize> Lanes for Single<N> {
    elementwise!(f32);
    const SINGLE: bool = true;
    const FAR: f64 = 1e30;
    type Number = Halves;
    type Numbers = [Self; 2];

    #[inline(always)]
    fn load(column: &[f64], slot: usize) -> Self {
        let part: &[f64; N] = column[slot..slot + N].try_into().expect("a slice of that length");
        each!(k => part[k] as f32)
    }
    #[inline(always)]
    fn of_fours(four: impl Fn(usize) -> Lane) -> Self {
        each!(k => four(k / LANES).0[k % LANES] as f32)
    }
    #[inline(always)]
    fn four(self, k: usize) -> Lane {
        Lane::each(|lane| f64::from(self.0[LANES * k + lane]))
    }
    #[inline(always)]
    fn of_halves(halves: Halves) -> Halves {
        halves
    }
    #[inline(always)]
    fn numbers(value: impl Fn(usize) -> f64) -> [Self; 2] {
        let high: Self = each!(k => value(k) as f32);
        [high, each!(k => (value(k) - f64::from(high.0[k])) as f32)]
    }
    #[inline(always)]
    fn difference([high, low]: [Self; 2], from: Halves) -> Self {
        (high - Self([from.high; N])) + (low - Self([from.low; N]))
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
    fn differences_of_singles_are_those_of_doubles() {
        // 1000.000001 and 1000 are the same number in single precision.
        let (x, y) = (1_000.000_001, 1000.0);
        assert_eq!(x as f32, y as f32);
        let apart = Single::<4>::difference(Single::<4>::numbers(|_| x), Halves::of(y));
        assert!((f64::from(apart.0[0]) - 1e-6).abs() < 1e-6 * 1e-6, "{apart:?}");
        let back = Single::<4>::difference(Single::<4>::numbers(|_| y), Halves::of(x));
        assert_eq!(back, -apart, "a pair is a pair whichever of the two is the target");
        assert_eq!(Lane::<4>::difference(Lane::splat(x), y), Lane::splat(x - y));
    }

    #[test]
    fn singles_are_stored_as_doubles() {
        let singles = Single::<8>::each(|k| k as f64);
        assert_eq!(Lanes::four(singles, 1), Lane([4.0, 5.0, 6.0, 7.0]));
        assert_eq!(Single::<8>::of_fours(|k| Lanes::four(singles, k)), singles);
        assert_eq!(Single::<4>::splat(0.1).0, [0.1_f32; 4]);
    }

    #[test]
    fn eight_are_two_fours() {
        let eight = Eight::each(|k| k as f64);
        assert_eq!(eight.four(1), Lane([4.0, 5.0, 6.0, 7.0]));
        assert_eq!(Eight::of_fours(|k| eight.four(k)), eight);
    }
}
