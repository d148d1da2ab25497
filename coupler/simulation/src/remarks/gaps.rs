//! Remarks on gaps too narrow for the fluid, and on gates that hold less water than stands beside them.

use super::shapes::length;
use super::water::{depths_below, falls, others, outermost};
use halfstep_scene::geometry::{self, Layout};
use halfstep_scene::{Block, Geometry, Lattice, Phase, Scene, Shape};

/// Spacings of a gap, from which on it is none of rounding, and up to which one or two rows of fluid creep through it.
const BELOW: [f64; 2] = [0.5, 3.25];
/// The same of a gap beside water: up to where it is no place of its own.
const BESIDE: [f64; 2] = [0.75, 4.25];
/// Part of a face that has the gap.
const MOSTLY: f64 = 0.5;

/// Least gap of a face from the depths below its row, m, where most of it has one within these bounds.
fn gap(depths: &[Option<f64>], row_to_row: f64, [least, most]: [f64; 2]) -> Option<f64> {
    let gaps: Vec<f64> = depths.iter().flatten().map(|depth| depth - row_to_row).collect();
    let own = || gaps.iter().copied().filter(|gap| least < *gap && *gap < most);
    (own().count() as f64 > MOSTLY * depths.len() as f64).then(|| own().reduce(f64::min)).flatten()
}

/// Wet gaps of few spacings between a wall and the one below it.
pub(super) fn below<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let Some((axis, down)) = falls::<D>(scene) else { return };
    let dx = scene.resolution;
    let row_to_row = if scene.numerics.lattice == Lattice::Nodal { 0.0 } else { dx };
    for (index, shape) in scene.shapes.iter().enumerate() {
        if shape.phase != Phase::Wall || !matches!(shape.geometry, Geometry::Box(_)) {
            continue;
        }
        let own = |of: u32| of as usize == index;
        let row =
            outermost(layout.wall.iter().filter(|p| own(p.shape)).map(|p| p.position), (axis, down), dx);
        let others = layout.wall.iter().filter(|p| !own(p.shape)).map(|p| &p.position);
        let most = row_to_row + BELOW[1] * dx;
        let depths = depths_below(&row, others, (axis, down), dx, most);
        let Some(gap) = gap(&depths, row_to_row, BELOW.map(|rows| rows * dx)) else { continue };
        if is_wet(scene, layout, &row, (axis, down), gap) {
            all.push(format!(
                "`{}` ends {} m, {:.1} spacings, above the wall below it: fluid neither stays behind so narrow a gap \
                 nor flows through it as it should (from four spacings on it does)",
                shape.name,
                length(gap),
                gap / dx
            ));
        }
    }
}

/// Whether fluid is in the gap below a row, or beside it.
fn is_wet<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    row: &[[f64; D]],
    (axis, down): (usize, f64),
    gap: f64,
) -> bool {
    let (mut low, mut high) = ([f64::MAX; D], [f64::MIN; D]);
    for x in row {
        (0..D).for_each(|a| (low[a], high[a]) = (low[a].min(x[a]), high[a].max(x[a])));
    }
    let near = 2.0 * scene.resolution;
    layout.fluid.iter().any(|p| {
        let depth = (p.position[axis] - row[0][axis]) * down;
        let beside = |a: usize| low[a] - near < p.position[a] && p.position[a] < high[a] + near;
        0.0 < depth && depth < gap + scene.resolution && (0..D).all(|a| a == axis || beside(a))
    })
}

/// Still water that ends a few spacings before what should hold it.
pub(super) fn beside<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let Some((down, _)) = falls::<D>(scene) else { return };
    let dx = scene.resolution;
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| shape.hydrostatic) {
        if !matches!(shape.geometry, Geometry::Box(_)) {
            continue;
        }
        let own = |of: u32| of as usize == index;
        for (axis, way) in (0..D).filter(|axis| *axis != down).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let column =
                outermost(layout.fluid.iter().filter(|p| own(p.shape)).map(|p| p.position), (axis, way), dx);
            let depths =
                depths_below(&column, others(layout, index), (axis, way), dx, (1.0 + BESIDE[1]) * dx);
            let Some(gap) = gap(&depths, dx, BESIDE.map(|rows| rows * dx)) else { continue };
            all.push(format!(
                "`{}` ends at {} = {} m, {} m, {:.1} spacings, before what stands there: it falls into that gap at \
                 once",
                shape.name,
                ["x", "y", "z"][axis],
                length(column[0][axis] + 0.5 * way * dx),
                length(gap),
                gap / dx
            ));
        }
    }
}

/// Gates that end below the water that they hold.
pub(super) fn over<const D: usize>(scene: &Scene, all: &mut Vec<String>) {
    let Some((down, way)) = falls::<D>(scene) else { return };
    let dx = scene.resolution;
    let water: Vec<(&Shape, Block)> = scene
        .shapes
        .iter()
        .filter(|shape| shape.phase == Phase::Fluid)
        .map(|shape| (shape, geometry::bounding_box(shape, scene)))
        .collect();
    // Heights against gravity.
    let ends = |block: &Block| match way < 0.0 {
        true => [block.min[down], block.max[down]],
        false => [-block.max[down], -block.min[down]],
    };
    for gate in scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall) {
        let (Geometry::Box(block), Some(motion)) = (&gate.geometry, &gate.motion) else { continue };
        if motion.makes().is_some() {
            continue;
        }
        let [foot, top] = ends(block);
        let touches = |other: &Block, axis: usize, low: bool| {
            let apart =
                if low { block.min[axis] - other.max[axis] } else { other.min[axis] - block.max[axis] };
            let level = |a: usize| a == axis || other.min[a] < block.max[a] && block.min[a] < other.max[a];
            apart.abs() < 1.5 * dx && (0..scene.dimension).all(level)
        };
        for axis in (0..scene.dimension).filter(|axis| *axis != down) {
            let [low, high] =
                [true, false].map(|low| water.iter().find(|(_, other)| touches(other, axis, low)));
            // Water on both sides flows nowhere.
            let ((Some((shape, held)), None) | (None, Some((shape, held)))) = (low, high) else { continue };
            let [bottom, level] = ends(held);
            if bottom < top && foot < level && top < level - 0.5 * dx {
                all.push(format!(
                    "`{}` ends {} m below the surface of `{}`, which stands beside it: the water flows over it at once",
                    gate.name,
                    length(level - top),
                    shape.name
                ));
            }
        }
    }
}
