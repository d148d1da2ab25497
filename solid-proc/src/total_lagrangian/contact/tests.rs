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
    let [depth, slope, _] = KernelSum::<2>::new(0.01, 0.01).over_rows(0.01, 0.009);
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

/// In a corner a particle sees twice as many of the wall, and one that begins a third of a spacing in a wall more, too:
/// nothing pushes at the start, nor once it has hopped along one of the two walls. What has left both is pushed by the
/// surface from then on, also after an interruption.
#[test]
fn what_begins_in_a_corner_or_in_a_wall_is_pushed_once_it_has_left() {
    let with = |left: f64| {
        format!(
            "box = {{ min = [{left}, 0.0], max = [{}, 0.1] }}\n[[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
             tank = {{ min = [0.0, 0.0], max = [0.4, 0.3], open = [\"top\"] }}\ncontact = true",
            left + 0.2
        )
    };
    for left in [0.0, -0.003] {
        let mut body = solid(&with(left), &[]);
        let pushed = |body: &TotalLagrangian<2>| force_at(body, [left + 0.005, 0.005]);
        assert_eq!(pushed(&body), [0.0; 2], "it begins there");
        let go = |body: &mut TotalLagrangian<2>, by: f64| body.deform(|x| [x[0] + by, x[1] + by]);
        go(&mut body, -1e-4);
        let deeper = pushed(&body);
        assert!(deeper[0] > 0.0 && deeper[1] > 0.0, "{deeper:?}");
        body.deform(|x| [x[0], x[1] + 0.003]);
        body.contact.iter_mut().for_each(super::Contact::leave);
        go(&mut body, 0.0);
        assert_eq!(pushed(&body), [0.0; 2], "it hopped");
        go(&mut body, 0.02);
        body.contact.iter_mut().for_each(super::Contact::leave);
        let mut again = solid(&with(left), &[]);
        again.load(&body.save()).expect("its own state");
        for body in [&mut body, &mut again] {
            go(body, -1e-4);
            let back = pushed(body);
            assert!(back[0] > 1.5 * deeper[0] && back[1] > 1.5 * deeper[1], "{back:?} {deeper:?}");
        }
        assert_eq!(pushed(&body), pushed(&again));
    }
    assert!(solid(&with(0.0), &[]).particles().len() == 200);
}
