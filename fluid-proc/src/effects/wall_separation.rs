//! Water that leaves a wall which does not push is not thinned out by that wall.
//!
//! A wall shows its fluid the reversed normal velocity, in a corner the whole one. Where the water leaves, both recede
//! from each other at twice its speed, and continuity thins the water out, the more the wider the kernel: in a corner
//! of two walls to 0.7 rho0. Where the wall's pressure would be negative it shows none, so nothing holds that water
//! back either. There the wall shows continuity the water's own mean velocity v~ instead:
//!   D rho_i / Dt += rho_i sum_w m_w / rho_w (v_w - v~_w) . grad W,   p_w <= 0 and (v~_w - u_w) . n_w > 0,
//! with v_w what the wall shows to all other terms, which keep that. Solids do the same in the interface.

use super::{FluidEffect, Listed, Neighbourhood};
use crate::columns::fit;
use crate::composition::NoShare;
use crate::rates::{FluidPair, PairEffect, PairRates};
use crate::walls::Walls;
use halfstep_scene::{Decision, EffectName, Scene};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Lanes, components};
use halfstep_sph::pair::dot;
use halfstep_wire::half_step::Stage;
use rayon::prelude::*;

/// Wall particles that one task looks at.
const TASK: usize = 256;

/// The effect.
#[derive(Clone, Debug, Default)]
pub struct WallSeparation<const D: usize> {
    /// v_w - v~_w of each wall slot that water leaves, m/s; else zero.
    excess: Vec<[f64; D]>,
}

impl<const D: usize> Listed<D> for WallSeparation<D> {
    fn of(_: &Scene) -> Option<Self> {
        Some(Self::default())
    }
}

impl<const D: usize> FluidEffect<D> for WallSeparation<D> {
    const NAME: &'static str = EffectName::WallSeparation.name();
    type Pair<'a> = NoShare;
    type AtWall<'a> = Separating<'a, D>;
    fn decide(scene: &Scene) -> Decision {
        halfstep_interface::wall_separation(scene)
    }
    fn resize(&mut self, _: usize, walls: Option<&Walls<D>>) {
        fit(&mut self.excess, walls.map_or(0, Walls::slots), [0.0; D]);
    }
    fn prepare<K: Kernel<D>>(&mut self, stage: Stage, around: &Neighbourhood<'_, K, D>) -> u64 {
        if let Some((walls, _)) = around.walls.filter(|_| around.needed(stage).continuity()) {
            self.excess.par_iter_mut().with_min_len(TASK).enumerate().for_each(|(slot, excess)| {
                *excess = walls.shown_to_leaving(slot).unwrap_or([0.0; D]);
            });
        }
        0
    }
    fn at_wall(&self) -> Option<Separating<'_, D>> {
        Some(Separating(&self.excess))
    }
    fn bytes(&self) -> usize {
        self.excess.capacity() * size_of::<[f64; D]>()
    }
}

/// The share of a pair of a fluid and a wall particle.
#[derive(Clone, Copy, Debug)]
pub struct Separating<'a, const D: usize>(pub &'a [[f64; D]]);

impl<const D: usize> PairEffect<D> for Separating<'_, D> {
    type Own<L: Lanes> = ();
    const MOMENTUM: bool = false;
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), j: usize, pair: &FluidPair<D, L>, rates: &mut PairRates<D, L>) {
        let excess = components(|d| L::splat(self.0[j][d]));
        rates.density = A::mul_add(pair.density_i, dot::<D, A, L>(excess, pair.dx), rates.density);
    }
}
