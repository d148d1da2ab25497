//! Rigid bodies by hand.

mod contact_tests;
mod hard_tests;
mod impact_tests;
mod joint_tests;
mod start_tests;
mod swing_tests;

use super::Rigid;
use crate::model::{Load, SolidModel};
use halfstep_scene::{Geometry, Phase, Scene};
use halfstep_sph::lane::Isa;
use halfstep_wire::half_step::HalfStep;
use std::path::Path;

const G: f64 = 9.81;

fn scene(keys: &str, shapes: &str) -> Scene {
    let text = format!(
        "resolution = 0.01\nend_time = 100.0\n[solid]\nmodel = \"rigid\"\ndensity = 500.0\n{keys}\n{shapes}"
    );
    halfstep_scene::parse(&text, Path::new("rigid.toml"), &[]).expect("a right scene")
}

const BOX: &str =
    "[[shape]]\nname = \"box\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.2, 0.1] }\n";
const FLOOR: &str =
    "[[shape]]\nname = \"floor\"\nphase = \"wall\"\nbox = { min = [-5.0, -1.0], max = [9.0, 0.0] }\n";

fn build<const D: usize>(scene: &Scene) -> Rigid<D> {
    Rigid::new(scene, 0, Isa::detect()).expect("a rigid solid")
}

/// Steps of one sub-step until a time, s; `see` is shown each state.
fn run<const D: usize>(
    model: &mut Rigid<D>,
    end: f64,
    dt: f64,
    load: &Load<D>,
    mut see: impl FnMut(f64, &mut Rigid<D>),
) {
    let steps = (end / dt).round() as u64;
    for k in 0..steps {
        for stage in HalfStep::begin(k, k as f64 * dt).lasting(dt).both() {
            model.advance(&stage, 1, load).expect("within bounds");
        }
        see((k + 1) as f64 * dt, model);
    }
}

fn free<const D: usize>(model: &Rigid<D>) -> Load<D> {
    Load::none(model.particles().len())
}

/// In space: as deep as given, m.
fn deepen(mut scene: Scene, depth: f64) -> Scene {
    scene.dimension = 3;
    for shape in &mut scene.shapes {
        if let Geometry::Box(block) = &mut shape.geometry {
            let beyond = if shape.phase == Phase::Wall { 1.0 } else { 0.0 };
            (block.min[2], block.max[2]) = (-beyond, depth + beyond);
        }
    }
    scene
}

fn spun(model: &mut Rigid<3>, rate: [f64; 3]) {
    let body = &model.system.bodies[0];
    model.system.poses[0].spin = body.spin(&nalgebra::Matrix3::identity(), &rate.into());
    model.show();
}

#[test]
fn a_box_has_the_moments_of_a_box() {
    let plane = build::<2>(&scene("", BOX));
    let body = &plane.system.bodies[0];
    let moment = |body: &super::body::Body, axis: usize| {
        let mut rate = super::Vec3::zeros();
        rate[axis] = 1.0;
        body.spin(&nalgebra::Matrix3::identity(), &rate)[axis]
    };
    // 0.2 x 0.1 m of 500 kg/m³: 10 kg/m, (0.2² + 0.1²) / 12 of it.
    assert!((body.mass - 10.0).abs() < 1e-12);
    assert!((body.center - super::Vec3::new(0.1, 0.05, 0.0)).amax() < 1e-15);
    assert!((moment(body, 2) / (10.0 * 0.05 / 12.0) - 1.0).abs() < 1e-12);
    let space = build::<3>(&deepen(scene("", BOX), 0.3));
    let body = &space.system.bodies[0];
    assert!((body.mass - 3.0).abs() < 1e-12);
    for (axis, squares) in [(0, 0.01 + 0.09), (1, 0.04 + 0.09), (2, 0.05)] {
        assert!((moment(body, axis) / (3.0 * squares / 12.0) - 1.0).abs() < 1e-12, "{axis}");
    }
    // What the scene says comes before what the shapes say; a heavy half moves the centre.
    let said = "bodies = [{ name = \"box\", mass = 20.0, center = [0.1, 0.02], inertia = 3.0, angular_velocity = 2.0 }]";
    let model = build::<2>(&scene(said, BOX));
    assert_eq!((model.states[0].mass, model.states[0].center), (20.0, [0.1, 0.02]));
    assert!((model.states[0].kinetic_energy - 0.5 * 3.0 * 4.0).abs() < 1e-12);
    let half = BOX.replace("0.2, 0.1] }", "0.1, 0.1] }\ndensity = 1500.0\nbody = \"float\"")
        + &BOX
            .replace("\"box\"", "\"right\"")
            .replace("[0.0, 0.0]", "[0.1, 0.0]")
            .replace("0.1] }", "0.1] }\nbody = \"float\"");
    let model = build::<2>(&scene("", &half));
    assert_eq!(model.states.len(), 1);
    assert!((model.states[0].mass - 20.0).abs() < 1e-12);
    assert!((model.states[0].center[0] - (15.0 * 0.05 + 5.0 * 0.15) / 20.0).abs() < 1e-12);
}

#[test]
fn a_thrown_body_flies_a_parabola_and_turns_evenly() {
    let said = "bodies = [{ name = \"box\", angular_velocity = 3.0 }]";
    let shape = format!("{BOX}velocity = [2.0, 5.0]\n");
    let mut model = build::<2>(&scene(said, &shape));
    let load = free(&model);
    run(&mut model, 1.0, 1e-3, &load, |_, _| {});
    let state = &model.states[0];
    assert!((state.center[0] - 2.1).abs() < 1e-11 && (state.center[1] - (5.05 - 0.5 * G)).abs() < 1e-11);
    assert!((state.angle[2] - 3.0).abs() < 1e-12);
    // A corner particle's place.
    let (r0, angle) = ([0.005 - 0.1, 0.005 - 0.05], 3.0_f64);
    let right = [
        state.center[0] + r0[0] * angle.cos() - r0[1] * angle.sin(),
        state.center[1] + r0[0] * angle.sin() + r0[1] * angle.cos(),
    ];
    let at = model.particles().position[0];
    assert!((at[0] - right[0]).abs() < 1e-12 && (at[1] - right[1]).abs() < 1e-12);
}

#[test]
fn a_torque_free_body_keeps_momentum_and_energy_and_tumbles() {
    let mut scene = scene("", BOX);
    scene.gravity = [0.0; 3];
    let mut model = build::<3>(&deepen(scene, 0.3));
    // Moments about x, y, z: 0.1, 0.13, 0.05 (times 3/12): about x, the middle one, it is unstable.
    spun(&mut model, [10.0, 1e-3, 1e-3]);
    let load = free(&model);
    let (spin, energy) = (model.system.poses[0].spin, model.states[0].kinetic_energy);
    let mut flips = 0;
    let mut last = 1.0_f64;
    let mut worst = 0.0_f64;
    run(&mut model, 10.0, 1e-3, &load, |_, model| {
        let pose = &model.system.poses[0];
        assert!((pose.spin - spin).amax() < 1e-12 * spin.norm());
        worst = worst.max((model.states[0].kinetic_energy / energy - 1.0).abs());
        let axis = pose.rotation()[(0, 0)];
        if axis * last < 0.0 {
            flips += 1;
        }
        last = axis;
    });
    println!("{flips} flips, energy to {worst:.1e}");
    assert!(flips >= 2, "it turns over again and again: {flips}");
    assert!(worst < 5e-6, "{worst}");
}

#[test]
fn the_free_rotation_is_of_second_order() {
    let mut scene = scene("", BOX);
    scene.gravity = [0.0; 3];
    let scene = deepen(scene, 0.3);
    let end = |steps: f64| {
        let mut model = build::<3>(&scene);
        spun(&mut model, [3.0, 2.0, 1.0]);
        let load = free(&model);
        run(&mut model, 1.0, 1.0 / steps, &load, |_, _| {});
        model.system.poses[0].rotation()
    };
    let (coarse, middle, fine) = (end(50.0), end(100.0), end(200.0));
    let order = ((coarse - middle).norm() / (middle - fine).norm()).log2();
    println!("order {order:.3}");
    assert!((order - 2.0).abs() < 0.1, "{order}");
}

#[test]
fn a_body_moves_as_prescribed() {
    let shape = format!("{BOX}motion = {{ angular_velocity = 2.0, pivot = [0.0, 0.0] }}\n");
    let mut model = build::<2>(&scene("", &shape));
    let load = free(&model);
    run(&mut model, 4.0, 1e-2, &load, |_, _| {});
    assert!((model.states[0].angle[2] - 8.0).abs() < 1e-12, "more than a turn: {:?}", model.states[0].angle);
    let (c, s) = (8.0_f64.cos(), 8.0_f64.sin());
    let right = [0.1 * c - 0.05 * s, 0.1 * s + 0.05 * c];
    for d in 0..2 {
        assert!((model.states[0].center[d] - right[d]).abs() < 1e-12);
    }
    let mut records = Vec::new();
    model.records(&[0], &mut records);
    assert_eq!(records[0].flags, 1 | 1 << 8, "prescribed, of the first body");
}

/// What contacts, stops, dampers and prescribed motion give explains every change of the energy.
#[test]
fn the_books_close() {
    let moved = "[[shape]]\nname = \"plate\"\nphase = \"wall\"\nbox = { min = [-5.0, -1.0], max = [9.0, 0.0] }\n\
                 motion = { amplitude = [0.02, 0.03], period = 0.5 }\n";
    let spring = "contact = { friction = 0.2, restitution = 0.3 }\n\
                  joints = [{ name = \"k\", kind = \"spring\", body = \"box\", with = \"plate\", at = [0.0, 0.1], \
                  to = [0.0, 0.3], stiffness = 500.0, damping = 5.0 }]";
    // Guided by the plate, with a damper, and bouncing on a floor. The plate begins at rest: a joint that is torn along
    // at once is an impact.
    let rail = "contact = { friction = 0.2, restitution = 0.3 }\n\
                joints = [{ name = \"r\", kind = \"rail\", body = \"box\", with = \"plate\", at = [0.1, 0.05], \
                axis = [0.2, 1.0], turns = true, damping = 5.0 }]";
    let guided = "[[shape]]\nname = \"plate\"\nphase = \"wall\"\nbox = { min = [-5.0, -9.0], max = [9.0, -8.0] }\n\
                  motion = { amplitude = [0.02, 0.03], period = 0.5, ramp = 0.5 }\n\
                  [[shape]]\nname = \"floor\"\nphase = \"wall\"\nbox = { min = [-5.0, -1.0], max = [9.0, -0.05] }\n\
                  contact = true\n";
    for (keys, shapes) in [
        (spring, BOX.to_owned() + moved),
        ("contact = { friction = 0.2 }", BOX.to_owned() + moved),
        (rail, BOX.to_owned() + guided),
    ] {
        let mut model = build::<2>(&scene(keys, &shapes));
        let load = free(&model);
        model.keep_account();
        let held = |model: &Rigid<2>| {
            model.states[0].kinetic_energy + model.strain_energy() + 10.0 * G * model.states[0].center[1]
        };
        let start = held(&model);
        let (mut given, mut most, mut worst) = (0.0, 0.0_f64, 0.0_f64);
        run(&mut model, 1.5, 2e-4, &load, |_, model| {
            model.account(&mut |_, joules| {
                given += joules;
                most = most.max(joules.abs());
            });
            worst = worst.max((held(model) - start - given).abs());
        });
        println!("rest {worst:.1e} J of {:.2} J", (held(&model) - start).abs().max(10.0 * G * 0.03));
        assert!(worst < 2e-4 * 10.0 * G * 0.03, "{worst}");
        assert!(most > 0.0);
    }
}

#[test]
fn a_load_that_is_no_number_is_named() {
    let mut model = build::<2>(&scene("", BOX));
    let mut load = free(&model);
    load.force[17] = [f64::NAN, 0.0];
    let [first, _] = HalfStep::begin(0, 0.0).lasting(1e-3).both();
    let failure = model.advance(&first, 1, &load).expect_err("NaN");
    assert_eq!(failure.particle, 17);
}

/// A quarter of a body's weight on one side turns it with the moment of that force.
#[test]
fn a_force_off_the_centre_turns_the_body() {
    let mut scene = scene("", BOX);
    scene.gravity = [0.0; 3];
    let mut model = build::<2>(&scene);
    let mut load = free(&model);
    let near = |&p: &usize| {
        let x = model.particles().reference[p];
        (x[0] - 0.195).abs() + (x[1] - 0.055).abs() < 1e-9
    };
    let p = (0..model.particles().len()).find(near).expect("there");
    load.force[p] = [0.0, 1.0];
    run(&mut model, 1e-2, 1e-3, &load, |_, _| {});
    let right = 1.0 * 0.095 / (10.0 * 0.05 / 12.0) * 1e-2;
    assert!((model.states[0].angular_velocity[2] / right - 1.0).abs() < 1e-5);
    assert!((model.states[0].velocity[1] - 1e-3).abs() < 1e-15);
}
