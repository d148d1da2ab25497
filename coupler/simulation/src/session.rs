//! A coupled run: starts its roles as processes or as threads, couples them, and finds out why one of them ended.

use crate::effects;
use crate::isa::{self, ISA_VARIABLE};
use crate::options::{RunOptions, SolidSource};
use halfstep_coupling::clock::Clock;
use halfstep_coupling::couple::{CoupledOutcome, Coupler};
use halfstep_coupling::error::RunError;
use halfstep_coupling::foreign::ForeignSolid;
use halfstep_coupling::recorder::Recorder;
use halfstep_coupling::roles;
use halfstep_coupling::supervise::Children;
use halfstep_link::{self as link, Claim, CouplerLink, LinkConfig, LinkError, Processes, Threads};
use halfstep_output::run_json::{PairEvaluations, Percentiles, RoleSeconds};
use halfstep_output::{self as output, FrameWriter, RunDirectory, RunReport};
use halfstep_role::farewell;
use halfstep_role::lockstep::{self, FOLDER_VARIABLE, RoleError, SCENE_VARIABLE, THREADS_VARIABLE};
use halfstep_scene::Scene;
use halfstep_wire::failure::RoleName;
use halfstep_wire::protocol::StateHeader;
use std::fmt::Display;
use std::path::Path;
use std::process::{Command, ExitStatus};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// File in the run's folder with the variables of a solid that is started by hand.
const SOLID_VARIABLES: &str = "solid.env";

/// What a coupled run needs, whatever carries its messages.
pub(crate) struct Session<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) options: &'a RunOptions,
    pub(crate) directory: &'a RunDirectory,
    pub(crate) stop: &'a AtomicBool,
    /// Interface capacities of fluid and solid.
    pub(crate) capacity: (u32, u32),
}

impl Session<'_> {
    fn threads(&self, role: RoleName) -> usize {
        let own = self.scene.numerics.threads;
        match role {
            RoleName::Fluid => self.options.threads.unwrap_or(own.fluid),
            _ => own.solid,
        }
    }

    /// Runs to the scene's end; returns whether it was stopped before.
    pub(crate) fn run(
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
        if self.options.solid == SolidSource::ByHand {
            // A solid that comes too late shall not look for a run that is gone.
            let _ = std::fs::remove_file(self.directory.file(SOLID_VARIABLES));
        }
        let outcome = match outcome? {
            // Nothing has happened yet that could have an outcome.
            Err(RunError::StoppedEarly) => return Ok(true),
            other => other?,
        };
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
        report.round_trip_us = Some(Percentiles {
            p50: outcome.fluid.probes[farewell::ROUND_TRIP_P50],
            p99: outcome.fluid.probes[farewell::ROUND_TRIP_P99],
        });
        effects::share_coupled(report, &outcome);
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
        let text = self.scene.to_json().map_err(|e| RunError::System(format!("scene.json: {e}")))?;
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
            SolidSource::ByHand => self.invite(config, &scene_file, &folder)?,
        }
        for role in built_in {
            let mut command = Command::new(&program);
            command
                .arg("role")
                .arg(roles::stem(role))
                .envs(config.to_env())
                .env(SCENE_VARIABLE, &scene_file)
                .env(FOLDER_VARIABLE, &folder)
                .env(ISA_VARIABLE, isa::name(self.options.isa))
                .env(THREADS_VARIABLE, self.threads(role).to_string());
            children.spawn(role, command)?;
        }
        let abort = Arc::new(AtomicBool::new(false));
        let (done, connected) = (AtomicBool::new(false), AtomicBool::new(false));
        let started = Instant::now();
        let by_hand = self.options.solid == SolidSource::ByHand;
        let watched = std::thread::scope(|scope| {
            // Before the handshake nobody else notices a child that could not even start.
            let watcher = scope.spawn(|| watch(&mut children, &abort, &done, self.stop));
            let result = CouplerLink::<Processes>::open(config, Some(Arc::clone(&abort)))
                .map_err(RunError::from)
                .inspect(|_| {
                    done.store(true, Ordering::Relaxed);
                    connected.store(true, Ordering::Relaxed);
                    if by_hand {
                        eprintln!("the solid is connected");
                    }
                })
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
                let waiting = !connected.load(Ordering::Relaxed);
                let seconds = self.options.solid_wait;
                Err(match (error, cause) {
                    _ if waiting && self.stop.load(Ordering::Relaxed) => RunError::StoppedEarly,
                    // The fluid waits for the solid, too, and may be the first to give up.
                    _ if waiting && by_hand && started.elapsed().as_secs_f64() >= seconds => {
                        RunError::NoSolid { seconds }
                    }
                    (RunError::Link(link), Some((role, status))) => {
                        RunError::RoleEnded { role, status, link }
                    }
                    (error, _) => error,
                })
            }
        }
    }

    /// Tells how to start a solid by hand: with the variables of a file, ready for a shell.
    fn invite(&self, config: &LinkConfig, scene: &Path, folder: &Path) -> Result<(), RunError> {
        let quoted = |path: &dyn Display| format!("'{}'", path.to_string().replace('\'', r"'\''"));
        let mut text = String::new();
        for (key, value) in config.to_env() {
            text += &format!("export {key}={}\n", quoted(&value));
        }
        text += &format!("export {SCENE_VARIABLE}={}\n", quoted(&scene.display()));
        let file = folder.join(SOLID_VARIABLES);
        output::atomic::replace_bytes(&file, text.as_bytes())?;
        eprintln!(
            "waiting up to {} s for a solid; start yours in another terminal:\n  . {} && COMMAND",
            self.options.solid_wait,
            quoted(&file.display())
        );
        Ok(())
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
        let mut coupler = Coupler::<S, 2>::new(link, self.scene, self.options.isa, foreign)
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
                (Err(error @ RunError::Diverged { .. }), _) => Err(error),
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
            .map_err(|error| RoleError::Frames(error.into()))
            .and_then(|writer| {
                lockstep::on_threads(self.threads(name), move || {
                    let mut role = roles::build(name, self.scene, self.options.isa)
                        .ok_or_else(|| RoleError::Start(format!("the scene has no {name}")))?;
                    lockstep::serve::<Threads>(role.as_mut(), config, Some(Box::new(writer)), abort)
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
