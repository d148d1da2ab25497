//! Boxes around shapes, and the one that fluid must stay in.

use super::outline;
use super::points::{self, Spacing};
use crate::{Block, Geometry, Motion, Phase, Scene, Shape};

/// The box that fluid particles must stay in: [`crate::Numerics::domain`], or the box of all shapes, where they are
/// and where they move to, widened by its own size on every side.
pub fn domain(scene: &Scene) -> Block {
    if let Some(block) = scene.numerics.domain {
        return block;
    }
    let mut block = Block { min: [0.0; 3], max: [0.0; 3] };
    let mut all = block;
    for axis in 0..scene.dimension {
        let bounds = scene.shapes.iter().map(|s| bounding_box(s, scene));
        (all.min[axis], all.max[axis]) = bounds.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), b| {
            (low.min(b.min[axis]), high.max(b.max[axis]))
        });
    }
    for axis in 0..scene.dimension {
        let (low, high) = (all.min[axis], all.max[axis]);
        let swept = |m: &Motion| m.swept(&all, scene.end_time);
        let swept = scene.shapes.iter().filter_map(|s| s.motion.as_ref().map(swept));
        let (low, high) =
            swept.fold((low, high), |(l, h), swept| (l.min(swept.min[axis]), h.max(swept.max[axis])));
        (block.min[axis], block.max[axis]) = (low - (high - low), high + (high - low));
    }
    block
}

/// The box around boxes; `None` around none.
pub fn around(boxes: impl IntoIterator<Item = Block>) -> Option<Block> {
    boxes.into_iter().reduce(|a, b| Block {
        min: std::array::from_fn(|axis| a.min[axis].min(b.min[axis])),
        max: std::array::from_fn(|axis| a.max[axis].max(b.max[axis])),
    })
}

/// The boxes around the shapes of fluid.
pub fn fluid_boxes(scene: &Scene) -> Vec<Block> {
    let fluid = scene.shapes.iter().filter(|shape| shape.phase == Phase::Fluid);
    fluid.map(|shape| bounding_box(shape, scene)).collect()
}

/// The box around a shape; a tank's with its walls.
pub fn bounding_box(shape: &Shape, scene: &Scene) -> Block {
    let round = |center: [f64; 3], radius: f64| Block {
        min: std::array::from_fn(|a| if a < scene.dimension { center[a] - radius } else { 0.0 }),
        max: std::array::from_fn(|a| if a < scene.dimension { center[a] + radius } else { 0.0 }),
    };
    match &shape.geometry {
        Geometry::Box(block) => *block,
        Geometry::Disc { center, radius } => round(*center, *radius),
        Geometry::Ring { center, outer, .. } => round(*center, *outer),
        Geometry::Tank { cavity, open } => {
            let thickness = Spacing::of(scene, shape).layers() as f64 * scene.resolution;
            let mut block = *cavity;
            for axis in 0..scene.dimension {
                let [low, high] = points::sides(axis);
                block.min[axis] -= if open.contains(&low) { 0.0 } else { thickness };
                block.max[axis] += if open.contains(&high) { 0.0 } else { thickness };
            }
            block
        }
        Geometry::Polygon(_) | Geometry::Moved(_) => {
            outline::bounding_box(&shape.geometry, scene.dimension, Spacing::of(scene, shape).thickness())
        }
    }
}
