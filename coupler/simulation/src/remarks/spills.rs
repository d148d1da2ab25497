//! Remarks on water that flows out of the scene at once, over a rim or at a side that nothing closes.

use super::near;
use super::reached::{Matter, by_place};
use super::shapes::length;
use super::water::falls;
use halfstep_scene::geometry::{self, FluidPoint, Layout};
use halfstep_scene::{Block, Geometry, Phase, Scene};

/// How far from where all walls end water flows out at once, in spacings beside the thickness of a tank's wall.
const BESIDE: f64 = 2.0;

/// Names of the directions along the axes.
const TOWARD: [[&str; 2]; 3] =
    [["the left", "the right"], ["the bottom", "the top"], ["the back", "the front"]];

/// Water beside which there is neither wall nor solid up to where all of them end.
pub(super) fn spills<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let Some((down, way)) = falls::<D>(scene) else { return };
    let others = scene.shapes.iter().filter(|shape| shape.phase != Phase::Fluid);
    let Some(around) = geometry::around(others.map(|shape| geometry::bounding_box(shape, scene))) else {
        return;
    };
    if layout.wall.is_empty() {
        return;
    }
    let dx = scene.resolution;
    let matter = Matter::with_solids(scene, layout);
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, s)| s.phase == Phase::Fluid) {
        // What is thrown flies, and what stands on a wall flows.
        let thrown = shape.velocity != [0.0; 3] && !stands(scene, layout, index, down);
        if thrown || shape.velocity_field.is_some() {
            continue;
        }
        for (axis, side) in (0..D).filter(|axis| *axis != down).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let (end, sign) = if side == 0 { (around.min[axis], -1.0) } else { (around.max[axis], 1.0) };
            let lidded = under_a_lid(scene, (down, way), (axis, side));
            let flows_out = |p: &&FluidPoint<D>| {
                let distance = (end - p.position[axis]) * sign;
                let is_beside = distance < super::walls::kernel_support(scene) + BESIDE * dx;
                let is_lidded = lidded.iter().any(|cavity| geometry::holds(cavity, &p.position, 0.0));
                let beside = |step: i32| -> [f64; D] {
                    std::array::from_fn(|a| {
                        p.position[a] + if a == axis { f64::from(step) * dx * sign } else { 0.0 }
                    })
                };
                let steps = (distance / dx).ceil() as i32;
                p.shape as usize == index
                    && distance >= 0.0
                    && (is_beside || is_lidded)
                    && (1..=steps).all(|step| !matter.fill(&beside(step)))
            };
            let count = layout.fluid.iter().filter(flows_out).count();
            if count > 0 {
                let lid = if lidded.is_empty() { "" } else { " (its tank is closed above and `open` there)" };
                all.push(format!(
                    "`{}` flows out of the scene toward {}: nothing is beside {count} of its particles up to {} = {} \
                     m, where all walls end{lid}",
                    shape.name,
                    TOWARD[axis][side],
                    ["x", "y", "z"][axis],
                    length(end)
                ));
            }
        }
    }
}

/// Cavities of tanks that are closed above and open at a side: it is hardly that side that was to be open.
fn under_a_lid(scene: &Scene, (down, way): (usize, f64), (axis, side): (usize, usize)) -> Vec<Block> {
    let upper = geometry::sides(down)[usize::from(way < 0.0)];
    let tanks = scene.shapes.iter().filter_map(|shape| match &shape.geometry {
        Geometry::Tank { cavity, open } => Some((cavity, open)),
        _ => None,
    });
    let lidded =
        tanks.filter(|(_, open)| !open.contains(&upper) && open.contains(&geometry::sides(axis)[side]));
    lidded.map(|(cavity, _)| *cavity).collect()
}

/// Whether walls are beside at least half as many of a shape's particles as it is wide.
fn stands<const D: usize>(scene: &Scene, layout: &Layout<D>, shape: usize, down: usize) -> bool {
    let reach = 1.5 * scene.resolution;
    let walls = by_place(reach, layout.wall.iter().map(|w| w.position));
    let own = layout.fluid.iter().filter(|p| p.shape as usize == shape);
    let beside = own.filter(|p| walls.around(&p.position).any(|w| near(w, &p.position, reach))).count();
    let block = geometry::bounding_box(&scene.shapes[shape], scene);
    let width: f64 =
        (0..D).filter(|a| *a != down).map(|a| (block.max[a] - block.min[a]) / scene.resolution).product();
    2.0 * beside as f64 > width
}
