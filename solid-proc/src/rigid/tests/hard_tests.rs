//! Rigid bodies where solvers of contact and rotation lose their way.

use super::*;

/// A heavy box between two light ones, each of 0.2 x 0.1 m, on a floor: mass ratio 1000 in a stack.
#[test]
fn a_heavy_box_between_two_light_ones_stays() {
    let boxes: String = [10.0, 10_000.0, 10.0]
        .into_iter()
        .enumerate()
        .map(|(k, density)| {
            let (low, high) = (0.1 * k as f64, 0.1 * (k + 1) as f64);
            format!(
                "[[shape]]\nname = \"b{k}\"\nphase = \"solid\"\ndensity = {density}\n\
                 box = {{ min = [0.0, {low}], max = [0.2, {high}] }}\n"
            )
        })
        .collect();
    let mut model = build::<2>(&scene("contact = { friction = 0.4 }", &(boxes + FLOOR)));
    let load = free(&model);
    let mut off = 0.0_f64;
    run(&mut model, 2.0, 1e-3, &load, |_, model| {
        for (k, state) in model.states.iter().enumerate() {
            let right = [0.1, 0.05 + 0.1 * k as f64];
            off = off.max((state.center[0] - right[0]).abs()).max((state.center[1] - right[1]).abs());
        }
    });
    println!("at most {off:.2e} m off their places");
    assert!(off < 3e-6, "{off:e} m");
    assert!(model.states.iter().all(|state| state.kinetic_energy < 1e-12), "{:?}", model.states);
    // The light one below carries 2 kg/m³ x 0.02 m² of its own kind and the heavy one.
    let carried = model.states[1].contact_force[1];
    assert!((carried / (200.0 * G) - 1.0).abs() < 1e-6, "{carried} N/m");
}

/// 0.2 rad a step: far beyond what a step limit would let it take, and still exact in the plane.
#[test]
fn a_bar_that_spins_fast_turns_evenly() {
    let said = "bodies = [{ name = \"bar\", angular_velocity = 200.0 }]";
    let bar = "[[shape]]\nname = \"bar\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.4, 0.02] }\n";
    let mut scene = scene(said, bar);
    scene.gravity = [0.0; 3];
    let mut model = build::<2>(&scene);
    let load = free(&model);
    let before = model.states[0].kinetic_energy;
    run(&mut model, 2.0, 1e-3, &load, |_, _| {});
    let state = &model.states[0];
    let energy = state.kinetic_energy / before - 1.0;
    println!("{:.2e} rad off 400 rad, energy changed by {energy:.1e}", state.angle[2] - 400.0);
    // 2000 sums, each rounded by at most half of 5.7e-14.
    assert!((state.angle[2] - 400.0).abs() < 6e-11, "{}", state.angle[2]);
    assert!(energy.abs() < 1e-13 && (state.center[0] - 0.2).abs() < 1e-12, "{state:?}");
}
