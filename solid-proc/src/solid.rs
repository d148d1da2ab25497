//! The solid as a [`Role`]: interface record, loads, sub-steps, probes.

use crate::effects::takes_part;
use crate::hypoelastic::Hypoelastic;
use crate::model::{Load, SolidModel};
use crate::sleep::{Rest, Sleep};
use crate::sub_steps::SubStepping;
use crate::total_lagrangian::TotalLagrangian;
use halfstep_interface::{Interface, Parameters};
use halfstep_role::role::{Costs, CoverageError, Peer, Role};
use halfstep_scene::geometry::{holds, nearest};
use halfstep_scene::{EffectName, Phase, ProbeKind, Scene, SolidModelName, Treatment};
use halfstep_sph::lane::Isa;
use halfstep_wire::failure::Diverged;
use halfstep_wire::frame::Frame;
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::{Audit, ForceRecord, StateRecord};
use halfstep_wire::{Name, wide};
use xxhash_rust::xxh3::Xxh3;

/// A solid model with what the lock-step asks of it.
pub struct Solid<const D: usize> {
    name: Name,
    model: Box<dyn SolidModel<D>>,
    /// Phase-blind coupling: the fluid's share in density and velocity gradient.
    interface: Option<Interface<D>>,
    load: Load<D>,
    probes: Vec<Measurement>,
    sub_steps: SubStepping,
    taken: u32,
    density: f64,
    limit: f64,
    cross_pairs: u64,
    sleep: Option<Sleep>,
}

enum Measurement {
    /// Mean displacement of these particles.
    Displacement(Vec<u32>),
    KineticEnergy,
    Centroid,
    /// Force of the fluid on these particles.
    Force(Vec<u32>),
}

impl<const D: usize> Solid<D> {
    /// The scene's solid of that index, with the model that it names.
    pub fn new(scene: &Scene, solid: usize, isa: Isa) -> Option<Self> {
        let model: Box<dyn SolidModel<D>> = match scene.solids.get(solid)?.model {
            SolidModelName::Hypoelastic => Box::new(Hypoelastic::<D>::new(scene, solid, isa)?),
            SolidModelName::TotalLagrangian => Box::new(TotalLagrangian::<D>::new(scene, solid, isa)?),
        };
        Some(Self::with_model(scene, solid, isa, model))
    }

    /// With any model.
    pub fn with_model(scene: &Scene, solid: usize, isa: Isa, model: Box<dyn SolidModel<D>>) -> Self {
        let phase_blind = scene.interface.treatment == Treatment::PhaseBlind;
        let interface = Parameters::<D>::new(scene, solid, isa).filter(|_| phase_blind).map(Interface::new);
        let probes = scene
            .probes
            .iter()
            .filter(|p| p.solid == Some(solid))
            .filter_map(|p| match p.kind {
                ProbeKind::Displacement { at } => {
                    let references = (0..model.particles() as u32).map(|p| model.reference(p));
                    let near = nearest(references, std::array::from_fn(|d| at[d]));
                    Some(Measurement::Displacement(near.into_iter().map(|p| p as u32).collect()))
                }
                ProbeKind::KineticEnergy { phase: Phase::Solid } => Some(Measurement::KineticEnergy),
                ProbeKind::Centroid { phase: Phase::Solid } => Some(Measurement::Centroid),
                ProbeKind::Force { within } => {
                    let set = model.interface_set().iter().copied();
                    let inside = |p: &u32| within.is_none_or(|b| holds(&b, &model.reference(*p), 0.0));
                    Some(Measurement::Force(set.filter(inside).collect()))
                }
                _ => None,
            })
            .collect();
        let material = scene.solids.get(solid);
        let sleep = takes_part(scene, solid, EffectName::SleepingSolid)
            .then(|| material.map(|material| Sleep::new(scene, material, model.as_ref())))
            .flatten();
        let name = material.and_then(|solid| solid.name.parse().ok()).unwrap_or(Name::SOLID);
        Self {
            name,
            sleep,
            load: Load::none(model.particles()),
            limit: model.sub_step_limit(),
            model,
            interface,
            probes,
            sub_steps: SubStepping::of(scene, solid),
            taken: 1,
            density: material.map_or(1.0, |s| s.density),
            cross_pairs: 0,
        }
    }

    fn all(&self) -> std::ops::Range<u32> {
        0..self.model.particles() as u32
    }

    fn kinetic_energy(&self) -> f64 {
        self.all()
            .map(|p| 0.5 * self.model.mass(p) * self.model.velocity(p).iter().map(|v| v * v).sum::<f64>())
            .sum()
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
        self.model.particles() as u64
    }

    fn dt_limit(&self) -> f64 {
        self.limit * f64::from(self.sub_steps.most())
    }

    fn publish(&mut self, _peers: &[Peer], out: &mut Vec<StateRecord>) -> u64 {
        out.clear();
        out.extend(self.model.interface_set().iter().map(|&p| self.model.record(p)));
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
        let n = self.model.particles();
        self.load.density_rate.resize(n, 0.0);
        self.load.gradient.resize(n, [[0.0; D]; D]);
        let load = &mut self.load;
        interface.rates_of_solid(|record, density_rate, gradient| {
            let p = own[record].id as usize;
            load.density_rate[p] = density_rate;
            load.gradient[p] = gradient;
        });
        Ok(())
    }

    fn advance(&mut self, half_step: &HalfStep, forces: &[ForceRecord]) -> Result<(), Diverged> {
        for force in forces {
            let whole = force.force(self.model.mass(force.id));
            self.load.force[force.id as usize] = std::array::from_fn(|d| whole[d]);
        }
        if half_step.stage == Stage::First {
            self.taken = self.sub_steps.choose(half_step.dt, self.limit);
        }
        let rest = match &mut self.sleep {
            Some(sleep) => sleep.decide(half_step, &self.load, self.model.as_ref()),
            None => Rest::Awake,
        };
        let outcome = match rest {
            Rest::Asleep => return Ok(()),
            Rest::Awake => self.model.advance(half_step, self.taken, &self.load),
            Rest::Woken => {
                let none = Load::none(self.model.particles());
                let [first, second] = half_step.both();
                self.model
                    .advance(&first, self.taken, &none)
                    .and_then(|()| self.model.advance(&second, self.taken, &self.load))
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
        Ok(())
    }

    fn sub_steps(&self) -> u32 {
        self.taken
    }

    fn probes(&self, out: &mut Vec<f64>) {
        let mut put = |value: f64| out.push(value);
        for probe in &self.probes {
            match probe {
                Measurement::Displacement(particles) => {
                    for d in 0..D {
                        let sum: f64 = particles
                            .iter()
                            .map(|&p| self.model.position(p)[d] - self.model.reference(p)[d])
                            .sum();
                        put(sum / particles.len() as f64);
                    }
                }
                Measurement::KineticEnergy => put(self.kinetic_energy()),
                Measurement::Centroid => {
                    let mass: f64 = self.all().map(|p| self.model.mass(p)).sum();
                    for d in 0..D {
                        let moment: f64 =
                            self.all().map(|p| self.model.mass(p) * self.model.position(p)[d]).sum();
                        put(moment / mass);
                    }
                }
                Measurement::Force(particles) => {
                    for d in 0..D {
                        put(particles.iter().map(|&p| self.load.force[p as usize][d]).sum());
                    }
                }
            }
        }
    }

    fn audit(&self) -> Audit {
        let (mut momentum, mut sum, mut density_error) = ([0.0; D], 0.0, 0.0_f64);
        for p in self.all() {
            let (velocity, mass) = (self.model.velocity(p), self.model.mass(p));
            for d in 0..D {
                momentum[d] += mass * velocity[d];
            }
            sum += mass;
            density_error = density_error.max((self.model.density(p) / self.density - 1.0).abs());
        }
        Audit {
            momentum: wide(momentum),
            kinetic_energy: self.kinetic_energy(),
            mass: sum,
            density_error,
            gap: f64::INFINITY,
            stored_energy: self.model.strain_energy(),
        }
    }

    fn fill_frame(&self, time: f64, frame: &mut Frame) {
        frame.clear();
        frame.time = time;
        self.model.fill_frame(frame);
    }

    fn state_hash(&self) -> u64 {
        let mut hash = Xxh3::new();
        for p in self.all() {
            let r = self.model.record(p);
            let v = self.model.velocity(p);
            hash.update(&p.to_le_bytes());
            for value in r.position.iter().chain(&v).chain(&r.deviatoric_stress) {
                hash.update(&value.to_le_bytes());
            }
            hash.update(&r.density.to_le_bytes());
        }
        hash.digest()
    }

    fn costs(&mut self) -> Costs {
        Costs { of_whole: true, ..self.model.costs() }
    }

    fn pair_evaluations(&self) -> u64 {
        self.model.pair_evaluations() + self.cross_pairs
    }
}
