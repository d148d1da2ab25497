//! The rigid bodies of a solid behind [`SolidModel`].

use super::Vec3;
use super::body::Pose;
use super::build;
use super::contact::Remembered;
use super::step::{System, Wrench};
use crate::columns::ParticleColumns;
use crate::model::{Load, OutOfBounds, Particles, RigidState, SolidModel};
use crate::shown_velocity::ShownVelocity;
use crate::surface::surface_set;
use halfstep_role::timeline;
use halfstep_scene::geometry::{self, SolidPoint};
use halfstep_scene::{EnergyPart, Scene};
use halfstep_sph::lane::Isa;
use halfstep_sph::quantity::Quantity;
use halfstep_wire::frame::flags_of;
use halfstep_wire::half_step::{HalfStep, Stage};
use halfstep_wire::protocol::StateRecord;
use halfstep_wire::wide;
use nalgebra::Matrix3;

/// Distance of a joint's ends over the spacing from which on it is open.
const OPEN: f64 = 0.1;

/// Rigid bodies.
pub struct Rigid<const D: usize> {
    pub(super) system: System,
    points: Vec<SolidPoint<D>>,
    /// Body of each particle.
    body_of: Vec<u32>,
    pub(super) shown: ParticleColumns<D>,
    pub(super) shown_velocity: ShownVelocity<D>,
    interface_set: Vec<u32>,
    pub(super) states: Vec<RigidState<D>>,
    /// State at n.
    at_n: Vec<Pose>,
    /// Contacts at n.
    contacts_at_n: Vec<Remembered>,
    spacing: f64,
    density: f64,
    mass: f64,
    /// Largest speed, m/s: the fluid's sound; infinite where there is none.
    fastest: f64,
    /// What the joints take from the velocities that the scene gives.
    jerked: Vec<(String, [f64; 2])>,
}

impl<const D: usize> Rigid<D> {
    /// The scene's solid of that index.
    pub fn new(scene: &Scene, solid: usize, _: Isa) -> Option<Self> {
        let material = scene.solids.get(solid)?;
        let keys = material.rigid()?;
        let layout = geometry::layout::<D>(scene).with_solid(scene, solid);
        let dx = scene.solid_spacing(solid);
        let (system, names) = build::system(scene, solid, keys, &layout);
        let points = layout.solid;
        let mut body_of = vec![0; points.len()];
        for (k, body) in system.bodies.iter().enumerate() {
            body.particles.iter().for_each(|&p| body_of[p as usize] = k as u32);
        }
        let mass = material.density * dx.powi(D as i32);
        let mut shown = ParticleColumns::new(&points, mass);
        shown.density.fill(material.density);
        let states = names.into_iter().map(RigidState::named).collect();
        let reach = 2.0 * scene.smoothing_ratio * scene.resolution;
        let mut model = Self {
            interface_set: surface_set(&points, &body_of, reach, dx),
            at_n: system.poses.clone(),
            contacts_at_n: Vec::new(),
            shown_velocity: ShownVelocity::new(points.iter().map(|p| p.velocity)),
            jerked: system.jerked_joints(),
            system,
            points,
            body_of,
            shown,
            states,
            spacing: dx,
            density: material.density,
            mass,
            fastest: scene.fluid.as_ref().map_or(f64::INFINITY, |fluid| fluid.sound_speed),
        };
        model.show();
        let velocities = model.shown.velocity.clone();
        model.shown_velocity = ShownVelocity::new(velocities.into_iter());
        Some(model)
    }

    /// Loads of the particles as forces and moments on their bodies.
    fn take_load(&mut self, load: &Load<D>) -> Result<(), OutOfBounds> {
        let unknown = |p: &usize| !load.force[*p].iter().all(|f| f.is_finite());
        if let Some(particle) = (0..self.points.len()).find(unknown) {
            let value = load.force[particle].iter().sum();
            return Err(self.out_of_bounds(particle, value));
        }
        for (body, wrench) in self.system.bodies.iter().zip(&mut self.system.wrenches) {
            let mut sum = Wrench { force: Vec3::zeros(), arms: Matrix3::zeros() };
            for &p in &body.particles {
                let force = Vec3::from(wide(load.force[p as usize]));
                let arm = Vec3::from(wide(self.points[p as usize].position)) - body.center;
                sum.force += force;
                sum.arms += arm * force.transpose();
            }
            *wrench = sum;
        }
        Ok(())
    }

    fn out_of_bounds(&self, particle: usize, value: f64) -> OutOfBounds {
        let position = wide(self.shown.position[particle]);
        OutOfBounds { particle: particle as u32, quantity: Quantity::Speed, value, position }
    }

    fn sub_steps(&mut self, count: u32, dt: f64, time: f64) {
        let each = dt / f64::from(count);
        for k in 0..count {
            let _phase = timeline::phase("sub-step");
            self.system.sub_step::<D>(each, time + f64::from(k) * each);
        }
    }

    /// Copies the bodies' present state to the columns by particle number and by body.
    pub(super) fn show(&mut self) {
        for (k, (body, pose)) in
            self.system.bodies.iter().zip(&self.system.poses).take(self.system.real).enumerate()
        {
            // What the rotation changes: nothing at first, to the last bit.
            let turned = pose.rotation() - Matrix3::identity();
            let moved = pose.center - body.center;
            let rate = body.angular_velocity(pose);
            for &p in &body.particles {
                let reference = Vec3::from(wide(self.points[p as usize].position));
                let arm = reference - body.center;
                let swung = turned * arm;
                let (place, velocity) =
                    (reference + (moved + swung), pose.velocity + rate.cross(&(arm + swung)));
                self.shown.position[p as usize] = std::array::from_fn(|d| place[d]);
                self.shown.velocity[p as usize] = std::array::from_fn(|d| velocity[d]);
            }
            let state = &mut self.states[k];
            state.mass = body.mass;
            state.center = std::array::from_fn(|d| pose.center[d]);
            state.velocity = std::array::from_fn(|d| pose.velocity[d]);
            state.angle = if D == 2 { [0.0, 0.0, pose.angle] } else { pose.turned().into() };
            state.angular_velocity = rate.into();
            state.kinetic_energy = body.kinetic_energy(pose);
        }
    }

    fn check(&self) -> Result<(), OutOfBounds> {
        let speed = |v: &[f64; D]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let speeds = self.shown.velocity.iter().map(speed).enumerate();
        // NaN is out of bounds.
        let excess = speeds.filter(|(_, speed)| !(*speed <= self.fastest && speed.is_finite()));
        match excess.max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((particle, value)) => Err(self.out_of_bounds(particle, value)),
            None => Ok(()),
        }
    }

    fn record(&self, particle: u32) -> StateRecord {
        let body = self.body_of[particle as usize];
        let driven = !self.system.bodies[body as usize].gives_way();
        StateRecord {
            id: particle,
            flags: flags_of(driven, Some(body)),
            position: wide(self.shown.position[particle as usize]),
            velocity: wide(self.shown_velocity.of(particle)),
            density: self.density,
            mass: self.mass,
            ..StateRecord::default()
        }
    }

    /// Number of particles.
    pub(super) fn count(&self) -> usize {
        self.points.len()
    }
}

impl<const D: usize> SolidModel<D> for Rigid<D> {
    fn particles(&self) -> Particles<'_, D> {
        self.shown.view()
    }

    fn interface_set(&self) -> &[u32] {
        &self.interface_set
    }

    fn set_gravity(&mut self, gravity: [f64; D]) {
        self.system.gravity = wide(gravity).into();
    }

    fn records(&self, particles: &[u32], out: &mut Vec<StateRecord>) {
        out.extend(particles.iter().map(|&p| self.record(p)));
    }

    fn sub_step_limit(&self) -> f64 {
        self.system.sub_step_limit(self.spacing)
    }

    fn advance(&mut self, half_step: &HalfStep, sub_steps: u32, load: &Load<D>) -> Result<(), OutOfBounds> {
        self.take_load(load)?;
        let span = half_step.span();
        match half_step.stage {
            Stage::First => {
                self.at_n.clone_from(&self.system.poses);
                self.contacts_at_n.clone_from(&self.system.memory);
                let place = &self.shown.position;
                self.shown_velocity.leave(|p| place[p]);
                self.sub_steps((sub_steps / 2).max(1), span, half_step.time);
            }
            Stage::Second => {
                self.system.poses.clone_from(&self.at_n);
                self.system.memory.clone_from(&self.contacts_at_n);
                self.system.contact.fill([Vec3::zeros(); 2]);
                self.system.books.open = true;
                self.sub_steps(sub_steps, span, half_step.time);
                self.system.books.open = false;
                for (k, state) in self.states.iter_mut().enumerate() {
                    let [force, moment] = self.system.contact_load(k, span);
                    state.contact_force = std::array::from_fn(|d| force[d]);
                    state.contact_moment = moment.into();
                }
            }
        }
        self.show();
        let shown = &self.shown;
        self.shown_velocity.arrive(half_step, sub_steps, |p| shown.position[p], |p| shown.velocity[p]);
        self.check()
    }

    fn rigid_bodies(&self) -> &[RigidState<D>] {
        &self.states
    }

    fn body_of(&self) -> &[u32] {
        &self.body_of
    }

    fn keep_account(&mut self) {
        self.system.accounted = true;
    }

    fn account(&mut self, give: &mut dyn FnMut(EnergyPart, f64)) {
        self.system.books.hand_over(give);
    }

    fn strain_energy(&self) -> f64 {
        self.system.spring_energy()
    }

    fn open_joints(&self) -> Vec<(String, f64)> {
        self.system.open_joints(OPEN * self.spacing)
    }

    fn jerked_joints(&self) -> Vec<(String, [f64; 2])> {
        self.jerked.clone()
    }

    fn state(&mut self) -> Option<&mut dyn halfstep_wire::state::State> {
        Some(self)
    }

    fn pair_evaluations(&self) -> u64 {
        0
    }
}
