//! Roles as processes: what others notice when one is killed, and what is left when all are gone.

use halfstep_coupling::supervise::{Children, StopFlags};
use halfstep_link::{Claim, Expect, LinkConfig, LinkError, Processes, Threads, cleanup_stale};
use halfstep_tests::conformance::link::end::End;
use halfstep_tests::conformance::link::suite::with_links;
use halfstep_tests::conformance::link::{Run, eventually};
use halfstep_wire::Name;
use halfstep_wire::half_step::Stage::First;
use std::collections::BTreeMap;
use std::os::unix::fs::MetadataExt;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

const ROLES: [Name; 3] = [Name::FLUID, Name::SOLID, Name::COUPLER];
const ENDLESS: &str = "1000000000";

fn helper() -> Command {
    Command::new(env!("CARGO_BIN_EXE_link-role"))
}

fn start(children: &mut Children, config: &LinkConfig, role: Name, steps: &str) {
    let mut command = helper();
    command.arg(role.to_string()).arg(steps).envs(config.to_env());
    children.spawn(role, command).unwrap();
}

fn kill(pid: u32, signal: i32) {
    assert_eq!(unsafe { libc::kill(pid as i32, signal) }, 0);
}

fn is_alive(pid: u32) -> bool {
    unsafe { libc::kill(pid as i32, 0) == 0 }
}

fn log_of(dir: &tempfile::TempDir) -> String {
    std::fs::read_to_string(dir.path().join("log.txt")).unwrap_or_default()
}

/// Lets a run get going: its objects exist, and then some.
fn settle(run: &Run) {
    eventually(20.0, "the run's start", || run.leftovers().len() > 20);
    std::thread::sleep(Duration::from_millis(200));
}

#[test]
fn memory_that_is_not_there_is_refused_before_anything_is_made() {
    let run = Run::new(u32::MAX, 1);
    match End::<Processes>::open(&run, Name::FLUID, None).map(drop) {
        Err(LinkError::SharedMemoryFull { needed, available }) => {
            assert!(needed > available && needed >= 128 * u64::from(u32::MAX));
            assert!(needed <= run.shared_memory_bytes());
        }
        other => panic!("{other:?}"),
    }
    // On the heap there is no such limit to ask for.
    let config = LinkConfig { handshake_seconds: 0.1, ..LinkConfig::of_two(100, 100) };
    let error = End::<Threads>::open(&config, Name::FLUID, None).map(drop).unwrap_err();
    assert!(matches!(error, LinkError::HandshakeTimeout { .. }), "{error}");
}

/// Every page of every object is taken before the first message, so that no later write can fail.
#[test]
fn memory_is_reserved() {
    let run = Run::new(20_000, 3_000);
    let whole = AtomicU64::new(0);
    with_links::<Processes>(
        &run,
        None,
        |mut fluid| drop(fluid.receive_forces(&Expect::new(0, First))),
        |mut solid| drop(solid.receive_forces(&Expect::new(0, First))),
        |link| {
            eventually(5.0, "the others' reservations", || {
                let objects = run.leftovers().into_iter().filter(|name| !name.starts_with('/'));
                let sizes = objects.map(|name| std::fs::metadata(Path::new("/dev/shm").join(name)).unwrap());
                let (mut length, mut missing) = (0, 0);
                for data in sizes {
                    length += data.len();
                    missing += data.len().saturating_sub(512 * data.blocks());
                }
                whole.store(length, Ordering::Relaxed);
                missing == 0
            });
            drop(link);
        },
    );
    let (actual, estimate) = (whole.into_inner(), run.shared_memory_bytes());
    assert!(actual > 20_000 * 128 * 4, "{actual}");
    assert!(actual <= estimate && estimate < actual + actual / 5, "{actual} bytes, estimated {estimate}");
}

#[test]
fn three_processes_finish() {
    let dir = tempfile::tempdir().unwrap();
    let run = Run::new(100, 100);
    let mut children = Children::new(&dir.path().join("log.txt"));
    for role in ROLES {
        start(&mut children, &run, role, "2000");
    }
    assert!(children.wait(Duration::from_secs(60)));
    assert!(children.exits().iter().all(|(_, status)| status.success()), "{}", log_of(&dir));
}

/// Kills a role of a run and returns how long it took the two others to report it and end.
fn kill_one(victim: Name) -> Duration {
    let dir = tempfile::tempdir().unwrap();
    let run = Run::new(100, 100);
    let _claim = Claim::new(&run).unwrap();
    let mut children = Children::new(&dir.path().join("log.txt"));
    for role in ROLES {
        start(&mut children, &run, role, ENDLESS);
    }
    settle(&run);
    assert_eq!(children.first_exit(), None, "{}", log_of(&dir));
    let pid = children.pids().into_iter().find(|(role, _)| *role == victim).unwrap().1;
    kill(pid, libc::SIGKILL);
    let killed = Instant::now();
    assert!(children.wait(Duration::from_secs(10)), "{victim}");
    let time = killed.elapsed();
    for (role, status) in children.exits() {
        if role == victim {
            assert_eq!(status.signal(), Some(libc::SIGKILL));
        } else {
            assert_eq!(status.code(), Some(2), "{role}");
        }
    }
    // One of the two others may learn of it from the third's end.
    assert!(log_of(&dir).contains(&format!("the {victim} is gone")), "{victim}: {}", log_of(&dir));
    time
}

#[test]
fn a_killed_role_is_reported_within_a_second() {
    for victim in ROLES {
        // The best of three: the machine may have other work.
        let mut times = (0..3).map(|_| kill_one(victim));
        assert!(times.any(|time| time < Duration::from_secs(1)), "{victim}");
    }
}

#[test]
fn stopped_children_clean_up() {
    let dir = tempfile::tempdir().unwrap();
    let run = Run::new(100, 100);
    let mut children = Children::new(&dir.path().join("log.txt"));
    for role in ROLES {
        start(&mut children, &run, role, ENDLESS);
    }
    settle(&run);
    // Ctrl-C is the coupler's business.
    for (_, pid) in children.pids() {
        kill(pid, libc::SIGINT);
    }
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(children.first_exit(), None);
    let start = Instant::now();
    let exits = children.stop(Duration::from_secs(10));
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
    assert_eq!(exits.len(), 3);
    assert!(exits.iter().all(|(_, status)| status.code() == Some(2)), "{exits:?}");
    assert!(log_of(&dir).contains("aborted"), "{}", log_of(&dir));
}

/// Starts a launcher with three children; returns it, the run and the children's process numbers.
fn launch(dir: &Path) -> (std::process::Child, Run, Vec<u32>) {
    let launcher = helper().arg("launcher").arg(dir).spawn().unwrap();
    let path = dir.join("run.json");
    eventually(20.0, "the launcher's start", || path.exists());
    let state: serde_json::Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    let environment: BTreeMap<String, String> = serde_json::from_value(state["environment"].clone()).unwrap();
    let run = Run(LinkConfig::from_variables(|key| environment.get(key).cloned()).unwrap());
    let pids: Vec<u32> = serde_json::from_value(state["pids"].clone()).unwrap();
    settle(&run);
    (launcher, run, pids)
}

#[test]
fn a_killed_launcher_leaves_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let (mut launcher, run, pids) = launch(dir.path());
    launcher.kill().unwrap();
    launcher.wait().unwrap();
    eventually(10.0, "the children's end", || !pids.iter().any(|pid| is_alive(*pid)));
    assert_eq!(run.leftovers(), Vec::<String>::new());
}

#[test]
fn a_later_run_removes_the_memory_of_killed_processes() {
    let dir = tempfile::tempdir().unwrap();
    let (mut launcher, run, pids) = launch(dir.path());
    // The launcher first, stopped, so that its children do not hear of each other's end from it.
    kill(launcher.id(), libc::SIGSTOP);
    for pid in &pids {
        kill(*pid, libc::SIGKILL);
    }
    launcher.kill().unwrap();
    launcher.wait().unwrap();
    eventually(10.0, "the children's end", || !pids.iter().any(|pid| is_alive(*pid)));
    // Another run on this machine may have been faster: only the result counts.
    cleanup_stale();
    assert_eq!(run.leftovers(), Vec::<String>::new());
}

#[test]
fn a_shell_line_learns_of_the_run_and_is_killed_with_its_children() {
    let dir = tempfile::tempdir().unwrap();
    let run = Run::new(123, 45);
    let log = dir.path().join("log.txt");
    std::fs::write(&log, "before\n").unwrap();
    let mut children = Children::new(&log);
    let line = "echo $HALFSTEP_FLUID_CAPACITY $HALFSTEP_SOLID_CAPACITY $HALFSTEP_SCENE; trap '' TERM; \
                sleep 1000 & echo child $! >&2; wait; wait";
    children
        .spawn_shell(&run.participants[1], line, &run, &[("HALFSTEP_SCENE", Path::new("/some/scene.json"))])
        .unwrap();
    eventually(5.0, "the shell's words", || log_of(&dir).contains("child "));
    let log = log_of(&dir);
    assert!(log.starts_with("before\n123 45 /some/scene.json\n"), "{log}");
    let grandchild: u32 = log.split_whitespace().next_back().unwrap().parse().unwrap();
    assert!(is_alive(grandchild));
    let exits = children.stop(Duration::from_millis(300));
    assert_eq!(exits[0].1.signal(), Some(libc::SIGKILL), "it ignores the request to end");
    eventually(10.0, "the grandchild's end", || !is_alive(grandchild));
}

#[test]
fn what_cannot_be_started_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let mut children = Children::new(&dir.path().join("log.txt"));
    let error = children.spawn(Name::FLUID, Command::new("/no/such/program")).unwrap_err().to_string();
    assert!(error.contains("fluid") && error.contains("/no/such/program"), "{error}");
    let error =
        Children::new(Path::new("/no/such/log.txt")).spawn(Name::FLUID, helper()).unwrap_err().to_string();
    assert!(error.contains("/no/such/log.txt"), "{error}");
}

#[test]
fn failure_comes_before_success() {
    let dir = tempfile::tempdir().unwrap();
    let run = Run::new(1, 1);
    let mut children = Children::new(&dir.path().join("log.txt"));
    children.spawn_shell(&run.participants[0], "exit 0", &run, &[]).unwrap();
    children.spawn_shell(&run.participants[1], "exit 3", &run, &[]).unwrap();
    assert!(children.wait(Duration::from_secs(5)));
    let (role, status) = children.first_exit().unwrap();
    assert_eq!((role, status.code()), (Name::SOLID, Some(3)));
}

#[test]
fn the_first_signal_asks_for_an_end_in_order_and_the_second_for_one_at_once() {
    for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGHUP] {
        let flags = StopFlags::of_signals().unwrap();
        kill(std::process::id(), signal);
        eventually(1.0, "the stop", || flags.stop.load(Ordering::Relaxed));
        assert!(!flags.at_once.load(Ordering::Relaxed));
        kill(std::process::id(), signal);
        eventually(1.0, "the end", || flags.at_once.load(Ordering::Relaxed));
    }
}
