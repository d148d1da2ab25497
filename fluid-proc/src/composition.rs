//! Which passes are compiled. Each set of shares that come together in a scene has a pass of its own, in which an
//! absent effect does not exist; the types of these passes follow from the list of effects, none is written out. A
//! share that does not ask for passes of its own ([`PairEffect::enter`]) takes part in the complete law, which asks for
//! each effect whether it is there. The further effect of another crate comes first: where it is absent,
//! or adds nothing, the passes of this crate's list are run, which are compiled already.

use crate::equations::{Both, Equations, Needed};
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
        if const { !adds::<E, D>(P::Equations::NEEDED) } {
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

/// A share adds to what is needed.
pub(crate) const fn adds<E: PairEffect<D>, const D: usize>(needed: Needed) -> bool {
    E::MOMENTUM && needed.momentum() || E::CONTINUITY && needed.continuity()
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

/// Shares of which a pass can be run.
pub(crate) trait Runs<const D: usize> {
    /// Runs the pass that is compiled for them.
    fn run<P: Pass<D>>(self, pass: P);
}

/// The shares that are there of a list of effects.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OfList<S>(pub S);

impl<const D: usize, S: Shares<D>> Runs<D> for OfList<S> {
    fn run<P: Pass<D>>(self, pass: P) {
        self.0.run(pass);
    }
}

/// The share of a further effect that is there, before those of a list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WithList<E, S>(pub E, pub S);

impl<const D: usize, E: PairEffect<D>, S: Shares<D>> Runs<D> for WithList<E, S> {
    fn run<P: Pass<D>>(self, pass: P) {
        let Self(share, rest) = self;
        if const { adds::<E, D>(P::Equations::NEEDED) } {
            share.enter(Entering { chosen: (), rest, all: (Some(share), rest), pass });
        } else {
            unreachable!("where a share adds nothing the passes without it are run");
        }
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
    const MOMENTUM: bool = false;
    const CONTINUITY: bool = false;
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

#[cfg(test)]
#[path = "composition_tests.rs"]
mod tests;
