//! `plot.png`: what the probes measured, against time, beside what the literature says.

use super::canvas::{Area, Canvas, FONT};
use super::legend::{Legend, Look};
use super::panels::{Panel, panels};
use super::stamp::Rect;
use super::strokes::Mask;
use crate::OutputError;
use crate::pictures::units;
use crate::probes::{Table, read_probes};
use halfstep_scene::Scene;
use plotters::chart::ChartContext;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Colours of the run's curves: those of Okabe and Ito that stand out from white, and a dark violet.
/// They differ for the colour-blind, too.
pub const CURVES: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(51, 34, 136),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];
/// Colours of the references: dark, brown or grey, as no curve's.
pub const REFERENCES: [RGBColor; 4] =
    [RGBColor(30, 30, 30), RGBColor(95, 60, 35), RGBColor(92, 90, 84), RGBColor(186, 180, 168)];
/// Corners of the references' marks: circles first.
const MARKS: [u32; 4] = [24, 4, 3, 5];
const GRID: RGBColor = RGBColor(225, 225, 225);

/// Pixels drawn for each pixel of the picture, in each direction.
pub(crate) const OVERSAMPLING: u32 = 2;
/// Height of the heading, pixels.
pub(crate) const HEAD: u32 = 48;
/// More panels are not drawn: nobody reads them, and each takes 3 MB of memory.
const MOST_PANELS: usize = 48;
/// References with more points are lines without marks.
const MOST_MARKS: usize = 80;

type Chart<'a, 'b> = ChartContext<'a, BitMapBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
pub(crate) type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

/// Where on the oversampled picture a panel's curves are, and its legend.
#[cfg_attr(not(test), expect(dead_code, reason = "tests look there"))]
pub(crate) struct Place {
    pub(crate) plot: Rect,
    pub(crate) legend: Option<Rect>,
}

/// Draws `dir/plot.png` from `dir/probes.csv` and the scene's references; returns its path.
pub fn draw_plot(scene: &Scene, dir: &Path) -> Result<PathBuf, OutputError> {
    let path = dir.join("plot.png");
    let table = read_probes(&dir.join("probes.csv"))?;
    let wrong =
        |e: Box<dyn std::error::Error>| OutputError::Picture { path: path.clone(), reason: e.to_string() };
    let (canvas, _) = paint(scene, &table).map_err(wrong)?;
    canvas.halved().save(&path)?;
    Ok(path)
}

/// The oversampled picture, and where its panels are.
pub(crate) fn paint(scene: &Scene, table: &Table) -> Fallible<(Canvas, Vec<Place>)> {
    let mut panels = panels(scene, table);
    let all = panels.len();
    panels.truncate(MOST_PANELS);
    let columns = match panels.len() {
        0..=3 => 1,
        4..=8 => 2,
        _ => 3,
    };
    let rows = panels.len().div_ceil(columns).max(1);
    let width = if columns == 1 { 1000 } else { 760 * columns as u32 };
    let height = HEAD + rows as u32 * if columns == 1 { 400 } else { 340 };
    let mut canvas = Canvas::new(width * OVERSAMPLING, height * OVERSAMPLING);
    let last = table.rows.iter().map(|row| row[0]).filter(|t| t.is_finite()).fold(scene.end_time, f64::max);
    let mut places = Vec::new();
    canvas.draw(|area| {
        let (head, below) = area.split_vertically(HEAD * OVERSAMPLING);
        let middle = (head.dim_in_pixel().0 as i32 / 2, (HEAD * OVERSAMPLING) as i32 / 2);
        let style = font(22).pos(Pos::new(HPos::Center, VPos::Center));
        let rest = match all > panels.len() {
            true => format!(" · the first {} of {all} panels: probes.csv has all", panels.len()),
            false => String::new(),
        };
        head.draw(&Text::new(title(scene) + &rest, middle, style))?;
        for (area, panel) in below.split_evenly((rows, columns)).iter().zip(&panels) {
            places.push(draw_panel(area, panel, last)?);
        }
        if panels.is_empty() {
            let (x, y) = (20 * OVERSAMPLING as i32, 40 * OVERSAMPLING as i32);
            below.draw(&Text::new("The scene has no probes.", (x, y), font(16)))?;
        }
        Ok(())
    })?;
    Ok((canvas, places))
}

/// The picture's heading: the scene and its resolution.
pub(crate) fn title(scene: &Scene) -> String {
    let length = |metres: f64| {
        let (factor, unit) = units::shown("m", metres);
        format!("{} {unit}", units::number(metres * factor))
    };
    let own = (0..scene.solids.len()).filter(|&solid| scene.solid_spacing(solid) != scene.resolution);
    let own: String =
        own.map(|k| format!(", {} {}", scene.solids[k].name, length(scene.solid_spacing(k)))).collect();
    format!("{} · {}D · particle spacing {}{own}", scene.name, scene.dimension, length(scene.resolution))
}

pub(crate) fn font(size: u32) -> TextStyle<'static> {
    (FONT, size * OVERSAMPLING).into_font().color(&RGBColor(40, 40, 40))
}

fn stroke(color: RGBColor, width: u32) -> ShapeStyle {
    ShapeStyle { color: color.to_rgba(), filled: false, stroke_width: width * OVERSAMPLING }
}

fn draw_panel(area: &Area<'_>, panel: &Panel, last: f64) -> Fallible<Place> {
    let (per_second, time_unit) = units::shown("s", last);
    let (factor, unit) = units::shown(&panel.unit, panel.largest(last));
    let values = panel.range(last);
    let mut values = values.start * factor..values.end * factor;
    let build = |values: &Range<f64>| {
        ChartBuilder::on(area)
            .margin(6 * OVERSAMPLING)
            .margin_right(22 * OVERSAMPLING)
            .x_label_area_size(44 * OVERSAMPLING)
            .y_label_area_size(74 * OVERSAMPLING)
            .build_cartesian_2d(0.0..last.max(f64::MIN_POSITIVE) * per_second, values.clone())
    };
    let mut chart = build(&values)?;
    let looks = looks(panel);
    let mut layers = layers(&chart, panel, last, [per_second, factor], &looks);
    let size = chart.plotting_area().dim_in_pixel();
    let size = (size.0 as i32, size.1 as i32);
    let mut legend = None;
    if looks.len() > 1 {
        let named = panel.references.iter().chain(&panel.curves).map(|curve| curve.label.clone());
        let entries = Legend::new(area, named.zip(looks.iter().copied()).collect())?;
        let mut all = Mask::new(size.0, size.1);
        layers.iter().for_each(|layer| all.add(layer));
        let mut at = entries.corner(size, &all);
        if at.is_none() {
            // No corner is free: the axis grows upward by a strip that holds no data.
            let (strip, below) = entries.strip(size);
            values.end = values.start + (values.end - values.start) / below;
            chart = build(&values)?;
            layers = self::layers(&chart, panel, last, [per_second, factor], &looks);
            at = Some(strip);
        }
        legend = at.map(|at| (entries, at));
    }
    let digits = tick_digits(&values);
    chart
        .configure_mesh()
        .x_desc(format!("time [{time_unit}]"))
        .y_labels(8)
        .y_desc(format!("{} [{unit}]", panel.quantity))
        .axis_desc_style(font(15))
        .label_style(font(14))
        .y_label_formatter(&|value| tick(*value, digits))
        .x_label_formatter(&|time| units::number(*time))
        .bold_line_style(stroke(GRID, 1))
        .light_line_style(TRANSPARENT)
        .axis_style(stroke(RGBColor(90, 90, 90), 1))
        .draw()?;
    let plot = chart.plotting_area().strip_coord_spec();
    layers.iter().zip(&looks).try_for_each(|(layer, look)| layer.draw(&plot, look.color))?;
    if let Some((entries, at)) = &legend {
        entries.draw(&plot, *at)?;
    }
    let (x, y) = plot.get_pixel_range();
    let legend = legend.map(|(_, at)| Rect { x: at.x + x.start, y: at.y + y.start, ..at });
    Ok(Place { plot: Rect { x: x.start, y: y.start, width: size.0, height: size.1 }, legend })
}

/// How the references and the curves of a panel are drawn.
fn looks(panel: &Panel) -> Vec<Look> {
    let thin = 0.5 * f64::from(OVERSAMPLING);
    let styles = REFERENCES.into_iter().zip(MARKS).cycle();
    let references = panel.references.iter().zip(styles).map(|(curve, (color, mark))| Look {
        color,
        line: curve.is_line().then_some(thin),
        // Marks alone for a cloud, no marks where they would run into each other.
        mark: (curve.points.len() <= MOST_MARKS || !curve.is_line()).then_some(mark),
    });
    // Where the colours begin again, lines are thinner.
    let curves = (0..panel.curves.len()).map(|k| Look {
        color: CURVES[k % CURVES.len()],
        line: Some(if k < CURVES.len() { 2.0 * thin } else { thin }),
        mark: None,
    });
    references.chain(curves).collect()
}

/// The pixels of each curve.
fn layers(
    chart: &Chart<'_, '_>,
    panel: &Panel,
    last: f64,
    [per_second, factor]: [f64; 2],
    looks: &[Look],
) -> Vec<Mask> {
    let (columns, rows) = chart.plotting_area().get_pixel_range();
    let pixel = |&(time, value): &(f64, f64)| {
        let (x, y) = chart.plotting_area().map_coordinate(&(time * per_second, value * factor));
        (f64::from(x - columns.start), f64::from(y - rows.start))
    };
    let empty = Mask::new(columns.end - columns.start, rows.end - rows.start);
    let references = panel.references.iter().map(|curve| vec![curve.visible(last)]);
    // A value that is not finite interrupts the curve.
    let curves = panel.curves.iter().map(|curve| {
        curve.points.split(|(_, value)| !value.is_finite()).map(<[_]>::to_vec).collect::<Vec<_>>()
    });
    let pieces = references.chain(curves).zip(looks);
    pieces
        .map(|(pieces, look)| {
            let mut mask = empty.clone();
            for piece in pieces {
                look.cover(&mut mask, &piece.iter().map(pixel).collect::<Vec<_>>());
            }
            mask
        })
        .collect()
}

/// Decimals that tell about eight ticks of an axis apart.
fn tick_digits(values: &Range<f64>) -> usize {
    let step = units::tick_step((values.end - values.start) / 10.0);
    (-step.log10().floor()).clamp(0.0, 9.0) as usize
}

pub(super) fn tick(value: f64, digits: usize) -> String {
    // Decimals would be zeros alone.
    let tiny = digits > 6 && value.abs() < 1e-4;
    match value {
        0.0 if tiny => "0".into(),
        _ if tiny || value.abs() >= 1e6 => format!("{value:.2e}"),
        _ => format!("{value:.digits$}"),
    }
}
