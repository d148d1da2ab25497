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

/// Of the points of a crack those on one section that reach over 2.8 mm and leave a gap of 1.4 mm: the section, m. A
/// particle that came off between two arms does not make them one.
fn parted(points: &[[f64; 2]]) -> Option<f64> {
    let sections = (100..200).map(|k| f64::from(k) * 0.5e-3);
    sections.into_iter().find(|x| {
        let mut ys: Vec<f64> = points.iter().filter(|p| (p[0] - x).abs() < 0.5e-3).map(|p| p[1]).collect();
        ys.sort_by(f64::total_cmp);
        let reach = ys.last().zip(ys.first()).map_or(0.0, |(high, low)| high - low);
        reach > 2.8e-3 && ys.windows(2).any(|pair| pair[1] - pair[0] > 1.4e-3)
    })
}

/// Measured for seeds 1 to 4: 33 to 47 us, 69 to 82 mm, up to 0.63 of Rayleigh's speed.
#[test]
#[ignore = "a minute"]
fn a_crack_in_glass_branches_in_every_arrangement() {
    for seed in 1..=4 {
        let all = cracks(scene("crack-branching").set("solid.arrangement_seed", seed));
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
                assert!(speed < 0.65 * RAYLEIGH, "{seed}: {speed} m/s from {time} s on");
            }
        }
        let branched = all.iter().find_map(|(time, points)| Some((*time, parted(points)?, tip(points))));
        let (time, at, tip) = branched.expect("two branches");
        println!("seed {seed}: starts at {} s, branches at {time} s, {at} m, tip {tip} m", runs[0].0);
        assert!((30e-6..50e-6).contains(&time), "{seed}: {time}");
        assert!((0.066..0.084).contains(&at), "{seed}: {at}");
    }
}

/// Angles of the line from each notch's tip to that of its crack, degrees, when the cracks are about 55 mm long.
fn kalthoff_winkler(run: RunBuilder) -> [f64; 2] {
    let all = cracks(run.until(54e-6));
    let (_, points) = all.last().expect("frames");
    [1.0, -1.0].map(|side| {
        let from = points.iter().map(|x| [x[0] - 0.05, side * x[1] - 0.025]).filter(|x| x[1] > 1e-3);
        let tip = from.max_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1]))).expect("a crack");
        assert!((0.04..0.07).contains(&tip[0].hypot(tip[1])), "{tip:?}");
        tip[1].atan2(tip[0]).to_degrees()
    })
}

/// The experiment has about 70 degrees. Measured at 54 us: 62 degrees in the mean of four arrangements, 60 to 68.
#[test]
#[ignore = "a minute"]
fn cracks_run_away_from_sheared_notches() {
    let mut all = Vec::new();
    for seed in 1..=4 {
        let angles = kalthoff_winkler(scene("kalthoff-winkler").set("solid.arrangement_seed", seed));
        println!("seed {seed}: {angles:?} degrees");
        all.extend(angles);
    }
    assert!(all.iter().all(|angle| (57.0..70.0).contains(angle)), "{all:?}");
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    assert!((60.5..64.5).contains(&mean), "{mean}");
}

/// On a lattice they take its rows and diagonals.
#[test]
#[ignore = "a minute"]
fn cracks_on_a_lattice_follow_it() {
    let straight = scene("kalthoff-winkler").set("solid.arrangement", "lattice");
    let [upper, lower] = kalthoff_winkler(straight);
    println!("lattice at 0 degrees: {upper} and {lower} degrees");
    assert!((upper - lower).abs() < 1.0 && (47.0..55.0).contains(&upper), "{upper} {lower}");
    let turned = kalthoff_winkler(scene_at(&repository().join("validation/kalthoff-winkler/turned.toml")));
    println!("lattice at 30 degrees: {turned:?} degrees");
    let mean = 0.5 * (turned[0] + turned[1]);
    assert!((60.0..75.0).contains(&mean), "{turned:?}");
}
