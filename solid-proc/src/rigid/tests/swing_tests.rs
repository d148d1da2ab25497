//! Pendulums, springs and hinges that swing, by hand.

use super::*;
use crate::rigid::Vec3;
use std::f64::consts::TAU;

/// T = T0 2 K(sin(A/2)) / pi, K by the arithmetic-geometric mean.
pub(super) fn pendulum_period(t0: f64, amplitude: f64) -> f64 {
    let (mut a, mut b) = (1.0, (0.5 * amplitude).cos());
    for _ in 0..30 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    t0 / a
}

#[test]
fn a_pendulum_has_its_period_at_any_amplitude() {
    // Hung at its upper left corner, it starts to the right of the lowest place by the angle of its diagonal.
    for at in [[0.1, 0.1], [0.1, 0.5]] {
        for amplitude in [0.1_f64, 2.5] {
            let keys = format!(
                "joints = [{{ name = \"pin\", kind = \"hinge\", body = \"box\", at = [{}, {}] }}]",
                at[0], at[1]
            );
            let mut model = build::<2>(&scene(&keys, BOX));
            let load = free(&model);
            // Turned about the pin before it starts.
            let arm = at[1] - 0.05;
            let pose = &mut model.system.poses[0];
            pose.angle = amplitude;
            pose.center = Vec3::new(at[0] + arm * amplitude.sin(), at[1] - arm * amplitude.cos(), 0.0);
            model.system.bodies[0].drift(&mut model.system.poses[0], 0.0);
            let i = 10.0 * 0.05 / 12.0 + 10.0 * arm * arm;
            let right = pendulum_period(TAU * (i / (10.0 * G * arm)).sqrt(), amplitude);
            let dt = right / 2000.0;
            let start = -10.0 * G * arm * amplitude.cos();
            let (mut last, mut crossings, mut worst) = (amplitude, Vec::new(), 0.0_f64);
            run(&mut model, 2.2 * right, dt, &load, |t, model| {
                let (angle, energy) = {
                    let state = &model.states[0];
                    (state.angle[2], state.kinetic_energy + 10.0 * G * (state.center[1] - at[1]))
                };
                if last > 0.0 && angle <= 0.0 {
                    crossings.push(t - dt * angle / (angle - last));
                }
                last = angle;
                worst = worst.max((energy - start).abs());
                // The pin stays.
                let pin = model.system.bodies[0].place(&model.system.poses[0], &[at[0], at[1], 0.0].into());
                assert!((pin - Vec3::new(at[0], at[1], 0.0)).amax() < 1e-12);
            });
            let period = crossings[1] - crossings[0];
            println!(
                "amplitude {amplitude}: period {period:.6} s, right {right:.6} s, energy {:.1e}",
                worst / start.abs()
            );
            assert!((period / right - 1.0).abs() < 1e-5, "{period} {right}");
            assert!(worst < 1e-4 * 20.0 * G * arm);
        }
    }
}

#[test]
fn a_pendulum_is_of_second_order() {
    let end = |steps: f64| {
        let keys = "joints = [{ name = \"pin\", kind = \"hinge\", body = \"box\", at = [0.0, 0.1] }]";
        let mut model = build::<2>(&scene(keys, BOX));
        let load = free(&model);
        run(&mut model, 0.5, 0.5 / steps, &load, |_, _| {});
        model.states[0].angle[2]
    };
    let (coarse, middle, fine) = (end(100.0), end(200.0), end(400.0));
    let order = ((coarse - middle) / (middle - fine)).log2();
    println!("order {order:.3}");
    assert!((order - 2.0).abs() < 0.1, "{order}");
}

/// A pin lets a damper turn the body about it, not about its centre of mass.
#[test]
fn a_damped_pendulum_is_of_second_order() {
    let end = |steps: f64| {
        let keys =
            "joints = [{ name = \"pin\", kind = \"hinge\", body = \"box\", at = [0.0, 0.1], damping = 1.0 }]";
        let mut model = build::<2>(&scene(keys, BOX));
        let load = free(&model);
        run(&mut model, 0.5, 0.5 / steps, &load, |_, _| {});
        model.states[0].angle[2]
    };
    let [coarse, middle, fine] = [100.0, 200.0, 400.0].map(end);
    let order = ((coarse - middle) / (middle - fine)).abs().log2();
    println!("order {order:.3}");
    assert!((order - 2.0).abs() < 0.1, "{order}");
}

#[test]
fn a_spring_swings_and_a_damper_decays() {
    // 10 kg/m on 4000 N/m², from 1 cm above its rest: the way x = 0.01 cos(20 t).
    let keys = "joints = [{ name = \"k\", kind = \"rail\", body = \"box\", at = [0.1, 0.05], axis = [1.0, 0.0], \
                stiffness = 4000.0, damping = 40.0, rest = -0.01 }]";
    let mut model = build::<2>(&scene(keys, BOX));
    let load = free(&model);
    // omega0 = 20, delta = 40 / 20 = 2 1/s.
    let (delta, omega) = (2.0, (400.0_f64 - 4.0).sqrt());
    let mut worst = 0.0_f64;
    run(&mut model, 1.0, 1e-4, &load, |t, model| {
        let x = model.states[0].center[0] - 0.1;
        let way = 0.01 * (-delta * t).exp() * ((omega * t).cos() + delta / omega * (omega * t).sin()) - 0.01;
        worst = worst.max((x - way).abs());
        assert!((model.states[0].center[1] - 0.05).abs() < 1e-13, "the rail carries it");
        assert!(model.states[0].angle[2].abs() < 1e-15);
    });
    println!("largest distance from the solution: {worst:.1e} m");
    // Of second order: 7e-9 m.
    assert!(worst < 1e-8, "{worst}");
}

#[test]
fn a_ball_joint_and_an_axis_hold_in_space() {
    for (axis, freedom) in [("", 3), (", axis = [0.0, 0.0, 1.0]", 1)] {
        let mut scene = scene("", BOX);
        let keys = match &mut scene.solids[0].model {
            halfstep_scene::ModelKeys::Rigid(keys) => keys,
            _ => unreachable!("rigid"),
        };
        keys.joints.push(halfstep_scene::Joint {
            name: "pin".into(),
            body: "box".into(),
            with: String::new(),
            kind: halfstep_scene::JointKind::Hinge {
                at: [0.0, 0.1, 0.0],
                axis: if axis.is_empty() { [0.0; 3] } else { [0.0, 0.0, 1.0] },
            },
            stiffness: 0.0,
            damping: 0.0,
            rest: 0.0,
            limits: None,
        });
        let mut model = build::<3>(&deepen(scene, 0.3));
        let load = free(&model);
        let start = model.states[0].center[1] * 3.0 * G;
        run(&mut model, 1.0, 1e-3, &load, |_, model| {
            let pose = model.system.poses[0];
            let pin = model.system.bodies[0].place(&pose, &[0.0, 0.1, 0.0].into());
            assert!((pin - Vec3::new(0.0, 0.1, 0.0)).amax() < 1e-12);
            let upright = pose.rotation()[(2, 2)];
            if freedom == 1 {
                assert!((upright - 1.0).abs() < 1e-12, "{upright}");
            }
            let energy = model.states[0].kinetic_energy + 3.0 * G * model.states[0].center[1];
            assert!((energy - start).abs() < 1e-3 * 3.0 * G * 0.1, "{energy} {start}");
        });
        if freedom == 3 {
            assert!(model.system.poses[0].rotation()[(2, 2)] < 0.99, "its centre is deeper than the pin");
        }
    }
}

#[test]
fn a_double_pendulum_keeps_its_energy_and_its_pins() {
    let second = BOX
        .replace("\"box\"", "\"second\"")
        .replace("[0.0, 0.0]", "[0.22, 0.0]")
        .replace("0.2, 0.1]", "0.42, 0.1]");
    let keys = "joints = [{ name = \"a\", kind = \"hinge\", body = \"box\", at = [0.0, 0.05] },\n\
                { name = \"b\", kind = \"hinge\", body = \"second\", with = \"box\", at = [0.21, 0.05] }]";
    let mut model = build::<2>(&scene(keys, &(BOX.to_owned() + &second)));
    let load = free(&model);
    let energy = |model: &Rigid<2>| -> f64 {
        model.states.iter().map(|s| s.kinetic_energy + s.mass * G * s.center[1]).sum()
    };
    let start = energy(&model);
    let mut worst = 0.0_f64;
    run(&mut model, 2.0, 2e-4, &load, |_, model| {
        let pin: Vec3 = [0.21, 0.05, 0.0].into();
        let [a, b] = [0, 1].map(|k| model.system.bodies[k].place(&model.system.poses[k], &pin));
        assert!((a - b).amax() < 1e-12);
        worst = worst.max((energy(model) - start).abs());
    });
    println!("energy to {:.1e} of what it falls", worst / (20.0 * G * 0.3));
    assert!(worst < 6e-6 * 20.0 * G * 0.3, "{worst}");
}

#[test]
fn a_hinge_stops_at_its_limit() {
    let keys = "joints = [{ name = \"pin\", kind = \"hinge\", body = \"box\", at = [0.0, 0.05], limits = [-0.5, 0.5] }]";
    let mut model = build::<2>(&scene(keys, BOX));
    let load = free(&model);
    let mut lowest = 0.0_f64;
    run(&mut model, 2.0, 1e-3, &load, |_, model| lowest = lowest.min(model.states[0].angle[2]));
    assert!((lowest + 0.5).abs() < 1e-5, "{lowest}");
    assert!((model.states[0].angle[2] + 0.5).abs() < 1e-5 && model.states[0].kinetic_energy < 1e-20);
}
