//! Remarks on gaps too narrow for the fluid between shapes of any outline, and on gates that hold less water than is
//! beside them.

use super::near;
use super::reached::{Matter, Places, is_driven, reached};
use super::shapes::{length, place};
use super::water::{depths_below, falls, others, outermost};
use halfstep_scene::geometry::{self, Cells, Layout, Surface, cell};
use halfstep_scene::{Block, Geometry, Lattice, Phase, Scene, Shape};
use std::collections::BTreeMap;

/// Spacings of a gap between walls, from which on it is none of rounding: of shapes whose sides are fitted to a
/// lattice, and of others, which lie on a wall to a quarter of a spacing.
const ROUNDED: [f64; 2] = [0.5, 0.25];
/// Spacings up to which one or two rows of fluid creep through a gap.
const NARROW: f64 = 3.25;
/// Cosine of the angle between faces of a gap: those of a corner open more.
const FACING: f64 = -0.98;
/// The same where one of two walls leans over the other without touching it.
const LEANING: f64 = -0.3;
/// Rows of particles of a face that a gap goes along.
const LONG: usize = 3;
/// Spacings from a place before a gap up to where fluid comes into it.
const BEFORE: i64 = 2;
/// Spacings of a gap beside still water, from which on it is none of rounding, and up to where it is no place of its
/// own.
const BESIDE: [f64; 2] = [0.75, 4.25];
/// Part of a face that has the gap.
const MOSTLY: f64 = 0.5;

/// Least gap of a face from the depths below its row, m, where most of it has one within these bounds.
fn gap(depths: &[Option<f64>], row_to_row: f64, [least, most]: [f64; 2]) -> Option<f64> {
    let gaps: Vec<f64> = depths.iter().flatten().map(|depth| depth - row_to_row).collect();
    let own = || gaps.iter().copied().filter(|gap| least < *gap && *gap < most);
    (own().count() as f64 > MOSTLY * depths.len() as f64).then(|| own().reduce(f64::min)).flatten()
}

/// A wall, or a solid that a clamp holds: its surface, and its particles by their places.
struct Face<const D: usize> {
    shape: usize,
    surface: Surface,
    particles: Cells<[f64; D], D>,
}

/// A gap between two shapes.
struct Gap<const D: usize> {
    width: f64,
    at: [f64; D],
    /// Places on its faces.
    along: Vec<[f64; D]>,
    /// Rows of particles that it goes along at least.
    rows: usize,
}

/// Gaps of few spacings between two walls, or a wall and a solid that a clamp holds, to which fluid can come.
pub(super) fn narrow<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    if layout.fluid.is_empty() {
        return;
    }
    let found = gaps(scene, layout);
    if found.is_empty() {
        return;
    }
    let dx = scene.resolution;
    let level = reached(scene, layout, &Matter::of_walls(scene, layout), false);
    let rises = is_driven(scene, layout, &level);
    // What a plate keeps dry is not looked at, nor what may be wide when the fluid comes.
    let with_solids = Matter::with_solids(scene, layout);
    let low = reached(scene, layout, &with_solids, false);
    let high = if rises { reached(scene, layout, &with_solids, true) } else { low.clone() };
    let moves = |shape: usize| scene.shapes[shape].motion.is_some();
    let is_wet = |at: &[f64; D], places: &Places<D>| {
        let here = cell(at, dx);
        let side = 2 * BEFORE + 1;
        (0..side.pow(D as u32)).any(|code| {
            let near = std::array::from_fn(|a| here[a] + code / side.pow(a as u32) % side - BEFORE);
            places.contains(&near)
        })
    };
    for ([one, other], gap) in found {
        let places = if moves(one) || moves(other) { &low } else { &high };
        if gap.along.len() < gap.rows || !gap.along.iter().any(|at| is_wet(at, places)) {
            continue;
        }
        let [one, other] = [one, other].map(|shape| &scene.shapes[shape].name);
        all.push(format!(
            "between `{one}` and `{other}` is a gap of {} m, {:.1} spacings, at {}: fluid neither stays behind so \
             narrow a gap nor flows through it as it should (from four spacings on it does), and where it enters one \
             it may be crushed",
            length(gap.width),
            gap.width / dx,
            place(&gap.at)
        ));
    }
}

/// All gaps whose faces look at each other, or of which one leans over the other, by their two shapes.
fn gaps<const D: usize>(scene: &Scene, layout: &Layout<D>) -> BTreeMap<[usize; 2], Gap<D>> {
    let dx = scene.resolution;
    let row = if scene.numerics.lattice == Lattice::Nodal { 0.0 } else { 0.5 * dx };
    let mut faces: Vec<Face<D>> = Vec::new();
    let held = layout.solid.iter().filter(|p| !scene.shapes[p.body as usize].clamp.is_empty());
    let places = layout.wall.iter().map(|p| (p.shape, p.position)).chain(held.map(|p| (p.body, p.position)));
    for (shape, position) in places {
        let shape = shape as usize;
        let face = faces.iter().position(|face| face.shape == shape).unwrap_or_else(|| {
            let surface = Surface::new(&scene.shapes[shape].geometry, None);
            faces.push(Face { shape, surface, particles: Cells::new(dx) });
            faces.len() - 1
        });
        faces[face].particles.add(&position, position);
    }
    let fitted =
        |shape: usize| matches!(scene.shapes[shape].geometry, Geometry::Box(_) | Geometry::Tank { .. });
    let rounded = |pair: &[usize; 2]| ROUNDED[usize::from(!pair.iter().all(|&shape| fitted(shape)))] * dx;
    let [mut all, mut leaning] = [const { BTreeMap::<[usize; 2], Gap<D>>::new() }; 2];
    for p in layout.wall.iter().filter(|p| p.has_one_face()) {
        let shape = p.shape as usize;
        let before = |way: f64| -> [f64; D] { std::array::from_fn(|a| p.position[a] + way * p.normal[a]) };
        let own = faces.iter().find(|face| face.shape == shape);
        let next = before(dx);
        if own.is_some_and(|own| own.particles.around(&next).any(|x| near(x, &next, 0.6 * dx))) {
            continue;
        }
        let Some((width, other, normal)) = across(&faces, shape, dx, |way| before(row + way)) else {
            continue;
        };
        let facing = (0..D).map(|a| normal[a] * p.normal[a]).sum::<f64>();
        let pair = [shape.min(other), shape.max(other)];
        let (kind, rows) = if facing <= FACING { (&mut all, LONG) } else { (&mut leaning, 1) };
        if facing > LEANING || width < rounded(&pair) {
            continue;
        }
        let at = before(row);
        let gap = kind.entry(pair).or_insert(Gap { width, at, along: Vec::new(), rows });
        gap.along.push(at);
        if width < gap.width {
            (gap.width, gap.at) = (width, at);
        }
    }
    for (pair, gap) in leaning {
        // Those that touch make a corner.
        let least = || apart(pair.map(|shape| &scene.shapes[shape].geometry), dx);
        if !all.contains_key(&pair) && rounded(&pair) < least() {
            all.insert(pair, gap);
        }
    }
    all
}

/// Least distance of two geometries, m: from points on the outline of either.
fn apart(pair: [&Geometry; 2], dx: f64) -> f64 {
    let [one, other] = pair.map(|geometry| Surface::new(geometry, None));
    let mut least = f64::INFINITY;
    for (from, to) in [(&one, &other), (&other, &one)] {
        from.outline(0.25 * dx, &mut |_, ends| {
            to.nearest(ends[0], &mut |distance, _| least = least.min(distance));
        });
    }
    least
}

/// How far before a face of a shape another one begins, m, with its index and normal there: `before` is the place so
/// far from the face. `None` where it is further than a narrow gap, or touches.
fn across<const D: usize>(
    faces: &[Face<D>],
    shape: usize,
    dx: f64,
    before: impl Fn(f64) -> [f64; D],
) -> Option<(f64, usize, [f64; D])> {
    let mut way = 0.0;
    loop {
        let at = before(way);
        let mut least = (f64::INFINITY, shape, [0.0; D]);
        for face in faces.iter().filter(|face| face.shape != shape) {
            face.surface.nearest(at, &mut |distance, normal| {
                if distance < least.0 {
                    least = (distance, face.shape, normal);
                }
            });
        }
        let (distance, other, normal) = least;
        if distance <= 1e-6 * dx {
            let particles = &faces.iter().find(|face| face.shape == other)?.particles;
            // A void may have taken what was there.
            let is_there = particles.around(&at).any(|x| near(x, &at, dx));
            return (way > 0.0 && is_there).then_some((way, other, normal));
        }
        way += distance;
        if way > NARROW * dx {
            return None;
        }
    }
}

/// Still water that ends a few spacings before what should hold it.
pub(super) fn beside<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let Some((down, _)) = falls::<D>(scene) else { return };
    let dx = scene.resolution;
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, shape)| shape.hydrostatic) {
        if !matches!(shape.geometry, Geometry::Box(_)) {
            continue;
        }
        let own = |of: u32| of as usize == index;
        for (axis, way) in (0..D).filter(|axis| *axis != down).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let column =
                outermost(layout.fluid.iter().filter(|p| own(p.shape)).map(|p| p.position), (axis, way), dx);
            let depths =
                depths_below(&column, others(layout, index), (axis, way), dx, (1.0 + BESIDE[1]) * dx);
            let Some(gap) = gap(&depths, dx, BESIDE.map(|rows| rows * dx)) else { continue };
            all.push(format!(
                "`{}` ends at {} = {} m, {} m, {:.1} spacings, before what stands there: it falls into that gap at \
                 once",
                shape.name,
                ["x", "y", "z"][axis],
                length(column[0][axis] + 0.5 * way * dx),
                length(gap),
                gap / dx
            ));
        }
    }
}

/// Gates that end below the water that they hold.
pub(super) fn over<const D: usize>(scene: &Scene, all: &mut Vec<String>) {
    let Some((down, way)) = falls::<D>(scene) else { return };
    let dx = scene.resolution;
    let water: Vec<(&Shape, Block)> = scene
        .shapes
        .iter()
        .filter(|shape| shape.phase == Phase::Fluid)
        .map(|shape| (shape, geometry::bounding_box(shape, scene)))
        .collect();
    // Heights against gravity.
    let ends = |block: &Block| match way < 0.0 {
        true => [block.min[down], block.max[down]],
        false => [-block.max[down], -block.min[down]],
    };
    for gate in scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall) {
        let upright = matches!(gate.geometry.unmoved(), Geometry::Box(_) | Geometry::Polygon(_));
        if !upright || gate.motion.as_ref().is_none_or(|motion| motion.makes().is_some()) {
            continue;
        }
        let block = geometry::bounding_box(gate, scene);
        let [foot, top] = ends(&block);
        let touches = |other: &Block, axis: usize, low: bool| {
            let apart =
                if low { block.min[axis] - other.max[axis] } else { other.min[axis] - block.max[axis] };
            let level = |a: usize| a == axis || other.min[a] < block.max[a] && block.min[a] < other.max[a];
            apart.abs() < 1.5 * dx && (0..scene.dimension).all(level)
        };
        for axis in (0..scene.dimension).filter(|axis| *axis != down) {
            let [low, high] =
                [true, false].map(|low| water.iter().find(|(_, other)| touches(other, axis, low)));
            // Water on both sides flows nowhere.
            let ((Some((shape, held)), None) | (None, Some((shape, held)))) = (low, high) else { continue };
            let [bottom, level] = ends(held);
            if bottom < top && foot < level && top < level - 0.5 * dx {
                all.push(format!(
                    "`{}` ends {} m below the surface of `{}`, which stands beside it: the water flows over it at once",
                    gate.name,
                    length(level - top),
                    shape.name
                ));
            }
        }
    }
}
