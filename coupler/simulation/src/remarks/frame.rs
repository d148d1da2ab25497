//! A frame that moves.

use halfstep_scene::{Gravity, Phase, Scene, Shape, geometry};

/// Instants at which the frame is looked at.
const INSTANTS: u32 = 2000;

/// Part of gravity above which what a turning frame leaves out is told.
const LEFT_OUT: f64 = 0.05;

/// Walls that move in the frame as the frame does in space: what is at rest in the frame moves already.
pub(super) fn twice(scene: &Scene, all: &mut Vec<String>) {
    let Some(frame) = &scene.frame else { return };
    let along = |shape: &&Shape| shape.phase == Phase::Wall && shape.motion.as_ref() == Some(&frame.motion);
    if let Some(wall) = scene.shapes.iter().find(along) {
        all.push(format!(
            "`{}` has the motion of the `[frame]` once more, so the fluid feels it twice: what has no `motion` rests \
             in the frame, and moves with it in space",
            wall.name
        ));
    }
}

/// What acts at no time, and what turning leaves out.
pub(super) fn frame(scene: &Scene, all: &mut Vec<String>) {
    let Some(frame) = &scene.frame else { return };
    let instants = (0..=INSTANTS).map(|k| scene.end_time * f64::from(k) / f64::from(INSTANTS));
    let gravity = Gravity::of(scene);
    let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let g = size(scene.gravity);
    let change = |t: f64| {
        let now: [f64; 3] = gravity.at(t);
        size(std::array::from_fn(|d| now[d] - scene.gravity[d]))
    };
    let most = instants.clone().map(change).fold(0.0, f64::max);
    if most <= 1e-9 * g {
        all.push(format!(
            "`frame.motion` changes gravity at no time until the end, {} s: a steady velocity accelerates nothing, nor \
             does what begins later",
            scene.end_time
        ));
        return;
    }
    if g > 0.0 && most > super::jolts::HARD * g {
        all.push(format!(
            "the `[frame]` is accelerated by up to {} m/s², {:.0} times gravity (a `period` is in seconds and no \
             frequency; a recording of accelerations is no `file` of places; noise in a recording is accelerations)",
            super::shapes::length(most),
            most / g
        ));
    }
    let Some(pivot) = frame.motion.pivot() else { return };
    let boxes = scene.shapes.iter().map(|shape| geometry::bounding_box(shape, scene));
    let Some(around) = geometry::around(boxes) else { return };
    let away = (0..2).map(|d| (around.min[d] - pivot[d]).abs().max((around.max[d] - pivot[d]).abs()));
    let radius = away.map(|x| x * x).sum::<f64>().sqrt();
    let turns = instants.filter_map(|t| frame.motion.at(t).turn);
    let left_out = turns.map(|turn| radius * turn.acceleration.abs().max(turn.rate * turn.rate));
    let left_out = left_out.fold(0.0, f64::max);
    if left_out > LEFT_OUT * g {
        all.push(format!(
            "the frame turns: gravity turns with it, and centrifugal and Euler forces of up to {left_out:.3} m/s2 \
             ({radius:.3} m from the pivot) and Coriolis forces are left out; shapes with that `motion` have them all"
        ));
    }
}
