//! What a solid does to the density of water that leaves it, beside values by hand.

use super::{Interface, Parameters};
use halfstep_scene::parse;
use halfstep_sph::lane::Isa;
use halfstep_wire::protocol::StateRecord;
use std::path::Path;

const DX: f64 = 0.01;
const ROWS: usize = 12;

fn record(id: usize, (x, y): (f64, f64), vx: f64, density: f64) -> StateRecord {
    StateRecord {
        id: id as u32,
        position: [x, y, 0.0],
        velocity: [vx, 0.0, 0.0],
        density,
        mass: density * DX * DX,
        ..StateRecord::default()
    }
}

/// Columns of particles from x on, `columns` of them.
fn lattice(x: f64, columns: usize, vx: f64, density: f64, first: usize) -> Vec<StateRecord> {
    let place = |k: usize| (x + (k / ROWS) as f64 * DX, (k % ROWS) as f64 * DX);
    (0..columns * ROWS).map(|k| record(first + k, place(k), vx, density)).collect()
}

/// Density rates, kg/(m³ s), of water without pressure on the left and on the right of a plate `columns` thick that
/// moves with `plate`, m/s.
fn rates(columns: usize, plate: f64, left: f64, right: f64, separation: &str) -> [Vec<f64>; 2] {
    let text = format!(
        "resolution = {DX}\nend_time = 1.0\ngravity = [0.0, 0.0]\nsmoothing_ratio = 2.0\n\
         [effects]\nwall-separation = \"{separation}\"\n[fluid]\ndensity = 1000.0\nsound_speed = 20.0\n\
         [solid]\ndensity = 2000.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n\
         [[shape]]\nname = \"plate\"\nphase = \"solid\"\nbox = {{ min = [0.0, 0.0], max = [{}, 0.12] }}\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.2, 0.0], max = [0.3, 0.1] }}\n",
        columns as f64 * DX
    );
    let scene = parse(&text, Path::new("s.toml"), &[]).expect("a right scene");
    let mut interface = Interface::<2>::new(Parameters::new(&scene, 0, Isa::detect()).expect("both"));
    assert_eq!(interface.parameters.thin_plates.len(), usize::from(columns < 7), "screened below 4h - dx");
    let solid = lattice(0.5 * DX, columns, plate, 2000.0, 0);
    let mut water = lattice(-3.5 * DX, 4, left, 1000.0, 0);
    water.extend(lattice((columns as f64 + 0.5) * DX, 4, right, 1000.0, 4 * ROWS));
    interface.update(&water, &solid, 1);
    let mut found = vec![0.0; water.len()];
    interface.act_on_fluid(|record, _, rate| found[record] = rate);
    let right = found.split_off(4 * ROWS);
    [found, right]
}

fn largest(rates: &[f64]) -> f64 {
    rates.iter().fold(0.0, |most, rate| rate.abs().max(most))
}

/// All water of a side has the velocity v~_s that the plate then shows continuity: no pair approaches or recedes.
#[test]
fn water_that_leaves_as_a_whole_keeps_its_density() {
    // Screened, and with one state for both sides: then the far side's water is out of reach of half of the plate.
    for columns in [4, 9] {
        // Both sides leave; a plate that is withdrawn from the left.
        for (plate, left, right) in [(0.0, -0.3, 0.3), (0.2, 0.0, 0.2)] {
            let [a, b] = rates(columns, plate, left, right, "on");
            assert!(largest(&a) < 1e-9 && largest(&b) < 1e-9, "{columns}: {} {}", largest(&a), largest(&b));
            let [without, _] = rates(columns, plate, left, right, "off");
            // Receding by v over about a spacing and a half: half of rho0 v / dx.
            assert!(largest(&without) > 0.3 * 1000.0 * 0.2 / DX, "{}", largest(&without));
        }
    }
}

/// Each face by itself: the plate moves from one water into the other.
#[test]
fn water_that_arrives_is_compressed_as_without() {
    let [left, right] = rates(4, 0.2, 0.0, 0.0, "on");
    let [_, compressed] = rates(4, 0.2, 0.0, 0.0, "off");
    assert!(largest(&left) < 1e-9, "{}", largest(&left));
    assert!(largest(&right) > 0.3 * 1000.0 * 0.2 / DX, "{}", largest(&right));
    assert_eq!(right, compressed);
}
