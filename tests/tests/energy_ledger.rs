//! The energy ledger: it closes, it says what theory says, and no bit of a run depends on it.

use halfstep_scene::EnergyPart;
use halfstep_tests::run::{repository, scene_at};
use halfstep_tests::{Finished, RunBuilder};
use std::path::Path;

/// A scene's text with energy probes, without the curves of other files, as a run.
fn with_ledgers(folder: &Path, text: &str, phases: &[&str]) -> RunBuilder {
    let own = |block: &&str| !block.starts_with("reference") && !block.starts_with("metric");
    let mut text = text.split("\n[[").filter(own).collect::<Vec<_>>().join("\n[[");
    for phase in phases {
        text += &format!("\n[[probe]]\nname = \"ledger-{phase}\"\nkind = \"energy\"\nphase = \"{phase}\"\n");
    }
    let path = folder.join(format!("ledger-{}.toml", phases.len()));
    std::fs::write(&path, text).expect("a scene");
    scene_at(&path)
}

/// The text of a shipped scene.
fn shipped(name: &str) -> String {
    std::fs::read_to_string(repository().join("scenes").join(name).with_extension("toml")).expect("a scene")
}

/// A part of a participant's ledger at the end, J.
fn joules(run: &Finished, participant: &str, part: EnergyPart) -> f64 {
    run.report.energy.as_ref().and_then(|energy| energy.joules(participant, part)).expect("a ledger")
}

/// Holds the rest of all ledgers below a part of the largest energy exchanged.
fn closes(what: &str, run: &Finished, limit: f64) {
    let energy = run.report.energy.as_ref().expect("ledgers");
    let rest = energy.relative_residual;
    println!("{what}: rest {rest:.2e} of {:?}", energy.largest);
    assert!(rest < limit, "{what}: rest {rest} of {:?}", energy.largest);
}

fn within(what: &str, value: f64, expected: f64, share: f64) {
    println!("{what}: {value:.6e}, expected {expected:.6e}");
    assert!((value / expected - 1.0).abs() < share, "{what}: {value}, expected {expected} to {share}");
}

// ---- Coupled --------------------------------------------------------------------------------------------------------

/// The ledgers close far below the 1 % that they are for, no bit of the run depends on them, and they are the same for
/// processes and after an interruption.
#[test]
fn the_elastic_gates_ledgers_close_and_change_no_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let gate = |phases: &[&str]| {
        let gate = with_ledgers(folder.path(), &shipped("elastic-gate"), phases);
        gate.set("resolution", 0.0025).set("output.frame_interval", 0.05)
    };
    let both = ["fluid", "solid"];
    let whole = gate(&both).until(0.05).in_process().run();
    let without = gate(&[]).until(0.05).in_process().run();
    assert_eq!(whole.state_hash(), without.state_hash());
    assert_eq!(whole.report.steps, without.report.steps);
    assert_eq!(without.report.energy, None, "nobody asks");
    // 9e-5 measured: the midpoint scheme's error.
    closes("elastic gate, 2.5 mm", &whole, 2e-4);

    let dir = folder.path().join("run");
    let short = gate(&both).set("output.checkpoint_interval", 0.01);
    short.until(0.04).out(&dir).run();
    let resumed = scene_at(&folder.path().join("ledger-2.toml")).resume(&dir).until(0.05).run();
    assert_eq!(resumed.state_hash(), whole.state_hash());
    assert_eq!(resumed.report.energy, whole.report.energy);

    // What the water loses, the plate gets, but for what f_i turns into heat.
    let give = |who, part| joules(&whole, who, part);
    let pressure = give("solid", EnergyPart::InterfacePressure);
    within("pressure", -give("fluid", EnergyPart::InterfacePressure), pressure, 0.03);
    let exchanged = whole.report.energy.as_ref().and_then(|energy| energy.interface).expect("both sides");
    assert!(exchanged.cross_viscosity < 0.0, "{exchanged:?}");
    let held = give("solid", EnergyPart::Strain) + give("solid", EnergyPart::Kinetic);
    within("the plate's energy", held, pressure + give("solid", EnergyPart::CrossViscosity), 0.05);
}

/// The same by position Verlet, which evaluates forces with the velocity at n: powers are of the step's mean velocity.
/// 6.6e-4 and 7.2e-4 measured: what damps is evaluated with velocities of n and densities of n - 1/2.
#[test]
fn the_ledgers_close_by_position_verlet() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, dx, until, limit) in
        [("elastic-gate", 0.0025, 0.05, 8e-4), ("dam-break-plate", 0.004, 0.17, 9e-4)]
    {
        let run = with_ledgers(folder.path(), &shipped(name), &["fluid", "solid"]).set("resolution", dx);
        let run = run.set("fluid.time_integration", "verlet").until(until).in_process().run();
        closes(&format!("{name} by position Verlet"), &run, limit);
    }
}

/// A piston shakes a closed box of water with 25 Hz: walls show continuity the fluid's mean velocity over the step, and
/// compression holds what it has at n. 4.6e-4 measured by either rule; 9.4e-2 with what walls show the fluid of n,
/// 1.7e-2 with what compression has half a step before.
#[test]
fn the_ledger_of_a_shaken_box_closes_by_either_rule() {
    let text = "resolution = 0.01\nend_time = 0.5\ngravity = [0.0, 0.0]\n\
         [fluid]\ndensity = 1000.0\nsound_speed = 30.0\nbackground_pressure = 5000.0\n[numerics]\ncfl = 0.4\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.4, 0.2] }\n\
         [[shape]]\nname = \"piston\"\nphase = \"wall\"\nbox = { min = [-0.06, 0.0], max = [0.0, 0.2] }\n\
         motion = { amplitude = [0.0005, 0.0], period = 0.04, ramp = 0.1 }\n\
         [[shape]]\nname = \"box\"\nphase = \"wall\"\n\
         tank = { min = [-0.1, 0.0], max = [0.4, 0.2], open = [\"left\"] }\n";
    let folder = tempfile::tempdir().expect("a folder");
    for (rule, limit) in [("verlet", 7e-4), ("midpoint", 7e-4)] {
        let run = with_ledgers(folder.path(), text, &["fluid"]).set("fluid.time_integration", rule);
        let run = run.in_process().threads(1).run();
        closes(&format!("shaken box, {rule}"), &run, limit);
    }
}

#[test]
fn the_ledgers_of_a_dam_break_on_a_plate_close() {
    let folder = tempfile::tempdir().expect("a folder");
    let plate = with_ledgers(folder.path(), &shipped("dam-break-plate"), &["fluid", "solid"]);
    let run = plate.set("resolution", 0.004).until(0.17).in_process().run();
    // 1.1e-4 measured.
    closes("dam break on a plate, 4 mm", &run, 5e-4);
    for part in [EnergyPart::ArtificialViscosity, EnergyPart::WallGuard, EnergyPart::DensityDiffusion] {
        assert!(joules(&run, "fluid", part) < 0.0, "{part:?} takes energy");
    }
}

/// All sinks at once: water, a plate that relaxes and rubs on the side walls, and a stop that lets it go.
#[test]
fn the_fitted_gates_ledger_closes_with_all_its_sinks() {
    let folder = tempfile::tempdir().expect("a folder");
    let gate = with_ledgers(folder.path(), &shipped("elastic-gate-rubber"), &["fluid", "solid"]);
    let run = gate.until(0.04).in_process().run();
    // 2.1e-4 measured.
    closes("fitted gate, 2.5 mm", &run, 3e-4);
    for part in [EnergyPart::Relaxation, EnergyPart::SideFriction, EnergyPart::WallContact] {
        let joules = joules(&run, "solid", part);
        println!("{part:?} {joules:.2e} J");
        assert!(joules < 0.0, "{part:?} takes energy: {joules} J");
    }
}

/// At 20 mm, three particles across the column, the guard stops particles within a step: what it takes of the water's
/// energy, and the rest of the ledger, are largest there.
#[test]
fn a_dam_breaks_ledger_closes_where_it_is_resolved() {
    let folder = tempfile::tempdir().expect("a folder");
    // 2.6e-3, 2.1e-4, 1.1e-2 and 4.2e-4 measured; the guard's joules are of 3.8 J and 3.2 J.
    for (rule, dx, limit, joules_of_guard, share) in [
        ("verlet", 0.02, 3.5e-3, 0.818, 0.02),
        ("verlet", 0.005715, 3e-4, 0.0927, 0.05),
        ("midpoint", 0.02, 1.2e-2, 1.06, 0.02),
        ("midpoint", 0.005715, 6e-4, 0.103, 0.05),
    ] {
        let run = with_ledgers(folder.path(), &shipped("dam-break"), &["fluid"]).set("resolution", dx);
        let run = run.set("fluid.time_integration", rule).until(0.3).in_process().run();
        closes(&format!("dam break, {dx} m, {rule}"), &run, limit);
        within("the guard", -joules(&run, "fluid", EnergyPart::WallGuard), joules_of_guard, share);
    }
}

/// Particles that are shifted go up and down without a velocity.
#[test]
fn the_ledger_of_shifted_water_closes() {
    let folder = tempfile::tempdir().expect("a folder");
    let wave = with_ledgers(folder.path(), &shipped("standing-wave"), &["fluid"]);
    let wave = wave.set("resolution", 0.05).until(0.5).in_process();
    // Shifting moves water down: three fifths of the largest kinetic energy.
    for (rule, limit, shifting) in [("verlet", 3e-3, -0.595), ("midpoint", 1.5e-3, -0.584)] {
        let run = wave.clone().set("fluid.time_integration", rule).run();
        closes(&format!("standing wave, shifted, 50 mm, {rule}"), &run, limit);
        within("shifting", joules(&run, "fluid", EnergyPart::ParticleShifting), shifting, 0.02);
    }
}

/// Phase-blind, with the hypoelastic solid, whose stress has a part of its own.
#[test]
fn the_papers_gate_closes() {
    let folder = tempfile::tempdir().expect("a folder");
    let gate = with_ledgers(folder.path(), &shipped("elastic-gate"), &["fluid", "solid"]);
    let gate = gate.set("preset", "kayaki").set("resolution", 0.0025).set("time_step", "auto");
    let run = gate.until(0.01).in_process().run();
    closes("the paper's gate, 2.5 mm", &run, 1e-5);
}

// ---- The fluid alone ------------------------------------------------------------------------------------------------

/// Taylor and Green's vortex loses 4 nu k² of its kinetic energy in a second to viscosity. The ledger says what the
/// decay alone does not: before particles mix viscosity takes that to 1 %, and the walls' pressure takes 6 % of it;
/// with twice the spacing 11 %.
#[test]
fn taylor_and_greens_vortex_loses_its_energy_to_viscosity() {
    // 9.0e-4, 3.2e-4, 4.8e-5 and 9.9e-6 measured.
    for (dx, rule, viscosity, walls, limit) in [
        (0.04, "verlet", 1.010, 0.1111, 1.1e-3),
        (0.02, "verlet", 1.007, 0.0592, 4e-4),
        (0.04, "midpoint", 1.010, 0.1120, 6e-5),
        (0.02, "midpoint", 1.007, 0.0594, 6e-5),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let vortex = with_ledgers(folder.path(), &shipped("taylor-green"), &["fluid"]).set("resolution", dx);
        let run = vortex.set("fluid.time_integration", rule).until(0.1).in_process().run();
        closes(&format!("Taylor and Green, {dx} m, {rule}"), &run, limit);
        let nu = run.report.scene["fluid"]["viscosity"].as_f64().expect("a number") / 1000.0;
        let (k, kinetic) = (std::f64::consts::PI, run.curve("ledger-fluid.kinetic").mean());
        let by = |part| -joules(&run, "fluid", part);
        let theory = 4.0 * nu * k * k * kinetic * run.report.time;
        within("viscosity", by(EnergyPart::Viscosity), viscosity * theory, 0.005);
        within("pressure of the walls", by(EnergyPart::WallPressure), walls * theory, 0.02);
    }
}

/// A piston that goes 0.1 m in 2 s turns 0.5 m x 0.2 m of water into 0.4 m x 0.25 m: its work is what the water weighs
/// times how far that rises, rho g (0.4 x 0.25² - 0.5 x 0.2²) / 2.
#[test]
fn a_slow_pistons_work_lifts_the_water() {
    let text = "resolution = 0.01\nend_time = 2.0\ngravity = [0.0, -9.81]\n[fluid]\ndensity = 1000.0\n\
        [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.5, 0.2] }\n\
        pressure = \"hydrostatic\"\n[[shape]]\nname = \"piston\"\nphase = \"wall\"\n\
        box = { min = [-0.08, 0.0], max = [0.0, 0.4] }\nmotion = { velocity = [0.05, 0.0], end = 2.0 }\n\
        [[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
        tank = { min = [-0.2, 0.0], max = [0.5, 0.4], open = [\"left\", \"top\"] }";
    let folder = tempfile::tempdir().expect("a folder");
    let run = with_ledgers(folder.path(), text, &["fluid"]).in_process().run();
    closes("a slow piston", &run, 2e-4);
    let expected = 0.5 * 1000.0 * 9.81 * (0.4 * 0.25_f64.powi(2) - 0.5 * 0.2_f64.powi(2));
    within("work of the piston", joules(&run, "fluid", EnergyPart::MovingWalls), expected, 0.035);
    within("potential energy", joules(&run, "fluid", EnergyPart::Potential), expected, 0.015);
}

// ---- The solid alone ------------------------------------------------------------------------------------------------

/// A plate swings from kinetic to strain energy and back, and loses what its viscosity, or a Maxwell arm, takes.
#[test]
fn the_oscillating_plates_ledger_closes() {
    let folder = tempfile::tempdir().expect("a folder");
    let plate = || with_ledgers(folder.path(), &shipped("oscillating-plate"), &["solid"]).in_process();
    let run = plate().until(0.03).run();
    closes("oscillating plate", &run, 3e-5);
    let relaxing = plate().set("solid.prony", "[[0.5, 0.01]]").until(0.03).run();
    closes("relaxing", &relaxing, 3e-5);
    assert!(joules(&relaxing, "solid", EnergyPart::Relaxation) < 0.0);
    let hypoelastic = plate().set("solid.model", "hypoelastic").until(0.02).run();
    closes("hypoelastic", &hypoelastic, 1e-4);
}

/// A beam whose clamp swings, and a block on a floor that throws it up.
#[test]
fn clamps_and_floors_that_move_do_the_work() {
    let solid = "resolution = 0.005\nend_time = 0.5\n[solid]\ndensity = 1000.0\nyoungs_modulus = 2e6\n\
        poissons_ratio = 0.3\n[[shape]]\nname = \"body\"\nphase = \"solid\"\n\
        box = { min = [-0.02, 0.0], max = [0.1, 0.02] }\n";
    let beam = "clamp = { min = [-0.02, 0.0], max = [0.0, 0.02], with = \"base\" }\n[[shape]]\nname = \"base\"\n\
        phase = \"wall\"\nbox = { min = [-0.05, -0.03], max = [-0.03, 0.05] }\n\
        motion = { amplitude = [0.0, 1e-2], period = 0.2 }";
    let floor = "[[shape]]\nname = \"floor\"\nphase = \"wall\"\ncontact = true\n\
        box = { min = [-0.05, -0.06], max = [0.15, 0.0] }\n\
        motion = { amplitude = [0.0, 0.01], period = 0.1, ramp = 0.05 }";
    for (what, more, part) in [("beam", beam, EnergyPart::Clamps), ("block", floor, EnergyPart::MovingWalls)]
    {
        for model in ["total-lagrangian", "hypoelastic"] {
            if (what, model) == ("beam", "hypoelastic") {
                continue;
            }
            let folder = tempfile::tempdir().expect("a folder");
            let rest = |cfl: f64, limit: f64| {
                let run = with_ledgers(folder.path(), &format!("{solid}{more}"), &["solid"]);
                let run = run.set("solid.model", model).set("numerics.solid_cfl", cfl);
                let run = run.in_process().until(0.2).run();
                closes(&format!("{what}, {model}, {cfl}"), &run, limit);
                let (work, held) =
                    (joules(&run, "solid", part), joules(&run, "solid", EnergyPart::Potential));
                assert!(work > held, "{what}, {model}: work {work} J, lifted {held} J");
                run.report.energy.expect("ledgers").relative_residual
            };
            // A contact's spring is stiffer than the solid: 3e-3 with the default step, and of second order.
            let rests = [rest(0.3, 1e-3), rest(0.15, 2.5e-4)];
            let order = (rests[0] / rests[1]).log2();
            println!("order {order:.2}");
            assert!(order > 1.8, "{what}, {model}: {rests:?}");
        }
    }
}
