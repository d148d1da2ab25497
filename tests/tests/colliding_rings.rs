//! Colliding rubber rings (Gray, Monaghan and Swift 2001): with artificial stress they bounce and stay whole, without
//! they crack where they are stretched, and the energy goes into the pieces.

use halfstep_tests::{Finished, cluster, scene};
use halfstep_wire::frame::SOLID;
use std::ops::RangeInclusive;

struct End {
    /// Pieces in the last frame, largest first, for neighbours at most 1.5 and 2 spacings apart.
    pieces: [Vec<usize>; 2],
    /// Kinetic energy after the rebound (mean over the last third) over that at the start.
    energy: f64,
}

fn end(what: &str, resolution: f64, run: &Finished) -> End {
    let frame = run.outcome.frames("solid").pop().expect("a last frame");
    let solid = (0..frame.len()).filter(|&k| frame.phase[k] == SOLID);
    let points: Vec<[f64; 2]> =
        solid.map(|k| [f64::from(frame.points[k][0]), f64::from(frame.points[k][1])]).collect();
    assert_eq!(points.len() as u64, run.report.particles.solid);
    let pieces = [1.5, 2.0].map(|reach| cluster::sizes(&points, reach * resolution));
    let energy = run.curve("rings.energy");
    let after = energy.between(run.report.time * 2.0 / 3.0, run.report.time).mean();
    let energy = after / energy.values[0];
    let largest = pieces.each_ref().map(|p| &p[..p.len().min(6)]);
    println!(
        "{what}: {} and {} pieces (1.5 and 2 dx), largest {largest:?}; kinetic energy after the rebound {:.0} %; drift of \
         momentum {:.1e}; {:.0} s",
        pieces[0].len(),
        pieces[1].len(),
        100.0 * energy,
        run.report.audit.momentum_drift.unwrap_or(f64::NAN),
        run.report.wall_seconds
    );
    assert!(run.report.audit.momentum_drift.unwrap() <= 1e-12);
    End { pieces, energy }
}

/// `back`: kinetic energy after the rebound over that before; the rest is in the rings' oscillation, or dissipated.
/// Which part of it the oscillation has then differs by spacing and kernel.
fn bounce_or_crack(resolution: f64, back: RangeInclusive<f64>) {
    let rings = || scene("colliding-rings").set("resolution", resolution);
    let run = rings().run();
    let whole = end(&format!("with artificial stress, {resolution} m"), resolution, &run);
    let half = run.report.particles.solid as usize / 2;
    // Each ring is one piece and on its own side again.
    assert_eq!(whole.pieces, [vec![half, half], vec![half, half]]);
    assert!(back.contains(&whole.energy), "{}", whole.energy);
    assert!(run.curve("left-end.x").at(run.report.time) < 0.0, "the left ring is on its way back");
    let [left, right] = ["left-end.x", "right-end.x"].map(|name| run.curve(name).at(run.report.time));
    assert!((left + right).abs() < 1e-4 * left.abs(), "mirror images: {left} {right}");

    let run = rings().set("solid.artificial_stress.strength", 0).run();
    let cracked = end(&format!("without, {resolution} m"), resolution, &run);
    assert!(cracked.pieces[0].len() > 2);
    assert!(cracked.energy < 0.2);
}

#[test]
fn total_lagrangian_rings_bounce() {
    let run = scene("colliding-rings").set("resolution", 0.002).set("solid.model", "total-lagrangian").run();
    let whole = end("total-Lagrangian, 0.002 m", 0.002, &run);
    let half = run.report.particles.solid as usize / 2;
    assert_eq!(whole.pieces[0], vec![half, half]);
    assert!(whole.energy > 0.5);
    let [left, right] = ["left-end.x", "right-end.x"].map(|name| run.curve(name).at(run.report.time));
    assert!(left < 0.0 && (left + right).abs() < 1e-4 * left.abs(), "mirror images: {left} {right}");
}

#[test]
fn rings_of_5_particles_across() {
    bounce_or_crack(0.002, 0.6..=0.64);
}

#[test]
#[ignore = "half a minute: the published resolution"]
fn rings_of_10_particles_across() {
    bounce_or_crack(0.001, 0.46..=0.51);
}
