//! A weight that fades with the distance of a pair: for terms that shall act between close neighbours only.

use crate::lane::Lanes;

/// 1 up to a distance, 0 beyond a second one, a straight line between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fade {
    end: f64,
    slope: f64,
}

impl Fade {
    /// Full up to `full`, m, gone from `end` > `full` on, m.
    pub fn new(full: f64, end: f64) -> Self {
        Self { end, slope: 1.0 / (end - full) }
    }

    /// Weight at these distances, m.
    #[inline(always)]
    pub fn at<L: Lanes>(&self, r: L) -> L {
        let ramp = (L::splat(self.end) - r) * L::splat(self.slope);
        ramp.min(L::splat(1.0)).max(L::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::Lane;

    #[test]
    fn full_then_a_line_then_nothing() {
        let fade = Fade::new(2.0, 4.0);
        assert_eq!(fade.at(Lane([0.0, 2.0, 3.5, 4.0])).0, [1.0, 1.0, 0.25, 0.0]);
        assert_eq!(fade.at::<Lane>(Lane::splat(9.0)).0, [0.0; 4]);
    }
}
