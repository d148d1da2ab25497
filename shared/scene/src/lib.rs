//! What a user writes: the scene, as resolved from a TOML file, a preset and `--set` overrides.
//!
//! Every length is in metres, every time in seconds, every other quantity in SI units. Two-dimensional masses and
//! forces are per metre of depth. A [`Scene`] that exists is valid: [`load`] refuses anything else with all of the
//! file's errors at once. Vectors have three components; a two-dimensional scene leaves the third at zero.
//!
//! ```
//! let text = "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
//!             phase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [1.0, 0.5] }\n";
//! let scene = halfstep_scene::parse(text, "water.toml".as_ref(), &[]).expect("a right scene");
//! let particles = halfstep_scene::geometry::layout::<2>(&scene).fluid;
//! assert_eq!(particles.len(), 10 * 5);
//! let wrong = halfstep_scene::parse(text, "water.toml".as_ref(), &["resolution=-1".into()]).unwrap_err();
//! assert!(wrong.problems[0].to_string().contains("resolution=-1"));
//! ```

mod bodies;
pub mod bounds;
mod brackets;
mod check;
mod check_contact;
mod check_frame;
mod check_lattice;
mod check_metric;
mod check_probe;
mod check_rigid;
mod check_solid;
mod check_waves;
mod contact;
mod dimension;
mod document;
mod drawing;
mod effect;
mod energy;
mod error;
mod file;
mod frame;
pub mod geometry;
mod keys;
mod load;
mod metric;
mod motion;
mod names;
mod overrides;
mod parameters;
mod participant;
mod preset;
mod probe;
mod range;
mod read;
mod read_contact;
mod read_geometry;
mod read_metric;
mod read_motion;
mod read_probe;
mod read_shape;
mod read_solid;
mod read_waves;
mod resources;
mod schema;
mod section;
mod shape;
mod solid;
mod solid_json;
mod spacing;
mod support;
mod velocity_field;
mod viscosity;

pub use bodies::Body;
pub use contact::PairContact;
pub use effect::{Decision, Derived, EffectName, Switch};
pub use energy::{EnergyEntry, EnergyPart};
pub use error::{Place, SceneError, SceneErrors};
pub use frame::{Frame, Gravity};
pub use halfstep_sph::Phase;
pub use halfstep_sph::kernel::KernelName;
pub use halfstep_sph::lane::Precision;
pub use load::{load, load_with, parse, parse_with};
pub use metric::{Metric, MetricKind, MetricReference};
pub use motion::{
    Column, Composed, Course, Motion, Part, Placement, Solitary, Spline, Turn, WaveMaker, angle_near,
};
pub use parameters::{Doubtful, WholeAngle};
pub use participant::Participant;
pub use probe::{BodyQuantity, Probe, ProbeKind, Reference, Spot};
pub use resources::{
    auto_sound_speed, expected_speed, expected_speed_of_fluid, memory_available, memory_needed,
};
pub use schema::schema;
pub use shape::{Block, CantileverMode, Geometry, Shape, TankSide, Traction, Void};
pub use solid::{
    ArtificialStress, ContactKeys, FiniteElementKeys, Fracture, HypoelasticKeys, Joint, JointKind, Material,
    ModelKeys, Plane, RigidBody, RigidKeys, Solid, SolidModelName, SubSteps, TimeIntegration,
    TotalLagrangianKeys,
};
pub use velocity_field::VelocityField;
pub use viscosity::{artificial_viscosity, viscosity};

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A scene with every default filled in and every value checked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// The scene's name: the stem of its file.
    pub name: String,
    /// The file it was read from.
    pub path: PathBuf,
    /// The preset it started from.
    pub preset: Option<Preset>,
    /// Number of space dimensions.
    pub dimension: usize,
    /// Particle spacing dx of the fluid, of walls and of solids that have no spacing of their own, m.
    pub resolution: f64,
    /// Smoothing length over spacing, h / dx, of the fluid and the interface.
    pub smoothing_ratio: f64,
    /// Simulated time, s.
    pub end_time: f64,
    /// End of the whole run, s, where only its beginning is computed: what is said of the scene is of the whole.
    #[serde(skip)]
    pub whole: Option<f64>,
    /// How the time step is chosen.
    pub time_step: TimeStep,
    /// Gravity, m/s²: in space, see [`Gravity`].
    pub gravity: [f64; 3],
    /// The frame of reference, where it moves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<Frame>,
    /// The liquid, where the scene has one.
    pub fluid: Option<Fluid>,
    /// The solids, in the file's order. As JSON `solid`: an object for `[solid]`, a list for `[[solid]]`.
    #[serde(rename = "solid", with = "solid_json")]
    pub solids: Vec<Solid>,
    /// How fluid and solid act on each other.
    pub interface: Interface,
    /// Files that a run writes, and when.
    pub output: Output,
    /// Contact of pairs of solids of which the file says something, see [`Scene::contacts`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pair_contacts: Vec<PairContact>,
    /// Where the particles are at first.
    pub shapes: Vec<Shape>,
    /// Places without particles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub voids: Vec<Void>,
    /// Probes.
    pub probes: Vec<Probe>,
    /// Curves of the literature drawn beside the probes.
    pub references: Vec<Reference>,
    /// Numbers that a study compares.
    #[serde(default)]
    pub metrics: Vec<Metric>,
    /// Effects that the user or the preset forces on or off; those absent are `auto`.
    pub effects: BTreeMap<EffectName, Switch>,
    /// The same of effects that only the program has that read the scene ([`load_with`]), by their names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub own_effects: BTreeMap<String, Switch>,
    /// Numerical parameters that are no physics.
    pub numerics: Numerics,
    /// What is hardly meant in `[parameters]` and formulas; nothing in a resolved scene.
    #[serde(skip)]
    pub doubtful: Doubtful,
}

/// A named set of parameter values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The values, geometry convention and interface of Kayaki's scheme.
    Kayaki,
    /// What keeps waves and vortices: more neighbours, less artificial viscosity, particles in order.
    Waves,
}

/// The choice of the time step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimeStep {
    /// From the stability limits of both phases at every step.
    Auto,
    /// Fixed, s.
    Fixed(f64),
}

/// A weakly compressible liquid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fluid {
    /// Reference density, kg/m³.
    pub density: f64,
    /// Dynamic viscosity, Pa s.
    pub viscosity: f64,
    /// Artificial speed of sound, m/s (resolved: ten times the expected speed where the scene says `auto`).
    pub sound_speed: f64,
    /// Monaghan's artificial viscosity.
    pub artificial_viscosity: ArtificialViscosity,
    /// Diffusion of density.
    pub density_diffusion: DensityDiffusion,
    /// Coefficient delta of the density diffusion.
    pub density_diffusion_coefficient: f64,
    /// Pressure added to the equation of state, Pa.
    pub background_pressure: f64,
    /// How it goes from n to n + 1.
    #[serde(default)]
    pub time_integration: FluidIntegration,
    /// Where waves are absorbed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beach: Option<Beach>,
}

/// How the fluid goes from n to n + 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FluidIntegration {
    /// The midpoint rule: all rates at both stages.
    #[default]
    Midpoint,
    /// Position Verlet: the density's rates at the first stage, accelerations at the second.
    Verlet,
}

impl FluidIntegration {
    /// Where a scene does not say it. `short`: steps have to be short, so that position Verlet would gain a tenth only,
    /// or the solid goes by the same rule.
    pub const fn usual(short: bool) -> Self {
        if short { Self::Midpoint } else { Self::Verlet }
    }

    /// As a sentence names it.
    pub const fn in_words(self) -> &'static str {
        match self {
            Self::Midpoint => "the midpoint rule",
            Self::Verlet => "position Verlet",
        }
    }

    /// `numerics.cfl` where a scene does not say it: with a margin to what the hard cases bear. `short`: beside a solid
    /// that strains, which some stiffnesses let swing with longer steps, and with several, whose contact is the softer
    /// the longer a step is.
    pub const fn courant_number(self, short: bool) -> f64 {
        match self {
            Self::Verlet if !short => 0.6,
            Self::Midpoint | Self::Verlet => 0.4,
        }
    }
}

/// Where velocities decay so that waves are absorbed: at rate s², s from 0 at `from` to 1 at `to` and beyond.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Beach {
    /// Where it begins, m along x.
    pub from: f64,
    /// Where it is strongest, m along x.
    pub to: f64,
    /// How fast velocities decay there, 1/s.
    pub rate: f64,
}

/// Coefficients A (linear) and B (quadratic) of the artificial viscosity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArtificialViscosity {
    /// A: proportional to the sound speed.
    pub linear: f64,
    /// B: proportional to the square of the approach speed.
    pub quadratic: f64,
}

impl ArtificialViscosity {
    /// Kinematic viscosity that A is worth in two dimensions, A h c0 / 16, m²/s, for a smoothing length, m, and a sound
    /// speed, m/s. Monaghan 2005 gives A h c0 / 8 for a Pi that acts on receding particles, too; here it acts on
    /// approaching ones only.
    pub fn kinematic(&self, smoothing_length: f64, sound_speed: f64) -> f64 {
        self.linear * smoothing_length * sound_speed / 16.0
    }
}

/// The variants of density diffusion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DensityDiffusion {
    /// None.
    None,
    /// Molteni and Colagrossi 2009.
    Simple,
    /// Fourtakas et al. 2019: the hydrostatic part is left out.
    Hydrostatic,
    /// Antuono et al. 2010, Marrone et al. 2011: with the renormalised gradient.
    DeltaSph,
}

/// The coupling of fluid and solid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interface {
    /// Which treatment.
    pub treatment: Treatment,
    /// Kayaki's C: strength of the cross-phase artificial viscosity f_i between particles that are near each other.
    pub cross_viscosity: f64,
    /// C beyond that.
    pub cross_viscosity_far: f64,
    /// Distance from which on C is the far one, over the spacing; it is whole up to [`Interface::FADE`] before that.
    pub cross_viscosity_reach: f64,
}

impl Interface {
    /// Over which distance C fades from the near to the far one, over the spacing.
    pub const FADE: f64 = 0.25;
}

/// The treatments of the interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Treatment {
    /// The solid is a moving wall to the fluid; it receives the reaction.
    MovingWall,
    /// Kayaki's: continuity and stress sums do not ask for a neighbour's phase.
    PhaseBlind,
}

/// When files are written.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Time between frames, s.
    pub frame_interval: f64,
    /// Time between rows of `probes.csv`, s.
    pub probe_interval: f64,
    /// Simulated time between checkpoints, s; 0: one each ten minutes of computation.
    pub checkpoint_interval: f64,
}

/// Where lattice points lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lattice {
    /// At the centres of cells of side dx: n dx of material carry n particles.
    Centred,
    /// At multiples of dx strictly inside a fluid or a solid (n dx of material carry n - 1), and up to and including
    /// the surface of a wall: Kayaki's counts.
    Nodal,
}

/// Numbers that are no physics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numerics {
    /// Smoothing kernel.
    #[serde(with = "names::Kernel")]
    pub kernel: KernelName,
    /// Precision of the pairs of fluid and wall particles.
    #[serde(with = "names::PrecisionName", default)]
    pub precision: Precision,
    /// Courant number of the fluid.
    pub cfl: f64,
    /// Courant number of the solid: dt c_P / dx.
    pub solid_cfl: f64,
    /// Largest number of solid sub-steps before the solid lowers the time step.
    pub max_sub_steps: u32,
    /// Largest number of fluid particles in the interface record; `None`: from the scene.
    pub interface_capacity: Option<u32>,
    /// Worker threads of each process.
    pub threads: Threads,
    /// Lattice convention.
    pub lattice: Lattice,
    /// Fluid particles that leave this box are removed; `None`: the box of all shapes, widened by its own size.
    pub domain: Option<Block>,
}

/// Worker threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Threads {
    /// Of the fluid process.
    pub fluid: usize,
    /// Of the solid process.
    pub solid: usize,
}
