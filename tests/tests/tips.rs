//! Solids that lie on tips: without friction they slide as on anything else.

use halfstep_tests::Written;

/// A plank on two posts, pulled along by 1 m/s². Its model, its own contact and the posts' are set by tests.
const PLANK: &str = r#"
resolution = 0.01
end_time = 0.3
gravity = [1.0, -9.81]

[[solid]]
name = "plank"
density = 1000.0
youngs_modulus = 1e7
poissons_ratio = 0.3
CONTACT

[[shape]]
name = "plank"
phase = "solid"
solid = "plank"
box = { min = [-0.4, 0.12], max = [0.4, 0.18] }

[[shape]]
name = "left"
POST
polygon = [[-0.26, 0.0], [-0.14, 0.0], [-0.2, 0.12]]

[[shape]]
name = "right"
POST
polygon = [[0.14, 0.0], [0.26, 0.0], [0.2, 0.12]]

[[probe]]
name = "plank"
kind = "body-velocity"
body = "plank"
solid = "plank"
"#;

const POSTS: &str = r#"
[[solid]]
name = "posts"
model = "rigid"
density = 1000.0
joints = [{ name = "left", body = "left", kind = "fixed" }, { name = "right", body = "right", kind = "fixed" }]

[[contact]]
solids = ["plank", "posts"]
stiffness = STIFFNESS
friction = FRICTION
"#;

/// Speed of the plank after 0.3 s, m/s.
fn speed(text: &str, model: &str) -> f64 {
    let rigid = text.replace("youngs_modulus = 1e7\npoissons_ratio = 0.3\n", "model = \"rigid\"\n");
    let scene = Written::new(if model == "rigid" { &rigid } else { text });
    let run = scene.run().set("solid.plank.model", model).in_process().run();
    run.curve("plank.x").at(0.3)
}

fn on_posts(stiffness: f64, friction: f64, model: &str) -> f64 {
    let posts = POSTS.replace("STIFFNESS", &stiffness.to_string());
    let posts = posts.replace("FRICTION", &friction.to_string());
    let text = PLANK.replace("CONTACT", &posts).replace("POST", "phase = \"solid\"\nsolid = \"posts\"");
    let speed = speed(&text, model);
    println!("{model}, K = {stiffness:e} Pa/m, mu = {friction}: {speed:.5} m/s");
    speed
}

/// The plank sinks by up to 8 mm on the posts, and deeper on the one that it moves toward: its tilt takes it along, by
/// up to 2.1 % with springs so soft, 0.6 % with ten times as stiff ones. A plank that strains hangs between the posts.
#[test]
fn a_plank_on_two_tips_slides_as_gravity_pulls_it() {
    for (stiffness, model, most) in [
        (1e7, "rigid", 1.02),
        (1e8, "rigid", 1.01),
        (1e7, "total-lagrangian", 1.03),
        (1e7, "finite-element", 1.03),
    ] {
        let part = on_posts(stiffness, 0.0, model) / 0.3;
        assert!((1.0..most).contains(&part), "{model}, {stiffness:e}: {part}");
    }
}

/// g t - mu g_y t, in the bands above.
#[test]
fn a_plank_on_two_tips_rubs_as_coulomb_says() {
    let right = 0.3 * (1.0 - 0.05 * 9.81);
    let part = on_posts(1e8, 0.05, "rigid") / right;
    assert!((0.99..1.02).contains(&part), "{part}");
}

/// Corners of walls carry a plank whose points are beside them.
#[test]
fn a_plank_on_two_tips_of_walls_slides_as_gravity_pulls_it() {
    let text = PLANK.replace("CONTACT", "contact = { friction = 0.0 }").replace("POST", "phase = \"wall\"");
    let part = speed(&text, "total-lagrangian") / 0.3;
    println!("{part}");
    assert!((1.0..1.03).contains(&part), "{part}");
}

/// A square turned by 30 degrees on its way down onto a slab that space holds: 10 J/m.
const SQUARE: &str = r#"
resolution = 0.01
end_time = 0.06
gravity = [0.0, 0.0]

[[solid]]
name = "slab"
model = "rigid"
density = 1000.0
joints = [{ name = "slab", body = "slab", kind = "fixed" }]

[[solid]]
name = "square"
model = "rigid"
density = 2000.0

[[contact]]
solids = ["slab", "square"]
restitution = 1.0
stiffness = 1e8

[[shape]]
name = "slab"
phase = "solid"
solid = "slab"
box = { min = [-0.3, -0.1], max = [0.3, 0.0] }

[[shape]]
name = "square"
phase = "solid"
solid = "square"
polygon = [[0.0, 0.002], [0.0866025, 0.052], [0.0366025, 0.1386025], [-0.05, 0.0886025]]
velocity = [0.0, -1.0]

[[probe]]
name = "square"
kind = "body-energy"
body = "square"
solid = "square"
"#;

/// It turns while it touches: a push that went with its angle gave 6 J/m. Measured: 0.01 and 0.02 J/m.
#[test]
fn a_square_on_its_corner_keeps_the_energy_of_an_elastic_impact() {
    let square = Written::new(SQUARE);
    for resolution in [0.01, 0.005] {
        let run = square.run().set("resolution", resolution).in_process().run();
        let energy = run.curve("square.energy");
        let (start, end) = (energy.at(0.0), energy.at(0.06));
        println!("{resolution} m: {start} J/m, {end} J/m, {:?}", run.report.contacts);
        assert!((end / start - 1.0).abs() < 0.005, "{resolution} m: {start} {end}");
        assert!(run.report.contacts[0].largest_force > 1e3, "{:?}", run.report.contacts);
    }
}
