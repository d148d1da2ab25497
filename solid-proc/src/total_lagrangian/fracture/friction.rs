//! Coulomb's friction between fragments, between the two sides of a crack, and at walls (`solid.fracture.friction`).
//!
//! What pushes along n with the force N is held across n with at most mu N. The force jumps where two particles stop on
//! each other, so it is not evaluated but solved for (Moreau 1988): a kick of dt takes from the velocity u of the two
//! along their surface
//!   |u| - min(|u|, mu N dt (1/m_i + 1/m_j)),
//! which is exact while they slide, stops them without turning them round, and holds them while less than mu N pulls. A
//! particle that touches several others is taken through them in the order of their slots. Each keeps momentum and, but
//! at walls that move, only takes energy, so all do, and there is nothing to remember.

use super::Fracture;
use crate::columns::{Vectors, vector};
use crate::total_lagrangian::model::TotalLagrangian;
use halfstep_scene::EnergyPart;
use halfstep_wire::state::{Fields, StateError};
use std::collections::BTreeMap;

/// Particles that rub on each other or on a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rubbing<const D: usize> {
    /// Slots; of a particle on a wall, its own twice.
    pair: [usize; 2],
    /// n.
    normal: [f64; D],
    /// N / m, m/s².
    push: f64,
    /// Of the wall, m/s.
    wall: [f64; D],
}

/// Length of a vector.
fn length<const D: usize>(a: [f64; D]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Change of the velocity of a particle along a surface of normal n by friction over a time, m/s: u is its velocity to
/// what it rubs on, of which `free` (1 or 2) give way, `most` mu N dt / m.
fn slowed<const D: usize>(u: [f64; D], normal: [f64; D], most: f64, free: f64) -> [f64; D] {
    let across: f64 = (0..D).map(|d| u[d] * normal[d]).sum();
    let along: [f64; D] = std::array::from_fn(|d| u[d] - across * normal[d]);
    let speed = length(along);
    let taken = most.min(speed / free);
    along.map(|u| if speed > 0.0 { -u * taken / speed } else { 0.0 })
}

impl<const D: usize> TotalLagrangian<D> {
    /// Notes what rubs in the present state, which has been evaluated.
    pub(in crate::total_lagrangian) fn note_rubbing(&mut self) {
        if self.fracture.as_ref().is_none_or(|fracture| fracture.friction == 0.0) {
            return;
        }
        let rubbing = self.rubbing();
        if let Some(fracture) = &mut self.fracture {
            fracture.rubbing = rubbing;
        }
    }

    fn rubbing(&self) -> Vec<Rubbing<D>> {
        let mut pairs = BTreeMap::new();
        let slot = |id: u32| self.slot_of[id as usize] as usize;
        if let Some(contact) = &self.contact {
            contact.touching(|[a, b], normal, push| {
                pairs.insert([slot(a), slot(b)], (normal, push));
            });
        }
        let of = |(pair, (normal, push))| Rubbing { pair, normal, push, wall: [0.0; D] };
        let mut rubbing: Vec<_> = pairs.into_iter().map(of).collect();
        if let Some(contact) = &self.contact {
            contact.touching_walls(|id, normal, push, wall| {
                rubbing.push(Rubbing { pair: [slot(id); 2], normal, push, wall });
            });
        }
        rubbing.retain(|r| r.push > 0.0 && r.pair.iter().any(|&slot| self.is_free(slot)));
        rubbing.sort_by_key(|r| r.pair);
        rubbing
    }

    /// Friction over a kick of dt, s, before or after the drift.
    pub(in crate::total_lagrangian) fn rub(&mut self, dt: f64, drift: Drift) {
        self.fracture.iter_mut().for_each(|fracture| fracture.rubbed.clear());
        let Some(mut fracture) = self.fracture.take_if(|fracture| !fracture.rubbing.is_empty()) else {
            return;
        };
        let before = self.keeps_account().then(|| self.now.velocity.clone());
        for Rubbing { pair: [i, j], normal, push, wall } in &fracture.rubbing {
            let velocity = |slot: usize| vector(&self.now.velocity, slot as u32);
            let at_wall = i == j;
            let (v, other) = (velocity(*i), if at_wall { *wall } else { velocity(*j) });
            let free = [*i, *j].map(|slot| self.is_free(slot));
            let count = if free[0] && free[1] && !at_wall { 2.0 } else { 1.0 };
            let u = std::array::from_fn(|d| v[d] - other[d]);
            let change = slowed(u, *normal, fracture.friction * push * dt, count);
            fracture.rubbed.push(([*i, *j], change.map(|change| change / dt)));
            for d in 0..D {
                if free[0] {
                    self.now.velocity[d][*i] += change[d];
                }
                if free[1] && !at_wall {
                    self.now.velocity[d][*j] -= change[d];
                }
            }
        }
        self.fracture = Some(fracture);
        if let Some(before) = before {
            let work = self.work_of_friction(&before, drift);
            self.account
                .iter_mut()
                .for_each(|account| account.given.give(EnergyPart::FragmentFriction, work));
        }
    }

    /// Calls `give` with particles and the force of friction on them in the last kick, N (2D: N/m).
    pub(in crate::total_lagrangian) fn friction_forces(&self, mut give: impl FnMut(u32, [f64; D])) {
        let rubbed = self.fracture.iter().flat_map(|fracture| &fracture.rubbed);
        for (pair, acceleration) in rubbed {
            give(self.id[pair[0]], acceleration.map(|a| self.mass * a));
            if pair[0] != pair[1] {
                give(self.id[pair[1]], acceleration.map(|a| -self.mass * a));
            }
        }
    }

    /// Work of friction that changed these velocities, m/s: by the velocity of the drift, as that of all forces. What
    /// sticks is pulled in each kick and stopped again, and goes nowhere: no work is done on it.
    fn work_of_friction(&self, before: &Vectors<D>, drift: Drift) -> f64 {
        let of = |(from, to): (&f64, &f64)| (to - from) * if drift == Drift::Follows { *to } else { *from };
        let columns = before.iter().zip(&self.now.velocity);
        self.mass * columns.map(|(from, to)| from.iter().zip(to).map(of).sum::<f64>()).sum::<f64>()
    }
}

/// Whether the kick is that before the drift or that after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::total_lagrangian) enum Drift {
    Follows,
    IsDone,
}

impl<const D: usize> Fracture<D> {
    /// Keeps what rubs at n.
    pub(in crate::total_lagrangian) fn leave_n(&mut self) {
        self.rubbing_at_n.clone_from(&self.rubbing);
    }

    /// The state is that at n again.
    pub(in crate::total_lagrangian) fn return_to_n(&mut self) {
        self.rubbing.clone_from(&self.rubbing_at_n);
    }

    /// Takes the coefficient away, for a while.
    pub(in crate::total_lagrangian) fn take_friction(&mut self) -> Option<f64> {
        (self.friction > 0.0).then(|| std::mem::take(&mut self.friction))
    }

    /// The coefficient is this again.
    pub(in crate::total_lagrangian) fn put_friction(&mut self, friction: f64) {
        self.friction = friction;
    }

    /// Visits what rubs: damping of walls took velocities that are not those of the state.
    pub(super) fn rubbing_fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        let mut slots: Vec<u32> = self.rubbing.iter().flat_map(|r| r.pair).map(|slot| slot as u32).collect();
        let mut normals: Vec<[f64; D]> = self.rubbing.iter().map(|r| r.normal).collect();
        let mut pushes: Vec<f64> = self.rubbing.iter().map(|r| r.push).collect();
        let mut walls: Vec<[f64; D]> = self.rubbing.iter().map(|r| r.wall).collect();
        fields.numbers("rubbing", &mut slots)?;
        fields.points("rubbing_normals", &mut normals)?;
        fields.reals("rubbing_pushes", &mut pushes)?;
        fields.points("rubbing_walls", &mut walls)?;
        for (name, count) in
            [("rubbing", slots.len() / 2), ("normals", normals.len()), ("walls", walls.len())]
        {
            fields.length(name, pushes.len(), count)?;
        }
        if slots.iter().any(|&slot| slot as usize >= self.strain.len()) {
            return Err(StateError::contradiction("friction of other particles than the scene's"));
        }
        let pairs = slots.chunks_exact(2).map(|pair| [pair[0] as usize, pair[1] as usize]);
        let of = |(((pair, normal), push), wall)| Rubbing { pair, normal, push, wall };
        self.rubbing = pairs.zip(normals).zip(pushes).zip(walls).map(of).collect();
        self.leave_n();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_slows_and_stops_but_does_not_turn_round() {
        // u = (3, 4, 5) on a surface across z: 5 m/s along it.
        let (u, n) = ([3.0, 4.0, 5.0], [0.0, 0.0, 1.0]);
        assert_eq!(slowed(u, n, 1.0, 1.0), [-0.6, -0.8, 0.0]);
        // Two that give way meet halfway, one that does alone stops.
        assert_eq!(slowed(u, n, 9.0, 2.0), [-1.5, -2.0, 0.0]);
        assert_eq!(slowed(u, n, 9.0, 1.0), [-3.0, -4.0, 0.0]);
        assert_eq!(slowed([0.0, 0.0, 5.0], n, 9.0, 1.0), [0.0; 3]);
    }
}
