//! The same scene gives the same bits: as processes, as threads of one process, and with any number of threads.

use halfstep_tests::{RunBuilder, scene};

fn gate(treatment: &str, model: &str) -> RunBuilder {
    scene("elastic-gate")
        .set("resolution", 0.0025)
        .set("interface.treatment", treatment)
        .set("solid.model", model)
}

fn same_bits(until: f64, treatment: &str, model: &str) {
    let run = || gate(treatment, model).until(until);
    let reference = run().run();
    let (hash, tip) = (reference.state_hash(), reference.curve("tip.x"));
    assert!(tip.at(until) > 1e-4, "something has moved");
    // Work is counted, not timed.
    let work = reference.report.work.pair_evaluations;
    assert!([work.fluid, work.solid, work.coupler].iter().all(|n| n.is_some_and(|n| n > 0)), "{work:?}");
    for (what, other) in [
        ("threads of one process", run().in_process()),
        ("one process, two threads", run().in_process().threads(2)),
        ("two threads", run().threads(2)),
        ("three threads", run().threads(3)),
    ] {
        let other = other.run();
        assert_eq!(other.state_hash(), hash, "{treatment}: {what}");
        assert_eq!(other.report.steps, reference.report.steps);
        assert_eq!(other.report.work, reference.report.work, "{treatment}: {what}");
        // Not only the end: every row in between.
        assert_eq!(other.probes, reference.probes, "{treatment}: {what}");
    }
    // The hash tells states apart.
    let other = gate(treatment, model).until(until).set("fluid.density", 1000.0 * (1.0 + 1e-12)).run();
    assert_ne!(other.state_hash().0, hash.0);
}

#[test]
fn moving_wall() {
    same_bits(0.05, "moving-wall", "total-lagrangian");
}

#[test]
fn moving_wall_with_the_hypoelastic_solid() {
    same_bits(0.02, "moving-wall", "hypoelastic");
}

#[test]
fn phase_blind() {
    same_bits(0.01, "phase-blind", "hypoelastic");
}
