//! Cracks that run through solids alone: `scenes/crack-branching.toml`, `scenes/kalthoff-winkler.toml`.

use halfstep_output::Frame;
use halfstep_tests::run::{repository, scene_at};
use halfstep_tests::{RunBuilder, scene};

/// Damage from which on a particle is part of a crack.
const CRACKED: f64 = 0.95;

/// Instants, s, and where particles were at the start that are part of a crack then, m.
fn cracks(run: RunBuilder) -> Vec<(f64, Vec<[f64; 2]>)> {
    let frames = run.run().outcome.frames("solid");
    let mut start = vec![[0.0; 2]; frames[0].len()];
    for (id, point) in frames[0].id.iter().zip(&frames[0].points) {
        start[*id as usize] = [f64::from(point[0]), f64::from(point[1])];
    }
    let cracked = |frame: &Frame| {
        let all = frame.id.iter().zip(&frame.damage).filter(|(_, damage)| f64::from(**damage) > CRACKED);
        (frame.time, all.map(|(id, _)| start[*id as usize]).collect())
    };
    frames.iter().map(cracked).collect()
}

/// Rayleigh's speed of the glass, m/s: 0.91 of that of shear waves.
const RAYLEIGH: f64 = 2125.0;

#[test]
#[ignore = "a minute"]
fn a_crack_in_glass_branches_and_stays_slower_than_rayleigh_waves() {
    let all = cracks(scene("crack-branching"));
    let tip = |points: &[[f64; 2]]| points.iter().map(|x| x[0]).fold(f64::NAN, f64::max);
    let runs: Vec<(f64, f64)> = all
        .iter()
        .filter(|(_, points)| !points.is_empty())
        .map(|(time, points)| (*time, tip(points)))
        .collect();
    assert!((6e-6..13e-6).contains(&runs[0].0), "it starts at {} s", runs[0].0);
    for (time, x) in &runs {
        if let Some((later, there)) = runs.iter().find(|(later, _)| *later > time + 9.5e-6) {
            let speed = (there - x) / (later - time);
            assert!(speed < 0.6 * RAYLEIGH, "{speed} m/s from {time} s on");
        }
    }
    // Two tips, and nothing between them.
    let branched = all.iter().find(|(_, points)| {
        let front: Vec<f64> =
            points.iter().filter(|x| x[0] > tip(points) - 2e-3).map(|x| x[1] - 0.02).collect();
        let reaches = |sign: f64| front.iter().any(|y| sign * y > 1.4e-3);
        reaches(1.0) && reaches(-1.0) && front.iter().all(|y| y.abs() > 6e-4)
    });
    let (time, points) = branched.expect("two branches");
    println!("starts at {} s, branches at {time} s, {} m", runs[0].0, tip(points));
    assert!((28e-6..50e-6).contains(time), "{time}");
    assert!((0.06..0.085).contains(&tip(points)), "{}", tip(points));
}

/// Angles of the line from each notch's tip to that of its crack, degrees, when the cracks are about 50 mm long.
fn kalthoff_winkler(run: RunBuilder) -> [f64; 2] {
    let all = cracks(run.until(50e-6));
    let (_, points) = all.last().expect("frames");
    [1.0, -1.0].map(|side| {
        let from = points.iter().map(|x| [x[0] - 0.05, side * x[1] - 0.025]).filter(|x| x[1] > 1e-3);
        let tip = from.max_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1]))).expect("a crack");
        assert!((0.04..0.07).contains(&tip[0].hypot(tip[1])), "{tip:?}");
        tip[1].atan2(tip[0]).to_degrees()
    })
}

/// The experiment has about 70 degrees. Cracks prefer rows and diagonals of the lattice: at 0 degrees they miss it.
#[test]
#[ignore = "a minute"]
fn cracks_run_away_from_sheared_notches() {
    let [upper, lower] = kalthoff_winkler(scene("kalthoff-winkler"));
    println!("lattice at 0 degrees: {upper} and {lower} degrees");
    assert!((upper - lower).abs() < 1.0 && (45.0..75.0).contains(&upper), "{upper} {lower}");
    let turned = kalthoff_winkler(scene_at(&repository().join("validation/kalthoff-winkler/turned.toml")));
    println!("lattice at 30 degrees: {turned:?} degrees");
    let mean = 0.5 * (turned[0] + turned[1]);
    assert!((60.0..75.0).contains(&mean), "{turned:?}");
}
