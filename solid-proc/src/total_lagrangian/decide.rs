//! The effects that only the total-Lagrangian model has: which take part, and why.

use crate::effects::is_clamped;
use crate::models::OwnEffects;
use halfstep_scene::{Derived, EffectName, Fracture, ModelKeys, Scene, Shape};

pub(crate) const EFFECTS: OwnEffects = OwnEffects {
    list: &[
        (EffectName::ClampFace, "only the total-Lagrangian solid corrects its clamps"),
        (
            EffectName::Relaxation,
            "only the total-Lagrangian solid has a strain that Maxwell arms could follow",
        ),
        (EffectName::Fracture, "only the total-Lagrangian solid breaks"),
        (EffectName::FragmentFriction, "only the total-Lagrangian solid breaks"),
    ],
    derive,
};

fn derive(scene: &Scene, solid: usize, effect: EffectName) -> Derived {
    match effect {
        EffectName::Relaxation => relaxation(scene, solid),
        EffectName::Fracture => fracture(scene, solid),
        EffectName::FragmentFriction => match scene.solids.get(solid).and_then(|solid| solid.fracture()) {
            Some(keys) if keys.friction > 0.0 => {
                Derived::On(format!("solid.fracture.friction: {}", keys.friction))
            }
            _ => Derived::Impossible("solid.fracture has no friction".into()),
        },
        _ if turns(scene, solid) => {
            Derived::Impossible("a clamp turns, and clamps at faces know no rotation".into())
        }
        _ if is_clamped(scene, solid) => Derived::On("clamps hold at their boxes' faces".into()),
        _ => Derived::Impossible("nothing is clamped".into()),
    }
}

/// A clamp of the solid turns, by itself or with a wall.
fn turns(scene: &Scene, solid: usize) -> bool {
    let turning = |shape: &Shape| shape.motion.as_ref().is_some_and(|motion| motion.pivot().is_some());
    let with = |shape: &Shape, wall: &Shape| shape.clamp_with.iter().flatten().any(|name| *name == wall.name);
    let mut shapes = scene.shapes.iter().filter(|shape| shape.solid == Some(solid));
    shapes.any(|s| turning(s) || scene.shapes.iter().any(|wall| turning(wall) && with(s, wall)))
}

fn fracture(scene: &Scene, solid: usize) -> Derived {
    let Some((solid_, keys)) = scene.solids.get(solid).and_then(|solid| Some((solid, solid.fracture()?)))
    else {
        return Derived::Impossible("solid.fracture is not there".into());
    };
    let band = Fracture::BAND * scene.solid_spacing(solid);
    Derived::On(format!(
        "solid.fracture: {} Pa and {} J/m², cracks in bands of {} m, of at most {} m",
        keys.strength,
        keys.energy,
        band as f32,
        keys.widest_band(solid_.strip_modulus(scene.dimension)) as f32
    ))
}

fn relaxation(scene: &Scene, solid: usize) -> Derived {
    let prony = match scene.solids.get(solid).map(|solid| &solid.model) {
        Some(ModelKeys::TotalLagrangian(keys)) => keys.prony.as_slice(),
        _ => &[],
    };
    match prony {
        [] => Derived::Impossible("solid.prony has no arm".into()),
        arms => Derived::On(format!(
            "solid.prony: {} Maxwell arm{}, a sudden strain meets {} times the shear modulus",
            arms.len(),
            if arms.len() > 1 { "s" } else { "" },
            1.0 + arms.iter().map(|[g, _]| g).sum::<f64>()
        )),
    }
}
