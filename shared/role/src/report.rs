//! What a participant says about itself when it ends: where its time went and how much it computed.

use crate::balance::Balance;
use halfstep_scene::{EffectName, EnergyEntry};
use serde::{Deserialize, Serialize};

/// Report of a participant, in seconds unless said otherwise.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Report {
    /// Its name.
    pub name: String,
    /// Computing.
    pub compute: f64,
    /// Waiting for others; of the whole process.
    pub wait: f64,
    /// Sending and receiving; of the whole process.
    pub exchange: f64,
    /// Handing over what is written.
    pub output: f64,
    /// From publishing a state to having the forces, µs: median, and what one in a hundred exceeds.
    pub round_trip_us: [f64; 2],
    /// Pairs listed in all passes, four targets each.
    pub pair_evaluations: u64,
    /// Walls toward this participant.
    pub walls: f64,
    /// Placing the walls that move.
    pub moving_walls: f64,
    /// Sums across the interface.
    pub interface: f64,
    /// Effects that took measurable time.
    pub effects: Vec<(EffectName, f64)>,
    /// Energy ledger, J; empty where the scene asks for none.
    pub energy: Vec<EnergyEntry>,
    /// Joints that have come apart at the end, each with how far, m.
    pub open_joints: Vec<(String, f64)>,
    /// Joints whose ends began with different velocities, each with how fast they moved, m/s, and turned, rad/s,
    /// against each other.
    pub jerked_joints: Vec<(String, [f64; 2])>,
    /// Impulse that the solids gave it, as it was added to its particles; of the fluid.
    pub impulse: Option<Balance>,
}
