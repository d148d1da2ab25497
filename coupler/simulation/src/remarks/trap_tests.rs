//! Valid scenes that would fail in silence: what is remarked on each.

use super::remarks;
use super::tests::{PLATE, TANK, WATER, plain};
use halfstep_scene::parse;
use std::path::Path;

const MOTION: &str = "motion = { amplitude = [0.01, 0.0], period = 1.0 }\n";
const OTHER: &str = "motion = { amplitude = [0.02, 0.0], period = 1.0 }\n";

/// A shape with lines more.
pub(super) fn with(shape: &str, line: &str) -> String {
    shape.replacen("phase = ", &format!("{line}phase = "), 1)
}

/// Remarks on a whole scene.
pub(super) fn on(text: &str) -> Vec<String> {
    remarks(&parse(text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
}

pub(super) fn has(found: &[String], said: &str) -> bool {
    found.iter().any(|text| text.contains(said))
}

#[test]
fn a_clamp_that_goes_another_way_than_its_tank() {
    let (tank, otherwise) =
        (with(TANK, MOTION), "the clamp of `plate` stands in `tank`, which moves: the clamp moves");
    let of = |plate: &str| plain(&[&tank, WATER, plate]);
    assert!(has(&of(&with(PLATE, OTHER)), otherwise));
    for along in [with(PLATE, MOTION), PLATE.replace("0.01] }", "0.01], with = \"tank\" }")] {
        assert_eq!(of(&along), [""; 0], "{along}");
    }
}

#[test]
fn a_joint_to_space_in_a_tank_that_moves() {
    let hung = |motion: &str, more: &str| {
        on(&format!(
            "resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[solid]\nmodel = \"rigid\"\n\
             density = 1100.0\njoints = [{{ name = \"pin\", kind = \"hinge\", body = \"flap\", at = [0.21, 0.25]{more} }}]\n\
             {}{WATER}[[shape]]\nname = \"flap\"\nphase = \"solid\"\nbox = {{ min = [0.2, 0.1], max = [0.22, 0.25] }}\n",
            with(TANK, motion)
        ))
    };
    let said = "joint `pin` ties `flap` to space inside of `tank`, which moves: the joint does not go along";
    assert!(has(&hung(MOTION, ""), said));
    assert_eq!(hung(MOTION, ", with = \"tank\""), [""; 0]);
    assert_eq!(hung("", ""), [""; 0], "a tank at rest");
}

#[test]
fn a_wall_that_a_tank_leaves_behind() {
    let weir =
        "[[shape]]\nname = \"weir\"\nphase = \"wall\"\nbox = { min = [0.3, -0.02], max = [0.32, 0.05] }\n";
    let plate = with(PLATE, MOTION);
    let of = |weir: &str| plain(&[weir, &with(TANK, MOTION), WATER, &plate]);
    assert!(has(&of(weir), "`weir` stands in `tank`, which moves, and stays where it is"));
    assert!(has(&of(&with(weir, OTHER)), "`weir` stands in `tank`, which moves, and moves otherwise"));
    assert!(!has(&of(&with(weir, MOTION)), "stands in"));
    // What moves in a tank at rest is a paddle.
    assert!(!has(&plain(&[&with(weir, MOTION), TANK, WATER, PLATE]), "stands in"));
}

/// A paddle that is drawn as a polygon holds no water, and a beach drags on what a tank takes along.
#[test]
fn a_paddle_is_no_tank() {
    let outline = "polygon = [[0.08, 0.0], [0.1, 0.0], [0.1, 0.2], [0.08, 0.2]]";
    let paddle = format!("[[shape]]\nname = \"pad\"\nphase = \"wall\"\n{outline}\n{MOTION}");
    let wide = WATER.replace("max = [0.1, 0.1]", "max = [0.18, 0.1]");
    assert!(!has(&plain(&[&paddle, TANK, &wide, PLATE]), "stands in `pad`"));
    let beach = |tank: &str| {
        on(&format!(
            "resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n\
             beach = {{ from = 0.2, to = 0.35 }}\n{tank}{}",
            WATER.replace("max = [0.1, 0.1]", "max = [0.4, 0.1]")
        ))
    };
    let said = "fluid.beach takes velocities in space toward zero, and `tank`, which holds the fluid, moves";
    assert!(has(&beach(&with(TANK, MOTION)), said), "{:?}", beach(&with(TANK, MOTION)));
    assert!(!has(&beach(TANK), "holds the fluid, moves"));
}

#[test]
fn shapes_of_which_one_names_its_body() {
    let block =
        "[[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = { min = [0.22, 0.0], max = [0.3, 0.1] }\n";
    let of = |plate: &str, block: &str| plain(&[TANK, WATER, plate, block]);
    let named = |shape: &str, body: &str| with(shape, &format!("body = \"{body}\"\n"));
    let found = of(&named(PLATE, "one"), block);
    assert!(
        has(&found, "`plate` and `block` touch and are bodies of their own (`body` stands at `plate` alone)"),
        "{found:?}"
    );
    let both = of(&named(PLATE, "one"), &named(block, "two"));
    assert!(!has(&both, "bodies of their own"), "{both:?}");
}

/// A plate of four rows.
/// Bodies of one solid that strains push each other by their particles.
#[test]
fn bodies_of_one_solid_that_begin_in_each_other() {
    let of = |geometry: &str| {
        let block = format!("[[shape]]\nname = \"block\"\nphase = \"solid\"\n{geometry}\n");
        plain(&[TANK, WATER, PLATE, &block])
    };
    let said = "`plate` and `block` lie 0.01 m in each other at the start";
    let lying = |x: f64| of(&format!("box = {{ min = [{x}, 0.03], max = [0.25, 0.06] }}"));
    assert!(has(&lying(0.21), said), "{:?}", lying(0.21));
    assert!(!has(&lying(0.22), "in each other"));
}

/// 92 mm of a plate of 102 mm are free: at a spacing of 5 mm 18 rows, 90 mm.
#[test]
fn a_free_length_that_is_rounded() {
    let long = |top: f64| PLATE.replace("max = [0.22, 0.1]", &format!("max = [0.22, {top}]"));
    let found = plain(&[TANK, WATER, &long(0.102)]);
    let said = "`plate` is free over 0.092 m in the scene and over 0.09 m of whole rows as computed: a force bends its \
                tip 0.94 times as far";
    assert!(has(&found, said), "{found:?}");
    assert!(!has(&plain(&[TANK, WATER, &long(0.101)]), "is free over"), "1.1 %");
}

#[test]
fn a_plate_of_which_a_void_leaves_one_row() {
    let void = |from: f64| {
        format!(
            "[[shape]]\nname = \"cut\"\nphase = \"void\"\nbox = {{ min = [{from}, 0.04], max = [0.2201, 0.12] }}\n"
        )
    };
    let one = plain(&[TANK, WATER, &void(0.205), PLATE]);
    let said = "`plate` is about 1.0 dx thick at [0.2025, 0.0475], and 2 dx are needed: fluid on one face reaches the \
                other through it (2h) and leaks";
    assert!(one.len() == 2 && one[0] == said, "{one:?}");
    let row = "12 particles of `plate`, at [0.2025, 0.0425] first, have their neighbours on one line";
    assert!(one[1].starts_with(row), "{one:?}");
    assert_eq!(plain(&[TANK, WATER, &void(0.21), PLATE]), [""; 0], "two rows are enough");
    let seen = plain(&[TANK, WATER, &void(0.205), PLATE, "[effects]\nthin-plate-screen = \"off\"\n"]);
    assert!(seen.len() == 1 && seen[0].starts_with(row), "{seen:?}");
}

#[test]
fn two_halves_of_a_plate_side_by_side() {
    let halves = |bodies: [&str; 2]| {
        let half = |name: &str, [from, to]: [f64; 2], body: &str| {
            format!(
                "[[shape]]\nname = \"{name}\"\nphase = \"solid\"\nbody = \"{body}\"\n\
                 box = {{ min = [{from}, 0.0], max = [{to}, 0.1] }}\nclamp = {{ min = [{from}, 0.0], max = [{to}, 0.01] }}\n"
            )
        };
        let [a, b] = [half("left", [0.2, 0.205], bodies[0]), half("right", [0.205, 0.21], bodies[1])];
        format!(
            "resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[solid]\ndensity = 1100.0\n\
             youngs_modulus = 12e6\npoissons_ratio = 0.4\n{TANK}{WATER}{a}{b}"
        )
    };
    assert_eq!(on(&halves(["one", "one"])), [""; 0]);
    let apart = parse(&halves(["one", "two"]), Path::new("x.toml"), &[]).unwrap_err();
    assert_eq!(apart.problems.len(), 2, "each alone has one row");
}

/// The tank is 0.4 m wide with walls of 15 mm, the plate takes 4 x 20 places: of 90 x 20 there are 1660, and 7 x 20
/// stand outside.
#[test]
fn water_that_is_wider_than_its_tank() {
    let found = plain(&[TANK, &WATER.replace("[0.1, 0.1]", "[0.45, 0.1]"), PLATE]);
    let said = "140 of 1660 particles of `water` have neither wall nor solid below them, however deep, and fall: the \
                first is at [0.4175, 0.0025]";
    assert!(has(&found, said), "{found:?}");
    // Beyond an end that is open there is the other half of the tank.
    let open = TANK.replace("[\"top\"]", "[\"right\", \"top\"]");
    let more =
        "[[shape]]\nname = \"apron\"\nphase = \"wall\"\nbox = { min = [0.4, -0.015], max = [0.6, 0.0] }\n";
    let found = plain(&[&open, more, &WATER.replace("[0.1, 0.1]", "[0.45, 0.1]"), PLATE]);
    assert!(!has(&found, "however deep"), "{found:?}");
}

#[test]
fn a_drop_in_the_air() {
    let drop = |height: f64| {
        format!(
            "[[shape]]\nname = \"drop\"\nphase = \"fluid\"\ndisc = {{ center = [0.1, {height}], radius = 0.03 }}\n"
        )
    };
    let said = "`drop` hangs in the air";
    assert!(has(&plain(&[TANK, &drop(0.2), PLATE]), said));
    assert!(!has(&plain(&[TANK, &drop(0.03), PLATE]), said), "on the floor");
    assert!(!has(&plain(&[TANK, WATER, &drop(0.13), PLATE]), said), "on other fluid");
}

#[test]
fn water_under_other_water_begins_with_its_own_depth() {
    let still = with(WATER, "pressure = \"hydrostatic\"\n");
    let beside = |name: &str, low: &str, high: &str| {
        let other = still.replace("\"water\"", &format!("\"{name}\"")).replace("max = [0.1, 0.1]", high);
        other.replace("min = [0.0, 0.0]", low)
    };
    // rho g times 0.1 m.
    let found = plain(&[TANK, &still, &beside("more", "min = [0.0, 0.1]", "max = [0.1, 0.2]"), PLATE]);
    let said =
        "`water` begins with the pressure of its own depth, and `more` stands on it: 981 Pa are missing";
    assert!(has(&found, said), "{found:?}");
    let level = plain(&[TANK, &still, &beside("more", "min = [0.1, 0.0]", "max = [0.18, 0.1]"), PLATE]);
    assert!(!has(&level, "are missing"), "{level:?}");
}

/// Triangular load of 882.9 Pa at the root on 0.09 m: q l⁴ / 30 over E / (1 - 0.16) (20 mm)³ / 12 = 1.587 mN m.
#[test]
fn what_is_hardly_meant() {
    let scene = |from: &str, to: &str| {
        let head = "resolution = 0.005\nend_time = 1.0\ngravity = [0.0, -9.81]\n[fluid]\ndensity = 1000.0\n\
                    viscosity = 0.001\n[solid]\ndensity = 1100.0\nyoungs_modulus = 12e6\npoissons_ratio = 0.4\n";
        on(&format!("{head}{TANK}{WATER}{PLATE}").replacen(from, to, 1))
    };
    assert_eq!(scene("", ""), [""; 0]);
    assert_eq!(
        scene("12e6", "2e3"),
        [
            "the fluid's full head would bend `plate` by 1.216 m by beam theory, whose free length is 0.09 m (it is \
          dry at the start: this is fluid that stands at it as high as fluid begins): is solid.youngs_modulus = 2e3 Pa right?"
        ]
    );
    assert_eq!(
        scene("viscosity = 0.001", "viscosity = 1.0"),
        [
            "fluid.viscosity = 1 Pa s in a fluid of the density of water, which has 0.001 Pa s: is the unit right?"
        ]
    );
    let heavy = scene("-9.81", "-981.0");
    assert!(
        has(&heavy, "gravity is 981 m/s², 100 times that of the Earth: are the units metres and seconds?"),
        "{heavy:?}"
    );
}
