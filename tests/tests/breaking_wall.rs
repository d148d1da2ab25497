//! `scenes/breaking-wall.toml`, `scenes/tsunami-wall.toml`: water breaks brittle walls.

use halfstep_output::run_json::RunStatus;
use halfstep_tests::run::{repository, scene_at};
use halfstep_tests::scene;

fn coarse() -> halfstep_tests::RunBuilder {
    scene("breaking-wall").set("resolution", 0.004).set("output.probe_interval", 0.001)
}

/// Until after the impact, ten times as strong.
#[test]
fn a_wall_that_holds_is_one_that_cannot_break() {
    let strong = || {
        let wall = coarse().set("solid.fracture.strength", 4e6).set("solid.fracture.energy", 300.0);
        wall.until(0.16).in_process()
    };
    let breakable = strong().run();
    let whole = strong().set("effects.fracture", "off").run();
    assert_eq!(breakable.state_hash(), whole.state_hash());
    assert!(breakable.curve("tip.x").peak().1 > 1e-4, "the water has arrived");
    assert_eq!(breakable.curve("crack.energy").peak().1, 0.0);
}

#[test]
#[ignore = "a minute"]
fn the_wall_breaks_alike_in_processes_and_threads_and_its_ledger_is_closed() {
    // Most of the ledger's rest comes when the fragments strike the floor.
    // The last row tears half a ms after the others: rows of the probes have to part the two.
    let wall = || coarse().set("output.probe_interval", 0.0005).until(0.3);
    let broken = wall().run();
    assert_eq!(broken.report.status, Some(RunStatus::Finished));
    // The wall breaks off at its foot and slides over it and the floor in one piece; after this, at 0.335 s, it meets
    // the far wall with 2 m/s and falls to crumbs.
    assert_eq!(broken.curve("pieces.bodies").peak().1, 2.0);
    assert_eq!(broken.curve("pieces.loose").peak().1, 0.0);
    let threads = wall().in_process().threads(1).run();
    assert_eq!(broken.state_hash(), threads.state_hash());
    // What nobody gave the wall, over what the water gave it.
    let largest = |name: &str| broken.curve(name).values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let (rest, given) = (largest("ledger.integration"), largest("ledger.interface-pressure"));
    println!("rest of the ledger {rest} J, given by the water {given} J");
    // 1.5e-5 measured.
    assert!(rest < 1e-4 * given, "{rest} of {given}");
    // Of water and wall, as run.json has it.
    let energy = broken.report.energy.as_ref().expect("ledgers");
    assert!(energy.relative_residual < 1e-2, "{}", energy.relative_residual);
    // The crack runs along the foot: what is cracked through lies in the lowest row.
    let frames = broken.outcome.frames("solid");
    let early = frames.iter().rfind(|frame| frame.time < 0.1705).expect("a frame");
    let cracked = (0..early.len()).filter(|&k| early.damage[k] > 0.95);
    let heights: Vec<f32> = cracked.map(|k| early.points[k][1] - early.displacement[k][1]).collect();
    assert!(!heights.is_empty() && heights.iter().all(|y| (0.0..0.004).contains(y)), "{heights:?}");
    // Beam theory lets it break under an even pressure of 3 kPa, a jet of 2.4 m/s, which is there 30 ms after the water
    // (0.12 s); a spacing of 2 mm breaks 5 % later. The first two of three rows take G_f times their length, and
    // what swings.
    let opened = broken.curve("opened.area");
    let first = broken.curve("crack.energy").first_above(f64::MIN_POSITIVE).unwrap();
    let cut = opened.first_above(0.0075).unwrap();
    let ratio = broken.curve("crack.energy").at(cut) / (3.0 * opened.at(cut));
    println!("first damage at {first} s, cut through two thirds at {cut} s, {ratio} of G_f");
    // Rows are 0.5 ms apart. Until here the last digits of other instructions change nothing: 0.02 is a tenth of what
    // another spacing does.
    assert!((first - 0.1561).abs() < 0.0012 && (cut - 0.162).abs() < 0.0012, "{first} {cut}");
    assert!((ratio - 1.103).abs() < 0.02, "{ratio}");
}

/// Momentum along x of what has come off above the floor, N s/m, in a frame.
fn momentum(frame: &halfstep_output::Frame, mass: f64) -> f64 {
    let free = |k: &usize| frame.points[*k][1] - frame.displacement[*k][1] > 0.0;
    (0..frame.len()).filter(free).map(|k| mass * f64::from(frame.velocity[k][0])).sum()
}

/// What flows past a wall's place, x = 0.32 m, until 0.3 s, m²: through the breach, and over one that holds. And the
/// momentum that the water gives the fragment.
#[test]
#[ignore = "half a minute"]
fn water_goes_through_the_breach() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("wall.toml");
    let text = std::fs::read_to_string(repository().join("scenes/breaking-wall.toml")).expect("a scene");
    let more = "\n[[probe]]\nname = \"through\"\nkind = \"flux\"\nfrom = [0.32, 0.0]\nto = [0.32, 0.3]\n\
                [[probe]]\nname = \"push\"\nkind = \"force\"\nshape = \"wall\"\n\
                within = { min = [0.28, 0.0], max = [0.3, 0.1] }\n";
    std::fs::write(&path, text + more).expect("a scene");
    let wall = || scene_at(&path).set("resolution", 0.004).set("output.probe_interval", 0.001).until(0.3);
    let volume = |run: halfstep_tests::run::Finished| {
        let flux = run.curve("through.flux");
        flux.mean() * 0.3
    };
    let run = wall().run();
    let mass = 2500.0 * 0.004 * 0.004;
    let after = run.outcome.frames("solid").into_iter().filter(|frame| frame.time > 0.19);
    let moved: Vec<(f64, f64)> = after.map(|frame| (frame.time, momentum(&frame, mass))).collect();
    let (first, last) = (moved[0], moved[moved.len() - 1]);
    let impulse = run.curve("push.x").between(first.0, last.0).mean() * (last.0 - first.0);
    println!(
        "the fragment's momentum {first:?} to {last:?} s, N s/m; the water's impulse meanwhile {impulse}"
    );
    // Nothing else pushes it along the floor, which is without friction.
    assert!((impulse / (last.1 - first.1) - 1.0).abs() < 0.05, "{impulse}");
    let broken = volume(run);
    let whole = volume(wall().set("solid.fracture.strength", 4e6).set("solid.fracture.energy", 300.0).run());
    println!(
        "{:.2} litres a metre through the breach, {:.2} over a wall that holds",
        1e3 * broken,
        1e3 * whole
    );
    // 13.24 and 6.75 measured.
    assert!((broken - 0.01324).abs() < 2e-4 && (whole - 0.00675).abs() < 1e-4, "{broken} {whole}");
}

/// A wall clamped at its foot; a piston at 25 mm/s makes the water behind it rise from 0.12 m, by 15 mm/s and more.
/// Side friction takes the swing that the start gives the wall, and holds it back by 1 % of the water's moment at most.
const RISING: &str = r#"
resolution = 0.005
end_time = 2.2
gravity = [0.0, -9.81]
[fluid]
density = 1000.0
[solid]
density = 1000.0
youngs_modulus = 1e8
poissons_ratio = 0.0
side_friction = 150.0
fracture = { strength = 1e5, energy = 0.6 }
[output]
probe_interval = 0.002
frame_interval = 0.1
[[shape]]
name = "water"
phase = "fluid"
box = { min = [-0.2, 0.0], max = [0.0, 0.12] }
pressure = "hydrostatic"
[[shape]]
name = "wall"
phase = "solid"
box = { min = [0.0, -0.02], max = [0.02, 0.22] }
clamp = { min = [-0.01, -0.03], max = [0.03, 0.0] }
[[shape]]
name = "piston"
phase = "wall"
box = { min = [-0.23, 0.0], max = [-0.2, 0.3] }
motion = { velocity = [0.025, 0.0], start = 0.2, end = 4.0 }
[[shape]]
name = "tank"
phase = "wall"
tank = { min = [-0.5, 0.0], max = [0.3, 0.4], open = ["top"] }
[[probe]]
name = "depth"
kind = "water-level"
x = [-0.015, -0.05, -0.08]
[[probe]]
name = "crack"
kind = "crack-energy"
[[probe]]
name = "opened"
kind = "crack-area"
[[probe]]
name = "root"
kind = "moment"
about = [0.01, 0.0]
[[probe]]
name = "tip"
kind = "displacement"
at = [0.01, 0.22]
"#;

/// Spacing, m, G_f, J/m², side friction, N/m³, and as measured: the depth at the first damage and at the cut through
/// half of the wall over that of beam theory, and at the first damage 6 M / t² less the weight over f_t with M of the
/// water's forces. Without side friction the wall swings, and M with it.
const MEASURED: [(f64, f64, f64, [f64; 3]); 5] = [
    (0.005, 0.6, 150.0, [0.981, 0.983, 0.952]),
    (0.005, 0.6, 0.0, [0.974, 0.975, 0.881]),
    (0.0025, 0.6, 150.0, [0.976, 1.034, 0.935]),
    (0.0025, 0.4, 150.0, [0.976, 0.998, 0.935]),
    (0.0025, 0.6, 0.0, [0.946, 1.013, 0.891]),
];

/// Under water of depth d a thin wall has 6 M / t² = rho g d³ / t² at its foot, and its own weight per area holds it
/// together.
#[test]
#[ignore = "minutes"]
fn slowly_rising_water_breaks_a_wall_at_the_depth_of_beam_theory() {
    let (strength, thickness, weight) = (1e5, 0.02_f64, 1000.0 * 9.81 * 0.22);
    let depth = ((strength + weight) * thickness.powi(2) / (1000.0 * 9.81)).cbrt();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rising.toml");
    std::fs::write(&path, RISING).unwrap();
    // t f_t² / (E G_f) is 3.3, 3.3 and 5: with 4 particles across it has to stay below 4.
    for (resolution, energy, side_friction, [first_is, broken_is, stress_is]) in MEASURED {
        let wall = scene_at(&path).set("resolution", resolution).set("solid.fracture.energy", energy);
        let run = wall.set("solid.side_friction", side_friction).until(2.6).run();
        let (level, taken) = (run.curve("depth.level-1"), run.curve("crack.energy"));
        let at = |time: f64| level.at(time) / depth;
        assert_eq!(taken.at(level.first_above(0.85 * depth).unwrap()), 0.0, "damaged at 85 % of the depth");
        let then = taken.first_above(f64::MIN_POSITIVE).unwrap();
        let stress = 6.0 * run.curve("root.moment").at(then).abs() / thickness.powi(2) - weight;
        let (first, stress) = (at(then), stress / strength);
        let broken = at(run.curve("opened.area").first_above(0.5 * thickness).unwrap());
        println!(
            "{resolution} m, {energy} J/m², {side_friction} N/m³: first damage at {first}, with {stress}, cut at {broken}"
        );
        // What was asked for; without side friction the finer wall misses it by 0.4 %.
        assert!(
            (first - 1.0).abs() < if side_friction > 0.0 { 0.05 } else { 0.06 },
            "first damage at {first}"
        );
        assert!((first - first_is).abs() < 0.015, "first damage at {first}");
        let within = if side_friction > 0.0 { 0.02 } else { 0.04 };
        assert!((stress - stress_is).abs() < within, "6 M / t² at {stress}");
        assert!((broken - 1.0).abs() < 0.1 && (broken - broken_is).abs() < 0.03, "broken at {broken}");
    }
}

/// Until the first wall has broken and lies on the second.
fn two_walls() -> halfstep_tests::RunBuilder {
    scene("tsunami-wall").set("resolution", 0.01).set("output.probe_interval", 0.002)
}

#[test]
fn the_first_of_two_walls_breaks_and_the_run_is_killed_and_goes_on() {
    let whole = two_walls().until(0.3).in_process().run();
    assert!(whole.curve("crack.energy").peak().1 > 0.0 && whole.curve("opened.area").peak().1 > 0.0);
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("run");
    let short =
        two_walls().set("output.checkpoint_interval", 0.02).until(0.25).out(&dir).in_process().start();
    // It has begun to crack.
    short.killed_at(0.23);
    let resumed = scene("tsunami-wall").resume(&dir).until(0.3).in_process().run();
    assert!(resumed.report.resumed[0].time > 0.2, "{:?}", resumed.report.resumed);
    assert_eq!(resumed.state_hash(), whole.state_hash());
    let cracks = |run: &halfstep_tests::run::Finished| run.curve("opened.area").values.clone();
    assert_eq!(cracks(&resumed), cracks(&whole));
}

/// To the end, when the first wall has struck the second and both are debris: 4.5e-4 to 5.6e-4 of the most that they
/// move with, by last digits.
#[test]
#[ignore = "a minute"]
fn the_ledger_of_two_walls_is_closed_among_their_debris() {
    let run = scene("tsunami-wall").set("resolution", 0.02 / 3.0).run();
    let largest = |name: &str| run.curve(name).values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let (rest, moves) = (largest("ledger.integration"), largest("ledger.kinetic"));
    println!("rest of the ledger {rest} J, kinetic energy up to {moves} J");
    assert!(run.curve("pieces.bodies").peak().1 > 10.0);
    assert!(rest < 1e-3 * moves, "{rest} of {moves}");
}
