//! Velocities and pressures that particles begin with.

use super::outline;
use super::points::{Point, Spacing};
use crate::{CantileverMode, Geometry, Scene, Shape};

/// First root of cos(kL) cosh(kL) = -1.
const FIRST_MODE: f64 = 1.875_104_068_711_961_2;

/// Velocity across a cantilever in its first bending mode (Landau and Lifshitz, Theory of Elasticity, section 25):
/// fraction c_0 F(x) / F(L) with F(x) = (cos kL + cosh kL)(cosh kx - cos kx) + (sin kL - sinh kL)(sinh kx - sin kx).
/// Zero behind the root. The crate libm's functions: the same bits on every machine.
pub fn cantilever_velocity(mode: &CantileverMode, sound_speed: f64, x: f64) -> f64 {
    use libm::{cos, cosh, sin, sinh};
    let end = FIRST_MODE;
    let shape = |kx: f64| {
        (cos(end) + cosh(end)) * (cosh(kx) - cos(kx)) + (sin(end) - sinh(end)) * (sinh(kx) - sin(kx))
    };
    let along = ((x - mode.root) / mode.length * end).max(0.0);
    mode.fraction * sound_speed * shape(along) / shape(end)
}

fn in_plane<const D: usize>(position: &[f64; D]) -> [f64; 2] {
    [position[0], position[1]]
}

pub(super) fn field_velocity<const D: usize>(scene: &Scene, shape: &Shape, position: &[f64; D]) -> [f64; 2] {
    let gravity = scene.gravity_magnitude();
    shape.velocity_field.map_or([0.0; 2], |field| field.velocity(in_plane(position), gravity))
}

pub(super) fn added<const D: usize>(mut velocity: [f64; D], field: [f64; 2]) -> [f64; D] {
    velocity.iter_mut().zip(field).for_each(|(v, f)| *v += f);
    velocity
}

/// Of fluid whose surface has g . x = `surface`, if it begins at rest.
pub(super) fn initial_pressure<const D: usize>(
    scene: &Scene,
    shape: &Shape,
    position: &[f64; D],
    surface: Option<f64>,
) -> f64 {
    let density = scene.fluid.as_ref().map_or(0.0, |fluid| fluid.density);
    let at_rest = surface.map_or(0.0, |surface| density * (fall(scene, position) - surface).max(0.0));
    at_rest + shape.velocity_field.map_or(0.0, |field| field.pressure(in_plane(position), density))
}

/// g . x: gravity's potential falls with depth, so it is least at the highest point.
fn fall<const D: usize>(scene: &Scene, position: &[f64; D]) -> f64 {
    (0..D).map(|a| scene.gravity[a] * position[a]).sum()
}

/// g . x at the surface of each copy of a shape at rest: its highest point, or, where it has no fluid there (a void or
/// another shape has the place, or other copies are higher), half a spacing above its highest particle.
pub(super) fn surfaces<const D: usize>(scene: &Scene, shape: &Shape, kept: &[(Point<D>, u32)]) -> Vec<f64> {
    let g = scene.gravity;
    let size = (0..D).map(|a| g[a] * g[a]).sum::<f64>().sqrt();
    let highest: f64 = match &shape.geometry {
        Geometry::Box(block) | Geometry::Tank { cavity: block, .. } => {
            (0..D).map(|a| (g[a] * block.min[a]).min(g[a] * block.max[a])).sum()
        }
        Geometry::Disc { center, radius: outer } | Geometry::Ring { center, outer, .. } => {
            (0..D).map(|a| g[a] * center[a]).sum::<f64>() - size * outer
        }
        Geometry::Polygon(_) | Geometry::Moved(_) => {
            let thickness = Spacing::of(scene, shape).thickness();
            outline::extent(&shape.geometry, D, thickness, scene.gravity)[0]
        }
    };
    let copies = kept.iter().map(|(_, copy)| copy + 1).max().unwrap_or(0);
    let mut surfaces = vec![f64::INFINITY; copies as usize];
    for (p, copy) in kept {
        let surface = &mut surfaces[*copy as usize];
        *surface = surface.min(fall(scene, &p.position));
    }
    let row = scene.spacing(shape) * size;
    // Particles of a round or pointed top are up to a spacing below it.
    let of_particles = |first: f64| if first - highest < 1.5 * row { highest } else { first - 0.5 * row };
    surfaces.into_iter().map(of_particles).collect()
}
