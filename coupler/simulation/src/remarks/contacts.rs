//! Remarks on what touches: overlaps at the start, and pairs of solids of which the scene says nothing.

use super::shapes::length;
use super::{meet, near};
use halfstep_scene::geometry::{self, Cells, Layout, SolidPoint, Surface};
use halfstep_scene::{Block, Body, ContactKeys, Geometry, Phase, Scene, Shape, SolidModelName};
use std::collections::HashSet;

/// Distance of particles, over their spacing, at which their surfaces meet: a spacing, and what lattices are off.
const FACING: f64 = 1.25;
/// Part of the spacing that surfaces may lie in each other: of what touches by its outline, and by its particles, whose
/// rows lie as their lattices do.
const OVERLAP: [f64; 2] = [1e-3, 0.25];

/// Copies of a shape.
fn copies(shape: &Shape) -> Vec<Option<u32>> {
    match &shape.geometry {
        Geometry::Moved(moved) => moved.copies().map(Some).collect(),
        _ => vec![None],
    }
}

/// A copy of a shape that touches others: its outline's points and its surface.
struct Toucher<'a> {
    shape: &'a Shape,
    copy: Option<u32>,
    points: Vec<[f64; 2]>,
    /// The box around these; `None` of a shape without an outline.
    around: Option<Block>,
    surface: Surface,
}

impl Toucher<'_> {
    /// It may lie in another one: a tank's walls have no outer face.
    fn meets(&self, other: &Self, scene: &Scene) -> bool {
        let is_tank = |one: &Self| matches!(one.shape.geometry.unmoved(), Geometry::Tank { .. });
        let boxes = self.around.as_ref().zip(other.around.as_ref());
        is_tank(self) || is_tank(other) || boxes.is_some_and(|(own, its)| meet(own, its, scene))
    }

    /// How deep points of its outline are in another shape, m.
    fn depth_in(&self, other: &Self) -> f64 {
        let mut deepest = 0.0_f64;
        for point in &self.points {
            other.surface.nearest(*point, &mut |distance, _| deepest = deepest.max(-distance));
        }
        deepest
    }
}

/// Bodies, and solids of which two touch, that lie in each other or in walls at the start: contact throws them
/// apart, or begins there.
pub(super) fn overlaps<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    if scene.dimension != 2 || scene.solids.is_empty() {
        return;
    }
    // A copy that lies in another one has no particles, and is no body.
    let name = |index: u32| scene.shapes[index as usize].name.as_str();
    let with_particles: HashSet<(&str, u32)> = layout.solid.iter().map(|p| (name(p.body), p.copy)).collect();
    let is_there = |one: &Toucher<'_>| {
        let Toucher { shape, copy, .. } = one;
        shape.phase == Phase::Wall || with_particles.contains(&(&shape.name, copy.unwrap_or(0)))
    };
    let touches =
        |shape: &&Shape| shape.phase == Phase::Solid || (shape.phase == Phase::Wall && shape.contact);
    let touchers: Vec<Toucher<'_>> = scene
        .shapes
        .iter()
        .filter(touches)
        .flat_map(|shape| {
            copies(shape).into_iter().map(move |copy| {
                let surface = Surface::new(&shape.geometry, copy);
                let mut points = Vec::new();
                surface.outline(scene.spacing(shape), &mut |_, [from, _]| points.push(from));
                let place = |p: &[f64; 2]| [p[0], p[1], 0.0];
                let around = geometry::around(points.iter().map(|p| Block { min: place(p), max: place(p) }));
                Toucher { shape, copy, points, around, surface }
            })
        })
        .filter(is_there)
        .collect();
    let pairs = scene.contacts();
    let contact = |a: &Toucher<'_>, b: &Toucher<'_>| match (a.shape.solid, b.shape.solid) {
        (Some(k), Some(l)) if k != l => pairs.iter().any(|pair| pair.solids == [k.min(l), k.max(l)]),
        (Some(_), Some(_)) => {
            let one_body = a.shape.body() == b.shape.body() && {
                let named = !a.shape.body.is_empty() || !b.shape.body.is_empty();
                named || a.copy == b.copy
            };
            let one_continuum =
                a.shape.solid.is_some_and(|k| scene.solids[k].model.name() == SolidModelName::Hypoelastic);
            !one_continuum && !one_body && !tied(scene, a.shape, b.shape)
        }
        (Some(_), None) => scene.is_rigid(a.shape) && !tied(scene, a.shape, b.shape),
        (None, Some(_)) => scene.is_rigid(b.shape) && !tied(scene, b.shape, a.shape),
        (None, None) => false,
    };
    for (k, a) in touchers.iter().enumerate() {
        for b in touchers[k + 1..].iter().filter(|b| a.meets(b, scene) && contact(a, b)) {
            let depth = a.depth_in(b).max(b.depth_in(a));
            let by_outline = a.shape.solid != b.shape.solid
                || scene.is_rigid(a.shape)
                || a.shape.solid.is_some_and(|k| scene.leaves_bodies_to_coupler(k));
            if depth > OVERLAP[usize::from(!by_outline)] * scene.resolution {
                let text = in_each_other(scene, [a.shape, b.shape], depth, by_outline);
                if !all.contains(&text) {
                    all.push(text);
                }
            }
        }
    }
}

/// What is said of two shapes that lie so deep, m, in each other, and touch by their outlines or by their particles.
fn in_each_other(scene: &Scene, [a, b]: [&Shape; 2], depth: f64, by_outline: bool) -> String {
    let depth = length(depth);
    let (solid, wall) = if a.phase == Phase::Wall { (b, a) } else { (a, b) };
    let around = |shape: &Shape| geometry::bounding_box(shape, scene);
    if matches!(wall.geometry.unmoved(), Geometry::Tank { .. }) && !meet(&around(solid), &around(wall), scene)
    {
        return format!(
            "`{}` begins outside of `{}`, whose walls have no outer face for what touches them: contact throws it \
             {depth} m back through them (a tank of boxes or polygons has both faces)",
            solid.name, wall.name
        );
    }
    let what = match a.name == b.name {
        true => format!("copies of `{}`", a.name),
        false => format!("`{}` and `{}`", a.name, b.name),
    };
    let then = match by_outline {
        true => "contact throws them apart",
        false => "they push each other from there on, until they have parted",
    };
    format!("{what} lie {depth} m in each other at the start: {then}")
}

/// A joint ties two shapes' bodies, or a motion prescribes where one is beside a wall: they do not touch.
fn tied(scene: &Scene, a: &Shape, b: &Shape) -> bool {
    let Some(keys) = a.solid.and_then(|k| scene.solids[k].rigid()) else { return false };
    let names =
        |shape: &Shape| if shape.phase == Phase::Wall { shape.name.clone() } else { shape.body().to_owned() };
    let (a_name, b_name) = (names(a), names(b));
    let ties =
        |body: &str, with: &str| (body == a_name && with == b_name) || (body == b_name && with == a_name);
    let moved = |shape: &Shape| shape.motion.is_some() || shape.phase == Phase::Wall;
    (moved(a) && moved(b)) || keys.joints.iter().any(|joint| joint.holds() && ties(&joint.body, &joint.with))
}

/// How many of the bodies are of the solid of that index.
pub(crate) fn bodies_of(scene: &Scene, bodies: &[Body], solid: usize) -> usize {
    let is_of = |shape: &usize| scene.shapes[*shape].solid == Some(solid);
    bodies.iter().filter(|body| body.shapes.first().is_some_and(is_of)).count()
}

/// `contact` of a solid, where there is nothing that it speaks of.
pub(super) fn of_walls(scene: &Scene, bodies: &[Body], all: &mut Vec<String>) {
    for (k, solid) in scene.solids.iter().enumerate() {
        if solid.rigid().is_some() {
            let says = solid.contact().unwrap_or_default() != ContactKeys::default();
            let alone = bodies_of(scene, bodies, k) == 1;
            if says && alone && scene.walls_to_touch().next().is_none() {
                all.push(format!(
                    "the `contact` of `{}` changes nothing: it has one body, and no wall that may touch it (contact = \
                     true at a wall; by default walls stop only what neither a clamp nor a joint holds)",
                    solid.name
                ));
            }
            continue;
        }
        if !scene.leaves_walls_to_coupler(k) {
            continue;
        }
        let name = &solid.name;
        let why = match scene.leaves_bodies_to_coupler(k) {
            false => Some("a hypoelastic solid is one continuum"),
            true => (bodies_of(scene, bodies, k) == 1).then_some("it has one body"),
        };
        if let Some(why) = why.filter(|_| scene.walls_to_touch().next().is_none()) {
            all.push(format!(
                "the `contact` of `{name}` changes nothing: {why}, and there is no wall that may touch it (contact = \
                 true at a wall)"
            ));
        }
    }
}

/// Solids that break, and touch others with the surface that they began with.
pub(super) fn debris(scene: &Scene, all: &mut Vec<String>) {
    let breaks = |k: &usize| scene.fracture(*k).is_some();
    for contact in scene.contacts() {
        let broken: Vec<&str> =
            contact.solids.iter().filter(|k| breaks(k)).map(|&k| scene.solids[k].name.as_str()).collect();
        if broken.is_empty() {
            continue;
        }
        let [a, b] = contact.solids.map(|k| &scene.solids[k].name);
        all.push(format!(
            "`{a}` and `{b}` touch with the surfaces that they begin with: a piece that breaks off {} takes its part \
             along, and where cracks leave none, its particles are held one by one",
            broken.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(" or ")
        ));
    }
}

/// Two solids that begin face to face, of which no table speaks: nothing ties them, and in space nothing acts between
/// them.
pub(super) fn face_to_face<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let spacing = |p: &SolidPoint<D>| scene.spacing(&scene.shapes[p.body as usize]);
    let widest = layout.solid.iter().map(spacing).fold(0.0, f64::max);
    let mut cells: Cells<&SolidPoint<D>, D> = Cells::new(FACING * widest);
    layout.solid.iter().for_each(|p| cells.add(&p.position, p));
    let solid = |p: &SolidPoint<D>| scene.shapes[p.body as usize].solid;
    let mut told = HashSet::new();
    for p in &layout.solid {
        let facing = |q: &&&SolidPoint<D>| {
            solid(q) > solid(p) && near(&p.position, &q.position, FACING * 0.5 * (spacing(p) + spacing(q)))
        };
        for q in cells.around(&p.position).filter(facing) {
            let (Some(a), Some(b)) = (solid(p), solid(q)) else { continue };
            let said = scene.pair_contacts.iter().any(|pair| pair.solids == [a, b]);
            if said || !told.insert([a, b]) {
                continue;
            }
            let [a, b] = [p, q].map(|p| &scene.shapes[p.body as usize].name);
            let acts = match D {
                2 => "they push each other without friction and come apart freely",
                _ => "in space nothing acts between these, so that they go through each other",
            };
            all.push(format!(
                "`{a}` and `{b}` begin face to face and are of two solids: {acts} (shapes of one [[solid]] with the \
                 same `body` are one piece; [[contact]] says how two solids touch in the plane)"
            ));
        }
    }
}

/// Whether a third solid fills all that lies between the boxes of two at the start.
fn parted(scene: &Scene, [a, b]: [usize; 2]) -> bool {
    let around = |solid: usize| {
        let own = scene.shapes.iter().filter(move |shape| shape.solid == Some(solid));
        geometry::around(own.map(|shape| geometry::bounding_box(shape, scene)))
    };
    let (Some(one), Some(other)) = (around(a), around(b)) else { return false };
    let half = 0.5 * scene.resolution;
    let mut between = one;
    for k in 0..scene.dimension {
        let ends = [one.min[k].max(other.min[k]), one.max[k].min(other.max[k])];
        (between.min[k], between.max[k]) = (ends[0].min(ends[1]) + half, ends[0].max(ends[1]) - half);
    }
    let fills = |third: &Block| {
        (0..scene.dimension).all(|k| third.min[k] <= between.min[k] && between.max[k] <= third.max[k])
    };
    (0..scene.solids.len()).filter(|k| ![a, b].contains(k)).filter_map(around).any(|third| fills(&third))
}

/// Two solids touch as no table says, although their own bodies rub.
pub(super) fn unsaid(scene: &Scene, all: &mut Vec<String>) {
    let of_debris = |k: usize| scene.fracture(k).map_or(0.0, |keys| keys.friction);
    let friction = |k: usize| scene.solids[k].contact().map_or(0.0, |keys| keys.friction).max(of_debris(k));
    for contact in scene.contacts() {
        let said = scene.pair_contacts.iter().any(|other| other.solids == contact.solids);
        let [a, b] = contact.solids;
        if !said && friction(a).max(friction(b)) > 0.0 && !parted(scene, [a, b]) {
            let [a, b] = [a, b].map(|k| &scene.solids[k].name);
            all.push(format!(
                "`{a}` and `{b}` touch without friction: their own friction is about walls and bodies of one solid \
                 ([[contact]] with solids = [\"{a}\", \"{b}\"] says how the two touch)"
            ));
        }
    }
}

/// Stiffness of contact over that of a solid's smallest side from which on restitution hardly acts.
const SOFT: f64 = 0.3;

/// Restitutions of solids that are as soft as their contact: their own strain gives the speed back.
pub(super) fn soft_restitutions(scene: &Scene, all: &mut Vec<String>) {
    let walls = scene.walls_to_touch().next().is_some();
    let held = |&k: &usize| scene.leaves_bodies_to_coupler(k) || (walls && scene.leaves_walls_to_coupler(k));
    let own = (0..scene.solids.len()).filter(held).map(|k| scene.own_contact(k));
    for contact in own.chain(scene.contacts()).filter(|contact| contact.restitution > 0.0) {
        let stiffness = contact.stiffness.unwrap_or_else(|| scene.contact_stiffness(contact.solids));
        let over = |k: &usize| {
            let strains = scene.solids[*k].rigid().is_none();
            let side = scene.smallest_side([*k; 2]);
            strains.then(|| (stiffness * side / scene.solids[*k].youngs_modulus, *k))
        };
        let softest = contact.solids.iter().filter_map(over).max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((part, k)) = softest.filter(|(part, _)| *part > SOFT) else { continue };
        let cure = match contact.solids[0] == contact.solids[1] {
            true => "",
            false => " (a lower `stiffness` of their [[contact]] lets it act)",
        };
        all.push(format!(
            "a restitution of {} hardly acts on `{}`: contact is {part:.1} times as stiff as the solid over its \
             smallest side, so that its own strain takes up most of an impact and gives it back{cure}",
            contact.restitution, scene.solids[k].name
        ));
    }
}
