//! Remarks on walls: how thick they are where the fluid can come, and which way their surface goes.

use super::near;
use halfstep_scene::geometry::{self, Cells, Layout, cell};
use halfstep_scene::{Phase, Scene};
use std::collections::HashSet;

/// Distance within which a place counts as filled by a particle, in spacings: half the diagonal of a cell and some
/// more.
const FILLED: f64 = 0.75;

/// The walls' particles, by their positions, m.
struct Walls<const D: usize> {
    cells: Cells<[f64; D], D>,
    dx: f64,
}

impl<const D: usize> Walls<D> {
    /// Whether a particle is near a place.
    fn fill(&self, at: &[f64; D]) -> bool {
        self.cells.around(at).any(|x| near(x, at, FILLED * self.dx))
    }
}

/// The cells of side dx that the fluid can come to without rising: from its particles through what walls leave free, in
/// the box around all shapes.
fn reached<const D: usize>(scene: &Scene, layout: &Layout<D>, walls: &Walls<D>) -> HashSet<[i64; D]> {
    let dx = scene.resolution;
    let (mut low, mut high) = ([i64::MAX; D], [i64::MIN; D]);
    for shape in &scene.shapes {
        let block = geometry::bounding_box(shape, scene);
        for a in 0..D {
            low[a] = low[a].min((block.min[a] / dx).floor() as i64);
            high[a] = high[a].max((block.max[a] / dx).floor() as i64);
        }
    }
    let height = |x: &[f64; D]| -(0..D).map(|a| scene.gravity[a] * x[a]).sum::<f64>();
    let highest = layout.fluid.iter().map(|p| height(&p.position)).fold(f64::NEG_INFINITY, f64::max);
    let middle = |k: &[i64; D]| -> [f64; D] { k.map(|k| (k as f64 + 0.5) * dx) };
    let mut open: Vec<[i64; D]> = layout.fluid.iter().map(|p| cell(&p.position, dx)).collect();
    let mut seen: HashSet<[i64; D]> = open.iter().copied().collect();
    while let Some(at) = open.pop() {
        for side in 0..2 * D {
            let mut next = at;
            next[side / 2] += if side % 2 == 0 { 1 } else { -1 };
            let inside = (0..D).all(|a| low[a] <= next[a] && next[a] <= high[a]);
            let free = inside && height(&middle(&next)) <= highest && !walls.fill(&middle(&next));
            if free && seen.insert(next) {
                open.push(next);
            }
        }
    }
    seen
}

/// Part of a wall's velocity across its face from which on it is no belt's.
const ACROSS: f64 = 0.5;

/// Walls with a velocity across a face that the fluid touches: the surface pushes and does not move.
pub(super) fn across<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let reach = 1.1 * scene.resolution;
    for (index, shape) in scene.shapes.iter().enumerate() {
        let speed = shape.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
        if shape.phase != Phase::Wall || speed == 0.0 {
            continue;
        }
        let across = |p: &geometry::WallPoint<D>| {
            (0..D).map(|a| shape.velocity[a] * p.normal[a]).sum::<f64>().abs() > ACROSS * speed
        };
        let mut faces = Cells::new(reach);
        let own = layout.wall.iter().filter(|p| p.shape as usize == index && !p.corner);
        own.filter(|p| across(p)).for_each(|p| faces.add(&p.position, p.position));
        let wet = layout
            .fluid
            .iter()
            .find_map(|f| faces.around(&f.position).find(|x| near(x, &f.position, reach)).copied());
        if let Some(at) = wet {
            let at: Vec<String> = at.iter().map(|x| (*x as f32).to_string()).collect();
            all.push(format!(
                "`{}` has a velocity of {} m/s across its face at [{}]: a wall's `velocity` is that of a belt, whose \
                 surface stays where it is, and fluid that is pushed there goes nowhere (`motion` moves a wall)",
                shape.name,
                speed as f32,
                at.join(", ")
            ));
        }
    }
}

/// Walls that are thinner than the kernel's support where the fluid can come.
pub(super) fn thin<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    if layout.fluid.is_empty() || layout.wall.is_empty() {
        return;
    }
    let dx = scene.resolution;
    let support = 2.0 * scene.smoothing_ratio * dx;
    let mut walls = Walls { cells: Cells::new(dx), dx };
    layout.wall.iter().for_each(|p| walls.cells.add(&p.position, p.position));
    let reached = reached(scene, layout, &walls);
    let behind = |p: &geometry::WallPoint<D>, way: f64| -> [f64; D] {
        std::array::from_fn(|a| p.position[a] - way * p.normal[a])
    };
    for (index, shape) in scene.shapes.iter().enumerate() {
        let mut thinnest: Option<(f64, [f64; D])> = None;
        for p in layout.wall.iter().filter(|p| p.shape as usize == index && !p.corner) {
            // Fluid next to it stands a spacing before it, or a little more where its cell begins.
            let before = [1.0, 1.5].map(|way| behind(p, -way * dx));
            let wet = |x: &[f64; D]| !walls.fill(x) && reached.contains(&cell(x, dx));
            if !before.iter().any(wet) {
                continue;
            }
            // Half a spacing lies before the particle, and half a one behind the last place that is filled.
            let filled = (0..).take_while(|k| {
                f64::from(*k) * 0.5 * dx < support && walls.fill(&behind(p, f64::from(*k) * 0.5 * dx))
            });
            let thickness = filled.count() as f64 * 0.5 * dx;
            if thinnest.is_none_or(|(least, _)| thickness < least) {
                thinnest = Some((thickness, p.position));
            }
        }
        if let Some((thickness, at)) = thinnest.filter(|(thickness, _)| *thickness < support - 0.51 * dx) {
            let at: Vec<String> = at.iter().map(|x| (*x as f32).to_string()).collect();
            all.push(format!(
                "`{}` is about {:.1} dx thick at [{}], and the fluid's kernel reaches {:.1} dx: fluid there is held \
                 weakly, and meets fluid behind it",
                shape.name,
                thickness / dx,
                at.join(", "),
                support / dx
            ));
        }
    }
}
