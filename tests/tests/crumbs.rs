//! What shatters between other solids or on one: contact only takes energy.

use halfstep_tests::Written;

/// A slab that a ram of 10 m/s crushes against an anvil: 380 fragments of single particles.
const CRUSHED: &str = r#"
resolution = 0.005
end_time = 0.03
gravity = [0.0, 0.0]
[[solid]]
name = "brittle"
density = 2400.0
youngs_modulus = 1e8
poissons_ratio = 0.2
fracture = { strength = 3e5, energy = 8.0 }
[[solid]]
name = "first"
model = "rigid"
density = 2400.0
[[solid]]
name = "second"
model = "rigid"
density = 2400.0
[output]
frame_interval = 0.01
probe_interval = 1e-4
[[shape]]
name = "slab"
phase = "solid"
solid = "brittle"
box = { min = [0.0, 0.0], max = [0.05, 0.2] }
[[shape]]
name = "ram"
phase = "solid"
solid = "first"
box = { min = [-0.11, 0.0], max = [-0.01, 0.1] }
velocity = [10.0, 0.0]
[[shape]]
name = "anvil"
phase = "solid"
solid = "second"
box = { min = [0.06, 0.05], max = [0.26, 0.25] }
[[probe]]
name = "pieces"
kind = "bodies"
solid = "brittle"
[[probe]]
name = "broken"
kind = "crack-energy"
solid = "brittle"
"#;

/// Where points held on whose particles were in different fragments, contact gave energy: the slab's particles came to
/// 140 m/s and the run diverged at 0.018 s. What contact does only takes energy: 339, 120 and 0 J/m of the ram's
/// 1200 J/m by 0.06 s; rubble goes 20 mm into the ram.
#[test]
fn crumbs_between_two_solids_gain_nothing() {
    let crushed = Written::new(CRUSHED);
    let run = crushed.run().in_process().run();
    let bodies = run.curve("pieces.bodies").values.last().copied().unwrap_or(0.0);
    assert!(bodies > 200.0, "it is crushed: {bodies} bodies");
    for pair in &run.report.contacts {
        println!("{:?} {:.2} J/m, {:.1} mm deep", pair.solids, pair.normal, 1e3 * pair.largest_penetration);
        assert!(pair.normal <= 0.0 && pair.friction == 0.0, "{pair:?}");
        assert!(pair.largest_penetration <= 0.025, "{pair:?}");
    }
    let same = crushed.run().run();
    assert_eq!(run.state_hash(), same.state_hash(), "three processes");
}

/// A brick of eight by six particles that a plate shatters. Where the plate's points were looked for in what was left
/// of the brick's outline, contact gave up to 2190 J/m.
#[test]
fn a_brick_that_shatters_on_a_plate_gains_nothing() {
    let brick = r#"
resolution = 0.01
end_time = 0.01
gravity = [0.0, 0.0]
[[solid]]
name = "brick"
density = 2400.0
youngs_modulus = 3e8
poissons_ratio = 0.2
fracture = { strength = 2e5, energy = 2.0, friction = 0.3 }
[[solid]]
name = "plate"
density = 2400.0
youngs_modulus = 3e8
poissons_ratio = 0.2
[[contact]]
solids = ["brick", "plate"]
[output]
probe_interval = 1e-4
[[shape]]
name = "brick"
phase = "solid"
solid = "brick"
box = { min = [-0.09, 0.0], max = [-0.01, 0.06] }
velocity = [10.0, 0.0]
[[shape]]
name = "plate"
phase = "solid"
solid = "plate"
box = { min = [0.0, -0.1], max = [0.05, 0.2] }
clamp = [{ min = [0.0, -0.1], max = [0.05, -0.08] }, { min = [0.0, 0.18], max = [0.05, 0.2] }]
[[probe]]
name = "pieces"
kind = "bodies"
solid = "brick"
"#;
    for speed in [8.0, 10.0, 12.0, 15.0, 20.0] {
        let scene = Written::new(&brick.replace("[10.0, 0.0]", &format!("[{speed:?}, 0.0]")));
        let run = scene.run().in_process().run();
        let loose = run.curve("pieces.loose").values.last().copied().unwrap_or(0.0);
        let (pair, start) = (&run.report.contacts[0], 0.5 * 2400.0 * 0.08 * 0.06 * speed * speed);
        println!("{speed} m/s: {:.3} of {start} J/m, {loose} loose, {pair:?}", pair.normal / start);
        assert!(loose > 20.0 && pair.normal < 0.0, "{speed}: {pair:?}");
    }
}
