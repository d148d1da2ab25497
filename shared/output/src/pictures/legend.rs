//! The legend of a panel of `plot.png`, and where it hides nothing.

use super::canvas::{Area, Drawn};
use super::plot::{Fallible, OVERSAMPLING, font};
use super::stamp::Rect;
use super::strokes::{Mask, Point};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Pixels of the oversampled picture: between a legend and what is around it, around its entries, between its columns.
const GAP: i32 = 5 * OVERSAMPLING as i32;
const EDGE: i32 = 8 * OVERSAMPLING as i32;
const BETWEEN: i32 = 14 * OVERSAMPLING as i32;
/// Length of a sample and of the space after it, height of an entry.
const SAMPLE: i32 = 30 * OVERSAMPLING as i32;
const TEXT: i32 = 34 * OVERSAMPLING as i32;
const ROW: i32 = 18 * OVERSAMPLING as i32;
/// Part of the panel's height that a strip for the legend takes at most.
const LARGEST_STRIP: f64 = 0.6;

/// How a curve is drawn.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    pub(crate) color: RGBColor,
    /// Half the width of its line; `None`: marks alone.
    pub(crate) line: Option<f64>,
    /// Corners of the outline of its marks; `None`: the line alone.
    pub(crate) mark: Option<u32>,
}

impl Look {
    /// Half the size of a mark, and of the width of its outline.
    const MARK: [f64; 2] = [4.0 * OVERSAMPLING as f64, 0.5 * OVERSAMPLING as f64];

    /// Covers the pixels of a curve.
    pub(crate) fn cover(self, mask: &mut Mask, points: &[Point]) {
        if let Some(radius) = self.line {
            mask.line(points, radius);
        }
        if let Some(corners) = self.mark {
            let [size, radius] = Self::MARK;
            points.iter().for_each(|&point| mask.mark(point, size, corners, radius));
        }
    }
}

/// Names beside samples, in columns.
pub(crate) struct Legend {
    entries: Vec<(String, Look)>,
    /// Width of a column, with the space after it.
    column: i32,
}

impl Legend {
    pub(crate) fn new(area: &Area<'_>, entries: Vec<(String, Look)>) -> Fallible<Self> {
        let style = font(14);
        let widths = entries.iter().map(|(name, _)| Ok(area.estimate_text_size(name, &style)?.0 as i32));
        let widths = widths.collect::<Fallible<Vec<_>>>()?;
        Ok(Self { entries, column: TEXT + widths.into_iter().max().unwrap_or(0) + BETWEEN })
    }

    fn size(&self, columns: i32) -> (i32, i32) {
        let rows = (self.entries.len() as i32 + columns - 1) / columns;
        (2 * EDGE + columns * self.column - BETWEEN, 2 * EDGE + rows * ROW)
    }

    /// The first corner of a panel where the legend hides nothing.
    pub(crate) fn corner(&self, (width, height): (i32, i32), drawn: &Mask) -> Option<Rect> {
        let (w, h) = self.size(1);
        let (right, bottom) = (width - w - GAP, height - h - GAP);
        let corners = [(GAP, GAP), (right, GAP), (GAP, bottom), (right, bottom)];
        let mut corners = corners.map(|(x, y)| Rect { x, y, width: w, height: h }).into_iter();
        let around = |r: &Rect| Rect { x: r.x - GAP, y: r.y - GAP, width: w + 2 * GAP, height: h + 2 * GAP };
        corners.find(|rect| rect.x >= 0 && rect.y >= 0 && drawn.count(around(rect)) == 0)
    }

    /// The legend in a strip along the upper edge of a panel, and the part of the panel's height below the strip.
    pub(crate) fn strip(&self, (width, height): (i32, i32)) -> (Rect, f64) {
        let fit = (width - 2 * GAP - 2 * EDGE + BETWEEN) / self.column;
        let count = self.entries.len().max(1) as i32;
        let rows = (count + fit.max(1) - 1) / fit.max(1);
        let (w, h) = self.size((count + rows - 1) / rows);
        let part = f64::from(h + 2 * GAP) / f64::from(height.max(1));
        (Rect { x: GAP, y: GAP, width: w, height: h }, 1.0 - part.min(LARGEST_STRIP))
    }

    /// Draws the legend in a rectangle that one of the above said.
    pub(crate) fn draw(&self, area: &Area<'_>, at: Rect) -> Drawn {
        let corners = [(at.x, at.y), (at.x + at.width, at.y + at.height)];
        area.draw(&Rectangle::new(corners, WHITE.filled()))?;
        area.draw(&Rectangle::new(corners, RGBColor(225, 225, 225).stroke_width(OVERSAMPLING)))?;
        let columns = (at.width - 2 * EDGE + BETWEEN) / self.column;
        let style = font(14).pos(Pos::new(HPos::Left, VPos::Center));
        for (k, (name, look)) in (0..).zip(&self.entries) {
            let (x, y) = (at.x + EDGE + k % columns * self.column, at.y + EDGE + k / columns * ROW);
            let mut sample = Mask::new(at.x + at.width, at.y + at.height);
            let [left, middle, right] = [0, SAMPLE / 2, SAMPLE].map(|dx| f64::from(x + dx));
            let height = f64::from(y + ROW / 2);
            Look { mark: None, ..*look }.cover(&mut sample, &[(left, height), (right, height)]);
            Look { line: None, ..*look }.cover(&mut sample, &[(middle, height)]);
            sample.draw(area, look.color)?;
            area.draw(&Text::new(name.clone(), (x + TEXT, y + ROW / 2), style.clone()))?;
        }
        Ok(())
    }
}
