//! The hypoelastic solid: exact deformations, symmetries. What every model must do is in
//! `tests/src/conformance/solid.rs`.

use crate::hypoelastic::Hypoelastic;
use crate::model::{Load, SolidModel};
use halfstep_scene::{self as scene, Scene};
use halfstep_sph::lane::Isa;
use halfstep_wire::half_step::HalfStep;
use proptest::prelude::*;
use std::path::Path;

const BLOCK: &str = r#"
        resolution = 0.01
        end_time = 1.0
        gravity = [0.0, 0.0]
        [solid]
        model = "hypoelastic"
        density = 1000.0
        youngs_modulus = 1e6
        poissons_ratio = 0.3
        [[shape]]
        name = "block"
        phase = "solid"
        box = { min = [0.0, 0.0], max = [0.2, 0.15] }
    "#;

const FLOOR: &str = r#"
        [[shape]]
        name = "floor"
        phase = "wall"
        box = { min = [-0.1, -0.04], max = [0.3, 0.0] }
    "#;

fn block(overrides: &[&str]) -> Scene {
    read(BLOCK, overrides)
}

fn read(text: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.into()).collect();
    scene::parse(text, Path::new("block.toml"), &overrides).expect("a right scene")
}

/// The block with a velocity field.
fn moving(overrides: &[&str], v: impl Fn([f64; 2]) -> [f64; 2]) -> Hypoelastic<2> {
    let mut solid = Hypoelastic::<2>::new(&block(overrides), 0, Isa::detect()).unwrap();
    solid.set_velocity(v);
    solid
}

fn interior(x: [f64; 2]) -> bool {
    x[0] > 0.04 && x[0] < 0.16 && x[1] > 0.04 && x[1] < 0.11
}

/// Largest |ds/dt| over particles that `which` picks.
fn largest_stress_rate(solid: &mut Hypoelastic<2>, which: impl Fn([f64; 2]) -> bool) -> f64 {
    let load = Load::none(solid.particles().len());
    let rates = solid.stress_rates(&load);
    (0..solid.particles().len() as u32)
        .filter(|&p| which(solid.particles().reference[p as usize]))
        .map(|p| rates[p as usize].as_flattened().iter().fold(0.0_f64, |m, r| m.max(r.abs())))
        .fold(0.0, f64::max)
}

#[test]
fn rigid_rotation_makes_no_stress_inside() {
    // Rate 2 about the middle. 2 G w = 1.5e6 would be the scale of a real strain.
    let spin = |x: [f64; 2]| [-2.0 * (x[1] - 0.075), 2.0 * (x[0] - 0.1)];
    let mut plain = moving(&[], spin);
    assert!(largest_stress_rate(&mut plain, interior) < 1e-6);
    // The plain gradient makes some at the surface, the renormalised one nowhere.
    assert!(largest_stress_rate(&mut plain, |_| true) > 1e4);
    let mut renormalised = moving(&["effects.renormalised-gradient=\"on\""], spin);
    assert!(largest_stress_rate(&mut renormalised, |_| true) < 1e-6);
}

#[test]
fn uniform_stretch_has_hookes_rate() {
    // dv_x/dx = 1: ds_xx/dt = 2 G (1 - 1/3) = 4/3 G, ds_yy/dt = -2/3 G, G = E / 2.6; renormalised, so everywhere.
    let mut solid = moving(&["effects.renormalised-gradient=\"on\""], |x| [x[0], 0.0]);
    let load = Load::none(solid.particles().len());
    let g = 1e6 / 2.6;
    for rate in solid.stress_rates(&load) {
        assert!((rate[0][0] - 4.0 / 3.0 * g).abs() < 1e-6 * g, "{rate:?}");
        assert!((rate[1][1] + 2.0 / 3.0 * g).abs() < 1e-6 * g);
        assert!(rate[0][1].abs() < 1e-6 * g);
    }
}

#[test]
fn a_clamp_as_wall_shows_what_is_around_it_and_no_shear() {
    let overrides = [
        "shape.block.clamp={ min = [0.0, 0.0], max = [0.05, 0.15] }",
        "effects.wall-clamp=\"on\"",
        "gravity=[-10.0, 0.0]",
    ];
    let mut solid = moving(&overrides, |_| [0.0, 0.0]);
    // 1 % denser: p = K / 100 with K = E / 1.2, and at the clamp rho g more per metre to the left.
    for slot in 0..solid.id.len() {
        solid.now.density[slot] = 1010.0;
        solid.now.stress[0][1][slot] = 77.0;
    }
    solid.apply_state_equation();
    solid.compute_rates(&Load::none(solid.particles().len()));
    let uniform = 1e6 / 1.2 * 0.01;
    for p in 0..solid.particles().len() as u32 {
        let (x, record) = (solid.particles().reference[p as usize][0], solid.record(p));
        if x > 0.05 {
            assert!(
                (record.pressure - uniform).abs() < 1e-6 && record.deviatoric_stress[3] == 77.0,
                "{record:?}"
            );
            continue;
        }
        assert_eq!(record.deviatoric_stress, [0.0; 6]);
        let found = record.pressure - uniform;
        if x > 0.04 {
            // Free particles in reach are 1 and 2 spacings away, the nearer ones weigh more.
            assert!(1010.0 * 10.0 * 0.01 < found && found < 1010.0 * 10.0 * 0.02, "{found}");
        } else if x < 0.02 {
            assert_eq!(record.pressure, 0.0, "nothing free in reach");
        }
        assert!((record.density - 1000.0 * (1.0 + record.pressure / (1e6 / 1.2))).abs() < 1e-9);
    }
}

/// Walls that hold values: pressed 1 % denser the block is pushed off the floor, stretched by 1 % drawn to it, by the
/// pressure that its own lowest rows have; the floor's particles are nobody's to see.
#[test]
fn a_wall_that_holds_values_pushes_and_pulls() {
    let on_a_floor = format!("{BLOCK}{FLOOR}");
    let scene = read(&on_a_floor, &["effects.wall-particles=\"on\""]);
    for (density, direction) in [(1010.0, 1.0), (990.0, -1.0)] {
        let mut solid = Hypoelastic::<2>::new(&scene, 0, Isa::detect()).unwrap();
        let own = solid.particles().len();
        assert_eq!((own, solid.points.len() - own), (20 * 15, 40 * 4), "the block, and all of the floor");
        for slot in 0..solid.id.len() {
            solid.now.density[slot] = density;
        }
        solid.apply_state_equation();
        solid.compute_rates(&Load::none(own));
        let uniform = 1e6 / 1.2 * (density / 1000.0 - 1.0);
        for p in own..solid.points.len() {
            let slot = solid.slot_of[p] as usize;
            let (x, shown) = (solid.points[p].position, solid.pressure[slot]);
            let near = x[1] > -0.02 && (0.0..0.2).contains(&x[0]);
            let expected = if near || shown != 0.0 { uniform } else { 0.0 };
            assert!((shown - expected).abs() < 1e-9 * uniform.abs(), "{x:?}: {shown} {expected}");
            assert!((solid.now.density[slot] - 1000.0 * (1.0 + shown / (1e6 / 1.2))).abs() < 1e-9);
            assert_eq!([0, 1].map(|d| solid.rates.acceleration[d][slot]), [0.0; 2]);
        }
        // Upright in the middle of the lowest row: what the rows above and below do cancels but for the artificial
        // stress; without a floor the row is pushed out of the block, or drawn into it.
        let middle = solid.slot_of[10] as usize;
        let held = solid.rates.acceleration[1][middle];
        let mut free = Hypoelastic::<2>::new(&block(&[]), 0, Isa::detect()).unwrap();
        free.now.density.fill(density);
        free.apply_state_equation();
        free.compute_rates(&Load::none(own));
        let push = held - free.rates.acceleration[1][free.slot_of[10] as usize];
        // Order of 2 p / rho² m sum F x over the rows below: p / (rho dx).
        assert!(direction * push > 0.5 * uniform.abs() / (1000.0 * 0.01), "{push}");
    }
    let with_a_spring = read(&on_a_floor, &[]);
    assert!(!crate::effects::takes_part(&with_a_spring, 0, halfstep_scene::EffectName::WallParticles));
    assert!(!crate::effects::touches_walls(&scene, 0), "the spring would push a second time");
}

/// In the floor springs are k / m = (c_P / dx)² / 2, beside the (2 c_P / (1.1 dx))² of the shortest wave.
#[test]
fn springs_of_walls_shorten_the_sub_step() {
    let floor = "shape=[{name=\"block\",phase=\"solid\",box={min=[0.0,0.0],max=[0.2,0.15]}},\
                 {name=\"floor\",phase=\"wall\",box={min=[0.15,-0.05],max=[0.3,0.0]}}]";
    // The wall is below the right end of the block: the first particles touch nothing.
    let mut solid = moving(&[floor], |_| [0.0, 0.0]);
    let load = Load::none(solid.particles().len());
    let step = |solid: &mut Hypoelastic<2>| {
        for half_step in HalfStep::begin(0, 0.0).lasting(1e-9).both() {
            solid.advance(&half_step, 1, &load).unwrap();
        }
        solid.sub_step_limit()
    };
    let alone = moving(&[], |_| [0.0, 0.0]).sub_step_limit();
    assert_eq!(step(&mut solid), alone, "it lies on the floor and touches nothing");
    solid.now.position[1].iter_mut().for_each(|y| *y -= 0.0025);
    let shorter = step(&mut solid) / alone;
    assert!((shorter - (1.0 + 0.5 / (2.0_f64 / 1.1).powi(2)).powf(-0.5)).abs() < 1e-9, "{shorter}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn inner_forces_sum_to_zero(a in -2.0..2.0f64, b in -2.0..2.0f64, c in -9.0..9.0f64) {
        let mut solid = moving(&[], |x| [a * x[0] + c * x[1] * x[1], b * x[1] + c * x[0]]);
        let load = Load::none(solid.particles().len());
        let dt = solid.sub_step_limit();
        let momentum = |s: &Hypoelastic<2>| {
            s.particles().velocity.iter().fold([0.0; 2], |m, v| [m[0] + v[0], m[1] + v[1]])
        };
        let speed: f64 = solid.particles().velocity.iter().map(|v| v[0].hypot(v[1])).sum();
        let before = momentum(&solid);
        for _ in 0..5 {
            for half_step in HalfStep::begin(0, 0.0).lasting(dt).both() {
                solid.advance(&half_step, 1, &load).unwrap();
            }
        }
        let after = momentum(&solid);
        for d in 0..2 {
            prop_assert!((after[d] - before[d]).abs() <= 1e-12 * (speed + 1.0));
        }
    }
}
