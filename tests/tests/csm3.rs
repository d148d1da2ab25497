//! CSM3 of Turek and Hron (2006): an elastic bar swings under its weight, large rotations, no water. Their reference
//! for the tip, by finite elements: y = -63.607 ± 65.160 mm at 1.0995 Hz, x = -14.305 ± 14.305 mm.
//!
//! Their bar ends in the round side of a cylinder, 0.35 m from its tip; here the side of the clamp is straight.

use halfstep_tests::{Curve, Finished, scene_at};

const SCENE: &str = r#"
resolution = 0.005
end_time = 1.05
gravity = [0.0, -2.0]

[solid]
density = 1000.0
youngs_modulus = 1.4e6
poissons_ratio = 0.4
material = "st-venant-kirchhoff"
artificial_viscosity = { linear = 0.0, quadratic = 0.0 }

[output]
frame_interval = 0.35
probe_interval = 0.002

[[shape]]
name = "bar"
phase = "solid"
box = { min = [0.23, 0.19], max = [0.6, 0.21] }
clamp = { min = [0.23, 0.19], max = [0.25, 0.21] }

[[probe]]
name = "tip"
kind = "displacement"
at = [0.6, 0.2]
"#;

/// What the tip does from its release to its return to the top.
#[derive(Debug)]
struct Swing {
    /// Lowest and highest y, m.
    y: [f64; 2],
    /// Inmost x, m.
    x: f64,
    /// Hz.
    frequency: f64,
}

impl Swing {
    fn of(run: &Finished) -> Self {
        let (y, x) = (run.curve("tip.y"), run.curve("tip.x"));
        let least = |curve: Curve| curve.values.into_iter().fold(f64::INFINITY, f64::min);
        // It hangs lowest half a period after its release, and is back at the top after a whole one.
        let lowest = least(y.between(0.2, 0.7));
        let top = y.between(0.7, 1.05).values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let rest = 0.5 * lowest;
        let crossings: Vec<f64> = (1..y.values.len())
            .filter(|&k| (y.values[k - 1] > rest) != (y.values[k] > rest))
            .map(|k| {
                let part = (rest - y.values[k - 1]) / (y.values[k] - y.values[k - 1]);
                y.times[k - 1] + part * (y.times[k] - y.times[k - 1])
            })
            .collect();
        // Down through the middle, up through it: half a period apart.
        let frequency = 0.5 / (crossings[1] - crossings[0]);
        Self { y: [lowest, top], x: least(x.between(0.2, 0.7)), frequency }
    }

    fn amplitude(&self) -> f64 {
        0.5 * (self.y[1] - self.y[0])
    }

    fn say(&self, model: &str) {
        let mean = 0.5 * (self.y[1] + self.y[0]);
        println!(
            "{model}: y {:.2} ± {:.2} mm, from {:.2} to {:.2}, x {:.2} mm, {:.4} Hz",
            1e3 * mean,
            1e3 * self.amplitude(),
            1e3 * self.y[0],
            1e3 * self.y[1],
            1e3 * self.x,
            self.frequency
        );
    }
}

fn bar(text: &str, model: &str, across: u32) -> Finished {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("csm3.toml");
    std::fs::write(&path, text).expect("a scene");
    scene_at(&path).set("resolution", 0.02 / f64::from(across)).set("solid.model", model).run()
}

/// Four across: y 1.5 and 1.4 % short, x 1.2 and 0.8 %, 0.9 and 0.8 % too fast. With eight y is 0.3 and 0.7 % short, x
/// 0.8 and 0.1 % off, 0.5 and 0.7 % too fast; the straight clamp is worth some of it. The amplitude is 63.5 mm.
#[test]
fn bars_of_both_models_swing_as_turek_and_hron_say() {
    // Over the reference: y, x, frequency, amplitude; from run to run only the last digits change.
    for (model, measured) in [
        ("total-lagrangian", [0.9854, 0.9881, 1.0086, 0.9738]),
        ("finite-element", [0.9863, 0.9919, 1.0079, 0.9747]),
    ] {
        let swing = Swing::of(&bar(SCENE, model, 4));
        swing.say(model);
        let [lowest, top] = swing.y;
        let found =
            [lowest / -0.128767, swing.x / -0.02861, swing.frequency / 1.0995, swing.amplitude() / 0.06516];
        for (found, measured) in found.into_iter().zip(measured) {
            assert!((found - measured).abs() < 1e-3, "{model}: {swing:?}");
        }
        // Released at rest it comes back to where it was, undamped; the reference's +1.55 mm is beyond that.
        assert!(top.abs() < 1e-4, "{model}: {top}");
    }
}

/// Eight across: how low the bar hangs, how far in, and how fast, each within a hundredth of the reference. It is
/// released from y = 0 and comes back there, so its amplitude is half of the lowest; the reference's is 1.2 % more.
#[test]
#[ignore = "a minute"]
fn finer_bars_are_within_a_hundredth_of_turek_and_hron() {
    for model in ["total-lagrangian", "finite-element"] {
        let swing = Swing::of(&bar(SCENE, model, 8));
        swing.say(model);
        for found in [swing.y[0] / -0.128767, swing.x / -0.02861, swing.frequency / 1.0995] {
            assert!((found - 1.0).abs() < 0.01, "{model}: {swing:?}");
        }
    }
}

/// Shown, not held to the reference: four across it is about as soft as its plates are elsewhere, 1.6 times, with A =
/// 0.1 (without any viscosity it blows up).
#[test]
fn a_bar_of_the_hypoelastic_model_hangs_too_low() {
    let text =
        SCENE.replace("material = \"st-venant-kirchhoff\"\n", "").replace("linear = 0.0", "linear = 0.1");
    let y = bar(&text, "hypoelastic", 4).curve("tip.y");
    let lowest = y.values.into_iter().fold(f64::INFINITY, f64::min);
    println!("y down to {:.2} mm, {:.2} times the reference's", 1e3 * lowest, lowest / -0.128767);
    assert!((1.5..1.75).contains(&(lowest / -0.128767)), "{lowest}");
}
