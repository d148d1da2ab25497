//! Dam break on a dry floor (Martin and Moyce 1952, n² = 2): the front of the water against the experiment.

use halfstep_tests::{Curve, scene};

/// The experiment's clock does not begin when the column is released, and a diaphragm had to burst: the computed
/// front is delayed so that it passes the first measured point (Z about 1.2) when the experiment's does. The delay
/// must stay within what it may mean.
const LONGEST_DELAY: f64 = 0.015;
/// Band of inviscid computations about the experiment, which run ahead of it: of the wide column, and of the one half
/// as wide, scaled, where friction holds the last stretch of the run back more. Measured: 8.7 and 13.1 %.
const BANDS: [(&str, f64); 2] = [("martin-moyce-2.25in.csv", 0.09), ("martin-moyce-1.125in.csv", 0.135)];

#[test]
fn the_front_runs_as_measured() {
    let run = scene("dam-break").set("resolution", 0.0028575).run();
    let front = run.curve("front.x");
    for (file, band) in BANDS {
        let experiment = Curve::reference("dam-break", file, "front [m]");
        let passed = front.first_above(experiment.values[0]).expect("the front moves");
        let delay = experiment.times[0] - passed;
        assert!((0.0..LONGEST_DELAY).contains(&delay), "{file}: delay {delay} s");
        let errors: Vec<f64> = experiment
            .times
            .iter()
            .zip(&experiment.values)
            .filter(|(t, _)| *t - delay <= run.report.time)
            .map(|(t, x)| front.at(t - delay) / x - 1.0)
            .collect();
        let percent: Vec<String> = errors.iter().map(|e| format!("{:+.1}", 100.0 * e)).collect();
        println!("{file}: delay {:.1} ms, errors in %: {}", 1e3 * delay, percent.join(" "));
        assert!(errors.len() >= 10 && errors.iter().all(|e| e.abs() < band), "{file}: {errors:?}");
    }
    // The column falls as the front runs.
    assert!(run.curve("level.level").at(0.35) < 0.25 * 0.1143);

    // One phase, one process: nobody else took part.
    let (roles, particles) = (&run.report.roles, &run.report.particles);
    assert!(roles.fluid.is_some() && roles.solid.is_none() && roles.coupler.is_none(), "{roles:?}");
    assert_eq!((run.report.round_trip_us, run.report.sub_steps, particles.solid), (None, None, 0));
    assert_eq!(run.report.audit.action_reaction, None);
    assert!(run.outcome.frames("solid").is_empty() && run.outcome.frames("fluid").len() > 5);
}
