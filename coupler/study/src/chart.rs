//! A coordinate system, of logarithms or linear, with grid and labels, and the legend of several of them.

use halfstep_output::pictures::canvas::{Area, Drawn, FONT};
use halfstep_output::pictures::plot;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::cell::RefCell;
use std::ops::Range;

/// Pixels drawn for each pixel of the picture, in each direction.
const OVERSAMPLING: i32 = 2;
const GRID: RGBColor = RGBColor(228, 228, 228);
const FRAME: RGBColor = RGBColor(90, 90, 90);
/// Height of a legend entry, pixels.
const ENTRY: i32 = 17;
/// Radius of a mark, pixels.
const MARK: i32 = 5;
/// Size of a note beside a mark, pixels.
const NOTE: i32 = 11;

pub(super) fn px(n: i32) -> i32 {
    n * OVERSAMPLING
}

pub(super) fn font(size: i32) -> TextStyle<'static> {
    (FONT, px(size)).into_font().color(&RGBColor(40, 40, 40))
}

pub(super) fn stroke(color: RGBColor, width: i32) -> ShapeStyle {
    ShapeStyle { color: color.to_rgba(), filled: false, stroke_width: px(width) as u32 }
}

/// Colours of a palette.
const COLORS: usize = plot::CURVES.len() + plot::REFERENCES.len();

/// Colour of the k-th series: a palette, then its lighter shades, then its darker ones.
pub(super) fn color(k: usize) -> RGBColor {
    let all = [&plot::CURVES[..], &plot::REFERENCES[..]].concat();
    let RGBColor(r, g, b) = all[k % COLORS];
    let shade = |c: u8| match k / COLORS % 3 {
        0 => c,
        1 => c / 2 + 110,
        _ => c / 2,
    };
    RGBColor(shade(r), shade(g), shade(b))
}

/// Shape of a series' marks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    Circle,
    Square,
    Triangle,
    Diamond,
}

/// How the points of a series are marked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    pub(super) color: RGBColor,
    pub(super) shape: Shape,
}

impl Mark {
    /// Mark of the k-th series: another shape for each turn of the palette.
    pub(super) fn of(k: usize) -> Self {
        let shapes = [Shape::Circle, Shape::Square, Shape::Triangle, Shape::Diamond];
        Self { color: color(k), shape: shapes[k / COLORS % shapes.len()] }
    }

    fn draw(self, area: &Area<'_>, (x, y): (i32, i32), radius: i32, filled: bool) -> Drawn {
        let style = ShapeStyle { color: self.color.to_rgba(), filled, stroke_width: px(2) as u32 };
        let r = px(radius);
        let corners: &[(i32, i32)] = match self.shape {
            Shape::Circle => {
                return Ok(area.draw(&Circle::new((x, y), r, style)).map_err(|e| e.to_string())?);
            }
            Shape::Square => &[(-r, -r), (r, -r), (r, r), (-r, r)],
            Shape::Triangle => &[(0, -r), (r, r), (-r, r)],
            Shape::Diamond => &[(0, -r - r / 4), (r + r / 4, 0), (0, r + r / 4), (-r - r / 4, 0)],
        };
        let polygon = |parts: i32, color: RGBColor| -> Drawn {
            let outline: Vec<_> =
                corners.iter().map(|(dx, dy)| (x + dx * parts / r, y + dy * parts / r)).collect();
            Ok(area.draw(&Polygon::new(outline, color.filled())).map_err(|e| e.to_string())?)
        };
        polygon(r, self.color)?;
        if filled { Ok(()) } else { polygon(r - px(2), WHITE) }
    }
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

/// What the places along an axis go with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scale {
    Logarithm,
    Linear,
}

impl Scale {
    fn of(self, value: f64) -> f64 {
        match self {
            Self::Logarithm => value.log10(),
            Self::Linear => value,
        }
    }

    /// Places of ticks with the values there.
    fn ticks(self, range: &Range<f64>) -> Vec<(f64, f64)> {
        match self {
            Self::Logarithm => ticks(range).into_iter().map(|t| (t, 10_f64.powf(t))).collect(),
            Self::Linear => linear_ticks(range).into_iter().map(|t| (t, t)).collect(),
        }
    }
}

/// Limits of a linear axis around these values.
pub(super) fn linear_axis(values: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let size = low.abs().max(high.abs());
    let margin = if high - low > 1e-9 * size { 0.06 * (high - low) } else { 0.1 * size.max(1e-30) };
    (low <= high).then_some(low - margin..high + margin)
}

/// Multiples of a round number between the limits, some five of them.
fn linear_ticks(range: &Range<f64>) -> Vec<f64> {
    let rough = (range.end - range.start) / 6.0;
    let power = 10_f64.powf(rough.log10().floor());
    let step =
        [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().map(|s| s * power).find(|s| *s >= rough).unwrap_or(rough);
    let (first, last) = ((range.start / step).ceil(), (range.end / step).floor());
    (0..=(last - first).max(0.0) as usize).map(|k| (first + k as f64) * step).collect()
}

/// How an axis is titled and its ticks are written.
pub(super) struct Axis<'f> {
    pub(super) range: Range<f64>,
    pub(super) title: String,
    pub(super) label: &'f dyn Fn(f64) -> String,
    pub(super) scale: Scale,
}

/// A name with the mark it explains.
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) mark: Mark,
    pub(super) filled: bool,
}

/// Columns in which entries fit into a width, pixels.
fn columns(entries: &[Entry], width: i32) -> usize {
    // A letter of the legend is at most 8 pixels wide on average.
    let widest = entries.iter().map(|e| e.name.chars().count()).max().unwrap_or(0) as i32 * 8 + 40;
    (width / widest).max(1) as usize
}

/// Height of the legend of entries in a picture of that width, pixels.
pub(super) fn legend_height(entries: &[Entry], width: i32) -> i32 {
    ENTRY * (entries.len().div_ceil(columns(entries, width)) as i32 + 1)
}

/// Draws the legend: columns of equal length.
pub(super) fn legend(area: &Area<'_>, entries: &[Entry]) -> Drawn {
    let width = area.dim_in_pixel().0 as i32;
    let columns = columns(entries, width / OVERSAMPLING);
    let rows = entries.len().div_ceil(columns);
    for (k, entry) in entries.iter().enumerate() {
        let at = (px(30) + (k / rows) as i32 * (width / columns as i32), px(ENTRY * (k % rows) as i32 + 8));
        entry.mark.draw(area, at, MARK - 1, entry.filled)?;
        write(area, &entry.name, (at.0 + px(12), at.1), 12, (HPos::Left, VPos::Center))?;
    }
    Ok(())
}

/// Where points go.
pub(super) struct Chart<'a, 'b> {
    area: &'a Area<'b>,
    ranges: [Range<f64>; 2],
    scales: [Scale; 2],
    inside: [i32; 4],
    /// Rectangles that marks and notes take, pixels: left, top, right, bottom.
    taken: RefCell<Vec<[i32; 4]>>,
}

impl<'a, 'b> Chart<'a, 'b> {
    /// Draws grid, frame and labels.
    pub(super) fn new(
        area: &'a Area<'b>,
        title: &str,
        [x, y]: [Axis<'_>; 2],
    ) -> Result<Self, Box<dyn std::error::Error>> {
        let (width, height) = area.dim_in_pixel();
        let inside = [px(84), px(34), width as i32 - px(24), height as i32 - px(54)];
        let [left, top, right, bottom] = inside;
        let (ranges, scales) = ([x.range, y.range], [x.scale, y.scale]);
        let chart = Self { area, ranges, scales, inside, taken: RefCell::default() };
        for (t, value) in x.scale.ticks(&chart.ranges[0]) {
            let at = chart.at(t, chart.ranges[1].start).0;
            chart.path(&[(at, top), (at, bottom)], stroke(GRID, 1))?;
            write(area, &(x.label)(value), (at, bottom + px(5)), 13, (HPos::Center, VPos::Top))?;
        }
        for (t, value) in y.scale.ticks(&chart.ranges[1]) {
            let at = chart.at(chart.ranges[0].start, t).1;
            chart.path(&[(left, at), (right, at)], stroke(GRID, 1))?;
            write(area, &(y.label)(value), (left - px(6), at), 13, (HPos::Right, VPos::Center))?;
        }
        let frame = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        chart.path(&frame, stroke(FRAME, 1))?;
        write(area, title, (left, px(10)), 13, (HPos::Left, VPos::Top))?;
        let middle = ((left + right) / 2, (top + bottom) / 2);
        write(area, &x.title, (middle.0, bottom + px(26)), 13, (HPos::Center, VPos::Top))?;
        let side = font(13).pos(Pos::new(HPos::Center, VPos::Top)).transform(FontTransform::Rotate270);
        area.draw(&Text::new(y.title, (px(6), middle.1), side)).map_err(|e| e.to_string())?;
        Ok(chart)
    }

    /// Pixels of a place along each axis.
    fn at(&self, x: f64, y: f64) -> (i32, i32) {
        let [left, top, right, bottom] = self.inside.map(f64::from);
        let place = |v: f64, r: &Range<f64>, a: f64, b: f64| a + (v - r.start) / (r.end - r.start) * (b - a);
        let [along, up] = &self.ranges;
        (place(x, along, left, right) as i32, place(y, up, bottom, top) as i32)
    }

    /// Pixels of a point.
    fn pixel(&self, (x, y): (f64, f64)) -> (i32, i32) {
        self.at(self.scales[0].of(x), self.scales[1].of(y))
    }

    fn path(&self, points: &[(i32, i32)], style: ShapeStyle) -> Drawn {
        Ok(self.area.draw(&PathElement::new(points.to_vec(), style)).map_err(|e| e.to_string())?)
    }

    pub(super) fn mark(&self, point: (f64, f64), mark: Mark, filled: bool) -> Drawn {
        let (x, y) = self.pixel(point);
        let r = px(MARK);
        self.taken.borrow_mut().push([x - r, y - r, x + r, y + r]);
        mark.draw(self.area, (x, y), MARK, filled)
    }

    pub(super) fn line(&self, points: &[(f64, f64)], style: ShapeStyle) -> Drawn {
        let points: Vec<_> = points.iter().map(|p| self.pixel(*p)).collect();
        self.path(&points, style)
    }

    /// A word beside a marked point, where it covers no mark and no other word; else none. Draw all marks first.
    pub(super) fn note(&self, point: (f64, f64), text: &str) -> Drawn {
        let at = self.pixel(point);
        let (width, height) = self.area.estimate_text_size(text, &font(NOTE)).map_err(|e| e.to_string())?;
        let mut taken = self.taken.borrow_mut();
        let Some(room) = room(at, (width as i32, height as i32), self.inside, &taken) else { return Ok(()) };
        taken.push(room);
        write(self.area, text, (room[0], (room[1] + room[3]) / 2), NOTE, (HPos::Left, VPos::Center))
    }
}

/// Place of a word of that size beside a point: above, below, right or left of it, within `inside` and free of `taken`.
fn room((x, y): (i32, i32), (w, h): (i32, i32), inside: [i32; 4], taken: &[[i32; 4]]) -> Option<[i32; 4]> {
    let gap = px(MARK + 3);
    let corners =
        [(x - w / 2, y - gap - h), (x - w / 2, y + gap), (x + gap, y - h / 2), (x - gap - w, y - h / 2)];
    let places = corners.map(|(left, top)| [left, top, left + w, top + h]);
    let within =
        |p: &[i32; 4]| p[0] >= inside[0] && p[1] >= inside[1] && p[2] <= inside[2] && p[3] <= inside[3];
    let meet = |a: &[i32; 4], b: &[i32; 4]| a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
    places.into_iter().find(|place| within(place) && !taken.iter().any(|other| meet(place, other)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_do_not_repeat_soon() {
        for k in 0..4 * COLORS {
            assert!((0..k).all(|other| Mark::of(other) != Mark::of(k)), "{k}");
        }
        assert!((0..3 * COLORS).all(|k| (0..k).all(|other| color(other) != color(k))));
    }

    #[test]
    fn notes_go_where_there_is_room() {
        let inside = [0, 0, 400, 400];
        let (at, size) = ((200, 200), (60, 20));
        let above = room(at, size, inside, &[]).unwrap();
        assert_eq!(above, [170, 164, 230, 184]);
        let below = room(at, size, inside, &[above]).unwrap();
        assert!(below[1] > 200, "{below:?}");
        // At the top of the frame there is no room above, and where all is taken there is none.
        assert!(room((200, 10), size, inside, &[]).unwrap()[1] > 10);
        assert_eq!(room(at, size, inside, &[inside]), None);
    }

    #[test]
    fn a_legend_has_as_many_columns_as_fit() {
        let entry = |name: &str| Entry { name: name.into(), mark: Mark::of(0), filled: true };
        let short: Vec<Entry> = (0..7).map(|_| entry("numerics.cfl=0.2")).collect();
        assert_eq!(columns(&short, 1240), 7);
        assert_eq!(legend_height(&short, 1240), 2 * ENTRY);
        assert_eq!(columns(&[entry(&"x".repeat(300))], 1240), 1);
    }

    #[test]
    fn linear_axes_hold_their_values_and_have_round_ticks() {
        let range = linear_axis([0.2, 1.0, f64::NAN].into_iter()).unwrap();
        assert!(range.start < 0.2 && range.end > 1.0);
        let ticks: Vec<f64> = linear_ticks(&range).iter().map(|t| (t * 1e9).round() / 1e9).collect();
        assert_eq!(ticks, [0.2, 0.4, 0.6, 0.8, 1.0]);
        assert_eq!(linear_ticks(&(-1.0..1.0)), [-1.0, -0.5, 0.0, 0.5, 1.0]);
        let same = linear_axis([3.0, 3.0].into_iter()).unwrap();
        assert!(same.start < 3.0 && same.end > 3.0 && !linear_ticks(&same).is_empty());
        assert_eq!(linear_axis(std::iter::empty()), None);
    }

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
