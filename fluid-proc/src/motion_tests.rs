//! Water in tanks that turn.

use crate::Fluid;
use halfstep_role::role::Role;
use halfstep_scene as scene;
use halfstep_sph::lane::Isa;
use halfstep_sph::neighbours::PADDING;
use halfstep_wire::half_step::{HalfStep, Stage};
use std::path::Path;

fn fluid(text: &str) -> Fluid<2> {
    let scene = scene::parse(text, Path::new("turning.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    Fluid::<2>::new(&scene, Isa::detect()).unwrap()
}

/// Goes on to a time; calls `see` after each step with sums of the state there.
pub(crate) fn run(fluid: &mut Fluid<2>, until: f64, mut see: impl FnMut(&Fluid<2>, f64)) {
    let (mut t, mut step, mut record) = (0.0, 0, Vec::new());
    while t < until {
        fluid.set_time(t);
        fluid.publish(&[], &mut record);
        let dt = fluid.dt_limit().min(until - t);
        for half_step in HalfStep::begin(step, t).lasting(dt).both() {
            if half_step.stage == Stage::Second {
                fluid.set_time(half_step.before());
                fluid.publish(&[], &mut record);
            }
            fluid.own_sums();
            if half_step.stage == Stage::First {
                see(fluid, t);
            }
            fluid.advance(&half_step, &[]).unwrap();
        }
        t += dt;
        step += 1;
    }
}

fn water(fluid: &Fluid<2>) -> Vec<[f64; 2]> {
    let real = (0..fluid.columns.slots()).filter(|&s| fluid.columns.id[s] != PADDING);
    real.map(|s| std::array::from_fn(|d| fluid.columns.now.position[d][s])).collect()
}

#[test]
fn a_tank_turned_upside_down_keeps_its_water() {
    // A closed tank, half full, turned by 180 degrees about a point outside of it.
    let text = "resolution = 0.02\nend_time = 3.0\n[fluid]\ndensity = 1000.0\nsound_speed = 30.0\n\
        [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.6, 0.2] }\n\
        pressure = \"hydrostatic\"\n\
        [[shape]]\nname = \"tank\"\nphase = \"wall\"\ntank = { min = [0.0, 0.0], max = [0.6, 0.4] }\n\
        motion = { angular_velocity = 1.5707963267948966, end = 2.5, ramp = 0.5, pivot = [0.2, -0.1] }\n";
    let mut fluid = fluid(text);
    let (mut error, mut count) = (0.0_f64, usize::MAX);
    run(&mut fluid, 3.0, |fluid, _| {
        let audit = fluid.audit();
        error = error.max(audit.density_error);
        count = count.min(fluid.columns.particles);
    });
    // Half a turn: (x, y) was at 2 p - (x, y), which has to lie in the cavity.
    let inside = |x: &[f64; 2]| {
        let [x, y] = [0.4 - x[0], -0.2 - x[1]];
        x > -0.01 && x < 0.61 && y > -0.01 && y < 0.41
    };
    let all = water(&fluid);
    let out = all.iter().filter(|x| !inside(x)).count();
    println!("{count} of 300 particles, {out} outside, density error {error}");
    assert_eq!((count, all.len(), out), (300, 300, 0));
    // Water that falls by 0.4 m is stopped by a shock, v / c0 = 2.8 / 30.
    assert!(error < 0.09, "{error}");
    // What was its lid is below: the tank's cavity is now from y = -0.6 to -0.2, half full.
    let mean = all.iter().map(|x| x[1]).sum::<f64>() / 300.0;
    assert!((mean + 0.5).abs() < 0.01, "{mean}");
}

/// Means over the last half second of 4 s of what is measured of water, 10 rows deep, in a tank with a motion: the
/// highest particles at three places, the pressure at two points that move with the floor, the force on the walls.
fn settled(motion: &str) -> [f64; 7] {
    let text = format!(
        "resolution = 0.01\nend_time = 4.0\n[fluid]\ndensity = 1000.0\nsound_speed = 15.0\n\
         artificial_viscosity = {{ linear = 0.5 }}\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [-0.1, 0.0], max = [0.1, 0.1] }}\n\
         pressure = \"hydrostatic\"\n\
         [[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
         tank = {{ min = [-0.1, 0.0], max = [0.1, 0.2], open = [\"top\"] }}\n{motion}\
         [[probe]]\nname = \"levels\"\nkind = \"water-level\"\nx = [-0.08, 0.0, 0.08]\n\
         [[probe]]\nname = \"left\"\nkind = \"pressure\"\nat = [-0.08, 0.02]\nshape = \"tank\"\n\
         [[probe]]\nname = \"right\"\nkind = \"pressure\"\nat = [0.08, 0.02]\nshape = \"tank\"\n\
         [[probe]]\nname = \"walls\"\nkind = \"force\"\nshape = \"tank\"\n"
    );
    let mut fluid = fluid(&text);
    let (mut sums, mut count) = ([0.0; 7], 0.0);
    run(&mut fluid, 4.0, |fluid, t| {
        if t > 3.5 {
            let mut values = Vec::new();
            fluid.probes(&mut values);
            sums.iter_mut().zip(&values).for_each(|(sum, value)| *sum += value);
            count += 1.0;
        }
    });
    sums.map(|sum| sum / count)
}

#[test]
fn water_in_a_tank_that_tilts_slowly_stays_level() {
    // By 15 degrees within 3 s, about the middle of its floor: the surface at the walls 0.2 m apart would be 5 cm off.
    let angle = 15.0_f64.to_radians();
    let turning = format!(
        "motion = {{ angular_velocity = {}, end = 3.0, ramp = 1.0, pivot = [0.0, 0.0] }}\n",
        angle / 2.0
    );
    let [a, b, c, left, right, fx, fy] = settled(&turning);
    let [.., still_left, still_right, _, _] = settled("");
    // Where a surface of the same water at the same pressures would be: rho g times the depth of a point of the floor.
    let surface = |pressure: f64, x: f64| pressure / 9810.0 + x * angle.sin() + 0.02 * angle.cos();
    let surfaces = [surface(left, -0.08), surface(right, 0.08)];
    let still = 0.02 + 0.5 * (still_left + still_right) / 9810.0;
    println!(
        "levels {a:.4} {b:.4} {c:.4} m, by pressure {surfaces:.4?} m, still {still:.4} m, force {fx:.2} {fy:.2} N/m"
    );
    let level = surfaces[0];
    assert!((surfaces[1] - level).abs() < 0.002, "{surfaces:?}");
    assert!([a, b, c].iter().all(|l| (l - level).abs() < 0.005), "{a} {b} {c} {level}");
    // The middle of the surface stays where the water is as deep, along the floor's normal, as at rest: that normal
    // leans by the angle.
    assert!((level - still * angle.cos()).abs() < 0.001, "{level} {still}");
    assert!((fy / -196.2 - 1.0).abs() < 0.01 && fx.abs() < 2.0, "{fx} {fy}");
}

#[test]
fn a_wall_far_from_its_pivot_shows_what_one_shows_that_moves_straight() {
    // omega² r = 5 m/s² toward a pivot 1000 m below, or above: beside the acceleration of 5 m/s² along a line.
    let shown = |motion: &str, time: f64| {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\n[fluid]\ndensity = 1000.0\nsound_speed = 20.0\n\
             [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.2, 0.1] }}\n\
             pressure = \"hydrostatic\"\n\
             [[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
             tank = {{ min = [0.0, 0.0], max = [0.2, 0.2], open = [\"top\"] }}\n{motion}"
        );
        let mut fluid = fluid(&text);
        fluid.set_time(time);
        fluid.own_sums();
        let walls = fluid.walls.as_ref().unwrap();
        let near = |s: &usize| {
            let [x, y] = std::array::from_fn(|d| walls.shown.position[d][*s]);
            (x - 0.105_f64).abs() < 1e-4 && (y + 0.005_f64).abs() < 1e-4
        };
        walls.shown.sources[(0..walls.slots()).find(near).expect("a wall particle")].pressure
    };
    let omega = (5.0_f64 / 1000.0).sqrt();
    let turning = |y: f64| format!("motion = {{ angular_velocity = {omega}, pivot = [0.105, {y}] }}\n");
    let still = shown("", 0.0);
    let (below, above) = (shown(&turning(-1000.0), 1e-9), shown(&turning(1000.0), 1e-9));
    let period = std::f64::consts::TAU / (5.0_f64 / 1e-6).sqrt();
    let swinging = format!("motion = {{ amplitude = [0.0, 1e-6], period = {period} }}\n");
    // At three quarters of its period it is accelerated upward by 5 m/s².
    let pushed = shown(&swinging, 0.75 * period);
    assert!(pushed > still + 50.0, "{pushed} {still}");
    assert!((above / pushed - 1.0).abs() < 1e-3, "{above} {pushed}");
    assert!(((still - below) / (above - still) - 1.0).abs() < 1e-3, "{below} {still} {above}");
}
