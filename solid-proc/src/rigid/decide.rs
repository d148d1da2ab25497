//! The rigid model has no effect that another has not.

use crate::models::OwnEffects;
use halfstep_scene::{Derived, EffectName, Scene};

pub(crate) const EFFECTS: OwnEffects = OwnEffects { list: &[], derive };

fn derive(_: &Scene, _: usize, effect: EffectName) -> Derived {
    Derived::Impossible(format!("{} belongs to another model", effect.name()))
}
