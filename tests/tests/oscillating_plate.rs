//! Oscillating plate (Gray, Monaghan and Swift 2001): a cantilever in its first bending mode.
//!
//! Thin-plate theory (Landau and Lifshitz): 0.2541 s. Plane-strain elasticity with a clamped face: 0.2552 s, the limit
//! of finite elements (`tests/src/finite_elements.rs`; 2 to 16 across: 0.2537, 0.2547, 0.2550, 0.2552). The hypoelastic
//! solid without gradient renormalisation is too soft and slower: published computations and this one come closer with
//! resolution. The total-Lagrangian one converges to elasticity.

use halfstep_tests::finite_elements::Block;
use halfstep_tests::{Finished, scene};
use nalgebra::Complex;

/// Period of thin-plate theory, s.
const PERIOD: f64 = 0.2541;

/// Period of plane-strain elasticity, s.
const ELASTICITY: f64 = 0.2552;

fn plate(resolution: f64, model: &str) -> Finished {
    scene("oscillating-plate").set("resolution", resolution).set("solid.model", model).until(0.32).run()
}

/// The hypoelastic solid: the relative error of its period.
fn hypoelastic_error(across: u32, kernel: &str) -> f64 {
    let run = scene("oscillating-plate")
        .set("resolution", 0.02 / f64::from(across))
        .set("solid.model", "hypoelastic")
        .set("numerics.kernel", kernel)
        .until(0.32)
        .run();
    error(&format!("hypoelastic, {kernel}, {across} across"), &run)
}

#[test]
fn finite_elements_converge_to_the_reference() {
    let plate =
        Block { length: 0.2, height: 0.02, youngs_modulus: 2e6, poissons_ratio: 0.3975, density: 1000.0 };
    let [two, four] = [(20, 2), (40, 4)].map(|(along, across)| plate.period(along, across));
    println!("2 across {two:.4} s, 4 across {four:.4} s");
    assert!((two - 0.2537).abs() < 1e-4 && (four - 0.2547).abs() < 1e-4, "{two} {four}");
    // From below, the error less than half with each halving.
    assert!(four < ELASTICITY && ELASTICITY < four + (four - two), "{two} {four}");
}

/// One, two and four elements across: +0.8, -0.5 and -0.3 % of the period of elasticity. No locking.
#[test]
fn the_finite_element_solid_swings_right_with_one_element_across() {
    for (across, measured) in [(1, 0.0083), (2, -0.0051), (4, -0.0031)] {
        let run = plate(0.02 / f64::from(across), "finite-element");
        let period = (1.0 + error(&format!("finite elements, {across} across"), &run)) * PERIOD;
        let to_elasticity = period / ELASTICITY - 1.0;
        println!("{:+.2} % to elasticity", 100.0 * to_elasticity);
        assert!((to_elasticity - measured).abs() < 0.001, "{to_elasticity}");
    }
}

/// Relative error of the total-Lagrangian period to elasticity.
fn error_to_elasticity(across: u32) -> f64 {
    let run = plate(0.02 / f64::from(across), "total-lagrangian");
    let error =
        (1.0 + error(&format!("total-Lagrangian, {across} across"), &run)) * PERIOD / ELASTICITY - 1.0;
    println!("{:+.2} % to elasticity", 100.0 * error);
    // It comes back to where it was straight with all of its energy: each half period.
    let energy = run.curve("plate.energy");
    // 0.9975 to 0.9985 measured at 3 to 10 across.
    let again = energy.between(0.1, 0.16).peak().1 / energy.values[0];
    assert!((0.996..1.0).contains(&again), "{again}");
    error
}

/// Relative error of the period.
fn error(what: &str, run: &Finished) -> f64 {
    let tip = run.curve("tip.y");
    let period = tip.period().expect("more than half an oscillation");
    let (time, peak) = tip.peak();
    let error = period / PERIOD - 1.0;
    println!(
        "{what}: period {period:.4} s ({:+.1} %), first peak {:.1} mm @ {time:.3} s, theory 23.1 mm; {:.0} s",
        100.0 * error,
        1e3 * peak,
        run.report.wall_seconds
    );
    // It starts upward and swings to the other side of its rest position.
    assert!(tip.at(0.05) > 0.01 && tip.between(0.15, 0.3).values.iter().any(|&y| y < -0.01));
    // Energy never grows: not even all of it, as motion, is more than at the start.
    let energy = run.curve("plate.energy");
    assert!(energy.between(0.05, 1.0).peak().1 <= energy.values[0], "{:?}", energy.between(0.05, 1.0).peak());
    let audit = &run.report.audit;
    assert!(run.report.roles.solid.is_some() && run.report.roles.fluid.is_none(), "{audit:?}");
    error
}

#[test]
fn the_period_at_10_across() {
    // The paper's kernel. 19.6 % of thin-plate theory measured, 19.0 % of elasticity.
    let error = hypoelastic_error(10, "cubic-spline");
    assert!((0.193..0.199).contains(&error), "{error}");
}

#[test]
fn the_total_lagrangian_period_from_3_to_10_across() {
    for (across, measured) in [(3, 0.0038), (5, 0.0022), (10, 0.0013)] {
        let found = error_to_elasticity(across);
        assert!((found - measured).abs() < 0.0004, "{across} across: {found}");
    }
}

#[test]
#[ignore = "minutes: 20 particles across"]
fn the_period_converges() {
    // Measured: 19 and 9 % with the paper's kernel, 23 and 15 % with the default.
    for (kernel, most, rate) in [("cubic-spline", 0.105, 0.6), ("wendland-c2", 0.16, 0.7)] {
        let [coarse, fine] = [10, 20].map(|across| hypoelastic_error(across, kernel));
        assert!((0.0..most).contains(&fine), "{kernel}: {fine}");
        assert!(fine < rate * coarse, "{kernel}: {fine} after {coarse}");
    }
}

#[test]
#[ignore = "minutes: 20 particles across"]
fn the_total_lagrangian_period_converges() {
    let [ten, twenty] = [10, 20].map(error_to_elasticity);
    // 0.13 and 0.04 % measured.
    assert!((twenty - 0.0004).abs() < 0.0003 && twenty < 0.5 * ten, "{twenty} after {ten}");
}

/// Complex modulus of bending in plane strain, E' = 4 G* (3 K + G*) / (3 K + 4 G*), as tan delta: of a plate whose arm
/// [g, tau] relaxes.
fn tan_delta(g: f64, tau: f64, omega: f64) -> f64 {
    let (nu, modulus) = (0.3975, 2e6);
    let (shear, bulk) = (modulus / (2.0 * (1.0 + nu)), modulus / (3.0 * (1.0 - 2.0 * nu)));
    let x = omega * tau;
    let share = g / (1.0 + x * x);
    let complex = Complex::new(shear * (1.0 + share * x * x), shear * share * x);
    let bending = complex * 4.0 * (complex + 3.0 * bulk) / (complex * 4.0 + 3.0 * bulk);
    bending.im / bending.re
}

/// For small damping amplitudes fall by pi tan delta a period. The resistance that gives particles the bending
/// stiffness of their cells, 1 / n² of the whole with n across, does not relax.
#[test]
fn a_relaxing_plate_swings_out_by_its_loss_angle() {
    let (g, tau, across) = (0.1, 0.04, 4);
    let run = scene("oscillating-plate")
        .set("resolution", 0.02 / f64::from(across))
        .set("solid.prony", format!("[[{g},{tau}]]"))
        .set("shape.plate.cantilever_mode.fraction", 0.002)
        .until(0.75)
        .run();
    let tip = run.curve("tip.y");
    // Turning points; the first has the arms' beginning in it.
    let turns: Vec<(f64, f64)> = (1..tip.values.len() - 1)
        .filter(|&k| (tip.values[k] - tip.values[k - 1]) * (tip.values[k + 1] - tip.values[k]) < 0.0)
        .map(|k| (tip.times[k], tip.values[k]))
        .collect();
    assert!(turns.len() >= 6, "{turns:?}");
    let (early, late) = (turns[1], turns[5]);
    let period = 0.5 * (late.0 - early.0);
    let decrement = 0.5 * (early.1 / late.1).ln();
    let relaxing = 1.0 - 1.0 / f64::from(across * across);
    let theory = std::f64::consts::PI * tan_delta(g, tau, 2.0 * std::f64::consts::PI / period) * relaxing;
    println!("period {period:.4} s, log decrement {decrement:.4}, theory {theory:.4}");
    // 0.978 measured.
    assert!((0.97..0.986).contains(&(decrement / theory)), "{decrement} {theory}");
}

/// Plane stress with E and nu is plane strain with E (1 + 2 nu) / (1 + nu)² and nu / (1 + nu): finite elements know the
/// latter. Without the effect the period would be 9 % shorter.
#[test]
fn a_plate_in_plane_stress_swings_as_finite_elements_say() {
    let (modulus, nu) = (2e6, 0.3975);
    let plate = Block {
        length: 0.2,
        height: 0.02,
        youngs_modulus: modulus * (1.0 + 2.0 * nu) / (1.0_f64 + nu).powi(2),
        poissons_ratio: nu / (1.0 + nu),
        density: 1000.0,
    };
    let theory = plate.period(40, 4);
    for material in ["neo-hookean", "st-venant-kirchhoff"] {
        let run = scene("oscillating-plate")
            .set("resolution", 0.005)
            .set("solid.plane", "stress")
            .set("solid.material", material)
            .set("shape.plate.cantilever_mode.fraction", 0.002)
            .until(0.32)
            .run();
        let period = run.curve("tip.y").period().expect("more than half an oscillation");
        println!("plane stress, {material}: period {period:.4} s, finite elements {theory:.4} s");
        assert!((period / theory - 1.0).abs() < 0.01, "{period} {theory}");
    }
}
