//! The fluid as a role: walls, rest, time step.

use crate::Fluid;
use crate::effects::FluidEffect;
use crate::rates::RateSum;
use crate::time_step::StepLimits;
use halfstep_role::role::Role;
use halfstep_scene::{self as scene, Scene};
use halfstep_sph::lane::Isa;
use halfstep_sph::neighbours::PADDING;
use halfstep_wire::half_step::{HalfStep, Stage};
use std::path::Path;

pub(crate) fn tank(overrides: &[&str]) -> Scene {
    let text = r#"
        resolution = 0.01
        end_time = 1.0
        [fluid]
        density = 1000.0
        sound_speed = 20.0
        [[shape]]
        name = "water"
        phase = "fluid"
        box = { min = [0.0, 0.0], max = [0.2, 0.1] }
        pressure = "hydrostatic"
        [[shape]]
        name = "tank"
        phase = "wall"
        tank = { min = [0.0, 0.0], max = [0.2, 0.2], open = ["top"] }
    "#;
    let overrides: Vec<String> = overrides.iter().map(|&o| o.into()).collect();
    scene::parse(text, Path::new("tank.toml"), &overrides).expect("a right scene")
}

#[test]
fn walls_show_the_hydrostatic_pressure() {
    let mut fluid = Fluid::<2>::new(&tank(&[]), Isa::detect()).unwrap();
    fluid.own_sums();
    let walls = fluid.walls.as_ref().unwrap();
    let mut seen = 0;
    for s in (0..walls.slots()).filter(|&s| walls.id[s] != PADDING) {
        let x: [f64; 2] = std::array::from_fn(|d| walls.shown.position[d][s]);
        // Two layers are within reach of the water: p = rho g (0.1 - y), exact for a linear field but for the
        // compressed density in the extrapolation (0.2 %).
        let deep_corner = x[1] < -0.01 && !(0.0..0.2).contains(&x[0]);
        if !deep_corner && x[1] < 0.09 && x[1] > -0.02 && x[0] > -0.02 && x[0] < 0.22 {
            let exact = 1000.0 * 9.81 * (0.1 - x[1]);
            let shown = walls.shown.sources[s].pressure;
            assert!((shown - exact).abs() < 0.005 * exact, "{x:?}: {shown} {exact}");
            seen += 1;
        }
    }
    assert!(seen > 30);
    // Above the water nothing is near: zero.
    let dry = (0..walls.slots()).filter(|&s| walls.id[s] != PADDING && walls.shown.position[1][s] > 0.14);
    assert!(dry.map(|s| walls.shown.sources[s].pressure).all(|p| p == 0.0));
}

#[test]
fn a_wall_that_pushes_shows_more_pressure_and_one_that_pulls_less() {
    // x = A sin(w t) with A = 1e-6 m and A w² = 5 m/s²: at three quarters of a period the tank is where it was, at
    // rest, and has the acceleration 5 m/s² to the right.
    let period = std::f64::consts::TAU / (5.0_f64 / 1e-6).sqrt();
    let motion = format!("shape.tank.motion={{amplitude=[1e-6,0.0],period={period}}}");
    let shown = |overrides: &[&str]| {
        let mut fluid = Fluid::<2>::new(&tank(overrides), Isa::detect()).unwrap();
        fluid.set_time(0.75 * period);
        fluid.publish(&[], &mut Vec::new());
        fluid.own_sums();
        let walls = fluid.walls.as_ref().unwrap();
        let at = |x: f64| {
            let near = |s: &usize| {
                (walls.shown.position[0][*s] - x).abs() < 1e-5
                    && (walls.shown.position[1][*s] - 0.055).abs() < 1e-9
            };
            walls.shown.sources[(0..walls.slots()).find(near).expect("a wall particle")].pressure
        };
        [at(-0.005), at(0.205)]
    };
    let (still, pushed) = (shown(&[]), shown(&[&motion]));
    let [left, right] = [pushed[0] - still[0], pushed[1] - still[1]];
    // p_w = sum (p_f + rho (g - a) . (x_w - x_f)) W / sum W: rho a times the mean distance of the water across, which
    // lies between its first column's, dx, and 2h.
    let support = 2.0 * tank(&[]).smoothing_ratio * 0.01;
    let (least, most) = (1000.0 * 5.0 * 0.01, 1000.0 * 5.0 * support);
    assert!(least < left && left < 0.6 * most, "{left} Pa between {least} and {most}");
    assert!((left + right).abs() < 2e-3 * left, "{left} {right}");
}

#[test]
fn walls_mirror_the_normal_velocity() {
    let scene = tank(&["shape.water.velocity=[0.3,-0.2]"]);
    let mut fluid = Fluid::<2>::new(&scene, Isa::detect()).unwrap();
    fluid.own_sums();
    let walls = fluid.walls.as_ref().unwrap();
    let at = |x: f64, y: f64| {
        (0..walls.slots())
            .find(|&s| {
                (walls.shown.position[0][s] - x).abs() < 1e-9 && (walls.shown.position[1][s] - y).abs() < 1e-9
            })
            .map(|s| walls.shown.sources[s].velocity)
            .unwrap()
    };
    let near =
        |a: [f64; 2], b: [f64; 2]| assert!((a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-12, "{a:?} {b:?}");
    near(at(0.105, -0.005), [0.3, 0.2]); // floor: along kept, normal reversed
    near(at(-0.005, 0.055), [-0.3, -0.2]); // side
    near(at(-0.005, -0.005), [-0.3, 0.2]); // corner: both
}

#[test]
fn still_water_stays_still() {
    let mut fluid = Fluid::<2>::new(&tank(&[]), Isa::detect()).unwrap();
    let mut record = Vec::new();
    let mut largest = 0.0_f64;
    for step in 0..400 {
        for half_step in HalfStep::begin(step, 0.0).lasting(fluid.dt_limit()).both() {
            fluid.publish(&[], &mut record);
            fluid.own_sums();
            fluid.advance(&half_step, &[]).unwrap();
        }
        largest = largest.max(fluid.audit().kinetic_energy);
    }
    // Energy of the same water falling through a tenth of its depth: 20 kg/m * g * 0.01 m = 2 J/m.
    assert!(largest < 2e-3, "{largest}");
}

/// Position Verlet has of each stage one equation, and of that the midpoint rule's bits. The guard is left out: it
/// knows how many stages stop a particle.
#[test]
fn a_stage_of_one_equation_has_its_bits() {
    let sums = |integration: &str, diffusion: &str, stage: Stage| {
        let integration = format!("fluid.time_integration=\"{integration}\"");
        let diffusion = format!("fluid.density_diffusion=\"{diffusion}\"");
        let moving = "shape.water.velocity_field={kind=\"standing-wave\",amplitude=0.01,origin=[0.0,0.0],\
                      half_wave=0.2,depth=0.1}";
        let others =
            ["effects.wall-guard=\"off\"", "effects.wall-separation=\"on\"", "fluid.viscosity=0.1", moving];
        let scene = tank(&[&[integration.as_str(), diffusion.as_str()], &others[..]].concat());
        let mut fluid = Fluid::<2>::new(&scene, Isa::detect()).unwrap();
        fluid.stage = stage;
        fluid.own_sums();
        let rates = |sum: &RateSum<2>| (sum.acceleration.map(|a| a.0), sum.density_rate.0);
        fluid.sums.iter().map(rates).unzip::<_, _, Vec<_>, Vec<_>>()
    };
    for diffusion in ["simple", "hydrostatic", "delta-sph"] {
        let (accelerations, density_rates) = sums("midpoint", diffusion, Stage::First);
        assert!(accelerations.iter().flatten().flatten().any(|a| *a != 0.0), "something moves");
        let (none, found) = sums("verlet", diffusion, Stage::First);
        assert!(none.iter().flatten().flatten().all(|a| *a == 0.0), "{diffusion}");
        assert_eq!(found, density_rates, "{diffusion}");
        let (found, none) = sums("verlet", diffusion, Stage::Second);
        assert!(none.iter().flatten().all(|rate| *rate == 0.0), "{diffusion}");
        assert_eq!(found, accelerations, "{diffusion}");
    }
}

/// Forces on walls have shares of the momentum equation, which the first stage of position Verlet does not need.
#[test]
fn position_verlet_measures_the_viscous_force_on_walls() {
    let loads = |integration: &str| {
        let integration = format!("fluid.time_integration=\"{integration}\"");
        let probe = "probe=[{name=\"push\",kind=\"force\",shape=\"tank\"}]";
        let moving = "shape.water.velocity=[0.3,-0.2]";
        let scene = tank(&[&integration, probe, moving, "fluid.viscosity=1.0", "effects.wall-guard=\"off\""]);
        let mut fluid = Fluid::<2>::new(&scene, Isa::detect()).unwrap();
        assert!(fluid.measures_loads());
        fluid.own_sums();
        (<() as FluidEffect<2>>::passes().wall_loads)(&fluid)
    };
    let [midpoint, verlet] = ["midpoint", "verlet"].map(loads);
    assert!(midpoint.iter().flatten().any(|f| *f != 0.0));
    assert_eq!(midpoint, verlet);
}

#[test]
fn time_step_limits_by_hand() {
    // h = 0.02, c0 = 20: 0.6 * 0.02 / (20 + 5); acceleration 1e6: 0.25 sqrt(0.02 / 1e6).
    let limits = StepLimits::new::<2>(&tank(&[]));
    assert!((limits.time_step(5.0, 0.0) - 0.6 * 0.02 / 25.0).abs() < 1e-15);
    assert!((limits.time_step(0.0, 1e6) - 0.25 * (0.02_f64 / 1e6).sqrt()).abs() < 1e-15);
    // Honey: 0.125 h² rho / mu = 0.125 * 4e-4 * 1000 / 1000.
    let viscous = StepLimits::new::<2>(&tank(&["fluid.viscosity=1000.0"]));
    assert!((viscous.time_step(0.0, 0.0) - 0.125 * 4e-4).abs() < 1e-12);
    // What damps: 1.4 h / (A c0) with A = 7; 0.25 h / (delta c0) with delta = 1, and h / c0 = 1 ms.
    let damped = StepLimits::new::<2>(&tank(&["fluid.artificial_viscosity={linear=7.0,quadratic=0.0}"]));
    assert!((damped.time_step(0.0, 0.0) - 2e-4).abs() < 1e-15);
    let diffusing = StepLimits::new::<2>(&tank(&["fluid.density_diffusion_coefficient=1.0"]));
    assert!((diffusing.time_step(0.0, 0.0) - 2.5e-4).abs() < 1e-15);
    // Honey and A = 7: 1 / (1 / 5e-5 + 1 / 2e-4).
    let both = ["fluid.viscosity=1000.0", "fluid.artificial_viscosity={linear=7.0,quadratic=0.0}"];
    assert!((StepLimits::new::<2>(&tank(&both)).time_step(0.0, 0.0) - 4e-5).abs() < 1e-15);
}

/// Viscous stress moves fluid and solid: h = 0.015 makes 0.125 h² rho / mu 28.125 µs, over 1 + 0.4 and over 2 + 0.4,
/// whose inverses add to that of 0.6 h / c0 = 0.45 ms, of the light block over the root of 2.
#[test]
fn solids_that_viscous_stress_drags_shorten_the_step() {
    for (density, limit) in [(1000.0, 28.125e-6 / 1.4), (500.0, 28.125e-6 / 2.4), (4000.0, 28.125e-6)] {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, 0.0]\n[fluid]\ndensity = 1000.0\nviscosity = 1000.0\n\
             sound_speed = 20.0\n[solid]\nmodel = \"rigid\"\ndensity = {density}\n\
             [[shape]]\nname = \"oil\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.2, 0.1] }}\n\
             [[shape]]\nname = \"block\"\nphase = \"solid\"\nbox = {{ min = [0.2, 0.0], max = [0.3, 0.1] }}\n"
        );
        let scene = scene::parse(&text, Path::new("honey.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let found = StepLimits::new::<2>(&scene).time_step(0.0, 0.0);
        let courant = 4.5e-4 / (1000.0_f64 / density).max(1.0).sqrt();
        let right = 1.0 / (1.0 / courant + 1.0 / limit);
        assert!((found / right - 1.0).abs() < 1e-12, "{density}: {found} {right}");
    }
}

#[test]
fn divergence_names_the_particle() {
    let mut fluid = Fluid::<2>::new(&tank(&[]), Isa::detect()).unwrap();
    let mut record = Vec::new();
    let mut failure = None;
    for step in 0..50 {
        // A hundred times the stable step.
        for half_step in HalfStep::begin(step, 0.0).lasting(0.02).both() {
            fluid.publish(&[], &mut record);
            fluid.own_sums();
            if let Err(diverged) = fluid.advance(&half_step, &[]) {
                failure = Some(diverged);
            }
        }
        if failure.is_some() {
            break;
        }
    }
    let diverged = failure.expect("an absurd time step diverges");
    assert!(diverged.to_string().contains("the fluid diverged at step"));
    assert!(diverged.particle < 200);
}
