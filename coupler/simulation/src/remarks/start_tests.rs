//! Scenes whose beginning, measures or motions are other than their author thinks: what is remarked on each, and on
//! what is near it not.

use super::tests::{PLATE, TANK, WATER, plain};
use super::trap_tests::{has, on, with};

/// Remarks on a scene of water with these lines at its head and these shapes.
fn water(head: &str, rest: &str) -> Vec<String> {
    on(&format!("resolution = 0.005\nend_time = 1.0\n{head}\n[fluid]\ndensity = 1000.0\n{rest}"))
}

/// The same with a rigid solid.
fn rigid(keys: &str, rest: &str) -> Vec<String> {
    water("", &format!("[solid]\nmodel = \"rigid\"\n{keys}\n{rest}"))
}

fn shape(name: &str, phase: &str, min: [f64; 2], max: [f64; 2], lines: &str) -> String {
    format!(
        "[[shape]]\nname = \"{name}\"\nphase = \"{phase}\"\nbox = {{ min = {min:?}, max = {max:?} }}\n{lines}\n"
    )
}

const DEEP: &str = "[[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.4, 0.2] }\n\
                    pressure = \"hydrostatic\"\n";

#[test]
fn a_frame_that_is_shaken_too_hard() {
    let shaken = |period: f64| {
        let motion = format!("[frame]\nmotion = {{ amplitude = [0.01, 0.0], period = {period} }}");
        water(&motion, &format!("{TANK}{DEEP}"))
    };
    // A (2 pi / T)²: 158 m/s² at 0.05 s, 39 m/s² at 0.1 s.
    assert!(
        has(&shaken(0.05), "the `[frame]` is accelerated by up to 157.9 m/s², 16 times gravity"),
        "{:?}",
        shaken(0.05)
    );
    assert!(!has(&shaken(0.1), "is accelerated by"));
}

#[test]
fn what_pushes_water_at_once() {
    let hull = |motion: &str| {
        rigid("density = 500.0", &(shape("hull", "solid", [0.15, 0.15], [0.25, 0.25], motion) + DEEP + TANK))
    };
    let said = "`hull` moves at 0.6283 m/s at once";
    let heaves = "motion = { amplitude = [0.0, 0.05], period = 0.5 }";
    assert!(has(&hull(heaves), said), "{:?}", hull(heaves));
    assert!(!has(&hull("motion = { amplitude = [0.0, 0.05], period = 0.5, ramp = 0.5 }"), "at once"));
    let tank = |velocity: &str| {
        water(
            "",
            &format!("{}{DEEP}", with(TANK, &format!("motion = {{ velocity = {velocity}, end = 0.2 }}\n"))),
        )
    };
    assert!(has(&tank("[0.5, 0.0]"), "`tank` moves at 0.5 m/s at once"), "{:?}", tank("[0.5, 0.0]"));
    assert!(!has(&tank("[0.05, 0.0]"), "at once"));
    // A gate that is pulled up along its faces pushes with its edge alone.
    let gate = shape("gate", "wall", [0.2, 0.0], [0.21, 0.3], "motion = { velocity = [0.0, 1.0] }");
    let lifted = water("", &format!("{gate}{DEEP}{TANK}"));
    assert!(!has(&lifted, "at once"), "{lifted:?}");
}

#[test]
fn a_current_that_nothing_feeds() {
    let flume = TANK.replace("[\"top\"]", "[\"top\", \"left\", \"right\"]");
    let flows = with(DEEP, "velocity = [0.5, 0.0]\n");
    let found = water("", &format!("{flows}{flume}"));
    assert!(has(&found, "`water` flows out of the scene toward the right"), "{found:?}");
    // A drop that is thrown may leave.
    let drop = shape("drop", "fluid", [0.35, 0.1], [0.4, 0.15], "velocity = [0.5, 0.0]");
    assert!(!has(&water("", &format!("{drop}{WATER}{flume}")), "`drop` flows out"));
}

#[test]
fn water_that_begins_under_pressure_at_its_surface() {
    let steps = "[[shape]]\nname = \"water\"\nphase = \"fluid\"\npressure = \"hydrostatic\"\n\
                 polygon = [[0.0, 0.0], [0.4, 0.0], [0.4, 0.05], [0.2, 0.05], [0.2, 0.2], [0.0, 0.2]]\n";
    let found = water("", &format!("{steps}{TANK}"));
    let said = "`water` begins with pressure at its free surface, up to that of 0.1525 m of water: `hydrostatic` counts from \
                the highest point of a shape, and 50 % of its surface is lower";
    assert!(has(&found, said), "{found:?}");
    assert!(!has(&water("", &format!("{DEEP}{TANK}")), "begins with pressure"));
    // Below a plate that covers it, water is under pressure.
    let lid = shape("lid", "wall", [0.1, 0.1], [0.4, 0.12], "");
    assert!(!has(&water("", &format!("{lid}{DEEP}{TANK}")), "begins with pressure"));
}

/// 0.2 m of water: 1962 Pa, of which a half compresses it by g H² / 2 c².
#[test]
fn still_water_that_begins_without_its_pressure() {
    let without = DEEP.replace("pressure = \"hydrostatic\"\n", "");
    let said =
        "`water` is held on all sides and begins without the pressure of its depth, 1.962e3 Pa at the bottom";
    let found = water("", &format!("{without}{TANK}"));
    assert!(has(&found, said), "{found:?}");
    assert!(!has(&water("", &format!("{DEEP}{TANK}")), "without the pressure"));
    // A column that collapses, one that a gate holds, and a layer.
    let column = without.replace("0.4, 0.2", "0.2, 0.2");
    assert!(!has(&water("", &format!("{column}{TANK}")), "without the pressure"));
    let gate = shape("gate", "wall", [0.2, 0.0], [0.22, 0.2], "");
    assert!(has(&water("", &format!("{column}{gate}{TANK}")), "without the pressure"));
    let layer = without.replace("0.4, 0.2", "0.4, 0.02");
    assert!(!has(&water("", &format!("{layer}{TANK}")), "without the pressure"));
}

#[test]
fn pivots_that_stay_where_they_are() {
    let flap = |lines: &str| {
        let motion = "motion = { angle = 0.1, period = 1.0, pivot = [0.1, 0.0], ramp = 1.0 }";
        let flap = shape("flap", "wall", [0.09, 0.0], [0.11, 0.15], &format!("{motion}\n{lines}"));
        water("", &format!("{flap}{DEEP}{TANK}"))
    };
    let all = "all 3 copies of `flap` turn about the one `pivot`, [0.1, 0]";
    assert!(has(&flap("repeat = { count = 3, step = [0.1, 0.0] }"), all));
    let beside = "`flap` turns about [0.1, 0], where it would be without `translate`";
    assert!(has(&flap("translate = [0.1, 0.0]"), beside), "{:?}", flap("translate = [0.1, 0.0]"));
    assert!(!has(&flap(""), "turn"), "{:?}", flap(""));
}

#[test]
fn forces_on_a_part_of_what_feels_the_fluid() {
    let probe = |keys: &str, within: [[f64; 2]; 2]| {
        let [min, max] = within;
        let within = format!("within = {{ min = {min:?}, max = {max:?} }}");
        plain(&[
            TANK,
            WATER,
            PLATE,
            &format!("[[probe]]\nname = \"p\"\nkind = \"force\"\n{keys}\n{within}\n"),
        ])
    };
    // h / dx is 1.5 beside solids: two rows.
    let said = "`within` of the probe `p` holds 1 of the 2 rows behind the surface that feel the fluid";
    let one = probe("shape = \"tank\"", [[-0.005, 0.0], [0.0, 0.1]]);
    assert!(has(&one, said) && has(&one, "a box that ends 0.01 m behind the surface"), "{one:?}");
    assert_eq!(probe("shape = \"tank\"", [[-0.01, 0.0], [0.0, 0.1]]), [""; 0]);
    assert!(has(&probe("", [[0.2, 0.0], [0.205, 0.1]]), said));
    assert_eq!(probe("", [[0.2, 0.02], [0.22, 0.05]]), [""; 0], "a piece of the plate");
    let held = probe("shape = \"plate\"", [[0.2, 0.0], [0.22, 0.01]]);
    assert!(has(&held, "the probe `p` looks at particles that a clamp holds"), "{held:?}");
    assert!(!has(&probe("shape = \"plate\"", [[0.2, 0.0], [0.22, 0.02]]), "that a clamp holds"));
}

#[test]
fn a_caisson_that_water_does_not_lift() {
    let caisson = |foot: f64, water: &str| {
        rigid(
            "density = 2400.0",
            &(shape("caisson", "solid", [0.15, foot], [0.25, foot + 0.15], "") + water + TANK),
        )
    };
    let said = "`caisson` stands on `tank` in the fluid: no fluid fits below it, so it has no uplift";
    assert!(has(&caisson(0.0, DEEP), said), "{:?}", caisson(0.0, DEEP));
    assert!(!has(&caisson(0.05, DEEP), "uplift"), "it sinks");
    assert!(!has(&caisson(0.0, WATER), "uplift"), "the water comes later");
}

#[test]
fn contact_of_what_a_hinge_holds() {
    let flap = |contact: &str, wall: &str| {
        let joint = "[[solid.joints]]\nname = \"pin\"\nkind = \"hinge\"\nbody = \"flap\"\nat = [0.21, 0.0]";
        let keys = format!("density = 700.0\n{contact}\n{joint}");
        rigid(&keys, &(shape("flap", "solid", [0.2, 0.0], [0.22, 0.15], "") + WATER + &with(TANK, wall)))
    };
    let rubs = "contact = { friction = 0.3 }";
    assert!(has(&flap(rubs, ""), "the `contact` of `solid` changes nothing"), "{:?}", flap(rubs, ""));
    assert!(!has(&flap(rubs, "contact = true\n"), "changes nothing"));
    assert!(!has(&flap("", ""), "changes nothing"));
}

#[test]
fn swings_about_another_level_and_levels_that_are_met_at_once() {
    let float = |metric: &str| {
        let probe = "[[probe]]\nname = \"box\"\nkind = \"body-position\"\nbody = \"box\"\n[[probe]]\nname = \"front\"\n\
                     kind = \"front\"\n";
        let shapes = shape("box", "solid", [0.15, 0.16], [0.25, 0.22], "") + DEEP + TANK;
        rigid("density = 500.0", &format!("{shapes}{probe}[[metric]]\nname = \"m\"\n{metric}\n"))
    };
    let said = "the metric `m` has level = 0 m, and box.y begins at 0.19 m: it does not swing about it";
    for kind in ["period", "decay"] {
        let found = float(&format!("probe = \"box.y\"\nkind = \"{kind}\""));
        assert!(has(&found, said), "{found:?}");
        let meant = float(&format!("probe = \"box.y\"\nkind = \"{kind}\"\nlevel = 0.18"));
        assert!(!has(&meant, "swing"), "{meant:?}");
    }
    let first = |level: f64| float(&format!("probe = \"front.x\"\nkind = \"first-above\"\nlevel = {level}"));
    assert!(has(&first(0.4), "begins there: the first stir is above it"), "{:?}", first(0.4));
}

#[test]
fn real_basins_and_foam_with_ballast() {
    // Of a length, half filled up to a level.
    let sea = |dx: f64, [long, level]: [f64; 2], end: f64| {
        on(&format!(
            "resolution = {dx}\nend_time = {end}\n[fluid]\ndensity = 1000.0\n{}{}",
            shape("sea", "fluid", [0.0, 0.0], [long, level], "pressure = \"hydrostatic\""),
            TANK.replace("[0.4, 0.3]", &format!("[{long:?}, {:?}]", 2.0 * level))
        ))
    };
    let basin = |end: f64| sea(4.0, [1700.0, 20.0], end);
    assert!(has(&basin(1.0), "the largest shape is 1700 m long: lengths are in metres"));
    assert!(!has(&basin(100.0), "lengths are in metres"), "{:?}", basin(100.0));
    // A scene of 600 by 400 mm: a wave of that length in metres needs 7.8 s.
    let in_mm = |end: f64| sea(10.0, [600.0, 200.0], end);
    assert!(has(&in_mm(3.9), "the largest shape is 600 m long: lengths are in metres"));
    assert!(!has(&in_mm(4.0), "lengths are in metres"), "{:?}", in_mm(4.0));
    let foam = |lines: &str| {
        let hull = shape("hull", "solid", [0.15, 0.16], [0.25, 0.22], "body = \"ship\"");
        let keel = shape("keel", "solid", [0.15, 0.15], [0.25, 0.16], &format!("body = \"ship\"\n{lines}"));
        rigid("density = 25.0", &(keel + &hull + DEEP + TANK))
    };
    assert!(has(&foam(""), "solid.density = 25 kg/m³ is very little"));
    assert!(!has(&foam("density = 2000.0"), "very little"), "{:?}", foam("density = 2000.0"));
}

#[test]
fn a_gauge_beside_a_body_that_floats() {
    let float = |keys: &str, lines: &str| {
        let probe = format!("[[probe]]\nname = \"p\"\nkind = \"pressure\"\n{keys}\n");
        rigid(
            &format!("density = 500.0\n{lines}"),
            &(shape("hull", "solid", [0.15, 0.16], [0.25, 0.22], "") + DEEP + TANK + &probe),
        )
    };
    let said = "the probe `p` at [0.2, 0.157] is fixed in space beside `hull`, which moves freely";
    assert!(has(&float("at = [0.2, 0.157]", ""), said), "{:?}", float("at = [0.2, 0.157]", ""));
    assert!(!has(&float("at = [0.2, 0.157]\nshape = \"hull\"", ""), "fixed in space"));
    assert!(!has(&float("at = [0.2, 0.1]", ""), "fixed in space"));
    let fixed = "[[solid.joints]]\nname = \"post\"\nkind = \"fixed\"\nbody = \"hull\"";
    assert!(!has(&float("at = [0.2, 0.157]", fixed), "fixed in space"));
}

#[test]
fn an_angle_that_a_rail_keeps() {
    let angle = |turns: &str| {
        let joint = format!(
            "[[solid.joints]]\nname = \"rail\"\nkind = \"rail\"\nbody = \"hull\"\nat = [0.2, 0.2]\naxis = [0.0, \
             1.0]\n{turns}"
        );
        let probe = "[[probe]]\nname = \"pitch\"\nkind = \"body-angle\"\nbody = \"hull\"\n";
        rigid(
            &format!("density = 500.0\n{joint}"),
            &(shape("hull", "solid", [0.15, 0.16], [0.25, 0.22], "") + DEEP + TANK + probe),
        )
    };
    let said =
        "the body-angle of the probe `pitch` is 0 throughout: the joint `rail` does not let `hull` turn";
    assert!(has(&angle(""), said), "{:?}", angle(""));
    assert!(!has(&angle("turns = true"), "throughout"));
}

#[test]
fn a_window_without_rows() {
    let metric = |from: f64, to: f64| {
        let lines = format!(
            "[[probe]]\nname = \"f\"\nkind = \"front\"\n[[metric]]\nname = \"m\"\nprobe = \"f.x\"\nkind = \
             \"mean\"\nfrom = {from}\nto = {to}\n"
        );
        water("[output]\nprobe_interval = 0.01", &format!("{WATER}{TANK}{lines}"))
    };
    let said =
        "the metric `m` looks from 0.9 to 0.901 s, and rows are 0.01 s apart: it holds one of them at most";
    assert_eq!(metric(0.9, 0.901), [said]);
    assert_eq!(metric(0.9, 0.92), [""; 0]);
}

#[test]
fn hollows_in_the_water() {
    let hollow = |min: [f64; 2], max: [f64; 2], rest: &str| {
        let void = shape("air", "void", min, max, "");
        water("", &format!("{rest}{void}{DEEP}{TANK}"))
    };
    let said =
        "the void `air` is empty, and no air: the fluid above 100 of its 100 empty places falls into it";
    assert!(has(&hollow([0.1, 0.05], [0.15, 0.1], ""), said), "{:?}", hollow([0.1, 0.05], [0.15, 0.1], ""));
    assert!(!has(&hollow([0.1, 0.15], [0.15, 0.2], ""), "no air"), "it is open above");
    let lid = shape("lid", "wall", [0.08, 0.1], [0.17, 0.12], "");
    assert!(!has(&hollow([0.1, 0.05], [0.15, 0.1], &lid), "no air"), "below a lid");
}
