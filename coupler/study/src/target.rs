//! `--error` and `--budget`: predict, run, compare.

use super::choose::{Candidate, Goal, candidates, pick};
use super::error::StudyError;
use super::fit::Prediction;
use super::ladder::{self, Setting};
use super::report::{percent, readable, short};
use super::result::Against;
use super::{Session, Study};
use halfstep_coupling::say;

/// Runs that may be made to reach an error: each adds to what the next prediction knows.
const ATTEMPTS: u32 = 3;
/// How much finer than the finest run of the ladder a prediction may go.
const FINER: f64 = 4.0;

/// How it went.
#[derive(Clone, Debug, PartialEq)]
pub enum Reached {
    /// With these overrides.
    Yes(Vec<String>),
    /// And why not.
    No(String),
    /// Somebody stopped it.
    Stopped,
}

impl Session<'_> {
    /// Finds, runs and reports settings for a goal in the metric of that index.
    ///
    /// # Errors
    /// A run cannot be started.
    pub fn reach(&mut self, goal: Goal, metric: usize) -> Result<Reached, StudyError> {
        for _ in 0..ATTEMPTS {
            let study = self.study();
            let surprise = self.surprise(&study, metric);
            let spacings = self.spacings(&study);
            let all = candidates(&study.rows, &study.metrics[metric], surprise, &spacings);
            let mut open = all.clone();
            let (candidate, setting) = loop {
                let Some(found) = pick(goal, &open).cloned() else {
                    return Ok(Reached::No(out_of_reach(goal, &all)));
                };
                // A setting that the scene refuses is no candidate.
                match self.setting(&found) {
                    Some(setting) => break (found, setting),
                    None => open.retain(|c| *c != found),
                }
            };
            say::tell(format_args!("{}", describe(&study, metric, &candidate)));
            if let Goal::Error(most) = goal
                && candidate.row.is_none()
                && candidate.error.high() > most
            {
                say::tell(format_args!(
                    "not sure: nothing is expected to lie below {} with its whole interval",
                    percent(Some(most))
                ));
            }
            if let Some(row) = candidate.row {
                return Ok(Reached::Yes(study.rows[row].changes.clone()));
            }
            if !self.run(std::slice::from_ref(&setting), true)? {
                return Ok(Reached::Stopped);
            }
            let study = self.study();
            let last = study.rows.len() - 1;
            let (row, errors) = (&study.rows[last], &study.metrics[metric].errors[last]);
            let (error, seconds) = (study.metrics[metric].shown(errors), row.seconds());
            say::tell(format_args!("reached: error {}, {} s", percent(error), short(seconds)));
            match (goal, error) {
                (Goal::Error(most), Some(error)) if error <= most => {
                    return Ok(Reached::Yes(setting.changes));
                }
                (Goal::Budget(most), Some(_)) if seconds <= most => return Ok(Reached::Yes(setting.changes)),
                (Goal::Budget(most), Some(_)) => {
                    let reason = format!("the run took {} s instead of {} s", short(seconds), short(most));
                    return Ok(Reached::No(reason));
                }
                (Goal::Error(_), Some(_)) => (),
                (_, None) => {
                    let why = row.error.clone().or_else(|| row.values[metric].clone().err());
                    return Ok(Reached::No(format!("the run has no error: {}", why.unwrap_or_default())));
                }
            }
        }
        Ok(Reached::No(format!(
            "{ATTEMPTS} predictions were too hopeful; the runs above are what was reached"
        )))
    }

    /// Spacings that may be chosen: they divide the thinnest shape, from the coarsest run to four times finer than the
    /// finest.
    fn spacings(&self, study: &Study) -> Vec<f64> {
        let all = || study.rows.iter().filter(|r| !r.chosen).map(|r| r.resolution);
        let (finest, coarsest) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
        let across = |dx: f64| (ladder::thinnest(&self.scene) / dx).round() as u32;
        ladder::dividing(&self.scene, across(coarsest)..=across(finest / FINER))
    }

    fn setting(&self, candidate: &Candidate) -> Option<Setting> {
        let own = candidate.point.resolution == self.scene.resolution;
        let resolution = (!own).then(|| format!("resolution={}", candidate.point.resolution));
        let changes: Vec<String> = resolution.into_iter().chain(candidate.point.choices.clone()).collect();
        Setting::load(&self.options.scene, &self.options.base, &changes).ok()
    }
}

fn describe(study: &Study, metric: usize, candidate: &Candidate) -> String {
    let point = &candidate.point;
    let changes = std::iter::once(format!("resolution={}", point.resolution)).chain(point.choices.clone());
    let label = readable(&changes.collect::<Vec<_>>().join(" "));
    if let Some(row) = candidate.row {
        let error = percent(study.metrics[metric].shown(&study.metrics[metric].errors[row]));
        return format!(
            "best of the runs made: {label}: error {error}, {} s",
            short(study.rows[row].seconds())
        );
    }
    let spare = match candidate.error.interval {
        Some(_) if study.metrics[metric].against == Against::Finest => {
            "four of five such runs lie between, if the limit stays where it is"
        }
        Some(_) => "four of five such runs lie between",
        None => "no interval: every run is used up by the fit",
    };
    let far =
        if candidate.error.extrapolated { "; extrapolated: finer or coarser than the runs made" } else { "" };
    let error = interval(&candidate.error, |v| percent(Some(v)));
    let time = interval(&candidate.time, |v| format!("{} s", short(v)));
    format!("predicted: {label}: error {error}, time {time} ({spare}{far})")
}

fn interval(prediction: &Prediction, show: impl Fn(f64) -> String) -> String {
    let value = show(prediction.value);
    prediction
        .interval
        .map_or(value.clone(), |(low, high)| format!("{value} [{}, {}]", show(low), show(high)))
}

fn out_of_reach(goal: Goal, all: &[Candidate]) -> String {
    let best = |f: fn(&Candidate) -> f64| all.iter().min_by(|a, b| f(a).total_cmp(&f(b)));
    match (goal, best(|c| c.error.value), best(|c| c.time.high())) {
        (Goal::Error(most), Some(best), _) => format!(
            "no settings are expected to have an error of {}; the least that can be expected is {} in {} s, at \
             resolution={}",
            percent(Some(most)),
            percent(Some(best.error.value)),
            short(best.time.value),
            short(best.point.resolution)
        ),
        (Goal::Budget(most), _, Some(best)) => {
            format!(
                "nothing is expected to run in {} s; the fastest takes {} s",
                short(most),
                short(best.time.value)
            )
        }
        _ => "no run of the ladder has an error to predict from".into(),
    }
}
