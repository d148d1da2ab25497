//! Where walls have their faces as computed: whole rows from the least corner of a box on.

use super::reached::{Matter, reached};
use super::shapes::length;
use halfstep_scene::geometry::{Layout, cell};
use halfstep_scene::{Geometry, Lattice, Phase, Scene};

/// Distance of a face from where it is asked for that is remarked, in spacings.
const NOTABLE: f64 = 0.1;
/// The sides at the largest coordinate along each axis.
const SIDES: [&str; 3] = ["right side", "top", "front"];

/// A side of a wall, asked and computed, m.
struct Face {
    shape: usize,
    axis: usize,
    asked: f64,
    computed: f64,
}

/// Boxes of walls whose rows end before or beyond a face that the fluid comes to.
pub(super) fn faces<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let dx = scene.resolution;
    let mut off = Vec::new();
    for (shape, of_scene) in scene.shapes.iter().enumerate().filter(|(_, s)| s.phase == Phase::Wall) {
        let Geometry::Box(block) = &of_scene.geometry else { continue };
        for axis in 0..D {
            let rows = ((block.max[axis] - block.min[axis]) / dx).round();
            let face = Face { shape, axis, asked: block.max[axis], computed: block.min[axis] + rows * dx };
            off.extend(((face.computed - face.asked).abs() > NOTABLE * dx).then_some(face));
        }
    }
    if off.is_empty() || layout.fluid.is_empty() || scene.numerics.lattice == Lattice::Nodal {
        return;
    }
    let walls = Matter::of_walls(scene, layout);
    let level = reached(scene, layout, &walls, false);
    for Face { shape, axis, asked, computed } in off {
        let own = layout.wall.iter().filter(|p| p.shape as usize == shape);
        let mut last = own.filter(|p| (p.position[axis] + 0.5 * dx - computed).abs() < 1e-3 * dx);
        let is_wet = last.any(|p| {
            [1.0, 1.5].iter().any(|way| {
                let mut before = p.position;
                before[axis] += way * dx;
                !walls.fill(&before) && level.contains(&cell(&before, dx))
            })
        });
        if is_wet {
            all.push(format!(
                "the {} of `{}` is at {} m in the scene and at {} m as computed, and fluid comes there: a wall has \
                 whole rows from its `min` on (the resolution is {})",
                SIDES[axis],
                scene.shapes[shape].name,
                length(asked),
                length(computed),
                length(dx)
            ));
        }
    }
}
