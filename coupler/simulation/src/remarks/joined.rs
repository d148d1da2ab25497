//! Every rigid body with its mass, and every joint as it begins: what it leaves free, between which stops, and with
//! which force its spring begins.

use super::rigid::Mass;
use super::shapes::{length, place};
use halfstep_scene::geometry::Layout;
use halfstep_scene::{Joint, JointKind, Scene};
use serde::Serialize;
use std::fmt;

/// A rigid body as it begins.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Massive {
    /// Its name.
    pub(crate) body: String,
    /// kg (2D: kg/m).
    mass: f64,
    /// m.
    center: [f64; 3],
    /// About the axis through the centre along z, kg m² (2D: kg m).
    inertia: f64,
    /// Which of them the scene says, and do not follow from the shapes.
    given: Vec<&'static str>,
}

impl fmt::Display for Massive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mass, center, inertia, given, .. } = self;
        let [mass, inertia] = [mass, inertia].map(|x| length(*x));
        write!(f, "rigid, {mass} kg/m with its centre at {}, inertia {inertia} kg m", place(&center[..2]))?;
        if given.is_empty() { Ok(()) } else { write!(f, " ({} as the scene says)", given.join(", ")) }
    }
}

/// The rigid bodies of a scene in the plane.
pub(crate) fn massive<const D: usize>(scene: &Scene, layout: &Layout<D>) -> Vec<Massive> {
    let mut all: Vec<Massive> = Vec::new();
    let rigid = scene.solids.iter().enumerate().filter_map(|(k, solid)| Some((k, solid.rigid()?)));
    for (solid, keys) in rigid.filter(|_| D == 2) {
        for shape in scene.shapes.iter().filter(|shape| shape.solid == Some(solid)) {
            let body = shape.body();
            if all.iter().any(|other| other.body == body) {
                continue;
            }
            let Some(shapes) = Mass::of(scene, layout, solid, body) else { continue };
            let said = keys.bodies.iter().find(|said| said.name == body);
            let (mass, center, inertia) = (
                said.and_then(|said| said.mass),
                said.and_then(|said| said.center),
                said.and_then(|said| said.inertia),
            );
            let given =
                [(mass.is_some(), "mass"), (center.is_some(), "centre"), (inertia.is_some(), "inertia")];
            let whole = mass.unwrap_or(shapes.mass);
            let at = center.unwrap_or_else(|| shapes.center());
            let own = shapes.inertia(2, &shapes.center()) * whole / shapes.mass;
            all.push(Massive {
                body: body.to_owned(),
                mass: whole,
                center: at,
                inertia: inertia.map_or(own, |inertia| inertia[2]),
                given: given.into_iter().filter(|(said, _)| *said).map(|(_, what)| what).collect(),
            });
        }
    }
    all
}

/// A joint as it begins.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Joined {
    /// Its name.
    pub(crate) name: String,
    kind: &'static str,
    body: String,
    with: String,
    /// What it leaves free and between which stops, in words.
    free: String,
    /// What its spring does at the start.
    #[serde(skip_serializing_if = "Option::is_none")]
    begins: Option<String>,
}

impl fmt::Display for Joined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, body, with, free, begins, .. } = self;
        write!(f, "{kind} of {body} to {with}{free}")?;
        begins.iter().try_for_each(|begins| write!(f, "; begins {begins}"))
    }
}

/// The joints of a scene, in its order.
pub(crate) fn joined(scene: &Scene) -> Vec<Joined> {
    let keys = scene.solids.iter().filter_map(|solid| solid.rigid());
    keys.flat_map(|keys| &keys.joints).map(|joint| of_joint(joint, scene.dimension)).collect()
}

fn of_joint(joint: &Joint, dimension: usize) -> Joined {
    let at = |x: &[f64; 3]| place(&x[..dimension]);
    let rad = |angle: f64| format!("{} rad ({:.0} degrees)", length(angle), angle.to_degrees());
    let metres = |way: f64| format!("{} m", length(way));
    let stops = |as_text: &dyn Fn(f64) -> String| match joint.limits {
        Some([least, largest]) => format!(", stops at {} and {}", as_text(least), as_text(largest)),
        None => String::new(),
    };
    let per = joint.stiffness;
    let (kind, free, begins) = match &joint.kind {
        JointKind::Fixed => ("fixed joint", String::new(), None),
        JointKind::Hinge { at: point, .. } => {
            let free = format!(", turns about {}, counter-clockwise positive{}", at(point), stops(&rad));
            let moment = per * joint.rest;
            ("hinge", free, (moment != 0.0).then(|| format!("with a moment of {} N m/m", length(moment))))
        }
        JointKind::Rail { at: point, axis, turns } => {
            let turns = if *turns { ", and turns" } else { "" };
            let free = format!(" along {} through {}{turns}{}", at(axis), at(point), stops(&metres));
            let force = per * joint.rest;
            ("rail", free, (force != 0.0).then(|| format!("with a force of {} N/m along it", length(force))))
        }
        JointKind::Spring { at: point, to } => {
            let long = (0..3).map(|d| (to[d] - point[d]).powi(2)).sum::<f64>().sqrt();
            let force = per * (long - joint.rest);
            let does = if force < 0.0 { "pushing" } else { "pulling" };
            let free = format!(
                " from {} to {}, {} m long, rests at {} m and pushes where it is shorter",
                at(point),
                at(to),
                length(long),
                length(joint.rest)
            );
            ("spring", free, (force != 0.0).then(|| format!("{does} with {} N/m", length(force.abs()))))
        }
    };
    let with = if joint.with.is_empty() { "space".to_owned() } else { joint.with.clone() };
    Joined { name: joint.name.clone(), kind, body: joint.body.clone(), with, free, begins }
}
