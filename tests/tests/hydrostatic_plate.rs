//! Water on an elastic floor (Fourey et al. 2017): 2 m of water on an aluminium plate clamped at both ends.
//!
//! Plate theory: -6.85e-5 m in the middle, with the plate's own weight; shear adds 3.6 %, -7.10e-5 m. Other SPH codes
//! are 7-50 % off. The total-Lagrangian solid bends 0.92, 1.08 and 1.05 times the thin plate with 2, 3 and 5 particles
//! across. The hypoelastic one is too soft: 2.8, 2.2 and 2.2 times with 2, 3 and 4. It is the solid and not the
//! coupling: dry, under a uniform weight of the same size, both models bend by the same (2.86, 2.22, 2.25; 0.92, 1.08,
//! 1.05).

use halfstep_tests::{Finished, scene};

/// Plate theory, m.
const DEFLECTION: f64 = -6.85e-5;

/// Weight of the water, N per metre of depth.
const WEIGHT: f64 = 1000.0 * 9.81 * 2.0;

/// Mean deflection over the theory's, once the first swing is over; and mean pressure 1 m deep over rho g depth. The
/// plate carries the water.
fn ratios(what: &str, run: &Finished) -> (f64, f64) {
    let mean = |name: &str| run.curve(name).between(0.05, run.report.time).mean();
    let (deflection, pressure) = (mean("middle.y") / DEFLECTION, mean("depth.pressure") / 9810.0);
    println!(
        "{what}: mean deflection {deflection:.2} of theory's, pressure {pressure:.3} of rho g depth; {} sub-steps; \
         {:.0} s",
        run.report.sub_steps.unwrap_or(1),
        run.report.wall_seconds
    );
    let load = mean("load.y") / -WEIGHT;
    println!("the plate carries {load:.3} of the water");
    // 1.013 measured over the shortest time, 1.004 over 0.15 s.
    assert!((load - 1.0).abs() < 0.016, "{load}");
    let audit = &run.report.audit;
    assert!(audit.action_reaction.unwrap() <= 1e-12 && audit.min_gap.unwrap() > 0.9, "{audit:?}");
    (deflection, pressure)
}

#[test]
fn a_coarse_hypoelastic_plate_is_two_and_a_half_times_too_soft() {
    let run = scene("hydrostatic-plate")
        .set("resolution", 0.025)
        .set("solid.model", "hypoelastic")
        .until(0.2)
        .run();
    let (deflection, pressure) = ratios("hypoelastic, 2 across", &run);
    // 2.676 measured over this time, 2.8 over a longer one: too soft, and no softer than that.
    assert!((2.65..2.70).contains(&deflection), "{deflection}");
    // 1.010 measured: what is left of the first swing.
    assert!((1.006..1.014).contains(&pressure), "{pressure}");
}

#[test]
fn a_plate_bends_as_theory_says() {
    let run = scene("hydrostatic-plate").set("resolution", 0.05 / 3.0).until(0.08).run();
    let (deflection, pressure) = ratios("3 across", &run);
    // 1.057 and 1.021 measured, over a part of the first swing.
    assert!((1.05..1.065).contains(&deflection), "{deflection}");
    assert!((1.016..1.026).contains(&pressure), "{pressure}");
}

/// The plate's own spacing does not change what the water weighs: over the first period of the water's sound, 4 H / c0.
#[test]
fn a_finer_plate_carries_coarse_water() {
    let run =
        scene("hydrostatic-plate").set("resolution", 0.025).set("shape.plate.across", 3).until(0.13).run();
    let mean = |name: &str| run.curve(name).mean();
    let (load, deflection) = (mean("load.y") / -WEIGHT, mean("middle.y") / DEFLECTION);
    println!("3 across in water at 2 across: load {load:.3}, deflection {deflection:.3}");
    // 1.0014 measured.
    assert!((load - 1.0).abs() < 0.003, "{load}");
    // 1.046 measured: as with water at three across, and not as with two, 0.89.
    assert!((1.04..1.052).contains(&deflection), "{deflection}");
}

#[test]
#[ignore = "many minutes: 5 particles across, many sub-steps"]
fn a_finer_plate_bends_as_theory_says() {
    let run = scene("hydrostatic-plate").until(0.2).run();
    let (deflection, pressure) = ratios("5 across", &run);
    // 1.041 and 1.009 measured; shear makes it 1.036.
    assert!((1.033..1.05).contains(&deflection), "{deflection}");
    assert!((pressure - 1.009).abs() < 0.006, "{pressure}");
}
