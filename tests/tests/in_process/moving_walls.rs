//! Walls that move by prescription.

use halfstep_fluid::Fluid;
use halfstep_role::role::Role;
use halfstep_tests::fluid_alone::{mean_of, run_to};

const TANK: &str = "resolution = 0.01\nend_time = 2.0\ngravity = [0.0, -9.81]\n[fluid]\ndensity = 1000.0\n\
    [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.5, 0.2] }\n\
    pressure = \"hydrostatic\"\n";

#[test]
fn a_piston_that_pushes_slowly_raises_the_water() {
    // 0.1 m in 2 s: 0.5 m x 0.2 m of water becomes 0.4 m x 0.25 m.
    let piston = "[[shape]]\nname = \"piston\"\nphase = \"wall\"\nbox = { min = [-0.03, 0.0], max = [0.0, 0.4] }\n\
        motion = { velocity = [0.05, 0.0], end = 2.0 }\n[[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
        tank = { min = [-0.1, 0.0], max = [0.5, 0.4], open = [\"left\", \"top\"] }\n";
    let (fluid, frame) = run_to(&format!("{TANK}{piston}"), 2.0);
    let water = || (0..1000).map(|k| frame.points[k].map(f64::from));
    let face = 0.1;
    let first = water().map(|x| x[0]).fold(f64::INFINITY, f64::min);
    assert!(first > face - 0.005, "a particle at {first} m is behind the piston's face at {face} m");
    // Half of a column's particles lie below half its height, whatever ripples its surface has.
    let mut heights: Vec<f64> = water().map(|x| x[1]).collect();
    heights.sort_unstable_by(f64::total_cmp);
    assert!((heights[500] - 0.125).abs() < 0.005, "median height {}", heights[500]);
    assert!((fluid.audit().mass - 100.0).abs() < 1e-9);
}

#[test]
fn a_tank_that_moves_with_its_water_is_a_tank_at_rest() {
    let tank = |velocity: &str, motion: &str| {
        format!(
            "{TANK}velocity = {velocity}\n[[shape]]\nname = \"tank\"\nphase = \"wall\"\n{motion}\
             tank = {{ min = [0.0, 0.0], max = [0.5, 0.3], open = [\"top\"] }}\n"
        )
    };
    let (rest, _) = run_to(&tank("[0.0, 0.0]", ""), 0.3);
    let (moving, frame) = run_to(&tank("[1.0, 0.0]", "motion = { velocity = [1.0, 0.0] }\n"), 0.3);
    let centroid = (0..1000).map(|k| f64::from(frame.points[k][0])).sum::<f64>() / 1000.0;
    // The water sloshes by no more than the standing tank's: a thousandth of a spacing.
    assert!((centroid - 0.55).abs() < 1e-5, "{centroid}");
    let energy = |f: &Fluid<2>| f.audit().kinetic_energy;
    let drift = energy(&moving) - 0.5 * 100.0;
    assert!(drift.abs() < 10.0 * energy(&rest).max(1e-4), "{drift} J beside {} J at rest", energy(&rest));
}

/// Circumferential velocity of the fluid between a shaft that turns and a shell at rest, both without slip, over that
/// of Couette's flow: the mean over the fluid's inner half, by its radii.
fn couette(ratio: f64, dx: f64) -> f64 {
    let (inner, outer, turn) = (0.1, 0.3, 2.0);
    let text = format!(
        "resolution = {dx}\nsmoothing_ratio = {ratio}\nend_time = 2.0\ngravity = [0.0, 0.0]\n\
         [fluid]\ndensity = 1000.0\nviscosity = 50.0\nsound_speed = 10.0\nbackground_pressure = 5000.0\n\
         [[shape]]\nname = \"oil\"\nphase = \"fluid\"\n\
         ring = {{ center = [0.0, 0.0], inner = {inner}, outer = {outer} }}\n\
         [[shape]]\nname = \"shaft\"\nphase = \"wall\"\nslip = \"none\"\n\
         disc = {{ center = [0.0, 0.0], radius = {inner} }}\n\
         motion = {{ angular_velocity = {turn}, pivot = [0.0, 0.0], ramp = 0.05 }}\n\
         [[shape]]\nname = \"shell\"\nphase = \"wall\"\nslip = \"none\"\n\
         ring = {{ center = [0.0, 0.0], inner = {outer}, outer = 0.4 }}\n"
    );
    // Of the slowest mode, (pi / 0.2 m)² mu / rho = 12 / s, is nothing left.
    let (_, frame) = run_to(&text, 0.6);
    // A r + B / r with the walls' speeds.
    let share = turn * inner * inner / (outer * outer - inner * inner);
    let exact = |r: f64| share * (outer * outer / r - r);
    mean_of(&frame, |[x, y], [u, v]| {
        let r = x.hypot(y);
        (r < 0.5 * (inner + outer)).then(|| (x * v - y * u) / r / exact(r))
    })
}

/// The walls reverse the fluid's velocity about that of their surface. About each particle's own, which is less in a
/// shaft, the fluid slipped.
#[test]
fn fluid_sticks_to_walls_that_turn() {
    // 0.874 and 0.886 with the particles' own, and a stress that is a gradient of a gradient.
    for (ratio, right) in [(2.0, 0.985), (1.5, 0.967)] {
        let found = couette(ratio, 0.01);
        println!("h / dx = {ratio}: {found:.4}");
        assert!((found - right).abs() < 0.006, "h / dx = {ratio}: {found}, not {right}");
    }
}
