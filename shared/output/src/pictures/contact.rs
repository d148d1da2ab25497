//! `contact.png`: the particles at several instants, side by side: the fluid by pressure, the solid by von Mises
//! stress and black where it is cracked, walls grey; the same view and the same scales in all.

use super::canvas::{Area, Canvas, Drawn, FONT};
use super::plot::title;
use super::stamp::{DARK, Rect, Scale, Sheet, WALL};
use super::view::{View, layout};
use crate::pictures::units;
use crate::series::Series;
use crate::{Frame, OutputError, vtkhdf};
use halfstep_scene::Scene;
use halfstep_wire::frame::{self, von_mises};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::{Path, PathBuf};

/// Instants shown at most.
const MOST: usize = 6;
/// Damage from which on a particle is shown as part of a crack.
const CRACKED: f32 = 0.9;
/// Particles beyond this quantile of a colour scale get its last colour: a single one does not fade all others.
const QUANTILE: f64 = 0.99;
/// Height of the heading and of the colour bars, pixels.
pub(crate) const HEAD: i32 = 52;
pub(crate) const FOOT: i32 = 84;

/// Everything shown at one instant.
pub(crate) struct Instant {
    /// s.
    pub(crate) time: f64,
    /// Frames of the processes.
    pub(crate) frames: Vec<Frame>,
}

impl Instant {
    /// All particles of a phase, with the frame that holds them.
    pub(crate) fn phase(&self, phase: u8) -> impl Iterator<Item = (&Frame, usize)> {
        self.frames.iter().flat_map(move |f| {
            f.phase.iter().enumerate().filter(move |(_, p)| **p == phase).map(move |(k, _)| (f, k))
        })
    }
}

/// Draws `dir/contact.png` from the frames on disk; `None` where there are none.
pub fn draw_contact(scene: &Scene, dir: &Path) -> Result<Option<PathBuf>, OutputError> {
    let instants = instants(scene, dir)?;
    let Some(view) = View::of(scene, &instants) else { return Ok(None) };
    let path = dir.join("contact.png");
    let scales = ColourScales::of(&instants);
    let place = layout(instants.len(), view.size(), HEAD, FOOT, scene.resolution);
    let mut sheet = Sheet::new(place.width, place.height);
    let of_solids = (0..scene.solids.len()).map(|solid| scene.solid_spacing(solid)).fold(0.0, f64::max);
    let views: Vec<(View, [f64; 2])> =
        instants.iter().map(|instant| view.following(scene, instant)).collect();
    for ((instant, &panel), (view, _)) in instants.iter().zip(&place.panels).zip(&views) {
        for (phase, scale) in
            [(frame::WALL, None), (frame::FLUID, Some(Scale::Fluid)), (frame::SOLID, Some(Scale::Solid))]
        {
            let spacing = if phase == frame::SOLID { of_solids } else { scene.resolution };
            let radius = radius(spacing * place.scale);
            for (frame, k) in instant.phase(phase).filter(|(frame, k)| view.shows(frame.points[*k])) {
                let cracked = frame.damage.get(k).is_some_and(|&damage| damage > CRACKED);
                let color =
                    if cracked { DARK } else { scale.map_or(WALL, |scale| scales.color(scale, frame, k)) };
                sheet.disc(panel, view.pixel(frame.points[k], panel, place.scale), radius, color);
            }
        }
    }
    let cracks = instants.iter().any(|instant| instant.frames.iter().any(|frame| !frame.damage.is_empty()));
    let bars = scales.bars(place.width, place.height, cracks);
    for bar in &bars {
        sheet.bar(bar.at, bar.scale);
    }
    let (width, height) = sheet.size();
    let mut canvas = Canvas::new(width, height);
    canvas
        .draw(|area| {
            label(area, &title(scene), (16, 14), 20, HPos::Left)?;
            scale_bar(area, &view, place.scale, width as i32)?;
            let last = instants.last().map_or(0.0, |instant| instant.time);
            for ((instant, panel), (view, by)) in instants.iter().zip(&place.panels).zip(&views) {
                frame_of(area, *panel)?;
                let text =
                    time_label(instant.time, last) + &way_label(*by) + &beyond_label(view.beyond(instant));
                label(area, &text, (panel.x, panel.y - 22), 15, HPos::Left)?;
            }
            bars.iter().try_for_each(|bar| bar.draw(area))
        })
        .map_err(|e| OutputError::Picture { path: path.clone(), reason: e.to_string() })?;
    sheet.overlay(&canvas);
    sheet.save(&path)?;
    Ok(Some(path))
}

/// Radius of a particle's disc for a spacing, both in pixels: large discs touch; small ones overlap so that no
/// background shines through.
pub(super) fn radius(spacing: f64) -> f64 {
    let overlap = 1.42 - 0.38 * ((spacing - 8.0) / 8.0).clamp(0.0, 1.0);
    (0.5 * spacing * overlap).max(0.75)
}

/// Up to [`MOST`] instants evenly over the announced frames, the first and the last among them.
fn instants(scene: &Scene, dir: &Path) -> Result<Vec<Instant>, OutputError> {
    let participants = scene.participants();
    let series = participants.iter().map(|participant| Series::of_run(dir, &participant.name));
    let mut series = series.collect::<Result<Vec<_>, OutputError>>()?;
    series.retain(|frames| !frames.is_empty());
    // An interrupted run may have written more frames of one participant than of another: the shortest leads.
    let Some(shortest) = (0..series.len()).min_by_key(|&k| series[k].len()) else { return Ok(Vec::new()) };
    let leading = series.remove(shortest);
    let shown = leading.len().min(MOST);
    (0..shown)
        .map(|k| {
            let (path, time) = &leading[if shown > 1 { k * (leading.len() - 1) / (shown - 1) } else { 0 }];
            let mut frames = vec![vtkhdf::read(path)?];
            let nearest = |(_, a): &&(PathBuf, f64), (_, b): &&(PathBuf, f64)| {
                f64::total_cmp(&(a - time).abs(), &(b - time).abs())
            };
            for other in &series {
                if let Some((path, _)) = other.iter().min_by(nearest) {
                    frames.push(vtkhdf::read(path)?);
                }
            }
            Ok(Instant { time: *time, frames })
        })
        .collect()
}

/// Ends of the colour scales, Pa; `None` where the phase is absent.
struct ColourScales {
    pressure: Option<(f64, f64)>,
    stress: Option<(f64, f64)>,
}

impl ColourScales {
    fn of(instants: &[Instant]) -> Self {
        let values = |phase, value: fn(&Frame, usize) -> f64| -> Vec<f64> {
            let all = instants.iter().flat_map(|instant| instant.phase(phase));
            let mut values: Vec<f64> =
                all.map(|(frame, k)| value(frame, k)).filter(|v| v.is_finite()).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let end = |values: &[f64], part: f64| {
            (!values.is_empty()).then(|| values[((values.len() - 1) as f64 * part).round() as usize])
        };
        let pressure = values(frame::FLUID, |frame, k| f64::from(frame.pressure[k]));
        let stress = values(frame::SOLID, |frame, k| von_mises(&frame.stress[k].map(f64::from)));
        let top = |value: f64| if value > 0.0 { units::scale_end(value) } else { 1.0 };
        Self {
            pressure: end(&pressure, QUANTILE).zip(end(&pressure, 1.0 - QUANTILE)).map(|(high, low)| {
                let high = top(high);
                // A little tension is no reason for a scale that starts below zero.
                (if low < -0.1 * high { -units::scale_end(-low) } else { 0.0 }, high)
            }),
            stress: end(&stress, QUANTILE).map(|high| (0.0, top(high))),
        }
    }

    fn color(&self, scale: Scale, frame: &Frame, k: usize) -> u8 {
        let (value, range) = match scale {
            Scale::Fluid => (f64::from(frame.pressure[k]), self.pressure),
            Scale::Solid => (von_mises(&frame.stress[k].map(f64::from)), self.stress),
        };
        let (low, high) = range.unwrap_or((0.0, 1.0));
        scale.index((value - low) / (high - low))
    }

    /// The bars that explain the colours, at the foot of the picture.
    fn bars(&self, width: i32, height: i32, cracks: bool) -> Vec<Bar> {
        let solid = if cracks {
            "solid: von Mises stress; black: damage above 0.9"
        } else {
            "solid: von Mises stress"
        };
        let present: Vec<_> =
            [(Scale::Fluid, "fluid: pressure", self.pressure), (Scale::Solid, solid, self.stress)]
                .into_iter()
                .filter_map(|(scale, quantity, range)| Some((scale, quantity, range?)))
                .collect();
        let (edge, gap) = (24, 56);
        let count = present.len().max(1) as i32;
        let length = ((width - 2 * edge - (count - 1) * gap) / count).clamp(60, 420);
        let bar = |(k, (scale, quantity, range))| Bar {
            at: Rect { x: edge + k * (length + gap), y: height - FOOT + 32, width: length, height: 16 },
            scale,
            quantity,
            range,
        };
        (0..).zip(present).map(bar).collect()
    }
}

/// A colour bar.
struct Bar {
    at: Rect,
    scale: Scale,
    quantity: &'static str,
    range: (f64, f64),
}

impl Bar {
    fn draw(&self, area: &Area<'_>) -> Drawn {
        let (low, high) = self.range;
        let (factor, unit) = units::shown("Pa", high.max(-low));
        label(area, &format!("{} [{unit}]", self.quantity), (self.at.x, self.at.y - 22), 14, HPos::Left)?;
        frame_of(area, self.at)?;
        let step = units::tick_step((high - low) / 5.0);
        let (first, last) = ((low / step).ceil() as i32, (high / step * (1.0 + 1e-9)).floor() as i32);
        for value in (first..=last).map(|tick| f64::from(tick) * step) {
            let x = self.at.x + (f64::from(self.at.width - 1) * (value - low) / (high - low)).round() as i32;
            let bottom = self.at.y + self.at.height;
            area.draw(&PathElement::new([(x, bottom), (x, bottom + 5)], BLACK.mix(0.6)))?;
            label(area, &units::number(value * factor), (x, bottom + 7), 13, HPos::Center)?;
        }
        Ok(())
    }
}

pub(super) fn label(area: &Area<'_>, text: &str, at: (i32, i32), size: u32, side: HPos) -> Drawn {
    let style = (FONT, size).into_font().color(&RGBColor(20, 20, 20)).pos(Pos::new(side, VPos::Top));
    Ok(area.draw(&Text::new(text.to_string(), at, style))?)
}

pub(super) fn frame_of(area: &Area<'_>, rect: Rect) -> Drawn {
    let corners = [(rect.x - 1, rect.y - 1), (rect.x + rect.width, rect.y + rect.height)];
    Ok(area.draw(&Rectangle::new(corners, RGBColor(120, 120, 120)))?)
}

/// A length to compare with, at the upper right: a tenth to a quarter of the view.
pub(super) fn scale_bar(area: &Area<'_>, view: &View, scale: f64, width: i32) -> Drawn {
    let length = units::tick_step(view.size()[0] / 10.0);
    let (factor, unit) = units::shown("m", length);
    let (right, y) = (width - 20, HEAD / 2 - 2);
    let left = right - (length * scale).round() as i32;
    let ends = [(left, y - 4), (left, y + 4), (left, y), (right, y), (right, y - 4), (right, y + 4)];
    area.draw(&PathElement::new(ends, BLACK))?;
    label(area, &format!("{} {unit}", units::number(length * factor)), (left - 8, y - 9), 14, HPos::Right)
}

/// Where a view that follows has gone.
fn way_label(by: [f64; 2]) -> String {
    let (factor, unit) = units::shown("m", by[0].abs().max(by[1].abs()));
    match by {
        [0.0, 0.0] => String::new(),
        [x, y] => {
            format!(", view moved by ({}, {}) {unit}", units::number(x * factor), units::number(y * factor))
        }
    }
}

/// How many particles the view does not show.
fn beyond_label(count: usize) -> String {
    if count == 0 { String::new() } else { format!(", {count} outside") }
}

fn time_label(time: f64, last: f64) -> String {
    let (factor, unit) = units::shown("s", last);
    format!("t = {} {unit}", units::number(time * factor))
}
