//! Remarks on fluid inside of solids and walls: a hull that an author thinks dry begins full, because a box of fluid
//! leaves out only the places that the hull itself has.

use super::{meet, near};
use halfstep_scene::geometry::{self, Cells, FluidPoint, Layout, Moved, Polygon, SolidPoint};
use halfstep_scene::{Geometry, Phase, Scene, Shape};
use halfstep_wire::wide;
use std::collections::BTreeSet;

/// Fluid of a shape that solids part from the rest of it, where it touches no wall.
pub(super) fn enclosed<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let reach = 1.1 * scene.resolution;
    let boxes = |phase: Phase| {
        let own = scene.shapes.iter().filter(move |shape| shape.phase == phase);
        own.map(|shape| geometry::bounding_box(shape, scene))
    };
    if !boxes(Phase::Solid).any(|solid| boxes(Phase::Fluid).any(|fluid| meet(&solid, &fluid, scene))) {
        return;
    }
    let mut walls = Cells::new(2.0 * reach);
    layout.wall.iter().for_each(|wall| walls.add(&wall.position, wall.position));
    let at_wall = |p: &FluidPoint<D>| walls.around(&p.position).any(|w| near(w, &p.position, 2.0 * reach));
    let parts = connected(&layout.fluid, reach);
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| shape.phase == Phase::Fluid) {
        let of_shape = |part: &&Vec<usize>| part.iter().any(|&k| layout.fluid[k].shape as usize == index);
        if parts.iter().filter(of_shape).count() < 2 {
            continue;
        }
        let own = |k: &usize| layout.fluid[*k].shape as usize == index;
        for part in parts.iter().filter(of_shape).filter(|part| part.iter().all(own)) {
            if part.iter().any(|&k| at_wall(&layout.fluid[k])) {
                continue;
            }
            let mut inside = Cells::new(2.0 * reach);
            part.iter().for_each(|&k| inside.add(&layout.fluid[k].position, layout.fluid[k].position));
            let beside: Vec<&SolidPoint<D>> = layout
                .solid
                .iter()
                .filter(|p| inside.around(&p.position).any(|x| near(x, &p.position, 2.0 * reach)))
                .collect();
            // Drops beside a plate have it on one side.
            let on = |side: f64| {
                beside.iter().any(|p| {
                    inside.around(&p.position).any(|x| {
                        let level = (1..D).all(|d| (x[d] - p.position[d]).abs() < 0.6 * scene.resolution);
                        let apart = (p.position[0] - x[0]) * side;
                        level && 0.0 < apart && apart < 2.0 * reach
                    })
                })
            };
            if !(on(-1.0) && on(1.0)) {
                continue;
            }
            let names: BTreeSet<&str> =
                beside.iter().map(|p| scene.shapes[p.body as usize].name.as_str()).collect();
            let names: Vec<String> = names.into_iter().map(|name| format!("`{name}`")).collect();
            all.push(format!(
                "{} of the particles of `{}` begin inside of {}, parted from the rest (a void listed before `{}` \
                 leaves them out)",
                part.len(),
                shape.name,
                names.join(" and "),
                shape.name
            ));
        }
    }
}

/// Fluid in the hollow of a wall, a ring or a polygon with a hole, that is of a shape which is outside of it, too.
pub(super) fn in_walls<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let hollow = |shape: &&Shape| match shape.geometry.unmoved() {
        Geometry::Ring { .. } => true,
        Geometry::Polygon(polygon) => !polygon.holes.is_empty(),
        _ => false,
    };
    for wall in scene.shapes.iter().filter(|s| s.phase == Phase::Wall).filter(hollow) {
        let filled = without_holes(&wall.geometry);
        let inside = |p: &FluidPoint<D>| geometry::distance(&filled, &wide(p.position)) == 0.0;
        for (index, fluid) in scene.shapes.iter().enumerate().filter(|(_, s)| s.phase == Phase::Fluid) {
            let own = layout.fluid.iter().filter(|p| p.shape as usize == index);
            let (count, within) =
                own.fold((0, 0), |(all, within), p| (all + 1, within + u32::from(inside(p))));
            if 0 < within && within < count {
                all.push(format!(
                    "{within} of the particles of `{}` begin in the hollow of `{}`, and what they do to it is in its \
                     forces (a void listed before `{}` leaves them out)",
                    fluid.name, wall.name, fluid.name
                ));
            }
        }
    }
}

/// What fills the hollows, too.
fn without_holes(geometry: &Geometry) -> Geometry {
    match geometry {
        Geometry::Ring { center, outer, .. } => Geometry::Disc { center: *center, radius: *outer },
        Geometry::Polygon(polygon) => {
            Geometry::Polygon(Polygon { outline: polygon.outline.clone(), holes: Vec::new() })
        }
        Geometry::Moved(moved) => {
            Geometry::Moved(Moved { geometry: Box::new(without_holes(&moved.geometry)), ..moved.clone() })
        }
        other => other.clone(),
    }
}

/// Sets of particles that are joined by steps shorter than `reach`.
fn connected<const D: usize>(fluid: &[FluidPoint<D>], reach: f64) -> Vec<Vec<usize>> {
    let mut cells = Cells::new(reach);
    fluid.iter().enumerate().for_each(|(k, p)| cells.add(&p.position, k));
    let mut seen = vec![false; fluid.len()];
    let mut parts = Vec::new();
    for first in 0..fluid.len() {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let mut part = vec![first];
        let mut next = 0;
        while let Some(&k) = part.get(next) {
            next += 1;
            let at = &fluid[k].position;
            for &other in cells.around(at) {
                if near(&fluid[other].position, at, reach) && !std::mem::replace(&mut seen[other], true) {
                    part.push(other);
                }
            }
        }
        parts.push(part);
    }
    parts
}
