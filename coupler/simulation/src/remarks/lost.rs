//! Remarks on shapes whose places others have: other shapes, or copies of the same one.

use super::overlap;
use super::shapes::{Placed, around_copy, length};
use halfstep_scene::geometry::{self, Layout, Regions};
use halfstep_scene::{Geometry, Phase, Scene, Shape};

/// From which share of its particles on a loss to other shapes is remarked.
const LOST: f64 = 0.1;

/// Shapes that lose many of their particles to others.
pub(super) fn overlaps<const D: usize>(scene: &Scene, placed: &[Placed], all: &mut Vec<String>) {
    for (shape, of_scene) in placed.iter().zip(&scene.shapes) {
        if shape.particles == 0 && shape.lost == 0 {
            all.push(format!(
                "`{}` has no particle, and nothing is where it stands: it is nowhere as thick as its spacing, {} m, or \
                 a void has its place",
                shape.name,
                length(scene.spacing(of_scene))
            ));
        }
    }
    for (index, shape) in placed.iter().enumerate().filter(|(_, shape)| shape.phase != Phase::Wall) {
        let whole = shape.particles + shape.lost;
        let are_many = |lost: usize| lost as f64 > LOST * whole as f64;
        let meant = || match shape.phase {
            Phase::Fluid => !are_many(shape.lost.saturating_sub(laid_over::<D>(scene, index))),
            _ => within_its_body(scene, placed, index),
        };
        if shape.particles == 0 && shape.lost > 0 {
            all.push(format!(
                "`{}` has none of its {whole} particles, and what it says acts nowhere: shapes that it overlaps take \
                 their places (of two shapes of one phase the one that is listed first has them)",
                shape.name
            ));
        } else if are_many(shape.lost) && !meant() {
            all.push(format!(
                "`{}` has {} of its {whole} particles: the others' places are taken by shapes that it overlaps",
                shape.name, shape.particles
            ));
        }
    }
}

/// Whether a shape loses particles only to its own body, which is the union of its shapes: to what has the same
/// density, or to what is smaller than it, as ballast in a hull is.
fn within_its_body(scene: &Scene, placed: &[Placed], index: usize) -> bool {
    let shape = &scene.shapes[index];
    let around = geometry::bounding_box(shape, scene);
    let same = |other: &Shape| (other.solid, other.body()) == (shape.solid, shape.body());
    let whole = |k: usize| placed[k].particles + placed[k].lost;
    let takers = (0..index).filter(|&k| {
        let other = &scene.shapes[k];
        other.phase == Phase::Solid && overlap(&geometry::bounding_box(other, scene), &around, scene)
    });
    takers
        .map(|k| (k, &scene.shapes[k]))
        .all(|(k, other)| same(other) && (other.density == shape.density || whole(k) < whole(index)))
}

/// How many of the places of a shape of fluid solids and walls have, without those of tanks: water is laid over bodies
/// and beaches.
fn laid_over<const D: usize>(scene: &Scene, index: usize) -> usize {
    let matter = Regions::of(scene, |shape| match shape.phase {
        Phase::Solid => true,
        Phase::Wall => !matches!(shape.geometry.unmoved(), Geometry::Tank { .. }),
        Phase::Fluid => false,
    });
    // Places closer than half a spacing to their particles are theirs as well.
    let margin = 0.5 * scene.resolution;
    geometry::places_alone::<D>(scene, index).iter().filter(|place| matter.hold(place, margin)).count()
}

/// Copies of a solid that lie in earlier ones, which have their places.
pub(super) fn copies<const D: usize>(scene: &Scene, layout: &Layout<D>, all: &mut Vec<String>) {
    for (index, shape) in scene.shapes.iter().enumerate().filter(|(_, s)| s.phase == Phase::Solid) {
        // Those of a shape that names its body are one.
        let Geometry::Moved(moved) = &shape.geometry else { continue };
        if moved.count < 2 || !shape.body.is_empty() {
            continue;
        }
        let around = around_copy(scene, shape, moved, 0);
        let extent = |a: usize| around.max[a] - around.min[a];
        if (0..D).any(|a| moved.step[a].abs() > extent(a) - 0.5 * scene.spacing(shape)) {
            continue;
        }
        let mut counts = vec![0_usize; moved.count as usize];
        layout.solid.iter().filter(|p| p.body as usize == index).for_each(|p| counts[p.copy as usize] += 1);
        let least = (1.0 - LOST) * counts[0] as f64;
        let lacking = counts.iter().filter(|&&count| (count as f64) < least).count();
        if lacking > 0 {
            let way = moved.step.iter().map(|x| x * x).sum::<f64>().sqrt();
            all.push(format!(
                "{lacking} of the {} copies of `{}` lie in earlier ones, which have their places: each is {} m from \
                 the one before (`step` is from copy to copy), and they are {} m wide",
                moved.count,
                shape.name,
                length(way),
                length((0..D).map(extent).fold(f64::INFINITY, f64::min))
            ));
        }
    }
}
