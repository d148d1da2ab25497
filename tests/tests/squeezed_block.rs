//! The total-Lagrangian sub-step follows the stiffness of the deformed solid: what blows up with the limit of the state
//! at rest lives with that of the present one, and where the state is nearly that at rest nothing changes.

use halfstep_output::run_json::RunStatus;
use halfstep_tests::run::scene_at;
use halfstep_tests::{Finished, RunBuilder};
use std::path::Path;

/// A block between two clamps, of which one comes nearer until 35 of the 80 mm between them are left.
const BLOCK: &str = r#"
resolution = 0.005
end_time = 0.05
gravity = [0.0, 0.0]
[solid]
density = 1000.0
youngs_modulus = 1e6
poissons_ratio = 0.3
[[shape]]
name = "block"
phase = "solid"
box = { min = [-0.02, 0.0], max = [0.1, 0.06] }
clamp = [
  { min = [-0.02, 0.0], max = [0.0, 0.06] },
  { min = [0.08, 0.0], max = [0.1, 0.06], with = "press" },
]
[[shape]]
name = "press"
phase = "wall"
box = { min = [0.2, 0.0], max = [0.22, 0.06] }
motion = { velocity = [-1.0, 0.0], end = 0.045 }
"#;

fn run(folder: &Path, text: &str) -> RunBuilder {
    let path = folder.join("block.toml");
    std::fs::write(&path, text).expect("a scene");
    scene_at(&path).in_process()
}

/// Largest and smallest step, s. The first one is that of the state at rest.
fn steps(run: &Finished) -> [f64; 2] {
    [run.report.dt.max, run.report.dt.min].map(|dt| dt.expect("steps"))
}

/// With this time step, s, the run diverges.
fn diverges(run: RunBuilder, dt: f64) {
    let outcome = run.set("time_step", dt).outcome();
    assert_eq!(outcome.report().status, Some(RunStatus::Diverged), "{}", outcome.stderr);
}

#[test]
fn a_block_squeezed_to_less_than_half_lives_with_the_steps_of_its_present_state() {
    let folder = tempfile::tempdir().expect("a folder");
    // The largest that a scene may ask for: the default, 0.6, has a margin of its own.
    let block = || run(folder.path(), BLOCK).set("numerics.solid_cfl", 0.9);
    let whole = block().run();
    let (at_rest, squeezed) = (0.9 / 0.6 * steps(&run(folder.path(), BLOCK).run())[0], steps(&whole)[1]);
    println!("step {at_rest:.3e} s at rest, {squeezed:.3e} s squeezed, {} steps", whole.report.steps);
    assert!(squeezed < 0.6 * at_rest);
    diverges(block(), at_rest);
}

/// The explicit damping of a large A limits the step, too.
#[test]
fn a_strongly_damped_block_lives() {
    let folder = tempfile::tempdir().expect("a folder");
    let free = BLOCK.replace("end = 0.045", "end = 0.005").replace("0.05\ngravity", "0.01\ngravity");
    let [plain, _] = steps(&run(folder.path(), &free).run());
    let damped = || run(folder.path(), &free).set("solid.artificial_viscosity.linear", 10);
    let [strong, _] = steps(&damped().run());
    println!("step {plain:.3e} s, with A = 10 {strong:.3e} s");
    assert!(strong < 0.5 * plain);
    diverges(damped(), plain);
}
