//! Remarks on tanks that stand in each other, and on walls beside tanks and in their floors.

use super::shapes::around_copy;
use super::{meet, overlap};
use halfstep_scene::geometry;
use halfstep_scene::{Block, Geometry, Phase, ProbeKind, Scene, Shape, TankSide};

/// Tanks with their cavities and the boxes around their walls.
struct Tank<'s> {
    shape: &'s Shape,
    cavity: Block,
    open: &'s [TankSide],
    around: Block,
}

fn tanks(scene: &Scene) -> Vec<Tank<'_>> {
    let tanks = scene.shapes.iter().filter_map(|shape| match &shape.geometry {
        Geometry::Tank { cavity, open } => {
            Some(Tank { shape, cavity: *cavity, open, around: geometry::bounding_box(shape, scene) })
        }
        _ => None,
    });
    tanks.collect()
}

/// Whether one box holds another one.
fn holds(outer: &Block, inner: &Block, scene: &Scene) -> bool {
    let slack = 1e-6 * scene.resolution;
    (0..scene.dimension).all(|a| outer.min[a] - slack <= inner.min[a] && inner.max[a] <= outer.max[a] + slack)
}

/// Tanks each of which has walls in the cavity of the other.
pub(super) fn overlapping(scene: &Scene, all: &mut Vec<String>) {
    let tanks = tanks(scene);
    for (k, b) in tanks.iter().enumerate() {
        for a in &tanks[..k] {
            let nested = holds(&a.cavity, &b.around, scene) || holds(&b.cavity, &a.around, scene);
            if !nested && overlap(&a.around, &b.cavity, scene) && overlap(&b.around, &a.cavity, scene) {
                all.push(format!(
                    "`{}` and `{}` overlap: walls of each stand in the other's cavity (`open` at both leaves out a \
                     wall between them; walls are outside of `min` and `max`)",
                    a.shape.name, b.shape.name
                ));
            }
        }
    }
}

/// Copies of a wall, of which some stand in a tank and others beyond its closed sides.
pub(super) fn copies_outside(scene: &Scene, all: &mut Vec<String>) {
    let tanks = tanks(scene);
    for shape in scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall) {
        let Geometry::Moved(moved) = &shape.geometry else { continue };
        let copies: Vec<Block> = moved.copies().map(|copy| around_copy(scene, shape, moved, copy)).collect();
        for tank in &tanks {
            let inside = copies.iter().filter(|copy| meet(copy, &tank.cavity, scene)).count();
            let elsewhere = |copy: &Block| tanks.iter().all(|other| !meet(copy, &other.around, scene));
            let beyond = copies.iter().filter(|copy| is_beyond(scene, tank, copy) && elsewhere(copy)).count();
            if inside > 0 && beyond > 0 {
                all.push(format!(
                    "{beyond} of the {} copies of `{}` stand outside of `{}`, beyond its closed sides, and the others \
                     in it: is `count` or `step` right?",
                    copies.len(),
                    shape.name,
                    tank.shape.name
                ));
            }
        }
    }
}

/// Whether a box lies beyond a side of a tank that is closed.
fn is_beyond(scene: &Scene, tank: &Tank<'_>, block: &Block) -> bool {
    (0..scene.dimension).any(|a| {
        let [low, high] = geometry::sides(a).map(|side| !tank.open.contains(&side));
        low && block.max[a] < tank.around.min[a] || high && block.min[a] > tank.around.max[a]
    })
}

/// Walls that lie in the wall of a tank altogether, and are no other than that.
pub(super) fn hidden(scene: &Scene, all: &mut Vec<String>) {
    let tanks = tanks(scene);
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| shape.phase == Phase::Wall) {
        let block = geometry::bounding_box(shape, scene);
        let is_named = scene.probes.iter().any(|probe| {
            matches!(probe.kind, ProbeKind::Force { shape: Some(k), .. } | ProbeKind::Moment { shape: Some(k), .. }
                | ProbeKind::Pressure { shape: Some(k), .. } if k == index)
        });
        let alike = |tank: &Shape| {
            shape.moves_like(tank) && (shape.contact, shape.free_slip) == (tank.contact, tank.free_slip)
        };
        let within = tanks.iter().find(|tank| {
            tank.shape.name != shape.name
                && holds(&tank.around, &block, scene)
                && !overlap(&tank.cavity, &block, scene)
                && alike(tank.shape)
        });
        if let (Some(tank), false) = (within, is_named) {
            all.push(format!(
                "`{}` lies in the walls of `{}` altogether, which are outside of its `min` and `max`: nothing is \
                 another one for it",
                shape.name, tank.shape.name
            ));
        }
    }
}
