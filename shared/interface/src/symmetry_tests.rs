//! Symmetries of everything that crosses the interface, for each treatment, in two and in three dimensions.

use super::{Interface, Parameters};
use crate::cross_viscosity::CrossViscosity;
use halfstep_scene::geometry::Plate;
use halfstep_scene::{Geometry, Scene, Treatment, parse};
use halfstep_sph::lane::Isa;
use halfstep_wire::protocol::StateRecord;
use proptest::prelude::*;
use std::path::Path;

const DX: f64 = 0.01;
/// Particles of the plate along x, y and, in three dimensions, z.
const CELLS: [usize; 3] = [2, 8, 6];

/// A plate beside water, without gravity; in three dimensions both have a depth.
fn scene<const D: usize>(keys: &str) -> Scene {
    let size = CELLS.map(|n| n as f64 * DX);
    let text = format!(
        "resolution = {DX}\nend_time = 1.0\ngravity = [0.0, 0.0]\n{keys}\n[fluid]\ndensity = 1000.0\nsound_speed = 20.0\n\
         [solid]\nmodel = \"hypoelastic\"\ndensity = 2000.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n\
         [[shape]]\nname = \"plate\"\nphase = \"solid\"\nbox = {{ min = [0.0, 0.0], max = [{}, {}] }}\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.1, 0.0], max = [0.2, 0.1] }}\n",
        size[0], size[1]
    );
    let mut scene = parse(&text, Path::new("s.toml"), &[]).expect("a right scene");
    if D == 3 {
        scene.dimension = 3;
        for shape in &mut scene.shapes {
            let Geometry::Box(block) = &mut shape.geometry else { panic!("a box") };
            block.max[2] = size[2];
        }
    }
    scene
}

/// Of that scene. Scenes of three dimensions are not run yet, so the plate to be screened is named here.
fn parameters<const D: usize>(keys: &str) -> Parameters<D> {
    let scene = scene::<D>(keys);
    let plates = scene.shapes.iter().filter_map(|shape| Plate::of(&scene, shape)).collect();
    let thin_plates = if keys.is_empty() { plates } else { Vec::new() };
    // About as strong as the pressures drawn.
    let viscosity = (scene.interface.treatment == Treatment::MovingWall).then_some(5.0);
    Parameters {
        thin_plates,
        viscosity,
        ..Parameters::new(&scene, 0, Isa::detect()).expect("fluid and solid")
    }
}

/// A particle drawn at random: place, velocity, pressure, density over the reference density.
#[derive(Clone, Copy, Debug)]
struct Drawn {
    place: [f64; 3],
    velocity: [f64; 3],
    pressure: f64,
    compression: f64,
}

fn drawn() -> impl Strategy<Value = Drawn> {
    (prop::array::uniform3(0.0..1.0), prop::array::uniform3(-1.0..1.0), -500.0..2000.0, 0.99..1.01)
        .prop_map(|(place, velocity, pressure, compression)| Drawn { place, velocity, pressure, compression })
}

fn record<const D: usize>(id: usize, position: [f64; D], of: &Drawn, density: f64) -> StateRecord {
    let vector = |v: &[f64]| std::array::from_fn(|d| if d < D { v[d] } else { 0.0 });
    let stress = of.pressure * 0.3;
    StateRecord {
        id: id as u32,
        position: vector(&position),
        velocity: vector(&of.velocity),
        density: density * of.compression,
        pressure: of.pressure,
        mass: density * DX.powi(D as i32),
        // Isotropic in the plane, so that it turns into itself.
        deviatoric_stress: [stress, stress, stress, 0.0, 0.0, 0.0],
        ..StateRecord::default()
    }
}

/// Water in and around the plate, anywhere.
fn water<const D: usize>(drawn: &[Drawn]) -> Vec<StateRecord> {
    let at = |of: &Drawn| std::array::from_fn(|d| (of.place[d] * (CELLS[d] + 6) as f64 - 3.0) * DX);
    drawn.iter().enumerate().map(|(id, of)| record::<D>(id, at(of), of, 1000.0)).collect()
}

/// The plate, each particle moved by up to a fifth of the spacing; `None` for where it is at first.
fn plate<const D: usize>(drawn: Option<&[Drawn]>) -> Vec<StateRecord> {
    let still = Drawn { place: [0.5; 3], velocity: [0.0; 3], pressure: 0.0, compression: 1.0 };
    let particle = |k: usize| {
        let of = drawn.map_or(&still, |drawn| &drawn[k % drawn.len()]);
        let cell = [k % CELLS[0], k / CELLS[0] % CELLS[1], k / CELLS[0] / CELLS[1]];
        let at = |d: usize| (cell[d] as f64 + 0.5 + 0.4 * (of.place[d] - 0.5)) * DX;
        record::<D>(k, std::array::from_fn(at), of, 2000.0)
    };
    (0..CELLS[..D].iter().product()).map(particle).collect()
}

/// What crosses the interface: force on each fluid and each solid record, and both density rates.
#[derive(Clone, Debug, PartialEq)]
struct Crossing<const D: usize> {
    force: Vec<[f64; D]>,
    rate: Vec<f64>,
}

/// Of records that came after those of the first state.
fn crossing<const D: usize>(keys: &str, fluid: &[StateRecord], solid: &[StateRecord]) -> Crossing<D> {
    let mut interface = Interface::<D>::new(parameters(keys));
    interface.update(fluid, &plate::<D>(None), 1);
    assert_eq!(interface.screen.is_some(), keys.is_empty());
    interface.update(fluid, solid, 2);
    let records = fluid.len() + solid.len();
    let mut out = Crossing { force: vec![[0.0; D]; records], rate: vec![0.0; records] };
    let add = |force: &mut [f64; D], a: [f64; D], mass: f64| (0..D).for_each(|d| force[d] += a[d] * mass);
    interface.act_on_fluid(|r, a, rate| {
        add(&mut out.force[r], a, fluid[r].mass);
        out.rate[r] = rate;
    });
    interface.act_on_solid(|r, force| add(&mut out.force[fluid.len() + r], force, 1.0));
    interface.rates_of_solid(|r, rate, _| out.rate[fluid.len() + r] = rate);
    let mut cross = CrossViscosity::default();
    cross.on_fluid(&interface, |r, a| add(&mut out.force[r], a, fluid[r].mass));
    cross.on_solid(&interface, |r, a| add(&mut out.force[fluid.len() + r], a, solid[r].mass));
    interface.drag_on_fluid(|r, a| add(&mut out.force[r], a, fluid[r].mass));
    interface.drag_on_solid(|r, a| add(&mut out.force[fluid.len() + r], a, solid[r].mass));
    out
}

impl<const D: usize> Crossing<D> {
    fn largest(&self) -> [f64; 2] {
        let force = self.force.as_flattened().iter().fold(1e-9_f64, |most, f| most.max(f.abs()));
        // Terms of 1e5 kg/(m³ s) may cancel, where all water leaves.
        [force, self.rate.iter().fold(1.0_f64, |most, r| most.max(r.abs()))]
    }

    /// Whether another is the same with its forces mapped, but for round-off.
    fn is(&self, other: &Self, map: impl Fn([f64; D]) -> [f64; D]) -> bool {
        let [force, rate] = self.largest().map(|most| 1e-9 * most);
        let near = |a: [f64; D], b: [f64; D]| (0..D).all(|d| (a[d] - b[d]).abs() < force);
        self.force.iter().zip(&other.force).all(|(a, b)| near(map(*a), *b))
            && self.rate.iter().zip(&other.rate).all(|(a, b)| (a - b).abs() < rate)
    }
}

/// Records with position and velocity mapped.
fn mapped<const D: usize>(
    records: &[StateRecord],
    position: impl Fn([f64; 3]) -> [f64; 3],
    velocity: impl Fn([f64; 3]) -> [f64; 3],
) -> Vec<StateRecord> {
    let map = |r: &StateRecord| StateRecord {
        position: position(r.position),
        velocity: velocity(r.velocity),
        ..*r
    };
    records.iter().map(map).collect()
}

fn action_is_reaction<const D: usize>(keys: &str, drawn: &[Drawn]) {
    let found = crossing::<D>(keys, &water::<D>(drawn), &plate::<D>(Some(drawn)));
    let scale: f64 = found.force.as_flattened().iter().map(|f| f.abs()).sum();
    for d in 0..D {
        let sum: f64 = found.force.iter().map(|f| f[d]).sum();
        assert!(sum.abs() <= 1e-13 * scale, "{sum} of {scale}");
    }
}

fn a_quarter_turn_turns_the_forces<const D: usize>(keys: &str, drawn: &[Drawn]) {
    let (fluid, solid) = (water::<D>(drawn), plate::<D>(Some(drawn)));
    let plain = crossing::<D>(keys, &fluid, &solid);
    // About z, and in space about x, too.
    for axis in 1..D {
        fn turn<const N: usize>(axis: usize, v: [f64; N]) -> [f64; N] {
            let mut turned = v;
            (turned[axis - 1], turned[axis]) = (-v[axis], v[axis - 1]);
            turned
        }
        let all = |records| mapped::<D>(records, |x| turn(axis, x), |v| turn(axis, v));
        assert!(plain.is(&crossing(keys, &all(&fluid), &all(&solid)), |f| turn(axis, f)));
    }
}

fn place_and_speed_of_the_frame_do_not_matter<const D: usize>(keys: &str, drawn: &[Drawn]) {
    let (fluid, solid) = (water::<D>(drawn), plate::<D>(Some(drawn)));
    let shift = |v: [f64; 3], by: [f64; 3]| std::array::from_fn(|d| if d < D { v[d] + by[d] } else { v[d] });
    let all =
        |records| mapped::<D>(records, |x| shift(x, [0.25, -0.5, 0.125]), |v| shift(v, [0.25, 0.5, -0.75]));
    assert!(crossing::<D>(keys, &fluid, &solid).is(&crossing(keys, &all(&fluid), &all(&solid)), |f| f));
}

fn the_order_of_the_fluids_records_does_not_matter<const D: usize>(keys: &str, drawn: &[Drawn]) {
    let (mut fluid, solid) = (water::<D>(drawn), plate::<D>(Some(drawn)));
    let plain = crossing::<D>(keys, &fluid, &solid);
    fluid.reverse();
    let mut reversed = crossing::<D>(keys, &fluid, &solid);
    reversed.force[..fluid.len()].reverse();
    reversed.rate[..fluid.len()].reverse();
    // Not even for the bits: sums follow the sorted order.
    assert_eq!(plain, reversed);
}

macro_rules! suite {
    ($($treatment:ident $dimension:literal $keys:literal;)*) => {
        $(mod $treatment {
            use super::*;

            suite!($dimension $keys action_is_reaction a_quarter_turn_turns_the_forces
                place_and_speed_of_the_frame_do_not_matter the_order_of_the_fluids_records_does_not_matter);
        })*
    };
    ($dimension:literal $keys:literal $($symmetry:ident)*) => {
        proptest! {
            $(
                #[test]
                fn $symmetry(drawn in prop::collection::vec(drawn(), 1..80)) {
                    super::$symmetry::<$dimension>($keys, &drawn);
                }
            )*
        }
    };
}

suite! {
    faces_in_the_plane 2 "";
    faces_in_space 3 "";
    moving_wall_in_the_plane 2 "effects.thin-plate-screen = \"off\"";
    moving_wall_in_space 3 "effects.thin-plate-screen = \"off\"";
    phase_blind_in_the_plane 2 "interface.treatment = \"phase-blind\"";
    phase_blind_in_space 3 "interface.treatment = \"phase-blind\"";
}
