//! Criteria, evaluated from what a run leaves: `run.json`, `probes.csv`, frames.

use crate::cluster;
use crate::run::Outcome;
use halfstep_output::Frame;
use halfstep_output::run_json::{RunReport, RunStatus};
use halfstep_wire::frame::{FLUID, SOLID};
use serde::Deserialize;

/// What is measured and within which bounds it must lie.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Criterion {
    /// Which quantity.
    pub what: What,
    /// Its name in the table and in `fails`; the quantity's own if it is empty.
    #[serde(default)]
    pub label: String,
    /// Lower bound.
    pub at_least: Option<f64>,
    /// Upper bound.
    pub at_most: Option<f64>,
    /// Component of a probe: `tip.x`.
    #[serde(default)]
    pub probe: String,
    /// What is taken of a probe's curve.
    #[serde(default)]
    pub of: Of,
    /// Where the part of the curve that counts begins, or of the frames for `outside`, s.
    pub from: Option<f64>,
    /// The probe's value, or its range, is given over this.
    pub over: Option<f64>,
    /// For `beyond`: 0 for x, 1 for y.
    #[serde(default)]
    pub axis: usize,
    /// For `beyond`: the place of the surface, m.
    #[serde(default)]
    pub at: f64,
    /// For `beyond`: the forbidden side is that of larger values.
    #[serde(default)]
    pub above: bool,
    /// For `beyond`: only particles whose other coordinate lies here count, m.
    pub between: Option<[f64; 2]>,
    /// For `outside`: corners of the region, in order, m.
    #[serde(default)]
    pub region: Vec<[f64; 2]>,
    /// For `difference`: overrides of the run to compare with.
    #[serde(default)]
    pub to_run: Vec<String>,
    /// The criterion does not hold today, and why: a known limit, asserted to be one.
    #[serde(default)]
    pub limit: String,
}

/// Quantities.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum What {
    /// Smallest distance between fluid and solid particles over all steps, dx.
    Gap,
    /// Largest unexplained energy of any phase over the energy in play.
    EnergyGrowth,
    /// Largest drift of momentum where nothing outside acts.
    Momentum,
    /// Fluid particles taken out because they left the domain, over their number at the start.
    Removed,
    /// Something of a probe's curve.
    Probe,
    /// How far a fluid particle got beyond a surface in any frame, dx; below 0: how far the nearest stayed away.
    Beyond,
    /// The same for a solid particle.
    SolidBeyond,
    /// How far a fluid particle got out of a region in any frame, dx; below 0: how far the nearest stayed inside.
    Outside,
    /// Pieces of the solid in the last frame, for neighbours at most 1.5 dx apart.
    Pieces,
    /// Largest solid sub-steps.
    SubSteps,
    /// Largest difference of a probe's curve to that of another run, over the other's range.
    Difference,
    /// Time reached over `end_time`, minus 1, in size.
    EndTime,
    /// Largest mismatch of the forces on both sides.
    ActionReaction,
}

/// What is taken of a probe's curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Of {
    /// Last value.
    #[default]
    Last,
    /// Largest value.
    Max,
    /// Mean over time.
    Mean,
    /// Largest minus smallest value.
    Range,
    /// Slope of the line through it by least squares, 1/s.
    Rate,
}

/// A criterion's value in a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The criterion.
    pub label: String,
    /// Value of the criterion; NaN where the run did not get that far.
    pub value: f64,
    /// Whether it holds.
    pub holds: bool,
}

impl Criterion {
    /// Its name.
    pub fn label(&self) -> String {
        if !self.label.is_empty() {
            return self.label.clone();
        }
        match self.what {
            What::Gap => "gap, dx",
            What::EnergyGrowth => "energy growth",
            What::Momentum => "momentum drift",
            What::Removed => "part removed",
            What::Probe => return self.probe.clone(),
            What::Beyond => "behind the wall, dx",
            What::SolidBeyond => "solid behind the wall, dx",
            What::Outside => "out of the walls, dx",
            What::Pieces => "pieces",
            What::SubSteps => "sub-steps",
            What::Difference => "difference",
            What::EndTime => "end_time missed by",
            What::ActionReaction => "action and reaction",
        }
        .into()
    }

    /// Its bounds as text.
    pub fn bounds(&self) -> String {
        match (self.at_least, self.at_most) {
            (Some(low), Some(high)) if low == high => format!("= {}", short(low)),
            (Some(low), Some(high)) => format!("{} to {}", short(low), short(high)),
            (Some(low), None) => format!("≥ {}", short(low)),
            (None, Some(high)) => format!("≤ {}", short(high)),
            (None, None) => String::new(),
        }
    }

    fn measure(&self, run: &Outcome, report: &RunReport, dx: f64, other: Option<&Outcome>) -> f64 {
        let audit = &report.audit;
        match self.what {
            What::Gap => audit.min_gap.unwrap_or(f64::INFINITY),
            What::EnergyGrowth => {
                let both = [audit.energy_growth.fluid, audit.energy_growth.solid];
                both.into_iter().flatten().fold(f64::NAN, f64::max)
            }
            What::Momentum => audit.momentum_drift.unwrap_or(f64::NAN),
            What::Removed => report.particles.removed as f64 / report.particles.fluid as f64,
            What::Probe => self.of_curve(run),
            What::Beyond => self.farthest(&run.frames_or_empty("fluid"), FLUID) / dx,
            What::SolidBeyond => self.farthest(&run.frames_or_empty("solid"), SOLID) / dx,
            What::Outside => {
                let from = self.from.unwrap_or(0.0);
                let frames = run.frames_or_empty("fluid").into_iter().filter(|frame| frame.time >= from);
                let distances = frames.map(|frame| {
                    let own = places(&frame, FLUID).map(|place| outside(&self.region, place));
                    own.fold(f64::NEG_INFINITY, f64::max)
                });
                distances.fold(f64::NEG_INFINITY, f64::max) / dx
            }
            What::Pieces => {
                let Some(frame) = run.frames_or_empty("solid").pop() else { return f64::NAN };
                let points: Vec<_> = places(&frame, SOLID).collect();
                cluster::sizes(&points, 1.5 * dx).len() as f64
            }
            What::SubSteps => report.sub_steps.map_or(f64::NAN, f64::from),
            What::Difference => other.map_or(f64::NAN, |other| self.difference(run, other)),
            What::EndTime => {
                let end = report.scene["end_time"].as_f64().unwrap_or(f64::NAN);
                (report.time / end - 1.0).abs()
            }
            What::ActionReaction => audit.action_reaction.unwrap_or(f64::NAN),
        }
    }

    fn curve(&self, run: &Outcome) -> crate::Curve {
        let curve = crate::Curve::of(&run.probes(), &self.probe);
        curve.between(self.from.unwrap_or(0.0), f64::INFINITY)
    }

    fn of_curve(&self, run: &Outcome) -> f64 {
        let curve = self.curve(run);
        let most = |sign: f64| sign * curve.values.iter().fold(f64::NEG_INFINITY, |m, v| m.max(sign * v));
        let value = match self.of {
            Of::Last => curve.values.last().copied().unwrap_or(f64::NAN),
            Of::Max => most(1.0),
            Of::Mean => curve.mean(),
            Of::Range => most(1.0) - most(-1.0),
            Of::Rate => curve.slope(),
        };
        value / self.over.unwrap_or(1.0)
    }

    fn difference(&self, run: &Outcome, other: &Outcome) -> f64 {
        let (one, two) = (self.curve(run), self.curve(other));
        let range = two.values.iter().fold(f64::NEG_INFINITY, |m, v| m.max(*v))
            - two.values.iter().fold(f64::INFINITY, |m, v| m.min(*v));
        let last = one.times.last().copied().unwrap_or(0.0);
        let pairs = two.times.iter().zip(&two.values).filter(|(t, _)| **t <= last);
        pairs.map(|(&t, v)| (one.at(t) - v).abs()).fold(0.0, f64::max) / range
    }

    fn farthest(&self, frames: &[Frame], phase: u8) -> f64 {
        let sign = if self.above { 1.0 } else { -1.0 };
        let [low, high] = self.between.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        let all = frames.iter().flat_map(|frame| places(frame, phase));
        all.filter(|x| (low..=high).contains(&x[1 - self.axis]))
            .map(|x| sign * (x[self.axis] - self.at))
            .fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Distance of a place from a polygon, m; below 0 inside of it.
fn outside(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> f64 {
    let (mut nearest, mut inside) = (f64::INFINITY, false);
    for (k, &[x1, y1]) in corners.iter().enumerate() {
        let [x2, y2] = corners[(k + 1) % corners.len()];
        let (dx, dy) = (x2 - x1, y2 - y1);
        let along = (((x - x1) * dx + (y - y1) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        nearest = nearest.min((x1 + along * dx - x).hypot(y1 + along * dy - y));
        if (y1 > y) != (y2 > y) && x < x1 + (y - y1) / dy * dx {
            inside = !inside;
        }
    }
    if inside { -nearest } else { nearest }
}

fn places(frame: &Frame, phase: u8) -> impl Iterator<Item = [f64; 2]> + '_ {
    let own = (0..frame.len()).filter(move |&k| frame.phase[k] == phase);
    own.map(|k| [f64::from(frame.points[k][0]), f64::from(frame.points[k][1])])
}

/// A number as the table shows it.
pub(super) fn short(value: f64) -> String {
    match value.abs() {
        _ if value.is_nan() => "none".into(),
        a if a.is_infinite() => "far".into(),
        0.0 => "0".into(),
        a if (1e-2..1e4).contains(&a) => {
            let text = format!("{value:.3}");
            text.trim_end_matches('0').trim_end_matches('.').into()
        }
        _ => format!("{value:.1e}"),
    }
}

/// All criteria of a run, with those that hold for every case before them: it finished, and nothing is NaN. `others`
/// has the run to compare with for each criterion that asks for one.
pub fn evaluate(criteria: &[Criterion], run: &Outcome, dx: f64, others: &[Option<Outcome>]) -> Vec<Measured> {
    let report = run.report();
    let finished = report.status == Some(RunStatus::Finished) && run.code() == Some(0);
    let mut all =
        vec![Measured { label: "finished".into(), value: report.time, holds: finished && numbers(run) }];
    for (criterion, other) in criteria.iter().zip(others) {
        let value = criterion.measure(run, &report, dx, other.as_ref());
        let holds = !value.is_nan()
            && criterion.at_least.is_none_or(|low| value >= low)
            && criterion.at_most.is_none_or(|high| value <= high);
        all.push(Measured { label: criterion.label(), value, holds });
    }
    all
}

/// Every number of probes and frames is one.
fn numbers(run: &Outcome) -> bool {
    let probes = run.probes();
    let rows = probes
        .columns
        .iter()
        .all(|name| probes.column(name).is_some_and(|values| values.iter().all(|v| v.is_finite())));
    let frames =
        ["fluid", "solid"].into_iter().filter(|s| run.dir.join(format!("frames/{s}.hdf.series")).exists());
    rows && frames.flat_map(|stem| run.frames_or_empty(stem)).all(|frame| {
        let finite = |column: &[[f32; 3]]| column.as_flattened().iter().all(|v| v.is_finite());
        finite(&frame.points) && finite(&frame.velocity) && frame.pressure.iter().all(|p| p.is_finite())
    })
}

#[cfg(test)]
mod tests {
    use super::outside;

    #[test]
    fn distances_from_a_triangle() {
        let triangle = [[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]];
        // Its inscribed circle has the radius 1 and the middle (1, 1).
        assert!((outside(&triangle, [1.0, 1.0]) + 1.0).abs() < 1e-15);
        assert!((outside(&triangle, [2.0, -0.5]) - 0.5).abs() < 1e-15);
        assert!((outside(&triangle, [7.0, 4.0]) - 5.0).abs() < 1e-15);
    }
}
