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
    // Two and a half steps of contact or more.
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

#[test]
fn flush_edges_hold_nothing_sideways() {
    for stiffness in [1e6, 1e7] {
        for right in [0.1, 0.0999, 0.1003] {
            slides(&pulled_along(boxed("b", [-0.1, -0.05], [right, 0.0]), stiffness));
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
