//! What the coupler holds of the solids: their interfaces with the fluid, the forces on both sides, and the work that
//! these do.

mod contacts;
pub(crate) mod expected;
mod kinds;
mod state;
mod touched;
mod walls;

use crate::error::RunError;
use crate::external::{Continuity, ExternalSolid};
pub use contacts::ContactSummary;
use expected::Expected;
use halfstep_interface::contact::{Contact, WallContact};
use halfstep_interface::cross_viscosity::CrossViscosity;
use halfstep_interface::{Interface, Parameters};
use halfstep_link::{FLUID, StateMessage};
use halfstep_output::FirstMessage;
use halfstep_output::run_json::ForceKind;
use halfstep_role::balance::Balance;
use halfstep_scene::{Gravity, Scene, geometry};
use halfstep_sph::lane::Isa;
use halfstep_wire::protocol::{ForceRecord, StateRecord};
use halfstep_wire::wide;
use kinds::ByKind;
pub use kinds::Done;
use touched::Touched;

/// What stands in for a solid of another program.
pub(crate) struct External<'s> {
    pub(crate) solid: &'s mut ExternalSolid,
    pub(crate) forces: &'s [ForceRecord],
    /// Those of contact among them, N (2D: N/m), where a probe asks for them.
    pub(crate) contact: &'s [[f64; 2]],
}

/// Work on a participant since the state before, J (2D: J/m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Work {
    /// Of the fluid on this solid.
    pub(crate) fluid: f64,
    /// Of the other solids on this one, and of the walls that the coupler holds it against.
    pub(crate) contact: f64,
}

/// All solids of a run. Participants are named by their place in the run, and `states` are those of all of them.
pub(crate) struct Solids<const D: usize> {
    /// Place of the first solid: 1 after a fluid, else 0.
    pub(crate) first: usize,
    solids: Vec<CoupledSolid<D>>,
    cross: CrossViscosity<D>,
    fluid_forces: Vec<ForceRecord>,
    gravity: Gravity,
    /// The fluid's forces on all solids at the states' instant.
    by_fluid: Balance,
    /// Of them over whole steps.
    pub(crate) impulse: Balance,
    /// What solids do to each other; `None` where there is one.
    contact: Option<Contact>,
}

struct CoupledSolid<const D: usize> {
    /// `None` where there is no fluid.
    interface: Option<Interface<D>>,
    forces: Vec<ForceRecord>,
    by_kind: ByKind,
    /// Positions at n, m.
    at_n: Vec<[f64; 3]>,
    continuity: Continuity,
    /// Hash of the state that a checkpoint was made of, as the solid published it.
    saved: u64,
    external: Option<ExternalSolid>,
    /// What the scene has for it, until its first message: of an external solid.
    expected: Option<Expected<D>>,
    /// The scene has walls that solids may touch.
    touches_walls: bool,
    /// Contact with them, of an external solid that does not evaluate it itself, and of one that leaves it.
    walls: Option<WallContact>,
    /// Contact forces, where a probe parts them from the fluid's.
    touched: Option<Touched>,
}

/// How far a record has come since n, m.
fn way(records: &[StateRecord], at_n: &[[f64; 3]], record: usize) -> [f64; 2] {
    let now = records[record].position;
    let from = at_n.get(record).copied().unwrap_or(now);
    [now[0] - from[0], now[1] - from[1]]
}

impl<const D: usize> Solids<D> {
    /// Of a scene; `external` has an entry for each.
    pub(crate) fn new(scene: &Scene, external: Vec<Option<ExternalSolid>>, isa: Isa) -> Self {
        let touches_walls = scene.walls_to_touch().next().is_some();
        let layout = external.iter().any(Option::is_some).then(|| geometry::layout::<D>(scene));
        let mut contact = Contact::new(scene);
        for (solid, _) in external.iter().enumerate().filter(|(_, external)| external.is_some()) {
            contact.iter_mut().for_each(|contact| contact.leave_bodies(solid));
        }
        let side = |(solid, external): (usize, Option<ExternalSolid>)| {
            let walls = (external.is_some() || scene.leaves_walls_to_coupler(solid))
                .then(|| WallContact::new(scene, solid))
                .flatten();
            let touches = contact.is_some() || walls.is_some();
            CoupledSolid {
                interface: Parameters::new(scene, solid, isa).map(Interface::new),
                forces: Vec::new(),
                by_kind: ByKind::default(),
                at_n: Vec::new(),
                continuity: Continuity::new(scene, solid, external.is_some()),
                saved: 0,
                touches_walls,
                walls,
                touched: touches.then(|| Touched::of::<D>(scene, solid)).flatten(),
                expected: external
                    .as_ref()
                    .and(layout.as_ref())
                    .map(|layout| Expected::of(scene, layout, solid)),
                external,
            }
        };
        Self {
            first: usize::from(scene.fluid.is_some()),
            solids: external.into_iter().enumerate().map(side).collect(),
            cross: CrossViscosity::default(),
            fluid_forces: Vec::new(),
            gravity: Gravity::of(scene),
            by_fluid: Balance::default(),
            impulse: Balance::default(),
            contact,
        }
    }

    /// Takes the first states of a run that begins.
    pub(crate) fn begin(&mut self, states: &[impl StateMessage]) {
        for (side, state) in self.solids.iter_mut().zip(&states[self.first..]) {
            if let Some(external) = &mut side.external {
                external.begin(state.records());
            }
            if let Some(walls) = &mut side.walls {
                walls.begin(state.records());
            }
        }
        if let Some(contact) = &mut self.contact {
            contact.begin(states[self.first..].iter().map(StateMessage::records));
        }
    }

    /// The first message of each external solid beside what the scene has for it: once.
    pub(crate) fn first_messages(&mut self, states: &[impl StateMessage]) -> Vec<FirstMessage> {
        let sides = self.solids.iter_mut().zip(&states[self.first..]);
        let compared = sides.filter_map(|(side, state)| {
            let (expected, external) = (side.expected.take()?, side.external.as_ref()?);
            Some(expected.compare(external.first(), state.records()))
        });
        compared.collect()
    }

    /// What each kind of force did to each solid, by its index in the scene.
    pub(crate) fn forces_by_kind(&self) -> Vec<(usize, ForceKind, Done)> {
        let solids = self.solids.iter().enumerate();
        solids.flat_map(|(solid, side)| side.by_kind.done().map(move |(k, done)| (solid, k, done))).collect()
    }

    /// Checks that each state, of step n at a stage, goes on from the one before, after a time step of at most `dt`, s.
    /// Returns what is to be warned of.
    ///
    /// # Errors
    /// What does not belong together.
    pub(crate) fn check(
        &mut self,
        states: &[impl StateMessage],
        dt: f64,
        at: (u64, u32),
    ) -> Result<Option<String>, RunError> {
        let mut remark = None;
        for (side, state) in self.solids.iter_mut().zip(&states[self.first..]) {
            side.continuity.check(state.records(), dt, at)?;
            remark = remark.or_else(|| side.continuity.remark());
        }
        Ok(remark)
    }

    /// Another program computes this participant.
    pub(crate) fn is_external(&self, place: usize) -> bool {
        place.checked_sub(self.first).is_some_and(|solid| self.solids[solid].external.is_some())
    }

    /// What stands in for a participant that another program computes, and the forces on it.
    pub(crate) fn external(&mut self, place: usize) -> Option<External<'_>> {
        let side = &mut self.solids[place.checked_sub(self.first)?];
        let contact = side.touched.as_ref().map_or(&[][..], Touched::now);
        Some(External { solid: side.external.as_mut()?, forces: &side.forces, contact })
    }

    /// Parts contact from the fluid's forces in what a participant measured on this state.
    pub(crate) fn part_contact(&self, place: usize, records: &[StateRecord], values: &mut [f64]) {
        let side = place.checked_sub(self.first).map(|solid| &self.solids[solid]);
        if let Some(touched) = side.and_then(|side| side.touched.as_ref()) {
            touched.correct(records, values);
        }
    }

    /// Number of frames of an external solid that are on disk.
    pub(crate) fn frames_safe(&self, place: usize) -> u32 {
        let side = place.checked_sub(self.first).map(|solid| &self.solids[solid]);
        side.and_then(|side| side.external.as_ref()).map_or(u32::MAX, ExternalSolid::frames_safe)
    }

    /// Waits until the frames of external solids are on disk.
    pub(crate) fn finish(&mut self) -> Result<(), RunError> {
        let mut external = self.solids.iter_mut().filter_map(|side| side.external.as_mut());
        Ok(external.try_for_each(ExternalSolid::finish)?)
    }

    /// Work on each participant from the state at n before to this one: the force of n + 1/2 moved a solid all the way.
    pub(crate) fn work(&mut self, states: &[impl StateMessage]) -> Vec<Work> {
        let mut work = vec![Work::default(); states.len()];
        if let Some(contact) = &mut self.contact {
            let way = |solid: usize, record: usize| {
                way(states[solid + self.first].records(), &self.solids[solid].at_n, record)
            };
            for (solid, done) in contact.work(way).into_iter().enumerate() {
                work[solid + self.first].contact = done;
                self.solids[solid].by_kind.work(ForceKind::Contact, done);
            }
        }
        for (place, side) in self.solids.iter_mut().enumerate() {
            let records = states[place + self.first].records();
            if let Some(walls) = &mut side.walls {
                let done = walls.work(|record| way(records, &side.at_n, record));
                work[place + self.first].contact += done;
                side.by_kind.work(ForceKind::Walls, done);
            }
            let ways = || records.iter().zip(&side.at_n).zip(&side.forces);
            let along = |force: [f64; 3], record: &StateRecord, from: &[f64; 3]| {
                (0..3).map(|d| force[d] * (record.position[d] - from[d])).sum::<f64>()
            };
            let done = ways().map(|((record, from), force)| along(force.force(record.mass), record, from));
            let work = &mut work[place + self.first];
            work.fluid = done.sum::<f64>() - work.contact;
            let cross = ways().map(|((record, from), force)| {
                along(force.cross_viscosity.map(|a| a * record.mass), record, from)
            });
            let cross = cross.sum::<f64>();
            side.by_kind.work(ForceKind::CrossViscosity, cross);
            side.by_kind.work(ForceKind::Stress, work.fluid - cross);
            side.at_n.clear();
            side.at_n.extend(records.iter().map(|r| r.position));
        }
        work
    }

    /// Evaluates the forces on both sides at the states' instant, s, in a time step `dt`, s; returns the pairs listed
    /// for it.
    pub(crate) fn evaluate(&mut self, states: &[impl StateMessage], [time, dt]: [f64; 2]) -> u64 {
        let touching = self.contact.is_some() || self.solids.iter().any(|side| side.walls.is_some());
        if self.solids.is_empty() || (self.first == 0 && !touching) {
            return 0;
        }
        let gravity = self.gravity.at(time);
        let interfaces = self.solids.iter_mut().filter_map(|side| side.interface.as_mut());
        interfaces.for_each(|interface| interface.parameters.gravity = gravity);
        let blank = |id| ForceRecord { id, ..ForceRecord::default() };
        let mut pairs = 0;
        self.fluid_forces.clear();
        self.by_fluid = Balance::default();
        if self.first > 0 {
            self.fluid_forces.extend(states[FLUID].records().iter().map(|r| blank(r.id)));
        }
        for (place, side) in self.solids.iter_mut().enumerate() {
            let solid = &states[place + self.first];
            side.by_kind.clear();
            if let Some(touched) = &mut side.touched {
                touched.begin(solid.records().len());
            }
            side.forces.clear();
            side.forces.extend(solid.records().iter().map(|r| blank(r.id)));
            let Some(interface) = &mut side.interface else { continue };
            let fluid = &states[FLUID];
            interface.update(fluid.records(), solid.records(), fluid.header().epoch);
            pairs += interface.pairs() as u64;
            let forces = &mut side.forces;
            interface.act_on_solid(|record, force| forces[record].stress_force = wide(force));
            self.cross.on_solid(interface, |record, a| forces[record].cross_viscosity = wide(a));
            let more = |force: &mut ForceRecord, a: [f64; D]| {
                force.cross_viscosity.iter_mut().zip(a).for_each(|(sum, a)| *sum += a);
            };
            interface.drag_on_solid(|record, a| more(&mut forces[record], a));
            let forces = &mut self.fluid_forces;
            self.cross.on_fluid(interface, |record, a| {
                // The first solid's share is taken as it is: a sum would lose the sign of a zero.
                match place {
                    0 => forces[record].cross_viscosity = wide(a),
                    _ => more(&mut forces[record], a),
                }
            });
            interface.drag_on_fluid(|record, a| more(&mut forces[record], a));
            for (slot, record) in interface.solid.slots() {
                let (force, mass) = (&side.forces[record], interface.solid.own_mass[slot]);
                self.by_fluid.add(force.force(mass));
                side.by_kind.add(ForceKind::Stress, force.stress_force);
                side.by_kind.add(ForceKind::CrossViscosity, force.cross_viscosity.map(|a| a * mass));
            }
        }
        if touching {
            self.touch(states, [time, dt]);
        }
        pairs
    }

    /// Books the forces as last evaluated as those of a whole step of this length, s.
    pub(crate) fn book(&mut self, dt: f64) {
        self.impulse.add_all(&self.by_fluid, dt);
        self.solids.iter_mut().for_each(|side| side.by_kind.book(dt));
    }

    /// The forces on each participant, in the order in which they are answered: the solids before the fluid.
    pub(crate) fn answers(&self) -> impl Iterator<Item = (usize, &[ForceRecord])> {
        let solids = self.solids.iter().enumerate();
        let solids = solids.map(|(solid, side)| (self.first + solid, side.forces.as_slice()));
        solids.chain((self.first > 0).then_some((FLUID, self.fluid_forces.as_slice())))
    }

    /// Sum of all interface forces over the sum of their magnitudes; `None` where there are none.
    pub(crate) fn audit(&mut self, states: &[impl StateMessage]) -> Option<f64> {
        let mut all = Balance::default();
        let records = states.first()?.records();
        for interface in self.solids.iter_mut().filter_map(|side| side.interface.as_mut()) {
            interface.act_on_fluid(|record, a, _| all.add(wide(a).map(|a| a * records[record].mass)));
        }
        for (force, record) in self.fluid_forces.iter().zip(records) {
            all.add(force.cross_viscosity.map(|a| a * record.mass));
        }
        for side in &self.solids {
            let Some(interface) = &side.interface else { continue };
            for (slot, record) in interface.solid.slots() {
                // Walls are no part of the exchange: nobody has the opposite force.
                let walls = side.walls.as_ref().map_or([0.0; 2], |walls| walls.on(record));
                let force = side.forces[record].force(interface.solid.own_mass[slot]);
                all.add([force[0] - walls[0], force[1] - walls[1], force[2]]);
            }
        }
        all.mismatch()
    }
}
