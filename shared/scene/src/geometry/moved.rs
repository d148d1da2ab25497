//! Shapes that are turned, shifted and repeated.

use super::Geometry;
use serde::{Deserialize, Serialize};

/// A geometry, turned, then shifted, then repeated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moved {
    /// The geometry before all this.
    pub geometry: Box<Geometry>,
    /// Angle in the plane, degrees, counter-clockwise.
    pub angle: f64,
    /// The point that it is turned about, m.
    pub about: [f64; 3],
    /// How far it is shifted, m.
    pub translate: [f64; 3],
    /// Number of copies, the first one included.
    pub count: u32,
    /// From one copy to the next, m.
    pub step: [f64; 3],
}

/// Cosine and sine of an angle, degrees: exact for quarters of a turn.
pub(super) fn turn(angle: f64) -> [f64; 2] {
    match angle.rem_euclid(360.0) {
        0.0 => [1.0, 0.0],
        90.0 => [0.0, 1.0],
        180.0 => [-1.0, 0.0],
        270.0 => [0.0, -1.0],
        angle => {
            let radians = angle.to_radians();
            [libm::cos(radians), libm::sin(radians)]
        }
    }
}

impl Moved {
    /// Cosine and sine of the angle.
    fn turn(&self) -> [f64; 2] {
        turn(self.angle)
    }

    /// A vector of the geometry as it is turned.
    pub fn turned<const D: usize>(&self, v: [f64; D]) -> [f64; D] {
        let [cos, sin] = self.turn();
        let mut turned = v;
        (turned[0], turned[1]) = (cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]);
        turned
    }

    /// Where a copy has a point of the geometry, m.
    pub fn place<const D: usize>(&self, copy: u32, x: [f64; D]) -> [f64; D] {
        let from: [f64; D] = self.turned(std::array::from_fn(|a| x[a] - self.about[a]));
        let shift = self.shift(copy);
        std::array::from_fn(|a| from[a] + shift[a])
    }

    /// The point of the geometry that a copy has at a place, m.
    pub fn back<const D: usize>(&self, copy: u32, x: [f64; D]) -> [f64; D] {
        let [cos, sin] = self.turn();
        let shift = self.shift(copy);
        let from: [f64; D] = std::array::from_fn(|a| x[a] - shift[a]);
        let mut back = from;
        (back[0], back[1]) = (cos * from[0] + sin * from[1], cos * from[1] - sin * from[0]);
        std::array::from_fn(|a| back[a] + self.about[a])
    }

    fn shift(&self, copy: u32) -> [f64; 3] {
        std::array::from_fn(|a| self.about[a] + self.translate[a] + f64::from(copy) * self.step[a])
    }

    /// The copies' numbers.
    pub fn copies(&self) -> std::ops::Range<u32> {
        0..self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Block;

    #[test]
    fn a_point_is_turned_then_shifted_then_repeated() {
        let geometry = Box::new(Geometry::Box(Block { min: [0.0; 3], max: [1.0, 1.0, 0.0] }));
        let (about, translate, step) = ([1.0, 0.0, 0.0], [0.0, 5.0, 0.0], [10.0, 0.0, 0.0]);
        let moved = Moved { geometry, angle: 90.0, about, translate, count: 3, step };
        // (2, 0) is one to the right of (1, 0); a quarter of a turn later it is one above it.
        assert_eq!(moved.place(0, [2.0, 0.0]), [1.0, 6.0]);
        assert_eq!(moved.place(2, [2.0, 0.0]), [21.0, 6.0]);
        assert_eq!(moved.back(2, [21.0, 6.0]), [2.0, 0.0]);
        assert_eq!(moved.turned([0.0, 1.0]), [-1.0, 0.0]);
    }
}
