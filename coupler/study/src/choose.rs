//! Which settings reach an error most cheaply, or the least error within a budget: predicted from the runs so far.

use super::fit::{Fit, Point, Prediction};
use super::result::{MetricResult, Row};

/// Goal of a study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// This relative error at least cost.
    Error(f64),
    /// The least error in this wall time, s.
    Budget(f64),
}

/// Settings that could be run, or that have been.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Where it lies.
    pub point: Point,
    /// Row of the candidate, where it has been run.
    pub row: Option<usize>,
    /// Relative error.
    pub error: Prediction,
    /// Wall time, s.
    pub time: Prediction,
}

/// How wrong the law of the coarser runs was about the finest ones: what residuals do not show, that the law may be
/// none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surprise {
    /// Largest |ln(error / predicted error)| of the finest runs.
    pub logs: f64,
    /// The finest runs' spacing, m.
    pub finest: f64,
    /// How far beyond the coarser runs that was: the logarithm of the ratio of spacings.
    pub distance: f64,
}

impl Surprise {
    /// From all rows, and from those before the finest ones with the errors that were seen then.
    pub fn new(rows: &[Row], metric: &MetricResult, before: &[Row], seen: &MetricResult) -> Option<Self> {
        let spacing = |rows: &[Row]| rows.iter().map(|r| r.resolution).fold(f64::INFINITY, f64::min);
        let (finest, coarser) = (spacing(rows), spacing(before));
        let fit = Fit::new(&errors(before, seen))?;
        fit.slope()?;
        let missed = errors(rows, metric).into_iter().filter(|(point, _)| point.resolution < coarser);
        let logs = missed.filter_map(|(p, error)| Some((error / fit.predict(&p)?.value).ln().abs()));
        let logs = logs.filter(|l| l.is_finite()).reduce(f64::max)?;
        Some(Self { logs, finest, distance: (coarser / finest).ln() })
    }

    /// Makes an interval beyond the finest runs as wide as the last prediction was wrong, in proportion to the way.
    fn widen(&self, resolution: f64, prediction: Prediction) -> Prediction {
        let way = (self.finest / resolution).ln();
        if way < 1e-9 {
            return prediction;
        }
        let factor = (self.logs * (way / self.distance).max(1.0)).exp();
        let (low, high) = prediction.interval.unwrap_or((prediction.value, prediction.value));
        let interval = Some((low.min(prediction.value / factor), high.max(prediction.value * factor)));
        Prediction { interval, ..prediction }
    }
}

fn point(row: &Row) -> Point {
    Point { resolution: row.resolution, choices: row.choices.clone() }
}

/// Runs with their errors, where they have one.
fn errors(rows: &[Row], metric: &MetricResult) -> Vec<(Point, f64)> {
    rows.iter().zip(&metric.errors).filter_map(|(row, e)| Some((point(row), metric.shown(e)?))).collect()
}

/// Predicts every combination of the choices that were run with these spacings. What has been run counts with its own
/// figures.
pub fn candidates(
    rows: &[Row],
    metric: &MetricResult,
    surprise: Option<Surprise>,
    spacings: &[f64],
) -> Vec<Candidate> {
    let shown = |k: usize| metric.shown(&metric.errors[k]);
    let known = |value: f64| Prediction { value, interval: None, extrapolated: false };
    let errors = errors(rows, metric);
    let times: Vec<_> = rows.iter().filter(|r| r.error.is_none()).map(|r| (point(r), r.seconds())).collect();
    let mut found: Vec<Candidate> = (0..rows.len())
        .filter_map(|k| {
            let (error, time) = (known(shown(k)?), known(rows[k].seconds()));
            Some(Candidate { point: point(&rows[k]), row: Some(k), error, time })
        })
        .collect();
    let (Some(error), Some(time)) = (Fit::new(&errors), Fit::new(&times)) else { return found };
    let mut tried: Vec<&Vec<String>> = Vec::new();
    for row in rows {
        // Choices with which a run did not get to its end are not tried again.
        let sound = rows.iter().all(|r| r.choices != row.choices || r.error.is_none());
        if tried.contains(&&row.choices) || !sound {
            continue;
        }
        tried.push(&row.choices);
        for &resolution in spacings {
            let point = Point { resolution, choices: row.choices.clone() };
            let same = |c: &Candidate| {
                c.point.choices == point.choices && (c.point.resolution / resolution - 1.0).abs() < 1e-6
            };
            if found.iter().any(same) {
                continue;
            }
            if let (Some(error), Some(time)) = (error.predict(&point), time.predict(&point)) {
                let error = surprise.map_or(error, |s| s.widen(resolution, error));
                found.push(Candidate { point, row: None, error, time });
            }
        }
    }
    found
}

/// The candidate that serves the goal best. For an error: the cheapest whose interval lies below it; where there is
/// no such one, the cheapest whose best guess does. For a budget: the most accurate whose interval lies below it.
pub fn pick(goal: Goal, candidates: &[Candidate]) -> Option<&Candidate> {
    let cost = |c: &Candidate| match goal {
        Goal::Error(_) => c.time.value,
        Goal::Budget(_) => c.error.value,
    };
    let best = |serves: &dyn Fn(&Candidate) -> bool| {
        candidates.iter().filter(|c| serves(c)).min_by(|a, b| cost(a).total_cmp(&cost(b)))
    };
    match goal {
        Goal::Error(most) => best(&|c| c.error.high() <= most).or_else(|| best(&|c| c.error.value <= most)),
        Goal::Budget(most) => best(&|c| c.time.high() <= most),
    }
}

#[cfg(test)]
mod tests {
    use super::super::result::{Against, Errors, tests::row};
    use super::*;

    /// Error dx, time 8 / dx³; the other kernel has half the error for twice the time.
    fn ladder() -> (Vec<Row>, MetricResult) {
        let rows: Vec<Row> = [(1.0, false), (2.0, false), (4.0, false), (2.0, true)]
            .into_iter()
            .map(|(dx, other)| {
                let factor = if other { 2.0 } else { 1.0 };
                let choices: &[&str] = if other { &["kernel=w"] } else { &[] };
                row(dx, choices, factor * 8.0 / (dx * dx * dx), 0.0)
            })
            .collect();
        let error = |r: &Row| 0.01 * r.resolution / if r.choices.is_empty() { 1.0 } else { 2.0 };
        let errors = rows.iter().map(|r| Errors { reference: Some(error(r)), ..Errors::default() }).collect();
        let metric = MetricResult {
            name: "m".into(),
            unit: String::new(),
            reference: Some(1.0),
            source: None,
            against: Against::Reference,
            groups: Vec::new(),
            errors,
        };
        (rows, metric)
    }

    #[test]
    fn the_cheapest_settings_for_an_error_are_found() {
        let (rows, metric) = ladder();
        let all = candidates(&rows, &metric, None, &[0.5, 1.0, 2.0, 4.0]);
        // Four runs, and predictions for 0.5, and for the other kernel at 0.5, 1 and 4.
        assert_eq!(all.iter().filter(|c| c.row.is_none()).count(), 4);
        // 1 % needs dx = 1 (8 s) or the other kernel at dx = 2 (2 s), which has been run.
        let best = pick(Goal::Error(0.0101), &all).unwrap();
        assert_eq!((best.row, best.point.resolution), (Some(3), 2.0));
        // 0.6 %: the other kernel at 1 (16 s) is cheaper than dx = 0.5 (64 s).
        let best = pick(Goal::Error(0.006), &all).unwrap();
        assert_eq!((best.row, best.point.resolution, &best.point.choices[0][..]), (None, 1.0, "kernel=w"));
        assert!((best.time.value - 16.0).abs() < 1e-6 && (best.error.value - 0.005).abs() < 1e-8);
        assert!(pick(Goal::Error(1e-4), &all).is_none());
        // With wide intervals nothing is sure to have 0.6 %, and the likeliest is tried.
        let unsure: Vec<_> = all
            .into_iter()
            .map(|mut c| {
                c.error.interval = Some((0.0, 9.0 * c.error.value));
                c
            })
            .collect();
        let best = pick(Goal::Error(0.006), &unsure).unwrap();
        assert!((best.error.value - 0.005).abs() < 1e-8 && best.error.high() > 0.006);
    }

    /// Errors 8, 4, 2 % at 4, 2, 1 promised 1 % at 1/2, and it was 2 %: a factor of two, and as much again for each
    /// halving.
    #[test]
    fn an_interval_is_as_wide_as_the_last_prediction_was_wrong() {
        let rows: Vec<Row> = [4.0, 2.0, 1.0, 0.5].map(|dx| row(dx, &[], 1.0 / dx, 0.0)).into();
        let of = |errors: &[f64]| MetricResult {
            errors: errors.iter().map(|&e| Errors { reference: Some(e), ..Errors::default() }).collect(),
            ..ladder().1
        };
        let (now, before) = (of(&[0.08, 0.04, 0.02, 0.02]), of(&[0.08, 0.04, 0.02]));
        let surprise = Surprise::new(&rows, &now, &rows[..3], &before).unwrap();
        let halving = 2.0_f64.ln();
        assert!((surprise.logs - halving).abs() < 1e-9 && (surprise.distance - halving).abs() < 1e-9);
        let guess = Prediction { value: 0.01, interval: Some((0.009, 0.011)), extrapolated: true };
        let near = surprise.widen(0.4, guess).interval.unwrap();
        assert!((near.0 - 0.005).abs() < 1e-9 && (near.1 - 0.02).abs() < 1e-9, "{near:?}");
        let far = surprise.widen(0.125, guess).interval.unwrap();
        assert!((far.0 - 0.0025).abs() < 1e-9 && (far.1 - 0.04).abs() < 1e-9, "{far:?}");
        assert_eq!(surprise.widen(0.5, guess), guess, "among the runs the residuals tell");
        // One spacing before the finest says nothing about a law.
        assert_eq!(Surprise::new(&rows[2..], &of(&[0.02, 0.02]), &rows[2..3], &of(&[0.02])), None);
    }

    #[test]
    fn the_best_error_in_a_budget_is_found() {
        let (rows, metric) = ladder();
        let all = candidates(&rows, &metric, None, &[0.5, 1.0, 2.0, 4.0]);
        let best = pick(Goal::Budget(20.0), &all).unwrap();
        assert!((best.error.value - 0.005).abs() < 1e-8);
        assert!(pick(Goal::Budget(0.1), &all).is_none());
    }

    #[test]
    fn choices_that_failed_are_not_tried_again() {
        let (mut rows, mut metric) = ladder();
        rows[3].error = Some("diverged".into());
        metric.errors[3].reference = None;
        let all = candidates(&rows, &metric, None, &[0.5, 1.0, 2.0, 4.0]);
        assert!(all.iter().all(|c| c.point.choices.is_empty()));
    }
}
