//! What is crushed, cut off or without strength: it stays stable, gives no energy, and is counted.

use super::{Run, halves, run_on, sever_where, solid, strength_and_energy};
use crate::model::SolidModel;
use crate::total_lagrangian::TotalLagrangian;
use nalgebra::{DMatrix, DVector};

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
    // The rest is 0.1 J/m, as measured.
    crush("", 0.3, [86.9, 144.0, 0.3]);
}

#[test]
fn with_the_default_sub_step_more_is_left_of_the_ledger() {
    // 3.0 J/m.
    crush("", 0.6, [87.3, 144.0, 5.0]);
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
    let before = run.momentum();
    run_on(&mut run, 100);
    let after = run.momentum();
    assert!((0..2).all(|d| (after[d] - before[d]).abs() < 1e-13), "{before:?} {after:?}");
    assert!(run.rest().abs() < 0.01 * run.start, "{} of {}", run.rest(), run.start);
}

/// Spacing of the lattice that pieces are cut from, m, and E, Pa.
const DX: f64 = 0.005;
const MODULUS: f64 = 1e9;

/// A piece that is cut out of the middle of a block, its particles by column and row; contacts aside, which resist
/// pressure on the cut.
struct Piece {
    model: TotalLagrangian<2>,
    /// Of the particles, in their order.
    slots: Vec<usize>,
}

impl Piece {
    fn of(cells: &[[i32; 2]]) -> Self {
        let text = solid(DX, 0.3, &strength_and_energy(1e6, 20.0))
            + "[[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.06, 0.06] }\n";
        let mut model = Run::<2>::of(&text).model;
        let cell = |at: [f64; 2]| at.map(|x| (x / DX) as i32 - 5);
        sever_where(&mut model, |at| cells.contains(&cell(at)));
        model.contact = None;
        let slot = |wanted: &[i32; 2]| {
            let mut all = model.slot_of.iter().map(|&slot| slot as usize);
            all.find(|&slot| cell(model.position_at(slot)) == *wanted).expect("a particle")
        };
        let slots = cells.iter().map(slot).collect();
        Self { model, slots }
    }

    /// Moves its particles away from the reference configuration; `to` takes their order and has m.
    fn displace(&mut self, to: impl Fn(usize) -> [f64; 2]) {
        for (k, &slot) in self.slots.iter().enumerate() {
            for (d, u) in to(k).into_iter().enumerate() {
                self.model.now.displacement[d][slot] = u;
            }
        }
        self.model.evaluate(0.0);
    }

    fn place(&self, k: usize) -> [f64; 2] {
        std::array::from_fn(|d| self.model.pairs.position()[d][self.slots[k]])
    }

    /// What it stores, J/m.
    fn stored(&self) -> f64 {
        self.slots.iter().map(|&slot| self.model.stored_at(slot)).sum()
    }

    /// Particles without a deformation gradient.
    fn loose(&self) -> usize {
        self.slots.iter().filter(|&&slot| !self.model.has_strain(slot)).count()
    }

    /// The stiffness of the undeformed piece, Pa: central differences of the model's forces.
    fn stiffness(&mut self) -> DMatrix<f64> {
        const STEP: f64 = 1e-8;
        let n = 2 * self.slots.len();
        let mut stiffness = DMatrix::zeros(n, n);
        for column in 0..n {
            let [ahead, behind] = [STEP, -STEP].map(|step| {
                self.displace(|k| [0, 1].map(|d| if 2 * k + d == column { step } else { 0.0 }));
                let acceleration = &self.model.now.acceleration;
                DVector::from_fn(n, |row, _| self.model.mass * acceleration[row % 2][self.slots[row / 2]])
            });
            stiffness.set_column(column, &((behind - ahead) / (2.0 * STEP)));
        }
        self.displace(|_| [0.0; 2]);
        stiffness
    }

    /// How many independent motions meet no stiffness; all others meet a tenth of E and more.
    fn free_modes(&mut self) -> usize {
        let stiffness = self.stiffness();
        let skew = (&stiffness - stiffness.transpose()).amax();
        assert!(skew < 1e-6 * MODULUS, "forces have an energy: {skew}");
        let values = ((&stiffness + stiffness.transpose()) * 0.5).symmetric_eigenvalues();
        let free = values.iter().filter(|value| value.abs() < 1e-6 * MODULUS).count();
        let stiff = values.iter().filter(|&&value| value > 0.1 * MODULUS).count();
        println!("{free} free modes of {}: {:?}", values.len(), values.as_slice());
        assert_eq!(free + stiff, values.len(), "{values}");
        free
    }
}

/// A particle with a deformation gradient holds all its neighbours: what strains it stores energy, and what differs
/// from its own linear field does so by the hourglass resistance. So it turns and moves with them as one, and two of
/// these that are neighbours turn alike: three free modes, whatever the form.
#[test]
fn small_pieces_have_no_free_mode_but_rigid_motion() {
    let forms: [(&[[i32; 2]], usize); 6] = [
        // Two by two, whose corners have three neighbours.
        (&[[0, 0], [1, 0], [0, 1], [1, 1]], 0),
        (&[[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]], 0),
        // An L of three: the corner has a neighbour along each axis; the pair of the ends, which have one straight
        // neighbour each, is cut.
        (&[[0, 0], [1, 0], [0, 1]], 2),
        // A tail, held by the hourglass resistance of the two that it hangs on.
        (&[[0, 0], [1, 0], [0, 1], [1, 1], [2, 0]], 1),
        // A T and a cross: the middle holds three and four.
        (&[[0, 0], [1, 0], [2, 0], [1, 1]], 3),
        (&[[1, 1], [0, 1], [2, 1], [1, 0], [1, 2]], 4),
    ];
    for (cells, loose) in forms {
        let mut piece = Piece::of(cells);
        assert_eq!((piece.loose(), piece.free_modes()), (loose, 3), "{cells:?}");
        assert_eq!(piece.model.summary().bodies, 2, "{cells:?}");
        // Turned by 1 rad it stores nothing: what it stored would be up to E of each cell.
        let ([x0, y0], (s, c)) = (piece.place(0), (libm::sin(1.0), libm::cos(1.0)));
        let places: Vec<[f64; 2]> = (0..cells.len()).map(|k| piece.place(k)).collect();
        piece.displace(|k| {
            let [x, y] = [places[k][0] - x0, places[k][1] - y0];
            [c * x - s * y - x, s * x + c * y - y]
        });
        assert!(piece.stored().abs() < 1e-12 * MODULUS * DX * DX, "{cells:?}: {}", piece.stored());
    }
}

/// One row has no second direction: none of its particles has a deformation gradient, and pairs of such are cut. What
/// is left are single particles, free each by itself, however they move.
#[test]
fn one_row_falls_to_single_particles() {
    let cells = [[0, 0], [1, 0], [2, 0]];
    let mut piece = Piece::of(&cells);
    assert_eq!((piece.loose(), piece.free_modes()), (3, 6));
    assert_eq!(piece.model.summary().bodies, 1 + 3);
    for step in 0..20 {
        // Up to half a spacing, by the golden ratio's multiples.
        let part = |k: usize| DX * ((0.618_033_988_749_895 * (6 * step + k) as f64).fract() - 0.5);
        piece.displace(|k| [part(2 * k), part(2 * k + 1)]);
        assert_eq!(piece.stored(), 0.0);
        let acceleration = &piece.model.now.acceleration;
        assert!(piece.slots.iter().all(|&slot| acceleration.iter().all(|a| a[slot] == 0.0)));
    }
}

/// A U of five: each corner holds its two neighbours, and both hold the middle, which has no deformation gradient and
/// resists nothing by itself. That is a hinge, a fourth free mode. Folded by it, both halves turn as rigid bodies.
#[test]
fn two_corners_that_share_a_loose_particle_are_hinged() {
    let cells = [[0, 1], [0, 0], [1, 0], [2, 0], [2, 1]];
    let mut piece = Piece::of(&cells);
    assert_eq!((piece.loose(), piece.free_modes()), (3, 4));
    assert_eq!(piece.model.summary().bodies, 2);
    let (hinge, places) = (piece.place(2), [0, 1, 2, 3, 4].map(|k| piece.place(k)));
    let folded = |angle: f64| {
        move |k: usize| {
            let turned = if k < 2 { angle } else { -angle };
            let (s, c) = (libm::sin(turned), libm::cos(turned));
            let [x, y] = [places[k][0] - hinge[0], places[k][1] - hinge[1]];
            [c * x - s * y - x, s * x + c * y - y]
        }
    };
    for angle in [-0.7, 0.1, 0.7] {
        piece.displace(folded(angle));
        assert!(piece.stored().abs() < 1e-12 * MODULUS * DX * DX, "{angle}: {}", piece.stored());
    }
    // Spread as much without turning the halves, the corners are strained.
    piece.displace(|k| [0.1 * (places[k][0] - hinge[0]), 0.0]);
    assert!(piece.stored() > 1e-3 * MODULUS * DX * DX, "{}", piece.stored());
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
