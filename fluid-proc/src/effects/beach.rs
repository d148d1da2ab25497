//! A beach that absorbs waves: - sigma(x) v on the acceleration of each fluid particle, sigma = rate s², s from 0 where
//! the beach begins to 1 where it is strongest and beyond (Altomare et al. 2017, Coastal Engineering 127:37, eq. 30).

use super::{FluidEffect, Listed};
use crate::composition::NoShare;
use halfstep_scene::{Beach as Place, Decision, Derived, EffectName, Scene};

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct Beach<const D: usize> {
    place: Place,
}

impl<const D: usize> Beach<D> {
    /// Of that place and strength.
    pub fn new(place: Place) -> Self {
        Self { place }
    }
}

impl<const D: usize> Listed<D> for Beach<D> {
    fn of(scene: &Scene) -> Option<Self> {
        Some(Self::new(scene.fluid.as_ref()?.beach?))
    }
}

impl<const D: usize> FluidEffect<D> for Beach<D> {
    const NAME: &'static str = EffectName::Beach.name();
    const ON_PARTICLES: bool = true;
    type Pair<'a> = NoShare;
    type AtWall<'a> = NoShare;
    fn decide(scene: &Scene) -> Decision {
        let derived = match scene.fluid.as_ref().and_then(|fluid| fluid.beach) {
            Some(Place { from, to, rate }) => Derived::On(format!(
                "fluid.beach: velocities decay from x = {from} m on, at x = {to} m at {:.3} 1/s",
                rate
            )),
            None => Derived::Impossible("fluid.beach is not there".into()),
        };
        Decision::new(scene, EffectName::Beach, derived)
    }
    fn on_particle(&self, position: &[f64; D], velocity: &[f64; D]) -> [f64; D] {
        let Place { from, to, rate } = self.place;
        let s = ((position[0] - from) / (to - from)).clamp(0.0, 1.0);
        velocity.map(|v| -rate * s * s * v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_decay_by_hand() {
        // From 3 m on toward 1 m, 8/s there. At 2.5 m: s = 1/4, 8 / 16 (1, -2) = (0.5, -1).
        let beach = Beach::<2>::new(Place { from: 3.0, to: 1.0, rate: 8.0 });
        assert_eq!(beach.on_particle(&[2.5, 7.0], &[1.0, -2.0]), [-0.5, 1.0]);
        assert_eq!(beach.on_particle(&[3.5, 0.0], &[1.0, -2.0]), [0.0, 0.0]);
        assert_eq!(beach.on_particle(&[0.5, 0.0], &[1.0, -2.0]), [-8.0, 16.0]);
    }
}
