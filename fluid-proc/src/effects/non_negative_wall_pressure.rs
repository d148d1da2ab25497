//! Walls, and the solid as a moving wall, never show the fluid a negative pressure: they push and do not pull.
//! [`crate::walls::Walls`] and the interface ask whether this effect takes part.

use super::{FluidEffect, Listed};
use crate::composition::NoShare;
use halfstep_scene::{Decision, EffectName, Scene};

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct NonNegativeWallPressure<const D: usize>;

impl<const D: usize> Listed<D> for NonNegativeWallPressure<D> {
    fn of(_: &Scene) -> Option<Self> {
        Some(Self)
    }
}

impl<const D: usize> FluidEffect<D> for NonNegativeWallPressure<D> {
    const NAME: &'static str = EffectName::NonNegativeWallPressure.name();
    type Pair<'a> = NoShare;
    type AtWall<'a> = NoShare;
    fn decide(scene: &Scene) -> Decision {
        halfstep_interface::non_negative_pressure(scene)
    }
}
