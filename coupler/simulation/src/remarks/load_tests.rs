//! Loads, cracks, modes and materials of beams that act otherwise than their author thinks: what is remarked on each,
//! and on what is near it not.

use super::trap_tests::{has, on, with};

const BEAM: &str = "[[shape]]\nname = \"beam\"\nphase = \"solid\"\nbox = { min = [0.0, 0.0], max = [0.4, 0.04] }\n\
                    clamp = { min = [0.0, 0.0], max = [0.02, 0.04] }\n";

/// Remarks on a beam of 80 x 8 particles, held at its left end, 0.1 s long.
fn beam(keys: &str, lines: &str) -> Vec<String> {
    on(&format!(
        "resolution = 0.005\nend_time = 0.1\n[solid]\ndensity = 1100.0\nyoungs_modulus = 5e6\n\
         poissons_ratio = 0.3\n{keys}\n{}",
        with(BEAM, &format!("{lines}\n"))
    ))
}

fn loaded(min: [f64; 2], max: [f64; 2], more: &str) -> Vec<String> {
    let load =
        format!("load = {{ within = {{ min = {min:?}, max = {max:?} }}, traction = [0.0, -10.0]{more} }}");
    beam("", &load)
}

#[test]
fn a_load_that_grows_for_longer_than_the_run() {
    let end = |ramp: f64| loaded([0.395, 0.0], [0.4, 0.04], &format!(", ramp = {ramp}"));
    let said =
        "the load of `beam` comes to 10 % of its traction: its `ramp` takes 1 s, and the run ends at 0.1 s";
    assert!(has(&end(1.0), said), "{:?}", end(1.0));
    assert_eq!(end(0.11), [""; 0], "to 91 %");
}

#[test]
fn a_load_that_its_shape_leaves_behind() {
    // Turned by 5 degrees about its root, the beam's right end, (0.4, 0.02), is at (0.397, 0.055).
    let turned =
        |min: [f64; 2], max: [f64; 2]| loaded(min, max, " }\nrotate = { angle = 5.0, about = [0.0, 0.0]");
    let said = "the `load` of `beam` is where it would be without `rotate` and `translate`";
    let left = turned([0.395, 0.0], [0.4, 0.04]);
    assert!(left.iter().any(|remark| remark.starts_with(said)), "{left:?}");
    let along = turned([0.39, 0.03], [0.41, 0.08]);
    assert!(!along.iter().any(|remark| remark.starts_with(said)), "{along:?}");
}

#[test]
fn a_load_inside_of_its_body() {
    let row = |y: f64| loaded([0.0, y], [0.4, y + 0.005], "");
    let said = "the traction on `beam` acts inside of it: of 76 particles 75 have others on all sides";
    assert!(has(&row(0.02), said), "{:?}", row(0.02));
    // The outermost row, and a section.
    assert_eq!(row(0.035), [""; 0]);
    assert_eq!(loaded([0.2, 0.0], [0.205, 0.04], ""), [""; 0]);
}

#[test]
fn cracks_that_part_nothing() {
    let crack = |x: f64, from: f64, to: f64| beam("", &format!("crack = [[{x}, {from}], [{x}, {to}]]"));
    let clamped = crack(0.01, -0.01, 0.05);
    let said = "pairs of particles, all of them clamped: it opens nowhere";
    assert!(has(&clamped, said), "{clamped:?}");
    // A point between four particles, and a slit along a row.
    let between = crack(0.2, 0.0005, 0.0015);
    assert!(
        has(&between, "the crack of `beam` lies between its particles, and parts nothing"),
        "{between:?}"
    );
    assert!(has(&crack(0.5, 0.0, 0.02), "the crack of `beam` lies beside it, and parts nothing"));
    for x in [0.02, 0.2] {
        assert_eq!(crack(x, -0.01, 0.02), [""; 0], "{x}");
    }
}

#[test]
fn a_bending_mode_of_another_length() {
    let mode = |root: f64, length: f64| {
        beam("", &format!("cantilever_mode = {{ fraction = 0.001, root = {root}, length = {length} }}"))
    };
    let found = mode(0.2, 0.1);
    let said = "the cantilever_mode of `beam` goes from x = 0.2 to 0.3 m, and the plate is free from 0.02 to 0.4 m: it \
                begins with other modes as well (root = 0.02, length = 0.38 fit it)";
    assert!(has(&found, said), "{found:?}");
    assert_eq!(mode(0.02, 0.38), [""; 0]);
    assert_eq!(mode(0.0, 0.4), [""; 0], "from within the clamp");
}

#[test]
fn arms_that_do_nothing() {
    let slow = beam("prony = [[0.5, 1000.0]]", "");
    let said = "the Maxwell arms of `solid` do not relax within the run: the shortest tau is 1000 s, and it ends at \
                0.1 s. They make it 1.5 times as stiff in shear, and damp nothing";
    assert!(has(&slow, said), "{slow:?}");
    let fast = beam("prony = [[0.5, 1e-7]]", "");
    let said = "the Maxwell arms of `solid` relax at once, and do nothing: the longest tau is 1e-7 s, and a wave needs \
                5.9e-5 s from one particle to the next";
    assert!(has(&fast, said), "{fast:?}");
    // A fit over many decades has arms of all kinds.
    for arms in ["[[0.5, 0.06]]", "[[0.5, 9.0]]", "[[0.5, 1e-7], [0.3, 0.01], [0.2, 1000.0]]"] {
        assert_eq!(beam(&format!("prony = {arms}"), ""), [""; 0], "{arms}");
    }
}

#[test]
fn side_friction_that_holds_all() {
    let stuck = beam("side_friction = 1e10", "");
    let said = "side_friction = 1e10 N/m³ of `solid` is 926700 times the weight of what is in the scene";
    assert!(has(&stuck, said), "{stuck:?}");
    assert_eq!(beam("side_friction = 1e6", ""), [""; 0]);
    assert_eq!(beam("side_friction = 1e10", "velocity = [0.0, 1.0]"), [""; 0]);
}

#[test]
fn friction_of_solids_that_do_not_touch() {
    let pair = |keys: &str| {
        on(&format!(
            "resolution = 0.005\nend_time = 0.1\n[[solid]]\nname = \"steel\"\ndensity = 7800.0\n\
             youngs_modulus = 1e8\npoissons_ratio = 0.3\n[[solid]]\nname = \"rubber\"\ndensity = 1100.0\n\
             youngs_modulus = 5e6\npoissons_ratio = 0.4\n[[contact]]\nsolids = [\"steel\", \"rubber\"]\n{keys}\n\
             [[shape]]\nname = \"a\"\nphase = \"solid\"\nsolid = \"rubber\"\n\
             box = {{ min = [0.0, 0.0], max = [0.2, 0.05] }}\nclamp = {{ min = [0.0, 0.0], max = [0.2, 0.01] }}\n\
             [[shape]]\nname = \"b\"\nphase = \"solid\"\nsolid = \"steel\"\n\
             box = {{ min = [0.05, 0.06], max = [0.1, 0.1] }}\n"
        ))
    };
    let said = "`steel` and `rubber` do not touch (touch = false), and pass through each other";
    assert!(has(&pair("touch = false\nfriction = 0.4"), said), "{:?}", pair("touch = false\nfriction = 0.4"));
    assert!(!has(&pair("touch = false"), "do not touch"));
    assert!(!has(&pair("friction = 0.4"), "do not touch"));
}

#[test]
fn a_row_of_one_particle_carries_nothing() {
    // Two voids leave a row of the beam's four, 5 mm each.
    let ligament = |upper: f64| {
        let void = |name: &str, low: f64, high: f64| {
            format!(
                "[[shape]]\nname = \"{name}\"\nphase = \"void\"\nbox = {{ min = [0.2, {low}], max = [0.3, {high}] }}\n"
            )
        };
        on(&format!(
            "resolution = 0.005\nend_time = 0.1\ngravity = [0.0, -9.81]\n[solid]\ndensity = 1000.0\n\
             youngs_modulus = 1e8\npoissons_ratio = 0.3\n{}{}[[shape]]\nname = \"beam\"\nphase = \"solid\"\n\
             box = {{ min = [0.0, 0.0], max = [0.4, 0.02] }}\nclamp = {{ min = [0.0, 0.0], max = [0.02, 0.02] }}\n",
            void("lower", -0.01, 0.005),
            void("upper", upper, 0.03)
        ))
    };
    let said = "20 particles of `beam`, at [0.2025, 0.0075] first, have their neighbours on one line or nearly so, and \
                the strain across is not known: no stress, no strength, and nothing holds what hangs there (two rows carry)";
    assert!(has(&ligament(0.01), said), "{:?}", ligament(0.01));
    assert!(!has(&ligament(0.015), "on one line"), "{:?}", ligament(0.015));
}
