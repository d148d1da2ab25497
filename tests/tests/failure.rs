//! Whatever ends a run, it ends soon, says why, and what it has left behind can be used.

use halfstep_output::probes::TIME_COLUMN;
use halfstep_output::run_json::RunStatus;
use halfstep_tests::conformance::link::eventually;
use halfstep_tests::process::{is_alive, kill, leftovers, role_of};
use halfstep_tests::run::{program, repository, whole_machine};
use halfstep_tests::{Outcome, Running, scene};
use std::time::{Duration, Instant};

/// How long the survivors may take to notice that one of them is gone, and to end, s.
const PROMISE: f64 = 2.0;

/// A run that would take long, with a handful of frames on disk.
fn under_way() -> Running {
    under_way_with_rows_each(0.0005)
}

/// The same with a row of probes at this interval, s.
fn under_way_with_rows_each(probe_interval: f64) -> Running {
    let running = scene("elastic-gate")
        .set("output.probe_interval", probe_interval)
        .set("resolution", 0.0025)
        .set("output.frame_interval", 0.001)
        .set("end_time", 6.0)
        .start();
    // Each role writes at its own pace.
    for stem in ["fluid", "solid"] {
        let index = running.dir().join(format!("frames/{stem}.hdf.series"));
        let lines = || std::fs::read_to_string(&index).map_or(0, |text| text.lines().count());
        eventually(60.0, "the first frames", || lines() > 5);
    }
    running
}

/// What is on disk is whole, and nothing else is left.
fn usable(outcome: &Outcome, launcher: u32) {
    for stem in ["fluid", "solid"] {
        let frames = outcome.frames(stem);
        assert!(frames.len() >= 4, "{stem}: {} frames", frames.len());
        assert!(frames.windows(2).all(|f| f[0].time < f[1].time && f[0].len() == f[1].len()), "{stem}");
    }
    let text = std::fs::read_to_string(outcome.dir.join("probes.csv")).unwrap();
    assert!(text.starts_with(TIME_COLUMN) && text.ends_with('\n'), "a row is cut off");
    let columns = text.lines().next().unwrap().split(',').count();
    assert!(text.lines().all(|line| line.split(',').count() == columns), "a row is cut off");
    assert_eq!(outcome.probes().rows.len(), text.lines().count() - 1);
    assert_eq!(leftovers(launcher), Vec::<String>::new());
}

#[test]
fn a_killed_role_ends_the_run_and_is_named() {
    let _machine = whole_machine();
    for (victim, survivor) in [("fluid", "solid"), ("solid", "fluid")] {
        let running = under_way();
        let launcher = running.pid();
        let [killed, other] = [victim, survivor].map(|role| role_of(launcher, role).expect("a child"));
        assert!(!leftovers(launcher).is_empty(), "what is looked for exists meanwhile");
        kill(killed, libc::SIGKILL);
        let moment = Instant::now();
        let outcome = running.wait();
        assert!(moment.elapsed().as_secs_f64() < PROMISE, "{victim}: {:?}", moment.elapsed());
        assert!(!is_alive(other), "the {survivor} outlives the run");
        assert_eq!(outcome.code(), Some(2));
        let named = format!("the {victim} process ended (signal: 9");
        assert!(outcome.stderr.contains(&named), "{}", outcome.stderr);
        assert!(outcome.log().contains(&named), "{}", outcome.log());
        let report = outcome.report();
        assert_eq!(report.status, Some(RunStatus::Failed));
        assert!(report.error.unwrap().contains(&named));
        usable(&outcome, launcher);
    }
}

#[test]
fn a_killed_launcher_takes_its_roles_along() {
    let _machine = whole_machine();
    let running = under_way();
    let launcher = running.pid();
    let roles = ["fluid", "solid"].map(|role| role_of(launcher, role).expect("a child"));
    kill(launcher, libc::SIGKILL);
    let moment = Instant::now();
    let outcome = running.wait();
    let left = PROMISE - moment.elapsed().as_secs_f64();
    eventually(left, "the end of both roles", || !roles.iter().any(|&pid| is_alive(pid)));
    assert_eq!(outcome.code(), None);
    let log = outcome.log();
    for role in ["fluid", "solid"] {
        let line = log.lines().find(|line| line.contains(&format!("{role}: ")));
        assert!(line.is_some_and(|line| line.contains("coupler")), "the {role} names who is gone: {log}");
    }
    assert_eq!(outcome.report().status, None, "nobody was left to say how it ended");
    usable(&outcome, launcher);
}

/// Also a program that the shell of another program has started, and that does not want to end; the launcher is killed
/// while that program is about to connect.
#[test]
fn a_killed_launcher_takes_external_programs_along() {
    for line in [
        "exec >&-; trap '' TERM; sleep 1000 & echo $! > PID; wait; wait",
        "sh -c 'echo $$ > PID; exec sleep 1000'",
    ] {
        let _machine = whole_machine();
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("pid");
        let line = line.replace("PID", &file.display().to_string());
        let running = scene("spring-block").argument("--solid").argument(line).start();
        let launcher = running.pid();
        let written = || std::fs::read_to_string(&file).ok()?.trim().parse::<u32>().ok();
        eventually(20.0, "the external program", || written().is_some());
        let program = written().unwrap();
        eventually(20.0, "the run's objects", || leftovers(launcher).len() > 10);
        assert!(is_alive(program), "it does not end by itself");
        kill(launcher, libc::SIGKILL);
        running.wait();
        eventually(PROMISE, "its end", || !is_alive(program));
        // What is removed last is removed after the watchdog's grace of a second; the limit only ends a hanging test.
        eventually(20.0, "the removal of the run's objects", || leftovers(launcher).is_empty());
    }
}

/// Cleaners of temporary folders remove what has not been touched for long. The run's sockets are among it.
#[test]
fn a_run_whose_temporary_folder_is_removed_goes_on() {
    let temporary = tempfile::tempdir().unwrap();
    let gate = || scene("elastic-gate").set("resolution", 0.0025).until(0.03);
    let running = gate().variable("TMPDIR", temporary.path()).start();
    let launcher = running.pid();
    let index = running.dir().join("frames/solid.hdf.series");
    eventually(60.0, "the first frame", || index.exists());
    let folder = || std::fs::read_dir(temporary.path()).unwrap().flatten().next();
    std::fs::remove_dir_all(folder().expect("the folder of the run").path()).unwrap();
    let solid = role_of(launcher, "solid").expect("a child");
    kill(solid, libc::SIGSTOP);
    std::thread::sleep(Duration::from_millis(300));
    kill(solid, libc::SIGCONT);
    let outcome = running.wait();
    assert_eq!(outcome.code(), Some(0), "{}", outcome.stderr);
    assert_eq!(outcome.report().audit.state_hash, gate().start().wait().report().audit.state_hash);
    assert_eq!(leftovers(launcher), Vec::<String>::new());
}

#[test]
fn an_interrupted_run_is_stopped_and_complete() {
    let running = under_way();
    let launcher = running.pid();
    let roles = ["fluid", "solid"].map(|role| role_of(launcher, role).expect("a child"));
    // As a terminal does: everybody in the foreground hears it.
    for pid in roles.into_iter().chain([launcher]) {
        kill(pid, libc::SIGINT);
    }
    let outcome = running.wait();
    assert_eq!(outcome.code(), Some(130), "{}", outcome.stderr);
    let report = outcome.report();
    assert_eq!((report.status, report.error), (Some(RunStatus::Stopped), None));
    assert!(report.steps > 0 && report.time > 0.0 && report.audit.state_hash.is_some());
    usable(&outcome, launcher);
    // Stopping is a step's end like any other: the last state is written.
    for stem in ["fluid", "solid"] {
        assert_eq!(outcome.frames(stem).last().unwrap().time, report.time, "{stem}");
    }
    assert!(outcome.dir.join("plot.png").exists());
}

/// What a crash of the machine would leave: rows and steps so far. A killed run can be drawn from it.
#[test]
fn a_run_that_goes_on_tells_how_far_it_is() {
    let running = under_way();
    let path = running.dir().join("run.json");
    let report = || halfstep_output::RunReport::read(&path).unwrap();
    eventually(20.0, "steps in run.json", || report().steps > 0);
    let now = report();
    assert!(now.status.is_none() && now.time > 0.0, "{:?}, {} s: {:?}", now.status, now.time, now.error);
    kill(running.pid(), libc::SIGKILL);
    let outcome = running.wait();
    assert!(!outcome.dir.join("plot.png").exists());
    let plot =
        |dir: &std::path::Path| std::process::Command::new(program()).arg("plot").arg(dir).output().unwrap();
    let drawn = plot(&outcome.dir);
    assert!(drawn.status.success(), "{}", String::from_utf8_lossy(&drawn.stderr));
    assert!(outcome.dir.join("plot.png").exists() && outcome.dir.join("contact.png").exists());
    assert_eq!(plot(&outcome.dir.join("frames")).status.code(), Some(1), "no run is there");
}

/// Rows that go to a file that nobody can find are no rows.
#[test]
fn a_run_whose_probes_are_removed_fails_and_says_so() {
    let running = under_way();
    std::fs::remove_file(running.dir().join("probes.csv")).unwrap();
    let outcome = running.wait();
    assert_eq!(outcome.code(), Some(2));
    assert!(outcome.stderr.contains("probes.csv: it was removed or replaced"), "{}", outcome.stderr);
    assert!(!outcome.stdout.contains("plot.png"), "it could not be drawn: {}", outcome.stdout);
    assert_eq!(outcome.report().status, Some(RunStatus::Failed));
}

/// The one who cannot go on says why, and the run repeats it.
#[test]
fn the_cause_of_an_end_leads_the_message() {
    let running = under_way();
    let frames = running.dir().join("frames");
    std::fs::rename(&frames, running.dir().join("aside")).unwrap();
    std::fs::write(&frames, "in the way").unwrap();
    let outcome = running.wait();
    assert_eq!(outcome.code(), Some(2));
    let error = outcome.report().error.unwrap();
    assert!(error.contains("frames/") && error.contains("cannot "), "{error}");
    assert!(error.contains("step ") && outcome.stderr.contains("log.txt"), "{}", outcome.stderr);
    drop(outcome);
    let line = "echo no such key >&2; exit 3";
    let outcome = scene("spring-block").argument("--solid").argument(line).start().wait();
    assert_eq!(outcome.code(), Some(2));
    let error = "the solid process ended (exit status: 3) before the run had begun: no such key";
    assert_eq!(outcome.report().error.as_deref(), Some(error));
}

/// As `timeout`, systemd or Slurm do: every process hears it.
#[test]
fn a_signal_to_all_processes_stops_the_run_in_order() {
    for signal in [libc::SIGTERM, libc::SIGHUP] {
        let running = under_way();
        let launcher = running.pid();
        let roles = ["fluid", "solid"].map(|role| role_of(launcher, role).expect("a child"));
        for pid in roles.into_iter().chain([launcher]) {
            kill(pid, signal);
        }
        let outcome = running.wait();
        assert_eq!(outcome.code(), Some(130), "{}", outcome.stderr);
        let report = outcome.report();
        assert_eq!((report.status, report.error), (Some(RunStatus::Stopped), None));
        usable(&outcome, launcher);
    }
}

/// A role that lives and is silent cannot keep a run from being ended: after two seconds, at once at the second signal.
#[test]
fn a_run_with_a_silent_role_can_be_interrupted() {
    for signals in [1, 2] {
        let running = under_way();
        let launcher = running.pid();
        let solid = role_of(launcher, "solid").expect("a child");
        kill(solid, libc::SIGSTOP);
        std::thread::sleep(Duration::from_millis(200));
        let moment = Instant::now();
        kill(launcher, libc::SIGINT);
        if signals == 2 {
            std::thread::sleep(Duration::from_millis(50));
            kill(launcher, libc::SIGINT);
        }
        let outcome = running.wait();
        let seconds = moment.elapsed().as_secs_f64();
        assert_eq!(outcome.code(), Some(130), "{}", outcome.stderr);
        assert!(outcome.stderr.contains("which has been silent for"), "{}", outcome.stderr);
        assert_eq!(outcome.report().status, Some(RunStatus::Stopped));
        assert!(!is_alive(solid), "it went with the run");
        assert!(seconds < PROMISE + 20.0, "{seconds} s instead of 600");
        usable(&outcome, launcher);
    }
}

/// The coupler waits for the solid, for its state or for its probes, and the solid can tell nobody that the fluid has
/// gone. With a row each step about every second wait is one for probes.
#[test]
fn the_end_of_one_role_ends_the_wait_for_another() {
    for probe_interval in [0.0005, 1e-5, 1e-5, 1e-5, 1e-5] {
        the_fluid_ends_while_the_solid_is_awaited(probe_interval);
    }
}

fn the_fluid_ends_while_the_solid_is_awaited(probe_interval: f64) {
    let running = under_way_with_rows_each(probe_interval);
    let launcher = running.pid();
    let [fluid, solid] = ["fluid", "solid"].map(|role| role_of(launcher, role).expect("a child"));
    kill(solid, libc::SIGSTOP);
    std::thread::sleep(Duration::from_millis(200));
    kill(fluid, libc::SIGKILL);
    let outcome = running.wait();
    assert_eq!(outcome.code(), Some(2), "{}", outcome.stderr);
    assert!(
        outcome.stderr.contains("the fluid process ended (signal: 9 (SIGKILL)) at step "),
        "{}",
        outcome.stderr
    );
    assert_eq!(outcome.report().status, Some(RunStatus::Failed));
    assert!(!is_alive(solid), "it went with the run");
    usable(&outcome, launcher);
}

#[test]
fn nobody_has_to_read_what_a_run_says() {
    // The shell closes both ends before the program starts.
    let folder = tempfile::tempdir().unwrap();
    let line = format!(
        "exec {} run {} --until 0.002 --set resolution=0.0025 --set time_step=1 --out {} >&- 2>&-",
        program().display(),
        repository().join("scenes/elastic-gate.toml").display(),
        folder.path().join("run").display()
    );
    let status =
        std::process::Command::new("sh").arg("-c").arg(line.replace(" --set time_step=1", "")).status();
    assert_eq!(status.unwrap().code(), Some(0));
    let refused = std::process::Command::new("sh").arg("-c").arg(line).status();
    assert_eq!(refused.unwrap().code(), Some(1), "a wrong scene, and no panic");
}

/// What the machine does not have is said before anything is done, an earlier run removed among it.
#[test]
fn a_run_that_cannot_be_held_is_refused_at_its_start() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("run");
    std::fs::create_dir(&dir).unwrap();
    std::fs::write(dir.join("run.json"), "{}").unwrap();
    let gate = || scene("elastic-gate").set("resolution", 0.0025).out(&dir).argument("--force");
    let outcome = gate().set("resolution", 0.0002).set("output.frame_interval", 4.1e-6).outcome();
    assert_eq!(outcome.code(), Some(1));
    let expected = "97562 frames among it, and ";
    assert!(outcome.stderr.contains(expected), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("raise output.frame_interval"), "{}", outcome.stderr);
    let line = format!(
        "ulimit -n 40; exec {} run {} --set resolution=0.0025 --force --out {} 2>&1",
        program().display(),
        repository().join("scenes/elastic-gate.toml").display(),
        dir.display()
    );
    let output = std::process::Command::new("sh").arg("-c").arg(line).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("needs about 104 at once, "), "{said}");
    assert_eq!(std::fs::read_to_string(dir.join("run.json")).unwrap(), "{}", "it was not touched");
}

#[test]
fn a_folder_in_use_is_refused() {
    let running = under_way();
    let (launcher, dir) = (running.pid(), running.dir().to_owned());
    for arguments in [&["--force"][..], &[]] {
        let again = arguments.iter().fold(scene("elastic-gate").out(&dir), |run, a| run.argument(*a));
        let outcome = again.start().wait();
        assert_eq!(outcome.code(), Some(1));
        assert!(outcome.stderr.contains(&format!("process {launcher}")), "{}", outcome.stderr);
    }
    let resumed = scene("elastic-gate").resume(&dir).start().wait();
    assert_eq!(resumed.code(), Some(1), "{}", resumed.stderr);
    kill(launcher, libc::SIGINT);
    let outcome = running.wait();
    assert_eq!(outcome.code(), Some(130), "it was not disturbed: {}", outcome.stderr);
}

#[test]
fn an_earlier_run_is_kept_unless_forced() {
    let dir = tempfile::tempdir().unwrap();
    let run = || scene("elastic-gate").set("resolution", 0.0025).until(0.001).out(dir.path());
    let first = run().run();
    let refused = run().outcome();
    assert_eq!(refused.code(), Some(1), "{}", refused.stderr);
    assert!(refused.stderr.contains("--force"), "{}", refused.stderr);
    assert_eq!(refused.report(), first.report, "it was not touched");
    let forced = run().argument("--force").run();
    assert_eq!(forced.state_hash(), first.state_hash());
}

#[test]
fn a_wrong_scene_starts_nothing() {
    let outcome = scene("elastic-gate").set("solid.youngs_modulus", -1).outcome();
    assert_eq!(outcome.code(), Some(1));
    assert!(outcome.stderr.contains("youngs_modulus"), "{}", outcome.stderr);
    assert!(!outcome.dir.exists(), "nothing was started");
    for wrong in
        [["--no-such-option", "1"], ["--solid-wait", "-1"], ["--solid-wait", "nan"], ["--threads", "0"]]
    {
        let outcome = wrong.iter().fold(scene("elastic-gate"), |run, a| run.argument(*a)).outcome();
        assert_eq!(outcome.code(), Some(1), "{wrong:?}");
        assert!(outcome.stderr.contains(wrong[0]), "{}", outcome.stderr);
        assert!(!outcome.dir.exists(), "nothing was started");
    }
    let missing = scene("no-such-scene").outcome();
    assert_eq!(missing.code(), Some(1));
    assert!(missing.stderr.contains("no-such-scene"), "{}", missing.stderr);
}
