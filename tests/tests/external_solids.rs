//! Several solids of other programs in one run: who is who, who is killed, and who is silent.

use halfstep_tests::conformance::link::eventually;
use halfstep_tests::process::{is_alive, kill, leftovers};
use halfstep_tests::python::python;
use halfstep_tests::run::{RunBuilder, program, repository, scene_at};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const STIFFNESS: f64 = 2e4;

/// Water between two blocks on springs, which are each a solid of their own.
const SCENE: &str = r#"
resolution = 0.01
end_time = 0.15

[fluid]
density = 1000.0

[[solid]]
name = "left"
density = 8000.0
youngs_modulus = 1e7
poissons_ratio = 0.3

[[solid]]
name = "right"
density = 8000.0
youngs_modulus = 1e7
poissons_ratio = 0.3

[[shape]]
name = "water"
phase = "fluid"
box = { min = [0.0, 0.0], max = [0.2, 0.1] }
pressure = "hydrostatic"

[[shape]]
name = "left"
phase = "solid"
solid = "left"
box = { min = [-0.04, 0.0], max = [0.0, 0.14] }

[[shape]]
name = "right"
phase = "solid"
solid = "right"
box = { min = [0.2, 0.0], max = [0.24, 0.14] }

[[shape]]
name = "floor"
phase = "wall"
box = { min = [-0.2, -0.04], max = [0.4, 0.0] }

[[probe]]
name = "left"
kind = "displacement"
at = [-0.02, 0.07]

[[probe]]
name = "right"
kind = "displacement"
at = [0.22, 0.07]

[[metric]]
name = "way"
probe = "right.x"
kind = "value"
at = 0.05
"#;

struct Scene {
    folder: tempfile::TempDir,
    path: PathBuf,
}

impl Scene {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("blocks.toml");
        std::fs::write(&path, SCENE).expect("a scene");
        Self { folder, path }
    }

    fn pid_file(&self, name: &str) -> PathBuf {
        self.folder.path().join(format!("{name}.pid"))
    }

    /// The line of a block whose process number is then in its file.
    fn telling_its_pid(&self, name: &str) -> String {
        let line = block(name, STIFFNESS, "");
        let (_, command) = line.split_once('=').expect("NAME=COMMAND");
        format!("{name}=echo $$ > {}; exec {command}", self.pid_file(name).display())
    }

    /// With these lines for solids, NAME=COMMAND.
    fn run(&self, solids: &[String]) -> RunBuilder {
        solids.iter().fold(scene_at(&self.path), |run, line| run.argument("--solid").argument(line))
    }
}

fn script() -> PathBuf {
    repository().join("tests/python/own_spring.py")
}

fn block(name: &str, stiffness: f64, more: &str) -> String {
    format!("{name}={} {} {stiffness} {more}", python().display(), script().display())
}

fn both(stiffness: [f64; 2]) -> [String; 2] {
    [block("left", stiffness[0], ""), block("right", stiffness[1], "")]
}

/// The scene is its own mirror image, and so is what happens, but for the order of sums; a spring twice as stiff on one
/// side holds its block nearer.
#[test]
fn two_programs_are_pushed_apart_evenly() {
    let scene = Scene::new();
    let run = scene.run(&both([STIFFNESS; 2])).run();
    let [left, right] = ["left.x", "right.x"].map(|name| run.curve(name));
    let most = right.peak().1;
    let off = left.values.iter().zip(&right.values).map(|(a, b)| (a + b).abs()).fold(0.0, f64::max);
    println!("right by {most:e} m, left and right together off by {off:e} m");
    assert!(most > 1e-3 && off < 0.02 * most, "{most} {off}");
    let commands: Vec<_> = run.report.participants.iter().map(|own| own.command.clone()).collect();
    let is_ours = |command: &Option<String>| command.as_ref().is_some_and(|c| c.contains("own_spring.py"));
    assert!(commands[0].is_none() && commands[1..].iter().all(is_ours), "{commands:?}");
    // The scene's model is not what was computed.
    let models: Vec<_> = run.report.participants.iter().map(|own| own.model.clone()).collect();
    assert!(models[0].is_some() && models[1..].iter().all(Option::is_none), "{models:?}");
    // Whoever comes first on the command line.
    let [a, b] = both([STIFFNESS; 2]);
    assert_eq!(
        scene.run(&[b, a]).until(0.05).run().probes,
        scene.run(&both([STIFFNESS; 2])).until(0.05).run().probes
    );
    // A quarter of the period is before the sides differ much: sqrt(m / k) = 47 ms and 33 ms.
    let uneven = scene.run(&both([STIFFNESS, 2.0 * STIFFNESS])).run();
    let farthest = |name: &str| uneven.curve(name).values.into_iter().map(f64::abs).fold(0.0, f64::max);
    let [left, right] = ["left.x", "right.x"].map(farthest);
    println!("uneven: {left:e} and {right:e} m");
    assert!(left > 1.3 * right, "{left} {right}");
}

/// One is started by the run and the other one by hand: the same bits.
#[test]
fn one_of_two_is_started_by_hand() {
    let scene = Scene::new();
    let [left, right] = both([STIFFNESS; 2]);
    let started = scene.run(&[left.clone(), right.clone()]).until(0.02).run();
    let running = scene.run(&[left]).until(0.02).argument("--await-solid=right").start();
    let variables = running.dir().join("solid-right.env");
    eventually(30.0, "the variables of the solid", || variables.exists());
    let line = right.split_once('=').expect("NAME=COMMAND").1;
    let line = format!(". '{}' && {line}", variables.canonicalize().expect("a path").display());
    let by_hand = Command::new("sh").arg("-c").arg(&line).stderr(Stdio::piped()).spawn().expect("a shell");
    let run = running.wait().finished();
    assert!(by_hand.wait_with_output().expect("its end").status.success());
    assert_eq!(run.probes, started.probes);
    assert_eq!(run.state_hash(), started.state_hash());
}

/// The one that is killed is named, and the other one ends, too.
#[test]
fn a_killed_program_is_named_and_takes_the_other_along() {
    let scene = Scene::new();
    for victim in ["left", "right"] {
        let lines = ["left", "right"].map(|name| scene.telling_its_pid(name));
        let running = scene.run(&lines).set("end_time", 100.0).start();
        let launcher = running.pid();
        let rows = running.dir().join("probes.csv");
        eventually(60.0, "rows", || {
            std::fs::read_to_string(&rows).is_ok_and(|text| text.lines().count() > 2)
        });
        let [left, right] = ["left", "right"].map(|name| read_pid(&scene.pid_file(name)));
        kill(if victim == "left" { left } else { right }, libc::SIGKILL);
        let moment = Instant::now();
        let outcome = running.wait();
        let seconds = moment.elapsed().as_secs_f64();
        println!("{victim}: {seconds:.2} s; {}", outcome.stderr);
        assert_eq!(outcome.code(), Some(2));
        let error = outcome.report().error.expect("an error");
        assert!(error.contains(&format!("the {victim} process ended (signal: 9")), "{error}");
        assert!(![left, right].into_iter().any(is_alive), "the other one outlives the run");
        assert_eq!(leftovers(launcher), Vec::<String>::new());
    }
}

fn read_pid(path: &Path) -> u32 {
    std::fs::read_to_string(path).expect("a number").trim().parse().expect("a number")
}

/// One that is slow at each state and one that is stopped: the run waits for both within its patience, names the one
/// that it has waited for 5 s, goes on when that one does, and ends with the bits of a run in which nobody was late.
#[test]
fn slow_and_stopped_programs_are_waited_for() {
    let scene = Scene::new();
    let until = || scene.run(&both([STIFFNESS; 2])).until(0.05);
    let prompt = until().start().wait().finished();
    let lines = [block("left", STIFFNESS, "0 0.002"), scene.telling_its_pid("right")];
    let mut running = scene.run(&lines).until(0.05).start();
    let launcher = running.pid();
    let rows = running.dir().join("probes.csv");
    let count = || std::fs::read_to_string(&rows).map_or(0, |text| text.lines().count());
    eventually(60.0, "rows", || count() > 2);
    let right = read_pid(&scene.pid_file("right"));
    kill(right, libc::SIGSTOP);
    std::thread::sleep(Duration::from_millis(300));
    let before = count();
    // Silence is told after 5 s.
    std::thread::sleep(Duration::from_millis(5200));
    assert!(running.is_alive() && count() == before, "{before} rows, then {}", count());
    kill(right, libc::SIGCONT);
    let late = running.wait().finished();
    assert!(late.report.steps > before as u64 && late.outcome.seconds > 5.5, "it was stopped within the run");
    for said in [&late.outcome.stderr, &late.outcome.log()] {
        assert!(said.contains("waiting for the right since 5 s"), "{said}");
        assert!(!said.contains("waiting for the left since"), "{said}");
    }
    assert_eq!(late.state_hash(), prompt.state_hash());
    assert_eq!(late.probes, prompt.probes);
    assert_eq!(leftovers(launcher), Vec::<String>::new());
}

/// Alive and without a word: after the patience it is named.
#[test]
fn a_silent_program_is_named() {
    let scene = Scene::new();
    for silent in ["left", "right"] {
        let line = |name: &str| block(name, STIFFNESS, if name == silent { "5" } else { "" });
        let run = scene.run(&[line("left"), line("right")]).argument("--patience").argument("1");
        let running = run.start();
        let launcher = running.pid();
        let outcome = running.wait();
        println!("{silent}: {}", outcome.stderr);
        assert_eq!(outcome.code(), Some(2));
        let error = outcome.report().error.expect("an error");
        assert!(error.contains(&format!("no message of the {silent} for 1 s")), "{error}");
        assert_eq!(leftovers(launcher), Vec::<String>::new());
    }
}

/// A sweep over the water's density: what is twice as heavy pushes the blocks twice as far.
#[test]
fn a_sweep_takes_programs() {
    let scene = Scene::new();
    let out = scene.folder.path().join("sweep");
    let mut command = Command::new(program());
    command.arg("study").arg(&scene.path).args([
        "--sweep",
        "fluid.density=500,1000",
        "--quiet",
        "--until",
        "0.06",
    ]);
    for line in both([STIFFNESS; 2]) {
        command.arg("--solid").arg(line);
    }
    let done = command.arg("--out").arg(&out).args(["--json"]).output().expect("it starts");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let table = std::fs::read_to_string(out.join("sweep.csv")).expect("a table");
    let way = |k: usize| -> f64 {
        table
            .lines()
            .nth(k)
            .and_then(|row| row.split(',').nth(1))
            .and_then(|x| x.parse().ok())
            .expect("a number")
    };
    println!("{table}");
    assert!((way(2) / way(1) - 2.0).abs() < 0.2, "{table}");
}
