//! What the `probes` of a last message hold, by place. A phase may leave them out.

use halfstep_scene::EffectName;

/// Median time from publishing a state to having the forces, µs.
pub const ROUND_TRIP_P50: usize = 0;
/// The one that one in a hundred exceeds, µs.
pub const ROUND_TRIP_P99: usize = 1;
/// Pair evaluations of the run: a whole number, exact up to 2^53.
pub const PAIR_EVALUATIONS: usize = 2;
/// Computing time of the walls toward this phase, s.
pub const WALLS: usize = 3;
/// Computing time of the sums across the interface, s.
pub const INTERFACE: usize = 4;
/// Here begin the effects in the order of [`halfstep_scene::EffectName::ALL`]: computing time of each, s.
pub const EFFECTS: usize = 5;
/// How many there are.
pub const COUNT: usize = EFFECTS + EffectName::ALL.len();
