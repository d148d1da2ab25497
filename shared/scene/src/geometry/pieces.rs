//! Connected pieces of solids.

use super::cells::Cells;
use super::crossing::Cracks;
use super::{Layout, SolidPoint};
use crate::{Scene, SolidModelName};
use std::collections::{BTreeSet, HashMap};

/// What two particles must have in common to be of one piece: solid, body and copy.
type Label<'s> = (Option<usize>, &'s str, u32);

/// The body that a particle's shape names: its own one by default, each copy of a shape one. A hypoelastic solid is one
/// continuum.
fn label<'s, const D: usize>(scene: &'s Scene, point: &SolidPoint<D>) -> Label<'s> {
    let shape = &scene.shapes[point.body as usize];
    let model = shape.solid.and_then(|k| scene.solids.get(k)).map(|solid| solid.model.name());
    match model {
        Some(SolidModelName::Hypoelastic) => (shape.solid, "", 0),
        _ if shape.body.is_empty() => (shape.solid, shape.body(), point.copy),
        _ => (shape.solid, shape.body(), 0),
    }
}

/// A particle of a rigid body that its shape names.
fn is_named_rigid<const D: usize>(scene: &Scene, point: &SolidPoint<D>) -> bool {
    let shape = &scene.shapes[point.body as usize];
    let solid = shape.solid.and_then(|k| scene.solids.get(k));
    !shape.body.is_empty() && solid.is_some_and(|solid| solid.rigid().is_some())
}

/// Calls `visit` with each pair of solid particles of one solid within the support of its kernel.
fn each_pair<const D: usize>(scene: &Scene, layout: &Layout<D>, mut visit: impl FnMut(u32, u32)) {
    let points = &layout.solid;
    let solid = |point: &SolidPoint<D>| scene.shapes[point.body as usize].solid;
    let reach_of = |point: &SolidPoint<D>| {
        let h = solid(point).and_then(|k| scene.solids.get(k)).map_or(0.0, |solid| solid.smoothing_ratio);
        2.0 * (h * scene.spacing(&scene.shapes[point.body as usize]))
    };
    let widest = points.iter().map(reach_of).fold(0.0, f64::max);
    let mut cells = Cells::new(widest);
    for (i, point) in points.iter().enumerate() {
        let reach = reach_of(point);
        for &j in cells.around(&point.position) {
            let other: &SolidPoint<D> = &points[j as usize];
            let r2: f64 = (0..D).map(|d| (point.position[d] - other.position[d]).powi(2)).sum();
            if r2 < reach * reach && solid(point) == solid(other) {
                visit(i as u32, j);
            }
        }
        cells.add(&point.position, i as u32);
    }
}

/// A number for the connected piece of each solid particle, from 0 on in the order of their first particles. Particles
/// of one body are connected where they are within the support of their solid's kernel; those of a rigid body that
/// shapes name are, wherever they are.
pub fn pieces<const D: usize>(scene: &Scene, layout: &Layout<D>) -> Vec<u32> {
    let labels: Vec<Label<'_>> = layout.solid.iter().map(|point| label(scene, point)).collect();
    let mut parent: Vec<u32> = (0..labels.len() as u32).collect();
    let cracks = Cracks::of(scene);
    each_pair(scene, layout, |i, j| {
        let [one, other] = [i, j].map(|k| &layout.solid[k as usize]);
        if labels[i as usize] == labels[j as usize] && !cracks.part(one, other) {
            let (a, b) = (root(&mut parent, i), root(&mut parent, j));
            parent[a.max(b) as usize] = a.min(b);
        }
    });
    let mut first: HashMap<Label<'_>, u32> = HashMap::new();
    for (p, _) in layout.solid.iter().enumerate().filter(|(_, point)| is_named_rigid(scene, point)) {
        let other = *first.entry(labels[p]).or_insert(p as u32);
        let (a, b) = (root(&mut parent, p as u32), root(&mut parent, other));
        parent[a.max(b) as usize] = a.min(b);
    }
    let mut numbers = HashMap::new();
    let mut number = |p| {
        let next = numbers.len() as u32;
        *numbers.entry(root(&mut parent, p)).or_insert(next)
    };
    (0..labels.len() as u32).map(&mut number).collect()
}

/// Pairs of shapes, by their indices, that touch and are different bodies of one solid.
pub fn touching<const D: usize>(scene: &Scene, layout: &Layout<D>) -> BTreeSet<(usize, usize)> {
    let mut pairs = BTreeSet::new();
    let points = &layout.solid;
    each_pair(scene, layout, |i, j| {
        let [one, other] = [i, j].map(|k| &points[k as usize]);
        // Particles that touch are of one piece where their bodies are the same.
        if one.body != other.body && label(scene, one) != label(scene, other) {
            let [a, b] = [one, other].map(|point| point.body as usize);
            pairs.insert((a.min(b), a.max(b)));
        }
    });
    pairs
}

fn root(parent: &mut [u32], mut p: u32) -> u32 {
    while parent[p as usize] != p {
        parent[p as usize] = parent[parent[p as usize] as usize];
        p = parent[p as usize];
    }
    p
}
