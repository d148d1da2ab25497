//! Remarks on walls that push the fluid too suddenly or too hard, and on recordings that end too soon.

use super::shapes::length;
use super::water::{INSTANTS, depth};
use super::{moving, near};
use halfstep_scene::geometry::{Cells, Layout};
use halfstep_scene::{Course, Motion, Part, Placement, Scene, Spline};

/// Speed with which a wall may begin to push at once, over that of long waves: the shock, rho c v with c ten times the
/// fluid's fastest, is then several times the pressure at rest.
const AT_ONCE: f64 = 0.2;
/// Accelerations of walls over that of gravity that no shaker and no impact test gives to water.
const HARD: f64 = 10.0;
/// Most wall particles that are followed.
const FOLLOWED: usize = 64;
/// Part of its largest rate with which a recording that is cut off ends.
const CUT_OFF: f64 = 0.25;
/// Spacings up to which a wall particle's next fluid particle is right at it.
const AT_FLUID: f64 = 1.5;

/// Wall particles of a shape that fluid is at: places and normals.
fn pushing<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    fluid: &Cells<[f64; D], D>,
    shape: usize,
) -> Vec<([f64; D], [f64; D])> {
    let reach = AT_FLUID * scene.resolution;
    let at_fluid = |x: &[f64; D]| fluid.around(x).any(|p| near(p, x, reach));
    let own = layout.wall.iter().filter(|w| w.shape as usize == shape && at_fluid(&w.position));
    let all: Vec<_> = own.map(|w| (w.position, w.normal)).collect();
    all.iter().step_by(1 + all.len() / FOLLOWED).copied().collect()
}

/// The parts of a motion; not of wave makers, which begin by themselves.
fn parts(motion: &Motion) -> &[Part] {
    if motion.makes().is_some() { &[] } else { motion.parts() }
}

/// Whether a part goes to and fro. What goes one way may be a gate, whose edge alone pushes.
fn swings(part: &Part) -> bool {
    match &part.course {
        Course::Sine { .. } => true,
        Course::Points(spline) => spline.swings_by() > 0.0,
        Course::Steady { .. } | Course::Solitary(_) => false,
    }
}

/// When parts of a motion begin that may begin at once, s.
fn starts(motion: &Motion) -> Vec<f64> {
    let of_part = |part: &Part| match &part.course {
        Course::Sine { start, ramp: 0.0, .. } => Some(*start),
        Course::Points(spline) => Some(spline.ends()[0]),
        _ => None,
    };
    match motion {
        Motion::Oscillating { start, ramp: 0.0, .. } => vec![*start],
        _ => parts(motion).iter().filter(|part| swings(part)).filter_map(of_part).collect(),
    }
}

fn is_swing(motion: &Motion) -> bool {
    matches!(motion, Motion::Oscillating { .. }) || parts(motion).iter().any(swings)
}

/// Walls that begin to push fluid at once, and walls that push it too hard.
pub(super) fn pushed<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let gravity = scene.gravity_magnitude();
    let Some(depth) = depth(scene).filter(|_| gravity > 0.0) else { return };
    let waves = (gravity * depth).sqrt();
    let mut fluid = Cells::new(AT_FLUID * scene.resolution);
    layout.fluid.iter().for_each(|p| fluid.add(&p.position, p.position));
    let mut told: Vec<&Motion> = Vec::new();
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| shape.solid.is_none()) {
        let Some(motion) = shape.motion.as_ref().filter(|m| is_swing(m) && !told.contains(m)) else {
            continue;
        };
        let faces = pushing(scene, layout, &fluid, index);
        let across = |v: &dyn Fn([f64; D]) -> [f64; D]| {
            let of = |(x, normal): &([f64; D], [f64; D])| {
                let v = v(*x);
                (0..D).map(|d| v[d] * normal[d]).sum::<f64>().abs()
            };
            faces.iter().map(of).fold(0.0, f64::max)
        };
        let jump = |start: f64| {
            let now = motion.at(start.max(0.0));
            let before = if start > 0.0 { motion.at(start.next_down()) } else { Placement::default() };
            across(&|x| {
                let (v, u) = (now.velocity_of(x), before.velocity_of(x));
                std::array::from_fn(|d| v[d] - u[d])
            })
        };
        let first = starts(motion).into_iter().filter(|start| *start < scene.end_time);
        let speed = first.map(jump).fold(0.0, f64::max);
        if speed > AT_ONCE * waves {
            told.push(motion);
            all.push(format!(
                "`{}` moves at {} m/s at once, {:.2} of the speed of long waves in its water: a shock runs through the \
                 fluid (with a `ramp` an oscillation begins gently, and a recording with some rows at rest)",
                shape.name,
                length(speed),
                speed / waves
            ));
        }
        // Between each other's instants, so that no period hides between them.
        let instants = (0..INSTANTS).map(|k| (k as f64 + (0.618 * k as f64).fract()) / INSTANTS as f64);
        let accelerations = instants.map(|t| {
            let now = motion.at(t * scene.end_time);
            across(&|x| now.acceleration_of(x))
        });
        let most = accelerations.fold(0.0, f64::max);
        if most > HARD * gravity {
            told.push(motion);
            all.push(format!(
                "`{}` pushes its fluid with up to {} m/s², {:.0} times gravity (a `period` is in seconds and no \
                 frequency; noise in a recording is accelerations)",
                shape.name,
                length(most),
                most / gravity
            ));
        }
    }
}

/// Recordings that end in the middle of a motion, before the run.
pub(super) fn cut_off(scene: &Scene, all: &mut Vec<String>) {
    let tanks = moving::tanks(scene);
    let of_frame = scene.frame.iter().map(|frame| {
        ("`frame.motion`".to_owned(), &frame.motion, true, "from then on nothing is accelerated".to_owned())
    });
    let of_shapes = scene.shapes.iter().filter_map(|shape| {
        let is_tank = tanks.iter().any(|(tank, _)| tank.name == shape.name);
        let stops = format!("there `{}` stops at once and stays", shape.name);
        Some((format!("`{}`", shape.name), shape.motion.as_ref()?, is_tank, stops))
    });
    let mut told: Vec<&Motion> = Vec::new();
    for (name, motion, is_tank, then) in of_frame.chain(of_shapes) {
        // A gate's recording may end on its way up.
        let cut = |spline: &Spline| {
            let goes_on = spline.last_rate().abs() > CUT_OFF * spline.fastest();
            spline.ends()[1] < scene.end_time && goes_on && (is_tank || spline.swings_by() > 0.0)
        };
        let found = parts(motion).iter().find_map(|part| match &part.course {
            Course::Points(spline) if cut(spline) => Some((part, spline)),
            _ => None,
        });
        let Some((part, spline)) = found.filter(|_| !told.contains(&motion)) else { continue };
        told.push(motion);
        let way = part.translation.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (size, unit) = if part.angle == 0.0 { (way, "m/s") } else { (part.angle, "rad/s") };
        all.push(format!(
            "the recording of {name} ends at {} s in the middle of its motion, at {} {unit}, and the run at {} s: \
             {then} (a recording as long as the run, or one that comes to rest)",
            length(spline.ends()[1]),
            length((size * spline.last_rate()).abs()),
            scene.end_time
        ));
    }
}
