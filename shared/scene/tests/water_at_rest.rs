//! Pressures that water begins with where a part of its shape has none: rho g times the depth below the water's own
//! surface.

use halfstep_scene::geometry::layout;
use halfstep_scene::parse;
use std::path::Path;

const DX: f64 = 0.01;
/// rho g, Pa/m.
const WEIGHT: f64 = 9810.0;

/// Largest pressure, Pa, of the fluid with x in a range.
fn deepest(shapes: &str, x: [f64; 2]) -> f64 {
    let text = format!("resolution = {DX}\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n{shapes}");
    let scene = parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let within = layout::<2>(&scene).fluid.into_iter().filter(|p| (x[0]..x[1]).contains(&p.position[0]));
    within.map(|p| p.pressure).fold(f64::NAN, f64::max)
}

fn shape(name: &str, phase: &str, geometry: &str) -> String {
    format!("[[shape]]\nname = \"{name}\"\nphase = \"{phase}\"\n{geometry}\n")
}

fn water(lines: &str) -> String {
    shape(
        "water",
        "fluid",
        &format!("box = {{ min = [0.0, 0.0], max = [0.2, 0.4] }}\npressure = \"hydrostatic\"\n{lines}"),
    )
}

/// That of the lowest row below so much water.
fn expected(depth: f64) -> f64 {
    WEIGHT * (depth - 0.5 * DX)
}

fn near(value: f64, wanted: f64) {
    assert!((value / wanted - 1.0).abs() < 1e-9, "{value} {wanted}");
}

#[test]
fn a_void_or_a_lid_keeps_the_upper_half_empty() {
    let tank = shape("tank", "wall", "tank = { min = [0.0, 0.0], max = [0.2, 0.5], open = [\"top\"] }");
    let upper = "box = { min = [-0.1, 0.25], max = [0.3, 0.6] }";
    near(deepest(&(tank.clone() + &water("")), [0.0, 1.0]), expected(0.4));
    near(deepest(&(shape("air", "void", upper) + &tank + &water("")), [0.0, 1.0]), expected(0.25));
    near(deepest(&(shape("lid", "wall", upper) + &tank + &water("")), [0.0, 1.0]), expected(0.25));
}

#[test]
fn each_copy_has_its_own_surface() {
    let copies = water("repeat = { count = 2, step = [0.5, 0.3] }\n");
    near(deepest(&copies, [0.0, 0.3]), expected(0.4));
    near(deepest(&copies, [0.3, 1.0]), expected(0.4));
}
