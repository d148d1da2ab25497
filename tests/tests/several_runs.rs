//! Runs do not hear of each other.

use halfstep_tests::process::leftovers;
use halfstep_tests::scene;

#[test]
fn three_runs_at_once_give_what_one_gives_alone() {
    let gate = || scene("elastic-gate").set("resolution", 0.0025).until(0.01);
    let alone = gate().run();
    let together: Vec<_> = (0..3).map(|_| gate().start()).collect();
    for running in together {
        let pid = running.pid();
        let run = running.wait().finished();
        assert_eq!(run.state_hash(), alone.state_hash());
        assert_eq!(run.probes, alone.probes);
        assert_eq!(leftovers(pid), Vec::<String>::new());
    }
}
