//! Which composition a further effect leads to.

use super::*;

macro_rules! share {
    ($name:ident, $with:ident, $continuity:literal) => {
        #[derive(Clone, Copy)]
        struct $name;
        impl PairEffect<2> for $name {
            type Own<L: Lanes> = ();
            const CONTINUITY: bool = $continuity;
            fn own<L: Lanes>(&self, _: usize) {}
            fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, _: &FluidPair<2, L>, _: &mut PairRates<2, L>) {}
            fn enter<C: Composition<2>>(self, composition: C) {
                share!($with self, composition);
            }
            fn labels(labels: &mut Vec<&'static str>) {
                labels.push(stringify!($name));
            }
        }
    };
    (with $share:expr, $composition:expr) => {
        $composition.with($share)
    };
    (complete $share:expr, $composition:expr) => {
        $composition.complete()
    };
}

share!(Listed, with, true);
share!(Entering, with, true);
share!(Plain, complete, true);
share!(Accelerating, with, false);

fn labels(shares: impl Runs<2>) -> Vec<&'static str> {
    let mut labels = Vec::new();
    shares.run(Name(&mut labels));
    labels
}

#[test]
fn a_further_share_comes_before_those_of_the_list_that_are_there() {
    let (there, absent) = ((Some(Listed), ()), (None::<Listed>, ()));
    assert_eq!(labels(OfList(there)), ["Listed"]);
    assert!(labels(OfList(absent)).is_empty());
    assert_eq!(labels(WithList(Entering, there)), ["Entering", "Listed"]);
    assert_eq!(labels(WithList(Entering, absent)), ["Entering"]);
    assert_eq!(labels(WithList(Plain, there)), ["complete law"]);
    assert_eq!(labels(WithList(Plain, absent)), ["complete law"]);
}

#[test]
fn a_share_adds_to_its_equations_alone() {
    let all = [Needed::Both, Needed::Momentum, Needed::Continuity];
    assert_eq!(all.map(adds::<Plain, 2>), [true; 3]);
    assert_eq!(all.map(adds::<Accelerating, 2>), [true, true, false]);
    assert_eq!(all.map(adds::<NoShare, 2>), [false; 3]);
}
