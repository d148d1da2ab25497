//! Several solids in a scene: each is computed by itself.

use halfstep_role::role::Role;
use halfstep_scene::bounds::Bounds;
use halfstep_scene::{EffectName, Scene, parse};
use halfstep_solid::{Solid, effects};
use halfstep_sph::lane::Isa;
use halfstep_wire::half_step::HalfStep;
use std::path::Path;

const GATE: &str = "density = 1000.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n";
const LID: &str = "model = \"hypoelastic\"\ndensity = 2000.0\nyoungs_modulus = 4e6\npoissons_ratio = 0.3\n";

fn scene(parts: &[&str]) -> Scene {
    let top = "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, -10.0]\n\
               numerics.domain = { min = [-1.0, -1.0], max = [2.0, 2.0] }\n";
    parse(&format!("{top}{}", parts.concat()), Path::new("s.toml"), &[]).expect("a right scene")
}

/// A block that swings, and touches the next one to the right.
fn block(name: &str, solid: &str, left: f64) -> String {
    let right = left + 0.1;
    format!(
        "[[shape]]\nname = \"{name}\"\nphase = \"solid\"\n{solid}\nbox = {{ min = [{left}, 0.0], max = [{right}, 0.2] }}\n\
         clamp = {{ min = [{left}, 0.0], max = [{right}, 0.02] }}\nvelocity = [1.0, 0.0]\n"
    )
}

fn two() -> Scene {
    let [gate, lid] = [("gate", GATE), ("lid", LID)].map(|(n, m)| format!("[[solid]]\nname = \"{n}\"\n{m}"));
    let [plate, cover] = [block("plate", "solid = \"gate\"", 0.0), block("cover", "solid = \"lid\"", 0.1)];
    scene(&[&gate, &lid, &cover, &plate])
}

/// Hash of all particles after ten steps, and how many they are.
fn after_ten_steps(scene: &Scene, solid: usize) -> (u64, u64) {
    let mut solid = Solid::<2>::new(scene, solid, Isa::detect()).expect("a solid");
    for step in 0..10 {
        for half_step in HalfStep::begin(step, 0.0).lasting(2e-5).both() {
            solid.advance(&half_step, &[]).expect("within bounds");
        }
    }
    (solid.particles(), solid.state_hash())
}

#[test]
fn a_solid_beside_another_computes_as_if_alone() {
    let both = two();
    for (k, (material, left)) in [(GATE, 0.0), (LID, 0.1)].into_iter().enumerate() {
        let alone = scene(&["[solid]\n", material, &block("alone", "", left)]);
        let (n, hash) = after_ten_steps(&alone, 0);
        assert_eq!(n, 200);
        assert_eq!(after_ten_steps(&both, k), (n, hash));
    }
    assert!(Solid::<2>::new(&both, 2, Isa::detect()).is_none());
}

#[test]
fn a_list_of_one_solid_computes_as_a_single_section() {
    let of = |heading: &str| scene(&[heading, GATE, &block("a", "", 0.0), &block("b", "", 0.1)]);
    let [plain, listed] = [of("[solid]\n"), of("[[solid]]\nname = \"gate\"\n")];
    assert_eq!(after_ten_steps(&plain, 0), after_ten_steps(&listed, 0));
}

#[test]
fn bounds_and_effects_are_each_solids_own() {
    let scene = two();
    let density = |k| Bounds::of_solid(&scene, k).map(|b| b.density);
    assert_eq!([density(0), density(1), density(2)], [Some(1000.0), Some(2000.0), None]);
    let on = |k, effect| effects::decision(&scene, k, effect).on;
    assert!(on(0, EffectName::ClampFace) && !on(1, EffectName::ClampFace));
    assert!(!on(0, EffectName::ArtificialStress) && on(1, EffectName::ArtificialStress));
    let summary = effects::decide(&scene);
    let of = |effect: EffectName| summary.iter().find(|d| d.name == effect.name()).unwrap();
    assert!(of(EffectName::ClampFace).on && of(EffectName::ClampFace).why.starts_with("gate: "));
    assert_eq!(of(EffectName::WallContact).why, "no wall has contact = true");
}
