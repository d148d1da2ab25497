//! Remarks on wave makers: whether their waves are resolved, stay before the paddle and arrive, and on a flap's hinge.

use super::shapes::length;
use super::water::DEPTH;
use halfstep_scene::{
    Block, Course, Geometry, Motion, Part, Phase, ProbeKind, Scene, Shape, WaveMaker, geometry,
};

/// Spacings below which a wave is lower than the unevenness of the particles' surface.
const LOWEST: f64 = 1.0;
/// Spacings of a wave that is well resolved.
const ENOUGH: f64 = 5.0;

/// Walls that make waves, with the boxes around them: wave makers, and boxes beside water that swing along x.
pub(super) fn paddles(scene: &Scene) -> Vec<(&Shape, Block)> {
    let walls = scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall);
    let around = walls.map(|wall| (wall, geometry::bounding_box(wall, scene)));
    around.filter(|(wall, around)| is_paddle(scene, wall, around)).collect()
}

fn is_paddle(scene: &Scene, wall: &Shape, around: &Block) -> bool {
    let Some(motion) = &wall.motion else { return false };
    let swings = matches!(motion, Motion::Oscillating { amplitude, .. } if amplitude[0] != 0.0);
    let is_box = matches!(wall.geometry.unmoved(), Geometry::Box(_));
    motion.makes().is_some()
        || swings
            && is_box
            && geometry::fluid_boxes(scene).iter().any(|water| super::meet(around, water, scene))
}

/// Wave makers whose waves are others than their author thinks.
pub(super) fn makers(scene: &Scene, all: &mut Vec<String>) {
    let Some(water) = geometry::around(geometry::fluid_boxes(scene)) else { return };
    for (paddle, around) in paddles(scene) {
        let Some((motion, makes)) = paddle.motion.as_ref().and_then(|m| Some((m, m.makes()?))) else {
            continue;
        };
        let remarks = [
            unresolved(scene, paddle, makes),
            flooded(scene, paddle, &around, (makes, &water)),
            averted(paddle, motion, &around, &water),
            hinge_beside(scene, paddle, motion, &around),
            floor_elsewhere(scene, paddle, motion, (makes, &water)),
            too_late(scene, paddle, motion, &around, makes),
        ];
        all.extend(remarks.into_iter().flatten());
    }
}

fn unresolved(scene: &Scene, paddle: &Shape, makes: &WaveMaker) -> Option<String> {
    (makes.height < LOWEST * scene.resolution).then(|| {
        format!(
            "`{}` makes waves {} m high, {:.1} spacings: the surface of the particles is as uneven (a resolution of {} \
             has {ENOUGH})",
            paddle.name,
            length(makes.height),
            makes.height / scene.resolution,
            length(makes.height / ENOUGH)
        )
    })
}

/// A paddle over which water flows, as it stands or as waves.
fn flooded(
    scene: &Scene,
    paddle: &Shape,
    around: &Block,
    (makes, water): (&WaveMaker, &Block),
) -> Option<String> {
    let (top, level) = (around.max[1], water.max[1]);
    // A solitary wave, which alone has an end, stands on the level as a whole.
    let crest = level + if makes.end.is_some() { makes.height } else { 0.5 * makes.height };
    let slack = 1e-6 * scene.resolution;
    let what = if top < level - slack {
        format!(
            "below the water's level, {} m: the water flows over it, and its waves are others",
            length(level)
        )
    } else if top < crest - slack {
        format!("below the crests of its waves, {} m: they flow over it, and others go on", length(crest))
    } else {
        return None;
    };
    Some(format!("`{}` ends at {} m, {what}", paddle.name, length(top)))
}

/// Swings that are a wave maker's: those of all parts whose course is a sine.
fn swings(motion: &Motion) -> impl Iterator<Item = (&Part, f64)> {
    motion.parts().iter().filter_map(|part| match part.course {
        Course::Sine { start, .. } => Some((part, start)),
        _ => None,
    })
}

/// A paddle with its back to all water.
fn averted(paddle: &Shape, motion: &Motion, around: &Block, water: &Block) -> Option<String> {
    // A flap that turns clockwise goes to the right.
    let sign = |part: &Part| (if part.angle == 0.0 { part.translation[0] } else { -part.angle }).signum();
    let mut signs = swings(motion).map(|(part, _)| sign(part));
    let first = signs.next()?;
    let behind = if first > 0.0 { water.max[0] <= around.max[0] } else { water.min[0] >= around.min[0] };
    let [toward, other] = if first > 0.0 { ["right", "left"] } else { ["left", "right"] };
    (behind && signs.all(|sign| sign == first)).then(|| {
        format!(
            "`{}` makes waves toward the {toward}, and all water is on its other side: they have troughs for crests \
             (toward = \"{other}\")",
            paddle.name
        )
    })
}

/// A flap that is hinged beside itself.
fn hinge_beside(scene: &Scene, paddle: &Shape, motion: &Motion, around: &Block) -> Option<String> {
    let pivot = motion.pivot()?;
    let apart = (around.min[0] - pivot[0]).max(pivot[0] - around.max[0]);
    // A hinge may stand before or behind its flap by as much as that is thick.
    let most = (around.max[0] - around.min[0]).max(2.0 * scene.resolution);
    (apart > most).then(|| {
        format!(
            "the pivot of the flap `{}`, [{}, {}], lies {} m beside it: it goes up and down, and does not swing over \
             its foot",
            paddle.name,
            length(pivot[0]),
            length(pivot[1]),
            length(apart)
        )
    })
}

/// A flap whose hinge counts from another floor than the water's.
fn floor_elsewhere(
    scene: &Scene,
    paddle: &Shape,
    motion: &Motion,
    (makes, water): (&WaveMaker, &Block),
) -> Option<String> {
    let pivot = motion.pivot()?;
    let bottom = water.min[1];
    ((makes.floor - bottom).abs() > DEPTH * makes.depth + 0.5 * scene.resolution).then(|| {
        format!(
            "the flap `{}` swings as if its hinge were {} m above a floor at {} m, and the water's is at {} m (floor = \
             {})",
            paddle.name,
            length(pivot[1] - makes.floor),
            length(makes.floor),
            length(bottom),
            length(bottom)
        )
    })
}

/// Waves that come to no probe and to no solid before the run ends.
fn too_late(
    scene: &Scene,
    paddle: &Shape,
    motion: &Motion,
    around: &Block,
    makes: &WaveMaker,
) -> Option<String> {
    if makes.end.is_some_and(|end| end > scene.end_time) {
        // That is remarked on as such.
        return None;
    }
    let (name, way) = targets(scene)
        .into_iter()
        .map(|(name, places)| (name, apart(around, places)))
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    let arrival = start(motion) + way / longest(scene, makes);
    (arrival > scene.end_time).then(|| {
        format!(
            "the waves of `{}` come to no probe and no solid: the nearest, `{name}`, is {} m away, where the longest \
             waves are after {} s, and the run ends at {} s",
            paddle.name,
            length(way),
            length(arrival),
            scene.end_time
        )
    })
}

/// Metrics whose window ends before any wave can have come to their probe, in water that nothing else moves.
pub(super) fn windows(scene: &Scene, all: &mut Vec<String>) {
    let moves = scene.shapes.iter().filter_map(|shape| Some((shape, shape.motion.as_ref()?)));
    if scene.frame.is_some() || !moves.clone().all(|(_, motion)| motion.makes().is_some()) {
        return;
    }
    for metric in &scene.metrics {
        let Some((to, (name, _))) = metric.to.zip(metric.probe.rsplit_once('.')) else { continue };
        let Some(probe) = scene.probes.iter().find(|probe| probe.name == name) else { continue };
        let arrival = |(shape, motion): (&Shape, &Motion)| {
            let around = geometry::bounding_box(shape, scene);
            let nearest = of_probe(scene, &probe.kind).into_iter().map(|places| apart(&around, places));
            Some(start(motion) + nearest.reduce(f64::min)? / longest(scene, motion.makes()?))
        };
        let Some(arrival) = moves.clone().filter_map(arrival).reduce(f64::min) else { continue };
        if to < arrival {
            all.push(format!(
                "the metric `{}` looks until {to} s, and no wave comes to `{name}` before {} s, when the longest ones \
                 do",
                metric.name,
                length(arrival)
            ));
        }
    }
}

/// When a wave maker begins, s.
fn start(motion: &Motion) -> f64 {
    let start = swings(motion).map(|(_, start)| start).fold(f64::INFINITY, f64::min);
    if start.is_finite() { start } else { 0.0 }
}

/// Speed of the longest waves, m/s: nothing on water is faster.
fn longest(scene: &Scene, makes: &WaveMaker) -> f64 {
    (scene.gravity[1].abs() * (makes.depth + makes.height)).sqrt()
}

/// How far an extent along x lies beside a box, m.
fn apart(around: &Block, [low, high]: [f64; 2]) -> f64 {
    (low - around.max[0]).max(around.min[0] - high).max(0.0)
}

/// Extents along x of what a probe measures, m.
fn of_probe(scene: &Scene, kind: &ProbeKind) -> Vec<[f64; 2]> {
    match kind {
        ProbeKind::WaterLevel { x } => x.iter().map(|&x| [x, x]).collect(),
        ProbeKind::Pressure { at, .. } | ProbeKind::Velocity { at } => vec![[at[0], at[0]]],
        ProbeKind::Flux { from, to } => vec![[from[0].min(to[0]), from[0].max(to[0])]],
        ProbeKind::Force { shape: Some(index), .. } => vec![of_shape(scene, &scene.shapes[*index])],
        _ => Vec::new(),
    }
}

fn of_shape(scene: &Scene, shape: &Shape) -> [f64; 2] {
    let around = geometry::bounding_box(shape, scene);
    [around.min[0], around.max[0]]
}

/// What waves are to come to, with its extent along x, m.
fn targets(scene: &Scene) -> Vec<(&str, [f64; 2])> {
    let probes = scene
        .probes
        .iter()
        .flat_map(|probe| of_probe(scene, &probe.kind).into_iter().map(|x| (probe.name.as_str(), x)));
    let solids = scene.shapes.iter().filter(|shape| shape.phase == Phase::Solid);
    probes.chain(solids.map(|shape| (shape.name.as_str(), of_shape(scene, shape)))).collect()
}
