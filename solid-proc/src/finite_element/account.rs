//! What the effects of the finite-element solid give it over a step (see [`crate::account`]).

use super::model::{FiniteElement, add_to_nodes};
use crate::account::{self, Driven, Sinks, SubStep};
use crate::columns::vector;

impl<const D: usize> FiniteElement<D> {
    fn keeps_account(&self) -> bool {
        account::is_open(self.account.as_ref())
    }

    /// Mass of a node, kg (2D: kg/m).
    pub(super) fn mass_of(&self, node: usize) -> f64 {
        self.mass * self.mesh.share(node)
    }

    /// Kinetic energy of the nodes, J (2D: J/m).
    pub(super) fn nodal_kinetic_energy(&self) -> f64 {
        let square = |node: usize| (0..D).map(|d| self.now.velocity[d][node].powi(2)).sum::<f64>();
        (0..self.mesh.nodes()).map(|node| 0.5 * self.mass_of(node) * square(node)).sum()
    }

    /// Kinetic energy of a cell: of its share in the masses of its nodes, J (2D: J/m).
    pub(super) fn kinetic_energy_in(&self, p: usize) -> f64 {
        let square = |node: u32| (0..D).map(|d| self.now.velocity[d][node as usize].powi(2)).sum::<f64>();
        let nodes = self.mesh.of(p);
        0.5 * self.mass / nodes.len() as f64 * nodes.iter().map(|&node| square(node)).sum::<f64>()
    }

    /// Part of a cell's nodes that no clamp holds.
    pub(super) fn free_part(&self, p: u32) -> f64 {
        let nodes = self.mesh.of(p as usize);
        nodes.iter().filter(|&&node| !self.clamped[node as usize]).count() as f64 / nodes.len() as f64
    }

    /// The same where account is kept.
    pub(super) fn accounted_kinetic_energy(&self) -> Option<f64> {
        self.keeps_account().then(|| self.nodal_kinetic_energy())
    }

    /// Where clamps move nodes from; nothing where no account is open.
    pub(super) fn driven_from(&self) -> Vec<Driven<D>> {
        let load = |node: usize| vector(&self.load, node as u32);
        let from = |(node, _): &(usize, _)| Driven::of(&self.now, *node, load(*node));
        if self.keeps_account() { self.driven.iter().map(from).collect() } else { Vec::new() }
    }

    /// The velocities are those of the drift, and the present state has been evaluated.
    pub(super) fn sinks(&self) -> Sinks<D> {
        let mut sinks = Sinks::none(self.mesh.nodes());
        for (p, f) in self.gradient.iter().enumerate().filter(|_| self.viscosity > 0.0) {
            let (stress, on_patterns) = self.viscous(p, f, &self.now.velocity);
            for (corner, &node) in self.mesh.of(p).iter().enumerate() {
                let node = node as usize;
                let force = self.element.force(corner, &stress, &on_patterns);
                for d in 0..D {
                    sinks.viscous[d][node] += force[d] / self.mass_of(node);
                }
            }
        }
        if let Some(contact) = &self.contact {
            contact.wall_accelerations(|id, a| add_to_nodes(&self.mesh, &mut sinks.walls, id, a));
            sinks.moving_walls = self.mass * contact.power_of_walls(|id| self.free_part(id));
        }
        let inner = |(node, _): &(usize, _)| {
            let (all, walls) = (vector(&self.inner, *node as u32), vector(&sinks.walls, *node as u32));
            std::array::from_fn(|d| all[d] - walls[d])
        };
        sinks.driven = self.driven.iter().map(inner).collect();
        for column in &mut sinks.walls {
            column.iter_mut().zip(&self.clamped).filter(|(_, held)| **held).for_each(|(a, _)| *a = 0.0);
        }
        sinks
    }

    /// Notes what was given over the sub-step of this length, s, that led to the present state; `before` is what
    /// clamps moved from.
    pub(super) fn note_sub_step(&mut self, dt: f64, before: &[Driven<D>]) {
        if !self.keeps_account() {
            return;
        }
        let sinks = self.sinks();
        // The loads hold gravity.
        let (now, gravity) = (&self.now, [0.0; D]);
        let step = SubStep { dt, mass: self.mass, now, driven: before, gravity };
        if let Some(account) = &mut self.account {
            account.note(&step, sinks, |node| self.mesh.share(node));
        }
    }
}
