//! Walls that are turned, lean or meet another wall, and what moves into each other: what is remarked on, and what is
//! near it not.

use super::remarks;
use super::tank_tests::{basin, beside, of, wall, water};
use super::trap_tests::has;
use halfstep_scene::parse;
use std::path::Path;

#[test]
fn a_ramp_of_part_of_a_row() {
    let ramp = |thick: f64| {
        let geometry = format!(
            "box = {{ min = [0.35, 0.0], max = [0.85, {thick}] }}\nrotate = {{ angle = 15, about = [0.35, 0.0] }}"
        );
        beside(&wall("ramp", &geometry))
    };
    let said = "the top of `ramp`, before `rotate`, is at 0.045 m in the scene and at 0.05 m as computed, and fluid \
                comes there";
    assert!(has(&ramp(0.045), said), "{:?}", ramp(0.045));
    assert!(!has(&ramp(0.05), "the top of"), "{:?}", ramp(0.05));
}

#[test]
fn a_corner_between_two_walls() {
    let wedge = |angle: f64, x: f64| {
        let geometry = format!(
            "box = {{ min = [{x}, 0.0], max = [{}, 0.05] }}\nrotate = {{ angle = {angle}, about = [{x}, 0.0] }}",
            x + 0.2
        );
        beside(&wall("ramp", &geometry))
    };
    // Its underside leaves the floor at its foot, away from the water that falls.
    let said =
        "fluid comes into the corner between `ramp` and `tank` at [0.6, 0], whose sides meet at 20 degrees";
    assert!(has(&wedge(20.0, 0.6), said), "{:?}", wedge(20.0, 0.6));
    assert!(!has(&wedge(40.0, 0.6), "sides meet"), "{:?}", wedge(40.0, 0.6));
    assert!(!has(&wedge(0.0, 0.6), "sides meet"), "{:?}", wedge(0.0, 0.6));
}

#[test]
fn a_wall_that_leans_without_its_foot() {
    let leaning = |foot: f64| {
        let geometry = format!(
            "box = {{ min = [0.35, {foot}], max = [0.4, 0.35] }}\nrotate = {{ angle = -30, about = [0.35, {foot}] }}"
        );
        beside(&wall("leaning", &geometry))
    };
    let said = "between `leaning` and `tank` is a gap of ";
    // Its lowest corner is 0.05 sin 30 degrees = 25 mm below what it is turned about.
    assert!(has(&leaning(0.04), said), "{:?}", leaning(0.04));
    assert!(!has(&leaning(0.025), said), "{:?}", leaning(0.025));
    assert!(!has(&leaning(0.1), said), "{:?}", leaning(0.1));
}

#[test]
fn two_that_move_into_each_other() {
    let blade = |name: &str, x: f64, keys: &str| {
        let motion = format!("motion = {{ angular_velocity = 6.28, pivot = [{x}, 0.1] }}");
        let block = format!("box = {{ min = [{}, 0.08], max = [{}, 0.12] }}", x - 0.08, x + 0.08);
        wall(name, &format!("{block}\n{keys}{motion}"))
    };
    let both = |x: f64| beside(&(blade("one", 0.12, "") + &blade("other", x, "rotate = { angle = 90 }\n")));
    assert!(has(&both(0.24), "`one` turns into `other` from about "), "{:?}", both(0.24));
    assert!(!has(&both(0.24), "`other` turns into `one`"), "once");
    assert!(!has(&both(0.36), "turns into"), "{:?}", both(0.36));
    // A tank is looked at from what turns in it, wherever it stands in the file.
    let keys = "motion = { angle = 0.05, period = 1.0, pivot = [0.5, 0.0] }";
    let rolls =
        wall("tank", &format!("tank = {{ min = [0.0, 0.0], max = [1.0, 0.4], open = [\"top\"] }}\n{keys}"));
    let blade = wall(
        "blade",
        "box = { min = [0.1, 0.04], max = [0.26, 0.08] }\nmotion = { angular_velocity = 6.28, pivot = [0.18, 0.06] }",
    );
    let found = of(&format!("{rolls}{blade}{}", water([0.0, 0.3, 0.2])));
    assert!(has(&found, "`blade` turns into `tank` from about "), "{found:?}");
    let plunger = |name: &str, x: f64, way: f64| {
        let block = format!("box = {{ min = [{x}, 0.0], max = [{}, 0.3] }}", x + 0.05);
        wall(name, &format!("{block}\nmotion = {{ amplitude = [{way}, 0.0], period = 2.0 }}"))
    };
    let plungers = |way: f64| beside(&(plunger("left", 0.02, way) + &plunger("right", 0.2, -way)));
    let said = "`left` and `right` move into each other from about ";
    assert!(has(&plungers(0.1), said), "{:?}", plungers(0.1));
    assert!(!has(&plungers(0.05), said), "{:?}", plungers(0.05));
}

#[test]
fn a_pipe_that_begins_full() {
    let pile = |void: &str| {
        let ring = wall("pile", "ring = { center = [0.15, 0.1], inner = 0.04, outer = 0.08 }");
        of(&format!("{ring}{}{void}{}", basin(), water([0.0, 0.3, 0.2])))
    };
    let said = "of the particles of `water` begin in the hollow of `pile`, and what they do to it is in its forces (a \
                void listed before `water` leaves them out)";
    assert!(has(&pile(""), said), "{:?}", pile(""));
    let void =
        "[[shape]]\nname = \"air\"\nphase = \"void\"\ndisc = { center = [0.15, 0.1], radius = 0.06 }\n";
    assert!(!has(&pile(void), "in the hollow of"), "{:?}", pile(void));
}

#[test]
fn a_surface_that_is_not_across_gravity() {
    let under = |gravity: &str, shape: &str| {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\ngravity = {gravity}\n[fluid]\ndensity = 1000.0\n{}[[shape]]\nname = \
             \"water\"\nphase = \"fluid\"\npressure = \"hydrostatic\"\n{shape}\n",
            wall("tank", "tank = { min = [0.0, 0.0], max = [0.4, 0.4], open = [\"top\"] }")
        );
        remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
    };
    let level = "box = { min = [0.0, 0.0], max = [0.4, 0.2] }";
    let found = under("[2.0, -9.6]", level);
    // The surface rises to the right: the left corner is the highest, the right one 0.4 2.0 / 9.806 m deeper.
    let said = "`water` begins with pressure at its free surface, up to that of 0.085";
    assert!(has(&found, said), "{found:?}");
    assert!(!has(&under("[0.0, -9.81]", level), "free surface"));
    let across = "polygon = [[0.0, 0.0], [0.4, 0.0], [0.4, 0.283], [0.0, 0.2]]";
    assert!(!has(&under("[2.0, -9.6]", across), "free surface"), "{:?}", under("[2.0, -9.6]", across));
}
