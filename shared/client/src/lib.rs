//! A solid in a program of its own that a run starts: `halfstep run SCENE --solid COMMAND`, or alone, pushed by a known
//! force, `halfstep fake-fluid SCENE --solid COMMAND --force FX,FY`.
//!
//! Units are SI; in two dimensions masses are kg/m, forces N/m, per metre of depth, and z is zero. What every solid
//! has to know is in `docs/protocol.md`. A block on a spring is in `examples/joined_solid.rs`.
//!
//! ```no_run
//! use halfstep_client::{Contact, Particles, Solid};
//!
//! let particles = Particles::of_scene()?;
//! let mut state = particles.clone();
//! let mut solid = Solid::join(&particles, Contact::Coupler)?;
//! while let Some(step) = solid.wait()? {
//!     let load: f64 = solid.forces().iter().map(|force| force[0]).sum();
//!     // From the state at n, by step.span.
//!     solid.publish(&state.position, &state.velocity)?;
//! }
//! # Ok::<(), halfstep_client::Error>(())
//! ```

mod checkpoint;
mod particles;
mod run;
mod solid;

pub use halfstep_wire::failure::Quantity;
pub use particles::Particles;
pub use run::{Contact, Run};
pub use solid::{Solid, Step};

/// Why a solid cannot go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// Another number of particles than the solid's, or one that the run has no room for.
    #[error("{0}")]
    Count(String),
    /// A number that nothing has: not finite, or not positive where it must be.
    #[error("{0}")]
    Value(String),
    /// A call out of order.
    #[error("{0}")]
    State(&'static str),
    /// There is no run, it speaks another version, or another process of it has ended.
    #[error("{0}")]
    Run(String),
}

impl From<halfstep_link::LinkError> for Error {
    fn from(error: halfstep_link::LinkError) -> Self {
        Self::Run(error.to_string())
    }
}
