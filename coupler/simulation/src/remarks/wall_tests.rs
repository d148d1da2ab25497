//! Walls that are thinner than the kernel reaches, what voids take of a shape, and sizes of polygons: what is said.

use super::tests::{PLATE, TANK, WATER, plain};
use super::trap_tests::{has, with};
use super::{placed, remarks};
use halfstep_scene::{Scene, geometry, parse};
use std::path::Path;

const DRIVEN: &str = "no fluid is there at the start, and what moves the fluid may take it there";

fn water(rest: &str) -> Scene {
    let text = format!("resolution = 0.01\nend_time = 2.0\n[fluid]\ndensity = 1000.0\n{rest}");
    parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"))
}

fn wall(name: &str, geometry: &str) -> String {
    format!("[[shape]]\nname = \"{name}\"\nphase = \"wall\"\n{geometry}\n")
}

/// Water 0.3 m deep to the left of x = 0.5 m, between the sides of a tank.
const HELD: &str = "[[shape]]\nname = \"tank\"\nphase = \"wall\"\n\
                    tank = { min = [0.0, 0.0], max = [1.0, 0.6], open = [\"top\"] }\n\
                    [[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [0.5, 0.3] }\n";

fn dam(thickness: f64) -> String {
    let x = 0.5 + thickness;
    wall("thin", &format!("polygon = [[0.5, 0.0], [{x}, 0.0], [{x}, 0.5], [0.5, 0.5]]"))
}

/// The normal of a single row may be that of its dry side.
#[test]
fn a_polygon_of_one_row_in_front_of_water() {
    let held =
        |thickness: f64| remarks(&water(&format!("{HELD}pressure = \"hydrostatic\"\n{}", dam(thickness))));
    for thickness in [0.011, 0.014, 0.015] {
        let found = held(thickness);
        let said = "`thin` is about 1.0 dx thick at [";
        assert!(has(&found, said) && has(&found, "is held weakly"), "{thickness}: {found:?}");
        assert!(!has(&found, DRIVEN), "{found:?}");
    }
    assert_eq!(held(0.04), [""; 0], "as thick as the kernel reaches");
}

/// A lid 0.1 m above still water, one row thick.
#[test]
fn a_thin_wall_above_water_that_moves() {
    let tank = wall("tank", "tank = { min = [0.0, 0.0], max = [0.6, 0.3], open = [\"top\"] }");
    let lid = wall("lid", "box = { min = [0.0, 0.3], max = [0.6, 0.31] }");
    let pool = |lines: &str| {
        format!(
            "[[shape]]\nname = \"water\"\nphase = \"fluid\"\npressure = \"hydrostatic\"\n{lines}\
             box = {{ min = [0.0, 0.0], max = [0.6, 0.2] }}\n"
        )
    };
    let shakes = "motion = { amplitude = [0.05, 0.0], period = 1.2 }\n";
    let said = "`lid` is about 1.0 dx thick at [";
    let still = remarks(&water(&format!("{}{lid}{tank}", pool(""))));
    assert_eq!(still, [""; 0]);
    let all = [
        format!("{}{}{}", pool(""), with(&lid, shakes), with(&tank, shakes)),
        format!("{}{lid}{tank}", pool("velocity = [0.1, 0.0]\n")),
        format!("frame.motion = {{ amplitude = [0.05, 0.0], period = 1.2 }}\n{}{lid}{tank}", pool("")),
        // Water that falls.
        format!("{}{lid}{tank}", pool("").replace("max = [0.6, 0.2]", "max = [0.3, 0.2]")),
    ];
    for scene in all {
        let top = scene.starts_with("frame").then_some(scene.lines().next()).flatten().unwrap_or_default();
        let rest = scene.replacen(top, "", usize::from(!top.is_empty()));
        let text = format!("resolution = 0.01\nend_time = 2.0\n{top}\n[fluid]\ndensity = 1000.0\n{rest}");
        let found = remarks(&parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}")));
        assert!(has(&found, said) && has(&found, DRIVEN), "{found:?}\n{scene}");
    }
}

/// A crest wall on a quay at the end of a flume, and a wave.
#[test]
fn a_thin_wall_that_a_wave_comes_to() {
    let scene = |thickness: f64| {
        let crest = format!("box = {{ min = [3.0, 0.2], max = [{}, 0.3] }}", 3.0 + thickness);
        remarks(&water(&format!(
            "{}{}{}{}[[shape]]\nname = \"water\"\nphase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [3.0, 0.2] }}\n",
            wall(
                "piston",
                "box = { min = [-0.04, 0.0], max = [0.0, 0.5] }\n\
                 motion = { wave = \"solitary\", height = 0.06, depth = 0.2 }"
            ),
            wall("crest", &crest),
            wall("quay", "box = { min = [3.0, 0.0], max = [3.5, 0.2] }"),
            wall("flume", "tank = { min = [-0.1, 0.0], max = [4.0, 0.5], open = [\"left\", \"top\"] }"),
        )))
    };
    let found = scene(0.01);
    assert!(has(&found, "`crest` is about 1.0 dx thick at [3.005, "), "{found:?}");
    assert!(has(&found, DRIVEN), "{found:?}");
    assert!(!has(&scene(0.04), "dx thick"), "{:?}", scene(0.04));
}

#[test]
fn a_void_in_a_polygon_is_no_wrong_size() {
    let void =
        "[[shape]]\nname = \"bubble\"\nphase = \"void\"\nbox = { min = [0.1, 0.1], max = [0.2, 0.2] }\n";
    let polygon = HELD.replace(
        "box = { min = [0.0, 0.0], max = [0.5, 0.3] }",
        "polygon = [[0.0, 0.0], [0.5, 0.0], [0.5, 0.3], [0.0, 0.3]]",
    );
    let scene = water(&format!("{void}{polygon}{}", dam(0.04)));
    let found = remarks(&scene);
    assert!(found.len() == 1 && found[0].starts_with("the void `bubble` is empty, and no air"), "{found:?}");
    let layout = geometry::layout::<2>(&scene);
    let listed = placed(&scene, &layout)[1].to_string();
    assert!(listed.contains("0.15 m²; 1400 particles"), "{listed}");
}

/// A void in the water of a tank takes nothing of its walls; one in a wall does.
#[test]
fn a_void_in_a_cavity_takes_nothing_of_the_tank() {
    let block = "[[solid]]\nname = \"block\"\nmodel = \"rigid\"\ndensity = 400.0\n\
                 [[shape]]\nname = \"block\"\nphase = \"solid\"\nsolid = \"block\"\n\
                 box = { min = [0.6, 0.3], max = [0.7, 0.4] }\n";
    let void = |x: f64| {
        format!(
            "[[shape]]\nname = \"bubble\"\nphase = \"void\"\ndisc = {{ center = [{x}, 0.1], radius = 0.04 }}\n"
        )
    };
    let said = "`bubble` may take a part of `tank`";
    let of = |x: f64| remarks(&water(&format!("{block}{}{HELD}", void(x))));
    assert!(!has(&of(0.2), said), "{:?}", of(0.2));
    assert!(has(&of(0.0), said), "{:?}", of(0.0));
}

/// Of 15 mm there is one row of 10 mm; a block of 0.2 x 0.3 m is hollow beyond its rows, and has its area.
#[test]
fn a_polygon_of_wall_has_the_area_of_its_rows() {
    let block = wall("block", "polygon = [[0.7, 0.0], [0.9, 0.0], [0.9, 0.3], [0.7, 0.3]]");
    let scene = water(&format!("{HELD}{}{block}", dam(0.015)));
    let layout = geometry::layout::<2>(&scene);
    let [thin, thick] = [2, 3].map(|k| placed(&scene, &layout)[k].to_string());
    assert!(thin.contains("0.0075 m² asked, 0.005 m² computed; 50 particles"), "{thin}");
    assert!(thick.contains("0.06 m²; ") && !thick.contains("600 particles"), "{thick}");
    assert!(!has(&remarks(&scene), "large in the scene"), "a wall's thickness is nobody's question");
}

#[test]
fn a_thin_polygon_is_refused_by_its_thickness() {
    let text = format!(
        "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n{}{}",
        HELD.replace("0.6]", "0.7]"),
        dam(0.015)
    );
    let wrong = parse(&text, Path::new("x.toml"), &[]).unwrap_err();
    let said = format!("{wrong:?}");
    assert!(said.contains("is 0.015 m thin at [") && said.contains("one particle needs 0.1 m"), "{said}");
}

/// Its own thick walls are no remark, whatever the fluid does.
#[test]
fn a_tank_holds_what_falls_in_it() {
    assert_eq!(plain(&[TANK, &with(WATER, "velocity = [0.5, 0.0]\n"), PLATE]), [""; 0]);
}

#[test]
fn a_wall_thinner_than_the_support() {
    // 2h = 3 dx = 15 mm; a weir of 10 mm in the water is two rows.
    let weir =
        "[[shape]]\nname = \"weir\"\nphase = \"wall\"\nbox = { min = [0.05, 0.0], max = [0.06, 0.08] }\n";
    let found = plain(&[TANK, weir, WATER, PLATE]);
    let thin: Vec<_> = found.iter().filter(|text| text.contains("thick")).collect();
    assert_eq!(thin.len(), 1, "{found:?}");
    assert!(thin[0].starts_with("`weir` is about 2.0 dx thick at [0.05"), "{thin:?}");
    let thick = weir.replace("0.06, 0.08]", "0.065, 0.08]");
    assert!(plain(&[TANK, &thick, WATER, PLATE]).iter().all(|text| !text.contains("thick")));
    // The same as a polygon and as a turned box.
    let polygon = weir.replace(
        "box = { min = [0.05, 0.0], max = [0.06, 0.08] }",
        "polygon = [[0.05, 0.0], [0.06, 0.0], [0.06, 0.08], [0.05, 0.08]]",
    );
    assert!(
        plain(&[TANK, &polygon, WATER, PLATE]).iter().any(|text| text.contains("`weir` is about 2.0 dx"))
    );
    let turned = weir.replace("max = [0.06, 0.08] }", "max = [0.06, 0.08] }\nrotate = { angle = 30.0 }");
    assert!(plain(&[TANK, &turned, WATER, PLATE]).iter().any(|text| text.contains("`weir` is about 2.0 dx")));
}
