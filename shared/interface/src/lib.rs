//! The interface between fluid and solid, seen from the records that both sides published.
//!
//! Fluid process and coupler hold the same two records and run the same code on them in the same order, so what both
//! need (the pressure that solid particles show to the fluid, the cross-phase pair force) has the same bits on each
//! side without a further message.
//!
//! ```
//! use halfstep_interface::{Interface, Parameters};
//! use halfstep_sph::lane::Isa;
//! use halfstep_wire::protocol::StateRecord;
//!
//! # let text = "resolution = 0.01\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[solid]\n\
//! #     density = 1000.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n[[shape]]\nname = \"water\"\n\
//! #     phase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.1, 0.1] }\n[[shape]]\nname = \"block\"\n\
//! #     phase = \"solid\"\nbox = { min = [0.1, 0.0], max = [0.2, 0.1] }\n";
//! # let scene = halfstep_scene::parse(text, "block.toml".as_ref(), &[]).expect("a right scene");
//! let parameters = Parameters::<2>::new(&scene, 0, Isa::detect()).expect("fluid and solid");
//! let mut interface = Interface::new(parameters);
//! // Water under pressure, 10 mm to the left of a solid particle, pushes it to the right, and is pushed to the left.
//! let particle = StateRecord { density: 1000.0, mass: 0.1, ..StateRecord::default() };
//! let water = StateRecord { pressure: 500.0, position: [-0.01, 0.0, 0.0], ..particle };
//! interface.update(&[water], &[particle], 1);
//! let (mut on_solid, mut on_water) = (0.0, 0.0);
//! interface.act_on_solid(|_, force| on_solid = force[0]);
//! interface.act_on_fluid(|_, acceleration, _| on_water = 0.1 * acceleration[0]);
//! assert!(on_solid > 0.0 && (on_solid + on_water).abs() < 1e-12 * on_solid);
//! ```

pub mod contact;
pub mod cross_viscosity;
mod faces;
mod interface_particles;
mod moving_wall;
mod phase_blind;
mod screen;
#[cfg(test)]
mod screen_tests;
mod separation;
#[cfg(test)]
mod separation_tests;
mod spin;
mod state;
#[cfg(test)]
mod symmetry_tests;
mod thin_plate;
mod viscous_stress;
#[cfg(test)]
mod viscous_tests;

pub use interface_particles::InterfaceParticles;
pub use phase_blind::SolidRates;
pub use separation::wall_separation;
pub use thin_plate::thin_plate_screen;
pub use viscous_stress::interface_viscosity;

use faces::Faces;
use halfstep_scene::geometry::Plate;
use halfstep_scene::{Decision, Derived, EffectName, KernelName, Phase, Scene, Treatment};
use halfstep_sph::extrapolation::ExtrapolationSum;
use halfstep_sph::lane::{Isa, LANES, Lane};
use halfstep_sph::neighbours::ClusterList;
use halfstep_sph::pair::pair_sum;
use halfstep_sph::state_equation::StateEquation;
use halfstep_wire::protocol::StateRecord;
use moving_wall::{OneFace, WallPressure};
use screen::Screen;
use separation::Separation;
use viscous_stress::ViscousStress;

/// What the interface needs to know of the scene.
#[derive(Clone, Debug)]
pub struct Parameters<const D: usize> {
    /// Which treatment.
    pub treatment: Treatment,
    /// Kernel.
    pub kernel: KernelName,
    /// Smoothing length h of the fluid, m.
    pub smoothing_length: f64,
    /// The fluid's equation of state.
    pub fluid: StateEquation,
    /// The solid's reference density, kg/m³.
    pub solid_density: f64,
    /// The solid's bulk sound speed, m/s.
    pub solid_sound_speed: f64,
    /// Gravity, m/s².
    pub gravity: [f64; D],
    /// The solid never pulls at the fluid.
    pub non_negative_pressure: bool,
    /// Water that leaves the solid keeps its density.
    pub separation: bool,
    /// Particle spacing of the fluid, m.
    pub resolution: f64,
    /// How far apart particles of the two are where fluid and solid touch: the mean of their spacings, m.
    pub spacing: f64,
    /// The plates whose faces are kept apart.
    pub thin_plates: Vec<Plate<D>>,
    /// Stretch of two nearest particles of a solid that can break from which on a crack is between them.
    pub torn: Option<f64>,
    /// Kayaki's C between particles near each other.
    pub cross_viscosity: f64,
    /// C beyond that.
    pub cross_viscosity_far: f64,
    /// The fluid's viscosity mu where viscous stress crosses the interface, Pa s.
    pub viscosity: Option<f64>,
    /// Distance from which on C is the far one, over the fluid's spacing.
    pub cross_viscosity_reach: f64,
    /// Instruction set of the pair loop.
    pub isa: Isa,
}

/// Whether walls, and the solid as the fluid's moving wall, only push: with negative pressures they would hold on to
/// water that leaves them.
pub fn non_negative_pressure(scene: &Scene) -> Decision {
    let derived = match &scene.fluid {
        None => Derived::Impossible("the scene has no fluid".into()),
        Some(_) if scene.solids.is_empty() && scene.shapes.iter().all(|s| s.phase != Phase::Wall) => {
            Derived::Impossible("neither walls nor solid".into())
        }
        Some(_) => Derived::On("walls and solids push and do not pull".into()),
    };
    Decision::new(scene, EffectName::NonNegativeWallPressure, derived)
}

impl<const D: usize> Parameters<D> {
    /// Between the fluid of a scene and its solid of that index; `None` where one is missing.
    pub fn new(scene: &Scene, index: usize, isa: Isa) -> Option<Self> {
        let (fluid, solid) = (scene.fluid.as_ref()?, scene.solids.get(index)?);
        Some(Self {
            treatment: scene.interface.treatment,
            kernel: scene.numerics.kernel,
            smoothing_length: scene.smoothing_ratio * scene.resolution,
            fluid: StateEquation::new(fluid.density, fluid.sound_speed, fluid.background_pressure),
            solid_density: solid.density,
            solid_sound_speed: solid.sound_speed(),
            gravity: std::array::from_fn(|d| scene.gravity[d]),
            non_negative_pressure: non_negative_pressure(scene).on,
            separation: wall_separation(scene).on,
            resolution: scene.resolution,
            spacing: scene.interface_spacing(index),
            thin_plates: thin_plate::screened(scene, index),
            torn: scene.fracture(index).map(|fracture| fracture.torn(scene.solid_spacing(index))),
            cross_viscosity: scene.interface.cross_viscosity,
            cross_viscosity_far: scene.interface.cross_viscosity_far,
            viscosity: interface_viscosity(scene).on.then_some(fluid.viscosity),
            cross_viscosity_reach: scene.interface.cross_viscosity_reach,
            isa,
        })
    }
}

/// What the solid does to several fluid particles.
#[derive(Clone, Copy, Debug)]
pub struct FluidSum<const D: usize, L = Lane> {
    /// Acceleration, m/s².
    pub acceleration: [L; D],
    /// Rate of density, kg/(m³ s).
    pub density_rate: L,
}
pair_sum!(FluidSum { D } { acceleration, density_rate });

/// Force of the fluid on several solid particles, N (2D: N/m).
pub type SolidForce<const D: usize, L = Lane> = crate::phase_blind::Vector<D, L>;

/// Both records, sorted, with the lists between them.
pub struct Interface<const D: usize> {
    /// Parameters.
    pub parameters: Parameters<D>,
    /// The fluid's interface particles.
    pub fluid: InterfaceParticles<D>,
    /// The solid's interface particles.
    pub solid: InterfaceParticles<D>,
    /// For each cluster of fluid particles its solid neighbours.
    pub fluid_list: ClusterList,
    /// For each cluster of solid particles its fluid neighbours.
    pub solid_list: ClusterList,
    epoch: Option<u64>,
    fluid_sums: Vec<FluidSum<D>>,
    solid_forces: Vec<SolidForce<D>>,
    wall_sums: Vec<ExtrapolationSum>,
    screen: Option<Screen<D>>,
    separation: Separation<D>,
    viscous_stress: Option<ViscousStress<D>>,
    solid_rates: Vec<SolidRates<D>>,
}

impl<const D: usize> Interface<D> {
    /// The interface of somebody who does not ask for viscous stress, which the coupler evaluates.
    pub fn without_viscous_stress(parameters: Parameters<D>) -> Self {
        Self { viscous_stress: None, ..Self::new(parameters) }
    }

    /// An interface without particles.
    pub fn new(parameters: Parameters<D>) -> Self {
        let list = ClusterList::new(parameters.isa);
        let viscous_stress = ViscousStress::new(&parameters, &list);
        Self {
            parameters,
            fluid: InterfaceParticles::default(),
            solid: InterfaceParticles::default(),
            fluid_list: list.clone(),
            solid_list: list,
            epoch: None,
            fluid_sums: Vec::new(),
            solid_forces: Vec::new(),
            wall_sums: Vec::new(),
            screen: None,
            separation: Separation::default(),
            viscous_stress,
            solid_rates: Vec::new(),
        }
    }

    /// Pairs that the passes between the phases evaluate.
    pub fn pairs(&self) -> usize {
        let own = self.viscous_stress.as_ref().map_or(0, ViscousStress::pairs);
        self.fluid_list.pairs() + self.solid_list.pairs() + own
    }

    fn skin(&self) -> f64 {
        0.3 * self.parameters.smoothing_length
    }

    /// Height of the rows, and reach of the lists, m.
    fn height(&self) -> f64 {
        2.0 * self.parameters.smoothing_length + self.skin()
    }

    /// Takes over both records; lists are renewed when the fluid's set changed (`epoch`) or particles moved too far.
    pub fn update(&mut self, fluid: &[StateRecord], solid: &[StateRecord], epoch: u64) {
        let same = self.epoch == Some(epoch)
            && self.fluid.records() == fluid.len()
            && self.solid.records() == solid.len();
        if same {
            self.fluid.load(fluid);
            self.solid.load(solid);
        }
        // The solid's own list, which its spin needs, holds pairs both of which move. All who keep the interface sort
        // alike, to the same bits, also those who do not ask for viscous stress.
        let pairs_of_solid =
            self.parameters.viscosity.is_some() && 2.0 * self.solid.displacement() > self.skin();
        if !same || self.fluid.displacement() + self.solid.displacement() > self.skin() || pairs_of_solid {
            let height = self.height();
            self.fluid.sort(fluid, height);
            self.solid.sort(solid, height);
            self.relist();
            self.epoch = Some(epoch);
        }
        match self.parameters.treatment {
            Treatment::MovingWall if self.parameters.thin_plates.is_empty() => {
                moving_wall::show_pressure(self)
            }
            Treatment::MovingWall => screen::show_pressures(self, solid),
            Treatment::PhaseBlind => phase_blind::show_stress(self),
        }
        self.show_velocity(solid);
    }

    /// What the solid does to the fluid. `visit(record, acceleration, density_rate)` for each fluid record that has
    /// solid neighbours in its cluster.
    pub fn act_on_fluid(&mut self, mut visit: impl FnMut(usize, [f64; D], f64)) {
        self.fluid_sums.resize(self.fluid_list.fours(), FluidSum::default());
        let mut sums = std::mem::take(&mut self.fluid_sums);
        match self.parameters.treatment {
            Treatment::MovingWall => {
                let mut separation = std::mem::take(&mut self.separation);
                match &self.screen {
                    None => self.push_fluid(OneFace(&self.solid), &mut separation, &mut sums),
                    Some(screen) => self.push_fluid(screen.wall(self), &mut separation, &mut sums),
                }
                self.separation = separation;
            }
            Treatment::PhaseBlind => phase_blind::act_on_fluid(self, &mut sums),
        }
        for (slot, record) in self.fluid.slots() {
            let (sum, k) = (&sums[slot / LANES], slot % LANES);
            visit(record, std::array::from_fn(|d| sum.acceleration[d].0[k]), sum.density_rate.0[k]);
        }
        self.fluid_sums = sums;
    }

    fn push_fluid(
        &self,
        wall: impl WallPressure<D> + Faces<D>,
        separation: &mut Separation<D>,
        sums: &mut [FluidSum<D>],
    ) {
        if self.parameters.separation {
            separation.find(self, wall);
            moving_wall::push_fluid(self, separation.shown_by(wall), sums);
        } else {
            moving_wall::push_fluid(self, wall, sums);
        }
    }

    /// Force of the fluid on the solid: `visit(record, force)`.
    pub fn act_on_solid(&mut self, mut visit: impl FnMut(usize, [f64; D])) {
        self.solid_forces.resize(self.solid_list.fours(), SolidForce::default());
        let mut sums = std::mem::take(&mut self.solid_forces);
        match self.parameters.treatment {
            Treatment::MovingWall => match &self.screen {
                None => moving_wall::push_solid(self, OneFace(&self.solid), &mut sums),
                Some(screen) => moving_wall::push_solid(self, screen.wall(self), &mut sums),
            },
            Treatment::PhaseBlind => phase_blind::act_on_solid(self, &mut sums),
        }
        for (slot, record) in self.solid.slots() {
            visit(record, std::array::from_fn(|d| sums[slot / LANES].0[d].0[slot % LANES]));
        }
        self.solid_forces = sums;
    }

    /// Contribution of the fluid to the solid's density rate and velocity gradient: `visit(record, density_rate,
    /// gradient)`, nothing with the moving wall.
    pub fn rates_of_solid(&mut self, mut visit: impl FnMut(usize, f64, [[f64; D]; D])) {
        if self.parameters.treatment == Treatment::MovingWall {
            return;
        }
        self.solid_rates.resize(self.solid_list.fours(), SolidRates::default());
        let mut sums = std::mem::take(&mut self.solid_rates);
        phase_blind::rates_of_solid(self, &mut sums);
        for (slot, record) in self.solid.slots() {
            let (sum, k) = (&sums[slot / LANES], slot % LANES);
            let gradient = std::array::from_fn(|a| std::array::from_fn(|b| sum.gradient[a][b].0[k]));
            visit(record, sum.density_rate.0[k], gradient);
        }
        self.solid_rates = sums;
    }

    /// Smallest distance between a fluid and a solid particle, m; infinite where none is within the kernel's support.
    pub fn smallest_distance(&self) -> f64 {
        let mut least = [f64::INFINITY; LANES];
        for first in (0..self.fluid.density.len()).step_by(LANES) {
            let own: [[f64; LANES]; D] =
                std::array::from_fn(|d| std::array::from_fn(|k| self.fluid.position[d][first + k]));
            for j in self.fluid_list.of(first) {
                let mut r2 = [0.0; LANES];
                for (own, solid) in own.iter().zip(&self.solid.position) {
                    for (r2, x) in r2.iter_mut().zip(own) {
                        *r2 += (x - solid[j]) * (x - solid[j]);
                    }
                }
                for (least, r2) in least.iter_mut().zip(r2) {
                    *least = if r2 < *least { r2 } else { *least };
                }
            }
        }
        // What else a list holds hangs on how many particles share it.
        let distance = least.into_iter().fold(f64::INFINITY, f64::min).sqrt();
        if distance < 2.0 * self.parameters.smoothing_length { distance } else { f64::INFINITY }
    }
}
