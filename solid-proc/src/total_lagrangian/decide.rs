//! The effects that only the total-Lagrangian model has: which take part, and why.

use crate::effects::is_clamped;
use crate::models::OwnEffects;
use halfstep_scene::{Derived, EffectName, Scene};

pub(crate) const EFFECTS: OwnEffects = OwnEffects {
    list: &[(EffectName::ClampFace, "only the total-Lagrangian solid corrects its clamps")],
    derive,
};

fn derive(scene: &Scene, solid: usize, _: EffectName) -> Derived {
    if is_clamped(scene, solid) {
        Derived::On("clamps hold at their boxes' faces".into())
    } else {
        Derived::Impossible("nothing is clamped".into())
    }
}
