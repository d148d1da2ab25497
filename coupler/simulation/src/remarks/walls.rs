//! Remarks on walls: how thick they are where the fluid can come.

use halfstep_scene::Scene;
use halfstep_scene::geometry::{self, Layout};
use std::collections::{HashMap, HashSet};

/// Distance within which a place counts as filled by a particle, in spacings: half the diagonal of a cell and some
/// more.
const FILLED: f64 = 0.75;

/// Particles in cells of side dx.
struct Cells<const D: usize> {
    cells: HashMap<[i64; D], Vec<[f64; D]>>,
    dx: f64,
}

impl<const D: usize> Cells<D> {
    fn new(points: impl Iterator<Item = [f64; D]>, dx: f64) -> Self {
        let mut cells: HashMap<[i64; D], Vec<[f64; D]>> = HashMap::new();
        points.for_each(|x| cells.entry(x.map(|x| (x / dx).floor() as i64)).or_default().push(x));
        Self { cells, dx }
    }

    /// Whether a particle is near a place.
    fn fills(&self, at: &[f64; D]) -> bool {
        let home = at.map(|x| (x / self.dx).floor() as i64);
        (0..3_usize.pow(D as u32)).any(|code| {
            let cell: [i64; D] =
                std::array::from_fn(|a| home[a] + (code / 3_usize.pow(a as u32) % 3) as i64 - 1);
            self.cells.get(&cell).is_some_and(|points| {
                let r2 = |x: &[f64; D]| (0..D).map(|a| (x[a] - at[a]).powi(2)).sum::<f64>();
                points.iter().any(|x| r2(x) < (FILLED * self.dx).powi(2))
            })
        })
    }
}

/// The cells of side dx that the fluid can come to without rising: from its particles through what walls leave free, in
/// the box around all shapes.
fn reached<const D: usize>(scene: &Scene, layout: &Layout<D>, walls: &Cells<D>) -> HashSet<[i64; D]> {
    let dx = scene.resolution;
    let cell = |x: &[f64; D]| -> [i64; D] { x.map(|x| (x / dx).floor() as i64) };
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
    let mut open: Vec<[i64; D]> = layout.fluid.iter().map(|p| cell(&p.position)).collect();
    let mut seen: HashSet<[i64; D]> = open.iter().copied().collect();
    while let Some(at) = open.pop() {
        for side in 0..2 * D {
            let mut next = at;
            next[side / 2] += if side % 2 == 0 { 1 } else { -1 };
            let inside = (0..D).all(|a| low[a] <= next[a] && next[a] <= high[a]);
            let free = inside && height(&middle(&next)) <= highest && !walls.fills(&middle(&next));
            if free && seen.insert(next) {
                open.push(next);
            }
        }
    }
    seen
}

/// Walls that are thinner than the kernel's support where the fluid can come.
pub(super) fn thin<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    if layout.fluid.is_empty() || layout.wall.is_empty() {
        return;
    }
    let dx = scene.resolution;
    let support = 2.0 * scene.smoothing_ratio * dx;
    let walls = Cells::new(layout.wall.iter().map(|p| p.position), dx);
    let reached = reached(scene, layout, &walls);
    let behind = |p: &geometry::WallPoint<D>, way: f64| -> [f64; D] {
        std::array::from_fn(|a| p.position[a] - way * p.normal[a])
    };
    for (index, shape) in scene.shapes.iter().enumerate() {
        let mut thinnest: Option<(f64, [f64; D])> = None;
        for p in layout.wall.iter().filter(|p| p.shape as usize == index && !p.corner) {
            // Fluid next to it stands a spacing before it, or a little more where its cell begins.
            let before = [1.0, 1.5].map(|way| behind(p, -way * dx));
            let wet = |x: &[f64; D]| !walls.fills(x) && reached.contains(&x.map(|x| (x / dx).floor() as i64));
            if !before.iter().any(wet) {
                continue;
            }
            // Half a spacing lies before the particle, and half a one behind the last place that is filled.
            let filled = (0..).take_while(|k| {
                f64::from(*k) * 0.5 * dx < support && walls.fills(&behind(p, f64::from(*k) * 0.5 * dx))
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
