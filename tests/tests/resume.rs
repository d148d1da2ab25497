//! A run that was interrupted goes on to the bits of a run that never was: hash, probes and frames.

use halfstep_output::checkpoint::{FOLDERS, MANIFEST, Manifest};
use halfstep_output::run_json::RunStatus;
use halfstep_sph::lane::Isa;
use halfstep_tests::baseline::baselines;
use halfstep_tests::process::{kill, role_of};
use halfstep_tests::run::{Outcome, files, repository};
use halfstep_tests::scene;
use std::hash::{BuildHasher, RandomState};
use std::path::Path;
use std::time::{Duration, Instant};

/// A number in 0 .. 1 that is another one in each run of the tests.
fn random() -> f64 {
    let bits = RandomState::new().hash_one(Instant::now());
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// Every shipped scene, stopped short at a random time: the run is prolonged from its last checkpoint before that end.
#[test]
fn every_shipped_scene_goes_on_to_the_stored_bits() {
    let level = Isa::detect();
    let mut wrong = Vec::new();
    for baseline in baselines() {
        let share = 0.2 + 0.6 * random();
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("run");
        // Intervals of the whole run, and a few checkpoints on the way.
        let path = repository().join("scenes").join(&baseline.case).with_extension("toml");
        let whole = [baseline.set.clone(), vec![format!("end_time={}", baseline.until)]].concat();
        let output = halfstep_scene::load(&path, &whole).unwrap().output;
        let short = baseline.builder_until(level, share * baseline.until);
        let short = short.set("output.frame_interval", output.frame_interval);
        let short = short.set("output.probe_interval", output.probe_interval);
        short.set("output.checkpoint_interval", 0.3 * share * baseline.until).out(&dir).run();
        let resumed = scene(&baseline.case).resume(&dir).until(baseline.until).in_process().run();
        let came_from = resumed.report.resumed.clone();
        assert_eq!(came_from.len(), 1);
        assert!(came_from[0].step > 0 && came_from[0].time < share * baseline.until, "{came_from:?}");
        let what = format!("{} / {}, stopped at {share} of the run", baseline.case, baseline.name);
        if let Some(difference) = baseline.difference(level, &baseline.record(level, &resumed)) {
            wrong.push(format!("{what}: {difference}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The plate in the gate, with every file compared: interrupted by Ctrl-C or killed, as processes.
#[test]
fn a_killed_run_leaves_the_files_of_one_that_was_not() {
    let gate = || {
        scene("elastic-gate")
            .set("resolution", 0.0025)
            .set("output.checkpoint_interval", 0.002)
            .set("output.frame_interval", 0.004)
            .until(0.08)
    };
    let whole = gate().run();
    for signal in [libc::SIGKILL, libc::SIGINT] {
        let folder = tempfile::tempdir().unwrap();
        let dir = folder.path().join("run");
        let cut = interrupted(gate().out(&dir), &dir, signal, 1.0 + 4.0 * random());
        if signal == libc::SIGINT {
            assert_eq!(cut.report().status, Some(RunStatus::Stopped));
            assert!(cut.stdout.contains("halfstep resume"), "{}", cut.stdout);
        }
        let resumed = scene("elastic-gate").resume(&dir).run();
        assert_eq!(resumed.state_hash(), whole.state_hash(), "{:?}", resumed.report.resumed);
        assert_eq!(resumed.report.steps, whole.report.steps);
        assert_eq!(resumed.report.dt, whole.report.dt);
        assert_eq!(resumed.report.audit, whole.report.audit);
        assert_eq!(resumed.report.work.pair_evaluations, whole.report.work.pair_evaluations);
        assert_eq!(files(&dir).unwrap(), files(whole.dir()).unwrap(), "{:?}", resumed.report.resumed);
    }
}

/// Starts a run and interrupts it when it has left some checkpoints.
fn interrupted(run: halfstep_tests::RunBuilder, dir: &Path, signal: i32, checkpoints: f64) -> Outcome {
    let mut running = run.start();
    let newest = || FOLDERS.iter().filter_map(|f| Manifest::read(&dir.join(f)).ok()?).map(|m| m.number).max();
    while (newest().unwrap_or(0) as f64) < checkpoints {
        assert!(running.is_alive(), "{:?}", running.wait());
        std::thread::sleep(Duration::from_millis(1));
    }
    // SAFETY: the launcher is a child of this process that has not been waited for.
    unsafe { libc::kill(running.pid() as i32, signal) };
    running.wait()
}

#[test]
fn a_torn_generation_is_passed_over_and_a_changed_run_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("run");
    let tank = || {
        let tank = scene("hydrostatic-tank").set("output.checkpoint_interval", 0.01);
        tank.set("output.frame_interval", 0.01).set("output.probe_interval", 0.01)
    };
    tank().until(0.05).out(&dir).run();
    let refused = |expected: &str| {
        let outcome = scene("hydrostatic-tank").resume(&dir).until(0.06).outcome();
        assert_eq!(outcome.code(), Some(1));
        assert!(outcome.stderr.contains(expected), "{}", outcome.stderr);
    };
    let finished = scene("hydrostatic-tank").resume(&dir).outcome();
    assert!(finished.stderr.contains("--until SECONDS gives it a later one"), "{}", finished.stderr);
    let text = std::fs::read_to_string(dir.join("scene.json")).unwrap();
    std::fs::write(dir.join("scene.json"), text.replace("-9.81", "-9.82")).unwrap();
    refused("is of another scene than scene.json beside it");
    std::fs::write(dir.join("scene.json"), &text).unwrap();
    let number = |folder: &str| Manifest::read(&dir.join(folder)).unwrap().unwrap().number;
    let (newer, older) = if number(FOLDERS[0]) > number(FOLDERS[1]) {
        (FOLDERS[0], FOLDERS[1])
    } else {
        (FOLDERS[1], FOLDERS[0])
    };
    std::fs::write(dir.join(newer).join("fluid.hdf"), b"torn").unwrap();
    let resumed = scene("hydrostatic-tank").resume(&dir).until(0.06).run();
    assert!(resumed.outcome.stderr.contains("is passed over"), "{}", resumed.outcome.stderr);
    let whole = tank().until(0.06).run();
    assert_eq!(resumed.state_hash(), whole.state_hash(), "from the older one");
    std::fs::remove_dir_all(dir.join(newer)).unwrap();
    std::fs::remove_file(dir.join(older).join(MANIFEST)).unwrap();
    refused("has no whole checkpoint");
}

/// What lies before the checkpoint must be what the run has written: the end shall be that of one run.
#[test]
fn what_was_changed_since_the_checkpoint_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("run");
    let tank = |until: f64| {
        let tank = scene("hydrostatic-tank").set("output.checkpoint_interval", 0.01);
        tank.set("output.frame_interval", 0.005).set("output.probe_interval", 0.01).until(until)
    };
    tank(0.05).out(&dir).run();
    let refused = |until: f64, expected: &str| {
        let outcome = scene("hydrostatic-tank").resume(&dir).until(until).outcome();
        assert_eq!(outcome.code(), Some(1));
        assert!(outcome.stderr.contains(expected), "{}", outcome.stderr);
    };
    refused(0.045, "the run has reached 0.05 s, and --until 0.045 s would discard its end");
    let (frame, probes) = (dir.join("frames/fluid_000002.hdf"), dir.join("probes.csv"));
    let (kept, rows) = (std::fs::read(&frame).unwrap(), std::fs::read_to_string(&probes).unwrap());
    std::fs::remove_file(&frame).unwrap();
    refused(0.06, "fluid_000002.hdf: this frame was written before the checkpoint and is missing");
    std::fs::write(&frame, kept).unwrap();
    std::fs::write(&probes, rows.replacen("\n0.01", "\n0.02", 1)).unwrap();
    refused(0.06, "its rows up to the checkpoint are not those that the run has written");
    std::fs::write(&probes, rows).unwrap();
    let resumed = scene("hydrostatic-tank").resume(&dir).until(0.06).run();
    let whole = tank(0.06).run();
    assert_eq!(resumed.state_hash(), whole.state_hash());
    assert_eq!(files(&dir).unwrap(), files(whole.dir()).unwrap());
}

/// Whatever is refused stays as it was, and can be resumed when it is mended.
#[test]
fn a_refused_resume_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("run");
    let tank = || scene("hydrostatic-tank").set("output.checkpoint_interval", 0.01);
    let tank = |until: f64| {
        tank().set("output.frame_interval", 0.005).set("output.probe_interval", 0.01).until(until)
    };
    tank(0.05).out(&dir).run();
    let (aside, probes) = (folder.path().join("probes.csv"), dir.join("probes.csv"));
    std::fs::rename(&probes, &aside).unwrap();
    let before = (
        std::fs::read(dir.join("scene.json")).unwrap(),
        std::fs::read_dir(dir.join("frames")).unwrap().count(),
    );
    let refused = scene("hydrostatic-tank").resume(&dir).until(0.06).outcome();
    assert_eq!(refused.code(), Some(1));
    assert!(refused.stderr.contains("probes.csv"), "{}", refused.stderr);
    assert!(
        before
            == (
                std::fs::read(dir.join("scene.json")).unwrap(),
                std::fs::read_dir(dir.join("frames")).unwrap().count()
            ),
        "nothing was touched"
    );
    std::fs::rename(&aside, &probes).unwrap();
    let resumed = scene("hydrostatic-tank").resume(&dir).until(0.06).run();
    assert_eq!(resumed.state_hash(), tank(0.06).run().state_hash());
    // A name in an index does not lead out of the folder.
    let victim = folder.path().join("victim.hdf");
    std::fs::write(&victim, "mine").unwrap();
    let index = dir.join("frames/fluid.hdf.series");
    let text = std::fs::read_to_string(&index).unwrap();
    assert!(text.contains("fluid_000012.hdf"), "written after the checkpoint");
    std::fs::write(&index, text.replacen("fluid_000012.hdf", "../../victim.hdf", 1)).unwrap();
    let refused = scene("hydrostatic-tank").resume(&dir).until(0.07).outcome();
    assert_eq!(refused.code(), Some(1), "{}", refused.stderr);
    assert!(refused.stderr.contains("is no frame of the fluid"), "{}", refused.stderr);
    assert!(victim.exists());
}

/// A role that outlives its launcher still has the folder: what it writes later would spoil a resumed run.
#[test]
fn a_run_with_a_living_role_is_not_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("run");
    let gate = scene("elastic-gate").set("resolution", 0.0025).set("output.checkpoint_interval", 0.002);
    let mut running = gate.until(0.03).out(&dir).start();
    let whole = || FOLDERS.iter().any(|name| dir.join(name).join(MANIFEST).exists());
    while !whole() {
        assert!(running.is_alive(), "{:?}", running.wait());
        std::thread::sleep(Duration::from_millis(1));
    }
    let solid = role_of(running.pid(), "solid").expect("a child");
    kill(solid, libc::SIGSTOP);
    kill(running.pid(), libc::SIGKILL);
    running.wait();
    let refused = scene("elastic-gate").resume(&dir).start().wait();
    assert_eq!(refused.code(), Some(1), "{}", refused.stderr);
    assert!(refused.stderr.contains("a run goes on in"), "{}", refused.stderr);
    kill(solid, libc::SIGCONT);
    scene("elastic-gate").resume(&dir).run();
}
