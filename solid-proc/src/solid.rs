//! The solid as a [`Role`]: interface record, loads, sub-steps, probes.

use crate::effects::takes_part;
use crate::ledger::SolidLedger;
use crate::model::{Load, OutOfBounds, OuterRates, SolidModel};
use crate::models;
use crate::probes::{self, Measured, Measurement};
use crate::sleep::{Rest, Sleep};
use crate::sub_steps::SubStepping;
use halfstep_interface::{Interface, Parameters};
use halfstep_role::ledger::Ledger;
use halfstep_role::role::{Costs, CoverageError, Peer, Role};
use halfstep_scene::geometry;
use halfstep_scene::{EffectName, Gravity, Phase, Scene, Treatment};
use halfstep_sph::lane::Isa;
use halfstep_wire::failure::Diverged;
use halfstep_wire::frame::{Frame, FramePoint, von_mises};
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::{Audit, ForceRecord, StateRecord};
use halfstep_wire::state::{Fields, State, StateError};
use halfstep_wire::{Name, wide};
use xxhash_rust::xxh3::Xxh3;

/// A solid model with what the lock-step asks of it.
pub struct Solid<const D: usize> {
    name: Name,
    model: Box<dyn SolidModel<D>>,
    gravity: Gravity,
    /// Phase-blind coupling: the fluid's share in density and velocity gradient.
    interface: Option<Interface<D>>,
    load: Load<D>,
    /// Phase-blind coupling: the fluid's share, by particle number; else empty.
    outer: Vec<OuterRates<D>>,
    /// All particle numbers.
    all: Vec<u32>,
    /// Number of each particle's body at the start; empty where the model's particles are not the scene's.
    bodies: Vec<u32>,
    probes: Vec<Measurement<D>>,
    /// Force of contacts on each particle when the run was stopped, N (2D: N/m); empty once the model has gone on.
    contact_at_stop: Vec<[f64; D]>,
    sub_steps: SubStepping,
    taken: u32,
    density: f64,
    limit: f64,
    cross_pairs: u64,
    /// Those before the sums of the present state.
    cross_pairs_before: u64,
    sleep: Option<Sleep>,
    /// Where the scene's probes ask for energies.
    ledger: Option<SolidLedger<D>>,
}

impl<const D: usize> Solid<D> {
    /// The scene's solid of that index, with the model that it names.
    pub fn new(scene: &Scene, solid: usize, isa: Isa) -> Option<Self> {
        Some(Self::with_model(scene, solid, isa, models::build(scene, solid, isa)?))
    }

    /// With any model.
    pub fn with_model(scene: &Scene, solid: usize, isa: Isa, mut model: Box<dyn SolidModel<D>>) -> Self {
        if scene.keeps_energy_ledgers() {
            model.keep_account();
        }
        let ledger = scene.keeps_energy_ledgers().then(|| SolidLedger::new(scene, &*model));
        let phase_blind = scene.interface.treatment == Treatment::PhaseBlind;
        let interface = Parameters::<D>::new(scene, solid, isa).filter(|_| phase_blind).map(Interface::new);
        let particles = model.particles();
        let probes = probes::of_solid(scene, solid, model.as_ref());
        let material = scene.solids.get(solid);
        let sleep = takes_part(scene, solid, EffectName::SleepingSolid)
            .then(|| {
                material.map(|material| Sleep::new(scene, material, scene.solid_spacing(solid), particles))
            })
            .flatten();
        let mut bodies = match model.body_of() {
            [] => geometry::pieces(scene, &geometry::layout::<D>(scene).with_solid(scene, solid)),
            own => own.to_vec(),
        };
        if bodies.len() != particles.len() {
            bodies.clear();
        }
        let name = material.and_then(|solid| solid.name.parse().ok()).unwrap_or(Name::SOLID);
        Self {
            name,
            gravity: Gravity::of(scene),
            sleep,
            load: Load::none(particles.len()),
            outer: Vec::new(),
            all: (0..particles.len() as u32).collect(),
            limit: model.sub_step_limit(),
            bodies,
            model,
            interface,
            probes,
            contact_at_stop: Vec::new(),
            sub_steps: SubStepping::of(scene, solid),
            taken: 1,
            density: material.map_or(1.0, |s| s.density),
            cross_pairs: 0,
            cross_pairs_before: 0,
            ledger,
        }
    }

    /// One half-step of the model under the load; phase-blind, with the fluid's share in its rates.
    fn advance_model(&mut self, half_step: &HalfStep) -> Result<(), OutOfBounds> {
        if self.interface.is_some() {
            self.model.take_outer_rates(&self.outer);
        }
        self.contact_at_stop.clear();
        self.model.advance(half_step, self.taken, &self.load)
    }

    /// What probes see.
    fn measured(&self) -> Measured<'_, D> {
        Measured {
            model: self.model.as_ref(),
            load: &self.load,
            ledger: self.ledger.as_ref().map(|own| &own.ledger),
            contact: &self.contact_at_stop,
        }
    }
}

impl<const D: usize> State for Solid<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.points("force", &mut self.load.force)?;
        fields.length("force", self.all.len(), self.load.force.len())?;
        fields.small_count("sub_steps", &mut self.taken)?;
        // That of the last step's end: contacts that were listed anew may have another.
        fields.real("sub_step_limit", &mut self.limit)?;
        // The sums of the state are evaluated again.
        fields.count("cross_pairs", &mut self.cross_pairs_before)?;
        if fields.loading() {
            self.cross_pairs = self.cross_pairs_before;
        }
        if let Some(sleep) = &mut self.sleep {
            fields.part("sleep", sleep)?;
        }
        if let Some(interface) = &mut self.interface {
            fields.part("interface", interface)?;
        }
        if let Some(own) = &mut self.ledger {
            fields.part("energy", &mut own.ledger)?;
        }
        if self.probes.iter().any(Measurement::asks_for_contact) {
            // Models evaluate contacts within a sub-step: no state at its end has them.
            let mut force = self.measured().contact_forces();
            fields.points("contact_force", &mut force)?;
            fields.length("contact_force", self.all.len(), force.len())?;
            if fields.loading() {
                self.contact_at_stop = force;
            }
        }
        match self.model.state() {
            Some(model) => fields.part("model", model),
            None => Err(StateError::contradiction("the solid's model cannot be saved")),
        }
    }

    fn restored(&mut self) -> Result<(), StateError> {
        if let Some(interface) = &mut self.interface {
            interface.restored()?;
        }
        self.model.state().map_or(Ok(()), State::restored)
    }
}

impl<const D: usize> Role for Solid<D> {
    fn name(&self) -> Name {
        self.name
    }

    fn phase(&self) -> Phase {
        Phase::Solid
    }

    fn particles(&self) -> u64 {
        self.all.len() as u64
    }

    fn dt_limit(&self) -> f64 {
        self.limit * f64::from(self.sub_steps.most())
    }

    fn set_time(&mut self, time: f64) {
        let gravity = self.gravity.at(time);
        self.model.set_gravity(gravity);
        if let Some(interface) = &mut self.interface {
            interface.parameters.gravity = gravity;
        }
    }

    fn publish(&mut self, _peers: &[Peer], out: &mut Vec<StateRecord>) -> u64 {
        out.clear();
        self.cross_pairs_before = self.cross_pairs;
        self.model.records(self.model.interface_set(), out);
        0
    }

    fn displacement(&self) -> f64 {
        0.0
    }

    fn own_sums(&mut self) {}

    fn cross_sums(&mut self, own: &[StateRecord], peers: &[Peer]) -> Result<(), CoverageError> {
        let (Some(interface), [fluid]) = (&mut self.interface, peers) else { return Ok(()) };
        interface.update(&fluid.records, own, fluid.epoch);
        self.cross_pairs += interface.pairs() as u64;
        self.outer.resize(self.all.len(), OuterRates::ZERO);
        let outer = &mut self.outer;
        interface.rates_of_solid(|record, density, gradient| {
            outer[own[record].id as usize] = OuterRates { density, gradient };
        });
        Ok(())
    }

    fn advance(&mut self, half_step: &HalfStep, forces: &[ForceRecord]) -> Result<(), Diverged> {
        let mass = self.model.particles().mass;
        for force in forces {
            let whole = force.force(mass[force.id as usize]);
            self.load.force[force.id as usize] = std::array::from_fn(|d| whole[d]);
        }
        if half_step.stage == Stage::First {
            self.taken = self.sub_steps.choose(half_step.dt, self.limit);
            if let Some(ledger) = &mut self.ledger {
                ledger.leave(&*self.model);
            }
        }
        let rest = match &mut self.sleep {
            Some(sleep) => sleep.decide(half_step, &self.load, &self.outer, self.model.particles()),
            None => Rest::Awake,
        };
        let outcome = match rest {
            Rest::Asleep => return Ok(()),
            Rest::Awake => self.advance_model(half_step),
            Rest::Woken => {
                let none = Load::none(self.all.len());
                let [first, second] = half_step.both();
                self.model.take_outer_rates(&[]);
                self.model.advance(&first, self.taken, &none).and_then(|()| self.advance_model(&second))
            }
        };
        outcome.map_err(|o| Diverged {
            participant: self.name,
            particle: o.particle,
            quantity: o.quantity,
            value: o.value,
            step: half_step.step,
            stage: half_step.stage,
            position: o.position,
        })?;
        self.limit = self.model.sub_step_limit();
        if let Some(ledger) = self.ledger.as_mut().filter(|_| half_step.stage == Stage::Second) {
            ledger.arrive(&mut *self.model, forces);
        }
        Ok(())
    }

    fn sub_steps(&self) -> u32 {
        self.taken
    }

    fn probes(&self, out: &mut Vec<f64>) {
        self.probes.iter().for_each(|probe| probe.measure(self.measured(), out));
        self.probes.iter().for_each(|probe| probe.accompany(self.model.as_ref(), out));
    }

    fn audit(&self) -> Audit {
        let (mut momentum, mut sum, mut density_error) = ([0.0; D], 0.0, 0.0_f64);
        let state = self.model.particles();
        for ((mass, velocity), density) in state.mass.iter().zip(state.velocity).zip(state.density) {
            for d in 0..D {
                momentum[d] += mass * velocity[d];
            }
            sum += mass;
            density_error = density_error.max((density / self.density - 1.0).abs());
        }
        let bodies = self.model.rigid_bodies();
        if !bodies.is_empty() {
            let of = |d: usize| bodies.iter().map(|body| body.mass * body.velocity[d]).sum();
            momentum = std::array::from_fn(of);
            sum = bodies.iter().map(|body| body.mass).sum();
        }
        Audit {
            momentum: wide(momentum),
            kinetic_energy: self.model.kinetic_energy(),
            mass: sum,
            density_error,
            gap: f64::INFINITY,
            stored_energy: self.model.strain_energy(),
        }
    }

    fn ledger(&self) -> Option<&Ledger> {
        self.ledger.as_ref().map(|own| &own.ledger)
    }

    fn fill_frame(&self, time: f64, frame: &mut Frame) {
        frame.clear();
        frame.time = time;
        let mut records = Vec::with_capacity(self.all.len());
        self.model.records(&self.all, &mut records);
        records.iter().for_each(|r| frame.push(FramePoint::solid(r)));
        let state = self.model.particles();
        let gone = |(now, first): (&[f64; D], &[f64; D])| {
            wide::<D>(std::array::from_fn(|d| now[d] - first[d])).map(|u| u as f32)
        };
        frame.displacement.extend(state.position.iter().zip(state.reference).map(gone));
        if self.model.rigid_bodies().is_empty() {
            frame.von_mises.extend(records.iter().map(|r| von_mises(&r.deviatoric_stress) as f32));
        }
        let bodies = self.model.parted().unwrap_or(&self.bodies);
        frame.body.extend(bodies.iter().map(|&body| body as i32));
        if self.model.breaks() {
            frame.damage.extend(self.all.iter().map(|&p| self.model.damage(p) as f32));
        }
    }

    fn state_hash(&self) -> u64 {
        let mut hash = Xxh3::new();
        let mut records = Vec::with_capacity(self.all.len());
        self.model.records(&self.all, &mut records);
        for (r, v) in records.iter().zip(self.model.particles().velocity) {
            hash.update(&r.id.to_le_bytes());
            for value in r.position.iter().chain(v).chain(&r.deviatoric_stress) {
                hash.update(&value.to_le_bytes());
            }
            hash.update(&r.density.to_le_bytes());
        }
        hash.digest()
    }

    fn costs(&mut self) -> Costs {
        Costs { of_whole: true, ..self.model.costs() }
    }

    fn state(&mut self) -> Option<&mut dyn State> {
        self.model.state().is_some().then_some(self as &mut dyn State)
    }

    fn open_joints(&self) -> Vec<(String, f64)> {
        self.model.open_joints()
    }

    fn jerked_joints(&self) -> Vec<(String, [f64; 2])> {
        self.model.jerked_joints()
    }

    fn pair_evaluations(&self) -> u64 {
        self.model.pair_evaluations() + self.cross_pairs
    }
}
