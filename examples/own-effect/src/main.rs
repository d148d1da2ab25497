//! A program with an effect of its own: two particles slide past each other and drag each other along.
//!
//! `laminar_viscosity.rs` holds all of the effect. `Fluid::with_effect` adds it to those of halfstep, and the fluid's
//! passes are compiled with it in this crate.

mod laminar_viscosity;

use halfstep_coupling::clock::Clock;
use halfstep_coupling::error::RunError;
use halfstep_coupling::recorder::Recorder;
use halfstep_coupling::solo::run_solo;
use halfstep_fluid::Fluid;
use halfstep_fluid::effects::FluidEffect;
use halfstep_role::lockstep::Member;
use halfstep_scene::{self as scene, Scene};
use halfstep_sph::lane::Isa;
use halfstep_wire::protocol::StateHeader;
use laminar_viscosity::LaminarViscosity;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Two particles of 1 kg/m beside each other, 0.1 m apart, with no velocity along their distance: neither pressure nor
/// artificial viscosity acts.
const TWO_PARTICLES: &str = r#"
    resolution = 0.1
    smoothing_ratio = 1.25
    end_time = 0.01
    time_step = 1e-4
    gravity = [0.0, 0.0]
    [fluid]
    density = 100.0
    sound_speed = 10.0
    [[shape]]
    name = "left"
    phase = "fluid"
    box = { min = [0.0, 0.0], max = [0.1, 0.1] }
    velocity = [0.0, 1e-6]
    [[shape]]
    name = "right"
    phase = "fluid"
    box = { min = [0.1, 0.0], max = [0.2, 0.1] }
    velocity = [0.0, -1e-6]
"#;

/// Runs a scene without solid to its end with one more effect; returns the fluid's last message.
fn run<X: FluidEffect<2> + 'static>(scene: &Scene, effect: X) -> Result<StateHeader, RunError> {
    let folder = tempfile::tempdir().map_err(|e| RunError::System(e.to_string()))?;
    let fluid = Fluid::with_effect(scene, Isa::detect(), effect)
        .ok_or_else(|| RunError::System("the scene has no fluid".into()))?;
    let member = Member { role: Box::new(fluid), frames: None };
    let mut recorder = Recorder::new(scene, &folder.path().join("probes.csv"), true)?;
    let never = AtomicBool::new(false);
    let outcome = run_solo(vec![member], &mut Clock::new(scene), &mut recorder, &never)?;
    Ok(outcome.last[0])
}

/// Speed of each of two particles of 1 kg/m that have the kinetic energy alike, m/s.
fn speed(last: &StateHeader) -> f64 {
    last.audit.kinetic_energy.sqrt()
}

fn two_particles() -> miette::Result<Scene> {
    Ok(scene::parse(TWO_PARTICLES, Path::new("two-particles.toml"), &[])?)
}

fn main() -> miette::Result<()> {
    let scene = two_particles()?;
    for viscosity in [0.0, 1.0, 10.0, 100.0] {
        let last = run(&scene, LaminarViscosity { viscosity }).map_err(|e| miette::miette!("{e}"))?;
        let speed = speed(&last);
        println!("mu = {viscosity:5} Pa s: speed after {} s: {speed:.6e} m/s", scene.end_time);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfstep_fluid::rates::{FluidPair, PairEffect, PairRates};
    use halfstep_role::role::Role;
    use halfstep_scene::Decision;
    use halfstep_sph::lane::Arch;
    use std::collections::BTreeSet;

    #[test]
    fn the_speed_decays_as_by_hand() {
        // F of the cubic spline at q = 0.1 / 0.125 = 0.8: 10 / (7 pi h²) (-3 + 2.25 q) / h²
        //   = 10 / (7 pi 0.125⁴) (-1.2) = -2235.1 1/m⁴.
        // The difference of the velocities has the rate 2 m 2 mu / rho² F: lambda = 4 (1 kg/m) (10 Pa s) / (100 kg/m³)²
        // (-2235.1 1/m⁴) = -8.9404 1/s; after 0.01 s it is exp(-0.089404) = 0.914476 of what it was.
        let last = run(&two_particles().unwrap(), LaminarViscosity { viscosity: 10.0 }).unwrap();
        // Both particles have half of the difference: the energy is 2 (1/2) (1 kg/m) v².
        assert!((speed(&last) / 1e-6 - 0.914_476).abs() < 1e-5, "{:e}", speed(&last));
        let momentum = last.audit.momentum[1];
        assert!(momentum.abs() < 1e-20, "{momentum:e}");
    }

    /// Takes part in every pair and adds nothing.
    #[derive(Clone, Copy)]
    struct Nothing;

    impl FluidEffect<2> for Nothing {
        const NAME: &'static str = "nothing";
        type Pair<'a> = Self;
        type AtWall<'a> = Self;
        fn decide(_: &Scene) -> Decision {
            Decision { name: "nothing", on: true, why: "always".into() }
        }
        fn pair(&self) -> Option<Self> {
            Some(*self)
        }
        fn at_wall(&self) -> Option<Self> {
            Some(*self)
        }
    }

    impl PairEffect<2> for Nothing {
        type Own = ();
        fn own(&self, _: usize) {}
        fn add<A: Arch>(&self, _: &(), _: usize, _: &FluidPair<2>, _: &mut PairRates<2>) {}
    }

    fn composition<X: FluidEffect<2>>(scene: &Scene, effect: X) -> String {
        let mut fluid = Fluid::with_effect(scene, Isa::detect(), effect).unwrap();
        fluid.own_sums();
        fluid.composition().unwrap().to_owned()
    }

    #[test]
    fn the_complete_law_gives_the_bits_of_the_compositions() {
        let tank = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/hydrostatic-tank.toml");
        let mut found = BTreeSet::new();
        for diffusion in ["none", "simple", "hydrostatic", "delta-sph"] {
            for viscosity in ["off", "on"] {
                let overrides = [
                    "end_time=0.002".to_owned(),
                    "shape.water.velocity=[0.3, -0.2]".into(),
                    "fluid.viscosity=1".into(),
                    format!("effects.viscosity={viscosity}"),
                    format!("fluid.density_diffusion={diffusion}"),
                ];
                let scene = scene::load(&tank, &overrides).unwrap();
                let (complete, chosen) = (run(&scene, Nothing).unwrap(), run(&scene, ()).unwrap());
                assert_eq!(composition(&scene, Nothing), "complete law");
                assert_ne!(composition(&scene, ()), "complete law");
                assert_eq!(complete.state_hash, chosen.state_hash, "{}", composition(&scene, ()));
                found.insert(chosen.state_hash);
            }
        }
        assert_eq!(found.len(), 8, "each effect changes the state");
    }
}
