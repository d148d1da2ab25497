//! What is measured, and the curves that it is compared with.

use super::{Block, EnergyPart, Phase};
use serde::{Deserialize, Serialize};

/// Something measured while the run goes on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Probe {
    /// Name of the probe: the column's prefix in `probes.csv`.
    pub name: String,
    /// Quantity that the probe measures.
    pub kind: ProbeKind,
    /// Index of the solid that it measures in [`crate::Scene::solids`]; `None` for the fluid.
    pub solid: Option<usize>,
}

/// The kinds of probes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ProbeKind {
    /// Displacement of the solid particles nearest to a point of the initial configuration; components x, y (, z), m.
    Displacement {
        /// The point, m.
        at: [f64; 3],
    },
    /// Fluid pressure at a fixed point (kernel average of the fluid around), Pa.
    Pressure {
        /// The point, m.
        at: [f64; 3],
    },
    /// Highest fluid particle surface in the column at a place (against gravity), m.
    WaterLevel {
        /// x of the column, m.
        x: f64,
    },
    /// Farthest reach of the fluid along +x, m.
    Front,
    /// Kinetic energy of a phase, J (2D: J/m).
    KineticEnergy {
        /// Fluid or solid.
        #[serde(with = "crate::names::PhaseName")]
        phase: Phase,
    },
    /// The energy ledger of the fluid or of a solid since the start, J (2D: J/m): what it holds, and what it was given.
    Energy {
        /// Fluid or solid.
        #[serde(with = "crate::names::PhaseName")]
        phase: Phase,
        /// Only this part.
        part: Option<EnergyPart>,
    },
    /// Centre of mass of a phase; components x, y (, z), m.
    Centroid {
        /// Fluid or solid.
        #[serde(with = "crate::names::PhaseName")]
        phase: Phase,
    },
    /// Force of the fluid on the solid; components x, y (, z), N (2D: N/m).
    Force {
        /// Only on particles whose place in the initial configuration is in this box.
        within: Option<Block>,
    },
}

impl ProbeKind {
    /// The phase whose process measures it.
    pub fn phase(&self) -> Phase {
        match *self {
            Self::Displacement { .. } | Self::Force { .. } => Phase::Solid,
            Self::Pressure { .. } | Self::WaterLevel { .. } | Self::Front => Phase::Fluid,
            Self::KineticEnergy { phase } | Self::Centroid { phase } | Self::Energy { phase, .. } => phase,
        }
    }
    /// Components of the probe and their unit, in the order of the values.
    pub fn components(&self, dimension: usize) -> (&'static [&'static str], &'static str) {
        let axes = &["x", "y", "z"][..dimension];
        match self {
            Self::Displacement { .. } | Self::Centroid { .. } => (axes, "m"),
            Self::Pressure { .. } => (&["pressure"], "Pa"),
            Self::WaterLevel { .. } => (&["level"], "m"),
            Self::Front => (&["x"], "m"),
            Self::KineticEnergy { .. } => (&["energy"], "J"),
            Self::Energy { phase, part } => (EnergyPart::names(*phase, *part), "J"),
            Self::Force { .. } => (axes, "N"),
        }
    }
}

impl Probe {
    /// Columns of the probe in `probes.csv`: `NAME.COMPONENT [UNIT]`.
    pub fn columns(&self, dimension: usize) -> Vec<String> {
        let (components, unit) = self.kind.components(dimension);
        components.iter().map(|c| format!("{}.{c} [{unit}]", self.name)).collect()
    }
}

/// A curve of the literature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Probe component it belongs to, e.g. `tip.x`.
    pub probe: String,
    /// Legend entry: who measured or computed it.
    pub label: String,
    /// Points (time s, value in the probe's unit).
    pub points: Vec<[f64; 2]>,
}
