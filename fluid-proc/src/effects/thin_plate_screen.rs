//! Thin plates show the fluid on each face a pressure of its own: part of the interface, which fluid and coupler
//! evaluate with the same code.

use super::{FluidEffect, Listed};
use crate::composition::NoShare;
use halfstep_scene::{Decision, EffectName, Scene};

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct ThinPlateScreen<const D: usize>;

impl<const D: usize> Listed<D> for ThinPlateScreen<D> {
    fn of(_: &Scene) -> Option<Self> {
        Some(Self)
    }
}

impl<const D: usize> FluidEffect<D> for ThinPlateScreen<D> {
    const NAME: &'static str = EffectName::ThinPlateScreen.name();
    type Pair<'a> = NoShare;
    type AtWall<'a> = NoShare;
    fn decide(scene: &Scene) -> Decision {
        halfstep_interface::thin_plate_screen(scene)
    }
}
