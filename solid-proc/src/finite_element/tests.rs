//! The model by hand: periods of plates, rotation, energy.

use super::FiniteElement;
use crate::model::{Load, SolidModel};
use halfstep_scene::{Scene, parse};
use halfstep_sph::lane::Isa;
use halfstep_wire::half_step::HalfStep;
use std::path::Path;

/// A plate of this many elements across, 20 mm thick and ten times as long, clamped over its left face.
fn plate(across: f64, more: &[&str]) -> Scene {
    let text = format!(
        "resolution = {}\nend_time = 1.0\ngravity = [0.0, 0.0]\n[solid]\nmodel = \"finite-element\"\n\
         density = 1000.0\nyoungs_modulus = 2e6\npoissons_ratio = 0.4\n[[shape]]\nname = \"plate\"\n\
         phase = \"solid\"\nbox = {{ min = [-0.02, 0.0], max = [0.2, 0.02] }}\n\
         clamp = {{ min = [-0.02, 0.0], max = [0.0, 0.02] }}\n",
        0.02 / across
    );
    let overrides: Vec<String> = more.iter().map(|o| (*o).to_owned()).collect();
    parse(&text, Path::new("plate.toml"), &overrides).unwrap_or_else(|e| panic!("{e:?}"))
}

fn model(scene: &Scene) -> FiniteElement<2> {
    FiniteElement::new(scene, 0, Isa::detect()).expect("a solid")
}

fn step(model: &mut FiniteElement<2>, n: u64, dt: f64) {
    let load = Load::none(model.particles().len());
    for stage in HalfStep::begin(n, n as f64 * dt).lasting(dt).both() {
        model.advance(&stage, 1, &load).expect("within bounds");
    }
}

/// Half periods of the tip after a small push in the first mode's shape, s.
fn period(across: f64) -> f64 {
    let mode = "shape.plate.cantilever_mode={fraction=0.0005,root=0.0,length=0.2}";
    let mut model = model(&plate(across, &[mode, "solid.artificial_viscosity={linear=0,quadratic=0}"]));
    let tip = model.particles().len() - 1;
    let dt = model.sub_step_limit();
    let (mut crossings, mut last) = (Vec::new(), 0.0);
    for n in 0.. {
        step(&mut model, n, dt);
        let state = model.particles();
        let y = state.position[tip][1] - state.reference[tip][1];
        if n > 5 && (y > 0.0) != (last > 0.0) {
            crossings.push(dt * (n as f64 + last / (last - y)));
        }
        if crossings.len() == 3 {
            return crossings[2] - crossings[0];
        }
        last = y;
    }
    unreachable!("it swings")
}

/// One, two and four elements across: no shear locking. A beam of Euler and Bernoulli has the period
/// T = 2 pi / (1.8751² sqrt(E' I / (rho A L⁴))); shear makes it longer.
#[test]
fn a_plate_swings_as_a_beam_with_one_element_across() {
    let beam = {
        let modulus = 2e6 / (1.0 - 0.4_f64.powi(2));
        let frequency =
            1.875_104_1_f64.powi(2) * (modulus * 0.02_f64.powi(2) / 12.0 / 1000.0).sqrt() / 0.2_f64.powi(2);
        std::f64::consts::TAU / frequency
    };
    let found = [1.0, 2.0, 4.0].map(|across| period(across) / beam);
    println!("periods over the beam's: {found:?}");
    assert!(found.iter().all(|ratio| (0.98..1.04).contains(ratio)), "{found:?}");
    assert!((found[1] / found[2] - 1.0).abs() < 0.01, "{found:?}");
}

/// A free block that turns keeps its shape, energy and spin.
#[test]
fn a_turning_block_does_not_strain() {
    let text = "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, 0.0]\n[solid]\nmodel = \"finite-element\"\n\
                density = 1000.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n[[shape]]\nname = \"block\"\n\
                phase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.06, 0.04] }\n";
    let scene = parse(text, Path::new("block.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let mut model = model(&scene);
    let turned = 1.3_f64;
    for node in 0..model.mesh.nodes() {
        let [x, y] = model.mesh.reference[node];
        model.now.displacement[0][node] = turned.cos() * x - turned.sin() * y - x;
        model.now.displacement[1][node] = turned.sin() * x + turned.cos() * y - y;
    }
    model.evaluate();
    // Of rounding: 1e-16 of 1e6 Pa times the area.
    let largest = model.now.acceleration.iter().flatten().fold(0.0_f64, |most, a| most.max(a.abs()));
    assert!(model.strain_energy().abs() < 1e-12 && largest < 1e-5, "{} {largest}", model.strain_energy());
}

/// Undamped, kinetic and strain energy stay what the push gave; with viscosity the account holds what went.
#[test]
fn energy_is_kept_and_what_viscosity_takes_is_booked() {
    let mode = "shape.plate.cantilever_mode={fraction=0.01,root=0.0,length=0.2}";
    for linear in [0.0, 1.0] {
        let viscosity = format!("solid.artificial_viscosity={{linear={linear},quadratic=0}}");
        let mut model = model(&plate(4.0, &[mode, &viscosity]));
        model.keep_account();
        let held = |model: &FiniteElement<2>| model.nodal_kinetic_energy() + model.strain_energy();
        let (dt, start) = (0.5 * model.sub_step_limit(), held(&model));
        let mut given = 0.0;
        for n in 0..4000 {
            step(&mut model, n, dt);
            model.account(&mut |_, joules| given += joules);
        }
        let lost = start - held(&model);
        assert!((lost + given).abs() < 1e-5 * start, "{linear}: {start} J, {lost} lost, {given} booked");
        println!("A = {linear}: {start} J, {lost} lost, {given} booked");
        assert!(if linear > 0.0 { lost > 1e-3 * start } else { given == 0.0 }, "{start} {lost} {given}");
    }
}
