//! Faces of walls, what voids leave of plates, corners, and what turns: what is remarked on, and what is near it not.

use super::tank_tests::{basin, beside, of, wall, water};
use super::trap_tests::has;

#[test]
fn a_weir_of_part_of_a_row() {
    let weir = |high: f64, to: f64| {
        beside(&wall("weir", &format!("box = {{ min = [0.5, 0.0], max = [{to}, {high}] }}")))
    };
    let said = "the top of `weir` is at 0.104 m in the scene and at 0.1 m as computed, and fluid comes there: a wall \
                has whole rows from its `min` on (the resolution is 0.01)";
    assert!(has(&weir(0.104, 0.55), said), "{:?}", weir(0.104, 0.55));
    assert!(has(&weir(0.1, 0.556), "the right side of `weir` is at 0.556 m"));
    assert!(!has(&weir(0.1005, 0.55), "as computed"), "a twentieth of a spacing");
    assert!(!has(&weir(0.304, 0.55), "the top of"), "higher than the water that falls");
    let wave = "box = { min = [-0.04, 0.0], max = [0.0, 0.4] }\nmotion = { amplitude = [0.05, 0.0], period = 2.0, \
                ramp = 0.5 }";
    let crest = wall("weir", "box = { min = [0.3, 0.0], max = [0.35, 0.304] }");
    let driven = beside(&(wall("piston", wave) + &crest));
    let said =
        "the top of `weir` is at 0.304 m in the scene and at 0.3 m as computed, and fluid may come there";
    assert!(has(&driven, said), "{driven:?}");
    let repeated = wall(
        "bars",
        "box = { min = [0.5, 0.0], max = [0.536, 0.1] }\nrepeat = { count = 3, step = [0.1, 0.0] }",
    );
    let found = beside(&repeated);
    assert!(
        has(&found, "the right side of `bars` is at 0.536 m in the scene and at 0.54 m as computed"),
        "{found:?}"
    );
    assert_eq!(found.iter().filter(|text| text.contains("as computed")).count(), 1, "{found:?}");
}

#[test]
fn a_top_that_still_water_does_not_come_to() {
    let weir = wall("weir", "box = { min = [0.5, 0.0], max = [0.55, 0.304] }");
    let still = of(&format!("{weir}{}{}", basin(), water([0.0, 0.5, 0.2])));
    assert!(!has(&still, "the top of"), "{still:?}");
}

#[test]
fn an_orifice_of_part_of_a_row() {
    let with = |from: f64, to: f64| {
        let void = format!(
            "[[shape]]\nname = \"orifice\"\nphase = \"void\"\nbox = {{ min = [0.2, {from}], max = [0.6, {to}] }}\n"
        );
        beside(&(void + &wall("curtain", "box = { min = [0.3, 0.0], max = [0.36, 0.3] }")))
    };
    let said = "the opening that `orifice` cuts into `curtain` at [0.4, 0.07] is 0.036 m high in the scene and 0.04 \
                m of \
                whole rows as computed (the resolution is 0.01)";
    assert!(has(&with(0.052, 0.088), said), "{:?}", with(0.052, 0.088));
    assert!(!has(&with(0.05, 0.09), "the opening that"));
}

#[test]
fn a_floor_below_its_water() {
    let standing = |floor: f64, dry: f64| {
        of(&format!(
            "{}{}{}{}",
            water([0.0, 0.3, 0.2]),
            wall("floor", &format!("box = {{ min = [-0.05, {floor}], max = [0.35, 0.0] }}")),
            wall("left", "box = { min = [-0.05, 0.0], max = [0.0, 0.3] }"),
            wall("right", &format!("box = {{ min = [0.3, 0.0], max = [{dry}, 0.3] }}")),
        ))
    };
    assert!(has(
        &standing(-0.054, 0.35),
        "the top of `floor` is at 0 m in the scene and at -0.004 m as computed"
    ));
    assert!(!has(&standing(-0.05, 0.354), "as computed"), "behind the wall is no fluid");
}

#[test]
fn an_arm_of_part_of_a_row() {
    let plate = |void: &str| {
        let void = format!("[[shape]]\nname = \"cut\"\nphase = \"void\"\n{void}\n");
        let solid = "[solid]\ndensity = 1100.0\nyoungs_modulus = 6e6\npoissons_ratio = 0.4\n[[shape]]\nname = \
                     \"plate\"\n\
                     phase = \"solid\"\nbox = { min = [0.5, 0.0], max = [0.7, 0.2] }\n\
                     clamp = { min = [0.5, 0.0], max = [0.7, 0.02] }\n";
        of(&format!("{void}{solid}{}{}", basin(), water([0.0, 0.3, 0.2])))
    };
    let beside = |from: f64| plate(&format!("box = {{ min = [{from}, 0.05], max = [0.7, 0.2] }}"));
    let said = "`plate` is 0.054 m thick at [0.527, 0.055] beside a void in the scene and 0.05 m of whole rows as \
                computed: 0.79 times the bending stiffness (its spacing is 0.01)";
    assert!(has(&beside(0.554), said), "{:?}", beside(0.554));
    assert!(!has(&beside(0.55), "beside a void"));
    // The narrower arm has whole rows, the wider one not.
    let two = plate("box = { min = [0.55, 0.05], max = [0.627, 0.2] }");
    assert!(has(&two, "`plate` is 0.073 m thick at [0.6635, 0.055] beside a void"), "{two:?}");
    let hole = |radius: f64| plate(&format!("disc = {{ center = [0.6, 0.1], radius = {radius} }}"));
    assert!(has(&hole(0.066), "beside a void in the scene"), "{:?}", hole(0.066));
    let repeated =
        "box = { min = [0.522, 0.05], max = [0.56, 0.15] }\nrepeat = { count = 2, step = [0.09, 0.0] }";
    assert!(has(&plate(repeated), "`plate` is 0.022 m thick"), "{:?}", plate(repeated));
}

#[test]
fn a_thin_part_of_a_polygon() {
    let wall = |thick: f64, hole: &str| {
        of(&format!(
            "{hole}[solid]\ndensity = 2400.0\nyoungs_modulus = 1e8\npoissons_ratio = 0.2\n[[shape]]\nname = \
             \"sea-wall\"\nphase = \"solid\"\npolygon = [[0.5, 0.0], [0.7, 0.0], [0.7, 0.1], [{0}, 0.1], [{0}, 0.3], \
             [0.5, 0.3]]\nclamp = {{ min = [0.5, 0.0], max = [0.7, 0.02] }}\n{1}{2}",
            0.5 + thick,
            basin(),
            water([0.0, 0.3, 0.2])
        ))
    };
    let said = "`sea-wall` is 0.054 m thick at [0.527, 0.295] in the scene and 0.05 m of whole rows as computed: 0.79 \
                times the bending stiffness (its spacing is 0.01)";
    let found = wall(0.054, "");
    assert!(has(&found, said), "{found:?}");
    assert!(!has(&wall(0.05, ""), "thick at"), "{:?}", wall(0.05, ""));
    let cut = "[[shape]]\nname = \"cut\"\nphase = \"void\"\npolygon = [[0.533, 0.15], [0.6, 0.15], [0.6, 0.31], \
               [0.533, 0.31]]\n";
    let found = wall(0.06, cut);
    assert!(has(&found, "`sea-wall` is 0.033 m thick at"), "{found:?}");
    assert!(has(&found, "beside a void in the scene and 0.03 m of whole rows"), "{found:?}");
}

#[test]
fn a_hull_of_other_plates() {
    let hull = |hole: &str, keys: &str| {
        of(&format!(
            "[[shape]]\nname = \"inside\"\nphase = \"void\"\nbox = {hole}\n[solid]\nmodel = \"rigid\"\ndensity = \
             800.0\n{keys}[[shape]]\nname = \"hull\"\nphase = \"solid\"\nbox = {{ min = [0.4, 0.1], max = [0.8, 0.3] }}\n\
             {}{}",
            basin(),
            water([0.0, 0.3, 0.2])
        ))
    };
    let off = "{ min = [0.424, 0.124], max = [0.776, 0.276] }";
    // 0.08 - 0.352 x 0.152 m², and 800 - 36 x 16 cells.
    let said = "voids leave 0.0265 m² of `hull` in the scene and 0.0224 m² as computed: 0.85 times the mass (its spacing is 0.01; `mass` at";
    let found = hull(off, "");
    assert!(has(&found, said), "{found:?}");
    assert!(!has(&hull("{ min = [0.42, 0.12], max = [0.78, 0.28] }", ""), "voids leave"));
    let given = "[[solid.bodies]]\nname = \"hull\"\nmass = 20.0\n";
    assert!(!has(&hull(off, given), "voids leave"), "its mass is said");
}

#[test]
fn a_sharp_corner() {
    let pit = |half: f64, level: f64, more: &str| {
        let [a, b] = [half * 0.4, half * 0.2];
        of(&format!(
            "{}[[shape]]\nname = \"water\"\nphase = \"fluid\"\npolygon = [[{}, {level}], [{b}, 0.2], [{a}, 0.4], \
             [-{a}, 0.4], [-{b}, 0.2], [-{}, {level}]]\n{more}",
            wall(
                "pit",
                &format!(
                    "polygon = [[0.0, 0.0], [{0}, 0.5], [0.4, 0.5], [0.4, -0.2], [-0.4, -0.2], [-0.4, 0.5], [-{0}, \
                     0.5]]",
                    half * 0.5
                )
            ),
            half * level,
            half * level,
        ))
    };
    // tan 10 degrees.
    let said = "fluid comes into the corner of `pit` at [0, 0], whose sides meet at 20 degrees";
    assert!(has(&pit(0.176_327, 0.19, ""), said), "{:?}", pit(0.176_327, 0.19, ""));
    assert!(!has(&pit(0.176_327, 0.01, ""), "sides meet"), "it stands there");
    assert!(!has(&pit(0.4, 0.19, ""), "sides meet"), "44 degrees");
}

#[test]
fn a_paddle_that_turns_into_a_block() {
    let turning = |angle: f64, foot: f64| {
        let paddle = format!(
            "box = {{ min = [0.2, {foot}], max = [0.24, 0.19] }}\n\
             motion = {{ angle = {angle}, period = 2.0, pivot = [0.22, 0.1] }}"
        );
        beside(&(wall("paddle", &paddle) + &wall("block", "box = { min = [0.28, 0.0], max = [0.4, 0.2] }")))
    };
    let said = "`paddle` turns into `block` from about ";
    assert!(has(&turning(-1.0, 0.05), said), "{:?}", turning(-1.0, 0.05));
    assert!(has(&turning(-1.0, 0.05), "s on: walls do not stop each other"));
    assert!(!has(&turning(-0.1, 0.05), "turns into"));
}

#[test]
fn gauges_beside_what_moves() {
    let gauge = |x: f64, keys: &str| {
        format!("[[probe]]\nname = \"p\"\nkind = \"pressure\"\nat = [{x}, 0.05]\n{keys}")
    };
    let piston = |probe: String| {
        let motion = "motion = { amplitude = [0.05, 0.0], period = 2.0, ramp = 0.5 }";
        beside(
            &(wall("piston", &format!("box = {{ min = [0.3, 0.0], max = [0.34, 0.3] }}\n{motion}")) + &probe),
        )
    };
    let said = "the probe `p` at [0.295, 0.05] is fixed in space beside `piston`, which moves (`shape = \"piston\"` \
                takes \
                it along)";
    assert!(has(&piston(gauge(0.295, "")), said), "{:?}", piston(gauge(0.295, "")));
    assert!(!has(&piston(gauge(0.1, "")), "fixed in space"));
    assert!(!has(&piston(gauge(0.295, "shape = \"piston\"\n")), "fixed in space"));
    let plate = |modulus: f64| {
        beside(&format!(
            "[solid]\ndensity = 1100.0\nyoungs_modulus = {modulus}\npoissons_ratio = 0.4\n[[shape]]\nname = \"plate\"\n\
             phase = \"solid\"\nbox = {{ min = [0.3, -0.03], max = [0.34, 0.25] }}\n\
             clamp = {{ min = [0.3, -0.03], max = [0.34, 0.0] }}\n{}",
            gauge(0.295, "")
        ))
    };
    let bends = plate(1e6);
    assert!(
        has(&bends, "the probe `p` at [0.295, 0.05] is fixed in space beside `plate`, which bends by about "),
        "{bends:?}"
    );
    assert!(!has(&plate(1e10), "fixed in space"), "{:?}", plate(1e10));
}
