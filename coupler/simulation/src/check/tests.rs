//! What `halfstep check` says of scenes by hand.

use super::{Check, check, duration};
use halfstep_sph::lane::Isa;
use std::path::Path;

/// A rigid block of 1000 kg/m³, 0.2 x 0.1 m, of the solid `block` on a longer one of the solid `base`.
fn two_blocks(more: &str) -> Check {
    let text = format!(
        "resolution = 0.02\nend_time = 0.5\ngravity = [0.0, -9.81]\n{more}\
         [[solid]]\nname = \"block\"\nmodel = \"rigid\"\ndensity = 1000.0\n\
         [[solid]]\nname = \"base\"\nmodel = \"rigid\"\ndensity = 2000.0\n\
         [[shape]]\nname = \"b\"\nphase = \"solid\"\nsolid = \"block\"\n\
         box = {{ min = [0.1, 0.0], max = [0.3, 0.1] }}\n\
         [[shape]]\nname = \"f\"\nphase = \"solid\"\nsolid = \"base\"\n\
         box = {{ min = [0.0, -0.1], max = [0.6, 0.0] }}\nmotion = {{ velocity = [0.1, 0.0] }}\n"
    );
    let scene = halfstep_scene::parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    check(&scene, Isa::detect()).expect("in the plane")
}

fn pair(keys: &str) -> Check {
    two_blocks(&format!("[[contact]]\nsolids = [\"block\", \"base\"]\n{keys}\n"))
}

#[test]
fn solids_touch_or_pass_through_each_other() {
    let touching = pair("friction = 0.2").to_string();
    assert!(touching.contains("between solids  block and base touch\n"), "{touching}");
    assert!(!touching.contains("pass through") && !touching.contains("no coupler"), "{touching}");
    let apart = pair("touch = false").to_string();
    assert!(apart.contains("block and base pass through each other where they meet\n"), "{apart}");
}

#[test]
fn contact_limits_the_step() {
    let soft = pair("stiffness = 1e8");
    let stiff = pair("stiffness = 1e12");
    let [a, b] = [&soft, &stiff].map(|check| check.contact_dt_limit.expect("they touch"));
    // As the root of the stiffness.
    assert!((a / b / 100.0 - 1.0).abs() < 1e-9, "{a} {b}");
    assert_eq!([soft.time_step, stiff.time_step], [a, b]);
    assert_eq!(pair("touch = false").contact_dt_limit, None);
}

#[test]
fn a_contact_that_a_weight_presses_through() {
    // rho g h = 981 Pa on a side of 0.1 m.
    let said = |stiffness: &str| {
        let found = pair(&format!("stiffness = {stiffness}")).warnings;
        found.into_iter().filter(|text| text.contains("is soft")).collect::<Vec<_>>()
    };
    assert_eq!(said("1e5"), [""; 0]);
    let soft = said("1.0");
    assert!(
        soft.len() == 1 && soft[0].contains("the weight of `b` presses it 9.81e2 m into what it lies on"),
        "{soft:?}"
    );
}

#[test]
fn a_fixed_step_above_a_limit() {
    let found = |step: &str| two_blocks(&format!("time_step = {step}\n")).warnings;
    let limit = two_blocks("").time_step;
    let above = found(&format!("{}", 2.0 * limit));
    let said = |text: &String| text.contains("above the") && text.contains("2.00 times");
    assert!(above.iter().any(said), "{above:?}");
    let within = found(&format!("{}", 0.5 * limit));
    assert!(!within.iter().any(|text| text.contains("stability limit")), "{within:?}");
}

#[test]
fn a_time_has_a_unit_that_suits_it() {
    assert_eq!(
        [2.4, 599.0, 900.0, 306_695.0, 2e6].map(duration),
        ["2.4 s", "599 s", "15 min", "85 h", "23 days"]
    );
    let said = two_blocks("").to_string();
    assert!(said.contains(" steps, one thread a role ("), "{said}");
}

#[test]
fn loads_and_probes_are_listed_as_they_begin() {
    let text = "resolution = 0.01\nend_time = 0.5\n[output]\nprobe_interval = 0.01\n[fluid]\ndensity = 1000.0\n\
        [solid]\ndensity = 1100.0\nyoungs_modulus = 12e6\npoissons_ratio = 0.4\n\
        [[shape]]\nname = \"tank\"\nphase = \"wall\"\ntank = { min = [0.0, 0.0], max = [0.4, 0.3], open = [\"top\"] }\n\
        [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.1, 0.1] }\n\
        [[shape]]\nname = \"plate\"\nphase = \"solid\"\nbox = { min = [0.2, 0.0], max = [0.24, 0.1] }\n\
        clamp = { min = [0.2, 0.0], max = [0.24, 0.02] }\n\
        load = { within = { min = [0.19, 0.08], max = [0.21, 0.11] }, traction = [50.0, 0.0], ramp = 0.1 }\n";
    let probes = [
        (
            "tip",
            "kind = \"displacement\"\nat = [0.22, 0.1]",
            "displacement of plate at [0.22, 0.1]; begins in it",
        ),
        ("root", "kind = \"stress\"\nat = [0.22, 0.0]", "stress of plate at [0.22, 0]; begins in it"),
        (
            "held",
            "kind = \"position\"\nat = [0.22, 0.0]",
            "position of plate at [0.22, 0]; begins in a clamp",
        ),
        ("wet", "kind = \"pressure\"\nat = [0.05, 0.0]", "pressure at [0.05, 0]; begins in fluid"),
        ("dry", "kind = \"velocity\"\nat = [0.3, 0.1]", "velocity at [0.3, 0.1]; begins dry"),
        (
            "gauges",
            "kind = \"water-level\"\nx = [0.05, 0.3]",
            "water-level at x = 0.05, 0.3 m; begins at 0.1 m, dry",
        ),
        (
            "section",
            "kind = \"flux\"\nfrom = [0.05, 0.0]\nto = [0.05, 0.2]",
            "flux from [0.05, 0] to [0.05, 0.2], positive toward [1, 0]; begins with 50 % in fluid",
        ),
        (
            "push",
            "kind = \"force\"\nshape = \"plate\"\nwithin = { min = [0.2, 0.0], max = [0.21, 0.1] }",
            "force of plate within [0.2, 0] to [0.21, 0.1]; begins with 10 particles",
        ),
        ("reach", "kind = \"front\"", "front along +x; begins at 0.1 m"),
        ("stored", "kind = \"strain-energy\"", "strain-energy of solid"),
    ];
    let of_probe = |(name, keys, _): &(&str, &str, &str)| format!("[[probe]]\nname = \"{name}\"\n{keys}\n");
    let text = text.to_owned() + &probes.iter().map(of_probe).collect::<String>();
    let scene = halfstep_scene::parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let found = check(&scene, Isa::detect()).expect("in the plane");
    let said = found.to_string();
    assert!(
        said.contains(
            "loads           1\n  plate         traction [50, 0] Pa on 2 particles in [0.19, 0.08] to [0.21, 0.11], \
             grows for 0.1 s\nprobes          10, a row each 0.01 s\n"
        ),
        "{said}"
    );
    for (name, _, line) in probes {
        assert!(said.contains(&format!("  {name:<13} {line}\n")), "{name}: {said}");
    }
    let json = serde_json::to_value(&found).expect("JSON");
    assert_eq!(json["probes"][3]["begins"], "in fluid");
    assert_eq!(json["loads"][0]["particles"], 2);
}

#[test]
fn bodies_and_joints_are_listed_as_they_begin() {
    let text = "resolution = 0.01\nend_time = 0.5\n[fluid]\ndensity = 1000.0\n[solid]\nmodel = \"rigid\"\ndensity = 500.0\n\
        [[solid.bodies]]\nname = \"box\"\nmass = 6.0\n\
        [[solid.joints]]\nname = \"pin\"\nkind = \"hinge\"\nbody = \"flap\"\nwith = \"tank\"\nat = [0.1, 0.0]\n\
        stiffness = 4.0\nrest = 0.5\nlimits = [-0.7853981633974483, 0.0]\n\
        [[solid.joints]]\nname = \"line\"\nkind = \"spring\"\nbody = \"box\"\nat = [0.3, 0.1]\nto = [0.3, 0.0]\n\
        stiffness = 20.0\nrest = 0.15\n\
        [[shape]]\nname = \"tank\"\nphase = \"wall\"\ntank = { min = [0.0, 0.0], max = [0.5, 0.3], open = [\"top\"] }\n\
        [[shape]]\nname = \"flap\"\nphase = \"solid\"\nbox = { min = [0.09, 0.0], max = [0.11, 0.2] }\n\
        [[shape]]\nname = \"box\"\nphase = \"solid\"\nbox = { min = [0.25, 0.1], max = [0.35, 0.2] }\n\
        [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.5, 0.15] }\n";
    let scene = halfstep_scene::parse(text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    let found = check(&scene, Isa::detect()).expect("in the plane");
    let said = found.to_string();
    // 0.02 x 0.2 m of 500 kg/m3: 2 kg/m, 2 (0.02² + 0.2²) / 12; 0.1 x 0.1 m of 6 kg/m: 6 (0.1² + 0.1²) / 12.
    for line in [
        "  flap          rigid, 2 kg/m with its centre at [0.1, 0.1], inertia 0.006733 kg m\n",
        "  box           rigid, 6 kg/m with its centre at [0.3, 0.15], inertia 0.01 kg m (mass as the scene says)\n",
        "joints          2\n  pin           hinge of flap to tank, turns about [0.1, 0], counter-clockwise positive, \
         stops at -0.7854 rad (-45 degrees) and 0 rad (0 degrees); begins with a moment of 2 N m/m\n",
        "  line          spring of box to space from [0.3, 0.1] to [0.3, 0], 0.1 m long, rests at 0.15 m and pushes \
         where it is shorter; begins pushing with 1 N/m\n",
    ] {
        assert!(said.contains(line), "{line}: {said}");
    }
    let json = serde_json::to_value(&found).expect("JSON");
    assert_eq!(
        (&json["joints"][0]["kind"], &json["rigid_bodies"][1]["mass"]),
        (&"hinge".into(), &6.0.into())
    );
}

/// A bar on two hinges that begins to turn about the first of them: the second is 0.2 m away and does not move.
#[test]
fn velocities_that_a_joint_takes_are_told_before_a_run() {
    let text = "resolution = 0.01\nend_time = 0.5\n[solid]\nmodel = \"rigid\"\ndensity = 500.0\n\
        [[solid.bodies]]\nname = \"bar\"\nangular_velocity = 0.3\n\
        [[solid.joints]]\nname = \"near\"\nkind = \"hinge\"\nbody = \"bar\"\nat = [0.0, 0.05]\n\
        [[solid.joints]]\nname = \"far\"\nkind = \"hinge\"\nbody = \"bar\"\nat = [0.2, 0.05]\n\
        [[shape]]\nname = \"bar\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.2, 0.1] }\n";
    let told = |text: &str| {
        let scene = halfstep_scene::parse(text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let warnings = check(&scene, Isa::detect()).expect("in the plane").warnings;
        warnings.into_iter().filter(|told| told.contains("begin with velocities")).collect::<Vec<_>>()
    };
    let jerked = told(text);
    let far = "the ends of the joint `far` of the solid begin with velocities that differ by 6.00e-2 m/s";
    assert!(jerked.len() == 1 && jerked[0].starts_with(far), "{jerked:?}");
    assert_eq!(told(&text.replace("0.3\n", "0.0\n")), <[String; 0]>::default());
}
