//! Fluids to measure, and a clock that takes medians.

use halfstep_fluid::Fluid;
use halfstep_shared::lane::Isa;
use halfstep_shared::role::Role;
use halfstep_shared::scene::{self, Scene};
use std::path::Path;

/// Settings of the fluid step that the targets are stated for: pressure, artificial viscosity, simple diffusion.
pub(crate) const LEAN: &[&str] = &["fluid.density_diffusion=simple", "numerics.kernel=wendland-c2"];

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

/// The same water, 100 wide and 140 high, beside an empty half of its tank: it collapses and splashes up the far wall.
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

/// A fluid on its way.
pub(crate) struct Running {
    pub(crate) fluid: Fluid<2>,
    step: u64,
}

impl Running {
    pub(crate) fn new(scene: &Scene, isa: Isa) -> Self {
        Self { fluid: Fluid::new(scene, isa).expect("a fluid"), step: 0 }
    }

    pub(crate) fn particles(&self) -> f64 {
        self.fluid.particles() as f64
    }

    /// One step of two stages; returns its length, s.
    pub(crate) fn step(&mut self) -> f64 {
        let dt = self.fluid.dt_limit();
        for stage in 0..2 {
            self.fluid.publish(&[], &mut Vec::new());
            self.fluid.own_sums();
            self.fluid.advance(self.step, stage, dt, &[]).expect("a stable flow");
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

/// Seconds of each piece of work, the pieces in turn, `rounds` times: the medians.
pub(crate) fn medians(rounds: usize, work: &mut [Box<dyn FnMut() + '_>]) -> Vec<f64> {
    let mut seconds = vec![Vec::with_capacity(rounds); work.len()];
    for _ in 0..rounds {
        for (piece, seconds) in work.iter_mut().zip(&mut seconds) {
            let start = clock();
            piece();
            seconds.push(clock() - start);
        }
    }
    seconds.into_iter().map(median).collect()
}

/// CPU seconds of this thread: on a machine that others use, what the work itself took.
fn clock() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the pointer is to a live timespec.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut time) };
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}
