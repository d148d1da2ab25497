//! A run that becomes unstable says whose particle left which bound, and which key to change; its files can be read.

use halfstep::Simulation;
use halfstep_output::run_json::RunStatus;
use halfstep_output::{Frame, RunReport};
use halfstep_tests::{Outcome, RunBuilder, scene};

/// The report's error of a run that must have diverged.
fn diverged(outcome: &Outcome) -> String {
    assert_eq!(outcome.code(), Some(2), "{}", outcome.stderr);
    let report = outcome.report();
    assert_eq!(report.status, Some(RunStatus::Diverged), "{:?}", report.error);
    let error = report.error.unwrap();
    assert!(outcome.stderr.contains(&error), "{}", outcome.stderr);
    assert!(outcome.log().contains(&error), "{}", outcome.log());
    error
}

/// Whose particle, and its number, quantity and value, from `the ROLE diverged at ...: QUANTITY of particle N is V`.
fn named(error: &str) -> (&str, i32, &str, f64) {
    let (role, rest) = error.strip_prefix("the ").unwrap().split_once(" diverged at step ").unwrap();
    let (quantity, rest) = rest.split_once(": ").unwrap().1.split_once(" of particle ").unwrap();
    let (particle, rest) = rest.split_once(" is ").unwrap();
    (role, particle.parse().unwrap(), quantity, rest.split_once(' ').unwrap().0.parse().unwrap())
}

/// Speed of a solid particle in a frame.
fn speed(frame: &Frame, particle: i32) -> f64 {
    let k = frame.id.iter().position(|&id| id == particle).unwrap();
    frame.velocity[k].iter().map(|v| f64::from(*v).powi(2)).sum::<f64>().sqrt()
}

fn warns(outcome: &Outcome, role: &str, limit: f64) {
    let start =
        format!("warning: time_step = 1.0000e-5 s is above the {role}'s stability limit of {limit:.4e} s");
    assert!(outcome.stderr.contains(&start), "{start}\n{}", outcome.stderr);
}

/// E = 0.22 GPa and the preset's time step, 1.77 dx / c_P: stable to 1.1.
fn stiff_plate() -> RunBuilder {
    scene("dam-break-plate").set("preset", "kayaki").set("output.frame_interval", 5e-4).until(0.02)
}

#[test]
fn a_solid_beyond_its_stability_limit_is_named_with_the_key_to_change() {
    let outcome = stiff_plate().outcome();
    let error = diverged(&outcome);
    let (role, particle, quantity, value) = named(&error);
    assert_eq!((role, quantity), ("solid", "speed"), "{error}");
    let c_p = (0.22e9_f64 / 2500.0 * (1.0 - 0.32) / ((1.0 + 0.32) * (1.0 - 2.0 * 0.32))).sqrt();
    assert!(value > 0.25 * c_p, "{error}");
    let limit = 0.6 * 0.002 / c_p;
    let hint = format!("time_step = 1.0000e-5 s is above the solid's stability limit of {limit:.4e} s");
    assert!(error.contains(&hint), "{hint}\n{error}");
    // Told at the start as well, where there is time to stop it.
    warns(&outcome, "solid", limit);

    let (fluid, solid) = (outcome.frames("fluid"), outcome.frames("solid"));
    assert_eq!(fluid.len(), solid.len());
    let [.., before, last] = &solid[..] else { panic!("{} frames", solid.len()) };
    // The last frame shows the particle as it was named; in the one before it was still sound.
    assert!((speed(last, particle) / value - 1.0).abs() < 1e-3, "{error}");
    assert!(speed(before, particle) < 0.25 * c_p);
    assert_eq!(fluid.last().unwrap().time, last.time);
}

#[test]
fn a_fluid_beyond_its_stability_limit_is_named_with_the_key_to_change() {
    let outcome = scene("dam-break").set("time_step", 3e-4).outcome();
    let error = diverged(&outcome);
    let (role, _, quantity, value) = named(&error);
    assert_eq!((role, quantity), ("fluid", "density"), "{error}");
    assert!((value / 1000.0 - 1.0).abs() > 0.3, "{error}");
    assert!(error.contains("hint: time_step = 3.0000e-4 s is above the fluid's stability limit"), "{error}");
    assert!(outcome.frames("fluid").len() >= 2);
}

#[test]
fn a_solid_that_outruns_the_interface_set_is_named() {
    // 60 m/s for half of 1.5e-4 s are 4.5 mm; the set has a margin of 0.6 h = 4 mm.
    let run = scene("spring-block")
        .set("time_step", 1.5e-4)
        .set("fluid.sound_speed", 14)
        .set("shape.block.velocity", "[60, 0]")
        .set("shape.block.box", "{ min = [0.3, 0.02], max = [0.34, 0.14] }")
        .set("probe.block.at", "[0.32, 0.07]");
    for run in [run.clone(), run.in_process()] {
        let outcome = run.outcome();
        let error = diverged(&outcome);
        let (role, _, quantity, value) = named(&error);
        assert_eq!((role, quantity), ("solid", "speed"), "{error}");
        assert!((value / 60.0 - 1.0).abs() < 1e-3, "{error}");
    }
}

#[test]
fn a_step_above_a_limit_is_taken_with_a_warning() {
    // The preset's step on the rubber gate: 1.53 dx / c_P at the spacing of 1 mm, 1.02 at 1.5 mm.
    let run = scene("elastic-gate").set("preset", "kayaki").set("resolution", 0.0015).until(5e-4).run();
    let c_p = (12e6_f64 / 1100.0 * (1.0 - 0.4) / ((1.0 + 0.4) * (1.0 - 2.0 * 0.4))).sqrt();
    warns(&run.outcome, "solid", 0.6 * 0.0015 / c_p);
    assert!(!run.outcome.stderr.contains("fluid's stability limit"), "{}", run.outcome.stderr);
    let auto = scene("elastic-gate").set("resolution", 0.0025).set("shape.plate.across", 5).until(1e-4).run();
    assert!(!auto.outcome.stderr.contains("stability limit"), "{}", auto.outcome.stderr);
}

#[test]
fn a_simulation_of_a_program_that_diverges_leaves_its_report() {
    let folder = tempfile::tempdir().unwrap();
    let path = halfstep_tests::run::repository().join("scenes/colliding-rings.toml");
    let scene = halfstep_scene::load(&path, &["time_step=1e-4".into(), "end_time=0.05".into()]).unwrap();
    let dir = folder.path().join("run");
    let error = Simulation::new(scene).folder(&dir).run().unwrap_err().to_string();
    assert!(error.contains("diverged at step") && error.contains("hint: "), "{error}");
    let report = RunReport::read(&dir.join("run.json")).unwrap();
    assert_eq!((report.status, report.error), (Some(RunStatus::Diverged), Some(error)));
    assert!(dir.join("plot.png").exists());
}

/// Rings whose fixed step is three times the limit: half of it is enough for their time in the run.
#[test]
fn a_diverged_run_goes_back_with_half_the_step() {
    let rings = || {
        let rings = scene("colliding-rings").set("resolution", 0.0015).set("time_step", 2e-5).until(0.004);
        rings.argument("--on-divergence")
    };
    // Without an interval, the run goes back to its start.
    let anew = rings().argument("retry").run();
    let [back] = anew.report.resumed.as_slice() else { panic!("{:?}", anew.report.resumed) };
    assert_eq!((back.time_step_factor, back.step, back.time), (0.5, 0, 0.0));
    let run = rings().argument("retry=2").set("output.checkpoint_interval", 0.001).run();
    let [back] = run.report.resumed.as_slice() else { panic!("{:?}", run.report.resumed) };
    assert!(back.time_step_factor == 0.5 && back.step == 50, "{back:?}");
    assert!(back.because.as_ref().unwrap().contains("diverged at step"), "{back:?}");
    let dt = run.report.dt;
    // The last step meets the end.
    assert!(dt.max == Some(2e-5) && (dt.min.unwrap() / 1e-5 - 1.0).abs() < 1e-9, "{dt:?}");
    assert!(run.outcome.stderr.contains("attempt 1 of 2: on from step 50"), "{}", run.outcome.stderr);
    let times = run.probes.times();
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "no row is there twice");
}
