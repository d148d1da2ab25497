//! Dam break on an upright elastic plate.
//!
//! Beam theory: a jet of 2 m/s over the whole height of the 12 mm plate (4 kPa) moves its tip by q L^4 / (8 D), which
//! is 0.6 mm for E = 0.22 GPa, 1.0 mm for a plate of 10 mm, and 10 mm for E = 12 MPa. The plate with E = 1 MPa of the
//! literature goes 41-49 mm at 0.23-0.26 s (`validation/dam-break-plate/reference`). The total-Lagrangian plate does,
//! too: 41.4, 43.3 and 42.7 mm @ 0.241, 0.230 and 0.242 s with three, four and six particles across. The hypoelastic
//! plate is too soft: 83 mm @ 0.28 s with six.
//!
//! The paper's scheme (`preset = "kayaki"`) has a plate of five rows, 10 mm. Its time step of 1e-5 s is 1.77 dx / c_P
//! for E = 0.22 GPa, where the plate blows up (`tests/tests/in_process/divergence.rs`): 5e-6 s there.

use halfstep_tests::{Curve, Finished, RunBuilder, scene};
use std::ops::Range;

/// When the jet arrives, s: the front's 0.286 m by free fall and spreading, seen in every computation.
const IMPACT: f64 = 0.12;

fn plate(resolution: f64, youngs_modulus: f64) -> RunBuilder {
    scene("dam-break-plate").set("resolution", resolution).set("solid.youngs_modulus", youngs_modulus)
}

/// The tip's displacement downstream, mm, and its first peak after the impact.
fn tip(what: &str, run: &Finished) -> (Curve, (f64, f64)) {
    let curve = run.curve("tip.x");
    let curve = Curve { values: curve.values.iter().map(|v| 1e3 * v).collect(), ..curve };
    let peak = curve.peak();
    let audit = &run.report.audit;
    println!(
        "{what}: tip {:.2} mm @ {:.3} s; closest {:.2} dx; {} sub-steps; {:.0} s",
        peak.1,
        peak.0,
        audit.min_gap.unwrap_or(f64::NAN),
        run.report.sub_steps.unwrap_or(1),
        run.report.wall_seconds
    );
    assert!(audit.action_reaction.unwrap() <= 1e-12, "{audit:?}");
    assert!(audit.impulse.unwrap() <= 1e-12, "{audit:?}");
    assert!(audit.min_gap.unwrap() > 0.3, "{audit:?}");
    (curve, peak)
}

/// Before the jet arrives nothing moves; then the tip goes downstream, as far as was measured, mm, to a part of it: an
/// impact is that irregular. With the total-Lagrangian plate that is 0.8 of the jet's load at rest. Then the jet holds
/// the plate bent: the mean from 0.15 to 0.2 s over the peak would be near 0 of one that rings about its place.
fn stiff(curve: &Curve, (time, peak): (f64, f64), expected: f64, part: f64, held: Range<f64>) {
    assert!(curve.between(0.0, IMPACT).values.iter().all(|x| x.abs() < 0.01), "it moved before it was hit");
    assert!((peak / expected - 1.0).abs() < part, "{peak} mm, measured {expected} mm");
    assert!((0.15..0.2).contains(&time), "{time} s");
    let mean = curve.between(0.15, 0.2).mean() / peak;
    println!("mean over the peak {mean:.3}");
    assert!(held.contains(&mean), "{mean}");
}

#[test]
fn a_stiff_plate_hardly_moves_and_a_softer_one_moves_more() {
    let (curve, peak) = tip("E 0.22 GPa, 4 mm", &plate(0.004, 0.22e9).until(0.2).run());
    // 0.458 mm @ 0.178 s and 0.79 measured.
    stiff(&curve, peak, 0.458, 0.04, 0.77..0.81);
    assert!((0.170..0.186).contains(&peak.0), "{peak:?}");
    let (soft, soft_peak) = tip("E 12 MPa, 4 mm", &plate(0.004, 12e6).until(0.2).run());
    assert!(soft.between(0.0, IMPACT).values.iter().all(|x| x.abs() < 0.01));
    // Eighteen times softer: 7.30 mm @ 0.1905 s measured, 16 times as far, since it gives way to the jet.
    assert!((7.1..7.5).contains(&soft_peak.1) && (0.186..0.195).contains(&soft_peak.0), "{soft_peak:?}");
}

/// The literature's plate: seven computations peak at 41.4 to 49.1 mm.
#[test]
fn the_accurate_plate_goes_as_far_as_the_published_ones() {
    let plate = plate(0.004, 1e6).set("solid.poissons_ratio", 0.0).set("solid.model", "total-lagrangian");
    let (_, (time, peak)) = tip("total-Lagrangian, E 1 MPa, 4 mm", &plate.until(0.3).run());
    // 41.41 mm measured, the least of the published ones, 41.4 to 49.1 mm; finer it is more.
    assert!((41.4..41.9).contains(&peak), "{peak} mm");
    // 0.241 s measured; published 0.231 to 0.255 s.
    assert!((0.236..0.246).contains(&time), "{time} s");
}

/// The plate sleeps until the water arrives; nobody sees that in the results, but in the work.
#[test]
fn a_plate_that_sleeps_before_the_impact_moves_as_one_that_does_not() {
    let run = |switch: &str, cfl: f64| {
        plate(0.004, 12e6).set("effects.sleeping-solid", switch).set("numerics.cfl", cfl).until(0.2).run()
    };
    let (sleeping, awake, shorter) = (run("auto", 0.4), run("off", 0.4), run("off", 0.39));
    let work = |run: &Finished| run.report.work.pair_evaluations.solid.unwrap() as f64;
    assert!(work(&sleeping) < 0.7 * work(&awake), "{} {}", work(&sleeping), work(&awake));
    let tip = awake.curve("tip.x");
    let apart = |other: &Curve| {
        let rows = tip.times.iter().zip(&tip.values).filter(|(t, _)| **t < 0.199);
        rows.map(|(&t, x)| (other.at(t) - x).abs()).fold(0.0, f64::max)
    };
    let (difference, chance) = (apart(&sleeping.curve("tip.x")), apart(&shorter.curve("tip.x")));
    let peak = tip.peak().1;
    println!(
        "largest difference {:.3} mm, of a step 2.5 % shorter {:.3} mm, peak {:.2} mm",
        1e3 * difference,
        1e3 * chance,
        1e3 * peak
    );
    // What a step 2.5 % shorter does to the impact is chance: 2 % of the peak. Sleeping does less, 0.6 %.
    assert!(difference < 0.5 * chance && difference < 0.015 * peak);
}

/// Static deflection of a cantilever's end, mm: q L^4 / (8 D) with 4 kPa over 80 mm.
fn beam(youngs_modulus: f64, thickness: f64) -> f64 {
    let bending_stiffness = youngs_modulus * thickness.powi(3) / (12.0 * (1.0 - 0.32 * 0.32));
    1e3 * 4000.0 * 0.08_f64.powi(4) / (8.0 * bending_stiffness)
}

/// Two rows of the paper's lattice, 8 mm: too soft, as five are. The impact is where the program's own is, 0.15 s; the
/// plate moves 25 mm at 0.17 s, 22.5 mm at the most with five rows of 10 mm.
#[test]
fn a_coarse_plate_with_the_papers_scheme() {
    let run = plate(0.004, 12e6).set("preset", "kayaki").set("time_step", 2e-5).until(0.17).run();
    let (curve, _) = tip("paper's scheme, E 12 MPa, 4 mm", &run);
    assert!(curve.between(0.0, 0.135).values.iter().all(|x| x.abs() < 0.02), "it moved before it was hit");
    let found = curve.at(0.17);
    assert!((24.0..26.5).contains(&found), "{found} mm, measured 25.1 mm");
}

#[test]
#[ignore = "many minutes: the paper's interface at full resolution"]
fn plates_with_the_paper_scheme_at_full_resolution() {
    let paper = |youngs_modulus, time_step: f64| {
        plate(0.002, youngs_modulus).set("preset", "kayaki").set("time_step", time_step)
    };
    let (curve, peak) = tip("paper's scheme, E 0.22 GPa, 2 mm", &paper(0.22e9, 5e-6).until(0.2).run());
    println!("beam theory {:.2} mm", beam(0.22e9, 0.01));
    stiff(&curve, peak, 2.16, 0.1, 0.4..0.9);
    let (_, peak) = tip("paper's scheme, E 12 MPa, 2 mm", &paper(12e6, 1e-5).until(0.21).run());
    println!("beam theory {:.1} mm", beam(12e6, 0.01));
    // 22.5 mm measured: the hypoelastic plate of five rows is 1.2 to 1.4 times too soft.
    assert!((21.0..24.0).contains(&peak.1), "{peak:?}");
}

#[test]
#[ignore = "minutes: full resolution"]
fn plates_at_full_resolution() {
    let (curve, peak) = tip("E 0.22 GPa, 2 mm", &plate(0.002, 0.22e9).until(0.25).run());
    stiff(&curve, peak, 0.473, 0.05, 0.7..0.9);
    let (_, peak) = tip("E 12 MPa, 2 mm", &plate(0.002, 12e6).until(0.25).run());
    // 7.91 mm measured; 7.3 mm at 4 mm.
    assert!((7.7..8.1).contains(&peak.1), "{peak:?}");
    let run = plate(0.002, 1e6).set("solid.poissons_ratio", 0).until(0.3).run();
    let (curve, _) = tip("E 1 MPa, 2 mm", &run);
    let published = Curve::reference("dam-break-plate", "published-peaks.csv", "x [mm]");
    let least = published.values.iter().copied().fold(f64::INFINITY, f64::min);
    // After the impact the tip first dips toward the jet.
    let (first, most) = (curve.between(0.17, 1.0).first_peak(0.5), published.peak().1);
    println!("E 1 MPa, 2 mm: first peak (s, mm) {first:.3?}; published {least}-{most} mm at 0.23-0.26 s");
    let (time, peak) = first.expect("a peak");
    assert!((least..=most).contains(&peak) && (0.23..0.26).contains(&time), "{peak} mm @ {time} s");
    // 42.7 mm measured.
    assert!((peak - 42.7).abs() < 0.7, "{peak} mm");
}
