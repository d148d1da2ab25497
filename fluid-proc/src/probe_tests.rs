//! What the fluid's probes measure, beside values by hand.

use crate::Fluid;
use halfstep_role::role::Role;
use halfstep_scene::{self as scene, Scene};
use halfstep_sph::lane::Isa;
use halfstep_sph::neighbours::PADDING;
use halfstep_wire::half_step::Stage;
use std::path::Path;

/// 0.4 m x 0.2 m of water in a tank, with these lines instead of the probes.
fn tank(more: &str) -> Scene {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\n[fluid]\ndensity = 1000.0\nsound_speed = 20.0\nviscosity = 0.001\n\
         [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.4, 0.2] }}\n\
         pressure = \"hydrostatic\"\n{more}"
    );
    scene::parse(&text, Path::new("tank.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

const WALLS: &str = "[[shape]]\nname = \"tank\"\nphase = \"wall\"\nslip = \"none\"\n\
    tank = { min = [0.0, 0.0], max = [0.4, 0.3], open = [\"top\"] }\n";

fn probe(name: &str, keys: &str) -> String {
    format!("[[probe]]\nname = \"{name}\"\n{keys}\n")
}

/// The values of the probes at the start.
fn measured(scene: &Scene) -> Vec<f64> {
    let mut fluid = Fluid::<2>::new(scene, Isa::detect()).unwrap();
    fluid.own_sums();
    let mut values = Vec::new();
    fluid.probes(&mut values);
    values
}

#[test]
fn walls_get_the_reaction_to_what_they_give_the_fluid() {
    // Water that flows at the walls, so that the artificial viscosity takes part, too.
    let walls = format!("velocity = [0.5, -0.3]\n{WALLS}");
    let text = walls + &probe("all", "kind = \"force\"\nshape = \"tank\"");
    let mut fluid = Fluid::<2>::new(&tank(&text), Isa::detect()).unwrap();
    fluid.stage = Stage::Second;
    fluid.own_sums();
    let mut force = Vec::new();
    fluid.probes(&mut force);
    let mass = fluid.columns.now.mass;
    let (mut inner, mut size) = ([0.0; 2], 0.0);
    for slot in (0..fluid.columns.slots()).filter(|&s| fluid.columns.id[s] != PADDING) {
        let sum = &fluid.sums[slot / 4];
        for d in 0..2 {
            // What fluid particles give each other adds up to nothing.
            inner[d] += mass * sum.acceleration[d].0[slot % 4];
            size += mass * sum.acceleration[d].0[slot % 4].abs();
        }
    }
    assert!(force[0].abs() > 10.0 && force[1] < -100.0, "{force:?}");
    for d in 0..2 {
        assert!((force[d] + inner[d]).abs() < 1e-12 * size, "{d}: {} {} of {size}", force[d], inner[d]);
    }
}

#[test]
fn forces_on_parts_add_up_to_that_on_the_whole_and_moments_follow_their_axis() {
    let walls = format!("velocity = [0.5, -0.3]\n{WALLS}");
    let part = |min: &str, max: &str| {
        format!("kind = \"force\"\nshape = \"tank\"\nwithin = {{ min = {min}, max = {max} }}")
    };
    let text = walls
        + &probe("all", "kind = \"force\"\nshape = \"tank\"")
        + &probe("left", &part("[-1.0, -1.0]", "[0.2, 1.0]"))
        + &probe("right", &part("[0.2, -1.0]", "[2.0, 1.0]"))
        + &probe("here", "kind = \"moment\"\nshape = \"tank\"\nabout = [0.0, 0.0]")
        + &probe("there", "kind = \"moment\"\nshape = \"tank\"\nabout = [0.3, -0.7]");
    let values = measured(&tank(&text));
    let [fx, fy, lx, ly, rx, ry, here, there] = values[..] else { panic!("{values:?}") };
    let size = fx.abs() + fy.abs();
    assert!((lx + rx - fx).abs() < 1e-10 * size && (ly + ry - fy).abs() < 1e-10 * size, "{values:?}");
    // M' = M - d x F.
    let moved = here - (0.3 * fy + 0.7 * fx);
    assert!((there - moved).abs() < 1e-10 * size, "{there} {moved}");
}

#[test]
fn a_line_measures_flux_velocity_and_mean_pressure() {
    let lines = [
        // Up through all of the water: it flows to the right of the line's direction at 0.5 m/s times 0.2 m.
        probe("up", "kind = \"flux\"\nfrom = [0.2, -0.1]\nto = [0.2, 0.3]"),
        probe("down", "kind = \"flux\"\nfrom = [0.2, 0.3]\nto = [0.2, -0.1]"),
        // On a slope: the same water crosses.
        probe("slope", "kind = \"flux\"\nfrom = [0.1, -0.1]\nto = [0.3, 0.3]"),
        probe("dry", "kind = \"flux\"\nfrom = [0.0, 0.3]\nto = [0.4, 0.3]"),
        probe("point", "kind = \"velocity\"\nat = [0.2, 0.1]"),
        probe("air", "kind = \"velocity\"\nat = [0.2, 0.39]"),
        probe("face", "kind = \"pressure\"\nfrom = [0.2, 0.05]\nto = [0.2, 0.15]"),
        probe("gauges", "kind = \"water-level\"\nx = [0.1, 0.6, 0.3]"),
        probe("gauge", "kind = \"water-level\"\nx = 0.1"),
    ];
    let scene = tank(&format!("velocity = [0.5, 0.0]\n{}", lines.concat()));
    let columns: Vec<String> = scene.probes.iter().flat_map(|p| p.columns(2)).collect();
    assert_eq!(columns[0], "up.flux [m2/s]");
    assert_eq!(
        columns[9..13],
        ["gauges.level-1", "gauges.level-2", "gauges.level-3", "gauge.level"].map(|c| c.to_owned() + " [m]")
    );
    let values = measured(&scene);
    let [up, down, slope, dry, x, y, air_x, air_y, face, levels @ ..] = &values[..] else {
        panic!("{values:?}")
    };
    // The line's points are 5 mm apart, of which one more or less is in the water.
    assert!((up - 0.1).abs() < 0.5 * 0.005 * 1.01 && *down == -up, "{up} {down}");
    assert!((slope - 0.1).abs() < 0.5 * 0.01, "{slope}");
    assert_eq!((*dry, *air_x, *air_y), (0.0, 0.0, 0.0));
    assert!((x - 0.5).abs() < 1e-12 && y.abs() < 1e-12, "{x} {y}");
    // The density that belongs to the pressure is 0.25 % more at this depth.
    let middle = 1000.0 * 9.81 * 0.1;
    assert!((face / middle - 1.0).abs() < 0.005, "{face} {middle}");
    assert!(levels.iter().zip([0.2, 0.0, 0.2, 0.2]).all(|(a, b)| (a - b).abs() < 1e-12), "{levels:?}");
}

#[test]
fn a_point_rides_on_its_wall() {
    // Where it is when the gauge's wall has moved by 0.05 m down: deeper by as much.
    let wall = "[[shape]]\nname = \"rod\"\nphase = \"wall\"\nbox = { min = [1.0, 0.0], max = [1.1, 0.1] }\n\
                motion = { velocity = [0.0, -0.5] }\n";
    let text = format!(
        "{wall}{}{}",
        probe("rides", "kind = \"pressure\"\nat = [0.2, 0.15]\nshape = \"rod\""),
        probe("stays", "kind = \"pressure\"\nat = [0.2, 0.1]")
    );
    let mut fluid = Fluid::<2>::new(&tank(&text), Isa::detect()).unwrap();
    fluid.set_time(0.1);
    fluid.own_sums();
    let mut values = Vec::new();
    fluid.probes(&mut values);
    assert!(values[0] > 900.0 && (values[0] - values[1]).abs() < 1e-6 * values[1], "{values:?}");
}

#[test]
fn a_gauge_in_the_air_feels_no_suction() {
    // The level is at 0.2 m.
    let at = |y: f64| probe(&format!("at-{:.0}", 1e3 * y), &format!("kind = \"pressure\"\nat = [0.2, {y}]"));
    let line = probe("line", "kind = \"pressure\"\nfrom = [0.2, 0.0]\nto = [0.2, 0.3]");
    let heights = [0.1, 0.195, 0.21, 0.23, 0.26];
    let values = measured(&tank(&(WALLS.to_owned() + &heights.map(at).concat() + &line)));
    let weight = 9810.0;
    for (y, value) in heights.into_iter().zip(&values) {
        let wanted = weight * (0.2 - y).max(0.0);
        // The water is compressed by up to 2.5e-4 of its density.
        assert!((value - wanted).abs() < 2.5e-4 * weight * 0.2, "{y}: {value} {wanted}");
    }
    // Its lower two thirds are in the water.
    let mean = weight * 0.2 * 0.2 / 2.0 / 0.3;
    assert!((values[5] / mean - 1.0).abs() < 2.5e-4, "{} {mean}", values[5]);
}

#[test]
fn front_and_centroid_of_nothing_are_no_numbers() {
    let text =
        probe("front", "kind = \"front\"") + &probe("centre", "kind = \"centroid\"\nphase = \"fluid\"");
    let mut fluid = Fluid::<2>::new(&tank(&(WALLS.to_owned() + &text)), Isa::detect()).unwrap();
    fluid.columns.id.fill(PADDING);
    fluid.columns.particles = 0;
    let mut values = Vec::new();
    fluid.probes(&mut values);
    assert!(values.iter().all(|value| value.is_nan()), "{values:?}");
}
