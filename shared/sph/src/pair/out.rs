//! Where the sums of a pass go.

use crate::neighbours::CHUNK_FOURS;
use rayon::prelude::*;

/// Fours of targets that one task works on: of a few thousand particles the last tasks end together.
pub(super) const TASK_FOURS: usize = 32;
const _: () = assert!(CHUNK_FOURS.is_multiple_of(TASK_FOURS), "a task is of one chunk");

/// Columns with an entry for each four targets.
pub(super) trait Out: Send + Sized {
    /// Entries.
    fn fours(&self) -> usize;
    /// The part of each task.
    fn tasks(self) -> impl IndexedParallelIterator<Item = Self>;
}

impl<T: Send> Out for &mut [T] {
    fn fours(&self) -> usize {
        self.len()
    }
    fn tasks(self) -> impl IndexedParallelIterator<Item = Self> {
        self.par_chunks_mut(TASK_FOURS)
    }
}

impl<A: Out, B: Out> Out for (A, B) {
    fn fours(&self) -> usize {
        assert_eq!(self.0.fours(), self.1.fours(), "of the same targets");
        self.0.fours()
    }
    fn tasks(self) -> impl IndexedParallelIterator<Item = Self> {
        self.0.tasks().zip(self.1.tasks())
    }
}

/// What becomes of the sum over the neighbours of four targets.
pub(super) trait Sink<F, O>: Copy + Sync {
    /// What the sum of an entry begins with.
    fn begin(self, out: &O, entry: usize) -> F;
    /// Takes the sum of the targets that begin at `slot`.
    fn end(self, slot: usize, sum: F, out: &mut O, entry: usize);
}

/// The sum takes the place of what was there.
#[derive(Clone, Copy)]
pub(super) struct Replace<G>(pub G);

impl<F: Default, T: Send, G: Fn(usize, &F) -> T + Copy + Sync> Sink<F, &mut [T]> for Replace<G> {
    #[inline(always)]
    fn begin(self, _: &&mut [T], _: usize) -> F {
        F::default()
    }
    #[inline(always)]
    fn end(self, slot: usize, sum: F, out: &mut &mut [T], entry: usize) {
        out[entry] = (self.0)(slot, &sum);
    }
}

/// The sum gives an entry of two columns.
#[derive(Clone, Copy)]
pub(super) struct ReplaceTwo<G>(pub G);

impl<F: Default, T: Send, U: Send, G: Fn(usize, &F) -> (T, U) + Copy + Sync> Sink<F, (&mut [T], &mut [U])>
    for ReplaceTwo<G>
{
    #[inline(always)]
    fn begin(self, _: &(&mut [T], &mut [U]), _: usize) -> F {
        F::default()
    }
    #[inline(always)]
    fn end(self, slot: usize, sum: F, out: &mut (&mut [T], &mut [U]), entry: usize) {
        (out.0[entry], out.1[entry]) = (self.0)(slot, &sum);
    }
}

/// The sum changes what was there.
#[derive(Clone, Copy)]
pub(super) struct Change<G>(pub G);

impl<F: Default, T: Send, G: Fn(&F, &mut T) + Copy + Sync> Sink<F, &mut [T]> for Change<G> {
    #[inline(always)]
    fn begin(self, _: &&mut [T], _: usize) -> F {
        F::default()
    }
    #[inline(always)]
    fn end(self, _: usize, sum: F, out: &mut &mut [T], entry: usize) {
        (self.0)(&sum, &mut out[entry]);
    }
}

/// The sum goes on from what was there.
#[derive(Clone, Copy)]
pub(super) struct Add;

impl<F: Copy + Send> Sink<F, &mut [F]> for Add {
    #[inline(always)]
    fn begin(self, out: &&mut [F], entry: usize) -> F {
        out[entry]
    }
    #[inline(always)]
    fn end(self, _: usize, sum: F, out: &mut &mut [F], entry: usize) {
        out[entry] = sum;
    }
}

/// Each of two sums to its own columns.
impl<F, G, O, P, A: Sink<F, O>, B: Sink<G, P>> Sink<(F, G), (O, P)> for (A, B) {
    #[inline(always)]
    fn begin(self, out: &(O, P), entry: usize) -> (F, G) {
        (self.0.begin(&out.0, entry), self.1.begin(&out.1, entry))
    }
    #[inline(always)]
    fn end(self, slot: usize, sum: (F, G), out: &mut (O, P), entry: usize) {
        self.0.end(slot, sum.0, &mut out.0, entry);
        self.1.end(slot, sum.1, &mut out.1, entry);
    }
}
