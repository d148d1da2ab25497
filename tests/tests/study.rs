//! `halfstep study` from end to end: a tiny scene, interrupted and resumed, and asked for errors it can and cannot
//! reach.

use halfstep_tests::process::{is_alive, kill};
use halfstep_tests::python::python;
use halfstep_tests::run::{program, repository};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime};

/// Water that slumps in a tank: a tenth of a second a run.
const SCENE: &str = r#"
resolution = 0.025
end_time = 0.3
gravity = [0.0, -9.81]

[fluid]
density = 1000.0

[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [0.2, 0.2] }
pressure = "hydrostatic"

[[shape]]
name = "tank"
phase = "wall"
tank = { min = [0.0, 0.0], max = [0.6, 0.3], open = ["top"] }

[[probe]]
name = "front"
kind = "front"

[[metric]]
name = "reach"
probe = "front.x"
kind = "value"
at = 0.15
reference = 0.4
source = "made up"

[[metric]]
name = "late"
probe = "front.x"
kind = "mean"
to = 0.3
"#;

struct Study {
    dir: tempfile::TempDir,
    scene: PathBuf,
}

impl Study {
    fn new() -> Self {
        let dir = tempfile::tempdir().unwrap();
        let scene = dir.path().join("pool.toml");
        std::fs::write(&scene, SCENE).unwrap();
        Self { dir, scene }
    }

    fn of(scene: PathBuf) -> Self {
        Self { dir: tempfile::tempdir().unwrap(), scene }
    }

    fn out(&self) -> PathBuf {
        self.dir.path().join("study")
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(program());
        command.arg("study").arg(&self.scene).arg("--quiet").arg("--out").arg(self.out());
        command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Folders of finished runs with the time of their report.
    fn done(&self) -> Vec<(PathBuf, SystemTime)> {
        let Ok(runs) = self.out().join("runs").read_dir() else { return Vec::new() };
        let folders = runs.map(|entry| entry.unwrap().path()).filter(|dir| dir.join("done.json").exists());
        let time = |dir: &Path| dir.join("run.json").metadata().unwrap().modified().unwrap();
        let mut found: Vec<_> = folders.map(|dir| (dir.clone(), time(&dir))).collect();
        found.sort();
        found
    }

    fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&std::fs::read(self.out().join("study.json")).unwrap()).unwrap()
    }
}

const LADDER: [&str; 4] = ["--vary", "resolution=0.025,0.02,0.0125,0.01", "--vary", "numerics.cfl=0.25"];

#[test]
fn a_study_is_interrupted_and_resumed() {
    let study = Study::new();
    let child = study.command(&LADDER).spawn().unwrap();
    let start = Instant::now();
    while study.done().is_empty() {
        assert!(start.elapsed() < Duration::from_secs(60), "no run finished");
        std::thread::sleep(Duration::from_millis(5));
    }
    kill(child.id(), libc::SIGINT);
    let pid = child.id();
    let stopped = child.wait_with_output().unwrap();
    assert_eq!(stopped.status.code(), Some(130), "{stopped:?}");
    assert!(!is_alive(pid));
    let first = study.done();
    assert!((1..5).contains(&first.len()), "{first:?}");
    assert!(!study.out().join("study.json").exists(), "nothing is concluded from a part");

    let resumed = study.run(&LADDER);
    assert_eq!(resumed.status.code(), Some(0), "{resumed:?}");
    let all = study.done();
    assert_eq!(all.len(), 5);
    assert!(first.iter().all(|run| all.contains(run)), "finished runs are not repeated");

    let json = study.json();
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 5);
    let work: Vec<u64> = rows.iter().map(|row| row["pair_evaluations"].as_u64().unwrap()).collect();
    assert!(work[0] < work[1] && work[1] < work[2] && work[2] < work[3] && work[4] > work[0], "{work:?}");
    let error = json["metrics"][0]["errors"][0]["reference"].as_f64().unwrap();
    let value = rows[0]["values"][0].as_f64().unwrap();
    assert!((error - (value / 0.4 - 1.0).abs()).abs() < 1e-12 && value > 0.25, "{error} {value}");
    assert!(json["metrics"][1]["reference"].is_null());
    let table = std::fs::read_to_string(study.out().join("study.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 2 * 5);
    for picture in ["work-precision.png", "convergence.png", "time-share.png"] {
        assert!(study.out().join(picture).metadata().unwrap().len() > 5000, "{picture}");
    }
    let text = String::from_utf8(resumed.stdout).unwrap();
    assert!(
        text.contains("reach: reference 0.4000 m, made up") && text.contains("numerics.cfl=0.25"),
        "{text}"
    );

    // With all runs there, goals are a matter of reading: one that a run has reached, and one that nothing can.
    let worst =
        json["metrics"][0]["errors"].as_array().unwrap().iter().filter_map(|e| e["reference"].as_f64());
    let enough = format!("{}", worst.fold(0.0, f64::max));
    let with = |more: &[&'static str]| [&LADDER[..], more].concat();
    let reached = study.run(&[&LADDER[..], &["--error", &enough]].concat());
    assert_eq!(reached.status.code(), Some(0), "{reached:?}");
    assert!(String::from_utf8_lossy(&reached.stdout).contains("settings that reach it: "), "{reached:?}");
    assert_eq!(study.done(), all);
    let beyond = study.run(&with(&["--budget", "1e-6s"]));
    assert_eq!(beyond.status.code(), Some(3), "{beyond:?}");
    assert!(String::from_utf8_lossy(&beyond.stderr).starts_with("not reached: "), "{beyond:?}");
}

#[test]
fn what_cannot_be_studied_is_said_before_anything_runs() {
    let study = Study::new();
    for (arguments, message) in [
        (&["--vary", "numerics.cfl=0.25,7"][..], "must be greater than 0 and at most 1"),
        (&["--until", "0.1"], "ends before its metrics"),
        (&["--metric", "speed", "--error", "1%"], "the scene has no such metric; it has reach, late"),
    ] {
        let refused = study.run(arguments);
        assert_eq!(refused.status.code(), Some(1), "{refused:?}");
        let said = String::from_utf8_lossy(&refused.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(message), "{said}");
        assert!(study.done().is_empty());
    }
    // What is physical is no error, and is said before the first run; here the goal is refused.
    let density = study.run(&["--vary", "fluid.density=500", "--metric", "speed", "--error", "1%"]);
    let said = String::from_utf8_lossy(&density.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("warning: --vary fluid.density changes what is computed and not how"), "{said}");
}

#[test]
fn a_sweep_tells_what_physics_does() {
    let study = Study::new();
    let sweep = ["--sweep", "fluid.density=500,1000,2000,1e3", "--sweep", "gravity.1=-4.905,-9.81", "--json"];
    let done = study.run(&sweep);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let told: serde_json::Value = serde_json::from_slice(&done.stdout).expect("JSON and nothing else");
    let written = std::fs::read(study.out().join("sweep.json")).unwrap();
    assert_eq!(told, serde_json::from_slice::<serde_json::Value>(&written).unwrap());
    let rows = told["rows"].as_array().unwrap();
    assert_eq!((rows.len(), told["keys"].as_array().unwrap().len()), (6, 2));
    let notes: Vec<&str> =
        told["notes"].as_array().unwrap().iter().filter_map(|note| note.as_str()).collect();
    let repeated = "fluid.density=1e3 gravity.1=-9.81 makes the scene of fluid.density=1000 gravity.1=-9.81, and is not run";
    assert!(notes.iter().any(|note| note.starts_with(repeated)), "{notes:?}");
    let reach = |density: &str, gravity: &str| {
        let row = rows.iter().find(|row| row["values"] == serde_json::json!([density, gravity])).unwrap();
        assert_eq!(row["status"], "finished");
        row["numbers"][0].as_f64().unwrap()
    };
    // Twice the density is twice of every force and mass: the same accelerations to the bit.
    for gravity in ["-4.905", "-9.81"] {
        let all = ["500", "1000", "2000"].map(|density| reach(density, gravity));
        assert!(all[0] == all[1] && all[1] == all[2], "{all:?}");
    }
    // And what weighs more runs farther: from 0.2 m, with Ritter's 2 sqrt(g d) at most.
    let [light, heavy] = ["-4.905", "-9.81"].map(|gravity| reach("1000", gravity));
    assert!(
        0.22 < light && light < heavy && heavy < 0.2 + 0.15 * 2.0 * (9.81 * 0.2_f64).sqrt(),
        "{light} {heavy}"
    );
    // A line for each run below the titles, and a picture.
    let table = std::fs::read_to_string(study.out().join("sweep.csv")).unwrap();
    assert!(table.starts_with("fluid.density,gravity.1,reach [m],late [m],status,"), "{table}");
    assert_eq!(table.lines().count(), 7);
    assert!(study.out().join("sweep.png").metadata().unwrap().len() > 5000);
}

/// The block on a spring is a program: each run starts it, and one that has changed, or may have, makes other runs.
#[test]
fn a_solid_of_ones_own_takes_part_in_a_study() {
    let study = Study::of(repository().join("scenes/spring-block.toml"));
    let script = study.dir.path().join("my spring_block.py");
    std::fs::copy(repository().join("tests/python/spring_block.py"), &script).unwrap();
    let line = |stiffness: &str| format!("{} '{}' {stiffness}", python().display(), script.display());
    let way = |stiffness: &str| {
        let command = line(stiffness);
        let ladder = ["--vary", "resolution=0.02,0.01", "--until", "0.2", "--set", "resolution=0.02"];
        let done = study.run(&[&ladder[..], &["--solid", &command, "--json"]].concat());
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        let rows = study.json()["rows"].as_array().unwrap().clone();
        assert!(rows.iter().all(|row| row["error"].is_null()), "{rows:?}");
        rows.len()
    };
    assert_eq!(way("20000"), 2);
    let first = study.done();
    let report = std::fs::read_to_string(first[0].0.join("run.json")).unwrap();
    assert!(report.contains("spring_block.py"), "the report names the program: {report}");
    way("20000");
    assert_eq!(study.done(), first, "runs of the same program are there already");
    way("40000");
    let stiffer = study.done();
    assert!(stiffer.iter().zip(&first).all(|(new, old)| new.0 == old.0 && new.1 > old.1), "other runs");
    let text = std::fs::read_to_string(&script).unwrap();
    std::fs::write(&script, format!("{text}\n")).unwrap();
    way("40000");
    let changed = study.done();
    assert!(changed.iter().zip(&stiffer).all(|(new, old)| new.1 > old.1), "the program has changed");
    // Nobody knows whether what the shell puts in its place is what it was.
    let command = line("\"${STIFFNESS:-40000}\"");
    let ladder = ["--vary", "resolution=0.02,0.01", "--until", "0.2", "--set", "resolution=0.02"];
    let mut before = changed;
    for _ in 0..2 {
        let done = study.run(&[&ladder[..], &["--solid", &command]].concat());
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        assert!(said.contains("runs that are there are not used again: `${STIFFNESS:-40000}` of"), "{said}");
        let after = study.done();
        assert!(after.iter().zip(&before).all(|(new, old)| new.1 > old.1), "other runs");
        before = after;
    }
}
