//! An effect that a scene does not call for costs nothing: no instruction in the pass, no memory.

use halfstep_fluid::Fluid;
use halfstep_role::role::Role;
use halfstep_scene as scene;
use halfstep_sph::lane::Isa;
use halfstep_tests::run::{program, repository};
use std::path::Path;
use std::process::Command;

/// Instructions within functions of a name, counted by callgrind: on one thread with AVX2.
fn counted(functions: &[&str], program: &Path, arguments: &[&str]) -> u64 {
    let folder = tempfile::tempdir().unwrap();
    let counts = folder.path().join("counts");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--collect-atstart=no"])
        .args(functions.iter().map(|functions| format!("--toggle-collect={functions}")))
        .arg(format!("--callgrind-out-file={}", counts.display()))
        .arg(program)
        .args(arguments)
        .env("RAYON_NUM_THREADS", "1")
        .env("HALFSTEP_ISA", "avx2")
        .output()
        .expect("valgrind runs (setup.sh installs it)");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(&counts).unwrap();
    let total = text.lines().find_map(|l| l.strip_prefix("totals: ")).expect("a line of totals");
    total.trim().parse().unwrap()
}

/// Instructions of the fluid's pass.
fn instructions(arguments: &[&str]) -> u64 {
    counted(&["*pair*run_avx2*"], Path::new(env!("CARGO_BIN_EXE_one-pass")), arguments)
}

/// Instructions of a swinging plate's solid within functions of a name.
fn of_a_plate(functions: &[&str], overrides: &[&str]) -> u64 {
    let folder = tempfile::tempdir().unwrap();
    let (out, scene) = (folder.path().join("out"), repository().join("scenes/oscillating-plate.toml"));
    let (out, scene) = (out.display().to_string(), scene.display().to_string());
    let mut arguments = vec!["run", &scene, "--until", "0.0003", "--in-process", "--quiet", "--out", &out];
    for setting in ["resolution=0.0025"].iter().chain(overrides) {
        arguments.extend(["--set", setting]);
    }
    counted(functions, program(), &arguments)
}

#[test]
fn an_absent_effect_takes_no_instruction() {
    let mut counts = Vec::new();
    for composition in ["artificial-viscosity", "simple", "delta-sph"] {
        let (chosen, alone) = (instructions(&[composition, "chosen"]), instructions(&[composition, "alone"]));
        println!("{composition}: {chosen} instructions as chosen, {alone} alone");
        assert_eq!(chosen, alone, "{composition}");
        counts.push(chosen);
    }
    // The counter counts the pass: 1600 particles in 400 clusters with some 40 neighbours, 30 instructions or more
    // each.
    assert!(counts[0] > 400 * 40 * 30, "{counts:?}");
    assert!(counts[0] < counts[1] && counts[1] < counts[2], "each effect costs: {counts:?}");
}

fn bytes_per_particle(overrides: &[&str]) -> f64 {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/hydrostatic-tank.toml");
    let overrides: Vec<String> =
        ["resolution=0.0025"].iter().chain(overrides).map(|&o| o.to_owned()).collect();
    let scene = scene::load(&path, &overrides).unwrap();
    let mut fluid = Fluid::<2>::new(&scene, Isa::detect()).unwrap();
    fluid.own_sums();
    fluid.bytes().unwrap() as f64 / fluid.particles() as f64
}

#[test]
fn an_absent_effect_takes_no_memory() {
    // Per slot, padding included: two components of the density gradient; four of the stress. Padding and spare room
    // add up to 10 % here.
    let lean = bytes_per_particle(&["fluid.density_diffusion=simple"]);
    let full = bytes_per_particle(&["fluid.density_diffusion=delta-sph"]) - lean;
    assert!((16.0..17.6).contains(&full), "{full}");
    let viscous = &["fluid.density_diffusion=simple", "fluid.viscosity=1", "effects.viscosity=on"];
    let stress = bytes_per_particle(viscous) - lean;
    assert!((32.0..35.2).contains(&stress), "{stress}");
}

#[test]
fn an_absent_effect_of_a_solid_takes_no_instruction() {
    let off =
        ["wall-contact", "relaxation", "side-friction", "fracture"].map(|name| format!("effects.{name}=off"));
    for model in ["total-lagrangian", "finite-element"] {
        let model = format!("solid.model={model}");
        let forced: Vec<&str> = [model.as_str()].into_iter().chain(off.iter().map(String::as_str)).collect();
        let [absent, forced] =
            [&[model.as_str()], &forced[..]].map(|settings| of_a_plate(&["*SolidModel*advance*"], settings));
        println!("{model}: {absent} instructions absent, {forced} forced off");
        assert_eq!(absent, forced, "{model}");
        // Some 600 particles in ten steps of two stages.
        assert!(absent > 600 * 20 * 1000, "{absent}");
    }
}

/// Sub-steps and what is published of them: 1.03 measured. Nothing but water and other solids needs what is inside.
#[test]
fn a_solid_that_may_break_and_does_not_costs_five_per_cent_at_most() {
    let breakable = ["solid.fracture.strength=1e5", "solid.fracture.energy=50"];
    let [whole, breakable] = [&[][..], &breakable[..]]
        .map(|settings| of_a_plate(&["*SolidModel*advance*", "*SolidModel*records*"], settings));
    println!("{whole} instructions, {breakable} with fracture");
    assert!((1.0..1.05).contains(&(breakable as f64 / whole as f64)), "{whole} {breakable}");
}
