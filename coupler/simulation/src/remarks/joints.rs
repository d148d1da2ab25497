//! Remarks on joints: angles in degrees, springs that are far from their rest, what joints hold altogether.

use super::rigid::Mass;
use super::shapes::length;
use halfstep_scene::geometry::{self, Layout};
use halfstep_scene::{
    Block, BodyQuantity, Geometry, Joint, JointKind, Phase, ProbeKind, RigidKeys, Scene, Shape,
};
use std::f64::consts::TAU;

/// A whole number of these, degrees, is hardly one of radians.
const ROUND: f64 = 5.0;
/// Degrees in a turn.
const TURN: f64 = 360.0;
/// Force of a spring at the start, over the body's weight, from which on it is remarked: moorings pull with a few.
const PULLS: f64 = 20.0;
/// Length over thickness from which on a body is a flap and no float on an arm.
const FLAP: f64 = 3.0;
/// Distance of a hinge from a flap over the flap's length, and of any hinge from its body over that.
const FAR: f64 = 0.5;
const ANYWHERE: f64 = 10.0;

/// A rigid solid with its keys.
fn rigid(scene: &Scene) -> impl Iterator<Item = (usize, &RigidKeys)> {
    scene.solids.iter().enumerate().filter_map(|(k, solid)| Some((k, solid.rigid()?)))
}

/// Shapes of a body.
fn shapes<'s>(scene: &'s Scene, solid: usize, body: &'s str) -> impl Iterator<Item = &'s Shape> + Clone {
    scene.shapes.iter().filter(move |shape| shape.solid == Some(solid) && shape.body() == body)
}

/// A joint keeps the bodies of two shapes together.
pub(super) fn tie(scene: &Scene, a: &Shape, b: &Shape) -> bool {
    let of = |joint: &Joint| {
        let ends = [joint.body.as_str(), joint.with.as_str()];
        joint.holds() && (ends == [a.body(), b.body()] || ends == [b.body(), a.body()])
    };
    a.solid == b.solid && rigid(scene).any(|(k, keys)| a.solid == Some(k) && keys.joints.iter().any(of))
}

/// What a joint ties its body to keeps its place.
fn is_grounded(scene: &Scene, joint: &Joint) -> bool {
    let rests = |s: &Shape| s.phase == Phase::Wall && s.name == joint.with && s.motion.is_none();
    joint.with.is_empty() || scene.shapes.iter().any(rests)
}

/// An angle in radians that is one in degrees.
fn in_degrees(angle: f64) -> bool {
    let round = angle != 0.0 && (angle / ROUND).fract() == 0.0;
    angle.abs() <= TURN && (round || angle.abs() > 1.001 * TAU)
}

/// Stops and rests of hinges in degrees.
pub(super) fn angles(scene: &Scene, all: &mut Vec<String>) {
    let hinge = |joint: &&Joint| matches!(joint.kind, JointKind::Hinge { .. });
    for joint in rigid(scene).flat_map(|(_, keys)| &keys.joints).filter(hinge) {
        let name = &joint.name;
        if let Some([least, largest]) = joint.limits.filter(|limits| limits.iter().any(|x| in_degrees(*x))) {
            all.push(format!(
                "limits = [{least}, {largest}] of the hinge `{name}` are in radians, {:.0} to {:.0} degrees: [{}, {}] \
                 if degrees are meant",
                least.to_degrees(),
                largest.to_degrees(),
                length(least.to_radians()),
                length(largest.to_radians())
            ));
        }
        let round = (joint.rest / ROUND).fract() == 0.0;
        // A spring that is wound up for several turns may be meant.
        if round && in_degrees(joint.rest) && joint.stiffness > 0.0 {
            all.push(format!(
                "rest = {} of the hinge `{name}` is in radians, {:.0} degrees: {} if degrees are meant",
                joint.rest,
                joint.rest.to_degrees(),
                length(joint.rest.to_radians())
            ));
        }
    }
}

/// Springs that begin far from where they rest.
pub(super) fn springs<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let gravity = scene.gravity_magnitude();
    for (solid, keys) in rigid(scene) {
        for joint in &keys.joints {
            let JointKind::Spring { at, to } = joint.kind else { continue };
            let long = (0..3).map(|d| (to[d] - at[d]).powi(2)).sum::<f64>().sqrt();
            let force = joint.stiffness * (long - joint.rest).abs();
            let said = keys.bodies.iter().find(|body| body.name == joint.body).and_then(|body| body.mass);
            let mass = said.or_else(|| Mass::of(scene, layout, solid, &joint.body).map(|shapes| shapes.mass));
            let Some(weight) = mass.map(|mass| mass * gravity).filter(|weight| *weight > 0.0) else {
                continue;
            };
            if force > PULLS * weight {
                all.push(format!(
                    "the spring `{}` begins {} m long and rests at {} m: it {} `{}` with {:.0} times its weight at the \
                     start (without `rest` it rests as it begins)",
                    joint.name,
                    length(long),
                    length(joint.rest),
                    if long > joint.rest { "pulls" } else { "pushes" },
                    joint.body,
                    force / weight
                ));
            }
        }
    }
}

/// Angles and rates of bodies that a joint does not let turn.
pub(super) fn still(scene: &Scene, all: &mut Vec<String>) {
    for probe in &scene.probes {
        let ProbeKind::Body { body, quantity: BodyQuantity::Angle | BodyQuantity::AngularVelocity } =
            &probe.kind
        else {
            continue;
        };
        let keys = probe.solid.and_then(|solid| scene.solids[solid].rigid());
        let keeps = |joint: &&Joint| {
            let kind = matches!(joint.kind, JointKind::Fixed | JointKind::Rail { turns: false, .. });
            kind && joint.body == *body && is_grounded(scene, joint)
        };
        if let Some(joint) = keys.and_then(|keys| keys.joints.iter().find(keeps)) {
            all.push(format!(
                "the {} of the probe `{}` is 0 throughout: the joint `{}` does not let `{body}` turn (`turns = true` \
                 at a rail does)",
                probe.kind.name(),
                probe.name,
                joint.name
            ));
        }
    }
}

/// Velocities at the start that a joint takes away.
pub(super) fn starts<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (solid, keys) in rigid(scene) {
        for joint in keys.joints.iter().filter(|joint| is_grounded(scene, joint)) {
            let (name, body) = (&joint.name, &joint.body);
            let velocities = || shapes(scene, solid, body).map(|shape| shape.velocity);
            let moves = velocities().any(|v| v != [0.0; 3]);
            let said = keys.bodies.iter().find(|said| said.name == *body);
            let turns = said.is_some_and(|said| said.angular_velocity != [0.0; 3]);
            let lost = match joint.kind {
                JointKind::Fixed if moves || turns => "the joint holds it",
                JointKind::Rail { turns: false, .. } if turns => {
                    "the rail does not let it turn (`turns = true` does)"
                }
                JointKind::Rail { axis, .. } if moves && velocities().all(|v| is_across(&v, &axis)) => {
                    "it is across the rail"
                }
                JointKind::Hinge { at, .. }
                    if moves && !turns && D == 2 && {
                        let center = || Mass::of(scene, layout, solid, body).map(|mass| mass.center());
                        let center = said.and_then(|said| said.center).or_else(center);
                        center.is_some_and(|center| along_arm(scene, (solid, body), &center, &at))
                    } =>
                {
                    "it is along the arm"
                }
                _ => continue,
            };
            let what = if turns && !moves { "angular velocity" } else { "velocity" };
            all.push(format!("the {what} that `{body}` begins with is lost at the joint `{name}`: {lost}"));
        }
    }
}

fn is_across(v: &[f64; 3], axis: &[f64; 3]) -> bool {
    let size = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    (0..3).map(|d| v[d] * axis[d]).sum::<f64>().abs() <= 1e-9 * size
}

/// All shapes of a body begin with one velocity, from a point toward the body's centre or back.
fn along_arm(scene: &Scene, (solid, body): (usize, &str), center: &[f64; 3], at: &[f64; 3]) -> bool {
    let arm = [0, 1].map(|d| center[d] - at[d]);
    let across = [-arm[1], arm[0], 0.0];
    across != [0.0; 3] && shapes(scene, solid, body).all(|shape| is_across(&shape.velocity, &across))
}

/// Keys of joints and bodies that do nothing.
pub(super) fn idle(scene: &Scene, all: &mut Vec<String>) {
    for (solid, keys) in rigid(scene) {
        let hinges = keys.joints.iter().filter(|joint| !matches!(joint.kind, JointKind::Spring { .. }));
        for joint in hinges.filter(|joint| joint.rest != 0.0 && joint.stiffness == 0.0) {
            all.push(format!(
                "rest = {} of the joint `{}` does nothing: it has no `stiffness`",
                joint.rest, joint.name
            ));
        }
        for said in keys.bodies.iter().filter(|said| said.angular_velocity != [0.0; 3]) {
            if let Some(shape) = shapes(scene, solid, &said.name).find(|shape| shape.motion.is_some()) {
                all.push(format!(
                    "the angular velocity of the body `{}` does nothing: the `motion` of `{}` says how it moves",
                    said.name, shape.name
                ));
            }
        }
    }
}

/// Two joints of one body that leave no way together, in the plane.
pub(super) fn locks(scene: &Scene, all: &mut Vec<String>) {
    if scene.dimension != 2 {
        return;
    }
    for (_, keys) in rigid(scene) {
        let grounded = || keys.joints.iter().filter(|joint| is_grounded(scene, joint));
        for (k, a) in grounded().enumerate() {
            if let Some(b) = grounded().skip(k + 1).find(|b| b.body == a.body && lock(a, b)) {
                all.push(format!(
                    "`{}` cannot move: the joints `{}` and `{}` leave no way together (kind = \"fixed\" holds it \
                     alone)",
                    a.body, a.name, b.name
                ));
            }
        }
    }
}

fn lock(a: &Joint, b: &Joint) -> bool {
    use JointKind::{Hinge, Rail};
    match (a.kind, b.kind) {
        (Hinge { at, .. }, Hinge { at: other, .. }) => at != other,
        (Hinge { .. }, Rail { turns, .. }) | (Rail { turns, .. }, Hinge { .. }) => !turns,
        (Rail { axis, turns: false, .. }, Rail { axis: other, turns: false, .. }) => {
            (axis[0] * other[1] - axis[1] * other[0]).abs() > 1e-9
        }
        _ => false,
    }
}

/// Bodies whose hinge is far from them, or whose rail is somewhere else.
pub(super) fn far(scene: &Scene, all: &mut Vec<String>) {
    for (solid, keys) in rigid(scene) {
        for joint in keys.joints.iter().filter(|joint| is_grounded(scene, joint)) {
            let (JointKind::Hinge { at, .. } | JointKind::Rail { at, .. }) = joint.kind else { continue };
            let boxes = shapes(scene, solid, &joint.body).map(|shape| geometry::bounding_box(shape, scene));
            let Some(around) = geometry::around(boxes) else { continue };
            let [thin, long] = sides(&around, scene.dimension);
            let away = geometry::distance(&Geometry::Box(around), &at);
            let (kind, does) = match joint.kind {
                JointKind::Hinge { .. } => ("hinge", "swings about it on an arm that is not there"),
                _ => ("rail", "is held at the end of an arm that is not there"),
            };
            let is_flap = kind == "hinge" && long > FLAP * thin && away > FAR * long;
            if is_flap || away > ANYWHERE * long {
                all.push(format!(
                    "the {kind} `{}` is {} m away from `{}`, which is {} m long: it {does} (`at` is in the scene's \
                     coordinates)",
                    joint.name,
                    length(away),
                    joint.body,
                    length(long)
                ));
            }
        }
    }
}

/// Hinges and rails at a shape as it would be without what turns and shifts it: that does not take them along.
pub(super) fn left_behind(scene: &Scene, all: &mut Vec<String>) {
    for (solid, keys) in rigid(scene) {
        for joint in &keys.joints {
            let (JointKind::Hinge { at, .. } | JointKind::Rail { at, .. }) = joint.kind else { continue };
            let reach = 0.5 * scene.resolution;
            let near = |geometry: &Geometry| geometry::distance(geometry, &at) <= reach;
            let own: Vec<&Shape> = shapes(scene, solid, &joint.body).collect();
            let was = own.iter().find(|shape| match &shape.geometry {
                Geometry::Moved(moved) => near(&moved.geometry),
                _ => false,
            });
            if let (Some(shape), false) = (was, own.iter().any(|shape| near(&shape.geometry))) {
                all.push(format!(
                    "the joint `{}` is where `{}` would be without `rotate` and `translate`, which do not take its \
                     `at` along: it is {} m beside it",
                    joint.name,
                    shape.name,
                    length(own.iter().map(|s| geometry::distance(&s.geometry, &at)).fold(f64::INFINITY, f64::min))
                ));
            }
        }
    }
}

/// The shortest and the longest side of a box.
fn sides(block: &Block, dimension: usize) -> [f64; 2] {
    let sides = (0..dimension).map(|d| block.max[d] - block.min[d]);
    sides.fold([f64::INFINITY, 0.0], |[low, high], side| [low.min(side), high.max(side)])
}
