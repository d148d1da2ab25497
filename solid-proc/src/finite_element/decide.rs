//! The finite-element solid has no effects of its own.

use crate::models::OwnEffects;
use halfstep_scene::Derived;

pub(crate) const EFFECTS: OwnEffects = OwnEffects {
    list: &[],
    derive: |_, _, _| Derived::Impossible("the finite-element solid has none".into()),
};
