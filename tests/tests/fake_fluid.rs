//! `halfstep fake-fluid`: a solid alone under a known load.

use halfstep_output::run_json::RunStatus;
use halfstep_output::{RunReport, read_probes};
use halfstep_tests::Curve;
use halfstep_tests::conformance::link::eventually;
use halfstep_tests::process::{is_alive, kill, leftovers, with_variable};
use halfstep_tests::python::{FAILING_SOLID, HANGING_SOLID, python};
use halfstep_tests::run::{program, repository, whole_machine};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

fn start(scene: &str, solid: &str, out: &Path, more: &[&str]) -> Child {
    let scene = repository().join("scenes").join(scene);
    let mut command = Command::new(program());
    command.arg("fake-fluid").arg(scene).arg("--out").arg(out).arg("--solid").arg(solid).args(more);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn ended(child: Child) -> Output {
    let launcher = child.id();
    let output = child.wait_with_output().unwrap();
    assert_eq!(leftovers(launcher), Vec::<String>::new());
    output
}

fn trial(scene: &str, solid: &str, out: &Path, more: &[&str]) -> Output {
    ended(start(scene, solid, out, more))
}

/// Processes of the trial in a folder: its solid.
fn solids(out: &Path) -> Vec<u32> {
    let told = out.canonicalize().unwrap();
    let mut found = with_variable("HALFSTEP_OUT", told.to_str().unwrap());
    found.retain(|pid| is_alive(*pid));
    found
}

/// A mass on a spring under a sudden load: x = F/k (1 - cos(omega t)).
#[test]
fn a_block_on_a_spring_swings_as_its_formula_says() {
    const STIFFNESS: f64 = 2e4;
    const FORCE: f64 = 100.0;
    let folder = tempfile::tempdir().unwrap();
    let line = format!(
        "{} {} {STIFFNESS}",
        python().display(),
        repository().join("tests/python/spring_block.py").display()
    );
    let more = ["--force=100,0", "--until", "0.2", "--time-step", "2e-4"];
    let output = trial("spring-block.toml", &line, folder.path(), &more);
    let (said, error) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{error}");
    assert!(said.starts_with("1000 steps to t = 0.2 s; the load is on 224 of 224 particles"), "{said}");
    let report = RunReport::read(&folder.path().join("run.json")).unwrap();
    assert_eq!((report.status, report.steps, report.time), (Some(RunStatus::Finished), 1000, 0.2));
    let [median, slow] = report.round_trip_us.map(|us| [us.p50, us.p99]).expect("half-steps");
    assert!(median > 0.0 && slow >= median && said.contains("a half-step of the solid takes"), "{said}");
    let omega = (STIFFNESS / (8000.0 * 0.04 * 0.14)).sqrt();
    let table = read_probes(&folder.path().join("probes.csv")).unwrap();
    let curve = Curve { times: table.times(), values: table.column("block.x").unwrap() };
    for (time, x) in curve.times.iter().zip(&curve.values) {
        let exact = FORCE / STIFFNESS * (1.0 - (omega * time).cos());
        assert!((x - exact).abs() < 1e-6, "{time} s: {x}, exactly {exact}");
    }
}

#[test]
fn a_solid_that_fails_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("failing.py");
    std::fs::write(&script, FAILING_SOLID).unwrap();
    let jumping = folder.path().join("jumping.py");
    // 0.1 m in no time, and no velocity.
    let jumps = FAILING_SOLID.replace("raise ValueError('no convergence')", "points.position[5] += 0.1");
    std::fs::write(&jumping, jumps).unwrap();
    let line = format!("{} {}", python().display(), script.display());
    let jumping = format!("{} {}", python().display(), jumping.display());
    for (line, more, reason) in [
        (line.as_str(), &["--force=1,0"][..], "the solid failed at step 3: ValueError: no convergence"),
        (&jumping, &["--force=1,0"], "the solid moved its particle 5 by 1.414e-1 m at step 3, although"),
        ("exit 3", &["--force=1,0"], "before the run had begun"),
        (&line, &["--force=1,0", "--within=5,5,6,6"], "none of the solid's particles begins in the box"),
        (
            &line,
            &["--force=1,0", "--set", "frame.motion={ amplitude = [0.01, 0.0], period = 1.0 }"],
            "another program, which is told one `gravity`, and `frame` changes it",
        ),
    ] {
        let output = trial("spring-block.toml", line, folder.path(), more);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(reason), "{error}");
    }
}

/// The load grows over T = 0.1 s: x = F / k (t / T - sin(omega t) / (omega T)); then the block swings about F / k.
#[test]
fn a_load_that_grows_moves_the_block_as_its_formula_says() {
    const STIFFNESS: f64 = 2e4;
    const FORCE: f64 = 100.0;
    const RAMP: f64 = 0.1;
    let folder = tempfile::tempdir().unwrap();
    let script = repository().join("tests/python/spring_block.py");
    let line = format!("{} {} {STIFFNESS}", python().display(), script.display());
    let more = ["--force=100,0", "--ramp", "0.1", "--until", "0.2", "--time-step", "2e-4"];
    let output = trial("spring-block.toml", &line, folder.path(), &more);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let omega = (STIFFNESS / (8000.0 * 0.04 * 0.14)).sqrt();
    let table = read_probes(&folder.path().join("probes.csv")).unwrap();
    for (time, x) in table.times().iter().zip(table.column("block.x").unwrap()) {
        // Beyond the ramp less what would have gone on.
        let grown = |t: f64| (t - (omega * t).sin() / omega) / RAMP;
        let exact = FORCE / STIFFNESS * (grown(*time) - grown((time - RAMP).max(0.0)));
        assert!((x - exact).abs() < 1e-6, "{time} s: {x}, exactly {exact}");
    }
}

/// A trial takes the place of an earlier trial and of nothing else.
#[test]
fn a_run_in_the_folder_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let occupied = folder.path().join("probes.csv");
    std::fs::write(&occupied, "somebody's").unwrap();
    let output = trial("spring-block.toml", "exit 3", folder.path(), &["--force=1,0"]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1));
    assert!(error.contains("holds a run (probes.csv)") && error.contains("--replace"), "{error}");
    assert_eq!(std::fs::read_to_string(&occupied).unwrap(), "somebody's");
    // Both begin, and end for the solid's sake.
    for more in [&["--force=1,0", "--replace"][..], &["--force=1,0"]] {
        let output = trial("spring-block.toml", "exit 3", folder.path(), more);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(error.contains("before the run had begun"), "{error}");
    }
    let told: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("trial.json")).unwrap()).unwrap();
    assert_eq!((&told["command"], &told["force"][0]), (&"exit 3".into(), &1.0.into()));
    let run = Command::new(program())
        .args(["run", "scenes/spring-block.toml", "--until", "0.001", "--out"])
        .arg(folder.path())
        .current_dir(repository())
        .output()
        .unwrap();
    assert!(String::from_utf8_lossy(&run.stderr).contains("holds an earlier run"), "{run:?}");
    for (arguments, reason) in [
        (&["--ramp", "0.1"][..], "--force"),
        (&["--within=0,0,1,1"], "--force"),
        (&["--force=1,0,1"], "its force has no third component"),
    ] {
        let output = trial("spring-block.toml", "exit 3", folder.path(), arguments);
        assert!(String::from_utf8_lossy(&output.stderr).contains(reason), "{output:?}");
    }
}

/// A solid that hangs keeps no trial: not from Ctrl-C, after two seconds or at once at the second, and not for ever.
#[test]
fn a_solid_that_hangs_is_given_up() {
    let _machine = whole_machine();
    for signals in [0, 1, 2] {
        let folder = tempfile::tempdir().unwrap();
        let (script, out) = (folder.path().join("hanging.py"), folder.path().join("out"));
        std::fs::write(&script, HANGING_SOLID).unwrap();
        let line = format!("{} {}", python().display(), script.display());
        let child = start("spring-block.toml", &line, &out, &["--force=1,0", "--patience", "8"]);
        eventually(60.0, "the solid to hang", || out.join("hangs").exists());
        assert_eq!(solids(&out).len(), 1);
        let moment = Instant::now();
        for _ in 0..signals {
            kill(child.id(), libc::SIGINT);
            std::thread::sleep(Duration::from_millis(100));
        }
        let output = ended(child);
        let (seconds, error) = (moment.elapsed().as_secs_f64(), String::from_utf8_lossy(&output.stderr));
        let report = RunReport::read(&out.join("run.json")).unwrap();
        assert_eq!((report.steps, solids(&out)), (3, vec![]), "{error}");
        if signals == 0 {
            assert_eq!((output.status.code(), report.status), (Some(2), Some(RunStatus::Failed)), "{error}");
            assert!(error.contains("waiting for the solid since "), "{error}");
            assert!(report.error.is_some_and(|error| error.contains("the solid") && error.contains("8 s")));
        } else {
            assert_eq!(
                (output.status.code(), report.status),
                (Some(130), Some(RunStatus::Stopped)),
                "{error}"
            );
            assert!(
                error.contains("stopped without waiting for the solid, which has been silent"),
                "{error}"
            );
            assert!(seconds < if signals == 1 { 7.0 } else { 2.0 }, "{seconds} s");
        }
    }
}

#[test]
fn a_trial_that_is_stopped_before_its_solid_came_has_not_failed() {
    let folder = tempfile::tempdir().unwrap();
    let child = start("spring-block.toml", "sleep 600", folder.path(), &["--force=1,0"]);
    eventually(60.0, "the solid to start", || !solids(folder.path()).is_empty());
    kill(child.id(), libc::SIGINT);
    let output = ended(child);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(130), "{error}");
    assert!(error.contains("stopped before the start"), "{error}");
    let report = RunReport::read(&folder.path().join("run.json")).unwrap();
    assert_eq!((report.status, report.error, report.steps), (Some(RunStatus::Stopped), None, 0));
    assert_eq!(solids(folder.path()), Vec::<u32>::new());
}

/// Steps with which the time stays the same.
#[test]
fn steps_that_never_reach_the_end_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("slow.py");
    let slow = FAILING_SOLID.replace("0.0)\n", "0.0, dt_limit=1e-300)\n");
    std::fs::write(&script, slow).unwrap();
    let line = format!("{} {}", python().display(), script.display());
    let output = trial("spring-block.toml", &line, &folder.path().join("out"), &["--force=1,0"]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("the solid diverged at step 1") && error.contains("1.0000e-300 s"), "{error}");
}

/// As on a full disk.
#[test]
fn a_report_that_cannot_be_written_hides_no_reason() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("run.json")).unwrap();
    let output = trial("spring-block.toml", "exit 3", folder.path(), &["--force=1,0"]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(
        error.contains("(exit status: 3) before the run had begun") && error.contains("run.json"),
        "{error}"
    );
}

/// A block of twice the spacing, in a fourth of the particles: told as by a run.
#[test]
fn a_trial_compares_the_first_message_with_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let script = std::fs::read_to_string(repository().join("tests/python/spring_block.py")).unwrap();
    let coarse = script.replace("scene[\"resolution\"], scene", "2 * scene[\"resolution\"], scene");
    assert_ne!(coarse, script);
    let path = folder.path().join("coarse.py");
    std::fs::write(&path, coarse).unwrap();
    let line = format!("{} {} 2e4", python().display(), path.display());
    let out = folder.path().join("trial");
    let output = trial("spring-block.toml", &line, &out, &["--force=100,0", "--until", "0.01"]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && error.contains("publishes 56 particles"), "{error}");
    let report = RunReport::read(&out.join("run.json")).unwrap();
    assert_eq!(report.external.len(), 1);
    assert!(!report.warnings.is_empty() && error.contains(&report.warnings[0]), "{:?}", report.warnings);
}
