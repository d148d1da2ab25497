//! Position Verlet's shares at predicted velocities, beside values by hand.

use crate::Fluid;
use halfstep_role::role::Role;
use halfstep_scene as scene;
use halfstep_sph::kernel::{CubicSpline, Kernel};
use halfstep_sph::lane::{Isa, LANES, Lane, Lanes, Unfused};
use halfstep_sph::neighbours::PADDING;
use halfstep_wire::half_step::{HalfStep, Stage};
use std::path::Path;

const DX: f64 = 0.01;
const H: f64 = 1.5 * DX;
const C0: f64 = 20.0;
const CFL: f64 = 0.6;

/// One particle 0.2 dx above the floor's surface, with a velocity.
fn drop(velocity: f64, guard: &str) -> Fluid<2> {
    let text = format!(
        "resolution = {DX}\nsmoothing_ratio = 1.5\nend_time = 1.0\ngravity = [0.0, -9.81]\n\
         [fluid]\ndensity = 1000.0\nsound_speed = {C0}\ntime_integration = \"verlet\"\n\
         [numerics]\nkernel = \"cubic-spline\"\ncfl = {CFL}\n\
         [effects]\nwall-guard = \"{guard}\"\nartificial-viscosity = \"off\"\n\
         [[shape]]\nname = \"drop\"\nphase = \"fluid\"\nvelocity = [0.0, {velocity}]\n\
         box = {{ min = [0.1, -0.003], max = [0.11, 0.007] }}\n\
         [[shape]]\nname = \"floor\"\nphase = \"wall\"\nbox = {{ min = [0.0, -0.04], max = [0.21, 0.0] }}\n"
    );
    let scene = scene::parse(&text, Path::new("drop.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    Fluid::new(&scene, Isa::detect()).expect("a scene with fluid")
}

/// Up to the sums at n + 1/2: slot of the particle.
fn go_half(fluid: &mut Fluid<2>, dt: f64) -> usize {
    let [first, _] = HalfStep::begin(0, 0.0).lasting(dt).both();
    let mut record = Vec::new();
    fluid.publish(&[], &mut record);
    fluid.own_sums();
    fluid.cross_sums(&record, &[]).expect("no solid");
    fluid.advance(&first, &[]).expect("within bounds");
    fluid.publish(&[], &mut record);
    fluid.own_sums();
    fluid.cross_sums(&record, &[]).expect("no solid");
    assert_eq!(fluid.stage, Stage::Second);
    (0..fluid.columns.slots()).find(|&slot| fluid.columns.id[slot] != PADDING).expect("a particle")
}

fn acceleration(fluid: &Fluid<2>, slot: usize) -> f64 {
    fluid.sums[slot / LANES].acceleration[1].0[slot % LANES]
}

/// A particle alone sees its own velocity mirrored: with what else accelerates it, a, the guard of a wall particle acts
/// on 2 v_n + dt a, and takes x / (1 + x') of that along the pair, x = k dt at the distance, x' with the slope F of
/// 0.15 dx.
#[test]
fn the_guard_opposes_what_all_else_leads_to() {
    let kernel = CubicSpline::<2>::new(H);
    let slope = |r: f64| -kernel.gradient_over_r::<Unfused, Lane>(Lane::splat(r)).0[0];
    let dt = CFL * H / C0;
    // At rest; towards the floor; away from it, but pressed back before the step ends.
    for velocity in [0.0, -0.3, 1e-4] {
        let mut free = drop(velocity, "off");
        let slot = go_half(&mut free, dt);
        let others = -9.81 + acceleration(&free, slot);
        let mut guarded = drop(velocity, "on");
        let slot = go_half(&mut guarded, dt);
        let found = acceleration(&guarded, slot) - acceleration(&free, slot);

        let predicted = 2.0 * velocity + dt * others;
        let at = guarded.position(slot);
        let walls = guarded.walls.as_ref().expect("a floor");
        let mut expected = 0.0;
        for w in (0..walls.slots()).filter(|&w| walls.id[w] != PADDING && !walls.reverses_all(w)) {
            let dx: [f64; 2] = std::array::from_fn(|d| at[d] - walls.shown.position[d][w]);
            let r2 = dx[0].powi(2) + dx[1].powi(2);
            let near = ((0.8 * DX - r2.sqrt()) / (0.2 * DX)).clamp(0.0, 1.0);
            let common = 32.0 * C0 * H * DX * DX * near * r2 / (r2 + 0.01 * H * H);
            let density = 0.5 * (guarded.columns.now.sources[slot].density + walls.shown.sources[w].density);
            let k = common * slope(r2.sqrt()) * 1000.0 / density;
            let divisor = 1.0 + dt * common * slope(0.15 * DX);
            if predicted * dx[1] < 0.0 {
                expected -= k / divisor * predicted * dx[1] * dx[1] / r2;
            }
        }
        assert!(expected > 1.0, "{velocity}: it acts");
        assert!((found - expected).abs() < 1e-9 * expected.abs(), "{velocity}: {found} {expected}");
    }
}
