//! What walls fill in the plane.

use crate::geometry::Polygon;
use crate::geometry::points::{Spacing, sides};
use crate::geometry::region::voids_before;
use crate::{Block, Geometry, Phase, Scene, Shape};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use std::f64::consts::TAU;

/// How far the chords of a circle are from it at most, in spacings.
const SAGITTA: f64 = 1e-4;

/// Regions of the plane: outlines counter-clockwise, each with its holes, clockwise.
pub(super) type Regions = Vec<Vec<Vec<[f64; 2]>>>;

/// The shapes of those indices without voids before them.
pub(super) fn union(scene: &Scene, members: &[usize]) -> Regions {
    members.iter().fold(Regions::new(), |all, &index| {
        all.overlay_as::<i64>(&own_places(scene, index), OverlayRule::Union, FillRule::EvenOdd)
    })
}

/// Regions without the solids that begin in them.
pub(super) fn without_solids(scene: &Scene, regions: Regions) -> Regions {
    let solids = scene.shapes.iter().enumerate().filter(|(_, shape)| shape.phase == Phase::Solid);
    solids.fold(regions, |all, (index, _)| {
        all.overlay_as::<i64>(&own_places(scene, index), OverlayRule::Difference, FillRule::EvenOdd)
    })
}

/// The region of a shape less the voids before it.
fn own_places(scene: &Scene, index: usize) -> Regions {
    let shape: &Shape = &scene.shapes[index];
    let spacing = Spacing::of(scene, shape);
    let mut own = regions(&shape.geometry, spacing);
    for void in voids_before(scene, index) {
        own = own.overlay_as::<i64>(
            &regions(&void.geometry, spacing),
            OverlayRule::Difference,
            FillRule::EvenOdd,
        );
    }
    own
}

/// What a geometry holds.
pub(super) fn regions(geometry: &Geometry, spacing: Spacing) -> Regions {
    match geometry {
        Geometry::Box(block) => vec![vec![around_block(block)]],
        Geometry::Disc { center, radius } => vec![vec![circle(center, *radius, spacing.dx)]],
        Geometry::Ring { center, inner, outer } => {
            let mut hole = circle(center, *inner, spacing.dx);
            hole.reverse();
            vec![vec![circle(center, *outer, spacing.dx), hole]]
        }
        Geometry::Tank { cavity, open } => {
            let mut outer = *cavity;
            for axis in 0..2 {
                let [low, high] =
                    sides(axis).map(|side| if open.contains(&side) { 0.0 } else { spacing.thickness() });
                (outer.min[axis], outer.max[axis]) = (cavity.min[axis] - low, cavity.max[axis] + high);
            }
            let (outer, cavity) = (vec![vec![around_block(&outer)]], vec![vec![around_block(cavity)]]);
            outer.overlay_as::<i64>(&cavity, OverlayRule::Difference, FillRule::EvenOdd)
        }
        Geometry::Polygon(polygon) => {
            let Polygon { outline, holes } = polygon;
            vec![std::iter::once(outline).chain(holes).cloned().collect()]
        }
        Geometry::Moved(moved) => {
            let one = regions(&moved.geometry, spacing);
            let mut all = Regions::new();
            for copy in moved.copies() {
                let mut placed = one.clone();
                placed.iter_mut().flatten().flatten().for_each(|corner| *corner = moved.place(copy, *corner));
                all = all.overlay_as::<i64>(&placed, OverlayRule::Union, FillRule::EvenOdd);
            }
            all
        }
    }
}

fn around_block(Block { min, max }: &Block) -> Vec<[f64; 2]> {
    vec![[min[0], min[1]], [max[0], min[1]], [max[0], max[1]], [min[0], max[1]]]
}

/// Corners on a circle, counter-clockwise.
fn circle(center: &[f64; 3], radius: f64, dx: f64) -> Vec<[f64; 2]> {
    let count = (0.5 * TAU * (radius / (2.0 * SAGITTA * dx)).sqrt()).ceil().max(12.0) as usize;
    let place = |k: usize| {
        let angle = TAU * k as f64 / count as f64;
        [center[0] + radius * libm::cos(angle), center[1] + radius * libm::sin(angle)]
    };
    (0..count).map(place).collect()
}
