//! Probes that are valid and measure nothing, or something else: what is remarked on each, and on what is near it not.

use super::tests::{PLATE, TANK, WATER, plain};
use super::trap_tests::has;

fn probe(keys: &str) -> String {
    format!("[[probe]]\nname = \"p\"\n{keys}\n")
}

/// Remarks on water beside a plate in a tank, and a probe.
fn of(keys: &str) -> Vec<String> {
    plain(&[TANK, WATER, PLATE, &probe(keys)])
}

#[test]
fn a_box_of_forces_without_particles() {
    let within =
        |shape: &str, box_: &str| of(&format!("kind = \"force\"\nshape = \"{shape}\"\nwithin = {box_}"));
    let dry = within("tank", "{ min = [0.3, 0.0], max = [0.35, 0.1] }");
    let said = "the probe `p` measures 0 throughout: its `within`, [0.3, 0] to [0.35, 0.1], holds no particle of \
                `tank`, the nearest of which is at [";
    assert!(dry.len() == 1 && dry[0].starts_with(said), "{dry:?}");
    assert_eq!(within("tank", "{ min = [0.3, -0.01], max = [0.35, 0.1] }"), [""; 0], "a piece of the floor");
    let thin = "kind = \"moment\"\nabout = [0.2, 0.0]\nwithin = { min = [0.2, 0.05], max = [0.202, 0.1] }";
    assert!(has(&of(thin), "holds no particle of `solid`"), "{:?}", of(thin));
    assert_eq!(of(&thin.replace("0.202", "0.209")), [""; 0]);
}

#[test]
fn an_axis_in_millimetres() {
    let about = |x: f64| of(&format!("kind = \"moment\"\nshape = \"tank\"\nabout = [{x}, 0.0]"));
    let said = "the probe `p` takes moments about [200, 0], 199.6 m beside the scene, 464 times its size: lengths are \
                in metres";
    assert_eq!(about(200.0), [said]);
    assert_eq!(about(10.0), [""; 0]);
}

#[test]
fn what_a_clamp_holds() {
    let at = |kind: &str, y: f64| of(&format!("kind = \"{kind}\"\nat = [0.21, {y}]"));
    let said = "the displacement of the probe `p` is 0 throughout: a clamp of `plate` holds what it looks at (the \
                nearest that is free is at [0.2075, 0.0125])";
    assert_eq!(at("displacement", 0.0), [said]);
    assert!(has(&at("position", 0.0), "the position of the probe `p` never changes"));
    assert_eq!(at("displacement", 0.1), [""; 0]);
    assert_eq!(at("stress", 0.0), [""; 0], "two rows are next to what is free");
    let deep = PLATE.replace("0.01] }", "0.03] }");
    let in_clamp = plain(&[TANK, WATER, &deep, &probe("kind = \"stress\"\nat = [0.21, 0.0]")]);
    assert!(has(&in_clamp, "the stress of the probe `p` is 0 throughout"), "{in_clamp:?}");
    // What moves along with its clamp is measured to be so.
    let moved = PLATE.replace("phase = ", "motion = { amplitude = [0.01, 0.0], period = 1.0 }\nphase = ");
    let found = plain(&[TANK, WATER, &moved, &probe("kind = \"displacement\"\nat = [0.21, 0.0]")]);
    assert!(!has(&found, "throughout"), "{found:?}");
}

#[test]
fn a_point_beside_its_solid() {
    let at = |y: f64| of(&format!("kind = \"displacement\"\nat = [0.21, {y}]"));
    let said = "the probe `p` at [0.21, 0.109] is beside `plate`: it measures the displacement of its nearest \
                particle, at [0.2075, 0.0975], 0.01177 m away";
    assert_eq!(at(0.109), [said]);
    assert_eq!(at(0.104), [""; 0]);
}

#[test]
fn probes_in_walls() {
    let found = of("kind = \"velocity\"\nat = [-0.007, 0.05]");
    let said = "the probe `p` at [-0.007, 0.05] is in a wall: it measures the fluid beside the wall, up to 2h = 0.015 \
                m away";
    assert_eq!(found, [said]);
    assert_eq!(of("kind = \"velocity\"\nat = [0.0, 0.05]"), [""; 0], "at the face");
    assert_eq!(of("kind = \"velocity\"\nat = [0.39, 0.25]"), [""; 0], "where water may splash");
    let block =
        "[[shape]]\nname = \"block\"\nphase = \"wall\"\nbox = { min = [0.3, 0.0], max = [0.36, 0.06] }\n";
    let beside = |keys: &str| plain(&[TANK, WATER, block, PLATE, &probe(keys)]);
    let within = beside("kind = \"pressure\"\nat = [0.33, 0.03]");
    let said = "the probe `p` at [0.33, 0.03] is in a wall: no fluid comes within 2h = 0.015 m of it, and it measures \
                0 throughout";
    assert_eq!(within, [said]);
    assert_eq!(beside("kind = \"pressure\"\nat = [0.31, 0.03]"), [""; 0], "near its face");
    assert_eq!(beside("kind = \"pressure\"\nfrom = [0.33, 0.03]\nto = [0.33, 0.08]"), [""; 0]);
    // A wall that moves may leave the place.
    let moves = block.replace("phase", "motion = { velocity = [0.0, 1.0] }\nphase");
    let found = plain(&[TANK, WATER, &moves, PLATE, &probe("kind = \"pressure\"\nat = [0.33, 0.03]")]);
    assert!(!has(&found, "is in a wall"), "{found:?}");
}

#[test]
fn gauges_and_lines_in_walls() {
    let gauge = |x: f64| of(&format!("kind = \"water-level\"\nx = {x}"));
    let said = "the gauge `p` at x = 0.41 m has walls alone below and above it: fluid comes there over their top at \
                most";
    assert_eq!(gauge(0.41), [said]);
    assert_eq!(gauge(0.404), [""; 0], "it looks at what is within a spacing");
    let front = |to: f64| {
        let water = WATER.replace("max = [0.1, 0.1]", &format!("max = [{to}, 0.1]"));
        plain(&[TANK, &water, PLATE, &probe("kind = \"front\"")])
    };
    let said = "the front `p` is 0.4 m throughout: it is the farthest reach along +x, where the fluid begins at a wall";
    assert!(has(&front(0.4), said), "{:?}", front(0.4));
    assert!(!has(&front(0.35), "throughout"));
    let flux = |from: &str, to: &str| of(&format!("kind = \"flux\"\nfrom = {from}\nto = {to}"));
    let said = "the flux `p` is 0 throughout: a wall is beside all of its line, [0.25, 0] to [0.39, 0], and nothing \
                crosses it";
    assert_eq!(flux("[0.25, 0.0]", "[0.39, 0.0]"), [said]);
    assert_eq!(flux("[0.3, 0.0]", "[0.3, 0.2]"), [""; 0]);
    assert_eq!(flux("[0.25, 0.02]", "[0.39, 0.02]"), [""; 0]);
}

#[test]
fn probes_in_a_paddle() {
    let paddle = |stroke: f64| {
        let lines = format!("motion = {{ amplitude = [{stroke}, 0.0], period = 1.0 }}\n");
        format!(
            "[[shape]]\nname = \"paddle\"\nphase = \"wall\"\nbox = {{ min = [0.3, 0.0], max = [0.38, 0.2] }}\n{lines}"
        )
    };
    let on = |keys: &str, stroke: f64| plain(&[&paddle(stroke), TANK, WATER, PLATE, &probe(keys)]);
    let gauge = "kind = \"water-level\"\nx = 0.34";
    let said = "the gauge `p` at x = 0.34 m is in `paddle` throughout, which moves: no fluid comes there";
    assert!(has(&on(gauge, 0.03), said), "{:?}", on(gauge, 0.03));
    // It goes by 40 mm to both sides of the gauge, which is 40 mm from its faces.
    assert!(!has(&on(gauge, 0.04), "throughout"), "{:?}", on(gauge, 0.04));
    for kind in ["pressure", "velocity"] {
        let point = format!("kind = \"{kind}\"\nat = [0.34, 0.1]");
        let said =
            "the probe `p` at [0.34, 0.1] is in `paddle` throughout, which moves: no fluid comes there";
        assert!(has(&on(&point, 0.02), said), "{kind}: {:?}", on(&point, 0.02));
        // Fluid is within 2h of it, 15 mm.
        assert!(!has(&on(&point, 0.03), "throughout"), "{kind}: {:?}", on(&point, 0.03));
    }
}

#[test]
fn a_gauge_that_begins_dry_beside_water_below_zero() {
    let of = |floor: f64, x: f64| {
        let down = |text: &str| {
            let raised = |text: String, y: f64| text.replace(&format!("{y:.1}]"), &format!("{}]", floor + y));
            raised(raised(text.replace("0.0], max", &format!("{floor}], max")), 0.3), 0.1)
        };
        plain(&[&down(TANK), &down(WATER), PLATE, &probe(&format!("kind = \"water-level\"\nx = {x}"))])
    };
    let said = "the gauge `p` begins dry at x = 0.3 m, and stands at 0 there until water comes: a level that water can \
                have, since the lowest place of the fluid is y = -0.2 m";
    assert!(has(&of(-0.2, 0.3), said), "{:?}", of(-0.2, 0.3));
    assert!(has(&of(0.5, 0.3), "below its floor, since the lowest place of the fluid is y = 0.5 m"));
    assert!(!has(&of(0.0, 0.3), "begins dry"));
    assert!(!has(&of(-0.2, 0.1), "begins dry"));
}
