//! Remarks on the fluid: what carries it, how fast it may become.

use halfstep_scene::geometry::Layout;
use halfstep_scene::{Geometry, Phase, Scene, expected_speed as fastest};

/// Mach number above which the density error, about its square, exceeds 3 %.
const HIGHEST_MACH: f64 = 0.17;

/// Fluid with nothing below it.
pub(super) fn hanging<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    // Along which axis things fall, and which way.
    let Some(axis) = (0..D).max_by(|&a, &b| scene.gravity[a].abs().total_cmp(&scene.gravity[b].abs())) else {
        return;
    };
    if scene.gravity[axis] == 0.0 {
        return;
    }
    let down = scene.gravity[axis].signum();
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| shape.phase == Phase::Fluid) {
        let Geometry::Box(block) = &shape.geometry else { continue };
        let bottom = if down < 0.0 { block.min[axis] } else { block.max[axis] };
        let reach = 1.5 * scene.resolution;
        let below = |x: &[f64; D]| {
            let depth = (x[axis] - bottom) * down;
            0.0 <= depth + 1e-9 * reach
                && depth < reach
                && (0..D).all(|a| a == axis || (block.min[a] <= x[a] && x[a] <= block.max[a]))
        };
        let others = layout.fluid.iter().filter(|p| p.shape as usize != index).map(|p| &p.position);
        let solid = layout.solid.iter().map(|p| &p.position);
        let wall = layout.wall.iter().map(|p| &p.position);
        if !others.chain(solid).chain(wall).any(below) {
            all.push(format!("`{}` hangs in the air: nothing is right below it, so it falls", shape.name));
        }
    }
}

/// Falls that compress the fluid.
pub(super) fn expected_speed(scene: &Scene, all: &mut Vec<String>) {
    let Some(fluid) = &scene.fluid else { return };
    let fastest = fastest(scene);
    let mach = fastest / fluid.sound_speed;
    if mach > HIGHEST_MACH {
        all.push(format!(
            "the fluid can fall to {fastest:.2} m/s, Mach {mach:.2}: it is compressed by about {:.0} %; \
             fluid.sound_speed = {:.0} keeps it below 1 %",
            100.0 * mach * mach,
            (10.0 * fastest).ceil()
        ));
    }
}
