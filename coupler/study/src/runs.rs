//! The runs of a study: each in its own folder, started as `halfstep run`, and kept for the next time.
//!
//! A run counts as done when its `run.json` says so and its `done.json` was written by this very program. The latter is
//! removed before a run starts and written after it ended, so whatever stops a study, no other run's result is taken
//! for this one's.

use super::error::StudyError;
use super::ladder::{Setting, content, strip};
use super::program::{Program, own_path};
use halfstep_coupling::supervise::StopFlags;
use halfstep_output::run_dir::RunDirectory;
use halfstep_output::run_json::RunStatus;
use halfstep_output::{OutputError, RunReport, atomic};
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

const DONE: &str = "done.json";
/// What a run of a study prints; its folder has it, whoever runs something there later.
pub(super) const MESSAGES: &str = "messages.txt";
/// Pause between two looks at the runs.
const TICK: Duration = Duration::from_millis(50);
/// How long a run that was asked to stop is waited for, until it is asked again and until it is killed.
const PATIENCE: Duration = Duration::from_secs(10);

/// One run to make.
#[derive(Clone, Debug)]
pub struct Job {
    /// Name of the run in the progress display.
    pub label: String,
    /// Folder of the run.
    pub dir: PathBuf,
    /// The scene's file.
    pub scene: PathBuf,
    /// Overrides, `KEY=VALUE`.
    pub overrides: Vec<String>,
    /// Further arguments of `halfstep run`.
    pub more: Vec<String>,
    /// Of a scene without water with a solid of another program: `halfstep fake-fluid` runs it, without a load.
    pub alone: bool,
    /// End time, s.
    pub end_time: f64,
    /// Expected cost, in any unit.
    pub cost: f64,
}

impl Job {
    /// The run of a setting with solids by these commands, repeated for the time of that number.
    pub fn new(folder: &Path, setting: &Setting, repeat: u32, solids: &[String]) -> Self {
        let scene = &setting.scene;
        let particles = halfstep_scene::geometry::estimate(scene).total() as f64;
        Self {
            label: setting.label(),
            dir: folder.join("runs").join(format!("{}-{repeat}", setting.slug())),
            scene: scene.path.clone(),
            overrides: setting.overrides.clone(),
            more: solids.iter().flat_map(|command| ["--solid".into(), command.clone()]).collect(),
            alone: false,
            end_time: scene.end_time,
            // Steps go with end over spacing.
            cost: particles * scene.end_time / (scene.resolution * scene.numerics.cfl),
        }
    }

    fn command(&self) -> std::io::Result<Command> {
        let mut command = Command::new(own_path()?);
        command
            .arg(if self.alone { "fake-fluid" } else { "run" })
            .arg(&self.scene)
            .arg("--out")
            .arg(&self.dir);
        // What is in the folder was made here.
        command.args(if self.alone { &["--replace"][..] } else { &["--quiet", "--force"] });
        command.arg("--by-study");
        command.args(self.overrides.iter().flat_map(|o| ["--set", o]));
        command.args(&self.more);
        let said = File::create(self.dir.join(MESSAGES))?;
        command.stdin(Stdio::null()).stdout(said.try_clone()?).stderr(said);
        // Ctrl-C is for the study, which then asks its runs to stop; without the study they stop, too.
        command.process_group(0);
        let study = std::process::id();
        // SAFETY: between fork and exec; calls without pointers, safe after a fork.
        unsafe {
            command.pre_exec(move || {
                if libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGTERM) != 0 {
                    return Err(std::io::Error::last_os_error());
                }
                // The study may have ended before that call.
                if libc::getppid() as u32 != study {
                    libc::_exit(1);
                }
                Ok(())
            });
        }
        Ok(command)
    }

    /// Refuses a folder in which a run goes on, and one with a run that no study made, or that somebody made or resumed
    /// in the place of a study's. Nobody else has one that is there while the result lives.
    fn check_folder(&self) -> Result<Option<RunDirectory>, StudyError> {
        if !self.dir.is_dir() {
            return Ok(None);
        }
        if self.dir.join(MESSAGES).is_file() {
            let own = RunDirectory::reopen(&self.dir)?;
            let report = self.dir.join("run.json");
            return match RunReport::read(&report) {
                // A study that was killed leaves none; a run of somebody else writes one at its start.
                Err(_) if !report.exists() => Ok(Some(own)),
                Ok(RunReport { by_study: Some(true) | None, .. }) => Ok(Some(own)),
                _ => Err(self.refused("run.json")),
            };
        }
        match RunDirectory::create(&self.dir, false) {
            Err(OutputError::Occupied { found, .. }) => Err(self.refused(&found)),
            other => other.map(Some).map_err(StudyError::from),
        }
    }

    fn refused(&self, found: &str) -> StudyError {
        StudyError::Usage(format!(
            "{} holds a run that was not made here ({found}), which would be replaced: give another --out",
            self.dir.display()
        ))
    }

    fn start(&self) -> Result<Child, StudyError> {
        let what = self.dir.display().to_string();
        let own = self.check_folder()?;
        std::fs::create_dir_all(&self.dir).map_err(StudyError::system(&what))?;
        // A run that is refused before it begins leaves no report; the one before is not taken for its own.
        for stale in [DONE, "run.json", "probes.csv"] {
            match std::fs::remove_file(self.dir.join(stale)) {
                Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                    return Err(StudyError::system(&what)(e));
                }
                _ => (),
            }
        }
        drop(own);
        self.command().and_then(|mut command| command.spawn()).map_err(StudyError::system(&what))
    }

    /// Part of the way that the run has gone: from the last time in its `probes.csv`.
    fn progress(&self) -> f64 {
        let last = || -> Option<f64> {
            let mut file = File::open(self.dir.join("probes.csv")).ok()?;
            let length = file.metadata().ok()?.len();
            file.seek(SeekFrom::Start(length.saturating_sub(4096))).ok()?;
            let mut tail = String::new();
            file.read_to_string(&mut tail).ok()?;
            let (whole, _) = tail.rsplit_once('\n')?;
            whole.rsplit('\n').next()?.split(',').next()?.parse().ok()
        };
        last().map_or(0.0, |time| (time / self.end_time).clamp(0.0, 1.0))
    }
}

/// The report of an earlier run of this setting by this program, where it is one that need not be repeated.
pub fn reusable(dir: &Path, setting: &Setting, program: &Program) -> Option<RunReport> {
    let done: Program = serde_json::from_slice(&std::fs::read(dir.join(DONE)).ok()?).ok()?;
    let report = RunReport::read(&dir.join("run.json")).ok()?;
    matches(&done, &report, setting, program).then_some(report)
}

fn matches(done: &Program, report: &RunReport, setting: &Setting, program: &Program) -> bool {
    let mut scene = report.scene.clone();
    strip(&mut scene);
    let over = matches!(report.status, Some(RunStatus::Finished | RunStatus::Diverged));
    over && report.by_study == Some(true)
        && done == program
        && content(&setting.scene).is_some_and(|own| own == scene)
}

/// Makes runs, so many at a time; returns whether all were made, or somebody stopped it.
///
/// # Errors
/// A run could not be started.
pub fn execute(
    jobs: &[Job],
    at_a_time: usize,
    quiet: bool,
    program: &Program,
    stop: &StopFlags,
) -> Result<bool, StudyError> {
    jobs.iter().try_for_each(|job| job.check_folder().map(drop))?;
    let bar = ProgressBar::new(1000);
    let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    if quiet {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    let started = Instant::now();
    let mut running: Vec<(usize, Child)> = Vec::new();
    let (mut next, mut done) = (0, 0.0);
    let total: f64 = jobs.iter().map(|job| job.cost).sum();
    while next < jobs.len() || !running.is_empty() {
        while next < jobs.len() && running.len() < at_a_time && !stop.stop.load(Ordering::Relaxed) {
            running.push((next, jobs[next].start()?));
            next += 1;
        }
        if stop.stop.load(Ordering::Relaxed) {
            end(&mut running, &stop.at_once);
            bar.finish_and_clear();
            return Ok(false);
        }
        let mut index = 0;
        while index < running.len() {
            let (job, child) = &mut running[index];
            if child.try_wait().map_err(StudyError::system("a run"))?.is_some() {
                let job = &jobs[*job];
                let text = serde_json::to_vec(program).map_err(|e| StudyError::System(e.to_string()))?;
                atomic::replace_bytes(&job.dir.join(DONE), &text)?;
                done += job.cost;
                running.remove(index);
            } else {
                index += 1;
            }
        }
        let under_way: f64 = running.iter().map(|(k, _)| jobs[*k].cost * jobs[*k].progress()).sum();
        let part = (done + under_way) / total;
        let names: Vec<&str> = running.iter().map(|(k, _)| jobs[*k].label.as_str()).collect();
        bar.set_position((1000.0 * part) as u64);
        let left = remaining(started.elapsed(), part);
        bar.set_message(format!("run {next} of {}: {}  ETA {}", jobs.len(), names.join(", "), left));
        std::thread::sleep(TICK);
    }
    bar.finish_and_clear();
    Ok(true)
}

fn remaining(elapsed: Duration, part: f64) -> String {
    if part < 1e-3 {
        return "unknown".into();
    }
    HumanDuration(elapsed.mul_f64((1.0 / part - 1.0).max(0.0))).to_string()
}

/// Asks the runs to stop after their step under way, and waits for that; then, or at the second Ctrl-C, asks them to
/// stop at once, and kills those that do neither.
fn end(running: &mut Vec<(usize, Child)>, at_once: &AtomicBool) {
    signal(running, libc::SIGTERM);
    if wait(running, || at_once.load(Ordering::Relaxed)) {
        return;
    }
    signal(running, libc::SIGTERM);
    if !wait(running, || false) {
        signal(running, libc::SIGKILL);
        wait(running, || false);
    }
}

fn signal(running: &[(usize, Child)], signal: i32) {
    for (_, child) in running {
        // SAFETY: no memory is passed; the child has not been waited for, so its number is its own.
        unsafe { libc::kill(child.id() as libc::pid_t, signal) };
    }
}

/// Waits until all have ended; returns whether they have before it was `enough` or has taken too long.
fn wait(running: &mut Vec<(usize, Child)>, enough: impl Fn() -> bool) -> bool {
    let since = Instant::now();
    loop {
        // Two signals at once may arrive as one.
        std::thread::sleep(TICK);
        // A child that cannot be waited for is gone.
        running.retain_mut(|(_, child)| matches!(child.try_wait(), Ok(None)));
        if running.is_empty() || enough() || since.elapsed() > PATIENCE {
            return running.is_empty();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_same_run_by_the_same_program_is_reused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("pool.toml");
        let text = "resolution = 0.1\nend_time = 1.0\n[fluid]\ndensity = 1000.0\n[[shape]]\nname = \"water\"\n\
            phase = \"fluid\"\nbox = { min = [0.0, 0.0], max = [2.0, 1.0] }\n[[probe]]\nname = \"front\"\nkind = \"front\"\n";
        std::fs::write(&path, text).unwrap();
        let load = |set: &[&str]| {
            let set: Vec<String> = set.iter().map(|s| s.to_string()).collect();
            Setting::load(&path, &[], &set).unwrap()
        };
        let own = load(&[]);
        let isa = "avx2".to_string();
        let program = Program { version: "1".into(), build: "a".into(), isa, solids: Vec::new() };
        let mut report = RunReport {
            status: Some(RunStatus::Finished),
            by_study: Some(true),
            scene: serde_json::to_value(&own.scene).unwrap(),
            ..RunReport::default()
        };
        assert!(matches(&program, &report, &own, &program));
        let by_hand = RunReport { by_study: Some(false), ..report.clone() };
        assert!(!matches(&program, &by_hand, &own, &program));
        assert!(!matches(&Program { build: "b".into(), ..program.clone() }, &report, &own, &program));
        assert!(!matches(&Program { version: "2".into(), ..program.clone() }, &report, &own, &program));
        assert!(!matches(&Program { isa: "baseline".into(), ..program.clone() }, &report, &own, &program));
        assert!(!matches(&program, &report, &load(&["fluid.density=900"]), &program));
        // A program that computes a solid is another one when its file changes.
        let script = dir.path().join("the plate.py");
        let with_script = |text: &str| {
            std::fs::write(&script, text).unwrap();
            program.clone().with_solids(&[format!("plate=python3 '{}'", script.display())]).0
        };
        let before = with_script("E = 1");
        assert!(matches(&before, &report, &own, &before));
        assert!(!matches(&program, &report, &own, &before));
        assert!(!matches(&before, &report, &own, &with_script("E = 2")));
        // What is not there to be looked at may have changed.
        std::fs::remove_file(&script).unwrap();
        let commands = [format!("plate=python3 '{}'", script.display())];
        let [(one, why), (other, _)] = [0, 1].map(|_| program.clone().with_solids(&commands));
        assert!(matches(&one, &report, &own, &one) && !matches(&one, &report, &own, &other));
        assert!(why[0].contains("the plate.py`"), "{why:?}");
        // A metric changes what is made of a run, not the run.
        let metric = "[[metric]]\nname = \"reach\"\nprobe = \"front.x\"\nkind = \"peak\"\n";
        std::fs::write(&path, format!("{text}{metric}")).unwrap();
        assert!(matches(&program, &report, &load(&[]), &program));
        for status in [None, Some(RunStatus::Stopped), Some(RunStatus::Failed)] {
            report.status = status;
            assert!(!matches(&program, &report, &own, &program), "{status:?}");
        }
        report.status = Some(RunStatus::Diverged);
        assert!(matches(&program, &report, &own, &program));
    }

    #[test]
    fn runs_of_others_are_refused_and_kept() {
        let dir = tempfile::tempdir().unwrap();
        let own = dir.path().join("runs/hypoelastic");
        let job = Job {
            label: "hypoelastic".into(),
            dir: own.clone(),
            scene: dir.path().join("pool.toml"),
            overrides: Vec::new(),
            more: Vec::new(),
            alone: false,
            end_time: 1.0,
            cost: 1.0,
        };
        job.check_folder().unwrap();
        assert!(!own.exists());
        std::fs::create_dir_all(&own).unwrap();
        std::fs::write(own.join("run.json"), "{}").unwrap();
        let refused = job.check_folder().unwrap_err().to_string();
        assert!(refused.contains("a run that was not made here (run.json)"), "{refused}");
        std::fs::write(own.join(MESSAGES), "").unwrap();
        job.check_folder().expect("of a program that did not say yet whose a run is");
        std::fs::write(own.join("run.json"), "{\"by_study\": false}").unwrap();
        let refused = job.check_folder().unwrap_err().to_string();
        assert!(refused.contains("a run that was not made here (run.json)"), "in its place: {refused}");
        std::fs::write(own.join("run.json"), "{\"by_study\": true}").unwrap();
        job.check_folder().unwrap();
        std::fs::remove_file(own.join("run.json")).unwrap();
        job.check_folder().unwrap();
        let _under_way = RunDirectory::reopen(&own).unwrap();
        let refused = job.check_folder().unwrap_err().to_string();
        assert!(refused.starts_with("a run goes on in "), "{refused}");
    }

    #[test]
    fn a_run_that_does_not_stop_is_asked_again() {
        let deaf = "trap 'echo asked >> said; test $(wc -l < said) = 2 && exit' TERM; echo > ready; \
                    while :; do sleep 0.01; done";
        let dir = tempfile::tempdir().unwrap();
        let mut command = Command::new("sh");
        let child = command.args(["-c", deaf]).current_dir(dir.path()).spawn().unwrap();
        while !dir.path().join("ready").exists() {
            std::thread::sleep(Duration::from_millis(5));
        }
        let started = Instant::now();
        end(&mut vec![(0, child)], &AtomicBool::new(true));
        let asked = std::fs::read_to_string(dir.path().join("said")).unwrap();
        assert_eq!(asked.lines().count(), 2);
        assert!(started.elapsed() < PATIENCE);
    }

    #[test]
    fn the_time_left_follows_the_part_done() {
        assert_eq!(remaining(Duration::from_secs(30), 0.25), "2 minutes");
        assert_eq!(remaining(Duration::from_secs(30), 0.0), "unknown");
        assert_eq!(remaining(Duration::from_secs(30), 1.0), "0 seconds");
    }
}
