//! Bodies that touch each other and walls: what is remarked on.

use super::remarks;
use super::tests::{PLATE, TANK, WATER};
use halfstep_scene::parse;
use std::path::Path;

/// Two rigid blocks, the second from this x on, on a floor at this height; `more` after the solids.
fn rigid(solids: [&str; 2], [x, floor]: [f64; 2], more: &str) -> Vec<String> {
    let mut names = solids.to_vec();
    names.dedup();
    let solid = |name: &&str| {
        format!("[[solid]]\nname = \"{name}\"\nmodel = \"rigid\"\ndensity = 2000.0\ncontact.friction = 0.3\n")
    };
    let block = |(k, solid): (usize, &str)| {
        let from = [0.0, x][k];
        format!(
            "[[shape]]\nname = \"block-{k}\"\nphase = \"solid\"\nsolid = \"{solid}\"\nbody = \"b{k}\"\n\
             box = {{ min = [{from}, 0.0], max = [{}, 0.1] }}\n",
            from + 0.1
        )
    };
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\n{more}{}{}[[shape]]\nname = \"floor\"\nphase = \"wall\"\n\
         box = {{ min = [-1.0, -0.1], max = [1.0, {floor}] }}\n",
        names.iter().map(solid).collect::<String>(),
        solids.into_iter().enumerate().map(block).collect::<String>()
    );
    remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
}

#[test]
fn what_lies_in_each_other_at_the_start() {
    assert_eq!(rigid(["a", "a"], [0.1, 0.0], ""), [""; 0], "touching is none");
    let both = "`block-0` and `block-1` lie 0.02 m in each other at the start";
    for solids in [["a", "a"], ["a", "b"]] {
        let more = "[[contact]]\nsolids = [\"a\", \"b\"]\n";
        let found = rigid(solids, [0.08, 0.0], if solids[1] == "b" { more } else { "" });
        assert!(found.iter().any(|text| text.starts_with(both)), "{found:?}");
    }
    let found = rigid(["a", "a"], [0.2, 0.005], "");
    let floor = |text: &String| text.contains("`floor` lie 0.005 m in each other");
    assert_eq!(found.iter().filter(|text| floor(text)).count(), 2, "{found:?}");
}

#[test]
fn two_solids_whose_own_bodies_rub_and_that_do_not() {
    let found = rigid(["a", "b"], [0.2, 0.0], "");
    assert!(found.len() == 1 && found[0].contains("`a` and `b` touch without friction"), "{found:?}");
    let said = rigid(["a", "b"], [0.2, 0.0], "[[contact]]\nsolids = [\"a\", \"b\"]\nfriction = 0.0\n");
    assert_eq!(said, [""; 0]);
    // A third one fills what is between them.
    let block = |name: &str, x: f64| {
        format!(
            "[[solid]]\nname = \"{name}\"\ndensity = 1000.0\nmodel = \"rigid\"\ncontact = {{ friction = 0.4 }}\n[[shape]]\n\
             name = \"block-{name}\"\nphase = \"solid\"\nsolid = \"{name}\"\n\
             box = {{ min = [{x}, 0.0], max = [{}, 0.1] }}\n",
            x + 0.1
        )
    };
    let pair = |solids: &str| format!("[[contact]]\nsolids = [{solids}]\nfriction = 0.4\n");
    let row = |between: f64| {
        let text = format!(
            "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, -9.81]\n{}{}{}{}{}[[shape]]\nname = \"floor\"\n\
             phase = \"wall\"\nbox = {{ min = [-1.0, -0.1], max = [1.0, 0.0] }}\n",
            block("a", 0.0),
            block("b", between),
            block("c", 0.2),
            pair("\"a\", \"b\""),
            pair("\"b\", \"c\""),
        );
        remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
    };
    assert_eq!(row(0.1), [""; 0]);
    assert!(
        row(0.4).iter().any(|text| text.contains("`a` and `c` touch without friction")),
        "{:?}",
        row(0.4)
    );
}

#[test]
fn two_solids_that_begin_face_to_face() {
    let said = "`block-0` and `block-1` begin face to face and are of two solids: they push each other without \
                friction and come apart freely (shapes of one [[solid]] with the same `body` are one piece; \
                [[contact]] says how two solids touch in the plane)";
    let found = rigid(["a", "b"], [0.1, 0.0], "");
    assert!(found.iter().any(|text| text == said), "{found:?}");
    let contact = "[[contact]]\nsolids = [\"a\", \"b\"]\nfriction = 0.0\n";
    assert_eq!(rigid(["a", "b"], [0.1, 0.0], contact), [""; 0]);
    let apart = rigid(["a", "b"], [0.12, 0.0], "");
    assert!(!apart.iter().any(|text| text.contains("face to face")), "{apart:?}");
}

#[test]
fn a_rigid_body_in_the_nodal_lattice_lacks_half_a_spacing() {
    let found = rigid(["a", "a"], [0.2, 0.0], "numerics.lattice = \"nodal\"\n");
    let lacks = found.iter().filter(|text| text.contains("has 81 % of the mass that its size asks for"));
    assert_eq!(lacks.count(), 2, "{found:?}");
}

#[test]
fn a_light_body_on_the_floor() {
    let block = |bottom: f64, density: &str| {
        let text = format!(
            "resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[solid]\ndensity = {density}\n\
             youngs_modulus = 12e6\npoissons_ratio = 0.4\n{TANK}{WATER}[[shape]]\nname = \"block\"\n\
             phase = \"solid\"\nbox = {{ min = [0.2, {bottom}], max = [0.26, {}] }}\n",
            bottom + 0.04
        );
        remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
    };
    let found = block(0.0, "500.0");
    assert!(
        found.len() == 1 && found[0].contains("`block` is lighter than the fluid and stands on `tank`"),
        "{found:?}"
    );
    // Heavier than water, or with water below it.
    assert_eq!(block(0.0, "1100.0"), [""; 0]);
    assert_eq!(block(0.02, "500.0"), [""; 0]);
}

#[test]
fn friction_of_what_strains_is_about_walls_and_bodies() {
    let rubs = |parts: &[&str]| {
        let text = format!(
            "resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[solid]\ndensity = 1100.0\n\
             youngs_modulus = 12e6\npoissons_ratio = 0.4\ncontact = {{ friction = 0.3 }}\n{}",
            parts.concat()
        );
        remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
    };
    // By default walls do not touch what is clamped.
    let nothing = rubs(&[TANK, WATER, PLATE]);
    assert!(
        nothing.len() == 1 && nothing[0].starts_with("the `contact` of `solid` changes nothing"),
        "{nothing:?}"
    );
    let free = PLATE.lines().filter(|line| !line.starts_with("clamp")).collect::<Vec<_>>().join("\n") + "\n";
    assert_eq!(rubs(&[TANK, WATER, &free]), [""; 0]);
    let other = free.replace("\"plate\"", "\"block\"").replace("0.22", "0.32").replace("[0.2,", "[0.3,");
    assert_eq!(rubs(&[TANK, WATER, &free, &other]), [""; 0]);
    // Between two bodies it needs no wall.
    let held = PLATE.replace("\"plate\"", "\"second\"").replace("0.22", "0.32").replace("[0.2,", "[0.3,");
    assert_eq!(rubs(&[TANK, WATER, PLATE, &held]), [""; 0]);
}

#[test]
fn debris_is_not_known_to_contact() {
    let of = |stone: &str, more: &str| {
        let shape = |name: &str, from: f64| {
            format!(
                "[[shape]]\nname = \"{name}\"\nphase = \"solid\"\nsolid = \"{name}\"\nvelocity = [0.1, 0.0]\n\
                 box = {{ min = [{from}, 0.0], max = [{}, 0.1] }}\n",
                from + 0.04
            )
        };
        let solid = |name: &str, more: &str| {
            format!(
                "[[solid]]\nname = \"{name}\"\ndensity = 1100.0\nyoungs_modulus = 1e8\npoissons_ratio = 0.3\n{more}\n"
            )
        };
        let text = format!(
            "resolution = 0.005\nend_time = 1.0\n{}{}{}{}{more}",
            solid("glass", "fracture = { strength = 1e5, energy = 10.0 }"),
            solid("stone", stone),
            shape("glass", 0.0),
            shape("stone", 0.1)
        );
        remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
    };
    let found = of("", "");
    let text = "`glass` and `stone` touch with the surfaces that they begin with: a piece that breaks off `glass` takes";
    assert!(found.len() == 1 && found[0].starts_with(text), "{found:?}");
    let apart = "[[contact]]\nsolids = [\"glass\", \"stone\"]\ntouch = false\n";
    assert_eq!(of("", apart), [""; 0]);
    // Friction of what breaks is that within one solid.
    let found = of("fracture = { strength = 1e5, energy = 10.0, friction = 0.3 }", "");
    let [smooth, debris] = found.as_slice() else { panic!("{found:?}") };
    assert!(debris.contains("a piece that breaks off `glass` or `stone` takes"), "{debris}");
    assert!(smooth.starts_with("`glass` and `stone` touch without friction: their own friction"), "{smooth}");
}
