//! Motions that are valid and hardly meant: what is remarked on each, and on what is near it not.

use super::meaning_tests::recorded;
use super::tests::{PLATE, TANK, WATER, plain};
use super::trap_tests::{has, on, with};
use super::wave_tests::with_paddle;

fn moved(motion: &str) -> Vec<String> {
    wet(&[&with(TANK, &format!("motion = {motion}\n")), WATER])
}

fn wet(parts: &[&str]) -> Vec<String> {
    on(&format!("resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n{}", parts.concat()))
}

#[test]
fn a_pivot_in_millimetres() {
    let rolls = |x: f64| moved(&format!("{{ angle = 0.07, period = 1.5, pivot = [{x}, 0.0], ramp = 0.5 }}"));
    let said = "the motion of `tank` turns about [200, 0], 199.6 m beside the scene, 454 times its size";
    assert!(has(&rolls(200.0), said), "{:?}", rolls(200.0));
    assert!(!has(&rolls(0.2), "turns about") && !has(&rolls(10.0), "turns about"));
}

#[test]
fn a_tank_that_rolls_by_degrees() {
    let rolls =
        |angle: f64| moved(&format!("{{ angle = {angle}, period = 9.0, pivot = [0.2, 0.0], ramp = 0.5 }}"));
    assert!(has(&rolls(1.5), "the motion of `tank` swings by 1.5 rad, 86 degrees: angles are in radians"));
    assert!(!has(&rolls(0.7), "radians"));
    let frame = |angle: f64| {
        let keys = format!(
            "[frame]\nmotion = {{ angle = {angle}, period = 9.0, pivot = [0.2, 0.0], ramp = 0.5 }}\n"
        );
        wet(&[TANK, WATER, &keys])
    };
    assert!(
        has(&frame(4.0), "the `[frame]` swings by 4 rad, 229 degrees: angles are in radians"),
        "{:?}",
        frame(4.0)
    );
    assert!(!has(&frame(0.1), "radians"));
}

#[test]
fn a_displacement_with_its_clamps_way() {
    let solid = "[solid]\ndensity = 1100.0\nyoungs_modulus = 12e6\npoissons_ratio = 0.4\n";
    let with = |wall: &str, probes: &[[f64; 2]]| {
        let plate = PLATE.replace("0.01] }", &format!("0.01]{wall} }}"));
        let probe = |(k, [x, y]): (usize, &[f64; 2])| {
            format!("[[probe]]\nname = \"p{k}\"\nkind = \"displacement\"\nat = [{x}, {y}]\n")
        };
        let probes: String = probes.iter().enumerate().map(probe).collect();
        let motion = "motion = { amplitude = [0.02, 0.0], period = 1.0, ramp = 0.5 }\n";
        wet(&[&super::trap_tests::with(TANK, motion), WATER, solid, &plate, &probes])
    };
    let said = "`p0` measures displacements in space, and the clamp of `plate` moves with `tank`: its way is in \
                it, up to 0.0";
    let along = ", with = \"tank\"";
    assert!(has(&with(along, &[[0.21, 0.1]]), said), "{:?}", with(along, &[[0.21, 0.1]]));
    assert!(!has(&with(along, &[[0.21, 0.1], [0.21, 0.0]]), "its way is in it"));
    assert!(!has(&with("", &[[0.21, 0.1]]), "its way is in it"));
}

#[test]
fn columns_of_rates_and_of_other_times() {
    let by = |time: &str, title: &str| {
        let columns = format!("{{ FILE, columns = {{ time = \"{time}\", x = \"{title}\" }} }}");
        recorded(&format!("{time},{title}"), "0,0\n500,0.01\n1000,0", &columns)
    };
    let said = "the motion of `tank` goes by the column `acc [m/s2]`, whose title says an acceleration: its numbers \
                are taken as ways in m, up to 0.01, and nothing integrates them";
    assert!(has(&by("t", "acc [m/s2]"), said), "{:?}", by("t", "acc [m/s2]"));
    for title in ["a (m/s^2)", "surge [mm/s2]", "Acceleration x"] {
        assert!(has(&by("t", title), "says an acceleration"), "{title}");
    }
    for title in ["v [m/s]", "vel", "u (cm/s)"] {
        assert!(has(&by("t", title), "says a velocity"), "{title}");
    }
    for title in ["x [m]", "velvet", "accumulated way [m]", "x"] {
        assert!(!has(&by("t [s]", title), "whose title"), "{title}");
    }
    let said = "the motion of `tank` takes the times of the column `t_ms`, whose title says ms, as seconds: they last \
                from 0 to 1000 s, and the run 1 s (times have no `scale`: in the file they need to be divided by 1000)";
    assert!(has(&by("t_ms", "x [m]"), said), "{:?}", by("t_ms", "x [m]"));
    assert!(has(&by("time (min)", "x [m]"), "need to be times 60"));
    assert!(!has(&by("time [s]", "x [m]"), "whose title") && !has(&by("items", "x [m]"), "whose title"));
}

#[test]
fn a_tank_that_begins_at_once() {
    let shaken = |keys: &str| moved(&format!("{{ amplitude = [0.05, 0.0], {keys} }}"));
    // 2 pi 0.05 / 1 = 0.314 m/s, and sqrt(9.81 0.1) = 0.990 m/s.
    let said = "`tank` moves at 0.3142 m/s at once, 0.32 of the speed of long waves in its water";
    assert!(has(&shaken("period = 1.0"), said), "{:?}", shaken("period = 1.0"));
    assert!(!has(&shaken("period = 1.0, ramp = 0.5"), "at once"));
    assert!(!has(&shaken("period = 1.6"), "at once"), "0.198 of it");
    assert!(!has(&shaken("period = 1.0, start = 2.0"), "at once"), "after the run");
    let record = |rows: &str| recorded("t,x", rows, "{ FILE, columns = { time = \"t\", x = \"x\" } }");
    assert!(has(&record("0,0\n0.1,0.05\n0.2,0.0\n0.3,-0.05\n0.4,0\n0.5,0\n2,0"), "at once"));
    assert!(!has(&record("0,0\n0.5,0\n1.0,0.01\n2,0"), "at once"));
    // A floor that goes to and fro under the water pushes nothing.
    let belt = "[[shape]]\nname = \"floor\"\nphase = \"wall\"\nbox = { min = [-0.3, -0.02], max = [0.4, 0.0] }\n\
                motion = { amplitude = [0.05, 0.0], period = 1.0 }\n";
    assert!(!has(&wet(&[belt, WATER]), "at once"), "{:?}", wet(&[belt, WATER]));
}

#[test]
fn a_frequency_for_a_period() {
    let shaken =
        |period: f64| moved(&format!("{{ amplitude = [0.05, 0.0], period = {period}, ramp = 0.1 }}"));
    let said = "`tank` pushes its fluid with up to 19740 m/s², 2012 times gravity";
    assert!(has(&shaken(0.01), said), "{:?}", shaken(0.01));
    assert!(!has(&shaken(0.2), "pushes its fluid"), "49 m/s², and some more while it begins");
}

#[test]
fn a_recording_that_ends_too_soon() {
    let record = |rows: &str| recorded("t,x", rows, "{ FILE, columns = { time = \"t\", x = \"x\" } }");
    let said = "the recording of `tank` ends at 0.4 s in the middle of its motion, at 0.08571 m/s";
    let cut = record("0,0\n0.1,0.01\n0.2,0.02\n0.3,0.01\n0.4,0");
    assert!(has(&cut, said) && has(&cut, "there `tank` stops at once and stays"), "{cut:?}");
    assert!(!has(&record("0,0\n0.1,0.01\n0.2,0.02\n0.3,0.01\n1,0"), "the recording"), "as long as the run");
    assert!(!has(&record("0,0\n0.1,0.01\n0.2,0.02\n0.3,0\n0.4,0\n0.5,0"), "the recording"), "at rest");
}

#[test]
fn a_motion_of_frame_and_tank() {
    let text = |motion: &str, of_frame: &str| wet(&[&with(TANK, motion), WATER, of_frame]);
    let motion = "motion = { amplitude = [0.01, 0.0], period = 0.7, ramp = 0.7 }\n";
    let frame = format!("[frame]\n{motion}");
    let said = "`tank` has the motion of the `[frame]` once more, so the fluid feels it twice";
    assert!(has(&text(motion, &frame), said), "{:?}", text(motion, &frame));
    assert_eq!(text("", &frame), [""; 0]);
    assert!(!has(&text(&motion.replace("0.7", "0.6"), &frame), "twice"));
}

#[test]
fn a_clamp_in_a_wall_that_moves() {
    let moving = TANK
        .replace("phase = \"wall\"", "phase = \"wall\"\nmotion = { amplitude = [0.01, 0.0], period = 1.0 }");
    let found = plain(&[
        &moving,
        WATER,
        &PLATE.replace("[0.2, 0.0], max = [0.22, 0.01]", "[0.2, -0.01], max = [0.22, 0.01]"),
    ]);
    assert_eq!(
        found,
        [
            "the clamp of `plate` stands in `tank`, which moves: the clamp stays where it is (`with = \"tank\"` at the \
          clamp takes it along)"
        ]
    );
}

#[test]
fn a_wall_that_goes_through_another_one() {
    let stop = |x: f64| {
        format!(
            "[[shape]]\nname = \"stop\"\nphase = \"wall\"\nbox = {{ min = [{x}, 0.0], max = [{}, 0.2] }}\n",
            x + 0.02
        )
    };
    let found = with_paddle("{ velocity = [0.1, 0.0] }", &stop(0.08));
    // More than half a spacing, 2.5 mm, after 80 mm: 0.825 s.
    assert!(found.iter().any(|r| r.starts_with("`paddle` goes through `stop` from about 0.82")), "{found:?}");
    // It stops before, goes where no fluid is, or slides along the other.
    for (motion, x) in [
        ("{ velocity = [0.1, 0.0], end = 0.5 }", 0.08),
        ("{ velocity = [-0.1, 0.0] }", -0.12),
        ("{ velocity = [0.0, 0.1] }", -0.04),
    ] {
        let found = with_paddle(motion, &stop(x));
        assert!(!found.iter().any(|r| r.contains("goes through")), "{motion}: {found:?}");
    }
}

#[test]
fn a_wall_that_slides_along_the_fluid_does_not_push_it() {
    // A gate at the water's right side, inside the tank, faster than a seventh of the sound speed.
    let text = |velocity: &str| {
        let gate = format!(
            "[[shape]]\nname = \"gate\"\nphase = \"wall\"\nbox = {{ min = [0.1, 0.0], max = [0.12, 0.3] }}\n\
             motion = {{ velocity = {velocity} }}\n"
        );
        let water = "resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\nsound_speed = 14.0\n";
        on(&format!("{water}{gate}{TANK}{WATER}pressure = \"hydrostatic\"\n"))
    };
    assert_eq!(text("[0.0, 4.0]"), [""; 0]);
    let pushed = text("[-4.0, 0.0]");
    assert!(pushed.iter().any(|r| r.contains("can come to 4.00 m/s")), "{pushed:?}");
}
