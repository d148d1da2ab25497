//! The picture of a scene before its run: shapes by phase, bodies by colour, clamps, moving walls, probes.

use super::canvas::{Area, Canvas, Drawn};
use super::contact::{FOOT, HEAD, frame_of, label, radius, scale_bar};
use super::plot::title;
use super::stamp::{Rect, Scale, Sheet, WALL};
use super::view::{View, layout};
use crate::OutputError;
use halfstep_scene::geometry::{self, Layout};
use halfstep_scene::{Block, Phase, ProbeKind, Scene, Spot, dispatch};
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
    canvas
        .draw(|area| {
            label(area, &title(scene), (16, 14), 20, HPos::Left)?;
            scale_bar(area, &view, place.scale, width as i32)?;
            frame_of(area, panel)?;
            for clamp in scene.shapes.iter().flat_map(|shape| &shape.clamp) {
                outline(area, clamp, pixel)?;
            }
            for probe in &scene.probes {
                let marks = marks(&probe.kind);
                for &at in &marks {
                    cross(area, pixel(at))?;
                }
                if let Some((x, y)) = marks.first().map(|&at| pixel(at)) {
                    let right = x > panel.x + panel.width / 2;
                    let (x, side) = if right { (x - 9, HPos::Right) } else { (x + 9, HPos::Left) };
                    label(area, &probe.name, (x, y - 18), 14, side)?;
                }
            }
            for (k, (_, text)) in legend(scene).iter().enumerate() {
                let swatch = swatch(k, place.height);
                label(area, text, (swatch.x + 20, swatch.y), 14, HPos::Left)?;
            }
            Ok(())
        })
        .map_err(|e| wrong(e.to_string()))?;
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

/// Points, or ends of lines, at which a probe measures, m.
fn marks(kind: &ProbeKind) -> Vec<[f64; 3]> {
    match kind {
        ProbeKind::Displacement { at }
        | ProbeKind::Position { at }
        | ProbeKind::Stress { at }
        | ProbeKind::SolidVelocity { at }
        | ProbeKind::Strain { of: Spot::At(at) }
        | ProbeKind::CauchyStress { of: Spot::At(at) }
        | ProbeKind::Velocity { at } => vec![*at],
        ProbeKind::Pressure { at, to, .. } => [Some(*at), *to].into_iter().flatten().collect(),
        ProbeKind::Flux { from, to } => vec![*from, *to],
        _ => Vec::new(),
    }
}

fn cross(area: &Area<'_>, (x, y): (i32, i32)) -> Drawn {
    for ends in [[(x - CROSS, y), (x + CROSS, y)], [(x, y - CROSS), (x, y + CROSS)]] {
        area.draw(&PathElement::new(ends, BLACK.stroke_width(2)))?;
    }
    Ok(())
}

fn outline(area: &Area<'_>, clamp: &Block, pixel: impl Fn([f64; 3]) -> (i32, i32)) -> Drawn {
    Ok(area.draw(&Rectangle::new([pixel(clamp.min), pixel(clamp.max)], BLACK))?)
}
