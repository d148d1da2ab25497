//! Water that leaves a solid which does not push is not thinned out by it, as at walls: a solid that water leaves
//! recedes from it, and continuity thins the water out, the more the wider the kernel. Where s shows no pressure and
//! the water around it, in the mean at x~_s with the velocity v~_s, leaves,
//!   p_s <= 0 and (v~_s - v_s) . (x~_s - x_s) > 0,
//! s shows continuity v~_s instead of its own velocity v_s, to water that is not compressed, p_f <= 0; a thin plate
//! does so on each face by itself. Compressed water expands as it leaves: without that, water that comes and goes at a
//! body is pumped up, and lifts it.

use super::Interface;
use super::faces::{AtFaces, FaceSum, Faces, between};
use super::moving_wall::WallPressure;
use halfstep_scene::{Decision, Derived, EffectName, Phase, Scene, Treatment};
use halfstep_sph::lane::{Arch, LANES, Lanes};
use halfstep_sph::pair;
use halfstep_sph::with_kernel;

/// Whether water that leaves walls, or solids as moving walls, keeps its density.
pub fn wall_separation(scene: &Scene) -> Decision {
    let walls = scene.shapes.iter().any(|s| s.phase == Phase::Wall);
    let solids = !scene.solids.is_empty() && scene.interface.treatment == Treatment::MovingWall;
    let derived = match scene.fluid.is_some() && (walls || solids) {
        false => Derived::Impossible("no fluid at walls or solids".into()),
        true if scene.fluid.as_ref().is_some_and(|fluid| fluid.background_pressure > 0.0) => {
            Derived::Off("under fluid.background_pressure walls push wherever water leaves".into())
        }
        true if scene.has_wide_support() => Derived::On("a wide kernel thins out water that leaves".into()),
        true if scene.has_free_bodies() => {
            Derived::On("f_i that ends at dx lets water by that a free body thinned out".into())
        }
        true if solids && is_thrown(scene) => {
            Derived::On("water that is thrown at a solid leaves its edges in jets".into())
        }
        true => Derived::Off("for kernels wider than h / dx = 1.75, free bodies and thrown water".into()),
    };
    Decision::new(scene, EffectName::WallSeparation, derived)
}

/// Whether water begins with a velocity.
fn is_thrown(scene: &Scene) -> bool {
    scene.shapes.iter().any(|s| s.phase == Phase::Fluid && s.velocity != [0.0; 3])
}

/// 1 for water of no pressure, or less; else 0: what is compressed may expand.
#[inline(always)]
fn thinned<L: Lanes>(pressure_term: L) -> L {
    // So steep that no pressure which a number can tell from none lies on the slope.
    (L::splat(1.0) - pressure_term * L::splat(1e30)).max(L::ZERO).min(L::splat(1.0))
}

/// What solid particles show continuity, and the sums that it follows from.
#[derive(Clone, Debug)]
pub(super) struct Separation<const D: usize> {
    /// v~_s - v_s toward each side, m/s, by slot of the solid; zero where water does not leave.
    excess: [Vec<[f64; D]>; 2],
    sums: Vec<[FaceSum<D>; 2]>,
}

impl<const D: usize> Default for Separation<D> {
    fn default() -> Self {
        Self { excess: Default::default(), sums: Vec::new() }
    }
}

/// v~_s - v_s of the k-th solid particle on one of its sides, if water leaves it there.
fn excess<const D: usize>(around: &FaceSum<D>, k: usize, own: [f64; D]) -> Option<[f64; D]> {
    let weight = around.weight.0[k];
    if weight <= 0.0 {
        return None;
    }
    let excess: [f64; D] = std::array::from_fn(|d| around.velocity[d].0[k] / weight - own[d]);
    let toward = (0..D).map(|d| excess[d] * around.from_fluid[d].0[k]).sum::<f64>();
    (toward < 0.0).then_some(excess)
}

impl<const D: usize> Separation<D> {
    /// Finds where water leaves.
    pub(super) fn find<S: WallPressure<D> + Faces<D>>(&mut self, interface: &Interface<D>, wall: S) {
        let (p, solid) = (&interface.parameters, &interface.solid);
        self.sums.resize(interface.solid_list.fours(), Default::default());
        with_kernel!(p.kernel, p.smoothing_length, D, |kernel| {
            let law = AtFaces { kernel, fluid: &interface.fluid, solid, faces: wall };
            pair::pass(p.isa, &law, &interface.solid_list, &mut self.sums);
        });
        let slots = solid.density.len();
        for (side, excess) in self.excess.iter_mut().enumerate() {
            excess.resize(slots, [0.0; D]);
            for (slot, excess) in excess.iter_mut().enumerate() {
                let own = std::array::from_fn(|d| solid.velocity[d][slot]);
                let around = &self.sums[slot / LANES][side];
                let pushes = wall.pressure_terms(slot)[side] > 0.0;
                *excess = self::excess(around, slot % LANES, own).filter(|_| !pushes).unwrap_or([0.0; D]);
            }
        }
    }

    /// A wall that shows continuity what has been found.
    pub(super) fn shown_by<S>(&self, wall: S) -> Separating<'_, S, D> {
        Separating { wall, excess: [&self.excess[0], &self.excess[1]] }
    }
}

/// A wall that does not thin out what leaves it.
#[derive(Clone, Copy)]
pub(super) struct Separating<'a, S, const D: usize> {
    wall: S,
    excess: [&'a [[f64; D]]; 2],
}

impl<S: WallPressure<D> + Faces<D>, const D: usize> WallPressure<D> for Separating<'_, S, D> {
    type Own<L: Lanes> = <S as WallPressure<D>>::Own<L>;

    #[inline(always)]
    fn own<L: Lanes>(&self, slot: usize) -> Self::Own<L> {
        self.wall.own(slot)
    }
    #[inline(always)]
    fn of<A: Arch, L: Lanes>(&self, own: &Self::Own<L>, to_fluid: [L; D]) -> L {
        self.wall.of::<A, L>(own, to_fluid)
    }
    #[inline(always)]
    fn to<A: Arch, L: Lanes>(&self, j: usize, to_fluid: [L; D]) -> (L, L) {
        self.wall.to::<A, L>(j, to_fluid)
    }
    fn pressure_terms(&self, slot: usize) -> [f64; 2] {
        self.wall.pressure_terms(slot)
    }
    #[inline(always)]
    fn receding<A: Arch, L: Lanes>(&self, j: usize, to_fluid: [L; D], dv: [L; D], term: L) -> [L; D] {
        let thin = thinned(term);
        let share = self.wall.share_at::<A, L>(j, to_fluid);
        let [against, along] = self.excess.map(|excess| excess[j]);
        std::array::from_fn(|d| {
            let (against, along) = (L::splat(against[d]), L::splat(along[d]));
            dv[d] - thin * between::<A, L>([against, along], share)
        })
    }
}
