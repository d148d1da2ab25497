//! How thick solids are at the start, from their particles: what voids and overlaps leave of a shape.

use super::shapes::Placed;
use halfstep_scene::geometry::{self, Cells, Layout};
use halfstep_scene::{Phase, Scene};

/// Distance within which a place counts as filled by a particle, in its spacings.
const FILLED: f64 = 0.75;
/// Neighbours of a particle on its lattice are closer than this, in spacings: between a diagonal and two rows.
const NEIGHBOUR: f64 = 1.6;
/// Sum of the directions to the neighbours that an even face lacks is 2.4 long; inside it is 0.
const FACE: f64 = 0.8;
/// Cosine below which two faces look away from each other.
const OPPOSITE: f64 = -0.7;

/// The place where a shape is thinnest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Thinnest {
    /// Thickness, m: whole and half rows.
    pub(crate) thickness: f64,
    /// A particle on one of the two faces, m.
    pub(crate) at: [f64; 2],
}

/// Outlines lie in a plane.
const PLANE: usize = 2;

/// What fluid cannot pass: particles of solids and walls with their spacings, m.
struct Matter {
    cells: Cells<([f64; PLANE], f64), PLANE>,
}

fn apart(a: &[f64; 2], b: &[f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn length(v: &[f64; 2]) -> f64 {
    v[0].hypot(v[1])
}

impl Matter {
    fn nearest(&self, at: &[f64; 2]) -> Option<&([f64; 2], f64)> {
        let close = |(x, dx): &&([f64; 2], f64)| length(&apart(x, at)) < FILLED * dx;
        let distance = |(x, _): &&([f64; 2], f64)| length(&apart(x, at));
        self.cells.around(at).filter(close).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// Unit normal out of the matter at a particle; `None` inside and at what has no one normal.
    fn normal(&self, at: &[f64; 2], dx: f64) -> Option<[f64; 2]> {
        let (mut sum, mut moment) = ([0.0; 2], [0.0; 3]);
        for (x, other) in self.cells.around(at) {
            let (way, reach) = (apart(at, x), NEIGHBOUR * 0.5 * (dx + other));
            let distance = length(&way);
            if distance > 0.0 && distance < reach {
                let way = way.map(|w| w / distance);
                (0..2).for_each(|a| sum[a] += way[a]);
                moment =
                    [moment[0] + way[0] * way[0], moment[1] + way[0] * way[1], moment[2] + way[1] * way[1]];
            }
        }
        let size = length(&sum);
        if size > FACE {
            return Some(sum.map(|s| s / size));
        }
        // Neighbours in one line: a single row, whose normal is across.
        let [xx, xy, yy] = moment;
        let line = xx * yy - xy * xy < 0.05 * (xx + yy).powi(2) && xx + yy > 0.0;
        line.then(|| if xx > yy { [-xy, xx] } else { [-yy, xy] }).map(|n| n.map(|c| c / length(&n)))
    }

    /// How thick the matter is behind a particle of its surface, m, where another face ends it within `most`, m.
    fn thickness(&self, at: &[f64; 2], dx: f64, most: f64) -> Option<f64> {
        let normal = self.normal(at, dx)?;
        let behind = |k: u32| [0, 1].map(|a| at[a] - 0.5 * f64::from(k) * dx * normal[a]);
        let last =
            (0..).take_while(|&k| 0.5 * f64::from(k) * dx < most + dx && self.nearest(&behind(k)).is_some());
        let count = last.count() as u32;
        let thickness = 0.5 * f64::from(count) * dx;
        if count == 0 || thickness > most {
            return None;
        }
        let (end, own) = self.nearest(&behind(count - 1))?;
        let other = self.normal(end, *own)?;
        let cosine = normal[0] * other[0] + normal[1] * other[1];
        // A single row has two faces and one normal.
        (cosine < OPPOSITE || end == at).then_some(thickness)
    }
}

/// Where each shape of solid is thinner than fluid needs it, by the shapes' indices; nowhere where the effect that asks
/// for it is off, or in space.
pub(super) fn thinnest<const D: usize>(scene: &Scene, layout: &Layout<D>) -> Vec<Option<Thinnest>> {
    let mut all = vec![None; scene.shapes.len()];
    let Some(least) = geometry::least_thickness(scene).filter(|_| D == 2) else { return all };
    let plane = |x: &[f64; D]| [x[0], x[1]];
    let spacing = |shape: u32| scene.spacing(&scene.shapes[shape as usize]);
    // An irregular arrangement has gaps, and is as thick as its lattice.
    let solids = layout.solid.iter().map(|p| (plane(&p.site), spacing(p.body)));
    let widest = solids.clone().map(|(_, dx)| dx).fold(scene.resolution, f64::max);
    let (mut low, mut high) = ([f64::MAX; 2], [f64::MIN; 2]);
    for (x, _) in solids.clone() {
        (0..2).for_each(|a| (low[a], high[a]) = (low[a].min(x[a]), high[a].max(x[a])));
    }
    // Walls beyond what is asked about a solid have no part in it.
    let reach = 2.0 * NEIGHBOUR * widest + least * scene.resolution;
    let near = |x: &[f64; 2]| (0..2).all(|a| low[a] - reach <= x[a] && x[a] <= high[a] + reach);
    let walls = layout.wall.iter().map(|p| (plane(&p.position), scene.resolution)).filter(|(x, _)| near(x));
    let mut matter = Matter { cells: Cells::new(NEIGHBOUR * widest) };
    solids.chain(walls).for_each(|(x, dx)| matter.cells.add(&x, (x, dx)));
    for point in &layout.solid {
        let (dx, at) = (spacing(point.body), plane(&point.site));
        // What is measured is half a row at the most from what is there.
        let most = least * scene.resolution - 0.51 * dx;
        let Some(thickness) = matter.thickness(&at, dx, most) else { continue };
        let thinnest: &mut Option<Thinnest> = &mut all[point.body as usize];
        if thinnest.is_none_or(|other| thickness < other.thickness) {
            *thinnest = Some(Thinnest { thickness, at });
        }
    }
    all
}

/// Solids that are too thin somewhere, although their shapes are not.
pub(super) fn thin(scene: &Scene, placed: &[Placed], all: &mut Vec<String>) {
    let Some(least) = geometry::least_thickness(scene) else { return };
    let dx = scene.resolution;
    for shape in placed.iter().filter(|shape| shape.phase == Phase::Solid) {
        if let Some(Thinnest { thickness, at: [x, y] }) = shape.thinnest {
            all.push(format!(
                "`{}` is about {:.1} dx thick at [{}, {}], and {least} dx are needed: fluid on one face reaches the \
                 other through it (2h) and leaks",
                shape.name,
                thickness / dx,
                x as f32,
                y as f32
            ));
        }
    }
}
