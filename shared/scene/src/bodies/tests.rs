use crate::{Scene, parse};
use std::path::Path;

/// A floor and solids `s0`, `s1`, ... at 1 cm: TL has h = 0.75 dx, so particles 1.5 dx apart are one continuum.
fn scene(model: &str, shapes: &[&str]) -> Scene {
    let head = format!(
        "resolution = 0.01\nend_time = 1.0\n[solid]\nmodel = \"{model}\"\ndensity = 1000.0\nyoungs_modulus = 1e6\n\
         poissons_ratio = 0.3\n[[shape]]\nname = \"floor\"\nphase = \"wall\"\n\
         box = {{ min = [0.0, -0.1], max = [1.0, 0.0] }}\n"
    );
    let shape =
        |(k, text): (usize, &&str)| format!("[[shape]]\nname = \"s{k}\"\nphase = \"solid\"\n{text}\n");
    let text: String = shapes.iter().enumerate().map(shape).collect();
    parse(&format!("{head}{text}"), Path::new("x.toml"), &[]).expect("a right scene")
}

fn bodies(model: &str, shapes: &[&str]) -> Vec<Vec<usize>> {
    scene(model, shapes).bodies().into_iter().map(|body| body.shapes).collect()
}

const LEFT: &str = "box = { min = [0.0, 0.0], max = [0.1, 0.1] }";
const BESIDE: &str = "box = { min = [0.1, 0.0], max = [0.2, 0.1] }";
const FAR: &str = "box = { min = [0.12, 0.0], max = [0.2, 0.1] }";
const ONE: &str = "\nbody = \"one\"";
const HELD: &str = "\nclamp = { min = [0.1, 0.0], max = [0.2, 0.02] }";

#[test]
fn shapes_that_touch_are_one_piece_where_they_name_one_body() {
    let tl = |shapes: &[&str]| bodies("total-lagrangian", shapes);
    assert_eq!(tl(&[LEFT, BESIDE]), [vec![1], vec![2]]);
    assert_eq!(tl(&[&(LEFT.to_owned() + ONE), &(BESIDE.to_owned() + ONE)]), [vec![1, 2]]);
    // What does not touch is no piece, whatever it is called.
    assert_eq!(tl(&[&(LEFT.to_owned() + ONE), &(FAR.to_owned() + ONE)]), [vec![1], vec![2]]);
    // A hypoelastic solid is one continuum; with h = 1.33 dx also across a gap of 1 dx.
    assert_eq!(bodies("hypoelastic", &[LEFT, BESIDE]), [vec![1, 2]]);
    assert_eq!(bodies("hypoelastic", &[LEFT, FAR]), [vec![1], vec![2]]);
}

#[test]
fn each_copy_is_a_body_unless_it_names_one() {
    let row = format!("{LEFT}\nrepeat = {{ count = 3, step = [0.1, 0.0] }}");
    assert_eq!(bodies("total-lagrangian", &[&row]), [vec![1], vec![1], vec![1]]);
    let named = scene("total-lagrangian", &[&(row + ONE)]).bodies();
    assert_eq!((named.len(), named[0].particles), (1, 300));
}

#[test]
fn a_shape_that_a_void_cuts_is_two_bodies() {
    let cut = "box = { min = [0.0, 0.0], max = [0.3, 0.1] }\n[[shape]]\nname = \"gap\"\nphase = \"void\"\n\
               box = { min = [0.1, -1.0], max = [0.13, 1.0] }";
    let uncut = scene("total-lagrangian", &[cut]).bodies();
    assert_eq!((uncut.len(), uncut[0].particles), (1, 300), "a void after the shape takes nothing from it");
    let gap = "[[shape]]\nname = \"gap\"\nphase = \"void\"\nbox = { min = [0.1, -1.0], max = [0.13, 1.0] }\n";
    let text = "resolution = 0.01\nend_time = 1.0\n[solid]\ndensity = 1000.0\nyoungs_modulus = 1e6\n\
                poissons_ratio = 0.3\n[[shape]]\nname = \"bar\"\nphase = \"solid\"\n\
                box = { min = [0.0, 0.0], max = [0.3, 0.1] }\nclamp = { min = [0.0, 0.0], max = [0.01, 0.1] }\n";
    let text = text.replace("[[shape]]\nname = \"bar\"", &format!("{gap}[[shape]]\nname = \"bar\""));
    let bodies = parse(&text, Path::new("x.toml"), &[]).expect("a right scene").bodies();
    let counts: Vec<_> = bodies.iter().map(|body| (body.particles, body.clamped)).collect();
    assert_eq!(counts, [(100, 10), (170, 0)]);
}

/// Two rigid shapes far apart, the second with what is added, and what stands before `[[shape]]`.
fn two_rigid(more: &str, keys: &str) -> Scene {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\n[solid]\nmodel = \"rigid\"\ndensity = 1000.0\n{keys}\n[[shape]]\n\
         name = \"floor\"\nphase = \"wall\"\nbox = {{ min = [-1.0, -0.1], max = [2.0, 0.0] }}\n[[shape]]\n\
         name = \"a\"\nphase = \"solid\"\nbox = {{ min = [0.0, 0.1], max = [0.1, 0.2] }}\n[[shape]]\nname = \"b\"\n\
         phase = \"solid\"\nbox = {{ min = [0.5, 0.1], max = [0.6, 0.2] }}\n{more}"
    );
    parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

#[test]
fn a_shape_whose_name_is_anothers_body_is_of_that_body() {
    assert_eq!(two_rigid("", "").bodies().len(), 2);
    let joined = two_rigid("body = \"a\"\n", "");
    assert_eq!(joined.bodies().len(), 1);
    assert_eq!(joined.bodies()[0].particles, 200);
    // Of another name it is none.
    assert_eq!(two_rigid("body = \"c\"\n", "").bodies().len(), 2);
}

#[test]
fn what_bodies_hold_of_each_other_holds_none_of_them() {
    let contact = |joints: &str| two_rigid("", joints).shapes[0].contact;
    let hinge = |body: &str, with: &str| {
        format!(
            "[[solid.joints]]\nname = \"of-{body}\"\nkind = \"hinge\"\nbody = \"{body}\"\n{with}at = [0.3, 0.15]\n"
        )
    };
    let (raft, anchor) = (hinge("a", "with = \"b\"\n"), hinge("b", ""));
    assert!(contact(&raft), "a raft of two falls");
    assert!(!contact(&(raft.clone() + &anchor)), "one that is moored does not, through the other one");
    assert!(contact(&anchor), "one of two is free");
}

#[test]
fn walls_can_be_touched_where_a_body_is_free() {
    let contact = |shapes: &[&str]| scene("total-lagrangian", shapes).shapes[0].contact;
    let held = BESIDE.to_owned() + HELD;
    assert!(contact(&[LEFT]));
    assert!(contact(&[LEFT, &held]), "one of the two is free");
    assert!(!contact(&[&held]));
    let (one, other) = (LEFT.to_owned() + ONE, held + ONE);
    assert!(!contact(&[&one, &other]), "one piece, and it is held");
}

#[test]
fn the_lightest_density_knows_given_masses_and_shapes() {
    let density = |shapes: &str, bodies: &str| {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\n[solid]\nmodel = \"rigid\"\ndensity = 1000.0\n{bodies}\n{shapes}"
        );
        parse(&text, Path::new("x.toml"), &[]).expect("a right scene").lightest_density(0)
    };
    let block = "[[shape]]\nname = \"s\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.2, 0.1] }\n";
    assert_eq!(density(block, ""), 1000.0);
    assert_eq!(density(&format!("{block}density = 300.0\n"), ""), 300.0);
    // 0.02 m² of it.
    let light = density(block, "bodies = [{ name = \"s\", mass = 1.0 }]");
    assert!((light - 50.0).abs() < 1e-9, "{light}");
    assert_eq!(density(block, "bodies = [{ name = \"s\", mass = 100.0 }]"), 1000.0);
}

/// Whether waves carry a body of a scene of water and these shapes of a solid.
fn carried(model: &str, shapes: &str, more: &str) -> bool {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\n{more}\n[fluid]\ndensity = 1000.0\nsound_speed = 20.0\n[solid]\n\
         model = \"{model}\"\ndensity = 500.0\nyoungs_modulus = 1e6\npoissons_ratio = 0.3\n[[shape]]\n\
         name = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, -0.2], max = [0.2, -0.1] }}\n{shapes}"
    );
    let text = if model == "rigid" {
        text.replace("youngs_modulus = 1e6\npoissons_ratio = 0.3\n", "")
    } else {
        text
    };
    let scene = parse(&text, Path::new("x.toml"), &[]).expect("a right scene");
    assert_eq!(scene.interface.cross_viscosity_reach, if scene.has_free_bodies() { 1.0 } else { 1.25 });
    scene.has_free_bodies()
}

#[test]
fn waves_carry_what_nothing_holds() {
    let shape = |name: &str, text: &str| format!("[[shape]]\nname = \"{name}\"\nphase = \"solid\"\n{text}\n");
    let (free, held) = (shape("a", LEFT), shape("b", &(BESIDE.to_owned() + HELD)));
    assert!(carried("total-lagrangian", &free, ""));
    assert!(!carried("total-lagrangian", &held, ""));
    assert!(carried("total-lagrangian", &format!("{free}{held}"), ""), "one of two is free");
    // Of one body a clamp of any shape holds all.
    let [a, b] = [("a", LEFT.to_owned()), ("b", BESIDE.to_owned() + HELD)]
        .map(|(name, text)| shape(name, &(text + ONE)));
    assert!(!carried("total-lagrangian", &format!("{a}{b}"), ""));
    assert!(!carried("hypoelastic", &free, "interface.treatment = \"phase-blind\""));
    assert!(carried("rigid", &free, ""));
    let moved = shape("a", &format!("{LEFT}\nmotion = {{ velocity = [0.1, 0.0] }}"));
    assert!(!carried("rigid", &moved, ""));
}
