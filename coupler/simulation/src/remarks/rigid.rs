//! Remarks on masses, centres and moments of inertia that a scene gives rigid bodies.

use super::magnitudes::DENSITY;
use super::shapes::length;
use halfstep_scene::geometry::{self, Layout, SolidPoint};
use halfstep_scene::{Block, Geometry, RigidBody, Scene};
use halfstep_wire::wide;

/// Mass over that of the shapes from which on it is remarked: what is hollow is lighter than its shapes, nothing is so
/// much heavier.
const HEAVIER: f64 = 5.0;
/// Moment of inertia over that of the shapes with the same mass below which it is remarked: all of the mass within a
/// tenth of the body.
const SLIGHT: f64 = 0.01;

/// What follows from the shapes of a body.
pub(super) struct Mass {
    /// kg (2D: kg/m), and m³ (2D: m²).
    pub(super) mass: f64,
    volume: f64,
    /// The places of its cells, with the mass of each.
    cells: Vec<([f64; 3], f64)>,
    dx: f64,
}

impl Mass {
    /// Of the body of that name of a rigid solid; `None` of one without particles.
    pub(super) fn of<const D: usize>(
        scene: &Scene,
        layout: &Layout<D>,
        solid: usize,
        body: &str,
    ) -> Option<Self> {
        let dx = scene.solid_spacing(solid);
        let cell = dx.powi(D as i32);
        let own = |p: &&SolidPoint<D>| {
            let shape = &scene.shapes[p.body as usize];
            shape.solid == Some(solid) && shape.body() == body
        };
        let mass = |p: &SolidPoint<D>| {
            cell * scene.shapes[p.body as usize].density.unwrap_or(scene.solids[solid].density)
        };
        let cells: Vec<_> = layout.solid.iter().filter(own).map(|p| (wide(p.position), mass(p))).collect();
        let (mass, volume) = (cells.iter().map(|(_, m)| m).sum(), cell * cells.len() as f64);
        (!cells.is_empty()).then_some(Self { mass, volume, cells, dx })
    }

    pub(super) fn center(&self) -> [f64; 3] {
        std::array::from_fn(|d| self.cells.iter().map(|(x, m)| x[d] * m).sum::<f64>() / self.mass)
    }

    fn around(&self, dimension: usize) -> Option<Block> {
        let half = |d: usize| if d < dimension { 0.5 * self.dx } else { 0.0 };
        geometry::around(self.cells.iter().map(|(x, _)| Block {
            min: std::array::from_fn(|d| x[d] - half(d)),
            max: std::array::from_fn(|d| x[d] + half(d)),
        }))
    }

    /// Moment of inertia about the axis through a point, kg m² (2D: kg m).
    pub(super) fn inertia(&self, axis: usize, about: &[f64; 3]) -> f64 {
        let across =
            |x: &[f64; 3]| (0..3).filter(|&d| d != axis).map(|d| (x[d] - about[d]).powi(2)).sum::<f64>();
        self.cells.iter().map(|(x, m)| m * (across(x) + self.dx * self.dx / 6.0)).sum()
    }

    /// How far the body reaches from a point, m.
    fn reach(&self, dimension: usize, from: &[f64; 3]) -> f64 {
        let away = |x: &[f64; 3]| (0..3).map(|d| (x[d] - from[d]).powi(2)).sum::<f64>().sqrt();
        let corner = 0.5 * self.dx * (dimension as f64).sqrt();
        self.cells.iter().map(|(x, _)| away(x) + corner).fold(0.0, f64::max)
    }
}

/// What `bodies` says of mass, centre and inertia.
pub(super) fn given<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (solid, keys) in scene.solids.iter().enumerate().filter_map(|(k, s)| Some((k, s.rigid()?))) {
        for said in &keys.bodies {
            if let Some(shapes) = Mass::of(scene, layout, solid, &said.name) {
                all.extend(mass(scene, said, &shapes));
                all.extend(center(scene, said, &shapes));
                inertia(scene, said, &shapes, all);
            }
        }
    }
}

fn mass(scene: &Scene, said: &RigidBody, shapes: &Mass) -> Option<String> {
    let mass = said.mass?;
    let density = mass / shapes.volume;
    if (DENSITY[0]..=DENSITY[1]).contains(&density) && mass <= HEAVIER * shapes.mass {
        return None;
    }
    let (unit, per) = match scene.dimension {
        2 => ("kg/m", " (a metre across the plane)"),
        _ => ("kg", ""),
    };
    Some(format!(
        "mass = {} {unit} of body `{}` makes {} kg/m³ of it, {} times its shapes' {} {unit}: is the unit right?{per}",
        length(mass),
        said.name,
        length(density),
        length(mass / shapes.mass),
        length(shapes.mass)
    ))
}

fn center(scene: &Scene, said: &RigidBody, shapes: &Mass) -> Option<String> {
    let center = said.center?;
    let away = geometry::distance(&Geometry::Box(shapes.around(scene.dimension)?), &center);
    (away > shapes.dx).then(|| {
        format!(
            "the centre of mass of body `{}`, {:?}, lies {} m beside its shapes, where none of its mass is: `center` \
             is in the scene's coordinates",
            said.name,
            &center[..scene.dimension],
            length(away)
        )
    })
}

fn inertia(scene: &Scene, said: &RigidBody, shapes: &Mass, all: &mut Vec<String>) {
    let Some(given) = said.inertia else { return };
    let (mass, middle) = (said.mass.unwrap_or(shapes.mass), shapes.center());
    let reach = shapes.reach(scene.dimension, &said.center.unwrap_or(middle));
    let most = mass * reach * reach;
    let unit = if scene.dimension == 2 { "kg m" } else { "kg m²" };
    // About z alone in the plane.
    let axes = if scene.dimension == 2 { 2..3 } else { 0..3 };
    for axis in axes {
        let own = mass / shapes.mass * shapes.inertia(axis, &middle);
        let what = match scene.dimension {
            2 => format!("inertia = {} {unit} of body `{}`", length(given[2]), said.name),
            _ => format!("inertia.{axis} = {} {unit} of body `{}`", length(given[axis]), said.name),
        };
        if given[axis] > most {
            all.push(format!(
                "{what} is more than its mass can have: {} at its farthest corner have {} {unit}, and its shapes {}",
                length(mass),
                length(most),
                length(own)
            ));
        } else if given[axis] < SLIGHT * own {
            all.push(format!(
                "{what} is {} times that of its shapes with its mass, {} {unit}: is the unit right?",
                length(given[axis] / own),
                length(own)
            ));
        }
    }
}
