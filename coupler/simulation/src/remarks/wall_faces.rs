//! Where walls have their faces as computed: whole rows from the least corner of a box on, and openings of whole rows.

use super::reached::{Matter, Places, is_pushed, reached};
use super::shapes::{around_copy, length, place};
use halfstep_scene::geometry::{Layout, Moved, cell};
use halfstep_scene::{Block, Geometry, Lattice, Phase, Scene, Shape};
use std::cell::LazyCell;

/// Distance of a face from where it is asked for that is remarked, in spacings.
const NOTABLE: f64 = 0.1;
/// The sides at the largest coordinate along each axis.
const SIDES: [&str; 3] = ["right side", "top", "front"];
/// Sizes along each axis.
const SIZES: [&str; 3] = ["wide", "high", "deep"];

/// A side of a wall, asked and computed, m: where the box is turned, before that.
struct Face<'s> {
    shape: usize,
    axis: usize,
    asked: f64,
    computed: f64,
    /// The box that it ends.
    of: Block,
    turned: Option<Turned<'s>>,
}

/// A copy of what is turned.
type Turned<'s> = (&'s Moved, u32);

impl Face<'_> {
    /// The point of the box, before it is turned, that is at a place.
    fn back<const D: usize>(&self, x: [f64; D]) -> [f64; D] {
        self.turned.map_or(x, |(moved, copy)| moved.back(copy, x))
    }

    fn place<const D: usize>(&self, x: [f64; D]) -> [f64; D] {
        self.turned.map_or(x, |(moved, copy)| moved.place(copy, x))
    }

    /// Whether it looks against gravity.
    fn is_upper(&self, scene: &Scene) -> bool {
        let axis: [f64; 3] = std::array::from_fn(|a| f64::from(u8::from(a == self.axis)));
        let normal = self.turned.map_or(axis, |(moved, _)| moved.turned(axis));
        let against: f64 = (0..3).map(|a| -scene.gravity[a] * normal[a]).sum();
        against > 0.5 * scene.gravity_magnitude()
    }
}

/// The boxes of a shape that lie along its lattice, one of each copy.
fn boxes(scene: &Scene, shape: &Shape) -> Vec<Block> {
    match &shape.geometry {
        Geometry::Box(block) => vec![*block],
        Geometry::Moved(moved) if moved.angle == 0.0 && matches!(*moved.geometry, Geometry::Box(_)) => {
            moved.copies().map(|copy| around_copy(scene, shape, moved, copy)).collect()
        }
        _ => Vec::new(),
    }
}

/// The boxes of a shape, one of each copy, those that are turned as before.
fn turned(shape: &Shape) -> Vec<(Block, Option<Turned<'_>>)> {
    match &shape.geometry {
        Geometry::Moved(moved) if moved.angle != 0.0 => match *moved.geometry {
            Geometry::Box(block) => moved.copies().map(|copy| (block, Some((moved, copy)))).collect(),
            _ => Vec::new(),
        },
        _ => Vec::new(),
    }
}

fn off<'s>(scene: &'s Scene, dimension: usize) -> Vec<Face<'s>> {
    let dx = scene.resolution;
    let walls = scene.shapes.iter().enumerate().filter(|(_, s)| s.phase == Phase::Wall);
    let of_box = |(shape, (of, turned)): (usize, (Block, Option<Turned<'s>>))| {
        let face = move |axis: usize| {
            let rows = ((of.max[axis] - of.min[axis]) / dx).round();
            Face { shape, axis, asked: of.max[axis], computed: of.min[axis] + rows * dx, of, turned }
        };
        (0..dimension).map(face).filter(move |face| (face.computed - face.asked).abs() > NOTABLE * dx)
    };
    let all = |shape| boxes(scene, shape).into_iter().map(|block| (block, None)).chain(turned(shape));
    walls.flat_map(|(k, s)| all(s).map(move |b| (k, b))).flat_map(of_box).collect()
}

/// Boxes of walls whose rows end before or beyond a face that the fluid comes to; upper faces, too, that it comes to as
/// it rises.
pub(super) fn faces<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let off = off(scene, D);
    if off.is_empty() || layout.fluid.is_empty() || scene.numerics.lattice == Lattice::Nodal {
        return;
    }
    let walls = Matter::of_walls(scene, layout);
    let level = reached(scene, layout, &walls, false);
    let above = LazyCell::new(|| is_pushed(scene, layout).then(|| reached(scene, layout, &walls, true)));
    let mut told: Vec<(usize, usize)> = Vec::new();
    for face in off {
        if told.contains(&(face.shape, face.axis)) {
            continue;
        }
        let upper = face.is_upper(scene);
        let still = is_wet(scene, layout, &walls, &face, &level);
        let later =
            || upper && above.as_ref().is_some_and(|above| is_wet(scene, layout, &walls, &face, above));
        if !(still || later()) {
            continue;
        }
        told.push((face.shape, face.axis));
        all.push(format!(
            "the {} of `{}`{} is at {} m in the scene and at {} m as computed, and fluid {}: a wall has whole rows \
             from its `min` on (the resolution is {})",
            SIDES[face.axis],
            scene.shapes[face.shape].name,
            if face.turned.is_some() { ", before `rotate`," } else { "" },
            length(face.asked),
            length(face.computed),
            if still { "comes there" } else { "may come there" },
            length(scene.resolution)
        ));
    }
}

/// Whether a place before a face is one of those.
fn is_wet<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    walls: &Matter<D>,
    face: &Face<'_>,
    places: &Places<D>,
) -> bool {
    let (dx, axis) = (scene.resolution, face.axis);
    let last = |p: &[f64; D]| (p[axis] + 0.5 * dx - face.computed).abs() < 1e-3 * dx;
    let beside =
        |p: &[f64; D]| (0..D).all(|a| a == axis || face.of.min[a] - dx < p[a] && p[a] < face.of.max[a] + dx);
    let own = layout.wall.iter().filter(|p| p.shape as usize == face.shape).map(|p| face.back(p.position));
    own.filter(|p| last(p) && beside(p)).any(|p| {
        [1.0, 1.5].iter().any(|way| {
            let mut before = p;
            before[axis] += way * dx;
            let before = face.place(before);
            !walls.fill(&before) && places.contains(&cell(&before, dx))
        })
    })
}

/// Voids through walls of boxes, whose openings have other than whole rows.
pub(super) fn openings<const D: usize>(scene: &Scene, all: &mut Vec<String>) {
    let dx = scene.resolution;
    for (index, wall) in scene.shapes.iter().enumerate().filter(|(_, s)| s.phase == Phase::Wall) {
        for block in boxes(scene, wall) {
            for void in scene.voids.iter().filter(|void| void.before <= index) {
                let Geometry::Box(hole) = &void.geometry else { continue };
                let inside =
                    |axis: usize| block.min[axis] < hole.min[axis] && hole.max[axis] < block.max[axis];
                let meets = (0..D).all(|a| hole.min[a] < block.max[a] && block.min[a] < hole.max[a]);
                // An opening goes through the wall along another axis.
                for axis in (0..D).filter(|&axis| meets && inside(axis) && !(0..D).all(inside)) {
                    let asked = hole.max[axis] - hole.min[axis];
                    let rows = ((block.max[axis] - block.min[axis]) / dx).round() as usize;
                    let at = |k: &usize| block.min[axis] + (*k as f64 + 0.5) * dx;
                    let cut = (0..rows).filter(|k| hole.min[axis] < at(k) && at(k) < hole.max[axis]).count();
                    let computed = cut as f64 * dx;
                    if (computed - asked).abs() > NOTABLE * dx {
                        let middle: Vec<f64> = (0..D).map(|a| 0.5 * (hole.min[a] + hole.max[a])).collect();
                        all.push(format!(
                            "the opening that `{}` cuts into `{}` at {} is {} m {} in the scene and {} m of whole rows \
                             as computed (the resolution is {})",
                            void.name,
                            wall.name,
                            place(&middle),
                            length(asked),
                            SIZES[axis],
                            length(computed),
                            length(dx)
                        ));
                    }
                }
            }
        }
    }
}
