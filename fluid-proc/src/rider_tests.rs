//! Where points that ride on solids are, beside places by hand.

use crate::riders::{Riders, Tie};
use halfstep_role::role::Peer;
use halfstep_scene::geometry::{self, Layout};
use halfstep_scene::{self as scene, Scene};
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::state::State;
use std::path::Path;

/// Water with two boxes side by side, 0.1 m x 0.05 m each, and a plate of one layer, 0.1 m x 0.01 m.
fn boxes() -> Scene {
    let solid = |name: &str, block: &str| {
        format!("[[shape]]\nname = \"{name}\"\nphase = \"solid\"\nsolid = \"bodies\"\nbox = {block}\n")
    };
    let text = "resolution = 0.01\nend_time = 1.0\n[effects]\nthin-plate-screen = \"off\"\n[fluid]\n\
                density = 1000.0\n[[solid]]\nname = \"bodies\"\n\
                model = \"rigid\"\ndensity = 500.0\n[[shape]]\nname = \"water\"\nphase = \"fluid\"\n\
                box = { min = [0.0, 0.0], max = [0.5, 0.1] }\n"
        .to_owned()
        + &solid("left", "{ min = [0.1, 0.2], max = [0.2, 0.25] }")
        + &solid("right", "{ min = [0.2, 0.2], max = [0.3, 0.25] }")
        + &solid("plate", "{ min = [0.3, 0.4], max = [0.4, 0.41] }");
    scene::parse(&text, Path::new("boxes.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

/// The records of particles that a map takes from their places in the scene.
fn moved(layout: &Layout<2>, scene: &Scene, to: impl Fn(&str, [f64; 2]) -> [f64; 2]) -> Vec<Peer> {
    let record = |(id, p): (usize, &geometry::SolidPoint<2>)| {
        let [x, y] = to(&scene.shapes[p.body as usize].name, p.position);
        StateRecord { id: id as u32, position: [x, y, 0.0], ..StateRecord::default() }
    };
    vec![Peer { records: layout.solid.iter().enumerate().map(record).collect(), epoch: 0 }]
}

/// Turned about the origin by an angle whose cosine is 0.28 and then moved.
fn turned([x, y]: [f64; 2]) -> [f64; 2] {
    [0.28 * x - 0.96 * y + 3.0, 0.96 * x + 0.28 * y - 2.0]
}

fn close(found: &[[f64; 2]], expected: &[[f64; 2]]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12, "{found:?} {expected:?}");
    }
}

fn shape(scene: &Scene, name: &str) -> usize {
    scene.shapes.iter().position(|s| s.name == name).unwrap()
}

/// On and beside the left box, on its side to the right box, and above and at the end of the plate.
const ON_LEFT: [[f64; 2]; 3] = [[0.15, 0.2], [0.095, 0.255], [0.2, 0.225]];
const ON_PLATE: [[f64; 2]; 2] = [[0.35, 0.42], [0.4, 0.405]];

fn riders(scene: &Scene, layout: &Layout<2>) -> Riders<2> {
    let mut riders = Riders::new();
    assert_eq!(riders.add(scene, layout, shape(scene, "left"), &ON_LEFT), Some(0..3));
    assert_eq!(riders.add(scene, layout, shape(scene, "plate"), &ON_PLATE), Some(3..5));
    assert_eq!(riders.add(scene, layout, shape(scene, "water"), &ON_PLATE), None);
    riders
}

#[test]
fn points_turn_with_their_body_and_with_no_other() {
    let scene = boxes();
    let layout = geometry::layout(&scene);
    let mut riders = riders(&scene, &layout);
    riders.ride(&moved(&layout, &scene, |_, x| x));
    close(&riders.now, &[&ON_LEFT[..], &ON_PLATE[..]].concat());
    // The right box goes away meanwhile.
    let apart = |name: &str, x: [f64; 2]| if name == "right" { [x[0] + 7.0, x[1]] } else { turned(x) };
    riders.ride(&moved(&layout, &scene, apart));
    close(&riders.now, &[ON_LEFT.map(turned).to_vec(), ON_PLATE.map(turned).to_vec()].concat());
}

#[test]
fn points_strain_with_their_solid_and_above_a_layer_keep_their_height() {
    let scene = boxes();
    let layout = geometry::layout(&scene);
    let mut riders = riders(&scene, &layout);
    riders.ride(&moved(&layout, &scene, |_, x| x));
    let strained = |[x, y]: [f64; 2]| [1.2 * x + 0.1 * y, 0.9 * y - 0.3 * x];
    riders.ride(&moved(&layout, &scene, |_, x| strained(x)));
    close(&riders.now[..3], &ON_LEFT.map(strained));
    // The layer's middle line, y = 0.405, goes along (1.2, -0.3); 0.015 m above it is across that.
    let [x, y] = strained([0.35, 0.405]);
    let size = 1.2_f64.hypot(0.3);
    close(&riders.now[3..], &[[x + 0.015 * 0.3 / size, y + 0.015 * 1.2 / size], strained([0.4, 0.405])]);
}

/// The first positions count, not those at which a run goes on.
#[test]
fn a_run_that_goes_on_has_the_same_bits() {
    let scene = boxes();
    let layout = geometry::layout(&scene);
    let mut whole = riders(&scene, &layout);
    whole.ride(&moved(&layout, &scene, |_, x| x));
    let now = moved(&layout, &scene, |_, x| turned(x));
    whole.ride(&now);
    let mut resumed = riders(&scene, &layout);
    resumed.load(&whole.save()).unwrap();
    resumed.restored().unwrap();
    resumed.ride(&now);
    assert_eq!(resumed.now, whole.now);
}

/// A foreign solid chooses its particles: here a spacing of 4/3 and half of one beside those of the scene.
#[test]
fn a_foreign_solid_takes_points_along() {
    let scene = boxes();
    let layout = geometry::layout(&scene);
    let at = |k: usize| [0.1 + (k % 8) as f64 * 0.0133, 0.2 + (k / 8) as f64 * 0.0125];
    let records = |to: &dyn Fn([f64; 2]) -> [f64; 2]| {
        let record = |k: usize| {
            let [x, y] = to(at(k));
            StateRecord { id: k as u32, position: [x, y, 0.0], ..StateRecord::default() }
        };
        vec![Peer { records: (0..40).map(record).collect(), epoch: 0 }]
    };
    let mut riders = riders(&scene, &layout);
    riders.ride(&records(&|x| x));
    riders.ride(&records(&turned));
    close(&riders.now[..2], &[turned(ON_LEFT[0]), turned(ON_LEFT[1])]);
}

/// In space: a block, a layer and a row of particles at (i, j, k), turned about z and x.
#[test]
fn points_ride_in_space() {
    let turned = |[x, y, z]: [f64; 3]| {
        let [x, y] = [0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y];
        [x + 1.0, 0.28 * y - 0.96 * z, 0.96 * y + 0.28 * z - 2.0]
    };
    let at = [1.3, 1.1, 3.0];
    let all = |depth: usize, width: usize| {
        (0..4 * width * depth).map(move |k| [k % 4, k / 4 % width, k / 4 / width].map(|i| i as f64))
    };
    let found = |depth: usize, width: usize| {
        let apart = |x: [f64; 3]| (0..3).map(|d| (x[d] - at[d]).powi(2)).sum::<f64>().sqrt();
        let near: Vec<_> = all(depth, width).enumerate().map(|(k, x)| (k as u32, x, apart(x))).collect();
        let record = |x: [f64; 3]| StateRecord { position: turned(x), ..StateRecord::default() };
        Tie::new(at, &near, 6.0).place(&all(depth, width).map(record).collect::<Vec<_>>())
    };
    let expected = turned(at);
    for depth in [3, 1] {
        let found = found(depth, 4);
        assert!((0..3).all(|d| (found[d] - expected[d]).abs() < 1e-12), "{depth}: {found:?} {expected:?}");
    }
    // A row does not say how it is turned: its middle's way, 1.02 m along the row by symmetry or not.
    let found = found(1, 1);
    let middle: Vec<f64> = (0..3).map(|d| found[d] - at[d]).collect();
    let way = |x: f64| {
        let y = turned([x, 0.0, 0.0]);
        [y[0] - x, y[1], y[2]]
    };
    let (low, high) = (way(0.0), way(3.0));
    assert!(
        (0..3).all(|d| middle[d] >= low[d].min(high[d]) && middle[d] <= low[d].max(high[d])),
        "{middle:?}"
    );
}
