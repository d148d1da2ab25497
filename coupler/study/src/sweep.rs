//! Parameter studies: the metrics' numbers over physical keys. Nothing here is an error of anything.

use super::chart::{Axis, Chart, Entry, Mark, Scale, legend, legend_height, linear_axis, px, stroke};
use super::error::StudyError;
use super::pictures::{HEAD, PANEL, picture};
use super::report::{Study, aligned, short};
use halfstep_output::run_json::RunStatus;
use halfstep_output::{OutputError, atomic};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// First parts of keys that change how a scene is computed.
const NUMERICAL: [&str; 8] =
    ["resolution", "smoothing_ratio", "time_step", "preset", "numerics", "effects", "output", "interface"];
/// The same within `[fluid]`, a solid and a shape.
const NUMERICAL_PARTS: [&str; 17] = [
    "sound_speed",
    "artificial_viscosity",
    "artificial_stress",
    "density_diffusion",
    "density_diffusion_coefficient",
    "background_pressure",
    "smoothing_ratio",
    "sub_steps",
    "time_integration",
    "hourglass",
    "model",
    "threads",
    "across",
    "spacing",
    "arrangement",
    "arrangement_seed",
    "lattice_angle",
];

/// Whether a key changes what is computed and not how: another material, another place, a parameter.
pub fn is_physical(key: &str) -> bool {
    let mut parts = key.split('.');
    let first = parts.next().unwrap_or_default();
    let inner =
        ["fluid", "solid", "shape"].contains(&first) && parts.any(|part| NUMERICAL_PARTS.contains(&part));
    !NUMERICAL.contains(&first) && !inner
}

/// What a study says where its ladder has physical keys.
pub fn warning(key: &str) -> String {
    format!(
        "--vary {key} changes what is computed and not how: differences between these runs are no numerical error \
         (--sweep {key}=A,B,C makes a parameter study)"
    )
}

/// A parameter study that is done.
#[derive(Clone, Debug, Serialize)]
pub struct Sweep {
    /// The scene's name.
    pub scene: String,
    /// The keys that were changed.
    pub keys: Vec<String>,
    /// The metrics' names and units.
    pub metrics: Vec<Measured>,
    /// The runs.
    pub rows: Vec<SweepRow>,
    /// What else is to be said of them.
    pub notes: Vec<String>,
}

/// Keys that change none of the numbers.
fn idle(keys: &[String], rows: &[SweepRow]) -> Vec<String> {
    let measured: Vec<&SweepRow> =
        rows.iter().filter(|row| row.numbers.iter().any(Option::is_some)).collect();
    let bits = |row: &SweepRow| row.numbers.iter().map(|n| n.map(f64::to_bits)).collect::<Vec<_>>();
    let is_idle = |key: &usize| {
        let differ = |one: &SweepRow, other: &SweepRow| {
            (0..keys.len()).all(|k| (one.values[k] == other.values[k]) != (k == *key))
        };
        let pairs = measured
            .iter()
            .enumerate()
            .flat_map(|(k, one)| measured[k + 1..].iter().map(move |o| (*one, *o)));
        let mut pairs = pairs.filter(|(one, other)| differ(one, other)).peekable();
        pairs.peek().is_some() && pairs.all(|(one, other)| bits(one) == bits(other))
    };
    let said =
        |key: usize| format!("{} changes none of these numbers: they agree to the last bit", keys[key]);
    (0..keys.len()).filter(is_idle).map(said).collect()
}

/// A number that was taken from each run.
#[derive(Clone, Debug, Serialize)]
pub struct Measured {
    /// The metric's name.
    pub name: String,
    /// Its unit.
    pub unit: String,
}

/// A run.
#[derive(Clone, Debug, Serialize)]
pub struct SweepRow {
    /// Value of each key, as after `--set KEY=`.
    pub values: Vec<String>,
    /// The metrics' numbers; `None` where the run's curve does not hold one.
    pub numbers: Vec<Option<f64>>,
    /// How the run ended.
    pub status: Option<RunStatus>,
    /// What was wrong with the run, or with a number.
    pub error: Option<String>,
    /// Wall time, s.
    pub wall_seconds: f64,
    /// Folders of the run and its repetitions.
    pub folders: Vec<PathBuf>,
}

impl Sweep {
    /// Of the runs of a study over these keys.
    pub fn of(study: &Study, keys: Vec<String>) -> Self {
        let row = |row: &super::result::Row| {
            let value = |key: &String| {
                let mut set = row.changes.iter().rev().filter_map(|change| change.split_once('='));
                set.find(|(name, _)| name == key).map_or(String::new(), |(_, value)| value.to_owned())
            };
            let unmeasured = row.values.iter().find_map(|value| value.as_ref().err());
            SweepRow {
                values: keys.iter().map(value).collect(),
                numbers: row.values.iter().map(|value| value.as_ref().ok().copied()).collect(),
                status: row.status,
                error: row.error.clone().or_else(|| unmeasured.map(ToString::to_string)),
                wall_seconds: row.seconds(),
                folders: row.folders.clone(),
            }
        };
        let measured =
            |m: &super::result::MetricResult| Measured { name: m.name.clone(), unit: m.unit.clone() };
        let late = study.left_out.iter().map(|name| format!("{name} needs a longer run and is left out"));
        let repeated = study.repeated.iter().map(|[one, other]| {
            format!("{one} makes the scene of {other}, and is not run: no key that matters depends on it")
        });
        // What a study says of physical keys asks for this.
        let asks = |text: &String| keys.iter().any(|key| text.ends_with(&warning(key)));
        let warned = study.warned().into_iter().filter(|text| !asks(text));
        let rows: Vec<SweepRow> = study.rows.iter().map(row).collect();
        let idle = idle(&keys, &rows);
        Self {
            notes: late.chain(repeated).chain(warned).chain(idle).collect(),
            scene: study.scene.clone(),
            rows,
            metrics: study.metrics.iter().map(measured).collect(),
            keys,
        }
    }

    fn titles(&self) -> Vec<String> {
        let with_unit = |m: &Measured| match m.unit.as_str() {
            "" => m.name.clone(),
            unit => format!("{} [{unit}]", m.name),
        };
        self.keys.iter().cloned().chain(self.metrics.iter().map(with_unit)).collect()
    }

    /// The table.
    pub fn text(&self) -> String {
        let mut table = vec![self.titles()];
        for row in &self.rows {
            let numbers = row.numbers.iter().map(|n| n.map_or("-".to_owned(), short));
            table.push(row.values.iter().cloned().chain(numbers).collect());
        }
        let mut text = aligned(&table);
        for row in self.rows.iter() {
            if let Some(error) = &row.error {
                text.push_str(&format!("{}: {error}\n", row.values.join(", ")));
            }
        }
        for note in &self.notes {
            text.push_str(&format!("\n{note}\n"));
        }
        text
    }

    /// Writes `sweep.csv`, `sweep.json` and, where the first key's values are numbers, `sweep.png`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), StudyError> {
        let mut json = self.json()?.into_bytes();
        json.push(b'\n');
        atomic::replace_bytes(&folder.join("sweep.json"), &json)?;
        let path = folder.join("sweep.csv");
        let csv =
            self.csv().map_err(|e| OutputError::Malformed { path: path.clone(), reason: e.to_string() })?;
        atomic::replace_bytes(&path, &csv)?;
        self.draw(folder)?;
        Ok(())
    }

    /// As JSON.
    ///
    /// # Errors
    /// None that is known.
    pub fn json(&self) -> Result<String, StudyError> {
        serde_json::to_string_pretty(self).map_err(|e| StudyError::System(e.to_string()))
    }

    fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let ends = ["status", "wall time [s]", "folder"].map(String::from);
        writer.write_record(self.titles().into_iter().chain(ends))?;
        for row in &self.rows {
            let status = serde_json::to_value(row.status).unwrap_or_default();
            let numbers = row.numbers.iter().map(|n| n.map_or(String::new(), |n| n.to_string()));
            let folder = row.folders.first().map_or(String::new(), |f| f.display().to_string());
            let ends = [status.as_str().unwrap_or_default().to_owned(), row.wall_seconds.to_string(), folder];
            writer.write_record(row.values.iter().cloned().chain(numbers).chain(ends))?;
        }
        writer.into_inner().map_err(|e| csv::Error::from(e.into_error()))
    }

    /// Points of a metric with the series that each belongs to: the values of the further keys.
    fn series(&self, metric: usize) -> Vec<(String, Vec<(f64, f64)>)> {
        let mut series: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
        for row in &self.rows {
            let Some(x) = row.values.first().and_then(|value| value.parse::<f64>().ok()) else { continue };
            let further = self.keys.iter().zip(&row.values).skip(1);
            let name = further.map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join(" ");
            let at = series.iter().position(|(other, _)| *other == name).unwrap_or_else(|| {
                series.push((name, Vec::new()));
                series.len() - 1
            });
            series[at].1.extend(row.numbers[metric].filter(|y| y.is_finite()).map(|y| (x, y)));
        }
        for (_, points) in &mut series {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        series
    }

    /// Draws each metric over the first key; not where its values are no numbers.
    fn draw(&self, folder: &Path) -> Result<(), OutputError> {
        let all: Vec<_> = (0..self.metrics.len()).map(|k| self.series(k)).collect();
        let Some(first) = all.first().filter(|series| series.iter().any(|(_, points)| !points.is_empty()))
        else {
            return Ok(());
        };
        let entries: Vec<Entry> = match &first[..] {
            [_] => Vec::new(),
            several => {
                let entry = |(k, (name, _)): (usize, &(String, _))| Entry {
                    name: name.clone(),
                    mark: Mark::of(k),
                    filled: true,
                };
                several.iter().enumerate().map(entry).collect()
            }
        };
        let panels = PANEL.1 * all.len() as i32;
        let below = if entries.is_empty() { 0 } else { legend_height(&entries, PANEL.0) };
        let title = format!("{} · {}", self.scene, self.keys.join(", "));
        picture(&folder.join("sweep.png"), (PANEL.0, HEAD + panels + below), &title, |area| {
            let (charts, below) = area.split_vertically(px(panels));
            for ((panel, series), metric) in
                charts.split_evenly((all.len(), 1)).iter().zip(&all).zip(&self.metrics)
            {
                let points = || series.iter().flat_map(|(_, points)| points.iter().copied());
                let (x, y) = (linear_axis(points().map(|p| p.0)), linear_axis(points().map(|p| p.1)));
                let (Some(x), Some(y)) = (x, y) else { continue };
                let unit = if metric.unit.is_empty() { String::new() } else { format!(" [{}]", metric.unit) };
                let chart = Chart::new(
                    panel,
                    &metric.name,
                    [
                        Axis { range: x, title: self.keys[0].clone(), label: &trimmed, scale: Scale::Linear },
                        Axis {
                            range: y,
                            title: format!("{}{unit}", metric.name),
                            label: &trimmed,
                            scale: Scale::Linear,
                        },
                    ],
                )?;
                for (k, (_, points)) in series.iter().enumerate() {
                    let mark = Mark::of(k);
                    chart.line(points, stroke(mark.color, 2))?;
                    points.iter().try_for_each(|point| chart.mark(*point, mark, true))?;
                }
            }
            if entries.is_empty() { Ok(()) } else { legend(&below, &entries) }
        })
    }
}

/// A tick's number without superfluous zeros.
fn trimmed(value: f64) -> String {
    halfstep_output::pictures::units::number(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_physical_or_numerical() {
        for key in [
            "solid.youngs_modulus",
            "solid.gate.density",
            "fluid.viscosity",
            "fluid.density",
            "gravity.1",
            "parameters.L",
            "shape.plate.box.max",
            "shape.tank.motion.period",
            "end_time",
        ] {
            assert!(is_physical(key), "{key}");
        }
        for key in [
            "resolution",
            "time_step",
            "numerics.cfl",
            "fluid.time_integration",
            "solid.time_integration",
            "effects.viscosity",
            "fluid.sound_speed",
            "fluid.artificial_viscosity.linear",
            "fluid.density_diffusion",
            "solid.model",
            "solid.gate.smoothing_ratio",
            "solid.arrangement",
            "solid.arrangement_seed",
            "shape.plate.lattice_angle",
            "shape.plate.across",
            "interface.cross_viscosity",
        ] {
            assert!(!is_physical(key), "{key}");
        }
    }

    fn sweep() -> Sweep {
        let row = |modulus: &str, density: &str, number: Option<f64>| SweepRow {
            values: vec![modulus.into(), density.into()],
            numbers: vec![number],
            status: Some(RunStatus::Finished),
            error: number.is_none().then(|| "passes its level 0 times".into()),
            wall_seconds: 1.5,
            folders: vec!["runs/a".into()],
        };
        Sweep {
            notes: vec!["warning: fluid came close".into()],
            scene: "gate".into(),
            keys: vec!["solid.youngs_modulus".into(), "solid.density".into()],
            metrics: vec![Measured { name: "tip".into(), unit: "m".into() }],
            rows: vec![
                row("2e6", "1000", Some(0.25)),
                row("1e6", "1000", Some(0.5)),
                row("1e6", "2000", None),
                row("2e6", "2000", Some(0.125)),
            ],
        }
    }

    #[test]
    fn tables_have_a_column_for_each_key_and_metric() {
        let text = sweep().text();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "solid.youngs_modulus  solid.density  tip [m]");
        assert_eq!(lines[3].split_whitespace().collect::<Vec<_>>(), ["1e6", "2000", "-"]);
        assert_eq!(lines[5], "1e6, 2000: passes its level 0 times");
        let csv = String::from_utf8(sweep().csv().unwrap()).unwrap();
        assert_eq!(csv.lines().nth(2), Some("1e6,1000,0.5,finished,1.5,runs/a"));
    }

    #[test]
    fn curves_ascend_and_have_the_further_keys_for_names() {
        let series = sweep().series(0);
        assert_eq!(series[0], ("solid.density=1000".into(), vec![(1e6, 0.5), (2e6, 0.25)]));
        assert_eq!(series[1], ("solid.density=2000".into(), vec![(2e6, 0.125)]));
        let folder = tempfile::tempdir().unwrap();
        sweep().write(folder.path()).unwrap();
        assert!(folder.path().join("sweep.png").exists());
    }

    #[test]
    fn a_key_that_changes_nothing_is_named() {
        let Sweep { keys, rows, .. } = sweep();
        assert_eq!(idle(&keys, &rows), [""; 0]);
        let with = |numbers: [f64; 4]| -> Vec<SweepRow> {
            let row =
                |(row, number): (&SweepRow, f64)| SweepRow { numbers: vec![Some(number)], ..row.clone() };
            rows.iter().zip(numbers).map(row).collect()
        };
        // The first two have one density, as the last two.
        assert_eq!(
            idle(&keys, &with([0.25, 0.25, 0.5, 0.5])),
            ["solid.youngs_modulus changes none of these numbers: they agree to the last bit"]
        );
        assert_eq!(idle(&keys, &with([0.25, 0.25, 0.5, 0.5_f64.next_up()])), [""; 0]);
        assert_eq!(idle(&keys, &rows[..1]), [""; 0], "one run shows nothing");
    }
}
