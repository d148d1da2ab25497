//! The solid's effects: what takes part in a scene with solid, and why.

use crate::sleep::TOLERANCE;
use halfstep_scene::{Decision, Derived, EffectName, Scene, Shape, SolidModelName};

const EFFECTS: [EffectName; 6] = [
    EffectName::ArtificialStress,
    EffectName::RenormalisedGradient,
    EffectName::ClampFace,
    EffectName::WallClamp,
    EffectName::WallContact,
    EffectName::SleepingSolid,
];

/// What a scene decides about each of the effects of its solids: an effect takes part where one of them has it.
pub fn decide(scene: &Scene) -> Vec<Decision> {
    let solids = 0..scene.solids.len().max(1);
    let summary = |effect| {
        let each: Vec<Decision> = solids.clone().map(|solid| decision(scene, solid, effect)).collect();
        let why = match each.iter().all(|d| d.why == each[0].why) {
            true => each[0].why.clone(),
            false => {
                let of =
                    each.iter().zip(&scene.solids).map(|(d, solid)| format!("{}: {}", solid.name, d.why));
                of.collect::<Vec<_>>().join("; ")
            }
        };
        Decision { name: effect.name(), on: each.iter().any(|d| d.on), why }
    };
    EFFECTS.map(summary).into()
}

/// What a scene decides about an effect of its solid of that index.
pub fn decision(scene: &Scene, solid: usize, effect: EffectName) -> Decision {
    Decision::new(scene, effect, derive(scene, solid, effect))
}

/// An effect of the scene's solid of that index takes part.
pub(crate) fn takes_part(scene: &Scene, solid: usize, effect: EffectName) -> bool {
    decision(scene, solid, effect).on
}

fn derive(scene: &Scene, k: usize, effect: EffectName) -> Derived {
    let Some(solid) = scene.solids.get(k) else {
        return Derived::Impossible("the scene has no solid".into());
    };
    let mut shapes = scene.shapes.iter().filter(|s| s.solid == Some(k));
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
        EffectName::ClampFace | EffectName::WallClamp if shapes.all(|s| s.clamp.is_empty()) => {
            Derived::Impossible("nothing is clamped".into())
        }
        EffectName::ClampFace => Derived::On("clamps hold at their boxes' faces".into()),
        EffectName::WallClamp => Derived::Off("clamped rows carry the solid's own stress".into()),
        EffectName::SleepingSolid if scene.fluid.is_none() => {
            Derived::Impossible("no fluid that could wake it".into())
        }
        EffectName::SleepingSolid if !shapes.all(begins_at_rest) => Derived::Impossible(
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

/// A shape that is clamped somewhere and starts with no velocity.
fn begins_at_rest(shape: &Shape) -> bool {
    !shape.clamp.is_empty() && shape.velocity == [0.0; 3] && shape.cantilever_mode.is_none()
}
