//! Lines with round joins, cut to a rectangle: the mitres of plotters' own lines leave their panel.

use super::canvas::{Area, Drawn};
use super::stamp::Rect;
use plotters::style::RGBColor;

/// A point in pixels.
pub(crate) type Point = (f64, f64);

/// Which pixels of a rectangle are covered.
#[derive(Clone)]
pub(crate) struct Mask {
    width: i32,
    height: i32,
    covered: Vec<bool>,
}

impl Mask {
    pub(crate) fn new(width: i32, height: i32) -> Self {
        Self { width, height, covered: vec![false; (width.max(0) * height.max(0)) as usize] }
    }

    /// Covers a line through points; one point alone is a dot.
    pub(crate) fn line(&mut self, points: &[Point], radius: f64) {
        if let [point] = *points {
            self.segment(point, point, radius);
        }
        for pair in points.windows(2) {
            self.segment(pair[0], pair[1], radius);
        }
    }

    /// Covers the outline of a regular polygon around a point.
    pub(crate) fn mark(&mut self, (x, y): Point, size: f64, corners: u32, radius: f64) {
        let step = std::f64::consts::TAU / f64::from(corners);
        // Squares stand on a side, all others on their lower corners.
        let first = if corners == 4 { 0.5 * step } else { -std::f64::consts::FRAC_PI_2 };
        let corner = |k| first + step * f64::from(k);
        let outline: Vec<_> =
            (0..=corners).map(|k| (x + size * corner(k).cos(), y + size * corner(k).sin())).collect();
        self.line(&outline, radius);
    }

    /// Covers all pixels nearer to a segment than `radius`.
    fn segment(&mut self, a: Point, b: Point, radius: f64) {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let length = dx.hypot(dy);
        let (nx, ny) = if length > 0.0 { (-dy * radius / length, dx * radius / length) } else { (0.0, 0.0) };
        let sides = [(a.0 + nx, a.1 + ny), (b.0 + nx, b.1 + ny), (b.0 - nx, b.1 - ny), (a.0 - nx, a.1 - ny)];
        let top = (a.1.min(b.1) - radius).floor().max(0.0) as i32;
        let bottom = (a.1.max(b.1) + radius).ceil().min(f64::from(self.height)) as i32;
        for row in top..bottom {
            let y = f64::from(row) + 0.5;
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            let mut reach = |x: f64, half: f64| (left, right) = (left.min(x - half), right.max(x + half));
            for end in [a, b] {
                let half = radius * radius - (y - end.1).powi(2);
                if half > 0.0 {
                    reach(end.0, half.sqrt());
                }
            }
            for (k, p) in sides.iter().enumerate() {
                let q = sides[(k + 1) % 4];
                if (p.1 <= y) != (q.1 <= y) {
                    reach(p.0 + (y - p.1) / (q.1 - p.1) * (q.0 - p.0), 0.0);
                }
            }
            let from = (left - 0.5).ceil().clamp(0.0, f64::from(self.width)) as i32;
            let to = ((right - 0.5).floor() + 1.0).clamp(0.0, f64::from(self.width)) as i32;
            if from < to {
                let row = row * self.width;
                self.covered[(row + from) as usize..(row + to) as usize].fill(true);
            }
        }
    }

    /// Covers what another mask of the same size covers.
    pub(crate) fn add(&mut self, other: &Self) {
        self.covered.iter_mut().zip(&other.covered).for_each(|(own, other)| *own |= other);
    }

    /// Number of covered pixels in a rectangle.
    pub(crate) fn count(&self, rect: Rect) -> usize {
        let within = |from: i32, length: i32, all: i32| from.clamp(0, all)..(from + length).clamp(0, all);
        let columns = within(rect.x, rect.width, self.width);
        let rows = within(rect.y, rect.height, self.height);
        let pixel = |y: i32, x: i32| self.covered[(y * self.width + x) as usize];
        rows.map(|y| columns.clone().filter(|&x| pixel(y, x)).count()).sum()
    }

    /// Draws the covered pixels on an area of the mask's size.
    pub(crate) fn draw(&self, area: &Area<'_>, color: RGBColor) -> Drawn {
        let covered = (0_i32..).zip(&self.covered).filter(|(_, covered)| **covered);
        covered.map(|(k, _)| (k % self.width, k / self.width)).try_for_each(|at| {
            area.draw_pixel(at, &color)?;
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: Rect = Rect { x: 0, y: 0, width: 200, height: 100 };

    fn count(points: &[Point]) -> f64 {
        let mut mask = Mask::new(ALL.width, ALL.height);
        mask.line(points, 3.0);
        mask.count(ALL) as f64
    }

    #[test]
    fn a_segment_has_the_area_of_a_stadium() {
        let ends = std::f64::consts::PI * 9.0;
        for (a, b) in [
            ((20.0, 50.0), (120.0, 50.0)),
            ((60.0, 10.0), (60.0, 90.0)),
            ((20.0, 90.0), (150.5, 10.2)),
            ((150.5, 10.2), (20.0, 90.0)),
        ] {
            let area = 6.0 * f64::hypot(b.0 - a.0, b.1 - a.1) + ends;
            assert!((count(&[a, b]) / area - 1.0).abs() < 0.03, "{a:?} {b:?}");
        }
        assert!((count(&[(50.0, 50.0)]) / ends - 1.0).abs() < 0.2);
        assert_eq!(count(&[]), 0.0);
    }

    #[test]
    fn a_sharp_turn_reaches_no_farther_than_the_line_is_wide() {
        let mut mask = Mask::new(ALL.width, ALL.height);
        mask.line(&[(100.0, 90.0), (101.0, 40.0), (102.0, 90.0)], 3.0);
        assert!(mask.count(Rect { y: 0, height: 37, ..ALL }) == 0);
        assert!(mask.count(Rect { y: 37, height: 3, ..ALL }) > 0);
    }

    #[test]
    fn what_is_outside_is_cut() {
        assert_eq!(count(&[(-50.0, -50.0), (-20.0, 400.0), (1e6, 300.0)]), 0.0);
        assert!((count(&[(-1e6, 50.0), (1e6, 50.0)]) / (200.0 * 6.0) - 1.0).abs() < 1e-9);
        assert!((count(&[(0.0, 0.0), (0.0, 100.0)]) / (3.0 * 100.0) - 1.0).abs() < 0.01);
    }
}
