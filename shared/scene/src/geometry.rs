//! Where the particles of a scene are at first.
//!
//! Every shape carries its own lattice of spacing dx, the scene's or its solid's own. A box's lattice starts at its
//! lowest corner and has round(extent / dx) cells along each axis; a disc's or ring's is symmetric about its centre.
//! [`Lattice`] says whether particles sit at the cells' centres or at their corners.
//!
//! A polygon of solid has a lattice along its longest side, one of fluid along the axes; a wall has rows parallel to
//! its sides. A shape that is turned takes its lattice along; a solid may have its lattice turned inside of it.
//!
//! Where shapes overlap, the solid wins over the wall, the wall over the fluid, and in one phase the shape that comes
//! first in the file. The loser has no particle inside the winner nor closer than dx / 2 (the mean where spacings
//! differ) to one of its particles.

mod alone;
mod at_start;
mod boxes;
mod cells;
mod crossing;
mod irregular;
mod line;
mod moved;
mod nearest;
mod occupied;
mod outline;
mod pieces;
mod plate;
mod points;
mod polygon;
mod region;
mod sections;
mod surface;
#[cfg(test)]
mod tests;
mod wall_surface;

use crate::{Block, Geometry, Lattice, Motion, Phase, Scene, Shape, dispatch};
pub use alone::{measure_alone, places_alone};
pub use at_start::cantilever_velocity;
use at_start::{added, field_velocity, initial_pressure, surfaces};
pub use boxes::{around, bounding_box, domain, fluid_boxes};
pub use cells::{CellSet, Cells, cell};
pub use crossing::{Cracks, crosses};
pub use line::along;
pub use moved::Moved;
pub use nearest::{nearest, nearest_solid};
use occupied::Occupied;
pub(crate) use outline::extent;
pub use pieces::{pieces, touching};
pub use plate::Plate;
pub(crate) use plate::joined;
pub use plate::{least_thickness, second_moments};
use points::Spacing;
pub use points::sides;
pub(crate) use polygon::Fault;
use polygon::Standing;
pub use polygon::twice_area;
pub use polygon::{MAX_CORNERS, Polygon};
use region::{Region, voids_before};
pub use region::{Regions, void_meets};
pub use sections::{Section, left_by_voids, sections};
pub use surface::Surface;
pub use wall_surface::{WallCorner, WallSurface, wall_corners};
use wall_surface::{find_edges, where_walls_meet};

/// Relative tolerance of every comparison of lengths, in spacings.
const TOLERANCE: f64 = 1e-9;

/// A fluid particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluidPoint<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Velocity, m/s.
    pub velocity: [f64; D],
    /// Pressure, Pa, above the background's: rho g times the depth below its shape's highest point, or zero; and what
    /// belongs to its velocity field.
    pub pressure: f64,
    /// Index of its shape in [`Scene::shapes`].
    pub shape: u32,
}

/// A solid particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidPoint<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Its place on the lattice, m: where it lies, unless the arrangement of its solid is irregular.
    pub site: [f64; D],
    /// Velocity, m/s; zero where clamped.
    pub velocity: [f64; D],
    /// Whether it keeps zero velocity.
    pub clamped: bool,
    /// Index of its shape in [`Scene::shapes`].
    pub body: u32,
    /// Of a shape that is repeated, which copy.
    pub copy: u32,
}

impl<const D: usize> SolidPoint<D> {
    /// It begins in the box of its shape's load, which acts on it unless it is clamped.
    pub fn is_in_load(&self, scene: &Scene) -> bool {
        self.would_be_in_load(scene, &self.position)
    }

    /// The box of its shape's load holds a place.
    pub fn would_be_in_load(&self, scene: &Scene, place: &[f64; D]) -> bool {
        let shape = &scene.shapes[self.body as usize];
        let tolerance = 1e-6 * scene.spacing(shape);
        shape.load.as_ref().is_some_and(|load| holds(&load.within, place, tolerance))
    }
}

/// A wall particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPoint<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Velocity of the wall, m/s.
    pub velocity: [f64; D],
    /// Unit normal of the surface it stands for, out of the wall. In a corner: the diagonal.
    pub normal: [f64; D],
    /// Below that surface, m; infinite behind an edge, round which water flows.
    pub depth: f64,
    /// It lies within the kernel's support of an edge.
    pub at_edge: bool,
    /// Whether it stands for two or more surfaces: all components of a velocity are reversed.
    pub corner: bool,
    /// Free slip (true) or no slip (false).
    pub free_slip: bool,
    /// Index of its shape in [`Scene::shapes`].
    pub shape: u32,
}

impl<const D: usize> WallPoint<D> {
    /// It stands for one surface: it lies neither in a corner nor behind an edge.
    pub fn has_one_face(&self) -> bool {
        !self.corner && self.depth.is_finite()
    }
}

/// All particles of a scene: shapes in the file's order, in a shape z outermost and x innermost.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout<const D: usize> {
    /// Fluid particles.
    pub fluid: Vec<FluidPoint<D>>,
    /// Solid particles.
    pub solid: Vec<SolidPoint<D>>,
    /// Wall particles.
    pub wall: Vec<WallPoint<D>>,
}

impl<const D: usize> Layout<D> {
    /// Without the particles of all solids of the scene but one.
    pub fn with_solid(mut self, scene: &Scene, solid: usize) -> Self {
        self.solid.retain(|p| scene.shapes[p.body as usize].solid == Some(solid));
        self
    }

    /// Particles of each solid, in the order of [`Scene::solids`].
    pub fn solid_counts(&self, scene: &Scene) -> Vec<u64> {
        let mut counts = vec![0; scene.solids.len()];
        for solid in self.solid.iter().filter_map(|p| scene.shapes[p.body as usize].solid) {
            counts[solid] += 1;
        }
        counts
    }

    /// Particles of each shape of the scene.
    pub fn shape_counts(&self, scene: &Scene) -> Vec<u64> {
        let mut counts = vec![0; scene.shapes.len()];
        self.solid.iter().for_each(|point| counts[point.body as usize] += 1);
        counts
    }

    /// How many there are.
    pub fn counts(&self) -> Counts {
        let [fluid, solid, wall] = [self.fluid.len(), self.solid.len(), self.wall.len()].map(|n| n as u64);
        Counts { fluid, solid, wall }
    }
}

/// Numbers of particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Fluid particles.
    pub fluid: u64,
    /// Solid particles.
    pub solid: u64,
    /// Wall particles.
    pub wall: u64,
}

impl Counts {
    /// All particles; `u64::MAX` where the sum is larger.
    pub fn total(&self) -> u64 {
        self.fluid.saturating_add(self.solid).saturating_add(self.wall)
    }
}

/// Places the particles of a scene.
///
/// # Panics
/// Where `D` is not the scene's dimension.
pub fn layout<const D: usize>(scene: &Scene) -> Layout<D> {
    irregular::rearranged(scene, on_lattices(scene, &[Phase::Solid, Phase::Wall, Phase::Fluid]))
}

/// Places the solid particles of a scene, which lose nothing to walls and fluid.
///
/// # Panics
/// As [`layout`].
pub fn solids<const D: usize>(scene: &Scene) -> Layout<D> {
    irregular::rearranged(scene, on_lattices(scene, &[Phase::Solid]))
}

/// Places the particles of the first of the phases, which lose nothing to later ones.
fn on_lattices<const D: usize>(scene: &Scene, phases: &[Phase]) -> Layout<D> {
    assert_eq!(D, scene.dimension, "layout of another dimension than the scene's");
    let mut layout = Layout { fluid: Vec::new(), solid: Vec::new(), wall: Vec::new() };
    let widest = scene.shapes.iter().map(|shape| scene.spacing(shape)).fold(scene.resolution, f64::max);
    let mut occupied = Occupied::new(widest);
    let standing: Vec<Option<Standing>> = match phases.contains(&Phase::Wall) {
        true => (0..scene.shapes.len()).map(|index| polygon::standing(scene, index)).collect(),
        false => Vec::new(),
    };
    // Places of walls that are taken, with their shapes.
    let mut shared = Vec::new();
    for &phase in phases {
        for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, s)| s.phase == phase) {
            let spacing = Spacing::of(scene, shape);
            let standing = standing.get(index).and_then(Option::as_ref);
            let [held, rows] = standing.map_or([&shape.geometry; 2], |own| [&own.region, &own.rows]);
            let region = Region::new(held, spacing, &voids_before(scene, index));
            let mut kept = points::with_copies::<D>(rows, spacing);
            if standing.is_some() {
                kept.retain(|(p, _)| region.contains(&p.position, TOLERANCE * spacing.dx));
            }
            kept.retain(|(p, _)| !region.is_void(&p.position));
            let free = |(p, _): &(points::Point<D>, u32)| occupied.is_free(&p.position, spacing.dx);
            if phase == Phase::Wall {
                let taken = kept.iter().filter(|point| !free(point));
                shared.extend(taken.map(|(p, _)| (p.position, index as u32)));
            }
            kept.retain(free);
            occupied.add(region, spacing, phase, kept.iter().map(|(p, _)| p.position));
            let velocity = truncated(shape.velocity);
            match phase {
                Phase::Solid => {
                    let point = |(p, copy): &(points::Point<D>, u32)| {
                        solid_point(scene, shape, [index as u32, *copy], p.position)
                    };
                    layout.solid.extend(kept.iter().map(point));
                }
                Phase::Wall => layout.wall.extend(kept.iter().map(|(p, _)| WallPoint {
                    position: p.position,
                    velocity,
                    normal: p.normal,
                    depth: p.depth,
                    at_edge: false,
                    corner: p.corner,
                    free_slip: shape.free_slip,
                    shape: index as u32,
                })),
                Phase::Fluid => {
                    let surfaces = if shape.hydrostatic { surfaces(scene, shape, &kept) } else { Vec::new() };
                    layout.fluid.extend(kept.iter().map(|(p, copy)| FluidPoint {
                        position: p.position,
                        velocity: added(velocity, field_velocity(scene, shape, &p.position)),
                        pressure: initial_pressure(
                            scene,
                            shape,
                            &p.position,
                            surfaces.get(*copy as usize).copied(),
                        ),
                        shape: index as u32,
                    }));
                }
            }
        }
    }
    where_walls_meet(scene, &mut layout.wall, &shared);
    find_edges(scene, &mut layout.wall);
    layout
}

/// The numbers of particles from the shapes' sizes, without placing any: overlaps count twice, curved shapes by
/// their area.
pub fn estimate(scene: &Scene) -> Counts {
    let mut counts = [0_u64; 3];
    for shape in &scene.shapes {
        // A float beyond the range becomes u64::MAX.
        let n = points::expected(&shape.geometry, Spacing::of(scene, shape), scene.dimension) as u64;
        let count = &mut counts[shape.phase as usize];
        *count = count.saturating_add(n);
    }
    let [fluid, solid, wall] = [Phase::Fluid, Phase::Solid, Phase::Wall].map(|p| counts[p as usize]);
    Counts { fluid, solid, wall }
}

/// Distance of a point to a shape, m: zero inside. A tank's is that to its cavity.
pub fn distance(geometry: &Geometry, at: &[f64; 3]) -> f64 {
    let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let from = |center: &[f64; 3]| length(std::array::from_fn(|a| at[a] - center[a]));
    match geometry {
        Geometry::Box(b) | Geometry::Tank { cavity: b, .. } => {
            length(std::array::from_fn(|a| (b.min[a] - at[a]).max(at[a] - b.max[a]).max(0.0)))
        }
        Geometry::Disc { center, radius } => (from(center) - radius).max(0.0),
        Geometry::Ring { center, inner, outer } => {
            let r = from(center);
            (inner - r).max(r - outer).max(0.0)
        }
        Geometry::Polygon(polygon) => polygon.distance(&[at[0], at[1]]),
        Geometry::Moved(moved) => {
            let distances = moved.copies().map(|copy| distance(&moved.geometry, &moved.back(copy, *at)));
            distances.fold(f64::INFINITY, f64::min)
        }
    }
}

/// How a clamp moves the particle of a solid, with a wall or by its shape's own motion: `None` where it stands still.
pub fn clamp_motion<const D: usize>(scene: &Scene, point: &SolidPoint<D>) -> Option<Motion> {
    let shape = scene.shapes.get(point.body as usize)?;
    let tolerance = TOLERANCE * scene.spacing(shape);
    let clamp = shape.clamp.iter().position(|block| holds(block, &point.position, tolerance))?;
    let Some(name) = shape.clamp_with.get(clamp).and_then(Option::as_ref) else {
        return shape.motion.clone();
    };
    scene.shapes.iter().find(|wall| wall.name == *name)?.motion.clone()
}

/// Whether each clamp of a solid shape holds one of its particles.
pub(crate) fn clamp_catches(scene: &Scene, shape: &Shape) -> Vec<bool> {
    dispatch!(scene.dimension, D => catches::<D>(scene, shape)).unwrap_or_default()
}

fn catches<const D: usize>(scene: &Scene, shape: &Shape) -> Vec<bool> {
    let points = points::of_shape::<D>(&shape.geometry, Spacing::of(scene, shape));
    let tolerance = TOLERANCE * scene.resolution;
    let any = |block| points.iter().any(|p| holds(block, &p.position, tolerance));
    shape.clamp.iter().map(any).collect()
}

fn solid_point<const D: usize>(
    scene: &Scene,
    shape: &Shape,
    [body, copy]: [u32; 2],
    position: [f64; D],
) -> SolidPoint<D> {
    let clamped = shape.clamp.iter().any(|block| holds(block, &position, TOLERANCE * scene.resolution));
    let mut velocity = truncated(shape.velocity);
    let solid = shape.solid.and_then(|k| scene.solids.get(k));
    if let (Some(mode), Some(solid)) = (&shape.cantilever_mode, solid) {
        velocity[1] += cantilever_velocity(mode, solid.sound_speed(), position[0]);
    }
    SolidPoint {
        position,
        site: position,
        velocity: if clamped { [0.0; D] } else { velocity },
        clamped,
        body,
        copy,
    }
}

/// Whether a point lies in a box, its surface included, or within `tolerance` (m) of it.
pub fn holds<const D: usize>(block: &Block, position: &[f64; D], tolerance: f64) -> bool {
    (0..D).all(|a| block.min[a] - tolerance <= position[a] && position[a] <= block.max[a] + tolerance)
}

fn truncated<const D: usize>(vector: [f64; 3]) -> [f64; D] {
    std::array::from_fn(|a| vector[a])
}

impl Spacing {
    fn of(scene: &Scene, shape: &Shape) -> Self {
        Self {
            dx: scene.spacing(shape),
            nodal: scene.numerics.lattice == Lattice::Nodal,
            wall: shape.phase == Phase::Wall,
            aligned: shape.phase == Phase::Solid,
            support: 2.0 * scene.smoothing_ratio,
            // A square lattice that is turned by right angles is the same one.
            turn: shape.lattice_angle % 90.0,
        }
    }
}
