//! Particle shifting beside values by hand.

use crate::Fluid;
use crate::effects::Effects;
use crate::effects::particle_shifting::STRENGTH;
use crate::shifting_sums::STRAINED;
use halfstep_role::role::Role;
use halfstep_scene as scene;
use halfstep_sph::kernel::{Kernel, WendlandC2};
use halfstep_sph::lane::{Isa, Lane, Lanes, Unfused};
use halfstep_sph::neighbours::PADDING;
use halfstep_wire::half_step::{HalfStep, Stage};
use std::path::Path;

const DX: f64 = 0.01;
const H: f64 = 2.0 * DX;

const SOUND_SPEED: f64 = 20.0;

/// So fast that the flow's strain does not limit a drift, m/s.
const STIRRED: f64 = 3.0;

/// Water of 24 x 24 particles without walls, of which every second one moves along x, m/s; the one of a number is
/// displaced, m.
fn water(displaced: u32, by: [f64; 2], speed: f64) -> Fluid<2> {
    water_by("verlet", displaced, by, speed)
}

/// The same by a rule of time integration.
fn water_by(rule: &str, displaced: u32, by: [f64; 2], speed: f64) -> Fluid<2> {
    let rule = [format!("fluid.time_integration={rule}")];
    let text = "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, 0.0]\n[fluid]\ndensity = 1000.0\n\
        sound_speed = 20.0\n[effects]\nparticle-shifting = \"on\"\n\
        [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.24, 0.24] }\n";
    let scene = scene::parse(text, Path::new("water.toml"), &rule).unwrap_or_else(|e| panic!("{e:?}"));
    let mut fluid = Fluid::<2>::new(&scene, Isa::detect()).expect("a scene with fluid");
    for slot in (0..fluid.columns.slots()).filter(|&s| fluid.columns.id[s] == displaced) {
        for d in 0..2 {
            fluid.columns.now.position[d][slot] += by[d];
            fluid.columns.now.sources[slot].position[d] += by[d];
        }
    }
    for slot in
        (0..fluid.columns.slots()).filter(|&s| fluid.columns.id[s] % 2 == 1 && fluid.columns.id[s] != PADDING)
    {
        fluid.columns.now.sources[slot].velocity[0] = speed;
    }
    fluid
}

/// Number, place and drift of each particle.
type Drifts = Vec<(u32, [f64; 2], [f64; 2])>;

fn drifts(fluid: &mut Fluid<2>) -> Drifts {
    fluid.stage = Stage::Second;
    fluid.own_sums();
    let drift = fluid.effects.drift().expect("the effect takes part");
    let real = (0..fluid.columns.slots()).filter(|&s| fluid.columns.id[s] != PADDING);
    let at = |s: usize| std::array::from_fn(|d| fluid.columns.now.position[d][s]);
    real.map(|s| (fluid.columns.id[s], at(s), drift[s])).collect()
}

/// The number of the particle at (0.115, 0.115) m.
fn middle() -> u32 {
    let all = drifts(&mut water(u32::MAX, [0.0; 2], STIRRED));
    let near = |x: &[f64; 2]| (x[0] - 0.115).abs() + (x[1] - 0.115).abs() < 1e-9;
    all.iter().find(|(_, x, _)| near(x)).expect("a particle").0
}

/// Inside by symmetry; along an edge the sum points out of the water, and what is along the edge is zero.
#[test]
fn a_lattice_stays_where_it_is() {
    let all = drifts(&mut water(u32::MAX, [0.0; 2], STIRRED));
    // Away from corners, whose neighbours are no mirror images.
    let beside = |x: &[f64; 2]| x.iter().any(|x| (x - 0.12).abs() < 0.03);
    let counted = all.iter().filter(|(_, x, _)| beside(x)).count();
    assert_eq!(counted, 24 * 24 - 18 * 18);
    for (id, x, drift) in all.iter().filter(|(_, x, _)| beside(x)) {
        assert!(drift.iter().all(|d| d.abs() < 1e-12), "{id} at {x:?}: {drift:?}");
    }
}

#[test]
fn a_displaced_particle_is_driven_back() {
    let id = middle();
    let all = drifts(&mut water(id, [0.05 * DX, 0.0], STIRRED));
    let (_, at, drift) = all.iter().find(|(own, ..)| *own == id).expect("the same");
    // -sigma h c0 sum V [1 + R (W / W(dx))^4] grad W over all, with V = dx².
    let kernel = WendlandC2::<2>::new(H);
    let mut exact = [0.0; 2];
    for (_, x, _) in all.iter().filter(|(other, ..)| *other != id) {
        let apart = [at[0] - x[0], at[1] - x[1]];
        let r = apart[0].hypot(apart[1]);
        let slope = kernel.gradient_over_r::<Unfused, Lane>(Lane::splat(r)).0[0];
        let pairing = 1.0 + 0.2 * (kernel.at(r) / kernel.at(DX)).powi(4);
        (0..2).for_each(|d| exact[d] -= STRENGTH * H * SOUND_SPEED * DX * DX * pairing * slope * apart[d]);
    }
    assert!(
        -STRAINED * STIRRED < exact[0] && exact[0] < -1e-3,
        "back, and not as fast as allowed: {exact:?}"
    );
    assert!((drift[0] - exact[0]).abs() < 1e-9 * exact[0].abs(), "{drift:?} {exact:?}");
    assert!(drift[1].abs() < 1e-12, "{drift:?}");
}

#[test]
fn the_flows_strain_limits_the_drift_and_water_at_rest_has_none() {
    let id = middle();
    for speed in [0.0, 1e-3] {
        let all = drifts(&mut water(id, [0.05 * DX, 0.0], speed));
        let (_, _, drift) = all.iter().find(|(own, ..)| *own == id).expect("the same");
        let exact = STRAINED * speed;
        assert!((drift[0].hypot(drift[1]) - exact).abs() < 1e-15, "{drift:?} {exact}");
    }
}

/// Beside the velocity of n + 1/2, by position Verlet the mean of n and n + 1.
#[test]
fn a_step_moves_by_the_drift() {
    for rule in ["midpoint", "verlet"] {
        moves_by_the_drift(rule);
    }
}

fn moves_by_the_drift(rule: &str) {
    const DT: f64 = 1e-4;
    let mut fluid = water_by(rule, middle(), [0.3 * DX, 0.1 * DX], STIRRED);
    let [first, second] = HalfStep::begin(0, 0.0).lasting(DT).both();
    fluid.own_sums();
    fluid.advance(&first, &[]).expect("within bounds");
    let drift = drifts(&mut fluid);
    let real: Vec<usize> = (0..fluid.columns.slots()).filter(|&s| fluid.columns.id[s] != PADDING).collect();
    let middle = fluid.columns.now.sources.clone();
    let at_n = fluid.columns.position_n.clone();
    fluid.advance(&second, &[]).expect("within bounds");
    let mut largest = 0.0_f64;
    for (&slot, (_, _, drift)) in real.iter().zip(&drift) {
        for d in 0..2 {
            let velocity = match rule {
                "midpoint" => middle[slot].velocity[d],
                // Shown at n + 1/2 is the velocity of n.
                _ => 0.5 * (middle[slot].velocity[d] + fluid.columns.now.sources[slot].velocity[d]),
            };
            let exact = at_n[d][slot] + DT * (velocity + drift[d]);
            assert!((fluid.columns.now.position[d][slot] - exact).abs() < 1e-15, "{rule}");
            largest = largest.max(drift[d].abs());
        }
    }
    assert!(largest > 1e-2, "{rule}: {largest}");
}
