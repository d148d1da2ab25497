//! Each term of the fluid's pass against values computed by hand, and the symmetries that they must keep, in two and in
//! three dimensions.

use crate::columns::PairParticles;
use crate::effects::artificial_viscosity::ArtificialViscosity;
use crate::effects::density_diffusion::gradient::{GradientLaw, GradientSum};
use crate::effects::density_diffusion::{DeltaSph, Hydrostatic, Simple, Strength};
use crate::effects::viscosity::Viscosity;
use crate::equations::Both;
use crate::rates::{PairEffect, RateLaw, RateSum};
use halfstep_scene::ArtificialViscosity as Coefficients;
use halfstep_sph::kernel::{CubicSpline, Kernel, KernelName};
use halfstep_sph::lane::{Fused, Isa, LANES, Lane, Lanes, Precision};
use halfstep_sph::neighbours::{ClusterList, PADDING, Rows};
use halfstep_sph::pair;
use proptest::prelude::*;

const H: f64 = 1.3;

#[derive(Clone, Copy, Debug)]
struct P<const D: usize> {
    x: [f64; D],
    v: [f64; D],
    rho: f64,
    p: f64,
}

/// Particles of mass `m`, sorted, with their list and the slot of each.
struct Cloud<const D: usize> {
    shown: PairParticles<D>,
    list: ClusterList,
    slot: Vec<usize>,
}

fn cloud<const D: usize>(points: &[P<D>], mass: f64) -> Cloud<D> {
    cloud_of(points, mass, Precision::Double)
}

fn cloud_of<const D: usize>(points: &[P<D>], mass: f64, precision: Precision) -> Cloud<D> {
    let n = points.len();
    let mut shown = PairParticles::<D>::new(n, mass, 1000.0);
    let mut pressure = vec![0.0; n];
    for (i, p) in points.iter().enumerate() {
        for d in 0..D {
            shown.position[d][i] = p.x[d];
        }
        (shown.sources[i].velocity, shown.sources[i].density) = (p.v, p.rho);
        pressure[i] = p.p;
    }
    let mut id: Vec<u32> = (0..n as u32).collect();
    let mut rows = Rows::<D>::new(precision);
    rows.sort(&shown.position, &id, 2.0 * H, [-1e2; D], [1e2; D]);
    shown.permute(&mut rows);
    rows.permute(&mut pressure);
    rows.permute_ids(&mut id);
    (0..id.len()).for_each(|slot| shown.show(slot, pressure[slot]));
    shown.round_for(precision);
    let mut list = ClusterList::with_precision(Isa::detect(), precision);
    list.build(&shown.position, &shown.position, &rows, 2.0 * H);
    let slot = (0..n as u32).map(|i| id.iter().position(|&j| j == i).unwrap()).collect();
    assert!(id.iter().filter(|&&i| i != PADDING).count() == n);
    Cloud { shown, list, slot }
}

impl<const D: usize> Cloud<D> {
    /// Acceleration and density rate of each particle.
    fn rates<E: PairEffect<D>>(&self, effects: E) -> Vec<([f64; D], f64)> {
        let law = RateLaw {
            equations: Both,
            kernel: CubicSpline::<D>::new(H),
            effects,
            targets: &self.shown,
            sources: &self.shown,
        };
        let mut sums = vec![RateSum::default(); self.list.fours()];
        pair::pass(Isa::detect(), &law, &self.list, &mut sums);
        self.slot
            .iter()
            .map(|&s| {
                let (sum, k) = (&sums[s / LANES], s % LANES);
                (sum.acceleration.map(|a| a.0[k]), sum.density_rate.0[k])
            })
            .collect()
    }

    fn gradients(&self) -> Vec<[f64; D]> {
        let law = GradientLaw { kernel: CubicSpline::<D>::new(H), fluid: &self.shown };
        let mut gradient = vec![[[0.0; D]; LANES]; self.list.fours()];
        let solve = |_, sum: &GradientSum<D>| sum.solve();
        pair::pass_into(Isa::detect(), &law, &self.list, solve, &mut gradient);
        gradient.as_flattened().to_vec()
    }
}

/// F(r) of the kernel used here, with the pass's softened distance.
fn slope<const D: usize>(r: f64) -> f64 {
    let softened = pair::distance(Lane::splat(r * r), H);
    CubicSpline::<D>::new(H).gradient_over_r::<Fused, Lane>(softened).0[0]
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-12 * b.abs().max(1e-300), "{a} is not {b}");
}

/// A vector along x.
fn along<const D: usize>(x: f64) -> [f64; D] {
    std::array::from_fn(|d| if d == 0 { x } else { 0.0 })
}

/// Two particles 1 m apart, the first with this velocity along x, m/s.
fn two<const D: usize>(speed: f64) -> [P<D>; 2] {
    [
        P { x: along(0.0), v: along(speed), rho: 2.0, p: 3.0 },
        P { x: along(1.0), v: along(0.0), rho: 4.0, p: 5.0 },
    ]
}

fn pressure_of_two_particles_by_hand<const D: usize>() {
    // a_0 = -m (3/4 + 5/16) F(1) (x_0 - x_1), m = 7: the factor is 17/16, x_0 - x_1 = -1.
    let rates = cloud(&two::<D>(0.0), 7.0).rates(());
    close(rates[0].0[0], 7.0 * 17.0 / 16.0 * slope::<D>(1.0));
    close(rates[1].0[0], -7.0 * 17.0 / 16.0 * slope::<D>(1.0));
    assert!(rates[0].0[1..].iter().all(|&a| a == 0.0));
    assert!(rates[0].0[0] < 0.0, "positive pressure pushes apart");
}

fn continuity_of_two_particles_by_hand<const D: usize>() {
    // Approach at 0.5: v_01 . x_01 = (0.5)(-1) = -0.5; D rho_0 = rho_0 m / rho_1 (-0.5) F > 0.
    let rates = cloud(&two::<D>(0.5), 7.0).rates(());
    close(rates[0].1, 2.0 * 7.0 / 4.0 * -0.5 * slope::<D>(1.0));
    close(rates[1].1, 4.0 * 7.0 / 2.0 * -0.5 * slope::<D>(1.0));
    assert!(rates[0].1 > 0.0, "approach raises the density");
}

fn artificial_viscosity_of_two_particles_by_hand<const D: usize>() {
    // A = 0.2, B = 0.7, c = 10: theta = 1.3 (-0.5) / (1 + 0.01 * 1.69), rho = 3,
    // Pi = (-0.2 * 10 theta + 0.7 theta²) / 3 > 0 and a_0 gets -m Pi F x_01.
    let effect = ArtificialViscosity::new(Coefficients { linear: 0.2, quadratic: 0.7 }, 10.0, H);
    let cloud_ = cloud(&two::<D>(0.5), 7.0);
    let (with, without) = (cloud_.rates((effect, ())), cloud_.rates(()));
    let theta = -1.3 * 0.5 / 1.0169;
    let pi = (-2.0 * theta + 0.7 * theta * theta) / 3.0;
    assert!((with[0].0[0] - without[0].0[0] - 7.0 * pi * slope::<D>(1.0)).abs() < 1e-12);
    // Receding particles feel none.
    let cloud_ = cloud(&two::<D>(-0.5), 7.0);
    assert_eq!(cloud_.rates((effect, ())), cloud_.rates(()));
}

fn simple_diffusion_of_two_particles_by_hand<const D: usize>() {
    // delta h c0 = 0.6: D rho_0 = 0.6 (m / rho_1) 2 (2 - 4) F.
    let effect = Simple(Strength(0.6));
    let rates = cloud(&two::<D>(0.0), 7.0).rates((effect, ()));
    close(rates[0].1, 0.6 * 7.0 / 4.0 * 2.0 * -2.0 * slope::<D>(1.0));
    assert!(rates[0].1 > 0.0, "density flows toward the lighter particle");
}

/// The points of a lattice of spacing 1, n along each axis.
fn lattice<const D: usize>(n: usize) -> impl Iterator<Item = [f64; D]> {
    (0..n.pow(D as u32)).map(move |k| std::array::from_fn(|d| (k / n.pow(d as u32) % n) as f64))
}

fn a_linear_density_is_not_diffused<const D: usize>() {
    let slope: [f64; D] = std::array::from_fn(|d| [3.0, -2.0, 5.0][d]);
    // A lattice that is none: fixed irregular shifts.
    let shifted = lattice::<D>(if D == 2 { 10 } else { 6 }).enumerate().map(|(k, x)| {
        std::array::from_fn(|d| {
            x[d] + 0.2 * ((k * [7, 2, 3][d]) % [5, 7, 11][d]) as f64 / [5.0, 7.0, 11.0][d]
        })
    });
    let rho = |x: [f64; D]| 1000.0 + x.iter().zip(slope).map(|(x, s)| x * s).sum::<f64>();
    let points: Vec<P<D>> = shifted.map(|x| P { x, v: [0.0; D], rho: rho(x), p: 0.0 }).collect();
    let c = cloud(&points, 1000.0);
    let gradient = c.gradients();
    for &s in &c.slot {
        assert!((0..D).all(|d| (gradient[s][d] - slope[d]).abs() < 1e-10), "{:?}", gradient[s]);
    }
    let plain = c.rates((Simple(Strength(1.0)), ()));
    let full = c.rates((DeltaSph { strength: Strength(1.0), gradient: &gradient }, ()));
    let rest = c.rates((Hydrostatic { strength: Strength(1.0), gradient: slope }, ()));
    let largest = |r: &[([f64; D], f64)]| r.iter().map(|r| r.1.abs()).fold(0.0, f64::max);
    assert!(largest(&plain) > 1.0, "the simple variant diffuses at the edges");
    assert!(largest(&full) < 1e-10, "{}", largest(&full));
    assert!(largest(&rest) < 1e-10, "{}", largest(&rest));
}

fn lone_particles_have_no_gradient<const D: usize>() {
    let c = cloud(&two::<D>(0.0), 7.0);
    assert!(c.gradients().iter().flatten().all(|&g| g == 0.0));
}

/// mu, Pa s.
const MU: f64 = 0.5;

fn viscosity<const D: usize>() -> (Viscosity<D>, ()) {
    (Viscosity::new(MU, KernelName::CubicSpline, H), ())
}

fn viscous_force_of_two_particles_by_hand<const D: usize>() {
    // Beside their pressures: a_0 = m 2 D mu / <r²> F (v_01 . x_01) x_01 / (rho_0 rho_1), m = 7, v_01 = 0.5, x_01 = -1.
    let strength = if D == 2 { 4.0 * MU / (31.0 / 49.0 * H * H) } else { 6.0 * MU / (0.9 * H * H) };
    for speed in [0.5, -0.5] {
        let c = cloud(&two::<D>(speed), 7.0);
        let (with, without) = (c.rates(viscosity()), c.rates(()));
        let by_stress = |k: usize| with[k].0[0] - without[k].0[0];
        close(by_stress(0), 7.0 * strength * slope::<D>(1.0) * speed / 8.0);
        close(by_stress(1), -by_stress(0));
        assert_eq!(with[0].1, without[0].1);
        assert!(by_stress(0) * speed < 0.0, "it slows what approaches and what recedes");
    }
}

fn velocities_that_are_quadratic_have_their_force<const D: usize>() {
    // mu (v'' + 2 grad div v) in the middle of a lattice, up to what the lattice's sum is off; nothing by a shear or a
    // turn.
    let place = |x: [f64; D]| x.map(|x| x - 4.0);
    let force = |velocity: fn([f64; 2]) -> [f64; 2]| {
        let of = |x: [f64; D]| {
            let (mut v, [x, y]) = ([0.0; D], [place(x)[0], place(x)[1]]);
            [v[0], v[1]] = velocity([x, y]);
            v
        };
        let points: Vec<P<D>> = lattice(9).map(|x| P { x, v: of(x), rho: 1.0, p: 0.0 }).collect();
        cloud(&points, 1.0).rates(viscosity())[points.len() / 2].0
    };
    let size = |a: [f64; D]| a.iter().map(|a| a.abs()).sum::<f64>();
    for (velocity, right, off) in [
        ((|[_, y]| [0.5 * y * y, 0.0]) as fn([f64; 2]) -> [f64; 2], MU, 0.05),
        (|[x, _]| [0.5 * x * x, 0.0], 3.0 * MU, 0.05),
        (|[x, y]| [0.0, x * y], 2.0 * MU, 0.05),
    ] {
        let a = force(velocity);
        println!("{a:?} {right}");
        assert!((a[0] / right - 1.0).abs() < off && a[1..].iter().all(|a| a.abs() < 1e-12), "{a:?} {right}");
    }
    assert!(
        size(force(|[x, y]| [-3.0 * y, 3.0 * x])) < 1e-12 && size(force(|[_, y]| [3.0 * y, 0.0])) < 1e-12
    );
}

fn particle<const D: usize>() -> impl Strategy<Value = P<D>> {
    // Closer in space, so that each has about as many neighbours.
    let side = if D == 2 { 5.0 } else { 3.5 };
    (prop::array::uniform3(0.0..side), prop::array::uniform3(-1.0..1.0), 900.0..1100.0, 0.0..1e4).prop_map(
        |(x, v, rho, p)| P { x: std::array::from_fn(|d| x[d]), v: std::array::from_fn(|d| v[d]), rho, p },
    )
}

fn all_effects<const D: usize>(c: &Cloud<D>) -> Vec<([f64; D], f64)> {
    let damping = ArtificialViscosity::new(Coefficients { linear: 1.0, quadratic: 1.0 }, 20.0, H);
    let gradient = c.gradients();
    let own = Viscosity::new(5.0, KernelName::CubicSpline, H);
    c.rates((own, (damping, (DeltaSph { strength: Strength(2.0), gradient: &gradient }, ()))))
}

fn scale<const D: usize>(rates: &[([f64; D], f64)]) -> f64 {
    rates.iter().map(|r| r.0.iter().map(|a| a.abs()).sum::<f64>() + r.1.abs()).fold(1e-3, f64::max)
}

/// Whether the second rates are the first with each acceleration mapped.
fn same<const D: usize>(
    a: &[([f64; D], f64)],
    b: &[([f64; D], f64)],
    map: impl Fn([f64; D]) -> [f64; D],
) -> bool {
    let s = 1e-9 * scale(a);
    let near = |a: [f64; D], b: [f64; D]| (0..D).all(|d| (b[d] - a[d]).abs() < s);
    a.iter().zip(b).all(|(a, b)| near(map(a.0), b.0) && (b.1 - a.1).abs() < s)
}

fn pairs_exchange_momentum<const D: usize>(points: &[P<D>]) {
    let rates = all_effects(&cloud(points, 1000.0));
    let s = scale(&rates) * points.len() as f64;
    for d in 0..D {
        assert!(rates.iter().map(|r| r.0[d]).sum::<f64>().abs() < 1e-12 * s);
    }
}

fn a_quarter_turn_turns_the_rates<const D: usize>(points: &[P<D>]) {
    // About z, and in space about x, too.
    let turn = |[first, second]: [usize; 2]| {
        move |v: [f64; D]| {
            let mut turned = v;
            (turned[first], turned[second]) = (-v[second], v[first]);
            turned
        }
    };
    let a = all_effects(&cloud(points, 1000.0));
    for axis in 1..D {
        let turn = turn([axis - 1, axis]);
        let turned: Vec<P<D>> = points.iter().map(|p| P { x: turn(p.x), v: turn(p.v), ..*p }).collect();
        assert!(same(&a, &all_effects(&cloud(&turned, 1000.0)), turn));
    }
}

fn place_and_speed_of_the_frame_do_not_matter<const D: usize>(points: &[P<D>]) {
    let by = |v: [f64; D], shift: [f64; 3]| std::array::from_fn(|d| v[d] + shift[d]);
    let moved: Vec<P<D>> = points
        .iter()
        .map(|p| P { x: by(p.x, [3.0, -7.0, 11.0]), v: by(p.v, [0.25, 0.5, -0.75]), ..*p })
        .collect();
    let (a, b) = (all_effects(&cloud(points, 1000.0)), all_effects(&cloud(&moved, 1000.0)));
    assert!(same(&a, &b, |a| a));
}

fn the_order_of_particles_does_not_matter<const D: usize>(points: &[P<D>]) {
    let reversed: Vec<P<D>> = points.iter().rev().copied().collect();
    let mut b = all_effects(&cloud(&reversed, 1000.0));
    b.reverse();
    // Not even the bits: sums follow the sorted order.
    assert_eq!(all_effects(&cloud(points, 1000.0)), b);
}

/// Sums of the sizes of all terms of [`mixed_precision_rounds`] for a particle, each as large as its rounding makes it:
/// velocities are rounded before their difference is taken, and the cubic spline's slope is a difference near its
/// middle and its end.
fn sizes<const D: usize>(points: &[P<D>], i: usize, [sound_speed, diffusion]: [f64; 2]) -> (f64, f64) {
    let norm = |v: [f64; D]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let a = &points[i];
    let (mut push, mut fill) = (0.0, 0.0);
    for (_, b) in points.iter().enumerate().filter(|&(j, _)| j != i) {
        let r = norm(std::array::from_fn(|d| a.x[d] - b.x[d]));
        let slope = -slope::<D>(0.9 * r).min(0.0) * (1.0 + H / r);
        let (speed, s) = (norm(a.v) + norm(b.v), r * r + 0.01 * H * H);
        let q = H * speed * r;
        let damping = 2.0 * q * (q + sound_speed * s) / (s * s * (a.rho + b.rho));
        push += 1000.0 * slope * r * (a.p / a.rho.powi(2) + b.p / b.rho.powi(2) + damping);
        fill += 1000.0 / b.rho * slope * (a.rho * speed * r + 2.0 * diffusion * (a.rho - b.rho).abs());
    }
    (push, fill)
}

/// Pairs in single precision give what pairs in double precision give, but for rounding. What a pair gives is the same
/// for both to the last bit; the sums round.
fn mixed_precision_rounds<const D: usize>(points: &[P<D>]) {
    const ROUNDING: f64 = 6e-8;
    let (sound_speed, diffusion) = (20.0, 2.0);
    let rates = |precision| {
        let damping = ArtificialViscosity::new(Coefficients { linear: 1.0, quadratic: 1.0 }, sound_speed, H);
        cloud_of(points, 1000.0, precision).rates((damping, (Simple(Strength(diffusion)), ())))
    };
    let [double, mixed] = [Precision::Double, Precision::Mixed].map(rates);
    let mut pushes = 0.0;
    for (i, (a, b)) in double.iter().zip(&mixed).enumerate() {
        let (push, fill) = sizes(points, i, [sound_speed, diffusion]);
        let near = |a: f64, b: f64, size: f64| (a - b).abs() <= 20.0 * ROUNDING * size;
        assert!(
            (0..D).all(|d| near(a.0[d], b.0[d], push)) && near(a.1, b.1, fill),
            "{a:?} {b:?} {push} {fill}"
        );
        pushes += push;
    }
    assert!((0..D).all(|d| mixed.iter().map(|r| r.0[d]).sum::<f64>().abs() <= 20.0 * ROUNDING * pushes));
}

macro_rules! suite {
    ($($dimension:ident $D:literal),*) => {
        $(mod $dimension {
            use super::*;

            suite!(by hand in $D: pressure_of_two_particles_by_hand continuity_of_two_particles_by_hand
                artificial_viscosity_of_two_particles_by_hand simple_diffusion_of_two_particles_by_hand
                a_linear_density_is_not_diffused lone_particles_have_no_gradient
                viscous_force_of_two_particles_by_hand velocities_that_are_quadratic_have_their_force);
            suite!(symmetries in $D: pairs_exchange_momentum a_quarter_turn_turns_the_rates
                place_and_speed_of_the_frame_do_not_matter the_order_of_particles_does_not_matter
                mixed_precision_rounds);
        })*
    };
    (by hand in $D:literal: $($case:ident)*) => {
        $(
            #[test]
            fn $case() {
                super::$case::<$D>();
            }
        )*
    };
    (symmetries in $D:literal: $($case:ident)*) => {
        proptest! {
            $(
                #[test]
                fn $case(points in prop::collection::vec(particle::<$D>(), 2..60)) {
                    super::$case(&points);
                }
            )*
        }
    };
}

suite!(in_two_dimensions 2, in_three_dimensions 3);
