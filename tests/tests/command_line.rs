//! What the program answers beside runs, and a run that is made once more from its own folder.

use halfstep_output::RunReport;
use halfstep_tests::run::{program, repository};
use std::path::Path;
use std::process::{Command, Output};

fn halfstep(folder: &Path, words: &[&str]) -> Output {
    Command::new(program()).args(words).current_dir(folder).output().expect("the program")
}

/// What it prints, where it succeeds.
fn told(words: &[&str]) -> String {
    let output = halfstep(&repository(), words);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && errors.is_empty(), "{words:?}: {errors}");
    String::from_utf8(output.stdout).expect("text")
}

/// From the `scene.json` of a run's folder: the same scene in every key, so the same bits.
#[test]
fn a_run_is_made_once_more_from_its_folder() {
    made_once_more("hydrostatic-tank", &["resolution=0.05"], "0.1");
}

/// Water, a solid, and a motion from a file beside the scene.
#[test]
fn a_coupled_run_with_a_recorded_motion_is_made_once_more() {
    let baffle = "shape.baffle.box={ min = [0.3005, 0.0575], max = [0.3085, 0.3525] }";
    made_once_more("rolling-tank", &["resolution=0.004", baffle], "0.01");
}

fn made_once_more(name: &str, settings: &[&str], until: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = repository().join(format!("scenes/{name}.toml"));
    let run = |words: &[&str]| {
        let ended = halfstep(folder.path(), &[&["run", "--quiet"], words].concat());
        assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    };
    let report = |dir: &str| RunReport::read(&folder.path().join(dir).join("run.json")).expect("a report");
    let set: Vec<&str> = settings.iter().flat_map(|setting| ["--set", setting]).collect();
    run(&[&set[..], &["--until", until, "--out", "first", &scene.to_string_lossy()]].concat());
    run(&["--out", "again", "first/scene.json"]);
    let [first, again] = ["first", "again"].map(report);
    assert!(first.steps > 10 && first.audit.state_hash.is_some());
    assert_eq!((first.audit.state_hash, first.steps), (again.audit.state_hash, again.steps));
    assert_eq!(first.scene, again.scene);
    assert!(!first.shapes.is_empty() && first.shapes == again.shapes, "{:?}", first.shapes);
    let rows = |dir: &str| std::fs::read(folder.path().join(dir).join("probes.csv")).expect("rows");
    assert_eq!(rows("first"), rows("again"));
    // With anything changed it would be another run than its folder says.
    let changed = halfstep(folder.path(), &["run", "--until", "0.1", "--out", "third", "first/scene.json"]);
    assert_eq!(changed.status.code(), Some(1));
    assert!(!folder.path().join("third").exists());
}

#[test]
fn the_version_says_of_what() {
    let version = told(&["--version"]);
    assert!(version.contains(env!("CARGO_PKG_VERSION")), "{version}");
    assert!(["commit", "instruction set", "features"].iter().all(|line| version.contains(line)), "{version}");
}

#[test]
fn completions_and_the_manual_know_the_commands() {
    for shell in ["bash", "zsh", "fish"] {
        let script = told(&["completions", shell]);
        for word in ["halfstep", "run", "resume", "check", "study"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    let manual = told(&["man"]);
    assert!(manual.contains(".TH halfstep") && manual.contains("resume"), "{manual}");
    assert_eq!(halfstep(&repository(), &["completions", "nosuch"]).status.code(), Some(1));
}

/// Where nobody looks at a terminal a run says in lines how far it has come, some seconds of it every second or so.
#[test]
fn a_run_without_a_terminal_tells_its_progress_in_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = repository().join("scenes/elastic-gate.toml");
    let scene = scene.to_str().expect("a path");
    let words =
        ["run", scene, "--until", "0.12", "--set", "resolution=0.00166666666666666667", "--threads", "1"];
    let ended = halfstep(folder.path(), &words);
    assert!(ended.status.success(), "{ended:?}");
    let text = String::from_utf8_lossy(&ended.stderr).into_owned();
    let parts: Vec<f64> = text
        .lines()
        .filter(|line| line.contains("s gone, about"))
        .map(|line| line.split('%').next().and_then(|part| part.trim().parse().ok()).expect("a part"))
        .collect();
    assert!(
        !parts.is_empty() && parts.is_sorted() && parts.iter().all(|part| (10.0..=100.0).contains(part)),
        "{text}"
    );
}
