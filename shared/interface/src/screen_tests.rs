//! The faces of thin plates, by hand: which side fluid is on, what each side shows, and that action equals reaction.

use super::{Interface, Parameters};
use halfstep_scene::{Scene, parse};
use halfstep_sph::lane::Isa;
use halfstep_wire::protocol::StateRecord;
use std::path::Path;

const DX: f64 = 0.01;
/// Rows of the plate, from y = 0 to 0.3, the left face at x = 0.
const ROWS: usize = 2;
const LENGTH: usize = 30;

fn text(effects: &str) -> String {
    format!(
        "resolution = {DX}\nsmoothing_ratio = 1.33\nend_time = 1.0\ngravity = [0.0, 0.0]\n\
         numerics.kernel = \"cubic-spline\"\n{effects}\n[fluid]\ndensity = 1000.0\n\
         sound_speed = 20.0\n[solid]\nmodel = \"hypoelastic\"\ndensity = 2000.0\nyoungs_modulus = 1e6\n\
         poissons_ratio = 0.3\n[[shape]]\nname = \"plate\"\nphase = \"solid\"\n\
         box = {{ min = [0.0, 0.0], max = [{}, 0.3] }}\n[[shape]]\nname = \"water\"\nphase = \"fluid\"\n\
         box = {{ min = [0.1, 0.0], max = [0.2, 0.1] }}\n",
        DX * ROWS as f64
    )
}

fn scene(effects: &str) -> Scene {
    parse(&text(effects), Path::new("s.toml"), &[]).unwrap()
}

fn interface(effects: &str) -> Interface<2> {
    Interface::new(Parameters::new(&scene(effects), 0, Isa::detect()).unwrap())
}

fn plate() -> Vec<StateRecord> {
    let at = |k: usize| [(k % ROWS) as f64 + 0.5, (k / ROWS) as f64 + 0.5].map(|x| x * DX);
    (0..ROWS * LENGTH).map(|k| record(k, at(k), 0.0, 2000.0)).collect()
}

fn record(id: usize, [x, y]: [f64; 2], pressure: f64, density: f64) -> StateRecord {
    let mass = density * DX * DX;
    StateRecord { id: id as u32, position: [x, y, 0.0], pressure, density, mass, ..StateRecord::default() }
}

/// Water four rows deep on both faces: 1000 Pa on the left, 300 Pa on the right.
fn water() -> Vec<StateRecord> {
    let mut water = Vec::new();
    for row in 0..LENGTH {
        for column in 0..4 {
            let (x, y) = ((column as f64 + 0.5) * DX, (row as f64 + 0.5) * DX);
            water.push(record(water.len(), [-x, y], 1000.0, 1000.0));
            water.push(record(water.len(), [DX * ROWS as f64 + x, y], 300.0, 1000.0));
        }
    }
    water
}

/// What each side of a record's plate shows, Pa: against its normal, along it.
fn shown(interface: &Interface<2>, record: usize) -> [f64; 2] {
    let (slot, _) = interface.solid.slots().find(|&(_, r)| r == record).unwrap();
    let screen = interface.screen.as_ref().unwrap();
    [0, 1].map(|k| {
        let face = &screen.faces[k];
        // p / rho² and m / rho.
        face.pressure_term[slot] * (interface.solid.mass[slot] / face.volume[slot]).powi(2)
    })
}

/// Unit normal of a record's plate.
fn normal(interface: &Interface<2>, record: usize) -> [f64; 2] {
    let (slot, _) = interface.solid.slots().find(|&(_, r)| r == record).unwrap();
    let screen = interface.screen.as_ref().unwrap();
    [screen.normal[0][slot], screen.normal[1][slot]]
}

#[test]
fn each_face_has_the_pressure_of_the_water_before_it() {
    let (mut screened, mut mixed) = (interface(""), interface("effects.thin-plate-screen = \"off\""));
    screened.update(&water(), &plate(), 1);
    mixed.update(&water(), &plate(), 1);
    assert!(mixed.screen.is_none());
    for record in 0..ROWS * LENGTH {
        let [left, right] = shown(&screened, record);
        assert!((left - 1000.0).abs() < 1e-9 && (right - 300.0).abs() < 1e-9, "{record}: {left} {right}");
    }
    // Of a particle in the middle of the left row, by the kernel's values: the columns of water 1 and 2 dx to the left,
    // 2 dx to the right.
    let of = |column: f64| -> f64 {
        let q = |row: i32| column.hypot(f64::from(row)) / 1.33;
        let w = |q: f64| match q {
            q if q < 1.0 => 1.0 - 1.5 * q * q + 0.75 * q.powi(3),
            q if q < 2.0 => 0.25 * (2.0 - q).powi(3),
            _ => 0.0,
        };
        (-3..4).map(|row| w(q(row))).sum()
    };
    let (near, far) = (of(1.0) + of(2.0), of(2.0));
    let (slot, _) = mixed.solid.slots().find(|&(_, r)| r == LENGTH).unwrap();
    let mean = (near * 1000.0 + far * 300.0) / (near + far);
    assert!(mean < 970.0, "the far side counts: {mean}");
    assert!((mixed.solid.pressure[slot] - mean).abs() < 1e-6, "{} {mean}", mixed.solid.pressure[slot]);
}

#[test]
fn a_dry_face_has_no_pressure_and_no_face_a_negative_one() {
    let left: Vec<StateRecord> = water().into_iter().filter(|r| r.position[0] < 0.0).collect();
    let mut screened = interface("");
    screened.update(&left, &plate(), 1);
    assert_eq!(shown(&screened, LENGTH)[1], 0.0);
    let pulls: Vec<StateRecord> = left.iter().map(|r| StateRecord { pressure: -50.0, ..*r }).collect();
    screened.update(&pulls, &plate(), 1);
    assert_eq!(shown(&screened, LENGTH), [0.0, 0.0]);
    let mut pulling = interface("effects.non-negative-wall-pressure = \"off\"");
    pulling.update(&pulls, &plate(), 1);
    let [left, right] = shown(&pulling, LENGTH);
    assert!((left + 50.0).abs() < 1e-9 && right == 0.0, "{left} {right}");
}

#[test]
fn the_normal_goes_with_the_material() {
    let mut screened = interface("");
    screened.update(&water(), &plate(), 1);
    for record in 0..ROWS * LENGTH {
        let [x, y] = normal(&screened, record);
        assert!((x - 1.0).abs() < 1e-15 && y.abs() < 1e-15, "{record}: {x} {y}");
    }
    // Turned by 150 degrees, elsewhere and stretched along itself by 10 %.
    let (sin, cos) = 150_f64.to_radians().sin_cos();
    let turned: Vec<StateRecord> = plate()
        .into_iter()
        .map(|mut r| {
            let [x, y] = [r.position[0], 1.1 * r.position[1]];
            r.position = [3.0 + cos * x - sin * y, sin * x + cos * y, 0.0];
            r
        })
        .collect();
    screened.update(&water(), &turned, 1);
    for record in 0..ROWS * LENGTH {
        let [x, y] = normal(&screened, record);
        assert!((x - cos).abs() < 1e-12 && (y - sin).abs() < 1e-12, "{record}: {x} {y}");
    }
    // Bent to an arc of radius 0.2 m about (0.21, 0): the normal points to the centre, at the ends, too.
    let bent: Vec<StateRecord> = plate()
        .into_iter()
        .map(|mut r| {
            let (sin, cos) = (r.position[1] / 0.2).sin_cos();
            let radius = 0.21 - r.position[0];
            r.position = [0.21 - radius * cos, radius * sin, 0.0];
            r
        })
        .collect();
    screened.update(&water(), &bent, 1);
    for (record, r) in bent.iter().enumerate() {
        let inward = [0.21 - r.position[0], -r.position[1]];
        let [x, y] = normal(&screened, record);
        let sine = (x * inward[1] - y * inward[0]) / inward[0].hypot(inward[1]);
        // One-sided at the ends: off by the angle to the middle of the neighbours, at most h / 0.2 m.
        assert!(sine.abs() < 0.07 && x * inward[0] + y * inward[1] > 0.0, "{record}: {sine}");
        if (3 * ROWS..(LENGTH - 3) * ROWS).contains(&record) {
            assert!(sine.abs() < 1e-3, "{record}: {sine}");
        }
    }
}

/// The plate of a solid that breaks.
fn brittle() -> Interface<2> {
    let keys = "model = \"total-lagrangian\"\nfracture = { strength = 1e5, energy = 20.0 }\n";
    let text = text("").replace("model = \"hypoelastic\"\n", keys).replace("1e6", "1e8");
    let scene = parse(&text, Path::new("s.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    Interface::new(Parameters::new(&scene, 0, Isa::detect()).unwrap())
}

/// The plate after its upper half has gone sideways without turning, m.
fn severed(slide: f64) -> Vec<StateRecord> {
    let mut plate = plate();
    plate[ROWS * LENGTH / 2..].iter_mut().for_each(|r| r.position[0] += slide);
    plate
}

#[test]
fn a_broken_plates_pieces_have_normals_of_their_own() {
    let slant = |interface: &mut Interface<2>, plate: &[StateRecord]| {
        interface.update(&water(), plate, 1);
        let slants = (0..ROWS * LENGTH).map(|record| {
            let [x, y] = normal(interface, record);
            y.atan2(x).abs().to_degrees()
        });
        slants.fold(0.0, f64::max)
    };
    // A plate that holds is bent as its particles lie, also one that cannot break where it lies far apart.
    for breaks in [false, true] {
        let mut held = if breaks { brittle() } else { interface("") };
        assert!(slant(&mut held, &plate()) < 1e-12);
        assert!(slant(&mut held, &severed(0.7 * DX)) > 5.0);
        assert_eq!(slant(&mut held, &severed(5.0 * DX)) > 40.0, !breaks);
    }
    for slide in [0.8, 1.0, 2.0, 3.0, 5.0, 14.0] {
        let mut screened = brittle();
        assert!(slant(&mut screened, &plate()) < 1e-12);
        let found = slant(&mut screened, &severed(slide * DX));
        assert!(found < 1e-12, "{slide} spacings: {found} degrees");
    }
}

#[test]
fn crumbs_of_a_plate_hold_nothing() {
    let mut screened = brittle();
    screened.update(&water(), &plate(), 1);
    // The three upper rows have come off: two as a piece that has turned by 90 degrees, the third as a row.
    let mut broken = plate();
    let (piece, row) = (ROWS * (LENGTH - 3), ROWS * (LENGTH - 1));
    for r in &mut broken[piece..row] {
        let [x, y] = [r.position[0], r.position[1]];
        r.position = [0.5 - y, 0.05 + x, 0.0];
    }
    broken[row..].iter_mut().for_each(|r| r.position[1] += 0.1);
    // A single particle of the left row.
    broken[ROWS * 4].position[0] -= 0.03;
    screened.update(&water(), &broken, 1);
    for record in 0..ROWS * LENGTH {
        let [x, y] = normal(&screened, record);
        let expected = match record {
            r if r == ROWS * 4 || r >= row => [0.0, 0.0],
            r if r >= piece => [0.0, 1.0],
            _ => [1.0, 0.0],
        };
        let off = (x - expected[0]).hypot(y - expected[1]);
        assert!(off < 1e-12, "{record}: {x} {y}");
    }
    // It shows one state, a mean of what is on both sides.
    let [against, along] = shown(&screened, ROWS * 4);
    assert!((against - along).abs() < 1e-9 && against > 300.0 && against < 1000.0, "{against} {along}");
}

/// Acceleration of each fluid record by the plate.
fn on_fluid(interface: &mut Interface<2>, fluid: &[StateRecord]) -> Vec<[f64; 2]> {
    let mut out = vec![[0.0; 2]; fluid.len()];
    interface.act_on_fluid(|record, a, _| out[record] = a);
    out
}

#[test]
fn pressure_goes_over_from_face_to_face_around_the_plates_end() {
    let mut fluid = water();
    let last = fluid.len();
    let (end, middle) = (LENGTH as f64 * DX, 0.5 * DX * ROWS as f64);
    fluid.push(record(last, [0.0, end + DX], 650.0, 1000.0));
    let at = |offset: f64, fluid: &mut Vec<StateRecord>| {
        fluid[last].position[0] = middle + offset;
        let mut screened = interface("");
        screened.update(fluid, &plate(), 1);
        on_fluid(&mut screened, fluid)[last]
    };
    let steps: Vec<[f64; 2]> = (-400..=400).map(|k| at(f64::from(k) * DX / 200.0, &mut fluid)).collect();
    let largest = steps.iter().map(|a| a[1].abs()).fold(0.0, f64::max);
    let jumps = steps.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]));
    // The kernel's own slope is some h: 1 / (200 x 1.33) a step. A switch would jump by the faces' difference.
    let jump = jumps.fold(0.0, f64::max);
    assert!(jump < 0.02 * largest, "{jump} of {largest}");
    assert!(largest > 0.0);
}

#[test]
fn action_is_reaction_on_faces_and_around_the_end() {
    let mut fluid = water();
    for k in 0..40 {
        // Scattered over the end by a fixed rule.
        let (a, b) = ((f64::from(k) * 0.618).fract(), (f64::from(k) * 0.377).fract());
        let at = [(4.0 * a - 1.0) * DX, (30.6 + 2.0 * b) * DX];
        fluid.push(record(fluid.len(), at, 900.0 * a + 100.0 * b, 1000.0 + a));
    }
    let mut screened = interface("");
    screened.update(&fluid, &plate(), 1);
    let (mut sum, mut scale) = ([0.0; 2], 0.0);
    let mut add = |force: [f64; 2]| {
        for d in 0..2 {
            sum[d] += force[d];
            scale += force[d].abs();
        }
    };
    for (a, r) in on_fluid(&mut screened, &fluid).into_iter().zip(&fluid) {
        add(a.map(|a| a * r.mass));
    }
    screened.act_on_solid(|_, force| add(force));
    assert!(scale > 1.0 && sum.iter().all(|s| s.abs() <= 1e-14 * scale), "{sum:?} of {scale}");
}

#[test]
fn particles_outside_thin_plates_have_one_pressure() {
    // A block 10 dx away from the plate, with the plate's water around it.
    let mut solid = plate();
    for k in 0..25 {
        let at = [0.205 + (k % 5) as f64 * DX, 0.105 + (k / 5) as f64 * DX];
        solid.push(record(solid.len(), at, 0.0, 2000.0));
    }
    let mut fluid = water();
    fluid.push(record(fluid.len(), [0.195, 0.125], 500.0, 1000.0));
    fluid.push(record(fluid.len(), [0.265, 0.125], 100.0, 1000.0));
    let (mut screened, mut plain) = (interface(""), interface("effects.thin-plate-screen = \"off\""));
    screened.update(&fluid, &solid, 1);
    plain.update(&fluid, &solid, 1);
    let both = [on_fluid(&mut screened, &fluid), on_fluid(&mut plain, &fluid)];
    for k in fluid.len() - 2..fluid.len() {
        for d in 0..2 {
            let (a, b) = (both[0][k][d], both[1][k][d]);
            assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{a} {b}");
        }
    }
    assert_eq!(normal(&screened, solid.len() - 1), [0.0, 0.0]);
}
