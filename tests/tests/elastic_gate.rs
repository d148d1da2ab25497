//! Elastic gate (Antoci, Gallati and Sibilla 2007): the plate's free end against the experiment and against what
//! others computed.
//!
//! The experiment's points and the published peaks are in `validation/elastic-gate/reference`. Computations of a plate
//! that is as linear as the datasheet's E peak early and low; the total-Lagrangian solid is one of them. The
//! hypoelastic solid is softer than its E says and comes nearer to the experiment by that.

use halfstep_tests::{Curve, Finished, RunBuilder, scene};
use halfstep_wire::frame::FLUID;
use nalgebra::{DMatrix, DVector};

/// 2 particles across, the least that bends at all: too stiff with the total-Lagrangian solid.
const TWO_ACROSS: f64 = 0.0025;

const THREE_ACROSS: f64 = 0.005 / 3.0;

/// Displacement of the free end, mm.
fn tip(run: &Finished, component: &str) -> Curve {
    let curve = run.curve(&format!("tip.{component}"));
    Curve { values: curve.values.iter().map(|v| 1e3 * v).collect(), ..curve }
}

/// Figures of a gate, printed for the record.
fn state(what: &str, run: &Finished) -> (f64, f64) {
    let (x, y) = (tip(run, "x"), tip(run, "y"));
    let (time, peak) = x.peak();
    let points: Vec<String> = [0.04, 0.08, 0.12, 0.16, 0.20, 0.24]
        .iter()
        .filter(|t| **t <= run.report.time)
        .map(|&t| format!("{:.1}", x.at(t)))
        .collect();
    let experiment = Curve::reference("elastic-gate", "experiment.csv", "x [mm]");
    println!(
        "{what}: peak x {peak:.1} mm @ {time:.3} s, y {:.1} mm; x at .04 .08 ... s: {}; rms to the experiment \
         {:.1} mm; closest {:.2} dx; {} steps, {:.0} s",
        y.at(time),
        points.join(" "),
        x.rms_to(&experiment),
        run.report.audit.min_gap.unwrap_or(f64::NAN),
        run.report.steps,
        run.report.wall_seconds
    );
    (time, peak)
}

/// What holds for every gate, whatever its resolution.
fn sound(run: &Finished) {
    let audit = &run.report.audit;
    assert!(audit.action_reaction.unwrap() <= 1e-12, "{audit:?}");
    assert!(audit.impulse.unwrap() <= 1e-12, "{audit:?}");
    assert!(audit.min_gap.unwrap() > 0.3, "no particle may pass through the plate: {audit:?}");
    let roles = &run.report.roles;
    assert!(roles.fluid.is_some() && roles.solid.is_some() && roles.coupler.is_some());
}

/// As far as the published computations of such a plate, 35.5 mm (Yang et al. 2012) to 42.7 mm (Khayyer et al. 2018) at
/// 0.10 to 0.12 s, and as measured, to half a millimetre: other processors round otherwise.
fn as_a_linear_plate((time, peak): (f64, f64), measured: f64) {
    assert!((35.5..=42.7).contains(&peak) && (peak - measured).abs() < 0.5, "{peak} mm");
    assert!((0.10..=0.12).contains(&time), "{time} s");
}

/// The experiment itself while the gate opens, 12.5 mm at 0.04 s and 34.0 mm at 0.08 s: farther by `ahead`, mm, at
/// these instants, as measured, to a millimetre, by which two digitisations of the experiment differ. An elastic plate
/// that is let go at once opens too early.
fn opens_as_in_the_experiment(run: &Finished, ahead: [f64; 2]) {
    let experiment = Curve::reference("elastic-gate", "experiment.csv", "x [mm]");
    for (time, ahead) in [0.04, 0.08].into_iter().zip(ahead) {
        let (found, truth) = (tip(run, "x").at(time), experiment.at(time));
        println!("{found:.2} mm at {time} s, {truth} mm in the experiment");
        assert!((found - truth - ahead).abs() < 1.0, "{found} mm at {time} s, {truth} mm in the experiment");
    }
}

#[test]
fn a_coarse_gate_opens_as_others_open() {
    let run = scene("elastic-gate").set("resolution", THREE_ACROSS).until(0.2).run();
    sound(&run);
    as_a_linear_plate(state("gate, 3 across", &run), 38.24);
    opens_as_in_the_experiment(&run, [2.3, 0.4]);
    // A free end that swings on a fixed length rises: 11.3 mm measured.
    assert!((tip(&run, "y").at(0.12) - 11.3).abs() < 0.5);
    for stem in ["fluid", "solid"] {
        let frames = run.outcome.frames(stem);
        assert_eq!(frames.len(), 21, "{stem}");
        assert!(frames.windows(2).all(|f| f[0].len() == f[1].len() && f[0].time < f[1].time), "{stem}");
    }
}

/// The peak that more particles do not change, mm: 5 across and water at 1 mm, and finite elements in the same water.
const CONVERGED: f64 = 36.6;

/// Five particles across the plate and coarse water: 3 % is what water at 2.5 mm may be off beside finer water,
/// whatever computes the plate; particles and finite elements are off by 0.8 and 1.1 %.
#[test]
fn a_plate_with_a_spacing_of_its_own_bends_in_coarse_water_as_the_converged_one() {
    for (model, measured) in [("total-lagrangian", 36.29), ("finite-element", 36.19)] {
        let gate = scene("elastic-gate").set("resolution", 0.0025).set("shape.plate.across", 5);
        let run = gate.set("solid.model", model).until(0.12).run();
        sound(&run);
        assert_eq!(run.report.particles.solid, 5 * 99);
        let (time, peak) = state(&format!("gate, water at 2.5 mm, plate at 1 mm, {model}"), &run);
        assert!((peak / CONVERGED - 1.0).abs() < 0.03, "{peak} mm");
        assert!((peak - measured).abs() < 0.25, "{peak} mm");
        // 0.1041 s measured.
        assert!((0.102..0.106).contains(&time), "{time} s");
    }
}

/// A plate by finite elements bends in implicit steps as in explicit sub-steps; of steel it leaves the fluid its step,
/// however it is run.
#[test]
fn an_implicit_plate_takes_the_fluids_steps() {
    let gate = |integration: &str| {
        let gate = scene("elastic-gate").set("resolution", 0.0025).set("shape.plate.across", 5);
        gate.set("solid.model", "finite-element").set("solid.time_integration", integration)
    };
    let [implicit, explicit] =
        ["implicit", "explicit"].map(|how| tip(&gate(how).until(0.03).run(), "x").at(0.03));
    println!("tip {implicit:.6} mm implicit, {explicit:.6} mm explicit");
    // 4e-5 measured.
    assert!((implicit / explicit - 1.0).abs() < 5e-4, "{implicit} {explicit}");
    let steel = || gate("implicit").set("solid.youngs_modulus", 2e11).set("solid.density", 7800).until(0.01);
    let run = steel().run();
    println!("{} steps", run.report.steps);
    assert!(run.report.steps < 150, "{}", run.report.steps);
    assert_eq!(run.state_hash(), steel().in_process().run().state_hash());
}

#[test]
fn a_coarse_hypoelastic_gate_opens_as_others_open() {
    let run = scene("elastic-gate")
        .set("resolution", TWO_ACROSS)
        .set("solid.model", "hypoelastic")
        .until(0.16)
        .run();
    sound(&run);
    let (time, peak) = state("hypoelastic gate, 2 across", &run);
    // 37.55 mm @ 0.1145 s measured; the published ones are 35.5 mm (Yang et al. 2012) to 50.1 mm (Antoci et al. 2007).
    assert!((37.2..37.9).contains(&peak) && (0.112..0.117).contains(&time), "{peak} mm at {time} s");
    opens_as_in_the_experiment(&run, [0.8, -0.7]);
}

#[test]
fn the_phase_blind_gate_opens() {
    let run = scene("elastic-gate")
        .set("resolution", TWO_ACROSS)
        .set("interface.treatment", "phase-blind")
        .until(0.02)
        .run();
    let x = tip(&run, "x");
    println!("phase-blind, 2.5 mm: x {:.2} mm at 0.02 s, experiment 12.5 mm at 0.04 s", x.at(0.02));
    assert!(run.report.audit.action_reaction.unwrap() <= 1e-12);
    // Away from the water, and faster and faster: 3.84 mm measured by 0.02 s, and nothing there to compare with.
    assert!(x.at(0.005) < x.at(0.01) && x.at(0.01) < x.at(0.015) && x.at(0.015) < x.at(0.02));
    assert!((3.7..4.0).contains(&x.at(0.02)), "{}", x.at(0.02));
}

/// Root mean square of x over the experiment's points in a window, mm.
fn rms_to_experiment(run: &Finished, from: f64, to: f64) -> f64 {
    let experiment = Curve::reference("elastic-gate", "experiment.csv", "x [mm]").between(from, to);
    tip(run, "x").rms_to(&experiment)
}

/// Fitted until 0.2 s, predicted after that: the plate comes back too slowly. The bands are as wide as a change of the
/// water moves the tip, some tenths of a millimetre, and narrow enough that the page's figures hold.
#[test]
#[ignore = "a minute: the fitted plate with water at 2.5 and 1.67 mm"]
fn a_fitted_plate_meets_the_experiment_where_it_was_not_fitted() {
    for (resolution, measured) in [(0.0025, [0.830, 2.60, 45.17]), (0.005 / 3.0, [0.824, 2.74, 45.47])] {
        let run = scene("elastic-gate-rubber").set("resolution", resolution).threads(2).run();
        sound(&run);
        let (time, peak) = state("fitted gate", &run);
        let [fitted, predicted] =
            [(0.0, 0.21), (0.21, 0.37)].map(|(from, to)| rms_to_experiment(&run, from, to));
        println!("fitted points {fitted:.2} mm, predicted points {predicted:.2} mm");
        assert!((fitted - measured[0]).abs() < 0.08, "{fitted} mm");
        assert!((predicted - measured[1]).abs() < 0.3, "{predicted} mm");
        // 0.158 and 0.157 s measured, 0.160 s in the experiment; within 0.1 mm of the peak from 0.142 to 0.188 s.
        assert!((peak - measured[2]).abs() < 0.3 && (0.14..0.19).contains(&time), "{peak} mm at {time} s");
    }
}

#[test]
#[ignore = "minutes: full resolution"]
fn the_gate_at_5_across() {
    let run = scene("elastic-gate").until(0.24).threads(2).run();
    sound(&run);
    as_a_linear_plate(state("gate, 5 across", &run), 36.7);
    opens_as_in_the_experiment(&run, [2.4, -0.4]);
    // In the same water: 36.56 mm @ 0.109 s measured.
    let run = scene("elastic-gate").set("solid.model", "finite-element").until(0.12).threads(2).run();
    sound(&run);
    let (time, peak) = state("gate, 5 across, finite elements", &run);
    println!("finite elements: {peak:.2} mm @ {time:.4} s");
    assert!((36.4..36.8).contains(&peak) && (0.105..0.113).contains(&time), "{peak} mm at {time} s");
}

/// With an odd number of rows the hypoelastic plate bends as if it were stiffer: docs/theory/hypoelastic.md.
#[test]
#[ignore = "minutes: full resolution"]
fn the_hypoelastic_gate_hangs_on_the_number_of_its_rows() {
    for (across, expected) in [(3, 19.2), (4, 45.4), (5, 31.5)] {
        let gate = scene("elastic-gate").set("resolution", 0.005 / f64::from(across));
        let run = gate.set("solid.model", "hypoelastic").until(0.16).threads(2).run();
        sound(&run);
        let (_, peak) = state(&format!("hypoelastic gate, {across} across"), &run);
        assert!((peak - expected).abs() < 0.5, "{across} across: {peak} mm");
    }
}

/// The paper's scheme: its preset, its plate of 6 mm, dt in proportion to the spacing.
fn paper_gate(resolution: f64) -> RunBuilder {
    let gate = scene("elastic-gate").set("preset", "kayaki").set("resolution", resolution);
    gate.set("time_step", 1e-5 * resolution / 1e-3).set("shape.plate.box.max", "[0.106, 0.099]")
}

/// Two rows; they are too soft, 55.7 mm @ 0.16 s. While it opens it is beside the experiment.
#[test]
fn a_coarse_gate_with_the_papers_scheme() {
    let run = paper_gate(0.002).until(0.08).run();
    sound(&run);
    assert_eq!(run.report.steps, 4000);
    opens_as_in_the_experiment(&run, [0.35, 4.3]);
}

/// The paper's peak is between the experiment's 46.4 and Antoci's 50.1 mm, and less after it; ours 45.1 mm @ 0.1215 s.
/// Its plate of five rows is luck: one of 5 mm has four and goes 53.5 mm.
#[test]
#[ignore = "minutes: the paper's scheme at full resolution"]
fn the_gate_with_the_papers_scheme_at_full_resolution() {
    let run = paper_gate(0.001).until(0.16).run();
    sound(&run);
    let (time, peak) = state("paper's gate, 6 mm", &run);
    assert!((peak - 45.1).abs() < 0.5 && (0.115..0.13).contains(&time), "{peak} mm at {time} s");
    let run = paper_gate(0.001).set("shape.plate.box.max", "[0.105, 0.099]").until(0.16).run();
    let (time, peak) = state("paper's gate, 5 mm", &run);
    assert!((peak - 53.5).abs() < 0.5 && (0.14..0.155).contains(&time), "{peak} mm at {time} s");
}

/// Walls that hold values toward the solid (the paper's section 4.1) hold on to the plate's end: 0.19 mm at 1.25 mm.
#[test]
fn the_papers_wall_particles_keep_the_gate_shut() {
    let run = paper_gate(0.002).set("effects.wall-particles", "on").until(0.04).run();
    let x = tip(&run, "x");
    let farthest = x.values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    println!("with wall particles the end moves {farthest:.3} mm by 0.04 s, 12.9 mm without them");
    assert!(farthest < 0.5, "{farthest} mm");
}

#[test]
#[ignore = "many minutes: the paper's interface at full resolution"]
fn the_phase_blind_gate_at_5_across() {
    let run = scene("elastic-gate").set("interface.treatment", "phase-blind").until(0.1).threads(2).run();
    state("gate, phase-blind, 1 mm", &run);
    assert!(run.report.audit.action_reaction.unwrap() <= 1e-12);
    // The experiment: 12.5 and 34.0 mm; it is let go later. Measured with A = 0.1: 14.5 and 38.0 mm.
    for (time, expected) in [(0.04, 14.5), (0.08, 38.0)] {
        let found = tip(&run, "x").at(time);
        println!("{found:.2} mm at {time} s");
        assert!((found - expected).abs() < 1.0, "{found} mm at {time} s");
    }
}

#[test]
#[ignore = "many minutes: up to 5 particles across"]
fn the_gate_from_3_to_5_across() {
    for (across, expected) in [(3, 38.2), (4, 36.9), (5, 36.7)] {
        let resolution = 0.005 / f64::from(across);
        let run = scene("elastic-gate").set("resolution", resolution).until(0.16).threads(2).run();
        sound(&run);
        let (time, peak) = state(&format!("gate, {across} across"), &run);
        as_a_linear_plate((time, peak), expected);
        assert!((peak - expected).abs() < 0.3, "{across} across: {peak} mm");
    }
}

/// Root mean square of the pressures in the basin about the quadratic that fits them best, Pa: sound, and noise of
/// particles.
fn sound_and_noise(run: &Finished) -> f64 {
    let frame = run.outcome.frames("fluid").pop().expect("a last frame");
    let rows: Vec<([f64; 2], f64)> = (0..frame.len())
        .filter(|&k| frame.phase[k] == FLUID)
        .map(|k| ([0, 1].map(|d| f64::from(frame.points[k][d])), f64::from(frame.pressure[k])))
        .filter(|([x, y], p)| *x < 0.15 && (0.01..0.09).contains(y) && *p > 0.0)
        .collect();
    let terms = |[x, y]: [f64; 2]| [1.0, x, y, x * x, y * y, x * y];
    let matrix = DMatrix::from_fn(rows.len(), 6, |i, j| terms(rows[i].0)[j]);
    let pressure = DVector::from_iterator(rows.len(), rows.iter().map(|r| r.1));
    let fit = matrix.clone().svd(true, true).solve(&pressure, 1e-12).expect("a fit");
    ((pressure - matrix * fit).norm_squared() / rows.len() as f64).sqrt()
}

/// The plate's short waves and the water's sound drive each other where nothing damps the plate: by 0.4 s the water is
/// full of it.
#[test]
#[ignore = "a minute: two gates to 0.4 s"]
fn the_plates_viscosity_keeps_sound_out_of_the_water() {
    let gate = || scene("elastic-gate").set("resolution", THREE_ACROSS).threads(2);
    let damped = sound_and_noise(&gate().run());
    let undamped = sound_and_noise(&gate().set("solid.artificial_viscosity.linear", 0).run());
    println!(
        "pressures about their mean field: {damped:.0} Pa, {undamped:.0} Pa without the plate's viscosity"
    );
    assert!(damped < 40.0 && undamped > 60.0, "{damped} {undamped}");
}
