//! Scenes seen from a frame that moves, beside closed forms and the same seen from space.

use halfstep_tests::run::scene_at;
use halfstep_tests::{Finished, RunBuilder};
use std::f64::consts::PI;
use std::path::Path;

fn scene(folder: &Path, name: &str, text: &str) -> RunBuilder {
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, text).unwrap();
    scene_at(&path)
}

/// A block that nothing holds, of a model, in a frame.
fn block(folder: &Path, model: &str, frame: &str, more: &str) -> Finished {
    let text = format!(
        "resolution = 0.01\nend_time = 0.2\ngravity = [0.0, -9.81]\n{more}\n[frame]\nmotion = {frame}\n\
         [solid]\nmodel = \"{model}\"\ndensity = 1000.0\n{}\n[[shape]]\nname = \"block\"\nphase = \"solid\"\n\
         box = {{ min = [0.0, 0.0], max = [0.1, 0.1] }}\n\
         [[probe]]\nname = \"block\"\nkind = \"centroid\"\nphase = \"solid\"\n",
        if model == "rigid" { "" } else { "youngs_modulus = 1e6\npoissons_ratio = 0.3" }
    );
    scene(folder, model, &text).run()
}

fn at_end(run: &Finished) -> [f64; 2] {
    ["block.x", "block.y"].map(|name| run.curve(name).at(0.2))
}

/// What rests in space goes back by the frame's way, X = e A sin(2 pi t / T), and falls by g t² / 2.
#[test]
fn blocks_of_all_models_stay_behind_a_shaken_frame() {
    let folder = tempfile::tempdir().unwrap();
    let frame = "{ amplitude = [0.05, 0.02], period = 0.25, ramp = 0.15 }";
    // At 0.2 s the ramp is over.
    let sine = (2.0 * PI * 0.2 / 0.25).sin();
    let expected = [0.05 - 0.05 * sine, 0.05 - 0.02 * sine - 0.5 * 9.81 * 0.04];
    for model in ["rigid", "total-lagrangian", "finite-element", "hypoelastic"] {
        let found = at_end(&block(folder.path(), model, frame, ""));
        println!("{model}: {found:?}, {expected:?}");
        // The block falls by 196 mm, and its way is right to 0.1 mm: rounding of the probes, dt² of the integration.
        assert!((0..2).all(|d| (found[d] - expected[d]).abs() < 1e-4), "{model}: {found:?} {expected:?}");
    }
}

/// X along x from a file whose rows are 10 ms apart, along y as a sum of two sines.
#[test]
fn a_block_stays_behind_a_recorded_frame() {
    let folder = tempfile::tempdir().unwrap();
    let x = |t: f64| 0.02 * (PI * t).sin().powi(2) * (8.0 * PI * t).sin();
    let rows: Vec<String> = (0..=100).map(|k| 0.01 * f64::from(k)).map(|t| format!("{t},{}", x(t))).collect();
    std::fs::write(folder.path().join("x.csv"), format!("t,x\n{}\n", rows.join("\n"))).unwrap();
    let frame = "[{ file = \"x.csv\", columns = { time = \"t\", x = \"x\" } }, \
        { amplitude = [0.0, 0.02], period = 0.1, ramp = 0.1 }, { amplitude = [0.0, 0.01], period = 0.15, ramp = 0.1 }]";
    let found = at_end(&block(folder.path(), "total-lagrangian", frame, ""));
    let y = 0.02 * (20.0 * PI * 0.2).sin() + 0.01 * (2.0 * PI * 0.2 / 0.15).sin();
    let expected = [0.05 - x(0.2), 0.05 - y - 0.5 * 9.81 * 0.04];
    println!("{found:?}, {expected:?}");
    // 1 um along x by the splines, 24 um along y by the steps, whose sines are 2.5 times as fast.
    assert!((0..2).all(|d| (found[d] - expected[d]).abs() < 5e-5), "{found:?} {expected:?}");
}

/// Steps of half the length have a quarter of the error: gravity is that of each stage's instant.
#[test]
fn gravity_is_of_second_order_in_time() {
    let folder = tempfile::tempdir().unwrap();
    let frame = "{ amplitude = [0.05, 0.0], period = 0.25, ramp = 0.15 }";
    let expected = 0.05 - 0.05 * (2.0 * PI * 0.2 / 0.25).sin();
    let error =
        |dt: f64| at_end(&block(folder.path(), "rigid", frame, &format!("time_step = {dt}")))[0] - expected;
    let [coarse, fine] = [0.005, 0.0025].map(error);
    println!("{coarse:e} {fine:e}");
    assert!((coarse / fine - 4.0).abs() < 0.2, "{coarse:e} {fine:e}");
}

/// Gravity turns clockwise as the frame turns counter-clockwise: with theta = w t, x'' = -g sin w t, y'' = -g cos w t.
#[test]
fn a_block_falls_as_gravity_turns() {
    let folder = tempfile::tempdir().unwrap();
    let frame = "{ angular_velocity = 5.0, pivot = [0.0, 0.0] }";
    let (w, t) = (5.0_f64, 0.2_f64);
    let expected =
        [0.05 - 9.81 * (w * t - (w * t).sin()) / (w * w), 0.05 - 9.81 * (1.0 - (w * t).cos()) / (w * w)];
    for model in ["rigid", "total-lagrangian"] {
        let run = block(folder.path(), model, frame, "");
        let found = at_end(&run);
        println!("{model}: {found:?}, {expected:?}");
        assert!((0..2).all(|d| (found[d] - expected[d]).abs() < 1e-4), "{model}: {found:?} {expected:?}");
        assert!(run.outcome.stderr.contains("Coriolis"), "{}", run.outcome.stderr);
    }
}

const SHAKE: &str = "{ amplitude = [0.01, 0.0], period = 0.7, ramp = 0.7 }";

/// 0.4 m x 0.1 m of water, with a box that floats in it or nothing.
fn tank(folder: &Path, from_within: bool, box_too: bool) -> RunBuilder {
    let (frame, motion) = match from_within {
        true => (format!("[frame]\nmotion = {SHAKE}\n"), String::new()),
        false => (String::new(), format!("motion = {SHAKE}\n")),
    };
    let solid = "[solid]\nmodel = \"rigid\"\ndensity = 500.0\n[[shape]]\nname = \"box\"\nphase = \"solid\"\n\
        box = { min = [0.15, 0.08], max = [0.25, 0.12] }\n\
        [[probe]]\nname = \"box\"\nkind = \"body-position\"\nbody = \"box\"\n";
    let text = format!(
        "resolution = 0.01\nend_time = 1.4\n{frame}[fluid]\ndensity = 1000.0\n\
         [[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
         tank = {{ min = [0.0, 0.0], max = [0.4, 0.3], open = [\"top\"] }}\n{motion}\
         {}[[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.4, 0.1] }}\n\
         pressure = \"hydrostatic\"\n\
         [[probe]]\nname = \"water\"\nkind = \"centroid\"\nphase = \"fluid\"\n\
         [output]\nprobe_interval = 0.01\ncheckpoint_interval = 0.05\n",
        if box_too { solid } else { "" },
    );
    scene(folder, if from_within { "within" } else { "space" }, &text)
}

/// Displacement of the tank, m.
fn way(t: f64) -> f64 {
    let envelope = if t < 0.7 { (PI * t / 1.4).sin().powi(2) } else { 1.0 };
    0.01 * envelope * (2.0 * PI * t / 0.7).sin()
}

/// Largest difference of a probe from that seen from space, over the largest value that it comes from its mean.
fn difference(within: &Finished, space: &Finished, name: &str) -> f64 {
    let (within, space) = (within.curve(name), space.curve(name));
    let first = space.at(0.0);
    let times = || (0..=140).map(|k| 0.01 * f64::from(k));
    let swing = times().map(|t| (space.at(t) - way(t) - first).abs()).fold(0.0, f64::max);
    let off = times().map(|t| (space.at(t) - way(t) - within.at(t)).abs()).fold(0.0, f64::max);
    println!("{name}: {off:.2e} m of {swing:.2e} m");
    off / swing
}

#[test]
fn a_shaken_tank_is_the_same_from_within_and_from_space() {
    let folder = tempfile::tempdir().unwrap();
    let [within, space] = [true, false].map(|from_within| tank(folder.path(), from_within, false).run());
    let off = difference(&within, &space, "water.x");
    // 1e-4 measured: the two differ in the rounding of places, and in the steps that wall accelerations allow.
    assert!(off < 0.002, "{off}");
}

/// With a box: fluid and coupler show the same pressure of the solid at the same instant, or action would not be
/// reaction.
#[test]
fn a_box_floats_in_a_shaken_tank_as_seen_from_space() {
    let folder = tempfile::tempdir().unwrap();
    let [within, space] = [true, false].map(|from_within| tank(folder.path(), from_within, true).run());
    let audit = &within.report.audit;
    assert!(audit.action_reaction.unwrap() <= 1e-12, "{audit:?}");
    assert!(audit.impulse.unwrap() <= 1e-12, "{audit:?}");
    let [water, body] = ["water.x", "box.x"].map(|name| difference(&within, &space, name));
    // 4e-4 and 2.4e-3 measured.
    assert!(water < 0.01 && body < 0.01, "{water} {body}");
}

#[test]
fn a_run_in_a_moving_frame_has_the_same_bits_in_any_layout_and_after_an_interruption() {
    let folder = tempfile::tempdir().unwrap();
    let short = || tank(folder.path(), true, true);
    let whole = short().until(0.2).run();
    let threads = short().until(0.2).in_process().threads(2).run();
    assert_eq!(threads.state_hash(), whole.state_hash());
    let dir = folder.path().join("run");
    short().until(0.12).out(&dir).run();
    let resumed = short().resume(&dir).until(0.2).run();
    assert_eq!(resumed.report.resumed.len(), 1);
    assert_eq!(resumed.state_hash(), whole.state_hash());
    assert_eq!(resumed.probes.rows, whole.probes.rows);
}

/// Another program is told one gravity.
#[test]
fn an_external_solid_has_no_moving_frame() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = tank(folder.path(), true, true).argument("--solid").argument("true").outcome();
    assert_ne!(outcome.code(), Some(0));
    assert!(outcome.stderr.contains("is told one `gravity`"), "{}", outcome.stderr);
}
