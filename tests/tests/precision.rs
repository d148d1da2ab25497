//! Pairs in single precision: the same bits however a run is run, and answers that nobody can tell from those of pairs
//! in double precision.

use halfstep_tests::{RunBuilder, scene};

/// A scene as it is, and with pairs in single precision.
fn both(run: impl Fn() -> RunBuilder) -> [RunBuilder; 2] {
    ["double", "mixed"].map(|precision| run().set("numerics.precision", precision))
}

fn gate() -> RunBuilder {
    scene("elastic-gate").set("resolution", 0.0025)
}

#[test]
fn mixed_precision_has_the_same_bits_however_it_is_run() {
    let run = || gate().set("numerics.precision", "mixed").until(0.02);
    let reference = run().run();
    for (what, other) in [
        ("threads of one process", run().in_process()),
        ("one process, two threads", run().in_process().threads(2)),
        ("three threads", run().threads(3)),
    ] {
        let other = other.run();
        assert_eq!(other.state_hash(), reference.state_hash(), "{what}");
        assert_eq!(other.probes, reference.probes, "{what}");
    }
    assert_ne!(gate().until(0.02).run().state_hash(), reference.state_hash(), "it is computed otherwise");
}

/// The gate's tip on its way out and at its peak: to a tenth of what nobody would see in the picture, 0.1 mm.
#[test]
fn the_gates_tip_is_where_double_precision_has_it() {
    let [double, mixed] = both(|| gate().set("shape.plate.across", 5).until(0.13)).map(|run| {
        let run = run.in_process().run();
        run.curve("tip.x")
    });
    let apart = double.farthest_from(&mixed);
    println!("tips {apart:e} m apart, peak {:e} m", double.peak().1);
    assert!(double.peak().1 > 0.03, "it opens");
    assert!(apart > 0.0 && apart < 1e-5, "{apart:e} m");
}

/// Water that should not move is no noisier: energy of its motion over that of its depth.
#[test]
fn a_tank_is_as_still_as_in_double_precision() {
    let [double, mixed] = both(|| scene("hydrostatic-tank").set("resolution", 0.02).until(2.0)).map(|run| {
        let run = run.in_process().run();
        run.curve("water.energy").between(1.0, 2.0).mean()
    });
    println!("kinetic energy {double:e} and {mixed:e} J");
    assert!((mixed / double - 1.0).abs() < 1e-3, "{double:e} {mixed:e}");
}

/// The swing of water in a wave as low as the scenes have any.
#[test]
fn a_standing_wave_is_that_of_double_precision() {
    let [double, mixed] = both(|| scene("standing-wave").set("resolution", 0.05).until(3.0)).map(|run| {
        let run = run.in_process().run();
        run.curve("middle.x")
    });
    let apart = double.farthest_from(&mixed);
    let swing = double.peak().1 - double.mean();
    println!("centres {apart:e} m apart, swing {swing:e} m");
    assert!(swing > 1e-3 && apart < 1e-3 * swing, "{apart:e} of {swing:e} m");
}

/// At 1e7 m the kernel's slopes are too small: a tank diverged after 71 steps.
#[test]
fn particles_out_of_the_range_of_single_precision_are_refused() {
    for (resolution, side) in [(5e-7, 1e-5), (1e7, 2e8)] {
        let outcome = scene("hydrostatic-tank")
            .set("numerics.precision", "mixed")
            .set("resolution", resolution)
            .set("shape.water.box", format!("{{ min = [0.0, 0.0], max = [{side:e}, {side:e}] }}"))
            .outcome();
        assert_eq!(outcome.code(), Some(1));
        assert!(outcome.stderr.contains("numerics.precision"), "{}", outcome.stderr);
        let said = "the kernel's slopes leave the range of single precision";
        assert!(outcome.stderr.contains(said), "{}", outcome.stderr);
    }
}
