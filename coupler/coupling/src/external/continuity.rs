//! What holds from one state of a solid to the next: as many particles of the masses that they had, each near where it
//! was, and in time as far as its velocities take it.

use crate::error::RunError;
use halfstep_scene::Scene;
use halfstep_wire::Name;
use halfstep_wire::protocol::StateRecord;

/// Part of the smoothing length that a particle of a solid may move between two states: more, and the fluid's interface
/// particles would no longer cover it.
const REACH: f64 = 0.6;
/// Steps before ways are compared with velocities, and the way that one particle has to have come by then, in spacings.
const STEPS: u64 = 20;
const WAY: f64 = 0.1;
/// Part of the ways that velocities may leave unexplained.
const UNEXPLAINED: f64 = 0.3;
/// Relative rounding of a mass that a process computes anew.
const ROUNDING: f64 = 1e-9;

/// The particles of the states of one solid.
pub struct Continuity {
    solid: Name,
    /// Number of them, once known.
    pub(crate) count: Option<u64>,
    /// How far one may come between two states whatever its velocity, m: of a solid of another program.
    reach: Option<f64>,
    /// Positions of the state before, m: of a solid of another program.
    before: Vec<[f64; 3]>,
    ways: Ways,
}

/// Ways of the particles of a solid of another program over whole steps, beside their velocities halfway.
#[derive(Default)]
struct Ways {
    /// Spacing, m.
    dx: f64,
    /// Of each particle the first position, m, and the mass, kg (2D: kg/m).
    first: Vec<([f64; 3], f64)>,
    /// Positions at n, m.
    at_n: Vec<[f64; 3]>,
    /// Velocities halfway, m/s.
    halfway: Vec<[f64; 3]>,
    /// Sums of the squares of ways and of what velocities leave of them, m².
    squares: [f64; 2],
    /// Farthest that a particle has come, m.
    farthest: f64,
    steps: u64,
    told: bool,
}

impl Ways {
    /// Takes the next state, after a step of `dt`, s, where it is one at n.
    fn add(&mut self, records: &[StateRecord], stage: u32, dt: f64) {
        if stage != 0 {
            self.halfway.clear();
            self.halfway.extend(records.iter().map(|r| r.velocity));
            return;
        }
        for ((record, from), velocity) in records.iter().zip(&self.at_n).zip(&self.halfway) {
            let led = std::array::from_fn(|d| from[d] + dt * velocity[d]);
            [*from, led]
                .map(|x| distance(record.position, x))
                .iter()
                .zip(&mut self.squares)
                .for_each(|(l, sum)| *sum += l * l);
        }
        let come = records.iter().zip(&self.first);
        self.farthest =
            come.map(|(r, (first, _))| distance(r.position, *first)).fold(self.farthest, f64::max);
        self.steps += u64::from(!self.halfway.is_empty());
        self.halfway.clear();
        self.at_n.clear();
        self.at_n.extend(records.iter().map(|r| r.position));
    }

    /// Part of the ways that velocities leave unexplained, once that is certain and too much.
    fn unexplained(&mut self) -> Option<f64> {
        if self.told || self.steps < STEPS || self.farthest < WAY * self.dx {
            return None;
        }
        let [ways, left] = self.squares;
        let part = (left / ways).sqrt();
        self.told = part > UNEXPLAINED;
        self.told.then_some(part)
    }
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    length(std::array::from_fn(|d| a[d] - b[d]))
}

impl Continuity {
    /// Of the scene's solid of that index; `external`: another program computes it.
    pub fn new(scene: &Scene, solid: usize, external: bool) -> Self {
        let solid = scene.solids.get(solid).and_then(|solid| solid.name.parse().ok()).unwrap_or(Name::SOLID);
        let reach = external.then_some(REACH * scene.smoothing_ratio * scene.resolution);
        let ways = Ways { dx: scene.resolution, ..Ways::default() };
        Self { solid, count: None, reach, before: Vec::new(), ways }
    }

    /// Looks at the next state, of step n at a stage, after a time step of at most `dt`, s.
    ///
    /// # Errors
    /// It has no particles, not as many as the states before, one of another mass, or one that came farther than
    /// velocities and time step explain: the fluid would take it for one that is too fast.
    pub fn check(
        &mut self,
        records: &[StateRecord],
        dt: f64,
        (step, stage): (u64, u32),
    ) -> Result<(), RunError> {
        let (solid, now) = (self.solid, records.len() as u64);
        let first = *self.count.get_or_insert(now);
        if first == 0 {
            return Err(RunError::NoParticles { solid });
        }
        if first != now {
            return Err(RunError::SolidCount { solid, first, now, step });
        }
        let Some(reach) = self.reach else { return Ok(()) };
        if self.ways.first.is_empty() {
            self.ways.first.extend(records.iter().map(|r| (r.position, r.mass)));
        }
        let is_other = |(r, (_, first)): (&StateRecord, &([f64; 3], f64))| {
            let off = (r.mass - first).abs() > ROUNDING * first;
            off.then_some((r.id, *first, r.mass))
        };
        if let Some((particle, first, now)) = records.iter().zip(&self.ways.first).find_map(is_other) {
            return Err(RunError::MassChanged { solid, particle, first, now, step });
        }
        self.ways.add(records, stage, dt);
        let speed = records.iter().map(|r| length(r.velocity)).fold(0.0, f64::max);
        let far = records.iter().zip(&self.before).map(|(r, x)| (r.id, distance(r.position, *x)));
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

    /// What is to be warned of: once, velocities with which the particles do not get where they are.
    pub fn remark(&mut self) -> Option<String> {
        let (part, solid) = (self.ways.unexplained()?, self.solid);
        Some(format!(
            "the velocities of the {solid} do not take its particles where they are: {:.0} % of their ways are not the \
             time step times the velocities halfway, and the fluid feels velocities that its surface does not have",
            100.0 * part
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn record(x: f64, speed: f64) -> StateRecord {
        StateRecord { position: [x, 0.0, 0.0], velocity: [speed, 0.0, 0.0], ..StateRecord::default() }
    }

    fn scene() -> Scene {
        let text = "resolution = 0.1\nend_time = 1.0\ngravity = [0.0, 0.0]\n[solid]\ndensity = 1.0\n\
                    youngs_modulus = 1.0\npoissons_ratio = 0.2\n[[shape]]\nname = \"block\"\nphase = \"solid\"\n\
                    box = { min = [0.0, 0.0], max = [0.5, 0.5] }\n";
        halfstep_scene::parse(text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"))
    }

    /// x = 0.05 (1 - cos 10 t) in steps of 1 ms: the way of a step is that of the velocity halfway to 4e-6 of it.
    #[test]
    fn velocities_that_do_not_take_particles_along_are_told_once() {
        for (factor, told) in [(1.0, None), (0.8, None), (0.0, Some("100 %")), (2.0, Some("100 %"))] {
            let mut solid = Continuity::new(&scene(), 0, true);
            let mut remarks = Vec::new();
            for step in 0..200_u64 {
                for stage in 0..2 {
                    let t = 1e-3 * (step as f64 + 0.5 * f64::from(stage));
                    let (x, v) = (0.05 * (1.0 - (10.0 * t).cos()), 0.5 * (10.0 * t).sin());
                    let still = StateRecord { id: 1, ..record(1.0, 0.0) };
                    solid.check(&[record(x, factor * v), still], 1e-3, (step, stage)).unwrap();
                    remarks.extend(solid.remark());
                }
            }
            assert_eq!(remarks.len(), usize::from(told.is_some()), "{factor}: {remarks:?}");
            assert!(told.is_none_or(|told| remarks[0].contains(told)), "{factor}: {remarks:?}");
        }
    }

    #[test]
    fn masses_stay() {
        let mut solid = Continuity::new(&scene(), 0, true);
        let heavy = |mass| StateRecord { mass, ..record(0.0, 0.0) };
        solid.check(&[heavy(2.0)], 0.01, (0, 0)).unwrap();
        solid.check(&[heavy(2.0 + 1e-10)], 0.01, (0, 1)).unwrap();
        let other = solid.check(&[heavy(2.1)], 0.01, (5, 0)).map_err(|e| e.to_string());
        assert!(other.is_err_and(|said| said.contains("a mass of 2.1 at step 5 and of 2 before")));
    }

    #[test]
    fn particles_stay_as_many_and_where_their_velocities_take_them() {
        let scene = scene();
        let reach = 0.6 * scene.smoothing_ratio * 0.1;
        let new = |external| Continuity::new(&scene, 0, external);
        let mut solid = new(true);
        // 0.01 s at 2 m/s explain 0.04 m at most.
        for (x, step) in [(0.0, 0), (reach + 0.039, 1), (0.0, 2)] {
            solid.check(&[record(x, 2.0)], 0.01, (step, 0)).unwrap_or_else(|e| panic!("{e}"));
        }
        let far = solid.check(&[record(reach + 0.041, 2.0)], 0.01, (3, 0)).map_err(|e| e.to_string());
        assert!(far.is_err_and(|said| said.contains("at step 3") && said.contains("2.000e0 m/s")));
        let mut own = new(false);
        own.check(&[record(0.0, 0.0)], 0.01, (0, 0)).unwrap_or_else(|e| panic!("{e}"));
        own.check(&[record(9.0, 0.0)], 0.01, (0, 0)).unwrap_or_else(|e| panic!("{e}"));
        let more = own.check(&[record(0.0, 0.0), record(1.0, 0.0)], 0.01, (7, 0)).map_err(|e| e.to_string());
        assert!(more.is_err_and(|said| said.contains("2 interface particles at step 7 and 1 before")));
        assert!(matches!(new(true).check(&[], 0.01, (0, 0)), Err(RunError::NoParticles { .. })));
    }
}
