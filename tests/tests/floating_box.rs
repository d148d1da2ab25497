//! Rigid bodies in water: they float as deep as Archimedes says, sink, and account for their energy.

use halfstep_tests::run::{repository, scene_at};
use halfstep_tests::{Curve, RunBuilder, scene};

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

/// On the floor, where no water is below it, what is above it presses it down: 196 N/m. Of the row of water that it
/// falls on, none is left at 20 mm. At 12.5 mm some ten particles are caught below it, and carry three quarters of
/// that; how many, hangs on the last digits: means of five heights.
#[test]
fn a_heavy_box_sinks_and_lies_on_the_floor() {
    let pressed = -1000.0 * 9.81 * 0.2 * 0.1;
    // What is caught below the box gives way: it does not lie on the floor to the last digit.
    let on_the_floor = |resolution: f64, off: f64| {
        let all = [-0.5e-3, 0.0, 0.5e-3, 1e-3, 2e-3].map(|above| {
            let (bottom, top) = (0.02 + above, 0.12 + above);
            let run = scene("floating-box")
                .set("resolution", resolution)
                .set("solid.density", 2000)
                .set("shape.box.box", format!("{{ min = [0.4, {bottom}], max = [0.6, {top}] }}"))
                .until(0.8)
                .in_process()
                .run();
            let last = |name: &str| run.curve(name).between(0.6, 0.8).mean();
            let y = last("box.y");
            assert!((y - 0.05).abs() < off, "{y}");
            last("water.y") / pressed
        });
        let mean = all.iter().sum::<f64>() / 5.0;
        println!("{resolution} m: {mean:.3} of the water's weight, {all:.3?}");
        mean
    };
    assert!((on_the_floor(0.02, 1e-9) - 1.0).abs() < 0.05);
    assert!((0.2..0.35).contains(&on_the_floor(0.0125, 1e-6)));
}

/// A drum full of water, and in its middle a disc of twice the water's density.
const DRUM: &str = r#"
resolution = 0.01
end_time = 0.04

[fluid]
density = 1000.0

[solid]
model = "rigid"
density = 2000.0

[[shape]]
name = "drum"
phase = "wall"
contact = false
ring = { center = [0.0, 0.0], inner = 0.15, outer = 0.2 }

[[shape]]
name = "disc"
phase = "solid"
disc = { center = [0.0, 0.0], radius = 0.05 }

[[shape]]
name = "water"
phase = "fluid"
disc = { center = [0.0, 0.0], radius = 0.15 }
pressure = "hydrostatic"

[[probe]]
name = "disc"
kind = "body-position"
body = "disc"
"#;

/// At first it falls with (rho_s - rho_f) g / (rho_s + C rho_f), C = (b² + a²) / (b² - a²) = 1.25 of the water that
/// goes along between the radii a and b: 2.41 mm in 0.04 s, without that water 3.92 mm. Measured: 3.1 % less, as
/// viscosity begins to brake it; bands of 1 % about that.
#[test]
fn a_sinking_disc_takes_water_along() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("drum.toml");
    std::fs::write(&path, DRUM).expect("a scene");
    let run = scene_at(&path).run();
    let fallen = -run.curve("disc.y").at(0.04);
    let right = 0.5 * 9.81 * (2.0 - 1.0) / (2.0 + 1.25) * 0.04 * 0.04;
    println!("{:.4} mm of {:.4} mm", 1e3 * fallen, 1e3 * right);
    assert!((fallen / right - 0.969).abs() < 0.01, "{fallen}");
    assert!(run.curve("disc.x").at(0.04).abs() < 1e-9, "straight down");
}

/// When a curve is lowest between two times, s.
fn lowest(curve: &Curve, from: f64, to: f64) -> f64 {
    let part = curve.between(from, to);
    Curve { values: part.values.iter().map(|x| -x).collect(), ..part }.peak().0
}

/// Let go 10 mm too high. By linear potential flow in this tank (`validation/floating-box/potential_flow.py`) it turns
/// round after 0.371 s and 0.765 s; in unbounded water without waves the first would be after 0.360 s, of its own mass
/// alone after 0.225 s. Measured here: 0.2 % early and 2.7 % early, with 10 mm 1.1 % and 0.3 % late. Bands: 1 % beyond.
#[test]
fn a_box_heaves_with_the_water_that_goes_along() {
    let run =
        scene("floating-box").set("resolution", 0.02).set("output.probe_interval", 1e-3).until(0.85).run();
    let heave = run.curve("box.y");
    let (down, up) = (lowest(&heave, 0.2, 0.6), heave.between(0.6, 0.85).peak());
    println!("down for {down:.4} s to {:.4} m, up at {up:.4?}", heave.at(down));
    assert!((down / 0.371 - 1.0).abs() < 0.012, "{down}");
    assert!((up.0 / 0.765 - 1.0).abs() < 0.037, "{up:?}");
}

/// Turned by 10 degrees it rights itself: by linear potential flow in this tank it is upright after 0.198 s and turns
/// round after 0.395 s and 0.790 s. Measured: 0.1971, 0.391 and 0.782 s, for viscosity brakes it before it turns: 0.140
/// rad on the other side instead of 0.172. Bands: 1 % beyond. Hydrostatics alone would have it upright after 0.159 s.
#[test]
fn a_flat_box_rights_itself() {
    let run = coarse()
        .set("shape.box.box", "{ min = [0.4, 0.15], max = [0.6, 0.25] }")
        .set("shape.box.rotate", "{ angle = 10 }")
        .set("output.probe_interval", 1e-3)
        .until(0.85)
        .run();
    let roll = run.curve("roll.angle");
    let upright = -10.0_f64.to_radians();
    assert_eq!(roll.at(0.0), 0.0);
    let from_upright = Curve { values: roll.values.iter().map(|x| x - upright).collect(), ..roll.clone() };
    let quarter = from_upright.crossings()[0].0;
    let (half, whole) = (lowest(&roll, 0.3, 0.5), roll.between(0.6, 0.85).peak().0);
    let beyond = from_upright.at(half);
    println!("upright after {quarter:.4} s, {beyond:.4} rad at {half:.4} s, back at {whole:.4} s");
    assert!((quarter / 0.198 - 1.0).abs() < 0.011, "{quarter}");
    assert!((half / 0.395 - 1.0).abs() < 0.02, "{half}");
    assert!((whole / 0.790 - 1.0).abs() < 0.02, "{whole}");
    assert!((beyond + 0.140).abs() < 0.005, "{beyond}");
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
