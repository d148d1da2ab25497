//! An effect that a scene does not call for costs nothing: no instruction in the pass, no memory.

use halfstep_fluid::Fluid;
use halfstep_role::role::Role;
use halfstep_scene as scene;
use halfstep_sph::lane::Isa;
use std::path::Path;
use std::process::Command;

/// Instructions of the pass on one thread with AVX2, counted by callgrind.
fn instructions(arguments: &[&str]) -> u64 {
    let folder = tempfile::tempdir().unwrap();
    let counts = folder.path().join("counts");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--collect-atstart=no", "--toggle-collect=*pair*run_avx2*"])
        .arg(format!("--callgrind-out-file={}", counts.display()))
        .arg(env!("CARGO_BIN_EXE_one-pass"))
        .args(arguments)
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .expect("valgrind runs (setup.sh installs it)");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(&counts).unwrap();
    let total = text.lines().find_map(|l| l.strip_prefix("totals: ")).expect("a line of totals");
    total.trim().parse().unwrap()
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
