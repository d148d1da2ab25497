//! Which lines a crack crosses, and which pairs of particles it parts.

use super::SolidPoint;
use crate::Scene;

/// Part of a crack's length by which a point may be beside its line and count as on it.
const ON_IT: f64 = 1e-9;

/// The line from a to b crosses a crack. Who is on the crack's own line is on its left: each has one side, and a row on
/// the line stays with its neighbours there. A crack that ends on the line from a to b crosses it.
pub fn crosses([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let side =
        |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let length_squared = (d[0] - c[0]).powi(2) + (d[1] - c[1]).powi(2);
    let left = |p: [f64; 2]| side(c, d, p) >= -ON_IT * length_squared;
    let [from, to] = [side(a, b, c), side(a, b, d)];
    let on_it = ON_IT * (length_squared * ((b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2))).sqrt();
    left(a) != left(b) && from.min(to) <= on_it && from.max(to) >= -on_it
}

/// The cracks that solids begin with.
pub struct Cracks<'s> {
    scene: &'s Scene,
    /// With the solid that has it, m.
    all: Vec<(Option<usize>, [[f64; 2]; 2])>,
}

impl<'s> Cracks<'s> {
    /// Of all solids.
    pub fn of(scene: &'s Scene) -> Self {
        let ends = |crack: [[f64; 3]; 2]| crack.map(|[x, y, _]| [x, y]);
        let all = scene.shapes.iter().filter_map(|shape| Some((shape.solid, ends(shape.crack?)))).collect();
        Self { scene, all }
    }

    /// Those of a solid, m.
    pub fn of_solid(&self, solid: Option<usize>) -> impl Iterator<Item = [[f64; 2]; 2]> {
        self.all.iter().filter(move |(of, _)| *of == solid).map(|(_, crack)| *crack)
    }

    /// Whether one of the first particle's solid parts it from the second.
    pub fn part<const D: usize>(&self, one: &SolidPoint<D>, other: &SolidPoint<D>) -> bool {
        let line = [one, other].map(|p| [p.position[0], p.position[1]]);
        let solid = self.scene.shapes[one.body as usize].solid;
        self.of_solid(solid).any(|crack| crosses(line, crack))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_cross_by_hand() {
        let crack = [[0.0, 0.0], [2.0, 0.0]];
        assert!(crosses([[1.0, -0.5], [1.0, 0.5]], crack));
        assert!(crosses([[1.5, -0.5], [2.4, 0.5]], crack));
        assert!(!crosses([[1.8, -0.5], [2.6, 0.5]], crack), "beyond the end");
        for beside in [1e-16, 0.0, -1e-16] {
            assert!(crosses([[2.0 + beside, -0.5], [2.0 + beside, 0.5]], crack), "it ends on the line");
        }
        assert!(!crosses([[1.0, 0.5], [1.0, 1.5]], crack), "above it");
        assert!(!crosses([[2.5, 0.0], [3.0, 0.0]], crack), "on its line, beyond the end");
        assert!(!crosses([[1.5, 0.0], [2.5, 0.0]], crack), "along it");
        for on_it in [1e-16, 0.0, -1e-16] {
            assert!(crosses([[1.0, on_it], [1.0, -0.5]], crack), "a row on it is on its left");
            assert!(!crosses([[1.0, on_it], [1.0, 0.5]], crack));
        }
    }
}
