//! Distances from walls, by hand.

use super::*;
use crate::geometry::Polygon;
use crate::geometry::tests::{scene, shape};
use crate::{Geometry, Phase, Shape, Void};

fn block(min: [f64; 2], max: [f64; 2]) -> Geometry {
    Geometry::Box(Block { min: [min[0], min[1], 0.0], max: [max[0], max[1], 0.0] })
}

fn wall(geometry: Geometry) -> Shape {
    let mut wall = shape(Phase::Wall, geometry);
    wall.contact = true;
    wall
}

/// Distance and normal.
type Found = (f64, [f64; 2]);

/// All that is within 0.1 of a point.
fn around(scene: &Scene, at: [f64; 2]) -> Vec<Found> {
    let mut all = Vec::new();
    for surface in WallSurface::all(scene) {
        for part in 0..surface.parts() {
            let mut edges = Vec::new();
            if surface.near(part, at, [0.1, 0.01], &mut edges) {
                surface.nearest(part, &edges, at, &mut |_, distance, normal| all.push((distance, normal)));
            }
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

#[track_caller]
fn meets(scene: &Scene, at: [f64; 2], right: &[Found]) {
    let found = around(scene, at);
    let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
    let same = |(a, b): (&Found, &Found)| near(a.0, b.0) && near(a.1[0], b.1[0]) && near(a.1[1], b.1[1]);
    assert!(found.len() == right.len() && found.iter().zip(right).all(same), "{found:?} {right:?}");
}

const UP: [f64; 2] = [0.0, 1.0];

#[test]
fn a_corner_of_two_walls_has_two_sides_and_a_seam_none() {
    let floors = [block([0.0, -0.5], [1.0, 0.0]), block([1.0, -0.5], [2.0, 0.0])];
    let step = block([2.0, -0.5], [3.0, 0.4]);
    let scene = scene(floors.into_iter().chain([step]).map(wall).collect());
    meets(&scene, [1.01, 0.03], &[(0.03, UP)]);
    meets(&scene, [0.99, 0.03], &[(0.03, UP)]);
    meets(&scene, [1.97, 0.02], &[(0.02, UP), (0.03, [-1.0, 0.0])]);
    // Past an outer corner, along the line to it; and inside of the wall.
    meets(&scene, [1.97, 0.44], &[(0.05, [-0.6, 0.8])]);
    meets(&scene, [2.5, 0.38], &[(-0.02, UP)]);
    meets(&scene, [2.5, 0.6], &[]);
    // The longest edge, where the one corner's two sides part.
    for x in [1.49, 1.5, 1.51] {
        meets(&scene, [x, -0.55], &[(0.05, [0.0, -1.0])]);
    }
}

/// The sides of a slot are there, and over it nothing.
#[test]
fn voids_open_walls() {
    let mut scene = scene(vec![wall(block([0.0, -0.5], [2.0, 0.0]))]);
    let slot = block([0.8, -0.3], [1.2, 0.0]);
    scene.voids.push(Void { name: "slot".into(), geometry: slot, before: 0 });
    meets(&scene, [1.0, 0.03], &[]);
    meets(&scene, [0.84, -0.1], &[(0.04, [1.0, 0.0])]);
    meets(&scene, [0.84, -0.25], &[(0.04, [1.0, 0.0]), (0.05, UP)]);
    meets(&scene, [0.83, 0.04], &[(0.05, [0.6, 0.8])]);
    // A void after a wall takes nothing of it.
    scene.voids[0].before = 1;
    meets(&scene, [1.0, 0.03], &[(0.03, UP)]);
}

/// What is let into a wall has a socket.
#[test]
fn solids_that_begin_in_a_wall_have_a_socket() {
    let foot = shape(Phase::Solid, block([0.8, -0.3], [1.2, 0.6]));
    let scene = scene(vec![wall(block([0.0, -0.5], [2.0, 0.0])), foot]);
    meets(&scene, [0.86, -0.25], &[(0.05, UP), (0.06, [1.0, 0.0])]);
    meets(&scene, [0.77, 0.04], &[(0.04, UP)]);
}

#[test]
fn tanks_have_an_inside_and_an_outside() {
    let cavity = Block { min: [0.0; 3], max: [2.0, 1.0, 0.0] };
    let open = vec![crate::TankSide::Top];
    let scene = scene(vec![wall(Geometry::Tank { cavity, open })]);
    meets(&scene, [0.04, 0.03], &[(0.03, UP), (0.04, [1.0, 0.0])]);
    meets(&scene, [1.98, 0.5], &[(0.02, [-1.0, 0.0])]);
    meets(&scene, [-0.1, 1.05], &[(0.05, UP)]);
    meets(&scene, [1.0, 0.99], &[]);
}

/// Chords are 1e-4 dx from the circle at most.
#[test]
fn rings_are_round() {
    let ring = Geometry::Ring { center: [1.0, 1.0, 0.0], inner: 0.5, outer: 0.9 };
    let scene = scene(vec![wall(ring)]);
    for k in 0..100 {
        let angle = 0.063 * f64::from(k);
        for (radius, right, way) in
            [(0.45, 0.05, -1.0), (0.95, 0.05, 1.0), (0.52, -0.02, -1.0), (0.86, -0.04, 1.0)]
        {
            let [x, y] = [angle.cos(), angle.sin()];
            let found = around(&scene, [1.0 + radius * x, 1.0 + radius * y]);
            let [(distance, normal)] = found[..] else { panic!("{found:?}") };
            assert!((distance - right).abs() < 1.1e-5, "{radius}: {distance}");
            assert!((normal[0] * x + normal[1] * y - way).abs() < 1e-3, "{normal:?} {x} {y}");
        }
    }
}

/// A slope of a polygon, turned: the foot of a beach is one side with the floor below 15 degrees, two above.
#[test]
fn gentle_corners_part_nothing() {
    for (rise, count) in [(0.2, 1), (0.4, 2)] {
        let outline = vec![[0.0, -0.5], [2.0, -0.5], [2.0, rise], [1.0, 0.0], [0.0, 0.0]];
        let polygon = Geometry::Polygon(Polygon { outline, holes: Vec::new() });
        let scene = scene(vec![wall(polygon)]);
        assert_eq!(around(&scene, [1.0, 0.05]).len(), count, "{rise}");
    }
}

/// In space shapes are taken by themselves.
#[test]
fn in_space_shapes_have_their_own_surfaces() {
    let mut scene = scene(vec![wall(Geometry::Box(Block { min: [0.0; 3], max: [1.0; 3] }))]);
    scene.dimension = 3;
    let [surface] = &WallSurface::all(&scene)[..] else { panic!("one") };
    let at = [0.5, 0.5, 1.05];
    assert!(surface.near(0, at, [0.1, 0.01], &mut Vec::new()));
    let mut all = Vec::new();
    surface.nearest(0, &[], at, &mut |face, distance, normal: [f64; 3]| all.push((face, distance, normal)));
    let [(0, distance, normal)] = all[..] else { panic!("{all:?}") };
    assert!((distance - 0.05).abs() < 1e-12 && normal == [0.0, 0.0, 1.0]);
}

/// A floor of two flush boxes has its own ends as corners and no seam; a step on it the two that stand out.
#[test]
fn corners_of_walls_stand_out() {
    let floors = [block([0.0, -0.5], [1.0, 0.0]), block([1.0, -0.5], [2.0, 0.0])];
    let step = block([1.2, 0.0], [1.3, 0.4]);
    let mut scene = scene(floors.into_iter().chain([step]).map(wall).collect());
    let corners = |scene: &Scene| {
        let all: Vec<_> = wall_corners(scene).iter().map(|corner| (corner.shape, corner.place)).collect();
        all
    };
    let floor = [(0, [0.0, -0.5]), (0, [0.0, 0.0]), (1, [2.0, -0.5]), (1, [2.0, 0.0])];
    let mut right = floor.to_vec();
    right.extend([(2, [1.3, 0.4]), (2, [1.2, 0.4])]);
    assert_eq!(corners(&scene), right);
    // A body that begins in a wall takes nothing of that, and a circle has no corners.
    scene.shapes[2].phase = Phase::Solid;
    assert_eq!(corners(&scene), floor);
    scene.shapes[2].phase = Phase::Wall;
    scene.shapes[2].geometry = Geometry::Disc { center: [1.0, 0.0, 0.0], radius: 0.2 };
    assert_eq!(corners(&scene), floor);
    // Beside a floor that moves otherwise both have the corner.
    scene.shapes[2].geometry = block([2.0, -0.2], [2.2, 0.0]);
    assert!(corners(&scene).iter().all(|(_, place)| *place != [2.0, 0.0]));
    scene.shapes[2].velocity = [1.0, 0.0, 0.0];
    let shared = |scene: &Scene| corners(scene).into_iter().filter(|(_, place)| *place == [2.0, 0.0]).count();
    assert_eq!(shared(&scene), 2);
    scene.shapes[2].velocity = [0.0; 3];
    let end = wall_corners(&scene).into_iter().find(|corner| corner.place == [2.2, 0.0]).expect("a corner");
    assert!((end.normals[0][0] - 1.0).abs() < 1e-12 && (end.normals[1][1] - 1.0).abs() < 1e-12, "{end:?}");
    assert!((end.length - 2.4).abs() < 1e-9, "0.2 m up and 2.2 m along: {end:?}");
    // Moved by itself, the step is another outline with all its corners.
    scene.shapes[2].geometry = block([1.2, 0.0], [1.3, 0.4]);
    scene.shapes[2].velocity = [1.0, 0.0, 0.0];
    assert_eq!(corners(&scene).len(), 8);
}

/// 0.1 + 0.1 + 0.1 is not 0.3: copies that are flush but for that are one wall.
#[test]
fn flush_but_for_rounding_is_flush() {
    let row = crate::geometry::Moved {
        geometry: Box::new(block([0.0, -0.5], [0.1, 0.0])),
        angle: 0.0,
        about: [0.0; 3],
        translate: [0.0; 3],
        count: 8,
        step: [0.1, 0.0, 0.0],
    };
    let scene = scene(vec![wall(Geometry::Moved(row))]);
    assert_eq!(wall_corners(&scene).len(), 4);
    for k in 1..8 {
        meets(&scene, [0.1 * f64::from(k), 0.03], &[(0.03, UP)]);
    }
}
