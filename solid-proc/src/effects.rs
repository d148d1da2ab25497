//! The solid's effects: what takes part in a scene with solid, and why.

use crate::models::own_effects;
use crate::sleep::TOLERANCE;
use halfstep_scene::{ContactKeys, Decision, Derived, EffectName, Scene, Shape, SolidModelName};

/// Effects that every model has.
const COMMON: [EffectName; 3] =
    [EffectName::WallContact, EffectName::SleepingSolid, EffectName::SideFriction];

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
    let owned = SolidModelName::ALL.iter().flat_map(|(_, model)| own_effects(*model).list);
    let mut all: Vec<EffectName> = owned.map(|(effect, _)| *effect).chain(COMMON).collect();
    all.sort_unstable();
    all.into_iter().map(summary).collect()
}

/// What a scene decides about an effect of its solid of that index.
pub fn decision(scene: &Scene, solid: usize, effect: EffectName) -> Decision {
    Decision::new(scene, effect, derive(scene, solid, effect))
}

/// An effect of the scene's solid of that index takes part.
pub(crate) fn takes_part(scene: &Scene, solid: usize, effect: EffectName) -> bool {
    decision(scene, solid, effect).on
}

/// The model of the scene's solid of that index evaluates contact with walls.
pub(crate) fn touches_walls(scene: &Scene, solid: usize) -> bool {
    !scene.leaves_walls_to_coupler(solid) && takes_part(scene, solid, EffectName::WallContact)
}

fn derive(scene: &Scene, k: usize, effect: EffectName) -> Derived {
    let Some(solid) = scene.solids.get(k) else {
        return Derived::Impossible("the scene has no solid".into());
    };
    let model = solid.model.name();
    for (_, owner) in SolidModelName::ALL {
        let own = own_effects(*owner);
        if let Some((_, elsewhere)) = own.list.iter().find(|(e, _)| *e == effect) {
            return if *owner == model {
                (own.derive)(scene, k, effect)
            } else {
                Derived::Impossible((*elsewhere).into())
            };
        }
    }
    match effect {
        EffectName::SideFriction if solid.side_friction == 0.0 => {
            Derived::Impossible("solid.side_friction is zero".into())
        }
        EffectName::SideFriction => Derived::On(format!("{} N/m³ against the velocity", solid.side_friction)),
        EffectName::SleepingSolid if scene.fluid.is_none() => {
            Derived::Impossible("no fluid that could wake it".into())
        }
        EffectName::SleepingSolid if !shapes(scene, k).all(begins_at_rest) => Derived::Impossible(
            "a solid that is not clamped, or that starts with a velocity, moves by itself".into(),
        ),
        EffectName::SleepingSolid if scene.frame.is_some() => {
            Derived::Impossible("gravity changes with `frame`, and would not wake it".into())
        }
        EffectName::SleepingSolid if shapes(scene, k).any(|s| s.load.is_some()) => {
            Derived::Impossible("the scene loads it".into())
        }
        EffectName::SleepingSolid if scene.shapes.iter().any(|s| s.contact && s.motion.is_some()) => {
            Derived::Impossible("a wall that it may touch moves".into())
        }
        EffectName::SleepingSolid
            if shapes(scene, k).any(|s| s.motion.is_some() || !s.clamp_with.is_empty()) =>
        {
            Derived::Impossible("a clamp moves".into())
        }
        EffectName::SleepingSolid => Derived::On(format!(
            "until fluid reaches it, while it has moved by less than {} % of the spacing for half its slowest period: \
             swings of up to {:.1e} m are left out, and with them 0.6 % of a peak after an impact (measured)",
            100.0 * TOLERANCE,
            TOLERANCE * scene.solid_spacing(k)
        )),
        EffectName::WallContact if takes_part(scene, k, EffectName::WallParticles) => {
            Derived::Impossible("walls act by their particles".into())
        }
        _ if scene.shapes.iter().any(|s| s.contact) && scene.leaves_walls_to_coupler(k) => {
            let ContactKeys { friction, restitution } = solid.contact().unwrap_or_default();
            let how = format!("friction {friction}, restitution {restitution}");
            Derived::On(format!("a wall has contact = true: in the coupler, {how}"))
        }
        _ if scene.shapes.iter().any(|s| s.contact) => Derived::On("a wall has contact = true".into()),
        _ => Derived::Impossible("no wall has contact = true".into()),
    }
}

/// The shapes of the scene's solid of that index.
fn shapes(scene: &Scene, solid: usize) -> impl Iterator<Item = &Shape> {
    scene.shapes.iter().filter(move |s| s.solid == Some(solid))
}

/// Something of the scene's solid of that index is clamped.
pub(crate) fn is_clamped(scene: &Scene, solid: usize) -> bool {
    shapes(scene, solid).any(|s| !s.clamp.is_empty())
}

/// A shape that is clamped somewhere and starts with no velocity.
fn begins_at_rest(shape: &Shape) -> bool {
    !shape.clamp.is_empty() && shape.velocity == [0.0; 3] && shape.cantilever_mode.is_none()
}
