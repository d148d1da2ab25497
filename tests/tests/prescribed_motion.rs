//! Scenes whose walls go along with a recorded motion.

use halfstep_tests::curve::Curve;
use halfstep_tests::scene;

/// Coarse, with a plate that is thick enough for it: the water reaches the plate when that of the experiment does,
/// which moves from 0.26 s on, and later than from a gate that is gone at once.
#[test]
fn water_behind_a_gate_that_lifts_reaches_the_plate() {
    let thick = || scene("gate-lift").set("resolution", 0.005).set("shape.plate.box.max", "[0.61, 0.09]");
    let coarse = || thick().set("shape.gate.box.max", "[0.215, 0.3]");
    let arrival = |run: halfstep_tests::Finished| run.curve("front.x").first_above(0.6 - 0.005);
    let recorded = arrival(coarse().until(0.32).run()).expect("water at the plate");
    let gone = "{ min = [0.2, 0.35], max = [0.215, 0.45] }";
    let at_once =
        arrival(coarse().set("shape.gate.box", gone).until(0.32).run()).expect("water at the plate");
    println!("at the plate after {recorded:.4} s, without a gate {at_once:.4} s");
    assert!((0.24..0.28).contains(&recorded), "{recorded}");
    assert!(at_once < recorded - 0.005, "{at_once} {recorded}");
}

/// The baffle's upper end goes along with the lid.
#[test]
fn a_baffle_hangs_from_a_tank_that_rolls() {
    let run = scene("rolling-tank")
        .set("resolution", 0.004)
        .set("shape.baffle.box", "{ min = [0.3005, 0.0575], max = [0.3085, 0.3525] }")
        .until(0.25)
        .run();
    let roll = Curve::reference("rolling-tank", "roll.csv", "angle [deg]");
    let angle = -roll.at(0.25).to_radians();
    let root = run.curve("root.x").at(0.25);
    // Its height above the pivot, times the sine: positive angles are counter-clockwise.
    let height = 0.349;
    println!(
        "root {root:.6} m, lid {:.6} m, tip {:.6} m",
        -height * angle.sin(),
        run.curve("tip.x").at(0.25)
    );
    assert!((root + height * angle.sin()).abs() < 0.03 * height * angle.sin().abs(), "{root}");
    let audit = &run.report.audit;
    assert!(audit.density_error.is_some_and(|error| error < 0.05), "{audit:?}");
}
