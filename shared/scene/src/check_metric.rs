//! What must hold between a metric and the rest of the scene.

use super::check::Check;
use super::error::{listed, nearest};
use super::*;

impl Check<'_> {
    pub(super) fn metrics(&self) {
        if self.report.has("metric") {
            return;
        }
        let names: Vec<&str> = self.scene.metrics.iter().map(|m| m.name.as_str()).collect();
        self.unique("metric", &names);
        for metric in &self.scene.metrics {
            if !self.report.has_any(&["probe"]) {
                self.metric_probe(metric);
            }
            if !self.report.has_any(&["probe", "reference"]) {
                self.metric_curve(metric);
            }
            self.metric_times(metric);
        }
    }

    fn metric_probe(&self, metric: &Metric) {
        let key = format!("metric.{}.probe", metric.name);
        self.component(&key, &metric.probe);
    }

    fn metric_curve(&self, metric: &Metric) {
        let Some(MetricReference::Curve { label }) = &metric.reference else { return };
        let of_probe = self.scene.references.iter().filter(|r| r.probe == metric.probe);
        let labels: Vec<&str> = of_probe.map(|r| r.label.as_str()).collect();
        if labels.contains(&label.as_str()) {
            return;
        }
        let key = format!("metric.{}.reference", metric.name);
        let reason = format!("is no label of a [[reference]] for {}", metric.probe);
        let note = self.report.value(&key, self.root.origin_of(&key), reason);
        match nearest(label, labels.iter().copied()) {
            Some(near) => note.help(format!("did you mean `{near}`?")),
            None if labels.is_empty() => note.help("the scene has no such [[reference]]"),
            None => note.help(format!("the labels are {}", listed(labels, "and"))),
        }
    }

    /// Times beyond the scene's own end are a slip; beyond an end that was overridden they are not, and such a metric
    /// is left out of a study.
    fn metric_times(&self, metric: &Metric) {
        let end = self.scene.end_time;
        if metric.needs() <= end || self.report.has("end_time") || self.is_overridden("end_time") {
            return;
        }
        let part = match (metric.kind, metric.to) {
            (MetricKind::Value { .. }, _) => "at",
            (_, Some(_)) => "to",
            _ => "from",
        };
        let key = format!("metric.{}.{part}", metric.name);
        self.report.value(&key, self.root.origin_of(&key), format!("must be at most end_time, {end} s"));
    }
}
