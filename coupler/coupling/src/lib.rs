//! The coupler: the clock, the lock-step of all participants, the energy balance, and the processes that they run in.
//!
//! ```
//! use halfstep_coupling::clock::{Clock, Limit};
//! use halfstep_wire::Name;
//!
//! # let text = "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
//! #     phase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [1.0, 0.5] }\n";
//! # let scene = halfstep_scene::parse(text, "water.toml".as_ref(), &[]).expect("a right scene");
//! let mut clock = Clock::new(&scene);
//! // The smallest limit of the participants decides.
//! let limits = [Limit { participant: Name::FLUID, dt: 0.2 }, Limit { participant: Name::SOLID, dt: 0.1 }];
//! let tick = clock.tick(&limits, false).expect("limits are numbers");
//! assert_eq!(tick.dt, Some(0.1));
//! ```

pub mod checkpoints;
pub mod clock;
pub mod couple;
pub mod course;
pub mod energy;
pub mod error;
pub mod external;
pub mod local;
pub mod no_room;
pub mod recorder;
pub mod reports;
pub mod roles;
pub mod say;
mod solids;
pub mod supervise;
