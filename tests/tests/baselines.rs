//! Every shipped scene gives the bits that are stored for it. `make baselines` stores them anew.

use halfstep::isa::{self, ISA_VARIABLE};
use halfstep_sph::lane::Isa;
use halfstep_tests::baseline::{Baseline, baselines, leftovers, levels};
use halfstep_tests::run::repository;
use halfstep_tests::scene;

/// Runs a baseline at a level.
fn run(baseline: &Baseline, level: Isa) -> halfstep_tests::Finished {
    baseline.builder(level).run()
}

fn named(case: &str, name: &str) -> Baseline {
    let one = baselines().into_iter().find(|b| b.case == case && b.name == name);
    one.unwrap_or_else(|| panic!("{case} has no baseline {name}"))
}

/// Compares all runs with what is stored; with HALFSTEP_RENEW stores them and prints what changed.
#[test]
fn every_run_gives_the_stored_bits() {
    let renew = std::env::var_os("HALFSTEP_RENEW").is_some();
    let mut wrong = Vec::new();
    for level in levels() {
        for baseline in baselines() {
            let run = run(&baseline, level);
            let difference = baseline.difference(level, &baseline.record(level, &run));
            if renew && let Some(difference) = &difference {
                println!("stored anew: {difference}");
                baseline.store(level, &run);
            } else {
                wrong.extend(difference);
            }
        }
    }
    if renew && !levels().iter().any(|level| level.bits_name() == Isa::Avx2.bits_name()) {
        println!("the level `{}` was not renewed: this processor lacks it", Isa::Avx2.bits_name());
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_shipped_scene_has_a_baseline() {
    let all = baselines();
    let scenes = std::fs::read_dir(repository().join("scenes")).unwrap();
    let paths =
        scenes.map(|entry| entry.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "toml"));
    let names: Vec<String> = paths.map(|p| p.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    assert!(!names.is_empty());
    for name in names {
        assert!(
            all.iter().any(|b| b.case == name),
            "scenes/{name}.toml: write validation/{name}/baseline.toml"
        );
    }
}

#[test]
fn every_stored_result_belongs_to_a_run() {
    let strays = leftovers(&baselines());
    assert!(strays.is_empty(), "remove what no run in baseline.toml has made:\n{}", strays.join("\n"));
}

/// A relative change of 1e-12 in the density is found, with its place in the probes.
#[test]
fn a_change_in_the_twelfth_digit_is_found() {
    let baseline = named("hydrostatic-tank", "tank");
    let level = Isa::detect();
    let changed = baseline.builder(level).set("fluid.density", 1000.0 * (1.0 + 1e-12)).run();
    let text = baseline.difference(level, &baseline.record(level, &changed)).expect("a difference");
    let stored = baseline.stored(level).expect("a stored run").state_hash;
    let parts = [
        format!("hydrostatic-tank/tank, {}:", level.bits_name()),
        format!("state hash: expected {stored}, found {}", changed.state_hash().0),
        "probes: row ".into(),
        "If the change is meant: make baselines, and say why in CHANGELOG.md.".into(),
    ];
    assert!(parts.iter().all(|part| text.contains(part)), "{text}");
}

/// The levels with FMA share one baseline: each of them gives its bits.
#[test]
fn the_levels_with_fma_agree() {
    let baseline = named("elastic-gate", "moving-wall");
    for level in [Isa::Avx2, Isa::Avx512vl].into_iter().filter(|level| *level <= Isa::detect()) {
        let found = baseline.record(level, &run(&baseline, level));
        assert_eq!(baseline.difference(level, &found), None, "{}", isa::name(level));
    }
}

#[test]
fn an_unknown_level_is_refused() {
    let outcome = scene("hydrostatic-tank").variable(ISA_VARIABLE, "sse9").outcome();
    assert_eq!(outcome.code(), Some(1));
    assert_eq!(outcome.stderr, "error: HALFSTEP_ISA is `sse9`, but a level is baseline, avx2 or avx512vl\n");
}
