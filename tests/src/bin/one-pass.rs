//! Runs the fluid's rate pass once, for an instruction counter: `one-pass COMPOSITION chosen|alone`. `chosen` goes the
//! way of a run, from the list of effects to a compiled composition; `alone` is a pass that was never told of any other
//! effect.

use halfstep_fluid::composition::{Pass, Shares};
use halfstep_fluid::effects::artificial_viscosity::ArtificialViscosity;
use halfstep_fluid::effects::density_diffusion::{DeltaSph, Diffusion, Simple, Strength};
use halfstep_fluid::effects::viscosity::Viscosity;
use halfstep_fluid::rates::RateSum;
use halfstep_scene::ArtificialViscosity as Coefficients;
use halfstep_sph::lane::Isa;
use halfstep_tests::patch::{Particle, Patch, RatePass, SMOOTHING_LENGTH as H};
use std::process::ExitCode;

/// 1600 particles on a disturbed lattice.
fn patch() -> Patch {
    let particle = |k: usize| {
        let (i, j) = ((k % 40) as f64, (k / 40) as f64);
        Particle {
            position: [i + 0.2 * (0.7 * j).sin(), j + 0.2 * (1.3 * i).cos()],
            velocity: [(0.3 * j).sin(), 0.0],
            density: 1.0 + 0.01 * (0.2 * i).cos(),
            pressure: 1.0 + (0.1 * i).sin(),
        }
    };
    Patch::new(&(0..1600).map(particle).collect::<Vec<_>>(), 2.3 * H, Isa::detect())
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let patch = patch();
    let gradient = vec![[0.01, 0.02]; patch.id.len()];
    let mut sums = vec![RateSum::default(); patch.list.fours()];
    let pass = RatePass(&patch, &mut sums);
    let viscosity = ArtificialViscosity::new(Coefficients { linear: 0.1, quadratic: 0.0 }, 10.0, H);
    let simple = Simple(Strength(0.1));
    let full = DeltaSph { strength: Strength(0.1), gradient: &gradient };
    let chosen = |diffusion| (Some(viscosity), (diffusion, (None::<Viscosity<_>>, ())));
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["artificial-viscosity", "chosen"] => chosen(None).run(pass),
        ["artificial-viscosity", "alone"] => pass.run(viscosity),
        ["simple", "chosen"] => chosen(Some(Diffusion::Simple(simple))).run(pass),
        ["simple", "alone"] => pass.run((viscosity, simple)),
        ["delta-sph", "chosen"] => chosen(Some(Diffusion::DeltaSph(full))).run(pass),
        ["delta-sph", "alone"] => pass.run((viscosity, full)),
        ["complete"] => pass.run((Some(viscosity), (Some(Diffusion::Simple(simple)), ()))),
        _ => {
            eprintln!(
                "usage: one-pass artificial-viscosity|simple|delta-sph chosen|alone, or one-pass complete"
            );
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}
