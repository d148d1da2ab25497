//! Implicit time integration: steps of any length, however stiff the material.
//!
//! The midpoint rule for the way w = u(n+1) - u(n) of each node,
//!   2 M (w / dt² - v(n) / dt) = f(u(n), w) + load,   v(n+1) = 2 w / dt - v(n),
//! with the stresses P = F S, F that of the middle and S that of Green's strain E(n) + kappa (E(n+1) - E(n)): turning
//! does not strain, these stresses keep angular momentum, and a St. Venant-Kirchhoff material with kappa = 1/2 keeps
//! its energy (J. C. Simo and N. Tarnow, The discrete energy-momentum method, Zeitschrift für angewandte Mathematik
//! und Physik 43, 1992; for small strains that is Newmark's method, beta = 1/4 and gamma = 1/2). kappa = 1/2 + theta
//! is a viscosity of theta dt times the stiffness: a mode of the frequency omega loses the part theta (omega dt)² of
//! its energy in a step where omega dt is small, and the fastest are multiplied by -(1 - 2 theta) / (1 + 2 theta).
//!
//! Newton's method, whose matrix a sparse Cholesky factorisation solves: 2 M / dt² makes it definite. Contacts act as
//! they are in the middle of the step without stresses, and limit it.

use super::equations::Equations;
use super::mesh::Mesh;
use super::model::{FiniteElement, add_to_nodes};
use crate::account;
use crate::columns::{Vectors, vectors};
use crate::total_lagrangian::material::Matrix;
use halfstep_role::timeline;
use halfstep_scene::bounds::Excess;
use halfstep_scene::{EnergyPart, Motion};
use halfstep_sph::quantity::Quantity;
use nalgebra::DVector;

/// How far after the middle of a step strains are taken, in steps.
const THETA: f64 = 0.05;

/// Where in a step strains are taken.
const KAPPA: f64 = 0.5 + THETA;

/// A correction of the way that ends the iteration, over the spacing; what is left is at most [`CONTRACTION`] of it.
const SMALL: f64 = 1e-8;

/// Largest ratio of a correction to the one before with which the same factorisation is kept.
const CONTRACTION: f64 = 0.1;

/// Most corrections of a step.
const MOST_CORRECTIONS: u32 = 12;

/// A step that does not converge is halved so often.
const MOST_HALVINGS: u32 = 8;

/// Difference of a displacement's gradient by which the stiffness is measured.
const DIFFERENCE: f64 = 1e-6;

/// What acts on the nodes during a step, m/s²: all but stresses.
struct Outer<const D: usize> {
    contacts: Vectors<D>,
    walls: Vectors<D>,
    moving_walls: f64,
}

impl<const D: usize> FiniteElement<D> {
    /// `count` implicit steps over `dt` from `time` on, both s.
    pub(super) fn implicit_steps(&mut self, equations: &mut Equations<D>, count: u32, dt: f64, time: f64) {
        let each = dt / f64::from(count);
        for k in 0..count {
            let _phase = timeline::phase("sub-step");
            self.implicit_step(equations, each, time + f64::from(k) * each, 0);
            self.evaluate();
        }
    }

    fn implicit_step(&mut self, equations: &mut Equations<D>, dt: f64, time: f64, halvings: u32) {
        if self.failure.is_some() {
            return;
        }
        let start = self.now.clone();
        let given = self.account.as_ref().map(|account| account.given.clone());
        self.rub(0.5 * dt);
        let outer = self.outer(dt, time);
        let way = self.guess(dt, time + dt);
        match self.way(equations, &outer, way, dt) {
            Some(way) => {
                self.note_implicit_step(&outer, &way, dt, time);
                self.go(&way, dt, time);
                self.rub(0.5 * dt);
            }
            None if halvings < MOST_HALVINGS => {
                self.now = start;
                if let (Some(account), Some(given)) = (&mut self.account, given) {
                    account.given = given;
                }
                self.implicit_step(equations, 0.5 * dt, time, halvings + 1);
                self.evaluate();
                self.implicit_step(equations, 0.5 * dt, time + 0.5 * dt, halvings + 1);
            }
            None => self.fail(dt),
        }
    }

    /// No step is short enough: blames the fastest particle.
    fn fail(&mut self, dt: f64) {
        let speed = |p: usize| self.mesh.mean(p, &self.now.velocity).iter().map(|v| v * v).sum::<f64>();
        let fastest = (0..self.mesh.elements()).max_by(|&a, &b| speed(a).total_cmp(&speed(b)));
        let excess = Excess { quantity: Quantity::TimeStep, value: dt, ratio: f64::INFINITY };
        self.failure = self.failure.or(fastest.map(|p| (p as u32, excess)));
    }

    /// The nodes' way by their velocities; of those that clamps move, by the clamps.
    fn guess(&self, dt: f64, end: f64) -> Vectors<D> {
        let mut way: Vectors<D> =
            std::array::from_fn(|d| self.now.velocity[d].iter().map(|v| dt * v).collect());
        for (node, motion) in &self.driven {
            let moved = motion.at(end).displacement_of(self.mesh.reference[*node]);
            (0..D).for_each(|d| way[d][*node] = moved[d] - self.now.displacement[d][*node]);
        }
        way
    }

    /// Contacts in the middle of the step, where velocities alone bring the nodes.
    fn outer(&mut self, dt: f64, time: f64) -> Outer<D> {
        let none = || vectors(self.mesh.nodes());
        let mut outer = Outer { contacts: none(), walls: none(), moving_walls: 0.0 };
        let Some(mut contact) = self.contact.take() else { return outer };
        let start = self.now.displacement.clone();
        self.now.drift(0.5 * dt);
        for p in 0..self.mesh.elements() {
            (self.gradient[p], self.volume_ratio[p]) = self.strained(p, &self.now.displacement);
        }
        contact.set_time(time + 0.5 * dt);
        self.touch(&mut contact);
        contact.accelerations(|id, a| add_to_nodes(&self.mesh, &mut outer.contacts, id, a));
        contact.wall_accelerations(|id, a| add_to_nodes(&self.mesh, &mut outer.walls, id, a));
        if account::is_open(self.account.as_ref()) {
            outer.moving_walls = self.mass * contact.power_of_walls(|id| self.free_part(id));
        }
        contact.set_time(time + dt);
        self.now.displacement = start;
        self.contact = Some(contact);
        outer
    }

    /// Newton's method for the way; `None`: it does not converge.
    fn way(
        &mut self,
        equations: &mut Equations<D>,
        outer: &Outer<D>,
        mut way: Vectors<D>,
        dt: f64,
    ) -> Option<Vectors<D>> {
        let (mut last, mut keep) = (f64::INFINITY, false);
        for _ in 0..MOST_CORRECTIONS {
            if !keep {
                self.factorise(equations, &way, dt)?;
            }
            let correction = equations.solve(&self.residual(equations, outer, &way, dt))?;
            // The larger of a number and NaN would be the number.
            if !correction.iter().all(|c| c.is_finite()) {
                return None;
            }
            let largest = correction.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
            for (node, first) in equations.free() {
                (0..D).for_each(|d| way[d][node] += correction[first + d]);
            }
            if largest <= SMALL * self.spacing {
                return Some(way);
            }
            keep = largest <= CONTRACTION * last;
            last = largest;
        }
        None
    }

    /// What is missing in the equations of motion, N (2D: N/m).
    fn residual(
        &mut self,
        equations: &Equations<D>,
        outer: &Outer<D>,
        way: &Vectors<D>,
        dt: f64,
    ) -> DVector<f64> {
        let stresses = self.stresses(way, dt);
        let mut missing = DVector::zeros(equations.count());
        for (node, first) in equations.free() {
            let mass = self.mass_of(node);
            for d in 0..D {
                let outside = self.load[d][node] + outer.contacts[d][node];
                let inertia = 2.0 * (way[d][node] / dt - self.now.velocity[d][node]) / dt;
                missing[first + d] = stresses[d][node] + mass * (outside - inertia);
            }
        }
        missing
    }

    /// Forces of the stresses on the nodes, N (2D: N/m).
    fn stresses(&mut self, way: &Vectors<D>, dt: f64) -> Vectors<D> {
        let mut forces = vectors(self.mesh.nodes());
        for p in 0..self.mesh.elements() {
            let nodes = self.mesh.of(p);
            let [before, after] = self.gradients(p, way);
            let stress = self.stress_over(&before, &after, KAPPA, dt);
            let [held, gone] = [&self.now.displacement, way].map(|of| self.element.patterns(nodes, of));
            let on_patterns = std::array::from_fn(|k| {
                let force = |d: usize| self.hourglass * held[k][d] + self.on_pattern(dt) * gone[k][d];
                std::array::from_fn(force)
            });
            for (corner, &node) in nodes.iter().enumerate() {
                let force = self.element.force(corner, &stress, &on_patterns);
                (0..D).for_each(|d| forces[d][node as usize] += force[d]);
            }
        }
        self.evaluations += self.mesh.elements() as u64;
        forces
    }

    /// F of an element before and after the way.
    fn gradients(&self, p: usize, way: &Vectors<D>) -> [Matrix<D>; 2] {
        let nodes = self.mesh.of(p);
        let before = self.gradient_at(p, &self.now.displacement);
        [before, before + self.element.gradient(nodes, way)]
    }

    /// Resistance of a pattern to its way, N/m (2D: N/m²).
    fn on_pattern(&self, dt: f64) -> f64 {
        KAPPA * self.hourglass + self.slowing() / dt
    }

    /// 2 M / dt² and what stresses change with the way.
    fn factorise(&mut self, equations: &mut Equations<D>, way: &Vectors<D>, dt: f64) -> Option<()> {
        let mut values = equations.zeros();
        for p in 0..self.mesh.elements() {
            equations.add_element(&mut values, p, &self.stiffness_of(p, way, dt));
        }
        equations.add_diagonal(&mut values, |node| 2.0 * self.mass_of(node) / (dt * dt));
        self.evaluations += (2 * D * D * self.mesh.elements()) as u64;
        equations.factorise(&values)
    }

    /// How the forces on an element's nodes fall with their way, N/m (2D: N/m²), row by row, made symmetric: a step
    /// that turns has a matrix that is not. The stress is differentiated by differences.
    fn stiffness_of(&self, p: usize, way: &Vectors<D>, dt: f64) -> Vec<f64> {
        let [before, after] = self.gradients(p, way);
        let column = |k: usize, l: usize| -> Matrix<D> {
            let stress = |by: f64| {
                let mut after = after;
                after[(k, l)] += by;
                self.stress_over(&before, &after, KAPPA, dt)
            };
            (stress(DIFFERENCE) - stress(-DIFFERENCE)) / (2.0 * DIFFERENCE)
        };
        let tangent: [[Matrix<D>; D]; D] = std::array::from_fn(|k| std::array::from_fn(|l| column(k, l)));
        let nodes = Mesh::<D>::CORNERS;
        let (side, volume) = (D << D, self.element.volume());
        let mut all = vec![0.0; side * side];
        for (a, row) in all.chunks_exact_mut(D * side).enumerate() {
            for b in 0..nodes {
                let patterns = self.on_pattern(dt) * self.element.pattern_product(a, b);
                for i in 0..D {
                    for k in 0..D {
                        let mut sum = 0.0;
                        for j in 0..D {
                            for l in 0..D {
                                let both = tangent[k][l][(i, j)] + tangent[i][j][(k, l)];
                                sum += 0.5 * both * self.element.slope(a, j) * self.element.slope(b, l);
                            }
                        }
                        row[i * side + b * D + k] = volume * sum + if i == k { patterns } else { 0.0 };
                    }
                }
            }
        }
        all
    }

    /// Goes the way.
    fn go(&mut self, way: &Vectors<D>, dt: f64, time: f64) {
        for d in 0..D {
            let (displacement, velocity) = (&mut self.now.displacement[d], &mut self.now.velocity[d]);
            for (node, (u, v)) in displacement.iter_mut().zip(velocity).enumerate() {
                if !self.clamped[node] {
                    *u += way[d][node];
                    *v = 2.0 * way[d][node] / dt - *v;
                }
            }
        }
        self.drive(time + dt);
    }

    /// Notes what a step that is about to be gone gives: the stresses' work beyond what is stored is the viscosity's.
    fn note_implicit_step(&mut self, outer: &Outer<D>, way: &Vectors<D>, dt: f64, time: f64) {
        if !account::is_open(self.account.as_ref()) {
            return;
        }
        let stresses = self.stresses(way, dt);
        let work =
            |force: &Vectors<D>, node: usize| (0..D).map(|d| force[d][node] * way[d][node]).sum::<f64>();
        let nodes = 0..self.mesh.nodes();
        let by_stresses: f64 = nodes.clone().map(|node| work(&stresses, node)).sum();
        let by_walls: f64 = nodes
            .filter(|node| !self.clamped[*node])
            .map(|node| self.mass_of(node) * work(&outer.walls, node))
            .sum();
        let there: Vectors<D> = std::array::from_fn(|d| {
            self.now.displacement[d].iter().zip(&way[d]).map(|(u, w)| u + w).collect()
        });
        let stored = self.stored(&there) - self.stored(&self.now.displacement);
        let clamp = |(node, motion): &(usize, Motion)| {
            let velocity = motion.at(time + dt).velocity_of(self.mesh.reference[*node]);
            self.by_clamp(*node, velocity, outer, &stresses, way)
        };
        let clamps: f64 = self.driven.iter().map(clamp).sum();
        let moving = dt * outer.moving_walls;
        if let Some(account) = &mut self.account {
            account.given.give(EnergyPart::ArtificialViscosity, by_stresses + stored);
            account.given.give(EnergyPart::WallContact, by_walls - moving);
            account.given.give(EnergyPart::MovingWalls, moving);
            account.given.give(EnergyPart::Clamps, clamps);
        }
    }

    /// What the clamp that moves a node, in the end with this velocity, m/s, gives: what the node gains, and what it
    /// does on the others.
    fn by_clamp(
        &self,
        node: usize,
        velocity: [f64; D],
        outer: &Outer<D>,
        stresses: &Vectors<D>,
        way: &Vectors<D>,
    ) -> f64 {
        let mass = self.mass_of(node);
        (0..D)
            .map(|d| {
                let gained = 0.5 * mass * (velocity[d].powi(2) - self.now.velocity[d][node].powi(2));
                let touched = outer.contacts[d][node] - outer.walls[d][node];
                let others = stresses[d][node] + mass * (self.load[d][node] + touched);
                gained - others * way[d][node]
            })
            .sum()
    }
}

#[cfg(test)]
impl<const D: usize> FiniteElement<D> {
    /// Largest difference of the matrix from differences of the residual, over its largest entry.
    pub(super) fn matrix_error(&mut self, equations: &mut Equations<D>, way: &Vectors<D>, dt: f64) -> f64 {
        let none = || vectors(self.mesh.nodes());
        let outer = Outer { contacts: none(), walls: none(), moving_walls: 0.0 };
        self.factorise(equations, way, dt).expect("definite");
        let matrix = equations.dense();
        let (step, mut worst) = (1e-6 * self.spacing, 0.0_f64);
        for (node, first) in equations.free() {
            for d in 0..D {
                let mut at = |by: f64| {
                    let mut way = way.clone();
                    way[d][node] += by;
                    self.residual(equations, &outer, &way, dt)
                };
                let column = (at(-step) - at(step)) / (2.0 * step);
                worst = worst.max((matrix.column(first + d) - column).amax());
            }
        }
        worst / matrix.amax()
    }
}
