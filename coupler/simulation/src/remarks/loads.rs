//! Remarks on tractions, and every one as it acts.

use super::near;
use super::shapes::{length, place};
use halfstep_scene::geometry::{Cells, Layout, SolidPoint};
use halfstep_scene::{Block, Geometry, Scene, Shape, Traction};
use serde::Serialize;
use std::collections::BTreeSet;
use std::fmt;

/// A traction with what it acts on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Loaded {
    /// Name of the shape.
    pub(crate) shape: String,
    /// Pa.
    traction: Vec<f64>,
    /// How long it takes to grow, s.
    ramp: f64,
    within: Block,
    particles: usize,
}

/// The tractions of a scene, in the order of its shapes.
pub(crate) fn listed<const D: usize>(scene: &Scene, layout: &Layout<D>) -> Vec<Loaded> {
    let of = |(index, name, Traction { within, traction, ramp }): (usize, &str, Traction)| Loaded {
        shape: name.to_owned(),
        traction: traction[..D].to_vec(),
        ramp,
        within,
        particles: taken(scene, layout, index).count(),
    };
    tractions_of(scene).map(of).collect()
}

impl fmt::Display for Loaded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Block { min, max } = &self.within;
        let axes = self.traction.len();
        let [traction, min, max] = [&self.traction[..], &min[..axes], &max[..axes]].map(place);
        write!(f, "traction {traction} Pa on {} particles in {min} to {max}", self.particles)?;
        if self.ramp > 0.0 {
            write!(f, ", grows for {} s", self.ramp)?;
        }
        Ok(())
    }
}

/// Shapes with a traction: index and name.
fn tractions_of(scene: &Scene) -> impl Iterator<Item = (usize, &str, Traction)> {
    scene
        .shapes
        .iter()
        .enumerate()
        .filter_map(|(index, shape)| Some((index, shape.name.as_str(), shape.load?)))
}

/// Particles that a shape's traction acts on.
fn taken<'l, const D: usize>(
    scene: &'l Scene,
    layout: &'l Layout<D>,
    shape: usize,
) -> impl Iterator<Item = &'l SolidPoint<D>> {
    layout.solid.iter().filter(move |p| p.body as usize == shape && !p.clamped && p.is_in_load(scene))
}

/// Rows, one behind the other, from which on a traction loads no surface.
const SEVERAL: f64 = 1.5;

/// A traction acts on one face of each particle: in a box of several rows its force is that many times a surface's, and
/// grows as the spacing falls.
pub(super) fn tractions<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (index, name, Traction { traction, .. }) in tractions_of(scene) {
        let dx = scene.spacing(&scene.shapes[index]);
        let places: Vec<[f64; D]> = taken(scene, layout, index).map(|p| p.position).collect();
        let columns = |axis: usize| {
            let cells: BTreeSet<i64> = places.iter().map(|x| (x[axis] / dx).floor() as i64).collect();
            cells.len()
        };
        let most = (0..D).map(columns).max().unwrap_or(0).max(1);
        let rows = places.len() as f64 / most as f64;
        if rows < SEVERAL {
            inside(scene, layout, &scene.shapes[index], &places, all);
            continue;
        }
        let size = traction.iter().map(|t| t * t).sum::<f64>().sqrt();
        let force = size * dx.powi(D as i32 - 1) * places.len() as f64;
        let unit = if D == 2 { "N/m" } else { "N" };
        all.push(format!(
            "the traction on `{name}` acts on one face of each of {} particles in {rows:.0} rows: {force:.3e} {unit} \
             in all, {rows:.0} times that on a surface (a box around one row loads a surface)",
            places.len()
        ));
    }
}

/// Boxes of tractions that a shape leaves behind as it is turned or shifted: they are places of the scene.
pub(super) fn left_behind<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (index, name, _) in tractions_of(scene) {
        let Geometry::Moved(moved) = &scene.shapes[index].geometry else { continue };
        if moved.angle == 0.0 && moved.translate == [0.0; 3] {
            continue;
        }
        let (mut taken, mut missed) = (0, 0);
        for point in layout.solid.iter().filter(|p| p.body as usize == index && !p.clamped) {
            let own = point.would_be_in_load(scene, &moved.back(0, point.position));
            let here = point.is_in_load(scene);
            taken += usize::from(here);
            missed += usize::from(own && !here && point.copy == 0);
        }
        if missed > taken {
            all.push(format!(
                "the `load` of `{name}` is where it would be without `rotate` and `translate`, which do not take its \
                 `within` along: it acts on {taken} particles, and not on {missed} that it would hold if it went with \
                 the shape; nor is the traction turned"
            ));
        }
    }
}

/// Part of the loaded particles from which on they are no surface: the ends of a row inside a body lie on it.
const INSIDE: f64 = 0.9;

/// Loads on a row inside of a body. A crack has faces there.
fn inside<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    shape: &Shape,
    places: &[[f64; D]],
    all: &mut Vec<String>,
) {
    let reach = 1.2 * scene.spacing(shape);
    let cracked = scene.shapes.iter().any(|other| other.solid == shape.solid && other.crack.is_some());
    if cracked || places.is_empty() {
        return;
    }
    let mut cells = Cells::new(reach);
    let own = layout.solid.iter().filter(|p| scene.shapes[p.body as usize].solid == shape.solid);
    own.for_each(|p| cells.add(&p.position, p.position));
    // Itself and one on each side, whichever way the lattice is turned.
    let enclosed = |at: &&[f64; D]| cells.around(at).filter(|x| near(x, at, reach)).count() > 2 * D;
    let count = places.iter().filter(enclosed).count();
    if count as f64 > INSIDE * places.len() as f64 {
        all.push(format!(
            "the traction on `{}` acts inside of it: of {} particles {count} have others on all sides (a box around \
             the outermost row loads a surface)",
            shape.name,
            places.len()
        ));
    }
}

/// Part of its traction that a load comes to at least where its ramp is meant.
const REACHED: f64 = 0.9;

/// Loads that the run's end cuts off as they grow.
pub(super) fn ramps(scene: &Scene, all: &mut Vec<String>) {
    for (shape, load) in scene.shapes.iter().filter_map(|shape| Some((shape, shape.load?))) {
        let share = load.share(scene.end_time);
        if share < REACHED {
            all.push(format!(
                "the load of `{}` comes to {} % of its traction: its `ramp` takes {} s, and the run ends at {} s",
                shape.name,
                length(100.0 * share),
                load.ramp,
                scene.end_time
            ));
        }
    }
}
