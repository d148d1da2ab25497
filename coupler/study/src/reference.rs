//! What the numbers of metrics are compared with, and over which time.

use super::measure::{Curve, number, value_at};
use super::report::short;
use halfstep_output::Table;
use halfstep_scene::{Metric, MetricKind, MetricReference, Scene};

/// Reference of a metric, with its source.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// The number.
    pub value: f64,
    /// Source of the reference.
    pub source: String,
    /// What errors are relative to.
    pub scale: f64,
}

/// The metric's reference as a number, where it has one.
pub fn target(scene: &Scene, metric: &Metric) -> Option<Target> {
    let (value, source) = match metric.reference.as_ref()? {
        MetricReference::Number { value, source } => (*value, source.clone()),
        MetricReference::Curve { label } if metric.kind == MetricKind::Rms => (0.0, label.clone()),
        MetricReference::Curve { label } => {
            let curve = literature(scene, metric)?;
            let metric = in_common(metric, scene.end_time, curve);
            (number(&metric, &until(curve, metric.to)).ok()?, label.clone())
        }
    };
    let scale = match metric.kind {
        // The measured number is relative already.
        MetricKind::Rms => 1.0,
        _ => metric.scale.unwrap_or(value.abs()),
    };
    Some(Target { value, source, scale })
}

/// A curve up to a time, at which it has a point.
fn until(curve: &Curve, to: Option<f64>) -> Curve {
    let Some(to) = to else { return curve.clone() };
    let mut part: Curve = curve.iter().filter(|point| point[0] <= to).copied().collect();
    if let (true, Ok(value)) = (part.last().is_some_and(|point| point[0] < to), value_at(curve, to)) {
        part.push([to, value]);
    }
    part
}

pub(super) fn literature<'s>(scene: &'s Scene, metric: &Metric) -> Option<&'s Curve> {
    let Some(MetricReference::Curve { label }) = &metric.reference else { return None };
    scene.references.iter().find(|r| r.probe == metric.probe && r.label == *label).map(|r| &r.points)
}

/// The metric over the time that a run and its reference's curve have in common, where the scene says no `to`.
pub(super) fn in_common(metric: &Metric, run_end: f64, reference: &Curve) -> Metric {
    let end = reference.last().map_or(run_end, |point| point[0]).min(run_end);
    Metric { to: metric.to.or(Some(end)), ..metric.clone() }
}

/// Part of a window that a run or a curve may lack without a word.
const LACKS: f64 = 0.01;
/// Points of a reference below which a mean distance says little.
const FEW: usize = 3;

/// What a comparison with a curve leaves out, since one of the two ends before the other.
pub fn left_out(scene: &Scene, metric: &Metric, probes: &Table) -> Option<String> {
    let reference = literature(scene, metric)?;
    let (end, other) = (*probes.times().last()?, reference.last()?[0]);
    let name = &metric.name;
    match metric.kind {
        MetricKind::Rms => {
            let to = metric.to.unwrap_or(f64::INFINITY);
            let wanted = reference.iter().filter(|p| metric.from <= p[0] && p[0] <= to).count();
            let met = reference.iter().filter(|p| metric.from <= p[0] && p[0] <= to.min(end)).count();
            (met < wanted && (met < FEW || 2 * met < wanted)).then(|| {
                format!(
                    "`{name}` knows {met} of the {wanted} points of its reference: the run ends at {} s",
                    short(end)
                )
            })
        }
        MetricKind::Value { .. } => None,
        _ if metric.to.is_some() || (end - other).abs() <= LACKS * end.max(other) => None,
        _ => {
            let [ends, goes] = if end < other { ["the run", "the curve"] } else { ["the curve", "the run"] };
            Some(format!(
                "`{name}` and its reference are of the time until {} s, when {ends} ends ({goes} goes on to {} s)",
                short(end.min(other)),
                short(end.max(other))
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::measure::measure;
    use super::*;

    /// A peak, and its reference's curve: 0.1 at 0.1 s, 0.4 at 0.4 s.
    fn beside_a_curve(end_time: f64, more: &str) -> (Scene, Metric) {
        let text = format!(
            "resolution = 0.01\nend_time = {end_time}\n[fluid]\ndensity = 1000.0\n\
             [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.1, 0.1] }}\n\
             [[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
             tank = {{ min = [0.0, 0.0], max = [0.1, 0.2], open = [\"top\"] }}\n\
             [[probe]]\nname = \"level\"\nkind = \"water-level\"\nx = 0.05\n\
             [[reference]]\nprobe = \"level.level\"\nlabel = \"line\"\npoints = [[0.0, 0.0], [0.1, 0.1], [0.4, 0.4]]\n\
             [[metric]]\nname = \"m\"\nprobe = \"level.level\"\n{more}\nreference = \"line\"\n"
        );
        let scene = halfstep_scene::parse(&text, std::path::Path::new("m.toml"), &[])
            .unwrap_or_else(|e| panic!("{e:?}"));
        let metric = scene.metrics[0].clone();
        (scene, metric)
    }

    #[test]
    fn a_curve_is_compared_over_the_time_that_both_have() {
        let run = |end: f64, metric: &Metric| {
            let rows = (0..=20).map(|k| end * f64::from(k) / 20.0).map(|t| vec![t, 2.0 * t]).collect();
            Table { columns: vec!["time [s]".into(), format!("{} [m]", metric.probe)], rows }
        };
        let of = |end: f64, more: &str| {
            let (scene, metric) = beside_a_curve(end, more);
            let table = run(end, &metric);
            let target = target(&scene, &metric).expect("a reference").value;
            (measure(&scene, &metric, &table).expect("a number"), target, left_out(&scene, &metric, &table))
        };
        let (own, reference, said) = of(0.2, "kind = \"peak\"");
        assert!((own - 0.4).abs() < 1e-12 && (reference - 0.2).abs() < 1e-12, "{own} {reference}");
        let ends = "`m` and its reference are of the time until 0.2000 s, when the run ends (the curve goes on to \
                    0.4000 s)";
        assert_eq!(said.as_deref(), Some(ends));
        let (own, reference, said) = of(0.8, "kind = \"peak\"");
        assert!((own - 0.8).abs() < 1e-12 && (reference - 0.4).abs() < 1e-12, "{own} {reference}");
        assert!(said.is_some_and(|text| {
            text.contains("until 0.4000 s, when the curve ends (the run goes on to 0.8000 s)")
        }));
        let (own, reference, said) = of(0.4, "kind = \"mean\"");
        assert!(
            (own - 0.4).abs() < 1e-12 && (reference - 0.2).abs() < 1e-12 && said.is_none(),
            "{own} {reference}"
        );
        let (_, _, said) = of(0.15, "kind = \"rms\"");
        let few = "`m` knows 2 of the 3 points of its reference: the run ends at 0.1500 s";
        assert_eq!(said.as_deref(), Some(few));
        assert_eq!(of(0.4, "kind = \"rms\"").2, None);
    }
}
