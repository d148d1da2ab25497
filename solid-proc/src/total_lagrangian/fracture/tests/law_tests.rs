//! The law of one particle: a block whose particles all have the same prescribed stretches.

use super::{Run, solid, strength_and_energy};
use crate::total_lagrangian::material::Matrix;

/// dx, m, and f_t, Pa.
const DX: f64 = 0.005;
const STRENGTH: f64 = 1e6;

/// How the particles are held across the pull.
#[derive(Clone, Copy)]
enum Across {
    /// Nominal stress across, Pa.
    Stress(f64),
    /// As stretched as along until damage begins, and held then.
    Alike,
    /// It cannot contract.
    Held,
}

/// What damage took and what is stored when it is broken, over G_f / b; the smallest nominal stress along, over f_t.
struct Pulled {
    taken: f64,
    stored: f64,
    least: f64,
}

/// Pulls until it is broken; G_f / (f_t b) is `opening`.
fn pulled(nu: f64, opening: f64, across: Across) -> Pulled {
    let energy = opening * STRENGTH * 2.0 * DX;
    let text = solid(DX, nu, &strength_and_energy(STRENGTH, energy))
        + "[[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.025, 0.025] }\n";
    let mut model = Run::<2>::of(&text).model;
    let slots: Vec<usize> = (0..model.id.len()).filter(|&slot| model.is_free(slot)).collect();
    let middle = model.slot_of[12] as usize;
    let start = model.pairs.position().clone();
    model.fracture.as_mut().expect("a brittle block").accept(true);
    let (mut s, mut t, mut least) = (1.0, 1.0, 0.0_f64);
    let step = 12.0 * opening / 20_000.0;
    while !model.fracture.as_ref().expect("a brittle block").is_broken(middle) {
        let damage = model.damage_at(middle);
        match across {
            Across::Stress(stress) => t = across_at(&model, s, t, damage, stress),
            Across::Alike if damage == 0.0 => t = s,
            Across::Alike | Across::Held => (),
        }
        for &slot in &slots {
            model.now.displacement[0][slot] = (s - 1.0) * start[0][slot];
            model.now.displacement[1][slot] = (t - 1.0) * start[1][slot];
        }
        model.evaluate(0.0);
        model.keep_gradients();
        let (f, j) = (model.gradient[middle], model.volume_ratio[middle]);
        if model.damage_at(middle) > 0.0 {
            least = least.min(model.stress_at(middle, &f, j)[(0, 0)] / STRENGTH);
        }
        s += step;
    }
    let per_volume = 2.0 * DX / (energy * DX * DX);
    let taken = model.summary().energy / slots.len() as f64 * per_volume;
    Pulled { taken, stored: model.stored_at(middle) * per_volume, least }
}

/// The stretch across at which the nominal stress across is that, near `t`.
fn across_at(
    model: &crate::total_lagrangian::TotalLagrangian<2>,
    s: f64,
    t: f64,
    damage: f64,
    stress: f64,
) -> f64 {
    let at = |t: f64| {
        let f = Matrix::<2>::new(s, 0.0, 0.0, t);
        let j = model.law.volume_ratio(&f);
        model.law.damaged(&f, j, damage).stress[(1, 1)] - stress
    };
    let mut t = t;
    for _ in 0..50 {
        let slope = (at(t + 1e-7) - at(t - 1e-7)) / 2e-7;
        let change = at(t) / slope;
        t -= change;
        if change.abs() < 1e-14 {
            break;
        }
    }
    t
}

/// With what a cut takes, all that is stored.
fn with_cut(pulled: Pulled) -> f64 {
    pulled.taken + pulled.stored
}

/// What is above 1 is neo-Hooke's law; at 0.1 the band is the narrowest that is allowed.
#[test]
fn a_strip_takes_its_fracture_energy() {
    for (opening, measured) in [(0.005, 1.0008), (0.01, 1.005), (0.02, 1.015), (0.1, 1.09)] {
        let taken = with_cut(pulled(0.0, opening, Across::Stress(0.0)));
        println!("strip {opening}: {taken}");
        assert!((taken - measured).abs() < 0.002, "{opening}: {taken}");
    }
    for nu in [0.2, 0.3, 0.4, 0.45] {
        let taken = with_cut(pulled(nu, 0.01, Across::Stress(0.0)));
        println!("strip nu {nu}: {taken}");
        assert!((taken - 1.0).abs() < 0.01, "{nu}: {taken}");
    }
}

/// 2 E' psi_0 / f_t², psi_0 at the onset, of linear elasticity in plane strain: 2 (1 - nu - 2 nu²) / (1 - nu²) where
/// it is stretched alike both ways, (1 - 2 nu) / (1 - nu)² where it cannot contract.
#[test]
fn what_is_held_across_takes_what_it_stores() {
    let alike = |nu: f64| 2.0 * (1.0 - nu - 2.0 * nu * nu) / (1.0 - nu * nu);
    let held = |nu: f64| (1.0 - 2.0 * nu) / ((1.0 - nu) * (1.0 - nu));
    for (nu, share, across, stored, said) in [
        (0.0, 0.5, Across::Alike, alike(0.0), 1.5),
        (0.2, 0.5, Across::Alike, alike(0.2), 1.25),
        (0.2, 0.8, Across::Held, held(0.2), 0.95),
        (0.3, 0.8, Across::Held, held(0.3), 0.85),
        (0.45, 0.8, Across::Held, held(0.45), 0.46),
    ] {
        // The widest band has G_f / (f_t b) = f_t / (2 E').
        let opening = STRENGTH * (1.0 - nu * nu) / (2.0 * 1e9) / share;
        let taken = with_cut(pulled(nu, opening, across));
        let theory = 1.0 + share * (stored - 1.0);
        println!("held {nu} {share}: {taken}, {theory}");
        assert!((taken / theory - 1.0).abs() < 0.01 && (taken - said).abs() < 0.02, "{nu}: {taken} {theory}");
    }
}

/// At a nominal stress of -3 f_t and -5 f_t across; G_f / (f_t b) of 0.01, and of half of the widest band.
#[test]
fn a_crack_under_a_squeeze_pushes_its_faces_apart() {
    for (nu, squeeze, wide, brittle) in
        [(0.2, 3.0, [1.08, 0.0], [1.83, -0.06]), (0.3, 5.0, [1.35, 0.0], [4.32, -0.71])]
    {
        for (opening, [takes, pushes]) in [(0.01, wide), (STRENGTH * (1.0 - nu * nu) / 1e9, brittle)] {
            let Pulled { taken, least, .. } = pulled(nu, opening, Across::Stress(-squeeze * STRENGTH));
            println!("squeeze {nu} {squeeze} {opening}: {taken}, {least}");
            assert!(
                (taken / takes - 1.0).abs() < 0.02 && (least - pushes).abs() < 0.01,
                "{nu}: {taken} {least}"
            );
        }
    }
}
