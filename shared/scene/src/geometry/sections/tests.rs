use super::*;
use crate::geometry::Polygon;
use crate::geometry::tests::{a_box, block, scene, shape};
use crate::{Shape, Void};
use approx::assert_relative_eq;

/// A base of 1 m x 0.3 m with a parapet 1 m high and so thick, m: at a spacing of 0.1 m.
fn parapet(thick: f64) -> Geometry {
    let corners = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.3], [thick, 0.3], [thick, 1.3], [0.0, 1.3]];
    Geometry::Polygon(Polygon::new(corners, Vec::new()).expect("a polygon"))
}

/// All parts of a solid of at least three lines that are thinner than 0.9 m, as thickness asked and computed.
fn arms(shape: Shape, voids: Vec<Void>) -> Vec<[f64; 2]> {
    let all = sections(&Scene { voids, ..scene(vec![shape]) }, 0);
    let arms = all.iter().flatten().filter(|part| part.lines >= 3 && part.asked < 0.9);
    arms.map(|part| [part.asked, part.computed]).collect()
}

fn void(geometry: Geometry) -> Vec<Void> {
    vec![Void { name: "hole".into(), geometry, before: 0 }]
}

#[test]
fn a_thin_part_of_a_polygon_has_whole_rows() {
    let found = arms(shape(Phase::Solid, parapet(0.224)), Vec::new());
    // The base is 0.3 m high with three rows; the parapet's rows are 0.05 and 0.15 m from its left side.
    assert!(found.iter().any(|[a, c]| (a - 0.224).abs() < 1e-9 && (c - 0.2).abs() < 1e-9), "{found:?}");
    assert!(found.iter().any(|[a, c]| (a - 0.3).abs() < 1e-9 && (c - 0.3).abs() < 1e-9), "{found:?}");
}

#[test]
fn turned_and_repeated_shapes_have_the_parts_of_their_own() {
    let moved = Moved {
        geometry: Box::new(parapet(0.224)),
        angle: 30.0,
        about: [0.3, 0.1, 0.0],
        translate: [1.0, -2.0, 0.0],
        count: 2,
        step: [4.0, 0.0, 0.0],
    };
    let found = arms(shape(Phase::Solid, Geometry::Moved(moved)), Vec::new());
    let thin = found.iter().filter(|[a, c]| (a - 0.224).abs() < 1e-9 && (c - 0.2).abs() < 1e-9);
    assert_eq!(thin.count(), 2, "{found:?}");
}

#[test]
fn a_polygons_void_leaves_an_arm() {
    let corners = vec![[0.334, 0.4], [1.2, 0.4], [1.2, 1.2], [0.334, 1.2]];
    let hole = Geometry::Polygon(Polygon::new(corners, Vec::new()).expect("a polygon"));
    let found = arms(a_box(Phase::Solid, [0.0, 0.0], [1.0, 1.0]), void(hole));
    assert!(found.iter().any(|[a, c]| (a - 0.334).abs() < 1e-9 && (c - 0.3).abs() < 1e-9), "{found:?}");
    assert!(found.iter().any(|[a, c]| (a - 0.4).abs() < 1e-9 && (c - 0.4).abs() < 1e-9), "{found:?}");
}

#[test]
fn a_hull_has_the_area_of_its_plates() {
    let hole = void(Geometry::Box(block([0.104, 0.104], [0.896, 0.396])));
    let hull = a_box(Phase::Solid, [0.0, 0.0], [1.0, 0.5]);
    let scene_of = |voids: Vec<Void>| Scene { voids, ..scene(vec![hull.clone()]) };
    let [asked, computed] = left_by_voids(&scene_of(hole), 0).expect("a void in it");
    assert_relative_eq!(asked, 0.5 - 0.792 * 0.292, max_relative = 1e-12);
    assert_relative_eq!(computed, 0.26, max_relative = 1e-12);
    let round = void(Geometry::Disc { center: [0.5, 0.25, 0.0], radius: 0.2 });
    let [asked, _] = left_by_voids(&scene_of(round), 0).expect("a void in it");
    assert_relative_eq!(asked, 0.5 - std::f64::consts::PI * 0.04, max_relative = 0.002);
    assert_eq!(left_by_voids(&scene_of(void(Geometry::Box(block([2.0, 0.0], [3.0, 1.0])))), 0), None);
}
