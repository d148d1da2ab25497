//! The width of the water's kernel, and what follows from it.

use super::Scene;
use super::preset::Defaults;

/// h / dx from which on guards at walls and solids are strong and near. h F(r), by which they act, is weaker near by
/// where the kernel is wide: at 0.75 dx 0.54 times as strong with h / dx = 2 as with 1.5.
const WIDE: f64 = 1.75;
/// h / dx of water alone: the fewest neighbours with which waves and vortices keep their energy.
pub(super) const ALONE: f64 = 2.0;
/// h / dx beside solids, whose loads converge faster with a narrow kernel.
const BESIDE_SOLIDS: f64 = 1.5;

/// Whether guards of a scene with this h / dx are strong and near.
pub(super) fn is_wide(smoothing_ratio: f64) -> bool {
    smoothing_ratio >= WIDE
}

impl Defaults {
    /// h / dx of a scene that does not say it, with water alone or not.
    pub(super) fn smoothing_ratio(&self, alone: bool) -> f64 {
        self.smoothing_ratio.unwrap_or(if alone { ALONE } else { BESIDE_SOLIDS })
    }

    /// With the A that suits this h / dx.
    pub(super) fn with_width(mut self, smoothing_ratio: f64) -> Self {
        if is_wide(smoothing_ratio) {
            self.fluid_viscosity.linear = self.wide_linear;
        }
        self
    }
}

impl Scene {
    /// The water's kernel is so wide that the guards at walls and solids are strong and near.
    pub fn has_wide_support(&self) -> bool {
        is_wide(self.smoothing_ratio)
    }
}
