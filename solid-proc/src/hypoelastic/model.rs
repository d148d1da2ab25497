//! The model behind [`SolidModel`]: time integration, equation of state, neighbour lists.

use super::artificial_stress;
use super::columns::{Rates, State, Tensors, tensors};
use super::gradient::renormalise;
use super::rates::{ArtificialStress, Moment, Plain, Renormalised, SolidLaw, SolidSum, TensileCorrection};
use super::stress_rate::jaumann;
use super::wall::{Push, WallForce, Walls};
use crate::model::{Load, OutOfBounds, SolidModel};
use halfstep_shared::extrapolation::{Extrapolation, ExtrapolationSum};
use halfstep_shared::failure::Quantity;
use halfstep_shared::geometry::{self, SolidPoint};
use halfstep_shared::interface::wire_component;
use halfstep_shared::kernel::Kernel;
use halfstep_shared::lane::{Isa, LANES};
use halfstep_shared::neighbours::{ClusterList, PADDING, Rows};
use halfstep_shared::output::{Frame, FramePoint};
use halfstep_shared::pair;
use halfstep_shared::protocol::StateRecord;
use halfstep_shared::scene::{EffectName, KernelName, Phase, Scene, Solid, Switch};
use halfstep_shared::{wide, with_kernel};
use std::marker::PhantomData;

const SKIN: f64 = 0.3;

/// The hypoelastic solid.
pub struct Hypoelastic<const D: usize> {
    material: Solid,
    kernel: KernelName,
    isa: Isa,
    smoothing_length: f64,
    skin: f64,
    resolution: f64,
    gravity: [f64; D],
    domain: ([f64; D], [f64; D]),
    renormalised: bool,
    artificial_stress: Option<u32>,
    mass: f64,
    points: Vec<SolidPoint<D>>,
    interface_set: Vec<u32>,
    /// Particle number of a slot, or padding.
    id: Vec<u32>,
    /// Slot of a particle.
    slot_of: Vec<u32>,
    now: State<D>,
    at_n: State<D>,
    /// State at n while sub-steps are under way.
    step_start: State<D>,
    rates: Rates<D>,
    /// Velocity shown to the fluid: the mean over the sub-steps of a stage.
    shown_velocity: [Vec<f64>; D],
    /// Positions at the start of a stage, by particle number.
    stage_start: Vec<[f64; D]>,
    courant: f64,
    pressure: Vec<f64>,
    volume: Vec<f64>,
    stress_term: Tensors<D>,
    artificial: Tensors<D>,
    reference: [Vec<f64>; D],
    rows: Rows<D>,
    list: ClusterList,
    sums: Vec<SolidSum<D>>,
    walls: Option<Walls<D>>,
    pair_evaluations: u64,
}

impl<const D: usize> Hypoelastic<D> {
    /// The solid of a scene that has one.
    pub fn new(scene: &Scene, isa: Isa) -> Option<Self> {
        let material = scene.solid.clone()?;
        let layout = geometry::layout::<D>(scene);
        let h = material.smoothing_ratio * scene.resolution;
        let n = layout.solid.len();
        let exponent = material.artificial_stress.exponent.round() as u32;
        let artificial = material.artificial_stress.strength > 0.0
            && scene.switch(EffectName::ArtificialStress) != Switch::Off;
        let walls = (scene.switch(EffectName::WallContact) != Switch::Off)
            .then(|| Walls::new(&layout.wall, (2.0 + SKIN) * h))
            .flatten();
        let domain = geometry::domain(scene);
        let now = State::new(&layout.solid, material.density);
        let mut model = Self {
            kernel: scene.numerics.kernel,
            isa,
            smoothing_length: h,
            skin: SKIN * h,
            resolution: scene.resolution,
            gravity: std::array::from_fn(|d| scene.gravity[d]),
            domain: (std::array::from_fn(|d| domain.min[d]), std::array::from_fn(|d| domain.max[d])),
            renormalised: scene.switch(EffectName::RenormalisedGradient) == Switch::On,
            artificial_stress: artificial.then_some(exponent),
            mass: material.density * scene.resolution.powi(D as i32),
            material,
            interface_set: surface_set(
                &layout.solid,
                2.0 * scene.smoothing_ratio * scene.resolution,
                scene.resolution,
            ),
            points: layout.solid,
            id: (0..n as u32).collect(),
            slot_of: vec![0; n],
            at_n: now.clone(),
            step_start: now.clone(),
            stage_start: vec![[0.0; D]; n],
            courant: scene.numerics.solid_cfl,
            shown_velocity: now.velocity.clone(),
            reference: now.position.clone(),
            now,
            rates: Rates::new(),
            pressure: Vec::new(),
            volume: Vec::new(),
            stress_term: tensors(0),
            artificial: tensors(0),
            rows: Rows::default(),
            list: ClusterList::default(),
            sums: Vec::new(),
            walls,
            pair_evaluations: 0,
        };
        model.sort();
        model.apply_state_equation();
        Some(model)
    }

    fn sort(&mut self) {
        let reach = 2.0 * self.smoothing_length + self.skin;
        self.rows.sort(&self.now.position, &self.id, reach, self.domain.0, self.domain.1);
        self.now.permute(&mut self.rows);
        self.at_n.permute(&mut self.rows);
        self.step_start.permute(&mut self.rows);
        for column in &mut self.shown_velocity {
            self.rows.permute(column);
        }
        self.rows.permute_ids(&mut self.id);
        for (slot, &id) in self.id.iter().enumerate() {
            if id != PADDING {
                self.slot_of[id as usize] = slot as u32;
            }
        }
        let slots = self.id.len();
        for d in 0..D {
            self.reference[d].clone_from(&self.now.position[d]);
            for b in d..D {
                self.stress_term[d][b].resize(slots, 0.0);
                if self.artificial_stress.is_some() {
                    self.artificial[d][b].resize(slots, 0.0);
                }
            }
        }
        self.pressure.resize(slots, 0.0);
        self.volume.resize(slots, 0.0);
        self.rates.resize(slots);
        self.list.build(&self.now.position, &self.now.position, &self.rows, reach);
        self.sums.resize(self.list.clusters(), SolidSum::default());
        if let Some(walls) = &mut self.walls {
            walls.neighbours.build(&self.now.position, &walls.position, &walls.rows, reach);
            walls.sources.build(&walls.position, &self.now.position, &self.rows, reach);
            walls.sums.resize(walls.sources.clusters(), ExtrapolationSum::default());
            walls.forces.resize(walls.neighbours.clusters(), WallForce::default());
        }
    }

    fn moved_too_far(&self) -> bool {
        let limit = 0.25 * self.skin * self.skin;
        (0..self.id.len()).filter(|&s| self.id[s] != PADDING).any(|s| {
            let r2: f64 = (0..D).map(|d| (self.now.position[d][s] - self.reference[d][s]).powi(2)).sum();
            r2 > limit
        })
    }

    fn stress_at(&self, slot: usize) -> [[f64; D]; D] {
        std::array::from_fn(|a| std::array::from_fn(|b| self.now.stress[a.min(b)][a.max(b)][slot]))
    }

    /// p = K (rho/rho0 - 1) (Kayaki's eq. 5) and what follows from pressure and stress.
    fn apply_state_equation(&mut self) {
        let (k, rho0) = (self.material.bulk_modulus(), self.material.density);
        for slot in 0..self.id.len() {
            let rho = self.now.density[slot];
            let p = k * (rho / rho0 - 1.0);
            self.pressure[slot] = p;
            self.volume[slot] = self.mass / rho;
            let s = self.stress_at(slot);
            let sigma: [[f64; D]; D] =
                std::array::from_fn(|a| std::array::from_fn(|b| if a == b { s[a][b] - p } else { s[a][b] }));
            let inverse = 1.0 / (rho * rho);
            for a in 0..D {
                for b in a..D {
                    self.stress_term[a][b][slot] = sigma[a][b] * inverse;
                }
            }
            if self.artificial_stress.is_some() {
                let r = artificial_stress::tensor(self.material.artificial_stress.strength, sigma, rho);
                for a in 0..D {
                    for b in a..D {
                        self.artificial[a][b][slot] = r[a][b];
                    }
                }
            }
        }
    }

    fn pass<K: Kernel<D>, T: TensileCorrection<D>, M: Moment>(&mut self, kernel: K, correction: T, _: M) {
        // The correction borrows from self; the sums do not.
        let mut sums = std::mem::take(&mut self.sums);
        let law = SolidLaw {
            kernel,
            correction,
            gradient: PhantomData::<M>,
            state: &self.now,
            stress_term: &self.stress_term,
            volume: &self.volume,
            mass: self.mass,
            linear: self.material.artificial_viscosity.linear * self.material.sound_speed(),
            quadratic: self.material.artificial_viscosity.quadratic,
        };
        pair::pass(self.isa, &law, &self.list, &mut sums);
        self.sums = sums;
        self.pair_evaluations += (self.list.entries() * LANES) as u64;
    }

    fn sums<K: Kernel<D>>(&mut self, kernel: K) {
        let artificial = std::mem::replace(&mut self.artificial, tensors(0));
        let correction = self.artificial_stress.map(|exponent| ArtificialStress {
            tensors: &artificial,
            inverse_w0: 1.0 / kernel.at(self.resolution),
            exponent,
        });
        match (correction, self.renormalised) {
            (None, false) => self.pass(kernel, (), Plain),
            (None, true) => self.pass(kernel, (), Renormalised),
            (Some(c), false) => self.pass(kernel, c, Plain),
            (Some(c), true) => self.pass(kernel, c, Renormalised),
        }
        self.artificial = artificial;
        let (linear, quadratic) = (
            self.material.artificial_viscosity.linear * self.material.sound_speed(),
            self.material.artificial_viscosity.quadratic,
        );
        if let Some(mut walls) = self.walls.take() {
            let law = Extrapolation {
                kernel,
                gravity: self.gravity,
                targets: &walls.position,
                sources: &self.now.position,
                density: &self.now.density,
                pressure: &self.pressure,
            };
            pair::pass(self.isa, &law, &walls.sources, &mut walls.sums);
            walls.show(self.material.density, self.material.bulk_modulus());
            let mut forces = std::mem::take(&mut walls.forces);
            let law = Push {
                kernel,
                solid: &self.now,
                pressure: &self.pressure,
                walls: &walls,
                mass: self.mass,
                linear,
                quadratic,
            };
            pair::pass(self.isa, &law, &walls.neighbours, &mut forces);
            walls.forces = forces;
            let listed = walls.sources.entries() + walls.neighbours.entries();
            self.pair_evaluations += (listed * LANES) as u64;
            self.walls = Some(walls);
        }
    }

    /// Rates of the present state under a load.
    fn compute_rates(&mut self, load: &Load<D>) {
        if self.moved_too_far() {
            self.sort();
            self.apply_state_equation();
        }
        with_kernel!(self.kernel, self.smoothing_length, D, |kernel| self.sums(kernel));
        let g = self.material.shear_modulus();
        for slot in 0..self.id.len() {
            let (sum, k) = (&self.sums[slot / LANES], slot % LANES);
            let id = self.id[slot];
            let mut l: [[f64; D]; D] =
                std::array::from_fn(|a| std::array::from_fn(|b| sum.gradient[a][b].0[k]));
            if self.renormalised {
                l = renormalise(l, std::array::from_fn(|a| std::array::from_fn(|b| sum.moment[a][b].0[k])));
            }
            let mut density_rate = -self.now.density[slot] * (0..D).map(|d| l[d][d]).sum::<f64>();
            let mut acceleration: [f64; D] =
                std::array::from_fn(|d| sum.acceleration[d].0[k] + self.gravity[d]);
            if let Some(walls) = &self.walls {
                for d in 0..D {
                    acceleration[d] += walls.forces[slot / LANES].0[d].0[k];
                }
            }
            if id != PADDING {
                let p = id as usize;
                for d in 0..D {
                    acceleration[d] += load.force[p][d] / self.mass;
                }
                if !load.gradient.is_empty() {
                    density_rate += load.density_rate[p];
                    for a in 0..D {
                        for b in 0..D {
                            l[a][b] += load.gradient[p][a][b];
                        }
                    }
                }
                if self.points[p].clamped {
                    acceleration = [0.0; D];
                }
            }
            let stress_rate = jaumann(g, l, self.stress_at(slot));
            for a in 0..D {
                self.rates.acceleration[a][slot] = acceleration[a];
                for b in a..D {
                    self.rates.stress[a][b][slot] = stress_rate[a][b];
                }
            }
            self.rates.density[slot] = density_rate;
        }
    }

    /// now = from + dt rates, for every advanced column; `from` is `at_n`.
    fn integrate(&mut self, dt: f64) {
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
        self.apply_state_equation();
    }

    /// One midpoint sub-step of the present state, whose copy at its start is `at_n`.
    fn midpoint(&mut self, dt: f64, load: &Load<D>) {
        self.compute_rates(load);
        self.integrate(0.5 * dt);
        self.compute_rates(load);
        self.integrate(dt);
    }

    /// `count` midpoint sub-steps over `dt` from the state at n, which is kept. Shows the mean velocity meanwhile.
    fn sub_step(&mut self, count: u32, dt: f64, load: &Load<D>) {
        let each = dt / f64::from(count);
        for (p, start) in self.stage_start.iter_mut().enumerate() {
            *start = std::array::from_fn(|d| self.now.position[d][self.slot_of[p] as usize]);
        }
        for _ in 0..count {
            self.at_n.copy_from(&self.now);
            self.midpoint(each, load);
        }
        for (p, start) in self.stage_start.iter().enumerate() {
            let s = self.slot_of[p] as usize;
            for d in 0..D {
                self.shown_velocity[d][s] = (self.now.position[d][s] - start[d]) / dt;
            }
        }
    }

    fn show_own_velocity(&mut self) {
        for d in 0..D {
            self.shown_velocity[d].clone_from(&self.now.velocity[d]);
        }
    }

    fn check(&self) -> Result<(), OutOfBounds> {
        let rho0 = self.material.density;
        let fastest = self.material.pressure_wave_speed();
        for (p, &slot) in self.slot_of.iter().enumerate() {
            let s = slot as usize;
            let rho = self.now.density[s];
            let v2: f64 = (0..D).map(|d| self.now.velocity[d][s].powi(2)).sum();
            let stress: f64 = self.stress_at(s).as_flattened().iter().map(|s| s.abs()).sum();
            let (quantity, value) = if !(rho > rho0 / 3.0 && rho < rho0 * 3.0) {
                (Quantity::Density, rho)
            } else if v2.is_nan() || v2 > fastest * fastest {
                (Quantity::Speed, v2.sqrt())
            } else if !stress.is_finite() {
                (Quantity::Stress, stress)
            } else {
                continue;
            };
            let position: [f64; D] = std::array::from_fn(|d| self.now.position[d][s]);
            return Err(OutOfBounds { particle: p as u32, quantity, value, position: wide(position) });
        }
        Ok(())
    }
}

#[cfg(test)]
impl<const D: usize> Hypoelastic<D> {
    /// Gives every particle a velocity by its position.
    pub(super) fn set_velocity(&mut self, v: impl Fn([f64; D]) -> [f64; D]) {
        for slot in 0..self.id.len() {
            let at = v(std::array::from_fn(|d| self.now.position[d][slot]));
            for d in 0..D {
                self.now.velocity[d][slot] = at[d];
            }
        }
    }

    /// Rate of the deviatoric stress of every particle.
    pub(super) fn stress_rates(&mut self, load: &Load<D>) -> Vec<[[f64; D]; D]> {
        self.compute_rates(load);
        let rate = |s: usize| {
            std::array::from_fn(|a| std::array::from_fn(|b: usize| self.rates.stress[a.min(b)][a.max(b)][s]))
        };
        self.slot_of.iter().map(|&s| rate(s as usize)).collect()
    }
}

/// Numbers of the particles within `reach` of a surface particle, ascending. A surface particle lacks one of its nearest
/// lattice neighbours (the 3^D - 1 within sqrt(D) dx). Every particle for plates thinner than twice the reach.
fn surface_set<const D: usize>(points: &[SolidPoint<D>], reach: f64, resolution: f64) -> Vec<u32> {
    let mut x: [Vec<f64>; D] = std::array::from_fn(|d| points.iter().map(|p| p.position[d]).collect());
    let mut id: Vec<u32> = (0..points.len() as u32).collect();
    let (low, high) = ([f64::MIN; D], [f64::MAX; D]);
    let mut rows = Rows::<D>::default();
    rows.sort(&x, &id, reach, low, high);
    for column in &mut x {
        rows.permute(column);
    }
    rows.permute_ids(&mut id);
    let within = |i: usize, radius: f64, visit: &mut dyn FnMut(usize)| {
        let at: [f64; D] = std::array::from_fn(|d| x[d][i]);
        rows.candidates(&x[0], at, at, radius, |first, end| {
            for j in first..end {
                let r2: f64 = (0..D).map(|d| (x[d][i] - x[d][j]).powi(2)).sum();
                if r2 <= radius * radius {
                    visit(j);
                }
            }
        });
    };
    let ring = (D as f64).sqrt() * 1.05 * resolution;
    let full = 3_usize.pow(D as u32);
    let mut surface = vec![false; id.len()];
    for i in 0..id.len() {
        let mut count = 0;
        within(i, ring, &mut |_| count += 1);
        surface[i] = count < full;
    }
    let mut set = Vec::new();
    for i in (0..id.len()).filter(|&i| id[i] != PADDING) {
        let mut near = false;
        within(i, reach, &mut |j| near |= surface[j]);
        if near {
            set.push(id[i]);
        }
    }
    set.sort_unstable();
    set
}

impl<const D: usize> SolidModel<D> for Hypoelastic<D> {
    fn particles(&self) -> usize {
        self.points.len()
    }

    fn interface_set(&self) -> &[u32] {
        &self.interface_set
    }

    fn record(&self, particle: u32) -> StateRecord {
        let s = self.slot_of[particle as usize] as usize;
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
            r.velocity[a] = self.shown_velocity[a][s];
            for b in a..D {
                r.deviatoric_stress[wire_component(a, b)] = self.now.stress[a][b][s];
            }
        }
        if D == 2 {
            r.deviatoric_stress[2] = -(self.now.stress[0][0][s] + self.now.stress[1][1][s]);
        }
        r
    }

    fn velocity(&self, particle: u32) -> [f64; D] {
        let s = self.slot_of[particle as usize] as usize;
        std::array::from_fn(|d| self.now.velocity[d][s])
    }

    fn sub_step_limit(&self) -> f64 {
        // Measured on this scheme: stable to 1.1 dx / c_P, unstable from 1.15; the scene's solid_cfl keeps clear of it.
        self.courant * self.resolution / self.material.pressure_wave_speed()
    }

    fn advance(&mut self, stage: u32, dt: f64, sub_steps: u32, load: &Load<D>) -> Result<(), OutOfBounds> {
        if sub_steps == 1 {
            if stage == 0 {
                self.at_n.copy_from(&self.now);
            }
            self.compute_rates(load);
            self.integrate(if stage == 0 { 0.5 * dt } else { dt });
            self.show_own_velocity();
        } else if stage == 0 {
            self.step_start.copy_from(&self.now);
            self.sub_step(sub_steps / 2, 0.5 * dt, load);
        } else {
            self.now.copy_from(&self.step_start);
            self.apply_state_equation();
            self.sub_step(sub_steps, dt, load);
        }
        self.check()
    }

    fn reference(&self, particle: u32) -> [f64; D] {
        self.points[particle as usize].position
    }

    fn mass(&self, _: u32) -> f64 {
        self.mass
    }

    fn strain_energy(&self) -> f64 {
        let (k, g) = (self.material.bulk_modulus(), self.material.shear_modulus());
        self.slot_of
            .iter()
            .map(|&slot| {
                let s = slot as usize;
                let t = self.stress_at(s);
                let mut norm: f64 = t.as_flattened().iter().map(|v| v * v).sum();
                if D == 2 {
                    norm += (t[0][0] + t[1][1]).powi(2);
                }
                self.volume[s] * (self.pressure[s].powi(2) / (2.0 * k) + norm / (4.0 * g))
            })
            .sum()
    }

    fn fill_frame(&self, frame: &mut Frame) {
        for p in 0..self.points.len() as u32 {
            let r = self.record(p);
            let mut stress = r.deviatoric_stress;
            for d in 0..3 {
                stress[d] -= r.pressure;
            }
            frame.push(FramePoint {
                position: r.position,
                velocity: r.velocity,
                density: r.density,
                pressure: r.pressure,
                stress,
                phase: Phase::Solid,
                id: p,
            });
        }
    }

    fn pair_evaluations(&self) -> u64 {
        self.pair_evaluations
    }
}
