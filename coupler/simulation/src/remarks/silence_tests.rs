//! Valid scenes that ran in silence and meant something else: what is remarked on each, and on what is near it not.

use super::remarks;
use super::tests::{PLATE, TANK, WATER, plain};
use super::trap_tests::{has, with};
use halfstep_scene::parse;
use std::path::Path;

/// Remarks on a whole scene of water, and of an elastic solid of this model and Poisson's ratio.
fn with_solid(keys: &str, rest: &str) -> Vec<String> {
    let text = format!(
        "resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[solid]\ndensity = 1100.0\n\
         youngs_modulus = 12e6\n{keys}\n{TANK}{WATER}{rest}"
    );
    remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
}

fn wall(name: &str, geometry: &str) -> String {
    format!("[[shape]]\nname = \"{name}\"\nphase = \"wall\"\n{geometry}\n")
}

#[test]
fn a_wall_without_particles() {
    let said = "`dam` has no particle, and nothing is where it stands";
    // A slope 4.6 mm thick, its rows 5 mm apart.
    let of = |thick: f64| {
        let dam = wall(
            "dam",
            &format!(
                "polygon = [[0.15, 0.0], [{}, 0.0], [{}, 0.1], [0.25, 0.1]]",
                0.15 + thick,
                0.25 + thick
            ),
        );
        plain(&[TANK, &dam, WATER, PLATE])
    };
    assert!(has(&of(0.0065), said), "{:?}", of(0.0065));
    assert!(!has(&of(0.06), said));
}

#[test]
fn water_of_which_a_part_alone_stands_on_something() {
    let water = |bottom: f64| {
        format!(
            "[[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, {bottom}], max = [0.19, 0.1] }}\n"
        )
    };
    let baffle = wall("baffle", "box = { min = [0.09, -0.02], max = [0.12, 0.15] }");
    let hanging = plain(&[TANK, &baffle, &water(0.02), PLATE]);
    assert!(has(&hanging, "`water` hangs in the air: nothing is right below"), "{hanging:?}");
    assert!(!has(&plain(&[TANK, &baffle, &water(0.0), PLATE]), "hangs"));
    // Of a box that reaches below the floor the floor has the places.
    assert_eq!(plain(&[TANK, &water(-0.01), PLATE]).iter().filter(|text| text.contains("hangs")).count(), 0);
}

#[test]
fn a_clamp_that_leaves_its_wall() {
    let motion = "motion = { amplitude = [0.01, 0.0], period = 1.0 }\n";
    let rooted = PLATE
        .replace("0.0], max = [0.22, 0.1]", "-0.02], max = [0.22, 0.1]")
        .replace("clamp = { min = [0.2, 0.0]", "clamp = { min = [0.2, -0.02]");
    let said =
        "the clamp of `plate` moves, and `tank`, in which it stands, does not: it leaves a gap in the wall";
    assert!(has(&plain(&[TANK, WATER, &with(&rooted, motion)]), said));
    assert!(!has(&plain(&[TANK, WATER, &rooted]), "leaves a gap"));
    assert!(!has(&plain(&[&with(TANK, motion), WATER, &with(&rooted, motion)]), "leaves a gap"));
    // On the floor and not in it.
    assert!(!has(&plain(&[TANK, WATER, &with(PLATE, motion)]), "leaves a gap"));
}

#[test]
fn a_plate_that_locks() {
    let said =
        "`plate` is 4 particles across, and with poissons_ratio = 0.49 the total-Lagrangian model locks";
    assert!(has(&with_solid("poissons_ratio = 0.49", PLATE), said));
    assert!(!has(&with_solid("poissons_ratio = 0.49\nmodel = \"finite-element\"", PLATE), "locks"));
    assert!(!has(&with_solid("poissons_ratio = 0.44", PLATE), "locks"));
    assert!(!has(&with_solid("poissons_ratio = 0.49\nplane = \"stress\"", PLATE), "locks"));
    let fine = with(PLATE, "spacing = 0.0025\n");
    assert!(!has(&with_solid("poissons_ratio = 0.49", &fine), "locks"), "8 across");
}

#[test]
fn an_irregular_arrangement_of_a_thin_plate() {
    let said = "arrangement = \"irregular\" of `solid` does nothing: two rows at the surface";
    let irregular = "poissons_ratio = 0.4\narrangement = \"irregular\"";
    // 20 mm thick: 4 and 8 across.
    assert!(has(&with_solid(irregular, PLATE), said), "{:?}", with_solid(irregular, PLATE));
    assert!(!has(&with_solid("poissons_ratio = 0.4", PLATE), said));
    assert!(!has(&with_solid(irregular, &with(PLATE, "spacing = 0.0025\n")), said));
}

#[test]
fn a_wall_that_goes_through_a_plate() {
    let ram = |contact: bool| {
        let geometry =
            "box = { min = [0.25, 0.02], max = [0.28, 0.08] }\nmotion = { velocity = [-0.5, 0.0] }\n";
        wall("ram", &format!("{geometry}contact = {contact}"))
    };
    let said = "`ram` goes through `plate` from about 0.0";
    assert!(has(&plain(&[TANK, WATER, PLATE, &ram(false)]), said));
    assert!(!has(&plain(&[TANK, WATER, PLATE, &ram(true)]), "goes through `plate`"));
}

#[test]
fn a_void_that_takes_nothing() {
    let void =
        "[[shape]]\nname = \"drain\"\nphase = \"void\"\nbox = { min = [0.3, -0.05], max = [0.33, 0.0] }\n";
    let said = "the void `drain` takes nothing: `tank`, in which it lies, stands before it";
    assert!(has(&plain(&[TANK, void, WATER, PLATE]), said));
    assert!(!has(&plain(&[void, TANK, WATER, PLATE]), "takes nothing"));
    let aside = void.replace("[0.3, -0.05], max = [0.33, 0.0]", "[0.3, 0.5], max = [0.33, 0.6]");
    assert!(has(
        &plain(&[&aside, TANK, WATER, PLATE]),
        "the void `drain` takes nothing: no shape has a place in it"
    ));
}

#[test]
fn bodies_of_which_nothing_moves() {
    let whole = PLATE.replace("max = [0.22, 0.01] }\n", "max = [0.22, 0.1] }\n");
    let said = "all 80 particles of `plate` are clamped: it neither moves nor bends";
    assert!(has(&plain(&[TANK, WATER, &whole]), said), "{:?}", plain(&[TANK, WATER, &whole]));
    assert!(!has(&plain(&[TANK, WATER, PLATE]), "are clamped"));
}

#[test]
fn loads_of_shapes_that_are_repeated() {
    let load = "load = { within = { min = [0.2, 0.095], max = [0.205, 0.1] }, traction = [10.0, 0.0] }\n";
    let repeat = "repeat = { count = 3, step = [0.05, 0.0] }\n";
    let said = "the load of `plate` acts on 1 of its 3 copies: `repeat` does not take its box along";
    let of = |lines: &str| plain(&[TANK, WATER, &with(PLATE, lines)]);
    assert!(has(&of(&format!("{load}{repeat}")), said), "{:?}", of(&format!("{load}{repeat}")));
    assert!(!has(&of(load), "copies"));
}

fn probe(lines: &str) -> String {
    format!("[[probe]]\nname = \"p\"\n{lines}\n")
}

#[test]
fn a_flux_through_a_short_line() {
    let line = |length: f64| probe(&format!("kind = \"flux\"\nfrom = [0.15, 0.0]\nto = [0.15, {length}]"));
    let said = "the line of the probe `p` is 1.0 spacings long";
    assert!(has(&plain(&[TANK, WATER, PLATE, &line(0.005)]), said));
    assert!(!has(&plain(&[TANK, WATER, PLATE, &line(0.015)]), "spacings long"));
}

#[test]
fn a_gauge_that_feels_both_faces() {
    let gauge = probe("kind = \"pressure\"\nat = [0.22, 0.05]\nshape = \"plate\"");
    let thin = PLATE.replace("0.22", "0.21");
    let on_thin = gauge.replace("0.22", "0.21");
    let said =
        "the gauge `p` on `plate` averages the fluid within 2h = 0.015 m, and the shape is 0.01 m thick";
    assert!(has(&plain(&[TANK, WATER, &thin, &on_thin]), said));
    assert!(!has(&plain(&[TANK, WATER, PLATE, &gauge]), "the gauge"), "0.02 m");
}

#[test]
fn motions_in_degrees_or_millimetres() {
    let of = |motion: &str| plain(&[&with(TANK, &format!("motion = {motion}\n")), WATER, PLATE]);
    let swing = |angle: f64| of(&format!("{{ pivot = [0.2, 0.0], angle = {angle}, period = 1.0 }}"));
    assert!(has(&swing(4.0), "the motion of `tank` swings by 4 rad, 229 degrees: angles are in radians"));
    assert!(!has(&swing(0.07), "radians"));
    let shake = |amplitude: f64| of(&format!("{{ amplitude = [{amplitude}, 0.0], period = 10.0 }}"));
    assert!(has(&shake(10.0), "the motion of `tank` leads 10 m away, "));
    assert!(!has(&shake(0.2), "leads"));
}

#[test]
fn a_hull_that_begins_full_of_water() {
    let water = |top: f64| {
        format!(
            "[[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.4, {top}] }}\n"
        )
    };
    // Hollow, 0.2 m x 0.1 m, of four rows, open where `open` says.
    let hull = |y: f64, open: bool| {
        let lid = if open { y + 0.1 } else { y + 0.08 };
        let hole = format!("[[0.12, {}], [0.28, {}], [0.28, {lid}], [0.12, {lid}]]", y + 0.02, y + 0.02);
        let outline = match open {
            false => format!(
                "polygon = [[0.1, {y}], [0.3, {y}], [0.3, {t}], [0.1, {t}]]\nholes = [{hole}]",
                t = y + 0.1
            ),
            true => format!(
                "polygon = [[0.1, {y}], [0.3, {y}], [0.3, {t}], [0.28, {t}], [0.28, {i}], [0.12, {i}], [0.12, {t}], \
                 [0.1, {t}]]",
                t = y + 0.1,
                i = y + 0.02
            ),
        };
        format!("[[shape]]\nname = \"hull\"\nphase = \"solid\"\n{outline}\n")
    };
    let void =
        "[[shape]]\nname = \"air\"\nphase = \"void\"\nbox = { min = [0.11, 0.09], max = [0.29, 0.3] }\n";
    let said = "of the particles of `water` begin inside of `hull`, parted from the rest";
    let of = |water: &str, hull: &str, before: &str| plain(&[TANK, before, hull, water]);
    // Closed under water, and open above it.
    let under = of(&water(0.25), &hull(0.08, false), "");
    assert!(has(&under, said), "{under:?}");
    let afloat = of(&water(0.14), &hull(0.08, true), "");
    assert!(has(&afloat, said), "{afloat:?}");
    // Below the surface the open hull's water is one with the rest.
    let sunk = of(&water(0.25), &hull(0.08, true), "");
    assert!(!has(&sunk, "begin inside"), "{sunk:?}");
    let dry = plain(&[TANK, &hull(0.08, true), void, &water(0.14)]);
    assert!(!has(&dry, "begin inside"), "{dry:?}");
    // Drops, one of which falls beside a plate.
    let drop = "[[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.17, 0.05], max = [0.2, 0.08] }\n\
                repeat = { count = 2, step = [-0.05, 0.0] }\n";
    let drops = plain(&[TANK, PLATE, drop]);
    assert!(!has(&drops, "begin inside"), "{drops:?}");
    // A plate parts a basin: on both sides the water stands on the floor.
    let weir = plain(&[TANK, PLATE, &water(0.08)]);
    assert!(!has(&weir, "begin inside"), "{weir:?}");
}

#[test]
fn a_background_pressure_under_a_free_surface() {
    let said = "fluid.background_pressure = 3000 Pa drives the fluid apart";
    let of = |walls: &str, water: &str| {
        let text = format!(
            "resolution = 0.005\nend_time = 1.0\n[fluid]\ndensity = 1000.0\nbackground_pressure = 3000.0\n\
             {walls}{water}"
        );
        remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
    };
    assert!(has(&of(TANK, WATER), said), "{:?}", of(TANK, WATER));
    let closed = TANK.replace(", open = [\"top\"]", "");
    let full = WATER.replace("max = [0.1, 0.1]", "max = [0.4, 0.3]");
    assert!(!has(&of(&closed, &full), "drives the fluid apart"), "{:?}", of(&closed, &full));
}

#[test]
fn a_wall_that_pushes_and_stays() {
    let of = |velocity: &str| {
        let belt = format!("box = {{ min = [0.1, 0.0], max = [0.13, 0.2] }}\nvelocity = {velocity}");
        plain(&[TANK, &wall("belt", &belt), WATER, PLATE])
    };
    assert!(
        has(&of("[1.0, 0.0]"), "`belt` has a velocity of 1 m/s across its face at [0.1025"),
        "{:?}",
        of("[1.0, 0.0]")
    );
    assert!(!has(&of("[0.0, 1.0]"), "across its face"), "{:?}", of("[0.0, 1.0]"));
}

#[test]
fn a_wall_of_a_tank_of_boxes_that_does_not_go_along() {
    let motion = "motion = { amplitude = [0.01, 0.0], period = 1.0 }";
    let of = |left: &str, right: &str| {
        let shapes = [
            ("floor", "box = { min = [-0.03, -0.03], max = [0.43, 0.0] }", motion),
            ("left", "box = { min = [-0.03, 0.0], max = [0.0, 0.3] }", left),
            ("right", "box = { min = [0.4, 0.0], max = [0.43, 0.3] }", right),
        ];
        let walls = shapes.map(|(name, geometry, motion)| wall(name, &format!("{geometry}\n{motion}")));
        plain(&[&walls.concat(), PLATE, &WATER.replace("[0.1, 0.1]", "[0.4, 0.1]")])
    };
    let said =
        "`right` stays where it is, and `floor`, which it touches, moves with 1 more wall around the fluid";
    assert!(has(&of(motion, ""), said), "{:?}", of(motion, ""));
    assert!(!has(&of(motion, motion), "`right` stays"));
    let other = "motion = { amplitude = [0.01, 0.0], period = 1.1 }";
    let apart = "`floor` and `right` touch, and move otherwise than each other beside the fluid";
    assert!(has(&of(motion, other), apart), "{:?}", of(motion, other));
    assert!(!has(&of(motion, motion), "move otherwise"));
}
