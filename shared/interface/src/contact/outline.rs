//! Outline of a solid: points that go with its particles, and straight parts between them.

use super::flanks::find_corners;
use super::law::less;
use halfstep_scene::geometry::{self, Cells, Layout, Surface};
use halfstep_scene::{Phase, Scene};
use nalgebra::{Matrix2, Vector2};
use std::collections::BTreeMap;

/// Points of an outline in a spacing of particles.
const POINTS: f64 = 2.0;

/// How far particles that carry a point lie from it, in spacings.
pub(super) const REACH: f64 = 2.3;

/// A moment matrix with less than this part of its trace squared as determinant belongs to a row of particles.
const FLAT: f64 = 1e-6;

/// Records that carry a point, with their weights.
type Weights = Vec<(u32, f64)>;

/// Shape, copy and ends of a part.
type ShapePart = (u32, u32, [[f64; 2]; 2]);

/// A point of an outline.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// Records and weights.
    pub(super) weights: Weights,
    /// What one row of particles cannot say of its place, m.
    pub(super) offset: [f64; 2],
    /// Share of the outline, m.
    pub(super) length: f64,
    /// How far before it the surface lies, m: half a spacing of a single particle.
    pub(super) radius: f64,
    /// The parts before and after it; `None` of a point alone.
    pub(super) beside: Option<[u32; 2]>,
}

/// A straight part; the solid lies on its left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// Its points.
    pub(super) ends: [u32; 2],
    /// The parts before and after it; itself where there is none.
    pub(super) beside: [u32; 2],
    /// The convex corners at which its straight or round side begins and ends.
    pub(super) corners: [Option<u32>; 2],
}

/// A body's parts, in a row.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) parts: std::ops::Range<u32>,
    pub(super) points: Vec<u32>,
    /// Points of its particles, each alone, where it can break.
    pub(super) singles: Vec<u32>,
    /// Number of the body in the scene.
    number: u32,
    /// Least mass behind a length, kg/m (2D: kg/m²).
    mass: f64,
}

/// Outline of a solid.
#[derive(Clone, Debug, Default)]
pub(super) struct Outline {
    /// Those of the outline, then those of single particles.
    pub(super) points: Vec<Point>,
    pub(super) parts: Vec<Part>,
    pub(super) pieces: Vec<Piece>,
    /// Spacing of the solid's particles, m.
    pub(super) spacing: f64,
    /// The solid can break.
    pub(super) breaks: bool,
}

/// Particles of a solid as the scene places them, and which record each is.
struct Particles {
    near: Cells<(usize, [f64; 2]), 2>,
    /// Shape, copy and piece of each.
    of: Vec<(u32, u32, u32)>,
    records: Cells<(u32, [f64; 2], u32), 2>,
    spacing: f64,
}

pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

impl Particles {
    fn new(scene: &Scene, placed: &Layout<2>, solid: usize, at: &[[f64; 2]]) -> Self {
        let layout = placed.clone().with_solid(scene, solid);
        let spacing = scene.solid_spacing(solid);
        let pieces = geometry::pieces(scene, &layout);
        let side = REACH * spacing;
        let mut own = Self { near: Cells::new(side), of: Vec::new(), records: Cells::new(side), spacing };
        for (k, (point, piece)) in layout.solid.iter().zip(pieces).enumerate() {
            own.near.add(&point.position, (k, point.position));
            own.of.push((point.body, point.copy, piece));
        }
        for (record, place) in at.iter().enumerate() {
            // A foreign solid's particles may lie beside those of the scene.
            let piece = own.nearest(*place, 0.75, |_| true).map(|k| own.of[k].2);
            if let Some(piece) = piece {
                own.records.add(place, (record as u32, *place, piece));
            }
        }
        own
    }

    /// The nearest of some particles within so many spacings.
    fn nearest(&self, at: [f64; 2], reach: f64, of: impl Fn(usize) -> bool) -> Option<usize> {
        let near = self.near.around(&at).filter(|(k, _)| of(*k));
        let near = near.map(|(k, place)| (distance(*place, at), *k));
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        (nearest.0 <= reach * self.spacing).then_some(nearest.1)
    }

    /// The piece whose outline a part of a shape is; `None` inside of a piece, or where voids took the particles.
    fn piece_at(&self, shape: u32, copy: u32, [from, to]: [[f64; 2]; 2]) -> Option<u32> {
        let length = distance(from, to);
        let beside = |way: f64| {
            let out = [(to[1] - from[1]) / length, (from[0] - to[0]) / length];
            [0, 1].map(|d| 0.5 * (from[d] + to[d]) + way * self.spacing * out[d])
        };
        let own = |k: usize| self.of[k].0 == shape && self.of[k].1 == copy;
        let piece = self.of[self.nearest(beside(-0.5), 1.5, own)?].2;
        let covered = self.nearest(beside(1.0), 0.72, |k| self.of[k].2 == piece).is_some();
        (!covered).then_some(piece)
    }

    /// Records and weights of a point of a piece, and what they leave of its place. The weights keep linear fields.
    fn weights(&self, at: [f64; 2], piece: u32) -> Option<(Weights, [f64; 2])> {
        let reach = REACH * self.spacing;
        let mut near: Vec<(u32, Vector2<f64>, f64)> = self
            .records
            .around(&at)
            .filter(|(_, place, of)| *of == piece && distance(*place, at) < reach)
            .map(|(record, place, _)| {
                let fade = 1.0 - distance(*place, at) / reach;
                (*record, Vector2::new(place[0] - at[0], place[1] - at[1]), fade * fade)
            })
            .collect();
        near.sort_by_key(|(record, ..)| *record);
        let sum: f64 = near.iter().map(|(.., w)| w).sum();
        if sum <= 0.0 {
            return None;
        }
        let middle = near.iter().map(|(_, r, w)| r * (w / sum)).sum::<Vector2<f64>>();
        let moment = near
            .iter()
            .map(|(_, r, w)| (r - middle) * (r - middle).transpose() * (w / sum))
            .sum::<Matrix2<f64>>();
        let trace = moment.trace();
        let inverse = if moment.determinant() > FLAT * trace * trace {
            moment.try_inverse()?
        } else {
            // One row: along it alone. Both columns are, and their sum may be nothing.
            let [x, y] = [0, 1].map(|d| moment.column(d).into_owned());
            let along = if x.norm_squared() < y.norm_squared() { y } else { x };
            let size = along.norm_squared();
            if size > 0.0 && trace > 0.0 {
                along * along.transpose() / (size * trace)
            } else {
                Matrix2::zeros()
            }
        };
        let slope = inverse * -middle;
        let weights: Weights =
            near.iter().map(|(record, r, w)| (*record, w / sum * (1.0 + (r - middle).dot(&slope)))).collect();
        let left = -near.iter().zip(&weights).map(|((_, r, _), (_, w))| r * *w).sum::<Vector2<f64>>();
        let exact = left.norm() < 1e-9 * self.spacing;
        Some((weights, if exact { [0.0; 2] } else { [left[0], left[1]] }))
    }
}

impl Piece {
    /// Points without parts between them.
    pub(super) fn of_points(points: Vec<u32>) -> Self {
        Self { parts: 0..0, points, singles: Vec::new(), number: 0, mass: f64::INFINITY }
    }
}

impl Outline {
    /// Of all solids of a scene, whose records were here at first, m, and have these masses.
    pub(super) fn all(scene: &Scene, first: &[(Vec<[f64; 2]>, Vec<f64>)]) -> Vec<Self> {
        let placed = geometry::solids(scene);
        let of = |(solid, (at, mass)): (usize, &(Vec<[f64; 2]>, Vec<f64>))| {
            Self::new(scene, &placed, solid, at, mass)
        };
        first.iter().enumerate().map(of).collect()
    }

    /// Of the solid of that index among those whose particles are placed.
    pub(super) fn new(
        scene: &Scene,
        placed: &Layout<2>,
        solid: usize,
        at: &[[f64; 2]],
        mass: &[f64],
    ) -> Self {
        let particles = Particles::new(scene, placed, solid, at);
        let spacing = particles.spacing;
        // By piece: in the order in which their shapes stand in the file.
        let mut parts: BTreeMap<u32, Vec<ShapePart>> = BTreeMap::new();
        let own = |s: &(usize, &halfstep_scene::Shape)| s.1.phase == Phase::Solid && s.1.solid == Some(solid);
        for (index, shape) in scene.shapes.iter().enumerate().filter(own) {
            Surface::new(&shape.geometry, None).outline(spacing / POINTS, &mut |copy, ends| {
                if let Some(piece) = particles.piece_at(index as u32, copy, ends) {
                    parts.entry(piece).or_default().push((index as u32, copy, ends));
                }
            });
        }
        let breaks = scene.solids[solid].fracture().is_some();
        let mut outline = Self { spacing, breaks, ..Self::default() };
        for (piece, parts) in parts {
            outline.add(&particles, piece, &parts);
        }
        outline.weigh(scene, solid, &particles, mass);
        if breaks {
            outline.add_singles(&particles, at, mass);
        }
        outline
    }

    fn add(&mut self, particles: &Particles, piece: u32, parts: &[ShapePart]) {
        let mut known: BTreeMap<(u32, u32, [u64; 2]), Option<u32>> = BTreeMap::new();
        let first = self.parts.len() as u32;
        let (mut points, mut lines) = (Vec::new(), Vec::new());
        for (shape, copy, ends) in parts {
            let found = ends.map(|end| {
                *known.entry((*shape, *copy, end.map(f64::to_bits))).or_insert_with(|| {
                    let (weights, offset) = particles.weights(end, piece)?;
                    self.points.push(Point { weights, offset, length: 0.0, radius: 0.0, beside: None });
                    points.push(self.points.len() as u32 - 1);
                    points.last().copied()
                })
            });
            let [Some(from), Some(to)] = found else { continue };
            let length = distance(ends[0], ends[1]);
            for end in [from, to] {
                self.points[end as usize].length += 0.5 * length;
            }
            let own = self.parts.len() as u32;
            self.parts.push(Part { ends: [from, to], beside: [own, own], corners: [None; 2] });
            lines.push(less(ends[1], ends[0]));
        }
        let all = first..self.parts.len() as u32;
        let mut begins: BTreeMap<u32, u32> = BTreeMap::new();
        all.clone().for_each(|k| {
            begins.insert(self.parts[k as usize].ends[0], k);
        });
        for k in all.clone() {
            if let Some(&after) = begins.get(&self.parts[k as usize].ends[1]) {
                self.parts[k as usize].beside[1] = after;
                self.parts[after as usize].beside[0] = k;
                self.points[self.parts[k as usize].ends[1] as usize].beside = Some([k, after]);
            }
        }
        find_corners(&mut self.parts[first as usize..], first, &lines);
        points.retain(|&p| self.points[p as usize].length > 0.0);
        if !all.is_empty() {
            self.pieces.push(Piece { parts: all, points, singles: Vec::new(), number: piece, mass: 0.0 });
        }
    }

    /// Each particle as a point of its own, whose spring is as soft as its mass asks: the steps stay those of the
    /// outline.
    fn add_singles(&mut self, particles: &Particles, at: &[[f64; 2]], mass: &[f64]) {
        for (record, place) in at.iter().enumerate() {
            let Some(k) = particles.nearest(*place, 0.75, |_| true) else { continue };
            let number = particles.of[k].2;
            let Some(piece) = self.pieces.iter_mut().find(|piece| piece.number == number) else { continue };
            piece.singles.push(self.points.len() as u32);
            self.points.push(Point {
                weights: vec![(record as u32, 1.0)],
                offset: [0.0; 2],
                length: self.spacing.min(mass[record] / piece.mass),
                radius: 0.5 * self.spacing,
                beside: None,
            });
        }
    }

    /// Finds the mass behind each piece: that of a rigid body lies behind its whole outline.
    fn weigh(&mut self, scene: &Scene, solid: usize, particles: &Particles, mass: &[f64]) {
        let cell = self.spacing * self.spacing;
        for piece in &mut self.pieces {
            let number = piece.number;
            let points = piece.points.iter().map(|&p| &self.points[p as usize]);
            piece.mass = match scene.solids[solid].rigid() {
                None => {
                    let behind = |p: &Point| {
                        let share = |(record, w): &(u32, f64)| w * w / mass[*record as usize];
                        1.0 / (p.weights.iter().map(share).sum::<f64>() * p.length)
                    };
                    points.map(behind).fold(f64::INFINITY, f64::min)
                }
                Some(keys) => {
                    let own = particles.of.iter().filter(|of| of.2 == number);
                    let shapes = own.map(|of| &scene.shapes[of.0 as usize]);
                    let density = scene.solids[solid].density;
                    let of_shapes: f64 = shapes.clone().map(|s| s.density.unwrap_or(density) * cell).sum();
                    let said = |s: &halfstep_scene::Shape| {
                        keys.bodies.iter().find(|body| body.name == s.body()).and_then(|body| body.mass)
                    };
                    let whole = shapes.clone().find_map(said).unwrap_or(of_shapes);
                    whole / points.map(|p| p.length).sum::<f64>()
                }
            };
        }
    }

    /// Least mass behind a length of it, kg/m (2D: kg/m²).
    pub(super) fn least_mass(&self) -> f64 {
        self.pieces.iter().map(|piece| piece.mass).fold(f64::INFINITY, f64::min)
    }
}
