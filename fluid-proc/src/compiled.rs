//! The entries to the passes over fluid and walls. Those of a fluid without a further effect are compiled once for all
//! programs, in this crate; as generic functions they would be compiled again in each crate that calls them.

use crate::composition::{NoShare, OfList};
use crate::effects::{Effects, FluidEffect, Standard};
use crate::equations::Needed;
use crate::fluid::Fluid;
use crate::passes::{self, FluidAndWalls};
use crate::rates::RateSum;
use crate::shifting_sums::ShiftingSums;
use halfstep_role::role::{Costs, Peer};
use halfstep_scene::{Decision, FluidIntegration, Scene, dispatch};
use halfstep_sph::with_kernel;
use halfstep_wire::half_step::Stage;
use halfstep_wire::protocol::StateRecord;
use std::any::Any;

/// The passes of a fluid with a further effect `X`, as functions.
#[derive(Clone, Copy, Debug)]
pub struct Passes<const D: usize, X: FluidEffect<D>> {
    /// The sums over fluid and walls at a stage.
    pub(crate) own_sums: fn(&mut Fluid<D, X>),
    /// Position Verlet, after the sums over the peers: wall rates at predicted velocities, and the ledger's powers.
    pub(crate) sums_after_peers: fn(&mut Fluid<D, X>, &[StateRecord], &[Peer]),
    /// What each effect takes of the time.
    pub(crate) costs: fn(&mut Fluid<D, X>) -> Costs,
    /// Force of the fluid on each slot of the walls, N (2D: N/m).
    pub(crate) wall_loads: fn(&Fluid<D, X>) -> Vec<[f64; D]>,
}

impl<const D: usize, X: FluidEffect<D>> Passes<D, X> {
    /// Compiled in the crate that names `X`.
    pub(crate) const fn compiled() -> Self {
        Self { own_sums, sums_after_peers, costs, wall_loads }
    }
}

fn own_sums<const D: usize, X: FluidEffect<D>>(fluid: &mut Fluid<D, X>) {
    with_kernel!(fluid.kernel, fluid.smoothing_length, D, |kernel| {
        fluid.sums(kernel);
        if fluid.stage == Stage::Second && fluid.integration == FluidIntegration::Midpoint {
            fluid.measure_powers(kernel);
        }
        if fluid.stage == Stage::Second && fluid.predicts_alone() {
            fluid.predicted_rates(kernel);
        }
    });
}

fn sums_after_peers<const D: usize, X: FluidEffect<D>>(
    fluid: &mut Fluid<D, X>,
    own: &[StateRecord],
    peers: &[Peer],
) {
    with_kernel!(fluid.kernel, fluid.smoothing_length, D, |kernel| {
        if !fluid.predicts_alone() {
            fluid.predicted_rates(kernel);
        }
        fluid.measure_powers_by_means(kernel, own, peers);
    });
}

fn costs<const D: usize, X: FluidEffect<D>>(fluid: &mut Fluid<D, X>) -> Costs {
    let before = fluid.pair_evaluations;
    let costs = with_kernel!(fluid.kernel, fluid.smoothing_length, D, |kernel| fluid.measured_costs(kernel));
    fluid.pair_evaluations = before;
    costs
}

fn wall_loads<const D: usize, X: FluidEffect<D>>(fluid: &Fluid<D, X>) -> Vec<[f64; D]> {
    with_kernel!(fluid.kernel, fluid.smoothing_length, D, |kernel| fluid.loads(kernel))
}

/// The passes of the rates by the list alone. A fluid with a further effect runs them where that adds nothing.
pub(crate) struct StandardPasses<const D: usize> {
    /// See [`passes::rates`].
    pub(crate) rates: for<'a> fn(
        FluidAndWalls<'a, D>,
        Needed,
        <Standard<D> as Effects<D>>::Pairs<'a>,
        Option<&'a mut ShiftingSums<D>>,
        &'a mut [RateSum<D>],
    ),
    /// See [`passes::wall_rates`].
    pub(crate) wall_rates: for<'a> fn(
        FluidAndWalls<'a, D>,
        Needed,
        <Standard<D> as Effects<D>>::AtWalls<'a>,
        &'a mut [RateSum<D>],
    ),
}

impl<const D: usize> StandardPasses<D> {
    /// Those compiled in this crate.
    pub(crate) fn get() -> &'static Self {
        here(D).and_then(|here| here.standard.downcast_ref()).expect(DIMENSION)
    }

    const fn compiled() -> Self {
        Self {
            rates: |particles, needed, shares, shifting, sums| {
                passes::rates(particles, needed, OfList(shares), shifting, sums);
            },
            wall_rates: |particles, needed, shares, sums| {
                passes::wall_rates(particles, needed, OfList(shares), sums);
            },
        }
    }
}

/// What is compiled in this crate for a dimension D.
struct Here {
    /// `Passes<D, ()>`.
    passes: &'static dyn Any,
    /// `StandardPasses<D>`.
    standard: &'static dyn Any,
}

/// Holds for each fluid that was made.
const DIMENSION: &str = "a dimension that scenes have";

/// Passes are compiled for a dimension.
pub(crate) fn has(dimension: usize) -> bool {
    here(dimension).is_some()
}

// Neither generic nor inlined: else the passes would be compiled where it is called.
#[inline(never)]
fn here(dimension: usize) -> Option<Here> {
    dispatch!(dimension, D => {
        static PASSES: Passes<D, ()> = Passes::compiled();
        static STANDARD: StandardPasses<D> = StandardPasses::compiled();
        Here { passes: &PASSES, standard: &STANDARD }
    })
}

/// No effect beside those of the list.
impl<const D: usize> FluidEffect<D> for () {
    const NAME: &'static str = "none";
    type Pair<'a> = NoShare;
    type AtWall<'a> = NoShare;
    fn decide(_: &Scene) -> Decision {
        Decision { name: "none", on: false, why: "no further effect".into() }
    }
    fn passes() -> Passes<D, Self> {
        *here(D).and_then(|here| here.passes.downcast_ref()).expect(DIMENSION)
    }
}
