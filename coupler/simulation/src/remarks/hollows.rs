//! Remarks on hollows in the fluid: a void is empty, and no air that holds the fluid above it up.

use super::reached::{Matter, by_place, filled};
use super::water::falls;
use halfstep_scene::geometry::{self, Layout};
use halfstep_scene::{Phase, Scene};

/// Part of a void's empty places above which fluid stands, from which on it is remarked.
const BELOW: f64 = 0.5;

/// Voids in the fluid into which it falls.
pub(super) fn hollows<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let Some((axis, way)) = falls::<D>(scene).filter(|_| !scene.voids.is_empty()) else { return };
    let dx = scene.resolution;
    let (fluid, matter) =
        (by_place(dx, layout.fluid.iter().map(|p| p.position)), Matter::with_solids(scene, layout));
    let is_wet = |x: &[f64; D]| filled(&fluid, x, dx);
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
                if !is_in || is_wet(&place) || matter.fill(&place) {
                    continue;
                }
                empty += 1;
                let up = |k: i64| -> [f64; D] {
                    std::array::from_fn(|a| place[a] - if a == axis { way * k as f64 * dx } else { 0.0 })
                };
                let over = (1..=count[axis]).map(up).find(|x| is_wet(x) || matter.fill(x));
                below += u32::from(over.is_some_and(|x| is_wet(&x)));
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
