//! The error falls with the square of the time step where everything is smooth: fluid and solid coupled with sub-steps,
//! and fluid alone. Three steps, each half of the one before; the order is log2 of the ratio of successive differences.

use halfstep_tests::{Curve, RunBuilder, run::scene_at};
use std::path::{Path, PathBuf};

/// Water on an elastic floor that is clamped at both ends and swings about its rest. No guard and no f_i would change
/// nothing here: nothing comes close.
const FLOOR: &str = r#"
resolution = 0.025
end_time = 0.1
gravity = [0.0, -9.81]
[fluid]
density = 1000.0
sound_speed = 20.0
[solid]
density = 1000.0
youngs_modulus = 2e7
poissons_ratio = 0.3
[output]
frame_interval = 1.0
probe_interval = 1e-3
[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [0.5, 0.2] }
pressure = "hydrostatic"
[[shape]]
name = "plate"
phase = "solid"
box = { min = [-0.075, -0.075], max = [0.575, 0.0] }
clamp = [
    { min = [-0.075, -0.075], max = [0.0, 0.0] },
    { min = [0.5, -0.075], max = [0.575, 0.0] },
]
[[shape]]
name = "sides"
phase = "wall"
tank = { min = [0.0, 0.0], max = [0.5, 0.4], open = ["bottom", "top"] }
[[probe]]
name = "middle"
kind = "displacement"
at = [0.25, -0.0375]
"#;

/// A tenth of a period of half a standing wave.
const WAVE: &str = r#"
resolution = 0.025
end_time = 0.1
gravity = [0.0, -9.81]
[fluid]
density = 1000.0
sound_speed = 20.0
[output]
frame_interval = 1.0
probe_interval = 1e-3
[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [0.5, 0.2] }
pressure = "hydrostatic"
velocity_field = { kind = "standing-wave", amplitude = 0.01, origin = [0.0, 0.0], half_wave = 0.5, depth = 0.2 }
[[shape]]
name = "tank"
phase = "wall"
tank = { min = [0.0, 0.0], max = [0.5, 0.4], open = ["top"] }
[[probe]]
name = "middle"
kind = "centroid"
phase = "fluid"
"#;

fn write(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("order.toml");
    std::fs::write(&path, text).unwrap();
    path
}

/// Observed order of a probe's curve, from its largest differences between runs with 4, 2 and 1 times `dt`, s.
fn order(what: &str, run: impl Fn() -> RunBuilder, probe: &str, dt: f64) -> f64 {
    let curves: Vec<Curve> = [4.0, 2.0, 1.0]
        .map(|times| run().set("time_step", times * dt).in_process().threads(1).run().curve(probe))
        .into();
    let difference = |a: &Curve, b: &Curve| {
        let apart = |(&t, &v): (&f64, &f64)| {
            assert!((b.at(t) - b.at(t + 1e-9)).abs() < 1e-6, "rows of both runs are at the same instants");
            (v - b.at(t)).abs()
        };
        a.times.iter().zip(&a.values).map(apart).fold(0.0, f64::max)
    };
    let differences = [difference(&curves[0], &curves[1]), difference(&curves[1], &curves[2])];
    let order = (differences[0] / differences[1]).log2();
    println!("{what}: differences {:.2e} and {:.2e} m, order {order:.2}", differences[0], differences[1]);
    order
}

#[test]
fn fluid_and_solid_are_of_second_order_together() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), FLOOR);
    for model in ["total-lagrangian", "hypoelastic"] {
        for sub_steps in [2, 4] {
            let run = || {
                let run = scene_at(&path).set("solid.sub_steps", sub_steps).set("solid.model", model);
                run.set("effects.frozen-diffusion", "off")
            };
            // The mean velocity of stage 0 as it is, which belongs to n + 1/4, gives 1.0 here.
            let found = order(&format!("{model}, {sub_steps} sub-steps"), run, "middle.y", 5e-5);
            assert!((1.85..2.15).contains(&found), "{found}");
        }
    }
}

#[test]
fn the_fluid_alone_is_of_second_order() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), WAVE);
    // Shifting is once a step, and separation a switch.
    for (shifting, separation, band) in
        [("off", "off", 1.85..2.15), ("on", "off", 1.4..1.8), ("off", "on", 0.8..1.1)]
    {
        let run = || {
            let run = scene_at(&path).set("effects.frozen-diffusion", "off");
            run.set("effects.particle-shifting", shifting).set("effects.wall-separation", separation)
        };
        let what = format!("fluid alone, shifting {shifting}, separation {separation}");
        let found = order(&what, run, "middle.x", 5e-5);
        assert!(band.contains(&found), "{found}");
    }
}
