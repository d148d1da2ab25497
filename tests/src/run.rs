//! Runs a shipped scene with the real program, as a user would, and reads what it leaves behind.
//!
//! Runs share the machine: processes in lock-step wait for each other, and leave half of two cores idle. A test that
//! holds a run to seconds keeps off those that others wait for ([`RunBuilder::outcome`]).

use crate::curve::Curve;
use crate::process::kill;
use halfstep_output::checkpoint::{FOLDERS, Manifest};
use halfstep_output::run_json::RunStatus;
use halfstep_output::{Frame, RunReport, Table, read_probes, series::Series, vtkhdf};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{OnceLock, PoisonError, RwLock, RwLockWriteGuard};
use std::time::{Duration, Instant};

/// Who has the machine: tests of seconds write, other runs read.
static MACHINE: RwLock<()> = RwLock::new(());

/// The program: `coupler/cli/src/main.rs`, which this package builds as well, so that it is up to date when a test
/// runs.
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        // target/PROFILE/deps/TEST-HASH: binaries lie one folder above, and some of them come here as well.
        let test = std::env::current_exe().expect("a test has a path");
        let folders = test.ancestors().skip(1).take(2);
        let mut programs = folders.map(|folder| folder.join("halfstep-under-test"));
        programs.find(|program| program.exists()).expect("halfstep-under-test: cargo test builds it")
    })
}

/// Probes and frames of a run, by their names.
///
/// # Errors
/// One of them cannot be read.
pub fn files(dir: &Path) -> std::io::Result<BTreeMap<String, Vec<u8>>> {
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let frames = std::fs::read_dir(dir.join("frames"))?.map(|entry| Ok(entry?.path()));
    let all = frames.chain([Ok(dir.join("probes.csv"))]);
    all.map(|path: std::io::Result<PathBuf>| path.and_then(|path| Ok((name(&path), std::fs::read(&path)?))))
        .collect()
}

/// The repository's top folder.
pub fn repository() -> PathBuf {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    path.canonicalize().expect("the repository")
}

/// A run of `scenes/NAME.toml`, to be configured.
pub fn scene(name: &str) -> RunBuilder {
    scene_at(&repository().join("scenes").join(name).with_extension("toml"))
}

/// A run of any scene file.
pub fn scene_at(path: &Path) -> RunBuilder {
    let (arguments, variables) = (Vec::new(), Vec::new());
    RunBuilder { scene: path.into(), arguments, variables, out: None, resumes: false }
}

/// How to run a scene.
#[derive(Clone, Debug)]
pub struct RunBuilder {
    scene: PathBuf,
    arguments: Vec<OsString>,
    variables: Vec<(OsString, OsString)>,
    out: Option<PathBuf>,
    resumes: bool,
}

impl RunBuilder {
    /// Overrides a key of the scene.
    #[must_use]
    pub fn set(self, key: &str, value: impl Display) -> Self {
        self.argument("--set").argument(format!("{key}={value}"))
    }

    /// Simulated time, s.
    #[must_use]
    pub fn until(self, seconds: f64) -> Self {
        self.argument("--until").argument(seconds.to_string())
    }

    /// Worker threads of the fluid; 1 if it is not asked for.
    #[must_use]
    pub fn threads(self, count: usize) -> Self {
        self.argument("--threads").argument(count.to_string())
    }

    /// The roles as threads of one process instead of three processes.
    #[must_use]
    pub fn in_process(self) -> Self {
        self.argument("--in-process")
    }

    /// Any other argument of `halfstep run`.
    #[must_use]
    pub fn argument(mut self, argument: impl Into<OsString>) -> Self {
        self.arguments.push(argument.into());
        self
    }

    /// An environment variable of the program.
    #[must_use]
    pub fn variable(mut self, name: &str, value: impl Into<OsString>) -> Self {
        self.variables.push((name.into(), value.into()));
        self
    }

    /// The folder of the run; without it a temporary one that goes with the result.
    #[must_use]
    pub fn out(mut self, dir: &Path) -> Self {
        self.out = Some(dir.into());
        self
    }

    /// Goes on with an interrupted run in a folder instead of running a scene.
    #[must_use]
    pub fn resume(mut self, dir: &Path) -> Self {
        self.resumes = true;
        self.out(dir)
    }

    /// Starts the program and does not wait for it.
    pub fn start(self) -> Running {
        let temporary = tempfile::tempdir().expect("a temporary folder");
        let dir = self.out.unwrap_or_else(|| temporary.path().join("run"));
        let stream = |name: &str| {
            let path = temporary.path().join(name);
            Stdio::from(std::fs::File::create(path).expect("a file for what the program says"))
        };
        let mut command = Command::new(program());
        match self.resumes {
            true => command.arg("resume").arg(&dir).arg("--quiet"),
            false => command.arg("run").arg(&self.scene).arg("--quiet").arg("--out").arg(&dir),
        };
        command.args(&self.arguments).envs(self.variables);
        // As many others run beside it as there are cores, and its bits are the same with any number of threads.
        if !self.resumes && self.arguments.iter().all(|argument| argument != "--threads") {
            command.args(["--threads", "1"]);
        }
        command.stdin(Stdio::null()).stdout(stream("stdout")).stderr(stream("stderr"));
        let child = command.spawn().expect("halfstep starts");
        Running { child, dir, temporary: Some(temporary), started: Instant::now() }
    }

    /// Runs the program to its end, however that is.
    pub fn outcome(self) -> Outcome {
        let _shared = MACHINE.read().unwrap_or_else(PoisonError::into_inner);
        self.start().wait()
    }

    /// Runs the program, which must reach the scene's end.
    pub fn run(self) -> Finished {
        self.outcome().finished()
    }
}

/// Keeps runs that other tests wait for off the machine, for tests that hold a run to seconds; they
/// [`RunBuilder::start`] it.
pub fn whole_machine() -> RwLockWriteGuard<'static, ()> {
    MACHINE.write().unwrap_or_else(PoisonError::into_inner)
}

/// A run that goes on. Dropping it kills the launcher.
#[derive(Debug)]
pub struct Running {
    child: Child,
    dir: PathBuf,
    temporary: Option<tempfile::TempDir>,
    started: Instant,
}

impl Running {
    /// Process number of the launcher, which is the coupler.
    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    /// The folder of the run.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Whether the launcher still runs.
    pub fn is_alive(&mut self) -> bool {
        self.child.try_wait().expect("a child").is_none()
    }

    /// Kills the launcher once there is a checkpoint of this time, s, or later; returns the newest one's.
    pub fn killed_at(mut self, time: f64) -> f64 {
        let dir = self.dir.clone();
        let newest = || {
            let read = |folder: &&str| Manifest::read(&dir.join(folder)).ok().flatten();
            FOLDERS.iter().filter_map(read).map(|manifest| manifest.time).fold(0.0, f64::max)
        };
        while newest() < time {
            assert!(self.is_alive(), "ended before {time} s");
            std::thread::sleep(Duration::from_millis(1));
        }
        kill(self.pid(), libc::SIGKILL);
        self.wait();
        newest()
    }

    /// Waits for the launcher's end.
    pub fn wait(mut self) -> Outcome {
        let status = self.child.wait().expect("a child");
        let temporary = self.temporary.take().expect("taken here only");
        let said = |name: &str| {
            let text = std::fs::read(temporary.path().join(name)).unwrap_or_default();
            String::from_utf8_lossy(&text).into_owned()
        };
        Outcome {
            status,
            stdout: said("stdout"),
            stderr: said("stderr"),
            dir: self.dir.clone(),
            seconds: self.started.elapsed().as_secs_f64(),
            _temporary: temporary,
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if self.is_alive() {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}

/// How the program ended and where its files are.
#[derive(Debug)]
pub struct Outcome {
    /// How the launcher ended.
    pub status: ExitStatus,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
    /// The folder of the run.
    pub dir: PathBuf,
    /// Wall time, s.
    pub seconds: f64,
    _temporary: tempfile::TempDir,
}

impl Outcome {
    /// Exit status, `None` for a signal.
    pub fn code(&self) -> Option<i32> {
        self.status.code()
    }

    /// `run.json`.
    pub fn report(&self) -> RunReport {
        RunReport::read(&self.dir.join("run.json")).unwrap_or_else(|e| panic!("{e}\n{}", self.stderr))
    }

    /// `log.txt`.
    pub fn log(&self) -> String {
        std::fs::read_to_string(self.dir.join("log.txt")).unwrap_or_default()
    }

    /// `probes.csv`.
    pub fn probes(&self) -> Table {
        read_probes(&self.dir.join("probes.csv")).unwrap_or_else(|e| panic!("{e}\n{}", self.stderr))
    }

    /// All announced frames of `fluid` or `solid`, read from their files; each holds a particle.
    pub fn frames(&self, stem: &str) -> Vec<Frame> {
        let frames = self.frames_or_empty(stem);
        assert!(frames.iter().all(|frame| !frame.is_empty()), "{stem} of {}", self.dir.display());
        frames
    }

    /// The same where a phase may have left the domain.
    pub fn frames_or_empty(&self, stem: &str) -> Vec<Frame> {
        let announced = Series::of_run(&self.dir, stem).expect("the index of the frames");
        announced
            .into_iter()
            .map(|(path, time)| {
                let frame = vtkhdf::read(&path).unwrap_or_else(|e| panic!("{e}"));
                assert_eq!(frame.time, time, "{}", path.display());
                frame
            })
            .collect()
    }

    /// The run, which must have reached its end.
    pub fn finished(self) -> Finished {
        let told = || format!("{:?}\n{}\n{}", self.status, self.stderr, self.log());
        assert!(self.status.success(), "{}", told());
        let report = self.report();
        assert_eq!(report.status, Some(RunStatus::Finished), "{}", told());
        assert_eq!(report.error, None);
        Finished { report, probes: self.probes(), outcome: self }
    }
}

/// A run that reached its end.
#[derive(Debug)]
pub struct Finished {
    /// `run.json`.
    pub report: RunReport,
    /// `probes.csv`.
    pub probes: Table,
    /// Everything else.
    pub outcome: Outcome,
}

impl Finished {
    /// A column of the probes: `tip.x`.
    pub fn curve(&self, name: &str) -> Curve {
        Curve::of(&self.probes, name)
    }

    /// The hash of the final state, with the instruction set it belongs to.
    pub fn state_hash(&self) -> (String, Option<String>) {
        let hash = self.report.audit.state_hash.clone().expect("a finished run has a hash");
        (hash, self.report.audit.isa.clone())
    }

    /// The folder of the run.
    pub fn dir(&self) -> &Path {
        &self.outcome.dir
    }
}
