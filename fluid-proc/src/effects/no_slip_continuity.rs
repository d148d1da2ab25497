//! Walls without slip show the fluid's mean velocity reversed as a whole, which viscous stress needs. To continuity its
//! tangential part is noise: along a wall particles approach and leave each other's places, and none of it compresses
//! water. So continuity sees a wall that lets slip (Marrone, Colagrossi, Antuono, Colicchio and Graziani 2013):
//!   D rho_i / Dt += rho_i sum_w m_w / rho_w (v_w - v'_w) . grad W,
//! with v_w what the wall shows to all other terms and v'_w what it would show with slip. In corners, where walls that
//! let slip reverse the whole velocity, too, nothing changes.

use super::{FluidEffect, Listed, Neighbourhood};
use crate::columns::fit;
use crate::composition::NoShare;
use crate::rates::{FluidPair, PairEffect, PairRates};
use crate::walls::Walls;
use halfstep_scene::{Decision, Derived, EffectName, Phase, Scene, Shape};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Lanes};
use halfstep_wire::half_step::Stage;

/// The effect.
#[derive(Clone, Debug, Default)]
pub struct NoSlipContinuity<const D: usize> {
    /// v_w - v'_w of each wall slot, m/s.
    excess: Vec<[f64; D]>,
}

impl<const D: usize> Listed<D> for NoSlipContinuity<D> {
    fn of(_: &Scene) -> Option<Self> {
        Some(Self::default())
    }
}

impl<const D: usize> FluidEffect<D> for NoSlipContinuity<D> {
    const NAME: &'static str = EffectName::NoSlipContinuity.name();
    type Pair<'a> = NoShare;
    type AtWall<'a> = Tangential<'a, D>;
    fn decide(scene: &Scene) -> Decision {
        let without_slip = |shape: &Shape| shape.phase == Phase::Wall && !shape.free_slip;
        let derived = match scene.fluid.is_some() && scene.shapes.iter().any(without_slip) {
            false => Derived::Impossible("no fluid at a wall without slip".into()),
            true => Derived::On("along walls without slip nothing is compressed".into()),
        };
        Decision::new(scene, EffectName::NoSlipContinuity, derived)
    }
    fn resize(&mut self, _: usize, walls: Option<&Walls<D>>) {
        fit(&mut self.excess, walls.map_or(0, Walls::slots), [0.0; D]);
    }
    fn prepare<K: Kernel<D>>(&mut self, stage: Stage, around: &Neighbourhood<'_, K, D>) -> u64 {
        if let Some((walls, _)) = around.walls.filter(|_| around.needed(stage).continuity()) {
            walls.beyond_slip(&mut self.excess);
        }
        0
    }
    fn at_wall(&self) -> Option<Tangential<'_, D>> {
        Some(Tangential(&self.excess))
    }
    fn bytes(&self) -> usize {
        self.excess.capacity() * size_of::<[f64; D]>()
    }
}

/// The share of a pair of a fluid and a wall particle: v_w - v'_w by wall slots, m/s.
#[derive(Clone, Copy, Debug)]
pub struct Tangential<'a, const D: usize>(&'a [[f64; D]]);

impl<const D: usize> PairEffect<D> for Tangential<'_, D> {
    type Own<L: Lanes> = ();
    const MOMENTUM: bool = false;
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), j: usize, pair: &FluidPair<D, L>, rates: &mut PairRates<D, L>) {
        rates.density = A::mul_add(pair.density_i, pair.approach_by::<A>(&self.0[j]), rates.density);
    }
}
