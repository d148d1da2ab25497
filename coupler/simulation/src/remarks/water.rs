//! Remarks on the fluid: what carries it, how fast it may become.

use halfstep_scene::geometry::{self, Layout};
use halfstep_scene::{Block, Geometry, Motion, Phase, Scene, expected_speed_of_fluid as fastest};

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
            "the fluid can come to {fastest:.2} m/s, Mach {mach:.2}: it is compressed by about {:.0} %; \
             fluid.sound_speed = {:.0} keeps it below 1 %",
            100.0 * mach * mach,
            (10.0 * fastest).ceil()
        ));
    }
}

/// Part of its depth by which the water may differ from what a wave maker is meant for.
const DEPTH: f64 = 0.05;

/// Depth of the water, m; `None` where there is none.
pub(super) fn depth(scene: &Scene) -> Option<f64> {
    geometry::around(geometry::fluid_boxes(scene)).map(|water| water.max[1] - water.min[1])
}

/// Wave makers for water of another depth.
pub(super) fn wave_makers(scene: &Scene, all: &mut Vec<String>) {
    let depth = depth(scene);
    for shape in &scene.shapes {
        let Some(makes) = shape.motion.as_ref().and_then(Motion::makes) else { continue };
        if let Some(end) = makes.end.filter(|end| *end > scene.end_time) {
            all.push(format!(
                "`{}` moves until {end:.3} s for its wave, and the run ends at {} s",
                shape.name, scene.end_time
            ));
        }
        let other = |d: &f64| (d - makes.depth).abs() > DEPTH * makes.depth + 0.5 * scene.resolution;
        if let Some(depth) = depth.filter(other) {
            all.push(format!(
                "`{}` makes waves for a depth of {} m, and the water is {} m deep: they have another height and length",
                shape.name, makes.depth as f32, depth as f32
            ));
        }
    }
}

/// Walls that move through fluid into other walls: what is dry may overlap.
pub(super) fn walls_that_meet(scene: &Scene, all: &mut Vec<String>) {
    let walls: Vec<_> = scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall).collect();
    let fluid = geometry::fluid_boxes(scene);
    for moving in &walls {
        let Some(motion) = &moving.motion else { continue };
        if motion.pivot().is_some() {
            continue;
        }
        let block = geometry::bounding_box(moving, scene);
        let time = |k: usize| scene.end_time * k as f64 / INSTANTS as f64;
        let at = |k: usize| {
            let (way, mut now) = (motion.at(time(k)).displacement, block);
            (0..3).for_each(|a| (now.min[a], now.max[a]) = (now.min[a] + way[a], now.max[a] + way[a]));
            now
        };
        let way: Vec<Block> = (0..=INSTANTS).map(at).collect();
        // Boxes that do not move: what slides along one meets nothing.
        for other in walls.iter().filter(|other| other.motion.is_none()) {
            let Geometry::Box(fixed) = &other.geometry else { continue };
            if overlap(&block, fixed, scene) {
                continue;
            }
            let Some(meets) = way.iter().position(|now| overlap(now, fixed, scene)) else { continue };
            if way[..=meets].iter().any(|now| fluid.iter().any(|fluid| overlap(now, fluid, scene))) {
                all.push(format!(
                    "`{}` goes through `{}` from about {:.3} s on: walls do not stop each other, and fluid between \
                     them is crushed",
                    moving.name,
                    other.name,
                    time(meets)
                ));
            }
        }
    }
}

/// Instants of a run at which walls are looked at.
pub(super) const INSTANTS: usize = 1000;

/// Whether two boxes have more in common than a face: half a spacing in each direction.
fn overlap(a: &Block, b: &Block, scene: &Scene) -> bool {
    let common = |k: usize| a.max[k].min(b.max[k]) - a.min[k].max(b.min[k]);
    (0..scene.dimension).all(|k| common(k) > 0.5 * scene.resolution)
}
