//! Walls that move by prescription.

use halfstep_fluid::Fluid;
use halfstep_output::Frame;
use halfstep_role::role::Role;
use halfstep_scene as scene;
use halfstep_sph::lane::Isa;
use halfstep_tests::fluid_alone::go_on;
use std::path::Path;

const TANK: &str = "resolution = 0.01\nend_time = 2.0\ngravity = [0.0, -9.81]\n[fluid]\ndensity = 1000.0\n\
    [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.5, 0.2] }\n\
    pressure = \"hydrostatic\"\n";

/// Runs to a time and returns the fluid with its last frame.
fn run(text: &str, until: f64) -> (Fluid<2>, Frame) {
    let scene = scene::parse(text, Path::new("moving.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let mut fluid = Fluid::<2>::new(&scene, Isa::detect()).unwrap();
    let mut reached = 0.0;
    go_on(&mut fluid, until, |_, _, t| reached = t);
    let mut frame = Frame::default();
    fluid.fill_frame(reached, &mut frame);
    (fluid, frame)
}

#[test]
fn a_piston_that_pushes_slowly_raises_the_water() {
    // 0.1 m in 2 s: 0.5 m x 0.2 m of water becomes 0.4 m x 0.25 m.
    let piston = "[[shape]]\nname = \"piston\"\nphase = \"wall\"\nbox = { min = [-0.03, 0.0], max = [0.0, 0.4] }\n\
        motion = { velocity = [0.05, 0.0], end = 2.0 }\n[[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
        tank = { min = [-0.1, 0.0], max = [0.5, 0.4], open = [\"left\", \"top\"] }\n";
    let (fluid, frame) = run(&format!("{TANK}{piston}"), 2.0);
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
    let (rest, _) = run(&tank("[0.0, 0.0]", ""), 0.3);
    let (moving, frame) = run(&tank("[1.0, 0.0]", "motion = { velocity = [1.0, 0.0] }\n"), 0.3);
    let centroid = (0..1000).map(|k| f64::from(frame.points[k][0])).sum::<f64>() / 1000.0;
    // The water sloshes by no more than the standing tank's: a thousandth of a spacing.
    assert!((centroid - 0.55).abs() < 1e-5, "{centroid}");
    let energy = |f: &Fluid<2>| f.audit().kinetic_energy;
    let drift = energy(&moving) - 0.5 * 100.0;
    assert!(drift.abs() < 10.0 * energy(&rest).max(1e-4), "{drift} J beside {} J at rest", energy(&rest));
}
