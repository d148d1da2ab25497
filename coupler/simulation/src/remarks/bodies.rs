//! Remarks on bodies: what holds them, what they stand on, what they touch.

use super::joints;
use super::meet;
use super::reached::by_place;
use super::shapes::length;
use halfstep_scene::geometry::Layout;
use halfstep_scene::{
    Body, EffectName, Geometry, Lattice, Phase, Scene, Shape, SolidModelName, Switch, Void, geometry,
};
use std::collections::BTreeSet;

/// Most bodies that are listed.
pub(crate) const MOST_LISTED: usize = 8;

/// Bodies that no clamp holds, where walls do not stop them.
pub(super) fn free(scene: &Scene, bodies: &[Body], all: &mut Vec<String>) {
    let walls = || scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall);
    if walls().next().is_none() {
        falling(scene, bodies, all);
        return;
    }
    for body in bodies.iter().filter(|body| !body.held) {
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
            let held = if on_spring(scene, body) { "a spring alone" } else { "no clamp" };
            let (are, them) = if through.len() == 1 { ("does", "it") } else { ("do", "them") };
            say(format!(
                "{name} is held by {held}, and {} {are} not stop it (contact is false): it goes through {them}",
                through.join(" and ")
            ));
        }
    }
}

/// Bodies on which gravity alone acts: all of them fall as they are, and nothing bends.
fn falling(scene: &Scene, bodies: &[Body], all: &mut Vec<String>) {
    let size = scene.gravity_magnitude();
    if size == 0.0 || scene.fluid.is_some() {
        return;
    }
    let held = |body: &Body| body.held || on_spring(scene, body);
    let thrown = |body: &Body| body.shapes.iter().any(|&k| scene.shapes[k].velocity != [0.0; 3]);
    // On what is held others may fall, and what has a velocity is thrown.
    let Some(first) = bodies.first().filter(|_| !bodies.iter().any(|body| held(body) || thrown(body))) else {
        return;
    };
    let rigid = |body: &Body| {
        let solid = scene.shapes[body.shapes[0]].solid;
        solid.is_some_and(|k| scene.solids[k].model.name() == SolidModelName::Rigid)
    };
    let (what, is, it) = match bodies.len() {
        1 => (names(scene, first), "is", "it falls"),
        n => (format!("{} and {} more of the bodies", names(scene, first), n - 1), "are", "they fall"),
    };
    let (as_it_is, remedy) = match bodies.iter().all(rigid) {
        true => ("", "`joints` and walls hold rigid bodies"),
        false => (", without bending", "a box of `clamp` holds what is in it"),
    };
    all.push(format!(
        "{what} {is} held by nothing, and the scene has no wall: {it} by {} m until {} s under gravity{as_it_is} \
         ({remedy})",
        length(0.5 * size * scene.end_time.powi(2)),
        scene.end_time
    ));
}

/// Copies and pieces of a shape that nothing holds, beside others that a clamp does.
pub(super) fn held_in_part(scene: &Scene, bodies: &[Body], all: &mut Vec<String>) {
    for (index, shape) in scene.shapes.iter().enumerate() {
        let own = || bodies.iter().filter(|body| body.shapes.contains(&index));
        let free: Vec<&Body> = own().filter(|body| !body.held).collect();
        let pieces = own().count();
        if free.is_empty() || free.len() == pieces {
            continue;
        }
        let (is, it, them) =
            if free.len() == 1 { ("is", "it is", "it") } else { ("are", "they are", "them") };
        let particles: usize = free.iter().map(|body| body.particles).sum();
        all.push(match &shape.geometry {
            Geometry::Moved(moved) if moved.count as usize == pieces => format!(
                "{} of the {pieces} copies of `{}` {is} free: `repeat` does not take the clamp's box along (`clamp = \
                 [{{ .. }}, {{ .. }}]`, a box at each copy, holds {them})",
                free.len(),
                shape.name
            ),
            _ => format!(
                "`{}` is {pieces} pieces, and no clamp reaches {} of them, {particles} particles: {it} free (one more \
                 box of `clamp` there holds {them})",
                shape.name,
                free.len()
            ),
        });
    }
}

/// A spring joint ties a rigid body, which stays free.
pub(super) fn on_spring(scene: &Scene, body: &Body) -> bool {
    body.shapes.iter().any(|&k| {
        let shape = &scene.shapes[k];
        let keys = shape.solid.and_then(|k| scene.solids[k].rigid());
        keys.is_some_and(|keys| keys.joints.iter().any(|j| j.body == shape.body() || j.with == shape.body()))
    })
}

/// Shapes that name one body and are several: too far from each other.
pub(super) fn parted(scene: &Scene, bodies: &[Body], all: &mut Vec<String>) {
    let mut told: Vec<&str> = Vec::new();
    let named = |shape: usize| Some(scene.shapes[shape].body.as_str()).filter(|name| !name.is_empty());
    for body in bodies {
        let Some(name) = body.shapes.iter().find_map(|&shape| named(shape)) else { continue };
        let of_name = |other: &&Body| other.shapes.iter().any(|&shape| named(shape) == Some(name));
        let count = bodies.iter().filter(of_name).count();
        if count > 1 && !told.contains(&name) {
            told.push(name);
            let cracked = scene.shapes.iter().any(|shape| shape.body == name && shape.crack.is_some());
            let why = if cracked { "lie apart, or a `crack` parts them" } else { "lie apart" };
            all.push(format!(
                "the shapes of body `{name}` {why}: it is {count} bodies, and nothing holds them together"
            ));
        }
    }
}

/// Contacts of rigid bodies are with whole shapes.
pub(super) fn voids<const D: usize>(scene: &Scene, all: &mut Vec<String>) {
    let rigid = |k: usize| scene.solids[k].model.name() == SolidModelName::Rigid;
    if scene.voids.is_empty() || !(0..scene.solids.len()).any(rigid) {
        return;
    }
    let touched = |shape: &Shape| match shape.solid {
        Some(solid) => rigid(solid),
        None => shape.phase == Phase::Wall && shape.contact,
    };
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| touched(shape)) {
        let around = |shape: &Shape| geometry::bounding_box(shape, scene);
        let cuts = |void: &&Void| {
            let as_shape = Shape { geometry: void.geometry.clone(), ..shape.clone() };
            let close = index >= void.before && meet(&around(shape), &around(&as_shape), scene);
            // What is within a tank's cavity takes nothing of its walls.
            close && geometry::void_meets::<D>(scene, void, index)
        };
        if let Some(void) = scene.voids.iter().find(cuts) {
            all.push(format!(
                "`{}` may take a part of `{}`, and rigid bodies touch the whole of that shape: they know no voids",
                void.name, shape.name
            ));
        }
    }
}

/// Voids that take no place, because what they are in stands before them in the file.
pub(super) fn idle_voids<const D: usize>(scene: &Scene, all: &mut Vec<String>) {
    for void in &scene.voids {
        let meets = |index: &usize| geometry::void_meets::<D>(scene, void, *index);
        if (void.before..scene.shapes.len()).any(|index| meets(&index)) {
            continue;
        }
        let why = match (0..void.before.min(scene.shapes.len())).find(meets) {
            Some(index) => format!(
                "`{}`, in which it lies, stands before it, and a void takes places of what comes after it",
                scene.shapes[index].name
            ),
            None => "no shape has a place in it".to_owned(),
        };
        all.push(format!("the void `{}` takes nothing: {why}", void.name));
    }
}

/// Bodies of which nothing can move.
pub(super) fn held_altogether(scene: &Scene, bodies: &[Body], all: &mut Vec<String>) {
    let moves = |body: &Body| {
        body.shapes.iter().any(|&k| {
            let shape = &scene.shapes[k];
            shape.motion.is_some() || !shape.clamp_with.is_empty()
        })
    };
    for body in bodies.iter().filter(|body| body.clamped == body.particles && !moves(body)) {
        all.push(format!(
            "all {} particles of {} are clamped: it neither moves nor bends (a wall that does not is cheaper)",
            body.particles,
            names(scene, body)
        ));
    }
}

/// Loads and cracks of shapes that are repeated, which are in one place.
pub(super) fn not_repeated<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (index, shape) in scene.shapes.iter().enumerate() {
        let Geometry::Moved(moved) = &shape.geometry else { continue };
        if moved.count < 2 {
            continue;
        }
        if shape.load.is_some() {
            let loaded = layout.solid.iter().filter(|p| p.body as usize == index && p.is_in_load(scene));
            let copies: BTreeSet<u32> = loaded.map(|p| p.copy).collect();
            if copies.len() < moved.count as usize {
                all.push(format!(
                    "the load of `{}` acts on {} of its {} copies: `repeat` does not take its box along",
                    shape.name,
                    copies.len(),
                    moved.count
                ));
            }
        }
        if shape.crack.is_some() {
            all.push(format!(
                "the crack of `{}` is in one place: `repeat` does not take it along to its {} copies",
                shape.name, moved.count
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
        if joints::tie(scene, a, b) {
            continue;
        }
        let said = match [a, b].map(|shape| !shape.body.is_empty()) {
            // Whoever names both knows.
            [true, true] => continue,
            [true, false] => format!(" (`body` stands at `{}` alone)", a.name),
            [false, true] => format!(" (`body` stands at `{}` alone)", b.name),
            [false, false] => String::new(),
        };
        all.push(format!(
            "`{}` and `{}` touch and are bodies of their own{said}, which repel each other and may part (the same \
             `body` at both makes them one piece)",
            a.name, b.name
        ));
    }
    let hypoelastic = |body: &&Body| {
        let model = body.shapes.first().and_then(|&k| scene.solids.get(scene.shapes[k].solid?));
        model.is_some_and(|solid| solid.model.name() == SolidModelName::Hypoelastic)
    };
    for body in bodies.iter().filter(hypoelastic) {
        let names_body = |&&k: &&usize| !scene.shapes[k].body.is_empty();
        let named =
            body.shapes.iter().find(names_body).map_or(String::new(), |_| ", whatever `body` says".into());
        // What the nodal lattice leaves between them is another remark.
        let hold = match scene.numerics.lattice {
            Lattice::Centred => ": they hold together as the material of each does",
            Lattice::Nodal => "",
        };
        if body.shapes.len() > 1 {
            all.push(format!(
                "{} touch and are one continuum of the hypoelastic model{named}{hold}",
                names(scene, body)
            ));
        }
    }
}

/// Bodies in the fluid that stand on a wall: no fluid fits below them that could lift them.
pub(super) fn standing<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    bodies: &[Body],
    all: &mut Vec<String>,
) {
    let size = scene.gravity_magnitude();
    let Some(fluid) = scene.fluid.as_ref().filter(|_| size > 0.0) else { return };
    let down = |x: &[f64; D]| (0..D).map(|d| x[d] * scene.gravity[d]).sum::<f64>() / size;
    let beside = 1.5 * scene.resolution;
    let water = by_place(beside, layout.fluid.iter().map(|p| p.position));
    let is_wet = |x: &[f64; D]| water.around(x).any(|p| super::near(p, x, beside));
    for body in bodies.iter().filter(|body| !body.held) {
        let Some(solid) = scene.shapes[body.shapes[0]].solid else { continue };
        let (light, rigid) =
            (scene.solids[solid].density < fluid.density, scene.solids[solid].rigid().is_some());
        let own = |p: &&geometry::SolidPoint<D>| body.shapes.contains(&(p.body as usize));
        let lowest =
            layout.solid.iter().filter(own).map(|p| down(&p.position)).fold(f64::NEG_INFINITY, f64::max);
        let reach = 1.1 * scene.interface_spacing(solid);
        let foot: Vec<_> =
            layout.solid.iter().filter(own).filter(|p| down(&p.position) > lowest - 0.5 * reach).collect();
        let below = |wall: &&geometry::WallPoint<D>| {
            foot.iter().any(|p| {
                let apart: [f64; D] = std::array::from_fn(|d| wall.position[d] - p.position[d]);
                apart.iter().map(|x| x * x).sum::<f64>() < reach * reach && down(&apart) > 0.5 * reach
            })
        };
        let Some(wall) = layout.wall.iter().find(below) else { continue };
        let (name, wall) = (names(scene, body), &scene.shapes[wall.shape as usize].name);
        if light {
            all.push(format!(
                "{name} is lighter than the fluid and stands on `{wall}`: no fluid fits below it, so the fluid presses \
                 it down and does not lift it"
            ));
        } else if rigid && layout.solid.iter().filter(own).any(|p| is_wet(&p.position)) {
            all.push(format!(
                "{name} stands on `{wall}` in the fluid: no fluid fits below it, so it has no uplift, and its whole \
                 weight rests on the wall"
            ));
        }
    }
}

/// The bodies in one line.
pub(crate) fn listed(scene: &Scene, bodies: &[Body]) -> String {
    let one = |body: &Body| {
        let held = match body.clamped {
            0 if body.held && body.shapes.iter().any(|&k| scene.shapes[k].motion.is_some()) => {
                "moves as prescribed".to_owned()
            }
            0 if body.held => "held by joints".to_owned(),
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

pub(super) fn names(scene: &Scene, body: &Body) -> String {
    let names: Vec<String> = body.shapes.iter().map(|&k| format!("`{}`", scene.shapes[k].name)).collect();
    names.join(" and ")
}
