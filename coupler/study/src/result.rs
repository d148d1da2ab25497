//! What the runs of a study gave: costs, metrics and their errors.

use super::convergence::{Convergence, richardson};
use super::ladder::Setting;
use super::measure::{self, Unmeasured};
use super::reference;
use super::{pareto, sweep};
use halfstep_output::run_json::{EffectReport, Roles, RunStatus};
use halfstep_output::{RunReport, read_probes};
use halfstep_scene::{Metric, MetricKind, Scene};
use serde::{Serialize, Serializer};
use std::path::PathBuf;

/// One setting and its runs.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// For tables: what differs from the scene.
    pub label: String,
    /// What differs from the scene, `key=value`.
    pub changes: Vec<String>,
    /// What differs beside the resolution.
    pub choices: Vec<String>,
    /// Everything that was set.
    pub overrides: Vec<String>,
    /// Particle spacing, m.
    pub resolution: f64,
    /// How the run ended.
    pub status: Option<RunStatus>,
    /// Why it did not finish.
    pub error: Option<String>,
    /// Fluid, solid and wall particles.
    pub particles: u64,
    /// Steps done.
    pub steps: u64,
    /// Mean time step, s.
    pub dt: Option<f64>,
    /// Largest number of solid sub-steps.
    pub sub_steps: Option<u32>,
    /// Wall time of each repeat, s.
    pub wall_seconds: Vec<f64>,
    /// Pair evaluations of all processes: the same in every repeat.
    pub pair_evaluations: Option<u64>,
    /// Where the first repeat's time went.
    pub roles: Roles,
    /// Effects of the first run.
    pub effects: Vec<EffectReport>,
    /// Each metric of the study, or why it could not be taken.
    #[serde(serialize_with = "numbers_or_reasons")]
    pub values: Vec<Result<f64, String>>,
    /// The setting was chosen for a goal and is not of the ladder.
    pub chosen: bool,
    /// Folders of the repeats.
    pub folders: Vec<PathBuf>,
    /// What the first run warned of, in the scene and of its result, and what its numbers are not.
    pub warnings: Vec<String>,
}

impl Row {
    /// From the reports of a setting's repeats.
    pub fn new(setting: &Setting, metrics: &[Metric], runs: Vec<(PathBuf, RunReport)>, chosen: bool) -> Self {
        let wall_seconds = runs.iter().map(|(_, report)| report.wall_seconds).collect();
        let folders: Vec<PathBuf> = runs.iter().map(|(folder, _)| folder.clone()).collect();
        let first = runs.into_iter().next().map(|(_, report)| report).unwrap_or_default();
        let finished = first.status == Some(RunStatus::Finished);
        let probes = folders.first().and_then(|f| read_probes(&f.join("probes.csv")).ok());
        let value = |metric: &Metric| match (&probes, finished) {
            (Some(probes), true) => {
                measure::measure(&setting.scene, metric, probes).map_err(|e: Unmeasured| e.to_string())
            }
            _ => Err("the run did not finish".into()),
        };
        let of_curve = |metric: &Metric| {
            let probes = probes.as_ref()?;
            reference::left_out(&setting.scene, metric, probes).or_else(|| measure::remark(metric, probes))
        };
        let choices = setting.choices();
        let physical = physical_keys(&choices).map(sweep::warning);
        let of_curves = metrics.iter().filter_map(of_curve);
        let warnings = first.warnings.into_iter().chain(of_curves).chain(physical).collect();
        Self {
            warnings,
            label: setting.label() + if chosen { " (chosen)" } else { "" },
            changes: setting.changes.clone(),
            choices,
            overrides: setting.overrides.clone(),
            resolution: setting.scene.resolution,
            status: first.status,
            particles: first.particles.fluid + first.particles.solid + first.particles.wall,
            steps: first.steps,
            dt: first.dt.mean,
            sub_steps: first.sub_steps,
            wall_seconds,
            pair_evaluations: first.work.pair_evaluations.total(),
            roles: first.roles,
            values: metrics.iter().map(value).collect(),
            error: first.error,
            effects: first.effects,
            chosen,
            folders,
        }
    }

    /// Median wall time, s.
    pub fn seconds(&self) -> f64 {
        median(&self.wall_seconds)
    }

    /// Shortest and longest wall time, s.
    pub fn spread(&self) -> (f64, f64) {
        let fold = |f: fn(f64, f64) -> f64| self.wall_seconds.iter().copied().fold(f64::NAN, f);
        (fold(f64::min), fold(f64::max))
    }
}

fn numbers_or_reasons<S: Serializer>(values: &[Result<f64, String>], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(values.iter().map(|value| match value {
        Ok(number) => serde_json::json!(number),
        Err(reason) => serde_json::json!(reason),
    }))
}

/// The middle value, or the mean of the two middle ones.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[n / 2],
        n => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
    }
}

/// What errors are taken against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Against {
    /// The metric's reference.
    Reference,
    /// What the finest runs extrapolate to.
    Finest,
}

/// A metric over all settings.
#[derive(Clone, Debug, Serialize)]
pub struct MetricResult {
    /// Name of the metric.
    pub name: String,
    /// Unit of its values.
    pub unit: String,
    /// Reference of the metric.
    pub reference: Option<f64>,
    /// Where that comes from.
    pub source: Option<String>,
    /// What `errors` that are shown and fitted are against.
    pub against: Against,
    /// Convergence with resolution, for each set of other choices.
    pub groups: Vec<Group>,
    /// For each setting.
    pub errors: Vec<Errors>,
}

/// Settings that differ in resolution alone.
#[derive(Clone, Debug, Serialize)]
pub struct Group {
    /// Choices that all runs of the group share.
    pub choices: Vec<String>,
    /// Spacings of the runs, finest first, m.
    pub resolutions: Vec<f64>,
    /// What the three finest say.
    pub convergence: Convergence,
    /// The finest run's value.
    pub finest: f64,
}

impl Group {
    /// Best guess at the value at zero spacing.
    fn limit(&self) -> f64 {
        self.convergence.extrapolated().unwrap_or(self.finest)
    }
}

/// Errors of a setting, relative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Against the reference.
    pub reference: Option<f64>,
    /// Against what the three finest runs with the same choices extrapolate to, or else against the finest.
    pub finest: Option<f64>,
    /// Nobody is as fast and as accurate.
    pub front_time: bool,
    /// Nobody does with as little work and is as accurate.
    pub front_work: bool,
}

impl MetricResult {
    /// Compares the values of one metric, the one of that index, over all rows.
    pub fn new(
        scene: &Scene,
        metrics: &[Metric],
        index: usize,
        rows: &[Row],
        against: Option<Against>,
    ) -> Self {
        let metric = &metrics[index];
        let target = reference::target(scene, metric);
        let probe = metric.probe.split('.').next().unwrap_or_default();
        let of_curve = scene.probes.iter().find(|p| p.name == probe);
        let of_curve = of_curve.map_or("", |p| p.kind.components(scene.dimension).1);
        let groups = groups(rows, index);
        let mut errors: Vec<Errors> = rows
            .iter()
            .map(|row| Errors {
                reference: target
                    .as_ref()
                    .and_then(|t| Some((row.values[index].as_ref().ok()? - t.value).abs() / t.scale)),
                finest: to_finest(metric, &groups, row, index),
                ..Errors::default()
            })
            .collect();
        let default = if target.is_some() { Against::Reference } else { Against::Finest };
        let mut result = Self {
            name: metric.name.clone(),
            unit: metric.kind.unit(of_curve).into(),
            reference: target.as_ref().filter(|_| metric.kind != MetricKind::Rms).map(|t| t.value),
            source: target.as_ref().map(|t| t.source.clone()),
            against: against.filter(|a| *a == Against::Finest || target.is_some()).unwrap_or(default),
            groups,
            errors: Vec::new(),
        };
        let shown = |e: &Errors| result.shown(e).unwrap_or(f64::NAN);
        let work = |row: &Row| row.pair_evaluations.map_or(f64::NAN, |w| w as f64);
        let by_time: Vec<_> = rows.iter().zip(&errors).map(|(r, e)| (r.seconds(), shown(e))).collect();
        let by_work: Vec<_> = rows.iter().zip(&errors).map(|(r, e)| (work(r), shown(e))).collect();
        let fronts = pareto::front(&by_time).into_iter().zip(pareto::front(&by_work));
        for (error, (time, work)) in errors.iter_mut().zip(fronts) {
            (error.front_time, error.front_work) = (time, work);
        }
        result.errors = errors;
        result
    }

    /// The error that is shown, fitted and aimed at.
    pub fn shown(&self, errors: &Errors) -> Option<f64> {
        match self.against {
            Against::Reference => errors.reference,
            Against::Finest => errors.finest,
        }
    }

    /// The group with the most resolutions.
    pub fn largest_group(&self) -> Option<&Group> {
        largest(&self.groups)
    }
}

fn largest(groups: &[Group]) -> Option<&Group> {
    // The first of several.
    groups.iter().rev().max_by_key(|g| g.resolutions.len())
}

fn groups(rows: &[Row], index: usize) -> Vec<Group> {
    // Points (spacing, value) by choices, in the order of the rows.
    type Points = (Vec<String>, Vec<(f64, f64)>);
    let mut groups: Vec<Points> = Vec::new();
    for row in rows {
        let Ok(value) = row.values[index] else { continue };
        let point = (row.resolution, value);
        match groups.iter_mut().find(|(choices, _)| *choices == row.choices) {
            Some((_, points)) => points.push(point),
            None => groups.push((row.choices.clone(), vec![point])),
        }
    }
    let group = |(choices, mut points): Points| {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Group {
            choices,
            convergence: richardson(&points),
            finest: points[0].1,
            resolutions: points.iter().map(|p| p.0).collect(),
        }
    };
    groups.into_iter().map(group).collect()
}

/// Keys among choices that make another scene.
fn physical_keys(choices: &[String]) -> impl Iterator<Item = &str> {
    let keys = choices.iter().filter_map(|choice| choice.split('=').next());
    keys.filter(|key| sweep::is_physical(key))
}

/// Error against the limit of the row's own group; a group of one resolution is compared with the largest group, unless
/// either computes something else.
fn to_finest(metric: &Metric, groups: &[Group], row: &Row, index: usize) -> Option<f64> {
    let own = groups.iter().find(|g| g.choices == row.choices).filter(|g| g.resolutions.len() > 1);
    let group = own.or(largest(groups))?;
    let differ = group.choices != row.choices;
    if differ
        && [&group.choices, &row.choices].into_iter().any(|choices| physical_keys(choices).next().is_some())
    {
        return None;
    }
    let value = *row.values[index].as_ref().ok()?;
    let itself = group.choices == row.choices && row.resolution == group.resolutions[0];
    if itself && group.convergence.extrapolated().is_none() {
        return None;
    }
    let limit = group.limit();
    let scale = match metric.kind {
        MetricKind::Rms => 1.0,
        _ => metric.scale.unwrap_or(limit.abs()),
    };
    Some((value - limit).abs() / scale)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn row(resolution: f64, choices: &[&str], seconds: f64, value: f64) -> Row {
        let choices: Vec<String> = choices.iter().map(|c| c.to_string()).collect();
        Row {
            label: format!("resolution={resolution}"),
            changes: [&[format!("resolution={resolution}")], &choices[..]].concat(),
            choices,
            overrides: Vec::new(),
            resolution,
            status: Some(RunStatus::Finished),
            error: None,
            particles: 100,
            steps: 10,
            dt: None,
            sub_steps: None,
            wall_seconds: vec![seconds],
            pair_evaluations: Some(1000),
            roles: Roles::default(),
            effects: Vec::new(),
            values: vec![Ok(value)],
            chosen: false,
            folders: Vec::new(),
            warnings: Vec::new(),
        }
    }

    fn metric() -> Metric {
        Metric {
            name: "m".into(),
            probe: "p.x".into(),
            kind: MetricKind::Peak,
            from: 0.0,
            to: None,
            reference: None,
            scale: None,
        }
    }

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0]), 2.5);
        assert!(median(&[]).is_nan());
    }

    #[test]
    fn errors_are_against_the_limit_of_the_own_group() {
        // 3 + 2 dx: limit 3. The other kernel has one resolution and is compared with that limit.
        let rows = [
            row(1.0, &[], 1.0, 5.0),
            row(2.0, &[], 1.0, 7.0),
            row(4.0, &[], 1.0, 11.0),
            row(1.0, &["numerics.kernel=w"], 1.0, 6.0),
        ];
        let groups = groups(&rows, 0);
        assert_eq!(groups.len(), 2);
        let of = |r: &Row| to_finest(&metric(), &groups, r, 0).unwrap();
        for (row, error) in rows.iter().zip([2.0 / 3.0, 4.0 / 3.0, 8.0 / 3.0, 1.0]) {
            assert!((of(row) - error).abs() < 1e-9, "{}", row.label);
        }
    }

    /// A gate of another stiffness has errors against its own limit, and none against another gate's.
    #[test]
    fn another_scene_is_no_error() {
        let soft = &["solid.youngs_modulus=6e6"];
        let rows = [
            row(1.0, &[], 1.0, 5.0),
            row(2.0, &[], 1.0, 7.0),
            row(1.0, soft, 1.0, 9.0),
            row(1.0, &["solid.youngs_modulus=3e6"], 1.0, 20.0),
            row(2.0, soft, 1.0, 10.0),
        ];
        let groups = groups(&rows, 0);
        let of = |row: &Row| to_finest(&metric(), &groups, row, 0);
        assert_eq!(of(&rows[3]), None);
        assert!((of(&rows[4]).unwrap() - 1.0 / 9.0).abs() < 1e-12);
    }

    #[test]
    fn without_an_order_the_finest_has_no_error_against_itself() {
        let rows = [row(1.0, &[], 1.0, 5.0), row(2.0, &[], 1.0, 7.0)];
        let groups = groups(&rows, 0);
        assert_eq!(groups[0].convergence, Convergence::TooFew);
        assert_eq!(to_finest(&metric(), &groups, &rows[0], 0), None);
        assert!((to_finest(&metric(), &groups, &rows[1], 0).unwrap() - 0.4).abs() < 1e-12);
    }
}
