//! Particle spacings: the scene's, and those that solids have of their own.

use crate::{Geometry, Lattice, Scene, Shape};

impl Scene {
    /// Spacing of a shape's particles, m.
    pub fn spacing(&self, shape: &Shape) -> f64 {
        shape.spacing.unwrap_or(self.resolution)
    }

    /// Spacing of the particles of the solid of that index, m.
    pub fn solid_spacing(&self, solid: usize) -> f64 {
        let shape = self.shapes.iter().find(|shape| shape.solid == Some(solid));
        shape.map_or(self.resolution, |shape| self.spacing(shape))
    }

    /// Mean of the fluid's spacing and that of the solid of that index, m: how far apart their particles are where the
    /// two touch.
    pub fn interface_spacing(&self, solid: usize) -> f64 {
        0.5 * (self.resolution + self.solid_spacing(solid))
    }

    /// Shapes that say nothing take the spacing that another shape of their solid has.
    pub(crate) fn share_spacings(&mut self) {
        for k in 0..self.solids.len() {
            let said =
                self.shapes.iter().filter(|shape| shape.solid == Some(k)).find_map(|shape| shape.spacing);
            for shape in self.shapes.iter_mut().filter(|shape| shape.solid == Some(k)) {
                shape.spacing = shape.spacing.or(said);
            }
        }
    }
}

/// Extent of a geometry's thinnest side, m.
pub(crate) fn thickness(geometry: &Geometry, dimension: usize) -> f64 {
    match geometry {
        Geometry::Box(b) | Geometry::Tank { cavity: b, .. } => {
            (0..dimension).map(|a| b.max[a] - b.min[a]).fold(f64::INFINITY, f64::min)
        }
        Geometry::Disc { radius, .. } => 2.0 * radius,
        Geometry::Ring { inner, outer, .. } => outer - inner,
        Geometry::Polygon(polygon) => polygon.thickness().0,
        Geometry::Moved(moved) => thickness(&moved.geometry, dimension),
    }
}

/// Spacing with which so many particles lie across a geometry's thinnest side, m.
pub(crate) fn with_across(geometry: &Geometry, dimension: usize, lattice: Lattice, across: u32) -> f64 {
    thickness(geometry, dimension) / f64::from(across + u32::from(lattice == Lattice::Nodal))
}
