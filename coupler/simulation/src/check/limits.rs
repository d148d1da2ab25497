//! What `halfstep check` warns of once the roles are there: steps above limits, contacts that are soft, runs that last.

use super::{DAY, duration};
use crate::forecast::megabytes;
use crate::remarks::DEEP;
use halfstep_coupling::clock::times_above_limit;
use halfstep_coupling::roles::ContactAsks;
use halfstep_scene::{self as scene, Scene, TimeStep};

/// Frames of a film of several minutes.
const MOST_FRAMES: u64 = 5000;
/// Output of a run that is remarked, bytes.
const MOST_DISK: u64 = 20_000_000_000;

/// A fixed step above limits.
pub(super) fn too_long(scene: &Scene, limits: &[(String, f64)]) -> Vec<String> {
    let TimeStep::Fixed(dt) = scene.time_step else { return Vec::new() };
    let above = limits.iter().filter(|(_, limit)| dt > limit * (1.0 + 1e-9));
    above.map(|(name, limit)| times_above_limit(dt, name, *limit)).collect()
}

/// A run of more than a day.
pub(super) fn takes_days(
    scene: &Scene,
    seconds: Option<f64>,
    steps: u64,
    limits: &[(String, f64)],
) -> Option<String> {
    let seconds = seconds.filter(|seconds| *seconds > DAY)?;
    let (who, limit) = limits.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let why = match scene.time_step {
        TimeStep::Auto => format!("steps of {limit:.1e} s, the limit of {who}"),
        TimeStep::Fixed(dt) => format!("steps of {dt:.1e} s, its time_step"),
    };
    Some(format!(
        "the run is expected to take {}: {steps} {why}, until end_time = {} s",
        duration(seconds),
        scene.end_time
    ))
}

/// More frames than a film has, or than a disk is for.
pub(super) fn too_many_frames(scene: &Scene, frames: u64, disk: u64) -> Option<String> {
    (frames > MOST_FRAMES || disk > MOST_DISK).then(|| {
        format!(
            "the run writes {frames} frames, one each {} s, about {} (output.frame_interval)",
            scene.output.frame_interval,
            megabytes(disk)
        )
    })
}

/// Contacts that a weight presses far in: of what nothing holds, on what begins below it. A body rests on at most its
/// longest side.
pub(super) fn too_soft(scene: &Scene, contact: &ContactAsks) -> Vec<String> {
    let gravity = scene.gravity_magnitude();
    let height = |shape: &scene::Shape| {
        let around = scene::geometry::bounding_box(shape, scene);
        -(0..scene.dimension).map(|a| scene.gravity[a] * (around.min[a] + around.max[a])).sum::<f64>()
    };
    let is_free = |shape: &scene::Shape| {
        let keys = shape.solid.and_then(|solid| scene.solids[solid].rigid());
        let tied = keys.is_some_and(|keys| keys.joints.iter().any(|joint| joint.body == shape.body()));
        shape.clamp.is_empty() && shape.motion.is_none() && !tied
    };
    let soft = |(solids, stiffness): &([usize; 2], f64)| {
        // What rests on the longer side is as high as the shorter one.
        let pressure = |(shape, side): (&scene::Shape, f64)| {
            let own = shape.solid.map_or(f64::INFINITY, |solid| scene.solids[solid].density);
            shape.density.unwrap_or(own) * gravity * side
        };
        let shapes: Vec<(&scene::Shape, f64)> = scene.shorter_sides(*solids).collect();
        let others = |shape: &scene::Shape| {
            let other = |below: &scene::Shape| below.solid != shape.solid || below.body() != shape.body();
            shapes.iter().any(|(below, _)| other(below) && height(shape) > height(below))
        };
        let above = shapes.iter().copied().filter(|(shape, _)| is_free(shape) && others(shape));
        let (upper, weight) =
            above.map(|one| (one.0, pressure(one))).max_by(|one, other| one.1.total_cmp(&other.1))?;
        let smallest = scene.smallest_side(*solids);
        let depth = weight / stiffness;
        let [a, b] = solids.map(|k| &scene.solids[k].name);
        let (who, of) = match a == b {
            true => (format!("the bodies of `{a}`"), "stiffness, from the scene,"),
            false => (format!("`{a}` and `{b}`"), "`stiffness` of their [[contact]]"),
        };
        (depth > DEEP * smallest).then(|| {
            format!(
                "contact of {who} is soft: the weight of `{}` presses it {depth:.2e} m into what it lies on, and the \
                 smallest side is {smallest:.2e} m ({of} is {stiffness:.1e} Pa/m)",
                upper.name
            )
        })
    };
    contact.stiffness.iter().filter_map(soft).collect()
}
