//! Sums of a pass, which are stored by four targets however many are computed at once.

use crate::lane::{Lane, Lanes, components};

/// Sums of several targets, which are stored by fours; see [`pair_sum`](crate::pair_sum!).
pub trait PairSum<L>: Copy + Send {
    /// The sums of four targets.
    type Four: Copy + Send;
    /// The k-th four.
    fn four(&self, k: usize) -> Self::Four;
    /// From fours.
    fn of_fours(four: impl Fn(usize) -> Self::Four) -> Self;
    /// Of no neighbours.
    fn none() -> Self;
}

impl<L: Lanes> PairSum<L> for L {
    type Four = Lane;
    #[inline(always)]
    fn four(&self, k: usize) -> Lane {
        Lanes::four(*self, k)
    }
    #[inline(always)]
    fn of_fours(four: impl Fn(usize) -> Lane) -> Self {
        <L as Lanes>::of_fours(four)
    }
    #[inline(always)]
    fn none() -> Self {
        L::ZERO
    }
}

impl<L, S: PairSum<L>, const N: usize> PairSum<L> for [S; N] {
    type Four = [S::Four; N];
    #[inline(always)]
    fn four(&self, k: usize) -> Self::Four {
        components(|n| self[n].four(k))
    }
    #[inline(always)]
    fn of_fours(four: impl Fn(usize) -> Self::Four) -> Self {
        components(|n| S::of_fours(|k| four(k)[n]))
    }
    #[inline(always)]
    fn none() -> Self {
        components(|_| S::none())
    }
}

impl<L, S: PairSum<L>, T: PairSum<L>> PairSum<L> for (S, T) {
    type Four = (S::Four, T::Four);
    #[inline(always)]
    fn four(&self, k: usize) -> Self::Four {
        (self.0.four(k), self.1.four(k))
    }
    #[inline(always)]
    fn of_fours(four: impl Fn(usize) -> Self::Four) -> Self {
        (S::of_fours(|k| four(k).0), T::of_fours(|k| four(k).1))
    }
    #[inline(always)]
    fn none() -> Self {
        (S::none(), T::none())
    }
}

/// Makes a structure a [`PairSum`](crate::pair::PairSum): `pair_sum!(Name { constants } { fields });` for a
/// `Name<constants, L>` whose fields are sums themselves, `L` or arrays of it. Its default is that of no neighbours:
/// zeros, or with `from value` after the fields that value in each of them.
#[macro_export]
macro_rules! pair_sum {
    ($name:ident { $($constant:ident),* } { $($field:tt),+ }) => {
        $crate::pair_sum!($name { $($constant),* } { $($field),+ } from $crate::pair::PairSum::<L>::none());
    };
    ($name:ident { $($constant:ident),* } { $($field:tt),+ } from $none:expr) => {
        impl<L: $crate::lane::Lanes, $(const $constant: usize),*> $crate::pair::PairSum<L>
            for $name<$($constant,)* L>
        {
            type Four = $name<$($constant,)* $crate::lane::Lane>;
            #[inline(always)]
            fn four(&self, k: usize) -> Self::Four {
                $name { $($field: $crate::pair::PairSum::<L>::four(&self.$field, k)),+ }
            }
            #[inline(always)]
            fn of_fours(four: impl Fn(usize) -> Self::Four) -> Self {
                $name { $($field: $crate::pair::PairSum::<L>::of_fours(|k| four(k).$field)),+ }
            }
            #[inline(always)]
            fn none() -> Self {
                $name { $($field: $none),+ }
            }
        }

        impl<L: $crate::lane::Lanes, $(const $constant: usize),*> Default for $name<$($constant,)* L> {
            #[inline(always)]
            fn default() -> Self {
                $crate::pair::PairSum::<L>::none()
            }
        }
    };
}
