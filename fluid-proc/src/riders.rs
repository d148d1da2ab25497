//! Points that ride on solids.
//!
//! A point X of the initial configuration goes with the solid's published particles k around it, whose first positions
//! are X_k, with weights w_k that fade with distance, middles X_m = sum w_k X_k and x_m = sum w_k x_k:
//! ```text
//! x = x_m + F (X - X_m),  F = A M^-1,  A = sum w_k (x_k - x_m) (X_k - X_m)^T,  M = sum w_k (X_k - X_m) (X_k - X_m)^T
//! ```
//! Any rigid motion and any even strain is kept exactly, so the point stays where it was in the material. That is a sum
//! of the x_k with constant weights. Of a layer one particle thick F lacks what goes along its normal N: that height
//! goes along the layer's present normal. Particles in one row of three dimensions, or a single one, do not say how
//! they are turned: X - X_m stays as it was.

use halfstep_role::role::Peer;
use halfstep_scene::Scene;
use halfstep_scene::geometry::{self, Cells, Layout};
use halfstep_sph::tensor;
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::state::{Fields, State, StateError};
use nalgebra::{SMatrix, SVector};

/// How much farther than the nearest particle those are that take a point along, in spacings.
const BEYOND: f64 = 1.8;

/// A moment matrix with less than this part of its trace's power as determinant belongs to a layer or a row.
const FLAT: f64 = 1e-6;

/// All points that ride on solids.
pub(crate) struct Riders<const D: usize> {
    ridden: Vec<Ridden<D>>,
    /// Where the points are at a state n, in the order in which they were added, m.
    pub(crate) now: Vec<[f64; D]>,
}

/// A solid that takes points along.
struct Ridden<const D: usize> {
    /// Index in the scene.
    solid: usize,
    spacing: f64,
    particles: Placed<D>,
    /// Positions of the first records, m; empty before them.
    first: Vec<[f64; D]>,
    points: Vec<Rider<D>>,
}

/// Particles of a solid as the scene places them: where, and shape and piece of each.
struct Placed<const D: usize> {
    near: Cells<([f64; D], u32, u32), D>,
}

struct Rider<const D: usize> {
    /// Place among all points.
    place: usize,
    /// In the initial configuration, m.
    at: [f64; D],
    shape: u32,
    tie: Tie<D>,
}

/// How a point goes with records.
#[derive(Default)]
pub(crate) struct Tie<const D: usize> {
    /// Records, weights of their positions, and of those in the layer's tangents.
    records: Vec<(u32, f64, [f64; 2])>,
    /// What the weights leave of the point's place: it stays as it is, m.
    offset: Option<[f64; D]>,
    /// Height above a layer, m.
    height: f64,
}

impl<const D: usize> Riders<D> {
    pub(crate) fn new() -> Self {
        Self { ridden: Vec::new(), now: Vec::new() }
    }

    /// Adds points that ride on a shape of a solid; returns their places.
    pub(crate) fn add(
        &mut self,
        scene: &Scene,
        layout: &Layout<D>,
        shape: usize,
        points: &[[f64; D]],
    ) -> Option<std::ops::Range<usize>> {
        let solid = scene.shapes[shape].solid?;
        let known = self.ridden.iter().position(|ridden| ridden.solid == solid);
        let index = known.unwrap_or_else(|| {
            self.ridden.push(Ridden::new(scene, layout, solid));
            self.ridden.len() - 1
        });
        let start = self.now.len();
        for (k, &at) in points.iter().enumerate() {
            let tie = Tie { offset: Some(at), ..Tie::default() };
            self.ridden[index].points.push(Rider { place: start + k, at, shape: shape as u32, tie });
        }
        self.now.extend_from_slice(points);
        Some(start..self.now.len())
    }

    /// Brings the points to where the solids' records of a state n take them.
    pub(crate) fn ride(&mut self, peers: &[Peer]) {
        for ridden in &mut self.ridden {
            let Some(Peer { records, .. }) = peers.get(ridden.solid) else { continue };
            // The number of a solid's records never changes.
            if ridden.first.len() != records.len() {
                ridden.first = records.iter().map(position).collect();
                ridden.tie();
            }
            for rider in &ridden.points {
                self.now[rider.place] = rider.tie.place(records);
            }
        }
    }
}

fn position<const D: usize>(record: &StateRecord) -> [f64; D] {
    std::array::from_fn(|d| record.position[d])
}

fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
}

impl<const D: usize> Placed<D> {
    /// Shape and piece of the particle nearest to a point.
    fn nearest(&self, at: [f64; D]) -> Option<(u32, u32)> {
        let near = self.near.around(&at).map(|(x, shape, piece)| (distance(*x, at), *shape, *piece));
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, shape, piece)| (shape, piece))
    }
}

impl<const D: usize> Ridden<D> {
    fn new(scene: &Scene, layout: &Layout<D>, solid: usize) -> Self {
        let of_solid = layout.solid.iter().filter(|p| scene.shapes[p.body as usize].solid == Some(solid));
        let own = Layout { solid: of_solid.copied().collect(), ..Layout::default() };
        let spacing = scene.solid_spacing(solid);
        let mut near = Cells::new(2.0 * spacing);
        for (point, piece) in own.solid.iter().zip(geometry::pieces(scene, &own)) {
            near.add(&point.position, (point.position, point.body, piece));
        }
        Self { solid, spacing, particles: Placed { near }, first: Vec::new(), points: Vec::new() }
    }

    /// Ties all points to the records that were around them at first.
    fn tie(&mut self) {
        // An external solid's particles may lie beside those of the scene.
        let of: Vec<Option<(u32, u32)>> = self.first.iter().map(|&x| self.particles.nearest(x)).collect();
        for rider in &mut self.points {
            let nearest = |own: &dyn Fn(usize) -> bool| {
                let own = (0..of.len()).filter(|&k| own(k)).map(|k| (distance(self.first[k], rider.at), k));
                own.min_by(|a, b| a.0.total_cmp(&b.0))
            };
            let found = nearest(&|k| of[k].is_some_and(|(shape, _)| shape == rider.shape));
            // Where no record is said to be of the shape, all are.
            let Some((least, k)) = found.or_else(|| nearest(&|_| true)) else { continue };
            let reach = least + BEYOND * self.spacing;
            let piece = of[k].map(|(_, piece)| piece);
            let around = (0..of.len()).filter(|&k| of[k].map(|(_, piece)| piece) == piece);
            let near = around.map(|k| (k as u32, self.first[k], distance(self.first[k], rider.at)));
            let near: Vec<_> = near.filter(|(.., r)| *r < reach).collect();
            rider.tie = Tie::new(rider.at, &near, reach);
        }
    }
}

impl<const D: usize> Tie<D> {
    /// To records with these first positions and distances, all within a reach.
    pub(crate) fn new(at: [f64; D], near: &[(u32, [f64; D], f64)], reach: f64) -> Self {
        let fade = |r: f64| (1.0 - r / reach).powi(2);
        let whole: f64 = near.iter().map(|(.., r)| fade(*r)).sum();
        let at = SVector::from(at);
        let all: Vec<(u32, SVector<f64, D>, f64)> =
            near.iter().map(|(record, x, r)| (*record, SVector::from(*x) - at, fade(*r) / whole)).collect();
        let middle = all.iter().map(|(_, r, w)| r * *w).sum::<SVector<f64, D>>();
        let mut moment = SMatrix::<f64, D, D>::zeros();
        for (_, r, w) in &all {
            moment += (r - middle) * (r - middle).transpose() * *w;
        }
        let flat = |m: &SMatrix<f64, D, D>| tensor::determinant(m) <= FLAT * m.trace().powi(D as i32);
        let normal = if flat(&moment) { normal_of(&moment) } else { None };
        if let Some(n) = normal {
            moment += n * n.transpose() * moment.trace();
        }
        let inverse = tensor::inverse(&moment, tensor::determinant(&moment)).filter(|_| !flat(&moment));
        let Some(inverse) = inverse else {
            let records = all.iter().map(|(record, _, w)| (*record, *w, [0.0; 2])).collect();
            return Self { records, offset: Some((-middle).into()), height: 0.0 };
        };
        let slope = inverse * -middle;
        let tangents = normal.map(tangents_of);
        let weights = |(record, r, w): &(u32, SVector<f64, D>, f64)| {
            let r = r - middle;
            let along = |t: &SVector<f64, D>| w * r.dot(&(inverse * t));
            let tangents = tangents.map_or([0.0; 2], |t| t.each_ref().map(along));
            (*record, w * (1.0 + r.dot(&slope)), tangents)
        };
        let records = all.iter().map(weights).collect();
        Self { records, offset: None, height: normal.map_or(0.0, |n| -middle.dot(&n)) }
    }

    /// Where the point is.
    pub(crate) fn place(&self, records: &[StateRecord]) -> [f64; D] {
        let mut x = SVector::from(self.offset.unwrap_or([0.0; D]));
        let mut tangents = [SVector::<f64, D>::zeros(); 2];
        for (record, w, along) in &self.records {
            let at = SVector::from(position(&records[*record as usize]));
            x += at * *w;
            for (tangent, w) in tangents.iter_mut().zip(along) {
                *tangent += at * *w;
            }
        }
        if self.height != 0.0 {
            let normal = across(&tangents);
            let length = normal.norm();
            if length > 0.0 {
                x += normal * (self.height / length);
            }
        }
        x.into()
    }
}

/// Unit normal of the layer that a singular moment matrix belongs to; `None` of a row in space, and of one particle.
///
/// The adjugate is a multiple of N N^T.
fn normal_of<const D: usize>(m: &SMatrix<f64, D, D>) -> Option<SVector<f64, D>> {
    let adjugate = |i: usize, j: usize| match D {
        2 => [[m[(1, 1)], -m[(0, 1)]], [-m[(1, 0)], m[(0, 0)]]][i][j],
        _ => {
            let of = |i: usize, j: usize| m[(i % D, j % D)];
            of(j + 1, i + 1) * of(j + 2, i + 2) - of(j + 1, i + 2) * of(j + 2, i + 1)
        }
    };
    let widest = (0..D).max_by(|&a, &b| adjugate(a, a).total_cmp(&adjugate(b, b)))?;
    let column = SVector::<f64, D>::from_fn(|i, _| adjugate(i, widest));
    let size = column.norm();
    (size > FLAT * m.trace().powi(D as i32 - 1)).then(|| column / size)
}

/// Two vectors across a unit normal (2D: one and zero), so that [`across`] of them is along the normal.
fn tangents_of<const D: usize>(n: SVector<f64, D>) -> [SVector<f64, D>; 2] {
    if D == 2 {
        let mut along = SVector::zeros();
        (along[0], along[1]) = (n[1], -n[0]);
        return [along, SVector::zeros()];
    }
    // Beside the axis that the normal has least of.
    let least = (0..D).min_by(|&a, &b| n[a].abs().total_cmp(&n[b].abs())).unwrap_or(0);
    let mut axis = SVector::zeros();
    axis[least] = 1.0;
    let first = axis - n * n[least];
    let first = first / first.norm();
    [first, across(&[n, first])]
}

/// A vector across two others (2D: across the first one).
fn across<const D: usize>([a, b]: &[SVector<f64, D>; 2]) -> SVector<f64, D> {
    let mut normal = SVector::zeros();
    if D == 2 {
        (normal[0], normal[1]) = (-a[1], a[0]);
    } else {
        (0..D).for_each(|d| {
            let (i, j) = ((d + 1) % D, (d + 2) % D);
            normal[d] = a[i] * b[j] - a[j] * b[i];
        });
    }
    normal
}

impl<const D: usize> State for Riders<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let mut all = self.ridden.iter_mut().enumerate();
        all.try_for_each(|(k, ridden)| fields.points(&format!("first_{k}"), &mut ridden.first))
    }

    fn restored(&mut self) -> Result<(), StateError> {
        self.ridden.iter_mut().filter(|ridden| !ridden.first.is_empty()).for_each(Ridden::tie);
        Ok(())
    }
}
