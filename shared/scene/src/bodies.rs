//! Bodies: solid shapes that make one connected piece.

use crate::{Geometry, Phase, Scene, Shape, geometry};

impl Scene {
    /// The solid shapes by connected pieces: indices in [`Scene::shapes`], in the file's order. Shapes of one solid are
    /// one piece where particles of both lie within the support of the solid's kernel.
    pub fn bodies(&self) -> Vec<Vec<usize>> {
        let mut bodies: Vec<Vec<usize>> = Vec::new();
        for index in (0..self.shapes.len()).filter(|&k| self.shapes[k].phase == Phase::Solid) {
            let touches = |body: &Vec<usize>| body.iter().any(|&other| self.one_piece(index, other));
            let (joined, mut apart): (Vec<_>, Vec<_>) = bodies.into_iter().partition(touches);
            let mut body: Vec<usize> = joined.into_iter().flatten().chain([index]).collect();
            body.sort_unstable();
            apart.push(body);
            bodies = apart;
        }
        bodies.sort();
        bodies
    }

    /// Whether one of a body's shapes has a clamp.
    pub fn is_held(&self, body: &[usize]) -> bool {
        body.iter().any(|&k| !self.shapes[k].clamp.is_empty())
    }

    /// What nothing holds would fall through walls: those that say nothing of `contact` can be touched where a body has
    /// no clamp.
    pub(crate) fn touch_free_bodies(&mut self, said: &[bool]) {
        if self.bodies().iter().all(|body| self.is_held(body)) {
            return;
        }
        for (shape, _) in self.shapes.iter_mut().zip(said).filter(|(_, said)| !**said) {
            shape.contact = shape.phase == Phase::Wall;
        }
    }

    fn one_piece(&self, a: usize, b: usize) -> bool {
        let (a, b) = (&self.shapes[a], &self.shapes[b]);
        let Some(solid) = a.solid.filter(|_| a.solid == b.solid).and_then(|k| self.solids.get(k)) else {
            return false;
        };
        // Particles of the outer rows lie half a spacing inside.
        let spacing = self.spacing(a);
        gap(self, a, b) < (2.0 * solid.smoothing_ratio - 1.0) * spacing * (1.0 - 1e-9)
    }
}

/// Distance of two shapes' surfaces, m; zero or less where they touch or overlap.
fn gap(scene: &Scene, a: &Shape, b: &Shape) -> f64 {
    let round = |shape: &Shape| match shape.geometry {
        Geometry::Disc { center, radius } => Some((center, radius)),
        Geometry::Ring { center, outer, .. } => Some((center, outer)),
        Geometry::Box(_) | Geometry::Tank { .. } => None,
    };
    let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    match (round(a), round(b)) {
        (Some((c, r)), Some((d, s))) => length(std::array::from_fn(|k| c[k] - d[k])) - r - s,
        (Some((center, radius)), None) => geometry::distance(&b.geometry, &center) - radius,
        (None, Some((center, radius))) => geometry::distance(&a.geometry, &center) - radius,
        (None, None) => {
            let (a, b) = (geometry::bounding_box(a, scene), geometry::bounding_box(b, scene));
            length(std::array::from_fn(|k| (a.min[k] - b.max[k]).max(b.min[k] - a.max[k]).max(0.0)))
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Scene, parse};
    use std::path::Path;

    fn scene(shapes: &[&str]) -> Scene {
        let head = "resolution = 0.01\nend_time = 1.0\n[solid]\nmodel = \"hypoelastic\"\ndensity = 1000.0\n\
                    youngs_modulus = 1e6\npoissons_ratio = 0.3\nsmoothing_ratio = 1.5\n\
                    [[shape]]\nname = \"floor\"\nphase = \"wall\"\nbox = { min = [0.0, -0.1], max = [1.0, 0.0] }\n";
        let shape =
            |(k, text): (usize, &&str)| format!("[[shape]]\nname = \"s{k}\"\nphase = \"solid\"\n{text}\n");
        let text: String = shapes.iter().enumerate().map(shape).collect();
        parse(&format!("{head}{text}"), Path::new("x.toml"), &[]).expect("a right scene")
    }

    const LEFT: &str = "box = { min = [0.0, 0.0], max = [0.1, 0.1] }";
    const BESIDE: &str = "box = { min = [0.11, 0.0], max = [0.2, 0.1] }";
    const HELD: &str =
        "box = { min = [0.11, 0.0], max = [0.2, 0.1] }\nclamp = { min = [0.11, 0.0], max = [0.2, 0.02] }";
    const FAR: &str = "box = { min = [0.12, 0.0], max = [0.2, 0.1] }";
    const BALL: &str = "disc = { center = [0.15, 0.15], radius = 0.05 }";

    #[test]
    fn shapes_within_the_support_are_one_piece() {
        // 2h = 3 dx: the outer rows of surfaces 1 dx apart lie 2 dx apart, of surfaces 2 dx apart 3 dx.
        assert_eq!(scene(&[LEFT, BESIDE]).bodies(), [vec![1, 2]]);
        assert_eq!(scene(&[LEFT, FAR]).bodies(), [vec![1], vec![2]]);
        // The ball stands on the first and is 2.07 dx away from the second; one that touches both joins them.
        assert_eq!(scene(&[FAR, LEFT, BALL]).bodies(), [vec![1, 3], vec![2]]);
        let wide = "disc = { center = [0.11, 0.15], radius = 0.05 }";
        assert_eq!(scene(&[FAR, LEFT, wide]).bodies(), [vec![1, 2, 3]]);
    }

    #[test]
    fn walls_can_be_touched_where_a_body_is_free() {
        let contact = |shapes: &[&str]| scene(shapes).shapes[0].contact;
        assert!(contact(&[LEFT]));
        assert!(contact(&[LEFT, &HELD.replace("0.11", "0.13")]), "one of the two is free");
        assert!(!contact(&[HELD]));
        assert!(!contact(&[LEFT, HELD]), "one piece, and it is held");
    }
}
