//! Remarks on tanks that move: clamps, joints and walls in them that do not go along.

use super::shapes::{Placed, length, place};
use super::water::INSTANTS;
use super::{meet, near, overlap};
use halfstep_scene::geometry::{self, Cells, Layout, SolidPoint};
use halfstep_scene::{Block, Body, Geometry, Joint, JointKind, Motion, Phase, ProbeKind, Scene, Shape};
use halfstep_wire::{narrow, wide};

/// Part of the box around a polygon from which on it is no basin.
const FILLS: f64 = 0.8;

/// Walls that move, with the boxes around them.
fn moving(scene: &Scene) -> Vec<(&Shape, Block)> {
    let walls = scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall);
    let around = walls.map(|wall| (wall, geometry::bounding_box(wall, scene)));
    around.filter(|(wall, around)| wall.motion.as_ref().is_some_and(|m| m.fastest(around) > 0.0)).collect()
}

/// Those of them that are around fluid.
pub(super) fn tanks(scene: &Scene) -> Vec<(&Shape, Block)> {
    // What has no inside of its own holds no fluid: a polygon that fills its box, for one.
    let hollow = |wall: &Shape, around: &Block| match wall.geometry.unmoved() {
        Geometry::Box(_) | Geometry::Disc { .. } => false,
        Geometry::Polygon(polygon) => {
            let sides = |block: &Block| (block.max[0] - block.min[0]) * (block.max[1] - block.min[1]);
            polygon.area() < FILLS * sides(around)
        }
        _ => true,
    };
    moving(scene)
        .into_iter()
        .filter(|(wall, around)| hollow(wall, around) && holds_fluid(scene, around))
        .collect()
}

/// Whether the middle of a shape of fluid lies in a box.
fn holds_fluid(scene: &Scene, around: &Block) -> bool {
    geometry::fluid_boxes(scene).iter().any(|b| {
        (0..scene.dimension).all(|a| {
            let middle = 0.5 * (b.min[a] + b.max[a]);
            around.min[a] < middle && middle < around.max[a]
        })
    })
}

/// Walls that stay beside several that move together around fluid: a tank of boxes, one of which was forgotten.
pub(super) fn forgotten(scene: &Scene, all: &mut Vec<String>) {
    let moving = moving(scene);
    let mut told: Vec<&str> = Vec::new();
    for (first, _) in &moving {
        let group: Vec<_> = moving.iter().filter(|(wall, _)| wall.motion == first.motion).collect();
        let Some(around) = geometry::around(group.iter().map(|(_, around)| *around)) else { continue };
        if group.len() < 2 || group[0].0.name != first.name || !holds_fluid(scene, &around) {
            continue;
        }
        let stays = scene.shapes.iter().filter(|s| s.phase == Phase::Wall && s.motion.is_none());
        for wall in stays {
            let block = geometry::bounding_box(wall, scene);
            let touched = group.iter().find(|(_, of)| meet(of, &block, scene));
            if let (Some((beside, _)), false) = (touched, told.contains(&wall.name.as_str())) {
                told.push(&wall.name);
                all.push(format!(
                    "`{}` stays where it is, and `{}`, which it touches, moves with {} more wall{} around the fluid: \
                     fluid gets out between them (the same `motion` at all takes it along)",
                    wall.name,
                    beside.name,
                    group.len() - 1,
                    if group.len() == 2 { "" } else { "s" }
                ));
            }
        }
    }
}

/// Walls that touch around the fluid and move otherwise than each other: sides of a tank of boxes.
pub(super) fn apart(scene: &Scene, all: &mut Vec<String>) {
    let moving = moving(scene);
    for (k, (one, of_one)) in moving.iter().enumerate() {
        for (other, of_other) in &moving[k + 1..] {
            let both = geometry::around([*of_one, *of_other]);
            let around_fluid = both.is_some_and(|both| holds_fluid(scene, &both));
            let is_tank = |wall: &Shape| matches!(wall.geometry.unmoved(), Geometry::Tank { .. });
            // What stands in a tank is another remark.
            if is_tank(one) || is_tank(other) || one.motion == other.motion {
                continue;
            }
            if around_fluid && meet(of_one, of_other, scene) {
                all.push(format!(
                    "`{}` and `{}` touch, and move otherwise than each other beside the fluid: it gets out between \
                     them (one tank has the same `motion` at all its walls, the `pivot` included)",
                    one.name, other.name
                ));
            }
        }
    }
}

/// How the wall of a name moves.
fn motion_of<'s>(scene: &'s Scene, wall: &str) -> Option<&'s Motion> {
    scene.shapes.iter().find(|shape| shape.name == wall)?.motion.as_ref()
}

/// Clamps that keep their place, or go another way, while a wall around them moves.
pub(super) fn clamps(scene: &Scene, all: &mut Vec<String>) {
    let walls = moving(scene);
    for shape in &scene.shapes {
        for (wall, around) in &walls {
            let motion = |k: usize| match shape.clamp_with.get(k).and_then(Option::as_ref) {
                Some(with) => motion_of(scene, with),
                None => shape.motion.as_ref(),
            };
            let astray = (0..shape.clamp.len())
                .find(|&k| motion(k) != wall.motion.as_ref() && meet(&shape.clamp[k], around, scene));
            let Some(clamp) = astray else { continue };
            let how = match motion(clamp) {
                None => "the clamp stays where it is",
                Some(_) => "the clamp moves otherwise",
            };
            all.push(format!(
                "the clamp of `{}` stands in `{}`, which moves: {how} (`with = \"{}\"` at the clamp takes it along)",
                shape.name, wall.name, wall.name
            ));
        }
    }
}

/// Clamps that move out of a wall that stays.
pub(super) fn clamps_that_leave<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, s)| s.phase == Phase::Solid) {
        let own = layout.solid.iter().filter(|p| p.body as usize == index && p.clamped);
        let moves = |p: &&SolidPoint<D>| {
            let at = Block { min: wide(p.position), max: wide(p.position) };
            geometry::clamp_motion(scene, p).is_some_and(|motion| {
                let swept = motion.swept(&at, scene.end_time);
                (0..D).any(|a| swept.max[a] - swept.min[a] > 0.5 * scene.resolution)
            })
        };
        let reach = 1.2 * scene.resolution;
        let mut clamped = Cells::new(reach);
        own.filter(moves).for_each(|p| clamped.add(&p.position, p.position));
        for (wall, of_wall) in scene.shapes.iter().enumerate() {
            if of_wall.phase != Phase::Wall || of_wall.motion.is_some() {
                continue;
            }
            // A wall on both sides of the clamp: it stands in it.
            let beside = |axis: usize, side: f64| {
                layout.wall.iter().filter(|w| w.shape as usize == wall).any(|w| {
                    clamped.around(&w.position).any(|p| {
                        let apart = (w.position[axis] - p[axis]) * side;
                        let near =
                            |a: usize| a == axis || (w.position[a] - p[a]).abs() < 0.6 * scene.resolution;
                        0.0 < apart && apart < reach && (0..D).all(near)
                    })
                })
            };
            if (0..D).any(|axis| beside(axis, -1.0) && beside(axis, 1.0)) {
                all.push(format!(
                    "the clamp of `{}` moves, and `{}`, in which it stands, does not: it leaves a gap in the wall (the \
                     same `motion` at the wall takes it along)",
                    shape.name, of_wall.name
                ));
            }
        }
    }
}

/// Displacements of what is clamped in a wall that moves, with none of the clamp to take off.
pub(super) fn displacements(scene: &Scene, all: &mut Vec<String>) {
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, s)| s.phase == Phase::Solid) {
        let moving = |wall: &&Shape| {
            wall.motion.is_some() && shape.clamp_with.iter().flatten().any(|w| *w == wall.name)
        };
        let Some(wall) = scene.shapes.iter().find(moving) else { continue };
        let places = scene.probes.iter().filter_map(|probe| match probe.kind {
            ProbeKind::Displacement { at } if probe.solid == shape.solid => Some((probe.name.as_str(), at)),
            _ => None,
        });
        let own: Vec<_> =
            places.filter(|(_, at)| geometry::nearest_solid(&scene.shapes, at) == Some(index)).collect();
        let reach = scene.spacing(shape);
        let in_clamp = |at: &[f64; 3]| shape.clamp.iter().any(|clamp| geometry::holds(clamp, at, reach));
        if let Some((first, at)) = own.first().filter(|_| !own.iter().any(|(_, at)| in_clamp(at))) {
            let way = way(scene, wall, *at);
            all.push(format!(
                "`{first}` measures displacements in space, and the clamp of `{}` moves with `{}`: its way is in \
                 it, up to {} m at that place (one at the clamp shows how much)",
                shape.name,
                wall.name,
                length(way)
            ));
        }
    }
}

/// How far a wall takes a place along at the most, m.
fn way(scene: &Scene, wall: &Shape, at: [f64; 3]) -> f64 {
    let Some(motion) = &wall.motion else { return 0.0 };
    let places = (0..=INSTANTS).map(|k| motion.at(scene.end_time * k as f64 / INSTANTS as f64));
    let ways = places.map(|place| place.displacement_of(at).map(|x| x * x).iter().sum::<f64>());
    ways.fold(0.0, f64::max).sqrt()
}

/// Joints in tanks that move, tied to what does not go along.
pub(super) fn joints(scene: &Scene, all: &mut Vec<String>) {
    let tanks = tanks(scene);
    if tanks.is_empty() {
        return;
    }
    for (solid, keys) in scene.solids.iter().enumerate().filter_map(|(k, solid)| Some((k, solid.rigid()?))) {
        let is_body =
            |name: &str| scene.shapes.iter().any(|shape| shape.solid == Some(solid) && shape.body() == name);
        for joint in keys.joints.iter().filter(|joint| !is_body(&joint.with)) {
            let motion = motion_of(scene, &joint.with);
            let astray = tanks
                .iter()
                .find(|(tank, around)| motion != tank.motion.as_ref() && holds(scene, solid, joint, around));
            let Some((tank, _)) = astray else { continue };
            let tied = match joint.with.as_str() {
                "" => "space".to_owned(),
                wall => format!("`{wall}`"),
            };
            all.push(format!(
                "joint `{}` ties `{}` to {tied} inside of `{}`, which moves: the joint does not go along (`with = \
                 \"{}\"` takes it along)",
                joint.name, joint.body, tank.name, tank.name
            ));
        }
    }
}

/// Whether a joint's point, or one that is fixed altogether, lies in a box.
fn holds(scene: &Scene, solid: usize, joint: &Joint, around: &Block) -> bool {
    match joint.kind {
        JointKind::Hinge { at, .. } | JointKind::Rail { at, .. } | JointKind::Spring { to: at, .. } => {
            meet(&Block { min: at, max: at }, around, scene)
        }
        JointKind::Fixed => {
            let own = scene.shapes.iter().filter(|s| s.solid == Some(solid) && s.body() == joint.body);
            own.map(|shape| geometry::bounding_box(shape, scene)).any(|b| meet(&b, around, scene))
        }
    }
}

/// Walls in tanks that move, which stay or go another way.
pub(super) fn walls(scene: &Scene, all: &mut Vec<String>) {
    for (tank, around) in tanks(scene) {
        for wall in scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall) {
            if wall.motion == tank.motion || !overlap(&geometry::bounding_box(wall, scene), &around, scene) {
                continue;
            }
            let how = if wall.motion.is_some() { "moves otherwise" } else { "stays where it is" };
            all.push(format!(
                "`{}` stands in `{}`, which moves, and {how} (the same `motion` at both takes it along)",
                wall.name, tank.name
            ));
        }
    }
}

/// Gauges of pressure that are fixed in space beside what moves: bodies, walls that are no tanks, plates that bend.
pub(super) fn gauges_at_bodies<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    bodies: &[Body],
    placed: &[Placed],
    all: &mut Vec<String>,
) {
    let gauges = scene.probes.iter().filter_map(|probe| match &probe.kind {
        ProbeKind::Pressure { at, shape: None, .. } => Some((&probe.name, at)),
        _ => None,
    });
    let gauges: Vec<_> = gauges.collect();
    if gauges.is_empty() {
        return;
    }
    let reach = 1.5 * scene.resolution;
    let tanks = tanks(scene);
    let is_tank = |shape: &Shape| tanks.iter().any(|(tank, _)| tank.name == shape.name);
    let ways: Vec<Option<String>> = (0..scene.shapes.len())
        .map(|k| if is_tank(&scene.shapes[k]) { None } else { way_of(scene, bodies, placed, k) })
        .collect();
    let mut moving = Cells::new(reach);
    let solids = layout.solid.iter().filter(|p| !p.clamped).map(|p| (p.position, p.body as usize));
    let walls = layout.wall.iter().map(|p| (p.position, p.shape as usize));
    let own = solids.chain(walls).filter(|(_, shape)| ways[*shape].is_some());
    own.for_each(|(x, shape)| moving.add(&x, (x, shape)));
    for (gauge, at) in gauges {
        let here: [f64; D] = narrow(*at);
        let Some((_, shape)) = moving.around(&here).find(|(x, _)| near(x, &here, reach)) else { continue };
        let name = &scene.shapes[*shape].name;
        all.push(format!(
            "the probe `{gauge}` at {} is fixed in space beside `{name}`, which {} (`shape = \"{name}\"` takes it along)",
            place(&at[..D]),
            ways[*shape].as_deref().unwrap_or_default()
        ));
    }
}

/// How a shape moves away from a place beside it; `None` where it stays.
fn way_of(scene: &Scene, bodies: &[Body], placed: &[Placed], index: usize) -> Option<String> {
    let shape = &scene.shapes[index];
    let is_free = || bodies.iter().any(|body| !body.held && body.shapes.contains(&index));
    let rigid = shape.solid.and_then(|solid| scene.solids[solid].rigid());
    let fixed = |joint: &Joint| joint.body == shape.body() && matches!(joint.kind, JointKind::Fixed);
    match (shape.phase, rigid) {
        (Phase::Fluid, _) => None,
        (Phase::Wall, _) => shape.motion.as_ref().map(|_| "moves".to_owned()),
        (Phase::Solid, _) if is_free() => Some("moves freely".to_owned()),
        (Phase::Solid, Some(keys)) if keys.joints.iter().any(fixed) => None,
        (Phase::Solid, Some(_)) => Some("moves".to_owned()),
        (Phase::Solid, None) => {
            let bends = placed[index].bends.as_ref().filter(|bends| bends.way[0] > 0.5 * scene.resolution)?;
            Some(format!("bends by about {} m under {}", length(bends.way[0]), bends.under))
        }
    }
}

/// Probes of the fluid that keep their place in a tank that moves.
pub(super) fn probes(scene: &Scene, all: &mut Vec<String>) {
    for (tank, around) in tanks(scene) {
        let Some(motion) = &tank.motion else { continue };
        let middle = |axis: usize| 0.5 * (around.min[axis] + around.max[axis]);
        let mut ride: Vec<(&str, f64)> = Vec::new();
        let mut stay = ride.clone();
        for probe in &scene.probes {
            let (kept, places) = match &probe.kind {
                ProbeKind::Pressure { at, to, shape: None } => {
                    (&mut ride, [Some(*at), *to].into_iter().flatten().collect())
                }
                ProbeKind::Velocity { at } => (&mut stay, vec![*at]),
                ProbeKind::WaterLevel { x } => {
                    (&mut stay, x.iter().map(|&x| [x, middle(1), middle(2)]).collect::<Vec<_>>())
                }
                ProbeKind::Flux { from, to } => (&mut stay, vec![*from, *to]),
                ProbeKind::Front => (&mut stay, vec![[middle(0), middle(1), middle(2)]]),
                _ => continue,
            };
            let inside = |at: &&[f64; 3]| meet(&Block { min: **at, max: **at }, &around, scene);
            let most = places.iter().filter(inside).map(|at| way(scene, tank, *at)).fold(0.0, f64::max);
            if most > 0.5 * scene.resolution {
                kept.push((&probe.name, most));
            }
        }
        let turns = motion.pivot().is_some();
        for (probes, rides) in [(ride, true), (stay, false)] {
            let Some(most) = probes.iter().map(|(_, way)| *way).reduce(f64::max) else { continue };
            let names: Vec<String> = probes.iter().map(|(name, _)| format!("`{name}`")).collect();
            let (the, them) = match names.len() {
                1 => ("the probe", "it"),
                _ => ("the probes", "them"),
            };
            let remedy = match rides {
                true => format!("`shape = \"{}\"` takes {them} along", tank.name),
                false if turns => "levels, velocities and fluxes do not turn with a tank".to_owned(),
                false => format!("seen from a `[frame]` with this motion the tank rests around {them}"),
            };
            all.push(format!(
                "{the} {} {} fixed in space inside of `{}`, which moves by up to {} m there: the tank slides by under \
                 {them} ({remedy})",
                names.join(" and "),
                if names.len() == 1 { "is" } else { "are" },
                tank.name,
                length(most)
            ));
        }
    }
}
