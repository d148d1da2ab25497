//! Viscous stress between fluid and solid, through the whole program: Couette flow over a clamped floor and around a
//! cylinder, what the ledgers say of it, and the same bits however it is run.

use halfstep_scene::EnergyPart;
use halfstep_tests::{RunBuilder, run::scene_at};
use std::f64::consts::PI;
use std::path::Path;

// ---- A slot ---------------------------------------------------------------------------------------------------------

/// Height of the slot, m.
const HEIGHT: f64 = 0.1;
/// Speed of the belt above it, m/s.
const SPEED: f64 = 0.1;
/// Pa s.
const MU: f64 = 10.0;
/// Length of the floor's middle, m.
const MIDDLE: f64 = 0.2;

/// A long closed slot between a belt and a clamped floor. No water gets past its ends, so what the belt takes along
/// comes back below: u = U (1 - 4 y + 3 y²), y from the belt over the height.
const SLOT: &str = r#"
end_time = 2.0
gravity = [0.0, 0.0]
[fluid]
density = 1000.0
viscosity = 10.0
sound_speed = 5.0
background_pressure = 100.0
[solid]
density = 1000.0
youngs_modulus = 1e6
poissons_ratio = 0.3
[output]
frame_interval = 1.0
probe_interval = 0.01
[[shape]]
name = "floor"
phase = "solid"
box = { min = [0.0, -0.04], max = [0.6, 0.0] }
clamp = { min = [0.0, -0.04], max = [0.6, 0.0] }
[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [0.6, 0.1] }
[[shape]]
name = "ends"
phase = "wall"
tank = { min = [0.0, 0.0], max = [0.6, 0.1], open = ["bottom", "top"] }
[[shape]]
name = "belt"
phase = "wall"
box = { min = [0.0, 0.1], max = [0.6, 0.14] }
slip = "none"
velocity = [0.1, 0.0]
[[probe]]
name = "floor"
kind = "force"
shape = "floor"
within = { min = [0.2, -0.04], max = [0.4, 0.0] }
[[probe]]
name = "belt"
kind = "force"
shape = "belt"
within = { min = [0.2, 0.1], max = [0.4, 0.14] }
"#;

fn slot(folder: &Path, more: &str) -> RunBuilder {
    let path = folder.join("slot.toml");
    std::fs::write(&path, format!("{SLOT}{more}")).expect("a scene");
    scene_at(&path)
}

/// Forces on floor and belt over mu U / H, means from 0.5 s on: exactly 2 and 4.
fn of_slot(dx: f64) -> [f64; 2] {
    let folder = tempfile::tempdir().expect("a folder");
    let run = slot(folder.path(), "").set("resolution", dx).in_process().run();
    assert!(run.report.audit.action_reaction.is_some_and(|rest| rest < 1e-13), "{:?}", run.report.audit);
    assert!(run.report.audit.impulse.is_some_and(|rest| rest < 1e-12), "{:?}", run.report.audit);
    let unit = MU * SPEED / HEIGHT * MIDDLE;
    let found = ["floor.x", "belt.x"].map(|name| -run.curve(name).between(0.5, 2.0).mean() / unit);
    println!("{dx} m: {found:?}, {:.0} s", run.report.wall_seconds);
    found
}

#[test]
fn ten_rows_between_a_belt_and_a_floor_drag_it() {
    let [floor, belt] = of_slot(0.01);
    assert!((floor / 2.0 - 1.109).abs() < 0.02 && (belt / 4.0 - 1.043).abs() < 0.015, "{floor} {belt}");
}

#[test]
#[ignore = "20 s"]
fn twenty_rows_do_it_better() {
    let [floor, belt] = of_slot(0.005);
    assert!((floor / 2.0 - 1.062).abs() < 0.02 && (belt / 4.0 - 1.028).abs() < 0.015, "{floor} {belt}");
}

// ---- Circular Couette flow ------------------------------------------------------------------------------------------

const CYLINDERS: &str = r#"
end_time = 0.6
gravity = [0.0, 0.0]
[fluid]
density = 1000.0
viscosity = 500.0
sound_speed = 10.0
background_pressure = 3000.0
[solid]
model = "rigid"
density = 1000.0
[output]
frame_interval = 1.0
probe_interval = 0.01
[[shape]]
name = "core"
phase = "solid"
disc = { center = [0.0, 0.0], radius = 0.5 }
motion = { angular_velocity = 0.0, pivot = [0.0, 0.0] }
[[shape]]
name = "water"
phase = "fluid"
ring = { center = [0.0, 0.0], inner = 0.5, outer = 1.0 }
[[shape]]
name = "drum"
phase = "wall"
ring = { center = [0.0, 0.0], inner = 1.0, outer = 1.2 }
slip = "none"
motion = { angular_velocity = 1.0, pivot = [0.0, 0.0] }
[[probe]]
name = "core"
kind = "moment"
shape = "core"
about = [0.0, 0.0]
[[probe]]
name = "drum"
kind = "moment"
shape = "drum"
about = [0.0, 0.0]
"#;

/// Moments on core and drum over 4 pi mu Omega R1² R2² / (R2² - R1²), with the angular velocities of both, rad/s;
/// steady from 0.2 s on.
fn of_cylinders(dx: f64, core: f64, drum: f64, set: &[(&str, &str)]) -> [f64; 2] {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cylinders.toml");
    std::fs::write(&path, CYLINDERS).expect("a scene");
    let run = scene_at(&path)
        .set("resolution", dx)
        .set("shape.core.motion.angular_velocity", core)
        .set("shape.drum.motion.angular_velocity", drum)
        .in_process();
    let run = set.iter().fold(run, |run, (key, value)| run.set(key, value)).run();
    let exact = 4.0 * PI * 500.0 * 0.25 / 0.75;
    let found = ["core.moment", "drum.moment"].map(|name| run.curve(name).between(0.3, 0.6).mean() / exact);
    println!("{dx} m, {core} and {drum} rad/s {set:?}: {found:?}, {:.0} s", run.report.wall_seconds);
    found
}

/// The moments on both are nearly the same, since angular momentum is kept pair by pair.
#[test]
fn a_core_is_turned_by_its_drum_and_a_drum_by_its_core() {
    let [core, drum] = of_cylinders(0.05, 0.0, 1.0, &[]);
    assert!((core - 1.040).abs() < 0.01 && (drum + 1.036).abs() < 0.01, "{core} {drum}");
    let [core, drum] = of_cylinders(0.05, 1.0, 0.0, &[]);
    assert!((core + 1.051).abs() < 0.01 && (drum - 1.041).abs() < 0.01, "{core} {drum}");
}

#[test]
#[ignore = "15 s"]
fn twice_as_many_rows_do_it_better() {
    let [core, drum] = of_cylinders(0.025, 0.0, 1.0, &[]);
    assert!((core - 1.031).abs() < 0.01 && (drum + 1.028).abs() < 0.01, "{core} {drum}");
    let [core, drum] = of_cylinders(0.025, 1.0, 0.0, &[]);
    assert!((core + 1.036).abs() < 0.01 && (drum - 1.031).abs() < 0.01, "{core} {drum}");
}

/// What is left is pressure on a circle of squares. Measured: 0.053.
#[test]
fn water_that_slips_hardly_turns_a_core() {
    let slips = [("effects.interface-viscosity", "off"), ("interface.cross_viscosity", "0")];
    let [core, _] = of_cylinders(0.05, 0.0, 1.0, &slips);
    assert!(core.abs() < 0.08, "{core}");
}

// ---- Energies and bits ----------------------------------------------------------------------------------------------

/// With f_i left out, all that `cross-viscosity` holds is viscous stress: what turns a core is given to the water, but
/// for what the stress across the interface dissipates.
#[test]
fn the_ledgers_hold_what_the_water_gains_and_the_core_loses() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cylinders.toml");
    let ledgers = ["fluid", "solid"]
        .map(|phase| format!("[[probe]]\nname = \"{phase}\"\nkind = \"energy\"\nphase = \"{phase}\"\n"));
    std::fs::write(&path, format!("{CYLINDERS}{}", ledgers.concat())).expect("a scene");
    let run = scene_at(&path)
        .set("resolution", 0.05)
        .set("shape.core.motion.angular_velocity", 1.0)
        .set("shape.drum.motion.angular_velocity", 0.0)
        .set("interface.cross_viscosity", 0)
        .set("output.probe_interval", 1e-3)
        .in_process()
        .run();
    let energy = run.report.energy.as_ref().expect("ledgers");
    let given = |who: &str| energy.joules(who, EnergyPart::CrossViscosity).expect("a part");
    // After the start the core turns by 0.4 rad.
    let since = |part: &str| {
        let column = run.curve(&format!("solid.{part}"));
        column.at(0.6) - column.at(0.2)
    };
    let (booked, work) = (
        since("cross-viscosity") + since("interface-pressure"),
        0.4 * run.curve("core.moment").between(0.2, 0.6).mean(),
    );
    println!("water {} J, core {} J, late {booked} J of {work} J", given("fluid"), given("solid"));
    println!("rest {:.1e} of {:?}, {:?}", energy.relative_residual, energy.largest, energy.interface);
    assert!((booked / work - 1.0).abs() < 2e-3, "{booked} {work}");
    let dissipated = -energy.interface.expect("both sides").cross_viscosity;
    assert!((dissipated + given("fluid") + given("solid")).abs() < 1e-9 * dissipated);
    assert!(dissipated > 0.0 && given("fluid") > 0.0, "{dissipated} {}", given("fluid"));
    assert!(energy.relative_residual < 0.01, "{}", energy.relative_residual);
}

/// Two solids, a clamped elastic floor and a free rigid body above it, of two processes.
#[test]
fn the_same_bits_however_it_is_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("two.toml");
    let one = "[solid]\ndensity = 1000.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n";
    let two = one.replace("[solid]", "[[solid]]\nname = \"floor\"")
        + "[[solid]]\nname = \"block\"\nmodel = \"rigid\"\ndensity = 500.0\n";
    let text = SLOT.replace(one, &two).replace("phase = \"solid\"", "phase = \"solid\"\nsolid = \"floor\"")
        + "[[shape]]\nname = \"block\"\nphase = \"solid\"\nsolid = \"block\"\n\
           box = { min = [0.25, 0.03], max = [0.35, 0.07] }\n";
    std::fs::write(&path, text).expect("a scene");
    let until = |seconds| {
        scene_at(&path).set("resolution", 0.01).set("output.checkpoint_interval", 0.03).until(seconds)
    };
    let slot = || until(0.1);
    let whole = slot().run();
    let effect = whole.report.effects.iter().find(|effect| effect.name == "interface-viscosity");
    assert!(effect.is_some_and(|effect| effect.on), "{effect:?}");
    for (what, other) in
        [("threads of one process", slot().in_process()), ("three threads", slot().threads(3))]
    {
        let other = other.run();
        assert_eq!(other.state_hash(), whole.state_hash(), "{what}");
        assert_eq!(other.probes, whole.probes, "{what}");
    }
    let dir = folder.path().join("resumed");
    let half = until(0.05).out(&dir).run();
    assert_ne!(half.state_hash(), whole.state_hash());
    let resumed = scene_at(&path).resume(&dir).until(0.1).run();
    assert_eq!(resumed.state_hash(), whole.state_hash(), "resumed");
    let slips = slot().set("effects.interface-viscosity", "off").run();
    assert_ne!(slips.state_hash(), whole.state_hash(), "the hash tells");
}
