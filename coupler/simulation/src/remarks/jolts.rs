//! Remarks on walls that push the fluid too suddenly or too hard, and on recordings that end too soon.

use super::moving;
use super::reached::by_place;
use super::shapes::length;
use super::water::{INSTANTS, depth};
use halfstep_scene::geometry::{Cells, Layout};
use halfstep_scene::{Course, Motion, Part, Placement, Scene, Shape, Spline};

/// Speed with which a wall may begin to push at once, over that of long waves: the shock, rho c v with c ten times the
/// fluid's fastest, is then several times the pressure at rest.
const AT_ONCE: f64 = 0.2;
/// Accelerations of walls over that of gravity that no shaker and no impact test gives to water.
pub(super) const HARD: f64 = 10.0;
/// Most wall particles that are followed.
const FOLLOWED: usize = 64;
/// Part of its largest rate with which a recording that is cut off ends.
const CUT_OFF: f64 = 0.25;
/// Spacings up to which a wall particle's next fluid particle is right at it.
const AT_FLUID: f64 = 1.5;

/// Place and normal of a particle that fluid is at.
type Face<const D: usize> = ([f64; D], [f64; D]);

/// Particles of a wall or a prescribed body that fluid is at: places and normals, of a body toward its nearest fluid;
/// and how many each of them stands for.
fn pushing<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    fluid: &Cells<[f64; D], D>,
    shape: usize,
) -> (Vec<Face<D>>, usize) {
    let reach = AT_FLUID * scene.resolution;
    let away = |x: &[f64; D], p: &[f64; D]| -> [f64; D] { std::array::from_fn(|d| p[d] - x[d]) };
    let square = |v: &[f64; D]| v.iter().map(|c| c * c).sum::<f64>();
    let toward = |x: &[f64; D]| {
        let nearest = fluid.around(x).map(|p| away(x, p)).min_by(|a, b| square(a).total_cmp(&square(b)));
        nearest.filter(|way| square(way) < reach * reach).map(|way| way.map(|c| c / square(&way).sqrt()))
    };
    let walls = layout.wall.iter().filter(|w| w.shape as usize == shape);
    let of_walls = walls.filter_map(|w| toward(&w.position).map(|_| (w.position, w.normal)));
    let bodies = layout.solid.iter().filter(|p| p.body as usize == shape);
    let of_bodies = bodies.filter_map(|p| toward(&p.position).map(|normal| (p.position, normal)));
    let all: Vec<_> = of_walls.chain(of_bodies).collect();
    let every = 1 + all.len() / FOLLOWED;
    (all.iter().step_by(every).copied().collect(), every)
}

/// The parts of a motion; not of wave makers, which begin by themselves.
fn parts(motion: &Motion) -> &[Part] {
    if motion.makes().is_some() { &[] } else { motion.parts() }
}

/// Part of the water's depth over which what goes one way pushes at least: a gate's edge is less.
const WIDE: f64 = 0.25;

/// Whether a part goes to and fro.
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

/// When a motion begins to go one way at once, s.
fn leaves(motion: &Motion) -> Vec<f64> {
    let of_part = |part: &Part| match &part.course {
        Course::Steady { start, ramp: 0.0, .. } => Some(start.next_up()),
        _ => None,
    };
    match motion {
        Motion::Steady { start, .. } => vec![*start],
        _ => parts(motion).iter().filter_map(of_part).collect(),
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
    let fluid = by_place(AT_FLUID * scene.resolution, layout.fluid.iter().map(|p| p.position));
    let mut told: Vec<&Motion> = Vec::new();
    // Water that goes along is not pushed.
    let flows = layout.fluid.iter().any(|p| p.velocity != [0.0; D]);
    let prescribed = |shape: &Shape| shape.solid.is_none_or(|k| scene.solids[k].rigid().is_some());
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| prescribed(shape)) {
        let Some(motion) = shape.motion.as_ref().filter(|m| !told.contains(m)) else { continue };
        let leaves = if flows { Vec::new() } else { leaves(motion) };
        if !is_swing(motion) && leaves.is_empty() {
            continue;
        }
        let (faces, every) = pushing(scene, layout, &fluid, index);
        let each = |v: &dyn Fn([f64; D]) -> [f64; D]| -> Vec<f64> {
            let of = |(x, normal): &Face<D>| {
                let v = v(*x);
                (0..D).map(|d| v[d] * normal[d]).sum::<f64>().abs()
            };
            faces.iter().map(of).collect()
        };
        let across = |v: &dyn Fn([f64; D]) -> [f64; D]| each(v).into_iter().fold(0.0, f64::max);
        let change = |start: f64| {
            let now = motion.at(start.max(0.0));
            let before = if start > 0.0 { motion.at(start.next_down()) } else { Placement::default() };
            move |x: [f64; D]| -> [f64; D] {
                let (v, u) = (now.velocity_of(x), before.velocity_of(x));
                std::array::from_fn(|d| v[d] - u[d])
            }
        };
        let in_run = |start: &f64| *start < scene.end_time;
        let swings = starts(motion).into_iter().filter(in_run).map(|start| across(&change(start)));
        let one_way = leaves.into_iter().filter(in_run).filter_map(|start| {
            let pushed = each(&change(start)).into_iter().filter(|v| *v > AT_ONCE * waves);
            let wide = (pushed.clone().count() * every) as f64 * scene.resolution;
            pushed.reduce(f64::max).filter(|_| wide > WIDE * depth)
        });
        let speed = swings.chain(one_way).fold(0.0, f64::max);
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
