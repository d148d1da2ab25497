//! Which viscosities of the fluid count: what fluid and interface both decide by.

use super::{Decision, Derived, EffectName, Fluid, Scene};

/// Physical over artificial kinematic viscosity below which the physical one is left out: it costs time, and what the
/// artificial one does is not known better than that.
const SMALLEST_SHARE: f64 = 0.05;

/// Whether the artificial viscosity acts between fluid particles.
pub fn artificial_viscosity(scene: &Scene) -> Decision {
    let derived = match &scene.fluid {
        None => Derived::Impossible("the scene has no fluid".into()),
        Some(Fluid { artificial_viscosity: a, .. }) if a.linear == 0.0 && a.quadratic == 0.0 => {
            Derived::Impossible(
                "fluid.artificial_viscosity is zero, or no more than fluid.viscosity does".into(),
            )
        }
        Some(Fluid { artificial_viscosity: a, sound_speed, .. }) => {
            let worth = a.kinematic(scene.smoothing_ratio * scene.resolution, *sound_speed);
            let (linear, quadratic) = ((1e4 * a.linear).round() / 1e4, a.quadratic);
            Derived::On(format!(
                "fluid.artificial_viscosity: A = {linear}, B = {quadratic}, worth {worth:.1e} m²/s"
            ))
        }
    };
    Decision::new(scene, EffectName::ArtificialViscosity, derived)
}

/// Whether the physical viscosity counts.
pub fn viscosity(scene: &Scene) -> Decision {
    let derived = match share_of_artificial(scene) {
        None => Derived::Impossible("fluid.viscosity is zero".into()),
        Some(share) if share.is_infinite() => Derived::On("there is no artificial viscosity".into()),
        Some(share) => {
            let (percent, least) = (100.0 * share, 100.0 * SMALLEST_SHARE);
            let why = format!("{percent:.2} % of the artificial viscosity; computed from {least} % on");
            if share >= SMALLEST_SHARE { Derived::On(why) } else { Derived::Off(why) }
        }
    };
    Decision::new(scene, EffectName::Viscosity, derived)
}

/// Physical over artificial kinematic viscosity; infinite without artificial one, `None` without fluid or without
/// physical one.
fn share_of_artificial(scene: &Scene) -> Option<f64> {
    let fluid = scene.fluid.as_ref().filter(|f| f.viscosity > 0.0)?;
    if !artificial_viscosity(scene).on {
        return Some(f64::INFINITY);
    }
    let h = scene.smoothing_ratio * scene.resolution;
    let artificial = fluid.artificial_viscosity.kinematic(h, fluid.sound_speed);
    Some(fluid.viscosity / fluid.density / artificial)
}
