//! A coupled run: starts its roles as processes or as threads, couples them, and finds out why one of them ended.

use crate::cause::{Cause, culprit};
use crate::checkpoint::Checkpoint;
use crate::isa::{self, ISA_VARIABLE};
use crate::options::{Launcher, RunOptions, SolidSource};
use crate::participants::{participants, report_outcome, report_participants};
use crate::particles::{self, PARTICLES_VARIABLE};
use crate::silence::{Ended, Silence, TICK, TOLD};
use crate::timeline;
use halfstep_coupling::couple::{Coupler, Outcome};
use halfstep_coupling::course::Course;
use halfstep_coupling::error::RunError;
use halfstep_coupling::external::ExternalSolid;
use halfstep_coupling::supervise::Children;
use halfstep_coupling::{no_room, say};
use halfstep_coupling::{reports, roles};
use halfstep_link::{
    self as link, Claim, CouplerLink, FLUID, LinkConfig, LinkError, Participant, Processes, Threads,
};
use halfstep_output::run_json::{Percentiles, RunStatus};
use halfstep_output::{self as output, RunDirectory, RunReport};
use halfstep_role::lockstep::RoleError;
use halfstep_role::report::Report;
use halfstep_role::serve::{
    self, CHECKPOINT_VARIABLE, FOLDER_VARIABLE, SCENE_VARIABLE, THREADS_VARIABLE, TIMELINE_VARIABLE,
};
use halfstep_role::timeline::Recording;
use halfstep_scene::Scene;
use halfstep_scene::geometry::Layout;
use halfstep_wire::Name;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What a coupled run needs, whatever carries its messages.
pub(crate) struct Session<'a, const D: usize> {
    scene: &'a Scene,
    options: &'a RunOptions,
    directory: &'a RunDirectory,
    checkpoint: Option<&'a Checkpoint>,
    config: LinkConfig,
    /// What external solids are told of their particles: their place in [`Scene::solids`], and the text of a file.
    particles: Vec<(usize, String)>,
}

impl<'a, const D: usize> Session<'a, D> {
    /// For a scene with both phases, whose particles begin as in `layout`, from its start or from a checkpoint.
    pub(crate) fn new(
        scene: &'a Scene,
        options: &'a RunOptions,
        directory: &'a RunDirectory,
        checkpoint: Option<&'a Checkpoint>,
        layout: &Layout<D>,
    ) -> Result<Self, RunError> {
        let mut config = LinkConfig::new(participants(scene, layout, &options.external_names())?);
        config.patience_seconds = options.patience;
        if options.external.iter().any(|(_, source)| *source == SolidSource::ByHand) {
            config.handshake_seconds = options.solid_wait;
        }
        let names = options.external_names();
        let solids = scene.solids.iter().enumerate();
        let external = solids.filter(|(_, solid)| names.iter().any(|name| name.as_str() == solid.name));
        let particles = external.map(|(k, _)| (k, particles::table(scene, layout, k))).collect();
        Ok(Self { scene, options, directory, checkpoint, config, particles })
    }

    /// Writes what an external solid is told of its particles; returns the file.
    fn tell_particles(&self, place: usize, folder: &Path) -> Result<PathBuf, RunError> {
        let path = folder.join(particles::file_name(self.config.participants[place].name.as_str()));
        let told = self.particles.iter().find(|(solid, _)| solid + 1 == place);
        output::atomic::replace_bytes(&path, told.map_or("", |(_, text)| text).as_bytes())?;
        Ok(path)
    }

    /// Worker threads of a process: the most that one of its participants asks for.
    fn threads(&self, process: Name) -> usize {
        let of = |place: usize| match place {
            FLUID => self.options.threads.unwrap_or(self.scene.numerics.threads.fluid),
            _ => self.scene.solids[place - 1].threads,
        };
        self.config.members(process).into_iter().map(of).max().unwrap_or(1)
    }

    /// Solids that are awaited, with the files that tell how to start them.
    fn awaited(&self) -> impl Iterator<Item = (&Participant, PathBuf)> {
        let single = self.scene.solids.len() == 1;
        self.config.participants.iter().filter_map(move |participant| {
            let by_hand = self.options.source(participant.name) == Some(&SolidSource::ByHand);
            let name = match single {
                true => "solid.env".to_owned(),
                false => format!("solid-{}.env", participant.name),
            };
            by_hand.then(|| (participant, self.directory.file(&name)))
        })
    }

    /// Runs to the scene's end; returns whether it was stopped before.
    pub(crate) fn run(&self, course: &mut Course, report: &mut RunReport) -> Result<bool, RunError> {
        link::cleanup_stale();
        // Held while children may live: what is the run's in shared memory goes with the last who holds it.
        let claim = Claim::new(&self.config)?;
        // The coupler's sums are short: one thread, and no worker to wake.
        let outcome = serve::on_threads(1, || match &self.options.launcher {
            Some(launcher) => {
                // What the process of a library does with signals is its own affair.
                if self.options.log {
                    self.prepare_for_no_room(report)?;
                }
                self.as_processes(course, launcher)
            }
            None if self.options.external.is_empty() => self.as_threads(course),
            None => Err(RunError::System("a solid of another program needs a launcher of processes".into())),
        });
        drop(claim);
        for (_, file) in self.awaited() {
            // A solid that comes too late shall not look for a run that is gone.
            let _ = std::fs::remove_file(file);
        }
        let outcome = match outcome? {
            // Nothing has happened yet that could have an outcome.
            Err(RunError::StoppedEarly) => return Ok(true),
            other => other?,
        };
        report_outcome(self.scene, &outcome, report);
        let read = |participant: &Participant| {
            reports::read(self.directory.path(), participant.name.as_str()).map_err(RunError::from)
        };
        let own: Vec<_> = self.config.participants.iter().map(read).collect::<Result<_, RunError>>()?;
        report.round_trip_us = own[FLUID].as_ref().map(|fluid| {
            let [p50, p99] = fluid.round_trip_us;
            Percentiles { p50, p99 }
        });
        report_participants(self.scene, &self.options.external, &outcome, &own, Some(&self.config), report);
        Ok(outcome.stopped)
    }

    /// The transport may find no room in the middle of making its objects: then the report tells of it.
    fn prepare_for_no_room(&self, report: &RunReport) -> Result<(), RunError> {
        let reason = no_room::REASON;
        let failed =
            RunReport { status: Some(RunStatus::Failed), error: Some(reason.into()), ..report.clone() };
        let text = serde_json::to_vec_pretty(&failed).map_err(|e| RunError::System(e.to_string()))?;
        let path = self.directory.file("run.json");
        let refused = |e: std::io::Error| RunError::System(format!("cannot watch for signals: {e}"));
        no_room::prepare(format!("error: {reason}\n"), Some((&path, text))).map_err(refused)
    }

    fn as_processes(&self, course: &mut Course, launcher: &Launcher) -> Result<Outcome, RunError> {
        let config = &self.config;
        let system = |what: &str, e: std::io::Error| RunError::System(format!("{what}: {e}"));
        let scene_file = self.directory.file("scene.json");
        let scene_file = scene_file.canonicalize().map_err(|e| system("scene.json", e))?;
        let folder = self.directory.path().canonicalize().map_err(|e| system("the run's folder", e))?;
        let log = self.directory.file("log.txt");
        let mut children = Children::new(&log);
        // A role that outlives this process still has the folder.
        children.keep(self.directory.lock());
        let checkpoint = self.checkpoint.map(|checkpoint| (CHECKPOINT_VARIABLE, checkpoint.folder.as_path()));
        let mut told = vec![(SCENE_VARIABLE, scene_file.as_path()), (FOLDER_VARIABLE, &folder)];
        told.extend(checkpoint);
        for (place, participant) in config.participants.iter().enumerate() {
            if let Some(SolidSource::Command(line)) = self.options.source(participant.name) {
                let particles = self.tell_particles(place, &folder)?;
                let mut told = told.clone();
                told.push((PARTICLES_VARIABLE, &particles));
                children.spawn_shell(participant, line, config, &told)?;
            }
        }
        self.invite(&scene_file, &folder)?;
        for process in config.processes() {
            if self.options.source(process).is_some() {
                continue;
            }
            let mut command = Command::new(&launcher.program);
            command
                .arg("role")
                .arg(process.as_str())
                .envs(config.to_env())
                .envs(told.iter().copied())
                .env(THREADS_VARIABLE, self.threads(process).to_string())
                .env(ISA_VARIABLE, isa::name(self.options.isa));
            if let Some(trace) = &self.options.trace {
                command.env(TIMELINE_VARIABLE, trace.window.to_string());
            }
            children.spawn(process, command)?;
        }
        let (abort, progress) = (Arc::new(AtomicBool::new(false)), Arc::clone(&course.progress));
        let (done, connected) = (AtomicBool::new(false), AtomicBool::new(false));
        let stop = &self.options.stop;
        let names = config.names();
        let started = Instant::now();
        let by_hand = self.awaited().next().is_some();
        let watched = std::thread::scope(|scope| {
            let watcher = scope.spawn(|| {
                // Before the handshake nobody else notices a child that could not even start.
                let early = watch(&mut children, &abort, &connected, &done, &stop.stop);
                (early, Silence::new(&progress, &names).watch(&mut children, &abort, &done, stop))
            });
            let over = Raised(&done);
            let result = CouplerLink::<Processes>::open(config, Some(Arc::clone(&abort)))
                .map_err(RunError::from)
                .inspect(|_| {
                    connected.store(true, Ordering::Relaxed);
                    if by_hand {
                        say::warn(format_args!("the solid is connected"));
                    }
                })
                .and_then(|link| self.lockstep(link, course));
            drop(over);
            let (early, later) = watcher.join().unwrap_or((None, None));
            let cause = |error, ended, at| {
                let external = self.options.external_names();
                Err(Cause { log: &log, external: &external, at }.of(error, Some(ended)))
            };
            match (result, early, later) {
                (Err(error @ RunError::Link(_)), Some(ended), _) => cause(error, ended, None),
                (Err(error @ RunError::Link(_)), _, Some(Ended::Failed(role, status))) => {
                    cause(error, (role, status), Some((course.clock.step(), course.clock.time())))
                }
                (Err(RunError::Link(_)), _, Some(Ended::Silent(role, silence))) => {
                    Err(RunError::StoppedAtOnce { role, seconds: silence.as_secs_f64() })
                }
                (result, ..) => result,
            }
        });
        match watched {
            Ok(outcome) => {
                children.wait(Duration::from_secs(5));
                Ok(outcome)
            }
            Err(error) => {
                if matches!(error, RunError::StoppedAtOnce { .. }) {
                    children.stop(Duration::from_millis(300));
                    return Err(error);
                }
                let cause = culprit(&mut children, &error);
                let waiting = !connected.load(Ordering::Relaxed);
                let seconds = self.options.solid_wait;
                Err(match (error, cause) {
                    _ if stop.stop.load(Ordering::Relaxed) && (waiting || course.clock.step() == 0) => {
                        RunError::StoppedEarly
                    }
                    // The fluid waits for the solid, too, and may be the first to give up.
                    (error, _) if waiting && by_hand && started.elapsed().as_secs_f64() >= seconds => {
                        let told = match error {
                            RunError::Link(LinkError::HandshakeTimeout { missing, .. }) => missing,
                            _ => Vec::new(),
                        };
                        let awaited: Vec<Name> = self.awaited().map(|(p, _)| p.name).collect();
                        let mut missing = awaited.clone();
                        missing.retain(|name| told.contains(name));
                        RunError::NoSolid {
                            missing: if missing.is_empty() { awaited } else { missing },
                            seconds,
                        }
                    }
                    (error, ended) => {
                        let external = self.options.external_names();
                        let at = (!waiting).then(|| (course.clock.step(), course.clock.time()));
                        Cause { log: &log, external: &external, at }.of(error, ended)
                    }
                })
            }
        }
    }

    /// Tells how to start the solids that are awaited: with the variables of a file, ready for a shell.
    fn invite(&self, scene: &Path, folder: &Path) -> Result<(), RunError> {
        let quoted = |path: &dyn Display| format!("'{}'", path.to_string().replace('\'', r"'\''"));
        for (participant, file) in self.awaited() {
            let place = self.config.participants.iter().position(|p| p.name == participant.name);
            let particles = self.tell_particles(place.unwrap_or_default(), folder)?;
            let mut text = String::new();
            for (key, value) in self.config.to_env_of(participant) {
                text += &format!("export {key}={}\n", quoted(&value));
            }
            text += &format!("export {SCENE_VARIABLE}={}\n", quoted(&scene.display()));
            text += &format!("export {FOLDER_VARIABLE}={}\n", quoted(&folder.display()));
            text += &format!("export {PARTICLES_VARIABLE}={}\n", quoted(&particles.display()));
            if let Some(checkpoint) = self.checkpoint {
                text += &format!("export {CHECKPOINT_VARIABLE}={}\n", quoted(&checkpoint.folder.display()));
            }
            output::atomic::replace_bytes(&file, text.as_bytes())?;
            let file = file.canonicalize().unwrap_or(file);
            say::warn(format_args!(
                "waiting up to {} s for the {}; start yours in another terminal:\n  . {} && COMMAND",
                self.options.solid_wait,
                participant.name,
                quoted(&file.display())
            ));
        }
        Ok(())
    }

    fn lockstep<S: link::Transport>(
        &self,
        link: CouplerLink<S>,
        course: &mut Course,
    ) -> Result<Outcome, RunError> {
        let external = |(place, participant): (usize, &Participant)| {
            let name = participant.name;
            let stands_in = || ExternalSolid::new(self.scene, place, name, self.directory.path());
            self.options.source(name).map(|_| stands_in()).transpose()
        };
        let solids = self.config.participants.iter().enumerate().skip(1);
        let external = solids.map(external).collect::<Result<Vec<_>, _>>()?;
        let mut coupler = Coupler::<_, D>::new(link, self.scene, external, self.options.isa);
        if let Some(checkpoint) = self.checkpoint {
            coupler.resume(&mut course.clock, &checkpoint.coupler)?;
        }
        let _recording = self.record(Name::COUPLER);
        coupler.run(course)
    }

    /// Records the half-steps of this thread, which is a process of the scene or the coupler, if that is asked for.
    fn record(&self, process: Name) -> Option<Recording> {
        let trace = self.options.trace.as_ref()?;
        let own = self.options.launcher.is_some();
        Some(timeline::record(trace.window, self.directory.path(), process, own))
    }

    fn as_threads(&self, course: &mut Course) -> Result<Outcome, RunError> {
        let config = &self.config;
        let abort = Arc::new(AtomicBool::new(false));
        std::thread::scope(|scope| {
            let threads: Vec<_> = config
                .processes()
                .into_iter()
                .map(|process| {
                    let abort = Arc::clone(&abort);
                    scope.spawn(move || self.thread(process, abort))
                })
                .collect();
            let failed = Raised(&abort);
            let result = CouplerLink::<Threads>::open(config, Some(Arc::clone(&abort)))
                .map_err(RunError::from)
                .and_then(|link| self.lockstep(link, course));
            if result.is_ok() {
                std::mem::forget(failed);
            } else {
                drop(failed);
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

    /// A process of the scene as a thread of this one.
    fn thread(&self, process: Name, abort: Arc<AtomicBool>) -> Result<(), RoleError> {
        let raised = Arc::clone(&abort);
        let folder = self.directory.path();
        let result = serve::on_threads(self.threads(process), move || {
            let places = self.config.members(process);
            let from = self.checkpoint.map(|checkpoint| checkpoint.folder.as_path());
            let members = roles::members(self.scene, &places, self.options.isa, Some(folder), from)?;
            let mut deliver = |report: &Report| Ok(reports::write(folder, report)?);
            let _recording = self.record(process);
            serve::serve::<Threads>(members, &self.config, process, abort, &mut deliver)
        });
        let result = result.and_then(|served| served);
        if matches!(result, Err(RoleError::Start(_) | RoleError::Output(_))) {
            raised.store(true, Ordering::Relaxed);
        }
        result
    }
}

/// Raises a flag when it goes, also where a panic unwinds: the other threads of a scope, which is left only after them,
/// look at it.
pub(crate) struct Raised<'a>(pub(crate) &'a AtomicBool);

impl Drop for Raised<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Watches for a child that ends, or for Ctrl-C, during the handshake.
pub(crate) fn watch(
    children: &mut Children,
    abort: &AtomicBool,
    connected: &AtomicBool,
    done: &AtomicBool,
    stop: &AtomicBool,
) -> Option<(Name, ExitStatus)> {
    let (started, mut told) = (Instant::now(), false);
    while !connected.load(Ordering::Relaxed) && !done.load(Ordering::Relaxed) {
        if started.elapsed() > TOLD && !std::mem::replace(&mut told, true) {
            let names: Vec<String> = children.pids().iter().map(|(name, _)| name.to_string()).collect();
            let seconds = TOLD.as_secs();
            say::warn(format_args!(
                "waiting since {seconds} s for the processes to connect: {}",
                names.join(", ")
            ));
        }
        children.keep_log_short();
        let exit = children.first_exit();
        if exit.is_some() || stop.load(Ordering::Relaxed) {
            abort.store(true, Ordering::Relaxed);
            return exit;
        }
        std::thread::sleep(TICK);
    }
    None
}
