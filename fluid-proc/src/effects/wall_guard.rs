//! Artificial viscosity between fluid and walls, and the wall guard.
//!
//! Between fluid and wall the same Pi_ij acts as between fluid particles (Kayaki's eq. 23), with the velocity that the
//! wall shows. The guard raises its A to 32 between a wall and what is close to it: fully below 0.6 dx,
//! fading to the scene's A at 0.8 dx. What the cross-phase f_i is between fluid and solid, it is here: without it
//! single particles of a thin film sink into the wall by up to 1.7 dx before their pressure stops them.
//!
//! Its reach is its price. A wall shows the mean tangential velocity of the water within 2h, so a stream that stretches
//! or thins along the wall approaches some of the wall's particles, and a guard over all of 2h brakes it: like a
//! boundary layer. Corners reverse the whole velocity and keep the scene's A: a guard would be friction. So would it be
//! at walls without slip by what they show; there the guard sees the velocity that they would show with slip, as
//! continuity does ([`super::no_slip_continuity`]), and is there where that effect is.
//!
//! So short a reach has to stop a particle within a few steps: at a rate k with k dt > 2, which the midpoint rule
//! cannot take. The guard divides it by 1 + k dt at the first stage and by 1 + k dt / 2 at the second. Then a pair
//! whose partner keeps its velocity approaches after the step 1 / (1 + k dt) times as fast as before: as by the
//! implicit Euler rule, whatever k. A wall that mirrors doubles the rate: 1 - 2 k dt / ((1 + k dt) (1 + k dt / 2)) of
//! the approach is left.
//!
//! Position Verlet has accelerations at one stage only. There the guard comes last, with the velocity v_n + dt a that
//! all others lead to (but what answers the interface), divided by 1 + k dt: (v_n + dt a) / (1 + k dt) is left of an
//! approach to a partner that keeps its velocity, as by the implicit Euler rule. With v_n alone, what pushes a particle
//! into the wall went unopposed for a step.

use super::artificial_viscosity::ArtificialViscosity;
use super::no_slip_continuity::NoSlipContinuity;
use super::{FluidEffect, Listed, Neighbourhood};
use crate::columns::fit;
use crate::composition::{Composition, NoShare};
use crate::rates::{FluidPair, PairEffect, PairRates};
use crate::walls::Walls;
use halfstep_scene::{Decision, Derived, EffectName, FluidIntegration, Phase, Scene};
use halfstep_sph::fade::Fade;
use halfstep_sph::kernel::Kernel;
use halfstep_sph::lane::{Arch, Lane, Lanes, Unfused};
use halfstep_wire::half_step::Stage;

/// A of the guard.
const STRENGTH: f64 = 32.0;
/// Up to where the guard is whole, and from where on there is none, over the spacing. With 0.5 and 0.75 films come
/// into walls by 0.3 dx; with 0.75 and 0.85 the pressure where a dam break meets a wall is 6 % lower.
const REACH: [f64; 2] = [0.6, 0.8];
/// Distance over the spacing at which k takes the kernel's slope: hardly anything comes nearer.
const NEAR: f64 = 0.25;
/// The same by position Verlet, with one evaluation and longer steps: so near that nowhere more than the whole approach
/// is taken, up to a Courant number of 1.
const NEAR_BY_VERLET: f64 = 0.15;

/// The effect.
#[derive(Clone, Debug)]
pub struct WallGuard<const D: usize> {
    smoothing_length: f64,
    fade: Fade,
    /// cfl h² A V of the guard, with the Courant limit's dt = cfl h / c0: times |F| it is k dt.
    rate: f64,
    /// k dt at the first stage, and where one stage has all accelerations; else k dt / 2.
    divisor: f64,
    /// Distance at which k takes the kernel's slope, m.
    near: f64,
    /// A c0 far from walls and in corners, m/s.
    plain: f64,
    /// What a close wall adds to it, m/s.
    guard: f64,
    quadratic: f64,
    /// What each wall slot adds, m/s.
    added: Vec<f64>,
    /// Velocity that each slot of a wall without slip shows beyond that of one with slip, m/s; empty where none sticks.
    beyond_slip: Vec<[f64; D]>,
    /// There are walls without slip that are guarded.
    sticky: bool,
    /// How the fluid goes from n to n + 1.
    integration: FluidIntegration,
}

impl<const D: usize> Listed<D> for WallGuard<D> {
    fn of(scene: &Scene) -> Option<Self> {
        let fluid = scene.fluid.as_ref()?;
        let acts = f64::from(u8::from(ArtificialViscosity::<D>::decide(scene).on));
        let plain = acts * fluid.artificial_viscosity.linear;
        let (dx, c0) = (scene.resolution, fluid.sound_speed);
        let h = scene.smoothing_ratio * dx;
        Some(Self {
            smoothing_length: h,
            fade: Fade::new(REACH[0] * dx, REACH[1] * dx),
            rate: scene.numerics.cfl * h * h * STRENGTH * dx.powi(D as i32),
            divisor: 0.0,
            near: dx
                * match fluid.time_integration {
                    FluidIntegration::Midpoint => NEAR,
                    FluidIntegration::Verlet => NEAR_BY_VERLET,
                },
            plain: plain * c0,
            guard: (STRENGTH - plain).max(0.0) * c0,
            quadratic: acts * fluid.artificial_viscosity.quadratic,
            added: Vec::new(),
            beyond_slip: Vec::new(),
            sticky: NoSlipContinuity::<D>::decide(scene).on,
            integration: fluid.time_integration,
        })
    }
}

impl<const D: usize> WallGuard<D> {
    /// Sets the divisor of a stage.
    fn divide<K: Kernel<D>>(&mut self, stage: Stage, kernel: &K) {
        let slope = -kernel.gradient_over_r::<Unfused, Lane>(Lane::splat(self.near)).0[0];
        let part = match (self.integration, stage) {
            (FluidIntegration::Midpoint, Stage::Second) => 0.5,
            (FluidIntegration::Midpoint, Stage::First) | (FluidIntegration::Verlet, _) => 1.0,
        };
        self.divisor = part * self.rate * slope;
    }

    fn share(&self) -> GuardedViscosity<'_, D> {
        let Self { smoothing_length, fade, divisor, plain, quadratic, added, beyond_slip, .. } = self;
        GuardedViscosity {
            smoothing_length: *smoothing_length,
            fade: *fade,
            divisor: *divisor,
            plain: *plain,
            added,
            beyond_slip,
            quadratic: *quadratic,
        }
    }
}

impl<const D: usize> FluidEffect<D> for WallGuard<D> {
    const NAME: &'static str = EffectName::WallGuard.name();
    type Pair<'a> = NoShare;
    type AtWall<'a> = GuardedViscosity<'a, D>;
    fn decide(scene: &Scene) -> Decision {
        let sticky = NoSlipContinuity::<D>::decide(scene).on;
        let derived = match &scene.fluid {
            None => Derived::Impossible("the scene has no fluid".into()),
            Some(_) if !scene.shapes.iter().any(|s| s.phase == Phase::Wall && (s.free_slip || sticky)) => {
                Derived::Impossible("no walls that it could guard".into())
            }
            Some(fluid) if fluid.artificial_viscosity.linear >= STRENGTH => {
                Derived::Impossible(format!("A is {STRENGTH} or more everywhere"))
            }
            Some(_) => Derived::On("keeps single particles out of walls".into()),
        };
        Decision::new(scene, EffectName::WallGuard, derived)
    }
    fn resize(&mut self, _: usize, walls: Option<&Walls<D>>) {
        let Some(walls) = walls else { return };
        fit(&mut self.added, walls.slots(), 0.0);
        for (slot, added) in self.added.iter_mut().enumerate() {
            let guarded = !walls.reverses_all(slot) || self.sticky && walls.sticks(slot);
            *added = if guarded { self.guard } else { 0.0 };
        }
        if self.sticky {
            fit(&mut self.beyond_slip, walls.slots(), [0.0; D]);
        }
    }
    fn prepare<K: Kernel<D>>(&mut self, stage: Stage, around: &Neighbourhood<'_, K, D>) -> u64 {
        self.divide(stage, &around.kernel);
        if let Some((walls, _)) = around.walls.filter(|_| around.needed(stage).momentum()) {
            walls.beyond_slip(&mut self.beyond_slip);
        }
        0
    }
    fn at_wall(&self) -> Option<GuardedViscosity<'_, D>> {
        (self.integration == FluidIntegration::Midpoint).then(|| self.share())
    }
    fn at_wall_predicted(&self) -> Option<GuardedViscosity<'_, D>> {
        (self.integration == FluidIntegration::Verlet).then(|| self.share())
    }
    fn bytes(&self) -> usize {
        self.added.capacity() * size_of::<f64>() + self.beyond_slip.capacity() * size_of::<[f64; D]>()
    }
}

/// The share of a pair of a fluid and a wall particle.
#[derive(Clone, Copy, Debug)]
pub struct GuardedViscosity<'a, const D: usize> {
    smoothing_length: f64,
    fade: Fade,
    divisor: f64,
    /// A c0 far from walls, m/s.
    plain: f64,
    /// What each wall slot adds where it is close, m/s.
    added: &'a [f64],
    /// What walls without slip show beyond those with slip, m/s.
    beyond_slip: &'a [[f64; D]],
    quadratic: f64,
}

impl<const D: usize> PairEffect<D> for GuardedViscosity<'_, D> {
    type Own<L: Lanes> = ();
    const CONTINUITY: bool = false;
    #[inline(always)]
    fn own<L: Lanes>(&self, _: usize) {}

    #[inline(always)]
    fn add<A: Arch, L: Lanes>(&self, _: &(), j: usize, pair: &FluidPair<D, L>, rates: &mut PairRates<D, L>) {
        let near = self.fade.at(pair.r2.sqrt());
        // k is that of Pi_ij: it falls with s = r² + 0.01 h².
        let s = pair.r2 + L::splat(0.01 * self.smoothing_length * self.smoothing_length);
        let damped = L::splat(self.added[j]) * near * s / (s + L::splat(self.divisor) * near * pair.r2);
        let plain = L::splat(self.plain);
        let h = self.smoothing_length;
        match self.beyond_slip.get(j) {
            Some(excess) if *excess != [0.0; D] => {
                let approach = pair.approach + pair.approach_by::<A>(excess);
                let with_slip = FluidPair { approach, ..*pair };
                rates.bracket = rates.bracket
                    - (pair.damping::<A>(h, plain, self.quadratic) + with_slip.damping::<A>(h, damped, 0.0));
            }
            _ => rates.bracket = rates.bracket - pair.damping::<A>(h, damped + plain, self.quadratic),
        }
    }
    fn enter<C: Composition<D>>(self, composition: C) {
        composition.with(self);
    }
    fn labels(labels: &mut Vec<&'static str>) {
        labels.push("guarded artificial viscosity");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fluid_tests::tank;
    use halfstep_sph::kernel::CubicSpline;
    use halfstep_sph::lane::Fused;

    const DX: f64 = 0.01;
    /// Of the scene's kernel: h / dx = 2 where water is alone.
    const H: f64 = 2.0 * DX;
    const RHO: f64 = 1000.0;

    fn guard() -> WallGuard<2> {
        guard_with(&[])
    }

    fn guard_with(more: &[&str]) -> WallGuard<2> {
        let scene = tank(&[&["effects.artificial-viscosity=\"off\""], more].concat());
        let mut guard = WallGuard::of(&scene).expect("a fluid");
        guard.added = vec![guard.guard];
        guard
    }

    /// Deceleration over the speed, 1/s, of a particle that comes straight at a wall particle from a distance, m.
    fn rate(guard: &WallGuard<2>, r: f64) -> f64 {
        let [zero, one] = [0.0, 1.0].map(Lane::splat);
        let pair = FluidPair {
            dx: [Lane::splat(r), zero],
            r2: Lane::splat(r * r),
            dv: [-one, zero],
            approach: Lane::splat(-r),
            density_i: Lane::splat(RHO),
            density_j: Lane::splat(RHO),
            density_difference: zero,
            pressure_term_i: zero,
            pressure_term_j: zero,
        };
        let mut rates = PairRates::ZERO;
        guard.share().add::<Fused, Lane>(&(), 0, &pair, &mut rates);
        let f = CubicSpline::<2>::new(H).gradient_over_r::<Unfused, Lane>(Lane::splat(r)).0[0];
        RHO * DX * DX * f * rates.bracket.0[0] * r
    }

    /// k = A c0 h V |F| r / (r² + 0.01 h²) times r, with A = 32, c0 = 20 m/s: that of Monaghan's Pi_ij on one side.
    fn undivided(r: f64) -> f64 {
        let f = CubicSpline::<2>::new(H).gradient_over_r::<Unfused, Lane>(Lane::splat(r)).0[0];
        32.0 * 20.0 * H * DX * DX * -f * r * r / (r * r + 0.01 * H * H)
    }

    #[test]
    fn it_is_whole_below_06_dx_half_at_07_and_gone_at_08() {
        let mut guard = guard();
        guard.divisor = 0.0;
        for (r, part) in [(0.3, 1.0), (0.6, 1.0), (0.7, 0.5), (0.8, 0.0), (1.0, 0.0)] {
            let (found, expected) = (rate(&guard, r * DX), part * undivided(r * DX));
            assert!((found - expected).abs() <= 1e-9 * undivided(r * DX), "{r}: {found} {expected}");
        }
    }

    /// A midpoint step of the Courant number's length: as by the implicit Euler rule beside a partner that keeps its
    /// velocity; beside a wall that mirrors, which doubles the rate, by what the head of this file says.
    #[test]
    fn a_step_leaves_what_the_implicit_rule_leaves() {
        let kernel = CubicSpline::<2>::new(H);
        // The distance at which the divisors are exact.
        let r = NEAR * DX;
        let k_dt = undivided(r) * 0.4 * H / 20.0;
        assert!(k_dt > 2.0, "{k_dt}: the midpoint rule alone would bear it");
        for (mirrored, expected) in
            [(1.0, 1.0 / (1.0 + k_dt)), (2.0, 1.0 - 2.0 * k_dt / ((1.0 + k_dt) * (1.0 + 0.5 * k_dt)))]
        {
            let mut guard = guard_with(&["fluid.time_integration=\"midpoint\""]);
            let dt = 0.4 * H / 20.0;
            guard.divide(Stage::First, &kernel);
            let half = 1.0 - 0.5 * dt * mirrored * rate(&guard, r);
            guard.divide(Stage::Second, &kernel);
            let left = 1.0 - dt * mirrored * rate(&guard, r) * half;
            assert!((left - expected).abs() < 1e-9, "{mirrored}: {left} {expected}");
        }
    }

    /// Position Verlet: of the approach that is predicted the implicit Euler rule's part is left beside a partner that
    /// keeps its velocity, and nowhere less than none: a guard that turned it round could feed energy in.
    #[test]
    fn a_step_by_verlet_leaves_what_the_implicit_rule_leaves() {
        let kernel = CubicSpline::<2>::new(H);
        for cfl in [0.4, 0.6, 1.0] {
            let number = format!("numerics.cfl={cfl}");
            let mut guard = guard_with(&["fluid.time_integration=\"verlet\"", &number]);
            guard.divide(Stage::Second, &kernel);
            let dt = cfl * H / 20.0;
            let left = |r: f64| 1.0 - dt * rate(&guard, r * DX);
            let expected = 1.0 / (1.0 + dt * undivided(NEAR_BY_VERLET * DX));
            assert!(
                (left(NEAR_BY_VERLET) - expected).abs() < 1e-9,
                "{cfl}: {} {expected}",
                left(NEAR_BY_VERLET)
            );
            let least = (1..80).map(|k| left(0.01 * f64::from(k))).fold(f64::INFINITY, f64::min);
            assert!((0.0..expected).contains(&least), "{cfl}: {least} {expected}");
        }
    }
}
