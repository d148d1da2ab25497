//! What a study compares: single numbers taken from the curve of a probe, and what they should be.

use serde::{Deserialize, Serialize};

/// A number taken from a probe's curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Metric {
    /// Name of the metric.
    pub name: String,
    /// Probe component that it is taken from, e.g. `tip.x`.
    pub probe: String,
    /// Which number.
    pub kind: MetricKind,
    /// The part of the curve that counts begins here, s.
    pub from: f64,
    /// And ends here, s; `None`: at the end of the run.
    pub to: Option<f64>,
    /// Reference: the value that the metric should have.
    pub reference: Option<MetricReference>,
    /// What errors are taken relative to; `None`: the size of the reference.
    pub scale: Option<f64>,
}

/// The numbers that can be taken from a curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MetricKind {
    /// Largest value.
    Peak,
    /// Time of the largest value, s.
    PeakTime,
    /// Least value.
    Trough,
    /// Time of the least value, s.
    TroughTime,
    /// Largest value less the least.
    Range,
    /// Root mean square of the difference to a curve of the literature, over that of the curve.
    Rms,
    /// Value at a time.
    Value {
        /// The time, s.
        at: f64,
    },
    /// Mean period of the oscillation about a level, s.
    Period {
        /// The level.
        level: f64,
    },
    /// Mean over time.
    Mean,
    /// Time at which it first exceeds a level, s.
    FirstAbove {
        /// The level.
        level: f64,
    },
    /// Rate of exponential decay toward a level, 1/s.
    Decay {
        /// The level.
        level: f64,
    },
}

/// Reference of a metric.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MetricReference {
    /// A number.
    Number {
        /// Value in the probe's unit.
        value: f64,
        /// Where it comes from.
        source: String,
    },
    /// The same number taken from a curve of the literature.
    Curve {
        /// The curve's label.
        label: String,
    },
}

impl MetricKind {
    /// Unit of the number for a curve of this unit; empty for a pure number.
    pub fn unit<'u>(&self, of_curve: &'u str) -> &'u str {
        match self {
            Self::Peak | Self::Trough | Self::Range | Self::Value { .. } | Self::Mean => of_curve,
            Self::PeakTime | Self::TroughTime | Self::FirstAbove { .. } | Self::Period { .. } => "s",
            Self::Decay { .. } => "1/s",
            Self::Rms => "",
        }
    }
}

impl Metric {
    /// The last time that the metric names, s.
    pub fn needs(&self) -> f64 {
        match self.kind {
            MetricKind::Value { at } => at,
            _ => self.to.unwrap_or(self.from),
        }
    }
}
