//! What a process that owns particles does, seen from the lock-step: the seam between physics and co-simulation.

use crate::failure::{Diverged, RoleName};
use crate::output::frame::Frame;
use crate::protocol::{ForceRecord, MAX_PROBE_VALUES, StateRecord};

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
    /// Energy stored in the material, J; 0 for a fluid.
    pub const STORED_ENERGY: usize = 7;
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
    /// Advances to n + 1/2 (`stage` 0) or to n + 1 (`stage` 1). `forces` answer the record last published.
    ///
    /// # Errors
    /// A quantity left its bounds.
    fn advance(&mut self, step: u64, stage: u32, dt: f64, forces: &[ForceRecord]) -> Result<(), Diverged>;
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
