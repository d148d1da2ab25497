//! Lines through the rows of a solid: how much of each its shape has, less the voids before it, and its particles do.

use super::points::{self, Spacing};
use super::polygon::Edges;
use super::region::{Region, voids_before};
use super::{Moved, Surface, moved};
use crate::{Geometry, Phase, Scene};

/// Parts of the outline of what is round, in a spacing.
const FINE: f64 = 8.0;
/// Lines in a spacing, beside those at the ends of sides, between which an area is found: sides may cross.
const LINES: f64 = 4.0;
/// Outlines lie in a plane.
const PLANE: usize = 2;
/// Relative tolerance of lengths, in spacings.
const ALIKE: f64 = 1e-6;

/// A part of a shape that is as thick on each of its lines, side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Its lines.
    pub lines: usize,
    /// Length of a line in the shape, m.
    pub asked: f64,
    /// Length of its particles' cells, the mean of all lines, m.
    pub computed: f64,
    /// The middle of its first line, m.
    pub at: [f64; 2],
    /// A void ends it.
    pub beside_void: bool,
    /// Extent of the shape along its lines, m.
    pub extent: f64,
}

/// What a line has of a shape between two places, m.
#[derive(Clone, Copy)]
struct Span {
    ends: [f64; 2],
    beside_void: bool,
}

/// Sides of an outline.
type Outline = Vec<[[f64; 2]; 2]>;

/// One copy of a shape in the frame of its lattice.
struct Frame<'s> {
    copy: Option<(&'s Moved, u32)>,
    /// Of the rows, before the copy is turned.
    direction: [f64; 2],
    shape: Outline,
    voids: Vec<Outline>,
    particles: Vec<[f64; 2]>,
    dx: f64,
}

/// Parts of the solid of an index along its rows and across them; none of walls and fluids, on the nodal lattice and
/// in space.
pub fn sections(scene: &Scene, index: usize) -> [Vec<Section>; 2] {
    let all = frames(scene, index);
    [0, 1].map(|along| all.iter().flat_map(|frame| frame.sections(along)).collect())
}

/// Area that voids leave of the solid of an index, and that of its particles, m²; `None` where no void meets it.
pub fn left_by_voids(scene: &Scene, index: usize) -> Option<[f64; 2]> {
    if voids_before(scene, index).is_empty() {
        return None;
    }
    let all = frames(scene, index);
    let meets = |frame: &Frame<'_>| frame.sections(0).iter().any(|section| section.beside_void);
    all.iter().any(meets).then(|| {
        all.iter().fold([0.0; 2], |[asked, computed], frame| {
            [asked + frame.area(), computed + frame.particles.len() as f64 * frame.dx.powi(2)]
        })
    })
}

/// Length of the parts of an outline, m: of what is straight its sides.
fn fine(geometry: &Geometry, dx: f64) -> f64 {
    match geometry.unmoved() {
        Geometry::Disc { .. } | Geometry::Ring { .. } => dx / FINE,
        _ => f64::INFINITY,
    }
}

fn frames<'s>(scene: &'s Scene, index: usize) -> Vec<Frame<'s>> {
    let shape = &scene.shapes[index];
    let spacing = Spacing::of(scene, shape);
    if shape.phase != Phase::Solid || scene.dimension != PLANE || spacing.nodal {
        return Vec::new();
    }
    let geometry = shape.geometry.unmoved();
    let along = match geometry {
        Geometry::Polygon(polygon) if spacing.aligned => Edges::new(polygon).longest().direction(),
        _ => [1.0, 0.0],
    };
    let [cos, sin] = moved::turn(spacing.turn);
    let direction = [cos * along[0] - sin * along[1], sin * along[0] + cos * along[1]];
    let voids = voids_before(scene, index);
    let region = Region::new(&shape.geometry, spacing, &voids);
    let points = points::of_shape::<PLANE>(geometry, spacing);
    let of_copy = |copy: Option<(&'s Moved, u32)>| {
        let mut frame = Frame {
            copy,
            direction,
            shape: Vec::new(),
            voids: Vec::new(),
            particles: Vec::new(),
            dx: spacing.dx,
        };
        let free = points.iter().map(|p| p.position).filter(|x| !region.is_void(&frame.placed(*x)));
        frame.particles = free.map(|x| frame.along_rows(x)).collect();
        Surface::new(geometry, None).outline(fine(geometry, spacing.dx), &mut |_, ends| {
            frame.shape.push(ends.map(|end| frame.along_rows(end)));
        });
        for void in &voids {
            let mut copies: Vec<Outline> = Vec::new();
            Surface::new(&void.geometry, None).outline(fine(&void.geometry, spacing.dx), &mut |k, ends| {
                copies.resize((k as usize + 1).max(copies.len()), Vec::new());
                copies[k as usize].push(ends.map(|end| frame.along_rows(frame.back(end))));
            });
            frame.voids.extend(copies);
        }
        frame
    };
    match &shape.geometry {
        Geometry::Moved(moved) => moved.copies().map(|copy| of_copy(Some((moved, copy)))).collect(),
        _ => vec![of_copy(None)],
    }
}

impl Frame<'_> {
    fn placed(&self, x: [f64; 2]) -> [f64; 2] {
        self.copy.map_or(x, |(moved, copy)| moved.place(copy, x))
    }

    fn back(&self, x: [f64; 2]) -> [f64; 2] {
        self.copy.map_or(x, |(moved, copy)| moved.back(copy, x))
    }

    fn along_rows(&self, x: [f64; 2]) -> [f64; 2] {
        let [cos, sin] = self.direction;
        [cos * x[0] + sin * x[1], cos * x[1] - sin * x[0]]
    }

    /// The place in the scene of a point of the frame.
    fn place(&self, x: [f64; 2]) -> [f64; 2] {
        let [cos, sin] = self.direction;
        self.placed([cos * x[0] - sin * x[1], sin * x[0] + cos * x[1]])
    }

    fn extent(&self, axis: usize) -> [f64; 2] {
        let all = self.shape.iter().map(|ends| ends[0][axis]);
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    }

    /// What the shape has of a line along an axis, less the voids.
    fn spans(&self, along: usize, at: f64) -> Vec<Span> {
        let pairs = |outline: &Outline| {
            let mut ends: Vec<f64> = outline.iter().filter_map(|side| crossing(side, along, at)).collect();
            ends.sort_by(f64::total_cmp);
            ends.chunks_exact(2).map(|ends| [ends[0], ends[1]]).collect::<Vec<_>>()
        };
        let mut holes: Vec<[f64; 2]> = self.voids.iter().flat_map(pairs).collect();
        holes.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut all = Vec::new();
        for [from, to] in pairs(&self.shape) {
            let mut rest = Span { ends: [from, to], beside_void: false };
            for hole in holes.iter().filter(|hole| hole[1] > from && hole[0] < to) {
                let before = Span { ends: [rest.ends[0], hole[0].min(to)], beside_void: true };
                all.push(before);
                rest = Span { ends: [rest.ends[0].max(hole[1]), to], beside_void: true };
            }
            all.push(rest);
        }
        all.retain(|span| span.ends[1] - span.ends[0] > ALIKE * self.dx);
        all
    }

    /// Parts whose lines go along an axis.
    fn sections(&self, along: usize) -> Vec<Section> {
        let (across, dx) = (1 - along, self.dx);
        let ([low, high], [first, last]) = (self.extent(across), self.extent(along));
        let Some(row) = self.particles.iter().map(|x| x[across]).reduce(f64::min) else { return Vec::new() };
        let row = row - ((row - low) / dx).floor() * dx;
        let rows = ((high - row) / dx + ALIKE).floor().max(0.0) as usize;
        let mut on_row: Vec<Vec<f64>> = vec![Vec::new(); rows + 1];
        for x in &self.particles {
            let k = ((x[across] - row) / dx).round() as usize;
            on_row[k.min(rows)].push(x[along]);
        }
        let (mut ended, mut open): (Vec<Section>, Vec<(Span, Section)>) = (Vec::new(), Vec::new());
        for (k, particles) in on_row.iter().enumerate() {
            let at = row + k as f64 * dx;
            let mut next = Vec::new();
            for span in self.spans(along, at) {
                let [from, to] = span.ends;
                let reach = ALIKE * dx;
                let own = particles.iter().filter(|x| from - reach <= **x && **x <= to + reach).count();
                let (asked, computed) = (to - from, own as f64 * dx);
                let same = |(other, section): &(Span, Section)| {
                    let overlap = other.ends[0] < to && from < other.ends[1];
                    overlap
                        && (section.asked - asked).abs() < reach
                        && section.beside_void == span.beside_void
                };
                let section = match open.iter().position(same) {
                    Some(before) => {
                        let (_, mut section) = open.swap_remove(before);
                        let lines = section.lines as f64;
                        section.computed = (section.computed * lines + computed) / (lines + 1.0);
                        section.lines += 1;
                        section
                    }
                    None => {
                        let mut middle = [at; 2];
                        middle[along] = 0.5 * (from + to);
                        let (at, extent) = (self.place(middle), last - first);
                        Section { lines: 1, asked, computed, at, beside_void: span.beside_void, extent }
                    }
                };
                next.push((span, section));
            }
            ended.extend(open.drain(..).map(|(_, section)| section));
            open = next;
        }
        ended.extend(open.into_iter().map(|(_, section)| section));
        ended
    }

    /// Area of the shape less the voids, m²: between two ends of sides a line's length is that in the middle.
    fn area(&self) -> f64 {
        let [low, high] = self.extent(1);
        let lines = ((high - low) / self.dx * LINES).ceil().max(1.0);
        let even = (0..=lines as usize).map(|k| low + (high - low) * k as f64 / lines);
        let ends = self.shape.iter().chain(self.voids.iter().flatten()).map(|side| side[0][1]);
        let mut levels: Vec<f64> = even.chain(ends).filter(|y| low <= *y && *y <= high).collect();
        levels.sort_by(f64::total_cmp);
        let between = levels.windows(2).map(|ends| {
            let spans = self.spans(0, 0.5 * (ends[0] + ends[1]));
            (ends[1] - ends[0]) * spans.iter().map(|span| span.ends[1] - span.ends[0]).sum::<f64>()
        });
        between.sum()
    }
}

/// Where a side crosses a line along an axis; its lower end belongs to it.
fn crossing([a, b]: &[[f64; 2]; 2], along: usize, at: f64) -> Option<f64> {
    let across = 1 - along;
    let crosses = (a[across] <= at) != (b[across] <= at);
    crosses.then(|| a[along] + (at - a[across]) / (b[across] - a[across]) * (b[along] - a[along]))
}

#[cfg(test)]
mod tests;
