//! Last rows beside cracks: which they are, and what their edges see, by hand.

use super::{Run, solid, strength_and_energy};
use crate::total_lagrangian::TotalLagrangian;
use crate::total_lagrangian::material::Matrix;
use halfstep_scene::Geometry;
use nalgebra::SVector;

const PLANE: usize = 2;
const SPACE: usize = 3;
const DX: f64 = 0.005;

/// A wall of four rows across, x from 0 to 20 mm, 40 mm high.
fn wall(keys: &str) -> Run<PLANE> {
    Run::of(
        &(solid(DX, 0.0, &strength_and_energy(1e6, 20.0))
            + "[[shape]]\nname = \"wall\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.02, 0.04] }\n"
            + keys),
    )
}

/// Cuts level at half height, but for the rows that are left.
fn cut(model: &mut TotalLagrangian<PLANE>, is_left: impl Fn(f64) -> bool) {
    let at = |slot: usize| model.position_at(slot);
    let slots: Vec<usize> = model.slot_of.iter().map(|&slot| slot as usize).collect();
    let across = |&i: &usize| {
        let others = model.pairs.neighbours(i).map(move |(j, _)| [i, j]);
        let cut = |&[i, j]: &[usize; 2]| {
            let ([x, y], [x_j, y_j]) = (at(i), at(j));
            i < j && (y < 0.02) != (y_j < 0.02) && !(is_left(x) && is_left(x_j))
        };
        others.filter(cut).collect::<Vec<_>>()
    };
    let pairs = slots.iter().flat_map(across).collect();
    model.sever(pairs);
}

/// Where the particles of last rows are, in spacings from the corner.
fn places(model: &TotalLagrangian<PLANE>) -> Vec<[i32; 2]> {
    let ligaments = &model.fracture.as_ref().expect("it breaks").ligaments;
    let mut places: Vec<[i32; 2]> = ligaments
        .iter()
        .map(|ligament| model.position_at(ligament.slot).map(|x| (x / DX).floor() as i32))
        .collect();
    places.sort_unstable();
    places.dedup();
    places
}

#[test]
fn one_row_is_a_ligament_and_two_are_not() {
    let left = |keys: &str, is_left: &dyn Fn(f64) -> bool| {
        let mut run = wall(keys);
        assert!(places(&run.model).is_empty());
        cut(&mut run.model, is_left);
        places(&run.model)
    };
    let none: [[i32; 2]; 0] = [];
    assert_eq!(left("", &|x| x > 0.015), [[3, 3], [3, 4]], "the last row");
    assert_eq!(left("", &|x| x > 0.01), none);
    assert_eq!(left("", &|x| x > 0.005 && x < 0.01), [[1, 3], [1, 4]], "between two cracks");
    assert_eq!(left("", &|x| !(0.005..0.01).contains(&x)), [[0, 3], [0, 4]], "beside two rows");
    assert_eq!(left("", &|_| false), none, "off");
    // Elsewhere there are no rows.
    let text = solid(DX, 0.0, &(strength_and_energy(1e6, 20.0) + "\narrangement = \"irregular\""))
        + "[[shape]]\nname = \"wall\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.02, 0.04] }\n";
    let mut run = Run::<PLANE>::of(&text);
    cut(&mut run.model, |x| x > 0.015);
    assert_eq!(places(&run.model), none);
}

/// A row bent to the curvature c, u = (c y² / 2, -c x y) from its middle: at half a spacing the strain is c dx / 2, and
/// the row's own is none.
#[test]
fn the_edges_of_a_bent_row_by_hand() {
    let mut run = wall("");
    cut(&mut run.model, |x| x > 0.015);
    let model = &mut run.model;
    let curvature = 0.3;
    let field = |x: f64, y: f64| {
        let (x, y) = (x - 0.0175, y - 0.02);
        Matrix::<PLANE>::new(1.0, curvature * y, -curvature * y, 1.0 - curvature * x)
    };
    for slot in model.slot_of.clone() {
        let [x, y] = model.position_at(slot as usize);
        model.gradient[slot as usize] = field(x, y);
    }
    let ligaments = model.fracture.as_ref().unwrap().ligaments.clone();
    assert_eq!(ligaments.len(), 2);
    for ligament in &ligaments {
        let [x, y] = model.position_at(ligament.slot);
        let expected = [0.5, -0.5].map(|side| field(x + side * DX, y));
        let mut found = model.at_edges(ligament);
        found.sort_by(|a, b| a[(1, 1)].total_cmp(&b[(1, 1)]));
        for (found, mut expected) in found.into_iter().zip(expected) {
            // What a row along y tells: its own stretch and its turn.
            expected[(0, 1)] = field(x, y)[(0, 1)];
            assert!((found - expected).norm() < 1e-15, "{found} {expected}");
            assert!(((found[(1, 1)] - 1.0).abs() - 0.5 * curvature * DX).abs() < 1e-15);
        }
    }
}

/// The upper half turns about the middle of the last row: the edge opens by half of the angle times the spacing, of
/// which either particle beside the crack sees half over the spacing, as of a straight crack, and its middle nothing.
#[test]
fn a_hinge_between_two_particles() {
    let mut run = wall("");
    cut(&mut run.model, |x| x > 0.015);
    let model = &mut run.model;
    let angle = 1e-3;
    for slot in model.slot_of.clone() {
        let [x, y] = model.position_at(slot as usize);
        if y > 0.02 {
            model.now.displacement[0][slot as usize] = angle * (y - 0.02);
            model.now.displacement[1][slot as usize] = -angle * (x - 0.0175);
        }
    }
    model.evaluate(0.0);
    let ligaments = model.fracture.as_ref().unwrap().ligaments.clone();
    for ligament in &ligaments {
        let own = model.gradient[ligament.slot][(1, 1)] - 1.0;
        let edge = model.at_edges(ligament).map(|f| f[(1, 1)] - 1.0).into_iter().fold(0.0, f64::max);
        assert!((edge / angle - 0.25).abs() < 1e-9 && own.abs() < 1e-12, "{own} {edge}");
        assert!(model.is_edge_stretched(ligament, 0.45 * angle));
        assert!(!model.is_edge_stretched(ligament, 0.55 * angle));
    }
}

/// In space the last row is a row of particles along the crack's front.
#[test]
fn a_last_row_in_space() {
    let text = solid(DX, 0.0, &strength_and_energy(1e6, 20.0))
        + "[[shape]]\nname = \"wall\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.015, 0.03] }\n";
    let mut scene = halfstep_scene::parse(&text, "test.toml".as_ref(), &[]).unwrap();
    scene.dimension = SPACE;
    for shape in &mut scene.shapes {
        let Geometry::Box(block) = &mut shape.geometry else { panic!("a box") };
        block.max[2] = 0.02;
    }
    let mut run = Run::<SPACE>::of_scene(&scene);
    let model = &mut run.model;
    let slots: Vec<usize> = model.slot_of.iter().map(|&slot| slot as usize).collect();
    let mut pairs = Vec::new();
    for &i in &slots {
        for (j, _) in model.pairs.neighbours(i).filter(|&(j, _)| i < j) {
            let (x, y) = (model.position_at(i), model.position_at(j));
            if (x[1] < 0.015) != (y[1] < 0.015) && !(x[0] > 0.01 && y[0] > 0.01) {
                pairs.push([i, j]);
            }
        }
    }
    model.sever(pairs);
    let ligaments = &model.fracture.as_ref().unwrap().ligaments;
    assert_eq!(ligaments.len(), 2 * 4);
    let across = SVector::<f64, SPACE>::new(0.5 * DX, 0.0, 0.0);
    assert!(ligaments.iter().all(|ligament| (ligament.edge.abs() - across).norm() < 1e-12));
}
