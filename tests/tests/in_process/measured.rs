//! Forces on walls and quantities inside of solids, beside values by hand.

use halfstep::{Simulation, scene};
use std::path::Path;

fn simulation(text: &str) -> Simulation {
    Simulation::new(scene::parse(text, Path::new("s.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
}

const TANK: &str = r#"
    resolution = 0.01
    end_time = 1.0
    [fluid]
    density = 1000.0
    artificial_viscosity = { linear = 1.0 }
    [[shape]]
    name = "water"
    phase = "fluid"
    box = { min = [0.0, 0.0], max = [0.4, 0.2] }
    pressure = "hydrostatic"
    [[shape]]
    name = "floor"
    phase = "wall"
    box = { min = [-0.04, -0.04], max = [0.44, 0.0] }
    [[shape]]
    name = "left"
    phase = "wall"
    box = { min = [-0.04, 0.0], max = [0.0, 0.3] }
    [[shape]]
    name = "right"
    phase = "wall"
    box = { min = [0.4, 0.0], max = [0.44, 0.3] }
    [[probe]]
    name = "floor"
    kind = "force"
    shape = "floor"
    [[probe]]
    name = "left"
    kind = "force"
    shape = "left"
    [[probe]]
    name = "right"
    kind = "force"
    shape = "right"
    [[probe]]
    name = "foot"
    kind = "moment"
    shape = "right"
    about = [0.4, 0.0]
    [[probe]]
    name = "face"
    kind = "pressure"
    from = [0.4, 0.0]
    to = [0.4, 0.2]
"#;

#[test]
fn walls_of_a_tank_carry_its_water() {
    let mut run = simulation(TANK).begin().expect("a run");
    let names =
        ["floor.x", "floor.y", "left.x", "left.y", "right.x", "right.y", "foot.moment", "face.pressure"];
    let (mut sums, mut count) = ([0.0; 8], 0.0);
    while run.step().expect("a step") {
        if run.time() > 0.5 {
            for (sum, name) in sums.iter_mut().zip(names) {
                *sum += run.probe(name).expect("a probe");
            }
            count += 1.0;
        }
    }
    let [floor_x, floor, left, left_y, right, right_y, foot, face] = sums.map(|sum| sum / count);
    let (rho_g, depth, width) = (1000.0 * 9.81, 0.2_f64, 0.4);
    let (weight, side) = (rho_g * depth * width, 0.5 * rho_g * depth * depth);
    let moment = rho_g * depth.powi(3) / 6.0;
    println!(
        "over theory: floor {:.4}, left {:.4}, right {:.4}, moment {:.4}, mean pressure {:.4}; all walls {:.5}, {:.1e}",
        -floor / weight,
        -left / side,
        right / side,
        -foot / moment,
        face / (0.5 * rho_g * depth),
        -(floor + left_y + right_y) / weight,
        (floor_x + left + right) / side
    );
    // The walls together carry the weight but for what still moves.
    assert!(((floor + left_y + right_y) / weight + 1.0).abs() < 2e-3);
    assert!(((floor_x + left + right) / side).abs() < 2e-3);
    // 20 particles deep: where the surface is known to half a spacing, the depth is to 2.5 %, the side's force to 5 %,
    // its moment to 7.5 %.
    assert!((floor / weight + 1.0).abs() < 0.005, "{floor} {weight}");
    assert!((left / side + 1.0).abs() < 0.05 && (right / side - 1.0).abs() < 0.05, "{left} {right} {side}");
    assert!((foot / moment + 1.0).abs() < 0.075, "{foot} {moment}");
    assert!((face / (0.5 * rho_g * depth) - 1.0).abs() < 0.05, "{face}");
}

/// A cantilever in its first bending mode.
const BEAM: &str = r#"
    resolution = 0.001
    end_time = 0.04
    gravity = [0.0, 0.0]
    [solid]
    density = 1000.0
    youngs_modulus = 2e6
    poissons_ratio = 0.3
    [[shape]]
    name = "beam"
    phase = "solid"
    box = { min = [-0.02, 0.0], max = [0.1, 0.01] }
    clamp = { min = [-0.02, 0.0], max = [0.0, 0.01] }
    cantilever_mode = { fraction = 0.005, root = 0.0, length = 0.1 }
    [[probe]]
    name = "tip"
    kind = "displacement"
    at = [0.0995, 0.005]
    [[probe]]
    name = "end"
    kind = "position"
    at = [0.0995, 0.005]
    [[probe]]
    name = "top"
    kind = "stress"
    at = [0.0105, 0.0085]
    [[probe]]
    name = "stored"
    kind = "strain-energy"
    [[probe]]
    name = "moving"
    kind = "kinetic-energy"
    phase = "solid"
"#;

#[test]
fn stress_and_energy_of_a_beam_are_those_of_its_bending() {
    let mut run = simulation(BEAM).begin().expect("a run");
    let mut first = None;
    let (mut most, mut stress, mut tip, mut end) = (0.0, 0.0, 0.0_f64, 0.0);
    while run.step().expect("a step") {
        let value = |name: &str| run.probe(name).expect("a probe");
        first.get_or_insert(value("moving.energy"));
        if value("tip.y") > tip {
            (tip, end) = (value("tip.y"), value("end.y"));
            (most, stress) = (value("stored.energy"), value("top.stress"));
        }
    }
    // At its turning point the beam has stored what it had as motion.
    let first: f64 = first.expect("a step");
    // Landau and Lifshitz, section 25: the mode, and its curvature over k².
    let (length, height, nu) = (0.1_f64, 0.01, 0.3_f64);
    let (k, modulus) = (1.875_104 / length, 2e6 / (1.0 - nu * nu));
    let end_of_mode = 1.875_104_f64;
    let ratio = (end_of_mode.sin() - end_of_mode.sinh()) / (end_of_mode.cosh() + end_of_mode.cos());
    let shape = |kx: f64| (kx.cosh() - kx.cos()) + ratio * (kx.sinh() - kx.sin());
    let bend = |kx: f64| (kx.cosh() + kx.cos()) + ratio * (kx.sinh() + kx.sin());
    let curvature = k * k * bend(k * 0.0105) / shape(k * 0.0995) * tip;
    let bending = modulus * curvature * (0.0085 - 0.5 * height);
    // Plane strain: the stress along z is nu times that along the beam.
    let expected = bending * (1.0 - nu + nu * nu).sqrt();
    println!("tip {tip:e} m, stress {stress} of {expected} Pa, energy {most:e} of {first:e} J");
    assert!((end - (0.005 + tip)).abs() < 1e-3 && end > tip, "{end} {tip}");
    assert!((most / first - 1.0).abs() < 0.03, "{most} {first}");
    assert!((stress / expected - 1.0).abs() < 0.08, "{stress} {expected}");
}

/// A wall of two blocks, one upon the other, beside water.
const BLOCKS: &str = r#"
    resolution = 0.01
    end_time = 0.05
    [fluid]
    density = 1000.0
    [solid]
    density = 2000.0
    youngs_modulus = 1e7
    poissons_ratio = 0.3
    [[shape]]
    name = "water"
    phase = "fluid"
    box = { min = [0.0, 0.0], max = [0.2, 0.2] }
    pressure = "hydrostatic"
    [[shape]]
    name = "tank"
    phase = "wall"
    tank = { min = [0.0, 0.0], max = [0.4, 0.3], open = ["top", "right"] }
    [[shape]]
    name = "lower"
    phase = "solid"
    box = { min = [0.2, 0.0], max = [0.26, 0.1] }
    clamp = { min = [0.2, 0.0], max = [0.26, 0.1] }
    [[shape]]
    name = "upper"
    phase = "solid"
    box = { min = [0.2, 0.1], max = [0.26, 0.25] }
    clamp = { min = [0.2, 0.1], max = [0.26, 0.25] }
    [[probe]]
    name = "both"
    kind = "force"
    [[probe]]
    name = "lower"
    kind = "force"
    shape = "lower"
    [[probe]]
    name = "upper"
    kind = "force"
    shape = "upper"
    [[probe]]
    name = "foot"
    kind = "moment"
    about = [0.2, 0.0]
"#;

/// At the face of a clamp a particle that is held and one that strains are equally near.
#[test]
fn stress_at_the_face_of_a_clamp_is_that_of_what_strains() {
    const BAR: &str = r#"
        resolution = 0.005
        end_time = 0.002
        gravity = [0.0, 0.0]
        [solid]
        density = 1000.0
        youngs_modulus = 1e7
        poissons_ratio = 0.0
        [[shape]]
        name = "bar"
        phase = "solid"
        box = { min = [0.0, 0.0], max = [0.1, 0.02] }
        clamp = { min = [0.0, 0.0], max = [0.02, 0.02] }
        load = { within = { min = [0.095, 0.0], max = [0.1, 0.02] }, traction = [1e4, 0.0] }
    "#;
    let kinds = ["stress", "strain", "cauchy-stress"];
    let probe = |(name, x): (&str, f64)| {
        kinds.map(|kind| {
            format!("[[probe]]\nname = \"{name}-{kind}\"\nkind = \"{kind}\"\nat = [{x}, 0.0075]\n")
        })
    };
    let probes: String = [("face", 0.02), ("next", 0.0225)].into_iter().flat_map(probe).collect();
    let mut run = simulation(&(BAR.to_owned() + &probes)).begin().expect("a run");
    while run.step().expect("a step") {}
    for value in ["stress.stress", "strain.xx", "cauchy-stress.xx"] {
        let [face, next] = ["face", "next"].map(|at| run.probe(&format!("{at}-{value}")).expect("a probe"));
        assert!(face == next && next.abs() > 0.0, "{value}: {face} {next}");
    }
}

#[test]
fn each_shape_of_a_solid_carries_its_part() {
    let mut run = simulation(BLOCKS).begin().expect("a run");
    while run.step().expect("a step") {}
    let value = |name: &str| run.probe(name).expect("a probe");
    let [both, lower, upper, foot] = ["both.x", "lower.x", "upper.x", "foot.moment"].map(value);
    assert!((lower + upper - both).abs() < 1e-9 * both, "{lower} {upper} {both}");
    // rho g h² / 2 = 196.2 N/m, three quarters of it on the lower half of the depth; rho g h³ / 6 = 13.08 N.
    println!("{both} N/m, lower {:.3} of it, moment {foot} N", lower / both);
    assert!((both / 196.2 - 1.0).abs() < 0.08 && (lower / both - 0.75).abs() < 0.04);
    assert!((foot / -13.08 - 1.0).abs() < 0.1);
}
