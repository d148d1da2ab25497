//! One run from a scene to a folder.

use crate::clock::Clock;
use crate::couple::{CoupledOutcome, Coupler};
use crate::effects;
use crate::error::RunError;
use crate::foreign::ForeignSolid;
use crate::recorder::Recorder;
use crate::roles;
use crate::solo::run_solo;
use crate::supervise::{Children, stop_flag};
use halfstep_shared::failure::RoleName;
use halfstep_shared::geometry;
use halfstep_shared::lane::Isa;
use halfstep_shared::link::{self, Claim, CouplerLink, LinkConfig, LinkError, Processes, Threads};
use halfstep_shared::lockstep::{self, FOLDER_VARIABLE, RoleError, SCENE_VARIABLE, THREADS_VARIABLE};
use halfstep_shared::output::run_json::{PairEvaluations, Particles, RoleSeconds, RunStatus};
use halfstep_shared::output::{self, FrameWriter, RunDirectory, RunReport};
use halfstep_shared::protocol::{StateHeader, farewell};
use halfstep_shared::scene::Scene;
use std::path::PathBuf;
use std::process::{Command, ExitStatus};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Where the solid process comes from.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum SolidSource {
    /// The scene's model.
    #[default]
    BuiltIn,
    /// A command line for the shell.
    Command(String),
    /// Somebody starts it by hand.
    ByHand,
}

/// How to run.
#[derive(Clone, Debug, Default)]
pub struct RunOptions {
    /// Folder of the run.
    pub out: PathBuf,
    /// Worker threads of the fluid; `None`: the scene's.
    pub threads: Option<usize>,
    /// Roles as threads of this process.
    pub in_process: bool,
    /// No progress.
    pub quiet: bool,
    /// An earlier run in the folder is removed.
    pub force: bool,
    /// The solid.
    pub solid: SolidSource,
    /// How long to wait for a solid started by hand, s.
    pub solid_wait: f64,
}

/// Runs a scene. The report is written whatever happens; an error stands in it, too.
///
/// # Errors
/// Nothing could be started or written. A run that failed is a report with its error.
pub fn run(scene: &Scene, options: &RunOptions) -> Result<(RunReport, Option<RunError>), RunError> {
    if options.solid != SolidSource::BuiltIn && (scene.fluid.is_none() || scene.solid.is_none()) {
        return Err(RunError::System("--solid needs a scene with [fluid] and [solid]".into()));
    }
    let directory = RunDirectory::create(&options.out, options.force)?;
    let stop = stop_flag().map_err(|e| RunError::System(format!("cannot watch for signals: {e}")))?;
    let layout = geometry::layout::<2>(scene);
    let mut report = RunReport {
        scene: serde_json::to_value(scene).map_err(|e| RunError::System(e.to_string()))?,
        version: env!("CARGO_PKG_VERSION").into(),
        particles: Particles {
            fluid: layout.fluid.len() as u64,
            solid: layout.solid.len() as u64,
            wall: layout.wall.len() as u64,
            removed: 0,
        },
        ..RunReport::default()
    };
    let counts = geometry::Counts {
        fluid: report.particles.fluid,
        solid: report.particles.solid,
        wall: report.particles.wall,
    };
    report.effects = effects::ledger(scene, &counts);
    start_log(&directory)?;
    report.audit.isa = Some(Isa::detect().bits_name().into());
    report.write(&directory.file("run.json"))?;
    let mut recorder = Recorder::new(scene, &directory.file("probes.csv"), options.quiet)?;
    let mut clock = Clock::new(scene);
    let foreign = options.solid != SolidSource::BuiltIn;
    let result = if scene.fluid.is_some() && (scene.solid.is_some() || foreign) {
        let capacity = capacities(scene, report.particles.fluid, report.particles.solid, foreign);
        let session = Session { scene, options, directory: &directory, stop: &stop, capacity };
        session.coupled(&mut clock, &mut recorder, &mut report)
    } else {
        solo(scene, options, &directory, &stop, &mut clock, &mut recorder, &mut report)
    };
    recorder.finish(&mut report);
    if let Some((dt, limit)) = clock.exceeded() {
        tracing::warn!(
            "time_step = {dt:e} s is above the stability limit of {limit:e} s: look at the result with care"
        );
        eprintln!(
            "note: time_step = {dt:e} s is above the stability limit of {limit:e} s (time_step = \"auto\" keeps to it)"
        );
    }
    let error = match result {
        Ok(stopped) => {
            report.status = Some(if stopped { RunStatus::Stopped } else { RunStatus::Finished });
            None
        }
        Err(error) => {
            tracing::error!("{error}");
            report.status = Some(if matches!(error, RunError::Diverged(_)) {
                RunStatus::Diverged
            } else {
                RunStatus::Failed
            });
            report.error = Some(error.to_string());
            Some(error)
        }
    };
    report.write(&directory.file("run.json"))?;
    for picture in
        [output::draw_plot(scene, directory.path()).map(Some), output::draw_contact(scene, directory.path())]
    {
        if let Err(e) = picture {
            tracing::warn!("a picture could not be drawn: {e}");
        }
    }
    Ok((report, error))
}

/// What this process has to say goes to the run's log, beside what its children say.
fn start_log(directory: &RunDirectory) -> Result<(), RunError> {
    let path = directory.file("log.txt");
    let log = std::fs::OpenOptions::new()
        .create(true)
        .append(true)
        .open(&path)
        .map_err(|e| RunError::System(format!("cannot open {}: {e}", path.display())))?;
    let subscriber =
        tracing_subscriber::fmt().with_ansi(false).with_writer(std::sync::Mutex::new(log)).finish();
    // A process that runs several scenes keeps its first log.
    if tracing::subscriber::set_global_default(subscriber).is_err() {
        tracing::debug!("the log is open already");
    }
    Ok(())
}

/// Interface capacities of fluid and solid for these numbers of particles.
pub fn capacities(scene: &Scene, fluid: u64, solid: u64, foreign: bool) -> (u32, u32) {
    let solid = if foreign { solid.max(4096) } else { solid };
    // A ribbon of about four layers on each side of the solid's surface, and room for compression.
    let ribbon = (24 * solid).max(4096).min(fluid);
    let fluid = scene.numerics.interface_capacity.map_or(ribbon, u64::from);
    (fluid.max(1) as u32, solid.max(1) as u32)
}

fn solo(
    scene: &Scene,
    options: &RunOptions,
    directory: &RunDirectory,
    stop: &AtomicBool,
    clock: &mut Clock,
    recorder: &mut Recorder,
    report: &mut RunReport,
) -> Result<bool, RunError> {
    let name = if scene.fluid.is_some() { RoleName::Fluid } else { RoleName::Solid };
    let stem = roles::stem(name);
    let own = scene.numerics.threads;
    let threads = options.threads.unwrap_or(if name == RoleName::Fluid { own.fluid } else { own.solid });
    let mut writer = FrameWriter::start(directory.path(), stem)?;
    let result = lockstep::on_threads(threads, || -> Result<_, RunError> {
        let mut role = roles::build(name, scene)
            .ok_or_else(|| RunError::System("the scene has neither fluid nor solid".into()))?;
        run_solo(role.as_mut(), clock, &mut writer, recorder, stop)
    })?;
    writer.finish()?;
    let outcome = result?;
    report.audit.state_hash = Some(format!("{:016x}", outcome.state_hash));
    let seconds = Some(outcome.seconds);
    let evaluations = Some(outcome.pair_evaluations);
    if name == RoleName::Fluid {
        report.roles.fluid = seconds;
        report.work.pair_evaluations.fluid = evaluations;
    } else {
        report.roles.solid = seconds;
        report.work.pair_evaluations.solid = evaluations;
    }
    Ok(outcome.stopped)
}

struct Session<'a> {
    scene: &'a Scene,
    options: &'a RunOptions,
    directory: &'a RunDirectory,
    stop: &'a Arc<AtomicBool>,
    capacity: (u32, u32),
}

impl Session<'_> {
    fn threads(&self, role: RoleName) -> usize {
        let own = self.scene.numerics.threads;
        match role {
            RoleName::Fluid => self.options.threads.unwrap_or(own.fluid),
            _ => own.solid,
        }
    }

    fn coupled(
        &self,
        clock: &mut Clock,
        recorder: &mut Recorder,
        report: &mut RunReport,
    ) -> Result<bool, RunError> {
        link::cleanup_stale();
        let mut config = LinkConfig::new(self.capacity.0, self.capacity.1);
        if self.options.solid == SolidSource::ByHand {
            config.handshake_seconds = self.options.solid_wait;
        }
        // Held while children may live: what is the run's in shared memory goes with the last who holds it.
        let claim = Claim::new(&config)?;
        // The coupler's sums are short: one thread, and no worker to wake.
        let outcome = lockstep::on_threads(1, || {
            if self.options.in_process && self.options.solid == SolidSource::BuiltIn {
                self.as_threads(&config, clock, recorder)
            } else {
                self.as_processes(&config, clock, recorder)
            }
        });
        drop(claim);
        link::cleanup(&config);
        let outcome = outcome??;
        let hash = outcome.fluid.state_hash ^ outcome.solid.state_hash.rotate_left(1);
        report.audit.state_hash = Some(format!("{hash:016x}"));
        report.audit.action_reaction = Some(outcome.action_reaction);
        report.audit.checks = outcome.checks;
        report.roles.fluid = Some(seconds(&outcome.fluid));
        report.roles.solid = Some(seconds(&outcome.solid));
        report.roles.coupler = Some(outcome.seconds);
        report.work.pair_evaluations = PairEvaluations {
            fluid: pair_evaluations(&outcome.fluid),
            solid: pair_evaluations(&outcome.solid),
            coupler: Some(outcome.pair_evaluations),
        };
        report.round_trip_us = Some(output::run_json::Percentiles {
            p50: outcome.fluid.probes[farewell::ROUND_TRIP_P50],
            p99: outcome.fluid.probes[farewell::ROUND_TRIP_P99],
        });
        Ok(outcome.stopped)
    }

    fn as_processes(
        &self,
        config: &LinkConfig,
        clock: &mut Clock,
        recorder: &mut Recorder,
    ) -> Result<CoupledOutcome, RunError> {
        let system = |what: &str, e: std::io::Error| RunError::System(format!("{what}: {e}"));
        let scene_file = self.directory.file("scene.json");
        let text = serde_json::to_string_pretty(self.scene).map_err(|e| RunError::System(e.to_string()))?;
        output::atomic::replace_bytes(&scene_file, text.as_bytes())?;
        let scene_file = scene_file.canonicalize().map_err(|e| system("scene.json", e))?;
        let folder = self.directory.path().canonicalize().map_err(|e| system("the run's folder", e))?;
        let program = std::env::current_exe().map_err(|e| system("cannot find the own program", e))?;
        let mut children = Children::new(&self.directory.file("log.txt"));
        let mut built_in = vec![RoleName::Fluid];
        match &self.options.solid {
            SolidSource::BuiltIn => built_in.push(RoleName::Solid),
            SolidSource::Command(line) => {
                children.spawn_shell(RoleName::Solid, line, config, &scene_file)?;
            }
            SolidSource::ByHand => {
                eprintln!("waiting {} s for a solid; start it with", self.options.solid_wait);
                for (key, value) in config.to_env() {
                    eprintln!("  export {key}={value}");
                }
                eprintln!("  export {SCENE_VARIABLE}={}", scene_file.display());
            }
        }
        for role in built_in {
            let mut command = Command::new(&program);
            command
                .arg("role")
                .arg(roles::stem(role))
                .envs(config.to_env())
                .env(SCENE_VARIABLE, &scene_file)
                .env(FOLDER_VARIABLE, &folder)
                .env(THREADS_VARIABLE, self.threads(role).to_string());
            children.spawn(role, command)?;
        }
        let abort = Arc::new(AtomicBool::new(false));
        let done = AtomicBool::new(false);
        let watched = std::thread::scope(|scope| {
            // Before the handshake nobody else notices a child that could not even start.
            let watcher = scope.spawn(|| watch(&mut children, &abort, &done, self.stop));
            let result = CouplerLink::<Processes>::open(config, Some(Arc::clone(&abort)))
                .map_err(RunError::from)
                .inspect(|_| done.store(true, Ordering::Relaxed))
                .and_then(|link| self.lockstep(link, clock, recorder));
            done.store(true, Ordering::Relaxed);
            let early = watcher.join().unwrap_or(None);
            match (result, early) {
                (Err(RunError::Link(link)), Some((role, status))) => {
                    Err(RunError::RoleEnded { role, status, link })
                }
                (result, _) => result,
            }
        });
        match watched {
            Ok(outcome) => {
                children.wait(Duration::from_secs(5));
                Ok(outcome)
            }
            Err(error) => {
                children.wait(Duration::from_millis(300));
                let missed = match error {
                    RunError::Link(LinkError::PeerDied { peer }) => Some(peer),
                    _ => None,
                };
                let cause = children.culprit(missed);
                children.stop(Duration::from_secs(1));
                Err(match (error, cause) {
                    (RunError::Link(link), Some((role, status))) => {
                        RunError::RoleEnded { role, status, link }
                    }
                    (error, _) => error,
                })
            }
        }
    }

    fn lockstep<S: link::Transport>(
        &self,
        link: CouplerLink<S>,
        clock: &mut Clock,
        recorder: &mut Recorder,
    ) -> Result<CoupledOutcome, RunError> {
        let foreign = match self.options.solid {
            SolidSource::BuiltIn => None,
            _ => Some(ForeignSolid::new(self.scene, self.directory.path())?),
        };
        let mut coupler = Coupler::<S, 2>::new(link, self.scene, foreign)
            .ok_or_else(|| RunError::System("a coupled scene needs [fluid] and [solid]".into()))?;
        coupler.run(clock, recorder, self.stop)
    }

    fn as_threads(
        &self,
        config: &LinkConfig,
        clock: &mut Clock,
        recorder: &mut Recorder,
    ) -> Result<CoupledOutcome, RunError> {
        let abort = Arc::new(AtomicBool::new(false));
        std::thread::scope(|scope| {
            let threads: Vec<_> = [RoleName::Fluid, RoleName::Solid]
                .into_iter()
                .map(|name| {
                    let abort = Arc::clone(&abort);
                    scope.spawn(move || self.role_thread(name, config, abort))
                })
                .collect();
            let result = CouplerLink::<Threads>::open(config, Some(Arc::clone(&abort)))
                .map_err(RunError::from)
                .and_then(|link| self.lockstep(link, clock, recorder));
            if result.is_err() {
                abort.store(true, Ordering::Relaxed);
            }
            let mut first = None;
            for thread in threads {
                let ended = thread.join().unwrap_or_else(|_| Err(RoleError::Start("a role panicked".into())));
                if let Err(error) = ended
                    && first.is_none()
                    && !matches!(error, RoleError::Link(_) | RoleError::PeerEnded { .. })
                {
                    first = Some(error);
                }
            }
            match (result, first) {
                (Err(error @ RunError::Diverged(_)), _) => Err(error),
                (Err(_), Some(cause)) => Err(cause.into()),
                (result, _) => result,
            }
        })
    }

    fn role_thread(
        &self,
        name: RoleName,
        config: &LinkConfig,
        abort: Arc<AtomicBool>,
    ) -> Result<(), RoleError> {
        let raised = Arc::clone(&abort);
        let result = FrameWriter::start(self.directory.path(), roles::stem(name))
            .map_err(RoleError::from)
            .and_then(|writer| {
                lockstep::on_threads(self.threads(name), move || {
                    let mut role = roles::build(name, self.scene)
                        .ok_or_else(|| RoleError::Start(format!("the scene has no {name}")))?;
                    lockstep::serve::<Threads>(role.as_mut(), config, Some(writer), abort)
                })?
            });
        if matches!(result, Err(RoleError::Start(_))) {
            raised.store(true, Ordering::Relaxed);
        }
        result
    }
}

/// Watches for a child that ends, or for Ctrl-C, during the handshake.
fn watch(
    children: &mut Children,
    abort: &AtomicBool,
    done: &AtomicBool,
    stop: &AtomicBool,
) -> Option<(RoleName, ExitStatus)> {
    while !done.load(Ordering::Relaxed) {
        let exit = children.first_exit();
        if exit.is_some() || stop.load(Ordering::Relaxed) {
            abort.store(true, Ordering::Relaxed);
            return exit;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    None
}

/// What a phase counted, where its last message says so.
fn pair_evaluations(last: &StateHeader) -> Option<u64> {
    let told = last.probe_count > farewell::PAIR_EVALUATIONS as u64;
    told.then(|| last.probes[farewell::PAIR_EVALUATIONS] as u64)
}

fn seconds(header: &StateHeader) -> RoleSeconds {
    let [compute, wait, exchange, output] = header.seconds;
    RoleSeconds { compute, wait, exchange, output }
}
