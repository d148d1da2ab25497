//! Where the fluid can come: from its particles at the start through what walls leave free.

use super::near;
use halfstep_scene::geometry::{self, CellSet, Cells, Layout, cell};
use halfstep_scene::{Phase, Scene};

/// Distance within which a place counts as filled by a particle, in spacings: half the diagonal of a cell and some
/// more.
const FILLED: f64 = 0.75;
/// Fluid whose level takes so many times its own places falls: a dam that breaks, a drop. Beside walls that lie in no
/// row of the fluid's lattice still water leaves some places free.
const FALLS: f64 = 1.2;

/// The particles of walls, or of walls and solids, by their positions, m.
pub(super) struct Matter<const D: usize> {
    cells: Cells<[f64; D], D>,
    dx: f64,
}

impl<const D: usize> Matter<D> {
    pub(super) fn of_walls(scene: &Scene, layout: &Layout<D>) -> Self {
        let dx = scene.resolution;
        Self { cells: by_place(dx, layout.wall.iter().map(|p| p.position)), dx }
    }

    pub(super) fn with_solids(scene: &Scene, layout: &Layout<D>) -> Self {
        let mut walls = Self::of_walls(scene, layout);
        layout.solid.iter().for_each(|p| walls.cells.add(&p.position, p.position));
        walls
    }

    /// Those of walls that stay where they are.
    pub(super) fn at_rest(scene: &Scene, layout: &Layout<D>) -> Self {
        let dx = scene.resolution;
        let rest = layout.wall.iter().filter(|p| scene.shapes[p.shape as usize].motion.is_none());
        Self { cells: by_place(dx, rest.map(|p| p.position)), dx }
    }

    /// Whether a particle is near a place.
    pub(super) fn fill(&self, at: &[f64; D]) -> bool {
        filled(&self.cells, at, self.dx)
    }
}

/// Places by cells of a side, m.
pub(super) fn by_place<const D: usize>(
    side: f64,
    places: impl Iterator<Item = [f64; D]>,
) -> Cells<[f64; D], D> {
    let mut cells = Cells::new(side);
    places.for_each(|x| cells.add(&x, x));
    cells
}

/// Whether one of the particles of a lattice of spacing dx fills a place.
pub(super) fn filled<const D: usize>(cells: &Cells<[f64; D], D>, at: &[f64; D], dx: f64) -> bool {
    cells.around(at).any(|x| near(x, at, FILLED * dx))
}

/// Cells of side dx.
pub(super) type Places<const D: usize> = CellSet<D>;

fn middle<const D: usize>(k: &[i64; D], dx: f64) -> [f64; D] {
    k.map(|k| (k as f64 + 0.5) * dx)
}

/// The places that the fluid can come to in the box around all shapes: without rising, or at all.
pub(super) fn reached<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    walls: &Matter<D>,
    rises: bool,
) -> Places<D> {
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
    let highest = match rises {
        true => f64::INFINITY,
        false => layout.fluid.iter().map(|p| height(&p.position)).fold(f64::NEG_INFINITY, f64::max),
    };
    let mut open: Vec<[i64; D]> = layout.fluid.iter().map(|p| cell(&p.position, dx)).collect();
    let mut seen: Places<D> = open.iter().copied().collect();
    while let Some(at) = open.pop() {
        for side in 0..2 * D {
            let mut next = at;
            next[side / 2] += if side % 2 == 0 { 1 } else { -1 };
            let inside = (0..D).all(|a| low[a] <= next[a] && next[a] <= high[a]);
            let place = middle(&next, dx);
            let free = inside && height(&place) <= highest && !walls.fill(&place);
            if free && seen.insert(next) {
                open.push(next);
            }
        }
    }
    seen
}

/// Whether the fluid can come above the level that it begins with: something pushes it, or it falls. `level` are the
/// places that it reaches without rising.
pub(super) fn is_driven<const D: usize>(scene: &Scene, layout: &Layout<D>, level: &Places<D>) -> bool {
    is_pushed(scene, layout) || falls(scene, layout, level)
}

/// Whether something moves the fluid, or it begins with a velocity.
pub(super) fn is_pushed<const D: usize>(scene: &Scene, layout: &Layout<D>) -> bool {
    let pushes = |phase: Phase| scene.shapes.iter().any(|s| s.phase == phase && s.motion.is_some());
    let moves = |v: &[f64; D]| v.iter().any(|v| *v != 0.0);
    if scene.frame.is_some() || pushes(Phase::Wall) || pushes(Phase::Solid) {
        return true;
    }
    layout.fluid.iter().any(|p| moves(&p.velocity)) || layout.solid.iter().any(|p| moves(&p.velocity))
}

fn falls<const D: usize>(scene: &Scene, layout: &Layout<D>, level: &Places<D>) -> bool {
    // Solids may keep fluid from falling, and stand where none can come.
    let dx = scene.resolution;
    let own: Places<D> = layout.fluid.iter().map(|p| cell(&p.position, dx)).collect();
    let solids = by_place(dx, layout.solid.iter().map(|p| p.position));
    let empty = level.iter().filter(|k| !own.contains(*k) && !filled(&solids, &middle(k, dx), dx)).count();
    (own.len() + empty) as f64 > FALLS * own.len() as f64
}
