//! Parts of a solid that are thinner than it: how thick they are as asked and as computed, and what voids leave of it.

use super::shapes::{NOTABLE, Placed, length, place};
use halfstep_scene::geometry::{self, Section};
use halfstep_scene::{Geometry, Phase, Scene, Shape};

/// Lines from which on a part is straight: an arm.
const STRAIGHT: usize = 3;
/// Thicknesses that differ by less are one, in spacings.
const ALIKE: f64 = 1e-6;

/// Solids in the plane whose narrowest part beside a void, or an arm, has another thickness than asked for, and rigid
/// ones of which voids leave another area.
pub(super) fn cuts(scene: &Scene, placed: &[Placed], all: &mut Vec<String>) {
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| shape.phase == Phase::Solid) {
        if scene.is_rigid(shape) {
            let whole = placed[index].lost == 0;
            all.extend(whole.then(|| hollowed(scene, index)).flatten());
        } else if shape.lattice_angle == 0.0 {
            let both = geometry::sections(scene, index);
            all.extend(both.iter().filter_map(|sections| thinned(scene, shape, sections)));
        }
    }
}

/// Of the thinnest part beside a void and of arms, the one whose thickness differs most; none that is thicker than half
/// of the shape.
fn thinned(scene: &Scene, shape: &Shape, sections: &[Section]) -> Option<String> {
    let dx = scene.spacing(shape);
    let parts = sections.iter().filter(|part| part.asked < 0.5 * part.extent);
    let least = parts.clone().map(|part| part.asked).fold(f64::INFINITY, f64::min);
    // The tips of a polygon have no thickness.
    let is_box = matches!(shape.geometry.unmoved(), Geometry::Box(_));
    let narrowest = |part: &Section| is_box && part.beside_void && part.asked < least + ALIKE * dx;
    let off = |part: &Section| (part.computed / part.asked - 1.0).abs();
    let counts = parts.filter(|part| part.lines >= STRAIGHT || narrowest(part));
    let most = counts.reduce(|a, b| if off(b) > off(a) + 1e-9 { b } else { a })?;
    let Section { asked, computed, at, beside_void, .. } = most;
    (off(most) >= NOTABLE).then(|| {
        format!(
            "`{}` is {} m thick at {}{} in the scene and {} m of whole rows as computed: {:.2} times the bending \
             stiffness (its spacing is {})",
            shape.name,
            length(*asked),
            place(at),
            if *beside_void { " beside a void" } else { "" },
            length(*computed),
            (computed / asked).powi(3),
            length(dx)
        )
    })
}

/// A rigid shape of which voids leave another area: its mass follows from its particles, unless it is said.
fn hollowed(scene: &Scene, index: usize) -> Option<String> {
    let shape = &scene.shapes[index];
    let keys = shape.solid.and_then(|k| scene.solids[k].rigid())?;
    let is_said = keys.bodies.iter().any(|body| body.name == shape.body() && body.mass.is_some());
    let [asked, computed] = geometry::left_by_voids(scene, index).filter(|_| !is_said)?;
    let factor = computed / asked;
    ((factor - 1.0).abs() >= NOTABLE).then(|| {
        format!(
            "voids leave {} m² of `{}` in the scene and {} m² as computed: {factor:.2} times the mass (its spacing is \
             {}; `mass` at its body says another)",
            length(asked),
            shape.name,
            length(computed),
            length(scene.spacing(shape))
        )
    })
}
