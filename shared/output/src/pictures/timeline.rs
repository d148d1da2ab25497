//! `trace.png`: who does what in two steps, and what each phase takes of the time of all recorded ones.

use super::canvas::{Area, Canvas, Drawn, FONT};
use super::plot::title;
use super::units;
use crate::OutputError;
use crate::timeline::{HALF_STEP, Share, Span, Timeline, Track};
use halfstep_scene::Scene;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

/// Pixels drawn for each pixel of the picture, in each direction.
const OVERSAMPLING: i32 = 2;
/// Sizes in pixels of the picture.
const WIDTH: i32 = 1400;
const HEAD: i32 = 48;
const NAMES: i32 = 150;
const MARGIN: i32 = 24;
const TRACK: i32 = 46;
const AXIS: i32 = 52;
const ROW: i32 = 21;
const COLUMN: i32 = 100;
/// Width of the column with the phases' names.
const PHASES: i32 = 240;
/// Between two tables.
const GAP: i32 = 60;
/// Phases with a smaller share in all tracks are part of everything else.
const SMALLEST_SHARE: f64 = 5e-4;

const INK: RGBColor = RGBColor(40, 40, 40);
const FAINT: RGBColor = RGBColor(225, 225, 225);
/// Colours of what other phases do, by category: neighbours differ.
pub(crate) const COMPUTE: [RGBColor; 14] = [
    RGBColor(0, 90, 181),
    RGBColor(20, 140, 90),
    RGBColor(120, 70, 160),
    RGBColor(86, 170, 226),
    RGBColor(190, 60, 130),
    RGBColor(140, 190, 70),
    RGBColor(0, 130, 150),
    RGBColor(90, 90, 190),
    RGBColor(200, 120, 190),
    RGBColor(40, 60, 110),
    RGBColor(110, 150, 130),
    RGBColor(150, 120, 220),
    RGBColor(60, 110, 60),
    RGBColor(160, 40, 60),
];
pub(crate) const WAIT: [RGBColor; 4] =
    [RGBColor(212, 212, 212), RGBColor(190, 190, 190), RGBColor(228, 228, 220), RGBColor(200, 205, 215)];
const MESSAGE: [RGBColor; 3] = [RGBColor(230, 130, 30), RGBColor(245, 190, 80), RGBColor(200, 90, 20)];
const OUTPUT: [RGBColor; 3] = [RGBColor(140, 90, 50), RGBColor(190, 150, 100), RGBColor(110, 110, 40)];

/// A row of the table of shares: a phase, and its share in each track.
struct Row {
    name: String,
    color: RGBColor,
    shares: Vec<f64>,
}

/// Draws the timeline of a run of a scene to a PNG file.
///
/// # Errors
/// The picture cannot be drawn or written.
pub fn draw_timeline(scene: &Scene, timeline: &Timeline, path: &Path) -> Result<(), OutputError> {
    let rows = rows(timeline);
    let tracks = timeline.tracks.len();
    let table = HEAD + tracks as i32 * TRACK + AXIS;
    let width = WIDTH.max(MARGIN * 2 + block_width(tracks));
    let height = table + ROW * ((rows.len() + 1).div_ceil(blocks(tracks)) as i32 + 3);
    let mut canvas = Canvas::new((width * OVERSAMPLING) as u32, (height * OVERSAMPLING) as u32);
    canvas
        .draw(|area| {
            write(area, &title(scene), [width / 2, HEAD / 2], 20, HPos::Center, INK)?;
            draw_tracks(area, timeline, &rows, width)?;
            draw_table(area, timeline, &rows, table)
        })
        .map_err(|e| OutputError::Picture { path: path.into(), reason: e.to_string() })?;
    canvas.halved().save(path)
}

fn write(area: &Area<'_>, text: &str, [x, y]: [i32; 2], size: i32, at: HPos, color: RGBColor) -> Drawn {
    let style = (FONT, size * OVERSAMPLING).into_font().color(&color).pos(Pos::new(at, VPos::Center));
    Ok(area.draw(&Text::new(text.to_owned(), (x * OVERSAMPLING, y * OVERSAMPLING), style))?)
}

/// A filled rectangle; a fraction of a pixel counts.
fn fill(area: &Area<'_>, [x0, x1]: [f64; 2], [y0, y1]: [i32; 2], color: RGBColor) -> Drawn {
    let scale = f64::from(OVERSAMPLING);
    let corners =
        [((x0 * scale).round() as i32, y0 * OVERSAMPLING), ((x1 * scale).round() as i32, y1 * OVERSAMPLING)];
    Ok(area.draw(&Rectangle::new(corners, color.filled()))?)
}

/// Phases of one category, the largest first, in the order of the categories.
fn rows(timeline: &Timeline) -> Vec<Row> {
    let all: Vec<Vec<Share>> = timeline.tracks.iter().map(Track::shares).collect();
    let mut rows = Vec::new();
    for (category, colors) in
        [("compute", &COMPUTE[..]), ("wait", &WAIT), ("message", &MESSAGE), ("output", &OUTPUT)]
    {
        let mut own: Vec<(String, Vec<f64>)> = Vec::new();
        for (track, shares) in all.iter().enumerate() {
            for share in shares.iter().filter(|share| share.category == category) {
                let place = own.iter().position(|(name, _)| *name == share.name).unwrap_or_else(|| {
                    own.push((share.name.clone(), vec![0.0; all.len()]));
                    own.len() - 1
                });
                own[place].1[track] += share.share;
            }
        }
        let largest = |shares: &[f64]| shares.iter().copied().fold(0.0, f64::max);
        own.sort_by(|a, b| largest(&b.1).total_cmp(&largest(&a.1)));
        own.retain(|(_, shares)| largest(shares) >= SMALLEST_SHARE);
        let colors = colors.iter().cycle();
        rows.extend(own.into_iter().zip(colors).map(|((name, shares), color)| Row {
            name,
            color: *color,
            shares,
        }));
    }
    rows
}

/// Beginning and end of two steps in the middle, µs; `None` where no half-step was recorded.
fn middle(timeline: &Timeline) -> Option<([f64; 2], [u64; 2])> {
    let (first, last) = timeline.steps()?;
    let step = (first + last) / 2;
    let steps = [step, (step + 1).min(last)];
    let spans = || timeline.tracks.iter().flat_map(|track| &track.spans).filter(|s| s.category == HALF_STEP);
    let start = spans().filter(|span| span.step == steps[0]).map(|span| span.start).reduce(f64::min)?;
    let end = spans().filter(|span| span.step == steps[1]).map(Span::end).reduce(f64::max)?;
    Some(([start, end], steps))
}

fn draw_tracks(area: &Area<'_>, timeline: &Timeline, rows: &[Row], width: i32) -> Drawn {
    let Some(([start, end], steps)) = middle(timeline) else { return Ok(()) };
    let (left, right) = (f64::from(MARGIN + NAMES), f64::from(width - MARGIN));
    let place = |time: f64| left + (right - left) * ((time - start) / (end - start)).clamp(0.0, 1.0);
    for (k, track) in timeline.tracks.iter().enumerate() {
        let top = HEAD + k as i32 * TRACK;
        let (high, low) = (top + 4, top + TRACK - 6);
        let (process, number) = &track.process;
        let named = if *process == track.name { String::new() } else { format!(", {process}") };
        let process = format!("process {number}{named}");
        write(area, &track.name, [MARGIN, top + TRACK / 2 - 8], 15, HPos::Left, INK)?;
        write(area, &process, [MARGIN, top + TRACK / 2 + 9], 11, HPos::Left, INK)?;
        fill(area, [left, right], [high, low], RGBColor(250, 250, 250))?;
        // What lies within a span follows it, and is drawn over it.
        for span in track.spans.iter().filter(|span| span.end() > start && span.start < end) {
            let at = [place(span.start), place(span.end())];
            if span.category == HALF_STEP {
                continue;
            }
            let name = span.label();
            let Some(row) = rows.iter().find(|row| row.name == name) else { continue };
            fill(area, at, [high, low], row.color)?;
            let light =
                [&WAIT[..], &MESSAGE[1..2], &COMPUTE[3..4], &COMPUTE[5..6]].concat().contains(&row.color);
            if at[1] - at[0] > 7.0 * span.name.chars().count() as f64 + 6.0 {
                let middle = [(0.5 * (at[0] + at[1])) as i32, (high + low) / 2];
                let ink = if light { INK } else { WHITE };
                write(area, &span.name, middle, 11, HPos::Center, ink)?;
            }
        }
        for span in track.spans.iter().filter(|span| span.category == HALF_STEP && span.end() <= end) {
            if span.start >= start {
                let x = place(span.start);
                fill(area, [x, x + 1.0], [high - 3, low + 3], INK)?;
            }
        }
    }
    let base = HEAD + timeline.tracks.len() as i32 * TRACK;
    let step = units::tick_step((end - start) / 10.0);
    for k in 0..=((end - start) / step) as usize {
        let time = k as f64 * step;
        let x = place(start + time);
        fill(area, [x, x + 1.0], [base, base + 5], INK)?;
        write(area, &units::number(time * 1e-3), [x as i32, base + 14], 12, HPos::Center, INK)?;
    }
    let told = format!(
        "time [ms] in steps {} and {}, two half-steps each; a black line is where a half-step begins",
        steps[0], steps[1]
    );
    write(area, &told, [(left + right) as i32 / 2, base + 33], 13, HPos::Center, INK)
}

fn draw_table(area: &Area<'_>, timeline: &Timeline, rows: &[Row], top: i32) -> Drawn {
    let tracks = timeline.tracks.len();
    let named = |track: usize| rows.iter().map(|row| row.shares[track]).sum::<f64>();
    let shares = (0..tracks).map(|track| 1.0 - named(track)).collect();
    let rest = Row { name: "everything else".into(), color: WHITE, shares };
    let all: Vec<&Row> = rows.iter().chain([&rest]).collect();
    let (first, last) = timeline.steps().unwrap_or_default();
    let told = format!("steps {first} to {last}: share of time");
    for (block, rows) in all.chunks(all.len().div_ceil(blocks(tracks)).max(1)).enumerate() {
        let left = MARGIN + block as i32 * (block_width(tracks) + GAP);
        let column = |k: usize| left + PHASES + (k as i32 + 1) * COLUMN;
        write(area, &told, [left, top + ROW], 14, HPos::Left, INK)?;
        for (k, track) in timeline.tracks.iter().enumerate() {
            write(area, &track.name, [column(k), top + ROW], 14, HPos::Right, INK)?;
        }
        let line = top + ROW + ROW / 2 + 1;
        fill(area, [left, left + block_width(tracks)].map(f64::from), [line, line + 1], FAINT)?;
        for (k, row) in rows.iter().enumerate() {
            let y = top + (k as i32 + 2) * ROW + 4;
            fill(area, [left, left + 22].map(f64::from), [y - 7, y + 7], row.color)?;
            write(area, &row.name, [left + 32, y], 13, HPos::Left, INK)?;
            for (k, share) in row.shares.iter().enumerate().filter(|(_, share)| **share >= SMALLEST_SHARE) {
                write(area, &format!("{:.1} %", 100.0 * share), [column(k), y], 13, HPos::Right, INK)?;
            }
        }
    }
    Ok(())
}

/// Width of the table of so many tracks, pixels.
fn block_width(tracks: usize) -> i32 {
    PHASES + tracks as i32 * COLUMN
}

/// How often it stands beside itself.
fn blocks(tracks: usize) -> usize {
    if 2 * (block_width(tracks) + MARGIN) + GAP <= WIDTH { 2 } else { 1 }
}
