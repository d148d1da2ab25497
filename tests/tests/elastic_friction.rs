//! Solids that strain rub on walls and on each other's bodies and bounce off them as their `contact` says: the coupler
//! holds them.

use halfstep_output::run_json::ContactReport;
use halfstep_tests::{Finished, Written};

const MODELS: [&str; 3] = ["total-lagrangian", "finite-element", "hypoelastic"];
const G: f64 = 9.81;

fn contact(run: &Finished) -> &ContactReport {
    let contact = run.report.contacts.first().expect("contact");
    assert_eq!(contact.solids, ["solid", "wall"]);
    contact
}

/// What the ledger does not explain over the largest energy exchanged.
fn unexplained(run: &Finished) -> f64 {
    run.report.energy.as_ref().expect("ledgers").relative_residual
}

/// A block of rubber, 5 kg/m, c_P = 37 m/s, on a floor.
const BLOCK: &str = r#"
resolution = 0.01
end_time = 0.5

[solid]
density = 1000.0
youngs_modulus = 1e6
poissons_ratio = 0.3
contact = { friction = 0.3 }

[[shape]]
name = "block"
phase = "solid"
box = { min = [0.0, 0.0], max = [0.1, 0.05] }
velocity = [1.0, 0.0]

[[shape]]
name = "floor"
phase = "wall"
box = { min = [-0.1, -0.05], max = [0.6, 0.0] }

[[probe]]
name = "block"
kind = "centroid"
phase = "solid"

[[probe]]
name = "ledger"
kind = "energy"
phase = "solid"
"#;

/// v² / (2 mu g), and all that the block had goes to friction, less what its own viscosity takes.
#[test]
fn a_sliding_block_stops_as_coulomb_says() {
    let scene = Written::new(BLOCK);
    for model in MODELS {
        let run = scene.run_as(model).in_process().run();
        let way = run.curve("block.x").at(0.5) - 0.05;
        let expected = 1.0 / (2.0 * 0.3 * G);
        let [normal, friction] = [contact(&run).normal, contact(&run).friction];
        let given = run.curve("ledger.interface-pressure").at(0.5);
        let viscosity = run.curve("ledger.artificial-viscosity").at(0.5);
        let lost = unexplained(&run);
        println!(
            "{model}: {way:.5} m of {expected:.5}, friction {friction:.4} J/m, viscosity {viscosity:.4}, unexplained \
             {lost:.1e}, {:?}",
            contact(&run)
        );
        assert!((way / expected - 1.0).abs() < 0.01, "{model}: {way}");
        assert!((friction / -2.5 - 1.0).abs() < 0.03, "{model}: {friction}");
        assert!(((normal + friction) / given - 1.0).abs() < 1e-9, "{model}: {given}");
        assert!(lost < 1e-3, "{model}: {lost}");
        // The model itself leaves walls alone.
        assert_eq!(run.curve("ledger.wall-contact").at(0.5), 0.0);
    }
}

/// The block without `contact`: its model holds it.
fn held_by_its_model() -> String {
    BLOCK.replace("contact = { friction = 0.3 }\n", "")
}

/// The floor of a block is a slab of the same solid instead, which a clamp holds.
fn on_a_slab(block: &str) -> String {
    let slab = "name = \"slab\"\nphase = \"solid\"\nclamp = { min = [-0.2, -0.1], max = [0.7, -0.02] }\n";
    let probes = ["position", "velocity", "force", "moment"]
        .map(|what| format!("[[probe]]\nname = \"{what}\"\nkind = \"body-{what}\"\nbody = \"block\"\n"));
    block.replace("name = \"floor\"\nphase = \"wall\"\n", slab) + &probes.concat()
}

#[test]
fn a_block_that_slides_on_a_slab_of_its_own_solid_stops_as_coulomb_says() {
    let scene = Written::new(&on_a_slab(BLOCK));
    for model in &MODELS[..2] {
        let run = scene.run_as(model).in_process().run();
        let x = run.curve("position.x");
        let way = x.at(0.5) - x.at(0.0);
        let contact = run.report.contacts.first().expect("contact");
        let (friction, lost) = (contact.friction, unexplained(&run));
        println!("{model}: {way:.5} m, friction {friction:.4} J/m, unexplained {lost:.1e}, {contact:?}");
        assert_eq!(contact.solids, ["solid", "solid"]);
        assert!((x.at(0.0) - 0.05).abs() < 1e-12 && (run.curve("position.y").at(0.0) - 0.025).abs() < 1e-12);
        assert!((run.curve("velocity.x").at(0.0) - 1.0).abs() < 1e-12, "{model}");
        // What carries the block is contact, of which its moment holds the middle; there is no fluid.
        let force = run.curve("force.y").at(0.5) / (5.0 * G);
        let lever = run.curve("moment.moment").at(0.5) / (5.0 * G * 0.05);
        assert!(force.abs() < 1e-9 && lever.abs() < 0.02, "{model}: {force}, {lever}");
        assert!((way * 2.0 * 0.3 * G - 1.0).abs() < 0.005, "{model}: {way}");
        assert!((friction / -2.5 - 1.0).abs() < 0.02, "{model}: {friction}");
        assert!(lost < 1e-3, "{model}: {lost}");
    }
}

/// A block on a slope: gravity is turned instead.
fn on_a_slope(block: &str, tangent: f64) -> Written {
    let angle = f64::atan(tangent);
    let gravity = format!("gravity = [{}, {}]\n", G * angle.sin(), -G * angle.cos());
    Written::new(&(gravity + &block.replace("velocity = [1.0, 0.0]\n", "")))
}

/// With mu = 0.3: below its angle the block leans over as an elastic block does, and stays; above it goes with
/// g (sin - mu cos).
#[test]
fn a_block_on_a_slope_holds_below_the_angle_of_friction_and_slides_above() {
    for model in MODELS {
        let run = on_a_slope(BLOCK, 0.27).run_as(model).in_process().run();
        let x = run.curve("block.x");
        let (lean, creep) = (x.at(0.25) - 0.05, x.at(0.5) - x.at(0.25));
        println!("{model}: leans by {lean:.2e} m, then creeps by {creep:.2e} m");
        assert!(lean.abs() < 5e-4 && creep.abs() < 2e-5, "{model}: {lean:e}, {creep:e}");
        let run = on_a_slope(BLOCK, 0.4).run_as(model).in_process().run();
        // Once it has come to rest on the slope: the second difference of the way over 0.15 s.
        let x = run.curve("block.x");
        let rate = (x.at(0.5) - 2.0 * x.at(0.35) + x.at(0.2)) / (0.15 * 0.15);
        let angle = f64::atan(0.4);
        let right = G * (angle.sin() - 0.3 * angle.cos());
        println!("{model}: slides with {rate:.4} m/s² of {right:.4}");
        assert!((rate / right - 1.0).abs() < 0.02, "{model}: {rate}");
    }
}

/// A disc of 40 mm that meets a floor at 1 m/s; c_P = 116 m/s, so that it is stiffer than contact.
const DISC: &str = r#"
resolution = 0.002
end_time = 0.02
gravity = [0.0, 0.0]

[solid]
density = 1000.0
youngs_modulus = 1e7
poissons_ratio = 0.3
contact = { restitution = 1.0 }

[[shape]]
name = "disc"
phase = "solid"
disc = { center = [0.0, 0.025], radius = 0.02 }
velocity = [0.0, -1.0]

[[shape]]
name = "floor"
phase = "wall"
contact = true
box = { min = [-0.05, -0.02], max = [0.05, 0.0] }

[[probe]]
name = "disc"
kind = "centroid"
phase = "solid"

[[probe]]
name = "ledger"
kind = "energy"
phase = "solid"
"#;

/// The disc's own steps are a tenth of what contact allows, so the force goes over from that of coming to that of
/// leaving within a small part of the disc's speed. A stiff body whose vibrations are much faster than the impact keeps
/// what a point mass keeps; here the three models are apart by their vibrations, up to 0.03 where nothing is kept.
#[test]
fn a_disc_comes_back_with_about_the_restitution_that_is_asked() {
    let scene = Written::new(DISC);
    for model in MODELS {
        for (restitution, measured) in [(1.0, 1.0), (0.5, 0.507), (0.2, 0.2), (0.0, 0.12)] {
            let run = scene.run_as(model).set("solid.contact.restitution", restitution).in_process().run();
            let height = run.curve("disc.y");
            let left = (height.at(0.02) - height.at(0.018)) / 0.002;
            let scale = run.curve("ledger.kinetic").at(0.0);
            let (contact, lost) = (contact(&run).normal / scale, unexplained(&run));
            println!("{model}, {restitution}: e = {left:.3}, contact {contact:.4}, unexplained {lost:.1e}");
            assert!((left - measured).abs() < 0.02, "{model}, {restitution}: {left}");
            assert!(lost < 1e-2, "{model}: {lost}");
        }
    }
}

/// A block of rubber that drops on the floor of a tank with a little water.
const WET: &str = r#"
resolution = 0.02
end_time = 0.2

[fluid]
density = 1000.0

[solid]
density = 1500.0
youngs_modulus = 1e6
poissons_ratio = 0.3
contact = { friction = 0.4, restitution = 0.3 }

[[shape]]
name = "tank"
phase = "wall"
tank = { min = [0.0, 0.0], max = [0.6, 0.4], open = ["top"] }

[[shape]]
name = "block"
phase = "solid"
box = { min = [0.3, 0.005], max = [0.46, 0.105] }
velocity = [-0.5, 0.0]

[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [0.16, 0.1] }
pressure = "hydrostatic"
"#;

#[test]
fn processes_do_not_matter_and_an_interrupted_run_goes_on() {
    goes_on(&Written::new(WET), &MODELS, &[["solid", "wall"]]);
}

/// A second body of the same solid lands on the block.
#[test]
fn processes_do_not_matter_for_bodies_of_one_solid() {
    let lid = "[[shape]]\nname = \"lid\"\nphase = \"solid\"\nbox = { min = [0.34, 0.115], max = [0.42, 0.175] }\n\
               velocity = [0.5, -0.5]\n";
    let scene = Written::new(&(WET.to_owned() + lid));
    goes_on(&scene, &MODELS[..2], &[["solid", "solid"], ["solid", "wall"]]);
}

/// Who touches whom, and loses energy by friction, is the same in processes, threads and after an interruption.
fn goes_on(scene: &Written, models: &[&str], touching: &[[&str; 2]]) {
    for model in models {
        let run = || scene.run_as(model);
        let whole = run().run();
        println!("{model}: {:?}", whole.report.contacts);
        let names: Vec<&[String]> = whole.report.contacts.iter().map(|of| of.solids.as_slice()).collect();
        assert_eq!(names, touching);
        assert!(whole.report.contacts.iter().all(|of| of.friction < 0.0 && of.normal < 0.0));
        for other in [run().in_process(), run().threads(1)] {
            let other = other.run();
            assert_eq!(other.state_hash(), whole.state_hash(), "{model}");
            assert_eq!(other.report.contacts, whole.report.contacts, "{model}");
        }
        let folder = tempfile::tempdir().expect("a folder");
        let dir = folder.path().join("run");
        run().set("output.checkpoint_interval", 0.03).until(0.1).out(&dir).run();
        let resumed = scene.run().resume(&dir).until(0.2).run();
        assert!(resumed.report.resumed[0].step > 0);
        assert_eq!(resumed.state_hash(), whole.state_hash(), "{model}");
        assert_eq!(resumed.report.contacts, whole.report.contacts, "{model}");
        assert!(whole.outcome.log().contains("walls: by the coupler, friction 0.4, restitution 0.3"));
    }
}

/// A floor that goes up with 0.2 m/s takes the block along; the effect's row says who holds it.
#[test]
fn a_floor_that_goes_up_lifts_the_block() {
    let floor = "name = \"floor\"\nmotion = { velocity = [0.0, 0.2] }\ncontact = true\n";
    let text = BLOCK.replace("name = \"floor\"\n", floor).replace("velocity = [1.0, 0.0]\n", "");
    let run = Written::new(&text).run_as("total-lagrangian").in_process().until(0.3).run();
    let rise = run.curve("block.y").at(0.3) - run.curve("block.y").at(0.0);
    let given = contact(&run).normal / (5.0 * (G * 0.06 + 0.5 * 0.04));
    let row = run.report.effects.iter().find(|row| row.name == "wall-contact").expect("a row");
    println!("rises {rise:.5} m of 0.06, gets {given:.4} of m g h + m v² / 2; {}", row.why);
    assert!((rise - 0.06).abs() < 1e-3, "{rise}");
    assert!((given - 1.0).abs() < 0.02, "{given}");
    assert_eq!(
        (row.on, row.why.as_str()),
        (true, "a wall has contact = true: in the coupler, friction 0.3, restitution 0")
    );
}

/// A block without friction on a floor of particles of its own spacing, on slopes.
#[test]
fn a_block_slides_on_particles_as_on_a_smooth_slope() {
    for degrees in [15.0_f64, 25.0] {
        let angle = degrees.to_radians();
        let scene = on_a_slope(&held_by_its_model(), angle.tan());
        for model in MODELS {
            let run = scene.run_as(model).set("shape.block.box.max", "[0.08, 0.06]");
            let run = run.set("shape.floor.box.max", "[3.0, 0.0]").until(1.0).in_process().run();
            let (way, smooth) = (run.curve("block.x").at(1.0) - 0.04, 0.5 * G * angle.sin());
            println!("{model}, {degrees} degrees: {way:.4} of {smooth:.4} m");
            // Within 0.0006 measured: the floor's rows brake by less than that.
            assert!((way / smooth - 1.0).abs() < 1e-3, "{model}: {way} of {smooth}");
        }
    }
}

/// Two bodies of one solid without `contact`: neither rows of particles nor the law take anything.
#[test]
fn a_block_slides_on_a_body_of_its_solid_without_friction() {
    let scene = Written::new(&on_a_slab(&held_by_its_model()));
    for model in &MODELS[..2] {
        let run = scene.run_as(model).in_process().run();
        let left = run.curve("ledger.kinetic").at(0.5);
        println!("{model}: {left:.4} of 2.5 J/m");
        assert!((2.485..2.5).contains(&left), "{model}: {left}");
    }
}

/// A block that slides into the corner of a tank stands at both walls. Its weight on six and eight particles of each
/// pushes it into them by 10 to 13 and 14 to 20 um.
#[test]
fn a_block_stands_in_a_corner_of_its_tank() {
    let corner = r#"
resolution = 0.01
end_time = 2.0
gravity = [-5.0, -9.81]

[solid]
density = 1000.0
youngs_modulus = 1e6
poissons_ratio = 0.3
artificial_viscosity = { linear = 3.0, quadratic = 0.0 }

[[shape]]
name = "tank"
phase = "wall"
tank = { min = [0.0, 0.0], max = [0.4, 0.3], open = ["top"] }

[[shape]]
name = "block"
phase = "solid"
box = { min = [0.02, 0.0], max = [0.1, 0.06] }

[[probe]]
name = "block"
kind = "centroid"
phase = "solid"
"#;
    let scene = Written::new(corner);
    for model in MODELS {
        let run = scene.run_as(model).in_process().run();
        let off = [("block.x", 0.04), ("block.y", 0.03)].map(|(of, right)| {
            let curve = run.curve(of).between(1.5, 2.0);
            curve.values.iter().map(|x| (x - right).abs()).fold(0.0, f64::max)
        });
        println!("{model}: {off:?} m");
        assert!(off[0] < 2e-5 && off[1] < 3e-5, "{model}: {off:?}");
    }
}
