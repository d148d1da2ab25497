//! Each joint by its formula: to space, to walls that move, between bodies, and more than one at a body.

use super::swing_tests::pendulum_period;
use super::*;
use crate::rigid::Vec3;
use std::f64::consts::{PI, TAU};

/// Another box of 0.2 m x 0.1 m, as far to the right, m.
pub(super) fn second(x: f64) -> String {
    BOX.replace("\"box\"", "\"second\"")
        .replace("[0.0, 0.0]", &format!("[{x}, 0.0]"))
        .replace("0.2, 0.1]", &format!("{}, 0.1]", x + 0.2))
}

/// A wall out of the way that moves.
fn mover(motion: &str) -> String {
    format!(
        "[[shape]]\nname = \"mover\"\nphase = \"wall\"\nbox = {{ min = [-3.0, -3.0], max = [-2.0, -2.0] }}\n\
         motion = {{ {motion} }}\n"
    )
}

pub(super) fn weightless(keys: &str, shapes: &str) -> Scene {
    let mut scene = scene(keys, shapes);
    scene.gravity = [0.0; 3];
    scene
}

/// Moment of a box about its centre, kg m, and its mass, kg/m.
pub(super) const MOMENT: f64 = 10.0 * 0.05 / 12.0;
pub(super) const MASS: f64 = 10.0;

/// Two boxes that are fixed to each other swing as one of twice the length, from the height of the pin.
#[test]
fn what_is_fixed_to_another_body_swings_with_it() {
    let keys = "joints = [{ name = \"pin\", kind = \"hinge\", body = \"box\", at = [0.0, 0.05] },\n\
                { name = \"weld\", kind = \"fixed\", body = \"second\", with = \"box\" }]";
    let mut model = build::<2>(&scene(keys, &(BOX.to_owned() + &second(0.2))));
    let load = free(&model);
    let inertia = 2.0 * MASS * ((0.4_f64.powi(2) + 0.1_f64.powi(2)) / 12.0 + 0.2_f64.powi(2));
    let right = pendulum_period(TAU * (inertia / (2.0 * MASS * G * 0.2)).sqrt(), 0.5 * PI);
    let dt = right / 2000.0;
    let (mut last, mut crossings) = (0.0, Vec::new());
    run(&mut model, 1.1 * right, dt, &load, |t, model| {
        let [a, b] = [0, 1].map(|k| model.states[k].angle[2]);
        // Lowest at a quarter turn.
        let angle = a + 0.5 * PI;
        if angle * last < 0.0 {
            crossings.push(t - dt * angle / (angle - last));
        }
        last = angle;
        let at: Vec3 = [0.3, 0.05, 0.0].into();
        let places = [0, 1].map(|k| model.system.bodies[k].place(&model.system.poses[k], &at));
        assert!((a - b).abs() < 1e-13 && (places[0] - places[1]).amax() < 1e-12, "{a} {b}");
    });
    let period = 2.0 * (crossings[1] - crossings[0]);
    println!("period {period:.6} s, right {right:.6} s");
    assert!((period / right - 1.0).abs() < 2e-6, "{period} {right}");
}

/// In space: a welded pair that tumbles keeps its angular momentum, and its parts their places.
#[test]
fn a_pair_that_is_fixed_in_space_tumbles_as_one() {
    let keys = "joints = [{ name = \"weld\", kind = \"fixed\", body = \"second\", with = \"box\" }]";
    let mut model = build::<3>(&deepen(weightless(keys, &(BOX.to_owned() + &second(0.2))), 0.3));
    let load = free(&model);
    // The pair turns about its middle, so each centre moves.
    let rate = Vec3::new(4.0, 3.0, 2.0);
    for k in 0..2 {
        let body = &model.system.bodies[k];
        let arm = body.center - Vec3::new(0.2, 0.05, 0.15);
        model.system.poses[k].spin = body.spin(&nalgebra::Matrix3::identity(), &rate);
        model.system.poses[k].velocity = rate.cross(&arm);
    }
    let momentum = |model: &Rigid<3>| -> Vec3 {
        let of = |k: usize| {
            let (body, pose) = (&model.system.bodies[k], &model.system.poses[k]);
            pose.spin + pose.center.cross(&pose.velocity) * body.mass
        };
        of(0) + of(1)
    };
    let start = momentum(&model);
    let mut energies = [f64::INFINITY, 0.0_f64];
    run(&mut model, 2.0, 1e-3, &load, |_, model| {
        let at: Vec3 = [0.3, 0.05, 0.2].into();
        let [a, b] = [0, 1].map(|k| model.system.bodies[k].place(&model.system.poses[k], &at));
        let apart = model.system.poses[0].rotation() - model.system.poses[1].rotation();
        assert!((a - b).amax() < 1e-12 && apart.amax() < 1e-12, "{a} {b}");
        let energy = model.system.kinetic_energy();
        energies = [energies[0].min(energy), energies[1].max(energy)];
    });
    let lost = (momentum(&model) - start).amax() / start.amax();
    println!("angular momentum to {lost:.1e}, energy to {:.1e}", energies[1] / energies[0] - 1.0);
    assert!(lost < 1e-12, "{lost}");
    assert!(energies[1] / energies[0] - 1.0 < 1e-5, "{energies:?}");
}

/// A second hinge on a wall that moves away, which the first one cannot follow: it is open by what the wall has gone.
#[test]
fn joints_that_come_apart_are_told() {
    let hinge = |name: &str, more: &str| {
        format!("{{ name = \"{name}\", kind = \"hinge\", body = \"box\", at = [0.1, 0.05]{more} }}")
    };
    let shapes = BOX.to_owned() + &mover("velocity = [0.3, 0.0]");
    for (joints, apart) in [
        (hinge("pin", ""), None),
        (hinge("pin", "") + ", " + &hinge("away", ", with = \"mover\""), Some(0.15)),
    ] {
        let mut model = build::<2>(&scene(&format!("joints = [{joints}]"), &shapes));
        let load = free(&model);
        run(&mut model, 0.5, 1e-2, &load, |_, _| ());
        let open = model.open_joints();
        assert_eq!(open.len(), usize::from(apart.is_some()), "{open:?}");
        assert!(
            open.iter().all(|(name, is)| name == "away"
                && Some(*is).zip(apart).is_some_and(|(a, b)| (a - b).abs() < 1e-9)),
            "{open:?}"
        );
    }
}

/// It is placed, and turns with the wall.
#[test]
fn what_is_fixed_to_a_wall_that_moves_goes_along() {
    let keys = "joints = [{ name = \"bolt\", kind = \"fixed\", body = \"box\", with = \"mover\" }]";
    let motion = "velocity = [0.3, 0.0], angular_velocity = 2.0, pivot = [0.0, 0.0]";
    let mut model = build::<2>(&scene(keys, &(BOX.to_owned() + &mover(motion))));
    let load = free(&model);
    run(&mut model, 1.5, 1e-2, &load, |time, model| {
        let (c, s) = ((2.0 * time).cos(), (2.0 * time).sin());
        let right = [0.1 * c - 0.05 * s + 0.3 * time, 0.1 * s + 0.05 * c];
        let state = &model.states[0];
        assert!((0..2).all(|d| (state.center[d] - right[d]).abs() < 1e-12), "{time} s: {state:?}");
        let speed = [0.3 - 2.0 * right[1], 2.0 * (right[0] - 0.3 * time)];
        assert!((0..2).all(|d| (state.velocity[d] - speed[d]).abs() < 1e-11), "{time} s: {state:?}");
    });
}

/// A bead on a rail that turns evenly about a point of it: r = r0 cosh(omega t), and the wall does the work.
#[test]
fn a_rail_of_a_wall_that_turns_throws_its_body_out() {
    let keys = "bodies = [{ name = \"box\", angular_velocity = 2.0 }]\n\
                joints = [{ name = \"arm\", kind = \"rail\", body = \"box\", with = \"mover\", at = [0.1, 0.05], \
                axis = [1.0, 0.0] }]";
    let shapes =
        format!("{BOX}velocity = [0.0, 0.2]\n{}", mover("angular_velocity = 2.0, pivot = [0.0, 0.05]"));
    let mut model = build::<2>(&weightless(keys, &shapes));
    let load = free(&model);
    model.keep_account();
    let start = model.states[0].kinetic_energy;
    let (mut worst, mut given) = (0.0_f64, 0.0);
    run(&mut model, 1.0, 1e-3, &load, |time, model| {
        let state = &model.states[0];
        let [x, y] = [state.center[0], state.center[1] - 0.05];
        worst = worst.max((x.hypot(y) / (0.1 * (2.0 * time).cosh()) - 1.0).abs());
        let across = y * (2.0 * time).cos() - x * (2.0 * time).sin();
        assert!(across.abs() < 1e-12 && (state.angle[2] - 2.0 * time).abs() < 1e-12, "{time} s: {state:?}");
        model.account(&mut |_, joules| given += joules);
    });
    let gained = model.states[0].kinetic_energy - start;
    // m omega² r0² (cosh² + sinh² - 1) / 2
    let right = MASS * 0.04 * 2.0_f64.sinh().powi(2);
    println!("way to {worst:.1e}, {gained:.6} J/m gained of {right:.6}, {given:.6} booked");
    assert!(worst < 2e-6, "{worst}");
    assert!((gained / right - 1.0).abs() < 1e-5 && (given / gained - 1.0).abs() < 1e-5, "{gained} {given}");
}

/// A box that falls along a rail stays at the lower stop; thrown up it stops at the upper one and falls from there.
#[test]
fn a_rail_has_stops() {
    let keys = "joints = [{ name = \"lift\", kind = \"rail\", body = \"box\", at = [0.1, 0.05], axis = [0.0, 1.0], \
                limits = [-0.1, 0.05] }]";
    for speed in [0.0, 2.0] {
        let mut model = build::<2>(&scene(keys, &format!("{BOX}velocity = [0.0, {speed}]\n")));
        let load = free(&model);
        // From where it falls, and when.
        let (top, begin) = match speed {
            0.0 => (0.0, 0.0),
            _ => (0.05, (speed - (speed * speed - 2.0 * G * 0.05).sqrt()) / G),
        };
        let (mut worst, mut highest) = (0.0_f64, 0.0_f64);
        run(&mut model, 0.4, 1e-4, &load, |time, model| {
            let y = model.states[0].center[1] - 0.05;
            let right = match time < begin {
                true => speed * time - 0.5 * G * time * time,
                false => (top - 0.5 * G * (time - begin).powi(2)).max(-0.1),
            };
            worst = worst.max((y - right).abs());
            highest = highest.max(y);
        });
        let state = &model.states[0];
        println!("{speed} m/s: off by {worst:.1e} m, at most at {highest:.6} m");
        // The impact is within a step, 2 m/s or less times 1e-4 s.
        assert!(worst < 2e-4 && highest < 0.05 + 1e-9, "{worst} {highest}");
        assert!((state.center[1] + 0.05).abs() < 1e-9 && state.kinetic_energy < 1e-20, "{state:?}");
        assert!(state.angle[2].abs() < 1e-15 && (state.center[0] - 0.1).abs() < 1e-13, "{state:?}");
    }
}

/// A box that hangs by its end from a rail without friction: nothing pushes its centre sideways, and at the lowest
/// place all that it has lost is in its rotation, I omega² / 2 = m g l.
#[test]
fn a_rail_lets_turn_what_may() {
    let keys = "joints = [{ name = \"slide\", kind = \"rail\", body = \"box\", at = [0.0, 0.05], axis = [1.0, 0.0], \
                turns = true }]";
    let mut model = build::<2>(&scene(keys, BOX));
    let load = free(&model);
    let mut fastest = 0.0_f64;
    run(&mut model, 0.5, 1e-4, &load, |_, model| {
        let state = &model.states[0];
        let depth = 0.1 * state.angle[2].sin();
        assert!((state.center[0] - 0.1).abs() < 1e-12, "{state:?}");
        assert!((state.center[1] - 0.05 - depth).abs() < 1e-12, "{state:?}");
        fastest = fastest.max(-state.angular_velocity[2]);
    });
    let right = (2.0 * MASS * G * 0.1 / MOMENT).sqrt();
    println!("{fastest:.6} rad/s of {right:.6}");
    assert!((fastest / right - 1.0).abs() < 1e-5, "{fastest} {right}");
}

/// Two pins hold a body as a fixed joint does; two rails on one line let it slide as one does.
#[test]
fn a_body_may_be_held_twice() {
    let keys = "joints = [{ name = \"a\", kind = \"hinge\", body = \"box\", at = [0.0, 0.05] },\n\
                { name = \"b\", kind = \"hinge\", body = \"box\", at = [0.2, 0.05] }]";
    let mut model = build::<2>(&scene(keys, BOX));
    let load = free(&model);
    run(&mut model, 1.0, 1e-3, &load, |_, _| {});
    let state = &model.states[0];
    assert!((state.center[1] - 0.05).abs() < 1e-13 && state.angle[2].abs() < 1e-13, "{state:?}");
    assert!(state.kinetic_energy < 1e-24, "{state:?}");
    let keys = "joints = [{ name = \"a\", kind = \"rail\", body = \"box\", at = [0.0, 0.05], axis = [3.0, -4.0] },\n\
                { name = \"b\", kind = \"rail\", body = \"box\", at = [0.15, -0.15], axis = [3.0, -4.0] }]";
    let mut model = build::<2>(&scene(keys, BOX));
    run(&mut model, 1.0, 1e-3, &load, |time, model| {
        let (state, way) = (&model.states[0], 0.5 * 0.8 * G * time * time);
        let [x, y] = [state.center[0] - 0.1, state.center[1] - 0.05];
        assert!((x - 0.6 * way).abs() < 1e-11 && (y + 0.8 * way).abs() < 1e-11, "{time} s: {state:?}");
        assert!(state.angle[2].abs() < 1e-13, "{state:?}");
    });
}

/// 4000 N/m² under 10 kg/m: omega = 20 1/s. A spring of no length pulls along both axes; one that is not said to rest
/// elsewhere begins without force. Velocity Verlet is off by (omega dt)² / 24 of the phase.
#[test]
fn a_spring_to_space_swings_as_its_formula_says() {
    let spring = |rest: &str| {
        format!(
            "joints = [{{ name = \"k\", kind = \"spring\", body = \"box\", at = [0.1, 0.05], to = [0.1, 0.25], \
             stiffness = 4000.0{rest} }}]"
        )
    };
    let sag = G / 400.0;
    // Along y from where it rests with the weight; along x from the point that it is tied to.
    for (rest, at_rest, speed) in [("", 0.05 - sag, 0.0), (", rest = 0.0", 0.25 - sag, 1.0)] {
        let mut model = build::<2>(&scene(&spring(rest), &format!("{BOX}velocity = [{speed}, 0.0]\n")));
        let load = free(&model);
        let mut worst = 0.0_f64;
        run(&mut model, 1.0, 1e-4, &load, |time, model| {
            let right =
                [0.1 + speed / 20.0 * (20.0 * time).sin(), at_rest + (0.05 - at_rest) * (20.0 * time).cos()];
            let state = &model.states[0];
            worst = worst.max((state.center[0] - right[0]).hypot(state.center[1] - right[1]));
            assert!(state.angle[2].abs() < 1e-10, "it pulls at the centre: {state:?}");
        });
        println!("rest{rest}: {worst:.1e} m off of {:.3}", (0.05 - at_rest).abs());
        assert!(worst < 20.0 * (20.0 * 1e-4_f64).powi(2) / 24.0 * 0.25, "{worst}");
    }
}

/// Between two bodies of 10 kg/m, stretched by 10 mm: the reduced mass is half of one, their middle stays.
#[test]
fn a_spring_between_two_bodies_swings_about_their_middle() {
    let keys = "joints = [{ name = \"k\", kind = \"spring\", body = \"second\", with = \"box\", at = [0.4, 0.05], \
                to = [0.1, 0.05], stiffness = 2000.0, damping = 20.0, rest = 0.29 }]";
    let mut model = build::<2>(&weightless(keys, &(BOX.to_owned() + &second(0.3))));
    let load = free(&model);
    // omega0² = 2000 / 5, delta = 20 / (2 * 5).
    let (delta, omega) = (2.0, (400.0_f64 - 4.0).sqrt());
    let mut worst = 0.0_f64;
    run(&mut model, 1.0, 1e-4, &load, |t, model| {
        let [a, b] = [0, 1].map(|k| model.states[k].center[0]);
        let way = 0.29 + 0.01 * (-delta * t).exp() * ((omega * t).cos() + delta / omega * (omega * t).sin());
        worst = worst.max((b - a - way).abs());
        assert!((a + b - 0.5).abs() < 1e-12, "{a} {b}");
    });
    println!("{worst:.1e} m off");
    assert!(worst < 2e-8, "{worst}");
}

/// A damper alone, along both axes: v = v0 exp(-c t / m), whatever the way.
#[test]
fn a_damper_slows_along_both_axes() {
    let keys = "joints = [{ name = \"c\", kind = \"spring\", body = \"box\", at = [0.1, 0.05], damping = 20.0, \
                rest = 0.0 }]";
    let mut model = build::<2>(&weightless(keys, &format!("{BOX}velocity = [0.6, 0.8]\n")));
    let load = free(&model);
    run(&mut model, 1.0, 1e-3, &load, |_, _| {});
    let (state, kept) = (&model.states[0], (-2.0_f64).exp());
    println!("{:.7} m/s of {:.7}", state.velocity[0], 0.6 * kept);
    // Of second order: (c dt / m)² / 6 a step's part, times c t / m.
    let part = 2.0 * (2e-3_f64).powi(2) / 6.0;
    assert!((state.velocity[0] / (0.6 * kept) - 1.0).abs() < part, "{state:?}");
    assert!((state.velocity[1] / (0.8 * kept) - 1.0).abs() < part, "{state:?}");
    let gone = 0.5 * (1.0 - kept);
    assert!(
        (state.center[0] - 0.1 - 0.6 * gone).abs() < part
            && (state.center[1] - 0.05 - 0.8 * gone).abs() < part
    );
}

/// A hinge's spring toward an angle: I phi'' = -k (phi - rest) - c phi', at any amplitude.
#[test]
fn a_hinge_turns_to_where_its_spring_rests() {
    let inertia = MOMENT + MASS * 0.01;
    let (stiffness, damping) = (100.0 * inertia, 2.0 * inertia);
    let keys = format!(
        "joints = [{{ name = \"pin\", kind = \"hinge\", body = \"box\", at = [0.0, 0.05], stiffness = {stiffness}, \
         damping = {damping}, rest = 2.0 }}]"
    );
    let mut model = build::<2>(&weightless(&keys, BOX));
    let load = free(&model);
    let (delta, omega) = (1.0, 99.0_f64.sqrt());
    let mut worst = 0.0_f64;
    run(&mut model, 2.0, 2e-4, &load, |t, model| {
        let swing = (-delta * t).exp() * ((omega * t).cos() + delta / omega * (omega * t).sin());
        worst = worst.max((model.states[0].angle[2] - 2.0 * (1.0 - swing)).abs());
    });
    println!("{worst:.1e} rad off");
    assert!(worst < 5e-6, "{worst}");
}

/// A motor: a wall that turns takes the body along by the damper of its hinge, omega (1 - exp(-c t / I)).
#[test]
fn a_wall_that_turns_drives_a_hinge() {
    let inertia = MOMENT + MASS * 0.01;
    let keys = format!(
        "joints = [{{ name = \"motor\", kind = \"hinge\", body = \"box\", with = \"mover\", at = [0.0, 0.05], \
         damping = {} }}]",
        3.0 * inertia
    );
    let shapes = BOX.to_owned() + &mover("angular_velocity = 2.0, pivot = [0.0, 0.05]");
    let mut model = build::<2>(&weightless(&keys, &shapes));
    let load = free(&model);
    let mut worst = 0.0_f64;
    run(&mut model, 1.0, 1e-3, &load, |time, model| {
        // At 0 s the wall is at rest yet, so the first half of a step does nothing.
        let right = 2.0 * (1.0 - (-3.0 * (time - 0.5e-3)).exp());
        worst = worst.max((model.states[0].angular_velocity[2] - right).abs());
    });
    println!("{worst:.1e} rad/s off");
    assert!(worst < 5e-6, "{worst}");
}

/// The stops of such a hinge turn with the wall: the body stays until it is at one, and is then taken along.
#[test]
fn the_stops_of_a_hinge_turn_with_its_wall() {
    let keys = "joints = [{ name = \"pin\", kind = \"hinge\", body = \"box\", with = \"mover\", at = [0.0, 0.05], \
                limits = [-0.5, 0.5] }]";
    let shapes = BOX.to_owned() + &mover("angular_velocity = 2.0, pivot = [0.0, 0.05]");
    let mut model = build::<2>(&weightless(keys, &shapes));
    let load = free(&model);
    let mut worst = 0.0_f64;
    run(&mut model, 1.0, 1e-3, &load, |time, model| {
        worst = worst.max((model.states[0].angle[2] - (2.0 * time - 0.5).max(0.0)).abs());
    });
    println!("{worst:.1e} rad off");
    // Found within a step: 2 rad/s times 1 ms.
    assert!(worst < 2e-3, "{worst}");
    assert!((model.states[0].angular_velocity[2] - 2.0).abs() < 1e-12, "{:?}", model.states[0]);
}

/// A pendulum whose pin goes to and fro by A sin(W t): I phi'' = -m l (g phi + x''), from rest with the pin's speed.
#[test]
fn a_pendulum_hangs_from_a_wall_that_moves() {
    let (amplitude, period) = (1e-4, 0.5);
    let keys =
        "joints = [{ name = \"pin\", kind = \"hinge\", body = \"box\", with = \"mover\", at = [0.1, 0.35] }]";
    let rate = TAU / period;
    let shapes = format!(
        "{BOX}velocity = [{}, 0.0]\n{}",
        amplitude * rate,
        mover(&format!("amplitude = [{amplitude}, 0.0], period = {period}"))
    );
    let mut model = build::<2>(&scene(keys, &shapes));
    let load = free(&model);
    let lever = MASS * 0.3 / (MOMENT + MASS * 0.09);
    let own = (lever * G).sqrt();
    let most = lever * amplitude * rate * rate / (own * own - rate * rate);
    let mut worst = 0.0_f64;
    run(&mut model, 2.0, 5e-4, &load, |t, model| {
        let right = most * ((rate * t).sin() - rate / own * (own * t).sin());
        worst = worst.max((model.states[0].angle[2] - right).abs());
    });
    println!("{worst:.1e} rad off of {most:.1e}");
    assert!(worst < 2e-5 * most.abs(), "{worst} of {most}");
}
