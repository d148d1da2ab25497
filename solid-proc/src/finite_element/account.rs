//! What effects give the solid over a step: the sum over its sub-steps of dt v . (a + a') / 2, where v is the velocity
//! of the drift, and a and a' are the accelerations of the kicks before and after it.

use super::model::{FiniteElement, add_to_nodes};
use crate::columns::{Vectors, vector, vectors};
use crate::ledger::Given;
use halfstep_scene::EnergyPart;
use halfstep_wire::state::{Fields, State, StateError};

/// Accelerations of nodes by what takes energy, at one evaluation.
#[derive(Clone, Debug)]
struct Sinks<const D: usize> {
    /// By the viscosity, m/s².
    viscous: Vectors<D>,
    /// By walls, m/s².
    walls: Vectors<D>,
    /// Power of walls that move, W (2D: W/m).
    moving_walls: f64,
    /// By all that acts inside, on the nodes that clamps move, m/s².
    driven: Vec<[f64; D]>,
}

/// What was given over the present step, and what that takes to know.
#[derive(Clone, Debug)]
pub(super) struct Account<const D: usize> {
    pub(super) given: Given,
    last: Sinks<D>,
}

/// A node that a clamp moves, before a sub-step.
pub(super) struct Driven<const D: usize> {
    displacement: [f64; D],
    velocity: [f64; D],
}

impl<const D: usize> State for Account<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let (nodes, driven) = (self.last.walls[0].len(), self.last.driven.len());
        fields.vectors("viscous", &mut self.last.viscous)?;
        fields.vectors("walls", &mut self.last.walls)?;
        fields.real("moving_walls", &mut self.last.moving_walls)?;
        fields.points("driven", &mut self.last.driven)?;
        let columns = self.last.viscous.iter().chain(&self.last.walls);
        columns.map(Vec::len).try_for_each(|n| fields.length("viscous", nodes, n))?;
        fields.length("driven", driven, self.last.driven.len())
    }
}

impl<const D: usize> FiniteElement<D> {
    fn keeps_account(&self) -> bool {
        self.account.as_ref().is_some_and(|account| account.given.open)
    }

    /// What follows belongs to a step that is kept, or no longer does.
    pub(super) fn set_account_open(&mut self, open: bool) {
        if let Some(account) = &mut self.account {
            account.given.open = open;
        }
    }

    /// Begins to keep account, from the present state on.
    pub(super) fn open_account(&mut self) {
        self.account = Some(Account { given: Given::default(), last: self.sinks() });
    }

    /// Mass of a node, kg (2D: kg/m).
    fn mass_of(&self, node: usize) -> f64 {
        self.mass * self.mesh.share(node)
    }

    /// Kinetic energy of the nodes, J (2D: J/m).
    pub(super) fn nodal_kinetic_energy(&self) -> f64 {
        let square = |node: usize| (0..D).map(|d| self.now.velocity[d][node].powi(2)).sum::<f64>();
        (0..self.mesh.nodes()).map(|node| 0.5 * self.mass_of(node) * square(node)).sum()
    }

    /// The same where account is kept.
    pub(super) fn accounted_kinetic_energy(&self) -> Option<f64> {
        self.keeps_account().then(|| self.nodal_kinetic_energy())
    }

    /// Where clamps move nodes from; nothing where no account is open.
    pub(super) fn driven_from(&self) -> Vec<Driven<D>> {
        let from = |(node, _): &(usize, _)| Driven {
            displacement: vector(&self.now.displacement, *node as u32),
            velocity: vector(&self.now.velocity, *node as u32),
        };
        if self.keeps_account() { self.driven.iter().map(from).collect() } else { Vec::new() }
    }

    /// The velocities are those of the drift, and the present state has been evaluated.
    fn sinks(&self) -> Sinks<D> {
        let nodes = self.mesh.nodes();
        let (mut viscous, mut walls) = (vectors(nodes), vectors(nodes));
        for (p, f) in self.gradient.iter().enumerate().filter(|_| self.viscosity > 0.0) {
            let (stress, on_patterns) = self.viscous(p, f);
            for (corner, &node) in self.mesh.of(p).iter().enumerate() {
                let node = node as usize;
                let force = self.element.force(corner, &stress, &on_patterns);
                for d in 0..D {
                    viscous[d][node] += force[d] / self.mass_of(node);
                }
            }
        }
        let mut moving_walls = 0.0;
        if let Some(contact) = &self.contact {
            contact.wall_accelerations(|id, a| add_to_nodes(&self.mesh, &mut walls, id, a));
            moving_walls = self.mass * contact.power_of_walls(self.isa, self.kernel, &self.material);
        }
        let of_walls = |node| vector(&walls, node);
        let inner = |(node, _): &(usize, _)| {
            let (all, walls) = (vector(&self.inner, *node as u32), of_walls(*node as u32));
            std::array::from_fn(|d| all[d] - walls[d])
        };
        let driven = self.driven.iter().map(inner).collect();
        for d in 0..D {
            walls[d].iter_mut().zip(&self.clamped).filter(|(_, held)| **held).for_each(|(a, _)| *a = 0.0);
        }
        Sinks { viscous, walls, moving_walls, driven }
    }

    /// Notes what was given over the sub-step of this length, s, that led to the present state; `before` is what
    /// clamps moved from.
    pub(super) fn note_sub_step(&mut self, dt: f64, before: &[Driven<D>]) {
        if !self.keeps_account() {
            return;
        }
        let sinks = self.sinks();
        let Some(mut account) = self.account.take() else { return };
        let velocity = &self.now.velocity;
        let work = |a: &Vectors<D>, b: &Vectors<D>| -> f64 {
            let of = |node: usize| -> f64 {
                let power = |d: usize| velocity[d][node] * 0.5 * (a[d][node] + b[d][node]);
                self.mass_of(node) * (0..D).map(power).sum::<f64>()
            };
            dt * (0..self.mesh.nodes()).map(of).sum::<f64>()
        };
        let contact = work(&account.last.walls, &sinks.walls);
        let moving = 0.5 * dt * (account.last.moving_walls + sinks.moving_walls);
        account.given.give(EnergyPart::ArtificialViscosity, work(&account.last.viscous, &sinks.viscous));
        account.given.give(EnergyPart::WallContact, contact - moving);
        account.given.give(EnergyPart::MovingWalls, moving);
        let mut clamps = 0.0;
        let accelerations = account.last.driven.iter().zip(&sinks.driven);
        for (((node, _), before), (a, b)) in self.driven.iter().zip(before).zip(accelerations) {
            for d in 0..D {
                let way = self.now.displacement[d][*node] - before.displacement[d];
                let kinetic = 0.5 * (velocity[d][*node].powi(2) - before.velocity[d].powi(2));
                let others = 0.5 * (a[d] + b[d]) + self.load[d][*node];
                clamps += self.mass_of(*node) * (kinetic - others * way);
            }
        }
        account.given.give(EnergyPart::Clamps, clamps);
        account.last = sinks;
        self.account = Some(account);
    }
}
