//! Bodies that begin in walls, beside them or in each other, and what moves through walls: what is remarked on each,
//! and on what is near it not.

use super::tests::{PLATE, TANK, WATER, plain};
use super::trap_tests::{has, on, with};

fn shape(name: &str, phase: &str, min: [f64; 2], max: [f64; 2], lines: &str) -> String {
    format!(
        "[[shape]]\nname = \"{name}\"\nphase = \"{phase}\"\nbox = {{ min = {min:?}, max = {max:?} }}\n{lines}\n"
    )
}

/// Remarks on rigid bodies, and what else is there.
fn rigid(shapes: &[&str]) -> Vec<String> {
    on(&format!(
        "resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[solid]\nmodel = \"rigid\"\ndensity = 1100.0\n{}",
        shapes.concat()
    ))
}

#[test]
fn a_plate_in_the_floor_whose_clamp_was_forgotten() {
    let plate = |bottom: f64, lines: &str| shape("plate", "solid", [0.2, bottom], [0.22, 0.1], lines);
    let found = plain(&[TANK, WATER, &plate(-0.02, "")]);
    let said = "`plate` begins 0.02 m deep in `tank`, and no clamp holds it: it stands loosely in a socket of the wall";
    assert!(has(&found, said) && !has(&found, "nothing is below"), "{found:?}");
    let clamp = "clamp = { min = [0.2, -0.02], max = [0.22, 0.0] }";
    let slot =
        "[[shape]]\nname = \"slot\"\nphase = \"void\"\nbox = { min = [0.19, -0.03], max = [0.23, 0.0] }\n"
            .to_owned();
    // It stands on the floor, is clamped in it, or in a slot of it.
    for (before, plate) in [("", plate(0.0, "")), ("", plate(-0.02, clamp)), (&slot, plate(-0.01, ""))] {
        let found = plain(&[before, TANK, WATER, &plate]);
        assert!(!has(&found, "deep in"), "{found:?}");
    }
}

#[test]
fn a_body_beside_all_walls() {
    let block = |x: f64, lines: &str| shape("block", "solid", [x, 0.2], [x + 0.1, 0.25], lines);
    let floor = shape("floor", "wall", [0.0, -0.05], [0.4, 0.0], "");
    let found = rigid(&[&floor, WATER, &block(0.5, "")]);
    let said = "nothing is below `block`, however deep: beside all walls it falls by 4.905 m until 1 s under gravity";
    assert!(has(&found, said), "{found:?}");
    for lines in ["velocity = [-1.0, 0.0]", "motion = { velocity = [0.0, -0.1] }"] {
        assert!(!has(&rigid(&[&floor, WATER, &block(0.5, lines)]), "nothing is below"), "{lines}");
    }
    // Over the floor's edge, and over another body.
    assert!(!has(&rigid(&[&floor, WATER, &block(0.35, "")]), "nothing is below"));
    let lower = shape("lower", "solid", [0.5, 0.0], [0.6, 0.05], "");
    assert_eq!(
        rigid(&[&floor, WATER, &lower, &block(0.5, "")])
            .iter()
            .filter(|r| r.contains("nothing is below"))
            .count(),
        1
    );
}

#[test]
fn a_body_outside_of_its_tank() {
    let block = |x: f64| shape("block", "solid", [x, 0.1], [x + 0.1, 0.15], "");
    let found = rigid(&[TANK, WATER, &block(0.6)]);
    let said = "`block` begins outside of `tank`, whose walls have no outer face for what touches them: contact throws \
                it 0.3 m back through them";
    assert!(has(&found, said), "{found:?}");
    assert!(!has(&found, "in each other") && !has(&found, "nothing is below"), "{found:?}");
    let astride = rigid(&[TANK, WATER, &block(0.32)]);
    assert!(has(&astride, "`tank` and `block` lie 0.02 m in each other at the start"), "{astride:?}");
    assert!(!has(&rigid(&[TANK, WATER, &block(0.3)]), "contact throws"));
}

#[test]
fn copies_in_each_other() {
    let blocks = |step: f64, lines: &str| {
        let repeat = format!("{lines}repeat = {{ count = 3, step = [{step}, 0.0] }}");
        rigid(&[TANK, WATER, &shape("block", "solid", [0.15, 0.1], [0.2, 0.15], &repeat)])
    };
    let found = blocks(0.001, "");
    let said = "2 of the 3 copies of `block` lie in earlier ones, which have their places: each is 0.001 m from the \
                one before (`step` is from copy to copy), and they are 0.05 m wide";
    // Those have no particles, and are no bodies that contact could throw.
    assert!(has(&found, said) && !has(&found, "contact throws"), "{found:?}");
    let found = blocks(0.04, "");
    assert!(has(&found, "copies of `block` lie 0.01 m in each other at the start"), "{found:?}");
    assert!(!has(&blocks(0.05, ""), "copies of"), "{:?}", blocks(0.05, ""));
    // One body is the union of its shapes.
    assert!(!has(&blocks(0.001, "body = \"one\"\n"), "copies of"));
}

#[test]
fn ballast_in_a_hull() {
    let hull =
        |more: &str| shape("hull", "solid", [0.1, 0.06], [0.3, 0.16], &format!("body = \"ship\"\n{more}"));
    let ballast =
        |top: f64| shape("ballast", "solid", [0.1, 0.06], [0.3, top], "body = \"ship\"\ndensity = 3000.0\n");
    let lost = |shapes: [&str; 2]| {
        let found = rigid(&[TANK, shapes[0], shapes[1], WATER]);
        found.into_iter().filter(|text| text.contains("particles")).collect::<Vec<_>>()
    };
    // Before its hull, a fifth of its height, as it should be.
    assert_eq!(lost([&ballast(0.08), &hull("")]), [""; 0]);
    // After it, it has no particle, or those of its keel alone.
    let after = lost([&hull(""), &ballast(0.08)]);
    assert!(has(&after, "`ballast` has none of its 160 particles") && after.len() == 1, "{after:?}");
    let keel = shape("keel", "solid", [0.15, 0.03], [0.25, 0.09], "body = \"ship\"\ndensity = 3000.0\n");
    assert!(has(&lost([&hull(""), &keel]), "`keel` has 120 of its 240 particles"));
    // Of one density, the order says nothing; another body takes places.
    assert_eq!(lost([&hull(""), &keel.replace("density = 3000.0", "")]), [""; 0]);
    let other = keel.replace("\"ship\"", "\"other\"");
    assert!(has(&lost([&hull(""), &other]), "`keel` has 120 of its 240 particles"));
}

#[test]
fn what_moves_through_a_tank() {
    let gate = |motion: &str| {
        let gate = shape("gate", "wall", [0.1, 0.0], [0.12, 0.2], &format!("motion = {motion}"));
        plain(&[&gate, TANK, WATER, PLATE])
    };
    let down = gate("{ velocity = [0.0, -1.5], end = 0.1 }");
    let said = "`gate` goes through the bottom of `tank` from about 0.00";
    assert!(has(&down, said) && has(&down, "walls do not stop each other"), "{down:?}");
    for motion in ["{ velocity = [0.0, 1.5] }", "{ velocity = [-0.1, 0.0], end = 0.9 }"] {
        assert!(!has(&gate(motion), "goes through"), "{motion}: {:?}", gate(motion));
    }
    assert!(has(&gate("{ velocity = [-0.2, 0.0] }"), "`gate` goes through the left wall of `tank`"));
    let slot =
        "[[shape]]\nname = \"slot\"\nphase = \"void\"\nbox = { min = [0.1, -0.03], max = [0.12, 0.0] }\n";
    let lines = "motion = { velocity = [0.0, -1.5], end = 0.1 }";
    let through = plain(&[slot, &shape("gate", "wall", [0.1, 0.0], [0.12, 0.2], lines), TANK, WATER, PLATE]);
    assert!(!has(&through, "goes through"), "{through:?}");
    // It stands in the floor, and goes further into it.
    let rooted = shape("gate", "wall", [0.1, -0.01], [0.12, 0.2], "motion = { velocity = [0.0, -0.1] }");
    assert!(!has(&plain(&[&rooted, TANK, WATER, PLATE]), "goes through"));
    // A lid, which is dry.
    let lid = TANK.replace(", open = [\"top\"]", "");
    let gate =
        with(&shape("gate", "wall", [0.1, 0.0], [0.12, 0.2], ""), "motion = { velocity = [0.0, 1.5] }\n");
    assert!(!has(&plain(&[&gate, &lid, WATER, PLATE]), "goes through"));
}

#[test]
fn a_body_that_is_led_through_the_floor() {
    let wedge = |end: f64| {
        let motion = format!("motion = {{ velocity = [0.0, -0.2], end = {end} }}");
        rigid(&[&shape("wedge", "solid", [0.02, 0.12], [0.08, 0.16], &motion), TANK, WATER])
    };
    let said = "`wedge` goes through the bottom of `tank` from about 0.61";
    assert!(
        has(&wedge(1.0), said) && has(&wedge(1.0), "nothing stops what `motion` moves"),
        "{:?}",
        wedge(1.0)
    );
    assert!(!has(&wedge(0.6), "goes through"));
}

/// K l = rho (20 U)²: with U = 1 m/s, by the block's own velocity, 0.4 MPa.
#[test]
fn a_restitution_that_hardly_acts() {
    let on = |modulus: f64, contact: &str| {
        on(&format!(
            "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, 0.0]\n[solid]\nmodel = \"total-lagrangian\"\n\
             density = 1000.0\nyoungs_modulus = {modulus}\npoissons_ratio = 0.0\n{contact}\n{}{}",
            shape("block", "solid", [0.0, 0.02], [0.1, 0.12], "velocity = [0.0, -1.0]"),
            shape("floor", "wall", [-0.1, -0.04], [0.2, 0.0], "contact = true")
        ))
    };
    let said = "a restitution of 0.5 hardly acts on `solid`: contact is 0.4 times as stiff";
    let found = on(1e6, "contact = { restitution = 0.5 }");
    assert!(has(&found, said), "{found:?}");
    for (modulus, contact) in
        [(1e7, "contact = { restitution = 0.5 }"), (1e6, "contact = { friction = 0.5 }")]
    {
        let found = on(modulus, contact);
        assert!(!has(&found, "hardly acts"), "{found:?}");
    }
}
