//! Runs the fluid's rate pass once, for an instruction counter: `one-pass COMPOSITION chosen|alone`. `chosen` goes the way
//! of a run, from the list of effects to a compiled composition; `alone` is a pass that was never told of any other
//! effect.

use halfstep_fluid::artificial_viscosity::ArtificialViscosity;
use halfstep_fluid::columns::{Shown, Source};
use halfstep_fluid::density_diffusion::{DeltaSph, Diffusion, Simple, Strength};
use halfstep_fluid::effects::{Effects, Pass};
use halfstep_fluid::rates::{PairEffect, RateLaw, RateSum};
use halfstep_shared::kernel::{CubicSpline, Kernel};
use halfstep_shared::lane::Isa;
use halfstep_shared::neighbours::{ClusterList, Rows};
use halfstep_shared::pair;
use halfstep_shared::scene::ArtificialViscosity as Coefficients;
use std::process::ExitCode;

const H: f64 = 1.33;

/// 1600 particles on a disturbed lattice.
struct Patch {
    shown: Shown<2>,
    list: ClusterList,
    gradient: Vec<[f64; 2]>,
}

impl Patch {
    fn new() -> Self {
        let n = 1600;
        let mut shown = Shown::<2>::new(n, 1.0);
        let mut pressure = vec![0.0; n];
        for k in 0..n {
            let (i, j) = ((k % 40) as f64, (k / 40) as f64);
            shown.position[0][k] = i + 0.2 * (0.7 * j).sin();
            shown.position[1][k] = j + 0.2 * (1.3 * i).cos();
            shown.velocity[0][k] = (0.3 * j).sin();
            shown.density[k] = 1.0 + 0.01 * (0.2 * i).cos();
            pressure[k] = 1.0 + (0.1 * i).sin();
        }
        let mut id: Vec<u32> = (0..n as u32).collect();
        let mut rows = Rows::<2>::default();
        rows.sort(&shown.position, &id, 2.0, [-1e3; 2], [1e3; 2]);
        let [x, y] = &mut shown.position;
        let [u, v] = &mut shown.velocity;
        for column in [x, y, u, v, &mut shown.density, &mut pressure] {
            rows.permute(column);
        }
        rows.permute_ids(&mut id);
        shown.sources.resize(id.len(), Source::ZERO);
        (0..id.len()).for_each(|slot| shown.show(slot, pressure[slot]));
        let mut list = ClusterList::default();
        list.build(&shown.position, &shown.position, &rows, 2.3 * H);
        let gradient = vec![[0.01, 0.02]; id.len()];
        Self { shown, list, gradient }
    }
}

struct Over<'a>(&'a Patch, &'a mut [RateSum<2>]);

impl Pass<2> for Over<'_> {
    fn run<E: PairEffect<2>>(self, effects: E) {
        let shown = &self.0.shown;
        let law = RateLaw { kernel: CubicSpline::<2>::new(H), effects, targets: shown, sources: shown };
        pair::pass(Isa::detect(), &law, &self.0.list, self.1);
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let patch = Patch::new();
    let mut sums = vec![RateSum::default(); patch.list.clusters()];
    let pass = Over(&patch, &mut sums);
    let damping = ArtificialViscosity::new(Coefficients { linear: 0.1, quadratic: 0.0 }, 10.0, H);
    let simple = Simple(Strength(0.1));
    let full = DeltaSph { strength: Strength(0.1), gradient: &patch.gradient };
    let chosen = |density_diffusion| {
        let mut effects = Effects::none();
        effects.artificial_viscosity = Some(damping);
        effects.density_diffusion = density_diffusion;
        effects
    };
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["damping", "chosen"] => println!("{}", chosen(None).composition(pass)),
        ["damping", "alone"] => pass.run(damping),
        ["simple", "chosen"] => println!("{}", chosen(Some(Diffusion::Simple(simple))).composition(pass)),
        ["simple", "alone"] => pass.run((damping, simple)),
        ["delta-sph", "chosen"] => println!("{}", chosen(Some(Diffusion::DeltaSph(full))).composition(pass)),
        ["delta-sph", "alone"] => pass.run((damping, full)),
        ["complete"] => pass.run((Some(damping), (Some(Diffusion::Simple(simple)), ()))),
        _ => {
            eprintln!("usage: one-pass damping|simple|delta-sph chosen|alone, or one-pass complete");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}
