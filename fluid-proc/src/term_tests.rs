//! Each term of the fluid's pass against values computed by hand, and the symmetries that they must keep.

use crate::columns::Shown;
use crate::effects::artificial_viscosity::ArtificialViscosity;
use crate::effects::density_diffusion::gradient::{GradientLaw, GradientSum};
use crate::effects::density_diffusion::{DeltaSph, Hydrostatic, Simple, Strength};
use crate::effects::viscosity::{self, StressTerm, VelocityGradient, ViscousStress};
use crate::rates::{PairEffect, RateLaw, RateSum};
use halfstep_scene::ArtificialViscosity as Coefficients;
use halfstep_sph::kernel::{CubicSpline, Kernel};
use halfstep_sph::lane::{Fused, Isa, LANES, Lane};
use halfstep_sph::neighbours::{ClusterList, PADDING, Rows};
use halfstep_sph::pair;
use proptest::prelude::*;

const H: f64 = 1.3;

#[derive(Clone, Copy, Debug)]
struct P {
    x: [f64; 2],
    v: [f64; 2],
    rho: f64,
    p: f64,
}

/// Particles of mass `m`, sorted, with their list and the slot of each.
struct Cloud {
    shown: Shown<2>,
    list: ClusterList,
    slot: Vec<usize>,
}

fn cloud(points: &[P], mass: f64) -> Cloud {
    let n = points.len();
    let mut shown = Shown::<2>::new(n, mass);
    let mut pressure = vec![0.0; n];
    for (i, p) in points.iter().enumerate() {
        for d in 0..2 {
            shown.position[d][i] = p.x[d];
        }
        (shown.sources[i].velocity, shown.sources[i].density) = (p.v, p.rho);
        pressure[i] = p.p;
    }
    let mut id: Vec<u32> = (0..n as u32).collect();
    let mut rows = Rows::<2>::default();
    rows.sort(&shown.position, &id, 2.0 * H, [-1e3; 2], [1e3; 2]);
    shown.permute(&mut rows);
    rows.permute(&mut pressure);
    rows.permute_ids(&mut id);
    (0..id.len()).for_each(|slot| shown.show(slot, pressure[slot]));
    let mut list = ClusterList::default();
    list.build(&shown.position, &shown.position, &rows, 2.0 * H);
    let slot = (0..n as u32).map(|i| id.iter().position(|&j| j == i).unwrap()).collect();
    assert!(id.iter().filter(|&&i| i != PADDING).count() == n);
    Cloud { shown, list, slot }
}

impl Cloud {
    /// Acceleration and density rate of each particle.
    fn rates<E: PairEffect<2>>(&self, effects: E) -> Vec<([f64; 2], f64)> {
        let law =
            RateLaw { kernel: CubicSpline::<2>::new(H), effects, targets: &self.shown, sources: &self.shown };
        let mut sums = vec![RateSum::default(); self.list.clusters()];
        pair::pass(Isa::detect(), &law, &self.list, &mut sums);
        self.slot
            .iter()
            .map(|&s| {
                let (sum, k) = (&sums[s / LANES], s % LANES);
                (sum.acceleration.map(|a| a.0[k]), sum.density_rate.0[k])
            })
            .collect()
    }

    fn gradients(&self) -> Vec<[f64; 2]> {
        let law = GradientLaw { kernel: CubicSpline::<2>::new(H), fluid: &self.shown };
        let mut gradient = vec![[[0.0; 2]; LANES]; self.list.clusters()];
        let solve = |_, sum: &GradientSum<2>| sum.solve();
        pair::pass_into(Isa::detect(), &law, &self.list, solve, &mut gradient);
        gradient.as_flattened().to_vec()
    }
}

/// F(r) of the kernel used here, with the pass's softened distance.
fn slope(r: f64) -> f64 {
    let softened = pair::distance(Lane::splat(r * r), H);
    CubicSpline::<2>::new(H).gradient_over_r::<Fused>(softened).0[0]
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-12 * b.abs().max(1e-300), "{a} is not {b}");
}

fn two(v0: [f64; 2], v1: [f64; 2]) -> [P; 2] {
    [P { x: [0.0, 0.0], v: v0, rho: 2.0, p: 3.0 }, P { x: [1.0, 0.0], v: v1, rho: 4.0, p: 5.0 }]
}

#[test]
fn pressure_of_two_particles_by_hand() {
    // a_0 = -m (3/4 + 5/16) F(1) (x_0 - x_1), m = 7: the factor is 17/16, x_0 - x_1 = -1.
    let rates = cloud(&two([0.0; 2], [0.0; 2]), 7.0).rates(());
    close(rates[0].0[0], 7.0 * 17.0 / 16.0 * slope(1.0));
    close(rates[1].0[0], -7.0 * 17.0 / 16.0 * slope(1.0));
    assert_eq!(rates[0].0[1], 0.0);
    assert!(rates[0].0[0] < 0.0, "positive pressure pushes apart");
}

#[test]
fn continuity_of_two_particles_by_hand() {
    // Approach at 0.5: v_01 . x_01 = (0.5)(-1) = -0.5; D rho_0 = rho_0 m / rho_1 (-0.5) F > 0.
    let rates = cloud(&two([0.5, 0.0], [0.0; 2]), 7.0).rates(());
    close(rates[0].1, 2.0 * 7.0 / 4.0 * -0.5 * slope(1.0));
    close(rates[1].1, 4.0 * 7.0 / 2.0 * -0.5 * slope(1.0));
    assert!(rates[0].1 > 0.0, "approach raises the density");
}

#[test]
fn artificial_viscosity_of_two_particles_by_hand() {
    // A = 0.2, B = 0.7, c = 10: theta = 1.3 (-0.5) / (1 + 0.01 * 1.69), rho = 3,
    // Pi = (-0.2 * 10 theta + 0.7 theta²) / 3 > 0 and a_0 gets -m Pi F x_01.
    let effect = ArtificialViscosity::new(Coefficients { linear: 0.2, quadratic: 0.7 }, 10.0, H);
    let cloud_ = cloud(&two([0.5, 0.0], [0.0; 2]), 7.0);
    let (with, without) = (cloud_.rates((effect, ())), cloud_.rates(()));
    let theta = -1.3 * 0.5 / 1.0169;
    let pi = (-2.0 * theta + 0.7 * theta * theta) / 3.0;
    assert!((with[0].0[0] - without[0].0[0] - 7.0 * pi * slope(1.0)).abs() < 1e-12);
    // Receding particles feel none.
    let cloud_ = cloud(&two([-0.5, 0.0], [0.0; 2]), 7.0);
    assert_eq!(cloud_.rates((effect, ())), cloud_.rates(()));
}

#[test]
fn simple_diffusion_of_two_particles_by_hand() {
    // delta h c0 = 0.6: D rho_0 = 0.6 (m / rho_1) 2 (2 - 4) F.
    let effect = Simple(Strength(0.6));
    let rates = cloud(&two([0.0; 2], [0.0; 2]), 7.0).rates((effect, ()));
    close(rates[0].1, 0.6 * 7.0 / 4.0 * 2.0 * -2.0 * slope(1.0));
    assert!(rates[0].1 > 0.0, "density flows toward the lighter particle");
}

fn patch(rho: impl Fn([f64; 2]) -> f64, v: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<P> {
    let mut points = Vec::new();
    for j in 0..9 {
        for i in 0..11 {
            // A lattice that is none: fixed irregular shifts.
            let x = [
                f64::from(i) + 0.2 * f64::from((i * 7 + j * 3) % 5) / 5.0,
                f64::from(j) + 0.2 * f64::from((i * 2 + j * 5) % 7) / 7.0,
            ];
            points.push(P { x, v: v(x), rho: rho(x), p: 0.0 });
        }
    }
    points
}

#[test]
fn a_linear_density_is_not_diffused() {
    let points = patch(|x| 1000.0 + 3.0 * x[0] - 2.0 * x[1], |_| [0.0; 2]);
    let c = cloud(&points, 1000.0);
    let gradient = c.gradients();
    for &s in &c.slot {
        assert!((gradient[s][0] - 3.0).abs() < 1e-10 && (gradient[s][1] + 2.0).abs() < 1e-10);
    }
    let plain = c.rates((Simple(Strength(1.0)), ()));
    let full = c.rates((DeltaSph { strength: Strength(1.0), gradient: &gradient }, ()));
    let rest = c.rates((Hydrostatic { strength: Strength(1.0), gradient: [3.0, -2.0] }, ()));
    let largest = |r: &[([f64; 2], f64)]| r.iter().map(|r| r.1.abs()).fold(0.0, f64::max);
    assert!(largest(&plain) > 1.0, "the simple variant diffuses at the edges");
    assert!(largest(&full) < 1e-10, "{}", largest(&full));
    assert!(largest(&rest) < 1e-10, "{}", largest(&rest));
}

#[test]
fn lone_particles_have_no_gradient() {
    let c = cloud(&two([0.0; 2], [0.0; 2]), 7.0);
    assert!(c.gradients().iter().flatten().all(|&g| g == 0.0));
}

#[test]
fn shear_flow_has_the_stress_of_its_rate() {
    // dv_x/dy = 3, mu = 0.5: tau_xy = 1.5 in the middle of a regular lattice; tau_xx = tau_yy = 0.
    let points: Vec<P> = (0..81)
        .map(|k| {
            let x = [f64::from(k % 9), f64::from(k / 9)];
            P { x, v: [3.0 * x[1], 0.0], rho: 1.0, p: 0.0 }
        })
        .collect();
    let c = cloud(&points, 1.0);
    let law =
        viscosity::GradientLaw { kernel: CubicSpline::<2>::new(H), targets: &c.shown, sources: &c.shown };
    let mut stress = StressTerm(vec![[[0.0; 2]; 2]; LANES * c.list.clusters()]);
    let finish = |slot, sum: &VelocityGradient<2>| sum.stress(0.5, c.shown.densities(slot));
    pair::pass_into(Isa::detect(), &law, &c.list, finish, stress.0.as_chunks_mut().0);
    let middle = c.slot[40];
    // The lattice sum of V F x² is 1 up to the kernel's error.
    let tau = stress.0[middle];
    assert!((tau[0][1] - 1.5).abs() < 0.02, "{}", tau[0][1]);
    assert!(tau[0][0].abs() < 1e-12 && tau[1][1].abs() < 1e-12);
    // A uniform stress makes no force inside.
    let rates = c.rates((ViscousStress(&stress), ()));
    assert!(rates[40].0[0].abs() < 1e-10 && rates[40].0[1].abs() < 1e-10);
}

fn particle() -> impl Strategy<Value = P> {
    ((0.0..5.0, 0.0..5.0), (-1.0..1.0, -1.0..1.0), 900.0..1100.0, 0.0..1e4).prop_map(|(x, v, rho, p)| P {
        x: [x.0, x.1],
        v: [v.0, v.1],
        rho,
        p,
    })
}

fn all_effects(c: &Cloud) -> Vec<([f64; 2], f64)> {
    let damping = ArtificialViscosity::new(Coefficients { linear: 1.0, quadratic: 1.0 }, 20.0, H);
    let gradient = c.gradients();
    c.rates((damping, (DeltaSph { strength: Strength(2.0), gradient: &gradient }, ())))
}

fn scale(rates: &[([f64; 2], f64)]) -> f64 {
    rates.iter().map(|r| r.0[0].abs() + r.0[1].abs() + r.1.abs()).fold(1e-3, f64::max)
}

proptest! {
    #[test]
    fn pairs_exchange_momentum(points in prop::collection::vec(particle(), 2..60)) {
        let rates = all_effects(&cloud(&points, 1000.0));
        let s = scale(&rates) * points.len() as f64;
        for d in 0..2 {
            prop_assert!(rates.iter().map(|r| r.0[d]).sum::<f64>().abs() < 1e-12 * s);
        }
    }

    #[test]
    fn a_quarter_turn_turns_the_rates(points in prop::collection::vec(particle(), 2..60)) {
        let turned: Vec<P> =
            points.iter().map(|p| P { x: [-p.x[1], p.x[0]], v: [-p.v[1], p.v[0]], ..*p }).collect();
        let (a, b) = (all_effects(&cloud(&points, 1000.0)), all_effects(&cloud(&turned, 1000.0)));
        let s = 1e-9 * scale(&a);
        for (a, b) in a.iter().zip(&b) {
            prop_assert!((b.0[0] + a.0[1]).abs() < s && (b.0[1] - a.0[0]).abs() < s && (b.1 - a.1).abs() < s);
        }
    }

    #[test]
    fn place_and_speed_of_the_frame_do_not_matter(points in prop::collection::vec(particle(), 2..60)) {
        let moved: Vec<P> = points
            .iter()
            .map(|p| P { x: [p.x[0] + 3.0, p.x[1] - 7.0], v: [p.v[0] + 0.25, p.v[1] + 0.5], ..*p })
            .collect();
        let (a, b) = (all_effects(&cloud(&points, 1000.0)), all_effects(&cloud(&moved, 1000.0)));
        let s = 1e-9 * scale(&a);
        for (a, b) in a.iter().zip(&b) {
            prop_assert!((b.0[0] - a.0[0]).abs() < s && (b.0[1] - a.0[1]).abs() < s && (b.1 - a.1).abs() < s);
        }
    }

    #[test]
    fn the_order_of_particles_does_not_matter(points in prop::collection::vec(particle(), 2..60)) {
        let reversed: Vec<P> = points.iter().rev().copied().collect();
        let mut b = all_effects(&cloud(&reversed, 1000.0));
        b.reverse();
        // Not even the bits: sums follow the sorted order.
        prop_assert_eq!(all_effects(&cloud(&points, 1000.0)), b);
    }
}
