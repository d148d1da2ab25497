//! Energy that nothing explains: the bound on a whole phase, where those on its particles do not see a slow blow-up.
//!
//! ```text
//! growth = (E - E(0) - G - W) / S,    E kinetic and stored energy,  G work of gravity,  W work of the other phase
//! S      = |E(0)| + max |G| + max |W| + m U² / 2
//! ```
//!
//! S is the energy in play, U the speed that the flow is expected to reach ([`flow_speed`]). Every sum is there anyway: G
//! follows from the momenta (dG/dt = g . P), W from the forces on the solid over the ways of its particles. Dissipation
//! makes growth negative. Above [`LIMIT`] or [`SOLID_LIMIT`] for [`PATIENCE`] states the run ends: a fast blow-up leaves the bounds of a
//! particle before that, and a particle says more.
//!
//! The walls of a scene must be at rest for the fluid to be judged. A foreign solid's energy is not known. With the
//! phase-blind interface the fluid strains the solid as well, so both are judged as one.

use halfstep_output::run_json::EnergyGrowth;
use halfstep_role::role::audit;
use halfstep_scene::bounds::flow_speed;
use halfstep_scene::{Phase, Scene, Treatment};
use halfstep_wire::failure::{Diverged, Quantity, RoleName};
use halfstep_wire::half_step::Stage;

/// Largest growth of the fluid: a tenth of the energy in play.
pub const LIMIT: f64 = 0.1;

/// Largest growth of the solid: as much again. The hypoelastic one stores energy in stresses that belong to no
/// deformation, up to 0.1 in the elastic gate with two particles across.
pub const SOLID_LIMIT: f64 = 1.0;

/// States in a row above the limit.
pub const PATIENCE: u32 = 100;

/// One judged phase, or both as one.
#[derive(Clone, Copy, Debug, Default)]
struct Ledger {
    start: Option<f64>,
    momentum: [f64; 3],
    gravity: f64,
    most_gravity: f64,
    other: f64,
    most_other: f64,
    growth: f64,
    /// What nothing explains now, J.
    unexplained: f64,
    /// States in a row above the limit.
    above: u32,
}

impl Ledger {
    fn note(&mut self, limit: f64, sums: &[f64; 8], work: f64, gravity: [f64; 3], dt: f64, speed: f64) {
        let energy = sums[audit::KINETIC_ENERGY] + sums[audit::STORED_ENERGY];
        let start = *self.start.get_or_insert(energy);
        for d in 0..3 {
            let now = sums[audit::MOMENTUM + d];
            self.gravity += 0.5 * dt * gravity[d] * (self.momentum[d] + now);
            self.momentum[d] = now;
        }
        self.other += work;
        self.most_gravity = self.most_gravity.max(self.gravity.abs());
        self.most_other = self.most_other.max(self.other.abs());
        let in_play =
            start.abs() + self.most_gravity + self.most_other + 0.5 * sums[audit::MASS] * speed * speed;
        self.unexplained = energy - start - self.gravity - self.other;
        let growth = if in_play > 0.0 { self.unexplained / in_play } else { 0.0 };
        self.growth = self.growth.max(growth);
        self.above = if growth > limit { self.above + 1 } else { 0 };
    }

    fn excess(&self) -> Option<f64> {
        (self.above >= PATIENCE).then_some(self.unexplained)
    }
}

/// The ledgers of a run.
#[derive(Clone, Debug)]
pub struct EnergyBalance {
    gravity: [f64; 3],
    speed: f64,
    /// Both phases as one.
    joint: bool,
    walls_rest: bool,
    time: f64,
    fluid: Ledger,
    solid: Ledger,
    judged: [bool; 2],
}

impl EnergyBalance {
    /// For a scene.
    pub fn new(scene: &Scene) -> Self {
        let moves = |s: &halfstep_scene::Shape| s.motion.is_some() || s.velocity != [0.0; 3];
        Self {
            gravity: scene.gravity,
            speed: flow_speed(scene),
            joint: scene.interface.treatment == Treatment::PhaseBlind,
            walls_rest: !scene.shapes.iter().any(|s| s.phase == Phase::Wall && moves(s)),
            time: 0.0,
            fluid: Ledger::default(),
            solid: Ledger::default(),
            judged: [false; 2],
        }
    }

    /// Takes the sums of the state at a time, s, and the work done on the solid since the last one, J. `None` stands for
    /// a phase that is not there or cannot be judged.
    pub fn note(
        &mut self,
        time: f64,
        fluid: Option<&[f64; 8]>,
        solid: Option<&[f64; 8]>,
        work_on_solid: f64,
    ) -> Option<(RoleName, f64)> {
        let dt = time - self.time;
        self.time = time;
        let (gravity, speed) = (self.gravity, self.speed);
        if let (true, Some(f), Some(s)) = (self.joint, fluid, solid) {
            let both = std::array::from_fn(|k| f[k] + s[k]);
            if self.walls_rest {
                self.judged[0] = true;
                self.fluid.note(SOLID_LIMIT, &both, 0.0, gravity, dt, speed);
            }
            return self.fluid.excess().map(|joules| (RoleName::Coupler, joules));
        }
        if let Some(f) = fluid.filter(|_| self.walls_rest) {
            self.judged[0] = true;
            self.fluid.note(LIMIT, f, -work_on_solid, gravity, dt, speed);
        }
        if let Some(s) = solid {
            self.judged[1] = true;
            self.solid.note(SOLID_LIMIT, s, work_on_solid, gravity, dt, speed);
        }
        let ledgers = [(RoleName::Fluid, &self.fluid), (RoleName::Solid, &self.solid)];
        ledgers.into_iter().find_map(|(role, ledger)| Some((role, ledger.excess()?)))
    }

    /// Largest growth so far.
    pub fn growth(&self) -> EnergyGrowth {
        let of = |k: usize, ledger: &Ledger| self.judged[k].then_some(ledger.growth);
        EnergyGrowth { fluid: of(0, &self.fluid), solid: of(1, &self.solid) }
    }
}

/// How the run says so.
pub(crate) fn diverged((role, value): (RoleName, f64), step: u64) -> Diverged {
    Diverged {
        role,
        particle: 0,
        quantity: Quantity::Energy,
        value,
        step,
        stage: Stage::First,
        position: [0.0; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn scene(more: &str) -> Scene {
        let text = format!(
            "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
             phase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [1.0, 1.0] }}\n{more}"
        );
        halfstep_scene::parse(&text, Path::new("x.toml"), &[]).unwrap()
    }

    fn sums(momentum: f64, kinetic: f64) -> [f64; 8] {
        let mut sums = [0.0; 8];
        sums[audit::MOMENTUM + 1] = momentum;
        sums[audit::KINETIC_ENERGY] = kinetic;
        sums[audit::MASS] = 1000.0;
        sums
    }

    /// A tonne that falls freely for a second: gravity explains all of it.
    #[test]
    fn free_fall_is_explained() {
        let mut balance = EnergyBalance::new(&scene(""));
        for k in 0..=100 {
            let t = 0.01 * f64::from(k);
            let v = 9.81 * t;
            assert_eq!(balance.note(t, Some(&sums(-1000.0 * v, 500.0 * v * v)), None, 0.0), None);
        }
        assert!(balance.growth().fluid.unwrap() < 1e-9);
        assert_eq!(balance.growth().solid, None);
    }

    #[test]
    fn energy_from_nowhere_is_told() {
        let mut balance = EnergyBalance::new(&scene(""));
        // U: free fall through the domain, three times the box in each direction.
        let in_play = 0.5 * 1000.0 * 2.0 * 9.81 * 3.0;
        assert_eq!(balance.note(0.0, Some(&sums(0.0, 0.0)), None, 0.0), None);
        let mut told = |share: f64| {
            let after = |k: &u32| {
                balance
                    .note(0.1 + 1e-3 * f64::from(*k), Some(&sums(0.0, share * in_play)), None, 0.0)
                    .is_some()
            };
            (1..=2 * PATIENCE).find(after)
        };
        assert_eq!(told(0.09), None);
        assert_eq!(told(0.11), Some(PATIENCE), "and not before");
        let (role, joules) = balance.note(0.3, Some(&sums(0.0, 0.11 * in_play)), None, 0.0).unwrap();
        assert_eq!(role, RoleName::Fluid);
        assert!((joules / (0.11 * in_play) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_one_phase_gives_the_other_gets() {
        let mut balance = EnergyBalance::new(&scene(""));
        let heavy = sums(0.0, 1e6);
        balance.note(0.0, Some(&heavy), Some(&sums(0.0, 0.0)), 0.0);
        // 4e5 J go from the fluid to the solid.
        assert_eq!(balance.note(0.1, Some(&sums(0.0, 6e5)), Some(&sums(0.0, 4e5)), 4e5), None);
        // The solid has them again, and nobody gave them.
        let hot = sums(0.0, 4e6);
        let told = (0..PATIENCE).fold(None, |_, _| balance.note(0.2, Some(&sums(0.0, 6e5)), Some(&hot), 0.0));
        assert_eq!(told.map(|(role, _)| role), Some(RoleName::Solid));
    }

    #[test]
    fn a_wall_that_moves_may_do_work() {
        let wall = "[[shape]]\nname = \"piston\"\nphase = \"wall\"\nbox = { min = [-0.5, 0.0], max = [-0.1, 1.0] }\n\
                    motion = { velocity = [1.0, 0.0] }\n";
        let mut balance = EnergyBalance::new(&scene(wall));
        balance.note(0.0, Some(&sums(0.0, 0.0)), None, 0.0);
        assert!((0..=PATIENCE).all(|_| balance.note(0.1, Some(&sums(0.0, 1e9)), None, 0.0).is_none()));
        assert_eq!(balance.growth().fluid, None);
    }
}
