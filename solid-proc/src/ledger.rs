//! The solid's energy ledger: what its model's effects give it, and what the fluid does to it.

use crate::model::SolidModel;
use halfstep_role::ledger::Ledger;
use halfstep_scene::{EnergyPart, Phase, Scene};
use halfstep_wire::protocol::ForceRecord;
use halfstep_wire::wide;

/// What a model's effects gave over the present step.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    /// What is noted belongs to a step that is kept.
    pub(crate) open: bool,
    /// By [`EnergyPart`], J (2D: J/m).
    joules: Vec<f64>,
}

impl Default for Given {
    fn default() -> Self {
        Self { open: false, joules: vec![0.0; EnergyPart::ALL.len()] }
    }
}

impl Given {
    pub(crate) fn give(&mut self, part: EnergyPart, joules: f64) {
        self.joules[part as usize] += joules;
    }

    /// Hands over what was given and begins anew.
    pub(crate) fn hand_over(&mut self, give: &mut dyn FnMut(EnergyPart, f64)) {
        for (&part, joules) in EnergyPart::ALL.iter().zip(&mut self.joules) {
            give(part, std::mem::take(joules));
        }
    }
}

/// Ledger of a solid.
pub(crate) struct SolidLedger<const D: usize> {
    pub(crate) ledger: Ledger,
    gravity: [f64; 3],
    /// Positions at n, m, by particle number.
    at_n: Vec<[f64; D]>,
}

impl<const D: usize> SolidLedger<D> {
    /// Of a model at its first state.
    pub(crate) fn new(scene: &Scene, model: &dyn SolidModel<D>) -> Self {
        let mut own = Self { ledger: Ledger::new(Phase::Solid), gravity: scene.gravity, at_n: Vec::new() };
        own.hold(model);
        own
    }

    fn hold(&mut self, model: &dyn SolidModel<D>) {
        let state = model.particles();
        let height = |x: &[f64; D]| -(0..D).map(|d| self.gravity[d] * x[d]).sum::<f64>();
        let potential = match model.rigid_bodies() {
            [] => state.mass.iter().zip(state.position).map(|(m, x)| m * height(x)).sum(),
            bodies => bodies.iter().map(|body| body.mass * height(&body.center)).sum(),
        };
        self.ledger.hold([model.kinetic_energy(), model.strain_energy(), potential]);
    }

    /// Notes where particles are at n.
    pub(crate) fn leave(&mut self, model: &dyn SolidModel<D>) {
        self.at_n.clear();
        self.at_n.extend_from_slice(model.particles().position);
    }

    /// After a whole step under these forces of n + 1/2.
    pub(crate) fn arrive(&mut self, model: &mut dyn SolidModel<D>, forces: &[ForceRecord]) {
        let state = model.particles();
        let (mut pressure, mut viscosity) = (0.0, 0.0);
        for force in forces {
            let p = force.id as usize;
            let way = wide(std::array::from_fn::<f64, D, _>(|d| state.position[p][d] - self.at_n[p][d]));
            for d in 0..3 {
                pressure += force.stress_force[d] * way[d];
                viscosity += state.mass[p] * force.cross_viscosity[d] * way[d];
            }
        }
        self.ledger.give(EnergyPart::InterfacePressure, pressure);
        self.ledger.give(EnergyPart::CrossViscosity, viscosity);
        model.account(&mut |part, joules| self.ledger.give(part, joules));
        self.hold(model);
    }
}
