//! Remarks on `numerics.domain`, outside of which fluid is taken out.

use super::shapes::length;
use super::water::INSTANTS;
use super::{meet, overlap};
use halfstep_scene::geometry::{self, Layout};
use halfstep_scene::{Block, Geometry, Phase, Scene, Shape};

/// A domain that cuts off water as it begins, or parts of a tank that holds water.
pub(super) fn domain<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let Some(domain) = &scene.numerics.domain else { return };
    let count = layout.fluid.len();
    let astray = layout.fluid.iter().filter(|p| !geometry::holds(domain, &p.position, 0.0)).count();
    if astray > 0 {
        all.push(format!(
            "numerics.domain takes {astray} of {count} fluid particles out in the first step: they begin outside of it \
             (without the key it is the box of all shapes, widened by its own size)"
        ));
        return;
    }
    for tank in scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall) {
        let Geometry::Tank { cavity, open } = &tank.geometry else { continue };
        let holds_water = geometry::fluid_boxes(scene).iter().any(|water| overlap(water, cavity, scene));
        if !holds_water || !meet(domain, cavity, scene) {
            continue;
        }
        let reached = wherever(scene, tank, cavity);
        let dx = scene.resolution;
        let cut = (0..D).find_map(|axis| {
            let [low, high] = geometry::sides(axis).map(|side| !open.contains(&side));
            let cuts_low = low && domain.min[axis] > reached.min[axis] + dx;
            let cuts_high = high && domain.max[axis] < reached.max[axis] - dx;
            let ends = match cuts_low {
                true => [domain.min[axis], reached.min[axis]],
                false => [domain.max[axis], reached.max[axis]],
            };
            (cuts_low || cuts_high).then_some((["x", "y", "z"][axis], ends))
        });
        if let Some((axis, [end, wall])) = cut {
            all.push(format!(
                "numerics.domain ends at {axis} = {} m inside of `{}`, whose wall {} at {} m: fluid that comes between \
                 them is taken out",
                length(end),
                tank.name,
                if tank.motion.is_some() { "comes to stand" } else { "stands" },
                length(wall)
            ));
        }
    }
}

/// The box of all places that a tank's cavity comes to.
fn wherever(scene: &Scene, tank: &Shape, cavity: &Block) -> Block {
    let Some(motion) = &tank.motion else { return *cavity };
    let corner = |code: usize| -> [f64; 3] {
        std::array::from_fn(|a| if code >> a & 1 == 0 { cavity.min[a] } else { cavity.max[a] })
    };
    let places = (0..=INSTANTS).map(|k| motion.at(scene.end_time * k as f64 / INSTANTS as f64));
    let corners = places.flat_map(|place| (0..8).map(move |code| place.position_of(corner(code))));
    geometry::around(corners.map(|at| Block { min: at, max: at })).unwrap_or(*cavity)
}
