//! Bodies that fall, slide, roll, stack and knock, by hand.

use super::*;
use crate::rigid::Vec3;

#[test]
fn a_falling_box_comes_to_rest_on_the_floor() {
    let shape = BOX.replace("[0.0, 0.0]", "[0.0, 0.05]").replace("0.2, 0.1]", "0.2, 0.15]");
    for restitution in [0.0, 0.6] {
        let keys = format!("contact = {{ restitution = {restitution} }}");
        let mut model = build::<2>(&scene(&keys, &(shape.clone() + FLOOR)));
        let load = free(&model);
        let (mut lowest, mut after) = (f64::INFINITY, 0.0_f64);
        run(&mut model, 2.0, 5e-4, &load, |t, model| {
            lowest = model.states[0].center[1].min(lowest);
            // Between the first two impacts.
            if t > 0.105 && t < 0.2 {
                after = after.max(model.states[0].center[1] - 0.05);
            }
        });
        println!("restitution {restitution}: lowest {:.2e}, rises again by {after:.5} m", lowest - 0.05);
        assert!(lowest > 0.05 - 1e-6, "{lowest}");
        assert!((after - restitution * restitution * 0.05).abs() < 1e-3, "{after}");
        let state = &model.states[0];
        assert!((state.center[1] - 0.05).abs() < 2e-6 && state.kinetic_energy < 1e-12, "{state:?}");
        assert!((state.contact_force[1] / (10.0 * G) - 1.0).abs() < 1e-9, "{:?}", state.contact_force);
    }
}

#[test]
fn a_sliding_block_stops_after_its_way() {
    let keys = "contact = { friction = 0.3 }";
    let shape = format!("{BOX}velocity = [1.0, 0.0]\n{FLOOR}");
    let mut model = build::<2>(&scene(keys, &shape));
    let load = free(&model);
    run(&mut model, 1.0, 5e-4, &load, |_, _| {});
    let way = model.states[0].center[0] - 0.1;
    let right = 1.0 / (2.0 * 0.3 * G);
    println!("way {way:.6} m, v² / (2 mu g) {right:.6} m");
    assert!((way / right - 1.0).abs() < 5e-6, "{way} {right}");
    assert!(model.states[0].kinetic_energy < 1e-20);
}

/// A wall's `velocity`, its surface's, which stays where it is: mu g up to the belt's speed, then rest on it.
#[test]
fn a_belt_takes_a_block_along() {
    let shape = format!("{BOX}{FLOOR}velocity = [0.5, 0.0]\n");
    let mut model = build::<2>(&scene("contact = { friction = 0.3 }", &shape));
    let load = free(&model);
    model.keep_account();
    let mut given = 0.0;
    run(&mut model, 0.5, 5e-4, &load, |time, model| {
        let right = (0.3 * G * time).min(0.5);
        let speed = model.states[0].velocity[0];
        assert!((speed - right).abs() < 2e-3, "{time} s: {speed} m/s, by hand {right}");
        model.account(&mut |_, joules| given += joules);
    });
    // 10 kg/m at 0.5 m/s.
    let held = model.states[0].kinetic_energy;
    println!("{held:.6} J/m, given {given:.6} J/m");
    assert!((held / 1.25 - 1.0).abs() < 1e-6, "{held}");
    assert!((given / held - 1.0).abs() < 1e-3, "{given} {held}");
}

#[test]
fn a_block_on_a_slope_holds_below_the_angle_of_friction() {
    // A slope is gravity at an angle.
    let go = |friction: f64| {
        let mut scene = scene(&format!("contact = {{ friction = {friction} }}"), &(BOX.to_owned() + FLOOR));
        let angle = 0.3_f64;
        scene.gravity = [G * angle.sin(), -G * angle.cos(), 0.0];
        let mut model = build::<2>(&scene);
        let load = free(&model);
        run(&mut model, 1.0, 5e-4, &load, |_, _| {});
        model.states[0].center[0] - 0.1
    };
    let holding = go(1.01 * 0.3_f64.tan());
    assert!(holding.abs() < 1e-12, "{holding}");
    let sliding = go(0.9 * 0.3_f64.tan());
    let right = 0.5 * 0.1 * G * 0.3_f64.sin();
    println!("slides {sliding:.6} m, g (sin - mu cos) t² / 2 = {right:.6} m");
    assert!((sliding / right - 1.0).abs() < 1e-6, "{sliding} {right}");
}

#[test]
fn a_disc_rolls_down_a_slope() {
    let disc =
        "[[shape]]\nname = \"disc\"\nphase = \"solid\"\ndisc = { center = [0.0, 0.1], radius = 0.1 }\n";
    let mut scene = scene("contact = { friction = 0.5 }", &(disc.to_owned() + FLOOR));
    let angle = 0.3_f64;
    scene.gravity = [G * angle.sin(), -G * angle.cos(), 0.0];
    let mut model = build::<2>(&scene);
    let load = free(&model);
    run(&mut model, 1.0, 5e-4, &load, |_, _| {});
    let state = &model.states[0];
    // a = g sin / (1 + I / (m r²)).
    let body = &model.system.bodies[0];
    let inertia = body.spin(&nalgebra::Matrix3::identity(), &Vec3::z())[2];
    let right = 0.5 * G * angle.sin() / (1.0 + inertia / (body.mass * 0.01));
    println!("rolls {:.6} m, right {right:.6} m", state.center[0]);
    assert!((state.center[0] / right - 1.0).abs() < 1e-3);
    assert!(
        (state.angle[2] + state.center[0] / 0.1).abs() < 1e-3 * state.center[0] / 0.1,
        "it does not slide"
    );
}

#[test]
fn a_stack_of_four_stays() {
    stack(4, 0.3);
}

#[test]
#[ignore = "seconds"]
fn a_stack_of_ten_stays() {
    stack(10, 1.0);
}

/// Boxes that stand on each other are at rest after a time, s, where they were.
fn stack(count: usize, end: f64) {
    let boxes: String = (0..count)
        .map(|k| {
            let (low, high) = (0.1 * k as f64, 0.1 * (k + 1) as f64);
            format!("[[shape]]\nname = \"b{k}\"\nphase = \"solid\"\nbox = {{ min = [0.0, {low}], max = [0.2, {high}] }}\n")
        })
        .collect();
    let mut model = build::<2>(&scene("contact = { friction = 0.4 }", &(boxes + FLOOR)));
    let load = free(&model);
    run(&mut model, end, 1e-3, &load, |_, _| {});
    for (k, state) in model.states.iter().enumerate() {
        let right = 0.05 + 0.1 * k as f64;
        assert!(
            (state.center[1] - right).abs() < 1e-11 && (state.center[0] - 0.1).abs() < 1e-11,
            "{state:?}"
        );
        assert!(state.kinetic_energy < 1e-15, "{state:?}");
    }
    assert!((model.states[count - 1].contact_force[1] / (10.0 * G) - 1.0).abs() < 1e-6);
}

/// Speeds of three equal discs in a row, m/s, after the first one came with 1 m/s.
fn cradle(gap: f64, restitution: f64, dt: f64) -> Vec<f64> {
    let disc = |k: usize| {
        let (x, v) = ((0.2 + gap) * k as f64, if k == 0 { 1.0 } else { 0.0 });
        format!(
            "[[shape]]\nname = \"d{k}\"\nphase = \"solid\"\ndisc = {{ center = [{x}, 1.0], radius = 0.1 }}\n\
             velocity = [{v}, 0.0]\n"
        )
    };
    let keys = format!("contact = {{ restitution = {restitution} }}");
    let mut scene = scene(&keys, &(0..3).map(disc).collect::<String>());
    scene.gravity = [0.0; 3];
    let mut model = build::<2>(&scene);
    let load = free(&model);
    run(&mut model, 0.2, dt, &load, |_, _| {});
    model.states.iter().map(|s| s.velocity[0]).collect()
}

/// With gaps above and below what a sub-step goes, and without: by collisions of two after two. With e = 1/2 the first
/// keeps (1 - e) / 2 = 1/4 and the second takes 3/4, of which it keeps 3/16 and gives 9/16 on; then the first catches
/// up with the second, at 1/16: 3/64 go over.
#[test]
fn a_cradle_hands_the_momentum_on() {
    for (restitution, right) in
        [(1.0, [0.0, 0.0, 1.0]), (0.5, [0.25 - 3.0 / 64.0, 3.0 / 16.0 + 3.0 / 64.0, 9.0 / 16.0])]
    {
        for (gap, dt) in [(0.01, 1e-4), (1e-3, 2e-3), (1e-4, 2e-3), (1e-7, 2e-3), (0.0, 2e-3)] {
            let speeds = cradle(gap, restitution, dt);
            for (speed, right) in speeds.iter().zip(right) {
                assert!(
                    (speed - right).abs() < 1e-6,
                    "e = {restitution}, gap {gap} m: {speeds:?}, not {right}"
                );
            }
        }
    }
}

/// A disc in the hollow of a ring stays there.
#[test]
fn a_ring_is_hollow() {
    let ring = "[[shape]]\nname = \"ring\"\nphase = \"solid\"\nring = { center = [0.0, 0.3], inner = 0.2, outer = 0.3 }\n\
                [[shape]]\nname = \"disc\"\nphase = \"solid\"\ndisc = { center = [0.05, 0.25], radius = 0.08 }\n";
    let mut model = build::<2>(&scene("contact = { friction = 0.2 }", &format!("{ring}{FLOOR}")));
    let load = free(&model);
    run(&mut model, 1.0, 5e-4, &load, |_, model| {
        let [ring, disc] = [0, 1].map(|k| model.states[k].center);
        let apart = (ring[0] - disc[0]).hypot(ring[1] - disc[1]);
        assert!(apart < 0.2 - 0.08 + 1e-3, "the disc is {apart} m from the middle of the ring");
    });
    assert!((model.states[0].center[1] - 0.3).abs() < 2e-3, "the ring stands on the floor");
}
