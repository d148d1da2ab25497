//! The fluid as a [`Role`]: what happens in a half-step, and which effects take part.

use crate::artificial_viscosity::ArtificialViscosity;
use crate::columns::{Columns, Shown, Vectors, vectors};
use crate::density_diffusion::{DeltaSph, Hydrostatic, Simple, Strength};
use crate::density_gradient::{self, GradientSum};
use crate::interface::Coupling;
use crate::rates::{PairEffect, RateLaw, RateSum, collect};
use crate::time_step::Limits;
use crate::viscosity::{self, StressTerm, VelocityGradient, Viscosity, ViscosityAtWall};
use crate::wall::{Damping, WallLaw, WallSum, Walls};
use crate::wall_guard::{GUARD, WallViscosity};
use halfstep_shared::failure::{Diverged, Quantity, RoleName};
use halfstep_shared::geometry;
use halfstep_shared::interface::Parameters;
use halfstep_shared::kernel::Kernel;
use halfstep_shared::lane::{Isa, LANES};
use halfstep_shared::neighbours::{ClusterList, PADDING, Rows};
use halfstep_shared::output::Frame;
use halfstep_shared::pair;
use halfstep_shared::protocol::{ForceRecord, MAX_PROBE_VALUES, StateRecord};
use halfstep_shared::role::{CoverageError, Role};
use halfstep_shared::scene::{DensityDiffusion, EffectName, KernelName, Phase, ProbeKind, Scene, Switch};
use halfstep_shared::state_equation::StateEquation;
use halfstep_shared::with_kernel;

/// Margin of the neighbour lists over h: lists are renewed when two particles may have come that much closer.
const SKIN: f64 = 0.3;

/// The fluid and the walls around it.
pub struct Fluid<const D: usize> {
    pub(crate) columns: Columns<D>,
    pub(crate) walls: Option<Walls<D>>,
    pub(crate) coupling: Option<Coupling<D>>,
    pub(crate) state: StateEquation,
    pub(crate) rows: Rows<D>,
    pub(crate) smoothing_length: f64,
    pub(crate) skin: f64,
    pub(crate) resolution: f64,
    pub(crate) kernel: KernelName,
    pub(crate) gravity: [f64; D],
    pub(crate) probes: Vec<ProbeKind>,

    isa: Isa,
    limits: Limits,
    diffusion: DensityDiffusion,
    strength: Strength,
    artificial_viscosity: ArtificialViscosity,
    quadratic: f64,
    viscosity: Option<f64>,
    domain: ([f64; D], [f64; D]),
    fluid_list: ClusterList,
    wall_list: ClusterList,
    list_of_walls: ClusterList,
    fluid_sums: Vec<RateSum<D>>,
    wall_sums: Vec<RateSum<D>>,
    extrapolations: Vec<WallSum<D>>,
    gradient_sums: Vec<GradientSum<D>>,
    gradient: Vectors<D>,
    stress: StressTerm<D>,
    velocity_gradients: [Vec<VelocityGradient<D>>; 2],
    displacement: f64,
    largest_speed: f64,
    largest_acceleration: f64,
    sorted: bool,
    pair_evaluations: u64,
}

impl<const D: usize> Fluid<D> {
    /// The fluid of a scene that has one.
    pub fn new(scene: &Scene, isa: Isa) -> Option<Self> {
        let fluid = scene.fluid.as_ref()?;
        let layout = geometry::layout::<D>(scene);
        let h = scene.smoothing_ratio * scene.resolution;
        let skin = SKIN * h;
        let volume = scene.resolution.powi(D as i32);
        let state = StateEquation::new(fluid.density, fluid.sound_speed, fluid.background_pressure);
        let columns = Columns::new(&layout.fluid, &state, volume);
        let non_negative = scene.switch(EffectName::NonNegativeWallPressure) != Switch::Off;
        let plain = fluid.artificial_viscosity.linear;
        let guarded =
            if scene.switch(EffectName::WallGuard) == Switch::Off { plain } else { plain.max(GUARD) };
        let damping = Damping { free_slip: guarded * fluid.sound_speed, plain: plain * fluid.sound_speed };
        let walls = (!layout.wall.is_empty())
            .then(|| Walls::new(&layout.wall, &state, volume, 2.0 * h + skin, non_negative, damping));
        let domain = geometry::domain(scene);
        let coupled = Parameters::new(scene, isa);
        Some(
            Self {
                columns,
                walls,
                coupling: coupled.map(Coupling::new),
                state,
                rows: Rows::default(),
                smoothing_length: h,
                skin,
                resolution: scene.resolution,
                kernel: scene.numerics.kernel,
                gravity: std::array::from_fn(|d| scene.gravity[d]),
                probes: scene.probes.iter().map(|p| p.kind).filter(|k| k.phase() == Phase::Fluid).collect(),

                isa,
                limits: Limits::new(scene),
                diffusion: fluid.density_diffusion,
                strength: Strength(fluid.density_diffusion_coefficient * h * fluid.sound_speed),
                artificial_viscosity: ArtificialViscosity::new(
                    fluid.artificial_viscosity,
                    fluid.sound_speed,
                    h,
                ),
                quadratic: fluid.artificial_viscosity.quadratic,
                viscosity: crate::viscosity_acts(scene).then_some(fluid.viscosity),
                domain: (std::array::from_fn(|d| domain.min[d]), std::array::from_fn(|d| domain.max[d])),
                fluid_list: ClusterList::default(),
                wall_list: ClusterList::default(),
                list_of_walls: ClusterList::default(),
                fluid_sums: Vec::new(),
                wall_sums: Vec::new(),
                extrapolations: Vec::new(),
                gradient_sums: Vec::new(),
                gradient: vectors(0),
                stress: StressTerm::default(),
                velocity_gradients: [Vec::new(), Vec::new()],
                displacement: 0.0,
                largest_speed: 0.0,
                largest_acceleration: 0.0,
                sorted: false,
                pair_evaluations: 0,
            }
            .prepared(),
        )
    }

    fn prepared(mut self) -> Self {
        self.sort();
        self.columns.apply_state_equation(&self.state);
        self.largest_acceleration = self.gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
        self.scan();
        self
    }

    /// Sorts the particles and renews the lists; particles outside the domain are taken out.
    fn sort(&mut self) {
        let (low, high) = self.domain;
        for slot in 0..self.columns.slots() {
            let outside = (0..D).any(|d| {
                let x = self.columns.now.position[d][slot];
                x < low[d] || x > high[d]
            });
            if outside && self.columns.id[slot] != PADDING {
                self.columns.id[slot] = PADDING;
            }
        }
        let reach = 2.0 * self.smoothing_length + self.skin;
        self.rows.sort(&self.columns.now.position, &self.columns.id, reach, low, high);
        self.columns.permute(&mut self.rows);
        let x = &self.columns.now.position;
        self.fluid_list.build(x, x, &self.rows, reach);
        if let Some(walls) = &self.walls {
            self.wall_list.build(x, &walls.shown.position, &walls.rows, reach);
            self.list_of_walls.build(&walls.shown.position, x, &self.rows, reach);
            self.extrapolations.resize(self.list_of_walls.clusters(), WallSum::default());
        }
        let clusters = self.fluid_list.clusters();
        self.fluid_sums.resize(clusters, RateSum::default());
        if self.walls.is_some() {
            self.wall_sums.resize(clusters, RateSum::default());
        }
        if self.diffusion == DensityDiffusion::DeltaSph {
            self.gradient_sums.resize(clusters, GradientSum::default());
            for column in &mut self.gradient {
                column.resize(self.columns.slots(), 0.0);
            }
        }
        if self.viscosity.is_some() {
            self.velocity_gradients[0].resize(clusters, VelocityGradient::default());
            if self.walls.is_some() {
                self.velocity_gradients[1].resize(clusters, VelocityGradient::default());
            }
        }
        self.displacement = 0.0;
        self.sorted = true;
    }

    /// Largest displacement, speed and acceleration.
    fn scan(&mut self) {
        let c = &self.columns;
        let (mut moved, mut fast, mut pushed) = (0.0_f64, 0.0_f64, 0.0_f64);
        // Padding repeats particles without the solid's forces; what becomes of it must not steer the run.
        for slot in (0..c.slots()).filter(|&s| c.id[s] != PADDING) {
            let (mut m, mut v2, mut a2) = (0.0, 0.0, 0.0);
            for d in 0..D {
                let dx = c.now.position[d][slot] - c.reference[d][slot];
                m += dx * dx;
                v2 += c.now.velocity[d][slot] * c.now.velocity[d][slot];
                a2 += c.acceleration[d][slot] * c.acceleration[d][slot];
            }
            moved = moved.max(m);
            fast = fast.max(v2);
            pushed = pushed.max(a2);
        }
        self.displacement = moved.sqrt();
        self.largest_speed = fast.sqrt();
        if pushed > 0.0 {
            self.largest_acceleration = pushed.sqrt();
        }
    }

    /// The first particle out of bounds: density within a factor of 3 of rho0, speed below 3 c0.
    fn find_divergence(&self, step: u64, stage: u32) -> Option<Diverged> {
        let c = &self.columns;
        let (low, high) = (self.state.density / 3.0, self.state.density * 3.0);
        let fastest = 3.0 * self.state.sound_speed;
        (0..c.slots()).filter(|&s| c.id[s] != PADDING).find_map(|s| {
            let rho = c.now.density[s];
            let v2: f64 = (0..D).map(|d| c.now.velocity[d][s].powi(2)).sum();
            let (quantity, value) = if !(rho > low && rho < high) {
                (Quantity::Density, rho)
            } else if v2.is_nan() || v2 > fastest * fastest {
                (Quantity::Speed, v2.sqrt())
            } else {
                return None;
            };
            let position: [f64; D] = std::array::from_fn(|d| c.now.position[d][s]);
            Some(Diverged {
                role: RoleName::Fluid,
                particle: c.id[s],
                quantity,
                value,
                step,
                stage,
                position: halfstep_shared::wide(position),
            })
        })
    }

    fn sums<K: Kernel<D>>(&mut self, kernel: K) {
        let isa = self.isa;
        if let Some(walls) = &mut self.walls {
            let law = WallLaw::new(kernel, self.gravity, walls, &self.columns);
            pair::pass(isa, &law, &self.list_of_walls, &mut self.extrapolations);
            walls.show(&self.extrapolations, &self.state);
        }
        if self.diffusion == DensityDiffusion::DeltaSph {
            let law = density_gradient::GradientLaw { kernel, fluid: &self.columns.now };
            pair::pass(isa, &law, &self.fluid_list, &mut self.gradient_sums);
            density_gradient::solve(&self.gradient_sums, &mut self.gradient);
        }
        if let Some(mu) = self.viscosity {
            self.viscous_stress(kernel, mu);
        }
        let mut fluid_sums = std::mem::take(&mut self.fluid_sums);
        let mut wall_sums = std::mem::take(&mut self.wall_sums);
        match self.diffusion {
            DensityDiffusion::None => self.rates(kernel, (), &mut fluid_sums, &mut wall_sums),
            DensityDiffusion::Simple => {
                self.rates(kernel, Simple(self.strength), &mut fluid_sums, &mut wall_sums);
            }
            DensityDiffusion::Hydrostatic => {
                let scale = self.state.density / self.state.sound_speed.powi(2);
                let effect =
                    Hydrostatic { strength: self.strength, gradient: self.gravity.map(|g| scale * g) };
                self.rates(kernel, effect, &mut fluid_sums, &mut wall_sums);
            }
            DensityDiffusion::DeltaSph => {
                let effect = DeltaSph { strength: self.strength, gradient: &self.gradient };
                self.rates(kernel, effect, &mut fluid_sums, &mut wall_sums);
            }
        }
        let columns = &mut self.columns;
        collect(self.gravity, &fluid_sums, &wall_sums, &mut columns.acceleration, &mut columns.density_rate);
        self.fluid_sums = fluid_sums;
        self.wall_sums = wall_sums;
    }

    fn viscous_stress<K: Kernel<D>>(&mut self, kernel: K, viscosity: f64) {
        let fluid = &self.columns.now;
        let law = viscosity::GradientLaw { kernel, targets: fluid, sources: fluid };
        let [of_fluid, of_walls] = &mut self.velocity_gradients;
        pair::pass(self.isa, &law, &self.fluid_list, of_fluid);
        if let Some(walls) = &self.walls {
            let law = viscosity::GradientLaw { kernel, targets: fluid, sources: &walls.shown };
            pair::pass(self.isa, &law, &self.wall_list, of_walls);
        }
        self.stress.set(viscosity, of_fluid, of_walls, &fluid.density);
    }

    /// The rate pass over fluid and walls with a density diffusion; viscosity as the scene has it.
    fn rates<K: Kernel<D>, E: PairEffect<D>>(
        &self,
        kernel: K,
        diffusion: E,
        fluid_sums: &mut [RateSum<D>],
        wall_sums: &mut [RateSum<D>],
    ) {
        let damping = self.artificial_viscosity;
        let stress = &self.stress;
        match self.viscosity {
            None => {
                self.pass(kernel, (damping, diffusion, ()), &self.fluid_list, &self.columns.now, fluid_sums)
            }
            Some(_) => {
                let effects = (damping, diffusion, Viscosity(stress));
                self.pass(kernel, effects, &self.fluid_list, &self.columns.now, fluid_sums);
            }
        }
        let Some(walls) = &self.walls else { return };
        let at_walls = WallViscosity {
            smoothing_length: self.smoothing_length,
            linear: &walls.damping,
            quadratic: self.quadratic,
        };
        match self.viscosity {
            None => self.pass(kernel, (at_walls, (), ()), &self.wall_list, &walls.shown, wall_sums),
            Some(_) => {
                let effects = (at_walls, (), ViscosityAtWall(stress));
                self.pass(kernel, effects, &self.wall_list, &walls.shown, wall_sums);
            }
        }
    }

    fn pass<K: Kernel<D>, E: PairEffect<D>>(
        &self,
        kernel: K,
        effects: E,
        list: &ClusterList,
        sources: &Shown<D>,
        sums: &mut [RateSum<D>],
    ) {
        let law = RateLaw { kernel, effects, targets: &self.columns.now, sources };
        pair::pass(self.isa, &law, list, sums);
    }

    fn passes_over_fluid(&self) -> u64 {
        1 + u64::from(self.diffusion == DensityDiffusion::DeltaSph) + u64::from(self.viscosity.is_some())
    }

    /// Number of wall particles.
    pub fn wall_particles(&self) -> usize {
        self.walls.as_ref().map_or(0, |w| w.id.iter().filter(|&&i| i != PADDING).count())
    }
}

impl<const D: usize> Role for Fluid<D> {
    fn name(&self) -> RoleName {
        RoleName::Fluid
    }

    fn particles(&self) -> u64 {
        self.columns.particles as u64
    }

    fn dt_limit(&self) -> f64 {
        self.limits.time_step(self.largest_speed, self.largest_acceleration)
    }

    fn publish(&mut self, peer: &[StateRecord], out: &mut Vec<StateRecord>) -> u64 {
        out.clear();
        if 2.0 * self.displacement > self.skin || self.coupling.as_ref().is_some_and(|c| c.is_stale(peer)) {
            self.sort();
            self.columns.apply_state_equation(&self.state);
        }
        let Some(coupling) = &mut self.coupling else { return 0 };
        if self.sorted {
            coupling.choose(&self.columns, peer);
            self.sorted = false;
        }
        coupling.record(&self.columns, out);
        coupling.epoch()
    }

    fn displacement(&self) -> f64 {
        self.displacement
    }

    fn own_sums(&mut self) {
        with_kernel!(self.kernel, self.smoothing_length, D, |kernel| self.sums(kernel));
        // The velocity gradients of the viscosity take a pass over fluid and walls, the density's one over the fluid.
        let passes_over_walls = 1 + usize::from(self.viscosity.is_some());
        let walls = self.wall_list.entries() * passes_over_walls + self.list_of_walls.entries();
        let listed = self.fluid_list.entries() as u64 * self.passes_over_fluid() + walls as u64;
        self.pair_evaluations += listed * LANES as u64;
    }

    fn cross_sums(
        &mut self,
        own: &[StateRecord],
        peer: &[StateRecord],
        _epoch: u64,
    ) -> Result<(), CoverageError> {
        let Some(coupling) = &mut self.coupling else { return Ok(()) };
        coupling.add_rates(&mut self.columns, own, peer, self.displacement)?;
        self.pair_evaluations += coupling.pairs() as u64;
        Ok(())
    }

    fn advance(&mut self, step: u64, stage: u32, dt: f64, forces: &[ForceRecord]) -> Result<(), Diverged> {
        if let Some(coupling) = &self.coupling {
            for (&slot, force) in coupling.slots().iter().zip(forces) {
                for d in 0..D {
                    self.columns.acceleration[d][slot as usize] += force.cross_viscosity[d];
                }
            }
        }
        if stage == 0 {
            self.columns.save();
            self.columns.advance(0.5 * dt);
        } else {
            self.columns.advance(dt);
        }
        self.columns.apply_state_equation(&self.state);
        self.scan();
        match self.find_divergence(step, stage) {
            Some(diverged) => Err(diverged),
            None => Ok(()),
        }
    }

    fn probes(&self, out: &mut [f64; MAX_PROBE_VALUES]) -> usize {
        self.measure(out)
    }

    fn audit(&self) -> [f64; 8] {
        self.audit_values()
    }

    fn fill_frame(&self, time: f64, frame: &mut Frame) {
        self.copy_to(time, frame);
    }

    fn state_hash(&self) -> u64 {
        self.hash()
    }

    fn pair_evaluations(&self) -> u64 {
        self.pair_evaluations
    }
}
