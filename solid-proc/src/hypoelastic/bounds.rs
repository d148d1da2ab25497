//! When the hypoelastic solid has diverged: density, speed or stress out of bounds.

use super::Hypoelastic;
use crate::model::OutOfBounds;
use halfstep_scene::bounds::Excess;
use halfstep_wire::failure::Quantity;
use halfstep_wire::wide;

impl<const D: usize> Hypoelastic<D> {
    /// Names the particle that is farthest out of bounds, if any is.
    pub(super) fn check(&self) -> Result<(), OutOfBounds> {
        let excess = |(p, &slot): (usize, &u32)| {
            let s = slot as usize;
            let v2: f64 = (0..D).map(|d| self.now.velocity[d][s].powi(2)).sum();
            let stress: f64 = self.stress_at(s).as_flattened().iter().map(|s| s.abs()).sum();
            let no_number = Excess { quantity: Quantity::Stress, value: stress, ratio: f64::INFINITY };
            let found = self.bounds.excess(self.now.density[s], v2.sqrt());
            Some((p, s, found.or((!stress.is_finite()).then_some(no_number))?))
        };
        let all = self.slot_of[..self.own].iter().enumerate().filter_map(excess);
        let Some((p, s, worst)) = all.max_by(|a, b| a.2.ratio.total_cmp(&b.2.ratio)) else { return Ok(()) };
        let position = wide::<D>(std::array::from_fn(|d| self.now.position[d][s]));
        Err(OutOfBounds { particle: p as u32, quantity: worst.quantity, value: worst.value, position })
    }
}
