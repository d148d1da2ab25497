//! The scenes of the suite, and what its cases measure on a model.

use halfstep_scene::{self as scene, Block, Geometry, Phase, Scene};
use halfstep_solid::{Load, SolidModel};
use halfstep_sph::lane::Isa;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::StateRecord;
use std::path::Path;

/// A model under test.
#[derive(Clone, Copy)]
pub struct Make<const D: usize> {
    /// Makes it for a scene.
    pub build: fn(&Scene, Isa) -> Option<Box<dyn SolidModel<D>>>,
    /// What its scenes say in `[solid]` about it: a line of TOML.
    pub keys: &'static str,
}
pub(super) type Model<const D: usize> = Box<dyn SolidModel<D>>;

pub(super) const MATERIAL: &str = r#"
    resolution = 0.01
    end_time = 1.0
    gravity = [0.0, 0.0]
    [solid]
    density = 1000.0
"#;
/// Of models that strain.
const ELASTIC: &str = "youngs_modulus = 1e6\npoissons_ratio = 0.3\n";
pub(super) const BLOCK: &str = r#"
    [[shape]]
    name = "block"
    phase = "solid"
    box = { min = [0.0, 0.0], max = [0.2, 0.15] }
"#;
/// Thrown at the block from the right.
pub(super) const BALL: &str = r#"
    [[shape]]
    name = "ball"
    phase = "solid"
    disc = { center = [0.29, 0.075], radius = 0.05 }
    velocity = [-4.0, 0.0]
"#;
pub(super) const FLOOR: &str = r#"
    [[shape]]
    name = "floor"
    phase = "wall"
    box = { min = [-0.1, -0.08], max = [0.3, -0.02] }
    contact = true
"#;

/// A scene of parts, the material first.
pub(super) fn parse<const D: usize>(make: Make<D>, parts: &[&str], overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.into()).collect();
    let elastic = if make.keys.contains("\"rigid\"") { "" } else { ELASTIC };
    let text =
        [MATERIAL, elastic, make.keys, "\n"].into_iter().chain(parts.iter().copied()).collect::<String>();
    let plane = scene::parse(&text, Path::new("solid.toml"), &overrides).expect("a right scene");
    if D == 2 { plane } else { in_space(plane) }
}

/// Extent of all bodies along z in three dimensions, m.
pub(super) const DEPTH: f64 = 0.08;

/// The same shapes with a depth: boxes become prisms, discs balls in the middle; walls stand out to both sides.
pub(super) fn in_space(mut scene: Scene) -> Scene {
    scene.dimension = 3;
    let deepen = |block: &mut Block, beyond: f64| (block.min[2], block.max[2]) = (-beyond, DEPTH + beyond);
    for shape in &mut scene.shapes {
        match &mut shape.geometry {
            Geometry::Box(block) => deepen(block, if shape.phase == Phase::Wall { 0.1 } else { 0.0 }),
            Geometry::Disc { center, .. } => center[2] = 0.5 * DEPTH,
            other => panic!("no shape of the suite: {other:?}"),
        }
        shape.clamp.iter_mut().for_each(|block| deepen(block, 0.0));
    }
    scene
}

/// Volume of a particle of these scenes, m³ (2D: m²).
pub(super) fn volume<const D: usize>() -> f64 {
    0.01_f64.powi(D as i32)
}

pub(super) fn model<const D: usize>(make: Make<D>, parts: &[&str], overrides: &[&str]) -> Model<D> {
    (make.build)(&parse(make, parts, overrides), Isa::detect()).expect("a solid")
}

/// A vector along an axis.
pub(super) fn along<const D: usize>(axis: usize, value: f64) -> [f64; D] {
    std::array::from_fn(|d| if d == axis { value } else { 0.0 })
}

/// Present state of a particle as the wire has it.
pub(super) fn record<const D: usize>(model: &Model<D>, particle: u32) -> StateRecord {
    let mut out = Vec::new();
    model.records(&[particle], &mut out);
    out[0]
}

pub(super) fn reference<const D: usize>(model: &Model<D>, particle: u32) -> [f64; D] {
    model.particles().reference[particle as usize]
}

pub(super) fn velocity<const D: usize>(model: &Model<D>, particle: u32) -> [f64; D] {
    model.particles().velocity[particle as usize]
}

pub(super) fn mass<const D: usize>(model: &Model<D>, particle: u32) -> f64 {
    model.particles().mass[particle as usize]
}

pub(super) fn all<const D: usize>(model: &Model<D>) -> impl Iterator<Item = u32> + use<D> {
    0..model.particles().len() as u32
}

/// The stages of a step of this length, s, whenever it is.
pub(super) fn both(dt: f64) -> [HalfStep; 2] {
    HalfStep::begin(0, 0.0).lasting(dt).both()
}

/// One step of the lock-step under one load.
pub(super) fn step<const D: usize>(model: &mut Model<D>, dt: f64, sub_steps: u32, load: &Load<D>) {
    for half_step in both(dt) {
        model.advance(&half_step, sub_steps, load).expect("within bounds");
    }
}

pub(super) fn momentum<const D: usize>(model: &Model<D>) -> [f64; D] {
    all(model).fold([0.0; D], |sum, p| {
        let (m, v) = (mass(model, p), velocity(model, p));
        std::array::from_fn(|d| sum[d] + m * v[d])
    })
}

/// About the origin: the components xy, yz and zx; in two dimensions the first.
pub(super) fn angular_momentum<const D: usize>(model: &Model<D>) -> Vec<f64> {
    let about = |[a, b]: [usize; 2]| {
        let of = |p| {
            let (x, v) = (record(model, p).position, velocity(model, p));
            mass(model, p) * (x[a] * v[b] - x[b] * v[a])
        };
        all(model).map(of).sum()
    };
    [[0, 1], [1, 2], [2, 0]].into_iter().filter(|axes| axes.iter().all(|&a| a < D)).map(about).collect()
}

/// Distance of two points, m.
pub(super) fn apart<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Position as the record has it, m.
pub(super) fn position<const D: usize>(model: &Model<D>, particle: u32) -> [f64; D] {
    let position = record(model, particle).position;
    std::array::from_fn(|d| position[d])
}
