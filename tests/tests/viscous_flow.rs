//! Flow between walls without slip: the lid-driven cavity of Ghia, Ghia and Shin (1982) at Re = 100.

use halfstep_tests::run::scene;

/// Means over the last second of the velocities against the lid's way, down and up, over Ghia's.
fn cavity(dx: f64, set: &[(&str, &str)]) -> [f64; 3] {
    let run = set.iter().fold(scene("lid-driven-cavity").set("resolution", dx), |run, (k, v)| run.set(k, *v));
    let run = run.in_process().run();
    let mean = |probe: &str| run.curve(probe).between(11.0, 12.0).mean();
    let found = [mean("back.x") / -0.2109, mean("down.y") / -0.24533, mean("up.y") / 0.17527];
    println!("{dx} m {set:?}: {found:.3?}, {:.0} s", run.report.wall_seconds);
    found
}

fn within(found: [f64; 3], right: [f64; 3], off: f64) {
    assert!(found.iter().zip(right).all(|(f, r)| (f - r).abs() < off), "{found:?} {right:?}");
}

/// 25 across. Walls that show continuity the reversed velocity, too, take a sixth more.
#[test]
fn a_cavity_has_ghias_velocities() {
    within(cavity(0.04, &[]), [0.931, 0.909, 0.919], 0.015);
    within(cavity(0.04, &[("fluid.time_integration", "midpoint")]), [0.928, 0.916, 0.916], 0.015);
    within(cavity(0.04, &[("smoothing_ratio", "1.5")]), [0.921, 0.908, 0.906], 0.02);
    within(cavity(0.04, &[("effects.no-slip-continuity", "off")]), [0.765, 0.795, 0.787], 0.02);
}

#[test]
#[ignore = "long: make validate"]
fn a_cavity_has_ghias_velocities_finer() {
    within(cavity(0.02, &[]), [0.969, 0.981, 0.977], 0.01);
    within(cavity(0.01, &[]), [0.984, 1.008, 0.991], 0.01);
}
