//! `[parameters]` and formulas.

use halfstep_scene::{Geometry, Scene, parse};
use std::path::Path;

const SCENE: &str = r#"
resolution = "=H / rows"
end_time = "= 2 * pi * sqrt(L / 9.81)"

[parameters]
L = 0.4
H = "=L / 4 + 0.1"
rows = 20
slope = "=atan(1)"

[fluid]
density = 1000

[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = ["=L", "=H"] }

[[shape]]
name = "tank"
phase = "wall"
tank = { min = [0, 0], max = ["=L", "=2 * H"], open = ["top"] }

[[probe]]
name = "gauges"
kind = "water-level"
x = ["=L / 4", "=3 * L / 4"]

[[reference]]
probe = "gauges.level-1"
label = "=H"
points = [[0, "=H"]]
"#;

fn scene(overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.into()).collect();
    parse(SCENE, Path::new("s.toml"), &overrides).unwrap_or_else(|e| panic!("{e:?}"))
}

fn size(scene: &Scene) -> [f64; 2] {
    let Geometry::Box(block) = &scene.shapes[0].geometry else { panic!("a box") };
    [block.max[0], block.max[1]]
}

#[test]
fn formulas_are_computed() {
    let found = scene(&[]);
    assert_eq!((size(&found), found.resolution), ([0.4, 0.2], 0.01));
    assert!((found.end_time - 2.0 * std::f64::consts::PI * (0.4_f64 / 9.81).sqrt()).abs() < 1e-15);
    assert_eq!(found.references[0].points, [[0.0, 0.2]]);
    assert_eq!(found.references[0].label, "=H", "what people read is no formula");
}

#[test]
fn an_override_of_a_parameter_changes_all_that_follows_from_it() {
    let found = scene(&["parameters.L=0.8"]);
    assert_eq!((size(&found), found.resolution), ([0.8, 0.3], 0.015));
    let found = scene(&["parameters.L==rows * 0.03", "parameters.rows=10"]);
    assert_eq!(size(&found)[0], 0.3);
    let found = scene(&["resolution==L / 40"]);
    assert_eq!(found.resolution, 0.01);
}

#[test]
fn rounding_is_none_of_what_a_formula_means() {
    let end = |formula: &str| scene(&[&format!("end_time=={formula}")]).end_time;
    assert_ne!(3.0 * 0.1, 0.3);
    assert_eq!([end("3 * 0.1"), end("0.1 + 0.2"), end("1.1 * 1.1")], [0.3, 0.3, 1.21]);
    // A number with more digits stays as it is.
    assert_eq!(end("1 / 3"), 1.0 / 3.0);
    assert_eq!(end("sqrt(2)").to_bits(), 2.0_f64.sqrt().to_bits());
    assert_eq!(end("0.300000000000001"), 0.300000000000001);
}

#[test]
fn a_parameter_that_nothing_needs_is_known() {
    assert_eq!(scene(&[]).doubtful.unused, ["slope"]);
    // What only such a parameter needs is as useless.
    assert_eq!(scene(&["parameters.angle=1", "parameters.slope==angle"]).doubtful.unused, ["angle", "slope"]);
    assert_eq!(scene(&["resolution==H / rows / slope"]).doubtful.unused, [""; 0]);
}

#[test]
fn arithmetic_is_that_of_paper() {
    for (formula, value) in [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("8 / 4 / 2", 1.0),
        ("8 / 4 * 2", 4.0),
        ("2 - 3 - 4", -5.0),
        ("2 * 3 / 4 * 2", 3.0),
        ("2^3", 8.0),
        ("2 * 3^2", 18.0),
        ("12 / 2^2", 3.0),
        ("-3 + 5", 2.0),
        ("-2^2", 4.0),
        ("5 - -3", 8.0),
        ("2 * (-3)", -6.0),
        ("1e-3 * 2", 2e-3),
        ("1.5E+2", 150.0),
        ("sqrt(2 * 8) + abs(-1)", 5.0),
        ("exp(0) + log(1) + sin(0) + cos(0) + tan(0)", 2.0),
        ("floor(2.7)", 2.0),
        ("asin(1) + acos(1) - pi / 2", 0.0),
        ("L - 0.4", 0.0),
    ] {
        let set = format!("shape.water.velocity=[\"={formula}\", 0]");
        assert_eq!(scene(&[&set]).shapes[0].velocity[0], value, "{formula}");
    }
}

#[test]
fn nonsense_is_an_error_and_no_panic() {
    let parts =
        ["(", ")", "1", ".", "e", "E+", "-", "^", "*", "/", ",", "L", "pi", "sin", "sqrt ", " ", "_", "log("];
    // All strings of three parts, and longer ones by a fixed walk.
    let three = (0..parts.len().pow(3))
        .map(|k| [k, k / parts.len(), k / parts.len().pow(2)].map(|k| parts[k % parts.len()]).concat());
    let mut walk = 1_usize;
    let mut next = || {
        walk = walk.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        parts[(walk >> 33) % parts.len()]
    };
    let long: Vec<String> = (0..3000).map(|k| (0..4 + k % 20).map(|_| next()).collect()).collect();
    let mut computed = 0;
    for formula in three.chain(long) {
        let overrides = [format!("shape.water.velocity=[\"={formula}\", 0]")];
        match parse(SCENE, Path::new("s.toml"), &overrides) {
            Ok(scene) => {
                assert!(scene.shapes[0].velocity[0].is_finite(), "{formula}");
                computed += 1;
            }
            Err(errors) => assert_eq!(errors.problems.len(), 1, "{formula}: {errors:?}"),
        }
    }
    assert!(computed > 100, "{computed}");
}

#[test]
fn angles_of_whole_numbers_are_known() {
    let of = |formula: &str| {
        let found = scene(&["parameters.slope=15", "parameters.k=3", &format!("resolution=={formula}")]);
        found.doubtful.whole_angles.into_iter().map(|angle| (angle.call, angle.radians)).collect::<Vec<_>>()
    };
    assert_eq!(of("0.01 * abs(tan(slope))"), [("tan(slope)".to_owned(), 15.0)]);
    assert_eq!(of("0.01 * abs(sin((slope * 2)) + cos(30))").len(), 2);
    assert_eq!(of("0.01 * abs(tan(22.5))"), [("tan(22.5)".to_owned(), 22.5)]);
    for radians in [
        "0.01 * sin(slope * pi / 180)",
        "0.01 * abs(cos(3))",
        "0.001 * atan(slope)",
        "0.01 * abs(sin(k * slope))",
        "0.01 * sin(0.5)",
    ] {
        assert_eq!(of(radians), [], "{radians}");
    }
}

#[test]
fn degrees_that_are_computed_in_radians_are_known() {
    let turned = |formula: &str| {
        let angle = format!("shape.water.rotate={{angle=\"={formula}\",about=[0,0]}}");
        scene(&[&angle]).doubtful.radians
    };
    assert_eq!(turned("atan(0.5)"), [["shape.water.rotate.angle".to_owned(), "atan(0.5)".to_owned()]]);
    assert_eq!(turned("atan(0.5) * 180 / pi"), [] as [[String; 2]; 0]);
    assert_eq!(turned("30"), [] as [[String; 2]; 0]);
}
