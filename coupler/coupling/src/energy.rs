//! Energy that nothing explains: the bound on a whole phase, where those on its particles do not see a slow blow-up.
//!
//! ```text
//! growth = (E - E(0) - G - W) / S,    E kinetic and stored energy,  G work of gravity,  W work of the other phase
//! S      = |E(0)| + max |G| + max |W| + m U² / 2
//! ```
//!
//! S is the energy in play, U the speed that the flow is expected to reach ([`flow_speed`]). Every sum is there anyway:
//! G follows from the momenta (dG/dt = g . P), W from the forces on the solid over the ways of its particles.
//! Dissipation makes growth negative. Above [`LIMIT`] or [`SOLID_LIMIT`] for [`PATIENCE`] states the run ends: a fast
//! blow-up leaves the bounds of a particle before that, and a particle says more.
//!
//! The walls of a scene must be at rest for the fluid to be judged, a solid's clamps, what its joints tie it to, and
//! the walls that may push it for the solid. An external solid's energy is not known. With the phase-blind interface
//! the fluid strains the solid as well, so both are judged as one.

use halfstep_output::run_json::EnergyGrowth;
use halfstep_scene::bounds::flow_speed;
use halfstep_scene::{Gravity, Phase, Scene, Treatment};
use halfstep_wire::Name;
use halfstep_wire::failure::{Diverged, Quantity};
use halfstep_wire::half_step::Stage;
use halfstep_wire::protocol::Audit;
use halfstep_wire::state::{Fields, State, StateError};

/// Largest growth of the fluid: a tenth of the energy in play.
pub const LIMIT: f64 = 0.1;

/// Largest growth of the solid: as much again. The hypoelastic one stores energy in stresses that belong to no
/// deformation, up to 0.1 in the elastic gate with two particles across.
pub const SOLID_LIMIT: f64 = 1.0;

/// States in a row above the limit.
pub const PATIENCE: u32 = 100;

/// One judged participant, or both phases as one.
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
    fn note(&mut self, limit: f64, sums: &Audit, work: f64, gravity: [f64; 3], dt: f64, speed: f64) {
        let energy = sums.kinetic_energy + sums.stored_energy;
        let start = *self.start.get_or_insert(energy);
        for d in 0..3 {
            let now = sums.momentum[d];
            self.gravity += 0.5 * dt * gravity[d] * (self.momentum[d] + now);
            self.momentum[d] = now;
        }
        self.other += work;
        self.most_gravity = self.most_gravity.max(self.gravity.abs());
        self.most_other = self.most_other.max(self.other.abs());
        let in_play = start.abs() + self.most_gravity + self.most_other + 0.5 * sums.mass * speed * speed;
        self.unexplained = energy - start - self.gravity - self.other;
        let growth = if in_play > 0.0 { self.unexplained / in_play } else { 0.0 };
        self.growth = self.growth.max(growth);
        self.above = if growth > limit { self.above + 1 } else { 0 };
    }

    fn excess(&self) -> Option<f64> {
        (self.above >= PATIENCE).then_some(self.unexplained)
    }
}

/// What a participant tells about the state at n.
#[derive(Clone, Copy, Debug)]
pub struct Account<'a> {
    /// Whose.
    pub name: Name,
    /// Its phase.
    pub phase: Phase,
    /// Its sums; `None` where they are not known.
    pub audit: Option<&'a Audit>,
    /// Work of the fluid on this solid since the last state, J; 0 for a fluid.
    pub work: f64,
    /// Work of other solids on this one since the last state, J.
    pub contact: f64,
}

/// The ledgers of a run.
#[derive(Clone, Debug)]
pub struct EnergyBalance {
    gravity: Gravity,
    speed: f64,
    /// Both phases as one.
    joint: bool,
    walls_rest: bool,
    /// Solids whose clamps or joints move: what that takes or gives is not counted.
    driven: Vec<String>,
    time: f64,
    /// Those that were judged, with phase and ledger.
    ledgers: Vec<(Name, Phase, Ledger)>,
}

/// Names of the solids with clamps or joints that move, and of all where a wall that moves may push them.
fn driven(scene: &Scene) -> Vec<String> {
    let pushed = scene.shapes.iter().any(|s| s.phase == Phase::Wall && s.contact && s.motion.is_some());
    let moves = |k: usize| {
        let of = |s: &&halfstep_scene::Shape| s.solid == Some(k);
        scene
            .shapes
            .iter()
            .filter(of)
            .any(|s| s.motion.is_some() || !s.clamp_with.is_empty() || s.load.is_some())
    };
    let moving = |name: &str| scene.shapes.iter().any(|s| s.name == name && s.motion.is_some());
    let tied = |k: usize| {
        scene.solids[k].rigid().is_some_and(|keys| keys.joints.iter().any(|joint| moving(&joint.with)))
    };
    let solids = scene.solids.iter().enumerate().filter(|(k, _)| pushed || moves(*k) || tied(*k));
    solids.map(|(_, solid)| solid.name.clone()).collect()
}

impl EnergyBalance {
    /// For a scene.
    pub fn new(scene: &Scene) -> Self {
        let moves = |s: &halfstep_scene::Shape| s.motion.is_some() || s.velocity != [0.0; 3];
        Self {
            gravity: Gravity::of(scene),
            speed: flow_speed(scene),
            joint: scene.interface.treatment == Treatment::PhaseBlind,
            walls_rest: !scene.shapes.iter().any(|s| s.phase == Phase::Wall && moves(s)),
            driven: driven(scene),
            time: 0.0,
            ledgers: Vec::new(),
        }
    }

    /// Takes the accounts of the state at a time, s, in the order of the participants. Returns whose energy nothing
    /// explains, and how much of it, J.
    pub fn note(&mut self, time: f64, accounts: &[Account<'_>]) -> Option<(Name, f64)> {
        let dt = time - self.time;
        let gravity = self.gravity.at(self.time + 0.5 * dt);
        self.time = time;
        let speed = self.speed;
        if let (true, [Account { audit: Some(f), .. }, Account { audit: Some(s), .. }]) =
            (self.joint, accounts)
        {
            let both = Audit {
                momentum: std::array::from_fn(|d| f.momentum[d] + s.momentum[d]),
                kinetic_energy: f.kinetic_energy + s.kinetic_energy,
                mass: f.mass + s.mass,
                stored_energy: f.stored_energy + s.stored_energy,
                ..Audit::default()
            };
            if !self.walls_rest {
                return None;
            }
            let ledger = self.ledger(Name::COUPLER, Phase::Fluid);
            ledger.note(SOLID_LIMIT, &both, 0.0, gravity, dt, speed);
            return ledger.excess().map(|joules| (Name::COUPLER, joules));
        }
        let on_solids: f64 = accounts.iter().map(|account| account.work).sum();
        for Account { name, phase, audit, work, contact } in accounts {
            let judged = match phase {
                Phase::Solid => !self.driven.iter().any(|driven| driven == name.as_str()),
                _ => self.walls_rest,
            };
            let Some(sums) = audit.filter(|_| judged) else { continue };
            let (limit, work) = match phase {
                Phase::Solid => (SOLID_LIMIT, *work + *contact),
                _ => (LIMIT, -on_solids),
            };
            self.ledger(*name, *phase).note(limit, sums, work, gravity, dt, speed);
        }
        self.ledgers.iter().find_map(|(name, _, ledger)| Some((*name, ledger.excess()?)))
    }

    fn ledger(&mut self, name: Name, phase: Phase) -> &mut Ledger {
        let place = self.ledgers.iter().position(|(known, ..)| *known == name).unwrap_or_else(|| {
            self.ledgers.push((name, phase, Ledger::default()));
            self.ledgers.len() - 1
        });
        &mut self.ledgers[place].2
    }

    /// Largest growth of a participant so far; `None` where it is not judged by itself.
    pub fn growth_of(&self, name: &str) -> Option<f64> {
        let own = self.ledgers.iter().find(|(known, ..)| known.as_str() == name);
        own.map(|(.., ledger)| ledger.growth)
    }

    /// Largest growth so far.
    pub fn growth(&self) -> EnergyGrowth {
        let of = |wanted: Phase| {
            let ledgers = self.ledgers.iter().filter(|(_, phase, _)| *phase == wanted);
            ledgers.map(|(.., ledger)| ledger.growth).reduce(f64::max)
        };
        EnergyGrowth { fluid: of(Phase::Fluid), solid: of(Phase::Solid) }
    }
}

impl State for Ledger {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.optional_real("start", &mut self.start)?;
        fields.vector("momentum", &mut self.momentum)?;
        fields.real("gravity", &mut self.gravity)?;
        fields.real("most_gravity", &mut self.most_gravity)?;
        fields.real("other", &mut self.other)?;
        fields.real("most_other", &mut self.most_other)?;
        fields.real("growth", &mut self.growth)?;
        fields.real("unexplained", &mut self.unexplained)?;
        fields.small_count("above", &mut self.above)
    }
}

impl State for EnergyBalance {
    fn fields(&mut self, fields: &mut Fields<'_>) -> Result<(), StateError> {
        fields.real("time", &mut self.time)?;
        let known: Vec<String> = self.ledgers.iter().map(|(name, ..)| name.to_string()).collect();
        let mut names = known.join(" ");
        // In the order in which they are judged.
        fields.text("names", &mut names)?;
        if fields.loading() {
            let ledger = |name: &str| {
                let name =
                    name.parse().map_err(|_| StateError::contradiction("a ledger of no participant"))?;
                let fluid = name == Name::FLUID || name == Name::COUPLER;
                Ok((name, if fluid { Phase::Fluid } else { Phase::Solid }, Ledger::default()))
            };
            self.ledgers = names.split_whitespace().map(ledger).collect::<Result<_, StateError>>()?;
        }
        let mut ledgers = self.ledgers.iter_mut();
        ledgers.try_for_each(|(name, _, ledger)| fields.part(name.as_str(), ledger))
    }
}

/// How the run says so.
pub(crate) fn diverged((participant, value): (Name, f64), step: u64) -> Diverged {
    Diverged {
        participant,
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

    fn sums(momentum: f64, kinetic: f64) -> Audit {
        Audit { momentum: [0.0, momentum, 0.0], kinetic_energy: kinetic, mass: 1000.0, ..Audit::default() }
    }

    fn of_fluid(audit: &Audit) -> Account<'_> {
        Account { name: Name::FLUID, phase: Phase::Fluid, audit: Some(audit), work: 0.0, contact: 0.0 }
    }

    fn of_solid(audit: &Audit, work: f64) -> Account<'_> {
        Account { name: Name::SOLID, phase: Phase::Solid, audit: Some(audit), work, contact: 0.0 }
    }

    /// A tonne that falls freely for a second: gravity explains all of it.
    #[test]
    fn free_fall_is_explained() {
        let mut balance = EnergyBalance::new(&scene(""));
        for k in 0..=100 {
            let t = 0.01 * f64::from(k);
            let v = 9.81 * t;
            assert_eq!(balance.note(t, &[of_fluid(&sums(-1000.0 * v, 500.0 * v * v))]), None);
        }
        assert!(balance.growth().fluid.unwrap() < 1e-9);
        assert_eq!(balance.growth().solid, None);
    }

    #[test]
    fn energy_from_nowhere_is_told() {
        let mut balance = EnergyBalance::new(&scene(""));
        // U: free fall through the domain, three times the box in each direction.
        let in_play = 0.5 * 1000.0 * 2.0 * 9.81 * 3.0;
        assert_eq!(balance.note(0.0, &[of_fluid(&sums(0.0, 0.0))]), None);
        let mut told = |share: f64| {
            let after = |k: &u32| {
                balance.note(0.1 + 1e-3 * f64::from(*k), &[of_fluid(&sums(0.0, share * in_play))]).is_some()
            };
            (1..=2 * PATIENCE).find(after)
        };
        assert_eq!(told(0.09), None);
        assert_eq!(told(0.11), Some(PATIENCE), "and not before");
        let (role, joules) = balance.note(0.3, &[of_fluid(&sums(0.0, 0.11 * in_play))]).unwrap();
        assert_eq!(role, Name::FLUID);
        assert!((joules / (0.11 * in_play) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_one_phase_gives_the_other_gets() {
        let mut balance = EnergyBalance::new(&scene(""));
        let heavy = sums(0.0, 1e6);
        let (cold, left) = (sums(0.0, 0.0), sums(0.0, 6e5));
        balance.note(0.0, &[of_fluid(&heavy), of_solid(&cold, 0.0)]);
        // 4e5 J go from the fluid to the solid.
        assert_eq!(balance.note(0.1, &[of_fluid(&left), of_solid(&sums(0.0, 4e5), 4e5)]), None);
        // The solid has them again, and nobody gave them.
        let hot = sums(0.0, 4e6);
        let told =
            (0..PATIENCE).fold(None, |_, _| balance.note(0.2, &[of_fluid(&left), of_solid(&hot, 0.0)]));
        assert_eq!(told.map(|(role, _)| role), Some(Name::SOLID));
    }

    /// A ram that touches the solid works on it; one that does not touch solids does not.
    #[test]
    fn a_wall_that_moves_may_push_a_solid() {
        let of = |contact: bool| {
            let ram = format!(
                "[solid]\ndensity = 1000.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n[[shape]]\nname = \"post\"\n\
                 phase = \"solid\"\nbox = {{ min = [2.0, 0.0], max = [2.4, 1.0] }}\n\
                 clamp = {{ min = [2.0, 0.0], max = [2.4, 0.2] }}\n[[shape]]\nname = \"ram\"\nphase = \"wall\"\n\
                 contact = {contact}\nbox = {{ min = [3.0, 0.0], max = [3.5, 1.0] }}\n\
                 motion = {{ velocity = [-1.0, 0.0] }}\n"
            );
            let mut balance = EnergyBalance::new(&scene(&ram));
            let (cold, hot) = (sums(0.0, 0.0), sums(0.0, 1e9));
            balance.note(0.0, &[of_fluid(&cold), of_solid(&cold, 0.0)]);
            let note = |_| balance.note(0.1, &[of_fluid(&cold), of_solid(&hot, 0.0)]);
            (0..=PATIENCE).map(note).any(|told| told.is_some())
        };
        assert!(!of(true));
        assert!(of(false));
    }

    #[test]
    fn a_joint_to_a_wall_that_moves_may_do_work() {
        let of = |with: &str| {
            let hub = format!(
                "[solid]\nmodel = \"rigid\"\ndensity = 1000.0\n\
                 joints = [{{ name = \"weld\", kind = \"fixed\", body = \"post\", with = \"{with}\" }}]\n\
                 [[shape]]\nname = \"post\"\nphase = \"solid\"\nbox = {{ min = [2.0, 0.0], max = [2.4, 1.0] }}\n\
                 [[shape]]\nname = \"hub\"\nphase = \"wall\"\ncontact = false\n\
                 box = {{ min = [3.0, 0.0], max = [3.5, 1.0] }}\nmotion = {{ velocity = [-1.0, 0.0] }}\n\
                 [[shape]]\nname = \"pillar\"\nphase = \"wall\"\ncontact = false\n\
                 box = {{ min = [3.6, 0.0], max = [4.0, 1.0] }}\n"
            );
            let mut balance = EnergyBalance::new(&scene(&hub));
            let (cold, hot) = (sums(0.0, 0.0), sums(0.0, 1e9));
            balance.note(0.0, &[of_fluid(&cold), of_solid(&cold, 0.0)]);
            let note = |_| balance.note(0.1, &[of_fluid(&cold), of_solid(&hot, 0.0)]);
            (0..=PATIENCE).map(note).any(|told| told.is_some())
        };
        assert!(!of("hub"));
        assert!(of("pillar"));
    }

    #[test]
    fn a_wall_that_moves_may_do_work() {
        let wall = "[[shape]]\nname = \"piston\"\nphase = \"wall\"\nbox = { min = [-0.5, 0.0], max = [-0.1, 1.0] }\n\
                    motion = { velocity = [1.0, 0.0] }\n";
        let mut balance = EnergyBalance::new(&scene(wall));
        balance.note(0.0, &[of_fluid(&sums(0.0, 0.0))]);
        assert!((0..=PATIENCE).all(|_| balance.note(0.1, &[of_fluid(&sums(0.0, 1e9))]).is_none()));
        assert_eq!(balance.growth().fluid, None);
    }
}
