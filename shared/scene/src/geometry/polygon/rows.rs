//! Wall particles of a polygon: rows parallel to its sides, as deep as the kernel reaches.
//!
//! Row k lies at the depth (k + 1/2) dx (nodal: k dx). Sides that turn by little make one line, along which a row has
//! equal spacings; at a corner the rows of both sides end on the bisector, so around a rectangle the rows are the
//! lattice that a tank has. Of particles that are closer to another side than to their own, that one's rows are there.

use super::{Edge, Edges, Polygon, dot, in_space};
use crate::geometry::cells::Cells;
use crate::geometry::points::{Point, Spacing};

/// Cosine of the turn from which on a corner reverses all components of a velocity: 45 degrees.
const SHARP: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Least distance of two particles, in spacings.
const APART: f64 = 0.6;

/// Sides from one sharp corner to the next, by their indices; or all of a line without any.
struct Chain {
    sides: Vec<usize>,
    closed: bool,
}

/// Outlines lie in a plane, whatever the dimension of the scene.
const PLANE: usize = 2;

/// All particles of a wall.
pub(in crate::geometry) fn rows<const D: usize>(polygon: &Polygon, spacing: Spacing) -> Vec<Point<D>> {
    let edges = Edges::new(polygon);
    let chains = chains(&edges);
    let layers = spacing.layers() + i64::from(spacing.nodal);
    let mut kept = Kept { points: Vec::new(), cells: Cells::new(spacing.dx), dx: spacing.dx };
    for depth in (0..layers).map(|k| spacing.place(k) * spacing.dx) {
        for chain in &chains {
            row(&edges, chain, depth, spacing, &mut kept);
        }
    }
    let in_space = |p: Point<PLANE>| Point {
        position: in_space(p.position),
        normal: in_space(p.normal),
        depth: p.depth,
        corner: p.corner,
    };
    kept.points.into_iter().map(in_space).collect()
}

fn is_sharp(edges: &Edges, edge: &Edge) -> bool {
    dot(&edges.all[edge.before].normal(), &edge.normal()) < SHARP
}

fn chains(edges: &Edges) -> Vec<Chain> {
    let mut chains = Vec::new();
    let mut first = 0;
    while first < edges.all.len() {
        let count = edges.all[first..].iter().take_while(|e| e.line == edges.all[first].line).count();
        let line = first..first + count;
        first = line.end;
        let Some(begin) = line.clone().find(|&k| is_sharp(edges, &edges.all[k])) else {
            chains.push(Chain { sides: line.collect(), closed: true });
            continue;
        };
        let (mut sides, mut k) = (vec![begin], edges.all[begin].after);
        while k != begin {
            if is_sharp(edges, &edges.all[k]) {
                chains.push(Chain { sides: std::mem::take(&mut sides), closed: false });
            }
            sides.push(k);
            k = edges.all[k].after;
        }
        chains.push(Chain { sides, closed: false });
    }
    chains
}

/// Where the parallels of two sides at a depth meet, seen from their corner; along each of them at most `most`, m.
fn bisector(before: &Edge, after: &Edge, depth: f64, most: f64) -> [f64; 2] {
    let (a, b) = (before.normal(), after.normal());
    let along = before.direction();
    // tan of half the turn, positive where the boundary turns to the left and the parallel becomes shorter.
    let turn = (a[0] * b[1] - a[1] * b[0]) / (1.0 + dot(&a, &b)).max(1e-9);
    let shift = (depth * turn).max(-most);
    [0, 1].map(|c| -depth * a[c] - shift * along[c])
}

/// A place on a parallel of a chain: the side, and the point.
type Place = (usize, [f64; 2]);

/// The corners of a chain's parallel, each with the side that begins there; the last one ends its side.
fn parallel(edges: &Edges, chain: &Chain, depth: f64, most: f64) -> Vec<Place> {
    let mut corners: Vec<Place> = chain
        .sides
        .iter()
        .map(|&k| {
            let edge = &edges.all[k];
            let mut shift = bisector(&edges.all[edge.before], edge, depth, most);
            if shift_is_cut(&edges.all[edge.before], edge, depth, most) {
                // The parallel of this side is cut at its own end.
                let along = edge.direction();
                let normal = edge.normal();
                shift = [0, 1].map(|c| -depth * normal[c] - most * along[c]);
            }
            (k, [0, 1].map(|c| edge.from[c] + shift[c]))
        })
        .collect();
    let last = chain.sides[chain.sides.len() - 1];
    let (edge, next) = (&edges.all[last], &edges.all[edges.all[last].after]);
    let shift = bisector(edge, next, depth, most);
    corners.push((last, [0, 1].map(|c| edge.to[c] + shift[c])));
    corners
}

/// Whether two sides turn so far to the right that their parallels end before they meet.
fn shift_is_cut(before: &Edge, after: &Edge, depth: f64, most: f64) -> bool {
    let (a, b) = (before.normal(), after.normal());
    depth * (a[0] * b[1] - a[1] * b[0]) / (1.0 + dot(&a, &b)).max(1e-9) < -most
}

fn row(edges: &Edges, chain: &Chain, depth: f64, spacing: Spacing, kept: &mut Kept) {
    let most = spacing.layers() as f64 * spacing.dx;
    let corners = parallel(edges, chain, depth, most);
    let length = |pair: &[Place]| libm::hypot(pair[1].1[0] - pair[0].1[0], pair[1].1[1] - pair[0].1[1]);
    let total: f64 = corners.windows(2).map(length).sum();
    let count = ((total / spacing.dx).round() as usize).max(1);
    let last = if chain.closed { count - 1 } else { count };
    let (mut side, mut before) = (0, 0.0);
    for i in 0..=last {
        let at = total * i as f64 / count as f64;
        while side + 2 < corners.len() && at > before + length(&corners[side..]) {
            before += length(&corners[side..]);
            side += 1;
        }
        let [(k, from), (_, to)] = [corners[side], corners[side + 1]];
        let share = ((at - before) / length(&corners[side..]).max(f64::MIN_POSITIVE)).min(1.0);
        let position = [0, 1].map(|c| from[c] + share * (to[c] - from[c]));
        let end = !chain.closed && (i == 0 || i == last);
        let tolerance = crate::geometry::TOLERANCE * spacing.dx;
        let nearer = edges.nearest(&position, depth - 1e3 * tolerance).is_some_and(|_| depth > 0.0);
        if nearer || !edges.contains(&position, tolerance) {
            continue;
        }
        let (normal, depth, corner) =
            surface(edges, k, &position, end.then_some(i == 0), tolerance, !chain.closed);
        kept.add(Point { position, normal, depth, corner });
    }
}

/// The outward normal at a particle of a side's row, its depth, m, infinite behind an edge, and whether it lies in a
/// corner.
fn surface(
    edges: &Edges,
    k: usize,
    p: &[f64; 2],
    end: Option<bool>,
    tolerance: f64,
    has_corners: bool,
) -> ([f64; 2], f64, bool) {
    let edge = &edges.all[k];
    let [along, depth] = edge.coordinates(p);
    let beyond = match end {
        Some(first) => Some(first),
        None if along < tolerance => Some(true),
        None if along > edge.length() - tolerance => Some(false),
        None => None,
    };
    let Some(first) = beyond else { return (edge.normal(), depth, false) };
    let [before, after] = if first { [edge.before, k] } else { [k, edge.after] };
    let (a, b) = (edges.all[before].normal(), edges.all[after].normal());
    let sharp = has_corners && dot(&a, &b) < SHARP;
    let sum = [a[0] + b[0], a[1] + b[1]];
    let corner = edges.all[after].from;
    // Behind a gentle corner the surface is round; behind a sharp one it has the diagonal.
    let out = match sharp || depth <= tolerance {
        true => sum,
        false => [corner[0] - p[0], corner[1] - p[1]],
    };
    let length = libm::hypot(out[0], out[1]);
    // Water flows round a corner that stands out.
    let stands_out = sharp && a[0] * b[1] - a[1] * b[0] > 0.0;
    let normal = if length > 0.0 { out.map(|c| c / length) } else { edge.normal() };
    (normal, if stands_out { f64::INFINITY } else { depth }, sharp && !stands_out)
}

/// The particles so far.
struct Kept {
    points: Vec<Point<PLANE>>,
    /// Their positions, m.
    cells: Cells<[f64; PLANE], PLANE>,
    dx: f64,
}

impl Kept {
    /// Takes a particle that is not too close to another one.
    fn add(&mut self, point: Point<PLANE>) {
        let p = point.position;
        let apart = |q: &[f64; PLANE]| libm::hypot(q[0] - p[0], q[1] - p[1]);
        if self.cells.around(&p).all(|q| apart(q) >= APART * self.dx) {
            self.cells.add(&p, p);
            self.points.push(point);
        }
    }
}
