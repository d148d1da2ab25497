//! Particles at one place: scenes cannot make them, and where a flow brings two together every force stays finite.

use halfstep_fluid::composition::Shares;
use halfstep_fluid::effects::artificial_viscosity::ArtificialViscosity;
use halfstep_fluid::effects::density_diffusion::{Diffusion, Simple, Strength};
use halfstep_fluid::rates::RateSum;
use halfstep_interface::cross_viscosity::CrossViscosity;
use halfstep_interface::{Interface, Parameters};
use halfstep_scene::geometry;
use halfstep_scene::{self as scene, ArtificialViscosity as Coefficients, Scene};
use halfstep_sph::lane::{Isa, LANES};
use halfstep_sph::neighbours::PADDING;
use halfstep_tests::patch::{Particle, Patch, RatePass, SMOOTHING_LENGTH as H};
use halfstep_wire::protocol::StateRecord;
use std::path::Path;

/// Acceleration and density rate of each particle, with artificial viscosity and density diffusion.
fn rates(particles: &[Particle]) -> Vec<[f64; 3]> {
    let patch = Patch::new(particles, 2.3 * H, Isa::detect());
    let mut sums = vec![RateSum::default(); patch.list.fours()];
    let coefficients = Coefficients { linear: 1.0, quadratic: 2.0 };
    let damping = ArtificialViscosity::<2>::new(coefficients, 10.0, H);
    let diffusion = Diffusion::<2>::Simple(Simple(Strength(1.0)));
    (Some(damping), (Some(diffusion), ())).run(RatePass(&patch, &mut sums));
    let mut rates = vec![[0.0; 3]; particles.len()];
    for (slot, &id) in patch.id.iter().enumerate().filter(|(_, id)| **id != PADDING) {
        let (sum, k) = (&sums[slot / LANES], slot % LANES);
        rates[id as usize] = [sum.acceleration[0].0[k], sum.acceleration[1].0[k], sum.density_rate.0[k]];
    }
    rates
}

fn particle(position: [f64; 2], velocity: [f64; 2]) -> Particle {
    Particle { position, velocity, density: 1.0, pressure: 5.0 }
}

#[test]
fn two_fluid_particles_at_one_place_have_finite_forces() {
    for apart in [0.0, 1e-300, 1e-12, 1e-6] {
        let pair = [particle([3.0, 3.0], [1.0, 0.0]), particle([3.0 + apart, 3.0], [-1.0, 0.0])];
        let alone = rates(&pair);
        assert!(alone.as_flattened().iter().all(|r| r.is_finite() && r.abs() < 1e3), "{apart}: {alone:?}");
        let third = particle([4.0, 3.0], [0.0, 0.0]);
        let with = rates(&[pair[0], pair[1], third]);
        assert!(with.as_flattened().iter().all(|r| r.is_finite() && r.abs() < 1e3), "{apart}: {with:?}");
        // The third one sees two neighbours on its left and is pushed to the right.
        assert!(with[2][0] > 0.0, "{with:?}");
    }
    let same = [particle([3.0, 3.0], [1.0, 0.0]), particle([3.0, 3.0], [-1.0, 0.0])];
    assert!(rates(&same).iter().all(|[x, y, _]| *x == 0.0 && *y == 0.0), "without direction no force");
}

fn parse(text: &str) -> Scene {
    scene::parse(text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

fn coupled(treatment: &str) -> Scene {
    parse(&format!(
        "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[solid]\nmodel = \"hypoelastic\"\ndensity = 2000.0\n\
         youngs_modulus = 1e6\npoissons_ratio = 0.3\n[interface]\ntreatment = \"{treatment}\"\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [1.0, 1.0] }}\n\
         [[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = {{ min = [1.0, 0.0], max = [2.0, 1.0] }}\n"
    ))
}

#[test]
fn a_fluid_particle_on_a_solid_one_has_finite_forces() {
    for treatment in ["moving-wall", "phase-blind"] {
        let scene = coupled(treatment);
        let mut interface = Interface::<2>::new(Parameters::new(&scene, 0, Isa::detect()).unwrap());
        let record = |density: f64, mass: f64, velocity: f64| StateRecord {
            position: [0.5, 0.5, 0.0],
            velocity: [velocity, 0.0, 0.0],
            density,
            pressure: 1e4,
            mass,
            ..StateRecord::default()
        };
        interface.update(&[record(1010.0, 10.0, 3.0)], &[record(2000.0, 20.0, -3.0)], 0);
        let mut numbers = Vec::new();
        interface.act_on_solid(|_, force| numbers.extend(force));
        interface.act_on_fluid(|_, a, rate| {
            numbers.extend(a);
            numbers.push(rate);
        });
        let mut cross = CrossViscosity::default();
        cross.on_solid(&interface, |_, a| numbers.extend(a));
        cross.on_fluid(&interface, |_, a| numbers.extend(a));
        assert!(numbers.len() >= 9 && numbers.iter().all(|n| n.is_finite()), "{treatment}: {numbers:?}");
    }
}

#[test]
fn shapes_that_overlap_leave_no_two_particles_closer_than_half_the_spacing() {
    let shape = |name: &str, x: f64| {
        format!(
            "[[shape]]\nname = \"{name}\"\nphase = \"fluid\"\n\
             box = {{ min = [{x}, 0.0], max = [{}, 1.0] }}\n",
            x + 1.0
        )
    };
    let head = "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n";
    for (offset, expected) in [(0.0, 100), (0.53, 150), (0.57, 160)] {
        let scene = parse(&format!("{head}{}{}", shape("a", 0.0), shape("b", offset)));
        let points = geometry::layout::<2>(&scene).fluid;
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let nearest = points
            .iter()
            .enumerate()
            .flat_map(|(k, a)| points[..k].iter().map(move |b| distance(a.position, b.position)));
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!(nearest > 0.05 - 1e-12, "{offset}: {nearest}");
        assert_eq!(points.len(), expected, "{offset}");
    }
}
