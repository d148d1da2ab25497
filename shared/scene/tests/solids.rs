//! `[solid]` and `[[solid]]`: names, processes, who is made of what, and how the resolved scene says it.

use halfstep_scene::geometry::layout;
use halfstep_scene::{ModelKeys, Phase, Scene, SolidModelName, parse};
use proptest::prelude::*;
use std::path::Path;

const MATERIAL: &str = "density = 1100.0\nyoungs_modulus = 12e6\npoissons_ratio = 0.4\n";

/// Water between a gate and a lid, which two sections describe.
fn two() -> String {
    let shape = |name: &str, keys: &str, [left, right]: [f64; 2]| {
        let place = format!("box = {{ min = [{left}, 0.0], max = [{right}, 0.2] }}");
        format!("[[shape]]\nname = \"{name}\"\n{keys}\n{place}\n")
    };
    let probe = |name: &str, keys: &str| format!("[[probe]]\nname = \"{name}\"\n{keys}\n");
    [
        "resolution = 0.01\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n",
        &format!("[[solid]]\nname = \"gate\"\nprocess = \"own\"\n{MATERIAL}"),
        &format!("[[solid]]\nname = \"lid\"\nthreads = 3\nmodel = \"hypoelastic\"\n{MATERIAL}"),
        &shape("cover", "phase = \"solid\"\nsolid = \"lid\"", [0.5, 0.6]),
        &shape("water", "phase = \"fluid\"", [0.1, 0.5]),
        &shape("plate", "phase = \"solid\"\nsolid = \"gate\"", [0.0, 0.1]),
        &probe("near-gate", "kind = \"displacement\"\nat = [0.09, 0.1]"),
        &probe("beside-lid", "kind = \"displacement\"\nat = [0.49, 0.1]"),
        &probe("level", "kind = \"water-level\"\nx = 0.3"),
        &probe("pull", "kind = \"force\"\nsolid = \"lid\""),
        &probe("swing", "kind = \"kinetic-energy\"\nphase = \"solid\"\nsolid = \"gate\""),
        &probe("slosh", "kind = \"kinetic-energy\"\nphase = \"fluid\""),
    ]
    .concat()
}

/// A block and a disc of one material, under this heading.
fn one(heading: &str, disc: [f64; 2]) -> Scene {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\n{heading}\n{MATERIAL}\
         [[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = {{ min = [0.0, 0.0], max = [0.1, 0.07] }}\n\
         [[shape]]\nname = \"disc\"\nphase = \"solid\"\ndisc = {{ center = [{}, 0.1], radius = {} }}\n",
        disc[0], disc[1]
    );
    read(&text, &[])
}

fn read(text: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|o| o.to_string()).collect();
    parse(text, Path::new("s.toml"), &overrides).unwrap_or_else(|e| panic!("{:?}", miette::Report::new(e)))
}

#[test]
fn each_section_is_a_participant_with_a_process() {
    let scene = read(&two(), &["numerics.threads.solid=2"]);
    let all: Vec<_> = scene.participants().into_iter().map(|p| (p.id, p.phase, p.name, p.process)).collect();
    let want = [
        (0, Phase::Fluid, "fluid".into(), "fluid".into()),
        (1, Phase::Solid, "gate".into(), "gate".into()),
        (2, Phase::Solid, "lid".into(), "solid".into()),
    ];
    assert_eq!(all, want);
    assert_eq!(scene.solids.iter().map(|s| s.threads).collect::<Vec<_>>(), [2, 3]);
    let models = [SolidModelName::TotalLagrangian, SolidModelName::Hypoelastic];
    assert_eq!(scene.solids.iter().map(|s| s.model.name()).collect::<Vec<_>>(), models);
    let together = read(&two(), &["solid.gate.process=plates", "solid.lid.process=plates"]);
    assert!(together.solids.iter().all(|s| s.process == "plates"));
}

#[test]
fn shapes_and_probes_know_their_solid() {
    let scene = read(&two(), &[]);
    let of = |name: &str| scene.shapes.iter().find(|s| s.name == name).unwrap().solid;
    assert_eq!([of("cover"), of("water"), of("plate")], [Some(1), None, Some(0)]);
    let of: Vec<_> = scene.probes.iter().map(|p| (p.name.as_str(), p.solid)).collect();
    let want = [
        ("near-gate", Some(0)),
        ("beside-lid", Some(1)),
        ("level", None),
        ("pull", Some(1)),
        ("swing", Some(0)),
        ("slosh", None),
    ];
    assert_eq!(of, want);
}

#[test]
fn one_key_of_one_solid_is_an_override_away() {
    let scene = read(&two(), &["solid.lid.youngs_modulus=1e9"]);
    assert_eq!(scene.solids.iter().map(|s| s.youngs_modulus).collect::<Vec<_>>(), [12e6, 1e9]);
    assert_eq!(one("[solid]", [0.3, 0.05]).solids[0].name, "solid");
}

#[test]
fn run_json_has_an_object_for_one_solid_and_a_list_for_named_ones() {
    let json = |scene: &Scene| {
        let text = scene.to_json().unwrap();
        assert_eq!(&Scene::from_json(&text).unwrap(), scene);
        serde_json::from_str::<serde_json::Value>(&text).unwrap()["solid"].clone()
    };
    assert_eq!(json(&one("[solid]", [0.3, 0.05]))["density"], 1100.0);
    assert_eq!(json(&one("[[solid]]\nname = \"gate\"", [0.3, 0.05]))[0]["name"], "gate");
    assert_eq!(json(&read(&two(), &[]))[1]["density"], 1100.0);
    let water = "resolution = 0.01\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
                 phase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.1, 0.1] }\n";
    assert!(json(&read(water, &[])).is_null());
}

proptest! {
    #[test]
    fn a_solids_numbers_pass_through_json_bit_for_bit(modulus in prop::num::f64::POSITIVE, alpha in 0.0..10.0_f64) {
        let mut scene = one("[solid]", [0.3, 0.05]);
        scene.solids[0].youngs_modulus = modulus;
        let ModelKeys::TotalLagrangian(keys) = &mut scene.solids[0].model else { unreachable!("the default") };
        keys.hourglass = Some(alpha);
        let back = Scene::from_json(&scene.to_json().unwrap()).unwrap();
        prop_assert_eq!(back.solids[0].youngs_modulus.to_bits(), modulus.to_bits());
        prop_assert_eq!(&back, &scene);
    }

    #[test]
    fn a_list_of_one_solid_is_the_scene_of_a_single_section(x in -0.2..0.4_f64, radius in 0.02..0.1_f64) {
        let plain = one("[solid]", [x, radius]);
        let mut listed = one("[[solid]]\nname = \"gate\"", [x, radius]);
        prop_assert_eq!(layout::<2>(&plain), layout::<2>(&listed));
        listed.solids[0].name = "solid".into();
        prop_assert_eq!(plain, listed);
    }
}

/// How hard a wall pushes what rubs on it follows from speeds, of which such a scene has none.
#[test]
fn contact_without_any_speed_is_refused() {
    let text = |contact: &str, gravity: f64| {
        format!(
            "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, {gravity}]\n[solid]\n{MATERIAL}{contact}\n\
             [[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = {{ min = [0.0, 0.0], max = [0.1, 0.07] }}\n\
             [[shape]]\nname = \"floor\"\nphase = \"wall\"\nbox = {{ min = [0.0, -0.05], max = [0.1, 0.0] }}\n"
        )
    };
    let of = |contact: &str, gravity: f64| parse(&text(contact, gravity), Path::new("s.toml"), &[]);
    assert!(of("", 0.0).is_ok());
    let held = of("contact = { friction = 0.3 }", -9.81).expect("a right scene");
    assert!(held.leaves_walls_to_coupler(0) && held.solids[0].contact().expect("said").friction == 0.3);
    let errors = of("contact = { friction = 0.3 }", 0.0).expect_err("no speed");
    let told: Vec<String> = errors.problems.iter().map(|p| p.to_string()).collect();
    assert_eq!(told.len(), 1);
    assert!(told[0].contains("solid.contact") && told[0].contains("says nothing of walls"), "{told:?}");
    // A clamped block touches only walls that say so: `contact` then has nothing to speak of, which a run warns of.
    let clamp = ", max = [0.1, 0.07] }\nclamp = { min = [0.0, 0.0], max = [0.1, 0.02] }\n";
    let text = text("contact = { friction = 0.3 }", 0.0).replace(", max = [0.1, 0.07] }\n", clamp);
    let held = parse(&text, Path::new("s.toml"), &[]).expect("no wall that it may touch");
    assert!(held.walls_to_touch().next().is_none() && held.leaves_walls_to_coupler(0));
}
