//! Walls and a solid of another program: the coupler holds it against them from its records, unless it does so itself.
//! Against another solid the coupler holds it in any case.

use halfstep_output::run_json::{ContactReport, ForceKind};
use halfstep_tests::python::python;
use halfstep_tests::run::{Finished, RunBuilder, repository, scene_at};
use std::path::PathBuf;

/// A block of 10 kg/m over a floor; water stands in a tank of its own.
const SCENE: &str = r#"
resolution = 0.01
end_time = 0.5

[fluid]
density = 1000.0

[solid]
model = "rigid"
density = 1000.0
contact = { friction = FRICTION }

[[shape]]
name = "block"
phase = "solid"
box = { min = [0.0, BOTTOM], max = [0.1, TOP] }
velocity = [SPEED, 0.0]

[[shape]]
name = "floor"
phase = "wall"
box = { min = [-0.1, -0.05], max = [0.8, 0.0] }

[[shape]]
name = "tank"
phase = "wall"
tank = { min = [1.0, 0.0], max = [1.1, 0.2], open = ["top"] }
contact = false

[[shape]]
name = "water"
phase = "fluid"
box = { min = [1.0, 0.0], max = [1.1, 0.05] }
pressure = "hydrostatic"

[output]
probe_interval = 0.001

[[probe]]
name = "block"
kind = "displacement"
at = [0.05, BOTTOM]

[[probe]]
name = "force"
kind = "force"

[[probe]]
name = "floor"
kind = "body-contact-force"
body = "block"
"#;

const WEIGHT: f64 = 10.0 * 9.81;

struct Block {
    _folder: tempfile::TempDir,
    path: PathBuf,
}

impl Block {
    /// At this height over the floor, m, with this speed along it, m/s.
    fn new(height: f64, speed: f64, friction: f64) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("block.toml");
        let text = SCENE.replace("BOTTOM", &height.to_string()).replace("TOP", &(height + 0.1).to_string());
        let text = text.replace("SPEED", &speed.to_string()).replace("FRICTION", &friction.to_string());
        std::fs::write(&path, text).expect("a scene");
        Self { _folder: folder, path }
    }

    /// The same with a model that strains in the scene.
    fn straining(self) -> Self {
        let text = std::fs::read_to_string(&self.path).expect("a scene");
        let elastic = "model = \"hypoelastic\"\nyoungs_modulus = 1e7\npoissons_ratio = 0.3";
        std::fs::write(&self.path, text.replace("model = \"rigid\"", elastic)).expect("a scene");
        self
    }

    fn built_in(&self) -> RunBuilder {
        scene_at(&self.path)
    }

    fn external(&self, more: &str) -> RunBuilder {
        self.built_in().argument("--solid").argument(line(more))
    }
}

/// The line that starts the block.
fn line(more: &str) -> String {
    let script = repository().join("tests/python/free_block.py");
    format!("{} {} {more}", python().display(), script.display())
}

fn contact(run: &Finished) -> &ContactReport {
    let contact = run.report.contacts.first().expect("contact");
    assert_eq!(contact.solids, ["solid", "wall"]);
    contact
}

fn log(run: &Finished) -> String {
    std::fs::read_to_string(run.dir().join("log.txt")).expect("a log")
}

/// How deep the block goes into the floor after a fall by 10 mm, m: the law of contact without restitution, in steps of
/// a ten-thousandth of the impact.
fn deepest(stiffness: f64) -> f64 {
    // 10 kg/m behind a circumference of 0.4 m.
    let limit = 0.3 / (stiffness / 25.0).sqrt();
    let dt = 1e-4 * limit;
    let (mut depth, mut speed) = (0.0, (2.0 * 9.81 * 0.01_f64).sqrt());
    let fastest: f64 = speed;
    while speed > 0.0 {
        let slow = (0.5 * 0.3 * 0.3 / limit * depth).max(0.01 * fastest).max(4.0 * 9.81 * limit);
        let push = stiffness * 0.105 * depth * 0.5 * (1.0 + (speed / slow).tanh());
        speed += dt * (9.81 - push / 10.0);
        depth += dt * speed;
    }
    depth
}

/// It falls by 10 mm and does not bounce. The force is at rest half of K times depth and length, of which corners have
/// a quarter of a spacing of the sides beside them.
#[test]
fn a_falling_block_stops_on_the_floor() {
    let run = Block::new(0.01, 0.0, 0.0).external("").run();
    let (force, way) = (run.curve("floor.y"), run.curve("block.y"));
    assert_eq!(run.curve("force.y").peak().1, 0.0, "no water is there");
    let (force, depth) = (force.between(0.3, 0.5).mean(), -0.01 - way.between(0.3, 0.5).mean());
    let ContactReport { stiffness, largest_penetration, normal, .. } = *contact(&run);
    let sunk = WEIGHT / (0.5 * stiffness * 0.105);
    let deepest = deepest(stiffness);
    println!(
        "force {force} N/m of {WEIGHT}; depth {depth:e} m of {sunk:e}, at most {largest_penetration:e} of {deepest:e}"
    );
    assert!((force / WEIGHT - 1.0).abs() < 1e-3, "{force}");
    assert!((depth / sunk - 1.0).abs() < 0.01, "{depth:e} {sunk:e}");
    assert!((largest_penetration / deepest - 1.0).abs() < 0.005, "{largest_penetration:e} {deepest:e}");
    assert!((normal / (-WEIGHT * (0.01 + depth)) - 1.0).abs() < 0.01, "{normal}");
    // At the end it rests: the floor's impulse is that of its weight over the whole run.
    let by = run.report.forces.iter().find(|by| by.kind == ForceKind::Walls).expect("the floor's force");
    assert!((by.impulse[1] / (WEIGHT * 0.5) - 1.0).abs() < 1e-3, "{by:?}");
    assert!((by.work / normal - 1.0).abs() < 1e-9, "{by:?} {normal}");
    let said = log(&run);
    assert!(
        said.contains("contact of the solid with walls: by the coupler, friction 0, restitution 0"),
        "{said}"
    );
}

#[test]
fn a_sliding_block_stops_as_coulomb_says_and_as_the_built_in_one_does() {
    let block = Block::new(0.0, 1.0, 0.3);
    let run = block.external("").run();
    let (way, expected) = (run.curve("block.x").at(0.5), 1.0 / (2.0 * 0.3 * 9.81));
    let own = block.built_in().run().curve("block.x").at(0.5);
    println!("way {way} m of {expected}, of the built-in block {own}; {:?}", contact(&run));
    assert!((way / expected - 1.0).abs() < 5e-3, "{way}");
    assert!((way / own - 1.0).abs() < 5e-3, "{way} {own}");
    // Its kinetic energy.
    assert!((contact(&run).friction / -5.0 - 1.0).abs() < 0.01, "{:?}", contact(&run));
    assert!(run.report.audit.action_reaction.expect("an audit") <= 1e-12);
}

/// A program has the friction that the scene gives its solid, whatever the model beside it.
#[test]
fn a_block_whose_scene_names_an_elastic_model_slides_as_coulomb_says() {
    let elastic = Block::new(0.0, 1.0, 0.3).straining();
    let run = elastic.external("").run();
    let (way, expected) = (run.curve("block.x").at(0.5), 1.0 / (2.0 * 0.3 * 9.81));
    println!("way {way} m of {expected}; {:?}", contact(&run));
    assert!((way / expected - 1.0).abs() < 5e-3, "{way}");
    assert!(
        log(&run).contains("contact of the solid with walls: by the coupler, friction 0.3, restitution 0")
    );
}

/// A block of 10 kg/m on a slab, which space holds; water stands in a tank of its own. Contact is as stiff as without
/// the water (`tests/tests/pair_contact.rs`), whose slow flow would soften it.
const SLAB: &str = r#"
resolution = 0.01
end_time = 0.5

[fluid]
density = 1000.0

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
stiffness = 9.4e7

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

[[shape]]
name = "tank"
phase = "wall"
tank = { min = [1.0, 0.0], max = [1.1, 0.2], open = ["top"] }
contact = false

[[shape]]
name = "water"
phase = "fluid"
box = { min = [1.0, 0.0], max = [1.1, 0.05] }
pressure = "hydrostatic"

[[probe]]
name = "block"
kind = "body-position"
body = "block"
solid = "block"
"#;

#[test]
fn a_block_slides_on_a_built_in_solid_as_coulomb_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("slab.toml");
    std::fs::write(&path, SLAB).expect("a scene");
    let external = scene_at(&path).argument("--solid").argument(format!("block={}", line(""))).run();
    let expected = 1.0 / (2.0 * 0.3 * 9.81);
    for (whose, run) in [("its own program", external), ("built in", scene_at(&path).run())] {
        let x = run.curve("block.x");
        let (way, late) = (x.at(0.5) - 0.05, x.at(0.5) - x.at(0.4));
        let pair = run.report.contacts.first().expect("contact");
        println!(
            "{whose}: way {way:.6} m of {expected:.6}, {late:.1e} m at last; {pair:?}, {:?}",
            run.report.forces
        );
        assert_eq!(pair.solids, ["block", "slab"]);
        assert!((way / expected - 1.0).abs() < 5e-3 && late.abs() < 1e-6, "{whose}: {way} {late}");
        // Its kinetic energy.
        assert!((pair.friction / -5.0 - 1.0).abs() < 0.01, "{whose}: {pair:?}");
        // Friction stops 10 N s/m, and the slab carries the weight for 0.5 s.
        let [on_block, on_slab] = &run.report.forces[..] else { panic!("{:?}", run.report.forces) };
        for (name, by, sign) in [("block", on_block, 1.0), ("slab", on_slab, -1.0)] {
            assert_eq!((by.solid.as_str(), by.kind), (name, ForceKind::Contact));
            let [x, y, _] = by.impulse.map(|p| sign * p);
            assert!(
                (x / -10.0 - 1.0).abs() < 0.01 && (y / (0.5 * WEIGHT) - 1.0).abs() < 0.01,
                "{whose}: {by:?}"
            );
        }
        assert!(run.report.audit.action_reaction.expect("an audit") <= 1e-12);
    }
}

#[test]
fn a_block_that_does_its_own_walls_gets_no_force() {
    let run = Block::new(0.01, 0.0, 0.0).external("own-walls").until(0.2).run();
    let way = run.curve("block.y").at(0.2);
    println!("{way} m");
    assert!((way / (-0.5 * 9.81 * 0.04) - 1.0).abs() < 1e-3, "{way}");
    assert_eq!(run.report.contacts, []);
    assert!(log(&run).contains("contact of the solid with walls: by itself, as it says"));
}

#[test]
fn an_interrupted_block_goes_on_to_the_same_bits_and_says_the_same_of_walls() {
    let block = Block::new(0.0, 1.0, 0.3);
    let whole = block.external("").until(0.2).run();
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path().join("run");
    block.external("").set("output.checkpoint_interval", 0.03).until(0.1).out(&dir).run();
    let again = || block.built_in().resume(&dir).until(0.2).argument("--solid");
    let other = again().argument(line("own-walls")).outcome();
    assert_eq!(other.code(), Some(1), "a resume that does not go on: {}", other.stderr);
    let error = "the solid says other than before the checkpoint who evaluates its contact with walls";
    assert!(other.stderr.contains(error), "{}", other.stderr);
    let resumed = again().argument(line("")).run();
    assert!(resumed.report.resumed[0].step > 0);
    assert_eq!(resumed.probes, whole.probes);
    assert_eq!(resumed.report.contacts, whole.report.contacts);
    assert_eq!(resumed.report.forces, whole.report.forces);
}

/// The floor goes up with 0.1 m/s: it lifts the block, and gives it m g times the way and its kinetic energy. The block
/// lies as deep in it as the contact is soft: as the square of the step.
#[test]
fn a_floor_that_goes_up_lifts_the_block() {
    let block = Block::new(0.0, 0.0, 0.0);
    let [usual, shorter] = [0.6, 0.4].map(|cfl| {
        let lift = "{ velocity = [0.0, 0.1] }";
        let run = block.external("").set("numerics.cfl", cfl).set("shape.floor.motion", lift).run();
        let (way, given) = (run.curve("block.y").at(0.5), contact(&run).normal);
        println!("{cfl}: {way} m of 0.05 m, {given} J/m of {}", WEIGHT * way + 0.05);
        assert!((given / (WEIGHT * way + 0.05) - 1.0).abs() < 5e-3, "{given}");
        assert!(!run.outcome.stderr.contains("instead of taking"), "{}", run.outcome.stderr);
        0.05 - way
    });
    assert!((0.0..5e-4).contains(&shorter), "{shorter}");
    assert!((usual / shorter / 2.25 - 1.0).abs() < 0.01, "{usual} {shorter}");
}

/// In water: floor and water carry it together, and the forces of water alone are in balance with those on the water.
#[test]
fn a_heavy_block_sinks_to_the_floor() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sinks.toml");
    std::fs::write(&path, SINKING).expect("a scene");
    let run = scene_at(&path).argument("--solid").argument(line("")).run();
    let mean = |column: &str| run.curve(column).between(0.5, 0.8).mean();
    let [of_water, of_floor] = ["force.y", "floor.y"].map(mean);
    let (force, height) = (of_water + of_floor, run.curve("block.y").at(0.8));
    println!("{of_water} and {of_floor} N/m of {}, height {height} m, {:?}", 2.0 * WEIGHT, contact(&run));
    // It lies on the floor, and the water only above it.
    assert!(of_water < 0.0 && of_floor > 2.0 * WEIGHT, "{of_water} {of_floor}");
    assert!((force / (2.0 * WEIGHT) - 1.0).abs() < 0.01, "{force}");
    assert!((height + 0.02).abs() < 1e-3, "{height}");
    let mismatch = run.report.audit.action_reaction.expect("an audit");
    assert!(mismatch <= 1e-12, "{mismatch:e}");
}

/// A block of twice the water's density 20 mm over the floor of a tank.
const SINKING: &str = r#"
resolution = 0.0125
end_time = 0.8

[fluid]
density = 1000.0

[solid]
model = "rigid"
density = 2000.0

[[shape]]
name = "block"
phase = "solid"
box = { min = [0.15, 0.02], max = [0.25, 0.12] }

[[shape]]
name = "tank"
phase = "wall"
tank = { min = [0.0, 0.0], max = [0.4, 0.3], open = ["top"] }

[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [0.4, 0.2] }
pressure = "hydrostatic"

[[probe]]
name = "block"
kind = "displacement"
at = [0.2, 0.07]

[[probe]]
name = "force"
kind = "force"

[[probe]]
name = "floor"
kind = "body-contact-force"
body = "block"
"#;

/// Alone, too, a solid stands on the floor.
#[test]
fn a_block_that_is_tried_alone_stands_on_the_floor() {
    let block = Block::new(0.0, 0.0, 0.0);
    let folder = tempfile::tempdir().expect("a folder");
    let mut tried = std::process::Command::new(halfstep_tests::run::program());
    tried.arg("fake-fluid").arg(&block.path).args(["--solid", &line(""), "--force", "0,0"]);
    let done = tried.arg("--out").arg(folder.path()).args(["--until", "0.3"]).output().expect("it starts");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let rows = halfstep_output::read_probes(&folder.path().join("probes.csv")).expect("probes");
    let last = |name: &str| rows.column(name).and_then(|column| column.last().copied()).expect("a force");
    let [of_floor, load] = ["floor.y", "force.y"].map(last);
    println!("{of_floor} N/m of {WEIGHT}, load {load} N/m");
    assert!((of_floor / WEIGHT - 1.0).abs() < 1e-3 && load.abs() < 1e-9, "{of_floor} {load}");
}
