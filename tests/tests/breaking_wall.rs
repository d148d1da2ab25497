//! `scenes/breaking-wall.toml`: water breaks a brittle wall.

use halfstep_output::run_json::RunStatus;
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
    let broken = coarse().until(0.24).run();
    assert_eq!(broken.report.status, Some(RunStatus::Finished));
    assert!(broken.curve("pieces.bodies").peak().1 >= 2.0);
    let threads = coarse().until(0.24).in_process().threads(1).run();
    assert_eq!(broken.state_hash(), threads.state_hash());
    // What nobody gave the wall, over what the water gave it.
    let rest = broken.curve("ledger.integration").peak().1;
    let given = broken.curve("ledger.interface-pressure").peak().1;
    assert!(rest.abs() < 0.01 * given, "{rest} of {given}");
}
