//! Deflection of clamped plates by beam theory, under what acts on them from the start: their own weight, their load,
//! the fluid. Remarks on those that would bend beyond all measure.

use super::magnitudes::STIFFNESS;
use super::meet;
use super::shapes::{Placed, length};
use halfstep_scene::geometry::{self, Layout};
use halfstep_scene::{Block, Geometry, Phase, Scene, Shape};
use serde::Serialize;

/// Deflection by linear theory over the free length from which on it is remarked: soft plates of experiments behind a
/// dam that breaks have up to five.
const TOO_FAR: f64 = 10.0;
/// Least free length of a beam over its thickness.
const SLENDER: f64 = 3.0;
/// Part of its length times its thickness that a straight plate has at least.
const STRAIGHT: f64 = 0.95;
/// Parts of the free length that the load is summed over.
const PARTS: usize = 1000;
/// Part of a deflection from which on its cause is named.
const NAMED: f64 = 0.01;
/// Component along gravity of the normal of a plate that rather lies than stands.
const LIES: f64 = 0.7;

/// How far a plate bends by beam theory.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Bends {
    /// Deflection and free length, m.
    #[serde(rename = "bends")]
    pub(super) way: [f64; 2],
    /// What bends it.
    #[serde(rename = "bends_under")]
    pub(super) under: String,
    /// The fluid is part of that, and does not touch it at the start.
    #[serde(skip)]
    dry: bool,
}

/// A straight plate, held at one end or both.
struct Beam {
    /// Middle of its first end, m.
    start: [f64; 2],
    /// Unit vectors along it and across.
    along: [f64; 2],
    across: [f64; 2],
    length: f64,
    thickness: f64,
    /// Ends of the free part, m from the start.
    free: [f64; 2],
    held: [bool; 2],
}

fn dot(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Corners of each copy of a box or polygon.
fn outlines(geometry: &Geometry) -> Vec<Vec<[f64; 2]>> {
    match geometry {
        Geometry::Box(Block { min, max }) => {
            vec![vec![[min[0], min[1]], [max[0], min[1]], [max[0], max[1]], [min[0], max[1]]]]
        }
        Geometry::Polygon(polygon) if polygon.holes.is_empty() => vec![polygon.outline.clone()],
        Geometry::Moved(moved) => {
            let first = outlines(&moved.geometry);
            let placed = |copy| first.iter().map(move |corners| (copy, corners));
            let place = |(copy, corners): (u32, &Vec<[f64; 2]>)| {
                corners.iter().map(|corner| moved.place(copy, *corner)).collect()
            };
            moved.copies().flat_map(placed).map(place).collect()
        }
        _ => Vec::new(),
    }
}

impl Beam {
    /// Of an outline that is nearly a rectangle; `None` of another one, and where no clamp holds an end.
    fn of(corners: &[[f64; 2]], clamps: &[Block], tolerance: f64) -> Option<Self> {
        let sides = corners.iter().zip(corners.iter().cycle().skip(1));
        let way = |(a, b): (&[f64; 2], &[f64; 2])| [b[0] - a[0], b[1] - a[1]];
        let size = |v: &[f64; 2]| v[0].hypot(v[1]);
        let longest = sides.map(way).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let along = longest.map(|c| c / size(&longest));
        let across = [-along[1], along[0]];
        let extent = |axis: &[f64; 2]| {
            let places = corners.iter().map(|p| dot(p, axis));
            places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| [low.min(s), high.max(s)])
        };
        let ([low, high], [right, left]) = (extent(&along), extent(&across));
        let (length, thickness, middle) = (high - low, left - right, 0.5 * (left + right));
        if 0.5 * geometry::twice_area(corners).abs() < STRAIGHT * length * thickness {
            return None;
        }
        let start = [0, 1].map(|a| low * along[a] + middle * across[a]);
        let mut beam =
            Self { start, along, across, length, thickness, free: [0.0, length], held: [false; 2] };
        for clamp in clamps {
            // The clamp holds the whole section somewhere, and ends on the middle line.
            let face = 0.5 * thickness - tolerance.min(0.5 * thickness);
            let lines = [-face, 0.0, face].map(|across| beam.within(clamp, across));
            let [Some(a), Some([from, to]), Some(b)] = lines else { continue };
            if a[0].max(from).max(b[0]) > a[1].min(to).min(b[1]) {
                continue;
            }
            if from < tolerance && to > beam.free[0] - tolerance {
                (beam.free[0], beam.held[0]) = (to, true);
            }
            if to > length - tolerance && from < beam.free[1] + tolerance {
                (beam.free[1], beam.held[1]) = (from, true);
            }
        }
        (beam.held != [false; 2] && beam.free_length() > SLENDER * thickness).then_some(beam)
    }

    /// Part of a line along the beam that lies in a box, m from the start.
    fn within(&self, block: &Block, across: f64) -> Option<[f64; 2]> {
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        for a in 0..2 {
            let ends = [block.min[a], block.max[a]].map(|x| x - self.place(0.0, across)[a]);
            if self.along[a].abs() < 1e-9 {
                if ends[0] > 0.0 || ends[1] < 0.0 {
                    return None;
                }
                continue;
            }
            let [one, other] = ends.map(|x| x / self.along[a]);
            (from, to) = (from.max(one.min(other)), to.min(one.max(other)));
        }
        (from <= to).then_some([from, to])
    }

    /// The place so far along it and from its middle, m.
    fn place(&self, along: f64, across: f64) -> [f64; 2] {
        [0, 1].map(|a| self.start[a] + along * self.along[a] + across * self.across[a])
    }

    /// The same of a place.
    fn coordinates(&self, x: &[f64; 2]) -> [f64; 2] {
        let from = [x[0] - self.start[0], x[1] - self.start[1]];
        [dot(&from, &self.along), dot(&from, &self.across)]
    }

    fn free_length(&self) -> f64 {
        self.free[1] - self.free[0]
    }

    /// Deflection of the free end, or of the middle where both are held, that a unit force does so far along the beam,
    /// times the bending stiffness, m³ (any textbook of statics).
    fn influence(&self, along: f64) -> f64 {
        let l = self.free_length();
        let at = (along - self.free[0]).clamp(0.0, l);
        let from_root = if self.held[0] { at } else { l - at };
        match self.held {
            [true, true] => {
                let a = at.min(l - at);
                a * a * (3.0 * l - 4.0 * a) / 48.0
            }
            _ => from_root * from_root * (3.0 * l - from_root) / 6.0,
        }
    }

    /// Deflection times the bending stiffness under a load across it, N/m² at each place.
    fn under(&self, load: impl Fn(f64) -> f64) -> f64 {
        let part = self.free_length() / PARTS as f64;
        let of_part = |k: usize| {
            let along = self.free[0] + (k as f64 + 0.5) * part;
            load(along) * self.influence(along) * part
        };
        (0..PARTS).map(of_part).sum()
    }

    /// Pressure of the fluid on the side of this sign, Pa: a plate that stands has the level of all fluid on that side,
    /// one that lies that of the fluid above and below it.
    fn pressure(&self, side: f64, water: &[Block], along: f64, weight: f64) -> f64 {
        let at = self.place(along, 0.5 * side * self.thickness);
        let out = self.across.map(|c| side * c);
        let on_side = |b: &&Block| {
            if out[1].abs() < LIES {
                let corners = [b.min[0], b.max[0]].into_iter().flat_map(|x| [[x, b.min[1]], [x, b.max[1]]]);
                let beyond = |corner: [f64; 2]| dot(&[corner[0] - at[0], corner[1] - at[1]], &out);
                corners.map(beyond).fold(f64::NEG_INFINITY, f64::max) > 0.5 * self.thickness
            } else {
                let beside = b.min[0] <= at[0] && at[0] <= b.max[0];
                beside && if out[1] > 0.0 { b.max[1] > at[1] } else { b.min[1] < at[1] }
            }
        };
        let level = water.iter().filter(on_side).map(|b| b.max[1]).fold(f64::NEG_INFINITY, f64::max);
        weight * (level - at[1]).max(0.0)
    }

    /// Whether fluid touches it at the start.
    fn is_wet<const D: usize>(&self, layout: &Layout<D>, dx: f64) -> bool {
        layout.fluid.iter().any(|p| {
            let [along, across] = self.coordinates(&[p.position[0], p.position[1]]);
            (0.0..=self.length).contains(&along) && across.abs() < 0.5 * self.thickness + 2.0 * dx
        })
    }
}

/// Where a plate along x is free, that a clamp holds at one end: from its root to its tip, m along x.
pub(super) fn free_along_x(scene: &Scene, shape: &Shape) -> Option<[f64; 2]> {
    let corners = outlines(&shape.geometry);
    let [corners] = &corners[..] else { return None };
    let beam = Beam::of(corners, &shape.clamp, 0.5 * scene.spacing(shape))?;
    let ends = beam.free.map(|along| beam.place(along, 0.0)[0]);
    let lies = beam.along[1].abs() < 1e-6 && beam.held != [true; 2];
    lies.then(|| if beam.held[0] { ends } else { [ends[1], ends[0]] })
}

/// Deflection of a clamped plate by beam theory, of the copy that bends most; `None` of what is no such plate.
pub(super) fn deflection<const D: usize>(scene: &Scene, layout: &Layout<D>, index: usize) -> Option<Bends> {
    let shape = &scene.shapes[index];
    let gravity = [scene.gravity[0], scene.gravity[1]];
    // Fluid has a level where gravity is along -y.
    let has_level = scene.fluid.is_none() || (gravity[0] == 0.0 && gravity[1] <= 0.0);
    // A crack makes two plates of one, or weakens it.
    if D != 2 || shape.phase != Phase::Solid || !has_level || shape.crack.is_some() {
        return None;
    }
    // What other shapes of its body stiffen.
    let around = geometry::bounding_box(shape, scene);
    let is_part = scene.shapes.iter().enumerate().any(|(k, other)| {
        let same = k != index && other.phase == Phase::Solid && other.solid == shape.solid;
        same && other.body() == shape.body() && meet(&geometry::bounding_box(other, scene), &around, scene)
    });
    if is_part {
        return None;
    }
    let material = shape.solid.and_then(|k| scene.solids.get(k)).filter(|solid| solid.rigid().is_none())?;
    let density = shape.density.unwrap_or(material.density);
    let water = geometry::fluid_boxes(scene);
    let weight = scene.fluid.as_ref().map_or(0.0, |fluid| fluid.density * -gravity[1]);
    let dx = scene.spacing(shape);
    let of_copy = |(copy, corners): (usize, Vec<[f64; 2]>)| {
        let beam = Beam::of(&corners, &shape.clamp, 0.5 * dx)?;
        let own = density * beam.thickness * dot(&gravity, &beam.across);
        let pressure =
            |at: f64| beam.pressure(-1.0, &water, at, weight) - beam.pressure(1.0, &water, at, weight);
        let loaded = layout.solid.iter().filter(|p| {
            p.body as usize == index && p.copy as usize == copy && !p.clamped && p.is_in_load(scene)
        });
        // On a face of each particle.
        let force = shape
            .load
            .as_ref()
            .map_or(0.0, |load| dx * dot(&[load.traction[0], load.traction[1]], &beam.across));
        let by_load = loaded.map(|p| {
            let [along, _] = beam.coordinates(&[p.position[0], p.position[1]]);
            force * beam.influence(along)
        });
        let wet = beam.is_wet(layout, scene.resolution);
        let fluid = if wet { "the fluid at rest" } else { "the fluid's full head" };
        let parts = [
            (fluid, beam.under(pressure)),
            ("its own weight", beam.under(|_| own)),
            ("its load", by_load.sum()),
        ];
        let sum: f64 = parts.iter().map(|(_, part)| part).sum();
        let largest = parts.iter().map(|(_, part)| part.abs()).fold(0.0, f64::max);
        let named = parts.iter().filter(|(_, part)| part.abs() > NAMED * largest).map(|(name, _)| *name);
        let stiffness = material.bending_modulus() * beam.thickness.powi(3) / 12.0;
        let way = [sum.abs() / stiffness, beam.free_length()];
        let dry = !wet && parts[0].1.abs() > NAMED * largest;
        // What floats bends by what rounding leaves.
        (sum.abs() > 1e-9 * largest).then(|| Bends {
            way,
            under: named.collect::<Vec<_>>().join(" and "),
            dry,
        })
    };
    let bends = outlines(&shape.geometry).into_iter().enumerate().filter_map(of_copy);
    bends.max_by(|a, b| a.way[0].total_cmp(&b.way[0]))
}

/// Clamped plates that would bend far beyond their length, of a modulus that exists.
pub(super) fn bent(scene: &Scene, placed: &[Placed], all: &mut Vec<String>) {
    for (shape, of_scene) in placed.iter().zip(&scene.shapes) {
        let Some(Bends { way: [way, free], under, dry }) = shape.bends.as_ref() else { continue };
        let (way, free) = (*way, *free);
        let Some(material) = of_scene.solid.and_then(|k| scene.solids.get(k)) else { continue };
        if way > TOO_FAR * free && material.youngs_modulus >= STIFFNESS[0] {
            let dry = match dry {
                true => " (it is dry at the start: this is fluid that stands at it as high as fluid begins)",
                false => "",
            };
            all.push(format!(
                "{under} would bend `{}` by {} m by beam theory, whose free length is {} m{dry}: is \
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

    fn near(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    }

    fn beam(held: [bool; 2]) -> Beam {
        let (along, across) = ([0.0, 1.0], [-1.0, 0.0]);
        Beam { start: [0.0, 0.0], along, across, length: 4.0, thickness: 0.1, free: [1.0, 3.0], held }
    }

    /// Even loads: q l⁴ / 8 and q l⁴ / 384; one that falls from q at the root to nothing: q l⁴ / 30, from the free end
    /// 11 q l⁴ / 120.
    #[test]
    fn deflections_are_those_of_textbooks() {
        near(beam([true, false]).under(|_| 3.0), 3.0 * 16.0 / 8.0);
        near(beam([false, true]).under(|_| 3.0), 3.0 * 16.0 / 8.0);
        near(beam([true, true]).under(|_| 3.0), 3.0 * 16.0 / 384.0);
        near(beam([true, false]).under(|y| 3.0 - y), 2.0 * 16.0 / 30.0);
        near(beam([false, true]).under(|y| 3.0 - y), 11.0 * 2.0 * 16.0 / 120.0);
    }

    /// A plate of 1 x 0.1 m at 30 degrees, whose lowest 0.2 m a box up to the height 0.1 m holds.
    #[test]
    fn a_turned_plate_is_free_from_where_its_middle_leaves_the_clamp() {
        let (cos, sin) = (0.75_f64.sqrt(), 0.5);
        let place = |s: f64, t: f64| [cos * s - sin * t, sin * s + cos * t];
        let corners = [place(0.0, -0.05), place(1.0, -0.05), place(1.0, 0.05), place(0.0, 0.05)];
        let clamp = |high: f64| Block { min: [-1.0, -1.0, 0.0], max: [1.0, high, 0.0] };
        let beam = Beam::of(&corners, &[clamp(0.1)], 0.005).expect("it is held");
        assert_ne!(beam.held[0], beam.held[1], "one end");
        near(beam.free_length(), 0.8);
        near(beam.thickness, 0.1);
        assert!(Beam::of(&corners, &[clamp(-0.06)], 0.005).is_none(), "a clamp below it");
        let wedge = [place(0.0, -0.05), place(1.0, 0.0), place(0.0, 0.05)];
        assert!(Beam::of(&wedge, &[clamp(0.1)], 0.005).is_none(), "no rectangle");
    }
}
