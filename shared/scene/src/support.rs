//! What follows from the width of the water's kernel.

use super::Scene;

/// h / dx from which on guards at walls and solids are strong and near. h F(r), by which they act, is weaker near by
/// where the kernel is wide: at 0.75 dx 0.54 times as strong with h / dx = 2 as with 1.5.
const WIDE: f64 = 1.75;

/// Whether the guards of a scene with this h / dx are strong and near.
pub(super) fn is_wide(smoothing_ratio: f64) -> bool {
    smoothing_ratio >= WIDE
}

impl Scene {
    /// The water's kernel is so wide that the guards at walls and solids are strong and near.
    pub fn has_wide_support(&self) -> bool {
        is_wide(self.smoothing_ratio)
    }
}
