//! The solid's effects: what takes part in a scene with solid, and why.

use crate::sleep::TOLERANCE;
use halfstep_scene::{Decision, Derived, EffectName, Phase, Scene, SolidModelName};

/// What a scene with solid decides about each of its effects.
pub fn decide(scene: &Scene) -> Vec<Decision> {
    [
        EffectName::ArtificialStress,
        EffectName::RenormalisedGradient,
        EffectName::ClampFace,
        EffectName::WallClamp,
        EffectName::WallContact,
        EffectName::SleepingSolid,
    ]
    .map(|effect| Decision::new(scene, effect, derive(scene, effect)))
    .into()
}

/// An effect of the solid takes part.
pub(crate) fn takes_part(scene: &Scene, effect: EffectName) -> bool {
    Decision::new(scene, effect, derive(scene, effect)).on
}

fn derive(scene: &Scene, effect: EffectName) -> Derived {
    let Some(solid) = scene.solids.first() else {
        return Derived::Impossible("the scene has no solid".into());
    };
    let hypoelastic = solid.model == SolidModelName::Hypoelastic;
    match effect {
        EffectName::ArtificialStress if !hypoelastic => {
            Derived::Impossible("neighbours of the reference configuration: no tensile instability".into())
        }
        EffectName::ArtificialStress if solid.artificial_stress.strength == 0.0 => {
            Derived::Impossible("solid.artificial_stress.strength is zero".into())
        }
        EffectName::ArtificialStress => Derived::On(format!(
            "the hypoelastic solid is unstable in tension; strength {}",
            solid.artificial_stress.strength
        )),
        EffectName::RenormalisedGradient if hypoelastic => {
            Derived::Off("the plain gradient is the method's own".into())
        }
        EffectName::RenormalisedGradient => {
            Derived::Impossible("part of the total-Lagrangian solid, corrected once for all".into())
        }
        EffectName::ClampFace if hypoelastic => {
            Derived::Impossible("only the total-Lagrangian solid corrects its clamps".into())
        }
        EffectName::WallClamp if !hypoelastic => {
            Derived::Impossible("only the hypoelastic solid's clamps carry stress".into())
        }
        EffectName::ClampFace | EffectName::WallClamp if scene.shapes.iter().all(|s| s.clamp.is_empty()) => {
            Derived::Impossible("nothing is clamped".into())
        }
        EffectName::ClampFace => Derived::On("clamps hold at their boxes' faces".into()),
        EffectName::WallClamp => Derived::Off("clamped rows carry the solid's own stress".into()),
        EffectName::SleepingSolid if scene.fluid.is_none() => {
            Derived::Impossible("no fluid that could wake it".into())
        }
        EffectName::SleepingSolid if !begins_at_rest(scene) => Derived::Impossible(
            "a solid that is not clamped, or that starts with a velocity, moves by itself".into(),
        ),
        EffectName::SleepingSolid => Derived::On(format!(
            "until fluid reaches it, while it has moved by less than {} % of the spacing for half its slowest period",
            100.0 * TOLERANCE
        )),
        _ if scene.shapes.iter().any(|s| s.contact) => Derived::On("a wall has contact = true".into()),
        _ => Derived::Impossible("no wall has contact = true".into()),
    }
}

/// Every solid shape is clamped somewhere and starts with no velocity.
fn begins_at_rest(scene: &Scene) -> bool {
    let mut solids = scene.shapes.iter().filter(|s| s.phase == Phase::Solid);
    solids.all(|s| !s.clamp.is_empty() && s.velocity == [0.0; 3] && s.cantilever_mode.is_none())
}
