//! Where a solid is so thin that fluid on both of its faces is within reach of the same solid particles.
//!
//! Of a plate as thick as N spacings dx of the fluid, the nearest fluid on either face stands (N + 1) dx apart. Below
//! 4h there are solid particles that see both; below 2h the fluid particles see each other.

use halfstep_scene::geometry::Plate;
use halfstep_scene::{Decision, Derived, EffectName, Scene, Shape, Treatment, dispatch};

/// Relative tolerance of lengths.
const TOLERANCE: f64 = 1e-9;

/// The plates of a scene that some support, in units of h, reaches through.
fn thinner<const D: usize>(scene: &Scene, support: f64, of: impl Fn(&Shape) -> bool) -> Vec<Plate<D>> {
    let reach = support * scene.smoothing_ratio * (1.0 - TOLERANCE);
    let plates = scene.shapes.iter().filter(|shape| of(shape)).filter_map(|shape| Plate::of(scene, shape));
    plates.filter(|plate| plate.thickness + 1.0 < reach).collect()
}

/// Thin plates show the fluid on each face a pressure of its own where the solid is a moving wall.
pub fn thin_plate_screen(scene: &Scene) -> Decision {
    Decision::new(scene, EffectName::ThinPlateScreen, derive(scene))
}

fn derive(scene: &Scene) -> Derived {
    if scene.fluid.is_none() || scene.solids.is_empty() {
        return Derived::Impossible("one phase only".into());
    }
    if scene.interface.treatment == Treatment::PhaseBlind {
        return Derived::Impossible("phase-blind: solid particles show their own stress".into());
    }
    let thin = dispatch!(scene.dimension, D => {
        thinner::<D>(scene, 4.0, |_| true).first().map(|plate| (plate.name.clone(), plate.rows))
    });
    match thin.flatten() {
        Some((name, rows)) => Derived::On(format!(
            "{name} is {} particles thick: they see the fluid on both faces",
            rows.round()
        )),
        None => Derived::Impossible("no plate is thinner than 4h - dx".into()),
    }
}

/// The plates of a solid to be screened; none where the effect is off.
pub(super) fn screened<const D: usize>(scene: &Scene, solid: usize) -> Vec<Plate<D>> {
    if !thin_plate_screen(scene).on {
        return Vec::new();
    }
    thinner(scene, 4.0, |shape| shape.solid.unwrap_or_default() == solid)
}
