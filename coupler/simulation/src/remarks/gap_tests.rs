//! Gaps between shapes of any outline: what is remarked on, and what is near it not.

use super::tank_tests::{basin, beside, wall, water};
use super::trap_tests::{has, on};

fn polygon(corners: &str, more: &str) -> Vec<String> {
    beside(&wall("rock", &format!("polygon = {corners}\n{more}")))
}

#[test]
fn a_gap_below_a_wall() {
    let dam =
        |foot: f64| beside(&wall("dam", &format!("box = {{ min = [0.3, {foot}], max = [0.34, 0.3] }}")));
    let said = |wide: &str| format!("between `dam` and `tank` is a gap of {wide} spacings, at ");
    assert!(has(&dam(0.01), &said("0.01 m, 1.0")), "{:?}", dam(0.01));
    assert!(has(&dam(0.03), &said("0.03 m, 3.0")), "{:?}", dam(0.03));
    for foot in [0.0, 0.04, 0.1] {
        assert_eq!(dam(foot), [""; 0], "{foot}");
    }
}

#[test]
fn a_gap_where_no_water_comes() {
    let weir = wall("weir", "box = { min = [0.3, 0.0], max = [0.34, 0.3] }");
    let beyond = wall("beyond", "box = { min = [0.7, 0.01], max = [0.74, 0.3] }");
    assert_eq!(beside(&(weir + &beyond)), [""; 0], "still water, and a weir before it");
    assert!(has(&beside(&beyond), "between `beyond` and `tank`"), "water that falls comes there");
}

#[test]
fn gaps_of_outlines() {
    let said = |wide: &str| format!("between `rock` and `tank` is a gap of {wide} spacings, at ");
    // Beaches 3 mm above the floor, and 5 mm before the side wall.
    let lifted = polygon("[[0.5, 0.003], [1.0, 0.003], [1.0, 0.15]]", "");
    assert!(has(&lifted, &said("0.003 m, 0.3")), "{lifted:?}");
    let apart = polygon("[[0.5, 0.0], [0.995, 0.0], [0.995, 0.15]]", "");
    assert!(has(&apart, &said("0.005 m, 0.5")), "{apart:?}");
    // Turned by 3 degrees about its first corner it opens to 1.05 dx.
    let block = "[[0.5, 0.0], [0.7, 0.0], [0.7, 0.06], [0.5, 0.06]]";
    assert!(has(
        &polygon(block, "rotate = { angle = 3.0, about = [0.5, 0.0] }"),
        "between `rock` and `tank`"
    ));
    // Where it lies, and faces of a corner.
    for clear in [block, "[[0.5, 0.0], [1.0, 0.0], [1.0, 0.15]]", "[[0.5, 0.002], [1.0, 0.002], [1.0, 0.15]]"]
    {
        assert!(!has(&polygon(clear, ""), "is a gap"), "{clear}");
    }
    let disc = |y: f64| beside(&wall("rock", &format!("disc = {{ center = [0.6, {y}], radius = 0.05 }}")));
    assert!(has(&disc(0.06), &said("0.01009 m, 1.0")), "{:?}", disc(0.06));
    assert!(!has(&disc(0.1), "is a gap"));
}

#[test]
fn a_slot_between_two_walls_and_one_below_a_plate() {
    let tower =
        |name: &str, x: f64| wall(name, &format!("box = {{ min = [{x}, 0.0], max = [{}, 0.1] }}", x + 0.06));
    let slot = |x: f64| beside(&(tower("a", 0.4) + &tower("b", x)));
    assert!(has(&slot(0.47), "between `a` and `b` is a gap of 0.01 m, 1.0 spacings"), "{:?}", slot(0.47));
    assert!(!has(&slot(0.5), "is a gap"));
    let plate = |foot: f64| {
        on(&format!(
            "resolution = 0.01\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[solid]\ndensity = 1100.0\n\
             youngs_modulus = 6e6\npoissons_ratio = 0.4\n[[shape]]\nname = \"plate\"\nphase = \"solid\"\n\
             box = {{ min = [0.3, {foot}], max = [0.34, 0.3] }}\nclamp = {{ min = [0.3, 0.2], max = [0.34, 0.3] }}\n\
             {}{}",
            basin(),
            water([0.0, 0.3, 0.2])
        ))
    };
    assert!(has(&plate(0.01), "between `plate` and `tank` is a gap of 0.01 m"), "{:?}", plate(0.01));
    assert!(!has(&plate(0.0), "is a gap"));
}
