//! What water does with the defaults, beside theory: how much of a wave, a swing, a run-up and a vortex is left.
//!
//! Each band is narrow about what is measured. Where a target of docs/validation.md is missed, the band does not
//! reach it: whoever comes closer sees the test fail and writes down the better value.

use halfstep_output::Frame;
use halfstep_scene::Motion;
use halfstep_tests::linear_waves::{Float, shaken_tank};
use halfstep_tests::{Curve, Finished, RunBuilder, run::repository, run::scene_at, scene};
use halfstep_wire::frame::FLUID;
use std::ops::RangeInclusive;
use std::path::Path;

const GRAVITY: f64 = 9.81;

fn within(what: &str, value: f64, band: RangeInclusive<f64>) {
    println!("{what}: {value:.4}");
    assert!(band.contains(&value), "{what}: {value} is not in {band:?}");
}

/// A run of a scene's text at a spacing, m.
fn run(folder: &Path, text: &str, dx: f64) -> RunBuilder {
    let path = folder.join("water.toml");
    std::fs::write(&path, text).unwrap();
    scene_at(&path).set("resolution", dx).in_process()
}

// ---- A tank that shakes -------------------------------------------------------------------------------------------

const SHAKE: Motion =
    Motion::Oscillating { amplitude: [0.005, 0.0, 0.0], period: 1.6, start: 0.0, ramp: 1.6 };
const SHAKEN: &str = r#"
resolution = 0.01
end_time = 4.0
gravity = [0.0, -9.81]
[fluid]
density = 1000.0
[output]
frame_interval = 4.0
[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [1.0, 0.3] }
pressure = "hydrostatic"
[[shape]]
name = "tank"
phase = "wall"
tank = { min = [0.0, 0.0], max = [1.0, 0.5], open = ["top"] }
motion = { amplitude = [0.005, 0.0], period = 1.6, ramp = 1.6 }
[[probe]]
name = "middle"
kind = "centroid"
phase = "fluid"
"#;

/// Swing of the centre of mass over that of modal theory, rms from 2 to 4 s.
fn swing(dx: f64) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let middle = run(folder.path(), SHAKEN, dx).run().curve("middle.x").between(2.0, 4.0);
    let theory = shaken_tank(1.0, 0.3, &SHAKE, 4.0);
    let relative = |(&t, &x): (&f64, &f64)| x - 0.5 - SHAKE.at(t).displacement[0];
    let found: Vec<f64> = middle.times.iter().zip(&middle.values).map(relative).collect();
    let expected: Vec<f64> = middle.times.iter().map(|&t| theory.at(t)).collect();
    deviation(&found) / deviation(&expected)
}

fn deviation(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}

#[test]
fn a_shaken_tank_keeps_its_swing() {
    within("shaken tank at 20 mm, swing over theory", swing(0.02), 0.925..=0.945);
}

#[test]
#[ignore = "long: make validate"]
fn a_shaken_tank_keeps_its_swing_finer() {
    within("shaken tank at 10 mm, swing over theory", swing(0.01), 0.95..=0.965);
    within("shaken tank at 5 mm, swing over theory", swing(0.005), 0.96..=0.975);
}

// ---- A block let go above its rest --------------------------------------------------------------------------------

const LIFTED: &str = r#"
resolution = 0.01
end_time = 0.6
gravity = [0.0, -9.81]
[fluid]
density = 1000.0
[solid]
density = 500.0
youngs_modulus = 1e6
poissons_ratio = 0.3
[output]
frame_interval = 1.0
[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [1.0, 0.3] }
pressure = "hydrostatic"
[[shape]]
name = "block"
phase = "solid"
box = { min = [0.4, 0.26], max = [0.6, 0.36] }
[[shape]]
name = "tank"
phase = "wall"
tank = { min = [0.0, 0.0], max = [1.0, 0.5], open = ["top"] }
[[probe]]
name = "block"
kind = "centroid"
phase = "solid"
"#;

/// Instant, s, and height over the rest, m, of the first trough.
fn trough(height: &Curve) -> (f64, f64) {
    let down = Curve { times: height.times.clone(), values: height.values.iter().map(|z| -z).collect() };
    let (time, depth) = down.peak();
    (time, -depth)
}

/// With h / dx; there is a free body, so the default is 1.5, with f_i that ends at dx.
fn heave(dx: f64, smoothing_ratio: f64) -> (f64, f64) {
    let folder = tempfile::tempdir().unwrap();
    let found = run(folder.path(), LIFTED, dx).set("smoothing_ratio", smoothing_ratio).run();
    assert!(found.report.audit.min_gap.unwrap() > 0.8, "water gets into the block");
    let mut height = found.curve("block.y");
    height.values.iter_mut().for_each(|z| *z -= 0.3);
    trough(&height)
}

#[test]
fn linear_theory_of_the_lifted_block() {
    let float = Float { tank: 1.0, depth: 0.3, width: 0.2, draft: 0.05 };
    let (time, depth) = trough(&float.heave(0.01, 0.005, 0.6));
    within("first trough of linear theory, mm", 1e3 * depth, -5.05..=-5.01);
    within("its instant, s", time, 0.363..=0.365);
}

#[test]
fn a_lifted_block_swings() {
    let (time, depth) = heave(0.02, 1.5);
    within("lifted block at 20 mm, first trough, mm", 1e3 * depth, -3.06..=-2.96);
    within("its instant over that of linear theory", time / 0.364, 1.004..=1.014);
}

#[test]
#[ignore = "long: make validate"]
fn a_lifted_block_swings_finer() {
    for (dx, depth_band, time_band) in
        [(0.01, -4.0..=-3.9, 1.009..=1.019), (0.005, -4.44..=-4.34, 1.006..=1.016)]
    {
        let (time, depth) = heave(dx, 1.5);
        within(&format!("lifted block at {dx} m, first trough, mm"), 1e3 * depth, depth_band);
        within("its instant over that of linear theory", time / 0.364, time_band);
    }
}

/// With the wide kernel of water alone, `preset = "waves"`.
#[test]
#[ignore = "long: make validate"]
fn a_lifted_block_swings_in_water_with_a_wide_kernel() {
    // The target is 15 % of -5.03 mm at 5 mm, -4.27 mm: the band does not reach past it.
    for (dx, depth_band) in [(0.01, -3.78..=-3.68), (0.005, -4.35..=-4.27)] {
        let (time, depth) = heave(dx, 2.0);
        within(&format!("lifted block at {dx} m, wide kernel, first trough, mm"), 1e3 * depth, depth_band);
        within("its instant over that of linear theory", time / 0.364, 1.009..=1.019);
    }
}

// ---- A dam break onto a far wall ----------------------------------------------------------------------------------

const RUN_UP: &str = r#"
resolution = 0.01
end_time = 1.0
gravity = [0.0, -9.81]
[fluid]
density = 1000.0
[output]
frame_interval = 0.01
[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [0.6, 0.3] }
pressure = "hydrostatic"
[[shape]]
name = "tank"
phase = "wall"
tank = { min = [0.0, 0.0], max = [1.61, 1.2], open = ["top"] }
[[probe]]
name = "foot"
kind = "pressure"
at = [1.61, 0.003]
"#;

/// Height, m, up to which water at the far wall is at least two particles thick without a gap of two spacings.
fn jet(frame: &Frame, dx: f64) -> f64 {
    let mut counts = vec![0; (1.2 / dx) as usize];
    for (place, _) in frame.points.iter().zip(&frame.phase).filter(|(_, phase)| **phase == FLUID) {
        let [x, y, _] = place.map(f64::from);
        let bin = (y.max(0.0) / dx) as usize;
        if x > 1.61 - 10.0 * dx && bin < counts.len() {
            counts[bin] += 1;
        }
    }
    // Four in two rows are two abreast; three allow for disorder.
    let whole = counts.windows(2).take_while(|two| two[0] + two[1] >= 3).count();
    whole as f64 * dx
}

/// Highest jet, m, and mean pressure at the foot of the far wall after the impact, over rho g H, of water so wide, m.
fn run_up(dx: f64, guard: &str, width: f64) -> [f64; 2] {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), RUN_UP, dx).set("effects.wall-guard", guard);
    let found: Finished = run.set("shape.water.box.max", format!("[{width}, 0.3]")).run();
    let highest = found.outcome.frames("fluid").iter().map(|f| jet(f, dx)).fold(0.0, f64::max);
    // As the literature counts time: t sqrt(g / H) from 3.2 to 4.5, after the first blow (Lobovsky et al. 2014).
    let unit = (0.3 / GRAVITY).sqrt();
    let pressure =
        found.curve("foot.pressure").between(3.2 * unit, 4.5 * unit).mean() / (1000.0 * GRAVITY * 0.3);
    println!("run-up at {dx} m, {width} m wide, guard {guard}: jet {highest:.3} m, pressure {pressure:.3}");
    [highest, pressure]
}

/// Jet and pressure with the guard over those without, means over so many widths of the water, a spacing apart: where
/// the jet comes apart hangs on single particles.
fn guard_over_none(dx: f64, widths: i32) -> [f64; 2] {
    let sums = |guard: &str| {
        let all = (0..widths).map(|k| run_up(dx, guard, 0.6 + dx * f64::from(k - widths / 2)));
        all.fold([0.0; 2], |sum, found| [sum[0] + found[0], sum[1] + found[1]])
    };
    let (guarded, free) = (sums("auto"), sums("off"));
    [guarded[0] / free[0], guarded[1] / free[1]]
}

#[test]
fn the_guard_does_not_brake_a_run_up() {
    let [jet, pressure] = guard_over_none(0.02, 5);
    within("jet over that without guard at 20 mm", jet, 0.87..=0.91);
    within("pressure over that without guard at 20 mm", pressure, 0.886..=0.916);
}

/// The target is 5 %. A jet comes apart at single particles, so that means of five ratios scatter by 3 %: 2 % about
/// those measured.
#[test]
#[ignore = "long: make validate"]
fn the_guard_does_not_brake_a_run_up_finer() {
    for (dx, widths, jets, pressures) in
        [(0.01, 5, 1.07..=1.11, 0.97..=0.99), (0.005, 3, 1.04..=1.08, 0.986..=1.006)]
    {
        let [jet, pressure] = guard_over_none(dx, widths);
        println!("{dx} m: jet {jet:.4}, pressure {pressure:.4}");
        within(&format!("jet over that without guard at {dx} m"), jet, jets);
        within(&format!("pressure over that without guard at {dx} m"), pressure, pressures);
    }
}

// ---- A standing wave ----------------------------------------------------------------------------------------------

/// Period and decay of the centre's swing over linear theory's.
fn standing_wave(dx: f64, rule: &str) -> (f64, f64) {
    let run = scene("standing-wave").set("resolution", dx).set("fluid.time_integration", rule).until(6.0);
    let run = run.in_process().run();
    let mut middle = run.curve("middle.x");
    middle.values.iter_mut().for_each(|x| *x -= 0.5);
    let crossings = middle.crossings();
    let swings: Vec<(f64, f64)> = crossings
        .windows(2)
        .map(|w| {
            let part = middle.between(w[0].0, w[1].0);
            let size = Curve { values: part.values.iter().map(|x| x.abs()).collect(), times: part.times };
            size.peak()
        })
        .collect();
    let (times, values) = swings.into_iter().map(|(t, x)| (t, x.ln())).unzip();
    let decay = -Curve { times, values }.slope();
    (middle.period().unwrap() / 1.1818, decay / 0.0987)
}

#[test]
fn a_standing_wave_has_its_period() {
    for rule in ["midpoint", "verlet"] {
        let (period, decay) = standing_wave(0.025, rule);
        within(&format!("standing wave at 25 mm, {rule}, period over theory"), period, 0.995..=0.999);
        within("its decay over 2 k² nu", decay, 1.054..=1.074);
    }
}

#[test]
#[ignore = "long: make validate"]
fn a_standing_wave_has_its_period_finer() {
    let (period, decay) = standing_wave(0.0125, "verlet");
    within("standing wave at 12.5 mm, period over theory", period, 0.996..=1.0);
    within("its decay over 2 k² nu", decay, 0.98..=1.0);
}

// ---- A paddle's waves ---------------------------------------------------------------------------------------------

/// Height of the waves over linear theory: of the gauge's part at the paddle's frequency, from 2.3 s over three
/// periods.
fn paddle(dx: f64) -> f64 {
    // As thick as the kernel reaches: water would get past it.
    let behind = format!("[{}, 0.0]", -4.0 * dx);
    let run =
        scene("wave-paddle").set("resolution", dx).set("shape.paddle.box.min", behind).in_process().run();
    let level = run.curve("gauge.level").between(2.3, 5.0);
    2.0 * level.amplitude(0.9, 0.2) / 0.0231
}

#[test]
fn a_paddle_makes_its_waves() {
    within("paddle at 20 mm, height over theory", paddle(0.02), 0.895..=0.915);
}

#[test]
#[ignore = "long: make validate"]
fn a_paddle_makes_its_waves_finer() {
    within("paddle at 10 mm, height over theory", paddle(0.01), 0.958..=0.978);
}

// ---- Taylor and Green's vortex ------------------------------------------------------------------------------------

/// Kinetic energy after 1 s over the exact one.
fn vortex(dx: f64) -> f64 {
    let run = scene("taylor-green").set("resolution", dx).in_process().run();
    run.curve("water.energy").values.last().unwrap() / 168.46
}

#[test]
fn a_vortex_decays_by_its_viscosity() {
    within("vortex at 40 mm, energy over the exact one", vortex(0.04), 0.932..=0.943);
}

#[test]
#[ignore = "long: make validate"]
fn a_vortex_decays_by_its_viscosity_finer() {
    within("vortex at 20 mm, energy over the exact one", vortex(0.02), 0.952..=0.962);
    within("vortex at 10 mm, energy over the exact one", vortex(0.01), 0.962..=0.972);
}

/// A is worth the viscosity A h c0 / 16: the decay of A = 1 less that of A = 0.5, in which walls and pressure cancel,
/// over 4 k² nu. 1.03 measured, while the lattice holds.
#[test]
fn artificial_viscosity_is_worth_a_sixteenth_of_its_product() {
    let rate = |linear: f64| {
        let run =
            scene("taylor-green").set("resolution", 0.04).set("fluid.artificial_viscosity.linear", linear);
        let run = run.set("effects.viscosity", "off").set("effects.wall-guard", "off");
        let energy = run.until(0.3).in_process().run().curve("water.energy");
        (energy.at(0.0) / energy.at(0.3)).ln() / 0.3
    };
    let (h, sound, k) = (0.08, 10.0, std::f64::consts::PI);
    let nu = (1.0 - 0.5) * h * sound / 16.0;
    within("worth of A over A h c0 / 16", (rate(1.0) - rate(0.5)) / (4.0 * k * k * nu), 1.02..=1.04);
}

// ---- Corners ------------------------------------------------------------------------------------------------------

/// Water thrown into a corner of two walls: with h / dx = 2 the walls thin out its first particle.
#[test]
fn water_that_leaves_a_corner_is_not_thinned_out() {
    let scene = repository().join("tests/stability/scenes/plate-tank.toml");
    let thrown = |separation: &str| {
        let run = scene_at(&scene).set("smoothing_ratio", 2).set("shape.water.velocity", "[2.0,-2.0]");
        let run = run.set("solid.youngs_modulus", 1e8).set("effects.wall-separation", separation);
        run.until(0.3).in_process().outcome()
    };
    let thinned = thrown("off");
    assert_eq!(thinned.code(), Some(2));
    let error = thinned.report().error.expect("what ended the run");
    assert!(error.contains("density of particle 0 is 6."), "{error}");
    let held = thrown("on").finished();
    assert!(held.report.steps > 1000);
}
