//! The picture of a scene before its run: shapes by phase, bodies by colour, clamps, moving walls, probes.

use super::canvas::{Area, Canvas, Drawn, FONT};
use super::contact::{FOOT, HEAD, frame_of, label, radius, scale_bar};
use super::plot::title;
use super::stamp::{Rect, Scale, Sheet, WALL};
use super::view::{View, layout};
use crate::OutputError;
use halfstep_scene::geometry::{self, Layout};
use halfstep_scene::{Block, Phase, ProbeKind, Scene, dispatch};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;
use std::path::Path;

/// Palette index of a wall that moves: a darker grey.
const MOVING: u8 = 10;
/// Palette index of what a clamp holds: black.
pub(super) const CLAMPED: u8 = 15;
/// Place of the fluid on its scale.
const WATER: f64 = 0.35;
/// Bodies that differ in colour; more begin again.
const COLOURS: usize = 7;
/// From one body to the next, so that neighbours in the file differ.
const STRIDE: usize = 3;
/// Half the size of a probe's cross, pixels.
const CROSS: i32 = 6;
/// Size of a probe's name, length of dashes and of the gaps between them, pixels.
const NAME: u32 = 14;
const DASH: (usize, usize) = (9, 6);
/// Colour of boxes to which probes are confined.
const WITHIN: RGBColor = RGBColor(70, 70, 70);

/// A particle to draw.
struct Dot {
    at: [f64; 3],
    spacing: f64,
    color: u8,
}

/// Draws a scene's particles, clamps and probes as they are at the start.
///
/// # Errors
/// There are no particles, or the file cannot be written.
pub fn draw_start(scene: &Scene, path: &Path) -> Result<(), OutputError> {
    let wrong = |reason: String| OutputError::Picture { path: path.into(), reason };
    let dots = dispatch!(scene.dimension, D => dots(scene, &geometry::layout::<D>(scene)));
    let dots = dots.unwrap_or_default();
    let view = View::of_points(scene, dots.iter().map(|dot| dot.at));
    let view = view.ok_or_else(|| wrong("the scene has no particles".into()))?;
    let place = layout(1, view.size(), HEAD, FOOT, scene.resolution);
    let panel = place.panels[0];
    let mut sheet = Sheet::new(place.width, place.height);
    let single = |x: [f64; 3]| x.map(|x| x as f32);
    for dot in dots.iter().filter(|dot| view.shows(single(dot.at))) {
        let at = view.pixel(single(dot.at), panel, place.scale);
        sheet.disc(panel, at, radius(dot.spacing * place.scale), dot.color);
    }
    let (width, height) = sheet.size();
    for (k, (color, _)) in legend(scene).iter().enumerate() {
        let swatch = swatch(k, place.height);
        sheet.disc(swatch, [f64::from(swatch.x + 7), f64::from(swatch.y + 7)], 7.0, *color);
    }
    let mut canvas = Canvas::new(width, height);
    let pixel = |x: [f64; 3]| {
        let [x, y] = view.pixel(single(x), panel, place.scale);
        (x.round() as i32, y.round() as i32)
    };
    let mut names = Vec::new();
    canvas
        .draw(|area| {
            label(area, &title(scene), (16, 14), 20, HPos::Left)?;
            scale_bar(area, &view, place.scale, width as i32)?;
            frame_of(area, panel)?;
            for clamp in scene.shapes.iter().flat_map(|shape| &shape.clamp) {
                outline(area, clamp, panel, pixel, BLACK)?;
            }
            names = draw_probes(area, scene, panel, pixel)?;
            for (k, (_, text)) in legend(scene).iter().enumerate() {
                let swatch = swatch(k, place.height);
                label(area, text, (swatch.x + 20, swatch.y), 14, HPos::Left)?;
            }
            Ok(())
        })
        .map_err(|e| wrong(e.to_string()))?;
    // Dark letters on blue water cannot be read.
    names.iter().for_each(|&name| sheet.blank(name));
    sheet.overlay(&canvas);
    sheet.save(path)
}

fn dots<const D: usize>(scene: &Scene, layout: &Layout<D>) -> Vec<Dot> {
    let dot = |position: [f64; D], spacing, color| {
        let mut at = [0.0; 3];
        at[..D].copy_from_slice(&position);
        Dot { at, spacing, color }
    };
    let moves = |shape: u32| scene.shapes[shape as usize].motion.is_some();
    let wall = |shape| if moves(shape) { MOVING } else { WALL };
    let (dx, water) = (scene.resolution, water());
    let walls = layout.wall.iter().map(|p| dot(p.position, dx, wall(p.shape)));
    let fluid = layout.fluid.iter().map(|p| dot(p.position, dx, water));
    let solid = layout.solid.iter().zip(geometry::pieces(scene, layout)).map(|(p, body)| {
        let color = if p.clamped { CLAMPED } else { body_color(body as usize) };
        dot(p.position, scene.spacing(&scene.shapes[p.body as usize]), color)
    });
    walls.chain(fluid).chain(solid).collect()
}

pub(super) fn water() -> u8 {
    Scale::Fluid.index(WATER)
}

pub(super) fn body_color(body: usize) -> u8 {
    Scale::Solid.index(0.2 + 0.75 * (body * STRIDE % COLOURS) as f64 / (COLOURS - 1) as f64)
}

/// What the colours mean, of what the scene has.
fn legend(scene: &Scene) -> Vec<(u8, &'static str)> {
    let walls = |moving| {
        let mut shapes = scene.shapes.iter().filter(|shape| shape.phase == Phase::Wall);
        shapes.any(|shape| shape.motion.is_some() == moving)
    };
    let solid = !scene.solids.is_empty();
    let clamped = scene.shapes.iter().any(|shape| !shape.clamp.is_empty());
    let all = [
        (scene.fluid.is_some(), water(), "fluid"),
        (walls(false), WALL, "wall"),
        (walls(true), MOVING, "wall that moves"),
        (solid, body_color(0), "solid, a colour for each body"),
        (clamped, CLAMPED, "clamped"),
    ];
    all.into_iter().filter_map(|(is_there, color, text)| is_there.then_some((color, text))).collect()
}

/// Where the colour of an entry of the legend stands.
fn swatch(entry: usize, height: i32) -> Rect {
    let (column, row) = (entry as i32 % 3, entry as i32 / 3);
    Rect { x: 24 + 220 * column, y: height - FOOT + 24 + 26 * row, width: 16, height: 16 }
}

/// Draws where the probes measure, with their names; returns the ground of these.
fn draw_probes(
    area: &Area<'_>,
    scene: &Scene,
    panel: Rect,
    pixel: impl Fn([f64; 3]) -> (i32, i32),
) -> Result<Vec<Rect>, Box<dyn std::error::Error>> {
    let mut names: Vec<(String, (i32, i32))> = Vec::new();
    for probe in &scene.probes {
        let marks = marks(&probe.kind);
        for &at in &marks {
            cross(area, pixel(at))?;
        }
        let mut name = marks.first().map(|&at| (pixel(at).0, pixel(at).1 - 18));
        if let Some(within) = within(&probe.kind) {
            outline(area, within, panel, &pixel, WITHIN)?;
            let (x, y) = pixel([within.min[0], within.max[1], 0.0]);
            name = name.or(Some((x.max(panel.x), y.max(panel.y) + 2)));
        }
        names.extend(name.map(|at| (probe.name.clone(), at)));
        if let ProbeKind::WaterLevel { x } = &probe.kind {
            for (k, &column) in x.iter().enumerate() {
                let (x_pixel, _) = pixel([column, 0.0, 0.0]);
                if (panel.x..panel.x + panel.width).contains(&x_pixel) {
                    dashes(area, x_pixel, panel)?;
                    let number = if x.len() > 1 { format!(" {}", k + 1) } else { String::new() };
                    names.push((probe.name.clone() + &number, (x_pixel, panel.y + 4)));
                }
            }
        }
    }
    let mut grounds: Vec<Rect> = Vec::new();
    for (name, (x, y)) in names {
        let right = x > panel.x + panel.width / 2;
        let (width, height) = label_size(area, &name)?;
        let left = if right { x - 9 - width } else { x + 9 };
        let mut ground = Rect { x: left - 3, y: y - 4, width: width + 6, height: height + 7 };
        // Names of probes at one place stand below each other.
        while let Some(other) = grounds.iter().find(|other| other.meets(&ground)) {
            ground.y = other.y + other.height;
        }
        let corners = [(ground.x, ground.y), (ground.x + ground.width, ground.y + ground.height)];
        area.draw(&Rectangle::new(corners, WHITE.filled()))?;
        label(area, &name, (left, ground.y + 4), NAME, HPos::Left)?;
        grounds.push(ground);
    }
    Ok(grounds)
}

/// Width and height of a name, pixels.
fn label_size(area: &Area<'_>, name: &str) -> Result<(i32, i32), Box<dyn std::error::Error>> {
    let (width, height) = area.estimate_text_size(name, &(FONT, NAME).into_font().into())?;
    Ok((width as i32, height as i32))
}

/// Points, or ends of lines, at which a probe measures, m.
fn marks(kind: &ProbeKind) -> Vec<[f64; 3]> {
    match kind {
        ProbeKind::Velocity { at } => vec![*at],
        ProbeKind::Pressure { at, to, .. } => [Some(*at), *to].into_iter().flatten().collect(),
        ProbeKind::Flux { from, to } => vec![*from, *to],
        ProbeKind::Moment { about, .. } => vec![*about],
        _ => kind.point_of_solid().into_iter().collect(),
    }
}

/// The box to which a probe is confined.
fn within(kind: &ProbeKind) -> Option<&Block> {
    match kind {
        ProbeKind::Force { within, .. } | ProbeKind::Moment { within, .. } => within.as_ref(),
        _ => None,
    }
}

/// A gauge of the water's level: a dashed line over the panel's height.
fn dashes(area: &Area<'_>, x: i32, panel: Rect) -> Drawn {
    let bottom = panel.y + panel.height;
    for y in (panel.y..bottom).step_by(DASH.0 + DASH.1) {
        let end = (y + DASH.0 as i32).min(bottom);
        area.draw(&Rectangle::new([(x - 1, y), (x + 1, end)], BLACK.filled()))?;
    }
    Ok(())
}

fn cross(area: &Area<'_>, (x, y): (i32, i32)) -> Drawn {
    for ends in [[(x - CROSS, y), (x + CROSS, y)], [(x, y - CROSS), (x, y + CROSS)]] {
        area.draw(&PathElement::new(ends, BLACK.stroke_width(2)))?;
    }
    Ok(())
}

/// A box, as far as the panel shows it.
fn outline(
    area: &Area<'_>,
    block: &Block,
    panel: Rect,
    pixel: impl Fn([f64; 3]) -> (i32, i32),
    color: RGBColor,
) -> Drawn {
    let shown = |x| {
        let (x, y) = pixel(x);
        (x.clamp(panel.x, panel.x + panel.width - 1), y.clamp(panel.y, panel.y + panel.height - 1))
    };
    Ok(area.draw(&Rectangle::new([shown(block.min), shown(block.max)], color))?)
}
