//! Tanks that do not hold their water, domains that cut it off, gaps, and walls where none is needed: what is remarked
//! on each, and on what is near it not.

use super::remarks;
use super::trap_tests::has;
use halfstep_scene::parse;
use std::path::Path;

/// Remarks on a scene at 0.01 m, with lines before `[fluid]` and keys of the fluid.
fn with_keys(lines: &str, keys: &str, rest: &str) -> Vec<String> {
    let text = format!(
        "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, -9.81]\n{lines}\n[fluid]\ndensity = 1000.0\n{keys}\n{rest}"
    );
    remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")))
}

pub(super) fn of(rest: &str) -> Vec<String> {
    with_keys("", "", rest)
}

pub(super) fn wall(name: &str, geometry: &str) -> String {
    format!("[[shape]]\nname = \"{name}\"\nphase = \"wall\"\n{geometry}\n")
}

/// A tank from the origin on.
pub(super) fn tank(name: &str, [x, wide, high]: [f64; 3], open: &str) -> String {
    wall(name, &format!("tank = {{ min = [{x}, 0.0], max = [{}, {high}], open = [{open}] }}", x + wide))
}

/// Still water between two places, up to a level.
pub(super) fn water([from, to, level]: [f64; 3]) -> String {
    format!(
        "[[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [{from}, 0.0], max = [{to}, {level}] }}\n\
         pressure = \"hydrostatic\"\n"
    )
}

pub(super) const OPEN: &str = "\"top\"";

/// Shapes beside a basin of 1 m with 0.3 m of water, 0.2 m deep, at a spacing of 10 mm.
pub(super) fn beside(shapes: &str) -> Vec<String> {
    of(&format!("{shapes}{}{}", basin(), water([0.0, 0.3, 0.2])))
}

pub(super) fn basin() -> String {
    tank("tank", [0.0, 1.0, 0.4], OPEN)
}

#[test]
fn a_domain_that_cuts_water_off() {
    let in_domain = |domain: &str, to: f64, motion: &str| {
        let tank = basin().replace("phase", &format!("{motion}phase"));
        with_keys(&format!("numerics.domain = {domain}"), "", &format!("{tank}{}", water([0.0, to, 0.2])))
    };
    let small = "{ min = [-0.1, -0.1], max = [0.5, 1.0] }";
    let found = in_domain(small, 1.0, "");
    let said =
        "numerics.domain takes 1000 of 2000 fluid particles out in the first step: they begin outside of it";
    assert!(has(&found, said) && !has(&found, "inside of"), "{found:?}");
    let ends = "numerics.domain ends at x = 0.5 m inside of `tank`, whose wall stands at 1 m";
    assert!(has(&in_domain(small, 0.3, ""), ends), "{:?}", in_domain(small, 0.3, ""));
    let fits = "{ min = [-0.05, -0.05], max = [1.05, 0.3] }";
    assert_eq!(in_domain(fits, 0.3, ""), [""; 0], "as far as the walls, and low where the tank is open");
    let shaken = in_domain(fits, 1.0, "motion = { amplitude = [0.2, 0.0], period = 1.0 }\n");
    let comes = "numerics.domain ends at x = -0.05 m inside of `tank`, whose wall comes to stand at -0.2 m";
    assert!(has(&shaken, comes), "{shaken:?}");
    let wide = "{ min = [-0.3, -0.05], max = [1.3, 0.3] }";
    let shaken = in_domain(wide, 1.0, "motion = { amplitude = [0.2, 0.0], period = 1.0 }\n");
    assert!(!has(&shaken, "numerics.domain"), "{shaken:?}");
}

#[test]
fn water_above_the_rim() {
    let level =
        |level: f64| of(&format!("{}{}", tank("tank", [0.0, 1.0, 0.2], OPEN), water([0.0, 1.0, level])));
    let found = level(0.3);
    assert!(has(&found, "`water` flows out of the scene toward the left: nothing is beside"), "{found:?}");
    assert!(has(&found, "toward the right"), "{found:?}");
    assert_eq!(level(0.2), [""; 0], "full to the brim");
}

#[test]
fn water_at_an_open_side() {
    let open = |side: &str, to: f64| {
        of(&format!("{}{}", tank("tank", [0.0, 1.0, 0.4], side), water([0.0, to, 0.2])))
    };
    let said = "`water` flows out of the scene toward the right: nothing is beside";
    assert!(has(&open("\"top\", \"right\"", 1.0), said));
    assert_eq!(open("\"top\", \"right\"", 0.5), [""; 0], "a dam that breaks and runs off");
    let lidded = open("\"right\"", 0.5);
    assert!(has(&lidded, said) && has(&lidded, "closed above and `open` there"), "{lidded:?}");
    // What closes the side may be another wall.
    let gate = wall("gate", "box = { min = [1.0, 0.0], max = [1.04, 0.4] }");
    let sides = tank("tank", [0.0, 1.1, 0.4], "\"top\", \"right\"");
    assert_eq!(of(&format!("{gate}{sides}{}", water([0.0, 1.0, 0.2]))), [""; 0]);
}

#[test]
fn gravity_along_x_in_a_tank_that_is_open_above() {
    let scene = format!(
        "resolution = 0.01\nend_time = 1.0\ngravity = [-9.81, 0.0]\n[fluid]\ndensity = 1000.0\n{}{}",
        basin(),
        water([0.0, 1.0, 0.2])
    );
    let found = remarks(&parse(&scene, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")));
    assert!(has(&found, "`water` flows out of the scene toward the top"), "{found:?}");
}

#[test]
fn gravity_that_points_up() {
    let scene = format!(
        "resolution = 0.01\nend_time = 1.0\ngravity = [0.0, 9.81]\n[fluid]\ndensity = 1000.0\n{}{}",
        basin(),
        water([0.0, 1.0, 0.2])
    );
    let found = remarks(&parse(&scene, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")));
    assert!(
        has(&found, "`water` hangs in the air: nothing is right below it, so it falls up, as gravity"),
        "{found:?}"
    );
}

#[test]
fn a_gap_beside_still_water() {
    let gate = wall("gate", "box = { min = [0.3, 0.0], max = [0.34, 0.4] }");
    let to = |to: f64| of(&format!("{gate}{}{}", basin(), water([0.0, to, 0.2])));
    let said = "`water` ends at x = 0.26 m, 0.04 m, 4.0 spacings, before what stands there";
    assert!(has(&to(0.26), said), "{:?}", to(0.26));
    for end in [0.3, 0.25] {
        assert_eq!(to(end), [""; 0], "{end}");
    }
    // What is no still water falls as it is meant to.
    let falls = water([0.0, 0.26, 0.2]).replace("pressure = \"hydrostatic\"\n", "");
    assert_eq!(of(&format!("{gate}{}{falls}", basin())), [""; 0]);
}

#[test]
fn a_gate_that_is_lower_than_its_water() {
    let gate = |top: f64, to: f64| {
        let gate = wall(
            "gate",
            &format!(
                "box = {{ min = [0.3, 0.0], max = [0.34, {top}] }}\nmotion = {{ velocity = [0.0, 1.5], start = 0.3 }}"
            ),
        );
        let more = water([0.34, to, 0.2]).replace("\"water\"", "\"more\"");
        let more = if to > 0.34 { more } else { String::new() };
        of(&format!("{gate}{}{}{more}", basin(), water([0.0, 0.3, 0.2])))
    };
    let said =
        "`gate` ends 0.05 m below the surface of `water`, which stands beside it: the water flows over it";
    assert!(has(&gate(0.15, 0.0), said), "{:?}", gate(0.15, 0.0));
    assert_eq!(gate(0.2, 0.0), [""; 0]);
    let outline = "polygon = [[0.3, 0.0], [0.34, 0.0], [0.34, 0.15], [0.3, 0.15]]\nmotion = { velocity = [0.0, 1.5], \
                   start = 0.3 }";
    let of_polygon = of(&format!("{}{}{}", wall("gate", outline), basin(), water([0.0, 0.3, 0.2])));
    assert!(has(&of_polygon, said), "{of_polygon:?}");
    assert!(!has(&gate(0.15, 1.0), "flows over it"), "water on both sides");
}

#[test]
fn tanks_that_overlap() {
    let two = |x: f64, open: [&str; 2]| {
        of(&format!(
            "{}{}{}",
            tank("tank", [0.0, 1.0, 0.4], open[0]),
            tank("other", [x, 1.0, 0.4], open[1]),
            water([0.0, 0.3, 0.2])
        ))
    };
    let said = "`tank` and `other` overlap: walls of each stand in the other's cavity";
    assert!(has(&two(1.0, [OPEN; 2]), said), "{:?}", two(1.0, [OPEN; 2]));
    assert_eq!(two(1.1, [OPEN; 2]), [""; 0], "with both walls between them");
    assert_eq!(two(1.0, ["\"top\", \"right\"", "\"top\", \"left\""]), [""; 0], "one of two halves");
    let inner = wall("inner", "tank = { min = [0.5, 0.04], max = [0.8, 0.3], open = [\"top\"] }");
    assert_eq!(of(&format!("{}{inner}{}", basin(), water([0.0, 0.3, 0.2]))), [""; 0], "one in the other");
}

#[test]
fn copies_beyond_a_tank() {
    let piles = |count: u32| {
        let pile = wall(
            "pile",
            &format!(
                "box = {{ min = [0.3, 0.1], max = [0.34, 0.2] }}\nrepeat = {{ count = {count}, step = [0.3, 0.0] }}"
            ),
        );
        of(&format!("{pile}{}{}", basin(), water([0.0, 1.0, 0.2])))
    };
    let said = "1 of the 4 copies of `pile` stand outside of `tank`, beyond its closed sides";
    assert!(has(&piles(4), said), "{:?}", piles(4));
    assert_eq!(piles(3), [""; 0]);
}

#[test]
fn a_block_in_the_floor() {
    let block = |low: f64, lines: &str| {
        let high = low + 0.04;
        let block = wall("block", &format!("box = {{ min = [0.5, {low}], max = [0.6, {high}] }}\n{lines}"));
        of(&format!("{block}{}{}", basin(), water([0.0, 0.3, 0.2])))
    };
    let said = "`block` lies in the walls of `tank` altogether, which are outside of its `min` and `max`";
    assert!(has(&block(-0.04, ""), said), "{:?}", block(-0.04, ""));
    assert_eq!(block(0.0, ""), [""; 0], "on the floor");
    assert!(!has(&block(-0.04, "contact = true"), "altogether"));
    let gauge = "[[probe]]\nname = \"lift\"\nkind = \"force\"\nshape = \"block\"\n";
    assert!(!has(
        &of(&format!(
            "{}{}{}{gauge}",
            wall("block", "box = { min = [0.5, -0.04], max = [0.6, 0.0] }"),
            basin(),
            water([0.0, 1.0, 0.2])
        )),
        "altogether"
    ));
}

#[test]
fn water_that_is_laid_over_a_beach_or_a_body() {
    let beach =
        |foot: f64, tip: f64| wall("slope", &format!("polygon = [[{foot}, 0.0], [4.0, 0.0], [4.0, {tip}]]"));
    let flume = tank("tank", [0.0, 4.0, 0.4], OPEN);
    for (foot, tip) in [(2.0, 0.35), (1.0, 0.3), (2.5, 0.25)] {
        let found = of(&format!("{}{flume}{}", beach(foot, tip), water([0.0, 4.0, 0.2])));
        assert_eq!(found, [""; 0], "{foot} {tip}");
    }
    let step = wall("step", "box = { min = [0.5, 0.0], max = [1.0, 0.1] }");
    assert_eq!(of(&format!("{step}{}{}", basin(), water([0.0, 1.0, 0.2]))), [""; 0]);
    // In the wall of a tank it is no overlay.
    let beside = of(&format!("{}{}", basin(), water([0.9, 1.1, 0.2])));
    assert!(has(&beside, "`water` has"), "{beside:?}");
}

#[test]
fn a_drop_that_is_thrown() {
    let drop = |lines: &str| {
        of(&format!(
            "{}{}[[shape]]\nname = \"drop\"\nphase = \"fluid\"\ndisc = {{ center = [0.5, 0.3], radius = 0.0505 }}\n{lines}",
            basin(),
            water([0.0, 1.0, 0.1])
        ))
    };
    assert!(has(&drop(""), "`drop` hangs in the air"));
    assert!(!has(&drop("velocity = [0.0, -1.0]\n"), "hangs"), "{:?}", drop("velocity = [0.0, -1.0]\n"));
}

#[test]
fn a_sound_speed_of_real_water() {
    let sound = |speed: f64| {
        with_keys("", &format!("sound_speed = {speed}"), &format!("{}{}", basin(), water([0.0, 0.3, 0.2])))
    };
    let said = "fluid.sound_speed = 1500 m/s is 75.7 times what \"auto\" would give, 19.81 m/s";
    assert!(has(&sound(1500.0), said), "{:?}", sound(1500.0));
    assert_eq!(sound(50.0), [""; 0]);
}

#[test]
fn a_kinematic_viscosity() {
    let viscosity = |value: &str| {
        with_keys("", &format!("viscosity = {value}"), &format!("{}{}", basin(), water([0.0, 0.3, 0.2])))
    };
    let said =
        "fluid.viscosity = 1e-6 Pa s in a fluid of the density of water is the kinematic viscosity of water";
    assert!(has(&viscosity("1e-6"), said), "{:?}", viscosity("1e-6"));
    let said = "fluid.viscosity = 1.002 Pa s in a fluid of the density of water, which has 0.001 Pa s";
    assert!(has(&viscosity("1.002"), said), "{:?}", viscosity("1.002"));
    for fine in ["1e-3", "1e-5", "0.0", "2.0"] {
        assert_eq!(viscosity(fine), [""; 0], "{fine}");
    }
}

#[test]
fn what_has_nothing_to_act_on() {
    let pool = format!("{}{}", basin(), water([0.0, 0.3, 0.2]));
    let idle = of(&format!("{pool}[effects]\nviscosity = \"on\"\n"));
    assert!(has(&idle, "effects.viscosity is \"on\" and does nothing: fluid.viscosity is zero"), "{idle:?}");
    let acts = with_keys("", "viscosity = 0.001", &format!("{pool}[effects]\nviscosity = \"on\"\n"));
    assert_eq!(acts, [""; 0]);
    let solid = of(&format!("{pool}[effects]\nfracture = \"on\"\n"));
    assert!(has(&solid, "effects.fracture is \"on\" and does nothing"), "{solid:?}");
    let sticks = pool.replacen("phase", "slip = \"none\"\nphase", 1);
    let said =
        "`tank` has slip = \"none\", and the fluid has no viscosity: what drags there is the artificial one";
    assert!(has(&of(&sticks), said), "{:?}", of(&sticks));
    assert_eq!(with_keys("", "viscosity = 2.0", &sticks), [""; 0]);
}

#[test]
fn a_belt_that_nothing_feels() {
    let belt = |lines: &str| {
        let floor = wall(
            "belt",
            &format!("box = {{ min = [0.0, -0.04], max = [1.0, 0.0] }}\nvelocity = [1.0, 0.0]\n{lines}"),
        );
        let sides = wall("left", "box = { min = [-0.04, -0.04], max = [0.0, 0.4] }");
        with_keys("", "viscosity = 2.0", &format!("{sides}{floor}{}", water([0.0, 0.3, 0.2])))
    };
    let said = "the `velocity` of `belt` is that of a belt, and nothing feels it: fluid slips along it";
    assert!(has(&belt(""), said), "{:?}", belt(""));
    assert!(!has(&belt("slip = \"none\""), "nothing feels it"));
}
