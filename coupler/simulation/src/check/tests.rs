//! What `halfstep check` says of scenes by hand.

use super::{Check, check, duration};
use halfstep_sph::lane::Isa;
use std::path::Path;

/// A rigid block of 1000 kg/m³, 0.2 x 0.1 m, of the solid `block` on a longer one of the solid `base`.
fn two_blocks(more: &str) -> Check {
    let text = format!(
        "resolution = 0.02\nend_time = 0.5\ngravity = [0.0, -9.81]\n{more}\
         [[solid]]\nname = \"block\"\nmodel = \"rigid\"\ndensity = 1000.0\n\
         [[solid]]\nname = \"base\"\nmodel = \"rigid\"\ndensity = 2000.0\n\
         [[shape]]\nname = \"b\"\nphase = \"solid\"\nsolid = \"block\"\n\
         box = {{ min = [0.1, 0.0], max = [0.3, 0.1] }}\n\
         [[shape]]\nname = \"f\"\nphase = \"solid\"\nsolid = \"base\"\n\
         box = {{ min = [0.0, -0.1], max = [0.6, 0.0] }}\nmotion = {{ velocity = [0.1, 0.0] }}\n"
    );
    let scene = halfstep_scene::parse(&text, Path::new("x.toml"), &[]).unwrap_or_else(|e| panic!("{e:?}"));
    check(&scene, Isa::detect()).expect("in the plane")
}

fn pair(keys: &str) -> Check {
    two_blocks(&format!("[[contact]]\nsolids = [\"block\", \"base\"]\n{keys}\n"))
}

#[test]
fn solids_touch_or_pass_through_each_other() {
    let touching = pair("friction = 0.2").to_string();
    assert!(touching.contains("between solids  block and base touch\n"), "{touching}");
    assert!(!touching.contains("pass through") && !touching.contains("no coupler"), "{touching}");
    let apart = pair("touch = false").to_string();
    assert!(apart.contains("block and base pass through each other where they meet\n"), "{apart}");
}

#[test]
fn contact_limits_the_step() {
    let soft = pair("stiffness = 1e8");
    let stiff = pair("stiffness = 1e12");
    let [a, b] = [&soft, &stiff].map(|check| check.contact_dt_limit.expect("they touch"));
    // As the root of the stiffness.
    assert!((a / b / 100.0 - 1.0).abs() < 1e-9, "{a} {b}");
    assert_eq!([soft.time_step, stiff.time_step], [a, b]);
    assert_eq!(pair("touch = false").contact_dt_limit, None);
}

#[test]
fn a_contact_that_a_weight_presses_through() {
    // rho g h = 981 Pa on a side of 0.1 m.
    let said = |stiffness: &str| {
        let found = pair(&format!("stiffness = {stiffness}")).warnings;
        found.into_iter().filter(|text| text.contains("is soft")).collect::<Vec<_>>()
    };
    assert_eq!(said("1e5"), [""; 0]);
    let soft = said("1.0");
    assert!(soft.len() == 1 && soft[0].contains("presses it 9.81e2 m into the other"), "{soft:?}");
}

#[test]
fn a_fixed_step_above_a_limit() {
    let found = |step: &str| two_blocks(&format!("time_step = {step}\n")).warnings;
    let limit = two_blocks("").time_step;
    let above = found(&format!("{}", 2.0 * limit));
    let said = |text: &String| text.contains("above the") && text.contains("2.00 times");
    assert!(above.iter().any(said), "{above:?}");
    let within = found(&format!("{}", 0.5 * limit));
    assert!(!within.iter().any(|text| text.contains("stability limit")), "{within:?}");
}

#[test]
fn a_time_has_a_unit_that_suits_it() {
    assert_eq!(
        [2.4, 599.0, 900.0, 306_695.0, 2e6].map(duration),
        ["2 s", "599 s", "15 min", "85 h", "23 days"]
    );
    let said = two_blocks("").to_string();
    assert!(said.contains(" steps, one thread a role ("), "{said}");
}
