//! What a study's numbers look like: error over cost, error over resolution, and where the time went.

use super::chart::{
    Axis, Chart, Entry, Mark, Scale, Shape, axis, color, font, legend, legend_height, px, stroke, write,
};
use super::report::{Study, readable, short};
use super::result::{MetricResult, Row};
use halfstep_output::OutputError;
use halfstep_output::pictures::canvas::{Area, Canvas, Drawn};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

/// Height of a picture's heading, pixels.
pub(super) const HEAD: i32 = 44;
/// Width and height of a panel, pixels.
pub(super) const PANEL: (i32, i32) = (620, 400);
/// Width of a panel of the convergence, pixels.
const WIDE: i32 = 860;
/// Height of a bar of the time's shares, with its distance to the next, pixels.
const BAR: (i32, i32) = (24, 34);
const FRONT: RGBColor = RGBColor(170, 170, 170);
const HOLLOW: Mark = Mark { color: RGBColor(120, 120, 120), shape: Shape::Circle };

/// Draws `work-precision.png`, `convergence.png` and `time-share.png`.
///
/// # Errors
/// A picture cannot be drawn or written.
pub fn draw(study: &Study, folder: &Path) -> Result<(), OutputError> {
    let metrics = study.metrics.len();
    let heading = |what: &str| format!("{} · {what}", study.scene);
    let panels = metrics as i32 * PANEL.1;
    let entries = entries(study, "hollow: another run is as cheap and better");
    let width = 2 * PANEL.0;
    let size = (width, HEAD + panels + legend_height(&entries, width));
    picture(&folder.join("work-precision.png"), size, &heading("what accuracy costs"), |area| {
        let (charts, below) = area.split_vertically(px(panels));
        for (panel, metric) in charts.split_evenly((metrics, 2)).chunks(2).zip(&study.metrics) {
            work_precision(&panel[0], study, metric, Cost::Time)?;
            work_precision(&panel[1], study, metric, Cost::Work)?;
        }
        legend(&below, &entries)
    })?;
    let entries = self::entries(study, "hollow: error against the finest runs");
    let size = (WIDE, HEAD + panels + legend_height(&entries, WIDE));
    picture(&folder.join("convergence.png"), size, &heading("convergence"), |area| {
        let (charts, below) = area.split_vertically(px(panels));
        for (panel, metric) in charts.split_evenly((metrics, 1)).iter().zip(&study.metrics) {
            convergence(panel, study, metric)?;
        }
        legend(&below, &entries)
    })?;
    let size = (900, HEAD + 60 + BAR.1 * study.rows.len() as i32);
    picture(&folder.join("time-share.png"), size, &heading("where the time goes"), |area| shares(area, study))
}

pub(super) fn picture(
    path: &Path,
    (width, height): (i32, i32),
    title: &str,
    draw: impl FnOnce(&Area<'_>) -> Drawn,
) -> Result<(), OutputError> {
    let mut canvas = Canvas::new(px(width) as u32, px(height) as u32);
    let drawn = canvas.draw(|area| {
        let (head, below) = area.split_vertically(px(HEAD));
        write(&head, title, (px(width) / 2, px(HEAD) / 2), 20, (HPos::Center, VPos::Center))?;
        draw(&below)
    });
    drawn.map_err(|e| OutputError::Picture { path: path.into(), reason: e.to_string() })?;
    canvas.halved().save(path)
}

#[derive(Clone, Copy, PartialEq)]
enum Cost {
    Time,
    Work,
}

impl Cost {
    fn of(self, row: &Row) -> f64 {
        match self {
            Self::Time => row.seconds(),
            Self::Work => row.pair_evaluations.map_or(f64::NAN, |w| w as f64),
        }
    }
}

fn nothing(area: &Area<'_>, name: &str) -> Drawn {
    let text = format!("{name}: no run has an error to show");
    write(area, &text, (px(30), px(40)), 14, (HPos::Left, VPos::Center))
}

/// The sets of choices beside the resolution, in the order of the rows.
fn families(rows: &[Row]) -> Vec<&Vec<String>> {
    let mut families: Vec<&Vec<String>> = Vec::new();
    for row in rows {
        if !families.contains(&&row.choices) {
            families.push(&row.choices);
        }
    }
    families
}

fn family_name(choices: &[String]) -> String {
    if choices.is_empty() { "as in the scene".into() } else { readable(&choices.join(" ")) }
}

/// The legend of all panels: a mark for each set of choices, and what hollow marks say.
fn entries(study: &Study, hollow: &str) -> Vec<Entry> {
    let families = families(&study.rows);
    let family = |(k, choices): (usize, &&Vec<String>)| Entry {
        name: family_name(choices),
        mark: Mark::of(k),
        filled: true,
    };
    let mut entries: Vec<Entry> = families.iter().enumerate().map(family).collect();
    entries.push(Entry { name: hollow.into(), mark: HOLLOW, filled: false });
    entries
}

fn error_label(error: f64) -> String {
    format!("{} %", tick(100.0 * error))
}

fn work_precision(area: &Area<'_>, study: &Study, metric: &MetricResult, cost: Cost) -> Drawn {
    let error = |k: usize| metric.shown(&metric.errors[k]).filter(|e| *e > 0.0);
    let point = |k: usize| error(k).map(|e| (cost.of(&study.rows[k]), e)).filter(|p| p.0.is_finite());
    let all = || (0..study.rows.len()).filter_map(point);
    let (Some(x), Some(y)) = (axis(all().map(|p| p.0)), axis(all().map(|p| p.1))) else {
        return nothing(area, &metric.name);
    };
    let (title, label): (_, &dyn Fn(f64) -> String) = match cost {
        Cost::Time => ("wall time [s]", &tick),
        Cost::Work => ("pair evaluations", &|v| format!("{v:.1e}").replace(".0e", "e")),
    };
    let on_front = |k: usize| match cost {
        Cost::Time => metric.errors[k].front_time,
        Cost::Work => metric.errors[k].front_work,
    };
    let families = families(&study.rows);
    let heading = format!("{}: {}", metric.name, Study::against(metric));
    let axes = [
        Axis { range: x, title: title.into(), label, scale: Scale::Logarithm },
        Axis { range: y, title: "relative error".into(), label: &error_label, scale: Scale::Logarithm },
    ];
    let chart = Chart::new(area, &heading, axes)?;
    let mut front: Vec<_> = (0..study.rows.len()).filter(|k| on_front(*k)).filter_map(point).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    chart.line(&front, stroke(FRONT, 2))?;
    for (k, row) in study.rows.iter().enumerate() {
        let Some(p) = point(k) else { continue };
        let mark = Mark::of(families.iter().position(|f| **f == row.choices).unwrap_or(0));
        let (shortest, longest) = row.spread();
        if cost == Cost::Time && longest > shortest {
            chart.line(&[(shortest, p.1), (longest, p.1)], stroke(mark.color, 1))?;
        }
        chart.mark(p, mark, on_front(k))?;
    }
    // Spacings: of the runs on the front first, where room is short.
    let (first, then): (Vec<usize>, Vec<usize>) = (0..study.rows.len()).partition(|k| on_front(*k));
    for k in first.into_iter().chain(then) {
        let Some(p) = point(k) else { continue };
        chart.note(p, &format!("{} m", short(study.rows[k].resolution).trim_end_matches('0')))?;
    }
    Ok(())
}

fn tick(value: f64) -> String {
    match value {
        v if !(1e-4..1e5).contains(&v) => format!("{v:.0e}"),
        v => ((v * 1e6).round() / 1e6).to_string(),
    }
}

fn convergence(area: &Area<'_>, study: &Study, metric: &MetricResult) -> Drawn {
    let shown = |k: usize| metric.shown(&metric.errors[k]).filter(|e| *e > 0.0);
    // Where the errors shown are those against the finest, they are not drawn twice.
    let finest = |k: usize| metric.errors[k].finest.filter(|e| *e > 0.0 && Some(*e) != shown(k));
    let all = || (0..study.rows.len()).flat_map(|k| [shown(k), finest(k)]).flatten();
    let spacings = study.rows.iter().map(|row| row.resolution);
    let (Some(x), Some(y)) = (axis(spacings), axis(all())) else { return nothing(area, &metric.name) };
    let verdict = metric.largest_group().map_or(String::new(), |group| group.convergence.verdict());
    let families = families(&study.rows);
    let mut curves = Vec::new();
    for (family, choices) in families.iter().enumerate() {
        for (filled, error) in [(true, &shown as &dyn Fn(usize) -> Option<f64>), (false, &finest)] {
            let of_family = (0..study.rows.len()).filter(|k| study.rows[*k].choices == **choices);
            let mut points: Vec<_> =
                of_family.filter_map(|k| Some((study.rows[k].resolution, error(k)?))).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            curves.push((points, Mark::of(family), filled));
        }
    }
    let axes = [
        Axis { range: x, title: "particle spacing [m]".into(), label: &tick, scale: Scale::Logarithm },
        Axis { range: y, title: "relative error".into(), label: &error_label, scale: Scale::Logarithm },
    ];
    let heading = format!("{}: {} · {verdict}", metric.name, Study::against(metric));
    let chart = Chart::new(area, &heading, axes)?;
    for (points, mark, filled) in curves {
        chart.line(&points, stroke(mark.color, if filled { 2 } else { 1 }))?;
        for point in points {
            chart.mark(point, mark, filled)?;
        }
    }
    Ok(())
}

/// Parts of a run's time with their names: effects where their shares are known, else what the processes did.
fn parts(row: &Row) -> Vec<(String, f64)> {
    let of_effects: Vec<_> = row.effects.iter().filter_map(|e| Some((e.name.clone(), e.share?))).collect();
    if !of_effects.is_empty() {
        return of_effects;
    }
    let roles = [("fluid", row.roles.fluid), ("solid", row.roles.solid), ("coupler", row.roles.coupler)];
    let of_role =
        roles.into_iter().filter_map(|(name, seconds)| Some((name, seconds?))).flat_map(|(name, s)| {
            let parts =
                [("compute", s.compute), ("wait", s.wait), ("exchange", s.exchange), ("output", s.output)];
            parts.map(|(part, seconds)| (format!("{name} {part}"), seconds))
        });
    let parts: Vec<_> = of_role.filter(|(_, seconds)| *seconds > 0.0).collect();
    let total: f64 = parts.iter().map(|p| p.1).sum();
    parts.into_iter().map(|(name, seconds)| (name, seconds / total)).collect()
}

fn shares(area: &Area<'_>, study: &Study) -> Drawn {
    let (left, right) = (px(250), area.dim_in_pixel().0 as i32 - px(20));
    let rectangle = |corners: [(i32, i32); 2], index: usize| -> Drawn {
        Ok(area.draw(&Rectangle::new(corners, color(index).filled())).map_err(|e| e.to_string())?)
    };
    let mut names: Vec<String> = Vec::new();
    for (k, row) in study.rows.iter().enumerate() {
        let y = px(44 + BAR.1 * k as i32);
        let middle = y + px(BAR.0) / 2;
        write(area, &readable(&row.label), (left - px(8), middle), 12, (HPos::Right, VPos::Center))?;
        let mut from = 0.0;
        for (name, share) in parts(row) {
            let index = names.iter().position(|n| *n == name).unwrap_or(names.len());
            if index == names.len() {
                names.push(name);
            }
            let x = |part: f64| left + (part * f64::from(right - left)) as i32;
            let [start, end] = [x(from), x(from + share)];
            rectangle([(start, y), (end, y + px(BAR.0))], index)?;
            if share > 0.06 {
                let style = font(11).color(&WHITE).pos(Pos::new(HPos::Center, VPos::Center));
                let text = format!("{:.0} %", 100.0 * share);
                area.draw(&Text::new(text, ((start + end) / 2, middle), style)).map_err(|e| e.to_string())?;
            }
            from += share;
        }
    }
    let mut x = px(20);
    for (k, name) in names.iter().enumerate() {
        rectangle([(x, px(14)), (x + px(12), px(26))], k)?;
        write(area, name, (x + px(17), px(20)), 12, (HPos::Left, VPos::Center))?;
        x += px(34 + 7 * name.len() as i32);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::result::tests::row;
    use super::*;
    use halfstep_output::run_json::{EffectReport, RoleSeconds, Roles};

    #[test]
    fn time_goes_to_effects_where_that_is_known() {
        let mut row = row(1.0, &[], 1.0, 1.0);
        let of_fluid = RoleSeconds { compute: 3.0, output: 1.0, ..RoleSeconds::default() };
        row.roles = Roles { fluid: Some(of_fluid), ..Roles::default() };
        assert_eq!(parts(&row), [("fluid compute".into(), 0.75), ("fluid output".into(), 0.25)]);
        row.effects =
            vec![EffectReport { name: "walls".into(), share: Some(0.3), ..EffectReport::default() }];
        assert_eq!(parts(&row), [("walls".into(), 0.3)]);
    }

    #[test]
    fn ticks_are_short() {
        assert_eq!([0.3, 20.0, 1e6, 2e-5].map(tick), ["0.3", "20", "1e6", "2e-5"]);
    }
}
