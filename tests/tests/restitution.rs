//! What is left of an impact's speed: a rubber disc on a wall, and steel balls that hang in a row.

use halfstep_tests::run::{Finished, scene_at};

/// A disc of 40 mm that meets a floor at 1 m/s; c_P = 37 m/s.
const DISC: &str = r#"
resolution = 0.002
end_time = 0.02
gravity = [0.0, 0.0]
[solid]
density = 1000.0
youngs_modulus = 1e6
poissons_ratio = 0.3
[output]
frame_interval = 0.02
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

/// Speed of the centre after the impact over that before, and the part of the energy that contact took.
fn bounce(model: &str, dx: f64) -> (f64, f64) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("disc.toml");
    std::fs::write(&path, DISC).expect("a scene");
    let run = scene_at(&path).set("resolution", dx).set("solid.model", model).in_process().run();
    let (height, start) = (run.curve("disc.y"), run.curve("ledger.kinetic").at(0.0));
    let left = (height.at(0.02) - height.at(0.018)) / 0.002;
    let end = |part: &str| run.curve(&format!("ledger.{part}")).at(0.02) / start;
    let [contact, viscosity] = [end("wall-contact"), end("artificial-viscosity")];
    println!(
        "{model}, {dx} m: e = {left:.3}; kinetic {:.3}, strain {:.3}, contact {contact:.3}, viscosity {viscosity:.3}",
        end("kinetic"),
        end("strain")
    );
    (left, contact)
}

/// The wall's spring gives back what it took, and its damping takes 3.9, 1.3, 0.6 and 0.2 % of the energy with 5, 10,
/// 20 and 40 particles across; the rest of the loss is the solid's own: vibrations, and its artificial viscosity.
/// Bands: a hundredth about the speed that is measured, a thousandth about the part.
#[test]
fn a_rubber_disc_comes_back_with_most_of_its_speed() {
    let measured = [
        ("total-lagrangian", 0.008, 0.921, -0.039),
        ("total-lagrangian", 0.004, 0.955, -0.013),
        ("finite-element", 0.008, 0.892, -0.038),
        ("finite-element", 0.004, 0.957, -0.012),
        ("total-lagrangian", 0.002, 0.959, -0.006),
        ("total-lagrangian", 0.001, 0.967, -0.002),
        ("finite-element", 0.002, 0.958, -0.006),
        ("finite-element", 0.001, 0.966, -0.002),
        ("hypoelastic", 0.002, 0.944, -0.004),
        ("hypoelastic", 0.001, 0.962, -0.002),
    ];
    let found = measured.map(|(model, dx, ..)| bounce(model, dx));
    for ((model, dx, left, taken), (found, contact)) in measured.into_iter().zip(found) {
        assert!((found - left).abs() < 0.01, "{model} at {dx} m: e = {found}");
        assert!((contact - taken).abs() < 0.001, "{model} at {dx} m: contact took {contact} of the energy");
    }
}

/// Nothing holds the disc, so the floor carries it without being asked: to the same bits.
#[test]
fn a_floor_carries_what_nothing_holds() {
    let folder = tempfile::tempdir().expect("a folder");
    let disc = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("a scene");
        scene_at(&path).set("resolution", 0.008).in_process()
    };
    let silent = DISC.replace("contact = true\n", "");
    assert_ne!(silent, DISC);
    let (asked, by_itself) = (disc("asked.toml", DISC).run(), disc("silent.toml", &silent).run());
    assert_eq!(asked.state_hash(), by_itself.state_hash());
    let refused = DISC.replace("contact = true", "contact = false");
    let through = disc("refused.toml", &refused).set("end_time", 0.1).until(0.1).run();
    let (back, gone) = (by_itself.curve("disc.y").at(0.02), through.curve("disc.y").at(0.1));
    println!("centre {back:.4} m after 0.02 s; without contact {gone:.4} m after 0.1 s");
    // Its radius is 0.02 m; without contact it goes on at 1 m/s.
    assert!(back > 0.02 && (gone + 0.075).abs() < 1e-3, "{back} m, {gone} m");
}

/// Five balls of 40 mm that hang on rods of 200 mm, m apart, the first one lifted by 0.3 rad.
fn cradle(gap: f64) -> String {
    let mut scene = String::from(
        "resolution = 0.004\nend_time = 0.72\ngravity = [0.0, -9.81]\n[solid]\nmodel = \"rigid\"\ndensity = 7800.0\n\
         contact = { friction = 0.0, restitution = 1.0 }\n",
    );
    for k in 0..5 {
        let pin = (0.04 + gap) * f64::from(k);
        let angle: f64 = if k == 0 { 0.3 } else { 0.0 };
        let (x, y) = (pin - 0.2 * angle.sin(), -0.2 * angle.cos());
        scene += &format!(
            "[[shape]]\nname = \"ball-{k}\"\nphase = \"solid\"\ndisc = {{ center = [{x}, {y}], radius = 0.02 }}\n\
             [[solid.joints]]\nname = \"pin-{k}\"\nkind = \"hinge\"\nbody = \"ball-{k}\"\nat = [{pin}, 0.0]\n\
             [[probe]]\nname = \"ball-{k}\"\nkind = \"body-angle\"\nbody = \"ball-{k}\"\n"
        );
    }
    scene
}

/// How far each ball of a cradle turns at the most, rad.
fn most_turned(run: &Finished) -> Vec<f64> {
    let most = |k: usize| {
        let angles = run.curve(&format!("ball-{k}.angle")).values;
        angles.into_iter().map(f64::abs).fold(0.0, f64::max)
    };
    (0..5).map(most).collect()
}

/// The last ball rises as high as the first one was, and the others stay. Gaps of 0.2 mm are a fifth of what a sub-step
/// may go, so impacts go on through them within one. Bands: the height to 1 %, of which 0.1 % is measured; what
/// overlaps is moved apart, by up to half of a sub-step's 1 mm (0.0025 rad) at each of the three impacts on a ball.
#[test]
fn a_cradle_swings_on_at_its_end() {
    for gap in [0.0, 2e-4] {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("cradle.toml");
        std::fs::write(&path, cradle(gap)).expect("a scene");
        let run = scene_at(&path).in_process().run();
        let turned = most_turned(&run);
        println!("gap {gap} m: at most {turned:.4?} rad");
        assert!((turned[4] - 0.3).abs() < 0.003, "gap {gap} m: {turned:?}");
        assert!(turned[1..4].iter().all(|angle| *angle < 0.0075), "gap {gap} m: {turned:?}");
    }
}

/// The same with each ball a solid of its own, which the coupler holds apart.
fn cradle_of_solids(gap: f64) -> String {
    let mut scene = String::from("resolution = 0.004\nend_time = 0.72\ngravity = [0.0, -9.81]\n");
    let mut shapes = String::new();
    for k in 0..5 {
        let pin = (0.04 + gap) * f64::from(k);
        let angle: f64 = if k == 0 { 0.3 } else { 0.0 };
        let (x, y) = (pin - 0.2 * angle.sin(), -0.2 * angle.cos());
        scene += &format!(
            "[[solid]]\nname = \"s{k}\"\nmodel = \"rigid\"\ndensity = 7800.0\n[[solid.joints]]\nname = \"pin\"\nkind = \
             \"hinge\"\nbody = \"ball-{k}\"\nat = [{pin}, 0.0]\n"
        );
        shapes += &format!(
            "[[shape]]\nname = \"ball-{k}\"\nphase = \"solid\"\nsolid = \"s{k}\"\ndisc = {{ center = [{x}, {y}], radius = \
             0.02 }}\n[[probe]]\nname = \"ball-{k}\"\nkind = \"body-angle\"\nbody = \"ball-{k}\"\nsolid = \"s{k}\"\n"
        );
    }
    for k in 0..4 {
        let next = k + 1;
        shapes +=
            &format!("[[contact]]\nsolids = [\"s{k}\", \"s{next}\"]\nfriction = 0.0\nrestitution = 1.0\n");
    }
    scene + &shapes
}

/// Five solids hand the momentum on through four contacts of the coupler, whose springs give it back in some steps.
/// Bands: the last ball's height to 1 %, of which 0.3 % is measured; the others are pushed by the gaps, 0.0016 rad
/// each, until they touch, and swing by 0.016 rad.
#[test]
fn a_cradle_of_five_solids_swings_on_at_its_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cradle.toml");
    std::fs::write(&path, cradle_of_solids(2e-4)).expect("a scene");
    let run = scene_at(&path).in_process().run();
    let turned = most_turned(&run);
    println!("at most {turned:.4?} rad");
    assert!((turned[4] - 0.3).abs() < 0.003, "{turned:?}");
    assert!(turned[1..4].iter().all(|angle| *angle < 0.018), "{turned:?}");
}

/// A disc that rolls on the slab of another solid. Its points leave the slab with e² of the force with which they come
/// in: with e = 1 it keeps its energy, with e = 0 it is braked. Bands: what is measured, 0.155 and 1e-3.
#[test]
fn a_disc_that_rolls_on_another_solid_is_braked_by_restitution() {
    let lost = |restitution: &str| {
        let text = format!(
            "resolution = 0.01\nend_time = 0.6\n[[solid]]\nname = \"wheel\"\nmodel = \"rigid\"\ndensity = 2000.0\n\
             bodies = [{{ name = \"disc\", angular_velocity = -20.0 }}]\n\
             [[solid]]\nname = \"road\"\nmodel = \"rigid\"\ndensity = 2000.0\n\
             joints = [{{ name = \"held\", kind = \"fixed\", body = \"slab\" }}]\n\
             [[contact]]\nsolids = [\"wheel\", \"road\"]\nfriction = 0.5\nrestitution = {restitution}\n\
             [[shape]]\nname = \"disc\"\nphase = \"solid\"\nsolid = \"wheel\"\n\
             disc = {{ center = [0.0, 0.05], radius = 0.05 }}\nvelocity = [1.0, 0.0]\n\
             [[shape]]\nname = \"slab\"\nphase = \"solid\"\nsolid = \"road\"\n\
             box = {{ min = [-0.2, -0.05], max = [0.8, 0.0] }}\n\
             [[probe]]\nname = \"disc\"\nkind = \"body-energy\"\nbody = \"disc\"\nsolid = \"wheel\"\n"
        );
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("rolling.toml");
        std::fs::write(&path, text).expect("a scene");
        let energy = scene_at(&path).in_process().run().curve("disc.energy");
        1.0 - energy.at(0.6) / energy.at(0.0)
    };
    let [soft, whole] = ["0.0", "1.0"].map(lost);
    println!("e = 0: {soft:.4} lost, e = 1: {whole:.5}");
    assert!((soft - 0.155).abs() < 0.005, "{soft}");
    assert!(whole.abs() < 2e-3, "{whole}");
}
