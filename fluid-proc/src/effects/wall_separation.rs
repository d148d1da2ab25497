//! Water that leaves a wall which does not push is not thinned out by that wall, nor drawn to it.
//!
//! A wall shows its fluid the reversed normal velocity, in a corner the whole one. Where the water leaves, both recede
//! from each other at twice its speed, and continuity thins the water out, the more the wider the kernel: in a corner
//! of two walls to 0.7 rho0. Where the wall's pressure would be negative it shows none, so nothing holds that water
//! back either. There the wall shows continuity the water's own mean velocity v~ instead:
//!   D rho_i / Dt += rho_i sum_w m_w / rho_w (v_w - v~_w) . grad W,   p_w <= 0 and (v~_w - u_w) . n_w > 0,
//! with v_w what the wall shows to all other terms, which keep that. Solids do the same in the interface. And behind
//! edges, where walls do not pull, no pair does: p_i / rho_i² + p_w / rho_w² is taken as no less than 0. A sheet of
//! water that runs over an edge is stretched: its own tension would draw it into the wall behind the edge, by more than
//! a spacing. Along a wall the pull is right: pushes alone would drive falling water off it.

use super::no_slip_continuity::NoSlipContinuity;
use super::{FluidEffect, Listed, Neighbourhood};
use crate::columns::fit;
use crate::composition::NoShare;
use crate::rates::{FluidPair, PairEffect, PairRates};
use crate::walls::Walls;
use halfstep_scene::{Decision, EffectName, Scene};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Lanes};
use halfstep_wire::half_step::Stage;
use rayon::prelude::*;

/// Wall particles that one task looks at.
const TASK: usize = 256;

/// The effect.
#[derive(Clone, Debug)]
pub struct WallSeparation<const D: usize> {
    /// v_w - v~_w of each wall slot that water leaves, m/s; else zero.
    excess: Vec<[f64; D]>,
    /// Least p_i / rho_i² + p_w / rho_w² of a pair with each wall slot.
    least: Vec<f64>,
    /// Walls do not pull.
    only_push: bool,
    /// [`NoSlipContinuity`] takes what walls without slip show along them.
    but_for_slip: bool,
}

impl<const D: usize> Listed<D> for WallSeparation<D> {
    fn of(scene: &Scene) -> Option<Self> {
        let only_push = halfstep_interface::non_negative_pressure(scene).on;
        let but_for_slip = NoSlipContinuity::<D>::decide(scene).on;
        Some(Self { excess: Vec::new(), least: Vec::new(), only_push, but_for_slip })
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
        fit(&mut self.least, walls.map_or(0, Walls::slots), f64::NEG_INFINITY);
        for (slot, least) in self.least.iter_mut().enumerate() {
            let lets_go = self.only_push && walls.is_some_and(|walls| walls.is_at_edge(slot));
            *least = if lets_go { 0.0 } else { f64::NEG_INFINITY };
        }
    }
    fn prepare<K: Kernel<D>>(&mut self, stage: Stage, around: &Neighbourhood<'_, K, D>) -> u64 {
        if let Some((walls, _)) = around.walls.filter(|_| around.needed(stage).continuity()) {
            let but_for_slip = self.but_for_slip;
            self.excess.par_iter_mut().with_min_len(TASK).enumerate().for_each(|(slot, excess)| {
                *excess = walls.shown_to_leaving(slot, but_for_slip).unwrap_or([0.0; D]);
            });
        }
        0
    }
    fn at_wall(&self) -> Option<Separating<'_, D>> {
        Some(Separating { excess: &self.excess, least: &self.least })
    }
    fn bytes(&self) -> usize {
        self.excess.capacity() * size_of::<[f64; D]>() + self.least.capacity() * size_of::<f64>()
    }
}

/// The share of a pair of a fluid and a wall particle.
#[derive(Clone, Copy, Debug)]
pub struct Separating<'a, const D: usize> {
    excess: &'a [[f64; D]],
    least: &'a [f64],
}

impl<const D: usize> PairEffect<D> for Separating<'_, D> {
    type Own<L: Lanes> = ();
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}
    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), j: usize, pair: &FluidPair<D, L>, rates: &mut PairRates<D, L>) {
        let pull = (pair.pressure_term_i + pair.pressure_term_j - L::splat(self.least[j])).min(L::ZERO);
        rates.bracket += pull;
        rates.density = A::mul_add(pair.density_i, pair.approach_by::<A>(&self.excess[j]), rates.density);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::momentum::pressure_and_continuity;
    use halfstep_sph::lane::{Fused, Lane};

    /// The bracket, pressure's and the effect's, of a pair with these p / rho².
    fn bracket(least: f64, own: f64, wall: f64) -> f64 {
        let [zero, one] = [0.0, 1.0].map(Lane::splat);
        let pair = FluidPair {
            dx: [one, zero],
            r2: one,
            dv: [zero; 2],
            approach: zero,
            density_i: one,
            density_j: one,
            density_difference: zero,
            pressure_term_i: Lane::splat(own),
            pressure_term_j: Lane::splat(wall),
        };
        let mut rates = pressure_and_continuity(&pair);
        Separating { excess: &[[0.0; 2]], least: &[least] }.add::<Fused, Lane>(&(), 0, &pair, &mut rates);
        rates.bracket.0[0]
    }

    #[test]
    fn no_pair_pulls() {
        for ([own, wall], only_push, may_pull) in [
            // Tension alone; tension that the wall's pressure outweighs, and not; pressure.
            ([-3.0, 0.0], 0.0, 3.0),
            ([-3.0, 5.0], -2.0, -2.0),
            ([-3.0, 1.0], 0.0, 2.0),
            ([2.0, 1.0], -3.0, -3.0),
        ] {
            assert_eq!(bracket(0.0, own, wall), only_push, "{own} {wall}");
            assert_eq!(bracket(f64::NEG_INFINITY, own, wall), may_pull, "{own} {wall}");
        }
    }
}
