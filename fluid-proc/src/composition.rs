//! Which passes are compiled. Each set of shares that come together in a scene has a pass of its own, in which an
//! absent effect does not exist; the types of these passes follow from the list of effects, none is written out. A
//! share that does not ask for passes of its own ([`PairEffect::enter`]) takes part in the complete law, which asks for
//! each effect whether it is there.

use crate::equations::{Both, Equations};
use crate::rates::{FluidPair, PairEffect, PairRates};
use halfstep_sph::lane::{Arch, Lanes};

/// A pass over whatever composition it is given.
pub trait Pass<const D: usize> {
    /// What it gives; shares that do not add to it are left out.
    type Equations: Equations;
    /// Runs it.
    fn run<E: PairEffect<D>>(self, effects: E);
}

/// A composition that one share after the other enters.
pub trait Composition<const D: usize>: Sized {
    /// Goes on to passes that are compiled with this share.
    fn with<E: PairEffect<D>>(self, share: E);
    /// Ends in the complete law.
    fn complete(self);
}

/// The shares of a list of effects, `(Option<A>, (Option<B>, ()))`; `None`: absent. Taken as one effect it is the
/// complete law.
pub trait Shares<const D: usize>: PairEffect<D> {
    /// Runs the pass that is compiled for the shares that are there. `chosen` are those before; `all` is the complete
    /// law.
    fn compose<C: PairEffect<D>, A: PairEffect<D>, P: Pass<D>>(self, chosen: C, all: A, pass: P);

    /// Some share is there.
    fn any(&self) -> bool;

    /// Runs the pass that is compiled for the shares that are there, or the complete law.
    fn run(self, pass: impl Pass<D>) {
        self.compose((), self, pass);
    }

    /// The name of the composition that [`Shares::run`] chooses.
    fn composition(self) -> String {
        let mut labels = Vec::new();
        self.run(Name(&mut labels));
        if labels.is_empty() { "pressure and continuity".into() } else { labels.join(", ") }
    }
}

impl<const D: usize> Shares<D> for () {
    fn compose<C: PairEffect<D>, A: PairEffect<D>, P: Pass<D>>(self, chosen: C, _: A, pass: P) {
        pass.run(chosen);
    }
    fn any(&self) -> bool {
        false
    }
}

impl<const D: usize, E: PairEffect<D>, R: Shares<D>> Shares<D> for (Option<E>, R) {
    fn compose<C: PairEffect<D>, A: PairEffect<D>, P: Pass<D>>(self, chosen: C, all: A, pass: P) {
        let (share, rest) = self;
        if const { !adds_to::<E, P::Equations, D>() } {
            return rest.compose(chosen, all, pass);
        }
        match share {
            None => rest.compose(chosen, all, pass),
            Some(share) => share.enter(Entering { chosen, rest, all, pass }),
        }
    }
    fn any(&self) -> bool {
        self.0.is_some() || self.1.any()
    }
}

/// A share adds to what a pass gives.
const fn adds_to<E: PairEffect<D>, Q: Equations, const D: usize>() -> bool {
    E::MOMENTUM && Q::MOMENTUM || E::CONTINUITY && Q::CONTINUITY
}

/// A composition at the place of one effect of the list.
struct Entering<C, R, A, P> {
    chosen: C,
    rest: R,
    all: A,
    pass: P,
}

impl<const D: usize, C: PairEffect<D>, R: Shares<D>, A: PairEffect<D>, P: Pass<D>> Composition<D>
    for Entering<C, R, A, P>
{
    fn with<E: PairEffect<D>>(self, share: E) {
        self.rest.compose((self.chosen, share), self.all, self.pass);
    }
    fn complete(self) {
        self.pass.run(self.all);
    }
}

/// Collects the labels of a composition.
struct Name<'a>(&'a mut Vec<&'static str>);

impl<const D: usize> Pass<D> for Name<'_> {
    type Equations = Both;
    fn run<E: PairEffect<D>>(self, _: E) {
        E::labels(self.0);
    }
}

/// The share of an effect that adds nothing to a pair: there is none.
#[derive(Clone, Copy, Debug)]
pub enum NoShare {}

impl<const D: usize> PairEffect<D> for NoShare {
    type Own<L: Lanes> = ();
    fn own<L: Lanes>(&self, _: usize) {
        match *self {}
    }
    fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, _: &FluidPair<D, L>, _: &mut PairRates<D, L>) {
        match *self {}
    }
    fn enter<C: Composition<D>>(self, _: C) {
        match self {}
    }
}
