//! Probes of pressure that ride on solids, beside depths by hand.
//!
//! At rest the kernel average of p + rho g . (at - x) is the hydrostatic pressure wherever water is near, also beside a
//! face that cuts the kernel in half. Bands of 2 % of the pressure at the bottom: sound that is left of the start, and
//! water that has not settled to the last part of a spacing (half of one is 1.6 % of 0.3 m at 10 mm).

use halfstep_tests::run::scene_at;
use halfstep_tests::{Finished, RunBuilder};
use std::path::Path;

const RHO_G: f64 = 1000.0 * 9.81;

/// 0.6 m x 0.3 m of water with a solid in it, at 10 mm.
fn tank(folder: &Path, solid: &str) -> RunBuilder {
    let text = format!(
        "resolution = 0.01\nend_time = 0.6\n[fluid]\ndensity = 1000.0\n\
         [[shape]]\nname = \"basin\"\nphase = \"wall\"\n\
         tank = {{ min = [0.0, 0.0], max = [0.6, 0.4], open = [\"top\"] }}\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.6, 0.3] }}\n\
         pressure = \"hydrostatic\"\n{solid}[output]\nprobe_interval = 0.01\ncheckpoint_interval = 0.02\n"
    );
    let path = folder.join("tank.toml");
    std::fs::write(&path, text).unwrap();
    scene_at(&path)
}

fn probe(name: &str, shape: &str, place: &str) -> String {
    format!("[[probe]]\nname = \"{name}\"\nkind = \"pressure\"\nshape = \"{shape}\"\n{place}\n")
}

fn mean(run: &Finished, name: &str, from: f64) -> f64 {
    run.curve(name).between(from, run.report.time).mean()
}

/// Its underside lies 0.2 m below the level, its right side's middle 0.15 m.
#[test]
fn a_box_that_is_held_under_water_has_the_pressure_of_its_depth() {
    let folder = tempfile::tempdir().unwrap();
    let solid = "[solid]\nmodel = \"rigid\"\ndensity = 700.0\n\
        joints = [{ name = \"hand\", kind = \"fixed\", body = \"box\" }]\n\
        [[shape]]\nname = \"box\"\nphase = \"solid\"\nbox = { min = [0.2, 0.1], max = [0.4, 0.2] }\n"
        .to_owned()
        + &probe("under", "box", "from = [0.2, 0.1]\nto = [0.4, 0.1]")
        + &probe("point", "box", "at = [0.3, 0.1]")
        + &probe("side", "box", "from = [0.4, 0.1]\nto = [0.4, 0.2]");
    let run = tank(folder.path(), &solid).until(0.3).run();
    for (name, depth) in [("under", 0.2), ("point", 0.2), ("side", 0.15)] {
        let found = mean(&run, &format!("{name}.pressure"), 0.1);
        println!("{name}: {found:.1} Pa of {:.1} Pa", RHO_G * depth);
        assert!((found - RHO_G * depth).abs() < 0.02 * RHO_G * 0.3, "{name}: {found}");
    }
}

/// A disc turns by a right angle: a point of its rim goes from beside the middle to the bottom, 0.08 m deeper.
#[test]
fn points_go_round_with_a_disc() {
    let folder = tempfile::tempdir().unwrap();
    let solid = "[solid]\nmodel = \"rigid\"\ndensity = 1000.0\n\
        [[shape]]\nname = \"disc\"\nphase = \"solid\"\ndisc = { center = [0.3, 0.15], radius = 0.08 }\n\
        motion = { angular_velocity = -5.0, end = 0.414159265, ramp = 0.1, pivot = [0.3, 0.15] }\n"
        .to_owned()
        + &probe("rim", "disc", "at = [0.38, 0.15]");
    let run = tank(folder.path(), &solid).set("output.probe_interval", 0.002).until(0.5).run();
    let (first, last) = (run.curve("rim.pressure").at(0.0), mean(&run, "rim.pressure", 0.43));
    println!("{first:.1} Pa of {:.1} Pa, then {last:.1} Pa of {:.1} Pa", RHO_G * 0.15, RHO_G * 0.23);
    // 5 rad/s over 0.314159 s and two halves of a ramp is pi/2 rad; on the way, half of that.
    assert!((first - RHO_G * 0.15).abs() < 0.02 * RHO_G * 0.3, "{first}");
    assert!((last - RHO_G * 0.23).abs() < 0.02 * RHO_G * 0.3, "{last}");
    // Sound and what the disc stirs up are four times the band at one instant: the mean of a twelfth of the way.
    let half_way = run.curve("rim.pressure").between(0.19, 0.225).mean();
    let expected = RHO_G * (0.15 + 0.08 * (std::f64::consts::PI / 4.0).sin());
    println!("half way {half_way:.1} Pa of {expected:.1} Pa");
    assert!((half_way - expected).abs() < 0.02 * RHO_G * 0.3, "{half_way} {expected}");
}

/// The floating box begins 20 mm too deep and rises: the probe goes along to its draught, half of its height.
#[test]
fn the_underside_of_a_floating_box_carries_it() {
    let folder = tempfile::tempdir().unwrap();
    let solid = "[solid]\nmodel = \"rigid\"\ndensity = 500.0\n\
        [[shape]]\nname = \"box\"\nphase = \"solid\"\nbox = { min = [0.2, 0.23], max = [0.4, 0.33] }\n"
        .to_owned()
        + &probe("under", "box", "from = [0.2, 0.23]\nto = [0.4, 0.23]")
        + "[[probe]]\nname = \"box\"\nkind = \"body-position\"\nbody = \"box\"\n";
    let run = tank(folder.path(), &solid).set("end_time", 1.6).until(1.5).run();
    let rise = mean(&run, "box.y", 0.8) - 0.28;
    println!("it rises by {:.1} mm", 1e3 * rise);
    assert!(rise > 0.01, "{rise}");
    let found = mean(&run, "under.pressure", 0.8);
    // Its weight over its width.
    println!("{found:.1} Pa of {:.1} Pa", 500.0 * 9.81 * 0.1);
    // What is left of its heave.
    assert!((found / (500.0 * 9.81 * 0.1) - 1.0).abs() < 0.05, "{found}");
}

/// A soft plate on the floor's place, clamped at both ends, sags under 0.3 m of water.
const PLATE: &str = "[solid]\ndensity = 1200.0\nyoungs_modulus = 2e6\npoissons_ratio = 0.3\n\
    [[shape]]\nname = \"plate\"\nphase = \"solid\"\nbox = { min = [0.1, 0.1], max = [0.5, 0.13] }\n\
    clamp = [{ min = [0.1, 0.1], max = [0.13, 0.13] }, { min = [0.47, 0.1], max = [0.5, 0.13] }]\n\
    [[probe]]\nname = \"middle\"\nkind = \"displacement\"\nat = [0.3, 0.13]\n";

fn plate() -> String {
    PLATE.to_owned()
        + &probe("above", "plate", "from = [0.2, 0.13]\nto = [0.4, 0.13]")
        + &probe("below", "plate", "from = [0.2, 0.1]\nto = [0.4, 0.1]")
}

#[test]
fn both_faces_of_an_elastic_plate_have_the_pressure_of_their_depth() {
    let folder = tempfile::tempdir().unwrap();
    let run = tank(folder.path(), &plate()).until(0.4).run();
    let sag = mean(&run, "middle.y", 0.1);
    println!("sag {:.2} mm", -1e3 * sag);
    for (name, depth) in [("above", 0.17), ("below", 0.2)] {
        let found = mean(&run, &format!("{name}.pressure"), 0.1);
        println!("{name}: {found:.1} Pa of {:.1} Pa", RHO_G * depth);
        assert!((found - RHO_G * depth).abs() < 0.02 * RHO_G * 0.3, "{name}: {found}");
    }
}

/// Processes or threads, any number of workers, at one go or interrupted: the same rows.
#[test]
fn riding_probes_have_the_same_bits_in_any_layout_and_after_an_interruption() {
    let folder = tempfile::tempdir().unwrap();
    let short = || tank(folder.path(), &plate());
    let rows = |run: &Finished| run.probes.rows.clone();
    let whole = short().until(0.08).run();
    assert_eq!(rows(&short().until(0.08).in_process().threads(2).run()), rows(&whole));
    let dir = folder.path().join("run");
    short().until(0.05).out(&dir).run();
    let resumed = short().resume(&dir).until(0.08).run();
    assert_eq!(resumed.report.resumed.len(), 1);
    assert_eq!(resumed.state_hash(), whole.state_hash());
    assert_eq!(rows(&resumed), rows(&whole));
}
