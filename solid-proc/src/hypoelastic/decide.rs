//! The effects that only the hypoelastic model has: which take part, and why.

use super::wall_states;
use crate::effects::is_clamped;
use crate::models::OwnEffects;
use halfstep_scene::{Derived, EffectName, ModelKeys, Scene};

pub(crate) const EFFECTS: OwnEffects = OwnEffects {
    list: &[
        (EffectName::ArtificialStress, "only the hypoelastic solid has a tensile instability that needs it"),
        (EffectName::RenormalisedGradient, "only the hypoelastic solid has the choice of its gradient"),
        (EffectName::WallClamp, "only the hypoelastic solid's clamps carry stress"),
        (EffectName::WallParticles, "only the hypoelastic solid has walls that hold its values"),
    ],
    derive,
};

fn derive(scene: &Scene, solid: usize, effect: EffectName) -> Derived {
    match effect {
        EffectName::ArtificialStress => match strength(scene, solid) {
            0.0 => Derived::Impossible("solid.artificial_stress.strength is zero".into()),
            strength => {
                Derived::On(format!("the hypoelastic solid is unstable in tension; strength {strength}"))
            }
        },
        EffectName::WallClamp if !is_clamped(scene, solid) => {
            Derived::Impossible("nothing is clamped".into())
        }
        EffectName::WallParticles => match wall_states::why_not(scene, solid) {
            Some(why) => Derived::Impossible(why.into()),
            None => Derived::Off("walls do not act on the solid, or push it by a spring".into()),
        },
        EffectName::WallClamp => Derived::Off("clamped rows carry the solid's own stress".into()),
        _ => Derived::Off("the plain gradient is the method's own".into()),
    }
}

fn strength(scene: &Scene, solid: usize) -> f64 {
    match scene.solids.get(solid).map(|s| &s.model) {
        Some(ModelKeys::Hypoelastic(keys)) => keys.artificial_stress.strength,
        _ => 0.0,
    }
}
