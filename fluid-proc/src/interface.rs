//! The fluid's side of the interface: which particles it publishes, and what the solid does to them.

use crate::columns::Columns;
use crate::ledger::FluidLedger;
use crate::rates::RateSum;
use halfstep_interface::{Interface, Parameters};
use halfstep_role::balance::Balance;
use halfstep_role::role::{CoverageError, Peer};
use halfstep_sph::columns::bounds;
use halfstep_sph::lane::LANES;
use halfstep_sph::neighbours::{PADDING, Rows};
use halfstep_wire::protocol::{ForceRecord, StateRecord};
use halfstep_wire::wide;

/// State of the coupling.
pub struct Coupling<const D: usize> {
    /// One for each solid.
    pub(crate) interfaces: Vec<Interface<D>>,
    /// Slots of the published particles, by ascending particle number.
    pub(crate) slots: Vec<u32>,
    /// Positions of all solids, one after the other, when the set was chosen.
    pub(crate) chosen_at: Vec<[f64; D]>,
    pub(crate) epoch: u64,
    reach: f64,
    skin: f64,
    rows: Rows<D>,
    sorted: [Vec<f64>; D],
    order: Vec<u32>,
    pub(crate) gap: f64,
    /// Of all that solids did to the particles over whole steps.
    pub(crate) impulse: Balance,
    /// The forces of this half-step.
    forces: Balance,
}

impl<const D: usize> Coupling<D> {
    /// With the parameters toward each solid of a scene; `None` where there is none.
    pub fn new(parameters: Vec<Parameters<D>>) -> Option<Self> {
        let h = parameters.first()?.smoothing_length;
        Some(Self {
            interfaces: parameters.into_iter().map(Interface::without_viscous_stress).collect(),
            slots: Vec::new(),
            chosen_at: Vec::new(),
            epoch: 0,
            reach: 2.0 * h,
            skin: 0.6 * h,
            rows: Rows::default(),
            sorted: std::array::from_fn(|_| Vec::new()),
            order: Vec::new(),
            gap: f64::INFINITY,
            impulse: Balance::default(),
            forces: Balance::default(),
        })
    }

    /// Gravity in what solids show, m/s².
    pub(crate) fn set_gravity(&mut self, gravity: [f64; D]) {
        self.interfaces.iter_mut().for_each(|interface| interface.parameters.gravity = gravity);
    }

    /// The present set's number.
    pub fn epoch(&self) -> u64 {
        self.epoch
    }

    /// Smallest distance between the phases over the mean of their spacings.
    pub fn gap(&self) -> f64 {
        self.gap
    }

    /// Largest displacement of a solid particle since the set was chosen, m.
    fn solid_displacement(&self, peers: &[Peer]) -> f64 {
        if peers.iter().map(|peer| peer.records.len()).sum::<usize>() != self.chosen_at.len() {
            return f64::INFINITY;
        }
        let mut largest = 0.0_f64;
        for (r, x0) in records(peers).zip(&self.chosen_at) {
            let r2: f64 = (0..D).map(|d| (r.position[d] - x0[d]).powi(2)).sum();
            largest = largest.max(r2);
        }
        largest.sqrt()
    }

    /// The set must be chosen anew although the fluid was not sorted.
    pub fn is_stale(&self, peers: &[Peer]) -> bool {
        self.solid_displacement(peers) > 0.3 * self.skin
    }

    /// Chooses the particles within reach of the solids as last received, with a margin for what moves meanwhile.
    pub fn choose(&mut self, fluid: &Columns<D>, peers: &[Peer]) {
        self.epoch += 1;
        self.chosen_at.clear();
        self.chosen_at.extend(records(peers).map(|r| std::array::from_fn(|d| r.position[d])));
        self.order.clear();
        self.order.extend(0..self.chosen_at.len() as u32);
        for d in 0..D {
            self.sorted[d].clear();
            self.sorted[d].extend(self.chosen_at.iter().map(|x| x[d]));
        }
        let (low, high) = bounds(&self.sorted);
        self.slots.clear();
        if self.chosen_at.is_empty() {
            return;
        }
        let reach = self.reach + self.skin;
        self.rows.sort(&self.sorted, &self.order, reach, low, high);
        for column in &mut self.sorted {
            self.rows.permute(column);
        }
        for slot in 0..fluid.slots() {
            if fluid.id[slot] == PADDING {
                continue;
            }
            let x: [f64; D] = std::array::from_fn(|d| fluid.now.position[d][slot]);
            if (0..D).any(|d| x[d] < low[d] - reach || x[d] > high[d] + reach) {
                continue;
            }
            let mut near = false;
            self.rows.candidates(&self.sorted[0], x, x, reach, |first, end| {
                near |= (first..end).any(|s| {
                    let r2: f64 = (0..D).map(|d| (x[d] - self.sorted[d][s]).powi(2)).sum();
                    r2 < reach * reach
                });
            });
            if near {
                self.slots.push(slot as u32);
            }
        }
        self.slots.sort_unstable_by_key(|&s| fluid.id[s as usize]);
        // Room for a ribbon that grows, so that later choices do not allocate.
        let used = self.slots.len();
        if self.slots.capacity() < used + used / 8 {
            self.slots.reserve_exact(used / 2 + 256);
        }
    }

    /// The record of the present state.
    pub fn record(&self, fluid: &Columns<D>, out: &mut Vec<StateRecord>) {
        out.clear();
        out.reserve_exact(self.slots.capacity());
        for &slot in &self.slots {
            let s = slot as usize;
            let particle = &fluid.now.sources[s];
            out.push(StateRecord {
                id: fluid.id[s],
                position: wide(particle.position),
                velocity: wide(particle.velocity),
                density: particle.density,
                pressure: particle.pressure,
                mass: fluid.now.mass,
                ..StateRecord::default()
            });
        }
    }

    /// Adds what the solids do to the fluid's rates, in their order, and their powers to a ledger.
    ///
    /// # Errors
    /// The set may lack a particle within reach of a solid.
    pub(crate) fn add_rates(
        &mut self,
        sums: &mut [RateSum<D>],
        own: &[StateRecord],
        peers: &[Peer],
        fluid_displacement: f64,
        mut ledger: Option<&mut FluidLedger<D>>,
    ) -> Result<(), CoverageError> {
        let solid = self.solid_displacement(peers);
        if fluid_displacement + solid > self.skin {
            let peer = self.farthest(peers);
            return Err(CoverageError { fluid: fluid_displacement, solid, allowed: self.skin, peer });
        }
        self.gap = f64::INFINITY;
        self.forces = Balance::default();
        for (interface, peer) in self.interfaces.iter_mut().zip(peers) {
            interface.update(own, &peer.records, self.epoch);
            let (slots, forces) = (&self.slots, &mut self.forces);
            interface.act_on_fluid(|record, acceleration, density_rate| {
                let slot = slots[record] as usize;
                sums[slot / LANES].add(slot % LANES, acceleration, density_rate);
                forces.add(wide(acceleration).map(|a| own[record].mass * a));
                if let Some(ledger) = &mut ledger {
                    ledger.push(&own[record], acceleration, density_rate);
                }
            });
            self.gap = self.gap.min(interface.smallest_distance() / interface.parameters.spacing);
        }
        Ok(())
    }

    /// Notes the powers of what the solids do to the fluid, by mean velocities over the step.
    pub(crate) fn measure_push(&mut self, own: &[StateRecord], peers: &[Peer], ledger: &mut FluidLedger<D>) {
        let mean = |(record, &slot): (&StateRecord, &u32)| StateRecord {
            velocity: wide(ledger.mean_velocity(slot as usize)),
            ..*record
        };
        let own: Vec<StateRecord> = own.iter().zip(&self.slots).map(mean).collect();
        for (interface, peer) in self.interfaces.iter_mut().zip(peers) {
            interface.update(&own, &peer.records, self.epoch);
            interface.act_on_fluid(|record, acceleration, density_rate| {
                ledger.push(&own[record], acceleration, density_rate);
            });
        }
    }

    /// Adds what the coupler answers to the fluid's rates.
    pub(crate) fn add_answers(&mut self, sums: &mut [RateSum<D>], mass: f64, answers: &[ForceRecord]) {
        for (&slot, answer) in self.slots.iter().zip(answers) {
            let acceleration: [f64; D] = std::array::from_fn(|d| answer.cross_viscosity[d]);
            sums[slot as usize / LANES].add(slot as usize % LANES, acceleration, 0.0);
            self.forces.add(wide(acceleration).map(|a| mass * a));
        }
    }

    /// Books the forces of this half-step as those of a whole step of this length, s.
    pub(crate) fn book(&mut self, dt: f64) {
        self.impulse.add_all(&self.forces, dt);
    }

    /// Place of the solid whose particles moved farthest since the set was chosen.
    fn farthest(&self, peers: &[Peer]) -> usize {
        let mut worst = (0, 0.0);
        let mut chosen_at = self.chosen_at.iter();
        for (place, peer) in peers.iter().enumerate() {
            for (r, x0) in peer.records.iter().zip(&mut chosen_at) {
                let r2: f64 = (0..D).map(|d| (r.position[d] - x0[d]).powi(2)).sum();
                if r2 > worst.1 {
                    worst = (place, r2);
                }
            }
        }
        worst.0
    }

    /// Slots of the published particles.
    pub fn slots(&self) -> &[u32] {
        &self.slots
    }

    /// Pairs listed between the phases, four targets each.
    pub fn pairs(&self) -> usize {
        self.interfaces.iter().map(Interface::pairs).sum()
    }
}

/// The records of all solids, one after the other.
fn records(peers: &[Peer]) -> impl Iterator<Item = &StateRecord> {
    peers.iter().flat_map(|peer| &peer.records)
}
