//! What is crushed, cut off or without strength: it stays stable, gives no energy, and is counted.

use super::{Run, halves, run_on, sever_where, solid, strength_and_energy};
use crate::model::SolidModel;

/// A block of this arrangement falls on a wall that crushes it; what cracks take, J/m, and single particles, as
/// measured, and what may be left of the ledger, J/m. Of what is crushed the last digit decides: 2 % of the energy at
/// the start.
pub(super) fn crush(arrangement: &str, courant: f64, [cracks, loose, most_left]: [f64; 3]) {
    let text = solid(0.005, 0.3, &format!("{}\n{arrangement}", strength_and_energy(2e5, 2.0)))
        + &format!("[numerics]\nsolid_cfl = {courant}\n")
        + "[[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = { min = [0.0, 0.003], max = [0.06, 0.063] }\n\
           velocity = [0.0, -10.0]\n\
           [[shape]]\nname = \"floor\"\nphase = \"wall\"\nbox = { min = [-0.1, -0.03], max = [0.16, 0.0] }\ncontact = true\n";
    let mut run = Run::<2>::of(&text);
    let most = run_on(&mut run, 10_000);
    let summary = run.model.summary();
    println!("{arrangement} {courant}: {summary:?}, rest {} of {} J, most {most}", run.rest(), run.start);
    assert!((f64::from(summary.loose) - loose).abs() < 10.0, "{summary:?}");
    // What flies has the start's energy but for rounding.
    assert!(most < (1.0 + 1e-9) * run.start, "{most} of {}", run.start);
    assert!(run.rest().abs() < most_left, "{} of {}", run.rest(), run.start);
    assert!((summary.energy - cracks).abs() < 0.02 * run.start, "{summary:?}");
}

#[test]
fn a_block_that_is_crushed_on_a_wall_stays_stable() {
    crush("", 0.3, [89.8, 144.0, 1.5]);
}

#[test]
fn with_the_default_sub_step_more_is_left_of_the_ledger() {
    crush("", 0.6, [82.3, 144.0, 5.0]);
}

/// A block of 12 x 10 particles, cut level: 36 of a slab of three rows have become thin, none of one of five, nor where
/// the whole had four.
#[test]
fn fragments_that_have_become_thin_are_counted() {
    let thin = |height: f64, cut: f64| {
        let block = format!("box = {{ min = [0.0, 0.0], max = [0.06, {height}] }}\n");
        let text = solid(0.005, 0.3, &strength_and_energy(1e6, 20.0))
            + "[[shape]]\nname = \"block\"\nphase = \"solid\"\n"
            + &block;
        let mut model = Run::<2>::of(&text).model;
        sever_where(&mut model, |[_, y]| y < cut);
        assert_eq!((model.summary().bodies, model.summary().loose), (2, 0));
        model.summary().thin
    };
    assert_eq!([thin(0.05, 0.015), thin(0.05, 0.025), thin(0.02, 0.01)], [36, 0, 0]);
}

#[test]
fn a_solid_without_strength_breaks_and_stays_stable() {
    let text = halves(0.0).replace(&strength_and_energy(1e6, 20.0), &strength_and_energy(1.0, 1e-4));
    let mut run = Run::<2>::of(&text);
    let most = run_on(&mut run, 10_000);
    assert_eq!(run.model.summary().bodies, 2);
    let bound = run.start * (1.0 + 1e-9);
    assert!(most <= bound && run.rest().abs() < 0.01 * run.start, "{most}, {} of {}", run.rest(), run.start);
}

#[test]
fn debris_flies_on_for_ten_thousand_steps() {
    let mut run = Run::<2>::of(&("numerics.solid_cfl = 0.3\n".to_owned() + &halves(0.0)));
    run.until(1e-3);
    let (summary, rest) = (run.model.summary(), run.rest());
    let energy = run.model.strain_energy() + run.model.particles().kinetic_energy();
    let most = run_on(&mut run, 10_000);
    assert_eq!(run.model.summary(), summary);
    assert!(most < energy * 1.0001, "{most} {energy}");
    assert!((run.rest() - rest).abs() < 1e-3 * energy, "{} {rest}", run.rest());
}

#[test]
fn a_particle_that_is_cut_off_has_no_hourglass_resistance() {
    let mut run = Run::<2>::of(&halves(0.0));
    let slot = run.model.slot_of[0] as usize;
    let neighbours: Vec<usize> = run.model.pairs.neighbours(slot).map(|(j, _)| j).collect();
    assert_eq!(neighbours.len(), 3, "a corner");
    assert!(run.model.hourglass[slot] > 0.0);
    // One straight neighbour is left: a row has no second direction.
    run.model.sever(neighbours[1..].iter().map(|&j| [slot.min(j), slot.max(j)]).collect());
    assert!(!run.model.has_strain(slot) && run.model.hourglass[slot] == 0.0);
    assert_eq!(run.model.summary().loose, 1);
    run_on(&mut run, 100);
}

/// A soft bar that is thrown and torn at its clamp, squeezed there to less than half: particles of two sides that are
/// closer than surfaces may be, and were never neighbours, part without a jump.
#[test]
fn a_crushed_root_gives_no_energy() {
    let text = "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, 0.0]\n[solid]\ndensity = 1100.0\n\
                youngs_modulus = 2e6\npoissons_ratio = 0.0\nfracture = { strength = 8e3, energy = 1.5 }\n\
                [[shape]]\nname = \"bar\"\nphase = \"solid\"\nbox = { min = [0.0, -0.05], max = [0.04, 0.25] }\n\
                clamp = { min = [0.0, -0.05], max = [0.04, 0.0] }\nvelocity = [3.0, 0.0]\n\
                load = { within = { min = [0.0, 0.0], max = [0.01, 0.2] }, traction = [1500.0, 0.0], ramp = 0.05 }\n";
    let mut run = Run::<2>::of(text);
    let mut most = 0.0_f64;
    while run.time < 0.11 {
        run.step();
        let taken = run.model.fracture().energy;
        assert!(taken > most - 0.02, "{taken} J at {} s, {most} J before", run.time);
        most = most.max(taken);
    }
    println!("{most} J taken, rest {}", run.rest());
    assert!(most > 1.0 && run.rest().abs() < 0.01 * (run.start + run.given.abs()), "{most} {}", run.rest());
}

#[test]
fn debris_without_a_sensible_volume_becomes_a_single_particle() {
    let mut run = Run::<2>::of(&halves(0.0));
    let slot = run.model.slot_of[5] as usize;
    let neighbours: Vec<usize> = run.model.pairs.neighbours(slot).map(|(j, _)| j).collect();
    run.model.volume_ratio[slot] = 0.19;
    assert!(!run.model.is_crushed(slot), "no debris: its own bound ends the run");
    run.model.fracture.as_mut().unwrap().strain[slot] = 1e-3;
    assert!(run.model.is_crushed(slot));
    run.model.volume_ratio[slot] = 5.1;
    assert!(run.model.is_crushed(slot));
    run.model.volume_ratio[slot] = 1.9;
    assert!(!run.model.is_crushed(slot), "a crack that opens");
    let before = run.momentum();
    let fracture = run.model.fracture.as_mut().unwrap();
    fracture.accept(true);
    fracture.crushed = vec![slot];
    run.model.tear();
    let fracture = run.model.fracture.as_ref().unwrap();
    assert!(fracture.crushed.is_empty() && fracture.cuts.len() == neighbours.len());
    let summary = run.model.summary();
    assert_eq!((summary.bodies, summary.loose), (2, 1));
    run_on(&mut run, 100);
    let after = run.momentum();
    assert!((0..2).all(|d| (after[d] - before[d]).abs() < 1e-13), "{before:?} {after:?}");
}

/// A corner that one neighbour holds has no deformation gradient, and the neighbour is whole: what is stretched as far
/// as a crack lets go.
#[test]
fn a_particle_that_one_pair_holds_is_cut_off() {
    let text = solid(0.005, 0.3, &strength_and_energy(1e6, 20.0))
        + "[[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.06, 0.05] }\n";
    let mut run = Run::<2>::of(&text);
    let slot = run.model.slot_of[0] as usize;
    let mut pairs: Vec<[usize; 2]> =
        run.model.pairs.neighbours(slot).map(|(j, _)| [slot.min(j), slot.max(j)]).collect();
    let distance = |&[i, j]: &[usize; 2]| run.model.apart(i, j).norm();
    pairs.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    run.model.sever(pairs.split_off(1));
    let summary = run.model.summary();
    assert_eq!((summary.bodies, summary.loose), (1, 1), "one pair is left");
    run.model.now.velocity[0][slot] = -10.0;
    run.model.now.velocity[1][slot] = -10.0;
    run.until(1e-4);
    let summary = run.model.summary();
    assert_eq!((summary.bodies, summary.loose), (2, 1));
}
