//! Remarks on the nodal lattice, which has no particles on a solid's surface: what a particle stands for ends half a
//! spacing from it.

use super::meet;
use super::shapes::{NOTABLE, Placed, length};
use halfstep_scene::geometry::{self, Cells, Layout};
use halfstep_scene::{Body, Geometry, Lattice, Phase, Scene, Shape, SolidModelName};

/// Whether a shape is a box of solid that lacks half a spacing at each side.
pub(super) fn lacks(scene: &Scene, shape: &Shape) -> bool {
    scene.numerics.lattice == Lattice::Nodal
        && shape.phase == Phase::Solid
        && shape.lattice_angle == 0.0
        && matches!(shape.geometry.unmoved(), Geometry::Box(_))
}

/// Boxes of solids that have less mass than their size asks for.
pub(super) fn mass(scene: &Scene, placed: &[Placed], all: &mut Vec<String>) {
    for (shape, of_scene) in placed.iter().zip(&scene.shapes).filter(|(_, shape)| lacks(scene, shape)) {
        let dx = scene.spacing(of_scene);
        let whole = f64::from(of_scene.geometry.copies()) * shape.asked.iter().product::<f64>();
        let share = (shape.particles + shape.lost) as f64 * dx.powi(shape.asked.len() as i32) / whole;
        if (share - 1.0).abs() < NOTABLE {
            continue;
        }
        let stiffness = shape.bending.map_or(String::new(), |[asked, computed]| {
            format!(", and {:.2} times the bending stiffness", computed / asked)
        });
        all.push(format!(
            "`{}` has {:.0} % of the mass that its size asks for{stiffness}: in the nodal lattice it lacks half a \
             spacing, {} m, at each side (numerics.lattice = \"centred\" fills it)",
            shape.name,
            100.0 * share,
            length(0.5 * dx)
        ));
    }
}

/// Distances, in spacings, of the outermost particles of two shapes that have a face in common: two spacings.
const GAP: [f64; 2] = [1.5, 2.5];

/// Shapes of one solid that touch in the scene: the lattice leaves a gap between them.
pub(super) fn touching<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    bodies: &[Body],
    all: &mut Vec<String>,
) {
    if scene.numerics.lattice != Lattice::Nodal {
        return;
    }
    let mut solids: Vec<(usize, &Shape)> =
        scene.shapes.iter().enumerate().filter(|(_, shape)| shape.solid.is_some()).collect();
    while let Some((b, last)) = solids.pop() {
        for &(a, first) in solids.iter().filter(|(_, other)| other.solid == last.solid) {
            let dx = scene.spacing(first);
            let around = [first, last].map(|shape| geometry::bounding_box(shape, scene));
            if !meet(&around[0], &around[1], scene) {
                continue;
            }
            let apart = nearest(layout, [a, b], GAP[1] * dx) / dx;
            if !(GAP[0]..GAP[1]).contains(&apart) {
                continue;
            }
            let one = bodies.iter().any(|body| [a, b].iter().all(|k| body.shapes.contains(k)));
            let hypoelastic = scene.solids[first.solid.unwrap_or_default()].model.name();
            let hold = match one {
                true if hypoelastic == SolidModelName::Hypoelastic => {
                    "few of each particle's neighbours are across that gap, and pulled apart they part"
                }
                true => {
                    "few of each particle's neighbours are across that gap, which is softer than the rest"
                }
                false => "nothing connects them, and they push each other when a spacing of it is closed",
            };
            all.push(format!(
                "`{}` and `{}` touch, and in the nodal lattice, which has no particles on their faces, they begin {} m \
                 apart: {hold} (one `polygon` for both has particles there, numerics.lattice = \"centred\" leaves no \
                 gap)",
                first.name,
                last.name,
                length(apart * dx)
            ));
        }
    }
}

/// Distance of the nearest particles of two shapes of solid, m; infinite from `reach` on.
fn nearest<const D: usize>(layout: &Layout<D>, [a, b]: [usize; 2], reach: f64) -> f64 {
    let of = |index: usize| layout.solid.iter().filter(move |p| p.body as usize == index);
    let mut cells = Cells::new(reach);
    of(a).for_each(|p| cells.add(&p.position, p.position));
    let between = |x: &[f64; D], y: &[f64; D]| (0..D).map(|d| (x[d] - y[d]).powi(2)).sum::<f64>().sqrt();
    let all = of(b).flat_map(|p| cells.around(&p.position).map(|x| between(x, &p.position)));
    let least = all.fold(f64::INFINITY, f64::min);
    if least < reach { least } else { f64::INFINITY }
}
