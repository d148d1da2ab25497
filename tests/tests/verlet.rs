//! Position Verlet: the same bits however a run is run, second order where nothing damps, and the midpoint
//! rule's answers in fewer steps.

use halfstep_tests::{RunBuilder, scene};

fn gate() -> RunBuilder {
    scene("elastic-gate").set("resolution", 0.0025)
}

#[test]
fn the_same_bits_however_it_is_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |until| gate().set("fluid.time_integration", "verlet").until(until);
    let reference = run(0.02).run();
    for (what, other) in [
        ("threads of one process", run(0.02).in_process()),
        ("one process, two threads", run(0.02).in_process().threads(2)),
        ("three threads", run(0.02).threads(3)),
    ] {
        let other = other.run();
        assert_eq!(other.state_hash(), reference.state_hash(), "{what}");
        assert_eq!(other.probes, reference.probes, "{what}");
    }
    // The density is of half a step before the checkpoint, of which it has to know the length.
    let dir = folder.path().join("run");
    run(0.012).set("output.checkpoint_interval", 0.005).out(&dir).run();
    let resumed = scene("elastic-gate").resume(&dir).until(0.02).run();
    assert_eq!(resumed.state_hash(), reference.state_hash(), "resumed");
}

/// Each stage evaluates one equation. Beside a solid that strains the Courant number is the midpoint rule's, unless the
/// scene says another; a step of 0.6 is half as long again.
#[test]
fn the_gates_tip_is_where_the_midpoint_rule_has_it() {
    let run = |rule| gate().set("shape.plate.across", 5).until(0.13).set("fluid.time_integration", rule);
    let [midpoint, own, longer] = [run("midpoint"), run("verlet"), run("verlet").set("numerics.cfl", 0.6)]
        .map(|r| r.in_process().run());
    let curve = midpoint.curve("tip.x");
    let peak = curve.peak().1;
    assert!(peak > 0.03, "it opens");
    for (verlet, fewer) in [(own, 1.0), (longer, 1.5)] {
        let steps = midpoint.report.steps as f64 / verlet.report.steps as f64;
        let other = verlet.curve("tip.x").peak().1;
        println!("peaks {peak:e} and {other:e} m, {steps} times fewer steps");
        assert!((fewer - 0.02..fewer + 0.02).contains(&steps), "{steps} times fewer steps");
        assert!((other / peak - 1.0).abs() < 2e-3, "{other} {peak}");
    }
}

/// Water that damps nothing: of second order. Viscosity and diffusion are evaluated by Euler's rule. Sound that nothing
/// damps is in single differences: the order is that over four halvings of the step.
#[test]
fn it_is_of_second_order_without_damping() {
    let order = |damped: &str| {
        let curves = [8e-4, 4e-4, 5e-5, 2.5e-5].map(|dt| {
            let run = scene("standing-wave").set("resolution", 0.05).set("fluid.time_integration", "verlet");
            let run = run.set("effects.particle-shifting", "off").set("effects.wall-separation", "off");
            let run =
                run.set("effects.artificial-viscosity", damped).set("effects.density-diffusion", damped);
            let run = run.set("effects.viscosity", damped).set("output.probe_interval", 4e-3);
            run.set("time_step", dt).until(0.1).in_process().threads(1).run().curve("middle.x")
        });
        let differences = [curves[0].farthest_from(&curves[1]), curves[2].farthest_from(&curves[3])];
        let order = (differences[0] / differences[1]).log2() / 4.0;
        println!("damping {damped}: {differences:?} m, order {order:.2}");
        order
    };
    let [free, damped] = ["off", "on"].map(order);
    assert!((1.9..2.2).contains(&free), "{free}");
    assert!((0.95..1.35).contains(&damped), "{damped}");
}
