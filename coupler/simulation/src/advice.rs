//! What to change in a scene whose run diverged.

use halfstep_coupling::clock::{Clock, above_limit};
use halfstep_scene::{Scene, Shape, TimeStep};
use halfstep_sph::Phase;
use halfstep_wire::Name;
use halfstep_wire::failure::{Diverged, Quantity};

/// The keys to change, with their present values. `external`: the solids that other programs compute.
pub(crate) fn advice(diverged: &Diverged, scene: &Scene, clock: &Clock, external: &[Name]) -> String {
    let name = diverged.participant;
    let of_solid = scene.solids.iter().any(|solid| solid.name == name.as_str());
    let phase = if of_solid { Phase::Solid } else { Phase::Fluid };
    // The diverged participant's own limit says more than another's.
    let exceeded = clock.exceeded();
    if let (TimeStep::Fixed(dt), Some(limit)) =
        (scene.time_step, exceeded.max_by_key(|limit| limit.participant == name))
    {
        let above = above_limit(dt, limit.participant.as_str(), limit.dt);
        return format!("{above}: choose a smaller one or time_step = \"auto\"");
    }
    if external.contains(&name) {
        return format!("the {name} is not this program's: look at what its process does");
    }
    let section = match scene.solids.as_slice() {
        [_] => "solid".to_owned(),
        _ => format!("solid.{name}"),
    };
    let rigid = scene.solids.iter().any(|solid| solid.name == name.as_str() && solid.rigid().is_some());
    let change = match (scene.time_step, phase) {
        (TimeStep::Fixed(dt), _) => {
            format!("choose a smaller time_step than {dt:.4e} s, although it is within the stability limits")
        }
        // A rigid body has no waves; the water that goes along with a light one needs the fluid's shorter step.
        (TimeStep::Auto, Phase::Solid) if rigid && scene.fluid.is_some() => {
            format!("lower numerics.cfl (now {})", scene.numerics.cfl)
        }
        (TimeStep::Auto, Phase::Solid) if rigid => "choose a time_step".into(),
        (TimeStep::Auto, Phase::Solid) => {
            format!("lower numerics.solid_cfl (now {})", scene.numerics.solid_cfl)
        }
        (TimeStep::Auto, _) => format!("lower numerics.cfl (now {})", scene.numerics.cfl),
    };
    let breaks = scene.solids.iter().any(|solid| solid.name == name.as_str() && solid.fracture().is_some());
    let of_it = |shape: &&Shape| {
        let solid = shape.solid.map(|k| &scene.solids[k]);
        shape.load.is_some() && solid.is_some_and(|solid| solid.name == name.as_str())
    };
    let loaded = scene.shapes.iter().find(of_it).map(|shape| &shape.name);
    match (diverged.quantity, phase) {
        (Quantity::Density, Phase::Solid) if breaks => format!(
            "it breaks ({section}.fracture): where debris is squeezed between others a smaller step seldom helps; look \
             at the last frames, and raise {section}.fracture.energy or {section}.youngs_modulus; or {change}"
        ),
        (Quantity::Speed, Phase::Solid) if let Some(loaded) = loaded.filter(|_| breaks) => format!(
            "it may break ({section}.fracture), and the load of `{loaded}` goes on pulling at what has broken off: let \
             the run end before (end_time), or {change}"
        ),
        (Quantity::TimeStep, _) => {
            "the time steps that the phases allow became too small to reach end_time: \
            look at the last frames for what goes wrong before"
                .into()
        }
        _ if rigid => change,
        (Quantity::Energy, Phase::Solid) => {
            format!("{change}; or raise {section}.artificial_viscosity: the last frames show where it moves")
        }
        (Quantity::Energy, _) => {
            format!(
                "{change}; or raise fluid.artificial_viscosity.linear: the last frames show where it moves"
            )
        }
        (Quantity::Density, Phase::Solid) => {
            format!("{change}; or the load is too much for {section}.youngs_modulus")
        }
        (Quantity::Density, Phase::Fluid) if let Some(fluid) = &scene.fluid => format!(
            "{change}; or raise fluid.sound_speed (now {:.4} m/s): beside it water that meets water or a wall is too \
             fast",
            fluid.sound_speed
        ),
        _ => change,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use halfstep_coupling::clock::Limit;
    use halfstep_scene::{self as scene, Fracture, ModelKeys};
    use halfstep_wire::half_step::Stage;
    use std::path::Path;

    const DIVERGED: Diverged = Diverged {
        participant: Name::SOLID,
        particle: 3,
        quantity: Quantity::Speed,
        value: 300.0,
        step: 7,
        stage: Stage::First,
        position: [0.0; 3],
    };

    fn scene(time_step: &str) -> Scene {
        let text = include_str!("../../../scenes/elastic-gate.toml");
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/elastic-gate.toml"));
        scene::parse(text, path, &[format!("time_step={time_step}")]).unwrap()
    }

    /// With these limits told before.
    fn advised(scene: &Scene, fluid: f64, solid: f64, diverged: &Diverged) -> String {
        let mut clock = Clock::new(scene);
        let limits =
            [(Name::FLUID, fluid), (Name::SOLID, solid)].map(|(participant, dt)| Limit { participant, dt });
        clock.tick(&limits, false).unwrap();
        advice(diverged, scene, &clock, &[])
    }

    #[test]
    fn a_fixed_step_is_held_to_the_limit_that_it_exceeds() {
        let scene = scene("1e-5");
        for (fluid, solid, named) in [(2e-5, 4e-6, "solid"), (9e-6, 4e-6, "solid"), (9e-6, 1e-3, "fluid")] {
            let text = advised(&scene, fluid, solid, &DIVERGED);
            assert!(text.contains("time_step = 1.0000e-5 s is above") && text.contains(named), "{text}");
        }
        let text = advised(&scene, 2e-5, 2e-5, &DIVERGED);
        assert!(text.contains("smaller time_step") && text.contains("within"), "{text}");
    }

    #[test]
    fn a_rigid_body_has_no_courant_number_of_its_own() {
        let rigid = |fluid: &str, shape: &str| {
            let text = format!(
                "resolution = 0.01\nend_time = 1.0\n{fluid}[solid]\nmodel = \"rigid\"\ndensity = 10.0\n{shape}\
                 [[shape]]\nname = \"box\"\nphase = \"solid\"\nbox = {{ min = [0.0, 0.0], max = [0.1, 0.1] }}\n"
            );
            scene::parse(&text, Path::new("box.toml"), &[]).unwrap()
        };
        let water =
            "[[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.2, 0.0], max = [0.3, 0.1] }\n";
        let floating = advised(&rigid("[fluid]\ndensity = 1000.0\n", water), 1e-5, 1e-5, &DIVERGED);
        assert_eq!(floating, "lower numerics.cfl (now 0.6)");
        assert_eq!(advised(&rigid("", ""), 1e-5, 1e-5, &DIVERGED), "choose a time_step");
    }

    #[test]
    fn without_a_fixed_step_the_courant_numbers_are_the_keys() {
        let scene = scene("auto");
        assert!(advised(&scene, 1e-5, 1e-5, &DIVERGED).contains("numerics.solid_cfl (now 0.6)"));
        let fluid = Diverged { participant: Name::FLUID, ..DIVERGED };
        assert!(advised(&scene, 1e-5, 1e-5, &fluid).contains("numerics.cfl (now 0.4)"));
        let torn = advised(&scene, 1e-5, 1e-5, &Diverged { quantity: Quantity::Density, ..fluid });
        assert!(torn.contains("numerics.cfl (now 0.4); or raise fluid.sound_speed (now 16.57"), "{torn}");
        let hot = Diverged { quantity: Quantity::Energy, ..fluid };
        assert!(advised(&scene, 1e-5, 1e-5, &hot).contains("fluid.artificial_viscosity.linear"));
        let dense = Diverged { quantity: Quantity::Density, ..DIVERGED };
        assert!(advised(&scene, 1e-5, 1e-5, &dense).contains("solid.youngs_modulus"));
        let mut brittle = scene;
        let ModelKeys::TotalLagrangian(keys) = &mut brittle.solids[0].model else { panic!("a plate") };
        keys.fracture = Some(Fracture { strength: 1e5, energy: 10.0, friction: 0.0 });
        assert!(advised(&brittle, 1e-5, 1e-5, &dense).contains("raise solid.fracture.energy"));
        assert!(!advised(&brittle, 1e-5, 1e-5, &DIVERGED).contains("broken off"));
        let plate = brittle.shapes.iter_mut().find(|shape| shape.phase == scene::Phase::Solid).unwrap();
        let within = plate.clamp[0];
        plate.load = Some(scene::Traction { within, traction: [0.0, -1e5, 0.0], ramp: 0.0 });
        let pulled = advised(&brittle, 1e-5, 1e-5, &DIVERGED);
        assert!(pulled.contains("the load of `plate` goes on pulling at what has broken off"), "{pulled}");
    }
}
