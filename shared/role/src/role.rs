//! What a process that owns particles does, seen from the lock-step: the seam between physics and co-simulation.

use crate::balance::Balance;
use crate::ledger::Ledger;
use halfstep_scene::EffectName;
use halfstep_sph::Phase;
use halfstep_wire::Name;
use halfstep_wire::failure::Diverged;
use halfstep_wire::frame::Frame;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{Audit, ForceRecord, StateRecord};
use halfstep_wire::state::State;
use std::time::Instant;

/// A peer's state as last received.
#[derive(Clone, Debug, Default)]
pub struct Peer {
    /// Its interface particles, by ascending number.
    pub records: Vec<StateRecord>,
    /// Generation of the set.
    pub epoch: u64,
}

/// What the effects take of a role's time: each measured by leaving the effect out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Costs {
    /// By [`EffectName`].
    pub effects: [f64; EffectName::ALL.len()],
    /// Walls toward this phase.
    pub walls: f64,
    /// Placing the walls that move; not part of the sums.
    pub moving_walls: f64,
    /// The numbers are parts of one of the whole computing time; else of [`Role::own_sums`].
    pub of_whole: bool,
}

impl Costs {
    /// The same in seconds, for this much time in the sums, in all, and in sums across the interface, which are told
    /// by themselves. What was measured by leaving it out may add up to more than the whole (two effects may hide
    /// each other's time, another program may have taken the processor): then each part is less by the same factor.
    pub fn of(self, sums: f64, compute: f64, cross: f64) -> Self {
        let parts = self.walls + self.effects.iter().sum::<f64>();
        let seconds = if self.of_whole { compute - cross } else { sums } / parts.max(1.0);
        Self {
            effects: self.effects.map(|e| e * seconds),
            walls: self.walls * seconds,
            moving_walls: (self.moving_walls * sums).min((compute - cross - sums).max(0.0)),
            ..self
        }
    }
}

/// Seconds of a piece of work: the fastest of three.
pub fn fastest(mut work: impl FnMut()) -> f64 {
    let once = |_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    (0..3).map(once).fold(f64::INFINITY, f64::min)
}

/// Owner of the particles of a participant: of the fluid, or of one solid.
///
/// One half-step is `publish`, `own_sums`, `cross_sums`, `advance`, in this order; the loop in [`crate::lockstep`]
/// calls them.
pub trait Role: Send {
    /// Name of the participant.
    fn name(&self) -> Name;
    /// Which phase.
    fn phase(&self) -> Phase;
    /// Number of own particles.
    fn particles(&self) -> u64;
    /// Largest stable time step from the state at n, s.
    fn dt_limit(&self) -> f64;
    /// The instant of the state that is published next, s: what moves by prescription goes there.
    fn set_time(&mut self, _time: f64) {}
    /// Fills `out` with the interface record of the present state. `peers` are the states of the other phase as last
    /// received: of all solids in the scene's order, or of the fluid. Returns the epoch.
    fn publish(&mut self, peers: &[Peer], out: &mut Vec<StateRecord>) -> u64;
    /// Largest displacement of an own particle since the epoch began, m.
    fn displacement(&self) -> f64;
    /// Sums over own particles and walls.
    fn own_sums(&mut self);
    /// Sums across the interfaces, from both sides' records of this half-step.
    ///
    /// # Errors
    /// An own particle within reach of a peer was not published.
    fn cross_sums(&mut self, own: &[StateRecord], peers: &[Peer]) -> Result<(), CoverageError>;
    /// Advances over a half-step. `forces` answer the record last published.
    ///
    /// # Errors
    /// A quantity left its bounds.
    fn advance(&mut self, half_step: &HalfStep, forces: &[ForceRecord]) -> Result<(), Diverged>;
    /// Sub-steps of the last full step.
    fn sub_steps(&self) -> u32 {
        1
    }
    /// Appends the values of this participant's probes on the present state to `out`, in the scene's order.
    fn probes(&self, out: &mut Vec<f64>);
    /// Sums over all own particles.
    fn audit(&self) -> Audit;
    /// Its energy ledger, where the scene asks for one.
    fn ledger(&self) -> Option<&Ledger> {
        None
    }
    /// Impulse that the solids gave it since the start, as it was added to its particles.
    fn impulse(&self) -> Option<Balance> {
        None
    }
    /// Copies the particles for output.
    fn fill_frame(&self, time: f64, frame: &mut Frame);
    /// Hash over the own particles' state in id order.
    fn state_hash(&self) -> u64;
    /// Pair evaluations so far (listed pairs, four targets each counted).
    fn pair_evaluations(&self) -> u64;
    /// Bytes allocated for particles, walls and neighbour lists, where the role counts them.
    fn bytes(&self) -> Option<usize> {
        None
    }
    /// Which compiled composition of pair effects runs, where there are several.
    fn composition(&self) -> Option<&str> {
        None
    }
    /// What it keeps over an interruption; `None`: it cannot be saved.
    fn state(&mut self) -> Option<&mut dyn State> {
        None
    }
    /// Joints that have come apart in the present state, each with how far, m.
    fn open_joints(&self) -> Vec<(String, f64)> {
        Vec::new()
    }
    /// Joints whose ends begin with different velocities, each with how fast they move, m/s, and turn, rad/s, against
    /// each other.
    fn jerked_joints(&self) -> Vec<(String, [f64; 2])> {
        Vec::new()
    }
    /// What each effect costs, measured on the present state, which does not change. For the end of a run.
    fn costs(&mut self) -> Costs {
        Costs::default()
    }
}

/// The interface record lacks a particle that it needs.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "interface coverage lost: fluid moved {fluid:e} m and solid {solid:e} m since the fluid chose its interface \
     particles, more than the {allowed:e} m that the choice allows for (a smaller time step helps)"
)]
pub struct CoverageError {
    /// Largest fluid displacement, m.
    pub fluid: f64,
    /// Largest solid displacement, m.
    pub solid: f64,
    /// Allowed sum, m.
    pub allowed: f64,
    /// Place of the solid among the peers.
    pub peer: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn costs(parts: [f64; 3], moving_walls: f64) -> Costs {
        let mut costs = Costs { walls: parts[0], moving_walls, ..Costs::default() };
        costs.effects[..2].copy_from_slice(&parts[1..]);
        costs
    }

    #[test]
    fn parts_that_fit_are_taken_as_measured() {
        let seconds = costs([0.25, 0.5, 0.125], 0.25).of(4.0, 8.0, 1.0);
        assert_eq!((seconds.walls, seconds.moving_walls, &seconds.effects[..2]), (1.0, 1.0, &[2.0, 0.5][..]));
        let of_whole = Costs { of_whole: true, ..costs([0.0, 0.5, 0.125], 0.0) }.of(4.0, 9.0, 1.0);
        assert_eq!(of_whole.effects[..2], [4.0, 1.0]);
    }

    #[test]
    fn parts_beyond_the_whole_share_it() {
        // 0.5 + 1 + 0.5 of 4 s; the walls' places within the half a second that is left.
        let seconds = costs([0.5, 1.0, 0.5], 0.25).of(4.0, 8.0, 3.5);
        assert_eq!((seconds.walls, seconds.moving_walls, &seconds.effects[..2]), (1.0, 0.5, &[2.0, 1.0][..]));
    }
}
