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
    // Archimedes: 0.242 m. Its draught of 5 mm is less than a row of particles, and it floats 8 mm too high.
    assert!((0.248..0.253).contains(&mean), "{mean}");
}

/// The same box by a given mass: the fluid's step knows how light it is.
#[test]
fn a_box_of_a_small_given_mass_is_stable() {
    let run = coarse()
        .set("solid.bodies", "[{ name = \"box\", mass = 1.0 }]")
        .set("shape.box.box", "{ min = [0.4, 0.18], max = [0.6, 0.28] }")
        .until(0.2)
        .run();
    let mean = run.curve("box.y").between(0.1, 0.2).mean();
    println!("centre {mean:.5} m, {:.0} s", run.report.wall_seconds);
    // As the same box of a small density, on its way up.
    assert!((0.240..0.250).contains(&mean), "{mean}");
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

/// Turned by 10 degrees it rights itself. Hydrostatics alone gives a period of 0.634 s, with half of the moment of a
/// plate of its breadth that turns in water 0.77 s; walls and floor are near.
#[test]
fn a_flat_box_rights_itself() {
    let run = coarse()
        .set("shape.box.box", "{ min = [0.4, 0.15], max = [0.6, 0.25] }")
        .set("shape.box.rotate", "{ angle = 10 }")
        .until(0.9)
        .run();
    let roll = run.curve("roll.angle");
    let (first, overshoot) = (roll.at(0.0), roll.between(0.3, 0.5).mean());
    let upright = -10.0_f64.to_radians();
    let passed = (0..900).map(|k| 1e-3 * f64::from(k)).find(|t| roll.at(*t) < upright);
    println!("a quarter of a period: {passed:?} s, beyond upright {:.4} rad", overshoot - upright);
    assert_eq!(first, 0.0);
    let period = 4.0 * passed.expect("it comes up");
    assert!((0.75..0.83).contains(&period), "{period}");
    assert!(overshoot < upright && overshoot > 2.0 * upright, "{overshoot}");
    assert!(roll.at(0.8) > overshoot, "it swings back");
}

/// A tall box of half the water's density: its metacentre is 42 mm below its centre of mass.
#[test]
fn a_tall_box_capsizes() {
    let run = coarse()
        .set("shape.box.box", "{ min = [0.45, 0.1], max = [0.55, 0.3] }")
        .set("solid.bodies", "[{ name = \"box\", angular_velocity = 0.3 }]")
        .until(1.0)
        .run();
    let roll = run.curve("roll.angle").between(0.8, 1.0).mean();
    println!("turned by {roll:.2} rad");
    // It swings about its side, pi / 2, and is on its way back.
    assert!((1.85..2.0).contains(&roll), "{roll}");
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
