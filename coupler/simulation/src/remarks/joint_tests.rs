//! Rigid bodies whose masses and joints are hardly meant: what is remarked on each, and on what is near it not.

use super::trap_tests::{has, on};

/// Remarks on a rigid flap of 0.04 x 0.3 m, 500 kg/m³, in a tank, with keys of its solid and its shape.
fn flap(keys: &str, lines: &str) -> Vec<String> {
    on(&format!(
        "resolution = 0.01\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[solid]\nmodel = \"rigid\"\ndensity = 500.0\n\
         {keys}\n[[shape]]\nname = \"flap\"\nphase = \"solid\"\nbox = {{ min = [0.48, 0.02], max = [0.52, 0.32] }}\n\
         {lines}\n[[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
         tank = {{ min = [0.0, 0.0], max = [1.0, 0.5], open = [\"top\"] }}\n[[shape]]\nname = \"water\"\n\
         phase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [1.0, 0.2] }}\npressure = \"hydrostatic\"\n"
    ))
}

fn given(keys: &str) -> Vec<String> {
    flap(&format!("bodies = [{{ name = \"flap\", {keys} }}]"), "")
}

fn joint(name: &str, kind: &str, keys: &str) -> String {
    format!("{{ name = \"{name}\", kind = \"{kind}\", body = \"flap\", {keys} }}")
}

fn jointed(joints: &[String], lines: &str) -> Vec<String> {
    flap(&format!("joints = [{}]", joints.join(", ")), lines)
}

fn hinged(keys: &str) -> Vec<String> {
    jointed(&[joint("pin", "hinge", keys)], "")
}

const FOOT: &str = "at = [0.5, 0.02]";

/// Two floats that touch, and a hinge between them.
#[test]
fn what_a_hinge_ties_does_not_part() {
    let second =
        "[[shape]]\nname = \"arm\"\nphase = \"solid\"\nbox = { min = [0.52, 0.22], max = [0.72, 0.26] }\n";
    let parts = "`flap` and `arm` touch and are bodies of their own, which repel each other and may part";
    let foot = joint("foot", "hinge", FOOT);
    let found = jointed(std::slice::from_ref(&foot), second);
    assert!(has(&found, parts), "{found:?}");
    let elbow = joint("elbow", "hinge", "with = \"arm\", at = [0.52, 0.24]");
    let found = jointed(&[foot, elbow], second);
    assert!(!has(&found, "may part"), "{found:?}");
}

#[test]
fn masses_of_another_unit() {
    assert_eq!(given("mass = 5.0"), [""; 0]);
    let heavy = given("mass = 5000.0");
    let said = "mass = 5000 kg/m of body `flap` makes 416700 kg/m³ of it, 833.3 times its shapes' 6 kg/m: is the unit \
                right? (a metre across the plane)";
    assert!(has(&heavy, said), "{heavy:?}");
    assert!(has(&given("mass = 0.02"), "makes 1.667 kg/m³ of it"), "{:?}", given("mass = 0.02"));
    // Hollow, and full of lead.
    for mass in ["0.7", "29.0"] {
        assert_eq!(given(&format!("mass = {mass}")), [""; 0], "{mass}");
    }
}

#[test]
fn moments_of_inertia_that_no_mass_has() {
    // 6 kg/m of 0.3 m x 0.04 m: m (a² + b²) / 12 = 0.0458; at most m (a² + b²) / 4 = 0.137.
    let much = given("inertia = 0.2");
    let said = "inertia = 0.2 kg m of body `flap` is more than its mass can have: 6 at its farthest corner have \
                0.1402 kg m, and its shapes 0.0458";
    assert!(has(&much, said), "{much:?}");
    let little = given("inertia = 1e-4");
    let said = "inertia = 0.0001 kg m of body `flap` is 0.002183 times that of its shapes with its mass, 0.0458 kg m";
    assert!(has(&little, said), "{little:?}");
    for inertia in ["0.13", "0.03", "0.001"] {
        assert_eq!(given(&format!("inertia = {inertia}")), [""; 0], "{inertia}");
    }
}

#[test]
fn a_centre_of_mass_beside_the_body() {
    let found = given("center = [0.02, 0.15]");
    let said = "the centre of mass of body `flap`, [0.02, 0.15], lies 0.46 m beside its shapes";
    assert!(has(&found, said), "{found:?}");
    assert_eq!(given("center = [0.5, 0.05]"), [""; 0]);
}

#[test]
fn hinges_in_degrees() {
    let stops = hinged(&format!("{FOOT}, limits = [-30.0, 30.0]"));
    let said = "limits = [-30, 30] of the hinge `pin` are in radians, -1719 to 1719 degrees: [-0.5236, 0.5236] if \
                degrees are meant";
    assert!(has(&stops, said), "{stops:?}");
    let rest = hinged(&format!("{FOOT}, stiffness = 10.0, rest = 45.0"));
    let said = "rest = 45 of the hinge `pin` is in radians, 2578 degrees: 0.7854 if degrees are meant";
    assert!(has(&rest, said), "{rest:?}");
    // A quarter and a turn; no stop on one side; a spring that is wound up.
    for keys in ["limits = [-1.5708, 6.2832]", "limits = [-0.5, 1e3]", "stiffness = 0.1, rest = 12.57"] {
        let found = hinged(&format!("{FOOT}, {keys}"));
        assert!(!has(&found, "in radians"), "{keys}: {found:?}");
    }
}

#[test]
fn a_spring_far_from_its_rest() {
    let spring = |keys: &str| {
        jointed(&[joint("line", "spring", &format!("at = [0.5, 0.02], to = [0.5, 0.0], {keys}"))], "")
    };
    // 6 kg/m weigh 58.9 N/m.
    let found = spring("stiffness = 1000.0, rest = 2.0");
    let said = "the spring `line` begins 0.02 m long and rests at 2 m: it pushes `flap` with 34 times its weight at \
                the start";
    assert!(has(&found, said), "{found:?}");
    for keys in ["stiffness = 1000.0, rest = 1.0", "stiffness = 1e6", "damping = 10.0"] {
        assert!(!has(&spring(keys), "the spring"), "{keys}: {:?}", spring(keys));
    }
}

#[test]
fn velocities_that_joints_take() {
    let moving = |joint: String, v: &str| jointed(&[joint], &format!("velocity = {v}"));
    let said = "the velocity that `flap` begins with is lost at the joint `pin`: the joint holds it";
    assert!(has(&moving("{ name = \"pin\", kind = \"fixed\", body = \"flap\" }".into(), "[1.0, 0.0]"), said));
    let rail = || joint("rail", "rail", "at = [0.5, 0.2], axis = [0.0, 1.0]");
    let across = moving(rail(), "[1.0, 0.0]");
    assert!(has(&across, "is lost at the joint `rail`: it is across the rail"), "{across:?}");
    assert!(!has(&moving(rail(), "[1.0, 1.0]"), "is lost"));
    assert!(!has(&moving(joint("pin", "hinge", FOOT), "[1.0, 0.0]"), "is lost"));
    let along = moving(joint("pin", "hinge", FOOT), "[0.0, 1.0]");
    assert!(has(&along, "is lost at the joint `pin`: it is along the arm"), "{along:?}");
    let turning = |turns: bool| {
        let rail = joint("rail", "rail", &format!("at = [0.5, 0.2], axis = [0.0, 1.0], turns = {turns}"));
        flap(&format!("bodies = [{{ name = \"flap\", angular_velocity = 3.0 }}]\njoints = [{rail}]"), "")
    };
    let said = "the angular velocity that `flap` begins with is lost at the joint `rail`: the rail does not let it turn";
    assert!(has(&turning(false), said), "{:?}", turning(false));
    assert!(!has(&turning(true), "is lost"));
}

#[test]
fn keys_that_do_nothing() {
    let found = hinged(&format!("{FOOT}, rest = 0.2"));
    assert!(has(&found, "rest = 0.2 of the joint `pin` does nothing: it has no `stiffness`"), "{found:?}");
    let found = hinged(&format!("{FOOT}, rest = 0.2, stiffness = 1000.0"));
    assert!(!has(&found, "does nothing"), "{found:?}");
    let bodies = "bodies = [{ name = \"flap\", angular_velocity = 3.0 }]";
    let found = flap(bodies, "motion = { amplitude = [0.01, 0.0], period = 1.0 }");
    let said =
        "the angular velocity of the body `flap` does nothing: the `motion` of `flap` says how it moves";
    assert!(has(&found, said), "{found:?}");
    assert!(!has(&flap(bodies, ""), "does nothing"));
}

#[test]
fn hinges_that_are_nowhere_near() {
    // The flap is 0.3 m long.
    for (at, told) in [("[0.5, -2.5]", true), ("[0.5, -0.1]", false)] {
        let found = hinged(&format!("at = {at}"));
        assert_eq!(has(&found, "the hinge `pin` is"), told, "{found:?}");
    }
}

#[test]
fn joints_that_lock() {
    let hinge = |name: &str, y: f64| joint(name, "hinge", &format!("at = [0.5, {y}]"));
    let rail = |name: &str, axis: &str| joint(name, "rail", &format!("at = [0.5, 0.2], axis = {axis}"));
    let said = "`flap` cannot move: the joints `a` and `b` leave no way together";
    for pair in [
        [hinge("a", 0.02), hinge("b", 0.2)],
        [hinge("a", 0.02), rail("b", "[0.0, 1.0]")],
        [rail("a", "[1.0, 0.0]"), rail("b", "[0.0, 1.0]")],
    ] {
        assert!(has(&jointed(&pair, ""), said), "{:?}", jointed(&pair, ""));
    }
    let spring = joint("b", "spring", "at = [0.5, 0.3], to = [0.5, 0.5], stiffness = 10.0");
    for pair in [
        [hinge("a", 0.02), hinge("b", 0.02)],
        [hinge("a", 0.02), spring],
        [rail("a", "[0.0, 1.0]"), rail("b", "[0.0, -1.0]")],
    ] {
        assert!(!has(&jointed(&pair, ""), "cannot move"), "{pair:?}");
    }
}

#[test]
fn a_hinge_that_a_turn_leaves_behind() {
    let turned = |lines: &str| jointed(&[joint("pin", "hinge", FOOT)], lines);
    let said = "the joint `pin` is where `flap` would be without `rotate` and `translate`, which do not take its `at` along: \
                it is ";
    let found = turned("rotate = { angle = 20.0, about = [0.5, 0.17] }");
    assert!(has(&found, said), "{found:?}");
    assert!(has(&turned("translate = [0.1, 0.0]"), "along: it is 0.08 m beside it"));
    assert!(!has(&turned("rotate = { angle = 20.0, about = [0.5, 0.02] }"), "the joint `pin`"));
}

#[test]
fn a_hinge_far_from_its_flap() {
    let found = hinged("at = [0.02, 0.5]");
    let said = "the hinge `pin` is 0.494 m away from `flap`, which is 0.3 m long";
    assert!(has(&found, said), "{found:?}");
    // Just above it, and a float on an arm.
    assert_eq!(hinged("at = [0.5, 0.45]"), [""; 0]);
    let float = "box = { min = [0.46, 0.15], max = [0.54, 0.25] }";
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\n[solid]\nmodel = \"rigid\"\ndensity = 500.0\n\
         joints = [{}]\n[[shape]]\nname = \"flap\"\nphase = \"solid\"\n{float}\n",
        joint("pin", "hinge", "at = [0.0, 0.5]")
    );
    assert!(!has(&on(&text), "the hinge"), "{:?}", on(&text));
}

#[test]
fn a_rail_that_is_somewhere_else() {
    let rail = |at: &str| jointed(&[joint("rail", "rail", &format!("{at}, axis = [0.0, 1.0]"))], "");
    let said = "the rail `rail` is 1000000 m away from `flap`, which is 0.3 m long: it is held at the end of an arm that is \
                not there";
    assert!(has(&rail("at = [1e6, 0.1]"), said), "{:?}", rail("at = [1e6, 0.1]"));
    assert!(!has(&rail("at = [1.0, 0.1]"), "the rail"));
}
