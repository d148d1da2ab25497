//! The model behind [`SolidModel`]: time integration and neighbour lists.

use super::account::Account;
use super::columns::{Rates, Source, State};
use super::rates::SolidSum;
use super::wall_states::{WallStates, wall_particles};
use crate::columns::{ParticleColumns, vector};
use crate::effects::{takes_part, touches_walls};
use crate::model::{Load, OutOfBounds, OuterRates, Particles, SolidModel};
use crate::shown_velocity::ShownVelocity;
use crate::side_friction;
use crate::surface::surface_set;
use crate::wall::Walls;
use halfstep_role::role::Costs;
use halfstep_role::timeline;
use halfstep_scene::bounds::Bounds;
use halfstep_scene::geometry::{self, SolidPoint};
use halfstep_scene::{ArtificialStress, EffectName, EnergyPart, KernelName, ModelKeys, Scene, Solid};
use halfstep_sph::columns::{copy, fit, moved_farther};
use halfstep_sph::lane::Isa;
use halfstep_sph::neighbours::{ClusterList, PADDING, Rows};
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::order;
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::state::StateError;
use halfstep_wire::wire_component;

const SKIN: f64 = 0.3;
/// Largest stable sub-step over dx / c_P, measured: unstable from 1.15.
const STABLE: f64 = 1.1;

/// The hypoelastic solid.
pub struct Hypoelastic<const D: usize> {
    pub(super) material: Solid,
    pub(super) bounds: Bounds,
    pub(super) kernel: KernelName,
    pub(super) isa: Isa,
    pub(super) smoothing_length: f64,
    skin: f64,
    /// dx of its own, m.
    pub(super) spacing: f64,
    pub(super) gravity: [f64; D],
    domain: ([f64; D], [f64; D]),
    pub(super) renormalised: bool,
    pub(super) wall_states: Option<WallStates<D>>,
    pub(super) artificial_stress: Option<ArtificialStress>,
    pub(super) mass: f64,
    /// The solid's particles, then those of walls that hold values toward it.
    pub(super) points: Vec<SolidPoint<D>>,
    /// Number of the solid's own.
    pub(super) own: usize,
    shown: ParticleColumns<D>,
    /// What the fluid adds to strain rates (phase-blind), by particle number; else empty.
    pub(super) outer: Vec<OuterRates<D>>,
    interface_set: Vec<u32>,
    /// Particle number of a slot, or padding.
    pub(super) id: Vec<u32>,
    /// Slot of a particle.
    pub(super) slot_of: Vec<u32>,
    pub(super) now: State<D>,
    pub(super) at_n: State<D>,
    /// State at n while sub-steps are under way.
    pub(super) step_start: State<D>,
    pub(super) rates: Rates<D>,
    pub(super) shown_velocity: ShownVelocity<D>,
    courant: f64,
    /// Deceleration by side friction, m/s².
    side_friction: Option<f64>,
    pub(super) pressure: Vec<f64>,
    pub(super) sources: Vec<Source<D>>,
    pub(super) artificial: Vec<[[f64; D]; D]>,
    /// Position at the last sort, m.
    pub(super) reference: [Vec<f64>; D],
    rows: Rows<D>,
    pub(super) neighbours: ClusterList,
    pub(super) sums: Vec<SolidSum<D>>,
    pub(super) walls: Option<Walls<D>>,
    /// What walls add to the square of a particle's highest frequency, the largest of any particle, 1/s².
    pub(super) wall_springs: f64,
    pub(super) pair_evaluations: u64,
    /// Where account is kept of what effects give.
    pub(super) account: Option<Account>,
}

impl<const D: usize> Hypoelastic<D> {
    /// The scene's solid of that index.
    pub fn new(scene: &Scene, solid: usize, isa: Isa) -> Option<Self> {
        let material = scene.solids.get(solid)?.clone();
        let layout = geometry::layout::<D>(scene).with_solid(scene, solid);
        let dx = scene.solid_spacing(solid);
        let h = material.smoothing_ratio * dx;
        let own = layout.solid.len();
        let ModelKeys::Hypoelastic(keys) = &material.model else { return None };
        let artificial_stress =
            takes_part(scene, solid, EffectName::ArtificialStress).then_some(keys.artificial_stress);
        let walls = touches_walls(scene, solid).then(|| Walls::new(scene, solid, SKIN * h)).flatten();
        let side_friction = takes_part(scene, solid, EffectName::SideFriction)
            .then(|| material.side_friction / material.density);
        let domain = geometry::domain(scene);
        let mass = material.density * dx.powi(D as i32);
        let [clamps, walls_hold] =
            [EffectName::WallClamp, EffectName::WallParticles].map(|effect| takes_part(scene, solid, effect));
        let mut points = layout.solid.clone();
        if walls_hold {
            points.extend(wall_particles(&layout.wall));
        }
        let n = points.len();
        let now = State::new(&points, material.density);
        let mut model = Self {
            bounds: Bounds::of_solid(scene, solid)?,
            kernel: scene.numerics.kernel,
            isa,
            smoothing_length: h,
            skin: SKIN * h,
            spacing: dx,
            gravity: std::array::from_fn(|d| scene.gravity[d]),
            domain: (std::array::from_fn(|d| domain.min[d]), std::array::from_fn(|d| domain.max[d])),
            renormalised: takes_part(scene, solid, EffectName::RenormalisedGradient),
            wall_states: (clamps || walls_hold).then(|| WallStates::new(clamps)),
            artificial_stress,
            shown: ParticleColumns::new(&layout.solid, mass),
            outer: Vec::new(),
            mass,
            material,
            interface_set: {
                let body = geometry::pieces(scene, &layout);
                surface_set(&layout.solid, &body, 2.0 * scene.smoothing_ratio * scene.resolution, dx)
            },
            shown_velocity: ShownVelocity::new(layout.solid.iter().map(|p| p.velocity)),
            points,
            own,
            id: (0..n as u32).collect(),
            slot_of: vec![0; n],
            at_n: now.clone(),
            step_start: now.clone(),
            courant: scene.numerics.solid_cfl,
            side_friction,
            reference: now.position.clone(),
            now,
            rates: Rates::new(),
            pressure: Vec::new(),
            sources: Vec::new(),
            artificial: Vec::new(),
            rows: Rows::default(),
            neighbours: ClusterList::narrow(),
            sums: Vec::new(),
            walls,
            wall_springs: 0.0,
            pair_evaluations: 0,
            account: None,
        };
        model.sort();
        if let Some(mut walls) = model.walls.take() {
            walls.begin(model.touching());
            model.walls = Some(walls);
        }
        model.apply_state_equation();
        model.show_particles();
        Some(model)
    }

    /// The rows as they were at the last sort.
    pub(super) fn sort_rows_at_reference(&mut self) -> Result<(), StateError> {
        let (height, domain) = (2.0 * self.spacing, self.domain);
        order::sort_again(&mut self.rows, &self.reference, &self.id, height, domain, "the solid's rows")
    }

    /// Notes the slot of each particle.
    pub(super) fn slot_particles(&mut self) {
        for (slot, &id) in self.id.iter().enumerate().filter(|&(_, &id)| id != PADDING) {
            self.slot_of[id as usize] = slot as u32;
        }
    }

    /// Lists who is near whom, from the positions at the last sort.
    pub(super) fn list(&mut self) {
        let reach = 2.0 * self.smoothing_length + self.skin;
        self.neighbours.build(&self.reference, &self.reference, &self.rows, reach);
        fit(&mut self.sums, self.neighbours.fours(), SolidSum::default());
        if let Some(walls) = &mut self.walls {
            walls.relist(&self.id, &self.reference);
        }
    }

    pub(super) fn sort(&mut self) {
        // Rows two spacings high: four neighbours in a row are a square.
        self.rows.sort(&self.now.position, &self.id, 2.0 * self.spacing, self.domain.0, self.domain.1);
        self.now.permute(&mut self.rows);
        self.at_n.permute(&mut self.rows);
        self.step_start.permute(&mut self.rows);
        self.rows.permute_ids(&mut self.id);
        self.slot_particles();
        let slots = self.id.len();
        for d in 0..D {
            copy(&mut self.reference[d], &self.now.position[d]);
        }
        fit(&mut self.pressure, slots, 0.0);
        fit(&mut self.sources, slots, Source::ZERO);
        if self.artificial_stress.is_some() {
            fit(&mut self.artificial, slots, [[0.0; D]; D]);
        }
        self.rates.resize(slots);
        self.list();
    }

    pub(super) fn moved_too_far(&self) -> bool {
        let walls_moved = self.walls.as_ref().is_some_and(|walls| walls.displacement() > 0.5 * self.skin);
        walls_moved || moved_farther(&self.now.position, &self.reference, &self.id, 0.5 * self.skin)
    }

    /// now = from + dt rates, for every advanced column; `from` is `at_n`. `kept`: the whole of a sub-step.
    fn integrate(&mut self, dt: f64, kept: bool) {
        fn axpy(out: &mut [f64], from: &[f64], rate: &[f64], dt: f64) {
            for ((o, f), r) in out.iter_mut().zip(from).zip(rate) {
                *o = f + dt * r;
            }
        }
        for d in 0..D {
            axpy(&mut self.now.position[d], &self.at_n.position[d], &self.now.velocity[d], dt);
            axpy(&mut self.now.velocity[d], &self.at_n.velocity[d], &self.rates.acceleration[d], dt);
            for b in d..D {
                axpy(&mut self.now.stress[d][b], &self.at_n.stress[d][b], &self.rates.stress[d][b], dt);
            }
        }
        axpy(&mut self.now.density, &self.at_n.density, &self.rates.density, dt);
        if let Some(friction) = self.side_friction {
            let before = (kept && self.account.is_some()).then(|| self.now.velocity.clone());
            side_friction::slow(&mut self.now.velocity, dt * friction, |_| true);
            if let Some(before) = before {
                self.note_friction(&before);
            }
        }
        self.apply_state_equation();
    }

    /// Energy stored by the particle at a slot, J (2D: J/m), of these moduli, Pa.
    fn stored_at(&self, slot: usize, bulk_modulus: f64, shear_modulus: f64) -> f64 {
        let t = self.stress_at(slot);
        let mut norm: f64 = t.as_flattened().iter().map(|v| v * v).sum();
        if D == 2 {
            norm += (t[0][0] + t[1][1]).powi(2);
        }
        let compressed = self.pressure[slot].powi(2) / (2.0 * bulk_modulus);
        self.sources[slot].volume * (compressed + norm / (4.0 * shear_modulus))
    }

    /// Brings walls that move to where they are at a time, s.
    fn move_walls(&mut self, time: f64) {
        if let Some(walls) = &mut self.walls {
            walls.set_time(time);
        }
    }

    /// One midpoint sub-step of the present state at `time`, whose copy at its start is `at_n`.
    fn midpoint(&mut self, dt: f64, time: f64, load: &Load<D>) {
        self.move_walls(time);
        self.compute_rates(load);
        self.integrate(0.5 * dt, false);
        self.move_walls(time + 0.5 * dt);
        self.compute_rates(load);
        self.note_rates(dt);
        self.integrate(dt, true);
    }

    /// `count` midpoint sub-steps over `dt` from the present state at `time`.
    fn sub_step(&mut self, count: u32, dt: f64, time: f64, load: &Load<D>) {
        let each = dt / f64::from(count);
        for k in 0..count {
            let _phase = timeline::phase("sub-step");
            self.at_n.copy_from(&self.now);
            self.midpoint(each, time + f64::from(k) * each, load);
        }
    }

    /// Copies the present state to the columns by particle number.
    pub(super) fn show_particles(&mut self) {
        for (p, &slot) in self.slot_of[..self.own].iter().enumerate() {
            let s = slot as usize;
            self.shown.position[p] = std::array::from_fn(|d| self.now.position[d][s]);
            self.shown.velocity[p] = std::array::from_fn(|d| self.now.velocity[d][s]);
            self.shown.density[p] = self.now.density[s];
        }
    }

    pub(super) fn record(&self, particle: u32) -> StateRecord {
        let s = self.slot_of[particle as usize] as usize;
        let velocity = self.shown_velocity.of(particle);
        let mut r = StateRecord {
            id: particle,
            flags: u32::from(self.points[particle as usize].clamped),
            density: self.now.density[s],
            pressure: self.pressure[s],
            mass: self.mass,
            ..StateRecord::default()
        };
        for a in 0..D {
            r.position[a] = self.now.position[a][s];
            r.velocity[a] = velocity[a];
            for b in a..D {
                r.deviatoric_stress[wire_component(a, b)] = self.now.stress[a][b][s];
            }
        }
        if D == 2 {
            r.deviatoric_stress[2] = -(self.now.stress[0][0][s] + self.now.stress[1][1][s]);
        }
        r
    }
}

impl<const D: usize> SolidModel<D> for Hypoelastic<D> {
    fn particles(&self) -> Particles<'_, D> {
        self.shown.view()
    }

    fn interface_set(&self) -> &[u32] {
        &self.interface_set
    }

    fn set_gravity(&mut self, gravity: [f64; D]) {
        self.gravity = gravity;
    }

    fn records(&self, particles: &[u32], out: &mut Vec<StateRecord>) {
        out.extend(particles.iter().map(|&p| self.record(p)));
    }

    fn take_outer_rates(&mut self, rates: &[OuterRates<D>]) {
        self.outer.clear();
        self.outer.extend_from_slice(rates);
    }

    fn sub_step_limit(&self) -> f64 {
        // The scene's solid_cfl keeps clear of what is stable.
        let limit = self.courant * self.spacing / self.material.pressure_wave_speed();
        if self.wall_springs == 0.0 {
            return limit;
        }
        let waves = (2.0 * self.material.pressure_wave_speed() / (STABLE * self.spacing)).powi(2);
        limit / (1.0 + self.wall_springs / waves).sqrt()
    }

    fn advance(&mut self, half_step: &HalfStep, sub_steps: u32, load: &Load<D>) -> Result<(), OutOfBounds> {
        let first = half_step.stage == Stage::First;
        if first {
            self.open_account();
            let (slot_of, now) = (&self.slot_of, &self.now.position);
            self.shown_velocity.leave(|p| vector(now, slot_of[p]));
        }
        self.keep_rates(!first);
        if sub_steps == 1 {
            if first {
                self.at_n.copy_from(&self.now);
            }
            self.move_walls(half_step.before());
            self.compute_rates(load);
            self.note_rates(half_step.span());
            self.integrate(half_step.span(), !first);
        } else if first {
            self.step_start.copy_from(&self.now);
            self.sub_step(sub_steps / 2, half_step.span(), half_step.time, load);
        } else {
            self.now.copy_from(&self.step_start);
            self.apply_state_equation();
            self.sub_step(sub_steps, half_step.span(), half_step.time, load);
        }
        self.keep_rates(false);
        if !first {
            self.close_account();
            self.wall_springs = self.springs_of_walls();
            self.walls.iter_mut().for_each(Walls::leave);
        }
        let (slot_of, now) = (&self.slot_of, &self.now);
        let place = |p: usize| vector(&now.position, slot_of[p]);
        self.shown_velocity.arrive(half_step, sub_steps, place, |p| vector(&now.velocity, slot_of[p]));
        self.show_particles();
        self.check()
    }

    fn keep_account(&mut self) {
        self.account = Some(Account::default());
    }

    fn account(&mut self, give: &mut dyn FnMut(EnergyPart, f64)) {
        if let Some(account) = &mut self.account {
            account.given.hand_over(give);
        }
    }

    fn strain_energy(&self) -> f64 {
        let (k, g) = (self.material.bulk_modulus(), self.material.shear_modulus());
        self.slot_of[..self.own].iter().map(|&slot| self.stored_at(slot as usize, k, g)).sum()
    }

    fn energy_of(&self, particles: &[u32]) -> f64 {
        let (k, g) = (self.material.bulk_modulus(), self.material.shear_modulus());
        let stored = particles.iter().map(|&p| self.stored_at(self.slot_of[p as usize] as usize, k, g));
        self.particles().kinetic_energy_of(particles) + stored.sum::<f64>()
    }

    fn contact_forces(&self, give: &mut dyn FnMut(u32, [f64; D])) {
        let Some(walls) = &self.walls else { return };
        for (id, &slot) in self.slot_of[..self.own].iter().enumerate() {
            give(id as u32, walls.acceleration(slot as usize).map(|a| self.mass * a));
        }
    }

    fn state(&mut self) -> Option<&mut dyn halfstep_wire::state::State> {
        Some(self)
    }

    fn costs(&mut self) -> Costs {
        self.costs_of_effects()
    }

    fn pair_evaluations(&self) -> u64 {
        self.pair_evaluations
    }
}
