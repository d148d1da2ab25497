//! Plates that bend too far by beam theory: what is said, and of which load.

use super::trap_tests::has;
use super::{placed, remarks};
use halfstep_scene::{Scene, geometry, parse};
use std::path::Path;

fn scene(modulus: &str, head: &str, rest: &str) -> Scene {
    let text = format!(
        "resolution = 0.005\nend_time = 1.0\n{head}\n[solid]\ndensity = 1000.0\nyoungs_modulus = {modulus}\n\
         poissons_ratio = 0.3\n{rest}"
    );
    parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

const EARTH: &str = "gravity = [0.0, -9.81]";
const WEIGHTLESS: &str = "gravity = [0.0, 0.0]";
const WET: &str = "gravity = [0.0, -9.81]\n[fluid]\ndensity = 1000.0";

/// A beam of 0.24 x 0.02 m, 0.2 m of it free, as this geometry.
fn beam(geometry: &str, clamp: &str, more: &str) -> String {
    format!("[[shape]]\nname = \"beam\"\nphase = \"solid\"\n{geometry}\n{clamp}\n{more}\n")
}

const LYING: &str = "box = { min = [-0.04, 0.0], max = [0.2, 0.02] }";
const END: &str = "clamp = { min = [-0.04, 0.0], max = [0.0, 0.02] }";

/// How it is listed.
fn listed(scene: &Scene) -> String {
    placed(scene, &geometry::layout::<2>(scene))[0].to_string()
}

/// rho g t l⁴ / 8 over E / (1 - 0.09) t³ / 12: 22.3 times its length at 12 kPa, a thousandth of that as it is meant.
#[test]
fn a_dry_beam_of_which_a_thousand_is_missing() {
    let of = |modulus: &str| scene(modulus, EARTH, &beam(LYING, END, ""));
    let found = remarks(&of("12e3"));
    let said = "its own weight would bend `beam` by 4.464 m by beam theory, whose free length is 0.2 m: is \
                solid.youngs_modulus = 1.2e4 Pa right?";
    assert!(has(&found, said), "{found:?}");
    assert_eq!(remarks(&of("12e6")), [""; 0]);
    let text = listed(&of("12e6"));
    assert!(text.contains("bends 0.004464 of 0.2 m under its own weight"), "{text}");
    assert!(!listed(&scene("12e6", WEIGHTLESS, &beam(LYING, END, ""))).contains("bends"), "nothing acts");
}

/// The same beam as a polygon, as one that is turned from upright, and as the second of two copies, whose first is
/// free.
#[test]
fn a_beam_in_other_words() {
    let polygon = "polygon = [[-0.04, 0.0], [0.2, 0.0], [0.2, 0.02], [-0.04, 0.02]]";
    let turned = "box = { min = [-0.04, -0.22], max = [-0.02, 0.02] }\ntranslate = [0.0, -0.02]\n\
                  rotate = { angle = 90.0, about = [-0.04, 0.02] }";
    let repeated =
        "box = { min = [-0.04, -0.1], max = [0.2, -0.08] }\nrepeat = { count = 2, step = [0.0, 0.1] }";
    for geometry in [polygon, turned, repeated] {
        let text = listed(&scene("12e6", EARTH, &beam(geometry, END, "")));
        assert!(text.contains("bends 0.004464 of 0.2 m under its own weight"), "{geometry}: {text}");
    }
    let wedge = "polygon = [[-0.04, 0.0], [0.2, 0.0], [-0.04, 0.02]]";
    let text = listed(&scene("12e6", EARTH, &beam(wedge, END, "")));
    assert!(!text.contains("bends"), "the formula is that of an even plate: {text}");
}

/// At 30 degrees from the horizontal what acts across it is its weight times cos 30, over a free length of its own.
#[test]
fn a_beam_that_leans() {
    let turned = format!("{LYING}\nrotate = {{ angle = 30.0, about = [0.0, 0.01] }}");
    let clamp = "clamp = { min = [-0.06, -0.03], max = [0.0, 0.04] }";
    let text = listed(&scene("12e6", EARTH, &beam(&turned, clamp, "")));
    assert!(text.contains("bends 0.003866 of 0.2 m under its own weight"), "{text}");
}

/// A traction on one row at the tip: P l³ / 3 over the stiffness, but for half a spacing.
#[test]
fn a_beam_with_a_load() {
    let load = "load = { within = { min = [0.194, -1.0], max = [0.21, 1.0] }, traction = [0.0, -100.0] }";
    let text = listed(&scene("12e6", WEIGHTLESS, &beam(LYING, END, load)));
    let (_, bends) = text.split_once("bends ").expect("it bends");
    assert!(bends.contains(" of 0.2 m under its load"), "{text}");
    // Four particles with 5 mm of face each.
    let stiffness = 12e6 / 0.91 * 0.02_f64.powi(3) / 12.0;
    let (force, way): (f64, f64) = (4.0 * 0.005 * 100.0, bends.split(' ').next().unwrap().parse().unwrap());
    assert!((way / (force * 0.2_f64.powi(3) / 3.0 / stiffness) - 1.0).abs() < 0.03, "{text}");
    let text = listed(&scene("12e6", EARTH, &beam(LYING, END, load)));
    assert!(text.contains("under its own weight and its load"), "{text}");
}

/// Under water a plate that lies has its buoyancy; one that is dry behind a dam has the dam's head.
#[test]
fn plates_in_water_and_dry_ones() {
    let pool = |from: f64, to: f64| {
        format!(
            "[[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [{from}, -0.2], max = [{to}, 0.2] }}\n"
        )
    };
    // As heavy as water.
    let text = listed(&scene("12e6", WET, &format!("{}{}", beam(LYING, END, ""), pool(-0.1, 0.4))));
    assert!(!text.contains("bends"), "{text}");
    let upright = "box = { min = [0.0, -0.2], max = [0.02, 0.0] }";
    let foot = "clamp = { min = [0.0, -0.2], max = [0.02, -0.16] }";
    let of = |from: f64| {
        listed(&scene("12e6", WET, &format!("{}{}", beam(upright, foot, ""), pool(from, from + 0.2))))
    };
    assert!(of(-0.2).contains("under the fluid at rest"), "{}", of(-0.2));
    assert!(of(-0.4).contains("under the fluid's full head"), "{}", of(-0.4));
}
