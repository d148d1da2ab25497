//! Probes of one body, by hand.

use halfstep_tests::Curve;
use halfstep_tests::run::{Finished, scene_at};

const G: f64 = 9.81;

fn run(text: &str) -> Finished {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).expect("a scene");
    scene_at(&path).in_process().run()
}

fn near(what: &str, found: f64, right: f64, part: f64) {
    println!("{what}: {found:.6} of {right:.6}");
    assert!((found - right).abs() <= part * right.abs(), "{what}: {found}, not {right}");
}

/// `[[probe]]` of a body's, named after what it measures.
fn probes(body: &str, kinds: &[&str]) -> String {
    let of =
        |kind: &&str| format!("[[probe]]\nname = \"{kind}\"\nkind = \"body-{kind}\"\nbody = \"{body}\"\n");
    kinds.iter().map(of).collect()
}

/// A box of 10 kg/m, I = 10 (0.2² + 0.1²) / 12 kg m, thrown with 2 m/s and 3 rad/s, without gravity.
#[test]
fn a_thrown_box_keeps_its_rate_and_energy() {
    let text = "resolution = 0.01\nend_time = 0.3\ngravity = [0.0, 0.0]\n[solid]\nmodel = \"rigid\"\ndensity = 500.0\n\
                bodies = [{ name = \"box\", angular_velocity = 3.0 }]\n[[shape]]\nname = \"box\"\nphase = \"solid\"\n\
                box = { min = [0.0, 0.0], max = [0.2, 0.1] }\nvelocity = [2.0, 0.0]\n";
    let run = run(&(text.to_owned() + &probes("box", &["angular-velocity", "energy"])));
    for time in [0.0, 0.3] {
        near("rate", run.curve("angular-velocity.rate").at(time), 3.0, 1e-12);
        near("energy", run.curve("energy.energy").at(time), 20.0 + 0.5 * 10.0 * 0.05 / 12.0 * 9.0, 1e-12);
    }
}

/// A disc of 0.1 m on a slope of 0.2 rad rolls: what holds its foot, m g sin / (1 + m r² / I), turns it, and half of m
/// r² is its I. The normal force goes through the centre.
#[test]
fn a_rolling_disc_is_turned_by_friction_at_its_foot() {
    let gravity = [G * f64::sin(0.2), -G * f64::cos(0.2)];
    let text = format!(
        "resolution = 0.005\nend_time = 0.4\ngravity = {gravity:?}\n[solid]\nmodel = \"rigid\"\ndensity = 500.0\n\
         contact = {{ friction = 0.5 }}\n[[shape]]\nname = \"disc\"\nphase = \"solid\"\n\
         disc = {{ center = [0.0, 0.1], radius = 0.1 }}\n[[shape]]\nname = \"slope\"\nphase = \"wall\"\n\
         box = {{ min = [-0.2, -0.05], max = [1.0, 0.0] }}\n"
    );
    let kinds = ["contact-force", "contact-moment", "angular-velocity", "energy", "velocity"];
    let run = run(&(text + &probes("disc", &kinds)));
    let at = |column: &str| run.curve(column).at(0.3);
    // The mass of its particles, from the normal force; 0.3 % less than that of the disc.
    let mass = at("contact-force.y") / -gravity[1];
    near("mass", mass, 500.0 * std::f64::consts::PI * 0.01, 0.01);
    near("friction", at("contact-force.x"), -mass * gravity[0] / 3.0, 0.01);
    near("moment", at("contact-moment.moment"), 0.1 * at("contact-force.x"), 1e-9);
    let speed = at("velocity.x");
    near("speed", speed, gravity[0] / 1.5 * 0.3, 0.01);
    near("rate", at("angular-velocity.rate"), -speed / 0.1, 1e-6);
    near("energy", at("energy.energy"), 0.75 * mass * speed * speed, 0.01);
}

/// Water 0.2 m deep before a wall 0.3 m high that is held: rho g h² / 2 at a third of the depth, about the middle.
#[test]
fn still_water_turns_a_wall_by_its_depth() {
    let text = "resolution = 0.01\nend_time = 0.4\n[fluid]\ndensity = 1000.0\n[solid]\nmodel = \"rigid\"\n\
                density = 2000.0\njoints = [{ name = \"held\", kind = \"fixed\", body = \"wall\" }]\n\
                [[shape]]\nname = \"wall\"\nphase = \"solid\"\nbox = { min = [0.2, 0.0], max = [0.26, 0.3] }\n\
                [[shape]]\nname = \"tank\"\nphase = \"wall\"\ntank = { min = [0.0, 0.0], max = [0.4, 0.4], open = [\"top\"] }\n\
                [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.2, 0.2] }\n\
                pressure = \"hydrostatic\"\n";
    let run = run(&(text.to_owned() + &probes("wall", &["force", "moment", "energy"])));
    let mean = |column: &str| run.curve(column).between(0.2, 0.4).mean();
    let force = 0.5 * 1000.0 * G * 0.04;
    near("force", mean("force.x"), force, 0.03);
    near("moment", mean("moment.moment"), force * (0.15 - 0.2 / 3.0), 0.05);
    assert_eq!(run.curve("energy.energy").at(0.4), 0.0, "it is held");
}

const MODELS: [&str; 3] = ["total-lagrangian", "finite-element", "hypoelastic"];

fn elastic(model: &str, shapes: &str, probes: &str) -> Finished {
    run(&format!(
        "resolution = 0.01\nend_time = 0.02\ngravity = [0.0, 0.0]\n[solid]\nmodel = \"{model}\"\ndensity = 1000.0\n\
         youngs_modulus = 1e6\npoissons_ratio = 0.3\n{shapes}{probes}"
    ))
}

/// Two bodies of one solid, of 10 and 20 kg/m, that fly with 1 and 2 m/s: each has its own m v² / 2.
#[test]
fn bodies_of_one_solid_have_energies_of_their_own() {
    let body = |name: &str, low: f64, width: f64, speed: f64| {
        format!(
            "[[shape]]\nname = \"{name}\"\nphase = \"solid\"\nbox = {{ min = [0.0, {low}], max = [{width}, {}] }}\n\
             velocity = [{speed}, 0.0]\n",
            low + 0.1
        )
    };
    let shapes = body("slow", 0.0, 0.1, 1.0) + &body("fast", 0.5, 0.2, 2.0);
    let of =
        |name: &str| format!("[[probe]]\nname = \"{name}\"\nkind = \"body-energy\"\nbody = \"{name}\"\n");
    for model in MODELS {
        let run = elastic(model, &shapes, &(of("slow") + &of("fast")));
        near(&format!("{model}, slow"), run.curve("slow.energy").at(0.02), 5.0, 1e-9);
        near(&format!("{model}, fast"), run.curve("fast.energy").at(0.02), 40.0, 1e-9);
    }
}

/// A plate that swings: its body's energy is what the solid's two probes hold together, and goes from one to the other.
#[test]
fn a_bent_body_holds_strain_energy() {
    let plate = "[[shape]]\nname = \"plate\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.2, 0.04] }\n\
                 clamp = { min = [0.0, 0.0], max = [0.03, 0.04] }\n\
                 cantilever_mode = { fraction = 0.02, root = 0.03, length = 0.17 }\n";
    let more = "[[probe]]\nname = \"kinetic\"\nkind = \"kinetic-energy\"\nphase = \"solid\"\n\
                [[probe]]\nname = \"strain\"\nkind = \"strain-energy\"\n";
    for model in MODELS {
        let run = elastic(model, plate, &(probes("plate", &["energy"]) + more));
        let [kinetic, strain] = ["kinetic.energy", "strain.energy"].map(|name| run.curve(name).at(0.02));
        near(model, run.curve("energy.energy").at(0.02), kinetic + strain, 1e-9);
        let start = run.curve("energy.energy").at(0.0);
        println!("{model}: {start:e} J/m at first, then kinetic {kinetic:e}, strain {strain:e}");
        assert!(strain > 0.05 * start && kinetic + strain < 1.01 * start, "{model}");
    }
}

/// A probe of a body, named after both.
fn of_body(kind: &str, body: &str, solid: &str) -> String {
    format!(
        "[[probe]]\nname = \"{body}-{kind}\"\nkind = \"body-{kind}\"\nbody = \"{body}\"\nsolid = \"{solid}\"\n"
    )
}

/// A block of 10 kg/m on the slab of another solid, 50 mm beside its middle: the coupler evaluates their contact, and
/// sends it together with the fluid's forces, of which there are none.
#[test]
fn contact_with_another_solid_is_parted_from_the_fluids_force() {
    let of_fluid = ["force", "moment"];
    let all = |body: &str, solid: &str| -> String {
        let kinds = of_fluid.into_iter().chain(["contact-force", "contact-moment"]);
        kinds.map(|kind| of_body(kind, body, solid)).collect()
    };
    for model in ["rigid"].into_iter().chain(MODELS) {
        let (upper, lower, clamp) = match model {
            "rigid" => ("", "joints = [{ name = \"held\", kind = \"fixed\", body = \"slab\" }]\n", ""),
            _ => {
                let material = "youngs_modulus = 1e6\npoissons_ratio = 0.3\n";
                (material, material, "clamp = { min = [0.0, -0.1], max = [0.4, -0.05] }\n")
            }
        };
        let text = format!(
            "resolution = 0.01\nend_time = 0.4\n[[solid]]\nname = \"upper\"\nmodel = \"{model}\"\ndensity = 500.0\n{upper}\
             [[solid]]\nname = \"lower\"\nmodel = \"{model}\"\ndensity = 500.0\n{lower}\
             [[contact]]\nsolids = [\"upper\", \"lower\"]\nstiffness = 1e7\n\
             [[shape]]\nname = \"block\"\nphase = \"solid\"\nsolid = \"upper\"\n\
             box = {{ min = [0.15, 0.0], max = [0.35, 0.1] }}\n\
             [[shape]]\nname = \"slab\"\nphase = \"solid\"\nsolid = \"lower\"\n\
             box = {{ min = [0.0, -0.1], max = [0.4, 0.0] }}\n{clamp}{}{}",
            all("block", "upper"),
            all("slab", "lower")
        );
        let run = run(&text);
        let mean = |column: &str| run.curve(column).between(0.2, 0.4).mean();
        let near = |what: &str, found: f64, right: f64| near(&format!("{model}, {what}"), found, right, 0.02);
        near("on the block", mean("block-contact-force.y"), 10.0 * G);
        near("on the slab", mean("slab-contact-force.y"), -10.0 * G);
        near("about the slab's middle", mean("slab-contact-moment.moment"), -10.0 * G * 0.05);
        let level = mean("block-contact-moment.moment");
        assert!(level.abs() < 0.01 * G, "{model}: {level} N about the block's middle");
        let columns = ["block-force.y", "slab-force.y", "block-moment.moment", "slab-moment.moment"];
        for column in columns {
            let (_, largest) = run.curve(column).peak();
            assert!(largest.abs() < 1e-9, "{model}, {column}: {largest}");
        }
    }
}

/// Where forces of a step count: those of its two ends by half each, as in velocity Verlet, or those at its end, where
/// a probe has the force of the half-step.
enum Rule {
    Trapezoid,
    Last,
}

impl Rule {
    fn integral(&self, curve: &Curve) -> f64 {
        let force = |k: usize| match self {
            Self::Trapezoid => 0.5 * (curve.values[k - 1] + curve.values[k]),
            Self::Last => curve.values[k],
        };
        (1..curve.times.len()).map(|k| force(k) * (curve.times[k] - curve.times[k - 1])).sum()
    }
}

/// What walls and other bodies of a solid that strains do is evaluated by its model, or by the coupler where the solid
/// says `contact`. A block of 10 kg/m falls by 10 mm on a floor, and another one on that: with a row for each step,
/// momentum is what weight and contact gave, to the last digits.
#[test]
fn contact_within_a_solid_that_strains_gives_its_bodies_their_momentum() {
    const UNTIL: f64 = 0.06;
    let contact = "contact = { restitution = 0.5 }\n";
    for (model, contact, rule) in [
        ("total-lagrangian", "", Rule::Trapezoid),
        ("finite-element", "", Rule::Trapezoid),
        ("hypoelastic", "", Rule::Last),
        ("total-lagrangian", contact, Rule::Last),
        ("finite-element", contact, Rule::Last),
    ] {
        let body = |name: &str, low: f64| {
            let high = low + 0.1;
            format!(
                "[[shape]]\nname = \"{name}\"\nphase = \"solid\"\nbox = {{ min = [0.0, {low}], max = [0.2, {high}] }}\n"
            )
        };
        // Bodies of one hypoelastic solid act on each other as material: one of them is enough.
        let names: &[&str] = if model == "hypoelastic" { &["lower"] } else { &["lower", "upper"] };
        let more: String = names
            .iter()
            .zip([0.0, 0.105])
            .map(|(name, low)| {
                body(name, low)
                    + &["contact-force", "velocity"].map(|kind| of_body(kind, name, "solid")).concat()
            })
            .collect();
        let run = run(&format!(
            "resolution = 0.01\nend_time = {UNTIL}\noutput.probe_interval = 1e-5\n[solid]\nmodel = \"{model}\"\n\
             density = 500.0\nyoungs_modulus = 1e5\npoissons_ratio = 0.3\n{contact}\
             [[shape]]\nname = \"floor\"\nphase = \"wall\"\ncontact = true\n\
             box = {{ min = [-0.1, -0.1], max = [0.3, -0.01] }}\n{more}"
        ));
        for name in names {
            let given = rule.integral(&run.curve(&format!("{name}-contact-force.y")));
            let gained = 10.0 * run.curve(&format!("{name}-velocity.y")).at(UNTIL);
            assert!(given > 1.0, "{model}, {name}: they met");
            near(&format!("{model} {contact}, {name}"), given, gained + 10.0 * G * UNTIL, 1e-9);
        }
    }
}
