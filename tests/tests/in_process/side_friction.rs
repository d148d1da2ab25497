//! Side friction: a block on a spring loses 4 F / k of amplitude a period, then sticks (dry friction, as every textbook
//! on vibrations has it).

use halfstep_scene::{EnergyPart, Scene, parse};
use halfstep_solid::hypoelastic::Hypoelastic;
use halfstep_solid::total_lagrangian::TotalLagrangian;
use halfstep_solid::{Load, SolidModel};
use halfstep_sph::lane::Isa;
use halfstep_wire::half_step::HalfStep;
use std::path::Path;

/// Deceleration F / m by friction, m/s².
const FRICTION: f64 = 1.6;
/// Of the spring, 1/s.
const OMEGA: f64 = 60.0;
/// At the start, m/s.
const SPEED: f64 = 0.8;

fn block(model: &str) -> Scene {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, 0.0]\n[solid]\nmodel = \"{model}\"\ndensity = 1000.0\n\
         youngs_modulus = 1e6\npoissons_ratio = 0.3\nside_friction = {}\n[[shape]]\nname = \"block\"\n\
         phase = \"solid\"\nbox = {{ min = [0.0, 0.0], max = [0.1, 0.05] }}\nvelocity = [{SPEED}, 0.0]\n",
        1000.0 * FRICTION
    );
    parse(&text, Path::new("block.toml"), &[]).expect("a right scene")
}

/// Turning points of the block, m, and what friction took, J: every particle hangs on a spring of its own, so the block
/// does not strain.
fn turning_points(mut model: Box<dyn SolidModel<2>>, dt: f64) -> (Vec<f64>, f64) {
    model.keep_account();
    let mut taken = 0.0;
    let mut load = Load::none(model.particles().len());
    let (mut points, mut last) = (Vec::new(), [0.0, SPEED]);
    for step in 0..(1.0 / dt) as u64 {
        for half_step in HalfStep::begin(step, step as f64 * dt).lasting(dt).both() {
            let now = model.particles();
            for (p, force) in load.force.iter_mut().enumerate() {
                let stretch = [0, 1].map(|d| now.position[p][d] - now.reference[p][d]);
                *force = stretch.map(|x| -now.mass[p] * OMEGA * OMEGA * x);
            }
            model.advance(&half_step, 1, &load).expect("within bounds");
        }
        model.account(&mut |part, joules| match part {
            EnergyPart::SideFriction => taken -= joules,
            _ => assert!(joules.abs() < 1e-10, "{part:?} gave {joules} J"),
        });
        let now = model.particles();
        let at = [now.position[7][0] - now.reference[7][0], now.velocity[7][0]];
        if last[1] != 0.0 && at[1] * last[1] <= 0.0 {
            points.push(if at[1] == 0.0 { at[0] } else { last[0] });
        }
        last = at;
    }
    assert_eq!(last[1], 0.0, "it sticks in the end");
    (points, taken)
}

fn loses_what_theory_says(name: &str, build: fn(&Scene) -> Option<Box<dyn SolidModel<2>>>) {
    let scene = block(name);
    let model = build(&scene).expect("a solid");
    let (points, taken) = turning_points(model, 1e-4);
    // F / k, and the first turning point from the energy: k x² / 2 + F x = m v² / 2.
    let reach = FRICTION / (OMEGA * OMEGA);
    let first = (reach * reach + (SPEED / OMEGA).powi(2)).sqrt() - reach;
    println!("{name}: turns at {points:.5?} m; F / k {reach:.5} m, first by theory {first:.5} m");
    for (k, point) in points.iter().enumerate() {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let theory = sign * (first - 2.0 * reach * k as f64);
        assert!((point - theory).abs() < 0.02 * reach, "turn {k}: {point} m, theory {theory} m");
    }
    // Friction takes F times the way, and so 4 F / k of the amplitude in each period: what the ledger says.
    let mass = 1000.0 * 0.1 * 0.05;
    let rest = points.last().expect("it turns");
    let ways = std::iter::once(0.0).chain(points.iter().copied());
    let way: f64 = ways.zip(&points).map(|(from, to)| (to - from).abs()).sum();
    let lost = 0.5 * mass * (SPEED * SPEED - (OMEGA * rest).powi(2));
    println!("friction took {taken:.6} J; F times the way {:.6} J, lost {lost:.6} J", mass * FRICTION * way);
    assert!((taken / (mass * FRICTION * way) - 1.0).abs() < 1e-3);
    assert!((taken / lost - 1.0).abs() < 1e-3);
    // Until the spring no longer overcomes the friction.
    assert_eq!(points.len(), ((first / reach + 1.0) / 2.0).ceil() as usize);
    assert!(points.last().unwrap().abs() < reach);
}

#[test]
fn a_total_lagrangian_block_loses_four_f_over_k_a_period() {
    loses_what_theory_says("total-lagrangian", |scene| {
        Some(Box::new(TotalLagrangian::<2>::new(scene, 0, Isa::detect())?))
    });
}

#[test]
fn a_hypoelastic_block_loses_four_f_over_k_a_period() {
    loses_what_theory_says("hypoelastic", |scene| {
        Some(Box::new(Hypoelastic::<2>::new(scene, 0, Isa::detect())?))
    });
}
