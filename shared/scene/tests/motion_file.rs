//! Motions that follow a file.

use halfstep_scene::{Scene, SceneErrors, parse};
use std::path::PathBuf;

fn scene(rows: &str, motion: &str) -> Result<Scene, SceneErrors> {
    let folder =
        std::env::temp_dir().join(format!("halfstep-motion-{}-{:x}", std::process::id(), rows.len()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("roll.csv"), rows).unwrap();
    let text = format!(
        "resolution = 0.01\nend_time = 2.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
         phase = \"fluid\"\nbox = {{ min = [0.0, 0.0], max = [0.2, 0.1] }}\n[[shape]]\nname = \"tank\"\n\
         phase = \"wall\"\ntank = {{ min = [0.0, 0.0], max = [0.2, 0.2], open = [\"top\"] }}\nmotion = {motion}\n"
    );
    let found = parse(&text, &folder.join("s.toml"), &[]);
    std::fs::remove_dir_all(folder).unwrap();
    found
}

const ROWS: &str = "# measured\ntime [s],roll [deg],x [mm]\n0,0,0\n0.5,3,1\n1.0,0,\n1.5,-3,2\n";
const COLUMNS: &str = "columns = { time = \"time [s]\", angle = \"roll [deg]\" }";

#[test]
fn a_tank_rolls_as_its_file_says() {
    let motion =
        format!("{{ file = \"roll.csv\", {COLUMNS}, scale = 0.017453292519943295, pivot = [0.1, 0.0] }}");
    let scene = scene(ROWS, &motion).unwrap_or_else(|e| panic!("{e:?}"));
    let motion = scene.shapes[1].motion.clone().expect("a motion");
    // At its rows: 3 degrees of the point 0.1 m right of the pivot.
    let angle = 3.0_f64.to_radians();
    let at = |t: f64| motion.at(t).position_of([0.2, 0.0]);
    assert!((at(0.5)[1] - 0.1 * angle.sin()).abs() < 1e-15 && at(1.0)[1].abs() < 1e-15);
    assert!((at(9.0)[1] + 0.1 * angle.sin()).abs() < 1e-15, "it stays where the file ends");
    // What is written down is read back, every number of it.
    assert_eq!(Scene::from_json(&scene.to_json().unwrap()).unwrap(), scene);
}

#[test]
fn files_that_are_no_series_are_refused() {
    let pivot = "pivot = [0.0, 0.0]";
    for (rows, motion, reason) in [
        ("time [s],roll [deg]\n0,0\n1,1\n1,2\n", COLUMNS, "goes back in time: 1 s follows 1 s"),
        ("time [s],roll [deg]\n0,0\n", COLUMNS, "has a single row"),
        (
            "time [s],roll [deg]\n0,0.1\n1,0\n",
            COLUMNS,
            "away from where the scene has the shape: at 0 s it is there",
        ),
        (
            "time [s],roll\n0,0\n1,1\n",
            COLUMNS,
            "has no column `roll [deg]`; its columns are `time [s]` and `roll`",
        ),
        ("time [s],roll [deg]\n0,0\n1e-300,1\n", COLUMNS, "moves faster than 1e12 m/s or rad/s"),
    ] {
        let found = scene(rows, &format!("{{ file = \"roll.csv\", {motion}, {pivot} }}")).unwrap_err();
        assert!(found.problems[0].to_string().ends_with(reason), "{reason}: {found:?}");
        assert_eq!(found.problems.len(), 1, "{found:?}");
    }
}

#[test]
fn a_file_is_looked_for_beside_the_scene() {
    let missing =
        scene("", &format!("{{ file = \"none.csv\", {COLUMNS}, pivot = [0.0, 0.0] }}")).unwrap_err();
    let said = missing.problems[0].to_string();
    assert!(said.contains(&PathBuf::from("halfstep-motion").display().to_string()), "{said}");
}
