//! What bodies begin with at their joints.

use super::joint_tests::{MASS, MOMENT, second, weightless};
use super::*;
use halfstep_scene::{JointKind, ModelKeys};

/// A rate is about the hinge: the bar keeps it, with m r² more than about its middle, and what hangs on its end goes
/// along with that, as does what is welded to it.
#[test]
fn a_hinged_body_begins_to_turn_about_its_hinge() {
    let pin = "{ name = \"pin\", kind = \"hinge\", body = \"box\", at = [0.0, 0.05] }";
    let keys = format!("bodies = [{{ name = \"box\", angular_velocity = 0.3 }}]\njoints = [{pin}]");
    let mut model = build::<2>(&weightless(&keys, BOX));
    let right = 0.5 * (MOMENT + MASS * 0.01) * 0.09;
    assert!((model.states[0].kinetic_energy / right - 1.0).abs() < 1e-12, "{:?}", model.states[0]);
    let load = free(&model);
    run(&mut model, 1.0, 1e-2, &load, |_, model| {
        assert!((model.states[0].kinetic_energy / right - 1.0).abs() < 1e-12, "{:?}", model.states[0]);
    });
    for (kind, more, rates) in [
        (
            "kind = \"hinge\", at = [0.2, 0.05]",
            ", { name = \"second\", angular_velocity = -0.5 }",
            [0.3, -0.5],
        ),
        ("kind = \"hinge\", at = [0.2, 0.05]", "", [0.3, 0.0]),
        ("kind = \"fixed\"", "", [0.3, 0.3]),
    ] {
        let joint = format!("{{ name = \"elbow\", {kind}, body = \"second\", with = \"box\" }}");
        let bodies = format!("bodies = [{{ name = \"box\", angular_velocity = 0.3 }}{more}]");
        // The order of the joints does not matter.
        let keys = format!("{bodies}\njoints = [{joint}, {pin}]");
        let mut model = build::<2>(&weightless(&keys, &(BOX.to_owned() + &second(0.2))));
        // The first centre is 0.1 m from the pin, the second 0.1 m beyond the elbow.
        let speeds = [0.03, 0.06 + 0.1 * rates[1]];
        for k in 0..2 {
            let state = &model.states[k];
            assert!(
                (state.velocity[1] - speeds[k]).abs() < 1e-14 && state.velocity[0].abs() < 1e-14,
                "{state:?}"
            );
        }
        let load = free(&model);
        run(&mut model, 1e-4, 1e-4, &load, |_, model| {
            for (state, rate) in model.states.iter().zip(rates) {
                assert!((state.angular_velocity[2] - rate).abs() < 1e-4, "{kind}{more}: {state:?}");
            }
        });
    }
}

/// The outer end of two welded bars, 0.4 m from the pin about which they turn with 0.3 rad/s, is pinned as well.
#[test]
fn velocities_that_a_joint_takes_are_told() {
    let pin = |name: &str, body: &str, x: f64| {
        format!("{{ name = \"{name}\", kind = \"hinge\", body = \"{body}\", at = [{x}, 0.05] }}")
    };
    let weld = "{ name = \"weld\", kind = \"fixed\", body = \"second\", with = \"box\" }";
    for (far, told) in [
        ("".to_owned(), vec![]),
        (format!(", {}", pin("far", "second", 0.4)), vec![("far".to_owned(), [0.3 * 0.4, 0.0])]),
    ] {
        let joints = format!("joints = [{}, {weld}{far}]", pin("pin", "box", 0.0));
        let keys = format!("bodies = [{{ name = \"box\", angular_velocity = 0.3 }}]\n{joints}");
        let mut model = build::<2>(&weightless(&keys, &(BOX.to_owned() + &second(0.2))));
        let load = free(&model);
        run(&mut model, 1e-3, 1e-3, &load, |_, _| ());
        let jerked = model.jerked_joints();
        assert_eq!(jerked.len(), told.len(), "{jerked:?}");
        for ((name, rates), (right, speeds)) in jerked.iter().zip(&told) {
            assert!(name == right && (0..2).all(|k| (rates[k] - speeds[k]).abs() < 1e-14), "{jerked:?}");
        }
    }
    // Welded bars of which one turns by itself: a rate of 0.3 rad/s against the other's -0.5.
    let bodies = "bodies = [{ name = \"box\", angular_velocity = 0.3 }, { name = \"second\", angular_velocity = -0.5 }]";
    let keys = format!("{bodies}\njoints = [{weld}]");
    let jerked = build::<2>(&weightless(&keys, &(BOX.to_owned() + &second(0.2)))).jerked_joints();
    assert!(jerked.len() == 1 && (jerked[0].1[1] - 0.8).abs() < 1e-14, "{jerked:?}");
}

/// In space: an arm that is hinged about x to a turntable about z is turned by it, and the first step takes nothing.
#[test]
fn what_is_hinged_across_turns_along() {
    let keys = "bodies = [{ name = \"box\", angular_velocity = 2.0 }]\n\
                joints = [{ name = \"table\", kind = \"hinge\", body = \"box\", at = [0.0, 0.05] },\n\
                { name = \"elbow\", kind = \"hinge\", body = \"second\", with = \"box\", at = [0.2, 0.05] }]";
    let mut scene = deepen(weightless(keys, &(BOX.to_owned() + &second(0.2))), 0.3);
    let ModelKeys::Rigid(keys) = &mut scene.solids[0].model else { panic!("rigid") };
    for (joint, axis) in keys.joints.iter_mut().zip([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]) {
        let JointKind::Hinge { at, .. } = joint.kind else { panic!("{joint:?}") };
        joint.kind = JointKind::Hinge { at: [at[0], at[1], 0.15], axis };
    }
    let mut model = build::<3>(&scene);
    // Both turn about z as one, on arms of 0.1 and 0.3 m.
    let energy = |model: &Rigid<3>| model.states.iter().map(|state| state.kinetic_energy).sum::<f64>();
    let before = energy(&model);
    let load = free(&model);
    run(&mut model, 1e-3, 1e-3, &load, |_, model| {
        assert!((energy(model) / before - 1.0).abs() < 1e-5, "{} {before}", energy(model));
        for (state, arm) in model.states.iter().zip([0.1, 0.3]) {
            assert!((state.velocity[1] - 2.0 * arm).abs() < 1e-4, "{state:?}");
            assert!((state.angular_velocity[2] - 2.0).abs() < 1e-4, "{state:?}");
        }
    });
}
