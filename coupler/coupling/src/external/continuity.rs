//! What holds from one state of a solid to the next: as many particles, each near where it was.

use crate::error::RunError;
use halfstep_scene::Scene;
use halfstep_wire::Name;
use halfstep_wire::protocol::StateRecord;

/// Part of the smoothing length that a particle of a solid may move between two states: more, and the fluid's interface
/// particles would no longer cover it.
const REACH: f64 = 0.6;

/// The particles of the states of one solid.
pub struct Continuity {
    solid: Name,
    /// Number of them, once known.
    pub(crate) count: Option<u64>,
    /// How far one may come between two states whatever its velocity, m: of a solid of another program.
    reach: Option<f64>,
    /// Positions of the state before, m: of a solid of another program.
    before: Vec<[f64; 3]>,
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

impl Continuity {
    /// Of the scene's solid of that index; `external`: another program computes it.
    pub fn new(scene: &Scene, solid: usize, external: bool) -> Self {
        let solid = scene.solids.get(solid).and_then(|solid| solid.name.parse().ok()).unwrap_or(Name::SOLID);
        let reach = external.then_some(REACH * scene.smoothing_ratio * scene.resolution);
        Self { solid, count: None, reach, before: Vec::new() }
    }

    /// Looks at the next state, of step n, after a time step of at most `dt`, s.
    ///
    /// # Errors
    /// It has no particles, not as many as the states before, or one that came farther than velocities and time step
    /// explain: the fluid would take it for one that is too fast.
    pub fn check(&mut self, records: &[StateRecord], dt: f64, step: u64) -> Result<(), RunError> {
        let (solid, now) = (self.solid, records.len() as u64);
        let first = *self.count.get_or_insert(now);
        if first == 0 {
            return Err(RunError::NoParticles { solid });
        }
        if first != now {
            return Err(RunError::SolidCount { solid, first, now, step });
        }
        let Some(reach) = self.reach else { return Ok(()) };
        let speed = records.iter().map(|r| length(r.velocity)).fold(0.0, f64::max);
        let way = |(r, x): (&StateRecord, &[f64; 3])| length(std::array::from_fn(|d| r.position[d] - x[d]));
        let far = records.iter().zip(&self.before).map(|pair| (pair.0.id, way(pair)));
        let jump = far
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, distance)| *distance > reach + 2.0 * speed * dt);
        self.before.clear();
        self.before.extend(records.iter().map(|r| r.position));
        match jump {
            Some((particle, distance)) => Err(RunError::Jump { solid, particle, distance, speed, dt, step }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn record(x: f64, speed: f64) -> StateRecord {
        StateRecord { position: [x, 0.0, 0.0], velocity: [speed, 0.0, 0.0], ..StateRecord::default() }
    }

    #[test]
    fn particles_stay_as_many_and_where_their_velocities_take_them() {
        let text = "resolution = 0.1\nend_time = 1.0\ngravity = [0.0, 0.0]\n[solid]\ndensity = 1.0\n\
                    youngs_modulus = 1.0\npoissons_ratio = 0.2\n[[shape]]\nname = \"block\"\nphase = \"solid\"\n\
                    box = { min = [0.0, 0.0], max = [0.5, 0.5] }\n";
        let scene = halfstep_scene::parse(text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let reach = 0.6 * scene.smoothing_ratio * 0.1;
        let new = |external| Continuity::new(&scene, 0, external);
        let mut solid = new(true);
        // 0.01 s at 2 m/s explain 0.04 m at most.
        for (x, step) in [(0.0, 0), (reach + 0.039, 1), (0.0, 2)] {
            solid.check(&[record(x, 2.0)], 0.01, step).unwrap_or_else(|e| panic!("{e}"));
        }
        let far = solid.check(&[record(reach + 0.041, 2.0)], 0.01, 3).map_err(|e| e.to_string());
        assert!(far.is_err_and(|said| said.contains("at step 3") && said.contains("2.000e0 m/s")));
        let mut own = new(false);
        own.check(&[record(0.0, 0.0)], 0.01, 0).unwrap_or_else(|e| panic!("{e}"));
        own.check(&[record(9.0, 0.0)], 0.01, 0).unwrap_or_else(|e| panic!("{e}"));
        let more = own.check(&[record(0.0, 0.0), record(1.0, 0.0)], 0.01, 7).map_err(|e| e.to_string());
        assert!(more.is_err_and(|said| said.contains("2 interface particles at step 7 and 1 before")));
        assert!(matches!(new(true).check(&[], 0.01, 0), Err(RunError::NoParticles { .. })));
    }
}
