//! Waves that are not resolved, do not arrive or are absorbed where they are made, paddles and initial fields that do
//! not fit: what is remarked on each, and on what is near it not.

use super::remarks;
use super::tests::{PLATE, TANK, WATER, plain};
use super::trap_tests::has;
use halfstep_scene::parse;
use std::path::Path;

const REGULAR: &str = "wave = \"regular\", height = 0.02, period = 0.9, depth = 0.2";

/// Remarks on a flume 4 m long with water 0.2 m deep, its piston at the left. `paddle`: its box; `keys` of the fluid.
fn flume(end_time: f64, keys: &str, paddle: &str, motion: &str, rest: &str) -> Vec<String> {
    at_floor(0.0, &format!("end_time = {end_time}"), keys, (paddle, motion), rest)
}

fn at_floor(floor: f64, lines: &str, keys: &str, (paddle, motion): (&str, &str), rest: &str) -> Vec<String> {
    let [level, rim] = [floor + 0.2, floor + 0.4];
    let text = format!(
        "resolution = 0.01\n{lines}\ngravity = [0.0, -9.81]\n[fluid]\ndensity = 1000.0\n{keys}\n\
         [[shape]]\nname = \"paddle\"\nphase = \"wall\"\n{paddle}\nmotion = {{ {motion} }}\n\
         [[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
         tank = {{ min = [-0.1, {floor}], max = [4.0, {rim}], open = [\"left\", \"top\"] }}\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, {floor}], max = [4.0, {level}] }}\n\
         pressure = \"hydrostatic\"\n{rest}"
    );
    remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
}

const PADDLE: &str = "box = { min = [-0.04, 0.0], max = [0.0, 0.4] }";

fn gauge(x: f64) -> String {
    format!("[[probe]]\nname = \"level\"\nkind = \"water-level\"\nx = {x}\n")
}

#[test]
fn a_flume_that_means_what_it_says() {
    assert_eq!(
        flume(5.0, "beach = { from = 2.5, to = 4.0, rate = 10.0 }", PADDLE, REGULAR, &gauge(2.0)),
        [""; 0]
    );
}

#[test]
fn waves_that_do_not_arrive() {
    // sqrt(9.81 0.22) = 1.469 m/s: 3 m take 2.042 s.
    let said = "the waves of `paddle` come to no probe and no solid: the nearest, `level`, is 3 m away, where the \
                longest waves are after 2.042 s, and the run ends at 2 s";
    let found = flume(2.0, "", PADDLE, REGULAR, &gauge(3.0));
    assert!(has(&found, said), "{found:?}");
    for (end, probes) in [
        (2.1, gauge(3.0)),
        (2.0, format!("{}{}", gauge(3.0), gauge(1.0).replacen("level", "near", 1))),
        (1.0, String::new()),
    ] {
        assert_eq!(flume(end, "", PADDLE, REGULAR, &probes), [""; 0], "{end}");
    }
}

#[test]
fn a_window_before_the_waves() {
    let with = |to: f64, more: &str| {
        let metric =
            format!("[[metric]]\nname = \"crest\"\nprobe = \"level.level\"\nkind = \"peak\"\nto = {to}\n");
        flume(5.0, "", PADDLE, REGULAR, &(gauge(3.0) + &metric + more))
    };
    let said = "the metric `crest` looks until 2 s, and no wave comes to `level` before 2.042 s, when the longest \
                ones do";
    assert!(has(&with(2.0, ""), said), "{:?}", with(2.0, ""));
    assert_eq!(with(2.1, ""), [""; 0]);
    let gate = "[[shape]]\nname = \"gate\"\nphase = \"wall\"\nbox = { min = [3.5, 0.0], max = [3.6, 0.4] }\nmotion = { \
                amplitude = [0.0, 0.2], period = 2.0 }\n";
    assert!(!has(&with(2.0, gate), "no wave comes"), "another thing moves the water");
}

#[test]
fn waves_of_less_than_a_spacing() {
    let high =
        |height: f64| flume(5.0, "", PADDLE, &REGULAR.replace("0.02", &height.to_string()), &gauge(2.0));
    let said = "`paddle` makes waves 0.004 m high, 0.4 spacings: the surface of the particles is as uneven (a \
                resolution of 0.0008 has 5)";
    assert!(has(&high(0.004), said), "{:?}", high(0.004));
    assert_eq!(high(0.011), [""; 0]);
}

#[test]
fn a_ramp_of_a_wave_maker_that_outlasts_the_run() {
    let ramp = |ramp: f64| flume(2.0, "", PADDLE, &format!("{REGULAR}, ramp = {ramp}"), &gauge(1.0));
    let said =
        "the motion of `paddle` reaches its amplitude at 3 s, after its `ramp`, and the run ends at 2 s";
    assert!(has(&ramp(3.0), said), "{:?}", ramp(3.0));
    assert_eq!(ramp(1.5), [""; 0]);
}

#[test]
fn a_paddle_that_is_too_low() {
    let high = |top: f64| {
        flume(5.0, "", &format!("box = {{ min = [-0.04, 0.0], max = [0.0, {top}] }}"), REGULAR, &gauge(2.0))
    };
    assert!(has(&high(0.15), "`paddle` ends at 0.15 m, below the water's level, 0.2 m"), "{:?}", high(0.15));
    assert!(
        has(&high(0.2), "`paddle` ends at 0.2 m, below the crests of its waves, 0.21 m"),
        "{:?}",
        high(0.2)
    );
    assert!(!has(&high(0.22), "`paddle` ends"), "{:?}", high(0.22));
}

#[test]
fn waves_away_from_the_water() {
    let toward = |side: &str| flume(5.0, "", PADDLE, &format!("{REGULAR}, toward = \"{side}\""), &gauge(2.0));
    let said = "`paddle` makes waves toward the left, and all water is on its other side: they have troughs for crests";
    assert!(has(&toward("left"), said), "{:?}", toward("left"));
    assert_eq!(toward("right"), [""; 0]);
}

#[test]
fn a_flap_and_its_hinge() {
    let flap = |pivot: &str, floor: f64, more: &str| {
        let paddle = format!("box = {{ min = [-0.04, {floor}], max = [0.0, {}] }}", floor + 0.4);
        let motion = format!("{REGULAR}, maker = \"flap\", pivot = {pivot}{more}");
        at_floor(floor, "end_time = 5.0", "", (&paddle, &motion), &gauge(2.0))
    };
    let beside = flap("[2.0, 0.0]", 0.0, "");
    assert!(has(&beside, "the pivot of the flap `paddle`, [2, 0], lies 2 m beside it"), "{beside:?}");
    for fine in ["[0.0, 0.0]", "[-0.02, 0.05]", "[0.03, 0.0]", "[-0.02, -0.5]"] {
        assert!(!has(&flap(fine, 0.0, ""), "the flap"), "{fine} {:?}", flap(fine, 0.0, ""));
    }
    let high = flap("[0.0, 1.0]", 1.0, ", floor = 1.0");
    assert!(!has(&high, "the flap"), "{high:?}");
    let elsewhere = flap("[0.0, 0.0]", 1.0, "");
    let said =
        "the flap `paddle` swings as if its hinge were 0 m above a floor at 0 m, and the water's is at 1 m";
    assert!(has(&elsewhere, said), "{elsewhere:?}");
}

#[test]
fn a_beach_in_the_wrong_place() {
    let beach = |from: f64, to: f64, rest: &str| {
        flume(5.0, &format!("beach = {{ from = {from}, to = {to}, rate = 10.0 }}"), PADDLE, REGULAR, rest)
    };
    let acts = "fluid.beach acts at `paddle`, which makes waves: velocities decay at 10 1/s there";
    assert!(has(&beach(3.0, 2.0, ""), acts), "{:?}", beach(3.0, 2.0, ""));
    assert!(has(&beach(1.0, 0.0, ""), acts));
    let beyond = "fluid.beach begins at x = 4.5 m, and the water ends at 4 m: it absorbs nothing";
    assert!(has(&beach(4.5, 5.5, ""), beyond), "{:?}", beach(4.5, 5.5, ""));
    let inside =
        "the gauge `level` at x = 3.9 m is inside of the beach: long waves that come there have lost";
    assert!(has(&beach(2.0, 4.0, &gauge(3.9)), inside), "{:?}", beach(2.0, 4.0, &gauge(3.9)));
    assert_eq!(beach(2.0, 4.0, &gauge(2.2)), [""; 0], "where it hardly acts");
    assert_eq!(beach(2.5, 5.0, &gauge(1.0)), [""; 0], "of which the water has most");
    // Four spacings of the last metre.
    let end = beach(3.9, 5.0, "");
    assert!(has(&end, "the beach leaves long waves 1.00 of their amplitude"), "{end:?}");
    // Behind a paddle that has water on both sides.
    let middle = "box = { min = [1.0, 0.0], max = [1.04, 0.4] }";
    let behind = flume(5.0, "beach = { from = 1.0, to = 0.0, rate = 10.0 }", middle, REGULAR, &gauge(2.0));
    assert!(!has(&behind, "fluid.beach acts"), "{behind:?}");
}

/// Remarks on water of this depth in a tank 1 m wide that begins with a field.
fn field(gravity: &str, depth: f64, field: &str) -> Vec<String> {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\ngravity = {gravity}\n[fluid]\ndensity = 1000.0\nsound_speed = 20.0\n\
         [[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
         tank = {{ min = [0.0, 0.0], max = [1.0, 1.0], open = [\"top\"] }}\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [1.0, {depth}] }}\n\
         velocity_field = {{ {field} }}\n"
    );
    remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
}

#[test]
fn a_standing_wave_of_other_water() {
    let wave = |origin: f64, half_wave: f64, depth: f64| {
        let keys = format!("origin = [{origin}, 0.0], half_wave = {half_wave}, depth = {depth}");
        field("[0.0, -9.81]", 0.3, &format!("kind = \"standing-wave\", amplitude = 0.02, {keys}"))
    };
    assert_eq!(wave(0.0, 1.0, 0.3), [""; 0]);
    assert_eq!(wave(0.0, 0.5, 0.31), [""; 0]);
    let said = "the standing wave of `water` is that of a surface at y = 0.2 m, 0.2 m above its origin";
    assert!(has(&wave(0.0, 1.0, 0.2), said), "{:?}", wave(0.0, 1.0, 0.2));
    let crosses = "the velocity field of `water` crosses `tank` at [";
    assert!(has(&wave(0.3, 1.0, 0.3), crosses), "{:?}", wave(0.3, 1.0, 0.3));
    let upward = field(
        "[0.0, 0.0]",
        0.3,
        "kind = \"standing-wave\", amplitude = 0.02, origin = [0.0, 0.0], half_wave = 1.0, depth = 0.3",
    );
    assert!(has(&upward, "is that of waves under gravity along -y, and gravity is [0.0, 0.0]"), "{upward:?}");
}

#[test]
fn vortices_of_another_tank() {
    let vortex = |origin: f64, half_wave: f64| {
        let keys = format!("origin = [{origin}, 0.0], half_wave = {half_wave}");
        field("[0.0, 0.0]", 1.0, &format!("kind = \"taylor-green\", speed = 1.0, {keys}"))
    };
    for half_wave in [1.0, 0.5, 0.25] {
        assert_eq!(vortex(0.0, half_wave), [""; 0], "{half_wave}");
    }
    let crosses = "the velocity field of `water` crosses `tank` at [";
    assert!(has(&vortex(0.2, 0.7), crosses), "{:?}", vortex(0.2, 0.7));
}

/// A paddle beside the water, and the tank open toward it.
pub(super) fn with_paddle(motion: &str, more: &str) -> Vec<String> {
    let open = TANK.replace("[\"top\"]", "[\"left\", \"top\"]");
    let paddle = format!(
        "[[shape]]\nname = \"paddle\"\nphase = \"wall\"\nbox = {{ min = [-0.02, 0.0], max = [0.0, 0.2] }}\n\
         motion = {motion}\n{more}"
    );
    plain(&[&open, WATER, PLATE, &paddle])
}

#[test]
fn a_paddle_for_water_of_another_depth() {
    let wave = |depth: f64| {
        let motion = format!("{{ wave = \"regular\", height = 0.005, period = 0.5, depth = {depth} }}");
        with_paddle(&motion, "")
    };
    assert_eq!(wave(0.1), [""; 0]);
    assert_eq!(
        wave(0.05),
        [
            "`paddle` makes waves for a depth of 0.05 m, and the water is 0.1 m deep: they have another height and length"
        ]
    );
}

#[test]
fn a_run_that_ends_before_its_wave() {
    // Goring's piston moves for 2 (5 + H / d) / (kappa c): kappa = sqrt(0.75 * 0.001 / 0.001), c = sqrt(9.81 * 0.101).
    let found = with_paddle("{ wave = \"solitary\", height = 0.001, depth = 0.1, start = 0.1 }", "");
    assert_eq!(found[0], "`paddle` moves until 11.724 s for its wave, and the run ends at 1 s");
}

#[test]
fn a_solitary_wave_the_wrong_way() {
    for (toward, wrong) in [("right", false), ("left", true)] {
        let text = format!(
            "resolution = 0.02\nend_time = 3.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
             phase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [3.0, 0.2] }}\n[[shape]]\nname = \"piston\"\n\
             phase = \"wall\"\nbox = {{ min = [-0.1, 0.0], max = [0.0, 0.5] }}\n\
             motion = {{ wave = \"solitary\", height = 0.05, depth = 0.2, toward = \"{toward}\" }}\n"
        );
        let found = remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")));
        assert_eq!(found.iter().any(|text| text.contains("its wave is a trough")), wrong, "{found:?}");
    }
}
