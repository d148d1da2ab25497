//! What a process that owns particles does, seen from the lock-step: the seam between physics and co-simulation.

use halfstep_scene::EffectName;
use halfstep_wire::failure::{Diverged, RoleName};
use halfstep_wire::frame::Frame;
use halfstep_wire::half_step::HalfStep;
use halfstep_wire::protocol::{ForceRecord, MAX_PROBE_VALUES, StateRecord};
use std::time::Instant;

/// The numbers of [`Role::audit`] by place.
pub mod audit {
    /// Linear momentum x, y, z, kg m/s (2D: per metre).
    pub const MOMENTUM: usize = 0;
    /// Kinetic energy, J.
    pub const KINETIC_ENERGY: usize = 3;
    /// Mass, kg.
    pub const MASS: usize = 4;
    /// Largest |rho / rho0 - 1|.
    pub const DENSITY_ERROR: usize = 5;
    /// Smallest distance to the other phase over dx (infinite where none is near).
    pub const GAP: usize = 6;
    /// Energy stored in the material, J: strain energy of a solid, work of compression of a fluid.
    pub const STORED_ENERGY: usize = 7;
}

/// What the effects take of a role's time: each measured by leaving the effect out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Costs {
    /// By [`EffectName`].
    pub effects: [f64; EffectName::ALL.len()],
    /// Walls toward this phase.
    pub walls: f64,
    /// The numbers are parts of one of the whole computing time; else of [`Role::own_sums`].
    pub of_whole: bool,
}

impl Costs {
    /// The same in seconds, for this much time in the sums and in all.
    pub fn of(self, sums: f64, compute: f64) -> Self {
        let seconds = if self.of_whole { compute } else { sums };
        Self { effects: self.effects.map(|e| e * seconds), walls: self.walls * seconds, ..self }
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

/// Owner of the fluid's or of the solid's particles.
///
/// One half-step is `publish`, `own_sums`, `cross_sums`, `advance`, in this order; the loops in [`crate::lockstep`]
/// call them.
pub trait Role: Send {
    /// Which phase.
    fn name(&self) -> RoleName;
    /// Number of own particles.
    fn particles(&self) -> u64;
    /// Largest stable time step from the state at n, s.
    fn dt_limit(&self) -> f64;
    /// The instant of the state that is published next, s: what moves by prescription goes there.
    fn set_time(&mut self, _time: f64) {}
    /// Fills `out` with the interface record of the present state. `peer` is the other phase's record as last received.
    /// Returns the epoch.
    fn publish(&mut self, peer: &[StateRecord], out: &mut Vec<StateRecord>) -> u64;
    /// Largest displacement of an own particle since the epoch began, m.
    fn displacement(&self) -> f64;
    /// Sums over own particles and walls.
    fn own_sums(&mut self);
    /// Sums across the interface, from both sides' records of this half-step. `epoch` is the fluid's.
    ///
    /// # Errors
    /// An own particle within reach of the peer was not published.
    fn cross_sums(
        &mut self,
        own: &[StateRecord],
        peer: &[StateRecord],
        epoch: u64,
    ) -> Result<(), CoverageError>;
    /// Goes from n over the half-step's span, to n + 1/2 or to n + 1. `forces` answer the record last published.
    ///
    /// # Errors
    /// A quantity left its bounds.
    fn advance(&mut self, half_step: &HalfStep, forces: &[ForceRecord]) -> Result<(), Diverged>;
    /// Sub-steps of the last full step.
    fn sub_steps(&self) -> u32 {
        1
    }
    /// Values of this phase's probes in the scene's order; returns how many.
    fn probes(&self, out: &mut [f64; MAX_PROBE_VALUES]) -> usize;
    /// Integral quantities, see [`audit`].
    fn audit(&self) -> [f64; 8];
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
}
