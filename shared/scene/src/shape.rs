//! Shapes: particles on a lattice inside a geometry, and what a scene says about them.

use crate::{Motion, VelocityField, geometry, names};
use halfstep_sph::Phase;
use serde::{Deserialize, Serialize};

/// Particles on a lattice inside a geometry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Name of the shape; `--set shape.NAME.KEY=VALUE` finds the shape by this name.
    pub name: String,
    /// Phase of the shape.
    #[serde(with = "names::PhaseName")]
    pub phase: Phase,
    /// Solid only: index of what it is made of in [`Scene::solids`](crate::Scene::solids).
    pub solid: Option<usize>,
    /// Where it is.
    pub geometry: Geometry,
    /// Solid only: particle spacing, m; `None`: the scene's resolution.
    #[serde(default)]
    pub spacing: Option<f64>,
    /// Solid only: angle of its lattice against the one that it would have, degrees, counter-clockwise.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub lattice_angle: f64,
    /// Rigid solid only: density, kg/m³; `None`: the solid's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Initial velocity, m/s (a wall: the constant velocity of its surface).
    pub velocity: [f64; 3],
    /// Initial velocity field of a vibrating cantilever, added to `velocity`.
    pub cantilever_mode: Option<CantileverMode>,
    /// Fluid only: initial velocity field, added to `velocity`.
    #[serde(default)]
    pub velocity_field: Option<VelocityField>,
    /// Solid only: particles inside this box keep zero velocity.
    pub clamp: Vec<Block>,
    /// Solid only: the wall that each clamp moves with, by its name; empty where none moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clamp_with: Vec<Option<String>>,
    /// Solid only: a traction that the scene prescribes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<Traction>,
    /// Solid only: ends of a line across which it is cut at the start, in space along z, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crack: Option<[[f64; 3]; 2]>,
    /// Solid only: the body that it is part of; its own where it is empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub body: String,
    /// Prescribed motion of a wall, or of a solid's clamps.
    #[serde(default)]
    pub motion: Option<Motion>,
    /// Wall only: the solid may touch this wall.
    pub contact: bool,
    /// Wall only: free slip (true) or no slip (false) toward the fluid.
    pub free_slip: bool,
    /// Fluid only: start with hydrostatic pressure below the shape's highest point.
    pub hydrostatic: bool,
}

fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

/// A traction on a solid's particles: each takes it on one face of its cell, dx (in space dx²).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Traction {
    /// On the particles whose place in the initial configuration is in this box, m.
    pub within: Block,
    /// Force per area, Pa.
    pub traction: [f64; 3],
    /// How long it takes to grow evenly from nothing, s; 0: it is there at once.
    pub ramp: f64,
}

impl Traction {
    /// Part of it that acts at a time, s.
    pub fn share(&self, time: f64) -> f64 {
        if time < self.ramp { (time / self.ramp).max(0.0) } else { 1.0 }
    }
}

/// A place that stays empty of all shapes that stand after it in the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Void {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub geometry: Geometry,
    /// Number of shapes before it in the file.
    pub before: usize,
}

/// An axis-parallel box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block {
    /// Lowest corner, m.
    pub min: [f64; 3],
    /// Highest corner, m.
    pub max: [f64; 3],
}

/// The geometries a shape can have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Geometry {
    /// An axis-parallel box.
    Box(Block),
    /// A disc (2D) or ball (3D).
    Disc {
        /// Centre, m.
        center: [f64; 3],
        /// Radius, m.
        radius: f64,
    },
    /// A ring (2D) or shell (3D).
    Ring {
        /// Centre, m.
        center: [f64; 3],
        /// Inner radius, m.
        inner: f64,
        /// Outer radius, m.
        outer: f64,
    },
    /// The walls around an axis-parallel cavity, as thick as the kernel asks for.
    Tank {
        /// The cavity.
        cavity: Block,
        /// Sides left out.
        open: Vec<TankSide>,
    },
    /// A region that straight sides bound (2D).
    Polygon(geometry::Polygon),
    /// Another geometry, turned, shifted or repeated.
    Moved(geometry::Moved),
}

impl Shape {
    /// The body that a solid shape is part of.
    pub fn body(&self) -> &str {
        if self.body.is_empty() { &self.name } else { &self.body }
    }

    /// A wall moves as another one does, and so does its surface.
    pub fn moves_like(&self, other: &Self) -> bool {
        self.motion == other.motion && self.velocity == other.velocity
    }

    /// Its geometry where that is a box along the axes.
    pub(crate) fn block(&self) -> Option<Block> {
        match self.geometry {
            Geometry::Box(block) => Some(block),
            _ => None,
        }
    }
}

impl Geometry {
    /// The geometry before it was turned, shifted or repeated.
    pub fn unmoved(&self) -> &Self {
        match self {
            Self::Moved(moved) => moved.geometry.unmoved(),
            _ => self,
        }
    }

    /// Circles bound it.
    pub fn is_round(&self) -> bool {
        matches!(self.unmoved(), Self::Disc { .. } | Self::Ring { .. })
    }

    /// How often it is there: what is repeated is there several times.
    pub fn copies(&self) -> u32 {
        match self {
            Self::Moved(moved) => moved.count,
            _ => 1,
        }
    }
}

/// A side of a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TankSide {
    /// Lowest x.
    Left,
    /// Highest x.
    Right,
    /// Lowest y.
    Bottom,
    /// Highest y.
    Top,
    /// Lowest z.
    Back,
    /// Highest z.
    Front,
}

/// First bending mode of a cantilever (Landau and Lifshitz; Gray 2001): v_y = fraction c_0 F(x) / F(L), c_0 the bulk
/// sound speed, x measured from `root` along the x axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CantileverMode {
    /// Tip speed over the bulk sound speed.
    pub fraction: f64,
    /// x of the clamped end, m.
    pub root: f64,
    /// Free length, m.
    pub length: f64,
}
