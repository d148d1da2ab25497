//! Runs a case with its remedy and without, and says what came out and what should not have.

use super::case::{Case, Without};
use super::criteria::{Measured, evaluate, short};
use crate::run::Outcome;
use halfstep_output::run_json::RunStatus;

/// One criterion of a case, as the table shows it.
#[derive(Clone, Debug)]
pub struct Row {
    /// The case's name.
    pub case: String,
    /// The solid's model, if there is a solid.
    pub model: String,
    /// Particle spacing, m.
    pub resolution: f64,
    /// The criterion and its bounds.
    pub criterion: String,
    /// Its value in the case as it is.
    pub value: String,
    /// What was taken away and what the value is then.
    pub without: String,
    /// Steps of the case as it is.
    pub steps: u64,
    /// Wall time of all its runs, s; in the first row of a case.
    pub seconds: f64,
}

/// A run's criteria and how it ended.
struct Result {
    measured: Vec<Measured>,
    outcome: Outcome,
}

impl Result {
    fn of(&self, label: &str) -> Option<&Measured> {
        self.measured.iter().find(|m| m.label == label)
    }

    /// Why it diverged, without the hint.
    fn error(&self) -> Option<String> {
        let report = self.outcome.report();
        (report.status == Some(RunStatus::Diverged)).then_some(report.error?)
    }
}

/// Runs a case, in the short form at its coarsest resolution, if at all. Returns the rows, and what is not as it should
/// be.
pub fn check(case: &Case, long: bool) -> (Vec<Row>, Vec<String>) {
    let (mut rows, mut wrong) = (Vec::new(), Vec::new());
    if case.long && !long {
        return (rows, wrong);
    }
    let resolutions = if long { &case.resolution[..] } else { &case.resolution[..1] };
    for model in case.each_model() {
        for &dx in resolutions {
            at(case, model, dx, long, &mut rows, &mut wrong);
        }
    }
    (rows, wrong)
}

fn at(case: &Case, model: Option<&str>, dx: f64, long: bool, rows: &mut Vec<Row>, wrong: &mut Vec<String>) {
    let what = format!("{}, {} at {dx} m", case.name, model.unwrap_or("fluid"));
    let others: Vec<Option<Outcome>> = case
        .criteria
        .iter()
        .map(|c| (!c.to_run.is_empty()).then(|| case.run(dx, model, long, &c.to_run).outcome()))
        .collect();
    let run = |more: &[String]| {
        let outcome = case.run(dx, model, long, more).outcome();
        Result { measured: evaluate(&case.criteria, &outcome, dx, &others), outcome }
    };
    let with = run(&[]);
    for (k, m) in with.measured.iter().enumerate() {
        if m.holds == case.is_known_limit(k) {
            let now = if m.holds { "holds, although it is a known limit" } else { "fails" };
            wrong.push(format!("{what}: {} {now}: {} {}", m.label, short(m.value), with.outcome.stderr));
        }
    }
    let removed: Vec<(&Without, Result)> = case
        .without
        .iter()
        .filter(|w| w.models.is_empty() || model.is_some_and(|m| w.models.iter().any(|own| own == m)))
        .filter(|w| w.resolution.is_empty() || w.resolution.contains(&dx))
        .map(|w| (w, run(&w.set)))
        .collect();
    for (w, result) in &removed {
        wrong.extend(unexpected(w, result).map(|text| format!("{what}, {}: {text}", w.what)));
    }
    let seconds = with.outcome.seconds
        + removed.iter().map(|(_, r)| r.outcome.seconds).sum::<f64>()
        + others.iter().flatten().map(|o| o.seconds).sum::<f64>();
    for (k, m) in with.measured.iter().enumerate() {
        let (name, value) = if k == 0 {
            ("finished, no NaN".to_owned(), if m.holds { "yes".into() } else { "no".into() })
        } else {
            (format!("{} {}", m.label, case.criteria[k - 1].bounds()), short(m.value))
        };
        let limit = if case.is_known_limit(k) {
            format!("; **known limit**: {}", case.criteria[k - 1].limit)
        } else {
            String::new()
        };
        let without: Vec<String> = removed.iter().filter_map(|(w, r)| shown(w, r, k)).collect();
        rows.push(Row {
            case: case.name.clone(),
            model: model.unwrap_or("").into(),
            resolution: dx,
            criterion: name,
            value: value + &limit,
            without: without.join("; "),
            steps: with.outcome.report().steps,
            seconds: if k == 0 { seconds } else { 0.0 },
        });
    }
}

/// What is not as it should be in a run without its remedy.
fn unexpected(w: &Without, result: &Result) -> Option<String> {
    let failed: Vec<&Measured> = result.measured.iter().filter(|m| !m.holds).collect();
    if w.holds {
        let list: Vec<String> = failed.iter().map(|m| format!("{} {}", m.label, short(m.value))).collect();
        return (!list.is_empty()).then(|| format!("was said to hold, but: {}", list.join(", ")));
    }
    let Some(named) = result.of(&w.fails) else { return Some(format!("no criterion is called {}", w.fails)) };
    if named.holds {
        return Some(format!("{} should fail and does not: {}", w.fails, short(named.value)));
    }
    if w.fails == "finished" {
        let Some(error) = result.error() else {
            return Some(format!("ended otherwise than diverged: {}", result.outcome.stderr));
        };
        if result.outcome.code() != Some(2) || !error.contains(&w.says) || !error.contains("hint: ") {
            return Some(format!("exit status {:?}, message {error}", result.outcome.code()));
        }
    }
    None
}

/// The cell for criterion `k` of a run without its remedy, if there is something to say.
fn shown(w: &Without, result: &Result, k: usize) -> Option<String> {
    let m = &result.measured[k];
    if k == 0 {
        return match result.error() {
            Some(error) => {
                let line = error.lines().next().unwrap_or_default();
                let brief = line.split(" at (").next().unwrap_or(line);
                Some(format!("{}: {brief}", w.what))
            }
            None if w.holds => Some(format!("{}: holds without it, too", w.what)),
            None => None,
        };
    }
    if result.error().is_some() {
        return None;
    }
    let verdict = if m.holds { "" } else { " **fails**" };
    Some(format!("{}: {}{verdict}", w.what, short(m.value)))
}
