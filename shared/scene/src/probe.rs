//! What is measured, and the curves that it is compared with.

use super::{Block, Column, EnergyPart, Phase};
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ProbeKind {
    /// Displacement of the solid particles nearest to a point of the initial configuration; components x, y (, z), m.
    Displacement {
        /// The point, m.
        at: [f64; 3],
    },
    /// Where the solid particles nearest to a point of the initial configuration are; components x, y (, z), m.
    Position {
        /// The point, m.
        at: [f64; 3],
    },
    /// Von Mises stress of the solid particles nearest to a point of the initial configuration, Pa.
    Stress {
        /// The point, m.
        at: [f64; 3],
    },
    /// Velocity of the solid particles nearest to a point of the initial configuration; components x, y (, z), m/s.
    SolidVelocity {
        /// The point, m.
        at: [f64; 3],
    },
    /// Green's strain (F^T F - 1) / 2 of a solid; components xx, yy, xy (in space xx, yy, zz, xy, yz, xz).
    Strain {
        /// Where.
        of: Spot,
    },
    /// Cauchy stress of a solid; components xx, yy, zz, xy (, yz, xz), Pa.
    CauchyStress {
        /// Where.
        of: Spot,
    },
    /// Elastic energy stored in a solid, J (2D: J/m).
    StrainEnergy,
    /// Energy that the fracture of a solid has taken, J (2D: J/m).
    CrackEnergy,
    /// Area of the cracks in a solid, m² (2D: length, m): of the faces of cells between which it is cut.
    CrackArea,
    /// Number of bodies of a solid, of its particles that are loose, and of those in fragments that have become thin.
    Bodies,
    /// Fluid pressure at a point, or its mean along a line (kernel average of the fluid around), Pa.
    Pressure {
        /// The point, or where the line begins, m.
        at: [f64; 3],
        /// Where the line ends, m.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to: Option<[f64; 3]>,
        /// Index of the wall or the shape of a solid in [`crate::Scene::shapes`] that the point or line moves with.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        shape: Option<usize>,
    },
    /// Fluid velocity at a fixed point (kernel average); components x, y (, z), m/s.
    Velocity {
        /// The point, m.
        at: [f64; 3],
    },
    /// Volume of fluid that crosses a line in a second, from its left to its right as seen along it, m³/s (2D: m²/s).
    Flux {
        /// Where the line begins, m.
        from: [f64; 3],
        /// Where the line ends, m.
        to: [f64; 3],
    },
    /// Highest fluid particle surface in the columns at some places (against gravity), m.
    WaterLevel {
        /// x of each column, m.
        x: Vec<f64>,
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
    /// Force of the fluid on a solid, or on one shape of a solid or of walls; components x, y (, z), N (2D: N/m).
    Force {
        /// Only on particles whose place in the initial configuration is in this box.
        within: Option<Block>,
        /// Index of the shape in [`crate::Scene::shapes`].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        shape: Option<usize>,
    },
    /// Moment of the same forces about a fixed axis along z, N m (2D: N m/m), positive counter-clockwise.
    Moment {
        /// Where the axis is, m.
        about: [f64; 3],
        /// As of the force.
        within: Option<Block>,
        /// As of the force.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        shape: Option<usize>,
    },
    /// Something of a body.
    Body {
        /// Name of the body.
        body: String,
        /// What of it.
        quantity: BodyQuantity,
    },
}

/// Where a solid's strain or stress is measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spot {
    /// Of the particles nearest to a point of the initial configuration, m.
    At([f64; 3]),
    /// Mean over a body, by its name.
    Body(String),
}

/// What is measured of a body: all of a rigid one; see [`BodyQuantity::is_of_rigid`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BodyQuantity {
    /// Centre of mass; components x, y (, z), m.
    Position,
    /// What the body has turned by since the start, rad: in the plane counter-clockwise, beyond whole turns; in space
    /// the rotation's axis times its angle.
    Angle,
    /// Velocity of the centre of mass; components x, y (, z), m/s.
    Velocity,
    /// Angular velocity, rad/s.
    AngularVelocity,
    /// Force of the fluid; components x, y (, z), N (2D: N/m).
    Force,
    /// Moment of that about the centre of mass, N m (2D: N).
    Moment,
    /// Force of contacts with walls and other bodies; components x, y (, z), N (2D: N/m).
    ContactForce,
    /// Moment of that about the centre of mass, N m (2D: N).
    ContactMoment,
    /// Kinetic energy, and the elastic one of what strains, J (2D: J/m).
    Energy,
}

impl BodyQuantity {
    /// All of them, by the probes' kinds.
    pub const ALL: [(&str, Self); 9] = [
        ("body-position", Self::Position),
        ("body-angle", Self::Angle),
        ("body-velocity", Self::Velocity),
        ("body-angular-velocity", Self::AngularVelocity),
        ("body-force", Self::Force),
        ("body-moment", Self::Moment),
        ("body-contact-force", Self::ContactForce),
        ("body-contact-moment", Self::ContactMoment),
        ("body-energy", Self::Energy),
    ];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "centre of mass",
            Self::Angle => "angle",
            Self::Velocity => "velocity",
            Self::AngularVelocity => "angular velocity",
            Self::Force => "force",
            Self::Moment => "moment",
            Self::ContactForce => "contact force",
            Self::ContactMoment => "contact moment",
            Self::Energy => "energy",
        }
    }

    /// A body that strains has no such thing.
    pub fn is_of_rigid(self) -> bool {
        matches!(self, Self::Angle | Self::AngularVelocity)
    }

    /// One component about z in the plane.
    pub fn turns(self) -> bool {
        matches!(self, Self::Angle | Self::AngularVelocity | Self::Moment | Self::ContactMoment)
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Position => "m",
            Self::Angle => "rad",
            Self::Velocity => "m/s",
            Self::AngularVelocity => "rad/s",
            Self::Force | Self::ContactForce => "N",
            Self::Moment | Self::ContactMoment => "N m",
            Self::Energy => "J",
        }
    }

    /// Name of the only component.
    fn about_z(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::AngularVelocity => "rate",
            _ => "moment",
        }
    }
}

impl ProbeKind {
    /// The point of a solid that it looks at, m.
    pub fn point_of_solid(&self) -> Option<[f64; 3]> {
        match self {
            Self::Displacement { at }
            | Self::Position { at }
            | Self::Stress { at }
            | Self::SolidVelocity { at }
            | Self::Strain { of: Spot::At(at) }
            | Self::CauchyStress { of: Spot::At(at) } => Some(*at),
            _ => None,
        }
    }

    /// Its name as the key `kind`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Displacement { .. } => "displacement",
            Self::Position { .. } => "position",
            Self::Stress { .. } => "stress",
            Self::SolidVelocity { .. } => "solid-velocity",
            Self::Strain { .. } => "strain",
            Self::CauchyStress { .. } => "cauchy-stress",
            Self::StrainEnergy => "strain-energy",
            Self::CrackEnergy => "crack-energy",
            Self::CrackArea => "crack-area",
            Self::Bodies => "bodies",
            Self::Pressure { .. } => "pressure",
            Self::Velocity { .. } => "velocity",
            Self::Flux { .. } => "flux",
            Self::WaterLevel { .. } => "water-level",
            Self::Front => "front",
            Self::KineticEnergy { .. } => "kinetic-energy",
            Self::Energy { .. } => "energy",
            Self::Centroid { .. } => "centroid",
            Self::Force { .. } => "force",
            Self::Moment { .. } => "moment",
            Self::Body { quantity, .. } => {
                BodyQuantity::ALL.iter().find(|(_, of)| of == quantity).map_or("body", |(name, _)| name)
            }
        }
    }

    /// Components of the probe and their unit, in the order of the values.
    pub fn components(&self, dimension: usize) -> (Vec<String>, &'static str) {
        let axes = || ["x", "y", "z"][..dimension].iter().map(|&axis| axis.to_owned()).collect();
        let one = |name: &str| vec![name.to_owned()];
        let tensor = |plane: &[&str]| {
            let all = if dimension == 2 { plane } else { &["xx", "yy", "zz", "xy", "yz", "xz"] };
            all.iter().map(|&component| component.to_owned()).collect()
        };
        match self {
            Self::Displacement { .. } | Self::Position { .. } | Self::Centroid { .. } => (axes(), "m"),
            Self::Stress { .. } => (one("stress"), "Pa"),
            Self::Pressure { .. } => (one("pressure"), "Pa"),
            Self::Velocity { .. } | Self::SolidVelocity { .. } => (axes(), "m/s"),
            Self::Strain { .. } => (tensor(&["xx", "yy", "xy"]), "1"),
            Self::CauchyStress { .. } => (tensor(&["xx", "yy", "zz", "xy"]), "Pa"),
            Self::Flux { .. } => (one("flux"), if dimension == 2 { "m2/s" } else { "m3/s" }),
            Self::WaterLevel { x } if x.len() == 1 => (one("level"), "m"),
            Self::WaterLevel { x } => ((1..=x.len()).map(|k| format!("level-{k}")).collect(), "m"),
            Self::Front => (one("x"), "m"),
            Self::KineticEnergy { .. } | Self::StrainEnergy | Self::CrackEnergy => (one("energy"), "J"),
            Self::CrackArea => (one("area"), if dimension == 2 { "m" } else { "m2" }),
            Self::Bodies => (["bodies", "loose", "thin"].map(str::to_owned).to_vec(), "1"),
            Self::Energy { phase, part } => (EnergyPart::names(*phase, *part), "J"),
            Self::Force { .. } => (axes(), "N"),
            Self::Moment { .. } => (one("moment"), "N m"),
            Self::Body { quantity: BodyQuantity::Energy, .. } => (one("energy"), "J"),
            Self::Body { quantity, .. } if quantity.turns() && dimension == 2 => {
                (one(quantity.about_z()), quantity.unit())
            }
            Self::Body { quantity, .. } => (axes(), quantity.unit()),
        }
    }

    /// Number of components.
    pub fn count(&self, dimension: usize) -> usize {
        self.components(dimension).0.len()
    }

    /// Number of values that a solid's process sends for the probe beyond its components, after those of all probes:
    /// the centre of mass about which a moment is, from which the coupler parts contact and fluid.
    pub fn companions(&self, dimension: usize) -> usize {
        match self {
            Self::Body { quantity: BodyQuantity::Moment | BodyQuantity::ContactMoment, .. } => dimension,
            _ => 0,
        }
    }
}

impl Probe {
    /// The phase whose process measures it: forces on walls are the fluid's.
    pub fn phase(&self) -> Phase {
        match self.kind {
            ProbeKind::Force { shape: Some(_), .. } | ProbeKind::Moment { shape: Some(_), .. }
                if self.solid.is_none() =>
            {
                Phase::Fluid
            }
            ProbeKind::Displacement { .. }
            | ProbeKind::Position { .. }
            | ProbeKind::Stress { .. }
            | ProbeKind::SolidVelocity { .. }
            | ProbeKind::Strain { .. }
            | ProbeKind::CauchyStress { .. }
            | ProbeKind::StrainEnergy
            | ProbeKind::CrackEnergy
            | ProbeKind::CrackArea
            | ProbeKind::Bodies
            | ProbeKind::Force { .. }
            | ProbeKind::Moment { .. }
            | ProbeKind::Body { .. } => Phase::Solid,
            ProbeKind::Pressure { .. }
            | ProbeKind::Velocity { .. }
            | ProbeKind::Flux { .. }
            | ProbeKind::WaterLevel { .. }
            | ProbeKind::Front => Phase::Fluid,
            ProbeKind::KineticEnergy { phase }
            | ProbeKind::Centroid { phase }
            | ProbeKind::Energy { phase, .. } => phase,
        }
    }

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
    /// The column of a file that they come from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub column: Option<Column>,
}
