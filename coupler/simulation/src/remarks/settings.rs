//! Remarks on settings that cannot act in their scene, or act the other way around.

use super::curves::level_at;
use super::near;
use super::shapes::{Placed, length};
use super::walls::kernel_support;
use super::water::INSTANTS;
use halfstep_scene::geometry::{Cells, Layout};
use halfstep_scene::{Course, Geometry, Motion, Phase, ProbeKind, Scene, Shape, geometry};

/// Motions that begin, or reach their amplitude, after the run.
pub(super) fn motions(scene: &Scene, all: &mut Vec<String>) {
    let end = scene.end_time;
    for shape in &scene.shapes {
        let Some(motion) = &shape.motion else { continue };
        let around = geometry::bounding_box(shape, scene);
        let first = motion.at(0.0);
        let stays = (0..=INSTANTS).all(|k| {
            let now = motion.at(end * k as f64 / INSTANTS as f64);
            now.displacement == first.displacement && now.velocity == [0.0; 3] && now.turn == first.turn
        });
        if stays && motion.fastest(&around) > 0.0 {
            all.push(format!(
                "`{}` has a motion and does not move until the run ends at {end} s",
                shape.name
            ));
        } else if let Some(full) = full_from(motion).filter(|full| *full > end) {
            all.push(format!(
                "the motion of `{}` reaches its amplitude at {} s, after its `ramp`, and the run ends at {end} s",
                shape.name,
                length(full)
            ));
        }
    }
}

/// When all swings of a motion have reached their amplitude, s; `None` without any.
fn full_from(motion: &Motion) -> Option<f64> {
    if let Motion::Oscillating { start, ramp, .. } = motion {
        return Some(start + ramp);
    }
    let full = motion.parts().iter().filter_map(|part| match part.course {
        Course::Sine { start, ramp, .. } => Some(start + ramp),
        _ => None,
    });
    full.reduce(f64::max)
}

/// Solitary waves whose maker goes away from all water.
pub(super) fn solitary_waves(scene: &Scene, all: &mut Vec<String>) {
    for shape in &scene.shapes {
        let Some(motion) = &shape.motion else { continue };
        // A maker of other waves goes both ways.
        let Some(end) = motion.makes().filter(|makes| makes.reach[1] == 0.0).and_then(|makes| makes.end)
        else {
            continue;
        };
        let way = motion.at(end).displacement[0];
        let around = geometry::bounding_box(shape, scene);
        let middle = 0.5 * (around.min[0] + around.max[0]);
        let mut water = geometry::fluid_boxes(scene).into_iter().peekable();
        let behind = |b: &halfstep_scene::Block| (0.5 * (b.min[0] + b.max[0]) - middle) * way < 0.0;
        if water.peek().is_some() && water.all(|block| behind(&block)) {
            all.push(format!(
                "`{}` goes away from the water, and its wave is a trough: `toward` says on which side the waves go",
                shape.name
            ));
        }
    }
}

/// Widths of the kernel's support along which a surface may be open before a background pressure is remarked.
const OPEN: f64 = 2.0;

/// A background pressure where a surface of the fluid is free: nothing balances it there.
pub(super) fn background_pressure<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let Some(fluid) = scene.fluid.as_ref().filter(|fluid| fluid.background_pressure > 0.0) else { return };
    let dx = scene.resolution;
    let solids = layout.solid.iter().map(|p| &p.position);
    let others = layout.wall.iter().map(|p| &p.position).chain(solids);
    let mut cells = Cells::new(dx);
    layout.fluid.iter().map(|p| &p.position).chain(others).for_each(|x| cells.add(x, *x));
    // No particle within a spacing of the place beside it.
    let open = |at: &[f64; D]| {
        (0..2 * D).any(|k| {
            let beside: [f64; D] = std::array::from_fn(|a| match k / 2 == a {
                true => at[a] + dx * (2.0 * (k % 2) as f64 - 1.0),
                false => at[a],
            });
            !cells.around(&beside).any(|x| near(x, &beside, 0.9 * dx))
        })
    };
    let count = layout.fluid.iter().filter(|p| open(&p.position)).count();
    if count as f64 > (OPEN * 4.0 * scene.smoothing_ratio).powi(D as i32 - 1) {
        all.push(format!(
            "fluid.background_pressure = {} Pa drives the fluid apart at its free surface, where nothing balances it: \
             it belongs to fluid that walls enclose",
            fluid.background_pressure
        ));
    }
}

/// Checkpoints that would be made after the run.
pub(super) fn checkpoints(scene: &Scene, all: &mut Vec<String>) {
    let interval = scene.output.checkpoint_interval;
    if interval > scene.end_time {
        all.push(format!(
            "output.checkpoint_interval is {interval} s and the run ends at {} s: it makes no checkpoint",
            scene.end_time
        ));
    }
}

/// Spacings below which a line has too few places for a stream of its width.
const SHORT: f64 = 2.5;

/// Lines that a stream crosses in so few places that it counts for nothing where it is thinner than 2h.
pub(super) fn fluxes(scene: &Scene, all: &mut Vec<String>) {
    for probe in &scene.probes {
        let ProbeKind::Flux { from, to } = &probe.kind else { continue };
        let long = (0..3).map(|a| (to[a] - from[a]).powi(2)).sum::<f64>().sqrt();
        if long < SHORT * scene.resolution {
            all.push(format!(
                "the line of the probe `{}` is {:.1} spacings long: a flux counts where fluid fills half of the \
                 kernel, which a stream of less than about three spacings does not",
                probe.name,
                long / scene.resolution
            ));
        }
    }
}

/// Gauges on plates so thin that the kernel reaches the fluid behind them.
pub(super) fn thin_gauges(scene: &Scene, placed: &[Placed], all: &mut Vec<String>) {
    let reach = kernel_support(scene);
    for probe in &scene.probes {
        let ProbeKind::Pressure { shape: Some(index), .. } = &probe.kind else { continue };
        let (shape, placed) = (&scene.shapes[*index], &placed[*index]);
        let Some(thickness) = placed.rows.map(|rows| rows * scene.spacing(shape)) else { continue };
        if shape.phase == Phase::Solid && thickness < reach * (1.0 - 1e-9) {
            all.push(format!(
                "the gauge `{}` on `{}` averages the fluid within 2h = {} m, and the shape is {} m thick: it feels the \
                 fluid at both faces",
                probe.name,
                shape.name,
                reach as f32,
                thickness as f32
            ));
        }
    }
}

/// Water levels that begin dry where 0, which they say then, is a level that water can have, or one below the floor.
pub(super) fn dry_gauges<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let tank = |shape: &Shape| match &shape.geometry {
        Geometry::Tank { cavity, .. } => Some(cavity.min[1]),
        _ => None,
    };
    let wet = layout.fluid.iter().map(|p| p.position[1] - 0.5 * scene.resolution);
    let Some(lowest) = wet.chain(scene.shapes.iter().filter_map(tank)).reduce(f64::min) else { return };
    if lowest.abs() < scene.resolution {
        return;
    }
    for probe in &scene.probes {
        let ProbeKind::WaterLevel { x } = &probe.kind else { continue };
        let Some(dry) = x.iter().find(|&&x| level_at(scene, layout, x).is_none()) else { continue };
        let what = if lowest < 0.0 { "a level that water can have" } else { "below its floor" };
        all.push(format!(
            "the gauge `{}` begins dry at x = {dry} m, and stands at 0 there until water comes: {what}, since the \
             lowest place of the fluid is y = {} m",
            probe.name, lowest as f32
        ));
    }
}

/// Probes of the fluid beside everything.
pub(super) fn probes(scene: &Scene, all: &mut Vec<String>) {
    if scene.shapes.iter().any(|shape| shape.motion.is_some()) {
        // Where things go is not known.
        return;
    }
    let boxes = scene.shapes.iter().map(|shape| geometry::bounding_box(shape, scene));
    let Some(around) = geometry::around(boxes) else { return };
    let beyond = |x: f64| x < around.min[0] || x > around.max[0];
    // Water may splash above everything.
    let beside = |at: &[f64; 3]| beyond(at[0]) || at[1] < around.min[1];
    for probe in &scene.probes {
        let nothing = match &probe.kind {
            ProbeKind::WaterLevel { x } => x.iter().any(|&x| beyond(x)),
            ProbeKind::Velocity { at } | ProbeKind::Pressure { at, to: None, shape: None } => beside(at),
            ProbeKind::Flux { from, to } => beside(from) && beside(to),
            _ => false,
        };
        if nothing {
            all.push(format!(
                "the probe `{}` looks beside all shapes of the scene, where no fluid comes",
                probe.name
            ));
        }
    }
}
