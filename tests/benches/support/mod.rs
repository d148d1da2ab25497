//! Fluids and solids to measure, clocks that take medians, and the file of all figures.
// The benchmarks share this; each uses a part.
#![allow(dead_code)]

pub(crate) mod naive;
pub(crate) mod raw;

use halfstep_fluid::composition::{Pass, Shares};
use halfstep_fluid::effects::artificial_viscosity::ArtificialViscosity;
use halfstep_fluid::effects::density_diffusion::{Diffusion, Simple, Strength};
use halfstep_fluid::equations::Both;
use halfstep_fluid::rates::{PairEffect, RateLaw, RateSum};
use halfstep_role::awake::Awake;
use halfstep_role::role::Role;
use halfstep_scene::{self as scene, ArtificialViscosity as Coefficients, Scene};
use halfstep_sph::kernel::{Kernel, WendlandC2};
use halfstep_sph::lane::{Isa, LANES, Precision};
use halfstep_sph::neighbours::PADDING;
use halfstep_sph::pair;
use halfstep_tests::patch;
use halfstep_tests::process::cpu_seconds;
use halfstep_wire::half_step::HalfStep;
use serde_json::{Map, Value};
use std::path::Path;
use std::time::Instant;

/// Settings that the targets of the fluid step are stated for: pressure, artificial viscosity, simple diffusion.
pub(crate) const LEAN: &[&str] = &["fluid.density_diffusion=simple", "numerics.kernel=wendland-c2"];

/// With LEAN: the narrow kernel of water beside a solid of the base method, without shifting.
pub(crate) const NARROW: &[&str] = &["smoothing_ratio=1.33", "effects.particle-shifting=off"];

/// Water 1.4 times as wide as high, at rest in a tank, with about `particles` particles.
pub(crate) fn tank(particles: usize, overrides: &[&str]) -> Scene {
    let high = (particles as f64 / 1.4).sqrt().round();
    let (width, height) = (1.4 * high * 1e-3, high * 1e-3);
    parse(
        &format!(
            "resolution = 0.001\nend_time = 10.0\ngravity = [0.0, -9.81]\n[fluid]\ndensity = 1000.0\n\
             [[shape]]\nname = \"water\"\nphase = \"fluid\"\npressure = \"hydrostatic\"\n\
             box = {{ min = [0.0, 0.0], max = [{width}, {height}] }}\n\
             [[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
             tank = {{ min = [0.0, 0.0], max = [{width}, {top}], open = [\"top\"] }}\n",
            top = 1.2 * height
        ),
        overrides,
    )
}

/// 14 000 particles, 100 wide and 140 high, beside the empty rest of their tank: they collapse and splash up its wall.
pub(crate) fn collapse(overrides: &[&str]) -> Scene {
    parse(
        "resolution = 0.001\nend_time = 10.0\ngravity = [0.0, -9.81]\n[fluid]\ndensity = 1000.0\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\npressure = \"hydrostatic\"\n\
         box = { min = [0.0, 0.0], max = [0.1, 0.14] }\n\
         [[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
         tank = { min = [0.0, 0.0], max = [0.3, 0.3], open = [\"top\"] }\n",
        overrides,
    )
}

fn parse(text: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    scene::parse(text, Path::new("bench.toml"), &overrides).unwrap_or_else(|e| panic!("{e:?}"))
}

/// A role on its way, alone.
pub(crate) struct Running {
    role: Box<dyn Role>,
    step: u64,
    /// As in a run.
    awake: Awake,
}

impl Running {
    pub(crate) fn fluid(scene: &Scene, isa: Isa) -> Self {
        Self::of(halfstep_fluid::role(scene, isa).expect("a fluid"))
    }

    pub(crate) fn solid(scene: &Scene) -> Self {
        Self::of(halfstep_solid::role(scene, 0, Isa::preferred()).expect("a solid"))
    }

    fn of(role: Box<dyn Role>) -> Self {
        Self { role, step: 0, awake: Awake::default() }
    }

    pub(crate) fn particles(&self) -> f64 {
        self.role.particles() as f64
    }

    pub(crate) fn bytes_per_particle(&self) -> f64 {
        self.role.bytes().unwrap_or(0) as f64 / self.particles()
    }

    /// One step of two stages; returns its length, s.
    pub(crate) fn step(&mut self) -> f64 {
        let dt = self.role.dt_limit();
        for half_step in HalfStep::begin(self.step, 0.0).lasting(dt).both() {
            self.awake.wake();
            self.role.publish(&[], &mut Vec::new());
            self.role.own_sums();
            self.role.advance(&half_step, &[]).expect("a stable step");
        }
        self.step += 1;
        dt
    }

    /// Steps until `time`, s.
    pub(crate) fn run_until(&mut self, time: f64) {
        let mut t = 0.0;
        while t < time {
            t += self.step();
        }
    }
}

/// 14 000 particles on a disturbed lattice of spacing 1, as the engine and as the naive pass hold them.
pub(crate) struct Patch {
    sorted: patch::Patch,
    pub(crate) sums: Vec<RateSum<2>>,
    pub(crate) naive: Vec<naive::Particle>,
    pub(crate) grid: naive::Grid,
    pub(crate) pass: naive::Pass,
}

const H: f64 = 1.33;
const LINEAR: f64 = 1.0;
const DIFFUSION: f64 = 1.33;

impl Patch {
    pub(crate) fn new(isa: Isa) -> Self {
        Self::with_precision(isa, Precision::Double)
    }

    /// The same for passes of this precision.
    pub(crate) fn with_precision(isa: Isa, precision: Precision) -> Self {
        let particle = |k: usize| {
            let (i, j) = ((k % 140) as f64, (k / 140) as f64);
            patch::Particle {
                position: [2.0 + i + 0.2 * (0.7 * j).sin(), 2.0 + j + 0.2 * (1.3 * i).cos()],
                velocity: [(0.3 * j).sin(), (0.2 * i).cos()],
                density: 1.0 + 0.01 * (0.2 * i).cos(),
                pressure: 1.0 + (0.1 * i).sin(),
            }
        };
        let particles: Vec<patch::Particle> = (0..14_000).map(particle).collect();
        let naive: Vec<naive::Particle> = particles
            .iter()
            .map(|p| naive::Particle {
                position: p.position.into(),
                velocity: p.velocity.into(),
                density: p.density,
                pressure: p.pressure,
            })
            .collect();
        let sorted = patch::Patch::with_precision(&particles, 2.3 * H, isa, precision);
        let sums = vec![RateSum::default(); sorted.list.fours()];
        let grid = naive::Grid::new(&naive, 2.0 * H);
        let pass = naive::Pass { h: H, mass: 1.0, linear: LINEAR, diffusion: DIFFUSION };
        Self { sorted, sums, naive, grid, pass }
    }

    /// The effects of the pass.
    pub(crate) fn effects() -> impl Shares<2> {
        let coefficients = Coefficients { linear: 1.0, quadratic: 0.0 };
        let damping = ArtificialViscosity::<2>::new(coefficients, LINEAR, H);
        (Some(damping), (Some(Diffusion::<2>::Simple(Simple(Strength(DIFFUSION)))), ()))
    }

    /// Largest difference of the engine's accelerations from the naive pass's, over the largest acceleration.
    pub(crate) fn difference(&self) -> f64 {
        let rates = self.pass.run(&self.naive, &self.grid);
        let largest = rates.iter().map(|r| r.0.norm()).fold(0.0, f64::max);
        let mut worst = 0.0_f64;
        for (slot, &id) in self.sorted.id.iter().enumerate().filter(|&(_, &id)| id != PADDING) {
            let sum = &self.sums[slot / LANES];
            for d in 0..2 {
                worst = worst.max((sum.acceleration[d].0[slot % LANES] - rates[id as usize].0[d]).abs());
            }
        }
        worst / largest
    }
}

impl Pass<2> for &mut Patch {
    type Equations = Both;
    fn run<E: PairEffect<2>>(self, effects: E) {
        let shown = &self.sorted.shown;
        let law = RateLaw {
            equations: Both,
            kernel: WendlandC2::<2>::new(H),
            effects,
            targets: shown,
            sources: shown,
        };
        pair::pass(self.sorted.isa, &law, &self.sorted.list, &mut self.sums);
    }
}

/// Which clock.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Clock {
    /// CPU time of this thread: on a machine that others use, what the work itself took.
    Cpu,
    /// Time on the wall, for work on several threads.
    Wall,
}

/// Seconds of each piece of work, the pieces in turn, `rounds` times: the medians.
pub(crate) fn medians(clock: Clock, rounds: usize, work: &mut [Box<dyn FnMut() + '_>]) -> Vec<f64> {
    let mut seconds = vec![Vec::with_capacity(rounds); work.len()];
    for _ in 0..rounds {
        for (piece, seconds) in work.iter_mut().zip(&mut seconds) {
            let (wall, cpu) = (Instant::now(), cpu_seconds());
            piece();
            seconds.push(match clock {
                Clock::Cpu => cpu_seconds() - cpu,
                Clock::Wall => wall.elapsed().as_secs_f64(),
            });
        }
    }
    seconds.into_iter().map(median).collect()
}

pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Writes figures to `target/bench.json`, beside those of other benchmarks that are there.
pub(crate) fn store(figures: Map<String, Value>) {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../target/bench.json"));
    let stored = std::fs::read(path).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
    let mut all: Map<String, Value> = stored.unwrap_or_default();
    all.extend(figures);
    let text = format!("{:#}\n", Value::Object(all));
    let folder = path.parent().expect("a folder");
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(path, text))
        .expect("target/bench.json can be written");
    println!("\nwritten to target/bench.json");
}
