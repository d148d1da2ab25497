//! When the total-Lagrangian solid has diverged: a volume below a tenth or above tenfold (its laws reach far), or a
//! speed out of bounds.

use super::TotalLagrangian;
use crate::model::OutOfBounds;
use halfstep_scene::Scene;
use halfstep_scene::bounds::{Bounds, Excess};
use halfstep_sph::quantity::Quantity;
use halfstep_wire::wide;

/// Largest volume of a particle over its reference volume, and of the latter over the former.
const VOLUME_CHANGE: f64 = 10.0;

/// Bounds of a material that follows its own volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct VolumeBounds {
    /// Reference density, kg/m³.
    density: f64,
    /// Largest speed, m/s.
    speed: f64,
}

impl VolumeBounds {
    /// Of the scene's solid of that index.
    pub(crate) fn new(scene: &Scene, solid: usize) -> Option<Self> {
        Bounds::of_solid(scene, solid).map(|b| Self { density: b.density, speed: b.speed })
    }

    /// The quantity out of bounds, if any, for J = det F and a speed: of two quantities the one that is farther out.
    /// A J that is NaN is left to the speed, which then is NaN, too, and stands nearer to the cause.
    pub(crate) fn excess(&self, volume_ratio: f64, speed: f64) -> Option<Excess> {
        let of_volume = match volume_ratio {
            j if j.is_nan() => 0.0,
            j if j <= 0.0 => f64::INFINITY,
            j if (1.0 / VOLUME_CHANGE..=VOLUME_CHANGE).contains(&j) => 0.0,
            j => (libm::log(j) / libm::log(VOLUME_CHANGE)).abs(),
        };
        let of_speed = if speed.is_nan() { f64::INFINITY } else { speed / self.speed };
        let (quantity, value, ratio) = if of_volume > of_speed {
            (Quantity::Density, self.density / volume_ratio, of_volume)
        } else {
            (Quantity::Speed, speed, of_speed)
        };
        (ratio > 1.0).then_some(Excess { quantity, value, ratio })
    }
}

/// Keeps of two particles out of bounds the one that is farther out.
pub(crate) fn keep_worse(worst: &mut Option<(u32, Excess)>, particle: u32, excess: Option<Excess>) {
    if let Some(excess) = excess
        && worst.is_none_or(|(_, other)| excess.ratio > other.ratio)
    {
        *worst = Some((particle, excess));
    }
}

/// Fails with the one of these particles that is farthest out of bounds; `position` by particle number, m.
pub(crate) fn refuse_worst<const D: usize>(
    all: impl Iterator<Item = (u32, Excess)>,
    position: impl Fn(usize) -> [f64; D],
) -> Result<(), OutOfBounds> {
    match all.max_by(|a, b| a.1.ratio.total_cmp(&b.1.ratio)) {
        None => Ok(()),
        Some((particle, Excess { quantity, value, .. })) => {
            Err(OutOfBounds { particle, quantity, value, position: wide(position(particle as usize)) })
        }
    }
}

impl<const D: usize> TotalLagrangian<D> {
    /// Names the particle that is farthest out of bounds, if any is.
    pub(super) fn check(&self) -> Result<(), OutOfBounds> {
        let excess = |(p, &slot): (usize, &u32)| {
            let v2: f64 = (0..D).map(|d| self.now.velocity[d][slot as usize].powi(2)).sum();
            Some((p as u32, self.bounds.excess(1.0, v2.sqrt())?))
        };
        let all = self.slot_of.iter().enumerate().filter_map(excess).chain(self.failure);
        refuse_worst(all, |p| self.position_at(self.slot_of[p] as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_volume_has_bounds_both_ways() {
        let bounds = VolumeBounds { density: 1000.0, speed: 20.0 };
        assert_eq!(bounds.excess(0.11, 19.0), None);
        assert_eq!(bounds.excess(9.9, 0.0), None);
        let excess = bounds.excess(0.01, 21.0).unwrap();
        assert_eq!((excess.quantity, excess.value), (Quantity::Density, 1e5));
        assert!((excess.ratio - 2.0).abs() < 1e-12);
        assert_eq!(bounds.excess(-0.5, 21.0).unwrap().ratio, f64::INFINITY, "turned inside out");
        assert_eq!(bounds.excess(f64::NAN, f64::NAN).unwrap().quantity, Quantity::Speed);
    }
}
