//! Remarks on where clamps hold a lattice.

use super::shapes::length;
use halfstep_scene::{EffectName, Geometry, Lattice, Scene, Shape, SolidModelName, Switch};

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
