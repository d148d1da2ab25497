//! The numbers that metrics take from curves.

use crate::reference::{in_common, literature};
use crate::report::short;
use halfstep_output::Table;
use halfstep_scene::{Metric, MetricKind, Scene};

/// Why a number cannot be taken from a curve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unmeasured {
    /// The probe has no such column.
    #[error("probes.csv has no column {0}")]
    NoColumn(String),
    /// The curve ends too early.
    #[error("needs t = {needed} s, and the curve ends at {end} s")]
    EndsEarly {
        /// s.
        needed: f64,
        /// s.
        end: f64,
    },
    /// There is nothing in the window.
    #[error("has fewer than two values in its window")]
    Empty,
    /// A value is NaN or infinite.
    #[error("meets a value that is no number")]
    NotFinite,
    /// The curve never exceeds the level.
    #[error("never exceeds its level")]
    Below,
    /// The curve does not pass the level often enough.
    #[error("passes its level {0} times, a period needs two")]
    NoOscillation(usize),
    /// No logarithm exists.
    #[error("meets a value at its level, from which nothing decays")]
    AtLevel,
}

/// Points (time s, value), ascending in time.
pub type Curve = Vec<[f64; 2]>;

/// The metric's number in a run's probes.
///
/// # Errors
/// The curve does not hold it.
pub fn measure(scene: &Scene, metric: &Metric, probes: &Table) -> Result<f64, Unmeasured> {
    let values = probes.column(&metric.probe).ok_or_else(|| Unmeasured::NoColumn(metric.probe.clone()))?;
    let curve: Curve = probes.times().into_iter().zip(values).map(|(t, v)| [t, v]).collect();
    match (&metric.kind, literature(scene, metric)) {
        (MetricKind::Rms, Some(reference)) => rms(metric, &curve, reference),
        (_, Some(reference)) => {
            let end = curve.last().ok_or(Unmeasured::Empty)?[0];
            number(&in_common(metric, end, reference), &curve)
        }
        _ => number(metric, &curve),
    }
}

/// What a metric's number is not: a peak is the largest value and not the largest in size, and extremes are of rows.
pub fn remark(metric: &Metric, probes: &Table) -> Option<String> {
    let values = probes.column(&metric.probe)?;
    let curve: Curve = probes.times().into_iter().zip(values).map(|(t, v)| [t, v]).collect();
    let part = window(metric, &curve).ok()?;
    match metric.kind {
        MetricKind::Peak => of_what_is_negative(metric, &part).or_else(|| between_rows(metric, &part, 1.0)),
        MetricKind::Trough => between_rows(metric, &part, -1.0),
        MetricKind::Range => [1.0, -1.0].iter().find_map(|&sign| between_rows(metric, &part, sign)),
        _ => None,
    }
}

fn of_what_is_negative(metric: &Metric, part: &Curve) -> Option<String> {
    let [least, largest] = range(part);
    (-least > MUCH * largest.abs().max(f64::MIN_POSITIVE) || largest < 0.0).then(|| {
        format!(
            "`{}` is the largest value of {}, {}, which goes down to {}: `peak` is not the largest in size \
             (`trough` is the least value)",
            metric.name,
            metric.probe,
            short(largest),
            short(least)
        )
    })
}

/// The parabola through an extreme row and its neighbours goes farther than the row, by a part of the curve's range.
fn between_rows(metric: &Metric, part: &Curve, sign: f64) -> Option<String> {
    let [least, largest] = range(part);
    let top = (0..part.len()).reduce(|a, b| if sign * part[b][1] > sign * part[a][1] { b } else { a })?;
    let [before, row, after] = [part.get(top.checked_sub(1)?)?, &part[top], part.get(top + 1)?];
    let slopes = [[before, row], [row, after]].map(|[a, b]| (b[1] - a[1]) / (b[0] - a[0]));
    let curvature = (slopes[1] - slopes[0]) / (after[0] - before[0]);
    let slope = (slopes[0] * (after[0] - row[0]) + slopes[1] * (row[0] - before[0])) / (after[0] - before[0]);
    // Of the parabola row + slope s + curvature s².
    let beyond = sign * -slope * slope / (4.0 * curvature);
    (beyond > BETWEEN * (largest - least)).then(|| {
        format!(
            "`{}` has {} from the row at t = {} s, and a parabola through it and its neighbours goes on by {:.0} % of \
             the curve's range: rows nearer to each other (output.probe_interval) would see more of the extreme",
            metric.name,
            short(row[1]),
            short(row[0]),
            100.0 * beyond / (largest - least)
        )
    })
}

/// The least and the largest value.
fn range(part: &Curve) -> [f64; 2] {
    part.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], p| [l.min(p[1]), h.max(p[1])])
}

/// Part of a curve's range by which an extreme may lie between rows.
const BETWEEN: f64 = 0.01;

/// Least value of a curve over its largest, from which on a peak is hardly meant.
const MUCH: f64 = 3.0;

pub(super) fn number(metric: &Metric, curve: &Curve) -> Result<f64, Unmeasured> {
    if let MetricKind::Value { at } = metric.kind {
        return value_at(curve, at);
    }
    let part = window(metric, curve)?;
    let extreme = |beyond: fn(&f64, &f64) -> bool| {
        let farther = |a: [f64; 2], b: [f64; 2]| if beyond(&b[1], &a[1]) { b } else { a };
        part.iter().copied().reduce(farther).ok_or(Unmeasured::Empty)
    };
    match metric.kind {
        MetricKind::Peak => extreme(f64::gt).map(|p| p[1]),
        MetricKind::PeakTime => extreme(f64::gt).map(|p| p[0]),
        MetricKind::Trough => extreme(f64::lt).map(|p| p[1]),
        MetricKind::TroughTime => extreme(f64::lt).map(|p| p[0]),
        MetricKind::Range => {
            let [least, largest] = range(&part);
            Ok(largest - least)
        }
        MetricKind::FirstAbove { level } => first_above(&part, level),
        MetricKind::Mean => Ok(mean(&part)),
        MetricKind::Period { level } => period(&part, level),
        MetricKind::Decay { level } => decay(&part, level),
        // A period and a decay need more than a window; the callers compute them.
        MetricKind::Value { .. } | MetricKind::Rms => Err(Unmeasured::Empty),
    }
}

/// Linear between points; a curve that begins above the level does so at its first point.
fn first_above(curve: &Curve, level: f64) -> Result<f64, Unmeasured> {
    let later = curve.iter().position(|p| p[1] > level).ok_or(Unmeasured::Below)?;
    let [t, v] = curve[later];
    let Some([before, low]) = later.checked_sub(1).map(|k| curve[k]) else { return Ok(t) };
    Ok(before + (t - before) * (level - low) / (v - low))
}

/// The points from `from` to `to`. A run's last row may lie a step before the time that is asked for.
fn window(metric: &Metric, curve: &Curve) -> Result<Curve, Unmeasured> {
    let last = curve.last().ok_or(Unmeasured::Empty)?[0];
    let to = metric.to.unwrap_or(last);
    if to > last * (1.0 + 1e-9) {
        return Err(Unmeasured::EndsEarly { needed: to, end: last });
    }
    let inside = |p: &&[f64; 2]| metric.from <= p[0] && p[0] <= to * (1.0 + 1e-9);
    let part: Curve = curve.iter().filter(inside).copied().collect();
    match part.len() {
        0 | 1 => Err(Unmeasured::Empty),
        _ if part.iter().any(|p| !p[1].is_finite()) => Err(Unmeasured::NotFinite),
        _ => Ok(part),
    }
}

/// Value at a time, linear between points.
pub(super) fn value_at(curve: &Curve, at: f64) -> Result<f64, Unmeasured> {
    let last = curve.last().ok_or(Unmeasured::Empty)?[0];
    if at > last * (1.0 + 1e-9) {
        return Err(Unmeasured::EndsEarly { needed: at, end: last });
    }
    if curve.len() < 2 {
        return Err(Unmeasured::Empty);
    }
    let next = curve.partition_point(|p| p[0] < at).clamp(1, curve.len() - 1);
    let ([t0, v0], [t1, v1]) = (curve[next - 1], curve[next]);
    let value = v0 + (v1 - v0) * (at - t0) / (t1 - t0);
    if value.is_finite() { Ok(value) } else { Err(Unmeasured::NotFinite) }
}

/// Mean over time, by trapezoids.
fn mean(part: &Curve) -> f64 {
    let area: f64 = part.windows(2).map(|w| 0.5 * (w[0][1] + w[1][1]) * (w[1][0] - w[0][0])).sum();
    area / (part[part.len() - 1][0] - part[0][0])
}

/// Root mean square of curve minus reference at the reference's times, over the scale or else over the reference's.
fn rms(metric: &Metric, curve: &Curve, reference: &Curve) -> Result<f64, Unmeasured> {
    let last = curve.last().ok_or(Unmeasured::Empty)?[0];
    let to = metric.to.unwrap_or(last);
    let (mut difference, mut size, mut count) = (0.0, 0.0, 0.0);
    for [time, value] in reference.iter().filter(|p| metric.from <= p[0] && p[0] <= to) {
        difference += (value_at(curve, *time)? - value).powi(2);
        size += value * value;
        count += 1.0;
    }
    let scale = metric.scale.unwrap_or_else(|| f64::sqrt(size / count));
    if count == 0.0 || scale == 0.0 {
        Err(Unmeasured::Empty)
    } else {
        Ok((difference / count).sqrt() / scale)
    }
}

/// Times at which the curve passes a level.
fn crossings(part: &[[f64; 2]], level: f64) -> Vec<f64> {
    let passes = part.windows(2).filter(|w| (w[0][1] < level) != (w[1][1] < level));
    passes.map(|w| w[0][0] + (w[1][0] - w[0][0]) * (level - w[0][1]) / (w[1][1] - w[0][1])).collect()
}

/// Twice the mean distance between crossings.
fn period(part: &Curve, level: f64) -> Result<f64, Unmeasured> {
    // A curve that starts at its level passes it then, whichever way it goes.
    let at_start = part[0][1] == level;
    let mut times = crossings(&part[usize::from(at_start)..], level);
    if at_start {
        times.insert(0, part[0][0]);
    }
    match (times.first(), times.last()) {
        (Some(first), Some(last)) if times.len() > 1 => Ok(2.0 * (last - first) / (times.len() - 1) as f64),
        _ => Err(Unmeasured::NoOscillation(times.len())),
    }
}

/// Slope of a line through ln |value - level| by least squares: through the extremes between crossings where the
/// curve oscillates about the level, through all points where it does not.
fn decay(part: &Curve, level: f64) -> Result<f64, Unmeasured> {
    let times = crossings(part, level);
    let points: Curve = if times.len() > 2 {
        let extreme = |w: &[f64]| {
            let between = part.iter().filter(|p| w[0] < p[0] && p[0] < w[1]);
            between.copied().reduce(|a, b| if (b[1] - level).abs() > (a[1] - level).abs() { b } else { a })
        };
        times.windows(2).filter_map(extreme).collect()
    } else {
        part.clone()
    };
    if points.iter().any(|p| p[1] == level) {
        return Err(Unmeasured::AtLevel);
    }
    let n = points.len() as f64;
    let logs: Curve = points.iter().map(|p| [p[0], (p[1] - level).abs().ln()]).collect();
    let [t, y] = [0, 1].map(|k| logs.iter().map(|p| p[k]).sum::<f64>() / n);
    let spread: f64 = logs.iter().map(|p| (p[0] - t).powi(2)).sum();
    let slope: f64 = logs.iter().map(|p| (p[0] - t) * (p[1] - y)).sum::<f64>() / spread;
    if slope.is_finite() { Ok(-slope) } else { Err(Unmeasured::Empty) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metric(kind: MetricKind) -> Metric {
        let name = String::from("m");
        Metric { name, probe: "p.x".into(), kind, from: 0.0, to: None, reference: None, scale: None }
    }

    fn sampled(f: impl Fn(f64) -> f64) -> Curve {
        (0..=2000).map(|k| 1e-3 * f64::from(k)).map(|t| [t, f(t)]).collect()
    }

    #[test]
    fn a_peak_of_what_is_negative_is_told() {
        let metric = |from: f64| Metric { from, ..metric(MetricKind::Peak) };
        let table = |values: &[f64]| {
            let rows = values.iter().enumerate().map(|(k, v)| vec![k as f64, *v]).collect();
            Table { columns: vec!["time [s]".into(), "p.x [m]".into()], rows }
        };
        let sags = table(&[0.0, -0.008, 1e-5, -0.005]);
        let said = "`m` is the largest value of p.x, 1.000e-5, which goes down to -0.008000: `peak` is not the largest \
                    in size (`trough` is the least value)";
        assert_eq!(remark(&metric(0.0), &sags).as_deref(), Some(said));
        assert_eq!(remark(&metric(0.0), &table(&[0.0, -0.2, 0.1])), None);
        assert!(remark(&metric(1.0), &table(&[5.0, -3.0, -2.0])).is_some_and(|said| said.contains("-2.000")));
    }

    #[test]
    fn an_extreme_between_rows_is_told() {
        let table = |interval: f64| {
            let row = |k: u32| interval * (f64::from(k) + 0.5);
            let rows = (0..(1.2 / interval) as u32).map(|k| vec![row(k), (6.0 * row(k)).sin()]).collect();
            Table { columns: vec!["time [s]".into(), "p.x [m]".into()], rows }
        };
        let of = |kind, interval| remark(&metric(kind), &table(interval));
        // Eight rows a period, at 0.063 s from the largest value.
        let said = "`m` has 0.9290 from the row at t = 0.3250 s, and a parabola through it and its neighbours goes on by 3 \
                    % of the curve's range: rows nearer to each other (output.probe_interval) would see more of the \
                    extreme";
        assert_eq!(of(MetricKind::Peak, 0.13).as_deref(), Some(said));
        assert!(of(MetricKind::Trough, 0.13).is_some_and(|said| said.contains("by 3 %")));
        assert!(of(MetricKind::Range, 0.13).is_some_and(|said| said.contains("by 3 %")));
        assert_eq!(of(MetricKind::Peak, 0.01), None);
        assert_eq!(of(MetricKind::Range, 0.01), None);
        assert_eq!(of(MetricKind::Trough, 0.01), None);
        assert_eq!(of(MetricKind::Mean, 0.13), None);
    }

    #[test]
    fn a_damped_wave_has_its_period_decay_and_peak() {
        let wave = sampled(|t| 0.5 + (-0.7 * t).exp() * (std::f64::consts::TAU * t / 0.3).sin());
        let of = |kind| number(&metric(kind), &wave).unwrap();
        assert!((of(MetricKind::Period { level: 0.5 }) - 0.3).abs() < 1e-4);
        assert!((of(MetricKind::Decay { level: 0.5 }) - 0.7).abs() < 1e-3);
        assert!((of(MetricKind::PeakTime) - 0.075).abs() < 3e-3);
        assert!((of(MetricKind::Peak) - 0.5 - (-0.7_f64 * 0.075).exp()).abs() < 1e-3);
        assert!((of(MetricKind::TroughTime) - 0.225).abs() < 3e-3);
        assert!((of(MetricKind::Trough) - 0.5 + (-0.7_f64 * 0.225).exp()).abs() < 1e-3);
        let both = (-0.7_f64 * 0.075).exp() + (-0.7_f64 * 0.225).exp();
        assert!((of(MetricKind::Range) - both).abs() < 2e-3);
    }

    #[test]
    fn a_start_at_the_level_counts_once_both_ways() {
        for sign in [1.0, -1.0] {
            let wave = sampled(|t| sign * (std::f64::consts::TAU * t / 1.6).sin());
            let period = number(&metric(MetricKind::Period { level: 0.0 }), &wave[..1001].to_vec());
            assert!((period.unwrap() - 1.6).abs() < 1e-6);
        }
    }

    #[test]
    fn a_curve_that_only_falls_has_a_decay_and_no_period() {
        let fall = sampled(|t| 3.0 * (-1.5 * t).exp());
        assert!((number(&metric(MetricKind::Decay { level: 0.0 }), &fall).unwrap() - 1.5).abs() < 1e-9);
        let period = number(&metric(MetricKind::Period { level: 0.0 }), &fall);
        assert_eq!(period, Err(Unmeasured::NoOscillation(0)));
        let ended = number(&metric(MetricKind::Decay { level: 0.0 }), &sampled(|t| (1.0 - t).max(0.0)));
        assert_eq!(ended, Err(Unmeasured::AtLevel));
    }

    #[test]
    fn values_and_means_are_those_of_the_line_between_points() {
        let line = vec![[0.0, 1.0], [1.0, 3.0], [3.0, 3.0]];
        assert_eq!(number(&metric(MetricKind::Value { at: 0.25 }), &line), Ok(1.5));
        let above = |level| number(&metric(MetricKind::FirstAbove { level }), &line);
        assert_eq!([above(0.5), above(1.5), above(3.0)], [Ok(0.0), Ok(0.25), Err(Unmeasured::Below)]);
        let late = number(&metric(MetricKind::Value { at: 3.5 }), &line);
        assert_eq!(late, Err(Unmeasured::EndsEarly { needed: 3.5, end: 3.0 }));
        // (2 * 1 + 3 * 2) / 3
        assert!((number(&metric(MetricKind::Mean), &line).unwrap() - 8.0 / 3.0).abs() < 1e-12);
        let late = Metric { from: 1.0, to: Some(3.0), ..metric(MetricKind::Mean) };
        assert_eq!(number(&late, &line), Ok(3.0));
        assert_eq!(number(&Metric { from: 2.0, to: None, ..late }, &line), Err(Unmeasured::Empty));
    }

    #[test]
    fn the_rms_is_relative_to_the_reference_or_to_the_scale() {
        let line = sampled(|t| 2.0 * t);
        let reference = vec![[0.5, 1.3], [0.7, 1.0], [9.0, 7.0]];
        // Differences -0.3 and 0.4; the reference's own root mean square is sqrt(1.345).
        let want = 0.125_f64.sqrt() / 1.345_f64.sqrt();
        assert!((rms(&metric(MetricKind::Rms), &line, &reference).unwrap() - want).abs() < 1e-9);
        let scaled = Metric { scale: Some(2.0), ..metric(MetricKind::Rms) };
        assert!((rms(&scaled, &line, &reference).unwrap() - 0.125_f64.sqrt() / 2.0).abs() < 1e-9);
    }
}
