//! Contact between bodies and with walls, by hand.

use crate::kernel_sum::KernelSum;
use crate::model::SolidModel;
use crate::total_lagrangian::TotalLagrangian;
use crate::total_lagrangian::tests::solid;
use halfstep_wire::state::State as _;

const LOWER: &str = "box = { min = [0.0, 0.0], max = [0.3, 0.1] }";

fn upper(bottom: f64) -> String {
    let top = bottom + 0.1;
    format!(
        "{LOWER}\n[[shape]]\nname = \"upper\"\nphase = \"solid\"\nbox = {{ min = [0.0, {bottom}], max = [0.3, {top}] }}"
    )
}

/// Mass times acceleration of the particle nearest to a place, N/m.
fn force_at(body: &TotalLagrangian<2>, at: [f64; 2]) -> [f64; 2] {
    let away = |p: &usize| {
        let x = body.position_at(body.slot_of[*p] as usize);
        (x[0] - at[0]).hypot(x[1] - at[1])
    };
    let nearest = (0..body.slot_of.len()).min_by(|a, b| away(a).total_cmp(&away(b))).expect("particles");
    let slot = body.slot_of[nearest] as usize;
    [0, 1].map(|d| body.mass * body.now.acceleration[d][slot])
}

/// 1 mm in each other, in the middle of two long faces: both depths are that of a particle 0.9 dx over rows, and each
/// particle is pushed by k' (delta_i + delta_j) |grad delta|, k' = (K + 4 G / 3) / 4.
#[test]
fn bodies_push_each_other_by_their_depths() {
    let mut body = solid(&upper(0.1), &[]);
    assert!(body.accelerations().as_flattened().iter().all(|a| *a == 0.0), "side by side nothing pushes");
    body.deform(|x| [x[0], if x[1] > 0.1 { x[1] - 0.001 } else { x[1] }]);
    let [depth, slope, _] = KernelSum::<2>::new(0.01).over_rows(0.01, 0.009);
    let modulus = body.material.density * body.material.pressure_wave_speed().powi(2);
    let expected = 0.25 * modulus * 2.0 * depth * slope;
    let [below, above] = [0.095, 0.104].map(|y| force_at(&body, [0.155, y]));
    assert!(
        (below[1] / -expected - 1.0).abs() < 1e-9 && (above[1] / expected - 1.0).abs() < 1e-9,
        "{below:?}"
    );
    assert!(below[0].abs() < 1e-9 * expected, "{below:?}");
    let sum = body.accelerations().iter().fold([0.0; 2], |s, a| [s[0] + a[0], s[1] + a[1]]);
    assert!(sum.iter().all(|a| a.abs() * body.mass < 1e-9 * expected), "{sum:?}");
}

/// k of a wall, N/m.
fn spring(body: &TotalLagrangian<2>) -> f64 {
    0.5 * body.material.density * body.material.pressure_wave_speed().powi(2)
}

/// The two walls of a corner push each by itself, and each from its surface on; of a block that begins in one the
/// surface is its own side there.
#[test]
fn a_corner_pushes_as_its_two_walls_do() {
    for left in [0.0, -0.003] {
        let shape = format!(
            "box = {{ min = [{left}, 0.0], max = [{}, 0.1] }}\n[[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
             tank = {{ min = [0.0, 0.0], max = [0.4, 0.3], open = [\"top\"] }}\ncontact = true",
            left + 0.2
        );
        let mut body = solid(&shape, &[]);
        assert_eq!(body.particles().len(), 200);
        let mut pushed = |by: [f64; 2]| {
            body.deform(|x| [x[0] + by[0], x[1] + by[1]]);
            force_at(&body, [left + 0.005 + by[0], 0.005 + by[1]]).map(|force| force / spring(&body))
        };
        for (by, right) in [
            ([0.0, 0.0], [0.0, 0.0]),
            ([0.001, -1e-4], [0.0, 1e-4]),
            ([-2e-4, 0.001], [2e-4, 0.0]),
            ([-2e-4, -1e-4], [2e-4, 1e-4]),
        ] {
            let found = pushed(by);
            assert!((0..2).all(|d| (found[d] - right[d]).abs() < 1e-12), "{by:?}: {found:?}");
        }
    }
}

/// The last row is 1 mm from the wall, d - 4 mm: it is pushed from there on until it has left the wall by more than d,
/// and from d on afterwards, also after an interruption.
#[test]
fn what_begins_too_close_is_pushed_by_the_surface_once_it_has_left() {
    let shape = "box = { min = [0.0, 0.0], max = [0.196, 0.1] }\n[[shape]]\nname = \"wall\"\nphase = \"wall\"\n\
                 box = { min = [0.196, -0.2], max = [0.3, 0.3] }\ncontact = true";
    let mut body = solid(shape, &[]);
    let pushed = |body: &TotalLagrangian<2>| -force_at(body, [0.195, 0.055])[0] / spring(body);
    let go = |body: &mut TotalLagrangian<2>, by: f64| {
        body.deform(|x| [x[0] + by, x[1]]);
        body.contact.iter_mut().for_each(super::Contact::leave);
        pushed(body)
    };
    for (by, right) in
        [(0.0, 0.0), (1e-4, 1e-4), (-0.0039, 0.0), (1e-4, 1e-4), (-0.0041, 0.0), (1e-4, 0.0041)]
    {
        assert!((go(&mut body, by) - right).abs() < 1e-12, "{by}: {}", pushed(&body));
    }
    let mut again = solid(shape, &[]);
    again.load(&body.save()).expect("its own state");
    assert!((go(&mut again, 2e-4) - 0.0042).abs() < 1e-12, "{}", pushed(&again));
}
