//! Rigid bodies in water: they float as deep as Archimedes says, sink, and account for their energy.

use halfstep_tests::run::{repository, scene_at};
use halfstep_tests::{RunBuilder, scene};

/// Coarse, released where it should float.
fn coarse() -> RunBuilder {
    scene("floating-box").set("resolution", 0.0125)
}

/// Draught of the box, m: its part below the level, which it lifts. The tank is 1 m wide, the box 0.2 m, and the water
/// lost the place of the box's submerged part at first.
fn draught(centre: f64, submerged_at_first: f64) -> f64 {
    // level = 0.2 - 0.2 submerged + 0.2 draught, and level - draught = centre - 0.05.
    (0.2 - 0.2 * submerged_at_first - (centre - 0.05)) / 0.8
}

#[test]
fn a_box_floats_as_deep_as_archimedes_says() {
    let run = coarse().set("shape.box.box", "{ min = [0.4, 0.15], max = [0.6, 0.25] }").until(1.5).run();
    let found = draught(run.curve("box.y").between(0.3, 1.5).mean(), 0.05);
    println!("draught {found:.5} m of 0.05 m, {:.0} s", run.report.wall_seconds);
    assert!((found / 0.05 - 1.0).abs() < 0.02, "{found}");
    let force = run.curve("water.y").between(0.3, 1.5).mean();
    assert!((force / 98.1 - 1.0).abs() < 0.01, "{force}");
    assert!(run.curve("roll.angle").mean().abs() < 1e-3);
}

/// A twentieth of the water's density: the water that goes along is many times heavier than the box.
#[test]
fn a_light_box_is_stable() {
    let run = coarse()
        .set("solid.density", 50)
        .set("shape.box.box", "{ min = [0.4, 0.18], max = [0.6, 0.28] }")
        .until(0.6)
        .run();
    let y = run.curve("box.y");
    let (mean, swing) = (y.between(0.2, 0.6).mean(), run.curve("roll.angle").mean());
    println!("centre {mean:.5} m, roll {swing:.1e}, {:.0} s", run.report.wall_seconds);
    assert!((0.18..0.30).contains(&mean), "{mean}");
}

#[test]
fn a_heavy_box_sinks_and_lies_on_the_floor() {
    let run = coarse()
        .set("solid.density", 2000)
        .set("shape.box.box", "{ min = [0.4, 0.02], max = [0.6, 0.12] }")
        .until(0.8)
        .run();
    let last = |name: &str| run.curve(name).between(0.6, 0.8).mean();
    let (y, contact) = (last("box.y"), run.curve("water.y").between(0.6, 0.8).mean());
    println!("centre {y:.6} m, water {contact:.1} N/m");
    assert!((y - 0.05).abs() < 1e-5, "{y}");
}

/// The same bits as processes and as threads, and a ledger that closes.
#[test]
fn processes_and_threads_agree_and_the_ledger_closes() {
    let text = std::fs::read_to_string(repository().join("scenes/floating-box.toml")).expect("a scene");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("box.toml");
    let ledgers = ["fluid", "solid"]
        .map(|phase| format!("[[probe]]\nname = \"e-{phase}\"\nkind = \"energy\"\nphase = \"{phase}\"\n"));
    std::fs::write(&path, text + "\n" + &ledgers.concat()).expect("a scene");
    let run = || scene_at(&path).set("resolution", 0.02).until(0.3);
    let (processes, threads) = (run().run(), run().in_process().run());
    assert_eq!(processes.state_hash(), threads.state_hash());
    let energy = processes.report.energy.as_ref().expect("ledgers");
    println!("rest {:.1e} of {:?}", energy.relative_residual, energy.largest);
    assert!(energy.relative_residual < 1e-3, "{}", energy.relative_residual);
}
