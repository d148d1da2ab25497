//! What effects give a solid that goes on by velocity Verlet over a step: the sum over its sub-steps of dt v . (a + a')
//! / 2, where v is the velocity of the drift, and a and a' are the accelerations of the kicks before and after it.

use crate::columns::{Vectors, vector, vectors};
use crate::ledger::Given;
use crate::verlet::Kinematics;
use halfstep_scene::EnergyPart;
use halfstep_wire::state::{Fields, State, StateError};

/// Accelerations by what takes energy, at one evaluation.
#[derive(Clone, Debug)]
pub(crate) struct Sinks<const D: usize> {
    /// By the viscosity, m/s².
    pub(crate) viscous: Vectors<D>,
    /// By walls, m/s².
    pub(crate) walls: Vectors<D>,
    /// Power of walls that move, W (2D: W/m).
    pub(crate) moving_walls: f64,
    /// By all that acts inside, on what clamps move, m/s².
    pub(crate) driven: Vec<[f64; D]>,
}

impl<const D: usize> Sinks<D> {
    /// None on so many slots.
    pub(crate) fn none(slots: usize) -> Self {
        Self { viscous: vectors(slots), walls: vectors(slots), moving_walls: 0.0, driven: Vec::new() }
    }
}

/// What was given over the present step, and what that takes to know.
#[derive(Clone, Debug)]
pub(crate) struct Account<const D: usize> {
    pub(crate) given: Given,
    last: Sinks<D>,
}

/// A sub-step that was taken.
pub(crate) struct SubStep<'a, const D: usize> {
    /// Its length, s.
    pub(crate) dt: f64,
    /// Mass of a particle, kg (2D: kg/m).
    pub(crate) mass: f64,
    /// At its end, with the velocities of the drift.
    pub(crate) now: &'a Kinematics<D>,
    /// What clamps move, before it.
    pub(crate) driven: &'a [Driven<D>],
    /// What acts on that beside its loads, m/s².
    pub(crate) gravity: [f64; D],
}

/// What a clamp moves, before a sub-step.
pub(crate) struct Driven<const D: usize> {
    slot: usize,
    displacement: [f64; D],
    velocity: [f64; D],
    /// m/s².
    load: [f64; D],
}

impl<const D: usize> Driven<D> {
    /// The present state of a slot under a load, m/s².
    pub(crate) fn of(now: &Kinematics<D>, slot: usize, load: [f64; D]) -> Self {
        let (displacement, velocity) =
            (vector(&now.displacement, slot as u32), vector(&now.velocity, slot as u32));
        Self { slot, displacement, velocity, load }
    }
}

impl<const D: usize> Account<D> {
    /// From a state on in which these act.
    pub(crate) fn new(sinks: Sinks<D>) -> Self {
        Self { given: Given::default(), last: sinks }
    }

    /// Notes what was given over a sub-step at whose end these act; `share` is the mass of a slot over that of a
    /// particle.
    pub(crate) fn note(&mut self, step: &SubStep<'_, D>, sinks: Sinks<D>, share: impl Fn(usize) -> f64) {
        let SubStep { dt, mass, now, .. } = *step;
        let work = |a: &Vectors<D>, b: &Vectors<D>| -> f64 {
            let of = |slot: usize| -> f64 {
                let power = |d: usize| now.velocity[d][slot] * 0.5 * (a[d][slot] + b[d][slot]);
                share(slot) * (0..D).map(power).sum::<f64>()
            };
            dt * mass * (0..now.velocity[0].len()).map(of).sum::<f64>()
        };
        let viscous = work(&self.last.viscous, &sinks.viscous);
        let contact = work(&self.last.walls, &sinks.walls);
        let moving = 0.5 * dt * (self.last.moving_walls + sinks.moving_walls);
        self.given.give(EnergyPart::ArtificialViscosity, viscous);
        self.given.give(EnergyPart::WallContact, contact - moving);
        self.given.give(EnergyPart::MovingWalls, moving);
        let mut clamps = 0.0;
        for (before, (a, b)) in step.driven.iter().zip(self.last.driven.iter().zip(&sinks.driven)) {
            for d in 0..D {
                let way = now.displacement[d][before.slot] - before.displacement[d];
                let kinetic = 0.5 * (now.velocity[d][before.slot].powi(2) - before.velocity[d].powi(2));
                let others = 0.5 * (a[d] + b[d]) + step.gravity[d] + before.load[d];
                clamps += share(before.slot) * (kinetic - others * way);
            }
        }
        self.given.give(EnergyPart::Clamps, mass * clamps);
        self.last = sinks;
    }
}

/// What the present sub-step gives is noted.
pub(crate) fn is_open<const D: usize>(account: Option<&Account<D>>) -> bool {
    account.is_some_and(|account| account.given.open)
}

impl<const D: usize> State for Account<D> {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let (slots, driven) = (self.last.walls[0].len(), self.last.driven.len());
        fields.vectors("viscous", &mut self.last.viscous)?;
        fields.vectors("walls", &mut self.last.walls)?;
        fields.real("moving_walls", &mut self.last.moving_walls)?;
        fields.points("driven", &mut self.last.driven)?;
        let columns = self.last.viscous.iter().chain(&self.last.walls);
        columns.map(Vec::len).try_for_each(|n| fields.length("viscous", slots, n))?;
        fields.length("driven", driven, self.last.driven.len())
    }
}
