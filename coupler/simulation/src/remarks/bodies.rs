//! Remarks on bodies: what holds them, what they stand on, what they touch.

use halfstep_scene::geometry::Layout;
use halfstep_scene::{Block, Body, EffectName, Phase, Scene, Shape, SolidModelName, Switch, geometry};

/// Most bodies that are listed.
const MOST_LISTED: usize = 8;

/// Clamps keep their place while a wall around them moves away.
pub(super) fn clamps(scene: &Scene, all: &mut Vec<String>) {
    let moving = |wall: &&Shape| wall.phase == Phase::Wall && wall.motion.is_some_and(|m| m.fastest() > 0.0);
    for shape in &scene.shapes {
        for wall in scene.shapes.iter().filter(moving) {
            let around = geometry::bounding_box(wall, scene);
            let stays =
                |k: usize| shape.clamp_with.get(k).is_none_or(|with| with.as_ref() != Some(&wall.name));
            if (0..shape.clamp.len()).any(|k| stays(k) && meet(&shape.clamp[k], &around, scene)) {
                all.push(format!(
                    "the clamp of `{}` stands in `{}`, which moves: the clamp stays where it is (`with = \"{}\"` at the \
                     clamp takes it along)",
                    shape.name, wall.name, wall.name
                ));
            }
        }
    }
}

fn meet(a: &Block, b: &Block, scene: &Scene) -> bool {
    (0..scene.dimension).all(|d| a.min[d] <= b.max[d] && b.min[d] <= a.max[d])
}

/// Bodies that no clamp holds, where walls do not stop them.
pub(super) fn free(scene: &Scene, bodies: &[Body], all: &mut Vec<String>) {
    let walls = || scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall);
    if walls().next().is_none() {
        return;
    }
    for body in bodies.iter().filter(|body| body.clamped == 0) {
        let name = names(scene, body);
        let mut say = |text: String| {
            // Copies of one shape say the same.
            if !all.contains(&text) {
                all.push(text);
            }
        };
        if scene.switch(EffectName::WallContact) == Switch::Off {
            say(format!("{name} is held by no clamp, and effects.wall-contact is \"off\": no wall stops it"));
            continue;
        }
        let through: Vec<String> =
            walls().filter(|wall| !wall.contact).map(|wall| format!("`{}`", wall.name)).collect();
        if !through.is_empty() {
            let (are, them) = if through.len() == 1 { ("does", "it") } else { ("do", "them") };
            say(format!(
                "{name} is held by no clamp, and {} {are} not stop it (contact is false): it goes through {them}",
                through.join(" and ")
            ));
        }
    }
}

/// Shapes of one solid that touch: bodies of their own, or one continuum although they say otherwise.
pub(super) fn touching<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    bodies: &[Body],
    all: &mut Vec<String>,
) {
    for (a, b) in geometry::touching(scene, layout) {
        let (a, b) = (&scene.shapes[a], &scene.shapes[b]);
        if a.body.is_empty() && b.body.is_empty() {
            all.push(format!(
                "`{}` and `{}` touch and are bodies of their own, which repel each other and may part (the same \
                 `body` at both makes them one piece)",
                a.name, b.name
            ));
        }
    }
    let hypoelastic = |body: &&Body| {
        let model = body.shapes.first().and_then(|&k| scene.solids.get(scene.shapes[k].solid?));
        model.is_some_and(|solid| solid.model.name() == SolidModelName::Hypoelastic)
    };
    for body in bodies.iter().filter(hypoelastic) {
        let names_body = |&&k: &&usize| !scene.shapes[k].body.is_empty();
        let named =
            body.shapes.iter().find(names_body).map_or(String::new(), |_| ", whatever `body` says".into());
        if body.shapes.len() > 1 {
            all.push(format!(
                "{} touch and are one continuum of the hypoelastic model{named}: they never part",
                names(scene, body)
            ));
        }
    }
}

/// The bodies in one line.
pub(crate) fn listed(scene: &Scene, bodies: &[Body]) -> String {
    let one = |body: &Body| {
        let held = match body.clamped {
            0 => "free".to_owned(),
            n => format!("{n} clamped"),
        };
        format!("{}: {} particles, {held}", names(scene, body).replace('`', ""), body.particles)
    };
    let shown: Vec<String> = bodies.iter().take(MOST_LISTED).map(one).collect();
    let more = match bodies.len().saturating_sub(MOST_LISTED) {
        0 => String::new(),
        n => format!("; {n} more"),
    };
    format!("{}{more}", shown.join("; "))
}

fn names(scene: &Scene, body: &Body) -> String {
    let names: Vec<String> = body.shapes.iter().map(|&k| format!("`{}`", scene.shapes[k].name)).collect();
    names.join(" and ")
}
