//! `[[metric]]`.

use super::document::Value;
use super::read_shape::name;
use super::section::{Range, Section};
use super::*;

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    Peak,
    PeakTime,
    Trough,
    TroughTime,
    Range,
    FirstAbove,
    Rms,
    Value,
    Period,
    Mean,
    Decay,
}

pub(crate) const KINDS: [(&str, Kind); 11] = [
    ("peak", Kind::Peak),
    ("peak-time", Kind::PeakTime),
    ("trough", Kind::Trough),
    ("trough-time", Kind::TroughTime),
    ("range", Kind::Range),
    ("first-above", Kind::FirstAbove),
    ("rms", Kind::Rms),
    ("value", Kind::Value),
    ("period", Kind::Period),
    ("mean", Kind::Mean),
    ("decay", Kind::Decay),
];

/// A metric; `None` where it is not clear what it measures.
pub(super) fn metric(section: Section<'_>) -> Option<Metric> {
    let name = name(&section);
    if section.node("probe").is_none() {
        section.missing("probe");
    }
    let probe = section.string("probe").map(str::to_owned);
    // Without a kind its other keys mean nothing: they are not looked at.
    let kind = section.choice("kind", None, &KINDS)?;
    let level = || section.number("level", Some(0.0));
    let read = match kind {
        Kind::Peak => MetricKind::Peak,
        Kind::PeakTime => MetricKind::PeakTime,
        Kind::Trough => MetricKind::Trough,
        Kind::TroughTime => MetricKind::TroughTime,
        Kind::Range => MetricKind::Range,
        Kind::FirstAbove => MetricKind::FirstAbove { level: level() },
        Kind::Rms => MetricKind::Rms,
        Kind::Value => MetricKind::Value { at: section.number("at", None) },
        Kind::Period => MetricKind::Period { level: level() },
        Kind::Mean => MetricKind::Mean,
        Kind::Decay => MetricKind::Decay { level: level() },
    };
    let (from, to) = if kind == Kind::Value { (0.0, None) } else { window(&section) };
    let reference = reference(&section, kind);
    let scale = section.node("scale").map(|_| section.number("scale", None));
    if let (Some(MetricReference::Number { value: 0.0, .. }), None) = (&reference, scale)
        && let Some(node) = section.node("reference")
    {
        section.wrong("reference", node, "needs a `scale`: there is no relative error to 0");
    }
    section.finish();
    Some(Metric { name, probe: probe?, kind: read, from, to, reference, scale })
}

fn window(section: &Section<'_>) -> (f64, Option<f64>) {
    let from = section.number("from", Some(0.0));
    let to = section.node("to").map(|_| section.number("to", None));
    if let (Some(end), Some(node)) = (to, section.node("to"))
        && end <= from
    {
        section.wrong("to", node, format!("must be greater than `from`, {from} s"));
    }
    (from, to)
}

fn reference(section: &Section<'_>, kind: Kind) -> Option<MetricReference> {
    let source = section.string("source");
    let Some(node) = section.node("reference") else {
        if let Some(node) = section.node("source") {
            section.wrong("source", node, "belongs to a number as `reference`, and the metric has none");
        }
        if kind == Kind::Rms {
            section.missing("reference");
        }
        return None;
    };
    match &node.value {
        Value::String(label) => {
            if let Some(node) = section.node("source") {
                section.wrong(
                    "source",
                    node,
                    "belongs to a number as `reference`: a curve's label says its source",
                );
            }
            Some(MetricReference::Curve { label: label.clone() })
        }
        _ if kind == Kind::Rms => {
            section.wrong("reference", node, "must be the label of a [[reference]], a string");
            None
        }
        Value::Float(_) | Value::Integer(_) => {
            let value = section.as_number("reference", node, Range::ANY)?;
            if section.node("source").is_none() {
                section.missing("source");
            }
            Some(MetricReference::Number { value, source: source?.to_owned() })
        }
        _ => {
            section.wrong("reference", node, "must be a number or the label of a [[reference]]");
            None
        }
    }
}
