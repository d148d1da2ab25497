//! Viscous stress between fluid and solid: part of the interface. The coupler evaluates the forces on both.

use super::{FluidEffect, Listed};
use crate::composition::NoShare;
use halfstep_scene::{Decision, EffectName, Scene};

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct InterfaceViscosity<const D: usize>;

impl<const D: usize> Listed<D> for InterfaceViscosity<D> {
    fn of(_: &Scene) -> Option<Self> {
        Some(Self)
    }
}

impl<const D: usize> FluidEffect<D> for InterfaceViscosity<D> {
    const NAME: &'static str = EffectName::InterfaceViscosity.name();
    type Pair<'a> = NoShare;
    type AtWall<'a> = NoShare;
    fn decide(scene: &Scene) -> Decision {
        halfstep_interface::interface_viscosity(scene)
    }
}
