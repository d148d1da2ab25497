//! The scenes that come with the program load, and their particles are where their comments say.

use halfstep_scene::geometry::{estimate, layout};
use halfstep_scene::{DensityDiffusion, EffectName, FluidIntegration, Scene, Switch, Treatment, load, parse};
use std::path::{Path, PathBuf};

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

fn shipped(name: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|o| o.to_string()).collect();
    let path = scenes().join(name).with_extension("toml");
    load(&path, &overrides).unwrap_or_else(|errors| panic!("{:?}", miette::Report::new(errors)))
}

#[test]
fn every_shipped_scene_loads_and_survives_json() {
    let mut found = 0;
    for entry in std::fs::read_dir(scenes()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let scene = shipped(&name, &[]);
        assert_eq!(scene.name, name);
        assert!(!scene.probes.is_empty(), "{name} measures nothing");
        assert!(!scene.metrics.is_empty(), "{name} has nothing to compare");
        assert_eq!(Scene::from_json(&scene.to_json().unwrap()).unwrap(), scene, "{name}");
        let (counts, layout) = (estimate(&scene), layout::<2>(&scene));
        let placed = layout.fluid.len() + layout.solid.len() + layout.wall.len();
        let ratio = placed as f64 / counts.total() as f64;
        assert!((0.95..1.02).contains(&ratio), "{name}: {ratio}");
        found += 1;
    }
    assert!(found >= 10, "{found} scenes");
}

#[test]
fn the_gates_plate_is_5_across_and_clamped_above_its_free_length() {
    let scene = shipped("elastic-gate", &[]);
    let layout = layout::<2>(&scene);
    assert_eq!(layout.fluid.len(), 100 * 140);
    assert_eq!(layout.solid.len(), 5 * 99);
    assert_eq!(layout.solid.iter().filter(|p| p.clamped).count(), 5 * 20);
    assert!(layout.solid.iter().all(|p| p.clamped == (p.position[1] > 0.079)));
    assert!(scene.walls_to_touch().next().is_none());
    // Water up to the plate's top and above: every wall it sees on the right turns its x component.
    let facing = layout
        .wall
        .iter()
        .filter(|p| (0.1..0.1027).contains(&p.position[0]) && (0.099..0.15).contains(&p.position[1]));
    let normals: Vec<_> = facing.map(|p| (p.normal, p.corner)).collect();
    assert_eq!(normals.len(), 3 * 51);
    assert!(normals.iter().all(|n| *n == ([-1.0, 0.0], false)));
}

#[test]
fn the_gates_other_thickness_is_one_override_away() {
    let solid = layout::<2>(&shipped("elastic-gate", &["shape.plate.box.max=[0.106,0.099]"])).solid;
    assert_eq!(solid.len(), 6 * 99);
    assert_eq!(solid.iter().filter(|p| p.clamped).count(), 6 * 20);
}

#[test]
fn the_demo_resolution_has_two_particles_across() {
    let scene = shipped("elastic-gate", &["resolution=0.0025"]);
    let layout = layout::<2>(&scene);
    assert_eq!(layout.fluid.len(), 40 * 56);
    assert_eq!(layout.solid.iter().filter(|p| p.position[1] < 0.0025).count(), 2);
}

#[test]
fn the_presets_counts_are_the_papers() {
    let scene = shipped("dam-break-plate", &["preset=kayaki"]);
    assert_eq!(scene.interface.treatment, Treatment::PhaseBlind);
    let layout = layout::<2>(&scene);
    assert_eq!((layout.fluid.len(), layout.solid.len()), (72 * 145, 5 * 47));
    let gate = shipped("elastic-gate", &["preset=kayaki", "shape.plate.box.max=[0.106,0.099]"]);
    let row = halfstep_scene::geometry::layout::<2>(&gate).solid;
    assert_eq!(row.iter().filter(|p| p.position[1] < 0.0015).count(), 5);
}

#[test]
fn a_preset_forces_effects_and_keys_override_it() {
    let switch = |overrides: &[&str]| shipped("elastic-gate", overrides).switch(EffectName::FrozenDiffusion);
    assert_eq!(switch(&[]), Switch::Auto);
    assert_eq!(switch(&["preset=kayaki"]), Switch::Off);
    assert_eq!(switch(&["preset=kayaki", "effects.frozen-diffusion=on"]), Switch::On);
}

/// h / dx, A, C near by and its reach: water alone has a wide kernel, with a solid it has not; free bodies ride on
/// waves; and what is said holds.
#[test]
fn the_kernels_width_follows_from_solids_and_the_rest_from_the_width() {
    let values = |name: &str, overrides: &[&str]| {
        let scene = shipped(name, overrides);
        let linear = scene.fluid.as_ref().expect("water").artificial_viscosity.linear;
        [
            scene.smoothing_ratio,
            linear,
            scene.interface.cross_viscosity,
            scene.interface.cross_viscosity_reach,
        ]
    };
    assert_eq!(values("hydrostatic-tank", &[]), [2.0, 0.02, 4.0, 1.0]);
    assert_eq!(values("hydrostatic-tank", &["smoothing_ratio=1.5"]), [1.5, 0.05, 1.0, 1.25]);
    assert_eq!(values("hydrostatic-tank", &["smoothing_ratio=1.75"]), [1.75, 0.02, 4.0, 1.0]);
    assert_eq!(values("hydrostatic-tank", &["fluid.artificial_viscosity.linear=0.1"]), [2.0, 0.1, 4.0, 1.0]);
    for name in ["spring-block", "floating-box"] {
        assert_eq!(values(name, &[]), [1.5, 0.02, 1.0, 1.0]);
        assert_eq!(values(name, &["preset=waves"]), [2.0, 0.02, 4.0, 1.0]);
    }
    // Held at its root, a plate has the longer reach.
    assert_eq!(values("elastic-gate", &[])[2..], [1.0, 1.25]);
    assert_eq!(values("floating-box", &["interface.cross_viscosity_reach=1.5"])[3], 1.5);
    assert_eq!(values("hydrostatic-tank", &["preset=kayaki"]), [1.33, 1.0, 1.0, 1.25]);
    assert_eq!(values("hydrostatic-tank", &["preset=kayaki", "smoothing_ratio=2.0"]), [2.0, 1.0, 1.0, 1.0]);
    let diffusion = |name: &str, overrides: &[&str]| {
        shipped(name, overrides).fluid.as_ref().expect("water").density_diffusion
    };
    for name in ["dam-break", "floating-box", "elastic-gate"] {
        assert_eq!(diffusion(name, &[]), DensityDiffusion::Hydrostatic, "{name}");
    }
    for name in ["dam-break", "elastic-gate"] {
        assert_eq!(diffusion(name, &["preset=kayaki"]), DensityDiffusion::DeltaSph, "{name}");
    }
}

/// Position Verlet, with its longer steps, where no solid strains; what is said holds.
#[test]
fn the_rule_of_time_integration_follows_from_the_solids() {
    use FluidIntegration::{Midpoint, Verlet};
    let rule = |name: &str, overrides: &[&str]| {
        let scene = shipped(name, overrides);
        (scene.fluid.as_ref().expect("water").time_integration, scene.numerics.cfl)
    };
    for name in ["hydrostatic-tank", "taylor-green", "floating-box", "block-wall"] {
        assert_eq!(rule(name, &[]), (Verlet, 0.6), "{name}");
        assert_eq!(rule(name, &["fluid.time_integration=midpoint"]), (Midpoint, 0.4), "{name}");
    }
    // The last one's solid is of another program.
    for name in ["elastic-gate", "two-plates", "tsunami-wall", "gate-lift", "spring-block"] {
        assert_eq!(rule(name, &[]), (Midpoint, 0.4), "{name}");
        assert_eq!(rule(name, &["fluid.time_integration=verlet"]), (Verlet, 0.4), "{name}");
    }
    assert_eq!(rule("hydrostatic-tank", &["numerics.cfl=0.3"]), (Verlet, 0.3));
    // Contact of two solids is the softer the longer a step is.
    let block = |name: &str, x: f64| {
        format!(
            "[[solid]]\nname = \"{name}\"\nmodel = \"rigid\"\ndensity = 500.0\n[[shape]]\nname = \"{name}\"\n\
             phase = \"solid\"\nsolid = \"{name}\"\nbox = {{ min = [{x}, 0.3], max = [{}, 0.4] }}\n",
            x + 0.1
        )
    };
    let water = "resolution = 0.01\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
        phase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.6, 0.3] }\n";
    for (blocks, expected) in
        [(block("a", 0.1), (Verlet, 0.6)), (block("a", 0.1) + &block("b", 0.3), (Midpoint, 0.4))]
    {
        let scene = parse(&(water.to_owned() + &blocks), Path::new("rafts.toml"), &[]);
        let scene = scene.unwrap_or_else(|errors| panic!("{:?}", miette::Report::new(errors)));
        assert_eq!((scene.fluid.expect("water").time_integration, scene.numerics.cfl), expected);
    }
    for more in ["preset=kayaki", "interface.treatment=phase-blind"] {
        assert_eq!(rule("hydrostatic-tank", &[more]), (Midpoint, 0.4), "{more}");
    }
    assert_eq!(rule("dam-break-plate", &["preset=kayaki"]), (Midpoint, 0.4));
}

#[test]
fn the_dam_breaks_plate_takes_the_floors_place() {
    let layout = layout::<2>(&shipped("dam-break-plate", &[]));
    assert_eq!(layout.solid.len(), 6 * 48);
    assert_eq!(layout.solid.iter().filter(|p| p.clamped).count(), 6 * 8);
    let under = |x: f64| (0.286..0.298).contains(&x);
    assert!(!layout.wall.iter().any(|p| under(p.position[0])));
}

#[test]
fn references_are_read_from_their_files_in_the_probes_unit() {
    let gate = shipped("elastic-gate", &[]);
    assert_eq!(gate.references[0].probe, "tip.x");
    assert_eq!(gate.references[0].points.len(), 9);
    assert_eq!(gate.references[0].points[3], [0.16, 46.4 * 0.001]);
    assert_eq!(gate.references[1].points[3], [0.16, 17.1 * 0.001]);
}

#[test]
fn the_sound_speed_is_ten_times_that_of_a_fall_through_the_water() {
    let fluid = shipped("elastic-gate", &[]).fluid.unwrap();
    assert!((fluid.sound_speed - 10.0 * (2.0_f64 * 9.81 * 0.14).sqrt()).abs() < 1e-12);
    let fast = shipped("elastic-gate", &["shape.water.velocity=[3,4]"]).fluid.unwrap();
    assert_eq!(fast.sound_speed, 50.0);
}

/// A box without extent beside another one of its body is refused, and nobody waits for the plate that both are.
#[test]
fn a_box_without_extent_beside_another_one_of_its_body_is_refused() {
    for end in ["0.12", "0.1200000001"] {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\n[solid]\ndensity = 800.0\nyoungs_modulus = 1e7\n\
             poissons_ratio = 0.3\n[[shape]]\nname = \"a\"\nphase = \"solid\"\nbody = \"b\"\n\
             box = {{ min = [0.1, 0.0], max = [0.12, 0.2] }}\n[[shape]]\nname = \"c\"\nphase = \"solid\"\n\
             body = \"b\"\nbox = {{ min = [0.12, 0.0], max = [{end}, 0.2] }}\n"
        );
        assert!(parse(&text, Path::new("thin.toml"), &[]).is_err(), "{end}");
    }
}

/// Water that falls on a solid, and a body that falls into water: each is as fast as its fall makes it.
#[test]
fn the_sound_speed_knows_what_falls() {
    let sound_speed = |shapes: &str| {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, -9.81]\n[fluid]\ndensity = 1000.0\n[solid]\n\
             density = 800.0\nyoungs_modulus = 1e7\npoissons_ratio = 0.3\n{shapes}"
        );
        parse(&text, Path::new("falls.toml"), &[])
            .unwrap_or_else(|e| panic!("{e:?}"))
            .fluid
            .unwrap()
            .sound_speed
    };
    let beam = "[[shape]]\nname = \"beam\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.5, 0.04] }\n\
        clamp = { min = [0.0, 0.0], max = [0.05, 0.04] }\n[[shape]]\nname = \"water\"\nphase = \"fluid\"\n\
        box = { min = [0.2, 0.6], max = [0.4, 0.75] }\n";
    assert!((sound_speed(beam) - 10.0 * (2.0_f64 * 9.81 * 0.71).sqrt()).abs() < 1e-12);
    let block = "[[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = { min = [0.4, 1.1], max = [0.6, 1.2] }\n\
        [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [1.0, 0.1] }\n";
    assert!((sound_speed(block) - 10.0 * (2.0_f64 * 9.81).sqrt()).abs() < 1e-12);
    let held = block.replace("[0.6, 1.2] }", "[0.6, 1.2] }\nclamp = { min = [0.4, 1.1], max = [0.6, 1.2] }");
    assert!((sound_speed(&held) - 10.0 * (2.0_f64 * 9.81 * 0.1).sqrt()).abs() < 1e-12);
}

/// A bar of 0.2 m x 0.04 m that turns about its middle, about a hinge at its end, and as it goes.
#[test]
fn the_sound_speed_knows_what_turns() {
    let sound_speed = |keys: &str, velocity: f64| {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, -9.81]\n[fluid]\ndensity = 1000.0\n[solid]\n\
             model = \"rigid\"\ndensity = 800.0\n{keys}\n[[solid.bodies]]\nname = \"bar\"\n\
             angular_velocity = 50.0\n[[shape]]\nname = \"bar\"\nphase = \"solid\"\n\
             box = {{ min = [0.1, 0.13], max = [0.3, 0.17] }}\nvelocity = [{velocity}, 0.0]\n[[shape]]\n\
             name = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.4, 0.1] }}\n"
        );
        let scene = parse(&text, Path::new("turns.toml"), &[]);
        scene.unwrap_or_else(|e| panic!("{e:?}")).fluid.expect("water").sound_speed
    };
    let corner = |x: f64, y: f64| x.hypot(y);
    assert!((sound_speed("", 0.0) - 500.0 * corner(0.1, 0.02)).abs() < 1e-9);
    assert!((sound_speed("", 1.0) - 10.0 - 500.0 * corner(0.1, 0.02)).abs() < 1e-9);
    let hinge = "joints = [{ name = \"pin\", kind = \"hinge\", body = \"bar\", at = [0.1, 0.15] }]";
    assert!((sound_speed(hinge, 0.0) - 500.0 * corner(0.2, 0.02)).abs() < 1e-9);
}

/// The hull lies over all of the box that a joint and a probe are about.
#[test]
fn a_body_without_a_particle_has_no_joints_and_no_probes() {
    let under = |heading: &str, more: &str| {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\n{heading}\nmodel = \"rigid\"\ndensity = 800.0\n{more}\n[[shape]]\n\
             name = \"hull\"\nphase = \"solid\"\nbox = {{ min = [0.0, 0.0], max = [0.3, 0.1] }}\n[[shape]]\n\
             name = \"box\"\nphase = \"solid\"\nbox = {{ min = [0.1, 0.02], max = [0.2, 0.08] }}\n"
        );
        parse(&text, Path::new("s.toml"), &[]).map_err(|errors| format!("{errors:?}"))
    };
    let scene = |more: &str| under("[solid]", more);
    assert!(scene("").is_ok());
    let joint = "joints = [{ name = \"pin\", kind = \"hinge\", body = \"box\", at = [0.15, 0.05] }]";
    let said =
        "is of `box`, which has no particle: shapes that come before it in the file, or voids, lie there";
    let found = scene(joint).expect_err("no body");
    assert!(found.contains(said) && found.contains("solid.joints.pin"), "{found}");
    let listed = under("[[solid]]\nname = \"boxes\"", joint).expect_err("no body");
    assert!(listed.contains("solid.boxes.joints.pin"), "{listed}");
    let probe = "[[probe]]\nname = \"place\"\nkind = \"body-position\"\nbody = \"box\"";
    let found = scene(probe).expect_err("no body");
    assert!(found.contains(said) && found.contains("probe.place"), "{found}");
    assert!(scene(&joint.replace("\"box\"", "\"hull\"")).is_ok());
}
