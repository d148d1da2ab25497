//! Published set-ups that are not shipped as scenes: each is taken without a warning, and makes its first steps.

use halfstep_tests::run::{program, repository, scene_at};
use std::process::Command;
use std::time::Instant;

#[test]
fn published_set_ups_can_be_written_and_run() {
    let folder = repository().join("tests/set-ups");
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("set-ups").map(|entry| entry.expect("a set-up").path()).collect();
    paths.sort();
    assert_eq!(paths.len(), 8, "{paths:?}");
    paths.push(repository().join("validation/rolling-tank/standing.toml"));
    for path in paths {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let start = Instant::now();
        let output = Command::new(program()).arg("check").arg(&path).arg("--json").output().expect("a check");
        let seconds = start.elapsed().as_secs_f64();
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(found["warnings"], serde_json::json!([]), "{name}");
        let run = scene_at(&path).until(0.002).run();
        println!("{name}: check {seconds:.2} s, {} steps", run.report.steps);
        assert!(run.report.steps > 2, "{name}");
    }
}
