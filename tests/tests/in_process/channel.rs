//! Walls without slip: a channel that a force drives along them, and thin layers on one.

use halfstep_tests::fluid_alone::{mean_of, run_to};
use halfstep_wire::frame::FLUID;

/// Mean velocity over Poiseuille's g H² / 12 nu = 0.25 m/s in the middle of a plug 1 m long, 0.1 m high, at 0.4 s,
/// when the start is over but for 2 %.
fn flow(ratio: f64, dx: f64) -> f64 {
    let text = format!(
        "resolution = {dx}\nsmoothing_ratio = {ratio}\nend_time = 1.0\ngravity = [3.0, 0.0]\n\
         [fluid]\ndensity = 1000.0\nviscosity = 10.0\nsound_speed = 10.0\n\
         [[shape]]\nname = \"oil\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [1.0, 0.1] }}\n\
         [[shape]]\nname = \"floor\"\nphase = \"wall\"\nslip = \"none\"\n\
         box = {{ min = [-0.4, -0.05], max = [1.6, 0.0] }}\n\
         [[shape]]\nname = \"lid\"\nphase = \"wall\"\nslip = \"none\"\n\
         box = {{ min = [-0.4, 0.1], max = [1.6, 0.15] }}\n"
    );
    let (_, frame) = run_to(&text, 0.4);
    let middle = mean_of(&frame, |[x, _], _| Some(x));
    mean_of(&frame, |[x, _], [u, _]| ((x - middle).abs() < 0.2).then_some(u / 0.25))
}

/// At 5 mm 0.993 and 0.999. A stress that is a gradient of a gradient, of which each sees every other row, has 1.3 to
/// 1.8.
#[test]
fn a_channel_without_slip_has_poiseuilles_flow() {
    for (ratio, right) in [(2.0, 1.016), (1.5, 1.013)] {
        let found = flow(ratio, 0.01);
        println!("h / dx = {ratio}: {found:.3}");
        assert!((found - right).abs() < 0.006, "h / dx = {ratio}: {found}, not {right}");
    }
}

/// Deepest particle below the floor, over dx, of a dam break of 0.1 Pa s at 0.6 s.
fn deepest(size: [f64; 2], guard: &str) -> f64 {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\n[effects]\nwall-guard = \"{guard}\"\n\
         [fluid]\ndensity = 1000.0\nviscosity = 0.1\nsound_speed = 25.0\n\
         [[shape]]\nname = \"oil\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [{}, {}] }}\n\
         [[shape]]\nname = \"tank\"\nphase = \"wall\"\nslip = \"none\"\n\
         tank = {{ min = [0.0, 0.0], max = [0.8, 0.5], open = [\"top\"] }}\n",
        size[0], size[1]
    );
    let (_, frame) = run_to(&text, 0.6);
    let of_fluid = frame.points.iter().zip(&frame.phase).filter(|(_, phase)| **phase == FLUID);
    of_fluid.map(|(x, _)| -f64::from(x[1]) / 0.01).fold(f64::NEG_INFINITY, f64::max)
}

/// The guard sees the velocity that the floor would show with slip: thin layers stay out of it.
#[test]
fn a_floor_without_slip_is_guarded() {
    let without = deepest([0.2, 0.2], "off");
    println!("without the guard {without:.2} dx");
    assert!(without > 0.5, "{without}");
    for size in [[0.2, 0.2], [0.213, 0.207]] {
        let with = deepest(size, "auto");
        println!("{size:?}: {with:.2} dx");
        assert!(with < 0.1, "{size:?}: {with}");
    }
}
