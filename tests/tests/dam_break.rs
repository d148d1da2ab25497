//! Dam break on a dry floor (Martin and Moyce 1952, n² = 2): the front of the water against the experiment.

use halfstep_tests::{Curve, scene};

/// The experiment's clock does not begin when the column is released, and a diaphragm had to burst: the computed
/// front is delayed so that it passes the first measured point (Z about 1.2) when the experiment's does. The delay
/// must stay within what it may mean.
const LONGEST_DELAY: f64 = 0.015;
/// Experiments, and for how many of their points the front is held to them, with the band. Inviscid computations run
/// ahead of the experiment. The column that is half as wide, scaled, is held back by friction at its end, which this
/// water does not have.
const EXPERIMENTS: [(&str, usize, f64); 2] =
    [("martin-moyce-2.25in.csv", 10, 0.09), ("martin-moyce-1.125in.csv", 7, 0.07)];
/// How far ahead it is at the last three points of the smaller column; to a hundredth.
const AHEAD: [f64; 3] = [0.091, 0.119, 0.138];

#[test]
fn the_front_runs_as_measured() {
    let run = scene("dam-break").set("resolution", 0.0028575).run();
    let front = run.curve("front.x");
    for (file, held, band) in EXPERIMENTS {
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
        assert_eq!(errors.len(), 10, "{file}");
        assert!(errors[..held].iter().all(|e| e.abs() < band), "{file}: {errors:?}");
        let last = errors[held..].iter().zip(AHEAD);
        assert!(last.clone().all(|(e, ahead)| (e - ahead).abs() < 0.01), "{file}: {errors:?}");
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
