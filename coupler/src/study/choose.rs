//! Which settings reach an error most cheaply, or the least error within a budget: predicted from the runs so far.

use super::fit::{Fit, Point, Prediction};
use super::result::{MetricResult, Row};

/// What is wanted.
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
    /// Its row, where it has been run.
    pub row: Option<usize>,
    /// Relative error.
    pub error: Prediction,
    /// Wall time, s.
    pub time: Prediction,
}

/// Predicts every combination of the choices that were run with these spacings. What has been run counts with its own
/// figures.
pub fn candidates(rows: &[Row], metric: &MetricResult, spacings: &[f64]) -> Vec<Candidate> {
    let shown = |k: usize| metric.shown(&metric.errors[k]);
    let point = |row: &Row| Point { resolution: row.resolution, choices: row.choices.clone() };
    let known = |value: f64| Prediction { value, interval: None, extrapolated: false };
    let errors: Vec<_> = (0..rows.len()).filter_map(|k| Some((point(&rows[k]), shown(k)?))).collect();
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
                found.push(Candidate { point, row: None, error, time });
            }
        }
    }
    found
}

/// The candidate that serves the goal best. For an error: the cheapest whose interval lies below it; where there is
/// no such one, none. For a budget: the most accurate whose interval lies below it.
pub fn pick(goal: Goal, candidates: &[Candidate]) -> Option<&Candidate> {
    let cost = |c: &Candidate| match goal {
        Goal::Error(_) => c.time.value,
        Goal::Budget(_) => c.error.value,
    };
    let serves = |c: &&Candidate| match goal {
        Goal::Error(most) => c.error.high() <= most,
        Goal::Budget(most) => c.time.high() <= most,
    };
    candidates.iter().filter(serves).min_by(|a, b| cost(a).total_cmp(&cost(b)))
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
        let all = candidates(&rows, &metric, &[0.5, 1.0, 2.0, 4.0]);
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
    }

    #[test]
    fn the_best_error_in_a_budget_is_found() {
        let (rows, metric) = ladder();
        let all = candidates(&rows, &metric, &[0.5, 1.0, 2.0, 4.0]);
        let best = pick(Goal::Budget(20.0), &all).unwrap();
        assert!((best.error.value - 0.005).abs() < 1e-8);
        assert!(pick(Goal::Budget(0.1), &all).is_none());
    }

    #[test]
    fn choices_that_failed_are_not_tried_again() {
        let (mut rows, mut metric) = ladder();
        rows[3].error = Some("diverged".into());
        metric.errors[3].reference = None;
        let all = candidates(&rows, &metric, &[0.5, 1.0, 2.0, 4.0]);
        assert!(all.iter().all(|c| c.point.choices.is_empty()));
    }
}
