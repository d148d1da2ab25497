//! The one neighbour pass: every sum over neighbours in the program is a [`PairLaw`] run by [`pass`].
//!
//! Each target gathers over its own neighbours in list order, so the bits of a sum do not depend on the number of
//! threads. Several targets are computed at once; a source is broadcast to them; the kernel itself is the cut-off. What
//! the targets beside it have as neighbours adds zeros to a target's sum, so neither do the bits depend on how many are
//! computed at once.

mod fixed;
mod out;
mod sum;
mod together;
#[cfg(test)]
mod together_tests;
#[cfg(test)]
mod width_tests;

use crate::lane::{
    Arch, Eight, Fused, Isa, LANES, Lane, Lanes, Number, Precision, Single, Unfused, WIDEST, WIDEST_SINGLE,
    components,
};
use crate::neighbours::{CHUNK_FOURS, ClusterList};
pub use crate::pair_sum;
pub use fixed::{FixedLaw, FixedPairs, fixed_pass};
use out::{Add, Change, Out, Replace, Sink, TASK_FOURS};
use rayon::prelude::*;
pub use sum::PairSum;
pub use together::{Along, pass_onward, pass_together};

/// A sum over neighbours.
pub trait PairLaw<const D: usize>: Sync {
    /// As many targets are computed at once as the processor can; else four: a law with more numbers for a target than
    /// registers gains nothing by more of them. Its list is made by [`ClusterList::new`], else by
    /// [`ClusterList::narrow`].
    const WIDE: bool = true;
    /// The law can be computed in single precision: over a list of [`Precision::Mixed`] it is.
    const SINGLE: bool = false;
    /// What is loaded of the targets before their neighbours are visited.
    type Target<L: Lanes>: Copy;
    /// What is summed up for the targets.
    type Sum<L: Lanes>: PairSum<L, Four = Self::Sum<Lane>> + Default;

    /// Positions of the targets.
    fn target_positions(&self) -> &[Vec<f64>; D];
    /// Position of source `j`.
    fn source_position(&self, j: usize) -> [f64; D];
    /// The same as the lanes have it.
    #[inline(always)]
    fn source_numbers<L: Lanes>(&self, j: usize) -> [L::Number; D] {
        let position = self.source_position(j);
        components(|d| L::Number::of(position[d]))
    }
    /// Source `j` adds nothing that counts, to any target: its distances are not computed.
    #[inline(always)]
    fn skips(&self, _j: usize) -> bool {
        false
    }
    /// Loads what else is needed of the targets from `slot` on.
    fn target<L: Lanes>(&self, slot: usize) -> Self::Target<L>;
    /// Adds the contribution of source `j`: `dx` = x_i - x_j, `r2` = |dx|².
    fn add<A: Arch, L: Lanes>(
        &self,
        target: &Self::Target<L>,
        j: usize,
        dx: [L; D],
        r2: L,
        sum: &mut Self::Sum<L>,
    );
}

/// A law that computes four targets at once, over a list that others like it use.
pub struct Narrow<W>(pub W);

impl<const D: usize, W: PairLaw<D>> PairLaw<D> for Narrow<W> {
    const WIDE: bool = false;
    type Target<L: Lanes> = W::Target<L>;
    type Sum<L: Lanes> = W::Sum<L>;

    #[inline(always)]
    fn target_positions(&self) -> &[Vec<f64>; D] {
        self.0.target_positions()
    }
    #[inline(always)]
    fn source_position(&self, j: usize) -> [f64; D] {
        self.0.source_position(j)
    }
    #[inline(always)]
    fn skips(&self, j: usize) -> bool {
        self.0.skips(j)
    }
    #[inline(always)]
    fn target<L: Lanes>(&self, slot: usize) -> W::Target<L> {
        self.0.target(slot)
    }
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, i: &W::Target<L>, j: usize, dx: [L; D], r2: L, sum: &mut W::Sum<L>) {
        self.0.add::<A, L>(i, j, dx, r2, sum);
    }
}

/// A law with the list of its pairs, or several laws and lists in one pass.
trait Work<const D: usize>: Copy + Sync {
    /// See [`PairLaw::WIDE`].
    const WIDE: bool;
    /// See [`PairLaw::SINGLE`].
    const SINGLE: bool;
    /// What is summed up.
    type Sum<L: Lanes>: PairSum<L, Four = Self::Sum<Lane>> + Default;
    /// The list.
    fn list(&self) -> &ClusterList;
    /// Adds up the neighbours of the cluster number `k` of a chunk, whose targets begin at `slot`.
    fn gather<A: Arch, L: Lanes>(self, chunk: usize, k: usize, slot: usize, sum: &mut Self::Sum<L>);
}

impl<const D: usize, W: PairLaw<D>> Work<D> for (&W, &ClusterList) {
    const WIDE: bool = W::WIDE;
    const SINGLE: bool = W::SINGLE;
    type Sum<L: Lanes> = W::Sum<L>;
    fn list(&self) -> &ClusterList {
        self.1
    }
    #[inline(always)]
    fn gather<A: Arch, L: Lanes>(self, chunk: usize, k: usize, slot: usize, sum: &mut W::Sum<L>) {
        let (law, list) = self;
        let neighbours = list.chunks()[chunk].of(k);
        if neighbours.len() == 0 {
            return;
        }
        let positions = law.target_positions();
        // By way of memory: of a vector put together from scalars the compiler keeps some apart through the whole loop,
        // and one that ends in fours it computes by fours.
        let target = std::hint::black_box(law.target::<L>(slot));
        let xi: [L::Numbers; D] =
            std::hint::black_box(components(|d| L::numbers(|k| positions[d][slot + k])));
        let mut total = *sum;
        for j in neighbours {
            if law.skips(j) {
                continue;
            }
            let xj = law.source_numbers::<L>(j);
            let mut dx = [L::ZERO; D];
            let mut r2 = L::ZERO;
            for d in 0..D {
                dx[d] = L::difference(xi[d], xj[d]);
                r2 = if d == 0 { dx[d] * dx[d] } else { A::mul_add(dx[d], dx[d], r2) };
            }
            law.add::<A, L>(&target, j, dx, r2, &mut total);
        }
        *sum = std::hint::black_box(total);
    }
}

/// Runs a law over all targets of a list; `sums` has one entry for each four of them.
pub fn pass<const D: usize, W: PairLaw<D>>(isa: Isa, law: &W, list: &ClusterList, sums: &mut [W::Sum<Lane>]) {
    run_tasks(isa, (law, list), Replace(|_, sum: &W::Sum<Lane>| *sum), sums);
}

/// The pass, adding to what `sums` holds.
pub fn pass_adding<const D: usize, W: PairLaw<D>>(
    isa: Isa,
    law: &W,
    list: &ClusterList,
    sums: &mut [W::Sum<Lane>],
) {
    run_tasks(isa, (law, list), Add, sums);
}

/// The pass; the sum of each four goes through `finish`, with the first of its slots, before it is stored.
pub fn pass_into<const D: usize, W: PairLaw<D>, T: Send>(
    isa: Isa,
    law: &W,
    list: &ClusterList,
    finish: impl Fn(usize, &W::Sum<Lane>) -> T + Copy + Sync,
    out: &mut [T],
) {
    run_tasks(isa, (law, list), Replace(finish), out);
}

/// The pass; the sum of each four changes what is in `out`.
pub fn pass_changing<const D: usize, W: PairLaw<D>, T: Send>(
    isa: Isa,
    law: &W,
    list: &ClusterList,
    change: impl Fn(&W::Sum<Lane>, &mut T) + Copy + Sync,
    out: &mut [T],
) {
    run_tasks(isa, (law, list), Change(change), out);
}

fn run_tasks<const D: usize, W: Work<D>, O: Out, S: Sink<W::Sum<Lane>, O>>(
    isa: Isa,
    work: W,
    sink: S,
    out: O,
) {
    let list = work.list();
    assert_eq!(out.fours(), list.fours(), "one sum for each four targets");
    // Never more than the processor has: that is what makes the calls below safe.
    let isa = isa.min(Isa::detect());
    let precision = list.precision();
    assert!(W::SINGLE || precision == Precision::Double, "a law that can be computed in single precision");
    let width = if W::WIDE { isa.targets(precision) } else { LANES };
    assert_eq!(list.width(), width, "the list's clusters are as wide as the passes");
    match out.fours() {
        0 => (),
        1..=TASK_FOURS => run_task(isa, precision, work, 0, sink, out),
        _ => {
            let tasks = out.tasks().enumerate();
            tasks.for_each(|(task, part)| run_task(isa, precision, work, task, sink, part));
        }
    }
}

fn run_task<const D: usize, W: Work<D>, O: Out, S: Sink<W::Sum<Lane>, O>>(
    isa: Isa,
    precision: Precision,
    work: W,
    task: usize,
    sink: S,
    out: O,
) {
    if W::SINGLE && precision == Precision::Mixed {
        return match isa {
            // SAFETY: `run_tasks` asked the processor.
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512vl => unsafe {
                run_avx512::<D, W, O, S, Single<WIDEST_SINGLE>>(work, task, sink, out)
            },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => unsafe { run_avx2::<D, W, O, S, Single<WIDEST>>(work, task, sink, out) },
            _ => run::<D, W, O, S, Unfused, Single<LANES>>(work, task, sink, out),
        };
    }
    match isa {
        // SAFETY: `run_tasks` asked the processor.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512vl if W::WIDE => unsafe { run_avx512::<D, W, O, S, Eight>(work, task, sink, out) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512vl => unsafe { run_avx512::<D, W, O, S, Lane>(work, task, sink, out) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => unsafe { run_avx2::<D, W, O, S, Lane>(work, task, sink, out) },
        _ => run::<D, W, O, S, Unfused, Lane>(work, task, sink, out),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,fma")]
unsafe fn run_avx512<const D: usize, W: Work<D>, O: Out, S: Sink<W::Sum<Lane>, O>, L: Lanes>(
    work: W,
    task: usize,
    sink: S,
    out: O,
) {
    run::<D, W, O, S, Fused, L>(work, task, sink, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn run_avx2<const D: usize, W: Work<D>, O: Out, S: Sink<W::Sum<Lane>, O>, L: Lanes>(
    work: W,
    task: usize,
    sink: S,
    out: O,
) {
    run::<D, W, O, S, Fused, L>(work, task, sink, out);
}

#[inline(always)]
fn run<const D: usize, W: Work<D>, O: Out, S: Sink<W::Sum<Lane>, O>, A: Arch, L: Lanes>(
    work: W,
    task: usize,
    sink: S,
    mut out: O,
) {
    let (chunk, part) = (task / (CHUNK_FOURS / TASK_FOURS), task % (CHUNK_FOURS / TASK_FOURS));
    let fours = L::TARGETS / LANES;
    let first = part * TASK_FOURS / fours;
    for k in 0..out.fours() / fours {
        let slot = task * TASK_FOURS * LANES + k * L::TARGETS;
        let mut sum = W::Sum::<L>::of_fours(|four| sink.begin(&out, k * fours + four));
        work.gather::<A, L>(chunk, first + k, slot, &mut sum);
        for four in 0..fours {
            sink.end(slot + four * LANES, sum.four(four), &mut out, k * fours + four);
        }
    }
}

/// A distance from its square that is never zero: a pair at one place (a particle with itself, or two coincident ones)
/// has finite kernel slopes and, as x_ij = 0, no force.
#[inline(always)]
pub fn distance<L: Lanes>(r2: L, smoothing_length: f64) -> L {
    (r2 + L::splat(1e-12 * smoothing_length * smoothing_length)).sqrt()
}

/// Scalar products of two vectors for each target.
#[inline(always)]
pub fn dot<const D: usize, A: Arch, L: Lanes>(a: [L; D], b: [L; D]) -> L {
    let mut sum = a[0] * b[0];
    for d in 1..D {
        sum = A::mul_add(a[d], b[d], sum);
    }
    sum
}
