//! A program with an effect of its own: two particles slide past each other and drag each other along.
//!
//! `laminar_viscosity.rs` holds all of the effect. `Simulation::effect` adds it to those of halfstep, and the
//! fluid's complete law is compiled with it in this crate.

mod laminar_viscosity;

use halfstep::{Error, FluidEffect, Running, Scene, Simulation, scene};
use laminar_viscosity::LaminarViscosity;
use std::path::Path;

/// Two particles of 1 kg/m beside each other, 0.1 m apart, with no velocity along their distance: neither pressure nor
/// artificial viscosity acts.
const TWO_PARTICLES: &str = r#"
    resolution = 0.1
    smoothing_ratio = 1.25
    end_time = 0.01
    time_step = 1e-4
    numerics.kernel = "cubic-spline"
    gravity = [0.0, 0.0]
    [fluid]
    density = 100.0
    sound_speed = 10.0
    time_integration = "midpoint"
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
    [[probe]]
    name = "both"
    kind = "kinetic-energy"
    phase = "fluid"
"#;

/// Speed of each of two particles of 1 kg/m that have the kinetic energy alike, m/s.
fn speed(run: &Running) -> f64 {
    run.probe("both.energy").unwrap_or(f64::NAN).sqrt()
}

fn two_particles() -> Result<Scene, Error> {
    Ok(scene::parse_with(TWO_PARTICLES, Path::new("two-particles.toml"), &[], &[laminar_viscosity::NAME])?)
}

/// The end of a run with one more effect.
fn end<X: FluidEffect<2>>(scene: &Scene, effect: X) -> Result<Running, Error> {
    let mut run = Simulation::new(scene.clone()).effect(effect).begin()?;
    while run.step()? {}
    Ok(run)
}

fn main() -> Result<(), Error> {
    let scene = two_particles()?;
    for viscosity in [0.0, 1.0, 10.0, 100.0] {
        let run = end(&scene, LaminarViscosity { viscosity })?;
        let speed = speed(&run);
        println!("mu = {viscosity:5} Pa s: speed after {} s: {speed:.6e} m/s", scene.end_time);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfstep_fluid::Fluid;
    use halfstep_fluid::rates::{FluidPair, PairEffect, PairRates};
    use halfstep_role::role::Role;
    use halfstep_scene::Decision;
    use halfstep_sph::lane::Isa;
    use halfstep_sph::lane::{Arch, Lanes};
    use std::collections::BTreeSet;

    #[test]
    fn the_speed_decays_as_by_hand() {
        // F of the cubic spline at q = 0.1 / 0.125 = 0.8: 10 / (7 pi h²) (-3 + 2.25 q) / h²
        //   = 10 / (7 pi 0.125⁴) (-1.2) = -2235.1 1/m⁴.
        // The difference of the velocities has the rate 2 m 2 mu / rho² F: lambda = 4 (1 kg/m) (10 Pa s) / (100 kg/m³)²
        // (-2235.1 1/m⁴) = -8.9404 1/s; after 0.01 s it is exp(-0.089404) = 0.914476 of what it was.
        let run = end(&two_particles().unwrap(), LaminarViscosity { viscosity: 10.0 }).unwrap();
        // Both particles have half of the difference: the energy is 2 (1/2) (1 kg/m) v².
        assert!((speed(&run) / 1e-6 - 0.914_476).abs() < 1e-5, "{:e}", speed(&run));
        let velocities = run.particles("fluid").unwrap().velocity;
        assert_eq!(velocities[0][1], -velocities[1][1], "action is reaction");
    }

    #[test]
    fn the_scene_switches_it_and_the_report_names_it() {
        let parse = |own: &[&str]| {
            let switch = ["effects.laminar-viscosity=off".to_owned()];
            scene::parse_with(TWO_PARTICLES, Path::new("two-particles.toml"), &switch, own)
        };
        let off = parse(&[laminar_viscosity::NAME]).unwrap();
        let effect = LaminarViscosity { viscosity: 10.0 };
        let row = |scene: &Scene| {
            let report = end(scene, effect).unwrap().finish().unwrap();
            report.effects.into_iter().find(|row| row.name == "laminar-viscosity").unwrap()
        };
        assert!(row(&two_particles().unwrap()).on);
        assert_eq!((row(&off).on, row(&off).why.as_str()), (false, "effects.laminar-viscosity is \"off\""));
        assert!(
            (speed(&end(&off, effect).unwrap()) / 1e-6 - 1.0).abs() < 1e-9,
            "without it nothing slows them"
        );
        // Who does not have the effect cannot read the scene, nor run it.
        assert_eq!(parse(&[]).unwrap_err().problems[0].reason, "unknown effect");
        let error = Simulation::new(off).begin().map(drop).unwrap_err();
        assert!(error.to_string().contains("effects.laminar-viscosity: the simulation has no such effect"));
    }

    /// Takes part in every pair, in the momentum equation or in both, and adds nothing.
    #[derive(Clone, Copy)]
    struct Nothing<const BOTH: bool>;

    impl<const BOTH: bool> FluidEffect<2> for Nothing<BOTH> {
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

    impl<const BOTH: bool> PairEffect<2> for Nothing<BOTH> {
        type Own<L: Lanes> = ();
        const CONTINUITY: bool = BOTH;
        fn own<L: Lanes>(&self, _: usize) {}
        fn add<A: Arch, L: Lanes>(&self, _: &(), _: usize, _: &FluidPair<2, L>, _: &mut PairRates<2, L>) {}
    }

    fn composition<X: FluidEffect<2>>(scene: &Scene, effect: X) -> String {
        let mut fluid = Fluid::with_effect(scene, Isa::detect(), effect).unwrap();
        fluid.own_sums();
        fluid.composition().unwrap().to_owned()
    }

    fn hash<X: FluidEffect<2>>(scene: &Scene, effect: X) -> String {
        let report = end(scene, effect).unwrap().finish().unwrap();
        report.audit.state_hash.unwrap()
    }

    #[test]
    fn the_complete_law_gives_the_bits_of_the_compositions() {
        let tank = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/hydrostatic-tank.toml");
        let mut found = BTreeSet::new();
        for diffusion in ["none", "simple", "hydrostatic", "delta-sph"] {
            for (viscosity, rule) in
                [("off", "verlet"), ("on", "verlet"), ("off", "midpoint"), ("on", "midpoint")]
            {
                let overrides = [
                    "end_time=0.002".to_owned(),
                    "shape.water.velocity=[0.3, -0.2]".into(),
                    "fluid.viscosity=1".into(),
                    format!("fluid.time_integration={rule}"),
                    format!("effects.viscosity={viscosity}"),
                    format!("fluid.density_diffusion={diffusion}"),
                ];
                let scene = scene::load(&tank, &overrides).unwrap();
                let chosen = hash(&scene, ());
                assert_eq!(composition(&scene, Nothing::<true>), "complete law");
                assert_ne!(composition(&scene, ()), "complete law");
                assert_eq!(hash(&scene, Nothing::<true>), chosen, "{}", composition(&scene, ()));
                assert_eq!(hash(&scene, Nothing::<false>), chosen, "{}", composition(&scene, ()));
                found.insert(chosen);
            }
        }
        assert_eq!(found.len(), 16, "each effect changes the state");
    }
}
