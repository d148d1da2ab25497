//! What walls fill in the plane.

use crate::geometry::points::Spacing;
use crate::geometry::region::voids_before;
use crate::geometry::{Polygon, outline};
use crate::{Block, Geometry, Phase, Scene, Shape};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// How far the chords of a circle are from it at most, in spacings.
const SAGITTA: f64 = 1e-4;

/// Grid of corners, in spacings.
const GRID: f64 = 1e-9;

/// Regions of the plane: outlines counter-clockwise, each with its holes, clockwise.
pub(super) type Regions = Vec<Vec<Vec<[f64; 2]>>>;

/// Regions on a grid, on which walls that are flush but for rounding are joined.
pub(super) struct Places<'s> {
    scene: &'s Scene,
    /// In units of the grid: whole numbers.
    regions: Regions,
    /// The corners before they were put on the grid, m.
    exact: BTreeMap<[i64; 2], [f64; 2]>,
}

impl<'s> Places<'s> {
    /// Of the shapes of those indices, without voids before them.
    pub(super) fn union(scene: &'s Scene, members: &[usize]) -> Self {
        let mut all = Self { scene, regions: Regions::new(), exact: BTreeMap::new() };
        for &index in members {
            let own = all.of_shape(index);
            all.regions = combined(&all.regions, &own, OverlayRule::Union);
        }
        all
    }

    /// The same, joined by halves: for many copies.
    pub(super) fn union_of_many(scene: &'s Scene, members: &[usize]) -> Self {
        let mut all = Self { scene, regions: Regions::new(), exact: BTreeMap::new() };
        let mut parts = Vec::new();
        for &index in members {
            let shape: &Shape = &scene.shapes[index];
            let spacing = Spacing::of(scene, shape);
            let voids = voids_before(scene, index);
            let voids: Vec<Regions> =
                voids.iter().map(|void| all.on_grid(copies(&void.geometry, spacing))).collect();
            for one in copies(&shape.geometry, spacing) {
                let own = all.on_grid(vec![one]);
                let without = |own: Regions, void: &Regions| combined(&own, void, OverlayRule::Difference);
                parts.push(voids.iter().fold(own, without));
            }
        }
        while parts.len() > 1 {
            let join = |pair: &[Regions]| match pair {
                [one, other] => combined(one, other, OverlayRule::Union),
                _ => pair.concat(),
            };
            parts = parts.chunks(2).map(join).collect();
        }
        all.regions = parts.pop().unwrap_or_default();
        all
    }

    /// Without the solids that begin in them.
    pub(super) fn without_solids(mut self) -> Self {
        for (index, shape) in self.scene.shapes.iter().enumerate() {
            if shape.phase == Phase::Solid {
                let own = self.of_shape(index);
                self.regions = combined(&self.regions, &own, OverlayRule::Difference);
            }
        }
        self
    }

    /// What they are, m.
    pub(super) fn regions(self) -> Regions {
        let Self { scene, mut regions, exact } = self;
        for corner in regions.iter_mut().flatten().flatten() {
            let known = exact.get(&corner.map(|x| x.round() as i64));
            *corner = known.copied().unwrap_or_else(|| corner.map(|x| x * GRID * scene.resolution));
        }
        regions
    }

    /// The region of a shape less the voids before it.
    fn of_shape(&mut self, index: usize) -> Regions {
        let shape: &Shape = &self.scene.shapes[index];
        let spacing = Spacing::of(self.scene, shape);
        let mut own = self.on_grid(copies(&shape.geometry, spacing));
        for void in voids_before(self.scene, index) {
            let void = self.on_grid(copies(&void.geometry, spacing));
            own = combined(&own, &void, OverlayRule::Difference);
        }
        own
    }

    /// The union of regions.
    fn on_grid(&mut self, all: Vec<Regions>) -> Regions {
        let grid = GRID * self.scene.resolution;
        let mut union = Regions::new();
        for mut one in all {
            for corner in one.iter_mut().flatten().flatten() {
                let exact = *corner;
                *corner = exact.map(|x| (x / grid).round());
                self.exact.entry(corner.map(|x| x as i64)).or_insert(exact);
            }
            union = combined(&union, &one, OverlayRule::Union);
        }
        union
    }
}

fn combined(one: &Regions, other: &Regions, rule: OverlayRule) -> Regions {
    one.overlay_as::<i64>(other, rule, FillRule::EvenOdd)
}

/// What the copies of a geometry hold, m.
pub(super) fn copies(geometry: &Geometry, spacing: Spacing) -> Vec<Regions> {
    let Geometry::Moved(moved) = geometry else { return vec![unmoved(geometry, spacing)] };
    let one = unmoved(&moved.geometry, spacing);
    let place = |copy: u32| {
        let mut placed = one.clone();
        placed.iter_mut().flatten().flatten().for_each(|corner| *corner = moved.place(copy, *corner));
        placed
    };
    moved.copies().map(place).collect()
}

/// What a geometry holds, m.
fn unmoved(geometry: &Geometry, spacing: Spacing) -> Regions {
    match geometry {
        Geometry::Box(block) => vec![vec![around_block(block)]],
        Geometry::Disc { center, radius } => vec![vec![circle(center, *radius, spacing.dx)]],
        Geometry::Ring { center, inner, outer } => {
            let mut hole = circle(center, *inner, spacing.dx);
            hole.reverse();
            vec![vec![circle(center, *outer, spacing.dx), hole]]
        }
        Geometry::Tank { cavity, .. } => {
            let outer = outline::bounding_box(geometry, 2, spacing.thickness());
            let [outer, cavity] = [&outer, cavity].map(|block| vec![vec![around_block(block)]]);
            combined(&outer, &cavity, OverlayRule::Difference)
        }
        Geometry::Polygon(polygon) => {
            let Polygon { outline, holes } = polygon;
            vec![std::iter::once(outline).chain(holes).cloned().collect()]
        }
        // A geometry is moved once.
        Geometry::Moved(moved) => unmoved(&moved.geometry, spacing),
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
