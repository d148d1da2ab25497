//! Scenes that are valid and mean something else than they say, and what is remarked on each.

use super::remarks;
use halfstep_scene::parse;
use std::path::Path;

/// Water on a floor, and what a test adds.
fn scene(resolution: f64, rest: &str) -> Vec<String> {
    let text = format!(
        "resolution = {resolution}\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[solid]\ndensity = 1100.0\n\
         youngs_modulus = 12e6\npoissons_ratio = 0.4\n{rest}"
    );
    remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
}

pub(super) const TANK: &str = "[[shape]]\nname = \"tank\"\nphase = \"wall\"\ntank = { min = [0.0, 0.0], max = [0.4, 0.3], open = [\"top\"] }\n";
pub(super) const WATER: &str =
    "[[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.1, 0.1] }\n";
pub(super) const PLATE: &str = "[[shape]]\nname = \"plate\"\nphase = \"solid\"\nbox = { min = [0.2, 0.0], max = [0.22, 0.1] }\n\
                     clamp = { min = [0.2, 0.0], max = [0.22, 0.01] }\n";

pub(super) fn plain(parts: &[&str]) -> Vec<String> {
    scene(0.005, &parts.concat())
}

#[test]
fn a_scene_that_means_what_it_says_is_not_remarked_on() {
    assert_eq!(plain(&[TANK, WATER, PLATE]), [""; 0]);
}

#[test]
fn a_parameter_that_nothing_needs() {
    let text = "[parameters]\nwidth = 0.1\nH = 0.1\n";
    let water = WATER.replace("max = [0.1, 0.1]", "max = [0.1, \"=H\"]");
    assert_eq!(
        plain(&[text, TANK, &water, PLATE]),
        ["no key needs the parameter `width`: whatever its value, the scene is the same"]
    );
}

#[test]
fn every_shipped_scene_means_what_it_says() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut found = 0;
    for entry in std::fs::read_dir(scenes).expect("scenes") {
        let path = entry.expect("a scene").path();
        if path.extension().is_some_and(|e| e == "toml") {
            let scene = halfstep_scene::load(&path, &[]).expect("a right scene");
            let found_here = remarks(&scene);
            assert_eq!(found_here, [""; 0], "{}", path.display());
            found += 1;
        }
    }
    assert!(found >= 12, "{found}");
}

#[test]
fn a_plate_of_another_thickness() {
    // 5 mm at 1.4 mm are four rows: 5.6 mm, and (5.6 / 5)³ = 1.40. All else are multiples of 1.4 mm.
    let rest =
        [TANK, WATER].concat().replace("0.4, 0.3]", "0.42, 0.308]").replace("0.1, 0.1]", "0.098, 0.098]");
    let plate = PLATE.replace("0.22", "0.205").replace("0.1]", "0.098]").replace("0.01]", "0.0098]");
    assert_eq!(
        scene(0.0014, &format!("{rest}{plate}")),
        [
            "`plate` is 0.005 m wide in the scene and 0.0056 m as computed: 1.40 times the bending stiffness (its \
          spacing is 0.0014; `across` at the shape makes it fit)"
        ]
    );
    // With a spacing of its own it fits.
    let fitted =
        plate.replace("phase = \"solid\"", "phase = \"solid\"\nacross = 4").replace("0.0098]", "0.01]");
    assert_eq!(scene(0.0014, &format!("{rest}{fitted}")), [""; 0]);
}

#[test]
fn a_tank_of_another_width() {
    // 0.4 m at 0.03 m are 13 cells: 0.39 m.
    let plate = PLATE
        .replace("0.2,", "0.15,")
        .replace("0.22,", "0.24,")
        .replace("0.1]", "0.12]")
        .replace("0.01]", "0.03]");
    let found = scene(0.03, &[TANK, &WATER.replace("0.1, 0.1]", "0.12, 0.12]"), &plate].concat());
    assert!(found[0].starts_with("`tank` is 0.4 m wide in the scene and 0.39 m as computed"), "{found:?}");
}

#[test]
fn shapes_that_touch_are_bodies_of_their_own() {
    let above = PLATE.replace("\"plate\"", "\"block\"").replace("0.22", "0.3").replace("[0.2,", "[0.22,");
    let free = above.lines().filter(|line| !line.starts_with("clamp")).collect::<Vec<_>>().join("\n");
    let found = plain(&[TANK, WATER, PLATE, &free]);
    assert_eq!(
        found,
        [
            "`plate` and `block` touch and are bodies of their own, which repel each other and may part (the same \
          `body` at both makes them one piece)"
        ]
    );
    // Whoever names bodies knows.
    let named = free.replace("phase = \"solid\"", "phase = \"solid\"\nbody = \"plate\"");
    assert_eq!(plain(&[TANK, WATER, PLATE, &named]), [""; 0]);
}

#[test]
fn a_body_that_falls_through_a_wall() {
    let block = PLATE.lines().filter(|line| !line.starts_with("clamp")).collect::<Vec<_>>().join("\n") + "\n";
    // By default walls that stand still carry it.
    assert_eq!(plain(&[TANK, WATER, &block]), [""; 0]);
    let passing = TANK.replace("phase = \"wall\"", "phase = \"wall\"\ncontact = false");
    assert_eq!(
        plain(&[&passing, WATER, &block]),
        ["`plate` is held by no clamp, and `tank` does not stop it (contact is false): it goes through it"]
    );
    let off = plain(&[TANK, WATER, &block, "[effects]\nwall-contact = \"off\"\n"]);
    assert!(off[0].contains("effects.wall-contact is \"off\": no wall stops it"), "{off:?}");
}

#[test]
fn water_in_the_air_and_in_a_wall() {
    let high = WATER.replace("[0.0, 0.0], max = [0.1, 0.1]", "[0.0, 0.1], max = [0.1, 0.2]");
    assert_eq!(
        plain(&[TANK, &high, PLATE]),
        ["`water` hangs in the air: nothing is right below it, so it falls"]
    );
    // Carried by other water it does not.
    assert_eq!(plain(&[TANK, WATER, &high.replace("\"water\"", "\"more\""), PLATE]), [""; 0]);
    // Three of ten columns lie in the tank's wall, 15 mm thick.
    let beside = WATER.replace("[0.0, 0.0], max = [0.1, 0.1]", "[0.365, 0.0], max = [0.415, 0.1]");
    let found = plain(&[TANK, &beside, PLATE]);
    assert_eq!(
        found,
        ["`water` has 140 of its 200 particles: the others' places are taken by shapes that it overlaps"]
    );
}

#[test]
fn water_that_falls_too_fast_for_its_sound_speed() {
    // sqrt(2 g 0.1 m) = 1.40 m/s, and over 7 m/s Mach 0.2.
    let slow = [TANK, WATER, PLATE].concat();
    let text = format!(
        "resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\nsound_speed = 7.0\n[solid]\n\
                        density = 1100.0\nyoungs_modulus = 12e6\npoissons_ratio = 0.4\n{slow}"
    );
    let found = remarks(&parse(&text, Path::new("x.toml"), &[]).expect("a right scene"));
    assert_eq!(
        found,
        [
            "the fluid can come to 1.40 m/s, Mach 0.20: it is compressed by about 4 %; fluid.sound_speed = 15 keeps it \
          below 1 %"
        ]
    );
}

/// A belt at 0.5 m/s over a fluid of 5e-3 m²/s: nu U / dx = 0.25 m²/s², and 0.25 / 0.003 is 9.13² m²/s².
#[test]
fn viscous_stress_that_compresses_the_fluid() {
    let scene = |fluid: &str| {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, 0.0]\n[fluid]\ndensity = 1000.0\n{fluid}\n\
             {}[[shape]]\nname = \"belt\"\nphase = \"wall\"\nslip = \"none\"\nvelocity = [0.5, 0.0]\n\
             box = {{ min = [-0.1, 0.1], max = [0.2, 0.16] }}\n",
            [TANK, WATER].concat().replace("phase = \"wall\"", "phase = \"wall\"\nslip = \"none\"")
        );
        parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"))
    };
    let sound = |fluid: &str| scene(fluid).fluid.map(|fluid| fluid.sound_speed).expect("a fluid");
    assert!((sound("viscosity = 5.0") - (0.25_f64 / 0.003).sqrt()).abs() < 1e-9);
    assert!((sound("viscosity = 0.5") - 5.0).abs() < 1e-9, "ten times the belt's speed");
    let said = "viscous stress between neighbouring rows compresses the fluid: fluid.sound_speed = 5 m/s, and 9.1 \
                keeps that below 0.3 %; fluid may be pressed out of corners";
    assert!(remarks(&scene("viscosity = 5.0\nsound_speed = 5.0")).iter().any(|remark| remark == said));
    for fluid in ["viscosity = 5.0\nsound_speed = 7.0", "viscosity = 5.0", "viscosity = 0.5"] {
        assert!(!remarks(&scene(fluid)).iter().any(|remark| remark.contains("viscous stress")), "{fluid}");
    }
}

#[test]
fn units_that_are_hardly_meant() {
    let text = [TANK, WATER, PLATE].concat();
    let change = |from: &str, to: &str| {
        let head = "resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[solid]\ndensity = 1100.0\n\
                    youngs_modulus = 12e6\npoissons_ratio = 0.4\n";
        let scene = format!("{head}{text}").replace(from, to);
        remarks(&parse(&scene, Path::new("x.toml"), &[]).expect("a right scene"))
    };
    assert_eq!(change("12e6", "12.0"), ["solid.youngs_modulus = 12 Pa is very little: is the unit right?"]);
    assert_eq!(
        change("density = 1000.0", "density = 1.1"),
        ["fluid.density = 1.1 kg/m³ is very little: is the unit right?"]
    );
    assert_eq!(
        change("max = [0.4, 0.3]", "max = [2e3, 0.3]"),
        ["the largest shape is 2000 m long: lengths are in metres"]
    );
}

/// The plate's right face, 20 rows of 5 mm of which 18 are free: one column is a surface, two are twice its force.
#[test]
fn a_traction_on_several_rows() {
    let loaded = |from: f64| {
        let load = format!(
            "load = {{ within = {{ min = [{from}, 0.0], max = [0.22, 0.1] }}, traction = [-1000.0, 0.0] }}\n"
        );
        plain(&[TANK, WATER, &format!("{PLATE}{load}")])
    };
    assert_eq!(loaded(0.215), [""; 0]);
    assert_eq!(
        loaded(0.21),
        [
            "the traction on `plate` acts on one face of each of 36 particles in 2 rows: 1.800e2 N/m in all, 2 times \
             that on a surface (a box around one row loads a surface)"
        ]
    );
}

#[test]
fn settings_that_cannot_act() {
    let probe = |keys: &str| format!("[[probe]]\nname = \"p\"\n{keys}\n");
    let beach = |rate: f64| format!("[fluid.beach]\nfrom = 0.0\nto = 0.4\nrate = {rate}\n");
    let sine = |more: &str| {
        TANK.replace(
            "phase = \"wall\"",
            &format!("phase = \"wall\"\nmotion = {{ amplitude = [0.01, 0.0], period = 1.0, {more} }}"),
        )
    };
    let said = |parts: &[&str], text: &str| {
        let found = scene(0.005, &parts.concat());
        found.iter().any(|remark| remark.contains(text))
    };
    assert!(said(&[&sine("start = 2.0"), WATER, PLATE], "does not move until the run ends at 1 s"));
    assert!(said(&[&sine("ramp = 2.0"), WATER, PLATE], "reaches its amplitude at 2 s"));
    assert!(!said(&[&sine("ramp = 0.5"), WATER, PLATE], "the run ends"));
    for (x, beside) in [(0.05, false), (0.6, true)] {
        let level = probe(&format!("kind = \"water-level\"\nx = [{x}]"));
        assert_eq!(said(&[TANK, WATER, PLATE, &level], "`p` looks beside all shapes"), beside, "{x}");
        let speed = probe(&format!("kind = \"velocity\"\nat = [{x}, 0.05]"));
        assert_eq!(said(&[TANK, WATER, PLATE, &speed], "`p` looks beside all shapes"), beside, "{x}");
    }
    for (interval, none) in [(0.5, false), (2.0, true)] {
        let output = format!("[output]\ncheckpoint_interval = {interval}\n");
        assert_eq!(said(&[TANK, WATER, PLATE, &output], "makes no checkpoint"), none);
    }
    assert!(said(
        &[TANK, WATER, PLATE, "[effects]\nbeach = \"on\"\n"],
        "effects.beach is \"on\" and does nothing"
    ));
    // exp(-rate 0.4 m / (3 sqrt(9.81 0.1) m/s)) = exp(-0.1346 rate).
    for (rate, little) in [(0.5, true), (10.0, false)] {
        assert_eq!(said(&[&beach(rate), TANK, WATER, PLATE], "the beach leaves long waves 0.93"), little);
    }
}

#[test]
fn ballast_is_of_its_body() {
    let shape = |name: &str, more: &str, to: &str| {
        format!(
            "[[shape]]\nname = \"{name}\"\nphase = \"solid\"\n{more}box = {{ min = [0.0, 0.0], max = {to} }}\n"
        )
    };
    let barge = shape("barge", "", "[0.4, 0.2]");
    let ballast = shape("ballast", "body = \"barge\"\ndensity = 2000.0\n", "[0.4, 0.04]");
    let of = |shapes: [&String; 2]| {
        let text = format!(
            "resolution = 0.02\nend_time = 1.0\ngravity = [0.0, 0.0]\n[solid]\nmodel = \"rigid\"\n\
             density = 500.0\n{}{}",
            shapes[0], shapes[1]
        );
        remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
    };
    let late = of([&barge, &ballast]);
    assert!(late.len() == 1 && late[0].starts_with("`ballast` has none of its 40 particles"), "{late:?}");
    let first = of([&ballast, &barge]);
    assert!(!first.iter().any(|text| text.contains("none") || text.contains("apart")), "{first:?}");
}

/// A rigid block in a tank, held as `more` says.
fn hung(more: &str) -> halfstep_scene::Scene {
    let tank = TANK.replace("phase = \"wall\"", "phase = \"wall\"\ncontact = false");
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\n[solid]\nmodel = \"rigid\"\ndensity = 1000.0\n{more}\n{tank}\
         [[shape]]\nname = \"c\"\nphase = \"solid\"\nbox = {{ min = [0.1, 0.1], max = [0.2, 0.2] }}\n"
    );
    parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

#[test]
fn a_body_that_hangs_on_a_spring() {
    let spring = "joints = [{ name = \"s\", kind = \"spring\", body = \"c\", at = [0.15, 0.2], to = [0.15, 0.4], \
                  stiffness = 2000.0 }]";
    for (more, held) in [(spring, "a spring alone"), ("", "no clamp")] {
        let text = format!("`c` is held by {held}, and `tank` does not stop it");
        assert!(remarks(&hung(more)).iter().any(|remark| remark.starts_with(&text)), "{held}");
    }
}

#[test]
fn a_given_mass_is_shown() {
    let mass = |more: &str| {
        let scene = hung(more);
        super::placed(&scene, &halfstep_scene::geometry::layout::<2>(&scene))[1].to_string()
    };
    assert!(mass("").contains(", 10 kg/m"), "{}", mass(""));
    let given = mass("bodies = [{ name = \"c\", mass = 20.0 }]");
    assert!(given.contains(", 20 kg/m"), "{given}");
}

#[test]
fn a_frame_that_changes_nothing_or_leaves_much_out() {
    let seen = |motion: &str| plain(&[&format!("[frame]\nmotion = {motion}\n"), TANK, WATER, PLATE]);
    assert_eq!(seen("{ amplitude = [0.01, 0.0], period = 1.0, ramp = 0.5 }"), [""; 0]);
    let nothing = seen("{ velocity = [0.1, 0.0] }");
    assert!(nothing.iter().any(|remark| remark.contains("changes gravity at no time")), "{nothing:?}");
    // 0.1 rad/s over 0.5 m is nothing; 0.2 rad at 2 pi rad/s is 7.9 rad/s2, half of gravity.
    assert_eq!(seen("{ angular_velocity = 0.1, pivot = [0.0, 0.0] }"), [""; 0]);
    let much = seen("{ angle = 0.2, period = 1.0, ramp = 0.5, pivot = [0.0, 0.0] }");
    assert!(much.iter().any(|remark| remark.contains("Coriolis forces are left out")), "{much:?}");
}

/// An upright plate of 5 mm and a wedge of a mean 5 mm, both 0.1 m high, as polygons at 1.4 mm.
#[test]
fn the_bending_stiffness_of_polygons() {
    let shown = |corners: &str, more: &str| {
        let text = format!(
            "resolution = 0.0014\nend_time = 1.0\n[solid]\ndensity = 1100.0\nyoungs_modulus = 12e6\n\
             poissons_ratio = 0.4\n[[shape]]\nname = \"plate\"\nphase = \"solid\"\n{corners}\n{more}\n\
             clamp = {{ min = [-0.1, -0.1], max = [0.1, 0.01] }}\n"
        );
        let scene = parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
        let placed = super::placed(&scene, &halfstep_scene::geometry::layout::<2>(&scene))[0].to_string();
        (placed, remarks(&scene))
    };
    // E / (1 - nu²) t³ / 12 = 14.2857e6 Pa (5 mm)³ / 12, and that of 5.6 mm.
    let (plate, warned) = shown("polygon = [[0.0, 0.0], [0.005, 0.0], [0.005, 0.098], [0.0, 0.098]]", "");
    assert!(
        plate.contains("bending stiffness 0.1488 N m asked, 0.2091 computed,")
            || plate.ends_with("0.2091 computed"),
        "{plate}"
    );
    assert!(
        warned.iter().any(|text| text.contains("m² as computed: 1.40 times the bending stiffness")),
        "{warned:?}"
    );
    let (wedge, warned) = shown("polygon = [[0.0, 0.0], [0.0076, 0.0], [0.004, 0.1], [0.0, 0.1]]", "");
    assert!(wedge.contains("computed from its area"), "{wedge}");
    assert!(!warned.iter().any(|text| text.contains("bending stiffness")), "{warned:?}");
    // A lattice that lies across the plate changes its area, and its stiffness.
    let (turned, _) = shown("box = { min = [0.0, 0.0], max = [0.0056, 0.098] }", "lattice_angle = 45");
    assert!(turned.contains("m² asked,") && turned.contains("bending stiffness"), "{turned}");
}
