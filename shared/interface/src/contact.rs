//! Contact between two solids, and between the bodies of one, evaluated from the records that they published.
//!
//! The surfaces are the outlines of the shapes as the scene has them (`outline`). Their points are sums of particles'
//! positions with constant weights that keep any linear field: they go with the particles, turn and strain with them,
//! and give their forces back to them with the same weights, so that force, moment and power are kept.
//!
//! A point of one solid that is g > 0 inside of another, with a share w of the outline, half of which is this pass's
//! (the other half is the pass of the other solid's points), n the normal out of the other solid and v the approach:
//! ```text
//! F_n = K w/2 g (1 + e² + (1 - e²) tanh(v / v_s)) / 2     K g approaching, e² K g leaving: the speed after an impact
//!                                                         is e times that before it, whatever the masses
//! F_t = -(k x + k tau u), at most mu F_n                  k = K w/2; x: way along the surface from where it sticks,
//!                                                         u: its rate; beyond mu F_n it slips
//! v_s = max(omega² dt g (1 - e²) / 2, v_max / 100, v_g)
//!         v_max: largest approach of this contact, v_g: what gravity gives in four steps
//! ```
//! omega² = K (1/m_a + 1/m_b) with the least mass behind a length of both outlines; steps of theta / omega resolve an
//! impact ([`Contact::limit`]). Force and opposite force differ by rounding.
//!
//! What walls do to a solid of another program is the same law, with all of K on the solid's points (`walls`).
//!
//! A law for leaving: Walton and Braun 1986; the spring along the surface: Cundall and Strack 1979.

mod corners;
mod flanks;
#[cfg(test)]
mod flanks_tests;
mod law;
mod outline;
mod placed;
mod state;
#[cfg(test)]
mod tests;
mod walls;
#[cfg(test)]
mod walls_tests;

use halfstep_scene::{PairContact, Scene};
use halfstep_wire::protocol::StateRecord;
use law::{Law, Touch};
use outline::Outline;
use placed::Placed;

/// Part of the inverse of the fastest frequency of contact that a step may take.
const THETA: f64 = 0.3;

/// What a pair of solids did to each other, as a report has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Booked {
    /// Energy that both got by normal forces, J (2D: J/m); what an elastic impact stores is given back.
    pub normal: f64,
    /// Energy that both got by friction, J (2D: J/m).
    pub friction: f64,
    /// Largest force on one of the two, N (2D: N/m).
    pub largest_force: f64,
    /// Largest penetration, m.
    pub largest_penetration: f64,
}

impl Booked {
    /// Takes the forces on one of the two, along the normals and along the surfaces, and the largest penetration, m.
    fn note(&mut self, [normal, along]: &[Vec<[f64; 2]>; 2], deepest: f64) {
        let sum = |forces: &[[f64; 2]], d: usize| forces.iter().map(|f| f[d]).sum::<f64>();
        let force = [0, 1].map(|d| sum(normal, d) + sum(along, d));
        self.largest_force = self.largest_force.max(libm::hypot(force[0], force[1]));
        self.largest_penetration = self.largest_penetration.max(deepest);
    }
}

/// One of the two solids of a pair.
#[derive(Clone, Debug, Default)]
struct Side {
    /// Index of the solid in the scene.
    solid: usize,
    /// Force on each record along the normals, and along the surfaces, N (2D: N/m); empty where nothing touches.
    forces: [Vec<[f64; 2]>; 2],
}

impl Side {
    /// Work of the forces along the normals, and of those along the surfaces, on the ways of the records, J (2D: J/m).
    fn work(&self, way: &impl Fn(usize) -> [f64; 2]) -> [f64; 2] {
        self.forces.each_ref().map(|forces| {
            let of = |(record, force): (usize, &[f64; 2])| {
                let way = way(record);
                force[0] * way[0] + force[1] * way[1]
            };
            forces.iter().enumerate().filter(|(_, force)| **force != [0.0; 2]).map(of).sum::<f64>()
        })
    }
}

/// Two solids that may touch, or the bodies of one.
#[derive(Clone, Debug)]
struct Pair {
    law: Law,
    /// Of bodies of one solid: that of two which stands first in the outline, and the other one.
    sides: [Side; 2],
    /// There are two that can touch.
    acts: bool,
    /// Contacts at n, ascending.
    touches: Vec<Touch>,
    booked: Booked,
}

/// All contacts between solids and between their bodies in a run.
#[derive(Clone, Debug)]
pub struct Contact {
    scene: Scene,
    /// One for each solid, empty before the first states.
    outlines: Vec<Outline>,
    placed: Vec<Placed>,
    pairs: Vec<Pair>,
    /// Contacts at n + 1/2.
    halfway: Vec<Touch>,
    /// Positions of the first states, m, and masses, kg (2D: kg/m), of each solid's records.
    first: Vec<(Vec<[f64; 2]>, Vec<f64>)>,
}

impl Contact {
    /// Between the solids of a scene and between the bodies of those that leave it to the coupler; `None` where no two
    /// can touch.
    pub fn new(scene: &Scene) -> Option<Self> {
        let said: Vec<PairContact> = scene.contacts().into_iter().chain(scene.contacts_of_bodies()).collect();
        if said.is_empty() {
            return None;
        }
        let of = |contact: &PairContact| Pair {
            law: Law::of(contact),
            sides: contact.solids.map(|solid| Side { solid, ..Side::default() }),
            acts: true,
            touches: Vec::new(),
            booked: Booked::default(),
        };
        Some(Self {
            pairs: said.iter().map(of).collect(),
            placed: vec![Placed::default(); scene.solids.len()],
            outlines: Vec::new(),
            halfway: Vec::new(),
            first: Vec::new(),
            scene: scene.clone(),
        })
    }

    /// Leaves contact between the bodies of a solid to its model: of a program that is not ours.
    pub fn leave_bodies(&mut self, solid: usize) {
        self.pairs.retain(|pair| pair.sides.iter().any(|side| side.solid != solid));
    }

    /// Takes the first states of a run; of one that goes on those that it began with are known.
    pub fn begin<'a>(&mut self, states: impl Iterator<Item = &'a [StateRecord]>) {
        if self.first.is_empty() {
            let of = |records: &[StateRecord]| {
                let at = |r: &StateRecord| [r.position[0], r.position[1]];
                (records.iter().map(at).collect(), records.iter().map(|r| r.mass).collect())
            };
            self.first = states.map(of).collect();
        }
        if self.outlines.is_empty() {
            self.build();
        }
    }

    fn build(&mut self) {
        let scene = &self.scene;
        self.outlines = Outline::all(scene, &self.first);
        for pair in &mut self.pairs {
            let [a, b] = pair.sides.each_ref().map(|side| side.solid);
            let masses = [a, b].map(|solid| self.outlines[solid].least_mass());
            pair.law.fit(scene, [a, b], masses);
            pair.acts = a != b || self.outlines[a].pieces.len() > 1;
        }
    }

    /// Largest time step that all contacts are stable with, s.
    pub fn limit(&self) -> f64 {
        let acting = self.pairs.iter().filter(|pair| pair.acts);
        acting.map(|pair| pair.law.limit).fold(f64::INFINITY, f64::min)
    }

    /// Evaluates all contacts from the solids' records, in the scene's order, in a time step, s. `whole`: of a state at
    /// n, from which the contacts go on; else it is one at n + 1/2.
    pub fn evaluate<'a>(&mut self, records: impl Fn(usize) -> &'a [StateRecord], whole: bool, dt: f64) {
        if self.outlines.is_empty() {
            return;
        }
        for (solid, placed) in self.placed.iter_mut().enumerate() {
            placed.bound(&self.outlines[solid], records(solid));
        }
        for pair in self.pairs.iter_mut().filter(|pair| pair.acts) {
            let [a, b] = pair.sides.each_ref().map(|side| side.solid);
            pair.sides.iter_mut().flat_map(|side| &mut side.forces).for_each(Vec::clear);
            if !self.placed[a].meets(&self.placed[b]) {
                pair.touches.clear();
                continue;
            }
            for solid in [a, b] {
                self.placed[solid].place(&self.outlines[solid], records(solid));
            }
            for side in &mut pair.sides {
                let n = records(side.solid).len();
                side.forces.iter_mut().for_each(|forces| forces.resize(n, [0.0; 2]));
            }
            self.halfway.clear();
            let [first, second] = &mut pair.sides;
            let view = |solid: usize| (&self.outlines[solid], &self.placed[solid]);
            let found = &mut self.halfway;
            let mut deepest =
                pair.law.pass(0, [view(a), view(b)], [&mut *first, &mut *second], (&pair.touches, dt), found);
            let other = pair.law.pass(1, [view(b), view(a)], [second, first], (&pair.touches, dt), found);
            deepest = deepest.max(other);
            if whole {
                std::mem::swap(&mut pair.touches, &mut self.halfway);
            }
            pair.note(deepest);
        }
    }

    /// Calls `visit` with each solid, its record and the force of all contacts on it, N (2D: N/m), where that is not
    /// zero.
    pub fn forces(&self, mut visit: impl FnMut(usize, usize, [f64; 2])) {
        for side in self.pairs.iter().flat_map(|pair| &pair.sides) {
            let [normal, along] = &side.forces;
            for (record, (n, t)) in normal.iter().zip(along).enumerate() {
                let force = [n[0] + t[0], n[1] + t[1]];
                if force != [0.0; 2] {
                    visit(side.solid, record, force);
                }
            }
        }
    }

    /// Books the work of the present forces on the way of the records from the state at n before to this one; returns
    /// that on each solid, J (2D: J/m).
    pub fn work(&mut self, way: impl Fn(usize, usize) -> [f64; 2]) -> Vec<f64> {
        let mut work = vec![0.0; self.placed.len()];
        for pair in &mut self.pairs {
            for side in &pair.sides {
                let done = side.work(&|record| way(side.solid, record));
                pair.booked.normal += done[0];
                pair.booked.friction += done[1];
                work[side.solid] += done[0] + done[1];
            }
        }
        work
    }

    /// What each pair did so far, with the indices of its solids; of bodies of one solid twice its index.
    pub fn booked(&self) -> impl Iterator<Item = ([usize; 2], &PairLaw, Booked)> {
        let acting = self.pairs.iter().filter(|pair| pair.acts);
        acting.map(|pair| (pair.sides.each_ref().map(|side| side.solid), &pair.law, pair.booked))
    }
}

pub use law::Law as PairLaw;
pub use walls::WallContact;

impl Pair {
    fn note(&mut self, deepest: f64) {
        self.booked.note(&self.sides[0].forces, deepest);
    }
}
