//! A coordinate system of logarithms with grid, labels and legend.

use halfstep_output::pictures::canvas::{Area, Drawn, FONT};
use halfstep_output::pictures::plot;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// Pixels drawn for each pixel of the picture, in each direction.
const OVERSAMPLING: i32 = 2;
const GRID: RGBColor = RGBColor(228, 228, 228);
const FRAME: RGBColor = RGBColor(90, 90, 90);
/// Height of a legend entry, pixels.
const ENTRY: i32 = 17;

pub(super) fn px(n: i32) -> i32 {
    n * OVERSAMPLING
}

pub(super) fn font(size: i32) -> TextStyle<'static> {
    (FONT, px(size)).into_font().color(&RGBColor(40, 40, 40))
}

pub(super) fn stroke(color: RGBColor, width: i32) -> ShapeStyle {
    ShapeStyle { color: color.to_rgba(), filled: false, stroke_width: px(width) as u32 }
}

/// Colour of the k-th series: a palette, then its lighter shades.
pub(super) fn color(k: usize) -> RGBColor {
    let all = [&plot::CURVES[..], &plot::REFERENCES[..]].concat();
    let RGBColor(r, g, b) = all[k % all.len()];
    let lighter = |c: u8| if k < all.len() { c } else { c / 2 + 127 };
    RGBColor(lighter(r), lighter(g), lighter(b))
}

pub(super) fn write(area: &Area<'_>, text: &str, at: (i32, i32), size: i32, place: (HPos, VPos)) -> Drawn {
    let style = font(size).pos(Pos::new(place.0, place.1));
    Ok(area.draw(&Text::new(text.to_owned(), at, style)).map_err(|e| e.to_string())?)
}

/// Limits of an axis of logarithms around these values, at round numbers.
pub(super) fn axis(values: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    let (low, high) = values
        .filter(|v| *v > 0.0 && v.is_finite())
        .fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    (high > 0.0).then(|| round(low / 1.1, false).log10()..round(high * 1.1, true).log10())
}

/// Round numbers over their power of ten.
const ROUND: [f64; 8] = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0];

fn round(value: f64, up: bool) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    let steps = ROUND.map(|s| s * power);
    let found = if up { steps.iter().find(|s| **s >= value) } else { steps.iter().rfind(|s| **s <= value) };
    found.copied().unwrap_or(value)
}

/// Ticks between the limits as logarithms: the more decades, the fewer in each.
fn ticks(range: &Range<f64>) -> Vec<f64> {
    let factors: &[f64] = match range.end - range.start {
        width if width > 3.0 => &[1.0],
        width if width > 1.2 => &[1.0, 2.0, 5.0],
        _ => &ROUND[..7],
    };
    let decades = range.start.floor() as i32..=range.end.ceil() as i32;
    let all = decades.flat_map(|d| factors.iter().map(move |f| f64::from(d) + f.log10()));
    all.filter(|t| (range.start - 1e-9..=range.end + 1e-9).contains(t)).collect()
}

/// How an axis is titled and its ticks are written.
pub(super) struct Axis<'f> {
    pub(super) range: Range<f64>,
    pub(super) title: String,
    pub(super) label: &'f dyn Fn(f64) -> String,
}

/// A name with the mark it explains.
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) color: RGBColor,
    pub(super) filled: bool,
}

/// Where points go.
pub(super) struct Chart<'a, 'b> {
    area: &'a Area<'b>,
    ranges: [Range<f64>; 2],
    inside: [i32; 4],
}

impl<'a, 'b> Chart<'a, 'b> {
    /// Draws grid, frame, labels, and the legend below.
    pub(super) fn new(
        area: &'a Area<'b>,
        title: &str,
        [x, y]: [Axis<'_>; 2],
        legend: &[Entry],
    ) -> Result<Self, Box<dyn std::error::Error>> {
        let (width, height) = area.dim_in_pixel();
        let below = px(54 + ENTRY * legend.len() as i32);
        let inside = [px(84), px(34), width as i32 - px(24), height as i32 - below];
        let [left, top, right, bottom] = inside;
        let chart = Self { area, ranges: [x.range, y.range], inside };
        for t in ticks(&chart.ranges[0]) {
            let at = chart.at(t, chart.ranges[1].start).0;
            chart.path(&[(at, top), (at, bottom)], stroke(GRID, 1))?;
            write(area, &(x.label)(10_f64.powf(t)), (at, bottom + px(5)), 13, (HPos::Center, VPos::Top))?;
        }
        for t in ticks(&chart.ranges[1]) {
            let at = chart.at(chart.ranges[0].start, t).1;
            chart.path(&[(left, at), (right, at)], stroke(GRID, 1))?;
            write(area, &(y.label)(10_f64.powf(t)), (left - px(6), at), 13, (HPos::Right, VPos::Center))?;
        }
        let frame = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        chart.path(&frame, stroke(FRAME, 1))?;
        write(area, title, (left, px(10)), 13, (HPos::Left, VPos::Top))?;
        let middle = ((left + right) / 2, (top + bottom) / 2);
        write(area, &x.title, (middle.0, bottom + px(26)), 13, (HPos::Center, VPos::Top))?;
        let side = font(13).pos(Pos::new(HPos::Center, VPos::Top)).transform(FontTransform::Rotate270);
        area.draw(&Text::new(y.title, (px(6), middle.1), side)).map_err(|e| e.to_string())?;
        for (k, entry) in legend.iter().enumerate() {
            let y = bottom + px(54 + ENTRY * k as i32);
            chart.circle((left + px(12), y), 4, entry.color, entry.filled)?;
            write(area, &entry.name, (left + px(24), y), 12, (HPos::Left, VPos::Center))?;
        }
        Ok(chart)
    }

    /// Pixels of a point of logarithms.
    fn at(&self, x: f64, y: f64) -> (i32, i32) {
        let [left, top, right, bottom] = self.inside.map(f64::from);
        let place = |v: f64, r: &Range<f64>, a: f64, b: f64| a + (v - r.start) / (r.end - r.start) * (b - a);
        let [along, up] = &self.ranges;
        (place(x, along, left, right) as i32, place(y, up, bottom, top) as i32)
    }

    /// Pixels of a point.
    fn pixel(&self, (x, y): (f64, f64)) -> (i32, i32) {
        self.at(x.log10(), y.log10())
    }

    fn path(&self, points: &[(i32, i32)], style: ShapeStyle) -> Drawn {
        Ok(self.area.draw(&PathElement::new(points.to_vec(), style)).map_err(|e| e.to_string())?)
    }

    fn circle(&self, at: (i32, i32), radius: i32, color: RGBColor, filled: bool) -> Drawn {
        let style = ShapeStyle { color: color.to_rgba(), filled, stroke_width: px(2) as u32 };
        Ok(self.area.draw(&Circle::new(at, px(radius), style)).map_err(|e| e.to_string())?)
    }

    pub(super) fn mark(&self, point: (f64, f64), color: RGBColor, filled: bool) -> Drawn {
        self.circle(self.pixel(point), 5, color, filled)
    }

    pub(super) fn line(&self, points: &[(f64, f64)], style: ShapeStyle) -> Drawn {
        let points: Vec<_> = points.iter().map(|p| self.pixel(*p)).collect();
        self.path(&points, style)
    }

    /// A word above a point.
    pub(super) fn note(&self, point: (f64, f64), text: &str) -> Drawn {
        let (x, y) = self.pixel(point);
        write(self.area, text, (x, y - px(8)), 11, (HPos::Center, VPos::Bottom))
    }
}

/// Height that a legend takes, pixels.
pub(super) fn legend_height(entries: usize) -> i32 {
    ENTRY * entries as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_end_at_round_numbers_and_have_ticks() {
        let range = axis([0.03, 0.43, f64::NAN, 0.0].into_iter()).unwrap();
        assert!(
            (range.start - 0.02_f64.log10()).abs() < 1e-12 && (range.end - 0.5_f64.log10()).abs() < 1e-12
        );
        let shown = |range: &Range<f64>| -> Vec<f64> {
            ticks(range).iter().map(|t| (10_f64.powf(*t) * 1e6).round() / 1e6).collect()
        };
        assert_eq!(shown(&range), [0.02, 0.05, 0.1, 0.2, 0.5]);
        assert_eq!(shown(&(3_f64.log10()..7_f64.log10())), [3.0, 4.0, 5.0, 7.0]);
        assert_eq!(shown(&(0.0..4.0)), [1.0, 10.0, 100.0, 1000.0, 10000.0]);
        assert_eq!(axis([0.0].into_iter()), None);
    }
}
