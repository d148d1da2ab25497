//! Remarks on cracks that part nothing.

use halfstep_scene::geometry::{self, Cells, Layout};
use halfstep_scene::{Geometry, Scene, Shape};

/// Cracks beside their shape, between its particles, or in what its clamps hold.
pub(super) fn cracks<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for shape in &scene.shapes {
        let Some([from, to]) = shape.crack else { continue };
        let around = geometry::bounding_box(shape, scene);
        let apart = |d: usize| from[d].max(to[d]) < around.min[d] || from[d].min(to[d]) > around.max[d];
        let name = &shape.name;
        if (0..2).any(apart) {
            all.push(format!("the crack of `{name}` lies beside it, and parts nothing"));
            continue;
        }
        if let Geometry::Moved(moved) = &shape.geometry {
            let beside = |geometry: &Geometry, end: &[f64; 3]| {
                geometry::distance(geometry, end) > scene.spacing(shape)
            };
            let ends = [&from, &to];
            let was_there = ends.iter().all(|end| !beside(&moved.geometry, end));
            if moved.angle != 0.0 && was_there && ends.iter().any(|end| beside(&shape.geometry, end)) {
                all.push(format!(
                    "the crack of `{name}` is where it would be without `rotate`, which does not turn it: its ends are \
                     places of the scene"
                ));
            }
        }
        match parted(scene, layout, shape, [[from[0], from[1]], [to[0], to[1]]]) {
            [0, _] => all.push(format!(
                "the crack of `{name}` lies between its particles, and parts nothing: it crosses no line from one to a \
                 neighbour"
            )),
            [pairs, 0] => all.push(format!(
                "the crack of `{name}` parts {pairs} pairs of particles, all of them clamped: it opens nowhere"
            )),
            _ => {}
        }
    }
}

/// Pairs of neighbours whose line a crack crosses, and those of them that no clamp holds altogether.
fn parted<const D: usize>(
    scene: &Scene,
    layout: &Layout<D>,
    shape: &Shape,
    crack: [[f64; 2]; 2],
) -> [usize; 2] {
    let Some(solid) = shape.solid else { return [0; 2] };
    let reach = 2.0 * scene.solids[solid].smoothing_ratio * scene.spacing(shape);
    let beside = |x: f64, d: usize| {
        crack[0][d].min(crack[1][d]) - reach <= x && x <= crack[0][d].max(crack[1][d]) + reach
    };
    let mut cells = Cells::new(reach);
    let mut counts = [0; 2];
    let own = layout.solid.iter().filter(|p| scene.shapes[p.body as usize].solid == Some(solid));
    for p in own.filter(|p| (0..2).all(|d| beside(p.position[d], d))) {
        for (place, clamped) in cells.around(&p.position) {
            let flat = |x: &[f64; D]| [x[0], x[1]];
            let line = [flat(place), flat(&p.position)];
            if super::near(place, &p.position, reach) && geometry::crosses(line, crack) {
                counts[0] += 1;
                counts[1] += usize::from(!(p.clamped && *clamped));
            }
        }
        cells.add(&p.position, (p.position, p.clamped));
    }
    counts
}
