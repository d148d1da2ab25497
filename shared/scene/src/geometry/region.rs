//! Which places a shape holds, prepared for questions about many points.

use super::points::{self, Spacing, sides};
use super::polygon::Edges;
use super::{Moved, TOLERANCE, holds};
use crate::{Block, Geometry, Scene, Shape, Void};

/// A geometry, ready for questions.
#[derive(Clone, Debug)]
enum Prepared<'s> {
    Plain(&'s Geometry),
    Polygon(Edges),
    Moved(&'s Moved, Box<Prepared<'s>>),
}

impl<'s> Prepared<'s> {
    fn of(geometry: &'s Geometry) -> Self {
        match geometry {
            Geometry::Polygon(polygon) => Self::Polygon(Edges::new(polygon)),
            Geometry::Moved(moved) => Self::Moved(moved, Box::new(Self::of(&moved.geometry))),
            _ => Self::Plain(geometry),
        }
    }

    /// Whether the geometry, grown by `margin` (shrunk where negative), holds a point.
    fn contains<const D: usize>(&self, spacing: Spacing, p: &[f64; D], margin: f64) -> bool {
        match self {
            Self::Plain(geometry) => contains(geometry, spacing, p, margin),
            Self::Polygon(edges) => edges.contains(&[p[0], p[1]], margin),
            Self::Moved(moved, inner) => {
                moved.copies().any(|copy| inner.contains(spacing, &moved.back(copy, *p), margin))
            }
        }
    }
}

/// The places of a shape: its geometry's, less those of the voids before it.
#[derive(Clone, Debug)]
pub(super) struct Region<'s> {
    prepared: Prepared<'s>,
    spacing: Spacing,
    voids: Vec<Prepared<'s>>,
}

impl<'s> Region<'s> {
    pub(super) fn new(geometry: &'s Geometry, spacing: Spacing, voids: &[&'s Void]) -> Self {
        let voids = voids.iter().map(|void| Prepared::of(&void.geometry)).collect();
        Self { prepared: Prepared::of(geometry), spacing, voids }
    }

    /// Whether it, grown by `margin` (shrunk where negative), m, holds a point.
    pub(super) fn contains<const D: usize>(&self, p: &[f64; D], margin: f64) -> bool {
        self.prepared.contains(self.spacing, p, margin) && !self.is_void(p)
    }

    /// Whether a void before the shape holds a place.
    pub(super) fn is_void<const D: usize>(&self, p: &[f64; D]) -> bool {
        // What lies on a void's surface is outside.
        let margin = -TOLERANCE * self.spacing.dx;
        self.voids.iter().any(|void| void.contains(self.spacing, p, margin))
    }
}

/// The places of some shapes, less those of the voids before each.
#[derive(Clone, Debug)]
pub struct Regions<'s>(Vec<Region<'s>>);

impl<'s> Regions<'s> {
    /// Of the shapes that are asked for.
    pub fn of(scene: &'s Scene, asked: impl Fn(&Shape) -> bool) -> Self {
        let own = scene.shapes.iter().enumerate().filter(|(_, shape)| asked(shape));
        let region = |(index, shape): (usize, &'s Shape)| {
            Region::new(&shape.geometry, Spacing::of(scene, shape), &voids_before(scene, index))
        };
        Self(own.map(region).collect())
    }

    /// Whether one of them, grown by `margin` (shrunk where negative), m, holds a place.
    pub fn hold<const D: usize>(&self, place: &[f64; D], margin: f64) -> bool {
        self.0.iter().any(|region| region.contains(place, margin))
    }
}

/// The voids that a shape of that index does not fill: those before it.
pub(super) fn voids_before(scene: &Scene, index: usize) -> Vec<&Void> {
    scene.voids.iter().filter(|void| void.before <= index).collect()
}

/// Whether a void holds a place of the shape of that index, whichever of the two comes first.
pub fn void_meets<const D: usize>(scene: &Scene, void: &Void, index: usize) -> bool {
    let spacing = Spacing::of(scene, &scene.shapes[index]);
    let places = points::of_shape::<D>(&scene.shapes[index].geometry, spacing);
    let region = Region::new(&void.geometry, spacing, &[void]);
    places.iter().any(|p| region.is_void(&p.position))
}

/// Whether a box, disc, ring or tank, grown by `margin` (shrunk where negative), holds a point.
pub(super) fn contains<const D: usize>(
    geometry: &Geometry,
    spacing: Spacing,
    p: &[f64; D],
    margin: f64,
) -> bool {
    let radius = |center: &[f64; 3]| (0..D).map(|a| (p[a] - center[a]).powi(2)).sum::<f64>().sqrt();
    match geometry {
        Geometry::Box(block) => holds(block, p, margin),
        Geometry::Disc { center, radius: outer } => radius(center) <= outer + margin,
        Geometry::Ring { center, inner, outer } => {
            (inner - margin..=outer + margin).contains(&radius(center))
        }
        Geometry::Tank { cavity, open } => {
            let thickness = spacing.layers() as f64 * spacing.dx;
            let mut around = Block { min: cavity.min, max: cavity.max };
            let mut in_cavity = true;
            for a in 0..D {
                let [low, high] = sides(a).map(|side| !open.contains(&side));
                around.min[a] -= if low { thickness } else { 0.0 };
                around.max[a] += if high { thickness } else { 0.0 };
                // Open sides do not end the cavity here: the outer box does.
                in_cavity &= !(low && p[a] <= cavity.min[a] + margin);
                in_cavity &= !(high && p[a] >= cavity.max[a] - margin);
            }
            holds(&around, p, margin) && !in_cavity
        }
        Geometry::Polygon(_) | Geometry::Moved(_) => Prepared::of(geometry).contains(spacing, p, margin),
    }
}
