//! Remarks on where clamps hold a lattice.

use super::shapes::length;
use halfstep_scene::geometry::{Layout, Plate, SolidPoint};
use halfstep_scene::{Block, EffectName, Geometry, Lattice, Scene, Shape, SolidModelName, Switch};
use std::collections::BTreeMap;

/// Part of a spacing by which a face may miss the boundary between two rows.
const MISS: f64 = 0.05;

/// Faces of clamps that cut a row of particles: a clamped particle carries no stress in the half of its cell that the
/// clamp does not hold, a free one does so in the part that it holds.
pub(super) fn clamp_faces(scene: &Scene, all: &mut Vec<String>) {
    if scene.switch(EffectName::ClampFace) == Switch::Off {
        return;
    }
    // Turned rows are cut by every face.
    for shape in scene.shapes.iter().filter(|shape| shape.lattice_angle == 0.0) {
        let model = shape.solid.and_then(|k| scene.solids.get(k)).map(|solid| solid.model.name());
        let Geometry::Box(body) = &shape.geometry else { continue };
        let elements = model == Some(SolidModelName::FiniteElement);
        if !elements && model != Some(SolidModelName::TotalLagrangian) {
            continue;
        }
        for clamp in &shape.clamp {
            for axis in 0..scene.dimension {
                let inside = |face: &f64| *face > body.min[axis] && *face < body.max[axis];
                for face in [clamp.min[axis], clamp.max[axis]].into_iter().filter(inside) {
                    all.extend(cut(scene, shape, axis, body.min[axis], face, elements));
                }
            }
        }
    }
}

fn cut(scene: &Scene, shape: &Shape, axis: usize, first: f64, face: f64, elements: bool) -> Option<String> {
    let dx = scene.spacing(shape);
    // Boundaries between rows lie at whole numbers of spacings, `nodal` half a spacing beside.
    let shift = if scene.numerics.lattice == Lattice::Nodal { 0.5 } else { 0.0 };
    let rows = (face - first) / dx - shift;
    if (rows - rows.round()).abs() <= MISS {
        return None;
    }
    let at = |rows: f64| length(first + (rows + shift) * dx);
    let held = match elements {
        true => "its elements are held as a whole where their middle is in the clamp",
        false => "it is held more softly than there",
    };
    Some(format!(
        "a face of the clamp of `{}`, at {} = {} m, cuts a row of its particles: {held}. Between rows are {} and {} m",
        shape.name,
        ["x", "y", "z"][axis],
        length(face),
        at(rows.floor()),
        at(rows.ceil())
    ))
}

/// Clamps that hold a plate by a part of its section, across which it bends and turns where it should be held.
pub(super) fn sections<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| !shape.clamp.is_empty()) {
        let Geometry::Box(body) = shape.geometry.unmoved() else { continue };
        // What a clamp pushes by a motion of its own may be a part; blocks are held by their feet.
        if shape.motion.is_some() || Plate::<D>::of(scene, shape).is_none() {
            continue;
        }
        let worst = (0..shape.geometry.copies()).find_map(|copy| {
            let own = layout.solid.iter().filter(|p| p.body as usize == index && p.copy == copy);
            held_in_part(scene, shape, body, &own.collect::<Vec<_>>())
        });
        if let Some([held, across]) = worst {
            let remedy = match shape.geometry {
                Geometry::Moved(_) => "`translate`, `rotate` and `repeat` do not take the clamp's box along",
                _ => "a box over the whole section holds it",
            };
            all.push(format!(
                "the clamp of `{}` holds {held} of the {across} particles of a section, and no section as a whole: \
                 there the plate bends and turns about what is held ({remedy})",
                shape.name
            ));
        }
    }
}

/// Of the section of a plate of which a clamp holds most: the particles that it holds, and all; `None` where it holds
/// all of one, of a row along it, or of what its box cuts.
fn held_in_part<const D: usize>(
    scene: &Scene,
    shape: &Shape,
    body: &Block,
    own: &[&SolidPoint<D>],
) -> Option<[usize; 2]> {
    let dx = scene.spacing(shape);
    let reach = 1e-6 * dx;
    let holds = |clamp: &&Block| {
        let inside = |p: &&SolidPoint<D>| {
            (0..D).all(|a| clamp.min[a] - reach <= p.position[a] && p.position[a] <= clamp.max[a] + reach)
        };
        own.iter().copied().any(|p| inside(&p))
    };
    // Several are supports, as of a beam in bending.
    if shape.clamp.iter().filter(holds).count() != 1 {
        return None;
    }
    let held = || own.iter().filter(|p| p.clamped);
    let cut_whole = (0..D).any(|a| {
        let ends = held()
            .map(|p| p.position[a])
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        let beside = |p: &&&SolidPoint<D>| (ends[0] - reach..=ends[1] + reach).contains(&p.position[a]);
        own.iter().filter(beside).all(|p| p.clamped)
    });
    if cut_whole {
        return None;
    }
    // Where they are in the lattice, however it is turned.
    let place = |p: &SolidPoint<D>| match &shape.geometry {
        Geometry::Moved(moved) => moved.back(p.copy, p.position),
        _ => p.position,
    };
    let rows = |axis: usize| {
        let mut rows: BTreeMap<i64, [usize; 2]> = BTreeMap::new();
        for p in own {
            let row = rows.entry(((place(p)[axis] - body.min[axis]) / dx - 0.25).round() as i64).or_default();
            *row = [row[0] + usize::from(p.clamped), row[1] + 1];
        }
        rows
    };
    if (0..D).any(|axis| rows(axis).values().any(|[held, all]| held == all)) {
        return None;
    }
    let extent = |a: &usize| body.max[*a] - body.min[*a];
    let along = (0..D).max_by(|a, b| extent(a).total_cmp(&extent(b)))?;
    rows(along).into_values().max_by_key(|[held, _]| *held)
}
