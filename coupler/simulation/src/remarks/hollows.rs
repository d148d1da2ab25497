//! Remarks on hollows in the fluid: a void is empty, and no air that holds the fluid above it up.

use super::near;
use super::water::falls;
use halfstep_scene::geometry::{self, Cells, Layout};
use halfstep_scene::{Phase, Scene};

/// Part of a void's empty places above which fluid stands, from which on it is remarked.
const BELOW: f64 = 0.5;
/// Distance within which a particle fills a place, in spacings.
const FILLED: f64 = 0.75;

/// Voids in the fluid into which it falls.
pub(super) fn hollows<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let Some((axis, way)) = falls::<D>(scene).filter(|_| !scene.voids.is_empty()) else { return };
    let dx = scene.resolution;
    let (mut fluid, mut others) = (Cells::new(dx), Cells::new(dx));
    layout.fluid.iter().for_each(|p| fluid.add(&p.position, p.position));
    layout.solid.iter().for_each(|p| others.add(&p.position, p.position));
    layout.wall.iter().for_each(|p| others.add(&p.position, p.position));
    let fills = |cells: &Cells<[f64; D], D>, x: &[f64; D]| cells.around(x).any(|p| near(p, x, FILLED * dx));
    for void in &scene.voids {
        let (mut empty, mut below) = (0_u32, 0_u32);
        for shape in scene.shapes.iter().filter(|shape| shape.phase == Phase::Fluid) {
            let block = geometry::bounding_box(shape, scene);
            let count: [i64; D] =
                std::array::from_fn(|a| ((block.max[a] - block.min[a]) / dx).round() as i64);
            for code in 0..count.iter().product() {
                let mut rest = code;
                let place: [f64; D] = std::array::from_fn(|a| {
                    let k = rest % count[a];
                    rest /= count[a];
                    block.min[a] + (k as f64 + 0.5) * dx
                });
                let is_in = geometry::distance(&void.geometry, &halfstep_wire::wide(place)) == 0.0;
                if !is_in || fills(&fluid, &place) || fills(&others, &place) {
                    continue;
                }
                empty += 1;
                let up = |k: i64| -> [f64; D] {
                    std::array::from_fn(|a| place[a] - if a == axis { way * k as f64 * dx } else { 0.0 })
                };
                let over = (1..=count[axis]).map(up).find(|x| fills(&fluid, x) || fills(&others, x));
                below += u32::from(over.is_some_and(|x| fills(&fluid, &x)));
            }
        }
        if f64::from(below) > BELOW * f64::from(empty) && empty >= 4 {
            all.push(format!(
                "the void `{}` is empty, and no air: the fluid above {below} of its {empty} empty places falls into it \
                 (there is one fluid, and a light solid floats)",
                void.name
            ));
        }
    }
}
