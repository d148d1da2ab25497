//! Cuts beside clamps and over an interruption.

use super::super::determinant;
use super::{Run, halves, run_on, slot_at, solid, strength_and_energy};
use crate::total_lagrangian::material::Matrix;
use halfstep_sph::tensor;
use halfstep_wire::state::State;
use nalgebra::SVector;

#[test]
fn a_run_goes_on_from_a_checkpoint_in_the_middle_of_a_break() {
    let mut run = Run::<2>::of(&halves(0.0));
    while run.model.summary().area == 0.0 {
        run.step();
    }
    let mut again = Run::<2>::of(&halves(0.0));
    again.model.load(&run.model.save()).unwrap();
    (again.time, again.steps) = (run.time, run.steps);
    for _ in 0..400 {
        run.step();
        again.step();
    }
    assert!(run.model.summary().bodies > 1, "{:?}", run.model.summary());
    assert!(run.bits() == again.bits());
    assert_eq!(run.model.summary(), again.model.summary());
}

/// Halves that a crack parts but for one column, pressed on each other, and then apart: their sides touch, were never
/// neighbours, and lost no pair.
#[test]
fn sides_that_never_were_neighbours_change_nothing_on_resuming() {
    let text = solid(0.005, 0.0, &strength_and_energy(1e6, 100.0))
        + "[[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.06, 0.04] }\n\
           crack = [[-0.001, 0.02], [0.055, 0.02]]\n";
    let mut run = Run::<2>::of(&text);
    let slots: Vec<usize> = (0..run.model.id.len()).filter(|&slot| run.model.is_free(slot)).collect();
    let above = |run: &Run<2>, slot: usize| run.model.position_at(slot)[1] > 0.02;
    let start = run.model.correction.clone();
    let (upper, lower): (Vec<usize>, Vec<usize>) = slots.iter().partition(|&&slot| above(&run, slot));
    upper.iter().for_each(|&slot| run.model.now.displacement[1][slot] = -1e-5);
    run.model.evaluate(0.0);
    let across = |&slot: &usize| -> Vec<[usize; 2]> {
        let others = run.model.pairs.neighbours(slot).map(|(other, _)| other);
        others.filter(|other| upper.contains(other)).map(|other| [slot.min(other), slot.max(other)]).collect()
    };
    let ligament: Vec<[usize; 2]> = lower.iter().flat_map(across).collect();
    assert_eq!(ligament.len(), 1, "the last column: the diagonals to it cross the crack's end");
    run.model.sever(ligament.clone());
    let cuts = run.model.fracture.as_ref().unwrap().cuts.len();
    assert!(cuts == ligament.len() && run.model.summary().bodies == 2, "{cuts} cuts");
    let mut again = Run::<2>::of(&text);
    again.model.load(&run.model.save()).unwrap();
    for &slot in &slots {
        let bits = |m: &Matrix<2>| m.map(f64::to_bits);
        assert_eq!(bits(&again.model.correction[slot]), bits(&run.model.correction[slot]));
        let touched = ligament.iter().flatten().any(|&other| other == slot);
        assert!(touched || bits(&run.model.correction[slot]) == bits(&start[slot]));
    }
    run_on(&mut run, 50);
    run_on(&mut again, 50);
    assert!(run.bits() == again.bits());
}

/// In space a kernel of h = 0.9 dx sees less than half of an eighth of the inside from a corner.
#[test]
fn corners_by_hand() {
    use halfstep_sph::kernel::{CubicSpline, Kernel, WendlandC2};
    // det M is 1 inside, up to what the lattice leaves; in the plane with h = 0.6 dx a corner has two neighbours of
    // weight w, and det M = (w dx²)².
    let kernel = CubicSpline::<2>::new(0.6);
    let w = -kernel.slope_at(1.0);
    assert!((determinant(kernel, 1.0, 0) - w * w).abs() < 1e-14);
    // All eight octants: the same sum over whole rows.
    let inside = |kernel: CubicSpline<3>| {
        let mut moment = Matrix::<3>::zeros();
        for k in 0..125 {
            let rows = [k / 25, k / 5 % 5, k % 5].map(|row| f64::from(row - 2));
            let x = SVector::<f64, 3>::from(rows);
            if x.norm() > 0.0 {
                let slope = kernel.slope_at(x.norm());
                moment -= x * x.transpose() * slope;
            }
        }
        tensor::determinant(&moment)
    };
    for (scale, ratio) in [(0.75, 0.888), (0.9, 0.482), (0.95, 0.397)] {
        let kernel = CubicSpline::<3>::new(scale);
        assert!((determinant(kernel, 1.0, -1) / inside(kernel) - 1.0).abs() < 1e-12);
        let found = determinant(kernel, 1.0, 0) / (inside(kernel) / 8.0);
        assert!((found - ratio).abs() < 2e-3, "{scale}: {found}");
    }
    assert!(determinant(WendlandC2::<3>::new(0.95), 1.0, 0) > 0.0);
}

/// Along the clamp, nowhere else, and as high as the bar.
fn is_along_clamp(run: &Run<2>) -> bool {
    (run.model.summary().area - 0.04).abs() < 1e-9 && run.is_cut_along_clamps()
}

/// Pulled in all its length, most at the clamp.
#[test]
fn a_crack_along_a_clamp_takes_its_fracture_energy() {
    let text = solid(0.005, 0.0, &strength_and_energy(1e6, 100.0))
        + "[[shape]]\nname = \"bar\"\nphase = \"solid\"\nbox = { min = [-0.02, 0.0], max = [0.1, 0.04] }\n\
           clamp = { min = [-0.02, 0.0], max = [0.0, 0.04] }\n\
           load = { within = { min = [0.0, 0.0], max = [0.1, 0.04] }, traction = [6e4, 0.0], ramp = 5e-3 }\n";
    let mut run = Run::<2>::of(&text);
    while run.model.summary().bodies == 1 {
        run.step();
    }
    let taken = run.model.summary().energy / (100.0 * 0.04);
    println!("along a clamp {} {taken}, rest {}", is_along_clamp(&run), run.rest());
    assert!(is_along_clamp(&run) && (taken - 1.015).abs() < 0.003, "{taken}");
    run_on(&mut run, 400);
    assert_eq!(run.model.summary().energy, taken * 100.0 * 0.04, "it only flies");
    assert!(run.rest().abs() < 2e-3 * 4.0, "{}", run.rest());
}

/// The face lies three quarters of the way to the clamped row, whose side stores nothing all the same.
#[test]
fn a_crack_along_a_clamp_that_cuts_a_row_takes_its_fracture_energy() {
    let text = solid(0.005, 0.0, &strength_and_energy(1e6, 100.0))
        + "[[shape]]\nname = \"bar\"\nphase = \"solid\"\nbox = { min = [-0.02, 0.0], max = [0.1, 0.04] }\n\
           clamp = { min = [-0.02, 0.0], max = [-0.00125, 0.04] }\n\
           load = { within = { min = [0.095, 0.0], max = [0.1, 0.04] }, traction = [1.1e6, 0.0], ramp = 5e-3 }\n";
    let mut run = Run::<2>::of(&text);
    while run.model.summary().bodies == 1 {
        run.step();
    }
    let taken = run.model.summary().energy / (100.0 * 0.04);
    println!("{taken} of G_f A, at {} s", run.time);
    assert!(is_along_clamp(&run) && (taken - 1.018).abs() < 0.003, "{taken}");
}

/// A broken particle lets go of three intact ones above it, a straight and two diagonal pairs, when they are 1.5 times
/// as far from it as a broken band is open.
#[test]
fn a_broken_particle_lets_go_of_intact_ones() {
    let dx = 0.005;
    let text = solid(dx, 0.0, &strength_and_energy(1e6, 100.0))
        + "[[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.055, 0.055] }\n";
    let mut model = Run::<2>::of(&text).model;
    let slot = slot_at(&model, [0.0275, 0.0275]);
    let fracture = model.fracture.as_mut().expect("fracture");
    fracture.onset[slot] = 1e-3;
    // e_f = G_f / (f_t b) - e0 / 2, and 0.5 % of the strength are left.
    let broken = 1e-3 - (0.01 - 0.5e-3) * 0.005_f64.ln();
    fracture.strain[slot] = 1.001 * broken;
    fracture.damaged = vec![slot];
    for (part, pairs) in [(0.95, 0), (1.02, 3)] {
        for other in model.slot_of.clone().into_iter().map(|slot| slot as usize) {
            let above = model.pairs.position()[1][other] > 0.028;
            model.now.displacement[1][other] = if above { part * 1.5 * 2.0 * dx * broken } else { 0.0 };
        }
        let torn = model.torn(model.fracture.as_ref().expect("fracture"));
        assert_eq!(torn.len(), pairs, "{torn:?}");
        assert!(torn.iter().all(|pair| pair.contains(&slot)), "{torn:?}");
    }
}
