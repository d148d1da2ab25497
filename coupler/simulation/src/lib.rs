//! The front door: fluid-structure co-simulation by smoothed particle hydrodynamics as a library.
//!
//! ```
//! use halfstep::{Simulation, scene};
//!
//! let tank = "resolution = 0.05\nend_time = 0.01\n[fluid]\ndensity = 1000.0\n\
//!             [[shape]]\nname = \"tank\"\nphase = \"wall\"\ntank = { min = [0.0, 0.0], max = [1.0, 0.5] }\n\
//!             [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [1.0, 0.5] }\n\
//!             pressure = \"hydrostatic\"\n[[probe]]\nname = \"bottom\"\nkind = \"pressure\"\nat = [0.5, 0.0]\n";
//! let mut tank = Simulation::new(scene::parse(tank, "tank.toml".as_ref(), &[])?).begin()?;
//! while tank.step()? {}
//! let pressure = tank.probe("bottom.pressure").expect("the scene has this probe");
//! assert!((pressure / (1000.0 * 9.81 * 0.5) - 1.0).abs() < 0.05, "{pressure} Pa");
//! # Ok::<(), halfstep::Error>(())
//! ```
//!
//! A [`Simulation`] takes one's own solid (any [`SolidModel`]) or one's own effect on the fluid ([`FluidEffect`]), is
//! stepped and looked into, writes a run's folder if it is told to, and leaves the rest of the process alone.
//! [`run`](mod@run) is what the command `halfstep run` does: participants as processes, supervised.

mod advice;
mod cause;
pub mod check;
mod checkpoint;
mod course;
mod effects;
mod error;
pub mod explain;
pub mod fake_fluid;
mod forecast;
pub mod isa;
mod last_frame;
pub mod options;
mod participants;
mod particles;
mod prescribed;
pub mod remarks;
mod role_main;
pub mod run;
mod session;
mod silence;
mod simulation;
mod step_cost;
mod through_walls;
mod timeline;

pub use error::Error;
pub use halfstep_fluid::effects::FluidEffect;
pub use halfstep_output::{Frame, RunReport};
pub use halfstep_scene::{self as scene, Scene};
pub use halfstep_solid::SolidModel;
pub use options::Launcher;
pub use role_main::{role_main, serve_role};
pub use simulation::{Running, Simulation};
