//! Two solids of different material and model in one scene, however they are run.

use halfstep_tests::{Curve, Finished, RunBuilder, scene};

/// Until the jet has bent the first plate by a few millimetres.
const UNTIL: f64 = 0.2;

fn run(configure: impl FnOnce(RunBuilder) -> RunBuilder) -> Finished {
    configure(scene("two-plates").until(UNTIL)).run()
}

#[test]
fn one_process_two_processes_and_threads_give_the_same_bits() {
    let together = run(|scene| scene);
    let report = &together.report;
    let names: Vec<(&str, &str)> =
        report.participants.iter().map(|p| (p.name.as_str(), p.process.as_str())).collect();
    assert_eq!(names, [("fluid", "fluid"), ("soft", "solid"), ("stiff", "solid")]);
    assert_eq!(report.participants[1].model.as_deref(), Some("total-lagrangian"));
    assert_eq!(report.participants[2].model.as_deref(), Some("hypoelastic"));
    // 24 x 3 particles of 4 mm at 2500 and 1100 kg/m³.
    for (participant, mass) in report.participants[1..].iter().zip([2.88, 1.2672]) {
        assert_eq!(participant.particles, 72);
        assert!((participant.mass / mass - 1.0).abs() < 1e-12, "{participant:?}");
    }
    assert_eq!(report.particles.solid, 144);
    assert!(report.audit.action_reaction.is_some_and(|mismatch| mismatch < 1e-12), "{:?}", report.audit);
    assert!(report.audit.impulse.is_some_and(|mismatch| mismatch < 1e-12), "{:?}", report.audit);
    let tip = together.curve("soft-tip.x");
    assert!(tip.at(UNTIL) > 2e-3, "the jet bends the first plate: {} m", tip.at(UNTIL));
    assert_eq!(together.outcome.frames("soft").len(), together.outcome.frames("stiff").len());

    for (what, other) in [
        ("a process each", run(|scene| scene.set("solid.stiff.process", "own"))),
        ("threads", run(RunBuilder::in_process)),
        ("threads, each its own", run(|scene| scene.set("solid.stiff.process", "own").in_process())),
        ("two threads of the fluid", run(|scene| scene.threads(2))),
    ] {
        assert_eq!(other.state_hash(), together.state_hash(), "{what}");
        assert_eq!(other.probes, together.probes, "{what}");
        assert_eq!(other.report.work, together.report.work, "{what}");
    }
}

/// The second plate stands where no water comes before 0.2 s: the first one must not notice it.
#[test]
fn a_plate_beyond_the_water_changes_nothing() {
    let both = run(|scene| scene);
    let stiffer = run(|scene| scene.set("solid.stiff.youngs_modulus", 24e6));
    let curve = |run: &Finished, name: &str| -> Curve { run.curve(name) };
    assert_eq!(curve(&both, "soft-tip.x").values, curve(&stiffer, "soft-tip.x").values);
    assert!(curve(&both, "stiff-force.x").values.iter().all(|force| *force == 0.0));
    assert!(curve(&both, "soft-force.x").values.iter().any(|force| *force > 1.0));
    // A softer first plate is another run.
    let softer = run(|scene| scene.set("solid.soft.youngs_modulus", 0.5e6));
    assert!(softer.curve("soft-tip.x").at(UNTIL) > both.curve("soft-tip.x").at(UNTIL));
}
