//! A solid in another language, end to end: fluid process, coupler and a Python script on the package `halfstep`.

use halfstep_output::series::Series;
use halfstep_tests::conformance::link::eventually;
use halfstep_tests::curve::Curve;
use halfstep_tests::process::{kill, leftovers};
use halfstep_tests::python::python;
use halfstep_tests::run::{files, repository, scene};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const STIFFNESS: f64 = 2e4;

/// The line that starts the script.
fn command() -> String {
    let script = repository().join("tests/python/spring_block.py");
    format!("{} {} {STIFFNESS}", python().display(), script.display())
}

/// Displacement x at which the spring carries the thrust of the water, whose volume is kept: k x = rho g H(x)² / 2.
fn equilibrium() -> f64 {
    let mut x = 0.0;
    for _ in 0..50 {
        let depth = 0.2 * 0.1 / (0.2 + x);
        x = 0.5 * 1000.0 * 9.81 * depth * depth / STIFFNESS;
    }
    x
}

#[test]
fn a_block_on_a_spring_in_python_swings_as_the_formula_says() {
    let run = scene("spring-block").argument("--solid").argument(command()).run();
    let curve = run.curve("block.x");

    // Westergaard 1933, as von Karman's estimate for a rigid wall: added mass 0.543 rho H² per metre of width.
    let mass = 8000.0 * 0.04 * 0.14 + 0.543 * 1000.0 * 0.1 * 0.1;
    let period = 2.0 * std::f64::consts::PI * (mass / STIFFNESS).sqrt();
    let expected = equilibrium();
    let mean = curve.between(0.0, 3.0 * period).mean();
    println!("equilibrium {mean:e} m, formula {expected:e} m");
    // 0.954 measured, and 0.932 with twice the spacing.
    assert!((mean / expected - 0.954).abs() < 0.01, "{mean} {expected}");

    let swing = Curve { values: curve.values.iter().map(|x| x - mean).collect(), ..curve };
    let measured = swing.period().expect("it swings");
    println!("period {measured} s, formula {period} s");
    // 0.971 measured.
    assert!((measured / period - 0.971).abs() < 0.01, "{measured} {period}");

    // Its frames and probes are the coupler's work.
    assert_eq!(
        Series::of_run(run.dir(), "solid").unwrap().len(),
        Series::of_run(run.dir(), "fluid").unwrap().len()
    );
    assert!(run.report.audit.action_reaction.unwrap() <= 1e-12);
    assert!(run.report.audit.impulse.unwrap() <= 1e-12);
    // What its records tell: how far it has gone, no stress, and nothing of bodies.
    let frames = run.outcome.frames("solid");
    let (first, last) = (&frames[0], &frames[frames.len() - 1]);
    assert!(
        first.displacement.iter().all(|gone| *gone == [0.0; 3]) && first.displacement.len() == first.len()
    );
    let gone = *run.curve("block.x").values.last().expect("a row") as f32;
    assert!(
        last.displacement.iter().all(|x| (x[0] - gone).abs() < 1e-7),
        "{:?} {gone}",
        last.displacement[0]
    );
    assert!(last.von_mises.iter().all(|stress| *stress == 0.0) && last.body.is_empty());
}

#[test]
fn a_run_with_the_block_goes_on_after_an_interruption() {
    let block = || {
        let block = scene("spring-block").argument("--solid").argument(command());
        let block = block.set("output.checkpoint_interval", 0.01).set("output.frame_interval", 0.02);
        block.set("output.probe_interval", 0.001)
    };
    let whole = block().until(0.06).run();
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("run");
    block().until(0.035).out(&dir).run();
    let resumed =
        scene("spring-block").resume(&dir).argument("--solid").argument(command()).until(0.06).run();
    assert!(resumed.report.resumed[0].step > 0);
    assert_eq!(resumed.state_hash(), whole.state_hash());
    assert_eq!(resumed.probes, whole.probes, "the block's are measured from its first positions");
    assert_eq!(resumed.report.external, whole.report.external, "its first message is that of the beginning");
    let built_in = scene("spring-block").resume(&dir).until(0.07).outcome();
    assert_eq!(built_in.code(), Some(1));
    let said = "`solid` of this run was computed by another program: --solid or --await-solid";
    assert!(built_in.stderr.contains(said), "{}", built_in.stderr);
    // The block forgets how far it was, how fast, or how heavy: the run is as it was.
    let told = || {
        (files(&dir).unwrap(), ["run.json", "scene.json"].map(|name| std::fs::read(dir.join(name)).unwrap()))
    };
    let before = told();
    for (honest, lie) in [
        ("x, v = float(saved", "x, v = 1e-3 + float(saved"),
        ("velocity=v * along_x", "velocity=0.0"),
        ("mass = density", "mass = (1.0 + halfstep.saved()['v'] ** 2) * density"),
    ] {
        let forgetful = altered(honest, lie);
        let refused = scene("spring-block")
            .resume(&dir)
            .argument("--solid")
            .argument(forgetful.line())
            .until(0.07)
            .outcome();
        assert_eq!(refused.code(), Some(1));
        let said = "the solid shows another state than that of the checkpoint: the run has not gone on";
        assert!(refused.stderr.contains(said), "{}", refused.stderr);
        assert!(told() == before, "{}", refused.stderr);
    }
    // A program that is not there, and one that nobody starts.
    for arguments in [&["--solid", "no-such-program"][..], &["--await-solid", "--solid-wait", "0.5"]] {
        let missing =
            arguments.iter().fold(scene("spring-block").resume(&dir), |run, word| run.argument(*word));
        let missing = missing.until(0.07).outcome();
        assert_eq!(missing.code(), Some(1), "{}", missing.stderr);
        assert!(told() == before, "{}", missing.stderr);
    }
    // Its last frames stand behind the others: one that remembers goes on.
    let going = scene("spring-block").resume(&dir).argument("--solid").argument(command()).until(0.07).run();
    let times: Vec<f64> = going.outcome.frames("fluid").iter().map(|frame| frame.time).collect();
    assert!(times[0] == 0.0 && times.len() == 5 && times.is_sorted(), "{times:?}");
}

/// A program knows nothing of what halfstep's own solid saved.
#[test]
fn a_run_of_the_built_in_solid_goes_on_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("run");
    let built_in = scene("spring-block").set("output.checkpoint_interval", 0.01);
    built_in.until(0.012).out(&dir).run();
    let status = || std::fs::read(dir.join("run.json")).unwrap();
    let before = status();
    let other =
        scene("spring-block").resume(&dir).argument("--solid").argument(command()).until(0.03).outcome();
    assert_eq!(other.code(), Some(1));
    assert!(other.stderr.contains("`solid` of this run was computed by halfstep itself"), "{}", other.stderr);
    assert_eq!(status(), before);
}

/// A block that says it rests while it swings; one that says what it does is told nothing.
#[test]
fn velocities_that_do_not_move_the_solid_are_told() {
    let lying = altered("v_now * along_x)", "0.0)");
    for (line, told) in [(lying.line(), true), (command(), false)] {
        let run = scene("spring-block").until(0.06).argument("--solid").argument(line).run();
        let said = "the velocities of the solid do not take its particles where they are: 100 %";
        assert_eq!(run.outcome.stderr.contains(said), told, "{}", run.outcome.stderr);
        let warnings = run.report.warnings.iter().filter(|warning| warning.contains(said)).count();
        assert_eq!(warnings, usize::from(told), "{:?}", run.report.warnings);
    }
}

/// The script with something else in it.
struct Altered(tempfile::TempDir);

fn altered(honest: &str, lie: &str) -> Altered {
    let script = std::fs::read_to_string(repository().join("tests/python/spring_block.py")).unwrap();
    assert!(script.contains(honest), "{honest}");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("block.py"), script.replace(honest, lie)).unwrap();
    Altered(folder)
}

impl Altered {
    fn line(&self) -> String {
        format!("{} {} {STIFFNESS}", python().display(), self.0.path().join("block.py").display())
    }
}

#[test]
fn a_block_without_checkpoints_cannot_be_set_back() {
    let unable = altered(", save=lambda: {\"x\": x, \"v\": v}", "");
    let block = || scene("spring-block").until(0.01).argument("--on-divergence").argument("retry");
    let outcome = block().argument("--solid").argument(unable.line()).outcome();
    assert_eq!(outcome.code(), Some(2));
    let error = outcome.report().error.unwrap();
    assert_eq!(error, "--on-divergence retry needs checkpoints, and the solid writes none");
    let by_hand = block().argument("--await-solid").outcome();
    assert_eq!(by_hand.code(), Some(1));
    assert!(by_hand.stderr.contains("cannot with a solid started by hand"), "{}", by_hand.stderr);
}

/// What cannot be is refused where it arrives, and named by its field and not by what the fluid makes of it.
#[test]
fn a_block_that_sends_nonsense_is_named() {
    for (honest, lie, named) in [
        (
            "publish(rest + x_now",
            "publish(rest + (x_now + 10 * (step.number == 19))",
            "by 1.000e1 m at step 19, although its particles are no faster than",
        ),
        ("mass, density, velocity", "-mass, density, velocity", "mass is "),
        ("\nmass =", "\nrest = rest[:0]\nmass =", "publishes no interface particles"),
        (
            "for step in solid:",
            "for step in solid:\n    solid.header['status'] = 3 * (step.number == 20)",
            "status is 3, expected 0 (ok)",
        ),
    ] {
        let lying = altered(honest, lie);
        let outcome = scene("spring-block").until(0.05).argument("--solid").argument(lying.line()).outcome();
        assert_eq!(outcome.code(), Some(2), "{lie}: {}", outcome.stderr);
        let error = outcome.report().error.unwrap();
        assert!(error.contains("the solid") && error.contains(named), "{lie}: {error}");
    }
}

/// 8 by 28 particles of 0.2 kg/m, 180 of them within 2 h of the surface; water reaches 20 rows high.
#[test]
fn a_block_that_is_not_the_scenes_is_told_of() {
    for (honest, lie, said) in [
        (
            "\nmass =",
            "\nrest = rest[rest[:, 1] > 0.03]\nmass =",
            "42 of 180 places near the surface of the solid",
        ),
        (
            "low + dx / 2, high, dx",
            "low + dx / 4, high, dx / 2",
            "publishes 896 particles, and its shapes have 224",
        ),
        ("\nmass =", "\nrest[:, 0] -= 0.005\nmass =", "20 particles of the fluid begin in the solid"),
        (
            "mass = density",
            "mass = 10 * density",
            "a mass of 448.0000 kg/m, and the table of its particles 44.8000 kg/m",
        ),
    ] {
        let lying = altered(honest, lie);
        let outcome = scene("spring-block").until(0.001).argument("--solid").argument(lying.line()).outcome();
        let said_as_warning =
            |text: &str| text.lines().any(|line| line.contains("warning: ") && line.contains(said));
        assert!(said_as_warning(&outcome.stderr), "{lie}: {}", outcome.stderr);
        let last = outcome.stderr.lines().last().unwrap_or_default();
        assert!(last.contains(said), "the last line: {last}");
        let log = outcome.log();
        assert!(log.contains(said), "{log}");
        let report = outcome.report();
        assert_eq!((report.external.len(), report.external[0].scene_particles), (1, 224));
        assert!(report.warnings.iter().any(|warning| warning.contains(said)), "{:?}", report.warnings);
    }
    let honest = scene("spring-block").until(0.001).argument("--solid").argument(command()).run();
    let first = &honest.report.external[0];
    assert_eq!((first.particles, first.outer_particles, first.empty, first.misplaced), (224, 180, 0, 0));
    assert!((first.mass / first.scene_mass - 1.0).abs() < 1e-12, "{first:?}");
    assert!(!honest.outcome.stderr.contains("warning"), "{}", honest.outcome.stderr);
}

#[test]
fn a_block_started_by_hand_moves_as_one_that_the_run_starts() {
    let started = scene("spring-block").until(0.05).argument("--solid").argument(command()).run();
    let running = scene("spring-block").until(0.05).argument("--await-solid").start();
    let launcher = running.pid();
    let variables = running.dir().join("solid.env");
    eventually(30.0, "the variables of the solid", || variables.exists());
    // As the message on the terminal says.
    let line = format!(". '{}' && {}", variables.canonicalize().unwrap().display(), command());
    let by_hand = Command::new("sh").arg("-c").arg(&line).stderr(Stdio::piped()).spawn().unwrap();
    let run = running.wait().finished();
    let by_hand = by_hand.wait_with_output().unwrap();
    let warned = String::from_utf8_lossy(&by_hand.stderr);
    assert!(by_hand.status.success() && warned.is_empty(), "it ends without a word: {warned}");
    assert_eq!(run.probes, started.probes, "who starts it makes no difference, to the last bit");
    assert_eq!(run.state_hash(), started.state_hash());
    let said = &run.outcome.stderr;
    let told = line.split(" && ").next().unwrap();
    assert!(said.contains("waiting up to 60 s for the solid;") && said.contains(told), "{said}");
    assert!(said.contains("the solid is connected"), "{said}");
    assert!(!variables.exists(), "they belong to a run that is over");
    assert_eq!(leftovers(launcher), Vec::<String>::new());
}

/// The launcher of such a solid is not its parent: it notices by the wake-up call that is missing.
#[test]
fn a_block_started_by_hand_ends_with_a_killed_run() {
    let running = scene("spring-block").argument("--await-solid").start();
    let launcher = running.pid();
    let variables = running.dir().join("solid.env");
    eventually(30.0, "the variables of the solid", || variables.exists());
    let line = format!(". '{}' && exec {}", variables.canonicalize().unwrap().display(), command());
    let by_hand = Command::new("sh").arg("-c").arg(&line).stderr(Stdio::piped()).spawn().unwrap();
    let rows = running.dir().join("probes.csv");
    eventually(30.0, "steps", || std::fs::read_to_string(&rows).is_ok_and(|text| text.lines().count() > 5));
    kill(launcher, libc::SIGKILL);
    running.wait();
    let began = Instant::now();
    let ended = by_hand.wait_with_output().unwrap();
    // A question a second; the limit only tells it from the patience of 600 s.
    assert!(began.elapsed() < Duration::from_secs(20), "{:?}", began.elapsed());
    let said = String::from_utf8_lossy(&ended.stderr);
    assert!(!ended.status.success() && said.contains("another process of the run has ended"), "{said}");
    eventually(20.0, "the removal of the run's objects", || leftovers(launcher).is_empty());
}

#[test]
fn a_solid_that_nobody_starts_is_missed_by_name() {
    let outcome =
        scene("spring-block").argument("--await-solid").argument("--solid-wait").argument("0.5").outcome();
    assert_eq!(outcome.code(), Some(2));
    let error = outcome.report().error.unwrap();
    assert_eq!(error, "nobody started a solid within 0.5 s (--solid-wait): solid");
    assert!(outcome.stderr.contains(&error), "{}", outcome.stderr);
}

#[test]
fn waiting_for_a_solid_can_be_stopped() {
    let running = scene("spring-block").argument("--await-solid").start();
    eventually(30.0, "the variables of the solid", || running.dir().join("solid.env").exists());
    kill(running.pid(), libc::SIGINT);
    let outcome = running.wait();
    assert_eq!(outcome.code(), Some(130), "{}", outcome.stderr);
    assert_eq!(outcome.report().error, None);
}
