//! The price list as a text, as `study.csv` and as `study.json`.

use super::convergence::Convergence;
use super::error::StudyError;
use super::program::Program;
use super::result::{Against, Errors, MetricResult, Row};
use halfstep_output::{OutputError, atomic};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// Everything that a study found.
#[derive(Clone, Debug, Serialize)]
pub struct Study {
    /// The scene's name.
    pub scene: String,
    /// Simulated time, s.
    pub end_time: f64,
    /// What made the runs.
    pub program: Program,
    /// Runs at a time; with more than one, wall times are of a shared machine.
    pub jobs: usize,
    /// The settings, in the order of the ladder.
    pub rows: Vec<Row>,
    /// The metrics, in the scene's order.
    pub metrics: Vec<MetricResult>,
    /// Metrics of the scene that need a longer run.
    pub left_out: Vec<String>,
    /// Settings that make the scene of another one, and are not run: both.
    pub repeated: Vec<[String; 2]>,
}

/// A number with four significant digits.
pub fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if (-3..6).contains(&magnitude) {
        format!("{value:.*}", (3 - magnitude).max(0) as usize)
    } else {
        format!("{value:.3e}")
    }
}

/// A relative error in per cent.
pub fn percent(error: Option<f64>) -> String {
    error.map_or("-".into(), |e| format!("{} %", short(100.0 * e)))
}

/// `key=value` with numbers shortened.
pub fn readable(label: &str) -> String {
    let part = |part: &str| match part.split_once('=') {
        Some((key, value)) if value.len() > 6 => {
            value.parse().map_or(part.to_owned(), |x: f64| format!("{key}={}", short(x)))
        }
        _ => part.to_owned(),
    };
    label.split(' ').map(part).collect::<Vec<_>>().join(" ")
}

fn with_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() { short(value) } else { format!("{} {unit}", short(value)) }
}

/// Columns as wide as they need to be, the first one left-aligned.
pub(super) fn aligned(table: &[Vec<String>]) -> String {
    let width = |k: usize| table.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..table.first().map_or(0, Vec::len)).map(width).collect();
    let mut text = String::new();
    for row in table {
        let mut line = format!("{:<1$}", row[0], widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            // Writing to a string cannot fail.
            let _ = write!(line, "  {cell:>width$}");
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

impl Study {
    /// The tables.
    pub fn text(&self) -> String {
        let mut text = self.costs();
        for (index, metric) in self.metrics.iter().enumerate() {
            text.push('\n');
            text.push_str(&self.metric(index, metric));
        }
        for left_out in &self.left_out {
            let _ = writeln!(text, "\n{left_out} needs a longer run and is left out");
        }
        let warned = self.warned();
        for warning in &warned {
            let _ = write!(text, "\n{warning}");
        }
        if warned.is_empty() { text } else { text + "\n" }
    }

    /// What runs warned of, each once with the settings that it is said of.
    pub fn warned(&self) -> Vec<String> {
        let mut told: Vec<(&String, Vec<&str>)> = Vec::new();
        for row in &self.rows {
            for warning in &row.warnings {
                match told.iter_mut().find(|(text, _)| *text == warning) {
                    Some((_, labels)) => labels.push(&row.label),
                    None => told.push((warning, vec![&row.label])),
                }
            }
        }
        let line = |(warning, labels): (&String, Vec<&str>)| match labels.len() == self.rows.len() {
            true => format!("warning: {warning}"),
            false => format!("warning: {}: {warning}", labels.join(", ")),
        };
        told.into_iter().map(line).collect()
    }

    fn costs(&self) -> String {
        let head = ["settings", "particles", "steps", "pair evaluations", "wall time [s]", "min - max"];
        let mut table = vec![head.map(String::from).to_vec()];
        for row in &self.rows {
            let (least, most) = row.spread();
            let work = row.pair_evaluations.map_or("-".into(), |w| format!("{:.2e}", w as f64));
            table.push(vec![
                readable(&row.label),
                row.particles.to_string(),
                row.steps.to_string(),
                work,
                short(row.seconds()),
                if row.wall_seconds.len() > 1 {
                    format!("{} - {}", short(least), short(most))
                } else {
                    "-".into()
                },
            ]);
        }
        let mut text = aligned(&table);
        if self.jobs > 1 {
            let _ = writeln!(text, "{} runs at a time: wall times are not comparable", self.jobs);
        }
        for row in self.rows.iter().filter(|row| row.error.is_some()) {
            let _ = writeln!(text, "{}: {}", readable(&row.label), row.error.as_deref().unwrap_or_default());
        }
        text
    }

    fn metric(&self, index: usize, metric: &MetricResult) -> String {
        let mut text = metric.name.clone();
        if let Some(source) = &metric.source {
            let should =
                metric.reference.map_or(String::new(), |r| format!(" {},", with_unit(r, &metric.unit)));
            let _ = write!(text, ": reference{should} {source}");
        }
        text.push('\n');
        let unit = if metric.unit.is_empty() { "value".into() } else { format!("value [{}]", metric.unit) };
        let head = ["settings".into(), unit, "error".into(), "to finest".into(), "front".into()];
        let mut table = vec![head.to_vec()];
        for (row, errors) in self.rows.iter().zip(&metric.errors) {
            let value = row.values[index].as_ref().map_or("-".into(), |v| short(*v));
            let front = match (errors.front_time, errors.front_work) {
                (true, true) => "time, work",
                (true, false) => "time",
                (false, true) => "work",
                (false, false) => "",
            };
            table.push(vec![
                readable(&row.label),
                value,
                percent(errors.reference),
                percent(errors.finest),
                front.into(),
            ]);
        }
        text.push_str(&aligned(&table));
        for row in &self.rows {
            if let (Err(reason), None) = (&row.values[index], &row.error) {
                let _ = writeln!(text, "{}: {reason}", readable(&row.label));
            }
        }
        for group in metric.groups.iter().filter(|g| g.resolutions.len() > 1) {
            let of = if group.choices.is_empty() {
                String::new()
            } else {
                format!("{}: ", group.choices.join(" "))
            };
            let _ = write!(text, "{of}{}", group.convergence.verdict());
            if let Convergence::Ordered { extrapolated, .. } = group.convergence {
                let _ = write!(text, ", extrapolated {}", with_unit(extrapolated, &metric.unit));
                if let Some(reference) = metric.reference.filter(|r| *r != 0.0) {
                    let off = (extrapolated / reference - 1.0).abs();
                    let _ = write!(text, ", {} from the reference", percent(Some(off)));
                }
            }
            text.push('\n');
        }
        text
    }

    /// Writes `study.csv` and `study.json`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), StudyError> {
        let system = |e: serde_json::Error| StudyError::System(e.to_string());
        let mut json = serde_json::to_vec_pretty(self).map_err(system)?;
        json.push(b'\n');
        atomic::replace_bytes(&folder.join("study.json"), &json)?;
        let path = folder.join("study.csv");
        let csv =
            self.csv().map_err(|e| OutputError::Malformed { path: path.clone(), reason: e.to_string() })?;
        atomic::replace_bytes(&path, &csv)?;
        Ok(())
    }

    fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record([
            "settings",
            "resolution [m]",
            "status",
            "particles",
            "steps",
            "dt [s]",
            "sub-steps",
            "pair evaluations",
            "wall time [s]",
            "shortest [s]",
            "longest [s]",
            "repeats",
            "metric",
            "unit",
            "value",
            "reference",
            "error to reference",
            "error to finest",
            "front in time",
            "front in work",
        ])?;
        let number = |x: Option<f64>| x.filter(|x| x.is_finite()).map_or(String::new(), |x| x.to_string());
        for (index, metric) in self.metrics.iter().enumerate() {
            for (row, errors) in self.rows.iter().zip(&metric.errors) {
                let Errors { reference, finest, front_time, front_work } = *errors;
                let (least, most) = row.spread();
                let status = serde_json::to_value(row.status).unwrap_or_default();
                writer.write_record([
                    row.changes.join(" "),
                    row.resolution.to_string(),
                    status.as_str().unwrap_or_default().into(),
                    row.particles.to_string(),
                    row.steps.to_string(),
                    number(row.dt),
                    row.sub_steps.map_or(String::new(), |k| k.to_string()),
                    row.pair_evaluations.map_or(String::new(), |w| w.to_string()),
                    number(Some(row.seconds())),
                    number(Some(least)),
                    number(Some(most)),
                    row.wall_seconds.len().to_string(),
                    metric.name.clone(),
                    metric.unit.clone(),
                    number(row.values[index].as_ref().ok().copied()),
                    number(metric.reference),
                    number(reference),
                    number(finest),
                    front_time.to_string(),
                    front_work.to_string(),
                ])?;
            }
        }
        writer.into_inner().map_err(|e| csv::Error::from(e.into_error()))
    }

    /// What the errors of a metric are against, in words.
    pub fn against(metric: &MetricResult) -> String {
        match (metric.against, &metric.source) {
            (Against::Reference, Some(source)) => format!("error against {source}"),
            _ => "error against the finest runs".into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        assert_eq!(short(0.254_03), "0.2540");
        assert_eq!(short(1234.56), "1235");
        assert_eq!(short(-6.85e-5), "-6.850e-5");
        assert_eq!(short(0.0), "0");
        assert_eq!(percent(Some(0.0912)), "9.120 %");
        assert_eq!(percent(None), "-");
        assert_eq!(readable("resolution=0.0014285714285714286 a=b"), "resolution=0.001429 a=b");
    }

    #[test]
    fn columns_are_aligned() {
        let row = |a: &str, b: &str| vec![a.to_owned(), b.to_owned()];
        assert_eq!(aligned(&[row("settings", "x"), row("a", "12")]), "settings   x\na         12\n");
    }
}
