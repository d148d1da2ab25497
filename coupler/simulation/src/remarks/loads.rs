//! Remarks on tractions.

use halfstep_scene::geometry::Layout;
use halfstep_scene::{Scene, Shape, Traction};
use std::collections::BTreeSet;

/// Rows, one behind the other, from which on a traction loads no surface.
const SEVERAL: f64 = 1.5;

/// A traction acts on one face of each particle: in a box of several rows its force is that many times a surface's, and
/// grows as the spacing falls.
pub(super) fn tractions<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let loaded = |(index, shape): (usize, &Shape)| Some((index, shape.name.clone(), shape.load?));
    for (index, name, Traction { traction, .. }) in scene.shapes.iter().enumerate().filter_map(loaded) {
        let dx = scene.spacing(&scene.shapes[index]);
        let taken =
            layout.solid.iter().filter(|p| p.body as usize == index && !p.clamped && p.is_in_load(scene));
        let places: Vec<[f64; D]> = taken.map(|p| p.position).collect();
        let columns = |axis: usize| {
            let cells: BTreeSet<i64> = places.iter().map(|x| (x[axis] / dx).floor() as i64).collect();
            cells.len()
        };
        let most = (0..D).map(columns).max().unwrap_or(0).max(1);
        let rows = places.len() as f64 / most as f64;
        if rows < SEVERAL {
            continue;
        }
        let size = traction.iter().map(|t| t * t).sum::<f64>().sqrt();
        let force = size * dx.powi(D as i32 - 1) * places.len() as f64;
        let unit = if D == 2 { "N/m" } else { "N" };
        all.push(format!(
            "the traction on `{name}` acts on one face of each of {} particles in {rows:.0} rows: {force:.3e} {unit} in \
             all, {rows:.0} times that on a surface (a box around one row loads a surface)",
            places.len()
        ));
    }
}
