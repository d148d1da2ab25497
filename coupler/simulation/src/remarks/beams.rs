//! Remarks on clamped plates that the fluid at rest would bend beyond all measure.

use super::magnitudes::STIFFNESS;
use super::shapes::{Placed, length};
use halfstep_scene::{Block, Geometry, Scene, Shape, geometry};

/// Deflection by linear theory over the free length from which on it is remarked: soft plates of experiments behind a
/// dam that breaks have up to five.
const TOO_FAR: f64 = 10.0;
/// Least free length of a beam over its thickness.
const SLENDER: f64 = 3.0;
/// Parts of the free length that the load is summed over.
const PARTS: usize = 1000;

/// A plate along an axis, held at one end or both.
struct Beam {
    along: usize,
    /// Ends of the free part, m.
    free: [f64; 2],
    held: [bool; 2],
    thickness: f64,
    /// Middle of its thickness, m.
    middle: f64,
}

impl Beam {
    fn of(scene: &Scene, shape: &Shape) -> Option<Self> {
        let Geometry::Box(body) = &shape.geometry else { return None };
        let extent = |a: usize| body.max[a] - body.min[a];
        let (along, across) = if extent(0) > extent(1) { (0, 1) } else { (1, 0) };
        let tolerance = 0.5 * scene.spacing(shape);
        let spans = |clamp: &&Block| {
            clamp.min[across] < body.min[across] + tolerance
                && clamp.max[across] > body.max[across] - tolerance
        };
        let (mut free, mut held) = ([body.min[along], body.max[along]], [false; 2]);
        for clamp in shape.clamp.iter().filter(spans) {
            if clamp.min[along] < body.min[along] + tolerance && clamp.max[along] > free[0] - tolerance {
                (free[0], held[0]) = (clamp.max[along], true);
            }
            if clamp.max[along] > body.max[along] - tolerance && clamp.min[along] < free[1] + tolerance {
                (free[1], held[1]) = (clamp.min[along], true);
            }
        }
        let beam = Self {
            along,
            free,
            held,
            thickness: extent(across),
            middle: 0.5 * (body.min[across] + body.max[across]),
        };
        (held != [false; 2] && beam.length() > SLENDER * beam.thickness).then_some(beam)
    }

    fn length(&self) -> f64 {
        self.free[1] - self.free[0]
    }

    /// Deflection of the free end, or of the middle where both are held, m: the load, N/m², at each place times what a
    /// unit force there does (any textbook of statics), over the bending stiffness, N m.
    fn deflection(&self, stiffness: f64, load: impl Fn(f64) -> f64) -> f64 {
        let (l, part) = (self.length(), self.length() / PARTS as f64);
        let of_part = |k: usize| {
            let at = (k as f64 + 0.5) * part;
            let from_root = if self.held[0] { at } else { l - at };
            let influence = match self.held {
                [true, true] => {
                    let a = at.min(l - at);
                    a * a * (3.0 * l - 4.0 * a) / 48.0
                }
                _ => from_root * from_root * (3.0 * l - from_root) / 6.0,
            };
            load(self.free[0] + at) * influence * part
        };
        (0..PARTS).map(of_part).sum::<f64>() / stiffness
    }
}

/// Deflection of a clamped plate by beam theory under the pressure of the fluid where it is at the start, and its free
/// length, m; `None` of what is no such plate.
pub(super) fn deflection(scene: &Scene, shape: &Shape) -> Option<[f64; 2]> {
    let down = scene.gravity[1];
    let fluid =
        scene.fluid.as_ref().filter(|_| scene.dimension == 2 && down < 0.0 && scene.gravity[0] == 0.0)?;
    let material = shape.solid.and_then(|k| scene.solids.get(k)).filter(|solid| solid.rigid().is_none())?;
    let beam = Beam::of(scene, shape)?;
    let water: Vec<Block> = geometry::fluid_boxes(scene);
    let pressure = |level: f64, y: f64| fluid.density * -down * (level - y).max(0.0);
    let load = |at: f64| match beam.along {
        // What stands on one side of it less what stands on the other.
        1 => {
            let level = |side: f64| {
                let on_side = |b: &&Block| {
                    let [near, far] = [b.min[0], b.max[0]].map(|x| (x - beam.middle) * side);
                    near.max(far) > beam.thickness
                };
                water.iter().filter(on_side).map(|b| b.max[1]).fold(f64::NEG_INFINITY, f64::max)
            };
            (pressure(level(-1.0), at) - pressure(level(1.0), at)).abs()
        }
        // What stands above it, and its own weight.
        _ => {
            let above =
                |b: &&Block| b.min[0] <= at && at <= b.max[0] && b.min[1] > beam.middle - beam.thickness;
            let level = water.iter().filter(above).map(|b| b.max[1]).fold(f64::NEG_INFINITY, f64::max);
            pressure(level, beam.middle) + material.density * -down * beam.thickness
        }
    };
    let stiffness = material.bending_modulus() * beam.thickness.powi(3) / 12.0;
    Some([beam.deflection(stiffness, load), beam.length()])
}

/// Clamped plates that the fluid would bend far beyond their length, of a modulus that exists.
pub(super) fn bent(scene: &Scene, placed: &[Placed], all: &mut Vec<String>) {
    for (shape, of_scene) in placed.iter().zip(&scene.shapes) {
        let Some([way, free]) = shape.bends.filter(|[way, free]| *way > TOO_FAR * free) else { continue };
        let Some(material) = of_scene.solid.and_then(|k| scene.solids.get(k)) else { continue };
        if material.youngs_modulus >= STIFFNESS[0] {
            all.push(format!(
                "the fluid at rest would bend `{}` by {} m by beam theory, whose free length is {} m: is \
                 {}.youngs_modulus = {:e} Pa right?",
                shape.name,
                length(way),
                length(free),
                material.name,
                material.youngs_modulus
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn beam(held: [bool; 2]) -> Beam {
        Beam { along: 1, free: [1.0, 3.0], held, thickness: 0.1, middle: 0.0 }
    }

    /// Even loads: q l⁴ / 8 and q l⁴ / 384; one that falls from q at the root to nothing: q l⁴ / 30, from the free end
    /// 11 q l⁴ / 120.
    #[test]
    fn deflections_are_those_of_textbooks() {
        let near =
            |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
        near(beam([true, false]).deflection(4.0, |_| 3.0), 3.0 * 16.0 / 8.0 / 4.0);
        near(beam([false, true]).deflection(4.0, |_| 3.0), 3.0 * 16.0 / 8.0 / 4.0);
        near(beam([true, true]).deflection(4.0, |_| 3.0), 3.0 * 16.0 / 384.0 / 4.0);
        near(beam([true, false]).deflection(4.0, |y| 3.0 - y), 2.0 * 16.0 / 30.0 / 4.0);
        near(beam([false, true]).deflection(4.0, |y| 3.0 - y), 11.0 * 2.0 * 16.0 / 120.0 / 4.0);
    }
}
