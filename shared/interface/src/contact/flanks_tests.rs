//! Bodies on tips and edges by hand: what a solid without friction does to another has no part along its surface.

use super::tests::{Run, boxed, shape};

/// A block of 0.1 m x 0.05 m on that solid, which stays, after 0.1 s with 1 m/s² along the block's lower side.
fn pulled_along(under: String, stiffness: f64) -> Run {
    let shapes = [boxed("a", [0.0, 0.0], [0.1, 0.05]), under];
    let mut run = Run::of(0.01, shapes, [[0.0; 2]; 2], &format!("stiffness = {stiffness}"));
    run.blocks[1].fixed = true;
    run.gravity = [1.0, -10.0];
    run.until(0.1);
    run
}

fn slides(run: &Run) {
    let velocity = run.blocks[0].velocity;
    let time = run.time();
    println!("{velocity:?} m/s after {time} s, {:?}", run.booked());
    assert!((velocity[0] / time - 1.0).abs() < 1e-9, "{velocity:?} m/s after {time} s");
    // Half its weight or more.
    assert!(run.booked().largest_force > 25.0, "{:?}", run.booked());
}

#[test]
fn a_tip_holds_nothing_sideways() {
    for stiffness in [1e6, 1e7, 1e8] {
        // Between two points of the block, beside one, and on a flank that is nearly upright.
        for tip in [0.0523, 0.0551] {
            let tip = format!("polygon = [[{}, -0.1], [{}, -0.1], [{tip}, 0.0]]", tip - 0.05, tip + 0.02);
            slides(&pulled_along(shape("b", &tip), stiffness));
        }
    }
}

/// A block whose edge is flush with that below it has to leave it: points beside the edge are pushed back until they
/// are as far from it as they are deep. That takes an energy of K w g²/4 for the share w of a point: less with more
/// stiffness. Measured: 0.919 to 0.949, 0.975 to 0.983.
#[test]
fn flush_edges_hold_little_sideways() {
    for (stiffness, least) in [(1e6, 0.91), (1e7, 0.97)] {
        for right in [0.1, 0.0999, 0.1003] {
            let run = pulled_along(boxed("b", [-0.1, -0.05], [right, 0.0]), stiffness);
            let part = run.blocks[0].velocity[0] / run.time();
            println!("K = {stiffness:e}, edge at {right}: {part}");
            assert!((least..1.0 + 1e-6).contains(&part), "K = {stiffness:e}, edge at {right}: {part}");
        }
    }
}

/// Flat on each other both sides' points push, as much as each other: the depth is that of all of the stiffness.
#[test]
fn what_lies_flat_is_pushed_by_both() {
    let mut run = pulled_along(boxed("b", [-0.1, -0.05], [0.3, 0.0]), 1e6);
    run.gravity = [0.0, -10.0];
    run.until(1.5);
    // At rest half of the force acts: of the points of the block, with half a part of its sides beside the corners,
    // and of as many of the slab.
    let sunk = 2.0 * run.blocks[0].mass * 10.0 / (1e6 * 0.5 * (0.105 + 0.1));
    let depth = -run.blocks[0].at[1];
    println!("{depth} m of {sunk} m");
    assert!((depth / sunk - 1.0).abs() < 0.03, "{depth} m of {sunk} m");
}

/// A block whose end goes over a tip: its lower corner and the tip's flank meet, and nothing is pushed by the far end.
#[test]
fn an_end_that_passes_a_tip_is_not_thrown() {
    let tip = shape("b", "polygon = [[0.06, -0.12], [0.18, -0.12], [0.12, 0.0]]");
    for resolution in [0.01, 0.005] {
        let shapes = [boxed("a", [-0.38, 0.0], [0.155, 0.06]), tip.clone()];
        let mut run = Run::of(resolution, shapes, [[-0.5, 0.0], [0.0; 2]], "stiffness = 1e7");
        run.blocks[1].fixed = true;
        run.gravity = [0.0, -10.0];
        run.until(0.12);
        let (velocity, booked) = (run.blocks[0].velocity, run.booked());
        println!("{resolution} m: {velocity:?} m/s, {booked:?}");
        // Below it the flank pushes on the way out, by no more than what the depth at the tip has stored.
        assert!((-0.62..-0.48).contains(&velocity[0]), "{resolution} m: {velocity:?}");
        assert!(booked.largest_penetration < 0.02 && booked.largest_force < 600.0, "{booked:?}");
    }
}

/// A block with its corner down, so deep in a slab and turned by so much: force over stiffness, m².
fn on_its_corner(degrees: f64, depth: f64) -> [f64; 2] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let corner = |x: f64, y: f64| [cosine * x - sine * y, sine * x + cosine * y - depth];
    let square = [corner(0.0, 0.0), corner(0.1, 0.0), corner(0.1, 0.1), corner(0.0, 0.1)];
    let shapes = [shape("a", &format!("polygon = {square:?}")), boxed("b", [-0.2, -0.2], [0.2, 0.0])];
    let mut run = Run::of(0.01, shapes, [[0.0, -1.0], [0.0; 2]], "stiffness = 1e6\nrestitution = 1.0");
    let states = run.blocks.iter().map(|block| block.records.clone()).collect::<Vec<_>>();
    run.contact.evaluate(|solid| states[solid].as_slice(), false, run.dt());
    let mut force = [0.0; 2];
    run.contact.forces(|solid, _, f| {
        (0..2).filter(|_| solid == 0).for_each(|d| force[d] += f[d] / 1e6);
    });
    force
}

/// Where a face of the block stops to be pushed by the slab's points beside its corner, nothing jumps.
#[test]
fn a_block_that_rolls_over_its_corner_is_carried_evenly() {
    for depth in [0.005, 0.01] {
        let forces: Vec<f64> =
            (300..450).map(|tenth| on_its_corner(0.1 * f64::from(tenth), depth)[1]).collect();
        let step = forces.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        let (least, most) = forces.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &f| (a.min(f), b.max(f)));
        println!("{depth} m: {least:e} to {most:e} m², steps of {step:e}");
        assert!(least > 0.0 && step < 0.02 * most, "{depth}: {step:e} of {most:e}");
    }
}

/// How many parts of the first solid's outline begin or end their side at no, one or two convex corners, and how many
/// such corners there are.
fn corners_of(shape: String) -> ([usize; 3], usize) {
    let run = Run::of(0.01, [shape, boxed("b", [1.0, 0.0], [1.1, 0.1])], [[0.0; 2]; 2], "stiffness = 1e6");
    let parts = &run.contact.outlines[0].parts;
    let mut counts = [0; 3];
    parts.iter().for_each(|part| counts[part.corners.iter().flatten().count()] += 1);
    let all: std::collections::BTreeSet<u32> = parts.iter().flat_map(|part| part.corners).flatten().collect();
    (counts, all.len())
}

#[test]
fn sides_know_the_corners_that_stand_out() {
    assert_eq!(corners_of(boxed("a", [0.0, 0.0], [0.1, 0.05])), ([0, 0, 60], 4));
    // Two sides of an L end at its inner corner.
    let inner = "polygon = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.05], [0.05, 0.05], [0.05, 0.1], [0.0, 0.1]]";
    assert_eq!(corners_of(shape("a", inner)), ([0, 20, 60], 5));
    let (disc, corners) = corners_of(shape("a", "disc = { center = [0.0, 0.0], radius = 0.05 }"));
    assert!(disc[0] > 50 && disc[1..] == [0, 0] && corners == 0, "{disc:?}");
    // The corners of a hole are not convex ones of the solid.
    let hole = "polygon = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.2], [0.0, 0.2]]\n\
                holes = [[[0.05, 0.05], [0.15, 0.05], [0.15, 0.15], [0.05, 0.15]]]";
    assert_eq!(corners_of(shape("a", hole)), ([80, 0, 160], 4));
}

/// A square turned by 30 degrees that falls on a slab with restitution 1: what pushes it is springs, whose lengths its
/// corner and the slab's points beside it change.
#[test]
fn a_corner_keeps_the_energy_of_an_elastic_impact() {
    for resolution in [0.01, 0.005] {
        let square =
            "polygon = [[0.0, 0.001], [0.0866025, 0.051], [0.0366025, 0.1376025], [-0.05, 0.0876025]]";
        let shapes = [shape("a", square), boxed("b", [-0.2, -0.1], [0.2, 0.0])];
        let mut run =
            Run::of(resolution, shapes, [[0.0, -1.0], [0.0; 2]], "stiffness = 1e7\nrestitution = 1.0");
        run.blocks[1].fixed = true;
        run.until(0.15);
        let (block, booked) = (&run.blocks[0], run.booked());
        let energy = 0.5 * block.mass * (block.velocity[0].powi(2) + block.velocity[1].powi(2));
        println!("{resolution} m: {:?} m/s, {booked:?}", block.velocity);
        assert!(block.velocity[1] > 0.9 && booked.largest_penetration > 0.5 * resolution, "{booked:?}");
        assert!((energy / (0.5 * block.mass) - 1.0).abs() < 0.01, "{resolution} m: {energy} J/m, {booked:?}");
    }
}
