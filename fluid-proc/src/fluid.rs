//! The fluid as a [`Role`]: what happens in a half-step, and which effects take part.

use crate::columns::{Columns, fit};
use crate::compiled;
use crate::composition::Shares;
use crate::effects::non_negative_wall_pressure::NonNegativeWallPressure;
use crate::effects::{self, Effects, FluidEffect, List};
use crate::integration;
use crate::interface::Coupling;
use crate::ledger::FluidLedger;
use crate::probes::{self, Gauge};
use crate::rates::RateSum;
use crate::riders::Riders;
use crate::time_step::StepLimits;
use crate::walls::Walls;
use crate::walls::moving::motions;
use halfstep_interface::Parameters;
use halfstep_role::balance::Balance;
use halfstep_role::ledger::Ledger;
use halfstep_role::role::{Costs, CoverageError, Peer, Role};
use halfstep_role::timeline;
use halfstep_scene::bounds::Bounds;
use halfstep_scene::geometry;
use halfstep_scene::{FluidIntegration, Gravity, KernelName, Phase, Scene};
use halfstep_sph::lane::Isa;
use halfstep_sph::neighbours::{ClusterList, PADDING, Rows};
use halfstep_sph::state_equation::StateEquation;
use halfstep_wire::Name;
use halfstep_wire::failure::Diverged;
use halfstep_wire::frame::Frame;
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::{Audit, ForceRecord, StateRecord};
use halfstep_wire::state::State;

/// Margin of the neighbour lists over h: lists are renewed when two particles may have come that much closer.
const SKIN: f64 = 0.3;

/// The fluid and the walls around it, with the effects of the program's list and one more, `X`.
pub struct Fluid<const D: usize, X: FluidEffect<D> = ()> {
    pub(crate) columns: Columns<D>,
    pub(crate) walls: Option<Walls<D>>,
    pub(crate) coupling: Option<Coupling<D>>,
    pub(crate) state: StateEquation,
    pub(crate) rows: Rows<D>,
    pub(crate) smoothing_length: f64,
    pub(crate) skin: f64,
    pub(crate) resolution: f64,
    pub(crate) kernel: KernelName,
    gravity_in_time: Gravity,
    /// At the instant of the next sums, m/s².
    pub(crate) gravity: [f64; D],
    pub(crate) probes: Vec<Gauge<D>>,
    /// Points of probes that go with solids.
    pub(crate) riders: Riders<D>,

    pub(crate) bounds: Bounds,
    pub(crate) isa: Isa,
    limits: StepLimits,
    pub(crate) integration: FluidIntegration,
    /// Position Verlet: time by which the density is of before n, half of the step before, s.
    pub(crate) density_lag: f64,
    /// Length of the step under way, from its first stage on, s.
    pub(crate) dt: f64,
    pub(crate) effects: List<D, X>,
    /// Name of the composition that the rate pass runs.
    composition: String,
    /// The stage of the next sums.
    pub(crate) stage: Stage,
    pub(crate) domain: ([f64; D], [f64; D]),
    /// Of the scene; particles that leave the domain are taken out.
    pub(crate) number_of_particles: usize,
    pub(crate) fluid_list: ClusterList,
    pub(crate) wall_list: ClusterList,
    pub(crate) list_of_walls: ClusterList,
    pub(crate) sums: Vec<RateSum<D>>,
    /// Position Verlet: velocities at n + 1 to which the sums lead, m/s, where effects ask for them.
    pub(crate) predicted: Vec<[f64; D]>,
    pub(crate) displacement: f64,
    pub(crate) largest_speed: f64,
    pub(crate) largest_acceleration: f64,
    pub(crate) sorted: bool,
    /// What the next state publishes was decided before an interruption.
    pub(crate) published: bool,
    pub(crate) pair_evaluations: u64,
    /// Those before the sums of the present state.
    pub(crate) evaluations_before: u64,
    /// Where the scene's probes ask for energies.
    pub(crate) ledger: Option<FluidLedger<D>>,
}

impl<const D: usize> Fluid<D> {
    /// The fluid of a scene that has one, in a dimension that scenes have.
    pub fn new(scene: &Scene, isa: Isa) -> Option<Self> {
        Self::build(scene, isa, None)
    }
}

impl<const D: usize, X: FluidEffect<D>> Fluid<D, X> {
    /// The fluid of a scene that has one, with a further effect where that takes part ([`FluidEffect::decide`]).
    pub fn with_effect(scene: &Scene, isa: Isa, effect: X) -> Option<Self> {
        Self::build(scene, isa, Some(effect).filter(|_| X::decide(scene).on))
    }

    fn build(scene: &Scene, isa: Isa, more: Option<X>) -> Option<Self> {
        let fluid = scene.fluid.as_ref().filter(|_| compiled::has(D))?;
        let layout = geometry::layout::<D>(scene);
        let h = scene.smoothing_ratio * scene.resolution;
        let skin = SKIN * h;
        let precision = scene.numerics.precision;
        let volume = scene.resolution.powi(D as i32);
        let state = StateEquation::new(fluid.density, fluid.sound_speed, fluid.background_pressure);
        let columns = Columns::new(&layout.fluid, &state, volume);
        let non_negative = NonNegativeWallPressure::<D>::decide(scene).on;
        let walls = (!layout.wall.is_empty()).then(|| {
            let (reach, motions) = (2.0 * h + skin, motions(scene));
            Walls::new(&layout.wall, &state, volume, reach, non_negative, &motions, precision)
        });
        let effects = effects::of_scene(scene, more);
        let domain = geometry::domain(scene);
        let coupled =
            (0..scene.solids.len()).filter_map(|solid| Parameters::new(scene, solid, isa)).collect();
        let gravity_in_time = Gravity::of(scene);
        let list = || ClusterList::with_precision(isa, precision);
        let (probes, riders) = probes::of_fluid(scene, &layout);
        Some(
            Self {
                number_of_particles: columns.particles,
                columns,
                walls,
                coupling: Coupling::new(coupled),
                state,
                rows: Rows::new(precision),
                smoothing_length: h,
                skin,
                resolution: scene.resolution,
                kernel: scene.numerics.kernel,
                gravity: gravity_in_time.at(0.0),
                gravity_in_time,
                probes,
                riders,

                bounds: Bounds::of_fluid(scene)?,
                isa,
                limits: StepLimits::new::<D>(scene),
                integration: fluid.time_integration,
                density_lag: 0.0,
                dt: 0.0,
                composition: effects.pairs().composition(),
                effects,
                stage: Stage::First,
                domain: (std::array::from_fn(|d| domain.min[d]), std::array::from_fn(|d| domain.max[d])),
                fluid_list: list(),
                wall_list: list(),
                list_of_walls: list(),
                sums: Vec::new(),
                predicted: Vec::new(),
                displacement: 0.0,
                largest_speed: 0.0,
                largest_acceleration: 0.0,
                sorted: false,
                published: false,
                pair_evaluations: 0,
                evaluations_before: 0,
                ledger: scene.keeps_energy_ledgers().then(FluidLedger::new),
            }
            .prepared(),
        )
    }

    fn prepared(mut self) -> Self {
        self.sort();
        self.largest_acceleration = self.gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
        let speeds = self.columns.now.sources.iter().map(|s| s.velocity.map(|v| v.powi(2)).iter().sum());
        self.largest_speed = speeds.fold(0.0, f64::max).sqrt();
        self.close_ledger(0.0);
        self
    }

    /// Sorts the particles and renews the lists; particles outside the domain are taken out.
    fn sort(&mut self) {
        let (low, high) = self.domain;
        let mut left = Vec::new();
        for slot in 0..self.columns.slots() {
            let outside = (0..D).any(|d| {
                let x = self.columns.now.position[d][slot];
                x < low[d] || x > high[d]
            });
            if outside && self.columns.id[slot] != PADDING {
                left.push(slot);
                self.columns.id[slot] = PADDING;
            }
        }
        self.give_away(&left);
        // Rows two spacings high: four neighbours in a row are a square.
        self.rows.sort(&self.columns.now.position, &self.columns.id, 2.0 * self.resolution, low, high);
        self.columns.permute(&mut self.rows, &self.state);
        if let Some(walls) = self.walls.as_mut().filter(|walls| walls.displacement() > 0.0) {
            walls.sort();
        }
        self.list();
        fit(&mut self.sums, self.fluid_list.fours(), RateSum::default());
        self.effects.resize(self.columns.slots(), self.walls.as_ref());
        self.displacement = 0.0;
        self.sorted = true;
    }

    /// Lists who is near whom, from where particles and walls were at the last sort.
    pub(crate) fn list(&mut self) {
        let reach = 2.0 * self.smoothing_length + self.skin;
        let x = &self.columns.reference;
        self.fluid_list.build(x, x, &self.rows, reach);
        if let Some(walls) = &self.walls {
            self.wall_list.build(x, &walls.shown.position, &walls.rows, reach);
            self.list_of_walls.build(&walls.shown.position, x, &self.rows, reach);
        }
    }

    /// Position Verlet without solids: the rates at predicted velocities are among the fluid's own sums.
    pub(crate) fn predicts_alone(&self) -> bool {
        self.integration == FluidIntegration::Verlet && self.coupling.is_none()
    }

    /// The particle that is farthest out of bounds, if any is.
    fn find_divergence(&self, half_step: &HalfStep) -> Option<Diverged> {
        let c = &self.columns;
        let excess = |s: usize| {
            let particle = &c.now.sources[s];
            let v2: f64 = particle.velocity.iter().map(|v| v.powi(2)).sum();
            Some((s, self.bounds.excess(particle.density, v2.sqrt())?))
        };
        let found = (0..c.slots()).filter(|&s| c.id[s] != PADDING).filter_map(excess);
        let (s, worst) = found.max_by(|a, b| a.1.ratio.total_cmp(&b.1.ratio))?;
        let position: [f64; D] = std::array::from_fn(|d| c.now.position[d][s]);
        Some(Diverged {
            participant: Name::FLUID,
            particle: c.id[s],
            quantity: worst.quantity,
            value: worst.value,
            step: half_step.step,
            stage: half_step.stage,
            position: halfstep_wire::wide(position),
        })
    }
}

impl<const D: usize, X: FluidEffect<D>> Role for Fluid<D, X> {
    fn name(&self) -> Name {
        Name::FLUID
    }

    fn phase(&self) -> Phase {
        Phase::Fluid
    }

    fn particles(&self) -> u64 {
        self.columns.particles as u64
    }

    fn dt_limit(&self) -> f64 {
        self.limits.time_step(self.largest_speed, self.largest_acceleration)
    }

    fn set_time(&mut self, time: f64) {
        self.gravity = self.gravity_in_time.at(time);
        if let Some(coupling) = &mut self.coupling {
            coupling.set_gravity(self.gravity);
        }
        if let Some(walls) = &mut self.walls {
            walls.set_time(time);
        }
    }

    fn publish(&mut self, peers: &[Peer], out: &mut Vec<StateRecord>) -> u64 {
        out.clear();
        self.evaluations_before = self.pair_evaluations;
        let walls = self.walls.as_ref().map_or(0.0, Walls::displacement);
        let stale = self.displacement + self.displacement.max(walls) > self.skin
            || self.coupling.as_ref().is_some_and(|c| c.is_stale(peers));
        if stale && !self.published {
            let _phase = timeline::phase("neighbour lists");
            self.sort();
        }
        self.published = false;
        let Some(coupling) = &mut self.coupling else { return 0 };
        if self.sorted {
            let _phase = timeline::phase("interface selection");
            coupling.choose(&self.columns, peers);
            self.sorted = false;
        }
        coupling.record(&self.columns, out);
        coupling.epoch()
    }

    fn displacement(&self) -> f64 {
        self.displacement
    }

    fn own_sums(&mut self) {
        (X::passes().own_sums)(self);
    }

    fn cross_sums(&mut self, own: &[StateRecord], peers: &[Peer]) -> Result<(), CoverageError> {
        let by_means = self.integration == FluidIntegration::Verlet;
        if let Some(coupling) = &mut self.coupling {
            if self.stage == Stage::First {
                self.riders.ride(peers);
            }
            let ledger = self.ledger.as_mut().filter(|_| self.stage == Stage::Second && !by_means);
            coupling.add_rates(&mut self.sums, own, peers, self.displacement, ledger)?;
            self.pair_evaluations += coupling.pairs() as u64;
        }
        if self.stage == Stage::Second && by_means {
            (X::passes().sums_after_peers)(self, own, peers);
        }
        Ok(())
    }

    fn advance(&mut self, half_step: &HalfStep, forces: &[ForceRecord]) -> Result<(), Diverged> {
        if let Some(coupling) = &mut self.coupling {
            coupling.add_answers(&mut self.sums, self.columns.now.mass, forces);
            if half_step.stage == Stage::Second {
                coupling.book(half_step.dt);
            }
        }
        if half_step.stage == Stage::Second {
            self.measure_cross_viscosity(forces);
            if let Some(drift) = self.effects.drift() {
                let _phase = timeline::phase("drift");
                integration::shift(&mut self.columns, drift, half_step.dt);
            }
        }
        self.stage = half_step.next().stage;
        self.dt = half_step.dt;
        let extremes = self.integrate(half_step);
        self.remember(half_step.stage, &extremes);
        if half_step.stage == Stage::Second {
            self.close_ledger(half_step.dt);
        }
        match extremes.out_of_bounds.then(|| self.find_divergence(half_step)).flatten() {
            Some(diverged) => Err(diverged),
            None => Ok(()),
        }
    }

    fn probes(&self, out: &mut Vec<f64>) {
        self.measure(out);
    }

    fn audit(&self) -> Audit {
        self.audit_values()
    }

    fn ledger(&self) -> Option<&Ledger> {
        self.ledger.as_ref().map(|own| &own.ledger)
    }

    fn impulse(&self) -> Option<Balance> {
        self.coupling.as_ref().map(|coupling| coupling.impulse)
    }

    fn fill_frame(&self, time: f64, frame: &mut Frame) {
        self.copy_to(time, frame);
    }

    fn state_hash(&self) -> u64 {
        self.hash()
    }

    fn state(&mut self) -> Option<&mut dyn State> {
        Some(self)
    }

    fn bytes(&self) -> Option<usize> {
        Some(self.allocated())
    }

    fn composition(&self) -> Option<&str> {
        Some(&self.composition)
    }

    fn costs(&mut self) -> Costs {
        (X::passes().costs)(self)
    }

    fn pair_evaluations(&self) -> u64 {
        self.pair_evaluations
    }
}
