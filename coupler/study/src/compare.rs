//! `halfstep compare`: one scene with different solids, built-in models and other people's programs: a table and a
//! picture.

use super::candidate::Candidate;
use super::chart::{Axis, Chart, Entry, Mark, Scale, legend, legend_height, linear_axis, px, stroke};
use super::error::StudyError;
use super::pictures::{HEAD, picture};
use super::report::{aligned, short};
use halfstep_output::probes::split_unit;
use halfstep_output::run_json::RunStatus;
use halfstep_output::{OutputError, RunReport, Table, atomic};
use halfstep_scene::Scene;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Size of the picture's chart, pixels.
const CHART: (i32, i32) = (1000, 520);

/// A run of a solid.
#[derive(Clone, Debug)]
pub struct Ran {
    /// The solid.
    pub solid: Candidate,
    /// Folder of its run.
    pub folder: PathBuf,
    /// How it went.
    pub report: RunReport,
    /// Its probes, where there are any.
    pub table: Option<Table>,
    /// What was left out of the scene for it; empty where nothing was.
    pub note: String,
    /// Largest stable sub-step in its first state, s; `None` of programs.
    pub stable_step: Option<f64>,
}

/// What came of a solid.
#[derive(Clone, Debug, Serialize)]
pub struct Compared {
    /// What it is called.
    pub name: String,
    /// The solid.
    pub solid: Candidate,
    /// How its run ended.
    pub status: Option<RunStatus>,
    /// Why it did not finish.
    pub error: Option<String>,
    /// Largest absolute value of the curve, with its sign, in the probe's unit.
    pub peak: Option<f64>,
    /// Its time, s.
    pub peak_time: Option<f64>,
    /// Distance to the curve of each solid, in their order: root of the mean square of the difference over the time
    /// that both have, over the largest absolute value of the first solid's curve.
    pub distance: Vec<Option<f64>>,
    /// Wall time, s.
    pub wall_seconds: f64,
    /// Steps.
    pub steps: u64,
    /// Mean time step, s.
    pub time_step: Option<f64>,
    /// Largest stable sub-step of the solid in its first state, s; `None` of programs, which do not tell.
    pub stable_step: Option<f64>,
    /// What was left out of the scene for it; empty where nothing was.
    pub note: String,
    /// Largest number of the solid's sub-steps in a step; 1 for programs that do not tell.
    pub sub_steps: Option<u32>,
    /// Energy of fluid and solid that nothing explains, over the energy in play: fluid, solid. The solid's is
    /// not known of programs.
    pub energy_growth: [Option<f64>; 2],
    /// Folder of its run.
    pub folder: PathBuf,
    /// Points (time s, value).
    #[serde(skip)]
    pub curve: Vec<(f64, f64)>,
}

/// The comparison.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// The scene's name.
    pub scene: String,
    /// Header of the column of probes.csv that is compared.
    pub probe: String,
    /// The solids, in the order of the command line.
    pub solids: Vec<Compared>,
}

/// The column that is compared where the command line names none: the first metric's, else the first of all.
pub fn default_probe(scene: &Scene) -> Option<String> {
    let of_metric = scene.metrics.first().map(|metric| metric.probe.clone());
    let first = || scene.probes.first()?.columns(scene.dimension).first().cloned();
    of_metric.or_else(first)
}

/// Root of the mean square of the difference of two curves over the time that both have.
fn distance(a: &[(f64, f64)], b: &[(f64, f64)]) -> Option<f64> {
    if b.len() < 2 {
        return None;
    }
    let end = a.last()?.0.min(b.last()?.0) * (1.0 + 1e-12);
    let at = |t: f64| {
        let k = b.partition_point(|p| p.0 < t).clamp(1, b.len() - 1);
        let [(t0, x0), (t1, x1)] = [*b.get(k - 1)?, *b.get(k)?];
        Some(if t1 > t0 { x0 + (t - t0) / (t1 - t0) * (x1 - x0) } else { x1 })
    };
    let squares: Vec<f64> = a
        .iter()
        .filter(|(t, x)| *t <= end && x.is_finite())
        .filter_map(|(t, x)| Some((x - at(*t)?).powi(2)))
        .filter(|square| square.is_finite())
        .collect();
    (squares.len() > 1).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// Sub-steps, and energy from nowhere, of the solid in a place among the scene's. A run that failed tells of all solids
/// together.
fn told_of(scene: &Scene, of: usize, report: &RunReport) -> (Option<u32>, Option<f64>) {
    let name = &scene.solids[of].name;
    match report.participants.iter().find(|participant| participant.name == *name) {
        Some(own) => (own.sub_steps, own.energy_growth),
        None if scene.solids.len() == 1 => (report.sub_steps, report.audit.energy_growth.solid),
        None => (None, None),
    }
}

impl Compared {
    /// How far the curve goes, where its run did not finish: a short one lies near any other.
    fn until(&self) -> String {
        let end = self.curve.last().filter(|_| self.status != Some(RunStatus::Finished));
        end.map_or(String::new(), |end| format!(" until {} s", short(end.0)))
    }
}

impl Comparison {
    /// From the runs of the solids in the place `of` among the scene's: report, and probes where there are any.
    ///
    /// # Errors
    /// A run has probes, and the one that is compared is not among them.
    pub fn new(scene: &Scene, probe: &str, of: usize, runs: Vec<Ran>) -> Result<Self, StudyError> {
        let mut header = probe.to_owned();
        let mut solids = Vec::new();
        for Ran { solid, folder, report, table, note, stable_step } in runs {
            let mut curve = Vec::new();
            if let Some(table) = table {
                let place = table.position(probe).ok_or_else(|| {
                    let known: Vec<&str> = table.columns[1..].iter().map(|c| split_unit(c).0).collect();
                    StudyError::Usage(format!("--probe {probe}: the scene has {}", known.join(", ")))
                })?;
                header.clone_from(&table.columns[place]);
                curve = table.rows.iter().map(|row| (row[0], row[place])).collect();
            }
            let finite = curve.iter().copied().filter(|p: &(f64, f64)| p.1.is_finite());
            let peak = finite.reduce(|a, b| if b.1.abs() > a.1.abs() { b } else { a });
            let (sub_steps, growth) = told_of(scene, of, &report);
            solids.push(Compared {
                name: solid.name().into(),
                energy_growth: [report.audit.energy_growth.fluid, growth],
                status: report.status,
                error: report.error,
                peak: peak.map(|p| p.1),
                peak_time: peak.map(|p| p.0),
                distance: Vec::new(),
                wall_seconds: report.wall_seconds,
                steps: report.steps,
                time_step: report.dt.mean,
                stable_step,
                note,
                sub_steps,
                solid,
                folder,
                curve,
            });
        }
        let scale = solids.first().and_then(|first| first.peak).map(f64::abs).filter(|scale| *scale > 0.0);
        let curves: Vec<Vec<(f64, f64)>> = solids.iter().map(|solid| solid.curve.clone()).collect();
        for (solid, own) in solids.iter_mut().zip(&curves) {
            let to = |other: &Vec<(f64, f64)>| Some(distance(own, other)? / scale?);
            solid.distance = curves.iter().map(to).collect();
        }
        Ok(Self { scene: scene.name.clone(), probe: header, solids })
    }

    /// The table.
    pub fn text(&self) -> String {
        let (name, unit) = split_unit(&self.probe);
        let peak = if unit.is_empty() { format!("peak {name}") } else { format!("peak {name} [{unit}]") };
        let first = self.solids.first().map_or("", |first| first.name.as_str());
        let titles = [
            "solid",
            &peak,
            "at [s]",
            &format!("distance to {first}"),
            "wall time [s]",
            "steps",
            "mean step [s]",
            "stable step [s]",
            "sub-steps",
            "energy from nowhere",
        ];
        let mut table = vec![titles.map(String::from).to_vec()];
        let number = |n: Option<f64>| n.map_or("-".to_owned(), short);
        for solid in &self.solids {
            let growth = solid.energy_growth.iter().flatten().copied().reduce(f64::max);
            table.push(vec![
                solid.name.clone(),
                number(solid.peak),
                number(solid.peak_time),
                solid
                    .distance
                    .first()
                    .copied()
                    .flatten()
                    .map_or("-".into(), |d| format!("{:.2} %{}", 100.0 * d, solid.until())),
                short(solid.wall_seconds),
                solid.steps.to_string(),
                number(solid.time_step),
                number(solid.stable_step),
                solid.sub_steps.map_or("-".into(), |k| k.to_string()),
                number(growth),
            ]);
        }
        let mut text = aligned(&table);
        for solid in self.solids.iter().filter(|solid| !solid.note.is_empty()) {
            text.push_str(&format!("{}: {}\n", solid.name, solid.note));
        }
        for solid in &self.solids {
            if let Some(error) = &solid.error {
                text.push_str(&format!("{}: {error}\n", solid.name));
            }
        }
        text
    }

    /// As JSON.
    ///
    /// # Errors
    /// None that is known.
    pub fn json(&self) -> Result<String, StudyError> {
        serde_json::to_string_pretty(self).map_err(|e| StudyError::System(e.to_string()))
    }

    /// Writes `compare.json` and `compare.png`, the latter with the scene's references.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, scene: &Scene, folder: &Path) -> Result<(), StudyError> {
        atomic::replace_bytes(&folder.join("compare.json"), format!("{}\n", self.json()?).as_bytes())?;
        Ok(self.draw(scene, &folder.join("compare.png"))?)
    }

    fn draw(&self, scene: &Scene, path: &Path) -> Result<(), OutputError> {
        let (name, unit) = split_unit(&self.probe);
        let end = self.solids.iter().filter_map(|s| s.curve.last()).map(|p| p.0).fold(0.0, f64::max);
        let of_probe = |r: &&halfstep_scene::Reference| r.probe == name;
        let visible = |points: &Vec<[f64; 2]>| -> Vec<(f64, f64)> {
            points.iter().map(|p| (p[0], p[1])).filter(|p| p.0 <= end).collect()
        };
        let references: Vec<(String, Vec<(f64, f64)>)> =
            scene.references.iter().filter(of_probe).map(|r| (r.label.clone(), visible(&r.points))).collect();
        let drawn = self.solids.iter().filter(|solid| !solid.curve.is_empty());
        let curves = drawn.map(|solid| (solid.name.clone(), solid.curve.clone()));
        let series: Vec<(String, Vec<(f64, f64)>)> = curves.chain(references.iter().cloned()).collect();
        let own = series.len() - references.len();
        let points = || series.iter().flat_map(|(_, points)| points.iter().copied());
        let (Some(x), Some(y)) = (linear_axis(points().map(|p| p.0)), linear_axis(points().map(|p| p.1)))
        else {
            return Ok(());
        };
        let entry = |(k, (name, _)): (usize, &(String, _))| Entry {
            name: name.clone(),
            mark: Mark::of(k),
            filled: k < own,
        };
        let entries: Vec<Entry> = series.iter().enumerate().map(entry).collect();
        let label = |value: f64| short((value * 1e12).round() / 1e12);
        let size = (CHART.0, HEAD + CHART.1 + legend_height(&entries, CHART.0));
        picture(path, size, &format!("{} · {name}", self.scene), |area| {
            let (above, below) = area.split_vertically(px(CHART.1));
            let titled = |title: String, range| Axis { range, title, label: &label, scale: Scale::Linear };
            let y_title = if unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") };
            let chart = Chart::new(&above, "", [titled("time [s]".into(), x), titled(y_title, y)])?;
            for (k, (_, points)) in series.iter().enumerate() {
                let mark = Mark::of(k);
                let finite: Vec<_> = points.iter().copied().filter(|p| p.1.is_finite()).collect();
                if k < own {
                    chart.line(&finite, stroke(mark.color, width(k, own)))?;
                } else {
                    finite.iter().try_for_each(|point| chart.mark(*point, mark, false))?;
                }
            }
            legend(&below, &entries)
        })
    }
}

/// Width of the k-th of several curves, pixels: the later are narrower, so that those below them are seen.
fn width(k: usize, curves: usize) -> i32 {
    let step = if curves <= 3 { 2 } else { 1 };
    2 + step * (curves - 1 - k) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn later_curves_are_narrower() {
        assert_eq!([0, 1].map(|k| width(k, 2)), [4, 2]);
        assert_eq!([0, 1, 2, 3, 4].map(|k| width(k, 5)), [6, 5, 4, 3, 2]);
    }

    #[test]
    fn distances_are_of_curves_and_not_of_rows() {
        let line = |n: usize, offset: f64| -> Vec<(f64, f64)> {
            (0..=n).map(|k| (k as f64 / n as f64, k as f64 / n as f64 + offset)).collect()
        };
        assert!((distance(&line(10, 0.0), &line(7, 0.25)).unwrap() - 0.25).abs() < 1e-12);
        assert_eq!(distance(&line(10, 0.0), &[]), None);
        // A run that failed in its first step left one row.
        assert_eq!(distance(&line(10, 0.0), &[(0.0, 0.0)]), None);
        assert_eq!(distance(&[(0.0, 0.0)], &line(10, 0.0)), None);
        // A run that ended early is compared as far as it went.
        let half: Vec<_> = line(10, 0.1).into_iter().filter(|p| p.0 < 0.51).collect();
        assert!((distance(&line(10, 0.0), &half).unwrap() - 0.1).abs() < 1e-12);
    }
}
