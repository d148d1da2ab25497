//! `halfstep explain`: what takes part, why, and what it costs, for every shipped scene.

use serde_json::Value;
use std::path::PathBuf;
use std::process::Command;

fn explain(scene: &str, overrides: &[&str], json: bool) -> (Option<i32>, String) {
    told("explain", scene, overrides, json)
}

fn told(subcommand: &str, scene: &str, overrides: &[&str], json: bool) -> (Option<i32>, String) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(scene).with_extension("toml");
    let mut command = Command::new(env!("CARGO_BIN_EXE_halfstep-under-test"));
    command.arg(subcommand).arg(path);
    for key in overrides {
        command.args(["--set", key]);
    }
    if json {
        command.arg("--json");
    }
    let output = command.output().unwrap();
    (output.status.code(), String::from_utf8(output.stdout).unwrap())
}

fn effects(scene: &str, overrides: &[&str]) -> Value {
    let (code, text) = explain(scene, overrides, true);
    assert_eq!(code, Some(0), "{scene}");
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{scene}: nothing but JSON: {e}: {text}"))
}

fn row<'a>(explanation: &'a Value, name: &str) -> &'a Value {
    let rows = explanation["effects"].as_array().unwrap();
    rows.iter().find(|row| row["name"] == name).unwrap_or_else(|| panic!("no row {name}"))
}

#[test]
fn every_shipped_scene_is_explained_and_its_shares_are_the_whole() {
    let coarse: [(&str, &[&str]); 23] = [
        ("block-wall", &[]),
        ("breaking-wall", &["resolution=0.004"]),
        ("colliding-rings", &["resolution=0.002"]),
        ("crack-branching", &["resolution=0.0006666666666666667"]),
        ("dam-break-plate", &["resolution=0.004"]),
        ("dam-break", &["resolution=0.0028575"]),
        ("elastic-gate", &["resolution=0.0025"]),
        ("elastic-gate-rubber", &[]),
        ("floating-box", &["resolution=0.02"]),
        ("gate-lift", &["resolution=0.005", "shape.plate.box.max=[0.61, 0.09]"]),
        ("hydrostatic-plate", &["resolution=0.025"]),
        ("hydrostatic-tank", &[]),
        ("kalthoff-winkler", &["resolution=0.0025"]),
        ("lid-driven-cavity", &["resolution=0.05"]),
        ("oscillating-plate", &["resolution=0.004"]),
        ("rolling-tank", &[]),
        ("solitary-wave-wall", &["resolution=0.02"]),
        ("spring-block", &[]),
        ("standing-wave", &["resolution=0.025"]),
        ("taylor-green", &["resolution=0.05"]),
        ("tsunami-wall", &["resolution=0.01"]),
        ("two-plates", &[]),
        ("wave-paddle", &["resolution=0.02"]),
    ];
    let shipped = std::fs::read_dir(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../scenes")).unwrap();
    assert_eq!(shipped.count(), coarse.len(), "all of them");
    for (scene, overrides) in coarse {
        let explanation = effects(scene, overrides);
        let rows = explanation["effects"].as_array().unwrap();
        let shares: Vec<f64> = rows.iter().filter_map(|row| row["share"].as_f64()).collect();
        let sum: f64 = shares.iter().sum();
        // A coupler without a force to compute has no row; it takes next to nothing.
        assert!((0.9..=1.0 + 1e-9).contains(&sum), "{scene}: {sum} {explanation:#}");
        assert!(shares.iter().all(|s| (0.0..=1.0).contains(s)), "{scene}: {shares:?}");
        for row in rows {
            assert!(!row["why"].as_str().unwrap().is_empty(), "{scene}: {row}");
            assert!(row["on"] == true || row["share"].is_null(), "{scene}: what is off costs nothing: {row}");
        }
    }
}

#[test]
fn what_a_scene_prescribes_has_its_rows() {
    let sea = "shape.paddle.motion={ wave = \"regular\", height = 0.02, period = 0.9, depth = 0.2 }";
    let flume = effects("wave-paddle", &["resolution=0.02", sea]);
    // Place, normal and velocity in the plane, and the shape.
    let moving = row(&flume, "moving-walls");
    assert_eq!((&moving["on"], &moving["bytes_per_particle"]), (&Value::Bool(true), &Value::from(56.0)));
    assert!(moving["why"].as_str().unwrap().contains("`paddle`"), "{moving}");
    assert!(moving["share"].as_f64().is_some_and(|share| share > 0.0), "{moving}");
    let beach = effects("wave-paddle", &["resolution=0.02", "fluid.beach={ from = 2.0, to = 4.0 }"]);
    let share = row(&beach, "beach")["share"].as_f64();
    assert!(share.is_some_and(|share| share > 0.0), "{beach:#}");
    let why = row(&flume, "wave-maker")["why"].as_str().unwrap();
    assert!(why.contains("0.02 m in 0.2 m of water with a stroke of 0.017 m"), "{why}");
    let cracked = effects("kalthoff-winkler", &["resolution=0.0025"]);
    assert!(row(&cracked, "crack")["why"].as_str().unwrap().contains("`plate`, `edge`"));
    let why = row(&cracked, "irregular-arrangement")["why"].as_str().unwrap();
    assert!(why.contains("`solid`, seed 1: "), "{why}");
    assert!(row(&cracked, "prescribed-solids")["why"].as_str().unwrap().contains("`edge`"));
    let load = "shape.plate.load={ within = { min = [0.0, -1.0], max = [1.0, 1.0] }, traction = [0.0, 5.0] }";
    let loaded = effects("oscillating-plate", &["resolution=0.004", load]);
    assert!(row(&loaded, "load")["why"].as_str().unwrap().contains("(0, 5) Pa on "), "{loaded:#}");
    let names = ["moving-walls", "wave-maker", "prescribed-solids", "load", "crack", "irregular-arrangement"];
    let still = effects("dam-break", &["resolution=0.0028575"]);
    let rows = still["effects"].as_array().unwrap();
    assert!(rows.iter().all(|row| !names.contains(&row["name"].as_str().unwrap())), "absent costs no row");
}

/// A wall 15 rows thick: 2 to 12 % measured. Shares are times: what else the machine does may hide one in one run, not
/// in five.
#[test]
fn fracture_has_a_share_where_a_solid_may_break_and_none_elsewhere() {
    let thick = ["resolution=0.004", "shape.wall.box.max=[0.346, 0.08]", "shape.wall.clamp.max=[0.352, 0.0]"];
    let share = || {
        let wall = effects("breaking-wall", &thick);
        let fracture = row(&wall, "fracture");
        assert!(fracture["on"] == true, "{fracture}");
        assert!(
            fracture["why"].as_str().unwrap().starts_with("solid.fracture: 400000 Pa and 3 J/m²"),
            "{fracture}"
        );
        fracture["share"].as_f64().unwrap_or(0.0)
    };
    let shares: Vec<f64> = (0..5).map(|_| share()).collect();
    assert!(shares.iter().all(|&share| (0.0..=1.0).contains(&share)), "{shares:?}");
    assert!(shares.iter().any(|&share| share > 0.0), "{shares:?}");
    let off = effects("breaking-wall", &[&thick[..], &["effects.fracture=off"][..]].concat());
    let never = effects("oscillating-plate", &["resolution=0.004"]);
    for (scene, why) in [(off, "effects.fracture is \"off\""), (never, "solid.fracture is not there")] {
        let fracture = row(&scene, "fracture");
        assert!(fracture["on"] == false && fracture["share"].is_null(), "{fracture}");
        assert_eq!(fracture["why"], why);
    }
}

#[test]
fn the_reason_is_the_key_or_the_fact() {
    let forced = effects("hydrostatic-tank", &["fluid.viscosity=0.1", "effects.viscosity=on"]);
    let viscosity = row(&forced, "viscosity");
    assert!(viscosity["on"] == true && viscosity["why"] == "effects.viscosity is \"on\"", "{viscosity}");
    assert_eq!(row(&forced, "particle-shifting")["bytes_per_particle"], 24.0);
    assert_eq!(forced["composition"], "artificial viscosity, hydrostatic diffusion, viscosity");
    assert_eq!(row(&forced, "solid")["on"], false);

    let bare = effects("hydrostatic-tank", &["fluid.density_diffusion=none"]);
    let diffusion = row(&bare, "density-diffusion");
    assert!(diffusion["on"] == false, "{diffusion}");
    assert_eq!(bare["composition"], "artificial viscosity");
    assert_eq!(row(&bare, "frozen-diffusion")["on"], false);

    let (code, text) = explain("oscillating-plate", &["resolution=0.004"], false);
    assert_eq!(code, Some(0));
    assert!(text.lines().any(|l| l.starts_with("fluid") && l.contains("off")), "{text}");
    let (code, _) = explain("oscillating-plate", &["resolution=-1"], false);
    assert_eq!(code, Some(1));
}

#[test]
fn a_check_for_scripts_says_what_it_says_to_people() {
    let (code, text) = told("check", "dam-break-plate", &["resolution=0.004"], true);
    assert_eq!(code, Some(0), "{text}");
    let check: Value =
        serde_json::from_str(&text).unwrap_or_else(|e| panic!("nothing but JSON: {e}: {text}"));
    let (_, people) = told("check", "dam-break-plate", &["resolution=0.004"], false);
    let [fluid, solid, wall] =
        ["fluid", "solid", "wall"].map(|phase| check["particles"][phase].as_u64().unwrap());
    assert!(people.contains(&format!("{fluid} fluid, {solid} solid, {wall} wall")), "{people}");
    let steps = check["steps"].as_u64().unwrap();
    assert!(people.contains(&format!(": {steps} steps to t = ")), "{people}");
    let step = check["end_time"].as_f64().unwrap() / check["time_step"].as_f64().unwrap();
    assert!((step.ceil() - steps as f64).abs() < 1.0);
    assert_eq!(check["bodies"][0]["particles"].as_u64(), Some(solid));
    assert_eq!(check["warnings"].as_array().map(Vec::len), Some(0), "a shipped scene has none");
    assert!(check["expected_seconds"].as_f64().unwrap() > 0.0);
}
