//! Damage in the row beside a rigid clamp.

use super::{Run, slope_of_energy, slot_at, solid, strength_and_energy};
use crate::total_lagrangian::TotalLagrangian;

const DX: f64 = 0.005;

/// Eleven rows that stand on their clamp, and a particle of the lowest in the middle of the row.
fn clamped() -> (TotalLagrangian<2>, usize) {
    clamped_with("")
}

fn clamped_with(keys: &str) -> (TotalLagrangian<2>, usize) {
    let text = solid(DX, 0.3, &strength_and_energy(1e6, 100.0))
        + "[[shape]]\nname = \"wall\"\nphase = \"solid\"\nbox = { min = [0.0, -0.02], max = [0.055, 0.055] }\n\
           clamp = { min = [0.0, -0.02], max = [0.055, 0.0] }\n"
        + keys;
    let model = Run::<2>::of(&text).model;
    let slot = slot_at(&model, [0.0275, 0.5 * DX]);
    (model, slot)
}

/// Displaces rows above the clamp upward, by their number from 0 on, and strains them along it.
fn displace(model: &mut TotalLagrangian<2>, along: f64, up: impl Fn(usize) -> f64) {
    for slot in model.slot_of.clone().into_iter().map(|slot| slot as usize) {
        let [x, y] = [0, 1].map(|d| model.pairs.position()[d][slot]);
        if y > 0.0 {
            model.now.displacement[0][slot] = along * x;
            model.now.displacement[1][slot] = up((y / DX) as usize);
        }
    }
    model.evaluate(0.0);
}

/// A crack along the clamp strains the lowest row by w / dx, all of it on the clamp's side; one beyond that row by half
/// as much, all of it on the other; an even strain both sides alike. What is elastic of it opens nothing.
#[test]
fn the_opening_inside_by_hand() {
    let (mut model, slot) = clamped();
    let w = 1e-3 * DX;
    for (rows, strain, inside) in [
        ([w, w, w], w / DX, 0.0),
        ([0.0, w, w], 0.5 * w / DX, 0.5 * w / DX),
        ([0.5 * w, 1.5 * w, 2.5 * w], w / DX, 0.5 * w / DX),
    ] {
        displace(&mut model, 0.0, |row| rows[row.min(2)]);
        assert!((model.gradient[slot][(1, 1)] - 1.0 - strain).abs() < 1e-12, "{rows:?}");
        assert!((model.strain_inside(slot) - inside).abs() < 1e-12, "{rows:?}");
        for elastic in [0.0, 0.4 * w / DX, w / DX] {
            let opening = (inside - 0.5 * elastic).max(0.0);
            assert!((model.opening_inside(slot, elastic) - opening).abs() < 1e-12, "{rows:?} {elastic}");
        }
        let second = model.pairs.neighbours(slot).find(|&(j, _)| model.pairs.position()[1][j] > DX);
        assert_eq!(model.opening_inside(second.expect("a row above").0, 0.0), 0.0, "not beside the clamp");
    }
}

/// The first row above a crack along the clamp has no clamped neighbours: it is as any row beside a crack, and takes
/// half of G_f.
#[test]
fn above_a_notch_along_the_clamp_nothing_is_beside_it() {
    let (mut model, slot) = clamped_with("crack = [[0.01, 0.0], [0.06, 0.0]]\n");
    displace(&mut model, 0.0, |row| 1e-5 * row as f64);
    assert!(model.gradient[slot][(1, 1)] > 1.001);
    assert_eq!(model.opening_inside(slot, 0.0), 0.0);
    let fracture = model.fracture.as_ref().expect("fracture");
    let beside =
        (0..model.id.len()).filter(|&slot| model.is_free(slot) && fracture.beside_clamp[slot]).count();
    assert_eq!(beside, 2, "left of the notch");
}

/// Turned as one, free neighbours show the same strain.
#[test]
fn the_strain_inside_does_not_turn() {
    let (mut model, slot) = clamped();
    displace(&mut model, 2e-4, |row| [5e-6, 1.3e-5, 2e-5][row.min(2)]);
    let before = model.strain_inside(slot);
    assert!(before > 1e-4);
    let turn = nalgebra::Rotation2::new(0.7);
    let pivot = nalgebra::Vector2::from(model.position_at(slot));
    for other in model.slot_of.clone().into_iter().map(|slot| slot as usize) {
        let to = pivot + turn * (nalgebra::Vector2::from(model.position_at(other)) - pivot);
        for d in 0..2 {
            model.now.displacement[d][other] = to[d] - model.pairs.position()[d][other];
        }
    }
    model.gradient[slot] = turn * model.gradient[slot];
    let after = model.strain_inside(slot);
    assert!((after - before).abs() < 1e-13, "{before} {after}");
}

/// The lowest row goes into the clamp as far as the next one goes away: no strain, and the energy of the three pairs
/// with the clamp, each with twice the way along it. An undamaged row, and one that goes away, have none.
#[test]
fn a_way_into_the_clamp_by_hand() {
    let (mut model, slot) = clamped();
    let w = 1e-3 * DX;
    displace(&mut model, 0.0, |row| if row == 0 { -w } else { w });
    assert!((model.gradient[slot] - nalgebra::Matrix2::identity()).norm() < 1e-12);
    assert_eq!(model.energy_beside_clamp(slot), 0.0);
    let fracture = model.fracture.as_mut().expect("fracture");
    fracture.damage[slot] = 0.5;
    fracture.damaged = vec![slot];
    model.soften(slot);
    let modulus = model.hourglass_modulus * (1.0 - 0.5_f64.powi(16));
    let clamped: Vec<_> = model.pairs.neighbours(slot).filter(|&(j, _)| model.is_rigid(j)).collect();
    assert_eq!(clamped.len(), 3);
    let parts = clamped.iter().map(|&(j, slope)| {
        let apart = model.apart(slot, j);
        -model.volume * slope * (2.0 * w * apart[1] / apart.norm()).powi(2)
    });
    let expected = 0.5 * model.volume * modulus * parts.sum::<f64>();
    let found = model.energy_beside_clamp(slot);
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    displace(&mut model, 0.0, |row| if row == 0 { w } else { -w });
    assert_eq!(model.energy_beside_clamp(slot), 0.0);
}

/// Where F of the particle itself is squeezed, and where it is stretched; along the clamp it is stretched in both, so
/// that no principal stretch is 1, where the energy has a kink in its second derivative.
#[test]
fn what_keeps_it_out_is_the_slope_of_the_energy() {
    let (mut model, slot) = clamped();
    let w = 1e-3 * DX;
    let fracture = model.fracture.as_mut().expect("fracture");
    fracture.keys.strength = f64::INFINITY;
    (fracture.damage[slot], fracture.strain[slot]) = (0.7, 1.0);
    fracture.damaged = vec![slot];
    model.soften(slot);
    for rows in [[-w, 3.0 * w], [-w, -2.0 * w]] {
        displace(&mut model, 1e-3, |row| rows[row.min(1)]);
        assert!(model.energy_beside_clamp(slot) > 0.0);
        let acceleration = model.now.acceleration.clone();
        let largest = acceleration[1].iter().fold(0.0_f64, |most, a| most.max(a.abs()));
        let around = model.pairs.neighbours(slot).map(|(j, _)| j).chain([slot]);
        for slot in around.filter(|&j| !model.is_rigid(j)).collect::<Vec<_>>() {
            for d in 0..2 {
                let (found, expected) = (slope_of_energy(&mut model, slot, d), acceleration[d][slot]);
                assert!((found - expected).abs() < 1e-6 * largest, "{rows:?} {slot} {d}: {found} {expected}");
            }
        }
    }
}
