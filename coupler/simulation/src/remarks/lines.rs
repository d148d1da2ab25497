//! Remarks on single rows, whose particles have their neighbours on one line.

use super::shapes::place;
use halfstep_scene::geometry::{self, Cells, Cracks, Layout, SolidPoint};
use halfstep_scene::{Scene, SolidModelName};
use halfstep_sph::kernel::Kernel;
use halfstep_sph::{tensor, with_kernel};
use nalgebra::{SMatrix, SVector};
use std::collections::BTreeMap;

/// Particles of total-Lagrangian solids whose moment matrix M is singular or nearly so: a single row between voids or
/// cracks, or a particle alone. They have no deformation gradient, and carry nothing.
pub(super) fn lines<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    let solid = |p: &SolidPoint<D>| scene.shapes[p.body as usize].solid;
    let model = |p: &SolidPoint<D>| solid(p).map(|k| scene.solids[k].model.name());
    let spacing = |p: &SolidPoint<D>| scene.spacing(&scene.shapes[p.body as usize]);
    let length = |p: &SolidPoint<D>| solid(p).map_or(0.0, |k| scene.solids[k].smoothing_ratio) * spacing(p);
    let own: Vec<_> = layout.solid.iter().zip(geometry::pieces(scene, layout)).collect();
    let mut cells = Cells::new(layout.solid.iter().map(|p| 2.0 * length(p)).fold(0.0, f64::max));
    own.iter().for_each(|entry| cells.add(&entry.0.position, entry));
    let cracks = Cracks::of(scene);
    let mut found: BTreeMap<u32, (usize, [f64; D])> = BTreeMap::new();
    for (p, piece) in
        own.iter().filter(|(p, _)| model(p) == Some(SolidModelName::TotalLagrangian) && !p.clamped)
    {
        let (h, volume) = (length(p), spacing(p).powi(D as i32));
        let mut moment = SMatrix::<f64, D, D>::zeros();
        for (q, other) in cells.around(&p.position) {
            let x = SVector::<f64, D>::from_fn(|d, _| p.position[d] - q.position[d]);
            if piece == other && x.norm() > 0.0 && !cracks.part(p, q) {
                let slope = with_kernel!(scene.numerics.kernel, h, D, |k| k.slope_at(x.norm()));
                moment -= x * x.transpose() * (volume * slope);
            }
        }
        if tensor::moment_inverse(&moment).is_none() {
            found.entry(p.body).or_insert((0, p.position)).0 += 1;
        }
    }
    for (shape, (count, at)) in found {
        let (are, their) = if count == 1 { ("particle", "has its") } else { ("particles", "have their") };
        let flat = if D == 2 { "on one line" } else { "in one plane" };
        all.push(format!(
            "{count} {are} of `{}`, at {} first, {their} neighbours {flat} or nearly so, and the strain across is not \
             known: no stress, no strength, and nothing holds what hangs there (two rows carry)",
            scene.shapes[shape as usize].name,
            place(&at)
        ));
    }
}
