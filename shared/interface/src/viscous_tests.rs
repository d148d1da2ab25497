//! Viscous stress across the interface by hand: a pair, shear beside a plate, what turns as one, and thin plates.

use super::{Interface, Parameters};
use halfstep_scene::{Scene, parse};
use halfstep_sph::lane::Isa;
use halfstep_wire::protocol::StateRecord;
use std::f64::consts::PI;
use std::path::Path;

const DX: f64 = 0.01;
const H: f64 = 1.5 * DX;
/// Pa s.
const MU: f64 = 2.0;

/// A plate of some rows, upright.
fn scene(rows: usize, effects: &str) -> Scene {
    let text = format!(
        "resolution = {DX}\nsmoothing_ratio = 1.5\nend_time = 1.0\ngravity = [0.0, 0.0]\n{effects}\n\
         effects.viscosity = \"on\"\n[fluid]\ndensity = 1000.0\nviscosity = {MU}\nsound_speed = 20.0\n[solid]\n\
         density = 2000.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n[[shape]]\nname = \"plate\"\n\
         phase = \"solid\"\nbox = {{ min = [0.0, 0.0], max = [{}, 0.4] }}\n[[shape]]\nname = \"water\"\n\
         phase = \"fluid\"\nbox = {{ min = [0.2, 0.0], max = [0.3, 0.1] }}\n",
        DX * rows as f64
    );
    parse(&text, Path::new("s.toml"), &[]).unwrap()
}

fn interface(rows: usize, effects: &str) -> Interface<2> {
    Interface::new(Parameters::new(&scene(rows, effects), 0, Isa::detect()).unwrap())
}

fn record(id: usize, [x, y]: [f64; 2], [u, v]: [f64; 2], density: f64, spacing: f64) -> StateRecord {
    let (position, velocity) = ([x, y, 0.0], [u, v, 0.0]);
    let mass = density * spacing * spacing;
    StateRecord { id: id as u32, position, velocity, density, mass, ..StateRecord::default() }
}

/// A lattice of columns and rows from a corner, with a velocity that depends on the place.
fn lattice(
    corner: [f64; 2],
    cells: [usize; 2],
    spacing: f64,
    density: f64,
    velocity: impl Fn([f64; 2]) -> [f64; 2],
) -> Vec<StateRecord> {
    let particle = |k: usize| {
        let cell = [k % cells[0], k / cells[0]];
        let x = std::array::from_fn(|d| corner[d] + (cell[d] as f64 + 0.5) * spacing);
        record(k, x, velocity(x), density, spacing)
    };
    (0..cells[0] * cells[1]).map(particle).collect()
}

/// Forces on fluid and solid records.
fn forces(interface: &mut Interface<2>, fluid: &[StateRecord], solid: &[StateRecord]) -> [Vec<[f64; 2]>; 2] {
    interface.update(fluid, solid, 1);
    let mut on = [vec![[0.0; 2]; fluid.len()], vec![[0.0; 2]; solid.len()]];
    interface.drag_on_fluid(|r, a| on[0][r] = a.map(|a| a * fluid[r].mass));
    interface.drag_on_solid(|r, a| on[1][r] = a.map(|a| a * solid[r].mass));
    on
}

fn sum(forces: &[[f64; 2]]) -> [f64; 2] {
    forces.iter().fold([0.0; 2], |sum, f| [sum[0] + f[0], sum[1] + f[1]])
}

#[test]
fn a_pair_is_what_the_formulas_say() {
    let mut interface = interface(8, "");
    let (v, u) = ([0.3, 0.1], [0.1, -0.2]);
    let fluid = record(0, [-0.6 * DX, 0.8 * DX], v, 1000.0, DX);
    let solid = record(0, [0.0, 0.0], u, 2000.0, 0.5 * DX);
    let [[on_fluid], [on_solid]] = forces(&mut interface, &[fluid], &[solid]).map(|f| [f[0]]);
    // r = dx, s = 2/3: F = -5 c / h² (2/3)³, c = 7 / (4 pi h²). The one neighbour is the mean, so w~ = w = v - u, and a
    // lone solid particle does not turn: the solid shows 2 u - v. <r²> = 5 h² / 9 makes 4 mu / <r²> 7.2 mu / h².
    let slope = -5.0 * 7.0 / (4.0 * PI * H.powi(4)) * (2.0_f64 / 3.0).powi(3);
    let (volume_f, volume_s) = (DX * DX, 0.25 * DX * DX);
    let place = [-0.6 * DX, 0.8 * DX];
    let approach = 2.0 * ((v[0] - u[0]) * place[0] + (v[1] - u[1]) * place[1]);
    for d in 0..2 {
        let expected = 7.2 * MU / (H * H) * volume_f * volume_s * slope * approach * place[d];
        assert!((on_fluid[d] / expected - 1.0).abs() < 1e-9, "{} {expected}", on_fluid[d]);
        assert!((on_solid[d] / expected + 1.0).abs() < 1e-9, "{} {expected}", on_solid[d]);
    }
}

/// Water four rows deep on the left of an upright plate of six rows, which is at rest at x = 0 and beyond.
fn beside(velocity: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<StateRecord> {
    lattice([-4.0 * DX, 0.0], [4, 40], DX, 1000.0, velocity)
}

#[test]
fn shear_drags_a_plate_by_its_stress() {
    const RATE: f64 = 5.0;
    let mut interface = interface(6, "");
    let fluid = beside(|[x, _]| [0.0, RATE * -x]);
    // What the lattice and the reversed mean velocity make of mu RATE; a finer plate has particles nearer to its face.
    for (across, right) in [(1, 0.9976), (2, 1.0990)] {
        let spacing = DX / across as f64;
        let solid = lattice([0.0, 0.0], [6 * across, 40 * across], spacing, 2000.0, |_| [0.0; 2]);
        let [on_fluid, on_solid] = forces(&mut interface, &fluid, &solid);
        let middle = |r: &StateRecord| r.position[1] > 0.1 && r.position[1] < 0.3;
        let on_middle: Vec<[f64; 2]> =
            solid.iter().zip(&on_solid).filter(|(r, _)| middle(r)).map(|(_, f)| *f).collect();
        let [across_it, along] = sum(&on_middle).map(|f| f / (0.2 * MU * RATE));
        println!("{across}: {along}");
        assert!((along / right - 1.0).abs() < 1e-4 && across_it.abs() < 1e-12, "{along} {across_it}");
        let (all, reaction) = (sum(&on_fluid), sum(&on_solid));
        assert!((all[1] + reaction[1]).abs() < 1e-14 * reaction[1].abs() * 40.0, "{all:?} {reaction:?}");
    }
}

#[test]
fn what_turns_as_one_has_no_drag() {
    let turn = |[x, y]: [f64; 2]| [0.4 - 3.0 * (y - 0.2), -0.1 + 3.0 * x];
    let fluid = beside(turn);
    let mut solid = lattice([0.0, 0.0], [6, 40], DX, 2000.0, turn);
    let mut interface = interface(6, "");
    let size = |on: &[Vec<[f64; 2]>; 2]| {
        on.iter().flatten().flatten().fold(0.0_f64, |most, force| most.max(force.abs()))
    };
    let still = size(&forces(&mut interface, &fluid, &solid));
    // Another body, at rest, does not change how the first one turns.
    for r in solid.iter_mut().filter(|r| r.position[0] > 3.0 * DX) {
        (r.velocity, r.flags) = ([0.0; 3], 1 << 8);
    }
    let two = size(&forces(&mut interface, &fluid, &solid));
    solid.iter_mut().for_each(|r| r.flags = 0);
    let mixed = size(&forces(&mut interface, &fluid, &solid));
    println!("{still:e} {two:e} {mixed:e}");
    // Forces of 0.01 N/m where the solid does not turn along.
    assert!(still < 1e-15 && two < 1e-15 && mixed > 1e-5, "{still:e} {two:e} {mixed:e}");
}

#[test]
fn each_face_of_a_thin_plate_drags_alone() {
    let wide = 2.0 * DX;
    let solid = lattice([0.0, 0.0], [2, 40], DX, 2000.0, |_| [0.0; 2]);
    let mut fluid = beside(|_| [0.0, 0.5]);
    let left = fluid.len();
    fluid.extend(lattice([wide, 0.0], [4, 40], DX, 1000.0, |_| [0.0; 2]));
    let of = |effects: &str| forces(&mut interface(2, effects), &fluid, &solid);
    let [screened, plate] = of("");
    // The water at rest on the right does not feel that on the left, and both act on all rows of the plate.
    assert!(screened[left..].iter().flatten().all(|f| *f == 0.0), "{:?}", sum(&screened[left..]));
    assert!(sum(&plate)[1] > 0.0 && plate[2 * 20][1] > 0.0 && plate[2 * 20 + 1][1] > 0.0);
    let [mixed, _] = of("effects.thin-plate-screen = \"off\"");
    let through = sum(&mixed[left..])[1] / sum(&plate)[1];
    println!("{through}");
    assert!(through.abs() > 0.01, "without the screen it does: {through}");
    // Moved in its plane between waters at rest the plate is dragged by both alike.
    let solid = lattice([0.0, 0.0], [2, 40], DX, 2000.0, |_| [0.0, 0.5]);
    fluid.iter_mut().for_each(|r| r.velocity = [0.0; 3]);
    let mut both = interface(2, "");
    let [on_fluid, plate] = forces(&mut both, &fluid, &solid);
    let sides = [sum(&on_fluid[..left])[1], sum(&on_fluid[left..])[1]];
    assert!(sides[0] > 0.0 && (sides[0] / sides[1] - 1.0).abs() < 1e-12, "{sides:?}");
    assert!((sum(&plate)[1] / (sides[0] + sides[1]) + 1.0).abs() < 1e-12);
    // Where one face is dry, half of it.
    fluid.truncate(left);
    let [_, plate] = forces(&mut both, &fluid, &solid);
    assert!((sum(&plate)[1] / sides[0] + 1.0).abs() < 1e-12, "{} {sides:?}", sum(&plate)[1]);
}

#[test]
fn the_scene_decides() {
    let decide = |effects: &str, overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\n{effects}\n[fluid]\ndensity = 1000.0\nviscosity = 2.0\n\
             sound_speed = 20.0\n[solid]\ndensity = 1000.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n\
             [[shape]]\nname = \"w\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.1, 0.1] }}\n\
             [[shape]]\nname = \"s\"\nphase = \"solid\"\nbox = {{ min = [0.1, 0.0], max = [0.2, 0.1] }}\n"
        );
        let scene = parse(&text, Path::new("s.toml"), &overrides).unwrap();
        let decision = super::interface_viscosity(&scene);
        let parameters = Parameters::<2>::new(&scene, 0, Isa::detect()).unwrap();
        assert_eq!(parameters.viscosity, decision.on.then_some(2.0));
        (decision.on, decision.why)
    };
    let on = (true, "viscosity is on, and fluid sticks to solids".to_owned());
    assert_eq!(decide("", &[]), on);
    let off = (false, "effects.interface-viscosity is \"off\"".to_owned());
    assert_eq!(decide("effects.interface-viscosity = \"off\"", &[]), off);
    let without = "effects.viscosity = \"off\"\neffects.interface-viscosity = \"on\"";
    let why = "viscosity is off: effects.viscosity is \"off\"".to_owned();
    assert_eq!(decide(without, &[]), (false, why));
    let (blind, why) = decide("", &["interface.treatment=phase-blind"]);
    assert!(!blind && why.starts_with("phase-blind"), "{why}");
    let mut silent = interface(6, "effects.interface-viscosity = \"off\"");
    silent.update(&beside(|_| [0.0, 1.0]), &lattice([0.0, 0.0], [6, 40], DX, 2000.0, |_| [0.0; 2]), 1);
    silent.drag_on_fluid(|_, _| panic!("no drag"));
    silent.drag_on_solid(|_, _| panic!("no drag"));
}
