//! Solvers of others as solids: the examples in `python/examples`.

use halfstep_tests::python::python;
use halfstep_tests::run::{repository, scene_at};

/// A box of MuJoCo's floats as Archimedes says and heaves with the period of linear potential flow in this tank, 0.771 s
/// by finite elements: Laplace's equation, the linear free surface, the box's own motion. A period and a half, coarse.
#[test]
fn a_box_of_mujoco_floats_and_heaves() {
    let folder = repository().join("python/examples/mujoco");
    let line = format!("{} {}", python().display(), folder.join("floating_box.py").display());
    let run = scene_at(&folder.join("floating-box.toml"))
        .set("resolution", 0.02)
        .until(1.4)
        .argument("--solid")
        .argument(line)
        .run();
    let heave = run.curve("box.y");
    // Water 0.8 m x 0.25 m less the box's 0.2 m x 0.03 m, and the draught of 0.05 m.
    let level = (0.8 * 0.25 - 0.2 * 0.03 + 0.2 * 0.05) / 0.8;
    let mean = heave.between(0.38, 1.16).mean();
    println!("mean height {mean} m, at rest {level} m");
    assert!((mean - level).abs() < 0.0025, "{mean} m, expected {level} m");
    let extreme = |from: f64, to: f64, sign: f64| {
        let part = heave.between(from, to);
        let k = (0..part.values.len())
            .max_by(|&a, &b| (sign * part.values[a]).total_cmp(&(sign * part.values[b])));
        part.times[k.expect("rows")]
    };
    let period = extreme(0.9, 1.4, -1.0) - extreme(0.1, 0.6, -1.0);
    println!("period {period} s");
    assert!((period / 0.771 - 1.0).abs() < 0.08, "{period} s");
    assert!(run.report.audit.action_reaction.unwrap() <= 1e-12);
}
