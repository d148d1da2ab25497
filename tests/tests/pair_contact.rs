//! Contact between two solids through real runs: law, bits, interruptions.

use halfstep_output::RunReport;
use halfstep_output::run_json::{ContactReport, ForceKind};
use halfstep_tests::{Finished, Written};

fn contact(report: &RunReport) -> &ContactReport {
    report.contacts.first().expect("a pair of solids")
}

/// A block of one solid on a slab of another, which space holds.
const SLIDING: &str = r#"
resolution = 0.01
end_time = 0.5

[[solid]]
name = "block"
model = "rigid"
density = 2000.0

[[solid]]
name = "slab"
model = "rigid"
density = 2000.0

[[solid.joints]]
name = "held"
kind = "fixed"
body = "slab"

[[contact]]
solids = ["block", "slab"]
friction = 0.3

[[shape]]
name = "block"
phase = "solid"
solid = "block"
box = { min = [0.0, 0.0], max = [0.1, 0.05] }
velocity = [1.0, 0.0]

[[shape]]
name = "slab"
phase = "solid"
solid = "slab"
box = { min = [-0.2, -0.05], max = [0.5, 0.0] }

[[probe]]
name = "block"
kind = "body-position"
body = "block"
solid = "block"

[[probe]]
name = "tilt"
kind = "body-angle"
body = "block"
solid = "block"
"#;

#[test]
fn a_block_of_one_solid_slides_on_another_as_coulomb_says() {
    let run = Written::new(SLIDING).run().run();
    let way = run.curve("block.x").at(0.5) - 0.05;
    let expected = 1.0 / (2.0 * 0.3 * 9.81);
    println!("{way:.6} m of {expected:.6} m, {:?}", contact(&run.report));
    assert!((way / expected - 1.0).abs() < 5e-3, "{way}");
    assert!(run.curve("tilt.angle").at(0.5).abs() < 1e-3);
    // Kinetic energy of 10 kg/m at 1 m/s.
    assert!((contact(&run.report).friction / 5.0 + 1.0).abs() < 0.01, "{:?}", contact(&run.report));
    // Contact alone acts: it stops 10 N s/m, and carries the weight for 0.5 s.
    let [on_block, on_slab] = &run.report.forces[..] else { panic!("{:?}", run.report.forces) };
    for (name, by, sign) in [("block", on_block, 1.0), ("slab", on_slab, -1.0)] {
        assert_eq!((by.solid.as_str(), by.kind), (name, ForceKind::Contact));
        let [x, y, z] = by.impulse.map(|p| sign * p);
        assert!((x / -10.0 - 1.0).abs() < 0.01 && (y / 49.05 - 1.0).abs() < 0.01 && z == 0.0, "{by:?}");
    }
    assert!((on_block.work / -5.0 - 1.0).abs() < 0.01 && on_slab.work == 0.0, "{:?}", run.report.forces);
    // At least weight and friction.
    let least = 98.1 * (1.0_f64 + 0.3 * 0.3).sqrt();
    assert!(on_block.largest > 0.99 * least, "{on_block:?}");
}

/// A block of one solid that strains on a slab of another, which is clamped below its upper two rows.
const RUBBING: &str = r#"
resolution = 0.01
end_time = 0.22

[[solid]]
name = "block"
density = 1000.0
youngs_modulus = 1e6
poissons_ratio = 0.3

[[solid]]
name = "slab"
density = 1000.0
youngs_modulus = 1e6
poissons_ratio = 0.3

[[contact]]
solids = ["block", "slab"]
friction = 0.3

[[shape]]
name = "block"
phase = "solid"
solid = "block"
box = { min = [0.0, 0.0], max = [0.1, 0.05] }
velocity = [0.5, 0.0]

[[shape]]
name = "slab"
phase = "solid"
solid = "slab"
box = { min = [-0.05, -0.05], max = [0.2, 0.0] }
clamp = { min = [-0.05, -0.05], max = [0.2, -0.02] }

[[probe]]
name = "block"
kind = "centroid"
phase = "solid"
solid = "block"
"#;

/// v² / (2 mu g) = 42.47 mm, after 0.17 s. Bands: the way is off by -0.6 to 0.4e-3 of it, 0.5e-3 of which may be that
/// the block shakes by 0.02 mm as it stays; friction takes 0.9 to 3.5e-3 less than the block had, which its own
/// viscosity takes as it shears.
#[test]
fn solids_that_strain_rub_on_each_other_as_coulomb_says() {
    let scene = Written::new(RUBBING);
    let energy = 0.5 * 5.0 * 0.25;
    for [block, slab] in [
        ["total-lagrangian", "finite-element"],
        ["total-lagrangian", "hypoelastic"],
        ["hypoelastic", "finite-element"],
    ] {
        let run =
            scene.run().set("solid.block.model", block).set("solid.slab.model", slab).in_process().run();
        let x = run.curve("block.x");
        let (way, late) = (x.at(0.22) - 0.05, x.at(0.22) - x.at(0.19));
        let (right, did) = (0.25 / (2.0 * 0.3 * 9.81), contact(&run.report));
        println!("{block} on {slab}: {way:.6} m of {right:.6} m, {late:.1e} m at last, {did:?}");
        assert!((way / right - 1.0).abs() < 1e-3, "{block} on {slab}: {way}");
        assert!(late.abs() < 5e-5, "{block} on {slab}: {late}");
        assert!((-5e-3..0.0).contains(&(-did.friction / energy - 1.0)), "{block} on {slab}: {did:?}");
        assert!(did.normal <= 0.0 && did.normal > -0.01 * energy, "{block} on {slab}: {did:?}");
        // It stops 2.5 N s/m; what one gets is what the other one gives.
        let [on_block, on_slab] = &run.report.forces[..] else { panic!("{:?}", run.report.forces) };
        assert!((on_block.impulse[0] / -2.5 - 1.0).abs() < 0.01, "{on_block:?}");
        for (a, b) in on_block.impulse.iter().zip(&on_slab.impulse) {
            assert!((a + b).abs() < 1e-12 * 11.0, "{:?}", run.report.forces);
        }
        assert!((on_block.work + on_slab.work - did.normal - did.friction).abs() < 1e-9 * energy, "{did:?}");
    }
}

/// A rigid block runs into a free elastic one.
const COLLIDING: &str = r#"
resolution = 0.01
end_time = 0.05
gravity = [0.0, 0.0]

[[solid]]
name = "rigid"
model = "rigid"
density = 1000.0

[[solid]]
name = "elastic"
density = 1000.0
youngs_modulus = 1e7
poissons_ratio = 0.3

[[contact]]
solids = ["rigid", "elastic"]
restitution = 1.0

[[shape]]
name = "rigid"
phase = "solid"
solid = "rigid"
box = { min = [0.0, 0.0], max = [0.1, 0.1] }
velocity = [2.0, 0.0]

[[shape]]
name = "elastic"
phase = "solid"
solid = "elastic"
box = { min = [0.11, 0.0], max = [0.31, 0.1] }

[[probe]]
name = "rigid"
kind = "body-velocity"
body = "rigid"
solid = "rigid"
"#;

#[test]
fn an_elastic_block_takes_the_momentum_that_a_rigid_one_loses() {
    let run = Written::new(COLLIDING).run().run();
    let drift = run.report.audit.momentum_drift.expect("momentum");
    let speed = run.curve("rigid.x").at(0.05);
    println!("drift {drift:.1e}, rigid {speed:.4} m/s, {:?}", contact(&run.report));
    assert!(drift < 1e-12, "{drift}");
    // An impact of points would leave (1 - 2) / 3 of the 2 m/s; waves in the block keep 1.5 % of that. The law's spring
    // gives back what it took: 5e-4 of 20 J/m.
    let right = -2.0 / 3.0;
    assert!((speed / right - 0.985).abs() < 0.01, "{speed}");
    assert!(contact(&run.report).normal.abs() < 2e-3, "{:?}", contact(&run.report));
    assert!(contact(&run.report).largest_force > 0.0);
}

/// A block falls on a raft that floats.
const RAFT: &str = r#"
resolution = 0.02
end_time = 0.3

[fluid]
density = 1000.0

[[solid]]
name = "raft"
model = "rigid"
density = 400.0

[[solid]]
name = "block"
model = "rigid"
density = 500.0

[[contact]]
solids = ["raft", "block"]
friction = 0.5

[[shape]]
name = "basin"
phase = "wall"
tank = { min = [0.0, 0.0], max = [1.0, 0.6], open = ["top"] }

[[shape]]
name = "raft"
phase = "solid"
solid = "raft"
box = { min = [0.3, 0.16], max = [0.7, 0.26] }

[[shape]]
name = "block"
phase = "solid"
solid = "block"
box = { min = [0.46, 0.265], max = [0.54, 0.345] }

[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [1.0, 0.2] }
pressure = "hydrostatic"

[[probe]]
name = "raft"
kind = "body-position"
body = "raft"
solid = "raft"

[[probe]]
name = "block"
kind = "body-position"
body = "block"
solid = "block"
"#;

fn lies_on_the_raft(run: &Finished) -> bool {
    let gap = run.curve("block.y").at(0.2) - run.curve("raft.y").at(0.2);
    (gap - 0.09).abs() < 1e-3
}

#[test]
fn processes_do_not_matter_and_an_interrupted_run_goes_on() {
    let together = Written::new(RAFT);
    let apart = Written::new(&RAFT.replace("model = \"rigid\"", "model = \"rigid\"\nprocess = \"own\""));
    let run = |written: &Written| written.run().until(0.2);
    let whole = run(&together).run();
    println!("{:?}", contact(&whole.report));
    assert!(lies_on_the_raft(&whole));
    assert!(contact(&whole.report).largest_force > 3.2 * 9.81);
    for other in [run(&apart), run(&together).in_process(), run(&together).threads(1)] {
        let other = other.run();
        assert_eq!(other.state_hash(), whole.state_hash());
        assert_eq!(other.report.contacts, whole.report.contacts);
    }
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path().join("run");
    let cut = together.run().set("output.checkpoint_interval", 0.03).until(0.15);
    cut.out(&dir).run();
    let resumed = together.run().resume(&dir).until(0.2).run();
    assert_eq!(resumed.state_hash(), whole.state_hash());
    assert_eq!(resumed.report.contacts, whole.report.contacts);
    assert_eq!(resumed.report.forces, whole.report.forces);
}
