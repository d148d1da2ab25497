//! Valid scenes whose clamps, columns, angles, lattice or probes are others than their author thinks: what is remarked
//! on each, and on what is near it not.

use super::remarks;
use super::tests::{PLATE, TANK, WATER, plain};
use super::trap_tests::{has, with};
use halfstep_scene::parse;
use std::path::Path;

const SHAKEN: &str = "motion = { amplitude = [0.05, 0.0], period = 1.0 }\n";

/// Remarks on a solid without fluid or walls.
fn dry(lines: &str, keys: &str, rest: &str) -> Vec<String> {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\n{lines}\n[solid]\ndensity = 1000.0\nyoungs_modulus = 1e6\n\
         poissons_ratio = 0.3\n{keys}\n{rest}"
    );
    remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
}

fn block(name: &str, min: [f64; 2], max: [f64; 2], lines: &str) -> String {
    format!(
        "[[shape]]\nname = \"{name}\"\nphase = \"solid\"\nbox = {{ min = {min:?}, max = {max:?} }}\n{lines}\n"
    )
}

#[test]
fn copies_that_no_clamp_holds() {
    let said = "1 of the 2 copies of `plate` is free: `repeat` does not take the clamp's box along";
    let repeated = with(PLATE, "repeat = { count = 2, step = [0.05, 0.0] }\n");
    let found = plain(&[TANK, WATER, &repeated]);
    assert!(has(&found, said), "{found:?}");
    let both = repeated.replace(
        "clamp = { min = [0.2, 0.0], max = [0.22, 0.01] }",
        "clamp = [{ min = [0.2, 0.0], max = [0.22, 0.01] }, { min = [0.25, 0.0], max = [0.27, 0.01] }]",
    );
    assert_eq!(plain(&[TANK, WATER, &both]), [""; 0]);
}

#[test]
fn a_piece_that_a_void_cuts_off() {
    let void = |to: f64| {
        format!(
            "[[shape]]\nname = \"cut\"\nphase = \"void\"\nbox = {{ min = [0.19, 0.05], max = [{to}, 0.06] }}\n"
        )
    };
    let said = "`plate` is 2 pieces, and no clamp reaches 1 of them, 32 particles: it is free";
    let found = plain(&[TANK, &void(0.23), WATER, PLATE]);
    assert!(has(&found, said), "{found:?}");
    assert!(!has(&plain(&[TANK, &void(0.205), WATER, PLATE]), "pieces"));
}

#[test]
fn a_beam_whose_clamp_was_forgotten() {
    let of = |gravity: &str, lines: &str| dry(gravity, "", &block("beam", [0.0, 0.0], [0.2, 0.04], lines));
    let (down, clamp) = ("gravity = [0.0, -9.81]", "clamp = { min = [0.0, 0.0], max = [0.02, 0.04] }");
    let said = "`beam` is held by nothing, and the scene has no wall: it falls by 4.905 m until 1 s under gravity, \
                without bending (a box of `clamp` holds what is in it)";
    assert!(has(&of(down, ""), said), "{:?}", of(down, ""));
    for meant in [of(down, clamp), of(down, "velocity = [1.0, 0.0]"), of("gravity = [0.0, 0.0]", "")] {
        assert_eq!(meant, [""; 0]);
    }
}

/// Remarks on a tank that moves by a file of these titles and rows.
pub(super) fn recorded(titles: &str, rows: &str, motion: &str) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("m.csv"), format!("{titles}\n{rows}\n")).expect("a file");
    let tank = with(TANK, &format!("motion = {}\n", motion.replace("FILE", "file = \"m.csv\"")));
    let text = format!("resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n{tank}{WATER}");
    remarks(&parse(&text, &folder.path().join("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
}

#[test]
fn columns_of_other_units() {
    let roll = |title: &str, scale: &str| {
        let columns = format!(
            "{{ FILE, columns = {{ time = \"t\", angle = \"{title}\" }}, pivot = [0.2, 0.0]{scale} }}"
        );
        recorded(&format!("t,{title}"), "0,0\n0.5,1\n1,2", &columns)
    };
    let said = "the motion of `tank` turns by the column `roll [deg]`, whose title says degrees, times scale = 1, in \
                radians: by up to 2 rad, 115 degrees";
    assert!(has(&roll("roll [deg]", ""), said), "{:?}", roll("roll [deg]", ""));
    assert!(has(&roll("roll (°)", ""), "whose title says degrees"));
    assert!(!has(&roll("roll [deg]", ", scale = 0.01745"), "degrees"));
    assert!(!has(&roll("roll [rad]", ""), "degrees"));
    let surge = |title: &str, scale: &str| {
        let columns = format!("{{ FILE, columns = {{ time = \"t\", x = \"{title}\" }}{scale} }}");
        recorded(&format!("t,{title}"), "0,0\n0.5,1\n1,0", &columns)
    };
    let said = "the motion of `tank` goes by the column `x [mm]`, whose title says mm, times scale = 1, in metres: by \
                up to 1 m (scale = 0.001 makes metres of mm)";
    assert!(has(&surge("x [mm]", ""), said), "{:?}", surge("x [mm]", ""));
    assert!(!has(&surge("x [mm]", ", scale = -1e-3"), "whose title"));
    assert!(!has(&surge("hammer", ""), "whose title"));
}

#[test]
fn one_scale_for_metres_and_degrees() {
    let of = |titles: [&str; 2], scale: f64| {
        let [x, angle] = titles;
        let columns = format!(
            "{{ FILE, columns = {{ time = \"t\", x = \"{x}\", angle = \"{angle}\" }}, pivot = [0.2, 0.0], \
             scale = {scale} }}"
        );
        recorded(&format!("t,{x},{angle}"), "0,0,0\n0.5,0.01,1\n1,0,0", &columns)
    };
    let said = "one scale = 0.01745 in the motion of `tank` is that of the lengths of `x [m]` and of the angles of \
                `roll [deg]`";
    assert!(has(&of(["x [m]", "roll [deg]"], 0.01745), said), "{:?}", of(["x [m]", "roll [deg]"], 0.01745));
    assert!(!has(&of(["x [mm]", "roll [mrad]"], 1e-3), "one scale"));
    assert!(!has(&of(["x", "roll"], 0.5), "one scale"), "half of what was recorded");
}

#[test]
fn a_recorded_swing_of_more_than_a_quarter_of_a_turn() {
    let of = |rows: &str| {
        let columns = "{ FILE, columns = { time = \"t\", angle = \"roll\" }, pivot = [0.2, 0.0] }";
        recorded("t,roll", rows, columns)
    };
    let said = "the motion of `tank` swings by 4";
    assert!(has(&of("0,0\n0.2,4\n0.6,-4\n0.9,0"), said), "{:?}", of("0,0\n0.2,4\n0.6,-4\n0.9,0"));
    assert!(!has(&of("0,0\n0.2,1\n0.9,3.14"), "swings"), "a turn to the other side");
    assert!(!has(&of("0,0\n0.2,0.07\n0.6,-0.07\n0.9,0"), "swings"));
}

#[test]
fn angles_that_are_round_in_radians() {
    let rotated = |angle: &str| {
        plain(&[TANK, WATER, &with(PLATE, &format!("rotate = {{ angle = {angle}, about = [0.21, 0.0] }}\n"))])
    };
    let said = "rotate.angle = 0.7854 of `plate` is in degrees, and as radians it would be 45 degrees";
    assert!(has(&rotated("0.7854"), said), "{:?}", rotated("0.7854"));
    assert!(has(&rotated("-1.5708"), "it would be -90 degrees"));
    for angle in ["0.0", "0.8", "3.0", "45.0", "90.0"] {
        assert!(!has(&rotated(angle), "as radians"), "{angle}");
    }
    let turned = |angle: &str| plain(&[TANK, WATER, &with(PLATE, &format!("lattice_angle = {angle}\n"))]);
    assert!(has(&turned("0.5236"), "lattice_angle = 0.5236 of `plate` is in degrees"));
    assert!(!has(&turned("30.0"), "as radians"));
}

#[test]
fn a_clamp_that_holds_a_part_of_a_section() {
    let said = "the clamp of `plate` holds 2 of the 4 particles of a section, and no section as a whole";
    let of = |lines: &str, clamp: &str| {
        let plate = PLATE.replace("clamp = { min = [0.2, 0.0], max = [0.22, 0.01] }", clamp);
        plain(&[TANK, WATER, &with(&plate, lines)])
    };
    let whole = "clamp = { min = [0.2, 0.0], max = [0.22, 0.01] }";
    let moved = of("translate = [0.01, 0.0]\n", whole);
    assert!(has(&moved, said) && has(&moved, "do not take the clamp's box along"), "{moved:?}");
    let half = of("", "clamp = { min = [0.2, 0.0], max = [0.21, 0.01] }");
    assert!(has(&half, said) && has(&half, "a box over the whole section holds it"), "{half:?}");
    let fine = [
        ("", whole),
        // Turned, cut by a box that reaches across all of it.
        (
            "rotate = { angle = 45.0, about = [0.21, 0.0] }\n",
            "clamp = { min = [0.1, -0.1], max = [0.3, 0.02] }",
        ),
        // Glued by one face.
        ("", "clamp = { min = [0.2, 0.0], max = [0.205, 0.1] }"),
        // A beam on two supports.
        (
            "",
            "clamp = [{ min = [0.2, 0.0], max = [0.205, 0.01] }, { min = [0.2, 0.09], max = [0.205, 0.1] }]",
        ),
    ];
    for (lines, clamp) in fine {
        assert!(!has(&of(lines, clamp), "of a section"), "{lines} {clamp} {:?}", of(lines, clamp));
    }
}

/// A slab that is clamped, and a block on it.
fn stacked(keys: &str, lattice: &str) -> Vec<String> {
    let slab = block("slab", [0.0, 0.0], [0.2, 0.04], "clamp = { min = [0.0, 0.0], max = [0.2, 0.015] }");
    dry(
        &format!("numerics.lattice = \"{lattice}\""),
        keys,
        &format!("{slab}{}", block("block", [0.05, 0.04], [0.15, 0.1], "")),
    )
}

#[test]
fn what_the_nodal_lattice_lacks() {
    let nodal = stacked("", "nodal");
    let mass = "`slab` has 71 % of the mass that its size asks for, and 0.42 times the bending stiffness";
    assert!(has(&nodal, mass), "{nodal:?}");
    let gap = "`slab` and `block` touch, and in the nodal lattice, which has no particles on their faces, they begin \
               0.02 m apart: nothing connects them";
    assert!(has(&nodal, gap), "{nodal:?}");
    let centred = stacked("", "centred");
    assert!(!has(&centred, "of the mass") && !has(&centred, "apart"), "{centred:?}");
    let hypoelastic = "model = \"hypoelastic\"\nsmoothing_ratio = 1.33";
    let nodal = stacked(hypoelastic, "nodal");
    assert!(has(&nodal, mass) && has(&nodal, "pulled apart they part"), "{nodal:?}");
    assert!(!has(&nodal, "hold together"), "{nodal:?}");
    assert!(has(
        &stacked(hypoelastic, "centred"),
        "one continuum of the hypoelastic model: they hold together"
    ));
}

#[test]
fn probes_that_a_tank_leaves() {
    let probes = |shape: &str| {
        format!(
            "[[probe]]\nname = \"p\"\nkind = \"pressure\"\nat = [0.0, 0.05]\n{shape}[[probe]]\nname = \"v\"\n\
             kind = \"velocity\"\nat = [0.05, 0.05]\n[[probe]]\nname = \"level\"\nkind = \"water-level\"\nx = 0.02\n"
        )
    };
    let plate = PLATE.replace("0.01] }", "0.01], with = \"tank\" }");
    let of = |motion: &str, shape: &str| plain(&[&with(TANK, motion), WATER, &plate, &probes(shape)]);
    let pressure = "the probe `p` is fixed in space inside of `tank`, which moves by up to 0.05 m there: the tank \
                    slides by under it (`shape = \"tank\"` takes it along)";
    let others =
        "the probes `v` and `level` are fixed in space inside of `tank`, which moves by up to 0.05 m there";
    let fixed = of(SHAKEN, "");
    assert!(has(&fixed, pressure) && has(&fixed, others), "{fixed:?}");
    let riding = of(SHAKEN, "shape = \"tank\"\n");
    assert!(!has(&riding, "`p`") && has(&riding, others), "{riding:?}");
    let rolling = of("motion = { angle = 0.1, period = 1.0, pivot = [0.2, 0.0] }\n", "");
    assert!(has(&rolling, "`p` is fixed in space"), "{rolling:?}");
    assert!(has(&rolling, "(levels, velocities and fluxes do not turn with a tank)"), "{rolling:?}");
    // By less than half a spacing.
    assert!(!has(&of(&SHAKEN.replace("0.05", "0.002"), ""), "fixed in space"));
    assert!(!has(&plain(&[TANK, WATER, PLATE, &probes("")]), "fixed in space"));
}
