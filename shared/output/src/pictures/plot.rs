//! `plot.png`: what the probes measured, against time, beside what the literature says.

use super::canvas::{Area, Canvas, Drawn, FONT};
use super::panels::{Curve, Panel, panels};
use crate::OutputError;
use crate::pictures::units;
use crate::probes::read_probes;
use halfstep_scene::Scene;
use plotters::chart::{ChartContext, SeriesLabelPosition};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Colours of the run's curves.
pub const CURVES: [RGBColor; 3] = [RGBColor(0, 90, 181), RGBColor(220, 90, 20), RGBColor(20, 140, 90)];
/// Colours of the references.
pub const REFERENCES: [RGBColor; 4] =
    [RGBColor(30, 30, 30), RGBColor(190, 40, 130), RGBColor(140, 110, 0), RGBColor(90, 90, 190)];
const GRID: RGBColor = RGBColor(225, 225, 225);

/// Pixels drawn for each pixel of the picture, in each direction.
const OVERSAMPLING: u32 = 2;
/// Height of the heading, pixels.
pub(crate) const HEAD: u32 = 48;
/// References with more points are lines without marks.
const MOST_MARKS: usize = 80;

type Chart<'a, 'b> = ChartContext<'a, BitMapBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Draws `dir/plot.png` from `dir/probes.csv` and the scene's references; returns its path.
pub fn draw_plot(scene: &Scene, dir: &Path) -> Result<PathBuf, OutputError> {
    let path = dir.join("plot.png");
    let table = read_probes(&dir.join("probes.csv"))?;
    let panels = panels(scene, &table);
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
    canvas
        .draw(|area| {
            let (head, below) = area.split_vertically(HEAD * OVERSAMPLING);
            let middle = (head.dim_in_pixel().0 as i32 / 2, (HEAD * OVERSAMPLING) as i32 / 2);
            let style = font(22).pos(Pos::new(HPos::Center, VPos::Center));
            head.draw(&Text::new(title(scene), middle, style))?;
            for (area, panel) in below.split_evenly((rows, columns)).iter().zip(&panels) {
                draw_panel(area, panel, last)?;
            }
            if panels.is_empty() {
                let (x, y) = (20 * OVERSAMPLING as i32, 40 * OVERSAMPLING as i32);
                below.draw(&Text::new("The scene has no probes.", (x, y), font(16)))?;
            }
            Ok(())
        })
        .map_err(|e| OutputError::Picture { path: path.clone(), reason: e.to_string() })?;
    canvas.halved().save(&path)?;
    Ok(path)
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

fn font(size: u32) -> TextStyle<'static> {
    (FONT, size * OVERSAMPLING).into_font().color(&RGBColor(40, 40, 40))
}

fn stroke(color: RGBColor, width: u32) -> ShapeStyle {
    ShapeStyle { color: color.to_rgba(), filled: false, stroke_width: width * OVERSAMPLING }
}

fn draw_panel(area: &Area<'_>, panel: &Panel, last: f64) -> Drawn {
    let (per_second, time_unit) = units::shown("s", last);
    let (factor, unit) = units::shown(&panel.unit, panel.largest(last));
    let values = panel.range(last);
    let values = values.start * factor..values.end * factor;
    let mut chart = ChartBuilder::on(area)
        .margin(6 * OVERSAMPLING)
        .margin_right(22 * OVERSAMPLING)
        .x_label_area_size(44 * OVERSAMPLING)
        .y_label_area_size(74 * OVERSAMPLING)
        .build_cartesian_2d(0.0..last.max(f64::MIN_POSITIVE) * per_second, values.clone())?;
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
    let scaled = |&(time, value): &(f64, f64)| (time * per_second, value * factor);
    for (curve, color) in panel.references.iter().zip(REFERENCES.iter().cycle()) {
        let points: Vec<_> = curve.visible(last).iter().map(scaled).collect();
        draw_reference(&mut chart, curve, points, *color)?;
    }
    for (curve, color) in panel.curves.iter().zip(CURVES.iter().cycle()) {
        // A value that is not finite interrupts the curve.
        let points: Vec<_> = curve.points.iter().map(scaled).collect();
        for (k, piece) in points.split(|(_, value)| !value.is_finite()).enumerate() {
            let drawn = chart.draw_series(LineSeries::new(piece.iter().copied(), stroke(*color, 2)))?;
            if k == 0 {
                let style = stroke(*color, 2);
                drawn.label(curve.label.clone()).legend(move |(x, y)| legend_line(x, y, style));
            }
        }
    }
    if panel.curves.len() + panel.references.len() > 1 {
        chart
            .configure_series_labels()
            .position(emptiest_corner(panel, last))
            .margin(8 * OVERSAMPLING)
            .legend_area_size(34 * OVERSAMPLING)
            .background_style(WHITE.mix(0.85))
            .border_style(stroke(GRID, 1))
            .label_font(font(14))
            .draw()?;
    }
    Ok(())
}

/// A thin line with marks on it; marks alone for a cloud, no marks where they would run into each other.
fn draw_reference<'a, 'b: 'a>(
    chart: &mut Chart<'a, 'b>,
    curve: &Curve,
    points: Vec<(f64, f64)>,
    color: RGBColor,
) -> Drawn {
    let size = 4 * OVERSAMPLING as i32;
    let marked = points.len() <= MOST_MARKS;
    // Without a line its legend has none either.
    let line = if curve.is_line() { stroke(color, 1) } else { stroke(color, 1).color.mix(0.0).into() };
    let drawn = chart.draw_series(LineSeries::new(points.iter().copied(), line))?;
    drawn.label(curve.label.clone()).legend(move |(x, y)| {
        let mark = if marked { size } else { 0 };
        let middle = (x + 15 * OVERSAMPLING as i32, y);
        EmptyElement::at((0, 0)) + legend_line(x, y, line) + Circle::new(middle, mark, stroke(color, 1))
    });
    if marked {
        chart.draw_series(points.iter().map(|&point| Circle::new(point, size, stroke(color, 1))))?;
    }
    Ok(())
}

fn legend_line(x: i32, y: i32, style: ShapeStyle) -> PathElement<(i32, i32)> {
    PathElement::new([(x, y), (x + 30 * OVERSAMPLING as i32, y)], style)
}

/// Decimals that tell about eight ticks of an axis apart.
fn tick_digits(values: &Range<f64>) -> usize {
    let step = units::tick_step((values.end - values.start) / 10.0);
    (-step.log10().floor()).clamp(0.0, 9.0) as usize
}

fn tick(value: f64, digits: usize) -> String {
    if value.abs() >= 1e6 { format!("{value:.2e}") } else { format!("{value:.digits$}") }
}

/// The corner in whose reach the fewest points lie.
fn emptiest_corner(panel: &Panel, last: f64) -> SeriesLabelPosition {
    let values = panel.range(last);
    let mut count = [0.0; 4];
    for curve in panel.curves.iter().chain(&panel.references) {
        let points = curve.visible(last);
        for (time, value) in &points {
            let (x, y) = (time / last, (value - values.start) / (values.end - values.start));
            let corner = match (x < 0.45, x > 0.55, y > 0.6, y < 0.4) {
                (true, _, true, _) => 0,
                (_, true, true, _) => 1,
                (true, _, _, true) => 2,
                (_, true, _, true) => 3,
                _ => continue,
            };
            // Curves count alike, however many points they have.
            count[corner] += 1.0 / points.len() as f64;
        }
    }
    let emptiest = (0..4).min_by(|&a, &b| f64::total_cmp(&count[a], &count[b]));
    use SeriesLabelPosition::{LowerLeft, LowerRight, UpperLeft, UpperRight};
    [UpperLeft, UpperRight, LowerLeft, LowerRight][emptiest.unwrap_or(0)].clone()
}
