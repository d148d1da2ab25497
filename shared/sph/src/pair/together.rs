//! Two laws over the same pairs in one pass: distance and slope of a pair are computed once for both. [`pass_onward`]
//! runs one law over two sets of neighbours.

use super::out::{Replace, ReplaceTwo};
use super::{PairLaw, Work, run_tasks};
use crate::lane::{Arch, Isa, Lane, Lanes};
use crate::neighbours::ClusterList;

/// A law that can go along with another one, `V`, over the same pairs.
pub trait Along<V: PairLaw<D>, const D: usize>: PairLaw<D> + Copy {
    /// The law with kernel and particles of the other one, so that the compiler merges what both compute of a pair.
    fn along(&self, other: &V) -> Self;
    /// What the law needs of the targets, of what the other one loads.
    fn targets<L: Lanes>(others: &V::Target<L>) -> Self::Target<L>;
}

/// A law and one that goes along, which goes on alone over a second set of neighbours. The laws are held by value:
/// behind pointers their constants would be computed anew for each neighbour.
#[derive(Clone, Copy)]
struct Together<'a, V, W> {
    laws: Pair<V, W>,
    list: &'a ClusterList,
    more: Option<(W, &'a ClusterList)>,
}

impl<const D: usize, V: PairLaw<D> + Copy, W: Along<V, D>> Work<D> for Together<'_, V, W> {
    const WIDE: bool = Pair::<V, W>::WIDE;
    const SINGLE: bool = Pair::<V, W>::SINGLE;
    type Sum<L: Lanes> = (V::Sum<L>, W::Sum<L>);
    fn list(&self) -> &ClusterList {
        with_same_targets(self.list, self.more.map(|(_, more)| more))
    }
    #[inline(always)]
    fn gather<A: Arch, L: Lanes>(self, chunk: usize, k: usize, slot: usize, sum: &mut Self::Sum<L>) {
        (&self.laws, self.list).gather::<A, L>(chunk, k, slot, sum);
        if let Some((law, list)) = &self.more {
            (law, *list).gather::<A, L>(chunk, k, slot, &mut sum.1);
        }
    }
}

/// A law that goes on over a second set of neighbours.
#[derive(Clone, Copy)]
struct Onward<'a, W> {
    law: W,
    list: &'a ClusterList,
    more: Option<(W, &'a ClusterList)>,
}

impl<const D: usize, W: PairLaw<D> + Copy> Work<D> for Onward<'_, W> {
    const WIDE: bool = W::WIDE;
    const SINGLE: bool = W::SINGLE;
    type Sum<L: Lanes> = W::Sum<L>;
    fn list(&self) -> &ClusterList {
        with_same_targets(self.list, self.more.map(|(_, more)| more))
    }
    #[inline(always)]
    fn gather<A: Arch, L: Lanes>(self, chunk: usize, k: usize, slot: usize, sum: &mut W::Sum<L>) {
        (&self.law, self.list).gather::<A, L>(chunk, k, slot, sum);
        if let Some((law, list)) = &self.more {
            (law, *list).gather::<A, L>(chunk, k, slot, sum);
        }
    }
}

/// The first list; the second one is of the same targets.
fn with_same_targets<'a>(list: &'a ClusterList, more: Option<&ClusterList>) -> &'a ClusterList {
    let of = |list: &ClusterList| (list.fours(), list.width(), list.precision());
    assert!(more.is_none_or(|more| of(more) == of(list)), "lists of the same targets");
    list
}

/// A law and one that goes along with it.
#[derive(Clone, Copy)]
struct Pair<V, W>(V, W);

impl<const D: usize, V: PairLaw<D>, W: Along<V, D>> PairLaw<D> for Pair<V, W> {
    const WIDE: bool = V::WIDE && W::WIDE;
    const SINGLE: bool = V::SINGLE && W::SINGLE;
    type Target<L: Lanes> = V::Target<L>;
    type Sum<L: Lanes> = (V::Sum<L>, W::Sum<L>);

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.0.target_positions()
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.0.source_position(j)
    }
    #[inline(always)]
    fn source_numbers<L: Lanes>(&self, j: usize) -> [L::Number; D] {
        self.0.source_numbers::<L>(j)
    }
    #[inline(always)]
    fn skips(&self, j: usize) -> bool {
        self.0.skips(j) && self.1.skips(j)
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> V::Target<L> {
        self.0.target(slot)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, i: &V::Target<L>, j: usize, dx: [L; D], r2: L, sum: &mut Self::Sum<L>) {
        self.0.add::<A, L>(i, j, dx, r2, &mut sum.0);
        self.1.along(&self.0).add::<A, L>(&W::targets(i), j, dx, r2, &mut sum.1);
    }
}

/// Runs a law and one that goes along with it, which goes on over a second set of neighbours, if there is one. The sums
/// of the first go to `sums`, those of the second through `finish`, with the first of their slots, to two columns.
pub fn pass_together<const D: usize, V: PairLaw<D> + Copy, W: Along<V, D>, T: Send, U: Send>(
    isa: Isa,
    (law, along): (V, W),
    list: &ClusterList,
    more: Option<(W, &ClusterList)>,
    sums: &mut [V::Sum<Lane>],
    finish: impl Fn(usize, &W::Sum<Lane>) -> (T, U) + Copy + Sync,
    out: (&mut [T], &mut [U]),
) {
    let keep = Replace(|_, sum: &V::Sum<Lane>| *sum);
    let work = Together { laws: Pair(law, along), list, more };
    run_tasks(isa, work, (keep, ReplaceTwo(finish)), (sums, out));
}

/// Runs a law over its neighbours and over a second set of them, if there is one. The sums go through `finish`, with
/// the first of their slots, to two columns.
pub fn pass_onward<const D: usize, W: PairLaw<D> + Copy, T: Send, U: Send>(
    isa: Isa,
    law: W,
    list: &ClusterList,
    more: Option<(W, &ClusterList)>,
    finish: impl Fn(usize, &W::Sum<Lane>) -> (T, U) + Copy + Sync,
    out: (&mut [T], &mut [U]),
) {
    run_tasks(isa, Onward { law, list, more }, ReplaceTwo(finish), out);
}
