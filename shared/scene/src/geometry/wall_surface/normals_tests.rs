//! What wall particles stand for where walls meet, and where edges are.

use crate::geometry::layout;
use crate::geometry::tests::{a_box, block, scene, shape, tank, wall_at};
use crate::{Geometry, Phase, TankSide};

#[test]
fn where_walls_meet_they_have_one_surface() {
    // A block on a tank's floor, and a step against its right wall.
    let l = layout::<2>(&scene(vec![
        tank(&[TankSide::Top]),
        a_box(Phase::Wall, [0.3, 0.0], [0.6, 0.3]),
        a_box(Phase::Wall, [0.8, 0.0], [1.0, 0.2]),
    ]));
    let normal = |x, y| wall_at(&l, x, y).map(|p| (p.normal, p.corner));
    let half = 1.0 / 2.0_f64.sqrt();
    let [up, left, right] = [[0.0, 1.0], [-1.0, 0.0], [1.0, 0.0]].map(|normal| Some((normal, false)));
    // The block's foot is none of its faces: its lowest row stands for its sides.
    assert_eq!([normal(0.35, 0.05), normal(0.55, 0.05)], [left, right]);
    // The floor: free, and in and behind the corners with the block's sides.
    assert_eq!([normal(0.25, -0.05), normal(0.65, -0.05)], [up, up]);
    assert_eq!(normal(0.35, -0.05), Some(([-half, half], true)));
    assert_eq!(normal(0.55, -0.15), Some(([half, half], true)));
    // The step goes on as the wall, and ends in a corner that is as free as the block's.
    assert_eq!([normal(0.95, 0.15), normal(0.85, 0.05), normal(1.05, 0.25)], [up, left, left]);
    assert_eq!(normal(1.05, 0.15), Some(([-half, half], true)));
    assert_eq!(normal(0.85, 0.15), Some(([-half, half], false)));
    // Two flush boxes are one floor.
    let boxes = [[0.0, 0.5], [0.5, 1.0]].map(|[from, to]| a_box(Phase::Wall, [from, -0.4], [to, 0.0]));
    let l = layout::<2>(&scene(boxes.to_vec()));
    let normal = |x, y| wall_at(&l, x, y).map(|p| (p.normal, p.corner));
    assert_eq!([normal(0.45, -0.05), normal(0.55, -0.15), normal(0.25, -0.05)], [up, up, up]);
}

#[test]
fn faces_of_tanks_are_seen_from_the_next_tank_and_over_the_rim() {
    let half = 1.0 / 2.0_f64.sqrt();
    let [up, left, right] = [[0.0, 1.0], [-1.0, 0.0], [1.0, 0.0]].map(|normal| Some((normal, false)));
    // Two tanks share a wall of three layers.
    let next = shape(
        Phase::Wall,
        Geometry::Tank { cavity: block([1.3, 0.0], [2.0, 0.5]), open: vec![TankSide::Top] },
    );
    let l = layout::<2>(&scene(vec![tank(&[TankSide::Top]), next]));
    let normal = |x, y| wall_at(&l, x, y).map(|p| (p.normal, p.corner));
    assert_eq!([normal(1.05, 0.25), normal(1.25, 0.25)], [left, right]);
    // Outer faces are none: the tank's floor, deep and away from its corner.
    assert_eq!(normal(0.85, -0.25), up);
    // A step as high as an open tank goes on as the rim.
    let l = layout::<2>(&scene(vec![tank(&[TankSide::Top]), a_box(Phase::Wall, [0.7, 0.0], [1.0, 0.5])]));
    let normal = |x, y| wall_at(&l, x, y).map(|p| (p.normal, p.corner));
    assert_eq!([normal(0.95, 0.45), normal(1.05, 0.45), normal(0.75, 0.25)], [up, up, left]);
    assert_eq!(normal(0.75, 0.45), Some(([-half, half], false)));
    // An open side that a wall closes.
    let open = tank(&[TankSide::Right, TankSide::Top]);
    let l = layout::<2>(&scene(vec![open, a_box(Phase::Wall, [1.0, -0.3], [1.3, 0.5])]));
    let normal = |x, y| wall_at(&l, x, y).map(|p| (p.normal, p.corner));
    assert_eq!(normal(1.05, 0.15), left);
    assert_eq!(normal(1.05, -0.05), Some(([-half, half], true)));
}

#[test]
fn edges_are_found_where_water_flows_round_them() {
    // 2 h = 2.66 dx, in whole spacings 3.
    let l = layout::<2>(&scene(vec![tank(&[TankSide::Top]), a_box(Phase::Wall, [0.3, 0.0], [0.9, 0.4])]));
    let at_edge = |x, y| wall_at(&l, x, y).expect("a wall particle").at_edge;
    assert!(at_edge(0.35, 0.35) && at_edge(0.35, 0.15) && at_edge(0.55, 0.35) && at_edge(0.85, 0.25));
    // Beyond, at the corners with the floor, in the tank's own, and on the block's diagonals.
    assert!(!at_edge(0.35, 0.05) && !at_edge(0.35, -0.05) && !at_edge(-0.05, -0.05) && !at_edge(0.55, 0.05));
    assert!(layout::<2>(&scene(vec![tank(&[])])).wall.iter().all(|p| !p.at_edge));
}

#[test]
fn a_sill_is_as_good_from_either_side() {
    for rows in [0.1, 0.3] {
        let sill = a_box(Phase::Wall, [0.5 - 0.5 * rows, 0.0], [0.5 + 0.5 * rows, 0.3]);
        let mut s = scene(vec![tank(&[TankSide::Top]), sill.clone()]);
        let on_floor = layout::<2>(&s);
        s.shapes.remove(0);
        for l in [on_floor, layout::<2>(&s)] {
            let top = wall_at(&l, 0.5, 0.25).expect("the top row's middle");
            assert!((top.normal[0], top.normal[1]) == (0.0, 1.0) && !top.corner, "{rows}: {top:?}");
        }
    }
}

#[test]
fn walls_that_slip_otherwise_have_their_own_surfaces() {
    let mut belt = a_box(Phase::Wall, [0.3, 0.0], [0.6, 0.1]);
    (belt.velocity, belt.free_slip) = ([1.0, 0.0, 0.0], false);
    let l = layout::<2>(&scene(vec![tank(&[TankSide::Top]), belt]));
    assert!(
        wall_at(&l, 0.45, -0.05).is_some_and(|p| p.normal == [0.0, 1.0] && (p.depth - 0.05).abs() < 1e-12)
    );
}
