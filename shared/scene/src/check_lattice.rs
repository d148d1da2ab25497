//! Finite elements are the cells of particles: these must lie on one lattice along the axes.

use super::document::Node;
use super::error::Report;
use super::geometry::{self, Cells};
use super::{Scene, SolidModelName, dispatch};

/// How far, in spacings, a particle may lie beside its place on the lattice: rounding only.
const ROUNDING: f64 = 1e-3;

/// Notes where particles of a body of finite elements lie between the places of a lattice.
pub(super) fn check_lattice(scene: &Scene, root: &Node, report: &Report) {
    let elements = |k: usize| scene.solids[k].model.name() == SolidModelName::FiniteElement;
    if !(0..scene.solids.len()).any(elements) {
        return;
    }
    let odd = dispatch!(scene.dimension, D => odd_neighbours::<D>(scene, &elements)).flatten();
    let Some([one, other]) = odd else { return };
    let needs = "finite elements need the particles of a body on one lattice along the axes";
    let turned = [one, other].into_iter().find(|k| scene.shapes[*k].lattice_angle != 0.0);
    if let Some(turned) = turned {
        let key = format!("shape.{}.lattice_angle", scene.shapes[turned].name);
        return report.among(root, &key, &[], format!("turns its particles, and {needs}"));
    }
    let key = format!("shape.{}", scene.shapes[one].name);
    let whose = match one == other {
        true => "its particles are turned".to_owned(),
        false => format!("those of `{}` do not fit to it", scene.shapes[other].name),
    };
    report.place(&key, root.origin_of(&key), format!("{needs}: {whose}"));
}

/// The shapes of two particles that are neighbours, but not by whole steps.
fn odd_neighbours<const D: usize>(scene: &Scene, elements: &impl Fn(usize) -> bool) -> Option<[usize; 2]> {
    let layout = geometry::layout::<D>(scene);
    let pieces = geometry::pieces(scene, &layout);
    let of_elements = layout
        .solid
        .iter()
        .zip(pieces)
        .filter(|(point, _)| scene.shapes[point.body as usize].solid.is_some_and(elements));
    let widest = (0..scene.solids.len()).map(|k| scene.solid_spacing(k)).fold(0.0, f64::max);
    // What is within the support of 2 x 0.75 spacings is one piece.
    let mut cells: Cells<([f64; D], u32, u32), D> = Cells::new(1.5 * widest);
    for (point, piece) in of_elements {
        let spacing = scene.spacing(&scene.shapes[point.body as usize]);
        for (other, of, shape) in cells.around(&point.position) {
            let apart: [f64; D] = std::array::from_fn(|d| (point.position[d] - other[d]).abs() / spacing);
            let near = apart.iter().map(|step| step * step).sum::<f64>() < 2.25;
            let whole = apart.iter().all(|step| *step < ROUNDING || (*step - 1.0).abs() < ROUNDING);
            if *of == piece && near && !whole {
                return Some([point.body as usize, *shape as usize]);
            }
        }
        cells.add(&point.position, (point.position, piece, point.body));
    }
    None
}
