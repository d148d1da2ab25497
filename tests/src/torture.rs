//! Real runs, interrupted at any instant in any way: they end, what they announced is whole, nothing stays behind, and
//! they go on to the bits of a run that nobody disturbed.

use crate::process::{is_alive, leftovers, with_variable};
use crate::run::{RunBuilder, Running, files, repository, scene};
use fastrand::Rng;
use halfstep_output::checkpoint::{FOLDERS, MANIFEST};
use halfstep_output::run_json::RunStatus;
use halfstep_output::{RunReport, read_probes, series::Series, vtkhdf};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// Environment variable by which the processes of a run are found, also those that somebody else started.
const MARK: &str = "HALFSTEP_TORTURE";
/// How long a disturbed run may go on after its last disturbance, s. Undisturbed ones take less than 4 s, alone.
const HANG: f64 = 60.0;
/// How long what is left of a run has, before the next one removes it, s.
const TIDY: f64 = 2.0;
/// How long the other processes of a run may live on after the launcher, s.
const SURVIVAL: f64 = 10.0;

/// A kind of run.
struct Kind {
    name: &'static str,
    scene: &'static str,
    set: &'static [(&'static str, &'static str)],
    until: f64,
    /// The solid is a Python script.
    external: bool,
    /// The script is started by a shell that stays.
    in_shell: bool,
}

const KINDS: [Kind; 6] = [
    Kind {
        name: "gate",
        scene: "elastic-gate",
        set: &[
            ("resolution", "0.0025"),
            ("output.checkpoint_interval", "0.002"),
            ("output.frame_interval", "0.002"),
        ],
        until: 0.02,
        external: false,
        in_shell: false,
    },
    Kind {
        name: "plates, one process",
        scene: "two-plates",
        set: &[("output.checkpoint_interval", "0.005"), ("output.frame_interval", "0.005"), COARSE],
        until: 0.05,
        external: false,
        in_shell: false,
    },
    Kind {
        name: "plates, a process each",
        scene: "two-plates",
        set: &[
            ("output.checkpoint_interval", "0.005"),
            ("output.frame_interval", "0.005"),
            ("solid.stiff.process", "own"),
            COARSE,
        ],
        until: 0.05,
        external: false,
        in_shell: false,
    },
    Kind {
        name: "tank",
        scene: "hydrostatic-tank",
        set: &[("output.checkpoint_interval", "0.02"), ("output.frame_interval", "0.02")],
        until: 0.2,
        external: false,
        in_shell: false,
    },
    Kind {
        name: "block in Python",
        scene: "spring-block",
        set: &[("output.checkpoint_interval", "0.005"), ("output.frame_interval", "0.005")],
        until: 0.05,
        external: true,
        in_shell: false,
    },
    Kind {
        name: "block in a shell",
        scene: "spring-block",
        set: &[("output.checkpoint_interval", "0.005"), ("output.frame_interval", "0.005")],
        until: 0.05,
        external: true,
        in_shell: true,
    },
];

const COARSE: (&str, &str) = ("resolution", "0.004");

impl Kind {
    /// How it is run, or resumed in a folder.
    fn builder(&self, python: &str, dir: &Path, resumes: bool, mark: &str) -> RunBuilder {
        let base = scene(self.scene);
        let mut run = match resumes {
            true => base.resume(dir),
            false => {
                self.set.iter().fold(base, |run, (key, value)| run.set(key, value)).until(self.until).out(dir)
            }
        };
        if self.external {
            let script = repository().join("tests/python/spring_block.py");
            let line = format!("{python} {} 2e4", script.display());
            run = run.argument("--solid").argument(if self.in_shell {
                format!("{line}; exit $?")
            } else {
                line
            });
        }
        run.variable(MARK, mark)
    }
}

/// What came of it.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Disturbed runs.
    pub runs: usize,
    /// Of these, those that were disturbed before their end.
    pub disturbed: usize,
    /// Of these, those that went on from a checkpoint.
    pub resumed: usize,
    /// Everything that should not be, a line each.
    pub faults: Vec<String>,
}

/// A whole run of a kind: its state hash, how long it took, and its frames and rows.
struct Whole {
    hash: Option<String>,
    seconds: f64,
    files: BTreeMap<String, Vec<u8>>,
}

/// Disturbs so many runs of all kinds in turn, or fewer where the time is over and one of them did not end by itself.
/// `python` is the interpreter for the external solid; without it there is none.
pub fn torture(
    runs: usize,
    seed: u64,
    time: Duration,
    python: Option<&str>,
    mut told: impl FnMut(&str),
) -> Tally {
    let (mut random, mut tally) = (Rng::with_seed(seed), Tally::default());
    let started = Instant::now();
    let mut known: BTreeMap<usize, Whole> = BTreeMap::new();
    let kinds: Vec<usize> = (0..KINDS.len()).filter(|&k| python.is_some() || !KINDS[k].external).collect();
    let python = python.unwrap_or_default();
    for number in 0..runs {
        if started.elapsed() > time && tally.disturbed > 0 {
            break;
        }
        let index = kinds[number % kinds.len()];
        let kind = &KINDS[index];
        let whole = known.entry(index).or_insert_with(|| undisturbed(kind, python));
        let mut trial = Trial { kind, python, random: &mut random, what: String::new() };
        let _ = write!(trial.what, "run {number}, {}", kind.name);
        let result = trial.run(whole, &mut tally);
        tally.runs += 1;
        let line = match result {
            Ok(()) => format!("{}: good", trial.what),
            Err(fault) => format!("{}: {fault}", trial.what),
        };
        told(&line);
        if !line.ends_with(": good") {
            tally.faults.push(line);
        }
    }
    tally
}

fn undisturbed(kind: &Kind, python: &str) -> Whole {
    let folder = tempfile::tempdir().expect("a folder");
    let run = kind.builder(python, &folder.path().join("run"), false, "whole").start().wait().finished();
    Whole {
        hash: run.report.audit.state_hash.clone(),
        seconds: run.outcome.seconds,
        files: files(run.dir()).expect("files of a whole run"),
    }
}

/// A run on its way through disturbances.
struct Trial<'a> {
    kind: &'a Kind,
    python: &'a str,
    random: &'a mut Rng,
    what: String,
}

impl Trial<'_> {
    fn run(&mut self, whole: &Whole, tally: &mut Tally) -> Result<(), String> {
        let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
        let dir = folder.path().join("run");
        let mut resumes = false;
        for round in 0..8 {
            let mark = format!("{}-{}", std::process::id(), self.random.u64(..));
            let running = self.kind.builder(self.python, &dir, resumes, &mark).start();
            // The last round is left alone.
            let code = if round < 2 + self.random.usize(..2) {
                self.disturb(running, whole.seconds, &mark)?
            } else {
                running.wait().code()
            };
            let report = RunReport::read(&dir.join("run.json")).ok();
            if dir.join("run.json").exists() && report.is_none() {
                return Err("run.json is torn".into());
            }
            whole_files(&dir)?;
            match report.and_then(|report| Some((report.status?, report.audit.state_hash))) {
                Some((RunStatus::Finished, hash)) => {
                    if hash != whole.hash {
                        return Err(format!("the state hash is {hash:?} and not {:?}", whole.hash));
                    }
                    let changed: Vec<String> =
                        differences(&files(&dir).map_err(|e| e.to_string())?, &whole.files);
                    if !changed.is_empty() {
                        return Err(format!("other files than those of a whole run: {}", changed.join(", ")));
                    }
                    tally.disturbed += usize::from(round > 0);
                    tally.resumed += usize::from(resumes);
                    return Ok(());
                }
                // Of one that was killed it may be the report of the round before.
                // A resumed run that did not go on, with status 1, has the report of the round before, too.
                Some((RunStatus::Stopped, _))
                    if code.is_some_and(|code| code != 130 && (code != 1 || !resumes)) =>
                {
                    return Err(format!("stopped with exit status {code:?}"));
                }
                Some((RunStatus::Diverged, _)) => return Err("diverged".into()),
                _ => {}
            }
            resumes = FOLDERS.iter().any(|folder| dir.join(folder).join(MANIFEST).exists());
            if !resumes && dir.exists() {
                std::fs::remove_dir_all(&dir).map_err(|e| e.to_string())?;
            }
        }
        Err("it does not come to its end".into())
    }

    /// Sends a signal to a process at an instant, waits for the end of all; returns the launcher's exit status.
    fn disturb(&mut self, mut running: Running, seconds: f64, mark: &str) -> Result<Option<i32>, String> {
        const SIGNALS: [(&str, i32); 5] = [
            ("KILL", libc::SIGKILL),
            ("STOP", libc::SIGSTOP),
            ("TERM", libc::SIGTERM),
            ("INT", libc::SIGINT),
            ("HUP", libc::SIGHUP),
        ];
        let launcher = running.pid();
        std::thread::sleep(Duration::from_secs_f64(seconds * self.random.f64()));
        let all = with_variable(MARK, mark);
        if all.is_empty() {
            return Ok(running.wait().code());
        }
        // The launcher as often as all others together; now and then all at once.
        let (name, signal) = SIGNALS[self.random.usize(..SIGNALS.len())];
        let victims: Vec<u32> = match self.random.usize(..5) {
            0 => all.clone(),
            1 | 2 => vec![launcher],
            _ => vec![all[self.random.usize(..all.len())]],
        };
        let who = match victims.as_slice() {
            [one] if *one == launcher => "the launcher".to_owned(),
            [one] => command_of(*one),
            _ => "all".into(),
        };
        let _ = write!(self.what, "; {name} to {who}");
        let send = |pids: &[u32], signal: i32| {
            for pid in pids {
                // SAFETY: no memory is passed; a process that has ended is no matter.
                unsafe { libc::kill(*pid as i32, signal) };
            }
        };
        send(&victims, signal);
        if signal == libc::SIGSTOP {
            std::thread::sleep(Duration::from_secs_f64(0.5 * self.random.f64()));
            if victims.len() == 1 && victims[0] != launcher && self.random.usize(..2) == 0 {
                // Nobody wakes it: the run is told to end.
                send(&[launcher], libc::SIGINT);
                self.what += " for good";
            } else {
                send(&victims, libc::SIGCONT);
            }
        }
        let moment = Instant::now();
        while running.is_alive() {
            if moment.elapsed().as_secs_f64() > HANG {
                send(&with_variable(MARK, mark), libc::SIGKILL);
                return Err(format!("it hangs; {}", running.wait().stderr));
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        let outcome = running.wait();
        let ended = Instant::now();
        let left = || with_variable(MARK, mark).into_iter().filter(|pid| is_alive(*pid)).collect::<Vec<_>>();
        while !left().is_empty() {
            if ended.elapsed().as_secs_f64() > SURVIVAL {
                let names: Vec<String> = left().into_iter().map(command_of).collect();
                send(&left(), libc::SIGKILL);
                return Err(format!("processes outlive it: {}", names.join("; ")));
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        // The last of a process are its open files and its locks.
        while !leftovers(launcher).is_empty() {
            // Where all were killed at once, or the launcher before it had roles, nobody is left to tidy up: the next
            // run does. An external solid may make something in the second that it is given.
            if signal == libc::SIGKILL && ended.elapsed().as_secs_f64() > TIDY {
                halfstep_link::cleanup_stale();
            }
            if ended.elapsed().as_secs_f64() > SURVIVAL {
                return Err(format!("left behind: {}", leftovers(launcher).join(", ")));
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        if outcome.stderr.contains("panicked") || outcome.log().contains("panicked") {
            return Err(format!("a panic: {} {}", outcome.stderr, outcome.log()));
        }
        Ok(outcome.code())
    }
}

/// Everything that a run has announced can be read.
fn whole_files(dir: &Path) -> Result<(), String> {
    for entry in std::fs::read_dir(dir.join("frames")).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some(stem) = name.strip_suffix(".hdf.series").filter(|stem| !stem.starts_with('.')) else {
            continue;
        };
        for (path, time) in Series::of_run(dir, stem).map_err(|e| e.to_string())? {
            let frame = vtkhdf::read(&path).map_err(|e| format!("an announced frame: {e}"))?;
            if frame.time != time {
                return Err(format!("{} is of another instant", path.display()));
            }
        }
    }
    let probes = dir.join("probes.csv");
    if let Ok(text) = std::fs::read_to_string(&probes) {
        let rows = read_probes(&probes).map_err(|e| e.to_string());
        if !text.is_empty() && (!text.ends_with('\n') || rows?.rows.len() + 1 != text.lines().count()) {
            return Err("a row of probes.csv is cut off".into());
        }
    }
    Ok(())
}

fn differences(own: &BTreeMap<String, Vec<u8>>, whole: &BTreeMap<String, Vec<u8>>) -> Vec<String> {
    let names = own.keys().chain(whole.keys().filter(|name| !own.contains_key(*name)));
    names.filter(|name| own.get(*name) != whole.get(*name)).cloned().collect()
}

fn command_of(pid: u32) -> String {
    let arguments = std::fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
    let words: Vec<String> =
        arguments.split(|&byte| byte == 0).map(|word| String::from_utf8_lossy(word).into_owned()).collect();
    match words.iter().position(|word| word == "role") {
        Some(k) => words[k..].join(" ").trim().to_owned(),
        None => words.join(" ").chars().take(40).collect(),
    }
}

/// The interpreter of the environment with what the external solid needs.
pub fn python() -> Option<String> {
    let output = Command::new("sh").arg(repository().join("tests/python/setup.sh")).output().ok()?;
    let path = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !path.is_empty()).then_some(path)
}
